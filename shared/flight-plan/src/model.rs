//! The flight plan as a value. Immutable by habit: edits make a new plan.
//!
//! Everything that can be an expression over the plan's variables is a [`Value`]. Broken
//! drafts are representable on purpose; the checks say what is wrong with them.

mod action;
mod pattern;
mod procedure;
mod zone;

pub use action::{Act, LegAction, Trigger};
pub use pattern::{Area, Pattern, Scan, ScanEntry, ScanOrder, ScanStyle, Spacing};
pub use procedure::{Call, Parameter, Procedure};
pub use zone::{Zone, ZoneKind, ZoneShape, ZoneTime};

use geometry::LatLon;
use serde::{Deserialize, Serialize};
use smol_str::SmolStr;
use std::sync::Arc;

/// An identifier of the document: letters, digits, `-`, `_`, `.`; unique, stable across edits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Id(SmolStr);

impl Id {
    /// From its text.
    pub fn new(text: &str) -> Self {
        Self(text.into())
    }
    /// Its text.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl std::borrow::Borrow<str> for Id {
    fn borrow(&self) -> &str {
        &self.0
    }
}

impl From<&str> for Id {
    fn from(text: &str) -> Self {
        Self::new(text)
    }
}

impl std::fmt::Display for Id {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// A whole document: the main plan and every alternative.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FlightPlan {
    /// What people call it.
    pub name: String,
    /// The aircraft profile it was written for (`aircraft::Profile::name`).
    pub aircraft: String,
    /// Named positions.
    pub fixes: Vec<Fix>,
    /// Runways, for take-off, landing and emergencies.
    pub runways: Vec<Runway>,
    /// Typed values that services write in flight.
    pub variables: Vec<Variable>,
    /// Where the flight must and must not be.
    pub zones: Vec<Zone>,
    /// Fragments that legs call.
    pub procedures: Vec<Procedure>,
    /// Emergency plan of everything that names none of its own.
    pub emergency: EmergencyChoice,
    /// The main plan's stages, in order.
    pub stages: Vec<Stage>,
    /// Partial plans, each ending on a runway.
    pub emergency_plans: Vec<EmergencyPlan>,
}

/// A named position.
#[derive(Debug, Clone, PartialEq)]
pub struct Fix {
    /// Its identifier.
    pub id: Id,
    /// Where it is.
    pub position: LatLon,
    /// What people call it.
    pub name: String,
    /// For the reader.
    pub description: String,
}

/// A runway, seen in its landing direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Runway {
    /// Its identifier.
    pub id: Id,
    /// Landing threshold.
    pub threshold: LatLon,
    /// Threshold elevation, metres AMSL.
    pub elevation_amsl_m: f64,
    /// Landing direction, degrees true.
    pub heading_deg: f64,
    /// Usable length, metres.
    pub length_m: f64,
    /// Preference among usable runways; 1 is the best.
    pub priority: u32,
    /// Where an approach to it starts, if charted.
    pub approach_entry: Option<LatLon>,
}

impl Runway {
    /// As a strip of ground.
    pub fn strip(&self) -> aircraft::Strip {
        aircraft::Strip { threshold: self.threshold, heading_deg: self.heading_deg, length_m: self.length_m }
    }

    /// The same runway from its other end, of which only the place is known.
    pub fn from_other_end(&self) -> Self {
        let aircraft::Strip { threshold, heading_deg, .. } = self.strip().from_other_end();
        Self { threshold, heading_deg, approach_entry: None, ..self.clone() }
    }
}

/// A variable's type and initial value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", content = "value", rename_all = "kebab-case")]
pub enum VariableValue {
    /// True or false.
    Bool(bool),
    /// A number, in the variable's unit.
    Number(f64),
    /// Free text.
    Text(String),
    /// A position.
    Position(LatLon),
    /// A simple polygon: its corners, not closed.
    Polygon(Vec<LatLon>),
}

