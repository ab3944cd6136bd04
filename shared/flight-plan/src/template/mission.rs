//! What is flown between the way out and the way home.

use super::frame::Frame;
use super::{Extent, Outline, Survey, Template, USUAL_ACROSS_DEG, fix, leg, to};
use crate::{
    Area, Fix, IterativeForm, Leg, LegKind, Pattern, Place, Scan, ScanEntry, ScanOrder, ScanStyle, Spacing,
    TurnDirection, Value, Variable, VariableValue,
};
use aircraft::Profile;
use geometry::LatLon;
use geometry::scan::camera_spacing_m;
use std::sync::Arc;
use terrain::Terrain;

/// Width of the strip along a line that was drawn, metres.
const STRIP_M: f64 = 200.0;
/// A fire may grow to so many times its radius.
const GROWN: f64 = 1.2;
/// So much of what is seen on one track of a survey is seen again on the next.
const SIDE_OVERLAP: f64 = 0.7;
/// From track to track a turn is so many radii long, with the overshoot.
const TURN_RADII: f64 = 6.0;
/// How often a fire is scanned.
const PASSES: f64 = 2.0;

impl Outline {
    /// The mission's legs; the fixes that they need are added.
    pub(super) fn mission(&self, frame: &Frame<'_>, fixes: &mut Vec<Fix>) -> Vec<Leg> {
        let spacing = self.spacing(frame);
        let heading_deg = self.runway.heading_deg;
        match self.template {
            Template::Circuit => frame.circuit(fixes),
            Template::Survey => {
                let area = Area::Polygon { corners: self.extent.corners(heading_deg), holes: Vec::new() };
                vec![leg("scan", "Scan the area", LegKind::Scan(scan(area, spacing)))]
            }
            Template::Corridor => vec![leg("strip", "Along the line", self.corridor(spacing))],
            Template::Search => {
                fixes.push(fix("DATUM", self.extent.centre()));
                vec![leg("search", "Search around the datum", self.search(spacing))]
            }
            Template::Patrol => {
                let points = self.extent.line(heading_deg);
                let ids: Vec<String> = (1..=points.len()).map(|n| format!("P{n}")).collect();
                fixes.extend(ids.iter().zip(points).map(|(id, at)| fix(id, at)));
                patrol(&ids)
            }
            Template::FireWatch => fire_watch(spacing),
        }
    }

    /// How a survey is seen by a usual camera; `None`: it is another mission.
    pub fn survey(&self, profile: &Profile, terrain: &dyn Terrain) -> Option<Survey> {
        let frame = Frame::new(self, profile, terrain);
        let spacing_m = Some(self.spacing_m(&frame)).filter(|_| self.template == Template::Survey)?;
        let above_ground_m = frame.above_ground_m;
        let seen_m = camera_spacing_m(above_ground_m, USUAL_ACROSS_DEG, 0.0).ok()?;
        Some(Survey { spacing_m, side_overlap: 1.0 - spacing_m / seen_m, above_ground_m })
    }

    fn spacing(&self, frame: &Frame<'_>) -> Spacing {
        Spacing::Metres(Value::Constant(self.spacing_m(frame)))
    }

    /// Neighbouring tracks are a turn apart, those of a survey as far as its pictures overlap; and not so many that the energy doesn't last.
    fn spacing_m(&self, frame: &Frame<'_>) -> f64 {
        let least_m = 2.2 * frame.turn_radius_m;
        let (half_m, radius_m) = (self.extent.half_width_m(), self.extent.radius_m());
        let scanned_m2 = match self.template {
            Template::Search => 4.0 * half_m * radius_m,
            Template::FireWatch => PASSES * 4.0 * (GROWN * half_m) * (GROWN * radius_m),
            Template::Corridor => 2.0 * radius_m * self.strip_m(),
            Template::Survey | Template::Circuit | Template::Patrol => 0.0,
        };
        let affordable_m = match self.template {
            Template::Survey => {
                let turns_m2 = 2.0 * half_m * TURN_RADII * frame.turn_radius_m;
                (self.extent.area_m2() + turns_m2) / frame.surveyed_m
            }
            _ => scanned_m2 / frame.tracks_m,
        };
        let overlapping_m = camera_spacing_m(frame.above_ground_m, USUAL_ACROSS_DEG, SIDE_OVERLAP);
        match overlapping_m {
            Ok(metres) if self.template == Template::Survey => {
                let in_fives = |fives: f64| fives.max(1.0) * 5.0;
                in_fives((metres / 5.0).floor()).max(in_fives((affordable_m / 5.0).ceil()))
            }
            _ => (half_m / 5.0).max(least_m).max(affordable_m).ceil(),
        }
    }

    fn corridor(&self, spacing: Spacing) -> LegKind {
        let route = self.extent.line(self.runway.heading_deg);
        let route = route.into_iter().map(|at: LatLon| Place::Position(Value::Constant(at))).collect();
        LegKind::Pattern(Pattern::Corridor { route, width_m: Value::Constant(self.strip_m()), spacing })
    }

    /// Width of the strip along a line, metres.
    fn strip_m(&self) -> f64 {
        match &self.extent {
            Extent::Around { radius_m, .. } => (radius_m / 2.0).clamp(100.0, 1000.0).round(),
            Extent::Drawn(_) => STRIP_M,
        }
    }

    fn search(&self, spacing: Spacing) -> LegKind {
        LegKind::Pattern(Pattern::ExpandingSquare {
            centre: Place::Fix("DATUM".into()),
            spacing,
            heading_deg: Value::Constant(self.runway.heading_deg),
            radius_m: Value::Constant(self.extent.radius_m().round()),
            turn: TurnDirection::Right,
        })
    }

    /// What the mission's legs read.
    pub(super) fn variables(&self) -> Vec<Variable> {
        if self.template != Template::FireWatch {
            return Vec::new();
        }
        let radius_m = self.extent.radius_m();
        let radius = Variable::new("fire_radius".into(), VariableValue::Number(radius_m.round()));
        vec![
            Variable::new("fire_centre".into(), VariableValue::Position(self.extent.centre())),
            Variable {
                unit: "m".into(),
                min: Some((radius_m / 2.0).max(200.0).round()),
                max: Some((radius_m * GROWN).round()),
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
        count: Some(Value::Constant(PASSES)),
        until: None,
        turn,
        body: body.into_iter().map(Arc::new).collect(),
    };
    vec![leg("watch", "Watch", watch)]
}

/// To the first point, and twice forth and back between all of them.
fn patrol(ids: &[String]) -> Vec<Leg> {
    let body = ids.iter().enumerate().map(|(i, id)| {
        let kind = if i == 0 { LegKind::If(to(id)) } else { LegKind::Tf(to(id)) };
        Arc::new(leg(&id.to_lowercase(), "", kind))
    });
    let patrol = LegKind::Iterative {
        form: IterativeForm::Reverse,
        count: Some(Value::Constant(2.0)),
        until: None,
        turn: TurnDirection::Left,
        body: body.collect(),
    };
    let first = ids.first().map(|id| leg("to-patrol", "To the patrol", LegKind::Tf(to(id))));
    first.into_iter().chain([leg("patrol", "Patrol", patrol)]).collect()
}

fn scan(area: Area, spacing: Spacing) -> Scan {
    Scan {
        area,
        style: ScanStyle::Parallel,
        spacing,
        heading_deg: None,
        overshoot_m: Value::Constant(50.0),
        entry: ScanEntry::Nearest,
        order: ScanOrder::Interleaved,
    }
}
