//! Mission items: what the autopilot accepts, and what it makes of them.

use aircraft::autopilot::FLY_OVER_M;
use geometry::LatLon;
use mavlink::dialects::ardupilotmega::{
    MISSION_ITEM_DATA, MISSION_ITEM_INT_DATA, MavCmd, MavFrame, MavMissionResult, MavMissionType,
};

/// The mission list.
#[derive(Debug, Default)]
pub struct Mission(pub(super) Vec<Item>);

impl Mission {
    /// All items, with the one that stands for home if the autopilot has that.
    pub fn items(&self) -> &[Item] {
        &self.0
    }
}

/// What an item does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kind {
    /// Take off on the present heading and climb to the altitude.
    TakeOff,
    /// Fly to a position; `over`: cross it before turning.
    Waypoint {
        /// Cross it before turning.
        over: bool,
        /// Go on this far before it, metres; `None`: as it likes.
        acceptance_m: Option<f64>,
    },
    /// Circle until told otherwise; positive clockwise, 0: the autopilot's own radius.
    Loiter {
        /// Metres.
        radius_m: f64,
    },
    /// Land.
    Land,
    /// Return to launch.
    ReturnToLaunch,
    /// Go on at another item.
    Jump {
        /// The item.
        to: u16,
        /// How often; negative: always.
        repeat: i32,
    },
    /// Change the airspeed.
    Speed {
        /// m/s; −1 keeps it, −2 resets it.
        mps: f64,
    },
    /// Marks where a landing sequence begins; nothing to do.
    LandStart,
}

/// What an altitude is measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Datum {
    /// Mean sea level.
    Amsl,
    /// Home's elevation (also for terrain altitudes: the simulator has no terrain).
    Home,
}

/// An accepted item. The wire form is kept for the read-back.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// What it does.
    pub kind: Kind,
    /// Where; latitude and longitude 0 mean "here".
    pub position: LatLon,
    /// Metres above the datum.
    pub altitude_m: f64,
    /// Which datum.
    pub datum: Datum,
    /// As it came.
    pub wire: MISSION_ITEM_INT_DATA,
}

impl Item {
    /// The item that stands for home, sequence number 0.
    pub fn home(position: LatLon, altitude_amsl_m: f64) -> Self {
        let wire = MISSION_ITEM_INT_DATA {
            x: degrees_e7(position.lat_deg),
            y: degrees_e7(position.lon_deg),
            z: altitude_amsl_m as f32,
            command: MavCmd::MAV_CMD_NAV_WAYPOINT,
            frame: MavFrame::MAV_FRAME_GLOBAL,
            autocontinue: 1,
            ..MISSION_ITEM_INT_DATA::DEFAULT
        };
        Self {
            kind: Kind::Waypoint { over: false, acceptance_m: None },
            position,
            altitude_m: altitude_amsl_m,
            datum: Datum::Amsl,
            wire,
        }
    }

    /// Reads an item as ArduPlane does.
    ///
    /// # Errors
    /// The answer it gives to an item that it doesn't take.
    pub fn from_wire(wire: &MISSION_ITEM_INT_DATA) -> Result<Self, MavMissionResult> {
        if wire.mission_type != MavMissionType::MAV_MISSION_TYPE_MISSION {
            return Err(MavMissionResult::MAV_MISSION_UNSUPPORTED);
        }
        check_numbers(wire)?;
        let kind = kind_of(wire)?;
        let datum = if kind.has_position() {
            if !wire.z.is_finite() {
                return Err(MavMissionResult::MAV_MISSION_INVALID_PARAM7);
            }
            datum_of(wire.frame)?
        } else {
            Datum::Amsl
        };
        Ok(Self {
            kind,
            position: LatLon::new(f64::from(wire.x) * 1e-7, f64::from(wire.y) * 1e-7),
            altitude_m: wire.z.into(),
            datum,
            wire: wire.clone(),
        })
    }

