//! What the rows of the tree are called.

use flight_plan::{FlightPlan, Id, Leg, LegKind, Stage, StageKind};
use gcs_app::panels::tree::{leg_tag, title};
use std::sync::Arc;

/// The row of a stage, leg, procedure or emergency plan, and how many rows before it are called the same.
pub fn row_of(plan: &FlightPlan, id: &Id) -> (String, usize) {
    let rows = rows(plan);
    let at = rows.iter().position(|(of, _)| of == id).unwrap_or_else(|| panic!("{id} has no row"));
    let name = rows[at].1.clone();
    let before = rows[..at].iter().filter(|(_, other)| *other == name).count();
    (name, before)
}

fn rows(plan: &FlightPlan) -> Vec<(Id, String)> {
    let mut rows = Vec::new();
    plan.stages.iter().for_each(|stage| add_stage(stage, &mut rows));
    for emergency in &plan.emergency_plans {
        rows.push(row("ALT", &emergency.name, &emergency.id));
        emergency.stages.iter().for_each(|stage| add_stage(stage, &mut rows));
    }
    for procedure in &plan.procedures {
        rows.push(row("PROC", &procedure.name, &procedure.id));
        add_legs(&procedure.legs, &mut rows);
    }
    rows
}

fn add_stage(stage: &Stage, rows: &mut Vec<(Id, String)>) {
    let tag = match stage.kind {
        StageKind::TakeOff => "T/O",
        StageKind::Departure => "DEP",
        StageKind::EnRoute => "ENR",
        StageKind::Mission => "MIS",
        StageKind::Arrival => "ARR",
        StageKind::Approach => "APP",
        StageKind::Land => "LND",
    };
    rows.push(row(tag, &stage.name, &stage.id));
    add_legs(&stage.legs, rows);
}

fn add_legs(legs: &[Arc<Leg>], rows: &mut Vec<(Id, String)>) {
    for leg in legs {
        rows.push(row(leg_tag(&leg.kind), &leg.name, &leg.id));
        add_legs(leg.body(), rows);
        if let LegKind::Intersection { branches, .. } = &leg.kind {
            rows.extend(branches.iter().map(|branch| row("▸", &branch.label, &branch.id)));
        }
    }
}

fn row(tag: &str, name: &str, id: &Id) -> (Id, String) {
    (id.clone(), format!("{tag} {}", title(name, id.as_str())))
}
