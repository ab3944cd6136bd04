//! A fixed-wing point mass: bank-limited coordinated turns, climb limits, wind drift, energy.
//!
//! Its place is a `LatLon` in f64, moved through a local frame that is re-centred every hundred
//! metres: cheap, and no flight is too long for it.

use crate::power::{self, Battery, Engine};
use crate::{Profile, Wind};
use geometry::geodesy::normalise_360;
use geometry::{LatLon, LocalFrame, Vec2};
use std::f64::consts::{PI, TAU};

/// How far the aircraft may be from its frame's origin, metres: its scale is wrong by 2 in 100,000 there.
const RECENTRE_M: f64 = 100.0;
/// Greatest change of airspeed in flight and on the ground, m/s².
const AIR_ACCELERATION_MPS2: f64 = 1.5;
const GROUND_ACCELERATION_MPS2: f64 = 3.0;
const BRAKING_MPS2: f64 = 2.5;
/// Time constant of the vertical speed, s.
const CLIMB_TIME_CONSTANT_S: f64 = 1.0;
/// It lifts off at this multiple of the minimum airspeed.
const ROTATION_FACTOR: f64 = 1.1;

/// What the aircraft is asked to do until the next step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Demand {
    /// Bank, radians, positive to the right.
    pub bank_rad: f64,
    /// Vertical speed, m/s, positive up.
    pub climb_mps: f64,
    /// Airspeed, m/s; 0 on the ground means: brake and stop.
    pub airspeed_mps: f64,
    /// Elevation of the runway it may touch down on, metres AMSL; `None`: nothing to land on here.
    pub ground_amsl_m: Option<f64>,
}

/// Everything about its motion, as a perfect observer sees it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Where it is.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Where the nose points, radians true in −π..=π.
    pub heading_rad: f64,
    /// Bank, radians, positive to the right.
    pub bank_rad: f64,
    /// True airspeed, m/s.
    pub airspeed_mps: f64,
    /// Vertical speed, m/s, positive up.
    pub climb_mps: f64,
    /// Over the ground, m/s east and north.
    pub ground_velocity_mps: Vec2,
    /// On the ground.
    pub on_ground: bool,
}

impl State {
    /// Ground speed, m/s.
    pub fn ground_speed_mps(&self) -> f64 {
        self.ground_velocity_mps.length()
    }

    /// Direction of travel over the ground, degrees true in 0..360; the heading when it stands still.
    pub fn track_deg(&self) -> f64 {
        let moving = self.ground_speed_mps() > 0.5;
        let track = if moving { self.ground_velocity_mps.bearing_rad() } else { self.heading_rad };
        normalise_360(track.to_degrees())
    }

    /// Where the nose points, degrees true in 0..360.
    pub fn heading_deg(&self) -> f64 {
        normalise_360(self.heading_rad.to_degrees())
    }
}

/// An aircraft: its profile, motion, battery and engine.
#[derive(Debug, Clone)]
pub struct Aircraft {
    profile: Profile,
    state: State,
    battery: Battery,
    engine: Engine,
    frame: LocalFrame,
    local: Vec2,
}

impl Aircraft {
    /// Standing on a runway: elevation in metres AMSL, heading in degrees true.
    pub fn on_runway(profile: Profile, position: LatLon, elevation_amsl_m: f64, heading_deg: f64) -> Self {
        let state = State {
            position,
            altitude_amsl_m: elevation_amsl_m,
            heading_rad: wrap_pi(heading_deg.to_radians()),
            bank_rad: 0.0,
            airspeed_mps: 0.0,
            climb_mps: 0.0,
            ground_velocity_mps: Vec2::default(),
            on_ground: true,
        };
        Self {
            battery: Battery::full(&profile),
            engine: Engine::cold(),
            frame: LocalFrame::new(position),
            local: Vec2::default(),
            profile,
            state,
        }
    }

    /// In level cruise.
    pub fn in_flight(profile: Profile, position: LatLon, altitude_amsl_m: f64, heading_deg: f64) -> Self {
        let mut aircraft = Self::on_runway(profile, position, altitude_amsl_m, heading_deg);
        let speed = aircraft.profile.cruise_airspeed_mps;
        aircraft.state.on_ground = false;
        aircraft.state.airspeed_mps = speed;
        aircraft.state.ground_velocity_mps = Vec2::from_bearing_rad(aircraft.state.heading_rad) * speed;
        aircraft
    }

