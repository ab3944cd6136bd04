//! The waypoints that are still to be flown, as the core knows them.

use crate::gateway::order::{Course, Fed, Order, Serial, Target};
use geometry::LatLon;
use std::collections::VecDeque;
use usal::contract::{Action, Token, Waypoint};

/// The buffer never holds more waypoints.
pub const CAPACITY: usize = 256;

/// The buffer: the waypoint steered to first, and those after it.
#[derive(Debug, Clone, Default)]
pub struct Buffer {
    waypoints: VecDeque<Fed>,
    /// Steered to although it was cancelled, is being left, or was never fed.
    stray: Option<Fed>,
    /// Where the way to the waypoint steered to begins: at the one before, or where the aircraft was sent elsewhere.
    passed: Option<LatLon>,
    /// The last number that was given.
    numbered: Serial,
    /// What the driver said last.
    course: Course,
}

impl Buffer {
    /// What the driver says of the waypoints.
    pub fn course(&self) -> Course {
        self.course
    }

    /// Nothing left to fly.
    pub fn is_empty(&self) -> bool {
        self.waypoints.is_empty() && self.stray.is_none()
    }

    /// How many more waypoints can be taken, after cancelling.
    pub fn room(&self, cancel_after: Option<Token>) -> usize {
        let all = self.waypoints.len() + usize::from(self.stray.is_some());
        let kept = match cancel_after {
            Some(token) => self.waypoints().filter(|w| w.token <= token).count() + 1,
            None => all,
        };
        CAPACITY.saturating_sub(kept)
    }

    /// Waypoints in the buffer, without one that is being left.
    pub fn waypoints(&self) -> impl DoubleEndedIterator<Item = &Waypoint> {
        self.waypoints.iter().map(|f| &f.waypoint)
    }

    /// The waypoint being steered to; `None` behind the last, and while it is not certain.
    pub fn current(&self) -> Option<&Waypoint> {
        let stray = self.stray.as_ref();
        let fed = match self.course.target {
            Target::Waypoint(serial) => {
                stray.into_iter().chain(self.waypoints.front()).find(|f| f.serial == serial)
            }
            Target::Elsewhere { .. } => stray,
            Target::None | Target::Unknown { .. } | Target::End => None,
        };
        fed.map(|f| &f.waypoint)
    }

    /// The one after it.
    pub fn next(&self) -> Option<&Waypoint> {
        self.waypoints().nth(usize::from(self.stray.is_none()))
    }

    /// The last.
    pub fn last(&self) -> Option<&Waypoint> {
        self.waypoints().next_back()
    }

    /// The waypoint that a feed with this `cancel_after` would follow on.
    pub fn predecessor(&self, cancel_after: Option<Token>) -> Option<&Waypoint> {
        match cancel_after {
            Some(token) => self.waypoints().rfind(|w| w.token <= token),
            None => self.last(),
        }
    }

    /// Where the aircraft comes from.
    pub fn passed(&self) -> Option<LatLon> {
        self.passed
    }

    /// The aircraft circles behind the last waypoint: everything that was fed has been flown.
    pub fn at_end(&self) -> bool {
        // what was fed a moment ago is not known to the driver yet
        self.course.target == Target::End && self.waypoints.is_empty()
    }

    /// Cancel and append, as one transaction: the order that makes it so. The caller has checked plausibility
    /// and [`Self::room`].
    pub fn feed(&mut self, cancel_after: Option<Token>, waypoints: Vec<Waypoint>) -> Order {
        let after = match cancel_after {
            Some(token) => self.cancel(token),
            None => self.numbered,
        };
        let waypoints = self.number(waypoints);
        self.waypoints.extend(waypoints.iter().cloned());
        Order::Feed { after, waypoints }
    }

    /// Cancels what is behind a token (our own waypoints have none); the last number that stays.
    fn cancel(&mut self, after: Token) -> Serial {
        let stays = |w: &Waypoint| w.token <= after && w.token.0 > 0;
        let keep = self.waypoints().take_while(|w| stays(w)).count();
        let cut = self.waypoints.split_off(keep);
        // what is steered to can't just vanish
        let steered_to = |f: &Fed| self.course.target == Target::Waypoint(f.serial);
        self.stray = self.stray.take().or_else(|| cut.into_iter().next().filter(steered_to));
        self.waypoints.back().map_or(Serial(0), |f| f.serial)
    }

