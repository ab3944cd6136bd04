//! Where a plan has expressions, and as what.

use crate::{
    Act, Area, Call, Holding, HoldingLength, Leg, LegAction, LegKind, Pattern, Place, Scan, Spacing, Stage,
    Trigger, Value,
};
use geometry::LatLon;
use std::sync::Arc;

/// What an expression is used as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// A number.
    Number,
    /// A condition.
    Condition,
    /// A position.
    Position,
    /// A polygon.
    Polygon,
    /// A value whose type the place decides: a variable's, a parameter's.
    Any,
}

/// Something in a leg or stage that has a value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Part<'a> {
    /// A number.
    Number(&'a Value<f64>),
    /// A position.
    Place(&'a Place),
    /// A position that can only be a constant.
    Corner(LatLon),
    /// An expression that can't be a constant, with what it is used as.
    Source(&'a Arc<str>, Use),
}

impl<'a> Part<'a> {
    /// The expression, if it is one.
    fn expression(self) -> Option<(&'a Arc<str>, Use)> {
        match self {
            Part::Number(Value::Expression(source)) => Some((source, Use::Number)),
            Part::Place(Place::Position(Value::Expression(source))) => Some((source, Use::Position)),
            Part::Source(source, used) => Some((source, used)),
            _ => None,
        }
    }
}

/// Takes every part that it is shown.
type Visitor<'a> = dyn FnMut(Part) + 'a;

impl Leg {
    /// Every expression of the leg itself (not of the legs inside it), with what it is used as.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        self.for_each_part(&mut |part| {
            if let Some((source, used)) = part.expression() {
                visit(source, used);
            }
        });
    }

    /// Every expression that its waypoints depend on: those of [`Leg::for_each_expression`] without its actions'.
    pub fn for_each_geometric_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        self.for_each_geometric_part(&mut |part| {
            if let Some((source, used)) = part.expression() {
                visit(source, used);
            }
        });
    }

    /// Everything that has a value in the leg itself (not in the legs inside it).
    pub fn for_each_part(&self, visit: &mut Visitor) {
        self.for_each_geometric_part(visit);
        self.actions.iter().for_each(|action| visit_action(action, visit));
    }

    fn for_each_geometric_part(&self, visit: &mut Visitor) {
        self.altitude.iter().for_each(|a| visit(Part::Number(&a.metres)));
        self.speed_mps.iter().for_each(|x| visit(Part::Number(x)));
        match &self.kind {
            LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } => visit(Part::Place(&to.place)),
            LegKind::Rf { to, centre, .. } => {
                visit(Part::Place(&to.place));
                visit(Part::Corner(*centre));
            }
            LegKind::Cf { to, course_deg } | LegKind::Fa { from: to, course_deg } => {
                visit(Part::Place(&to.place));
                visit(Part::Number(course_deg));
            }
            LegKind::Hf(holding) | LegKind::Ha(holding) => visit_holding(holding, visit),
            LegKind::Hm { holding, until, max_laps } => {
                visit_holding(holding, visit);
                until.iter().for_each(|source| visit(Part::Source(source, Use::Condition)));
                max_laps.iter().for_each(|x| visit(Part::Number(x)));
            }
            LegKind::Iterative { count, until, .. } => {
                count.iter().for_each(|x| visit(Part::Number(x)));
                until.iter().for_each(|source| visit(Part::Source(source, Use::Condition)));
            }
            LegKind::Intersection { branches, .. } => {
                let conditions = branches.iter().filter_map(|b| b.when.as_ref());
                conditions.for_each(|source| visit(Part::Source(source, Use::Condition)));
            }
            LegKind::Scan(scan) => visit_scan(scan, visit),
            LegKind::Pattern(pattern) => visit_pattern(pattern, visit),
            LegKind::Call(call) => visit_call(call, visit),
            LegKind::Orbit { centre, radius_m, turns, .. } => {
                visit(Part::Place(centre));
                visit(Part::Number(radius_m));
                visit(Part::Number(turns));
            }
        }
    }
}

fn visit_holding(holding: &Holding, visit: &mut Visitor) {
    visit(Part::Place(&holding.fix.place));
    holding.inbound_course_deg.iter().for_each(|x| visit(Part::Number(x)));
    let (HoldingLength::Distance(length) | HoldingLength::Time(length)) = &holding.leg;
    visit(Part::Number(length));
}

