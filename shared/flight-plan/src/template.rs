//! New plans from a few answers: a runway, an aircraft, and what the flight is for.
//!
//! Every template has the same frame: take-off, a departure ahead of the runway with a climb in the hold, the mission, an
//! arrival with a descent in the hold, the approach, the landing; and an emergency plan for the way home from anywhere. A
//! template is a beginning: whoever drew it goes on with edits.

use crate::{
    Altitude, AltitudeReference, Area, EmergencyChoice, EmergencyPlan, Fix, FlightPlan, Holding,
    HoldingLength, Id, IterativeForm, Leg, LegKind, Pattern, Place, PlanWaypoint, Runway, Scan, ScanEntry,
    ScanStyle, Spacing, Stage, StageKind, TurnDirection, Value, Variable, VariableValue,
};
use aircraft::Profile;
use geometry::LatLon;
use std::sync::Arc;
use terrain::Terrain;

/// Height above the runway at which a take-off ends, metres.
const CLIMB_OUT_M: f64 = 80.0;
/// Above the highest ground on the way, metres.
const CLEARANCE_M: f64 = 150.0;
/// Of the final above the ground under it, metres.
const LOWEST_M: f64 = 60.0;
/// Descent on the final, metres down per metre forward.
const GLIDE_SLOPE: f64 = 0.075;
/// Length of the straight legs of holds, metres.
const HOLD_M: f64 = 600.0;
/// The ground is looked at in a grid of so many by so many places.
const GRID: u32 = 24;

/// What a flight is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Template {
    /// Once around the runway.
    Circuit,
    /// A square area, scanned.
    Survey,
    /// A strip along a line.
    Corridor,
    /// An expanding square around a point.
    Search,
    /// Forth and back between three points.
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
            Self::Survey => "A square area, scanned in parallel tracks",
            Self::Corridor => "A strip along a line, flown up and down",
            Self::Search => "An expanding square around a point",
            Self::Patrol => "Forth and back between three points",
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
    /// The middle of the mission; of no use to a circuit.
    pub centre: LatLon,
    /// From the middle to the mission's edge, metres.
    pub radius_m: f64,
    /// Of the mission above the runway, metres; more where the ground asks for it.
    pub height_m: f64,
}

impl Outline {
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
        plan.stages.extend(frame.way_home(""));
        plan.emergency_plans = vec![EmergencyPlan {
            id: "return".into(),
            name: format!("Return to {}", self.runway.id),
            runway: self.runway.id.clone(),
            stages: frame.way_home("r-"),
        }];
        plan
    }

    /// The mission's legs; the fixes that they need are added.
    fn mission(&self, frame: &Frame<'_>, fixes: &mut Vec<Fix>) -> Vec<Leg> {
        // neighbouring tracks are a turn apart
        let least_m = 2.2 * frame.turn_radius_m;
        let spacing = Spacing::Metres(Value::Constant((self.radius_m / 5.0).max(least_m).ceil()));
        let heading_deg = self.runway.heading_deg;
        let from_centre =
            |bearing_deg: f64, metres: f64| self.centre.destination(heading_deg + bearing_deg, metres);
        let line = [from_centre(180.0, self.radius_m), self.centre, from_centre(0.0, self.radius_m)];
        match self.template {
            Template::Circuit => frame.circuit(fixes),
            Template::Survey => {
                let corners =
                    [-45.0, 45.0, 135.0, 225.0].map(|b| from_centre(b, self.radius_m * 2f64.sqrt()));
                let area = Area::Polygon { corners: corners.to_vec(), holes: Vec::new() };
                vec![leg("scan", "Scan the area", LegKind::Scan(scan(area, spacing)))]
            }
            Template::Corridor => {
                let route = line.map(|at| Place::Position(Value::Constant(at))).to_vec();
                let width_m = Value::Constant((self.radius_m / 2.0).clamp(100.0, 1000.0).round());
                let pattern = Pattern::Corridor { route, width_m, spacing };
                vec![leg("strip", "Along the line", LegKind::Pattern(pattern))]
            }
            Template::Search => {
                fixes.push(fix("DATUM", self.centre));
                let pattern = Pattern::ExpandingSquare {
                    centre: Place::Fix("DATUM".into()),
                    spacing,
                    heading_deg: Value::Constant(heading_deg),
                    radius_m: Value::Constant(self.radius_m),
                    turn: TurnDirection::Right,
                };
                vec![leg("search", "Search around the datum", LegKind::Pattern(pattern))]
            }
            Template::Patrol => {
                let ids = ["P1", "P2", "P3"];
                fixes.extend(ids.iter().zip(line).map(|(id, at)| fix(id, at)));
                patrol(ids)
            }
            Template::FireWatch => fire_watch(spacing),
        }
    }

    /// What the mission's legs read.
    fn variables(&self) -> Vec<Variable> {
        if self.template != Template::FireWatch {
            return Vec::new();
        }
        let radius = Variable::new("fire_radius".into(), VariableValue::Number(self.radius_m.round()));
        vec![
            Variable::new("fire_centre".into(), VariableValue::Position(self.centre)),
            Variable {
                unit: "m".into(),
                min: Some((self.radius_m / 2.0).max(200.0).round()),
                max: Some((self.radius_m * 1.2).round()),
                ..radius
            },
        ]
    }
}

