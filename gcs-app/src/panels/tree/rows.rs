//! The rows of the tree: what there is to be seen of a plan, from top to bottom.

use super::make::Group;
use crate::command::{BranchId, Selection, ViewCommand};
use flight_plan::create::ways;
use flight_plan::{
    Alternates, Branch, EmergencyChoice, FlightPlan, Id, Leg, LegKind, Pattern, Stage, StageKind, Turnaround,
    TurnaroundEnergy, Use, ZoneKind,
};
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

/// One line of the tree.
#[derive(Debug, Clone, Default)]
pub(in crate::panels) struct Row {
    /// No two rows have the same; stays what it is from edit to edit.
    pub key: String,
    pub depth: usize,
    pub tag: &'static str,
    pub text: String,
    pub detail: String,
    /// Its expressions and conditions, wherever in it they are: what is searched, too.
    pub expressions: Vec<Arc<str>>,
    pub selection: Option<Selection>,
    /// What can be made in it, for a heading.
    pub group: Option<Group>,
    /// There is something inside that can be hidden.
    pub folds: bool,
    /// Legs can be put into it.
    pub nests: bool,
    /// It is a branch of the fork that it selects.
    pub branch: Option<Id>,
    /// Of a leg or stage, or of the whole plan.
    pub alternates: Option<Arc<Alternates>>,
}

impl Row {
    /// It is a branch of a fork.
    pub fn as_branch(&self) -> Option<BranchId> {
        match (&self.selection, &self.branch) {
            (Some(Selection::Leg(fork)), Some(branch)) => {
                Some(BranchId { fork: fork.clone(), branch: branch.clone() })
            }
            _ => None,
        }
    }

    /// Selects what it stands for.
    pub fn select(&self) -> ViewCommand {
        self.as_branch()
            .map_or_else(|| ViewCommand::Select(self.selection.clone()), ViewCommand::SelectBranch)
    }

    /// A leg, and no branch of it.
    pub fn leg(&self) -> Option<&Id> {
        match &self.selection {
            Some(Selection::Leg(id)) if self.branch.is_none() => Some(id),
            _ => None,
        }
    }
}

/// The rows of a plan, but for those inside of what is folded.
pub(super) fn rows(plan: &FlightPlan, folded: &BTreeSet<String>) -> Vec<Row> {
    let mut builder = Builder { plan, rows: Vec::new(), folded };
    let whole = Arc::new(Alternates::default().within(&plan.emergency, None));
    for group in Group::ALL.into_iter().filter(|group| group.is_shown(plan)) {
        let alternates = (group == Group::Stages && !plan.stages.is_empty()).then(|| whole.clone());
        builder.group(group, alternates, |b| match group {
            Group::Stages => plan.stages.iter().for_each(|stage| b.stage(stage, 1, Some(&whole))),
            Group::EmergencyPlans => b.emergency_plans(plan),
            Group::Procedures => b.procedures(plan),
            Group::Zones => b.zones(plan),
            Group::Variables => b.variables(plan),
            Group::Fixes => b.fixes(plan),
            Group::Runways => b.runways(plan),
        });
    }
    builder.rows
}

struct Builder<'a> {
    plan: &'a FlightPlan,
    rows: Vec<Row>,
    folded: &'a BTreeSet<String>,
}

/// Legs of one list, and which of them are flown on a branch of a fork alone (both by their numbers), or on none.
struct List<'a> {
    legs: &'a [Arc<Leg>],
    inside: HashMap<Option<(usize, usize)>, Vec<usize>>,
}

