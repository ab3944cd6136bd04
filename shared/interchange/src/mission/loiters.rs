//! Circles and waits.

use super::commands as cmd;
use super::import::Importer;
use super::placed::{self, Placed, place, waypoint};
use super::runways::SAME_M;
use super::{Item, jumps};
use flight_plan::{Act, Altitude, Holding, HoldingLength, Leg, LegKind, TurnDirection, Value};
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
            _ if signed_m != 0.0 && signed_m.is_finite() => {
                self.circle(item, altitude, position, signed_m.abs(), turn)
            }
            _ => {
                let holding = racetrack(position, turn, signed_m.abs());
                self.push_at(
                    item,
                    altitude,
                    LegKind::Hm { holding, until: Some(jumps::ENOUGH.into()), max_laps: None },
                );
                let message = format!(
                    "an endless circle without a radius becomes a holding (HM) until released, or until `{}`",
                    jumps::ENOUGH
                );
                self.notes.again("loiter-as-racetrack", &item.place, &message);
            }
        }
        self.arrive(Some(position));
    }

    /// A holding would have the aircraft's own radius: a loop of single turns keeps that of the circle.
    fn circle(
        &mut self,
        item: &Item,
        altitude: Option<Altitude>,
        centre: LatLon,
        radius_m: f64,
        turn: TurnDirection,
    ) {
        let (radius_m, turns) = (Value::Constant(radius_m), Value::Constant(1.0));
        self.push_at(item, altitude, LegKind::Orbit { centre: place(centre), radius_m, turns, turn });
        if let Some(Placed { leg: mut circle, first, last, .. }) = self.legs.pop() {
            let id = self.names.take(&format!("circle{}", item.number), "circle");
            // once, not in each turn
            let actions = std::mem::take(&mut circle.actions);
            let leg = Leg { actions, ..placed::leg(id, jumps::repeated(vec![circle], None)) };
            self.legs.push(Placed { leg, first, last, depth: 1 });
        }
        let message = format!(
            "an endless circle becomes a loop of single turns until `{}`: what the energy allows; change its condition, or end it with the command skip leg",
            jumps::ENOUGH
        );
        self.notes.again("endless-circle", &item.place, &message);
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

    /// The leg before ends here: there is no track to fly.
    pub(super) fn is_at(&self, position: LatLon) -> bool {
        let at_its_place = |placed: &Placed| {
            let last = last_flown(&placed.leg);
            matches!(last.kind, LegKind::Tf(_) | LegKind::Df { .. } | LegKind::Ha(_) | LegKind::Hm { .. })
        };
        self.last.is_some_and(|last| last.distance_m(position) < SAME_M)
            && self.legs.last().is_some_and(at_its_place)
    }

    /// A waypoint where the aircraft is becomes part of the leg before, or a holding to its altitude. False: neither is possible.
    pub(super) fn merge(&mut self, item: &Item) -> bool {
        let Some(before) = self.legs.last() else { return false };
        let (is_leg, number) = (can_wait(before), item.number);
        if !is_leg && item.param(1) > 0.0 {
            return false;
        }
        let altitude = self.altitude(item);
        if altitude.is_some() && altitude != self.level {
            let message = "a waypoint above or below the one before becomes a holding to its altitude (HA)";
            self.notes.again("climb-on-the-spot", &item.place, message);
            if let Some(position) = item.position() {
                self.push_at(item, altitude, LegKind::Ha(racetrack(position, TurnDirection::Right, 0.0)));
            }
        } else {
            let message = "a waypoint where the one before is becomes one with it";
            self.notes.again("duplicate-waypoint", &item.place, message);
            if is_leg {
                self.flush_at_end();
            }
        }
        if item.param(1) > 0.0 {
            self.at_end(Act::Wait { seconds: Value::Constant(item.param(1)) });
        }
        // a jump to either of them leads to the same leg
        if let Some(placed) = self.legs.last_mut().filter(|_| is_leg) {
            (placed.first, placed.last) = (number, placed.last.max(number));
        }
        true
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

fn last_flown(leg: &Leg) -> &Leg {
    leg.body().last().map_or(leg, |last| last_flown(last))
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