/// Scan the fire, then look at it from its rim; twice.
fn fire_watch(spacing: Spacing) -> Vec<Leg> {
    let centre = || Place::Position(Value::Expression("fire_centre".into()));
    let radius_m = || Value::Expression("fire_radius".into());
    let area = Area::Circle { centre: centre(), radius_m: radius_m() };
    let (turns, turn) = (Value::Constant(1.0), TurnDirection::Left);
    let look = LegKind::Orbit { centre: centre(), radius_m: radius_m(), turns, turn };
    let body = vec![
        leg("sweep", "Scan the fire", LegKind::Scan(scan(area, spacing))),
        leg("look", "Around the fire", look),
    ];
    let watch = LegKind::Iterative {
        form: IterativeForm::Forward,
        count: Some(Value::Constant(2.0)),
        until: None,
        turn,
        body: body.into_iter().map(Arc::new).collect(),
    };
    vec![leg("watch", "Watch", watch)]
}

/// Climb-out altitude of a take-off.
pub(crate) fn climb_out() -> Altitude {
    above_home(CLIMB_OUT_M)
}

/// How far around a runway the ground is looked at for a way home, metres.
const HOME_REACH_M: f64 = 3000.0;

/// An emergency plan that brings the aircraft to a runway from anywhere, and the fixes that it needs. Fixes of the plan that are
/// in the right places are used.
pub(crate) fn bring_home(
    plan: &FlightPlan,
    id: &Id,
    runway: &Runway,
    profile: &Profile,
    terrain: &dyn Terrain,
) -> (Vec<Fix>, EmergencyPlan) {
    let outline = Outline {
        template: Template::Circuit,
        aircraft: plan.aircraft.clone(),
        runway: runway.clone(),
        centre: runway.threshold,
        radius_m: HOME_REACH_M,
        height_m: 150.0,
    };
    let mut frame = Frame::new(&outline, profile, terrain);
    let mut made = Vec::new();
    let mut on_final = |name: &str, position: LatLon| {
        let known = plan.fixes.iter().find(|fix| fix.position.distance_m(position) < 1.0);
        known.map_or_else(
            || {
                let id = plan.unique_id(name);
                made.push(fix(id.as_str(), position));
                id
            },
            |fix| fix.id.clone(),
        )
    };
    frame.final_fix = on_final("FINAL", frame.at(-frame.final_m, 0.0));
    frame.gate_fix = on_final("GATE", frame.at(-frame.gate_m, 0.0));
    // altitudes are above the take-off runway, wherever this one is
    let home_m = plan.home().map_or(runway.elevation_amsl_m, |home| home.elevation_amsl_m);
    let mut stages = frame.way_home(&format!("{id}-"));
    stages.iter_mut().for_each(|stage| raise(stage, runway.elevation_amsl_m - home_m));
    let name = format!("Return to {}", runway.id);
    (made, EmergencyPlan { id: id.clone(), name, runway: runway.id.clone(), stages })
}

fn raise(stage: &mut Stage, by_m: f64) {
    for leg in &mut stage.legs {
        if let Some(Altitude { metres: Value::Constant(metres), .. }) = &mut Arc::make_mut(leg).altitude {
            *metres += by_m;
        }
    }
}

/// To the first point, and twice forth and back between all of them.
fn patrol(ids: [&str; 3]) -> Vec<Leg> {
    let [first, second, third] = ids;
    let body = vec![
        leg("p1", "", LegKind::If(to(first))),
        leg("p2", "", LegKind::Tf(to(second))),
        leg("p3", "", LegKind::Tf(to(third))),
    ];
    let patrol = LegKind::Iterative {
        form: IterativeForm::Reverse,
        count: Some(Value::Constant(2.0)),
        until: None,
        turn: TurnDirection::Left,
        body: body.into_iter().map(Arc::new).collect(),
    };
    vec![leg("to-patrol", "To the patrol", LegKind::Tf(to(first))), leg("patrol", "Patrol", patrol)]
}