    /// An item that is flown, not just done in passing.
    pub fn is_navigation(&self) -> bool {
        !matches!(self.kind, Kind::Jump { .. } | Kind::Speed { .. } | Kind::LandStart)
    }
}

impl Kind {
    /// It is about a place.
    pub fn has_position(self) -> bool {
        matches!(self, Kind::TakeOff | Kind::Waypoint { .. } | Kind::Loiter { .. } | Kind::Land)
    }
}

/// Degrees as MAVLink sends them.
pub fn degrees_e7(degrees: f64) -> i32 {
    (degrees * 1e7).round() as i32
}

/// The float form of an item in the integer form.
pub fn from_float(item: &MISSION_ITEM_DATA) -> MISSION_ITEM_INT_DATA {
    MISSION_ITEM_INT_DATA {
        param1: item.param1,
        param2: item.param2,
        param3: item.param3,
        param4: item.param4,
        x: degrees_e7(item.x.into()),
        y: degrees_e7(item.y.into()),
        z: item.z,
        seq: item.seq,
        command: item.command,
        target_system: item.target_system,
        target_component: item.target_component,
        frame: item.frame,
        current: item.current,
        autocontinue: item.autocontinue,
        mission_type: item.mission_type,
    }
}

/// The integer form of an item in the float form, for those who ask for that.
pub fn to_float(item: &MISSION_ITEM_INT_DATA) -> MISSION_ITEM_DATA {
    MISSION_ITEM_DATA {
        param1: item.param1,
        param2: item.param2,
        param3: item.param3,
        param4: item.param4,
        x: (f64::from(item.x) * 1e-7) as f32,
        y: (f64::from(item.y) * 1e-7) as f32,
        z: item.z,
        seq: item.seq,
        command: item.command,
        target_system: item.target_system,
        target_component: item.target_component,
        frame: item.frame,
        current: item.current,
        autocontinue: item.autocontinue,
        mission_type: item.mission_type,
    }
}

fn check_numbers(wire: &MISSION_ITEM_INT_DATA) -> Result<(), MavMissionResult> {
    use MavMissionResult as R;
    // a NaN in param4 (yaw) is how clients say "whatever you like", and in z of what has no place
    let numbers = [
        (wire.param1, R::MAV_MISSION_INVALID_PARAM1),
        (wire.param2, R::MAV_MISSION_INVALID_PARAM2),
        (wire.param3, R::MAV_MISSION_INVALID_PARAM3),
    ];
    if let Some((_, refusal)) = numbers.into_iter().find(|(value, _)| !value.is_finite()) {
        return Err(refusal);
    }
    if wire.x.unsigned_abs() > 900_000_000 {
        return Err(R::MAV_MISSION_INVALID_PARAM5_X);
    }
    if wire.y.unsigned_abs() > 1_800_000_000 {
        return Err(R::MAV_MISSION_INVALID_PARAM6_Y);
    }
    Ok(())
}

/// An acceptance radius (param2) of next to nothing or an overflight distance (param3) asks for crossing the point; a greater one for
/// going on that early. It keeps each in a byte.
fn waypoint(wire: &MISSION_ITEM_INT_DATA) -> Kind {
    let accepted_m = wire.param2.clamp(0.0, 255.0);
    let over = wire.param3 > 0.0 || (accepted_m > 0.0 && accepted_m <= FLY_OVER_M as f32);
    let acceptance_m = (accepted_m > 0.0 && !over).then(|| f64::from(accepted_m));
    Kind::Waypoint { over, acceptance_m }
}