fn visit_scan(scan: &Scan, visit: &mut Visitor) {
    visit_area(&scan.area, visit);
    visit_spacing(&scan.spacing, visit);
    scan.heading_deg.iter().for_each(|x| visit(Part::Number(x)));
    visit(Part::Number(&scan.overshoot_m));
}

fn visit_pattern(pattern: &Pattern, visit: &mut Visitor) {
    match pattern {
        Pattern::Spiral { centre, inner_radius_m, outer_radius_m, spacing, .. } => {
            visit(Part::Place(centre));
            [inner_radius_m, outer_radius_m].into_iter().for_each(|v| visit(Part::Number(v)));
            visit_spacing(spacing, visit);
        }
        Pattern::ExpandingSquare { centre, spacing, heading_deg, radius_m, .. } => {
            visit(Part::Place(centre));
            visit_spacing(spacing, visit);
            [heading_deg, radius_m].into_iter().for_each(|v| visit(Part::Number(v)));
        }
        Pattern::Sector { centre, radius_m, sectors, heading_deg, passes, .. } => {
            visit(Part::Place(centre));
            let numbers = [radius_m, sectors, heading_deg, passes];
            numbers.into_iter().for_each(|v| visit(Part::Number(v)));
        }
        Pattern::TrackLine { route, spacing, .. } => {
            route.iter().for_each(|place| visit(Part::Place(place)));
            visit_spacing(spacing, visit);
        }
        Pattern::Corridor { route, width_m, spacing } => {
            route.iter().for_each(|place| visit(Part::Place(place)));
            visit(Part::Number(width_m));
            visit_spacing(spacing, visit);
        }
        Pattern::Contour { area, spacing, loops, .. } => {
            visit_area(area, visit);
            visit_spacing(spacing, visit);
            loops.iter().for_each(|x| visit(Part::Number(x)));
        }
        Pattern::FigureEight { centre, radius_m, heading_deg, turns, .. } => {
            visit(Part::Place(centre));
            [radius_m, heading_deg, turns].into_iter().for_each(|v| visit(Part::Number(v)));
        }
    }
}

fn visit_call(call: &Call, visit: &mut Visitor) {
    call.arguments.iter().for_each(|(_, source)| visit(Part::Source(source, Use::Any)));
    call.anchor.iter().for_each(|place| visit(Part::Place(place)));
    call.bearing_deg.iter().for_each(|x| visit(Part::Number(x)));
}

fn visit_action(action: &LegAction, visit: &mut Visitor) {
    match &action.trigger {
        Trigger::Distance(x) | Trigger::Every(x) | Trigger::Time(x) => visit(Part::Number(x)),
        Trigger::Abeam(place) => visit(Part::Place(place)),
        Trigger::Start | Trigger::End => {}
    }
    match &action.act {
        Act::PhotoSeries { every_m } => visit(Part::Number(every_m)),
        Act::Set { to, .. } => visit(Part::Source(to, Use::Any)),
        Act::Wait { seconds } => visit(Part::Number(seconds)),
        Act::Photo | Act::PhotoStop | Act::VideoStart | Act::VideoStop | Act::Invoke { .. } => {}
    }
}

fn visit_area(area: &Area, visit: &mut Visitor) {
    match area {
        Area::Circle { centre, radius_m } => {
            visit(Part::Place(centre));
            visit(Part::Number(radius_m));
        }
        Area::Expression(source) => visit(Part::Source(source, Use::Polygon)),
        Area::Polygon { corners, holes } => {
            corners.iter().chain(holes.iter().flatten()).for_each(|corner| visit(Part::Corner(*corner)))
        }
    }
}

fn visit_spacing(spacing: &Spacing, visit: &mut Visitor) {
    match spacing {
        Spacing::Metres(metres) => visit(Part::Number(metres)),
        Spacing::Camera { field_of_view_deg, overlap, height_m } => {
            [field_of_view_deg, overlap].into_iter().for_each(|v| visit(Part::Number(v)));
            height_m.iter().for_each(|x| visit(Part::Number(x)));
        }
    }
}

impl Stage {
    /// Every expression of the stage itself (not of its legs), with what it is used as.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        let numbers = self.altitude.iter().map(|a| &a.metres).chain(&self.speed_mps);
        numbers.filter_map(|x| Part::Number(x).expression()).for_each(|(source, used)| visit(source, used));
    }
}
