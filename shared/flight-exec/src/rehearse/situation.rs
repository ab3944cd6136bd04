//! Everything about a previewed flight at one instant: a clone goes on as the original does.

use super::scenario::Moment;
use super::{FlownWaypoint, LegPassage, Options, PreviewError, Start};
use crate::api::{Time, Waypoint};
use crate::executor::Executor;
use aircraft::autopilot::{GREATEST_ACCEPTANCE_M, arc_acceptance_m, turn_acceptance_m};
use aircraft::{Aircraft, Guidance, Profile, Target};
use flight_plan::{Id, Program, Runway};
use geometry::LocalFrame;
use std::collections::VecDeque;
use std::sync::Arc;
use terrain::Terrain;

/// A flight at one instant.
#[derive(Clone)]
pub(super) struct Situation {
    pub executor: Executor,
    pub aircraft: Aircraft,
    pub guidance: Guidance,
    /// Waypoints fed and not reached yet.
    pub buffer: VecDeque<Waypoint>,
    pub moment: Moment,
    /// Since the start, microseconds: whole numbers, so that two flights that differ by a shift in time have the same times.
    pub now_us: u64,
    pub due: Due,
    /// The executor was stepped last then.
    pub stepped_us: u64,
    /// Holding or waiting for so long.
    pub waiting_us: u64,
    pub requests: u64,
    pub fired: Vec<bool>,
    /// The scenario says so.
    pub ended: bool,
    /// A leg was begun since this was last read.
    pub entered: bool,
    /// When the present flight of the plan began, microseconds since the start of the first one.
    pub began_us: u64,
    /// Energy used in the flights before, joules.
    pub used_before_j: f64,
    /// Over the ground, metres.
    pub distance_m: f64,
    /// The passage being flown, its distance and energy still those at its beginning.
    pub passage: Option<LegPassage>,
    /// The waypoint steered to.
    pub steered: Option<FlownWaypoint>,
    /// Passages that are over, and waypoints that were steered to before.
    pub passages: usize,
    pub waypoints: usize,
    pub renumbering: Renumbering,
}

/// When something is due by itself.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Due {
    pub report_us: u64,
    pub track_us: u64,
    pub advance_us: u64,
}

/// What the executor's numbers have to be raised by: it may have counted before legs were put into the plan, or taken out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Renumbering {
    pub tokens: i64,
    pub passages: i64,
}

impl Renumbering {
    pub fn token(self, n: u64) -> u64 {
        n.saturating_add_signed(self.tokens)
    }
    pub fn passage(self, n: u64) -> u64 {
        n.saturating_add_signed(self.passages)
    }
}

impl Situation {
    pub fn new(
        program: &Program,
        profile: &Profile,
        terrain: &Arc<dyn Terrain>,
        start: Start,
        triggers: usize,
        options: &Options,
    ) -> Result<Self, PreviewError> {
        let executor = Executor::new(options.config.clone(), terrain.clone(), profile.clone());
        let mut aircraft = placed(program, profile, start)?;
        aircraft.set_battery_share(options.energy_share);
        Ok(Self::at_first(executor, aircraft, triggers, options))
    }

    /// A flight under way: the executor as it is, the aircraft as it was reported last, in steady flight along its track.
    /// `None`: nothing is being flown, or nothing is known of the aircraft.
    pub fn under_way(mut executor: Executor, triggers: usize, options: &Options) -> Option<Self> {
        let known = executor.aircraft().filter(|_| executor.is_flying())?;
        // a preview counts time from its own beginning; the executor's clock goes on
        executor.set_last_step(Some(Time::ZERO));
        let place = |new: fn(Profile, geometry::LatLon, f64, f64) -> Aircraft| {
            new(executor.profile().clone(), known.position, known.altitude_amsl_m, known.track_deg)
        };
        let mut aircraft = place(if known.on_ground { Aircraft::on_runway } else { Aircraft::in_flight });
        aircraft.set_battery_share(known.battery);
        aircraft.set_engine_healthy(!known.engine_out);
        let mut at = Self::at_first(executor, aircraft, triggers, options);
        at.moment.place = at.executor.place();
        let begun = |place| LegPassage {
            place,
            start_s: 0.0,
            end_s: 0.0,
            distance_m: 0.0,
            energy_j: at.used_j(),
            waypoints: 0,
        };
        at.passage = at.moment.place.clone().map(begun);
        if !at.executor.is_muted() {
            at.buffer = at.executor.ahead().cloned().collect();
        }
        if let Some(front) = at.buffer.front() {
            at.guidance.direct(at.aircraft.state(), at.target(front));
        }
        Some(at)
    }

    fn at_first(executor: Executor, aircraft: Aircraft, triggers: usize, options: &Options) -> Self {
        let profile = aircraft.profile().clone();
        let habits = options.habits(&profile);
        Self {
            guidance: Guidance::with(profile, habits),
            executor,
            aircraft,
            buffer: VecDeque::new(),
            moment: Moment::default(),
            now_us: 0,
            due: Due::default(),
            stepped_us: 0,
            waiting_us: 0,
            requests: 0,
            fired: vec![false; triggers],
            ended: false,
            entered: false,
            began_us: 0,
            used_before_j: 0.0,
            distance_m: 0.0,
            passage: None,
            steered: None,
            passages: 0,
            waypoints: 0,
            renumbering: Renumbering::default(),
        }
    }

