//! Legs from what was drawn.

use super::course::{Approach, arc_centre};
use super::kind::LegChoice;
use crate::{
    Altitude, AltitudeReference, Area, Branch, Call, DecideBefore, EmergencyChoice, FlightPlan, Holding,
    HoldingLength, Id, IterativeForm, Leg, LegKind, Pattern, Place, PlanWaypoint, Scan, ScanEntry, ScanOrder,
    ScanStyle, Spacing, TurnDirection, Value,
};
use aircraft::Profile;
use geometry::LatLon;

/// Length of the straight legs of a holding, metres.
const HOLD_M: f64 = 600.0;
/// Above the legs around it, where a leg ends at an altitude of its own, metres.
const CLIMB_M: f64 = 50.0;
/// How far tracks go on beyond an area's edge, metres.
const OVERSHOOT_M: f64 = 50.0;
/// Height above the runway where the plan says nothing, metres.
const HEIGHT_M: f64 = 150.0;
/// Ahead of a fork, a decision is due, seconds.
const DECIDE_S: f64 = 30.0;

/// What was drawn.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawn {
    /// A place.
    Place(Place),
    /// An open line.
    Line(Vec<Place>),
    /// An outline, not closed.
    Area(Vec<LatLon>),
    /// A middle and a rim.
    Circle {
        /// Its middle.
        centre: Place,
        /// Metres.
        radius_m: f64,
    },
    /// Nothing.
    Nothing,
}

/// A leg of a kind where it was drawn; `None`: that can't be drawn so. `at`: how the path arrives there, as far as that is
/// known. `level`: the altitude in force there.
pub fn leg(
    plan: &FlightPlan,
    profile: &Profile,
    choice: LegChoice,
    drawn: &Drawn,
    at: Option<Approach>,
    level: Option<&Altitude>,
) -> Option<Leg> {
    Some(Leg {
        id: plan.fresh_id(choice.stem()),
        name: String::new(),
        emergency: EmergencyChoice::default(),
        altitude: needs_altitude(choice).then(|| raised(level)),
        speed_mps: None,
        next: None,
        actions: Vec::new(),
        kind: Maker::new(plan, profile, at).kind(choice, drawn)?,
    })
}

/// A call of a procedure, put there and turned to a bearing (`None`: as it was written). A procedure without a reference stays
/// where it is. `None`: there is no such procedure.
pub fn call(plan: &FlightPlan, procedure: &Id, anchor: Place, bearing_deg: Option<f64>) -> Option<Leg> {
    let procedure = plan.procedure(procedure)?;
    let movable = procedure.reference.is_some();
    let call = Call {
        procedure: procedure.id.clone(),
        arguments: Vec::new(),
        anchor: movable.then_some(anchor),
        bearing_deg: bearing_deg.filter(|_| movable).map(Value::Constant),
    };
    Some(Leg {
        id: plan.fresh_id(LegChoice::Call.stem()),
        name: String::new(),
        emergency: EmergencyChoice::default(),
        altitude: None,
        speed_mps: None,
        next: None,
        actions: Vec::new(),
        kind: LegKind::Call(call),
    })
}

/// A leg made another kind: it keeps its identifier, name, altitude, speed, actions and, as far as that can be, its place.
/// `None`: nothing of it can become that.
pub fn convert(
    plan: &FlightPlan,
    profile: &Profile,
    old: &Leg,
    choice: LegChoice,
    at: Option<Approach>,
) -> Option<Leg> {
    let maker = Maker::new(plan, profile, at);
    let kind = maker.kind(choice, &maker.drawn(&old.kind))?;
    let altitude = old.altitude.clone().or_else(|| needs_altitude(choice).then(|| raised(None)));
    Some(Leg { kind, altitude, ..old.clone() })
}

/// It ends at its own altitude.
fn needs_altitude(choice: LegChoice) -> bool {
    matches!(choice, LegChoice::Fa | LegChoice::Ha)
}

