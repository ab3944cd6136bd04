//! What a proposed plan would do, before it is committed. It stands beside map and panels: the commands of the flight
//! stay in reach while the operator reads.

use super::Scene;
use crate::command::{FlyCommand, Queue};
use crate::state::{Proposal, log::short_hash};
use crate::theme::{self, Palette};
use crate::units::{self, Units};
use egui::{Color32, Panel, RichText, ScrollArea, Ui};
use flight_plan::{Change, FlightPlan, Id};

/// Screen points.
const WIDTH: f32 = 260.0;
/// So many changes are written out.
const MOST_CHANGES: usize = 200;
/// So many legs are named.
const MOST_LEGS: usize = 40;

/// Draws the proposal's answer, while there is one.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(proposal) = &scene.vehicle.proposal else { return };
    Panel::right("push")
        .exact_size(WIDTH)
        .resizable(false)
        .frame(theme::panel(ui).inner_margin(12.0))
        .show(ui, |ui| body(ui, scene, proposal, queue));
}

fn body(ui: &mut Ui, scene: &Scene<'_>, proposal: &Proposal, queue: &mut Queue) {
    let report = &proposal.report;
    let p = theme::of(ui);
    ui.label(RichText::new("Push plan").strong().size(16.0));
    verdict(ui, proposal, p);
    if scene.analysis.hash_of(scene.document.version()).is_some_and(|hash| *hash != *report.hash) {
        let text = "⚠ The draft was edited since. What was checked is committed, without these edits.";
        ui.label(RichText::new(text).color(p.caution));
    }
    // the decision first: it is never scrolled away
    if report.entry_needed {
        entry(ui, scene, proposal, queue);
    }
    ui.horizontal(|ui| buttons(ui, proposal, queue));
    ui.separator();
    if scene.aboard.is_some() {
        ui.label(RichText::new("── on the map: this plan").color(p.accent));
        ui.label(RichText::new("╌╌ on the map: the plan aboard").color(p.contingency));
    }
    next(ui, proposal, scene, p);
    ui.separator();
    ScrollArea::vertical().id_salt("push").auto_shrink(false).show(ui, |ui| {
        let plan = scene.document.plan();
        for problem in &report.problems {
            ui.label(RichText::new(format!("⚠ {}", plan.in_names(problem))).color(p.caution));
        }
        difference(ui, "+", "added", plan, &report.added, p.good);
        difference(ui, "~", "changed", plan, &report.changed, p.accent);
        // they are in the other plan
        let aboard = scene.vehicle.aboard.as_ref().map_or(plan.as_ref(), |aboard| aboard.plan.as_ref());
        difference(ui, "−", "removed", aboard, &report.removed, p.weak);
        if report.added.is_empty() && report.changed.is_empty() && report.removed.is_empty() {
            ui.label(RichText::new("No leg differs from the plan aboard.").color(p.weak));
        }
        changes(ui, plan, &proposal.changes, p);
    });
}

/// Each change in words: `leg patrol changed: count 2 → 3`.
fn changes(ui: &mut Ui, plan: &FlightPlan, changes: &[Change], p: &Palette) {
    if changes.is_empty() {
        return;
    }
    ui.add_space(6.0);
    super::group_title(ui, "In the document");
    for change in changes.iter().take(MOST_CHANGES) {
        ui.label(change.in_names(plan));
    }
    if let Some(more) = changes.len().checked_sub(MOST_CHANGES).filter(|more| *more > 0) {
        ui.label(RichText::new(format!("and {more} more")).color(p.weak));
    }
}

fn verdict(ui: &mut Ui, proposal: &Proposal, p: &Palette) {
    let (report, hash) = (&proposal.report, short_hash(&proposal.report.hash));
    // what is found in a plan that is accepted are warnings
    let (text, colour) = match (report.acceptable, report.problems.len()) {
        (true, 0) => (format!("✔ Checked aboard: {hash} can be flown"), p.good),
        (true, 1) => (format!("⚠ Checked aboard: {hash} can be flown, 1 warning"), p.caution),
        (true, count) => (format!("⚠ Checked aboard: {hash} can be flown, {count} warnings"), p.caution),
        (false, _) => (format!("✖ Checked aboard: {hash} can't be flown. It stays a draft."), p.warning),
    };
    ui.label(RichText::new(text).strong().color(colour));
}

