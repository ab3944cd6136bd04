//! Pure: what the gateway tells of a flight, beside what the autopilot itself says.

use super::world::{Flies, Heard};
use geometry::LatLon;
use usal::contract::{GatewayState, GatewayStatus};

/// A change is told within so many seconds.
const TOLD_WITHIN_S: f64 = 4.0;
/// What was told last is not held against it after so many seconds of silence: its end of the radio may be dead.
const FRESH_S: f64 = 2.0;
/// An item of the list lies at most so far from the waypoint that it stands for, metres: some are put aside of it, or behind a corner.
const ASIDE_M: f64 = 300.0;
/// What is higher above home does not stand, metres.
const STANDS_M: f64 = 20.0;
/// So many are kept.
const MOST: usize = 8;

/// What the gateway tells.
#[derive(Debug)]
pub struct Told {
    /// Its state, and when it told that, on its own clock.
    pub status: GatewayStatus,
    pub at_s: f64,
    /// The waypoint that it steers to, as it says.
    pub waypoint: Option<LatLon>,
}

/// Keeps what was told and was not so.
#[derive(Debug, Default)]
pub struct Doubts {
    found: Vec<String>,
    /// Since when it is told otherwise than it is.
    since_s: Option<f64>,
    /// When something was told last, on its own clock and on ours.
    fresh: Option<(f64, f64)>,
}

impl Doubts {
    /// What was told and was not so, for longer than a change takes to be told.
    pub fn found(&self) -> &[String] {
        &self.found
    }

    /// Compares what is told now with what is heard now.
    pub fn compare(&mut self, now_s: f64, told: Option<&Told>, heard: Option<&Heard>) {
        let (Some(told), Some(heard)) = (told, heard) else { return };
        if self.fresh.is_none_or(|(at_s, _)| at_s != told.at_s) {
            self.fresh = Some((told.at_s, now_s));
        }
        let is_fresh = self.fresh.is_some_and(|(_, since_s)| now_s - since_s < FRESH_S);
        let why = why_not(told, heard).filter(|_| is_fresh && told.status.autopilot_age_s < FRESH_S);
        let Some(why) = why else {
            self.since_s = None;
            return;
        };
        if now_s - *self.since_s.get_or_insert(now_s) > TOLD_WITHIN_S {
            // the next one counts from here on
            self.since_s = None;
            if self.found.len() < MOST {
                let Told { status, waypoint, .. } = told;
                self.found
                    .push(format!("at {now_s:.0} s: {why}: {:?}, {waypoint:?}; but {heard:?}", status.state));
            }
        }
    }
}

/// Why it can't be so.
fn why_not(told: &Told, heard: &Heard) -> Option<&'static str> {
    let status = &told.status;
    if status.armed != heard.armed && status.state != GatewayState::Off {
        return Some("it is told that it is armed, or not, as it is not");
    }
    // a hold right after lift-off is asked for, and the list flown a little longer
    if status.waits_for_height_m.is_some() {
        return None;
    }
    let is_stale = |waypoint: LatLon, item: LatLon| waypoint.distance_m(item) > ASIDE_M;
    match status.state {
        GatewayState::Stop => (heard.above_home_m > STANDS_M).then_some("it is told to stand"),
        GatewayState::Nav | GatewayState::TakeOff | GatewayState::Approach | GatewayState::Land => {
            if heard.flies != Some(Flies::List) {
                return Some("it is told to fly waypoints");
            }
            let pair = told.waypoint.zip(heard.item);
            pair.is_some_and(|(waypoint, item)| is_stale(waypoint, item))
                .then_some("it steers to another place than is told")
        }
        GatewayState::Hold | GatewayState::SafeHold | GatewayState::Directed => {
            (heard.flies != Some(Flies::Place)).then_some("it is told to hold, or to go to a place")
        }
        GatewayState::SafeReturn | GatewayState::SafeApproach | GatewayState::SafeLand => {
            heard.flies.is_none().then_some("it is told to go home by itself")
        }
        GatewayState::Off | GatewayState::Manual | GatewayState::Terminate => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: LatLon = LatLon::new(36.4905, -84.2710);
    const FLYING: Heard =
        Heard { armed: true, flies: Some(Flies::List), item: Some(HERE), above_home_m: 100.0 };

    fn told(at_s: f64, state: GatewayState) -> Told {
        let status = GatewayStatus {
            state,
            cause: String::new(),
            armed: true,
            autopilot: None,
            unfit: None,
            autopilot_mode: String::new(),
            autopilot_age_s: 0.1,
            fp_manager: None,
            fp_manager_age_s: None,
            waits_for_height_m: None,
            circle: None,
            safe_return_in_s: None,
            alarms: vec![],
        };
        Told { status, at_s, waypoint: Some(HERE) }
    }

    /// So many doubts after ten seconds of it.
    fn doubts(told_at: impl Fn(f64) -> Told, heard: Heard) -> usize {
        let mut doubts = Doubts::default();
        for step in 0..100 {
            let now_s = f64::from(step) / 10.0;
            doubts.compare(now_s, Some(&told_at(now_s)), Some(&heard));
        }
        doubts.found().len()
    }

    #[test]
    fn what_is_told_and_is_not_so_is_found() {
        use GatewayState::*;
        let elsewhere = Heard { item: Some(HERE.destination(0.0, 400.0)), ..FLYING };
        let circles = Heard { flies: Some(Flies::Place), ..FLYING };
        for (state, heard, expected) in [
            (Nav, FLYING, 0),
            (Nav, elsewhere, 2),
            (Nav, circles, 2),
            (Hold, circles, 0),
            (Hold, FLYING, 2),
            (Stop, FLYING, 2),
            (Manual, circles, 0),
            (SafeReturn, Heard { flies: None, ..FLYING }, 2),
            (Land, Heard { armed: false, ..FLYING }, 2),
        ] {
            assert_eq!(doubts(|now_s| told(now_s, state), heard), expected, "{state:?}, {heard:?}");
        }
    }

    #[test]
    fn whoever_is_silent_or_has_not_had_the_time_tells_no_lie() {
        let circles = Heard { flies: Some(Flies::Place), ..FLYING };
        assert_eq!(doubts(|_| told(1.0, GatewayState::Nav), circles), 0, "a gateway that is dead");
        let in_turn = |now_s: f64| if now_s as u64 % 4 == 3 { GatewayState::Hold } else { GatewayState::Nav };
        assert_eq!(doubts(|now_s| told(now_s, in_turn(now_s)), circles), 0, "three seconds each");
        let deaf = |now_s: f64| {
            let mut told = told(now_s, GatewayState::Nav);
            told.status.autopilot_age_s = 5.0;
            told
        };
        assert_eq!(doubts(deaf, circles), 0, "a radio that is cut");
    }
}
