//! The whole flight ahead of time: the executor against the simulated aircraft, faster than real time.
//!
//! The same `step` as aboard, the same guidance and dynamics as the simulator, no sockets and no clock: what is seen here is what
//! will be sent.

mod changes;
mod engine_out;
mod equivalence;
mod flight;
mod glide;
mod rehearsal;
mod scenario;
mod shift;
mod situation;
mod start;
mod what_if;

pub use aircraft::glide::GlidePoint;
pub(crate) use engine_out::Best;
pub use engine_out::{Glide, Reach, is_near_runway};
pub(crate) use glide::{names_engine, route};
pub(crate) use rehearsal::end_in_ground;
pub use rehearsal::{Diversion, Glided, Kept, Powered, Rehearsal, glide_instead};
pub use scenario::{Act, Scenario, Trigger, When};
pub use start::Start;
pub use what_if::WhatIf;

use crate::api::{Event, PlacePointer, ProposalReport, Refusal, Waypoint};
use crate::executor::Executor;
use crate::value::Config;
use aircraft::{Autopilot, Habits, Profile, Winds};
use flight::{Circumstances, Flight};
use flight_plan::{Id, Program};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use terrain::Terrain;

/// How far and how finely.
#[derive(Debug, Clone, PartialEq)]
pub struct Options {
    /// The executor's settings.
    pub config: Config,
    /// Longest flight, seconds of simulated time.
    pub most_s: f64,
    /// Most waypoints flown.
    pub most_waypoints: usize,
    /// Time between two points of the track, seconds.
    pub track_every_s: f64,
    /// Time step of the dynamics, seconds (0.02..=0.2).
    pub step_s: f64,
    /// Share of the energy that is there at the start, 0..=1.
    pub energy_share: f64,
    /// The autopilot whose habits it is flown with; `None`: close to the lines, at true airspeeds, as reviews fly.
    pub autopilot: Option<Autopilot>,
    /// Airspeeds are held as indicated ones whatever the habits.
    pub is_indicated: bool,
    /// So much warmer than the standard's is the air at any height, °C. That matters where airspeeds are indicated ones.
    pub isa_deviation_c: f64,
}

impl Options {
    /// How an aircraft is led.
    fn habits(&self, profile: &Profile) -> Habits {
        let habits = self.autopilot.map_or(Habits::CLOSE, |autopilot| autopilot.habits(profile));
        let is_indicated = habits.is_indicated || self.is_indicated;
        Habits { is_indicated, isa_deviation_c: self.isa_deviation_c, ..habits }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            config: Config::default(),
            most_s: 12.0 * 3600.0,
            most_waypoints: 200_000,
            track_every_s: 1.0,
            step_s: 0.1,
            energy_share: 1.0,
            autopilot: None,
            is_indicated: false,
            isa_deviation_c: 0.0,
        }
    }
}

/// A point of the previewed track.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct TrackPoint {
    /// Seconds since the start.
    pub time_s: f64,
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Airspeed, m/s.
    pub airspeed_mps: f64,
    /// Index of the passage in [`Preview::legs`]; `None` before the first leg.
    pub passage: Option<usize>,
    /// Pass of the innermost loop, from 1; 0 outside loops.
    pub iteration: u64,
}

/// One passage of a leg.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LegPassage {
    /// Where in the plan.
    pub place: PlacePointer,
    /// Seconds since the start at which it was entered.
    pub start_s: f64,
    /// Seconds since the start at which the next one was entered.
    pub end_s: f64,
    /// Distance over the ground, metres.
    pub distance_m: f64,
    /// Energy used, joules.
    pub energy_j: f64,
    /// Waypoints flown.
    pub waypoints: u64,
}

/// A stop on the ground between two flights of a plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// The stage that landed.
    pub stage: Id,
    /// So many of the [`Preview::legs`] are over: the next one belongs to the next flight.
    pub legs: usize,
    /// Seconds since the start at which it landed.
    pub from_s: f64,
    /// Seconds since the start at which the next flight begins.
    pub until_s: f64,
    /// Share of the energy with which it landed, 0..1.
    pub battery_left: f64,
    /// Share of the energy with which the next flight begins, 0..1.
    pub battery_after: f64,
}

/// A waypoint that was steered to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlownWaypoint {
    /// As it was issued.
    pub waypoint: Waypoint,
    /// Index of its passage in [`Preview::legs`].
    pub passage: Option<usize>,
    /// Seconds since the start at which the aircraft began to steer to it.
    pub from_s: f64,
    /// It was replaced before it was reached.
    pub replaced: bool,
}

