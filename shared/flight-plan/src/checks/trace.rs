//! The way through a plan: from leg to leg in the order of the document, as far as that says what follows what.

use super::extent::{self, Region};
use super::incremental_cache::Recall;
use super::inspection::Inspection;
use super::path::Path;
use super::step::{Around, Point, Step};
use crate::ids::Spots;
use crate::{Branch, Id, Leg, LegKind, Stage, StageKind};
use geometry::LatLon;
use std::sync::Arc;

/// A walk through a plan, and what it found.
pub(super) struct Trace<'i, 'a> {
    view: &'i mut Inspection<'a>,
    recall: &'i mut Recall,
    pub steps: Vec<Step>,
    pub lists: Vec<&'a [Arc<Leg>]>,
    pub spots: Spots,
}

/// How the path gets to the next leg.
#[derive(Debug, Clone, Copy, Default)]
struct Arrival {
    point: Option<Point>,
    /// What the point is within, if it is not known.
    within: Option<Region>,
    step: Option<usize>,
}

/// True if `leg` can follow the sibling before it in the document.
fn leads_to(previous: &Leg, leg: &Leg) -> bool {
    let names = |next: &Option<Id>| next.as_ref().is_none_or(|id| *id == leg.id);
    match &previous.kind {
        LegKind::Intersection { branches, .. } if !branches.is_empty() => {
            branches.iter().any(|b: &Branch| names(&b.next))
        }
        _ => names(&previous.next),
    }
}

impl<'i, 'a> Trace<'i, 'a> {
    /// Through the main plan, then through each emergency plan.
    pub fn of(view: &'i mut Inspection<'a>, recall: &'i mut Recall) -> Self {
        let plan = view.plan;
        let legs: usize = plan.all_stages().map(|(_, stage)| stage.legs.len()).sum();
        let steps = Vec::with_capacity(legs.max(recall.total()));
        let mut trace = Self { view, recall, steps, lists: Vec::new(), spots: Spots::default() };
        trace.stages(&plan.stages, None);
        for (index, emergency) in plan.emergency_plans.iter().enumerate() {
            trace.stages(&emergency.stages, Some(index));
        }
        trace
    }

    fn stages(&mut self, stages: &'a [Stage], emergency_plan: Option<usize>) {
        let mut arrival = Arrival::default();
        for (index, stage) in stages.iter().enumerate() {
            self.spots.stage(emergency_plan, index);
            if stage.kind == StageKind::TakeOff {
                arrival = Arrival { point: self.view.climb_out(stage), ..Arrival::default() };
                continue;
            }
            let (main, stage_only) = (emergency_plan.is_none(), Arc::new(stage.without_legs()));
            let home_m = if main { self.view.home_at_m(index) } else { self.view.common_home_m() };
            let around = self.recall.around(Around { main, home_m, loops: Vec::new(), stage: stage_only });
            arrival = self.list(&stage.legs, &around, None, arrival);
        }
    }

    fn list(
        &mut self,
        legs: &'a [Arc<Leg>],
        around: &Arc<Around>,
        parent: Option<usize>,
        mut arrival: Arrival,
    ) -> Arrival {
        let mut jumps = false;
        let mut previous: Option<&Leg> = None;
        for (index, leg) in legs.iter().enumerate() {
            let follows = previous.replace(leg).is_none_or(|previous| leads_to(previous, leg));
            let entry = if follows { arrival } else { Arrival::default() };
            let number = self.steps.len();
            self.spots.leg(parent, index);
            arrival = self.leg(leg, around, entry, &mut jumps);
            if let LegKind::Iterative { body, form, .. } = &leg.kind {
                let inside = self.recall.around(around.inside(leg, *form));
                // a reverse loop, too, is left at the end of the last leg
                arrival = self.list(body, &inside, Some(number), entry);
            }
        }
        if jumps {
            self.lists.push(legs);
        }
        arrival
    }

    fn leg(&mut self, leg: &Arc<Leg>, around: &Arc<Around>, entry: Arrival, jumps: &mut bool) -> Arrival {
        let number = self.steps.len();
        let known = self.recall.step(leg, around, (entry.point, entry.within), entry.step);
        let step = known.unwrap_or_else(|| self.step(leg, around, entry));
        let step = Step { before: entry.step, after: None, ..step };
        *jumps |= step.marks.jumps;
        if step.directed().is_some()
            && let Some(before) = entry.step.and_then(|i| self.steps.get_mut(i))
        {
            before.after = Some(number);
        }
        let passes_through = matches!(leg.kind, LegKind::Intersection { .. });
        let last = if passes_through { entry.step } else { Some(number) };
        let arrival = Arrival { point: step.end, within: step.end_within, step: last };
        self.steps.push(step);
        arrival
    }

    fn step(&mut self, leg: &Arc<Leg>, around: &Arc<Around>, entry: Arrival) -> Step {
        let marks = self.view.marks(leg);
        let start = entry.point;
        let speed = around.speed_of(leg).and_then(|v| self.view.number(v));
        // one that the aircraft does not fly is told by itself: what follows from it would hide that
        let (least, most) = (self.view.profile.min_airspeed_mps, self.view.profile.max_airspeed_mps);
        let flown = speed.filter(|v| *v > 0.0).map(|v| v.max(least).min(most));
        let mut step = Step {
            leg: leg.clone(),
            around: around.clone(),
            start,
            end: start,
            start_within: entry.within,
            end_within: entry.within,
            speed_mps: flown.unwrap_or(self.view.profile.cruise_airspeed_mps),
            path: None,
            before: None,
            after: None,
            marks,
            found: Vec::new(),
        };
        if !matches!(leg.kind, LegKind::Iterative { .. } | LegKind::Intersection { .. }) {
            step.end = self.view.end_of(&step);
            step.end_within = if step.end.is_none() { extent::region_of(self.view, &step) } else { None };
            step.path = start.zip(step.end).and_then(|(from, to)| path_of(leg, from.position, to.position));
        }
        step
    }
}

fn path_of(leg: &Leg, from: LatLon, to: LatLon) -> Option<Path> {
    match &leg.kind {
        LegKind::Tf(_) => Some(Path::line(from, to)),
        LegKind::Rf { centre, turn, .. } if centre.is_valid() => Some(Path::arc(from, to, *centre, *turn)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use crate::checks::testing::check_legs;

    #[test]
    fn forth_and_back_ends_where_its_last_leg_does() {
        let repeated = |how: &str| {
            format!(
                r#"<IF id="a" fix="A"/><iterative id="i" form="reverse" {how}><TF id="b" fix="B"/></iterative><TF id="c" fix="B"/>"#
            )
        };
        for how in [r#"count="1""#, r#"count="2""#, r#"count="3""#, r#"until="time > 100.0""#] {
            check_legs(&[(&repeated(how), &["zero-length"])]);
        }
    }
}