impl Builder<'_> {
    fn group(&mut self, group: Group, alternates: Option<Arc<Alternates>>, children: impl FnOnce(&mut Self)) {
        let name = group.name();
        let row = Row {
            key: name.into(),
            text: name.into(),
            group: Some(group),
            folds: true,
            alternates,
            ..Row::default()
        };
        if self.push(row) {
            children(self);
        }
    }

    /// True if what is inside is to be seen.
    fn push(&mut self, row: Row) -> bool {
        let is_open = !self.folded.contains(&row.key);
        self.rows.push(row);
        is_open
    }

    fn item(&mut self, depth: usize, tag: &'static str, text: &str, detail: String, selection: Selection) {
        let key = format!("{tag} {}", selection.id());
        self.push(Row {
            key,
            depth,
            tag,
            text: text.into(),
            detail,
            selection: Some(selection),
            ..Row::default()
        });
    }

    /// `outer`: what is in force around it; a stage of an emergency plan has no alternate.
    fn stage(&mut self, stage: &Stage, depth: usize, outer: Option<&Arc<Alternates>>) {
        let alternates = outer.map(|outer| within(outer, &stage.emergency, &stage.id));
        let is_open = self.push(Row {
            key: format!("stage {}", stage.id),
            depth,
            tag: stage_tag(stage.kind),
            text: title(&stage.name, stage.id.as_str()),
            detail: turnaround(&stage.turnaround),
            expressions: expressions(|visit| stage.for_each_expression(visit)),
            selection: Some(Selection::Stage(stage.id.clone())),
            folds: !stage.legs.is_empty(),
            nests: true,
            alternates: alternates.clone(),
            ..Row::default()
        });
        if is_open {
            self.legs(&stage.legs, depth + 1, alternates.as_ref());
        }
    }

    fn legs(&mut self, legs: &[Arc<Leg>], depth: usize, outer: Option<&Arc<Alternates>>) {
        let mut list = List { legs, inside: HashMap::new() };
        for (leg, owner) in ways(legs).into_iter().enumerate() {
            list.inside.entry(owner).or_default().push(leg);
        }
        self.legs_of(&list, None, depth, outer);
    }

    /// Those of a list that are flown on that branch alone, or on none.
    fn legs_of(
        &mut self,
        list: &List<'_>,
        of: Option<(usize, usize)>,
        depth: usize,
        outer: Option<&Arc<Alternates>>,
    ) {
        for index in list.inside.get(&of).into_iter().flatten() {
            self.leg(list, *index, depth, outer);
        }
    }

    fn leg(&mut self, list: &List<'_>, index: usize, depth: usize, outer: Option<&Arc<Alternates>>) {
        let Some(leg) = list.legs.get(index) else { return };
        let alternates = outer.map(|outer| within(outer, &leg.emergency, &leg.id));
        let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches);
        let is_open = self.push(Row {
            key: format!("leg {}", leg.id),
            depth,
            tag: leg_tag(&leg.kind),
            text: title(&leg.name, leg.id.as_str()),
            detail: called(self.plan, &leg.kind).unwrap_or_else(|| leg_detail(&leg.kind)),
            expressions: expressions(|visit| leg.for_each_expression(visit)),
            selection: Some(Selection::Leg(leg.id.clone())),
            folds: !leg.body().is_empty() || !branches.is_empty(),
            nests: matches!(leg.kind, LegKind::Iterative { .. }),
            alternates: alternates.clone(),
            ..Row::default()
        });
        if !is_open {
            return;
        }
        self.legs(leg.body(), depth + 1, alternates.as_ref());
        for (number, branch) in branches.iter().enumerate() {
            let of = Some((index, number));
            if self.branch(leg, branch, list.inside.contains_key(&of), depth + 1) {
                // a fork is around nothing: they have what is in force around it
                self.legs_of(list, of, depth + 2, outer);
            }
        }
    }

    /// True if the legs that are flown on it alone are to be seen.
    fn branch(&mut self, fork: &Leg, branch: &Branch, folds: bool, depth: usize) -> bool {
        let to =
            branch.next.as_ref().map_or_else(|| "→ on".into(), |next| format!("→ {}", self.plan.label(next)));
        let to = branch.when.as_ref().map_or_else(|| to.clone(), |when| format!("{to} when {when}"));
        let is_default = fork.as_fork().and_then(|fork| fork.default) == Some(&branch.id);
        self.push(Row {
            key: format!("branch {} of {}", branch.id, fork.id),
            depth,
            tag: "▸",
            text: title(&branch.label, branch.id.as_str()),
            detail: if is_default { format!("{to}, default") } else { to },
            selection: Some(Selection::Leg(fork.id.clone())),
            branch: Some(branch.id.clone()),
            folds,
            ..Row::default()
        })
    }

    fn emergency_plans(&mut self, plan: &FlightPlan) {
        for emergency in &plan.emergency_plans {
            let is_open = self.push(Row {
                key: format!("emergency {}", emergency.id),
                depth: 1,
                tag: "ALT",
                text: title(&emergency.name, emergency.id.as_str()),
                detail: format!("→ {}", emergency.runway),
                selection: Some(Selection::Emergency(emergency.id.clone())),
                folds: true,
                ..Row::default()
            });
            for stage in emergency.stages.iter().filter(|_| is_open) {
                self.stage(stage, 2, None);
            }
        }
    }

    fn procedures(&mut self, plan: &FlightPlan) {
        // what is in force around a call is not known here
        let nothing = Arc::new(Alternates::default());
        for procedure in &plan.procedures {
            let parameters: Vec<&str> = procedure.parameters.iter().map(|p| p.name.as_str()).collect();
            let is_open = self.push(Row {
                key: format!("procedure {}", procedure.id),
                depth: 1,
                tag: "PROC",
                text: title(&procedure.name, procedure.id.as_str()),
                detail: parameters.join(", "),
                selection: Some(Selection::Procedure(procedure.id.clone())),
                folds: !procedure.legs.is_empty(),
                nests: true,
                ..Row::default()
            });
            if is_open {
                self.legs(&procedure.legs, 2, Some(&nothing));
            }
        }
    }

    fn zones(&mut self, plan: &FlightPlan) {
        for zone in &plan.zones {
            let tag = match zone.kind {
                ZoneKind::KeepIn => "IN",
                ZoneKind::KeepOut => "OUT",
            };
            self.item(
                1,
                tag,
                &title(&zone.name, zone.id.as_str()),
                String::new(),
                Selection::Zone(zone.id.clone()),
            );
        }
    }

    fn variables(&mut self, plan: &FlightPlan) {
        for v in &plan.variables {
            let value = crate::state::log::variable(&v.initial);
            let detail = format!("{value} {}", v.unit).trim().to_owned();
            self.item(1, "VAR", v.name.as_str(), detail, Selection::Variable(v.name.clone()));
        }
    }

    fn fixes(&mut self, plan: &FlightPlan) {
        for fix in &plan.fixes {
            self.item(1, "FIX", fix.id.as_str(), fix.name.clone(), Selection::Fix(fix.id.clone()));
        }
    }

    fn runways(&mut self, plan: &FlightPlan) {
        for runway in &plan.runways {
            let detail = crate::units::bearing(runway.heading_deg);
            self.item(1, "RWY", runway.id.as_str(), detail, Selection::Runway(runway.id.clone()));
        }
    }
}