    /// What it can do.
    pub fn profile(&self) -> &Profile {
        &self.profile
    }
    /// Its motion.
    pub fn state(&self) -> &State {
        &self.state
    }
    /// Its battery.
    pub fn battery(&self) -> &Battery {
        &self.battery
    }
    /// Its engine.
    pub fn engine(&self) -> &Engine {
        &self.engine
    }

    /// Moves alike from here on, as long as there is energy.
    pub fn moves_as(&self, other: &Self) -> bool {
        (self.state, self.frame, self.local) == (other.state, other.frame, other.local)
            && self.engine.healthy == other.engine.healthy
            && self.profile == other.profile
    }

    /// Uses energy (joules), or gives it back.
    pub fn use_energy(&mut self, joules: f64) {
        self.battery.energy_left_j =
            (self.battery.energy_left_j - joules).clamp(0.0, self.battery.capacity_j);
    }

    /// Goes back in time by a part of the last step and rounds the motion to what an autopilot reports: position to
    /// 1e-7 degrees (1 cm), altitude and speeds to centimetres, angles to a thousandth of a radian. On the
    /// ground nothing is done.
    ///
    /// A preview does this at each waypoint: what happened before differs by less than nothing after a while, and two flights
    /// that differ only there are one and the same from then on.
    pub fn settle(&mut self, back_s: f64, wind: &Wind) {
        if self.state.on_ground {
            return;
        }
        let s = &mut self.state;
        let position = self.frame.to_geo(self.local - s.ground_velocity_mps * back_s);
        let turn_rate = power::turn_rate_rad_s(s.bank_rad, s.airspeed_mps);
        s.position = LatLon::new(rounded(position.lat_deg, 1e7), rounded(position.lon_deg, 1e7));
        s.altitude_amsl_m = rounded(s.altitude_amsl_m - s.climb_mps * back_s, 1e2);
        s.heading_rad = rounded(wrap_pi(s.heading_rad - turn_rate * back_s), 1e3);
        s.bank_rad = rounded(s.bank_rad, 1e3);
        s.airspeed_mps = rounded(s.airspeed_mps, 1e2);
        s.climb_mps = rounded(s.climb_mps, 1e2);
        s.ground_velocity_mps = over_ground(s, wind);
        self.frame = LocalFrame::new(s.position);
        self.local = Vec2::default();
        self.battery.draw(-back_s, self.engine.power_w + power::avionics_power_w());
    }

    /// Fails the engine, or repairs it.
    pub fn set_engine_healthy(&mut self, healthy: bool) {
        self.engine.healthy = healthy;
    }

    /// Sets the share of the usable energy left (clamped to 0..=1).
    pub fn set_battery_share(&mut self, share: f64) {
        self.battery.energy_left_j = self.battery.capacity_j * share.clamp(0.0, 1.0);
    }

    /// Stands where it is, wherever that is: it came down.
    pub fn come_down(&mut self) {
        let s = &mut self.state;
        (s.airspeed_mps, s.climb_mps, s.bank_rad, s.on_ground) = (0.0, 0.0, 0.0, true);
        s.ground_velocity_mps = Vec2::default();
    }

    /// Flies (or rolls) for `dt_s` seconds. Made for steps of 0.01 to 0.2 s.
    pub fn step(&mut self, dt_s: f64, demand: &Demand, wind: &Wind) {
        if self.state.on_ground {
            self.roll(dt_s, demand, wind);
        } else {
            self.fly(dt_s, demand, wind);
        }
        self.move_by(self.state.ground_velocity_mps * dt_s);
        self.spend(dt_s, demand);
    }

    fn has_power(&self) -> bool {
        self.engine.healthy && self.battery.energy_left_j > 0.0
    }

