//! A part of a plan as its element, to be changed.

use super::first::First;
use super::{Change, Description, Kind, change};
use crate::xml::{Part, Piece, read_part, text};
use crate::{Edit, Element, FlightPlan, Id, Leg, LegKind, Thing};

/// What is shown or changed.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Subject {
    /// The plan itself.
    Plan,
    /// A leg, also in a procedure.
    Leg(Id),
    /// A stage.
    Stage(Id),
    /// An emergency plan.
    EmergencyPlan(Id),
    /// A fix.
    Fix(Id),
    /// A runway.
    Runway(Id),
    /// A variable.
    Variable(Id),
    /// A zone.
    Zone(Id),
    /// A procedure.
    Procedure(Id),
}

/// A part of a plan as its element: without what has identifiers of its own in it (legs, stages).
#[derive(Debug, Clone, PartialEq)]
pub struct Draft {
    subject: Subject,
    element: Element,
    description: &'static Description,
}

impl Draft {
    /// `None`: the plan has no such part.
    pub fn of(plan: &FlightPlan, subject: &Subject) -> Option<Self> {
        let element = Element::of(&text(&piece(plan, subject)?))?;
        let description = super::of(&element.name)?;
        Some(Self { subject: subject.clone(), element, description })
    }

    /// What it is.
    pub fn subject(&self) -> &Subject {
        &self.subject
    }

    /// As the document has it.
    pub fn element(&self) -> &Element {
        &self.element
    }

    /// What is said about it.
    pub fn description(&self) -> &'static Description {
        self.description
    }

    /// The edit that makes a change of the element at the end of a path (of indices among children; empty: itself).
    ///
    /// # Errors
    /// Says why that can't be, and what to do: in the reader's words, if the value is not one that the document may have.
    pub fn edit(&self, plan: &FlightPlan, at: &[usize], wanted: &Change) -> Result<Edit, String> {
        if let (Change::Set(property, Some(to)), []) = (wanted, at)
            && property.kind == Kind::Identifier
        {
            return Ok(Edit::SetId {
                id: self.element.attribute(property.attribute).unwrap_or("").into(),
                to: to.trim().into(),
            });
        }
        self.edit_together(plan, at, std::slice::from_ref(wanted))
    }

    /// The same of several changes that belong together: none of them is of an identifier.
    ///
    /// # Errors
    /// As [`Draft::edit`].
    pub fn edit_together(&self, plan: &FlightPlan, at: &[usize], wanted: &[Change]) -> Result<Edit, String> {
        let mut changed = self.element.clone();
        let first = First { plan, root: &self.element };
        for change in wanted {
            change::apply(&mut changed, at, change, &first).ok_or(GONE)?;
        }
        let (_, before) = read_part(&self.element.text());
        let (part, problems) = read_part(&changed.text());
        let known = |message: &str| before.iter().any(|p| p.message == message);
        match problems.into_iter().find(|p| !known(&p.message)) {
            Some(problem) => Err(problem.message),
            None => self.replaced(plan, part.ok_or(GONE)?).ok_or_else(|| GONE.into()),
        }
    }

    /// The edit that puts a part in the place of this one; what has identifiers of its own stays in it.
    fn replaced(&self, plan: &FlightPlan, part: Part) -> Option<Edit> {
        let thing = |id: &Id, with: Thing| Some(Edit::Replace { id: id.clone(), with: Box::new(with) });
        match (&self.subject, part) {
            (Subject::Plan, Part::Head(head)) => Some(headed(plan, head)),
            (Subject::Leg(id), Part::Leg(leg)) => {
                let with = Box::new(with_body(leg, plan.any_leg(id)?));
                Some(Edit::ReplaceLeg { leg: id.clone(), with })
            }
            (Subject::Stage(id), Part::Stage(stage)) => {
                Some(Edit::ReplaceStage { stage: id.clone(), with: Box::new(stage) })
            }
            (Subject::EmergencyPlan(id), Part::EmergencyPlan(mut new)) => {
                new.stages.clone_from(&plan.emergency_plan(id)?.stages);
                thing(id, Thing::EmergencyPlan(new))
            }
            (Subject::Procedure(id), Part::Procedure(mut new)) => {
                new.legs.clone_from(&plan.procedure(id)?.legs);
                thing(id, Thing::Procedure(new))
            }
            (Subject::Fix(id), Part::Fix(new)) => thing(id, Thing::Fix(new)),
            (Subject::Runway(id), Part::Runway(new)) => thing(id, Thing::Runway(new)),
            (Subject::Variable(id), Part::Variable(new)) => thing(id, Thing::Variable(new)),
            (Subject::Zone(id), Part::Zone(new)) => thing(id, Thing::Zone(new)),
            _ => None,
        }
    }
}

const GONE: &str = "this is no longer in the plan: choose something else";

fn piece<'p>(plan: &'p FlightPlan, subject: &Subject) -> Option<Piece<'p>> {
    Some(match subject {
        Subject::Plan => Piece::Head(plan),
        Subject::Leg(id) => Piece::Leg(plan.any_leg(id)?),
        Subject::Stage(id) => Piece::Stage(plan.stage(id)?),
        Subject::EmergencyPlan(id) => Piece::EmergencyPlan(plan.emergency_plan(id)?),
        Subject::Fix(id) => Piece::Fix(plan.fix(id)?),
        Subject::Runway(id) => Piece::Runway(plan.runway(id)?),
        Subject::Variable(id) => Piece::Variable(plan.variable(id)?),
        Subject::Zone(id) => Piece::Zone(plan.zone(id)?),
        Subject::Procedure(id) => Piece::Procedure(plan.procedure(id)?),
    })
}

/// The legs inside a loop are not part of its element.
fn with_body(mut leg: Leg, old: &Leg) -> Leg {
    if let (LegKind::Iterative { body, .. }, LegKind::Iterative { body: kept, .. }) =
        (&mut leg.kind, &old.kind)
    {
        body.clone_from(kept);
    }
    leg
}

/// The plan's own properties.
fn headed(plan: &FlightPlan, head: FlightPlan) -> Edit {
    let mut edits = vec![Edit::SetTitle(head.name), Edit::SetAircraft(head.aircraft)];
    let causes = plan.emergency.by_cause.iter().map(|(cause, _)| (*cause, None));
    let kept = head.emergency.by_cause.iter().map(|(cause, plan)| (*cause, Some(plan.clone())));
    let set = |(cause, plan)| Edit::SetEmergency { of: None, cause, plan };
    edits.extend(causes.chain(kept).map(set));
    Edit::All(edits)
}