fn raised(level: Option<&Altitude>) -> Altitude {
    match level {
        Some(Altitude { metres: Value::Constant(metres), reference }) => {
            Altitude { metres: Value::Constant(metres + CLIMB_M), reference: *reference }
        }
        _ => Altitude { metres: Value::Constant(HEIGHT_M + CLIMB_M), reference: AltitudeReference::Home },
    }
}

struct Maker<'a> {
    plan: &'a FlightPlan,
    turn_radius_m: f64,
    at: Option<Approach>,
}

impl<'a> Maker<'a> {
    fn new(plan: &'a FlightPlan, profile: &Profile, at: Option<Approach>) -> Self {
        Self { plan, turn_radius_m: profile.turn_radius_m(profile.cruise_airspeed_mps), at }
    }

    fn kind(&self, choice: LegChoice, drawn: &Drawn) -> Option<LegKind> {
        Some(match choice {
            LegChoice::If | LegChoice::Tf | LegChoice::Df | LegChoice::Rf | LegChoice::Cf | LegChoice::Fa => {
                self.track(choice, place(drawn)?)?
            }
            LegChoice::Hf => LegKind::Hf(self.holding(place(drawn)?)),
            LegChoice::Ha => LegKind::Ha(self.holding(place(drawn)?)),
            LegChoice::Hm => LegKind::Hm {
                holding: self.holding(place(drawn)?),
                until: None,
                max_laps: Some(Value::Constant(3.0)),
            },
            LegChoice::Scan => self.scan(ScanStyle::Parallel, drawn)?,
            LegChoice::CreepingLine => self.scan(ScanStyle::Creeping, drawn)?,
            LegChoice::CrissCross => self.scan(ScanStyle::CrissCross, drawn)?,
            LegChoice::Contour => LegKind::Pattern(self.contour(drawn)?),
            LegChoice::TrackLine | LegChoice::Corridor => LegKind::Pattern(self.along(choice, drawn)?),
            LegChoice::Orbit
            | LegChoice::Spiral
            | LegChoice::ExpandingSquare
            | LegChoice::Sector
            | LegChoice::FigureEight => self.around(choice, drawn)?,
            LegChoice::Call => LegKind::Call(self.call(place(drawn)?)?),
            LegChoice::Iterative => empty_loop(),
            LegChoice::Intersection => one_way_on(),
        })
    }

    /// What would have been drawn for a leg.
    fn drawn(&self, kind: &LegKind) -> Drawn {
        let circle = |centre: &Place, radius: &Value<f64>| Drawn::Circle {
            centre: centre.clone(),
            radius_m: constant(radius).unwrap_or_else(|| self.usual_radius_m()),
        };
        match kind {
            LegKind::Scan(Scan { area, .. }) | LegKind::Pattern(Pattern::Contour { area, .. }) => {
                match area {
                    Area::Circle { centre, radius_m } => circle(centre, radius_m),
                    Area::Polygon { corners, .. } => Drawn::Area(corners.clone()),
                    Area::Expression(_) => Drawn::Nothing,
                }
            }
            LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => {
                Drawn::Line(route.clone())
            }
            LegKind::Orbit { centre, radius_m, .. }
            | LegKind::Pattern(
                Pattern::Spiral { centre, outer_radius_m: radius_m, .. }
                | Pattern::ExpandingSquare { centre, radius_m, .. }
                | Pattern::Sector { centre, radius_m, .. }
                | Pattern::FigureEight { centre, radius_m, .. },
            ) => circle(centre, radius_m),
            other => other.place().map_or(Drawn::Nothing, |place| Drawn::Place(place.clone())),
        }
    }

    fn track(&self, choice: LegChoice, place: Place) -> Option<LegKind> {
        let end = self.position(&place);
        let to = PlanWaypoint { place, fly_over: false };
        let course_deg = Value::Constant(self.course_to(end));
        Some(match choice {
            LegChoice::If => LegKind::If(to),
            LegChoice::Df => LegKind::Df { to, turn: None },
            LegChoice::Cf => LegKind::Cf { to, course_deg },
            LegChoice::Fa => LegKind::Fa { from: to, course_deg },
            LegChoice::Rf => {
                let (centre, turn) = arc_centre(&self.at?, end?)?;
                LegKind::Rf { to, centre, turn }
            }
            _ => LegKind::Tf(to),
        })
    }