/// A typed, bounded variable of the plan.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Its name, an identifier of the expression language.
    pub name: Id,
    /// Type and value at the start.
    pub initial: VariableValue,
    /// Unit of a number, for the reader (`m`, `deg`, …).
    pub unit: String,
    /// Least value of a number.
    pub min: Option<f64>,
    /// Greatest value of a number.
    pub max: Option<f64>,
    /// Longest text, characters; most corners of a polygon.
    pub max_length: Option<usize>,
    /// Who may write it in flight: names of services, or `operator`. Empty: anybody.
    pub writers: Vec<Id>,
}

impl Variable {
    /// Without a unit and without limits; anybody may write it.
    pub fn new(name: Id, initial: VariableValue) -> Self {
        Self {
            name,
            initial,
            unit: String::new(),
            min: None,
            max: None,
            max_length: None,
            writers: Vec::new(),
        }
    }
}

/// Which emergency plan applies, possibly by cause; the entry without a cause is the fallback.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EmergencyChoice {
    /// `(cause, emergency plan id)`; cause `None` is the fallback. Empty: inherit from outside.
    pub by_cause: Vec<(Option<Cause>, Id)>,
}

/// Why an emergency was raised.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Operator's decision, no other cause known. The least severe.
    Operator,
    /// A payload failed.
    Payload,
    /// Traffic conflict.
    Traffic,
    /// Ground link lost.
    Link,
    /// Position no longer known.
    Gps,
    /// Fuel or battery too low for the plan.
    Energy,
    /// Engine failure. The most severe.
    Engine,
}

impl Cause {
    /// The most severe first.
    pub const ALL: [Self; 7] =
        [Self::Engine, Self::Energy, Self::Gps, Self::Link, Self::Traffic, Self::Payload, Self::Operator];
}

/// What a stage is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StageKind {
    /// Performed by the autopilot: names a runway and a climb-out altitude.
    TakeOff,
    /// From the runway to the route.
    Departure,
    /// Between departure and mission, or mission and arrival.
    EnRoute,
    /// What the flight is for.
    Mission,
    /// From the route to the approach.
    Arrival,
    /// To the runway.
    Approach,
    /// Performed by the autopilot: names a runway.
    Land,
}

impl StageKind {
    /// What people call a stage of this kind that has no name of its own.
    pub fn name(self) -> &'static str {
        match self {
            Self::TakeOff => "Take-off",
            Self::Departure => "Departure",
            Self::EnRoute => "En route",
            Self::Mission => "Mission",
            Self::Arrival => "Arrival",
            Self::Approach => "Approach",
            Self::Land => "Landing",
        }
    }
}

/// A group of legs with one purpose.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// Its identifier.
    pub id: Id,
    /// What people call it.
    pub name: String,
    /// What it is for.
    pub kind: StageKind,
    /// Emergency plan of its legs.
    pub emergency: EmergencyChoice,
    /// Runway of a take-off or land stage.
    pub runway: Option<Id>,
    /// Climb-out altitude of a take-off; default altitude of its legs otherwise.
    pub altitude: Option<Altitude>,
    /// Default airspeed of its legs, m/s.
    pub speed_mps: Option<Value<f64>>,
    /// Of a landing behind which the plan goes on with another flight.
    pub turnaround: Turnaround,
    /// Its legs, in order; empty for take-off and land. Plans that were edited share what is the same in them.
    pub legs: Vec<Arc<Leg>>,
}

/// What is expected to happen on the ground between two flights.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turnaround {
    /// The energy that the next flight begins with; `None`: all of it.
    pub energy: Option<TurnaroundEnergy>,
    /// How long it takes, seconds; `None`: no time.
    pub time_s: Option<f64>,
}

impl Turnaround {
    /// Share of the energy that the next flight begins with, 0..1, if `left` is there after the landing.
    pub fn energy_after(&self, left: f64) -> f64 {
        match self.energy {
            None => 1.0,
            Some(TurnaroundEnergy::Share(share)) => share.clamp(0.0, 1.0),
            Some(TurnaroundEnergy::Kept) => left,
        }
    }
}