fn scan(area: Area, spacing: Spacing) -> Scan {
    Scan {
        area,
        style: ScanStyle::Parallel,
        spacing,
        heading_deg: None,
        overshoot_m: Value::Constant(50.0),
        entry: ScanEntry::Nearest,
    }
}

/// What all templates have in common: places around the runway, and heights above it.
struct Frame<'a> {
    runway: &'a Runway,
    turn_radius_m: f64,
    /// From the threshold to the departure's fix, metres.
    ahead_m: f64,
    /// From the threshold back to the beginning and to the gate of the final, metres.
    final_m: f64,
    gate_m: f64,
    /// Of the mission, metres above the runway.
    height_m: f64,
    /// Of the highest ground under the final, metres above the runway.
    hill_m: f64,
    /// The fixes where the final begins, and lower on it.
    final_fix: Id,
    gate_fix: Id,
}

impl<'a> Frame<'a> {
    fn new(outline: &'a Outline, profile: &Profile, terrain: &dyn Terrain) -> Self {
        let turn_radius_m = profile.turn_radius_m(profile.cruise_airspeed_mps);
        let mut frame = Self {
            runway: &outline.runway,
            turn_radius_m,
            ahead_m: outline.runway.length_m + (8.0 * turn_radius_m).max(1000.0),
            final_m: (20.0 * turn_radius_m).max(2600.0),
            gate_m: (9.0 * turn_radius_m).max(1200.0),
            height_m: outline.height_m,
            hill_m: 0.0,
            final_fix: "FINAL".into(),
            gate_fix: "GATE".into(),
        };
        frame.hill_m = frame.hill_on_final(terrain);
        let hilltop_m = frame.highest_ground(outline, terrain) - outline.runway.elevation_amsl_m;
        frame.height_m = (outline.height_m.max(hilltop_m + CLEARANCE_M) / 10.0).ceil() * 10.0;
        frame
    }

    /// The highest known ground around runway and mission, metres AMSL; the runway's own where none is known.
    fn highest_ground(&self, outline: &Outline, terrain: &dyn Terrain) -> f64 {
        let margin_m = outline.radius_m * 1.5 + 6.0 * self.turn_radius_m;
        let around = [0.0, 90.0, 180.0, 270.0].map(|bearing| outline.centre.destination(bearing, margin_m));
        let places = [self.at(self.ahead_m, 0.0), self.at(-self.final_m, 0.0), self.at(0.0, self.side_m())];
        let (south_west, north_east) = bounds(around.into_iter().chain(places));
        let share = |i: u32, from: f64, to: f64| from + (to - from) * f64::from(i) / f64::from(GRID);
        let grid = (0..=GRID).flat_map(|i| (0..=GRID).map(move |j| (i, j)));
        grid.filter_map(|(i, j)| {
            let lat_deg = share(i, south_west.lat_deg, north_east.lat_deg);
            terrain.elevation_m(LatLon { lat_deg, lon_deg: share(j, south_west.lon_deg, north_east.lon_deg) })
        })
        .fold(self.runway.elevation_amsl_m, f64::max)
    }

    /// The highest known ground between the final's beginning and its gate, metres above the runway.
    fn hill_on_final(&self, terrain: &dyn Terrain) -> f64 {
        let share = |i: u32| self.gate_m + (self.final_m - self.gate_m) * f64::from(i) / f64::from(GRID);
        let ground = (0..=GRID).filter_map(|i| terrain.elevation_m(self.at(-share(i), 0.0)));
        ground.fold(0.0, |hill_m: f64, at_m| hill_m.max(at_m - self.runway.elevation_amsl_m))
    }

    /// So many metres in the runway's direction from its threshold, and to its right.
    fn at(&self, ahead_m: f64, right_m: f64) -> LatLon {
        let heading_deg = self.runway.heading_deg;
        self.runway.threshold.destination(heading_deg, ahead_m).destination(heading_deg + 90.0, right_m)
    }

    /// From the runway's line to the downwind of a circuit, metres.
    fn side_m(&self) -> f64 {
        (5.0 * self.turn_radius_m).max(900.0)
    }

    fn gate_height_m(&self) -> f64 {
        (self.gate_m * GLIDE_SLOPE).min(self.final_height_m()).max(self.hill_m + LOWEST_M).round()
    }

