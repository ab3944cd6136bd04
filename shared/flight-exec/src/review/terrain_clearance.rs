//! `below-terrain`: the path goes into the ground; `low-clearance`: it comes nearer than the margin, away from runways.

use super::View;
use super::flown::{Flown, Point};
use super::other_ways::{OtherWay, OtherWays};
use flight_plan::{Edit, Id, Problem, StageKind};
use std::collections::HashMap;

pub(super) fn check(view: &View, problems: &mut Vec<Problem>) {
    let mut lowest: HashMap<&Id, Lowest> = HashMap::new();
    let mut order = Vec::new();
    for flown in view.flights.all() {
        track(view, flown, &mut lowest, &mut order);
    }
    let ways = OtherWays::of(view);
    for leg in order {
        problems.extend(lowest.get(leg).and_then(|lowest| problem(view, leg, lowest, ways.as_ref())));
    }
}

/// Where a leg is nearest to the ground.
struct Lowest<'a> {
    clearance_m: f64,
    point: Point,
    /// The altitude that the leg asks for there, metres AMSL.
    wanted_amsl_m: f64,
    /// The ground's elevation is known there.
    known: bool,
    /// What is flown before the leg, and the altitude with which that ends, metres AMSL.
    before: Option<(&'a Id, f64)>,
    /// By how much the leg has to be raised so that all of it is high enough, on every way to it, metres; negative: it is.
    lift_m: f64,
    /// What has to begin higher: the legs before it, the altitudes with which they end, metres AMSL, and by how much, metres.
    begins: Vec<(&'a Id, f64, f64)>,
}

/// A leg is not raised by more than so many times what lacks.
const MOST_OF_LACK: f64 = 4.0;

impl<'a> Lowest<'a> {
    /// What has to begin higher, and by how much (metres), where the leg itself is high enough and only still climbing: between
    /// two waypoints the altitude changes evenly.
    fn begins_too_low(&self, margin_m: f64) -> Option<(&'a Id, f64, f64)> {
        let below_m = self.wanted_amsl_m - self.point.altitude_amsl_m;
        let lacks_m = margin_m - self.clearance_m;
        let (before, ends_amsl_m) = self.before?;
        let rise_m = self.wanted_amsl_m - ends_amsl_m;
        (below_m >= lacks_m && rise_m > 0.0).then(|| {
            let by_m = (lacks_m * (rise_m / below_m).max(1.0)).min(rise_m);
            (before, ends_amsl_m, by_m)
        })
    }

    /// Takes in another place of the leg: the lower one is told, and both are lifted.
    fn with(&mut self, mut other: Self) {
        if other.clearance_m < self.clearance_m {
            std::mem::swap(self, &mut other);
        }
        self.lift_m = self.lift_m.max(other.lift_m);
        for begins in other.begins {
            match self
                .begins
                .iter_mut()
                .find(|(before, ends_m, _)| (*before, *ends_m) == (begins.0, begins.1))
            {
                Some((_, _, by_m)) => *by_m = by_m.max(begins.2),
                None => self.begins.push(begins),
            }
        }
    }

    /// The edit after which no place of the leg is too low.
    fn lifted(&self, view: &View, leg: &Id) -> Option<Edit> {
        let begins =
            self.begins.iter().map(|(before, ends_amsl_m, by_m)| view.raised(before, *ends_amsl_m, *by_m));
        let lift = (self.lift_m > 0.0).then(|| view.raised(leg, self.wanted_amsl_m, self.lift_m));
        let mut edits: Vec<Edit> = begins.chain(lift).collect::<Option<_>>()?;
        if edits.len() > 1 { Some(Edit::All(edits)) } else { edits.pop() }
    }
}

fn track<'a>(
    view: &View,
    flown: &'a Flown,
    lowest: &mut HashMap<&'a Id, Lowest<'a>>,
    order: &mut Vec<&'a Id>,
) {
    let margin_m = view.conditions.margins.terrain_m;
    for point in flown.points.iter().filter(|p| !flown.enters(p)) {
        let Some((clearance_m, known)) = clearance_m(view, point) else { continue };
        let Some(leg) = flown.leg(point) else { continue };
        let wanted_amsl_m = flown.wanted_amsl_m(point).unwrap_or(point.altitude_amsl_m);
        let before = flown.before(point);
        let (lift_m, begins) = (f64::NEG_INFINITY, Vec::new());
        let mut here = Lowest { clearance_m, point: *point, wanted_amsl_m, known, before, lift_m, begins };
        if is_too_low(view, leg, clearance_m) {
            match here.begins_too_low(margin_m) {
                Some(begins) => here.begins.push(begins),
                None => {
                    let share = flown.share_of_leg(point).max(1.0 / MOST_OF_LACK);
                    here.lift_m = (margin_m - clearance_m) / share;
                }
            }
        }
        match lowest.get_mut(leg) {
            None => {
                order.push(leg);
                lowest.insert(leg, here);
            }
            Some(known) => known.with(here),
        }
    }
}

