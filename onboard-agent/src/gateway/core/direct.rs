//! A direct command: straight ahead, and to an altitude.
//!
//! It leads to a place far ahead. PX4 changes its altitude evenly all the way to a place: one that is to climb or to sink is sent to a
//! place near by first, and on from there once it has its altitude.

use super::Gateway;
use super::io::Intent;
use aircraft::Profile;
use geometry::LatLon;

/// So far ahead it leads, metres.
const FAR_M: f64 = 20_000.0;
/// An altitude that differs by less is the one that was commanded, metres.
const SAME_M: f64 = 10.0;
/// The nearest place that it is sent to, metres.
const NEAR_M: f64 = 700.0;
/// So far before a place near by it is sent on, metres: it would begin to circle there.
const SENT_ON_M: f64 = 350.0;
/// So much of its best climb or descent is planned with.
const EASY: f64 = 0.6;

/// Where a direct command leads.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direct {
    /// A place far ahead.
    far: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// The place on the way there at which it is to have its altitude; `None`: it has it.
    near: Option<LatLon>,
}

impl Direct {
    /// From here, at an altitude (metres AMSL) that may be another than commanded.
    pub fn new(
        here: (LatLon, f64),
        heading_deg: f64,
        altitude_amsl_m: f64,
        airspeed_mps: f64,
        profile: &Profile,
    ) -> Self {
        let far = here.0.destination(heading_deg, FAR_M);
        Self { far, altitude_amsl_m, near: near(here, far, altitude_amsl_m, airspeed_mps, profile) }
    }

    /// It stays where it is.
    pub fn here((place, altitude_amsl_m): (LatLon, f64)) -> Self {
        Self { far: place, altitude_amsl_m, near: None }
    }

    /// The place that it is sent to now.
    pub fn place(&self) -> LatLon {
        self.near.unwrap_or(self.far)
    }

    /// Where it is sent on to from here; `None`: it is on its way.
    fn sent_on(&self, here: (LatLon, f64), airspeed_mps: f64, profile: &Profile) -> Option<Self> {
        let place = self.near?;
        let near = near(here, self.far, self.altitude_amsl_m, airspeed_mps, profile);
        let is_due = near.is_none() || here.0.distance_m(place) < SENT_ON_M;
        is_due.then_some(Self { near, ..*self })
    }
}

/// Where an aircraft that climbs or sinks easily has its altitude.
fn near(
    (here, now_amsl_m): (LatLon, f64),
    far: LatLon,
    altitude_amsl_m: f64,
    airspeed_mps: f64,
    profile: &Profile,
) -> Option<LatLon> {
    let up_m = altitude_amsl_m - now_amsl_m;
    let rate_mps = if up_m > 0.0 { profile.max_climb_mps } else { profile.max_descent_mps };
    let way_m = (up_m.abs() / (EASY * rate_mps) * airspeed_mps).max(NEAR_M);
    let is_needed = up_m.abs() > SAME_M && way_m < here.distance_m(far);
    is_needed.then(|| here.destination(here.bearing_deg(far), way_m))
}

impl Gateway {
    /// It may have the altitude of its direct command by now.
    pub(super) fn send_on(&mut self) {
        let Some(direct) = self.control.direct.filter(|_| self.control.intent == Intent::Direct) else {
            return;
        };
        let Some(fix) = self.telemetry.fix_now(self.now) else { return };
        let here = (fix.position, fix.altitude_amsl_m);
        let profile = &self.settings.profile;
        if let Some(next) = direct.sent_on(here, profile.cruise_airspeed_mps, profile) {
            self.control.direct = Some(next);
            self.control.direct_due = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HERE: LatLon = LatLon::new(36.4905, -84.2710);

    fn north(altitude_amsl_m: f64) -> Direct {
        Direct::new((HERE, 500.0), 0.0, altitude_amsl_m, 25.0, &Profile::default())
    }

    #[test]
    fn what_climbs_or_sinks_is_sent_to_a_place_near_by_first() {
        let profile = Profile::default();
        assert!(HERE.distance_m(north(505.0).place()) > 19_000.0, "it is there");
        let climb = north(700.0);
        let way_m = HERE.distance_m(climb.place());
        let foreseen_m = 200.0 / (EASY * profile.max_climb_mps) * 25.0;
        assert!((way_m - foreseen_m).abs() < 1.0, "{way_m}, {foreseen_m}");
        assert!((HERE.distance_m(north(520.0).place()) - NEAR_M).abs() < 1.0);
        assert!(HERE.distance_m(north(300.0).place()) < 19_000.0, "it sinks");
    }

    #[test]
    fn it_is_sent_on_before_it_would_circle_and_far_ahead_once_it_has_its_altitude() {
        let profile = Profile::default();
        let climb = north(700.0);
        let on =
            |m: f64, altitude_m: f64| climb.sent_on((HERE.destination(0.0, m), altitude_m), 25.0, &profile);
        assert_eq!(on(300.0, 560.0), None, "it climbs");
        let higher = on(300.0, 695.0).expect("it has its altitude");
        assert!(HERE.distance_m(higher.place()) > 19_000.0);
        assert_eq!(higher.sent_on((HERE, 640.0), 25.0, &profile), None, "once is enough");
        let way_m = HERE.distance_m(climb.place());
        let slower = on(way_m - 300.0, 600.0).expect("it would circle");
        assert!(
            HERE.distance_m(slower.place()) > way_m + 300.0 && HERE.distance_m(slower.place()) < 19_000.0
        );
    }
}