    /// A waypoint as the autopilot is told it, where nothing is known of the turn there.
    pub fn target(&self, waypoint: &Waypoint) -> Target {
        let tells = waypoint.on_arc && !waypoint.fly_over && self.guidance.habits().is_told_corners;
        let acceptance_m = tells.then(|| arc_acceptance_m(waypoint.airspeed_mps));
        Target { acceptance_m, ..Target::from(waypoint) }
    }

    /// A waypoint as the autopilot is told it that it goes on to from the one steered to, with the one after it.
    pub fn target_between(&self, waypoint: &Waypoint, onward: Option<&Waypoint>) -> Target {
        let target = self.target(waypoint);
        let is_left_early = self.guidance.habits().is_told_corners
            && target.action == aircraft::Action::Fly
            && !(waypoint.fly_over || waypoint.on_arc);
        // a take-off leads onto the line that begins where it was to end
        let leads = |action| matches!(action, aircraft::Action::Fly | aircraft::Action::TakeOff { .. });
        let from = self.guidance.target().filter(|t| is_left_early && leads(t.action));
        let acceptance_m = from.zip(onward).and_then(|(from, onward)| {
            turn_acceptance_m(from.position, waypoint.position, onward.position, waypoint.airspeed_mps)
        });
        Target { acceptance_m: acceptance_m.or(target.acceptance_m), ..target }
    }

    /// Behind a take-off: where it was to end, if the autopilot flies there first, and it lies ahead.
    pub fn climb_out(&self) -> Option<Target> {
        let habits = self.guidance.habits();
        let is_take_off = |target: &&Target| matches!(target.action, aircraft::Action::TakeOff { .. });
        let take_off = self.guidance.target().filter(is_take_off).filter(|_| habits.climbs_out)?;
        let state = self.aircraft.state();
        let ahead = LocalFrame::new(state.position).to_local(take_off.position);
        // as far away as can be told
        let acceptance_m = habits.is_told_corners.then_some(GREATEST_ACCEPTANCE_M);
        let place = Target { action: aircraft::Action::Fly, acceptance_m, ..*take_off };
        (ahead.dot(state.ground_velocity_mps) > 0.0).then_some(place)
    }

    /// Since the start, seconds.
    pub fn time_s(&self) -> f64 {
        seconds(self.now_us)
    }

    /// Energy that is gone of what the aircraft can hold, joules.
    pub fn used_j(&self) -> f64 {
        let battery = self.aircraft.battery();
        battery.capacity_j - battery.energy_left_j
    }

    /// Energy used in all flights of the plan so far, joules.
    pub fn used_in_all_j(&self) -> f64 {
        self.used_before_j + self.used_j()
    }

    /// Index of the passage being flown, among all of the flight.
    pub fn passage_index(&self) -> Option<usize> {
        self.passage.as_ref().map(|_| self.passages)
    }

    /// The leg being flown.
    pub fn leg(&self) -> Id {
        self.moment.place.as_ref().map_or_else(|| Id::new("start"), |p| p.leg.clone())
    }

    /// At its greatest speed it is still on the ground: the wind comes from behind.
    fn never_lifts_off(&self) -> bool {
        let takes_off = |target: &Target| matches!(target.action, aircraft::Action::TakeOff { .. });
        let state = self.aircraft.state();
        let is_fastest = state.ground_speed_mps() > self.aircraft.profile().max_airspeed_mps - 0.1;
        state.on_ground && is_fastest && self.guidance.target().is_some_and(takes_off)
    }

    /// It has flown longer or farther than it may, or has no energy left.
    pub fn exceeded(&self, options: &Options) -> Option<PreviewError> {
        let (seconds, leg) = (self.time_s(), self.leg());
        if seconds - self::seconds(self.began_us) > options.most_s {
            return Some(PreviewError::TooLong { seconds, leg });
        }
        if self.waypoints > options.most_waypoints {
            return Some(PreviewError::TooManyWaypoints { waypoints: options.most_waypoints, leg });
        }
        if self.never_lifts_off() {
            return Some(PreviewError::NoLiftOff { leg });
        }
        let empty = self.aircraft.battery().energy_left_j <= 0.0;
        empty.then_some(PreviewError::OutOfEnergy { seconds, leg })
    }
}

/// Microseconds as seconds.
pub(super) fn seconds(us: u64) -> f64 {
    us as f64 / 1e6
}

/// Seconds as microseconds.
pub(super) fn microseconds(seconds: f64) -> u64 {
    // a cast of a negative number gives 0
    (seconds * 1e6).round() as u64
}

fn placed(program: &Program, profile: &Profile, start: Start) -> Result<Aircraft, PreviewError> {
    match start {
        Start::InFlight { position, altitude_amsl_m, heading_deg } => {
            Ok(Aircraft::in_flight(profile.clone(), position, altitude_amsl_m, heading_deg))
        }
        Start::Runway => {
            let runway = program.plan.home().ok_or(PreviewError::NoStart)?;
            Ok(standing(runway, profile))
        }
    }
}

/// On a runway, ready to take off.
pub(super) fn standing(runway: &Runway, profile: &Profile) -> Aircraft {
    let (elevation_m, heading_deg) = (runway.elevation_amsl_m, runway.heading_deg);
    Aircraft::on_runway(profile.clone(), runway.threshold, elevation_m, heading_deg)
}