/// A whole flight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Preview {
    /// Where the aircraft is when.
    pub track: Vec<TrackPoint>,
    /// Every waypoint steered to, in order.
    pub waypoints: Vec<FlownWaypoint>,
    /// What happened, with seconds since the start.
    pub events: Vec<(f64, Event)>,
    /// Commands of the scenario that were refused, with seconds since the start.
    pub refusals: Vec<(f64, Refusal)>,
    /// What the plans that the scenario put forward would have done, with seconds since the start.
    pub proposals: Vec<(f64, ProposalReport)>,
    /// Passages of legs, in order.
    pub legs: Vec<LegPassage>,
    /// Stops on the ground between the plan's flights, in order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stops: Vec<Stop>,
    /// Triggers of the scenario that never fired, by index.
    pub not_fired: Vec<usize>,
    /// Duration, seconds.
    pub time_s: f64,
    /// Distance over the ground, metres.
    pub distance_m: f64,
    /// Energy used, joules.
    pub energy_j: f64,
    /// Share of the energy left, 0..1.
    pub battery_left: f64,
    /// It ended on the ground.
    pub landed: bool,
}

/// Why there is no preview.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PreviewError {
    /// No take-off stage to start from.
    #[error("the plan has no take-off stage: say where in flight the preview should start")]
    NoStart,
    /// The executor refused to start.
    #[error("the plan can't be started: {0}")]
    Refused(Refusal),
    /// Longer than allowed.
    #[error(
        "after {seconds:.0} s the flight still goes on, at leg `{leg}`: give its loops a count or a condition that ends them"
    )]
    TooLong {
        /// The limit.
        seconds: f64,
        /// The leg being flown.
        leg: Id,
    },
    /// More waypoints than allowed.
    #[error(
        "after {waypoints} waypoints the flight still goes on, at leg `{leg}`: widen its pattern or shorten its loops"
    )]
    TooManyWaypoints {
        /// The limit.
        waypoints: usize,
        /// The leg being flown.
        leg: Id,
    },
    /// The battery is empty.
    #[error("the energy is used up after {seconds:.0} s, at leg `{leg}`: shorten the plan or land before")]
    OutOfEnergy {
        /// When.
        seconds: f64,
        /// The leg being flown.
        leg: Id,
    },
    /// It rolls as fast as it can, and does not lift off.
    #[error(
        "the aircraft can't take off with so much wind from behind, at leg `{leg}`: wait for less, or take off the other way"
    )]
    NoLiftOff {
        /// The leg being flown.
        leg: Id,
    },
    /// It holds or waits, and nothing in the scenario would make it go on.
    #[error(
        "after {seconds:.0} s the flight waits at leg `{leg}` and nobody goes on: give the intersection a default, or the holding an end"
    )]
    Waiting {
        /// When.
        seconds: f64,
        /// The leg being flown.
        leg: Id,
    },
    /// The callback said so.
    #[error("cancelled")]
    Cancelled,
}

/// What the progress callback gets.
#[derive(Debug, Clone, PartialEq)]
pub struct Advance {
    /// Simulated seconds so far.
    pub time_s: f64,
    /// Where the flight is.
    pub place: Option<PlacePointer>,
    /// Waypoints flown so far.
    pub waypoints: usize,
}

/// Flies a plan ahead of time.
///
/// # Errors
/// The flight can't start or doesn't end within the limits.
pub fn preview(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    winds: impl Into<Winds>,
    start: Start,
    scenario: &Scenario,
    options: &Options,
) -> Result<Preview, PreviewError> {
    let to_its_end = &mut |_: &Advance| true;
    match preview_as_far_as_possible(program, profile, terrain, winds, start, scenario, options, to_its_end)?
    {
        (flown, None) => Ok(flown),
        (_, Some(error)) => Err(error),
    }
}

/// As [`preview`], reporting about every ten simulated seconds; the callback returns false to cancel. A flight that ends too early is there
/// up to its end, with the reason.
///
/// # Errors
/// The flight can't start.
#[expect(
    clippy::too_many_arguments,
    reason = "the circumstances of a flight: each is known to another part of the caller"
)]
pub fn preview_as_far_as_possible(
    program: &Arc<Program>,
    profile: &Profile,
    terrain: &Arc<dyn Terrain>,
    winds: impl Into<Winds>,
    start: Start,
    scenario: &Scenario,
    options: &Options,
    progress: &mut dyn FnMut(&Advance) -> bool,
) -> Result<(Preview, Option<PreviewError>), PreviewError> {
    let given = Circumstances { winds: winds.into(), scenario, options };
    Ok(Flight::new(program, profile, terrain, start, given, false)?.flown_on(progress))
}

/// As [`preview_on`]; one that ends too early is there up to its end, with the reason. `None`: nothing is being flown.
pub(crate) fn preview_on_as_far_as_possible(
    flight: Executor,
    winds: impl Into<Winds>,
    scenario: &Scenario,
    options: &Options,
) -> Option<(Preview, Option<PreviewError>)> {
    let given = Circumstances { winds: winds.into(), scenario, options };
    Some(Flight::under_way(flight, given)?.flown_as_far_as_possible())
}

/// Flies on from where a flight under way is, with what is left of its energy; times are seconds from now.
///
/// # Errors
/// As [`preview`]; `NoStart`: nothing is being flown.
pub(crate) fn preview_on(
    flight: Executor,
    winds: impl Into<Winds>,
    scenario: &Scenario,
    options: &Options,
) -> Result<Preview, PreviewError> {
    let given = Circumstances { winds: winds.into(), scenario, options };
    Flight::under_way(flight, given).ok_or(PreviewError::NoStart)?.flown(&mut |_| true)
}
