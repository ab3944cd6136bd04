//! Whether a mission can be flown, by PX4's rules for fixed wings. One that can't is taken and kept, but not flown.

use super::params::{LANDING_ANGLE_DEG, REQUIRED_ITEMS};
use crate::core::autopilot::Autopilot;
use crate::core::item::{Item, Kind};
use mavlink::dialects::ardupilotmega::MavCmd;

/// What is wrong with the mission, in words; `None`: it can be flown.
pub fn problem(a: &Autopilot, items: &[Item], is_vtol: bool) -> Option<&'static str> {
    if items.is_empty() {
        return Some("there is no mission");
    }
    if a.fence.is_broken() {
        return Some("the fence is broken");
    }
    if !is_vtol && items.iter().any(is_for_vtol) {
        return Some("it has items for a VTOL");
    }
    required(a, items).or_else(|| take_off(a, items)).or_else(|| landing(a, items)).or_else(|| loops(items))
}

fn is_for_vtol(item: &Item) -> bool {
    matches!(item.wire.command, MavCmd::MAV_CMD_NAV_VTOL_TAKEOFF | MavCmd::MAV_CMD_NAV_VTOL_LAND)
}

fn required(a: &Autopilot, items: &[Item]) -> Option<&'static str> {
    let has_take_off = items.iter().any(|i| i.kind == Kind::TakeOff);
    let has_landing = items.iter().any(|i| i.kind == Kind::Land);
    match a.params.value(REQUIRED_ITEMS) as u8 {
        1 if !has_take_off => Some("the mission needs a take-off"),
        2 if !has_landing => Some("the mission needs a landing"),
        3 if !(has_take_off && has_landing) => Some("the mission needs take-off and landing"),
        4 | 5 if has_take_off != has_landing => Some("the mission has half of take-off and landing"),
        _ => None,
    }
}

fn take_off(a: &Autopilot, items: &[Item]) -> Option<&'static str> {
    let places = items.iter().filter(|i| i.kind.has_position());
    let too_low = |i: &Item| i.kind == Kind::TakeOff && amsl_m(a, i) <= a.home.altitude_amsl_m;
    if items.iter().any(too_low) {
        return Some("its take-off ends below home");
    }
    let is_late = places.skip(1).any(|i| i.kind == Kind::TakeOff);
    is_late.then_some("the take-off is not first")
}

fn landing(a: &Autopilot, items: &[Item]) -> Option<&'static str> {
    if items.first().is_some_and(|i| i.kind == Kind::Land) {
        return Some("the mission begins with its landing");
    }
    let land_starts = items.iter().filter(|i| i.kind == Kind::LandStart).count();
    let last_land = items.iter().rposition(|i| i.kind == Kind::Land);
    let last_start = items.iter().rposition(|i| i.kind == Kind::LandStart);
    if land_starts > 1 {
        return Some("the mission has two land starts");
    }
    if last_start.is_some() && last_start > last_land {
        return Some("no landing follows the land start");
    }
    items.windows(2).find_map(|pair| match pair {
        [before, land] if land.kind == Kind::Land && before.is_navigation() => approach(a, before, land),
        _ => None,
    })
}

/// The real one hangs for ever on it, when it reckons how long the way home is.
fn loops(items: &[Item]) -> Option<&'static str> {
    let land = items.iter().position(|i| i.kind == Kind::Land)?;
    let back = |i: &Item| matches!(i.kind, Kind::Jump { to, .. } if usize::from(to) <= land);
    items.iter().skip(land).any(back).then_some("a jump leads back from behind the landing")
}

fn approach(a: &Autopilot, before: &Item, land: &Item) -> Option<&'static str> {
    let height_m = amsl_m(a, before) - amsl_m(a, land);
    let length_m = before.position.distance_m(land.position);
    let steepest = (a.params.value(LANDING_ANGLE_DEG) + 0.1).to_radians().tan();
    match before.kind {
        Kind::Waypoint { .. } if height_m <= 0.0 => Some("the approach begins below the landing"),
        Kind::Waypoint { .. } if height_m > steepest * length_m => Some("the approach is too steep"),
        Kind::Waypoint { .. } => None,
        _ => Some("no waypoint leads to the landing"),
    }
}

fn amsl_m(a: &Autopilot, item: &Item) -> f64 {
    a.amsl_m(item.altitude_m, item.datum)
}