/// For a departure and an approach the ground is low enough.
fn is_too_low(view: &View, leg: &Id, clearance_m: f64) -> bool {
    let near_runway = matches!(view.stage_kind(leg), Some(StageKind::Departure | StageKind::Approach));
    clearance_m < if near_runway { 0.0 } else { view.conditions.margins.terrain_m }
}

/// The height above the ground, metres, and whether that is known there: where it is not, all that can be said is that it lies
/// above whoever is below the sea and every runway.
fn clearance_m(view: &View, point: &Point) -> Option<(f64, bool)> {
    if let Some(ground_m) = view.terrain.elevation_m(point.position) {
        return Some((point.altitude_amsl_m - ground_m, true));
    }
    let clearance_m = point.altitude_amsl_m - view.program.flown().lowest_ground_amsl_m();
    (clearance_m < 0.0).then_some((clearance_m, false))
}

fn problem(view: &View, leg: &Id, lowest: &Lowest, ways: Option<&OtherWays>) -> Option<Problem> {
    let Lowest { clearance_m, point, known, .. } = *lowest;
    let kind = view.stage_kind(leg)?;
    // the autopilot performs these, on the runway's elevation and not the terrain's
    if matches!(kind, StageKind::TakeOff | StageKind::Land) || !is_too_low(view, leg, clearance_m) {
        return None;
    }
    let margin_m = view.conditions.margins.terrain_m;
    let (lat, lon) = (point.position.lat_deg, point.position.lon_deg);
    let fix = lowest.lifted(view, leg);
    let advice = match lowest.begins_too_low(margin_m) {
        Some((before, _, by_m)) => format!(
            "raise `{before}` by {:.0} m, or hold to climb (HA) behind it, because this leg is still climbing there",
            by_m.ceil()
        ),
        None => format!("raise this leg by {:.0} m", lowest.lift_m.ceil()),
    };
    let way = ways.and_then(|ways| ways.to(leg, lowest.before.map(|(before, _)| before)));
    let spot = way.as_ref().map_or_else(|| point.position.into(), |way| way.spot(point.position));
    let advice = advice + &way.as_ref().map(OtherWay::told).unwrap_or_default();
    if clearance_m < 0.0 {
        let message = if known {
            format!("it goes into the ground at {lat:.5}, {lon:.5}: {advice}")
        } else {
            format!(
                "{advice}: at {lat:.5}, {lon:.5}, where no elevation is known, it leads {:.0} m below the sea and the plan's lowest runway; if the ground is that low, load its elevations",
                -clearance_m
            )
        };
        return Some(Problem::error("below-terrain", message).of(leg).with_place(spot).perhaps_fixed_by(fix));
    }
    let message = format!(
        "{advice}: as flown, it passes {:.0} m above the ground. That is at {lat:.5}, {lon:.5}; {margin_m:.0} m above it is the least of a path as flown",
        clearance_m.floor()
    );
    Some(Problem::warning("low-clearance", message).of(leg).with_place(spot).perhaps_fixed_by(fix))
}