/// What an item does.
///
/// # Errors
/// Not known, or with a parameter that makes no sense.
pub fn kind_of(wire: &MISSION_ITEM_INT_DATA) -> Result<Kind, MavMissionResult> {
    Ok(match wire.command {
        MavCmd::MAV_CMD_NAV_TAKEOFF => Kind::TakeOff,
        MavCmd::MAV_CMD_NAV_WAYPOINT => waypoint(wire),
        MavCmd::MAV_CMD_NAV_LOITER_UNLIM => Kind::Loiter { radius_m: wire.param3.into() },
        MavCmd::MAV_CMD_NAV_LAND => Kind::Land,
        MavCmd::MAV_CMD_NAV_RETURN_TO_LAUNCH => Kind::ReturnToLaunch,
        MavCmd::MAV_CMD_DO_JUMP if wire.param1 >= 0.0 => {
            Kind::Jump { to: wire.param1 as u16, repeat: wire.param2 as i32 }
        }
        MavCmd::MAV_CMD_DO_JUMP => return Err(MavMissionResult::MAV_MISSION_INVALID_PARAM1),
        MavCmd::MAV_CMD_DO_CHANGE_SPEED => Kind::Speed { mps: wire.param2.into() },
        MavCmd::MAV_CMD_DO_LAND_START => Kind::LandStart,
        _ => return Err(MavMissionResult::MAV_MISSION_UNSUPPORTED),
    })
}

/// The frame of the same datum that is not for whole numbers.
pub fn without_integers(frame: MavFrame) -> MavFrame {
    match frame {
        MavFrame::MAV_FRAME_GLOBAL_INT => MavFrame::MAV_FRAME_GLOBAL,
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT => MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT,
        MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT => MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT,
        frame => frame,
    }
}

/// What an altitude in that frame is measured from.
///
/// # Errors
/// A frame that is not a global one.
pub fn datum_of(frame: MavFrame) -> Result<Datum, MavMissionResult> {
    match frame {
        MavFrame::MAV_FRAME_GLOBAL | MavFrame::MAV_FRAME_GLOBAL_INT => Ok(Datum::Amsl),
        MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT
        | MavFrame::MAV_FRAME_GLOBAL_RELATIVE_ALT_INT
        | MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT
        | MavFrame::MAV_FRAME_GLOBAL_TERRAIN_ALT_INT => Ok(Datum::Home),
        _ => Err(MavMissionResult::MAV_MISSION_UNSUPPORTED_FRAME),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_items_are_refused_with_the_right_answer() {
        use MavMissionResult as R;
        type Spoil = fn(&mut MISSION_ITEM_INT_DATA);
        let cases: [(Spoil, R); 7] = [
            (|w| w.param2 = f32::NAN, R::MAV_MISSION_INVALID_PARAM2),
            (|w| w.z = f32::INFINITY, R::MAV_MISSION_INVALID_PARAM7),
            (|w| w.x = 900_000_001, R::MAV_MISSION_INVALID_PARAM5_X),
            (|w| w.y = i32::MIN, R::MAV_MISSION_INVALID_PARAM6_Y),
            (|w| w.frame = MavFrame::MAV_FRAME_LOCAL_NED, R::MAV_MISSION_UNSUPPORTED_FRAME),
            (|w| w.command = MavCmd::MAV_CMD_NAV_SPLINE_WAYPOINT, R::MAV_MISSION_UNSUPPORTED),
            (|w| w.mission_type = MavMissionType::MAV_MISSION_TYPE_FENCE, R::MAV_MISSION_UNSUPPORTED),
        ];
        let good = Item::home(LatLon::new(36.0, -84.0), 300.0).wire;
        assert!(Item::from_wire(&good).is_ok());
        for (spoil, refusal) in cases {
            let mut wire = good.clone();
            spoil(&mut wire);
            assert_eq!(Item::from_wire(&wire).err(), Some(refusal));
        }
    }

    #[test]
    fn an_unwanted_yaw_may_be_not_a_number() {
        let mut wire = Item::home(LatLon::new(36.0, -84.0), 300.0).wire;
        wire.param4 = f32::NAN;
        assert!(Item::from_wire(&wire).is_ok());
    }
}
