//! What changed between two plans.

mod legs;
mod users;
mod words;

use crate::xml::Piece;
use crate::{Edit, FlightPlan, Id, Stage};
use serde::Serialize;
use std::collections::HashMap;

/// What became of a part of a plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum ChangeKind {
    /// Only in the new plan.
    Added,
    /// Only in the old plan.
    Removed,
    /// In both, with other properties.
    Changed,
    /// In both, in another place (and perhaps with other properties).
    Moved,
}

/// A part of a plan that is not what it was.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Change {
    /// `plan`, `fix`, `runway`, `variable`, `zone`, `procedure`, `stage`, `leg`, `emergency plan`.
    pub part: &'static str,
    /// Which; `None`: the plan itself.
    pub id: Option<Id>,
    /// What became of it.
    pub fate: ChangeKind,
    /// What changed, a phrase each.
    pub words: Vec<String>,
}

impl std::fmt::Display for Change {
    /// `leg o1 changed: altitude 300 → 400 m AMSL`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.told(self.id.as_ref().map(Id::as_str)))
    }
}

impl Change {
    /// For people, with what the plan calls it.
    pub fn in_names(&self, plan: &FlightPlan) -> String {
        self.told(self.id.as_ref().map(|id| plan.label(id)))
    }

    fn told(&self, name: Option<&str>) -> String {
        let fate = match self.fate {
            ChangeKind::Added => "added",
            ChangeKind::Removed => "removed",
            ChangeKind::Changed => "changed",
            ChangeKind::Moved => "moved",
        };
        let of: Vec<&str> = std::iter::once(self.part).chain(name).chain([fate]).collect();
        let words =
            if self.words.is_empty() { String::new() } else { format!(": {}", self.words.join(", ")) };
        format!("{}{words}", of.join(" "))
    }
}

/// Identifiers of legs by what became of them, in document order.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Difference {
    /// Only in the new plan.
    pub added: Vec<Id>,
    /// Only in the old plan.
    pub removed: Vec<Id>,
    /// In both, but another leg, at another place, or over fixes that moved. A loop counts as changed only for its own
    /// properties, not for what changed inside it.
    pub changed: Vec<Id>,
}

impl Difference {
    /// From one plan to another.
    pub fn between(old: &FlightPlan, new: &FlightPlan) -> Self {
        let mut difference = Difference::default();
        for Change { id, fate, .. } in legs::changes(old, new) {
            let list = match fate {
                ChangeKind::Added => &mut difference.added,
                ChangeKind::Removed => &mut difference.removed,
                ChangeKind::Changed | ChangeKind::Moved => &mut difference.changed,
            };
            list.extend(id);
        }
        difference
    }

    /// Nothing changed that legs can show.
    pub fn is_empty(&self) -> bool {
        self.added.is_empty() && self.removed.is_empty() && self.changed.is_empty()
    }
}

/// Everything that changed from one plan to another; empty when they are the same, and only then (where no identifier is
/// there twice).
pub fn changes(old: &FlightPlan, new: &FlightPlan) -> Vec<Change> {
    let mut changes = Vec::new();
    if std::ptr::eq(old, new) {
        return changes;
    }
    let words = words::between(&Piece::Head(old), &Piece::Head(new));
    changes.extend((!words.is_empty()).then_some(Change {
        part: "plan",
        id: None,
        fate: ChangeKind::Changed,
        words,
    }));
    list("fix", (&old.fixes, &new.fixes), |f| (&f.id, Piece::Fix(f)), &mut changes);
    list("runway", (&old.runways, &new.runways), |r| (&r.id, Piece::Runway(r)), &mut changes);
    list("variable", (&old.variables, &new.variables), |v| (&v.name, Piece::Variable(v)), &mut changes);
    users::of_variables(old, new, &mut changes);
    list("zone", (&old.zones, &new.zones), |z| (&z.id, Piece::Zone(z)), &mut changes);
    list("procedure", (&old.procedures, &new.procedures), |p| (&p.id, Piece::Procedure(p)), &mut changes);
    users::of_procedures(old, new, &mut changes);
    stages(old, new, &mut changes);
    changes.extend(legs::changes(old, new));
    list(
        "emergency plan",
        (&old.emergency_plans, &new.emergency_plans),
        |e| (&e.id, Piece::EmergencyPlan(e)),
        &mut changes,
    );
    changes
}