    /// On the wheels: straight ahead, faster or slower; lifts off when fast enough and asked to climb.
    fn roll(&mut self, dt_s: f64, demand: &Demand, wind: &Wind) {
        let s = &mut self.state;
        let ahead = Vec2::from_bearing_rad(s.heading_rad);
        let rolling_mps = s.ground_velocity_mps.dot(ahead).max(0.0);
        let driven = self.engine.healthy && self.battery.energy_left_j > 0.0 && demand.airspeed_mps > 0.0;
        let ground_mps = if driven {
            (rolling_mps + GROUND_ACCELERATION_MPS2 * dt_s).min(self.profile.max_airspeed_mps)
        } else {
            (rolling_mps - BRAKING_MPS2 * dt_s).max(0.0)
        };
        s.ground_velocity_mps = ahead * ground_mps;
        // what the pitot sees: the rolling speed less the wind's share along the runway
        s.airspeed_mps = (ground_mps - wind.vector().dot(ahead)).max(0.0);
        s.climb_mps = 0.0;
        s.bank_rad = 0.0;
        let rotation_mps = ROTATION_FACTOR * self.profile.min_airspeed_mps;
        if driven && demand.climb_mps > 0.0 && s.airspeed_mps >= rotation_mps {
            s.on_ground = false;
            // keeps its way over the ground at lift-off: the nose turns into the wind at once
            let through_air = s.ground_velocity_mps - wind.vector();
            s.heading_rad = through_air.bearing_rad();
            s.airspeed_mps = through_air.length();
        }
    }

    fn fly(&mut self, dt_s: f64, demand: &Demand, wind: &Wind) {
        self.bank_and_turn(dt_s, demand.bank_rad);
        self.change_airspeed(dt_s, demand.airspeed_mps);
        self.change_altitude(dt_s, demand.climb_mps);
        let s = &mut self.state;
        s.ground_velocity_mps = over_ground(s, wind);
        if let Some(ground) = demand.ground_amsl_m {
            self.touch_down(ground);
        }
    }

    /// First-order bank, then half the turn of the old and half of the new bank (trapezoid).
    fn bank_and_turn(&mut self, dt_s: f64, bank_demand_rad: f64) {
        let limit = self.profile.max_bank_deg.to_radians();
        let s = &mut self.state;
        let before = power::turn_rate_rad_s(s.bank_rad, s.airspeed_mps);
        let share = 1.0 - (-dt_s / self.profile.bank_time_constant_s).exp();
        s.bank_rad += (bank_demand_rad.clamp(-limit, limit) - s.bank_rad) * share;
        let after = power::turn_rate_rad_s(s.bank_rad, s.airspeed_mps);
        s.heading_rad = wrap_pi(s.heading_rad + 0.5 * (before + after) * dt_s);
    }

    fn change_airspeed(&mut self, dt_s: f64, demand_mps: f64) {
        let p = &self.profile;
        // without power only the best-glide speed can be held
        let wanted = if self.has_power() { demand_mps } else { p.cruise_airspeed_mps };
        let wanted = wanted.clamp(p.min_airspeed_mps, p.max_airspeed_mps);
        let most = AIR_ACCELERATION_MPS2 * dt_s;
        self.state.airspeed_mps += (wanted - self.state.airspeed_mps).clamp(-most, most);
    }

    fn change_altitude(&mut self, dt_s: f64, demand_mps: f64) {
        let p = &self.profile;
        let best = if self.has_power() {
            let room_m = (p.ceiling_amsl_m - self.state.altitude_amsl_m).max(0.0);
            // four time constants: the approach to the ceiling doesn't overshoot it
            p.max_climb_mps.min(room_m / (4.0 * CLIMB_TIME_CONSTANT_S))
        } else {
            let n = power::load_factor(self.state.bank_rad);
            -power::glide_sink_mps(p, self.state.airspeed_mps, n)
        };
        let wanted = demand_mps.max(-p.max_descent_mps).min(best);
        let share = (dt_s / CLIMB_TIME_CONSTANT_S).min(1.0);
        self.state.climb_mps += (wanted - self.state.climb_mps) * share;
        self.state.altitude_amsl_m += self.state.climb_mps * dt_s;
    }

    /// Below the runway's surface: on the wheels, rolling the way it was going.
    fn touch_down(&mut self, ground_amsl_m: f64) {
        let s = &mut self.state;
        if s.altitude_amsl_m > ground_amsl_m || s.climb_mps > 0.0 {
            return;
        }
        s.altitude_amsl_m = ground_amsl_m;
        s.heading_rad = s.ground_velocity_mps.bearing_rad();
        s.on_ground = true;
        s.climb_mps = 0.0;
        s.bank_rad = 0.0;
    }

    fn move_by(&mut self, metres: Vec2) {
        self.local = self.local + metres;
        self.state.position = self.frame.to_geo(self.local);
        if self.local.dot(self.local) > RECENTRE_M * RECENTRE_M {
            self.frame = LocalFrame::new(self.state.position);
            self.local = Vec2::default();
        }
    }