/// What people call it, or else its identifier.
pub fn title(name: &str, id: &str) -> String {
    if name.is_empty() { id.to_owned() } else { name.to_owned() }
}

/// Everything that a walk over them visits.
pub(super) fn expressions(walk: impl FnOnce(&mut dyn FnMut(&Arc<str>, Use))) -> Vec<Arc<str>> {
    let mut found = Vec::new();
    walk(&mut |source, _| found.push(source.clone()));
    found
}

/// What is in force inside; shared, where it is the same.
fn within(outer: &Arc<Alternates>, choice: &EmergencyChoice, of: &Id) -> Arc<Alternates> {
    if choice.by_cause.is_empty() { outer.clone() } else { Arc::new(outer.within(choice, Some(of))) }
}

/// What is expected on the ground behind a landing.
fn turnaround(Turnaround { energy, time_s }: &Turnaround) -> String {
    let time = time_s.map(|seconds| format!("stands {}", crate::units::duration(seconds)));
    let energy = energy.map(|energy| match energy {
        TurnaroundEnergy::Share(share) => format!("then {:.0} % energy", share * 100.0),
        TurnaroundEnergy::Kept => "then the energy that is left".into(),
    });
    time.into_iter().chain(energy).collect::<Vec<_>>().join(", ")
}

fn stage_tag(kind: StageKind) -> &'static str {
    match kind {
        StageKind::TakeOff => "T/O",
        StageKind::Departure => "DEP",
        StageKind::EnRoute => "ENR",
        StageKind::Mission => "MIS",
        StageKind::Arrival => "ARR",
        StageKind::Approach => "APP",
        StageKind::Land => "LND",
    }
}

/// Short tag of a leg's kind.
pub fn leg_tag(kind: &LegKind) -> &'static str {
    match kind {
        LegKind::If(_) => "IF",
        LegKind::Tf(_) => "TF",
        LegKind::Df { .. } => "DF",
        LegKind::Rf { .. } => "RF",
        LegKind::Hf(_) => "HF",
        LegKind::Ha(_) => "HA",
        LegKind::Cf { .. } => "CF",
        LegKind::Fa { .. } => "FA",
        LegKind::Hm { .. } => "HM",
        LegKind::Iterative { .. } => "LOOP",
        // ways end at it, and none parts from it
        LegKind::Intersection { branches, .. } if branches.is_empty() => "MEET",
        LegKind::Intersection { .. } => "FORK",
        LegKind::Scan(_) => "SCAN",
        LegKind::Orbit { .. } => "ORB",
        LegKind::Call(_) => "CALL",
        LegKind::Pattern(pattern) => match pattern {
            Pattern::Spiral { .. } => "SPIRAL",
            Pattern::ExpandingSquare { .. } => "SQUARE",
            Pattern::Sector { .. } => "SECTOR",
            Pattern::TrackLine { .. } => "TRACK",
            Pattern::Corridor { .. } => "CORR",
            Pattern::Contour { .. } => "CONT",
            Pattern::FigureEight { .. } => "FIG8",
        },
    }
}

/// What a call calls.
fn called(plan: &FlightPlan, kind: &LegKind) -> Option<String> {
    let LegKind::Call(call) = kind else { return None };
    Some(format!("of {}", plan.label(&call.procedure)))
}

pub(super) fn leg_detail(kind: &LegKind) -> String {
    use flight_plan::Value;
    let (count, until) = match kind {
        LegKind::Iterative { count, until, .. } => (count.as_ref(), until),
        LegKind::Hm { until, .. } => (None, until),
        LegKind::Call(call) => return call.procedure.to_string(),
        _ => return String::new(),
    };
    let count = match count {
        Some(Value::Constant(n)) => format!("×{n:.0}"),
        Some(Value::Expression(source)) => format!("×({source})"),
        None => String::new(),
    };
    let until = until.as_ref().map(|u| format!(" until {u}")).unwrap_or_default();
    format!("{count}{until}").trim().to_owned()
}
