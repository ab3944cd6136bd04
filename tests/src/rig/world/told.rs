//! How each autopilot's simulation is told what goes wrong in its world: by its parameters and by commands.

use geometry::LatLon;
use mavlink::dialects::ardupilotmega::*;
use sim::Mode;

/// What is to become of its world.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Wish {
    /// A wind, m/s.
    Wind {
        /// Eastward.
        east_mps: f64,
        /// Northward.
        north_mps: f64,
    },
    /// A flight mode, as by the pilot's switch.
    Mode(Mode),
    /// Whether satellites are there.
    Gps(bool),
    /// Whether the engine gives what it is asked for.
    Engine(bool),
    /// Whether it has its full power; if not, too little for the altitude or the speed.
    Power(bool),
    /// What an earlier flight has done to the engine is over, as far as that can be told.
    EngineAsNew,
    /// How much the battery has left, percent.
    Battery(f32),
    /// A fence of the autopilot's own, so many metres around home, behind which it returns; `None`: no more.
    Fence(Option<f64>),
    /// A list that leads round a place takes the place of the one aboard.
    List(LatLon),
    /// That list is flown from its first waypoint on.
    FlyList,
}

/// What it is told for that.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// A parameter, and its value as it stands in the message.
    Set(&'static str, f32, MavParamType),
    /// A command, and its first parameters.
    Do(MavCmd, [f32; 3]),
    /// A list around a place; whether its first item stands for home.
    Upload(LatLon, bool),
}

/// Autopilots whose simulations are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simulation {
    /// ArduPlane's (SITL): the `SIM_` parameters of libraries/SITL/SITL.cpp.
    ArduPlane,
    /// PX4's own (SIH): src/modules/simulation.
    Px4,
}

impl Simulation {
    /// That of an autopilot by what its heartbeat says.
    pub fn of(heartbeat: &HEARTBEAT_DATA) -> Option<Self> {
        match heartbeat.autopilot {
            MavAutopilot::MAV_AUTOPILOT_ARDUPILOTMEGA => Some(Self::ArduPlane),
            MavAutopilot::MAV_AUTOPILOT_PX4 => Some(Self::Px4),
            _ => None,
        }
    }

    /// What it is told for a wish; `None`: it can't be had from this one.
    pub fn orders(self, wish: Wish) -> Option<Vec<Order>> {
        match self {
            Self::ArduPlane => arduplane(wish),
            Self::Px4 => px4(wish),
        }
    }
}

/// A parameter that is a real number.
fn real(name: &'static str, value: f64) -> Order {
    Order::Set(name, value as f32, MavParamType::MAV_PARAM_TYPE_REAL32)
}

/// PX4 takes the bits of a whole number for it.
fn bits(name: &'static str, value: i32) -> Order {
    Order::Set(name, f32::from_bits(value.cast_unsigned()), MavParamType::MAV_PARAM_TYPE_INT32)
}

/// The first parameter says that the numbers of the mode are the autopilot's own.
fn mode(main: u8, sub: u8) -> Order {
    Order::Do(MavCmd::MAV_CMD_DO_SET_MODE, [1.0, main.into(), sub.into()])
}

fn arduplane(wish: Wish) -> Option<Vec<Order>> {
    Some(match wish {
        Wish::Wind { east_mps, north_mps } => {
            let from_deg = (-east_mps).atan2(-north_mps).to_degrees().rem_euclid(360.0);
            vec![real("SIM_WIND_DIR", from_deg), real("SIM_WIND_SPD", east_mps.hypot(north_mps))]
        }
        Wish::Mode(Mode::Auto) => vec![mode(10, 0)],
        Wish::Mode(Mode::ReturnToLaunch) => vec![mode(11, 0)],
        Wish::Mode(Mode::Loiter) => vec![mode(12, 0)],
        Wish::Mode(_) => return None,
        Wish::Gps(is_there) => vec![real("SIM_GPS1_ENABLE", f64::from(u8::from(is_there)))],
        // a mask of servos; the throttle is the third one. SIM_ENGINE_MUL, by which it is multiplied, is 0 by default
        Wish::Engine(false) => vec![real("SIM_ENGINE_FAIL", 4.0)],
        Wish::Engine(true) | Wish::EngineAsNew => vec![real("SIM_ENGINE_FAIL", 0.0)],
        Wish::Power(full) => vec![real("THR_MAX", if full { 100.0 } else { 25.0 })],
        // the first battery
        Wish::Battery(percent) => vec![Order::Do(MavCmd::MAV_CMD_BATTERY_RESET, [1.0, percent, 0.0])],
        // a circle, and a return; the radius is not taken away with it
        Wish::Fence(Some(radius_m)) => vec![
            real("FENCE_TYPE", 2.0),
            real("FENCE_ACTION", 1.0),
            real("FENCE_RADIUS", radius_m),
            real("FENCE_ENABLE", 1.0),
        ],
        Wish::Fence(None) => vec![real("FENCE_ENABLE", 0.0)],
        Wish::List(around) => vec![Order::Upload(around, true)],
        Wish::FlyList => vec![Order::Do(MavCmd::MAV_CMD_DO_SET_MISSION_CURRENT, [1.0, 0.0, 0.0])],
    })
}