/// What an edit would change; empty if it can't be made.
pub fn of_edit(plan: &FlightPlan, edit: &Edit) -> Vec<Change> {
    edit.apply(plan).map_or_else(|_| Vec::new(), |edited| changes(plan, &edited))
}

/// What became of the items of a list: their properties and their order.
fn list<'p, T>(
    part: &'static str,
    (old, new): (&'p [T], &'p [T]),
    of: impl Fn(&'p T) -> (&'p Id, Piece<'p>),
    changes: &mut Vec<Change>,
) {
    let before: HashMap<&Id, usize> = old.iter().enumerate().map(|(i, item)| (of(item).0, i)).collect();
    let after: HashMap<&Id, usize> = new.iter().enumerate().map(|(i, item)| (of(item).0, i)).collect();
    let common: Vec<usize> = new.iter().filter_map(|item| before.get(of(item).0).copied()).collect();
    let mut moved = out_of_order(&common).into_iter();
    for item in new {
        let (id, piece) = of(item);
        let Some(was) = before.get(id).and_then(|i| old.get(*i)) else {
            changes.push(Change { part, id: Some(id.clone()), fate: ChangeKind::Added, words: Vec::new() });
            continue;
        };
        let words = words::between(&of(was).1, &piece);
        let fate = if moved.next() == Some(true) { ChangeKind::Moved } else { ChangeKind::Changed };
        if fate == ChangeKind::Moved || !words.is_empty() {
            changes.push(Change { part, id: Some(id.clone()), fate, words });
        }
    }
    for id in old.iter().map(|item| of(item).0).filter(|id| !after.contains_key(id)) {
        changes.push(Change { part, id: Some(id.clone()), fate: ChangeKind::Removed, words: Vec::new() });
    }
}

fn stages(old: &FlightPlan, new: &FlightPlan, changes: &mut Vec<Change>) {
    list("stage", (&old.stages, &new.stages), |s| (&s.id, Piece::Stage(s)), changes);
    let after: HashMap<&Id, &[Stage]> = new.emergency_plans.iter().map(|e| (&e.id, &*e.stages)).collect();
    for plan in &old.emergency_plans {
        // those of a plan that is gone are gone with it
        let Some(stages) = after.get(&plan.id) else { continue };
        list("stage", (&plan.stages, stages), |s| (&s.id, Piece::Stage(s)), changes);
    }
}

/// For each of some different numbers, whether it is outside the longest ascending selection of them (of several, one).
fn out_of_order(numbers: &[usize]) -> Vec<bool> {
    // `tails[n]`: index of the least number at which an ascending selection of n + 1 ends; `before`: what comes before it
    let mut tails: Vec<usize> = Vec::new();
    let mut before: Vec<Option<usize>> = Vec::with_capacity(numbers.len());
    for (i, number) in numbers.iter().enumerate() {
        let length = tails.partition_point(|tail| numbers.get(*tail) < Some(number));
        before.push(length.checked_sub(1).and_then(|n| tails.get(n).copied()));
        match tails.get_mut(length) {
            Some(tail) => *tail = i,
            None => tails.push(i),
        }
    }
    let mut outside = vec![true; numbers.len()];
    let mut inside = tails.last().copied();
    while let Some(i) = inside {
        if let Some(outside) = outside.get_mut(i) {
            *outside = false;
        }
        inside = before.get(i).copied().flatten();
    }
    outside
}

#[cfg(test)]
mod tests;