    /// The way the path would arrive at a place, whole degrees; where it is there already, the way it goes.
    fn course_to(&self, end: Option<LatLon>) -> f64 {
        let way = self.at.zip(end).map(|(at, end)| at.from.inverse(end)).filter(|way| way.distance_m > 1.0);
        let course_deg = way.map(|way| way.bearing_end_deg).or_else(|| self.at?.course_deg);
        course_deg.map_or(0.0, |course_deg| geometry::geodesy::normalise_360(course_deg.round()))
    }

    fn holding(&self, place: Place) -> Holding {
        let course_deg = self.course_to(self.position(&place));
        Holding {
            fix: PlanWaypoint { place, fly_over: false },
            inbound_course_deg: Some(Value::Constant(course_deg)),
            turn: TurnDirection::Right,
            leg: HoldingLength::Distance(Value::Constant(HOLD_M)),
        }
    }

    fn scan(&self, style: ScanStyle, drawn: &Drawn) -> Option<LegKind> {
        let (area, reach_m) = self.area(drawn)?;
        Some(LegKind::Scan(Scan {
            area,
            style,
            spacing: self.spacing(reach_m),
            heading_deg: None,
            overshoot_m: Value::Constant(OVERSHOOT_M),
            entry: ScanEntry::Nearest,
            order: ScanOrder::Interleaved,
        }))
    }

    fn contour(&self, drawn: &Drawn) -> Option<Pattern> {
        let (area, _) = self.area(drawn)?;
        Some(Pattern::Contour {
            area,
            spacing: Spacing::Metres(Value::Constant(100.0)),
            loops: Some(Value::Constant(1.0)),
            levels: None,
            level_step_m: None,
            inward: true,
            turn: TurnDirection::Left,
        })
    }

    /// An area, and about how far it reaches from its middle, metres.
    fn area(&self, drawn: &Drawn) -> Option<(Area, f64)> {
        let circle = |centre: &Place, radius_m: f64| {
            (Area::Circle { centre: centre.clone(), radius_m: Value::Constant(radius_m.round()) }, radius_m)
        };
        Some(match drawn {
            Drawn::Area(corners) if corners.len() >= 3 => {
                let area = Area::Polygon { corners: corners.clone(), holes: Vec::new() };
                (area, reach_m(corners))
            }
            Drawn::Circle { centre, radius_m } => circle(centre, *radius_m),
            Drawn::Place(centre) => circle(centre, self.usual_radius_m()),
            _ => return None,
        })
    }

    fn along(&self, choice: LegChoice, drawn: &Drawn) -> Option<Pattern> {
        let Drawn::Line(route) = drawn else { return None };
        let (route, spacing) = (route.clone(), self.spacing(0.0));
        if route.len() < 2 {
            return None;
        }
        let width_m = Value::Constant((4.4 * self.turn_radius_m / 50.0).ceil() * 50.0);
        Some(match choice {
            LegChoice::Corridor => Pattern::Corridor { route, width_m, spacing },
            _ => Pattern::TrackLine { route, spacing, returns: true },
        })
    }