/// The energy that the flight behind a landing begins with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TurnaroundEnergy {
    /// A share of what the aircraft holds, 0..1: it is charged, fuelled, or gets another battery.
    Share(f64),
    /// What the flight before left.
    Kept,
}

impl TurnaroundEnergy {
    /// [`Self::Kept`] in a document.
    pub(crate) const KEPT: &'static str = "kept";
}

impl std::fmt::Display for TurnaroundEnergy {
    /// As in a document.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Share(share) => write!(f, "{share}"),
            Self::Kept => f.write_str(Self::KEPT),
        }
    }
}

/// An alternative that ends on a runway.
#[derive(Debug, Clone, PartialEq)]
pub struct EmergencyPlan {
    /// Its identifier.
    pub id: Id,
    /// What people call it.
    pub name: String,
    /// Where it lands.
    pub runway: Id,
    /// Its stages; the first leg is a DF so that it can be entered from anywhere.
    pub stages: Vec<Stage>,
}

/// What an altitude is measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AltitudeReference {
    /// Mean sea level.
    Amsl,
    /// The terrain below.
    Agl,
    /// The take-off runway's elevation.
    Home,
}

impl AltitudeReference {
    /// What they are called in the document.
    pub const NAMES: [(&str, AltitudeReference); 3] = [
        ("amsl", AltitudeReference::Amsl),
        ("agl", AltitudeReference::Agl),
        ("home", AltitudeReference::Home),
    ];

    /// What it is called in the document.
    pub fn name(self) -> &'static str {
        match self {
            AltitudeReference::Amsl => "amsl",
            AltitudeReference::Agl => "agl",
            AltitudeReference::Home => "home",
        }
    }
}

/// An altitude with its datum.
#[derive(Debug, Clone, PartialEq)]
pub struct Altitude {
    /// Metres.
    pub metres: Value<f64>,
    /// Above what.
    pub reference: AltitudeReference,
}

/// A constant, or a CEL expression over the plan's variables (written `= expression`).
#[derive(Debug, Clone, PartialEq)]
pub enum Value<T> {
    /// A constant.
    Constant(T),
    /// CEL source, without the leading `=`.
    Expression(Arc<str>),
}

/// Which way a turn goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TurnDirection {
    /// Anticlockwise seen from above.
    Left,
    /// Clockwise seen from above.
    Right,
}

/// Where a leg goes.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// A fix of the plan.
    Fix(Id),
    /// A position, or an expression that gives one.
    Position(Value<LatLon>),
}

/// A waypoint of a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanWaypoint {
    /// Where.
    pub place: Place,
    /// Cross it before turning (fly-over) instead of cutting the corner (fly-by).
    pub fly_over: bool,
}

/// One leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// Its identifier, unique in the document, stable across edits.
    pub id: Id,
    /// What people call it.
    pub name: String,
    /// Emergency plan while on it (and inside it).
    pub emergency: EmergencyChoice,
    /// Altitude at its end; default: the enclosing control leg's or the stage's, else the previous one's.
    pub altitude: Option<Altitude>,
    /// Airspeed on it, m/s; default: as for the altitude, else the aircraft's cruise speed.
    pub speed_mps: Option<Value<f64>>,
    /// The leg that follows, when it is not the next in the document (same list only).
    pub next: Option<Id>,
    /// What is done on the way.
    pub actions: Vec<LegAction>,
    /// What it is.
    pub kind: LegKind,
}

/// The racetrack of a holding leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Holding {
    /// The hold fix.
    pub fix: PlanWaypoint,
    /// Inbound course, degrees true; `None`: the course on which the aircraft arrives.
    pub inbound_course_deg: Option<Value<f64>>,
    /// Turn direction.
    pub turn: TurnDirection,
    /// Length of the straight legs.
    pub leg: HoldingLength,
}