    fn spend(&mut self, dt_s: f64, demand: &Demand) {
        let s = &self.state;
        let standing = s.on_ground && demand.airspeed_mps <= 0.0;
        let engine_w = if !self.has_power() || standing {
            0.0
        } else {
            // on the take-off roll it gives what a climb takes
            let climb = if s.on_ground { self.profile.max_climb_mps } else { s.climb_mps };
            let n = power::load_factor(s.bank_rad);
            power::demanded_power_w(&self.profile, s.airspeed_mps, climb, n)
        };
        self.engine.follow(dt_s, &self.profile, engine_w);
        self.battery.draw(dt_s, engine_w + power::avionics_power_w());
    }
}

/// To the nearest part of one.
fn rounded(x: f64, parts: f64) -> f64 {
    (x * parts).round() / parts
}

/// The sum of the way through the air and the wind, m/s.
fn over_ground(s: &State, wind: &Wind) -> Vec2 {
    Vec2::from_bearing_rad(s.heading_rad) * horizontal(s.airspeed_mps, s.climb_mps) + wind.vector()
}

/// Horizontal part of the airspeed while climbing.
fn horizontal(airspeed_mps: f64, climb_mps: f64) -> f64 {
    (airspeed_mps * airspeed_mps - climb_mps * climb_mps).max(0.0).sqrt()
}