    fn around(&self, choice: LegChoice, drawn: &Drawn) -> Option<LegKind> {
        let (centre, reach_m) = self.circle(drawn)?;
        let (turn, spacing) = (TurnDirection::Left, self.spacing(reach_m));
        let heading_deg = Value::Constant(self.course_to(self.position(&centre)));
        let radius_m = Value::Constant(reach_m);
        Some(LegKind::Pattern(match choice {
            LegChoice::Spiral => Pattern::Spiral {
                centre,
                inner_radius_m: Value::Constant((1.5 * self.turn_radius_m).ceil().min(reach_m / 2.0)),
                outer_radius_m: radius_m,
                spacing,
                inward: true,
                turn,
            },
            LegChoice::ExpandingSquare => {
                Pattern::ExpandingSquare { centre, spacing, heading_deg, radius_m, turn }
            }
            LegChoice::Sector => {
                let (sectors, passes) = (Value::Constant(3.0), Value::Constant(1.0));
                Pattern::Sector { centre, radius_m, sectors, heading_deg, passes, turn }
            }
            LegChoice::FigureEight => {
                Pattern::FigureEight { centre, radius_m, heading_deg, turns: Value::Constant(2.0), turn }
            }
            _ => return Some(LegKind::Orbit { centre, radius_m, turns: Value::Constant(2.0), turn }),
        }))
    }

    /// A middle and a radius of whole metres.
    fn circle(&self, drawn: &Drawn) -> Option<(Place, f64)> {
        Some(match drawn {
            Drawn::Circle { centre, radius_m } => (centre.clone(), radius_m.round()),
            Drawn::Place(centre) => (centre.clone(), self.usual_radius_m()),
            Drawn::Area(corners) => (middle(corners)?, reach_m(corners).round()),
            Drawn::Line(_) | Drawn::Nothing => return None,
        })
    }

    fn call(&self, place: Place) -> Option<Call> {
        let procedure = self.plan.procedures.first()?;
        let anchor = procedure.reference.map(|_| place);
        Some(Call { procedure: procedure.id.clone(), arguments: Vec::new(), anchor, bearing_deg: None })
    }

    /// Neighbouring tracks are at least a turn apart; few enough that they can be told apart.
    fn spacing(&self, reach_m: f64) -> Spacing {
        let metres = (2.2 * self.turn_radius_m).max(reach_m / 5.0);
        Spacing::Metres(Value::Constant((metres / 10.0).ceil() * 10.0))
    }

    fn usual_radius_m(&self) -> f64 {
        (4.0 * self.turn_radius_m / 50.0).ceil() * 50.0
    }

    fn position(&self, place: &Place) -> Option<LatLon> {
        match place {
            Place::Fix(id) => self.plan.fix(id).map(|fix| fix.position),
            Place::Position(Value::Constant(at)) => Some(*at),
            Place::Position(Value::Expression(_)) => None,
        }
    }
}

/// To be filled.
fn empty_loop() -> LegKind {
    LegKind::Iterative {
        form: IterativeForm::Forward,
        count: Some(Value::Constant(2.0)),
        until: None,
        turn: TurnDirection::Left,
        body: Vec::new(),
    }
}

fn one_way_on() -> LegKind {
    LegKind::Intersection {
        branches: vec![Branch { id: Id::new("on"), label: "Go on".into(), next: None, when: None }],
        default: Some(Id::new("on")),
        decide_before: DecideBefore::Time(DECIDE_S),
    }
}

/// The place that was drawn, or the end or middle of what was.
fn place(drawn: &Drawn) -> Option<Place> {
    match drawn {
        Drawn::Place(place) | Drawn::Circle { centre: place, .. } => Some(place.clone()),
        Drawn::Line(route) => route.last().cloned(),
        Drawn::Area(corners) => middle(corners),
        Drawn::Nothing => None,
    }
}

fn middle(corners: &[LatLon]) -> Option<Place> {
    let frame = geometry::LocalFrame::around(corners)?;
    Some(Place::Position(Value::Constant(frame.origin())))
}

fn constant(value: &Value<f64>) -> Option<f64> {
    match value {
        Value::Constant(x) => Some(*x),
        Value::Expression(_) => None,
    }
}

/// From the middle of corners to the farthest, metres.
fn reach_m(corners: &[LatLon]) -> f64 {
    let Some(frame) = geometry::LocalFrame::around(corners) else { return 0.0 };
    corners.iter().map(|corner| frame.to_local(*corner).length()).fold(0.0, f64::max)
}