fn px4(wish: Wish) -> Option<Vec<Order>> {
    Some(match wish {
        // it adds them to the velocity over ground: they are where the wind comes from
        Wish::Wind { east_mps, north_mps } => {
            vec![real("SIH_WIND_N", -north_mps), real("SIH_WIND_E", -east_mps)]
        }
        Wish::Mode(Mode::Loiter) => vec![mode(4, 3)],
        Wish::Mode(Mode::Auto) => vec![mode(4, 4)],
        Wish::Mode(Mode::ReturnToLaunch) => vec![mode(4, 5)],
        Wish::Mode(_) => return None,
        Wish::Gps(is_there) => vec![bits("SIM_GPS_USED", if is_there { 10 } else { 0 })],
        // how strong it was is not known: whoever has stopped it starts the autopilot anew
        Wish::Engine(true) => return None,
        Wish::EngineAsNew => vec![],
        Wish::Engine(false) => vec![real("SIH_F_T_MAX", 0.0)],
        Wish::Power(full) => vec![real("FW_THR_MAX", if full { 1.0 } else { 0.4 })],
        // it runs down to this within the first minute of the flight
        Wish::Battery(percent) => vec![real("SIM_BAT_MIN_PCT", percent.into())],
        // 3: it returns
        Wish::Fence(Some(radius_m)) => vec![bits("GF_ACTION", 3), real("GF_MAX_HOR_DIST", radius_m)],
        Wish::Fence(None) => vec![real("GF_MAX_HOR_DIST", 0.0)],
        Wish::List(around) => vec![Order::Upload(around, false)],
        Wish::FlyList => vec![Order::Do(MavCmd::MAV_CMD_MISSION_START, [0.0; 3])],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(simulation: Simulation, wish: Wish) -> Vec<(&'static str, f32)> {
        let orders = simulation.orders(wish).unwrap();
        orders
            .into_iter()
            .map(|order| match order {
                Order::Set(name, value, _) => (name, value),
                Order::Do(..) | Order::Upload(..) => panic!("{order:?}"),
            })
            .collect()
    }

    #[test]
    fn wind_from_the_west_is_told_as_each_simulation_understands_it() {
        let west = Wish::Wind { east_mps: 5.0, north_mps: 0.0 };
        assert_eq!(told(Simulation::ArduPlane, west), [("SIM_WIND_DIR", 270.0), ("SIM_WIND_SPD", 5.0)]);
        assert_eq!(told(Simulation::Px4, west), [("SIH_WIND_N", 0.0), ("SIH_WIND_E", -5.0)]);
    }

    #[test]
    fn whole_numbers_go_to_px4_as_their_bits() {
        let lost = Simulation::Px4.orders(Wish::Gps(true)).unwrap();
        let [Order::Set(_, value, MavParamType::MAV_PARAM_TYPE_INT32)] = lost[..] else { panic!("{lost:?}") };
        assert_eq!(value.to_bits(), 10);
    }

    #[test]
    fn an_engine_that_cannot_be_started_again_is_refused_and_not_passed_over() {
        assert_eq!(Simulation::Px4.orders(Wish::Engine(true)), None);
        assert_eq!(Simulation::Px4.orders(Wish::EngineAsNew), Some(vec![]), "each flight begins so");
        for wish in [Wish::Engine(true), Wish::EngineAsNew] {
            assert_eq!(told(Simulation::ArduPlane, wish), [("SIM_ENGINE_FAIL", 0.0)]);
        }
    }

    #[test]
    fn what_a_pilot_does_in_the_programme_is_known_to_both() {
        for simulation in [Simulation::ArduPlane, Simulation::Px4] {
            let mut orders = vec![];
            for mode in [Mode::Auto, Mode::Loiter, Mode::ReturnToLaunch] {
                orders.extend(simulation.orders(Wish::Mode(mode)).unwrap());
            }
            assert_eq!(orders.len(), 3);
            assert_eq!(simulation.orders(Wish::Mode(Mode::Manual)), None);
        }
    }
}
