//! `unknown-fix`, `unknown-runway`, `unknown-emergency-plan`, `unknown-leg`: something is named that is not there.

use super::Inspection;
use crate::{Area, EmergencyChoice, Id, Leg, LegContext, LegKind, Pattern, Place, Problem};
use std::collections::HashSet;

pub(super) fn check(view: &Inspection, problems: &mut Vec<Problem>) {
    let plan = view.plan;
    emergencies(view, &plan.emergency, None, problems);
    for emergency in &plan.emergency_plans {
        runway(view, &emergency.runway, &emergency.id, problems);
    }
    for (_, stage) in plan.all_stages() {
        emergencies(view, &stage.emergency, Some(&stage.id), problems);
        stage.runway.iter().for_each(|id| runway(view, id, &stage.id, problems));
    }
    let known: Known = view.steps.iter().map(|s| (s.context.siblings.as_ptr(), &s.context.leg.id)).collect();
    for step in &view.steps {
        let leg = step.context.leg;
        emergencies(view, &leg.emergency, Some(&leg.id), problems);
        place(leg.place(), view, &leg.id, problems);
        next(&known, &step.context, leg.next.as_ref(), problems);
        if let LegKind::Intersection { branches, .. } = &leg.kind {
            branches.iter().for_each(|b| next(&known, &step.context, b.next.as_ref(), problems));
        }
    }
}

impl Leg {
    /// Where it goes, holds, or what it is about; `None` for control legs and polygons.
    pub fn place(&self) -> Option<&Place> {
        match &self.kind {
            LegKind::If(to) | LegKind::Tf(to) | LegKind::Df { to, .. } | LegKind::Rf { to, .. } => {
                Some(&to.place)
            }
            LegKind::Cf { to, .. } | LegKind::Fa { from: to, .. } => Some(&to.place),
            LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => Some(&h.fix.place),
            LegKind::Orbit { centre, .. } => Some(centre),
            LegKind::Scan(scan) => scan.area.centre(),
            LegKind::Pattern(pattern) => pattern.centre(),
            LegKind::Call(call) => call.anchor.as_ref(),
            LegKind::Iterative { .. } | LegKind::Intersection { .. } => None,
        }
    }
}

impl Area {
    /// The centre of a circle.
    pub fn centre(&self) -> Option<&Place> {
        match self {
            Area::Circle { centre, .. } => Some(centre),
            Area::Polygon { .. } | Area::Expression(_) => None,
        }
    }
}

impl Pattern {
    /// What it is about, or where its route begins.
    pub fn centre(&self) -> Option<&Place> {
        match self {
            Pattern::Spiral { centre, .. }
            | Pattern::ExpandingSquare { centre, .. }
            | Pattern::Sector { centre, .. }
            | Pattern::FigureEight { centre, .. } => Some(centre),
            Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. } => route.first(),
            Pattern::Contour { area, .. } => area.centre(),
        }
    }
}

fn emergencies(view: &Inspection, choice: &EmergencyChoice, of: Option<&Id>, problems: &mut Vec<Problem>) {
    for (_, id) in choice.by_cause.iter().filter(|(_, id)| !view.emergency_plans.contains(id)) {
        let message = format!("there is no emergency plan `{id}`: add it or name another");
        let problem = Problem::error("unknown-emergency-plan", message);
        problems.push(of.map_or(problem.clone(), |of| problem.of(of)));
    }
}

fn runway(view: &Inspection, id: &Id, of: &Id, problems: &mut Vec<Problem>) {
    if !view.runways.contains_key(id) {
        let message = format!("there is no runway `{id}`: add it or name another");
        problems.push(Problem::error("unknown-runway", message).of(of));
    }
}

fn place(place: Option<&Place>, view: &Inspection, of: &Id, problems: &mut Vec<Problem>) {
    if let Some(Place::Fix(id)) = place
        && !view.fixes.contains_key(id)
    {
        let message = format!("there is no fix `{id}`: add it or name another");
        problems.push(Problem::error("unknown-fix", message).of(of));
    }
}

/// Each leg with the list it is in.
type Known<'a> = HashSet<(*const Leg, &'a Id)>;

fn next(known: &Known, context: &LegContext, next: Option<&Id>, problems: &mut Vec<Problem>) {
    if let Some(id) = next.filter(|id| !known.contains(&(context.siblings.as_ptr(), *id))) {
        let message = format!(
            "`next` names `{id}`, which is no leg of the same list: name a leg of this stage or loop"
        );
        problems.push(Problem::error("unknown-leg", message).of(&context.leg.id));
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    #[test]
    fn names_of_things_that_are_not_there() {
        check_legs(&[
            (r#"<IF id="a" fix="Z"/>"#, &["unknown-fix"]),
            (r#"<IF id="a" fix="A" emergency="nowhere"/>"#, &["unknown-emergency-plan"]),
            (
                r#"<IF id="a" fix="A"><emergency cause="engine" plan="nowhere"/></IF>"#,
                &["unknown-emergency-plan"],
            ),
            (r#"<IF id="a" fix="A" next="z"/><TF id="b" fix="B"/>"#, &["unknown-leg"]),
        ]);
    }

    #[test]
    fn next_must_not_leave_its_list() {
        let legs = r#"<IF id="a" fix="A"/>
            <iterative id="loop" form="forward" count="2"><TF id="b" fix="B"/><TF id="c" fix="C" next="a"/></iterative>"#;
        check_legs(&[(legs, &["unknown-leg"])]);
    }
}