fn difference(ui: &mut Ui, sign: &str, what: &str, plan: &FlightPlan, legs: &[Id], colour: Color32) {
    if legs.is_empty() {
        return;
    }
    let shown: Vec<&str> = legs.iter().take(MOST_LEGS).map(|leg| plan.label(leg)).collect();
    let more = legs.len().saturating_sub(shown.len());
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(format!("{sign} {} {what}:", legs.len())).strong().color(colour));
        ui.label(format!("{}{rest}", shown.join(", ")));
    });
}

/// Where the aircraft would go, and when: on its way, or into the leg that was chosen.
fn next(ui: &mut Ui, proposal: &Proposal, scene: &Scene<'_>, p: &Palette) {
    let units = scene.units();
    let report = &proposal.report;
    let chosen = report.entries.iter().find(|entry| Some(&entry.leg) == proposal.entry.as_ref());
    let (leg, position, way) = match chosen {
        Some(entry) => (Some(&entry.leg), Some(entry.position), Some((entry.in_m, entry.in_s))),
        None => (report.next_leg.as_ref(), report.next_position, report.next_in_m.zip(report.next_in_s)),
    };
    let leg = leg.map_or("–", |leg| scene.document.label(leg));
    let place = position.map_or_else(String::new, |at| format!(" at {}", units::position(at)));
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("The aircraft would fly next:").color(p.weak));
        ui.label(RichText::new(format!("{leg}{place}{}", in_so_far(way, units))).strong().color(p.active));
    });
    if report.differs_in_m.is_some() {
        let way = report.differs_in_m.zip(report.differs_in_s);
        ui.label(RichText::new(format!("Its way differs{}.", in_so_far(way, units))).color(p.weak));
    }
}

/// `, in 850 m · 34 s`.
fn in_so_far(way: Option<(f64, f64)>, units: Units) -> String {
    let told = |(m, s)| format!(", in {} · {}", units.length().show(m), units::duration(s));
    way.map_or_else(String::new, told)
}

fn entry(ui: &mut Ui, scene: &Scene<'_>, proposal: &Proposal, queue: &mut Queue) {
    ui.vertical(|ui| {
        ui.label("The leg it is on is gone. Enter at:");
        let current = proposal.entry.as_ref().map_or("choose a leg", |leg| scene.document.label(leg));
        egui::ComboBox::from_id_salt("entry").selected_text(current).show_ui(ui, |ui| {
            for leg in entries(scene) {
                let way = proposal.report.entries.iter().find(|entry| entry.leg == *leg);
                let name = scene.document.label(leg);
                let text = format!("{name}{}", in_so_far(way.map(|e| (e.in_m, e.in_s)), scene.units()));
                if ui.selectable_label(proposal.entry.as_ref() == Some(leg), text).clicked() {
                    queue.fly(FlyCommand::EnterAt(leg.clone()));
                }
            }
        });
    });
}

/// It can be committed.
pub fn is_ready(proposal: &Proposal) -> bool {
    proposal.report.acceptable && (!proposal.report.entry_needed || proposal.entry.is_some())
}

/// Legs at which it may be entered.
pub fn entries<'a>(scene: &Scene<'a>) -> impl Iterator<Item = &'a Id> {
    let legs = scene.document.plan().all_legs().into_iter();
    legs.filter(|context| context.section == flight_plan::Section::Main).map(|context| &context.leg.id)
}

fn buttons(ui: &mut Ui, proposal: &Proposal, queue: &mut Queue) {
    let p = theme::of(ui);
    if ui.add_enabled(is_ready(proposal), super::primary_button("Commit", p)).clicked() {
        queue.fly(FlyCommand::Commit);
    }
    if ui.button("Keep as draft").clicked() {
        queue.fly(FlyCommand::DropProposal);
    }
}
