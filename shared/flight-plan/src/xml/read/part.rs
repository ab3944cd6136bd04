//! One part of a plan, read by itself: see [`Piece`](super::super::write::Piece), which writes it.

use super::super::cursor::{Cursor, Element};
use super::super::legs::is_leg;
use super::{Document, Places};
use crate::{EmergencyPlan, Fix, FlightPlan, Leg, Problem, Procedure, Runway, Stage, Variable, Zone};

/// A part of a plan, without what has identifiers of its own in it.
pub(crate) enum Part {
    /// The plan's own properties.
    Head(FlightPlan),
    Fix(Fix),
    Runway(Runway),
    Variable(Variable),
    Zone(Zone),
    Procedure(Procedure),
    Stage(Stage),
    Leg(Leg),
    EmergencyPlan(EmergencyPlan),
}

/// Reads an element; `None`: it is no part of a plan.
pub(crate) fn read_part(text: &str) -> (Option<Part>, Vec<Problem>) {
    let mut document = Document { cursor: Cursor::new(text), places: Places::default(), kept: Vec::new() };
    let root = document.cursor.root();
    let part = root.and_then(|root| document.alone(root));
    (part, document.cursor.into_problems())
}

impl<'a> Document<'a> {
    fn alone(&mut self, root: Element<'a>) -> Option<Part> {
        Some(match root.name {
            "flightPlan" => Part::Head(self.head(root)),
            "fix" => Part::Fix(self.fix(root)),
            "runway" => Part::Runway(self.runway(root)),
            "variable" => Part::Variable(self.variable(root)),
            "keepIn" | "keepOut" => Part::Zone(self.zone(root)),
            "procedure" => Part::Procedure(self.procedure(root)),
            "stage" => Part::Stage(self.stage(root)),
            "emergencyPlan" => Part::EmergencyPlan(self.emergency_plan(root)),
            name if is_leg(name) => Part::Leg(self.leg(root)),
            _ => return None,
        })
    }

    fn head(&mut self, root: Element<'a>) -> FlightPlan {
        let mut plan = FlightPlan {
            name: self.text(&root, "name"),
            aircraft: self.required_text(&root, "aircraft"),
            emergency: self.emergency_attribute(&root),
            ..FlightPlan::default()
        };
        self.stages(&root, &mut Vec::new(), Some(&mut plan.emergency));
        self.cursor.finish(&root);
        plan
    }
}
