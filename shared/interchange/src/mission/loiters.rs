//! Circles and waits.

use super::commands as cmd;
use super::import::Importer;
use super::placed::{place, waypoint};
use super::runways::SAME_M;
use super::{Item, placed::Placed};
use flight_plan::{Act, Altitude, Holding, HoldingLength, LegKind, TurnDirection, Value};
use geometry::LatLon;

/// Straight legs of the racetrack that replaces an endless circle, metres.
const RACETRACK_M: f64 = 500.0;

impl Importer<'_> {
    pub(super) fn loiter(&mut self, item: &Item) {
        let Some(position) = item.position().or(self.here()) else {
            let message = "a loiter on the spot is left out: the file doesn't say where that is";
            return self.notes.push("no-position", &item.place, message);
        };
        if item.position().is_none() && self.legs.is_empty() {
            let message = "a loiter on the spot before any place is put at home";
            self.notes.push("loiter-place", &item.place, message);
        }
        let signed_m = match item.command {
            cmd::LOITER_TO_ALTITUDE => item.param(2),
            _ => item.param(3),
        };
        let turn = if signed_m < 0.0 { TurnDirection::Left } else { TurnDirection::Right };
        let altitude = self.loiter_altitude(item);
        match item.command {
            cmd::LOITER_TURNS => self.orbit(item, altitude, position, signed_m, turn),
            cmd::LOITER_TIME => self.timed(item, altitude, position, signed_m, turn),
            cmd::LOITER_TO_ALTITUDE => {
                self.hold_until_level(item, altitude, racetrack(position, turn, signed_m.abs()))
            }
            _ => {
                let holding = racetrack(position, turn, signed_m.abs());
                self.push_at(item, altitude, LegKind::Hm { holding, until: None, max_laps: None });
                self.notes.again(
                    "loiter-as-racetrack",
                    &item.place,
                    "an endless circle becomes a holding until released (HM)",
                );
            }
        }
        self.arrive(Some(position));
    }

    /// ArduPilot takes a height of 0 as the present one: there is no altitude of its own then, and that of the leg before counts.
    fn loiter_altitude(&mut self, item: &Item) -> Option<Altitude> {
        if item.param(7) == 0.0 && (item.position().is_none() || cmd::counts_from_below(item.frame)) {
            self.notes.again(
                "loiter-altitude",
                &item.place,
                "a loiter at a height of 0 m keeps the altitude of the leg before, as ArduPilot flies it",
            );
            return None;
        }
        self.altitude(item)
    }

    /// Such a holding names its altitude, if it is the present one too.
    fn hold_until_level(&mut self, item: &Item, altitude: Option<Altitude>, holding: Holding) {
        let altitude = altitude.or_else(|| self.level.clone());
        self.push_at(item, altitude, LegKind::Ha(holding));
        self.notes.again(
            "loiter-as-racetrack",
            &item.place,
            "a circle to an altitude becomes a holding to that altitude (HA)",
        );
    }

    /// On the spot there is no track to fly: the leg before waits at its end, or a holding first leads to another altitude.
    fn timed(
        &mut self,
        item: &Item,
        altitude: Option<Altitude>,
        position: LatLon,
        signed_m: f64,
        turn: TurnDirection,
    ) {
        let before = self.legs.last();
        let stays = before.is_some() && self.last.is_some_and(|l| l.distance_m(position) < SAME_M);
        let level = altitude.is_none() || before.is_some_and(|l| l.leg.altitude == altitude);
        if stays && level && before.is_some_and(can_wait) {
            self.flush_at_end();
        } else if stays {
            self.hold_until_level(item, altitude, racetrack(position, turn, signed_m.abs()));
        } else {
            self.push_at(item, altitude, LegKind::Tf(waypoint(position, false)));
        }
        // no time is none to wait
        let seconds = if item.param(1).is_finite() { item.param(1).clamp(0.0, 1e6) } else { 0.0 };
        self.wait(item, seconds);
        self.radius_lost(item, signed_m);
    }

    fn orbit(
        &mut self,
        item: &Item,
        altitude: Option<Altitude>,
        centre: LatLon,
        signed_m: f64,
        turn: TurnDirection,
    ) {
        let radius_m = match signed_m.abs() {
            radius_m if radius_m > 0.0 => radius_m,
            _ => {
                let radius_m = self.assumptions.loiter_radius_m;
                self.notes.again(
                    "loiter-radius",
                    &item.place,
                    &format!("a circle without a radius gets {radius_m:.0} m"),
                );
                radius_m
            }
        };
        let turns = item.param(1);
        let turns = if turns.is_finite() { turns.clamp(0.25, 1e6) } else { 1.0 };
        let (radius_m, turns) = (Value::Constant(radius_m), Value::Constant(turns));
        self.push_at(item, altitude, LegKind::Orbit { centre: place(centre), radius_m, turns, turn });
    }

    fn radius_lost(&mut self, item: &Item, signed_m: f64) {
        if signed_m != 0.0 && signed_m.is_finite() {
            self.notes.again(
                "loiter-radius",
                &item.place,
                "the radius of a timed circle is left out: the aircraft's own counts",
            );
        }
    }

    pub(super) fn delay(&mut self, item: &Item) {
        let seconds = item.param(1);
        if seconds > 0.0 && self.legs.last().is_some_and(can_wait) {
            self.wait(item, seconds);
        } else {
            self.not_carried(item);
        }
    }

    /// Waits at the end of the last leg, which the item belongs to from now on: a jump to it leads into the leg's middle.
    fn wait(&mut self, item: &Item, seconds: f64) {
        self.at_end(Act::Wait { seconds: Value::Constant(seconds) });
        if let Some(last) = self.legs.last_mut() {
            last.last = last.last.max(item.number);
        }
    }
}

/// A leg, not a loop, can wait at its end.
fn can_wait(before: &Placed) -> bool {
    !matches!(before.leg.kind, LegKind::Iterative { .. })
}

pub(super) fn racetrack(position: LatLon, turn: TurnDirection, radius_m: f64) -> Holding {
    let length_m = if radius_m > 0.0 { radius_m.min(1e5) } else { RACETRACK_M };
    Holding {
        fix: waypoint(position, false),
        inbound_course_deg: None,
        turn,
        leg: HoldingLength::Distance(Value::Constant(length_m)),
    }
}
