//! New plans from a few answers: a runway, an aircraft, and what the flight is for.
//!
//! Every template has the same frame: take-off, a departure ahead of the runway with a climb in the hold, the mission, an
//! arrival with a descent in the hold, the approach, the landing; and an emergency plan for the way home from anywhere. A
//! template is a beginning: whoever drew it goes on with edits.

mod extent;
mod frame;
mod home;
mod mission;

pub use extent::Extent;
pub(crate) use frame::{GLIDE_SLOPE, climb_out};
pub use home::WayHome;
pub(crate) use home::{before_threshold_m, bring_home, return_name, returns_to};

use crate::figures;
use crate::uses::SlotMut;
use crate::{
    Altitude, AltitudeReference, EmergencyChoice, EmergencyPlan, Fix, FlightPlan, Holding, HoldingLength, Id,
    Leg, LegKind, Place, PlanWaypoint, Problem, Runway, Stage, StageKind, TurnDirection, Turnaround, Value,
    VariableValue, check,
};
use aircraft::Profile;
use frame::Frame;
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// Length of the straight legs of holds, metres.
const HOLD_M: f64 = 600.0;

/// What a camera sees across the track where nothing else is said, degrees.
pub const USUAL_ACROSS_DEG: f64 = 60.0;

/// The tracks of a survey.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Survey {
    /// Between neighbouring tracks, metres.
    pub spacing_m: f64,
    /// Share of what a usual camera sees on a track that it sees again on the next, over the highest ground around; below 0, if it does not see
    /// all.
    pub side_overlap: f64,
    /// Height of the tracks above that ground, metres.
    pub above_ground_m: f64,
}

/// What a flight is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Template {
    /// Once around the runway.
    Circuit,
    /// An area, scanned.
    Survey,
    /// A strip along a line.
    Corridor,
    /// An expanding square around a point.
    Search,
    /// Forth and back along a line.
    Patrol,
    /// A circle that follows a fire: scanned and orbited, again and again.
    FireWatch,
}

impl Template {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Survey, Self::Corridor, Self::Search, Self::Patrol, Self::FireWatch, Self::Circuit];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Circuit => "Circuit",
            Self::Survey => "Survey",
            Self::Corridor => "Corridor",
            Self::Search => "Search",
            Self::Patrol => "Patrol",
            Self::FireWatch => "Fire watch",
        }
    }

    /// What it does, in a line.
    pub fn about(self) -> &'static str {
        match self {
            Self::Circuit => "Once around the runway",
            Self::Survey => "An area, scanned in parallel tracks",
            Self::Corridor => "A strip along a line, in parallel tracks",
            Self::Search => "An expanding square around a point",
            Self::Patrol => "Forth and back between points",
            Self::FireWatch => "A circle that moves with a fire, scanned and orbited",
        }
    }
}

/// The answers that a plan is made of.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// What the flight is for.
    pub template: Template,
    /// Name of the aircraft's profile.
    pub aircraft: String,
    /// Where it takes off and lands.
    pub runway: Runway,
    /// Where the mission is; of no use to a circuit.
    pub extent: Extent,
    /// Of the mission above the runway, metres; more where the ground asks for it.
    pub height_m: f64,
}

impl Outline {
    /// The height at which the mission is flown, metres above the runway: as asked for, or as the highest known ground around runway
    /// and mission asks for.
    pub fn mission_height_m(&self, profile: &Profile, terrain: &dyn Terrain) -> f64 {
        Frame::new(self, profile, terrain).height_m
    }

    /// The same from the first of some runways whose plan has no errors, of which the ground around may leave only some; as it is, where
    /// there is none.
    pub fn flyable(
        self,
        runways: impl IntoIterator<Item = Runway>,
        profile: &Profile,
        terrain: &dyn Terrain,
    ) -> Self {
        let from = |runway| Self { runway, ..self.clone() };
        let flies = |outline: &Self| {
            let problems = check(&outline.plan(profile, terrain), profile, terrain);
            !problems.iter().any(Problem::is_error)
        };
        let found = std::iter::once(self.clone()).chain(runways.into_iter().map(from)).find(flies);
        found.unwrap_or(self)
    }