    /// Gives numbers to waypoints.
    pub fn number(&mut self, waypoints: Vec<Waypoint>) -> Vec<Fed> {
        let fed = waypoints.into_iter().map(|waypoint| {
            self.numbered = Serial(self.numbered.0 + 1);
            Fed { serial: self.numbered, waypoint }
        });
        fed.collect()
    }

    /// The waypoints of a flight that was met in the air.
    pub fn adopt(&mut self, known: Vec<Fed>) {
        self.clear();
        self.waypoints = known.into();
    }

    /// Leaves the waypoint steered to, a loiter, for the one after it: the order that makes it so, the first
    /// time and if there is one.
    pub fn leave(&mut self) -> Option<Order> {
        if self.stray.is_some() || self.waypoints.len() < 2 {
            return None;
        }
        self.stray = self.waypoints.pop_front();
        self.stray.as_ref().map(|f| Order::Leave(f.serial))
    }

    /// Takes in what the driver says of the waypoints; `here`: where the aircraft is, as far as that is known.
    pub fn set_course(&mut self, course: Course, here: Option<LatLon>) {
        self.course = course;
        match course.target {
            Target::None => self.stray = None,
            Target::Waypoint(serial) => {
                self.pass_stray(|stray| stray != serial, here);
                self.pass_before(serial);
            }
            Target::Elsewhere { next, position, altitude_amsl_m } => {
                self.pass_before(next);
                self.stray = self.waypoints.front().map(|f| foreign(f, position, altitude_amsl_m));
            }
            Target::Unknown { next } => self.pass_before(next),
            Target::End => {
                self.pass_stray(|_| true, here);
                self.pass_before(Serial(u64::MAX));
            }
        }
    }

    /// It was left, not reached: what follows begins where the aircraft is.
    fn pass_stray(&mut self, left: impl Fn(Serial) -> bool, here: Option<LatLon>) {
        if let Some(stray) = self.stray.take_if(|f| left(f.serial)) {
            self.passed = here.or(Some(stray.waypoint.position));
        }
    }

    fn pass_before(&mut self, serial: Serial) {
        while let Some(fed) = self.waypoints.pop_front_if(|f| f.serial < serial) {
            self.passed = Some(fed.waypoint.position);
        }
    }

    /// The flight is over. Numbers go on.
    pub fn clear(&mut self) {
        *self = Self { numbered: self.numbered, ..Self::default() };
    }
}

/// A waypoint that nobody fed, flown to like the one after it.
fn foreign(after: &Fed, position: LatLon, altitude_amsl_m: f64) -> Fed {
    let waypoint = Waypoint {
        token: Token(0),
        position,
        altitude_amsl_m,
        action: Action::Fly,
        end_of_plan: false,
        ..after.waypoint.clone()
    };
    Fed { serial: Serial(0), waypoint }
}

#[cfg(test)]
mod tests {
    use super::*;
    use usal::contract::Id;

    fn waypoint(token: u64) -> Waypoint {
        Waypoint {
            token: Token(token),
            position: LatLon::new(36.0 + token as f64 * 1e-3, -84.0),
            altitude_amsl_m: 500.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: Id::from("leg"),
            end_of_plan: false,
        }
    }

    fn waypoints(tokens: &[u64]) -> Vec<Waypoint> {
        tokens.iter().map(|t| waypoint(*t)).collect()
    }

    fn steering_to(target: Target) -> Course {
        Course { aboard: true, ready: true, target }
    }

    /// A buffer of four, steering to the second.
    fn flying() -> Buffer {
        let mut buffer = Buffer::default();
        buffer.feed(None, waypoints(&[11, 12, 13, 14]));
        buffer.set_course(steering_to(Target::Waypoint(Serial(2))), None);
        buffer
    }

    /// `after` and the numbers of what follows.
    fn fed(order: Order) -> (u64, Vec<u64>) {
        let Order::Feed { after, waypoints } = order else { panic!("{order:?}") };
        (after.0, waypoints.iter().map(|f| f.serial.0).collect())
    }