    /// Not above the mission: a mission that ends beside the final would leave no room to climb there.
    fn final_height_m(&self) -> f64 {
        (self.final_m * GLIDE_SLOPE).min(self.height_m).max(self.hill_m + 2.0 * LOWEST_M).round()
    }

    fn fixes(&self) -> Vec<Fix> {
        vec![
            fix("DEP", self.at(self.ahead_m, 0.0)),
            fix(self.final_fix.as_str(), self.at(-self.final_m, 0.0)),
            fix(self.gate_fix.as_str(), self.at(-self.gate_m, 0.0)),
        ]
    }

    fn take_off(&self) -> Stage {
        let (runway, altitude) = (Some(self.runway.id.clone()), Some(above_home(CLIMB_OUT_M)));
        Stage { runway, altitude, ..stage("take-off", "Take-off", StageKind::TakeOff) }
    }

    /// Ahead of the runway, and up in a hold to the mission's height.
    fn departure(&self) -> Stage {
        let heading_deg = self.runway.heading_deg;
        let climb = LegKind::Ha(hold("DEP", heading_deg, TurnDirection::Right));
        let legs = vec![
            Leg {
                altitude: Some(above_home(CLIMB_OUT_M + 20.0)),
                ..leg("d1", "Runway track", LegKind::Tf(to("DEP")))
            },
            Leg { altitude: Some(above_home(self.height_m)), ..leg("d2", "Climb in the hold", climb) },
        ];
        let legs = legs.into_iter().map(Arc::new).collect();
        Stage { legs, ..stage("departure", "Departure", StageKind::Departure) }
    }

    /// Downwind, beside the runway.
    fn circuit(&self, fixes: &mut Vec<Fix>) -> Vec<Leg> {
        fixes.push(fix("CROSS", self.at(self.ahead_m, self.side_m())));
        fixes.push(fix("DOWN", self.at(-self.gate_m, self.side_m())));
        vec![
            leg("crosswind", "Crosswind", LegKind::Tf(to("CROSS"))),
            leg("downwind", "Downwind", LegKind::Tf(to("DOWN"))),
        ]
    }

    /// From anywhere to the runway. `prefix`: of the identifiers.
    fn way_home(&self, prefix: &str) -> Vec<Stage> {
        let id = |text: &str| format!("{prefix}{text}");
        let holding = hold(self.final_fix.as_str(), self.runway.heading_deg, TurnDirection::Right);
        let (height_m, final_m) = (self.height_m, self.final_height_m());
        let line_up = if height_m > final_m { LegKind::Ha(holding) } else { LegKind::Hf(holding) };
        let direct = LegKind::Df { to: to(self.final_fix.as_str()), turn: None };
        let arrival = vec![
            Leg { altitude: Some(above_home(height_m)), ..leg(&id("a1"), "Direct to the final", direct) },
            Leg { altitude: Some(above_home(final_m)), ..leg(&id("a2"), "Descend in the hold", line_up) },
        ];
        let approach = Leg {
            altitude: Some(above_home(self.gate_height_m())),
            ..leg(&id("ap1"), "Final approach", LegKind::Tf(to(self.gate_fix.as_str())))
        };
        let runway = Some(self.runway.id.clone());
        vec![
            Stage {
                legs: arrival.into_iter().map(Arc::new).collect(),
                ..stage(&id("arrival"), "Arrival", StageKind::Arrival)
            },
            Stage {
                legs: vec![Arc::new(approach)],
                ..stage(&id("approach"), "Approach", StageKind::Approach)
            },
            Stage { runway, ..stage(&id("land"), "Landing", StageKind::Land) },
        ]
    }
}

/// The box around places, none of them near the antimeridian.
fn bounds(places: impl Iterator<Item = LatLon>) -> (LatLon, LatLon) {
    let nothing = (LatLon::new(90.0, 180.0), LatLon::new(-90.0, -180.0));
    places.fold(nothing, |(low, high), at| {
        (
            LatLon { lat_deg: low.lat_deg.min(at.lat_deg), lon_deg: low.lon_deg.min(at.lon_deg) },
            LatLon { lat_deg: high.lat_deg.max(at.lat_deg), lon_deg: high.lon_deg.max(at.lon_deg) },
        )
    })
}

fn above_home(metres: f64) -> Altitude {
    Altitude { metres: Value::Constant(metres), reference: AltitudeReference::Home }
}

fn to(fix: &str) -> PlanWaypoint {
    PlanWaypoint { place: Place::Fix(Id::new(fix)), fly_over: false }
}

fn fix(id: &str, position: LatLon) -> Fix {
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
        legs: Vec::new(),
    }
}