/// How long the straight legs of a racetrack are.
#[derive(Debug, Clone, PartialEq)]
pub enum HoldingLength {
    /// Metres.
    Distance(Value<f64>),
    /// Seconds at the leg's airspeed.
    Time(Value<f64>),
}

/// How an iterative leg loops.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum IterativeForm {
    /// Every pass in the legs' own direction (form B).
    Forward,
    /// Forth and back, with a full turn at each end (form A).
    Reverse,
    /// A procedure that is called: one pass, and no loop for `iteration`. Only in [`crate::Program::flown`], never in a document.
    Once,
}

/// A branch of an intersection.
#[derive(Debug, Clone, PartialEq)]
pub struct Branch {
    /// Its identifier.
    pub id: Id,
    /// What the operator reads.
    pub label: String,
    /// The leg it leads to: in the same list, or `None` for the leg after the intersection.
    pub next: Option<Id>,
    /// Taken when this CEL condition holds and there is no decision.
    pub when: Option<Arc<str>>,
}

/// When a decision is due before the intersection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DecideBefore {
    /// Seconds of flight.
    Time(f64),
    /// Metres of path.
    Distance(f64),
}

/// What a leg is.
#[derive(Debug, Clone, PartialEq)]
pub enum LegKind {
    /// Where a path starts; flies nothing.
    If(PlanWaypoint),
    /// Geodesic track from the previous waypoint.
    Tf(PlanWaypoint),
    /// Straight from the aircraft's position.
    Df {
        /// Where to.
        to: PlanWaypoint,
        /// First turn, if it must be one way.
        turn: Option<TurnDirection>,
    },
    /// Constant-radius arc.
    Rf {
        /// Its end.
        to: PlanWaypoint,
        /// Its centre.
        centre: LatLon,
        /// Its direction.
        turn: TurnDirection,
    },
    /// A course into a fix, intercepted and tracked.
    Cf {
        /// The fix.
        to: PlanWaypoint,
        /// The course at the fix, degrees true.
        course_deg: Value<f64>,
    },
    /// A track from a fix until the leg's altitude is reached.
    Fa {
        /// The fix.
        from: PlanWaypoint,
        /// The track's direction at the fix, degrees true.
        course_deg: Value<f64>,
    },
    /// Racetrack, left at the first crossing of its fix.
    Hf(Holding),
    /// Racetrack, left at the first crossing at or beyond the leg's altitude.
    Ha(Holding),
    /// Racetrack, left at the first crossing after its condition holds, an operator released it (skip), or its laps are flown.
    Hm {
        /// The racetrack.
        holding: Holding,
        /// CEL condition read at each crossing; `None`: left by a command or by its laps.
        until: Option<Arc<str>>,
        /// Most laps; `None`: any number.
        max_laps: Option<Value<f64>>,
    },
    /// A loop over a body.
    Iterative {
        /// Forth and back, or round and round.
        form: IterativeForm,
        /// Arrivals at the end of the final leg, forward; the upper bound if `until` is there too.
        count: Option<Value<f64>>,
        /// CEL condition read at each of those arrivals.
        until: Option<Arc<str>>,
        /// Turn direction of form A's full turns.
        turn: TurnDirection,
        /// The legs.
        body: Vec<Arc<Leg>>,
    },
    /// Fork and/or merge.
    Intersection {
        /// Ways on; empty or one: a pure merge.
        branches: Vec<Branch>,
        /// The branch taken without a decision.
        default: Option<Id>,
        /// When the decision is due.
        decide_before: DecideBefore,
    },
    /// Straight tracks over an area, bound to variables.
    Scan(Scan),
    /// Another pattern, bound to variables.
    Pattern(Pattern),
    /// A procedure, called.
    Call(Call),
    /// A circle flown a number of times, then left at its nearest point to what follows.
    Orbit {
        /// Its centre.
        centre: Place,
        /// Its radius, metres.
        radius_m: Value<f64>,
        /// Turns, at least a quarter.
        turns: Value<f64>,
        /// Direction.
        turn: TurnDirection,
    },
}
