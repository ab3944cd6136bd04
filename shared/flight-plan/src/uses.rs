//! Where a plan has expressions, and as what.

use crate::{Altitude, Area, HoldingLength, Leg, LegKind, Place, Stage, Value};
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
}

impl Leg {
    /// Every expression of the leg itself (not of the legs inside it), with what it is used as.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        visit_altitude(self.altitude.as_ref(), visit);
        visit_number(self.speed_mps.as_ref(), visit);
        match &self.kind {
            LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => {
                visit_place(&to.place, visit)
            }
            LegKind::Hf(h) | LegKind::Ha(h) => {
                visit_place(&h.fix.place, visit);
                visit_number(h.inbound_course_deg.as_ref(), visit);
                let (HoldingLength::Distance(length) | HoldingLength::Time(length)) = &h.leg;
                visit_number(Some(length), visit);
            }
            LegKind::Iterative { count, until, .. } => {
                visit_number(count.as_ref(), visit);
                until.iter().for_each(|source| visit(source, Use::Condition));
            }
            LegKind::Intersection { branches, .. } => {
                branches
                    .iter()
                    .filter_map(|b| b.when.as_ref())
                    .for_each(|source| visit(source, Use::Condition));
            }
            LegKind::Scan(scan) => {
                if let Area::Circle { centre, radius_m } = &scan.area {
                    visit_place(centre, visit);
                    visit_number(Some(radius_m), visit);
                }
                visit_number(Some(&scan.spacing_m), visit);
                visit_number(scan.heading_deg.as_ref(), visit);
                visit_number(Some(&scan.overshoot_m), visit);
            }
            LegKind::Orbit { centre, radius_m, turns, .. } => {
                visit_place(centre, visit);
                visit_number(Some(radius_m), visit);
                visit_number(Some(turns), visit);
            }
        }
    }
}

impl Stage {
    /// Every expression of the stage itself (not of its legs), with what it is used as.
    pub fn for_each_expression(&self, visit: &mut dyn FnMut(&Arc<str>, Use)) {
        visit_altitude(self.altitude.as_ref(), visit);
        visit_number(self.speed_mps.as_ref(), visit);
    }
}

fn visit_altitude(altitude: Option<&Altitude>, visit: &mut dyn FnMut(&Arc<str>, Use)) {
    visit_number(altitude.map(|a| &a.metres), visit);
}

fn visit_number(value: Option<&Value<f64>>, visit: &mut dyn FnMut(&Arc<str>, Use)) {
    if let Some(Value::Expression(source)) = value {
        visit(source, Use::Number);
    }
}

fn visit_place(place: &Place, visit: &mut dyn FnMut(&Arc<str>, Use)) {
    if let Place::Position(Value::Expression(source)) = place {
        visit(source, Use::Position);
    }
}
