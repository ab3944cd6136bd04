//! The rows of the tree: what there is to be seen of a plan, from top to bottom.

use super::make::Group;
use crate::command::Selection;
use flight_plan::{FlightPlan, Leg, LegKind, Pattern, Stage, StageKind, ZoneKind};
use std::collections::BTreeSet;
use std::sync::Arc;

/// One line of the tree.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub depth: usize,
    pub tag: &'static str,
    pub text: String,
    pub detail: String,
    pub selection: Option<Selection>,
    /// What can be made in it, for a heading.
    pub group: Option<Group>,
    /// What is hidden when it is folded.
    pub folds: Option<String>,
}

/// The rows of a plan, but for those inside of what is folded.
pub(super) fn rows(plan: &FlightPlan, folded: &BTreeSet<String>) -> Vec<Row> {
    let mut builder = Builder { rows: Vec::new(), folded };
    for group in Group::ALL.into_iter().filter(|group| group.is_shown(plan)) {
        builder.group(group, |b| match group {
            Group::Stages => plan.stages.iter().for_each(|stage| b.stage(stage, 1)),
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
    rows: Vec<Row>,
    folded: &'a BTreeSet<String>,
}

impl Builder<'_> {
    fn group(&mut self, group: Group, children: impl FnOnce(&mut Self)) {
        let name = group.name();
        self.push(Row {
            depth: 0,
            tag: "",
            text: name.into(),
            detail: String::new(),
            selection: None,
            group: Some(group),
            folds: Some(name.into()),
        });
        if !self.folded.contains(name) {
            children(self);
        }
    }

    fn push(&mut self, row: Row) {
        self.rows.push(row);
    }

    fn item(&mut self, depth: usize, tag: &'static str, text: &str, detail: String, selection: Selection) {
        self.push(Row {
            depth,
            tag,
            text: text.into(),
            detail,
            selection: Some(selection),
            group: None,
            folds: None,
        });
    }

    fn stage(&mut self, stage: &Stage, depth: usize) {
        let fold = format!("stage {}", stage.id);
        let hidden = self.folded.contains(&fold);
        self.push(Row {
            depth,
            tag: stage_tag(stage.kind),
            text: title(&stage.name, stage.id.as_str()),
            detail: emergency(&stage.emergency),
            selection: Some(Selection::Stage(stage.id.clone())),
            group: None,
            folds: (!stage.legs.is_empty()).then_some(fold),
        });
        if !hidden {
            self.legs(&stage.legs, depth + 1);
        }
    }

    fn legs(&mut self, legs: &[Arc<Leg>], depth: usize) {
        for leg in legs {
            self.leg(leg, depth);
        }
    }

    fn leg(&mut self, leg: &Leg, depth: usize) {
        let fold = format!("leg {}", leg.id);
        let hidden = self.folded.contains(&fold);
        self.push(Row {
            depth,
            tag: leg_tag(&leg.kind),
            text: title(&leg.name, leg.id.as_str()),
            detail: [leg_detail(&leg.kind), emergency(&leg.emergency)].join(" ").trim().to_owned(),
            selection: Some(Selection::Leg(leg.id.clone())),
            group: None,
            folds: (!leg.body().is_empty()).then_some(fold),
        });
        if hidden {
            return;
        }
        self.legs(leg.body(), depth + 1);
        if let LegKind::Intersection { branches, default, .. } = &leg.kind {
            for branch in branches {
                let to = branch.next.as_ref().map_or_else(|| "→ on".into(), |next| format!("→ {next}"));
                let is_default = default.as_ref() == Some(&branch.id);
                let to = branch.when.as_ref().map_or_else(|| to.clone(), |when| format!("{to} when {when}"));
                let detail = if is_default { format!("{to}, default") } else { to };
                self.item(
                    depth + 1,
                    "▸",
                    &title(&branch.label, branch.id.as_str()),
                    detail,
                    Selection::Leg(leg.id.clone()),
                );
            }
        }
    }

    fn emergency_plans(&mut self, plan: &FlightPlan) {
        for emergency in &plan.emergency_plans {
            let fold = format!("emergency {}", emergency.id);
            let hidden = self.folded.contains(&fold);
            self.push(Row {
                depth: 1,
                tag: "ALT",
                text: title(&emergency.name, emergency.id.as_str()),
                detail: format!("→ {}", emergency.runway),
                selection: Some(Selection::Emergency(emergency.id.clone())),
                group: None,
                folds: Some(fold),
            });
            for stage in emergency.stages.iter().filter(|_| !hidden) {
                self.stage(stage, 2);
            }
        }
    }

    fn procedures(&mut self, plan: &FlightPlan) {
        for procedure in &plan.procedures {
            let parameters: Vec<&str> = procedure.parameters.iter().map(|p| p.name.as_str()).collect();
            let fold = format!("procedure {}", procedure.id);
            let hidden = self.folded.contains(&fold);
            self.push(Row {
                depth: 1,
                tag: "PROC",
                text: title(&procedure.name, procedure.id.as_str()),
                detail: parameters.join(", "),
                selection: Some(Selection::Procedure(procedure.id.clone())),
                group: None,
                folds: (!procedure.legs.is_empty()).then_some(fold),
            });
            if !hidden {
                self.legs(&procedure.legs, 2);
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

fn emergency(choice: &flight_plan::EmergencyChoice) -> String {
    choice.by_cause.first().map(|(_, id)| format!("⚑ {id}")).unwrap_or_default()
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

fn leg_detail(kind: &LegKind) -> String {
    use flight_plan::Value;
    let LegKind::Iterative { count, until, .. } = kind else { return String::new() };
    let count = match count {
        Some(Value::Constant(n)) => format!("×{n:.0}"),
        Some(Value::Expression(source)) => format!("×({source})"),
        None => String::new(),
    };
    let until = until.as_ref().map(|u| format!(" until {u}")).unwrap_or_default();
    format!("{count}{until}").trim().to_owned()
}