    fn tokens(buffer: &Buffer) -> Vec<u64> {
        buffer.waypoints().map(|w| w.token.0).collect()
    }

    fn current(buffer: &Buffer) -> Option<u64> {
        buffer.current().map(|w| w.token.0)
    }

    #[test]
    fn numbers_are_never_used_twice_and_cancelling_keeps_what_is_before() {
        let mut buffer = flying();
        assert_eq!(fed(buffer.feed(None, waypoints(&[15]))), (5 - 1, vec![5]));
        assert_eq!(fed(buffer.feed(Some(Token(13)), waypoints(&[16, 17]))), (3, vec![6, 7]));
        assert_eq!((current(&buffer), tokens(&buffer)), (Some(12), vec![12, 13, 16, 17]));
        assert_eq!(buffer.predecessor(Some(Token(16))).unwrap().token, Token(16));
    }

    #[test]
    fn a_cancelled_waypoint_is_current_until_the_driver_says_otherwise() {
        let mut buffer = flying();
        assert_eq!(fed(buffer.feed(Some(Token(0)), waypoints(&[21, 22]))), (0, vec![5, 6]));
        assert_eq!((current(&buffer), tokens(&buffer)), (Some(12), vec![21, 22]));
        assert_eq!(buffer.next().unwrap().token, Token(21));
        buffer.set_course(steering_to(Target::Waypoint(Serial(5))), None);
        assert_eq!((current(&buffer), tokens(&buffer)), (Some(21), vec![21, 22]));
        assert_eq!(buffer.passed(), Some(waypoint(12).position));
        assert_eq!(buffer.next().unwrap().token, Token(22));
    }

    #[test]
    fn way_to_a_waypoint_begins_where_the_aircraft_was_sent_there() {
        let mut buffer = flying();
        buffer.feed(Some(Token(0)), waypoints(&[21, 22]));
        let here = LatLon::new(36.0115, -84.01);
        buffer.set_course(steering_to(Target::Waypoint(Serial(5))), Some(here));
        assert_eq!(buffer.passed(), Some(here), "the one that was cancelled was never reached");
        buffer.set_course(steering_to(Target::Waypoint(Serial(6))), Some(here));
        assert_eq!(buffer.passed(), Some(waypoint(21).position), "in order, from the one before");
    }

    #[test]
    fn nothing_is_claimed_while_the_target_is_not_certain_and_everything_is_flown_at_the_end() {
        let mut buffer = flying();
        buffer.set_course(steering_to(Target::Unknown { next: Serial(3) }), None);
        assert_eq!((current(&buffer), tokens(&buffer)), (None, vec![13, 14]));
        let place = LatLon::new(36.5, -84.5);
        let elsewhere = Target::Elsewhere { next: Serial(4), position: place, altitude_amsl_m: 400.0 };
        buffer.set_course(steering_to(elsewhere), None);
        assert_eq!((current(&buffer), tokens(&buffer)), (Some(0), vec![14]));
        assert!(!buffer.at_end());
        buffer.set_course(steering_to(Target::End), None);
        assert!(buffer.at_end() && buffer.is_empty() && current(&buffer).is_none());
        buffer.feed(None, waypoints(&[15]));
        assert!(!buffer.at_end(), "there is something to fly again");
    }

    #[test]
    fn a_loiter_is_left_once_and_only_for_a_waypoint_after_it() {
        let mut buffer = flying();
        assert_eq!(buffer.leave(), Some(Order::Leave(Serial(2))));
        assert_eq!((buffer.leave(), current(&buffer), tokens(&buffer)), (None, Some(12), vec![13, 14]));
        buffer.set_course(steering_to(Target::Waypoint(Serial(4))), None);
        assert_eq!((buffer.leave(), current(&buffer)), (None, Some(14)));
    }

    #[test]
    fn what_is_kept_and_what_is_steered_to_count_for_the_room() {
        let mut buffer = flying();
        assert_eq!(buffer.room(None), CAPACITY - 3);
        assert_eq!(buffer.room(Some(Token(13))), CAPACITY - 3);
        buffer.feed(Some(Token(0)), waypoints(&[21, 22]));
        assert_eq!(buffer.room(None), CAPACITY - 3);
    }
}
