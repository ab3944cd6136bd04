//! The landing that ends a list, and one that is left.
//!
//! PX4 judges a landing by the entry before it, and takes no list in which that is steeper than it is set to. A glide may need more height
//! where its final begins, and nothing is to be told lower than it was fed for that: so a waypoint of its own, close in on the line between
//! the two, stands before such a landing. It has the landing's number.

use super::{Window, ring};
use crate::gateway::driver::mavlink::item::{Item, ItemKind};
use crate::gateway::order::{Fed, Fix};
use geometry::near::distance_m;
use geometry::{LatLon, LocalFrame, Vec2};
use usal::contract::{Action, Waypoint};

/// How steep a landing may be as PX4 comes, degrees above the place of the touch-down, and the least and the most that it can be set to.
const USUAL_DEG: f64 = 5.0;
const LEAST_DEG: f64 = 1.0;
const MOST_DEG: f64 = 45.0;
/// What stands before a landing by itself is so steep, as a share of the steepest, and never more than that.
const EASY: f64 = 0.6;
const EASY_DEG: f64 = 3.0;
/// What stands before a landing that is come to more steeply is so far before it, metres, and no farther than this share of the way to it.
const CLOSE_M: f64 = 60.0;
const CLOSE_SHARE: f64 = 0.5;

/// How steep a landing may be in a list: PX4 refuses one that is steeper, degrees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Steepest(f64);

impl Default for Steepest {
    /// As PX4 comes.
    fn default() -> Self {
        Self(USUAL_DEG)
    }
}

impl Steepest {
    /// As it is set, if it tells that.
    pub(super) fn told(degrees: Option<f64>) -> Self {
        let degrees = degrees.filter(|degrees| degrees.is_finite());
        degrees.map_or_else(Self::default, |degrees| Self(degrees.clamp(LEAST_DEG, MOST_DEG)))
    }

    /// The waypoints, with one more before each landing that PX4 would find too steep; `before`: what comes before the first of them.
    pub(super) fn with_close_ins(self, mut before: Option<Item>, waypoints: Vec<Fed>) -> Vec<Fed> {
        let with_its_own = |fed: Fed| {
            let from = before.replace(Item::of(&fed.waypoint));
            [from.and_then(|from| self.close_in(&from, &fed)), Some(fed)].into_iter().flatten()
        };
        waypoints.into_iter().flat_map(with_its_own).collect()
    }

    fn close_in(self, from: &Item, landing: &Fed) -> Option<Fed> {
        let Waypoint { position, altitude_amsl_m, .. } = landing.waypoint;
        let way_m = distance_m(from.position, position);
        let is_steep = from.altitude_amsl_m - altitude_amsl_m > way_m * self.0.to_radians().tan();
        let is_landing = matches!(landing.waypoint.action, Action::Land { .. });
        let is_flown = matches!(from.kind, ItemKind::Fly(_));
        (is_landing && is_flown && is_steep && way_m > 0.0).then(|| {
            let close_m = CLOSE_M.min(CLOSE_SHARE * way_m);
            let (position, height_m) = self.before_landing(position, from.position, close_m);
            let waypoint = Waypoint {
                position,
                altitude_amsl_m: altitude_amsl_m + height_m,
                action: Action::Fly,
                end_of_plan: false,
                ..landing.waypoint.clone()
            };
            Fed { waypoint, ..*landing }
        })
    }

    /// A place so many metres before a landing, as seen from another, and its height above that.
    fn before_landing(self, landing: LatLon, from: LatLon, metres: f64) -> (LatLon, f64) {
        let height_m = metres * (EASY * self.0).min(EASY_DEG).to_radians().tan();
        (landing.destination(landing.bearing_deg(from), metres), height_m)
    }
}

/// What leads on to another place lies behind an aircraft that is on that side of it, and flies away from it. One that comes from elsewhere,
/// and still turns towards it, may have its back to it.
fn lies_behind(fix: &Fix, place: LatLon, onward: LatLon) -> bool {
    let frame = LocalFrame::new(fix.position);
    let to_place = frame.to_local(place);
    let flies_away = to_place.dot(Vec2::new(fix.east_mps, fix.north_mps)) < 0.0;
    flies_away && to_place.dot(frame.to_local(onward) - to_place) < 0.0
}

impl Window {
    /// A landing that is left for something else does not end the list, and is not flown any more. What led to it stands in its place:
    /// if the same landing comes next, PX4 wants to see that it is come to from above.
    pub(super) fn instead_of_landing(&self, position: u64, landing: Item) -> Item {
        let before = self.chain.before(position).filter(|item| item.kind != ItemKind::Land);
        ring::passing(before.unwrap_or(landing))
    }

    /// What a landing that is flown to at once comes from: where the aircraft is. PX4 judges by it whether that is too steep or begins too
    /// low, and then flies no list at all.
    pub(super) fn comes_from(&self, landing: u64) -> Option<Item> {
        let first = self.chain.first();
        let is_next = landing == first || (landing == first + 1 && self.chain.is_left_behind(first));
        let at = self.chain.at(landing).filter(|at| is_next && matches!(at.action, Action::Land { .. }))?;
        let from = self.fix.map(|fix| fix.position).or_else(|| Some(self.chain.before(landing)?.position))?;
        let (position, height_m) =
            self.steepest.before_landing(at.position, from, distance_m(from, at.position).max(CLOSE_M));
        Some(Item { position, altitude_amsl_m: at.altitude_amsl_m + height_m, ..ring::passing(Item::of(at)) })
    }

    /// What leads to a landing lies behind the aircraft, which had another height there than PX4 wants, and circles for it: nobody turns
    /// round for it close in, nor for one that it is below. Without an engine it would circle until it is down.
    pub(super) fn leave_behind_what_leads_in(&mut self, fix: &Fix) {
        let first = self.chain.first();
        let lands =
            |position| self.chain.at(position).is_some_and(|w| matches!(w.action, Action::Land { .. }));
        let is_close_in = |position| self.chain.is_one(position) && lands(position + 1);
        let leads_in = lands(first + 1) || is_close_in(first + 1);
        let Some(active) = self.chain.at(first).filter(|w| leads_in && w.action == Action::Fly) else {
            return;
        };
        let onward = self.chain.at(first + 1).map_or(active.position, |next| next.position);
        if lies_behind(fix, active.position, onward)
            && (is_close_in(first) || fix.altitude_amsl_m < active.altitude_amsl_m)
        {
            self.chain.skip_active();
        }
    }

    /// It is to land at a position, and nothing comes behind that.
    pub(super) fn ends_at(&self, position: u64) -> bool {
        let is_left = position == self.chain.first() && self.chain.jump().is_some();
        !is_left && self.chain.at(position).is_some_and(|w| matches!(w.action, Action::Land { .. }))
    }

    /// The landing that is to be on board.
    pub(super) fn landing(&self) -> Option<u64> {
        (self.chain.first()..self.end).find(|p| self.ends_at(*p))
    }
}