/// An angle brought into −π..=π.
pub(crate) fn wrap_pi(angle_rad: f64) -> f64 {
    if (-PI..=PI).contains(&angle_rad) {
        return angle_rad;
    }
    (angle_rad + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const HERE: LatLon = LatLon::new(36.4905, -84.2710);

    fn cruising() -> Aircraft {
        Aircraft::in_flight(Profile::default(), HERE, 900.0, 90.0)
    }

    fn demand(bank_deg: f64, climb_mps: f64) -> Demand {
        Demand { bank_rad: bank_deg.to_radians(), climb_mps, airspeed_mps: 25.0, ground_amsl_m: None }
    }

    fn fly(aircraft: &mut Aircraft, seconds: f64, demand: &Demand, wind: &Wind) {
        for _ in 0..(seconds / 0.1).round() as usize {
            aircraft.step(0.1, demand, wind);
        }
    }

    #[test]
    fn a_steady_turn_has_the_radius_of_the_formula() {
        for bank_deg in [15.0_f64, 25.0, 40.0] {
            let mut a = cruising();
            fly(&mut a, 5.0, &demand(bank_deg, 0.0), &Wind::CALM);
            let radius = 625.0 / (crate::GRAVITY_MPS2 * bank_deg.to_radians().tan());
            let before = a.state().position;
            fly(&mut a, (PI * radius / 25.0 * 10.0).round() / 10.0, &demand(bank_deg, 0.0), &Wind::CALM);
            let diameter = before.distance_m(a.state().position);
            assert!((diameter / 2.0 / radius - 1.0).abs() < 0.01, "{bank_deg}: {diameter}");
        }
    }

    #[test]
    fn bank_is_limited_whatever_is_demanded() {
        let mut a = cruising();
        fly(&mut a, 10.0, &demand(400.0, 0.0), &Wind::CALM);
        assert!(a.state().bank_rad <= 45.0_f64.to_radians() + 1e-9);
    }

    #[test]
    fn climb_descent_and_ceiling_are_limited() {
        for (demanded, seconds, gained) in [(20.0, 60.0, 240.0), (-20.0, 60.0, -240.0)] {
            let mut a = cruising();
            fly(&mut a, seconds, &demand(0.0, demanded), &Wind::CALM);
            let gain = a.state().altitude_amsl_m - 900.0;
            assert!((gain - gained).abs() < 6.0, "{demanded}: {gain}");
        }
        let mut a = cruising();
        fly(&mut a, 900.0, &demand(0.0, 4.0), &Wind::CALM);
        let altitude = a.state().altitude_amsl_m;
        assert!((2990.0..=3000.01).contains(&altitude), "{altitude}");
    }

    #[test]
    fn the_wind_drifts_it_by_the_vector_sum() {
        let wind = Wind { east_mps: -5.0, north_mps: 8.0 };
        let mut a = cruising();
        fly(&mut a, 600.0, &demand(0.0, 0.0), &wind);
        let to = HERE.inverse(a.state().position);
        let expected = Vec2::new(20.0, 8.0) * 600.0;
        assert!((to.distance_m - expected.length()).abs() < 10.0, "{}", to.distance_m);
        assert!((to.bearing_start_deg - expected.bearing_rad().to_degrees()).abs() < 0.2);
    }

    #[test]
    fn what_is_settled_is_where_it_was_to_the_centimetre() {
        let wind = Wind { east_mps: 3.0, north_mps: -4.0 };
        let mut a = cruising();
        fly(&mut a, 20.0, &demand(20.0, 1.0), &wind);
        let before = a.clone();
        fly(&mut a, 0.1, &demand(20.0, 1.0), &wind);
        a.settle(0.1, &wind);
        let (was, is) = (before.state(), a.state());
        assert!(was.position.distance_m(is.position) < 0.02);
        assert!((was.altitude_amsl_m - is.altitude_amsl_m).abs() < 0.02);
        assert!(wrap_pi(was.heading_rad - is.heading_rad).abs() < 1e-3);
        assert!((before.battery().energy_left_j - a.battery().energy_left_j).abs() < 0.1);
        // an aircraft that was a millimetre away is in the same place now
        let mut beside = before.clone();
        beside.local = beside.local + Vec2::new(1e-4, -1e-4);
        fly(&mut beside, 0.1, &demand(20.0, 1.0), &wind);
        beside.settle(0.1, &wind);
        assert!(beside.moves_as(&a));
    }

    #[test]
    fn energy_spent_is_power_times_time() {
        let mut a = cruising();
        fly(&mut a, 600.0, &demand(0.0, 0.0), &Wind::CALM);
        let spent = 3.0e6 - a.battery().energy_left_j;
        assert!((spent / (308.0 * 600.0) - 1.0).abs() < 1e-3, "{spent}");
    }

    #[test]
    fn engine_out_glides_at_its_ratio_and_an_empty_battery_is_an_engine_out() {
        type Fail = fn(&mut Aircraft);
        let failures: [Fail; 2] = [|a| a.set_engine_healthy(false), |a| a.set_battery_share(0.0)];
        for fail in failures {
            let mut a = cruising();
            fail(&mut a);
            fly(&mut a, 120.0, &demand(0.0, 4.0), &Wind::CALM);
            let sunk = 900.0 - a.state().altitude_amsl_m;
            let ratio = HERE.distance_m(a.state().position) / sunk;
            assert!((ratio - 12.0).abs() < 0.3, "{ratio}");
        }
    }

    #[test]
    fn no_flight_is_too_long_for_the_frame() {
        let mut a = cruising();
        a.battery.capacity_j = 1.0e9;
        a.battery.energy_left_j = 1.0e9;
        a.state.heading_rad = 0.0;
        fly(&mut a, 3600.0, &demand(0.0, 0.0), &Wind::CALM);
        let flown = HERE.distance_m(a.state().position);
        assert!((flown - 90_000.0).abs() < 1.0, "{flown}");
        assert!((a.state().position.lon_deg - HERE.lon_deg).abs() < 1e-9);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn whatever_is_demanded_it_stays_finite_and_within_its_limits(
            demands in prop::collection::vec((-2.0..2.0_f64, -50.0..50.0_f64, -5.0..80.0_f64), 1..60),
            wind_east in -15.0..15.0_f64,
        ) {
            let wind = Wind { east_mps: wind_east, north_mps: 3.0 };
            let mut a = cruising();
            let mut energy = a.battery().energy_left_j;
            for (bank_rad, climb_mps, airspeed_mps) in demands {
                let d = Demand { bank_rad, climb_mps, airspeed_mps, ground_amsl_m: Some(880.0) };
                for _ in 0..20 {
                    a.step(0.1, &d, &wind);
                }
                let s = a.state();
                prop_assert!(s.position.is_valid() && s.altitude_amsl_m >= 880.0 - 1e-9);
                prop_assert!(s.bank_rad.abs() <= 45.0_f64.to_radians() + 1e-9);
                prop_assert!(s.climb_mps <= 4.0 + 1e-9 && s.climb_mps >= -4.0 - 1e-9);
                prop_assert!(a.battery().energy_left_j <= energy);
                energy = a.battery().energy_left_j;
            }
        }
    }
}