    /// The plan.
    pub fn plan(&self, profile: &Profile, terrain: &dyn Terrain) -> FlightPlan {
        let frame = Frame::new(self, profile, terrain);
        let mut plan = FlightPlan {
            name: format!("New {}", self.template.name().to_lowercase()),
            aircraft: self.aircraft.clone(),
            fixes: frame.fixes(),
            runways: vec![self.runway.clone()],
            variables: self.variables(),
            emergency: EmergencyChoice { by_cause: vec![(None, "return".into())] },
            ..FlightPlan::default()
        };
        let mission = self.mission(&frame, &mut plan.fixes);
        plan.stages = vec![frame.take_off(), frame.departure()];
        plan.stages.push(Stage {
            altitude: Some(above_home(frame.height_m)),
            legs: mission.into_iter().map(Arc::new).collect(),
            ..stage("mission", self.template.name(), StageKind::Mission)
        });
        plan.stages.extend(frame.way_home("", &[]));
        plan.emergency_plans = vec![EmergencyPlan {
            id: "return".into(),
            name: format!("Return to {}", self.runway.id),
            runway: self.runway.id.clone(),
            stages: frame.way_home("r-", &[]),
        }];
        in_round_figures(&mut plan);
        plan
    }
}

/// Where its legs and variables are was worked out.
fn in_round_figures(plan: &mut FlightPlan) {
    for variable in &mut plan.variables {
        if let VariableValue::Position(at) = &mut variable.initial {
            *at = figures::place(*at);
        }
    }
    for leg in plan.stages.iter_mut().flat_map(|stage| &mut stage.legs) {
        Arc::make_mut(leg).for_each_slot_mut(&mut |slot| match slot {
            SlotMut::Place(Place::Position(Value::Constant(at))) | SlotMut::Corner(at) => {
                *at = figures::place(*at)
            }
            _ => {}
        });
    }
}

fn above_home(metres: f64) -> Altitude {
    Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Home }
}

fn to(fix: &str) -> PlanWaypoint {
    PlanWaypoint { place: Place::Fix(Id::new(fix)), fly_over: false }
}

fn fix(id: &str, position: LatLon) -> Fix {
    let position = figures::place(position);
    Fix { id: Id::new(id), position, name: String::new(), description: String::new() }
}

fn hold(fix: &str, course_deg: f64, turn: TurnDirection) -> Holding {
    let leg = HoldingLength::Distance(Value::Constant(HOLD_M));
    Holding { fix: to(fix), inbound_course_deg: Some(Value::Constant(course_deg)), turn, leg }
}

fn leg(id: &str, name: &str, kind: LegKind) -> Leg {
    Leg {
        id: Id::new(id),
        name: name.into(),
        emergency: EmergencyChoice::default(),
        altitude: None,
        speed_mps: None,
        next: None,
        actions: Vec::new(),
        kind,
    }
}

fn stage(id: &str, name: &str, kind: StageKind) -> Stage {
    Stage {
        id: Id::new(id),
        name: name.into(),
        kind,
        emergency: EmergencyChoice::default(),
        runway: None,
        altitude: None,
        speed_mps: None,
        turnaround: Turnaround::default(),
        legs: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flat ground, and a steep hill.
    struct Hill(LatLon);
    impl Terrain for Hill {
        fn elevation_m(&self, at: LatLon) -> Option<f64> {
            Some(300.0 + (700.0 - 3.0 * at.distance_m(self.0)).max(0.0))
        }
    }

    /// The heading was chosen blindly, and the final of what was made went over a hill.
    #[test]
    fn a_plan_is_made_from_the_end_of_the_runway_that_it_can_be_flown_from() {
        let threshold = LatLon::new(36.3, -84.2);
        let heading_deg = 52.0;
        let runway = crate::create::runway(
            &FlightPlan::default(),
            threshold,
            threshold.destination(heading_deg, 600.0),
            300.0,
        );
        // below the hold where the final begins
        let hill =
            Hill(threshold.destination(heading_deg + 180.0, 2900.0).destination(heading_deg + 90.0, 220.0));
        let outline = Outline {
            template: Template::Circuit,
            aircraft: "trainer".into(),
            extent: Extent::Around { centre: threshold, radius_m: 800.0 },
            height_m: 150.0,
            runway: runway.clone(),
        };
        let profile = Profile::by_name("trainer").unwrap();
        let errors = |outline: &Outline, terrain: &dyn Terrain| {
            let problems = check(&outline.plan(&profile, terrain), &profile, terrain);
            problems.into_iter().filter(Problem::is_error).collect::<Vec<_>>()
        };
        assert!(!errors(&outline, &hill).is_empty());
        let other = || [crate::create::other_direction(&FlightPlan::default(), &runway, 300.0)];
        let flyable = outline.clone().flyable(other(), &profile, &hill);
        assert_eq!((errors(&flyable, &hill), flyable.runway.id.as_str()), (Vec::new(), "R23"));
        // where it can be flown as it was asked for, it is that
        let flat = outline.clone().flyable(other(), &profile, &terrain::Flat(300.0));
        assert_eq!(flat, outline);
    }
}
