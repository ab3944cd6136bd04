//! What a proposed plan would do, before it is committed. It stands beside map and panels: the commands of the flight
//! stay in reach while the operator reads.

use super::bar::PUSH;
use super::field::List;
use super::{Scene, answer, problems};
use crate::command::{FlyCommand, Queue};
use crate::map::guard;
use crate::state::{LOOK_AGAIN, Proposal, log::short_hash};
use crate::theme::{self, Palette};
use crate::units::{self, Units};
use egui::collapsing_header::CollapsingState;
use egui::{Button, Color32, Label, RichText, ScrollArea, Sense, Ui};
use flight_plan::{Change, FlightPlan, Id, LegKind, Verdict};

/// So many changes are written out.
const MOST_CHANGES: usize = 200;
/// So many legs are named when all are asked for, and without being asked for.
const MOST_LEGS: usize = 200;
const FEW_LEGS: usize = 3;
/// What was told so long ago is of another place, seconds.
const OLD_S: f64 = 10.0;
/// What is proposed is not looked at again sooner after the last time, seconds of the window's clock: looking is work.
const PAUSE_S: f64 = 10.0;
/// What lies less far ahead is here, metres.
const HERE_M: f64 = 1.0;

/// Draws the proposal's answer, while there is one; false: there is none.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, width: Option<f32>, queue: &mut Queue) -> bool {
    let Some(proposal) = &scene.vehicle.proposal else { return false };
    super::read_beside_map(ui, width, |ui| body(ui, scene, proposal, queue));
    true
}

fn body(ui: &mut Ui, scene: &Scene<'_>, proposal: &Proposal, queue: &mut Queue) {
    let report = &proposal.report;
    let p = theme::of(ui);
    ui.label(RichText::new("Push plan").strong().size(16.0));
    verdict(ui, scene, proposal, p);
    let is_edited = is_edited(scene, proposal);
    if is_edited {
        let text = "⚠ The draft was edited since. What was checked is committed, without these edits.";
        ui.label(RichText::new(text).color(p.caution));
    }
    // the decision first: it is never scrolled away
    if report.entry_needed {
        entry(ui, scene, proposal, queue);
    }
    // with the third one they are wider than the panel
    ui.horizontal_wrapped(|ui| buttons(ui, scene, proposal, queue));
    ui.separator();
    if scene.path_aboard().is_some() {
        let shown =
            if is_edited { "── on the map: the edited draft" } else { "── on the map: this plan" };
        ui.label(RichText::new(shown).color(p.accent));
        ui.label(RichText::new("╌╌ on the map: the plan aboard").color(p.contingency));
    }
    next(ui, proposal, scene, p);
    ui.separator();
    ScrollArea::vertical().id_salt("push").auto_shrink(false).show(ui, |ui| {
        let plan = scene.document.plan();
        for problem in &report.problems {
            let said = format!("⚠ {}", answer::told(scene, true, problem));
            answer::with_codes(ui.label(RichText::new(said).color(p.caution)), problem);
        }
        difference(ui, "+", "added", plan, &report.added, p.good);
        difference(ui, "~", "changed", plan, &report.changed, p.accent);
        too_late(ui, scene, &report.changed, p);
        // they are in the other plan
        let aboard = scene.vehicle.aboard.as_ref().map_or(plan.as_ref(), |aboard| aboard.plan.as_ref());
        difference(ui, "−", "removed", aboard, &report.removed, p.weak);
        if report.added.is_empty() && report.changed.is_empty() && report.removed.is_empty() {
            ui.label(RichText::new("No leg differs from the plan aboard.").color(p.weak));
        }
        changes(ui, plan, &proposal.changes, p);
    });
}

/// The draft is not any more what was checked.
fn is_edited(scene: &Scene<'_>, proposal: &Proposal) -> bool {
    let hash = scene.analysis.hash_of(scene.document.version());
    hash.is_some_and(|hash| *hash != *proposal.report.hash)
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

fn verdict(ui: &mut Ui, scene: &Scene<'_>, proposal: &Proposal, p: &Palette) {
    let (report, hash) = (&proposal.report, short_hash(&proposal.report.hash));
    let here = found_here(scene, proposal);
    // what is found in a plan that is accepted are warnings
    let (text, colour) = match (report.acceptable, report.problems.len()) {
        (true, 0) if here.is_some() => (format!("Checked aboard: {hash} can be flown"), p.text),
        (true, 0) => (format!("✔ Checked aboard: {hash} can be flown"), p.good),
        (true, 1) => (format!("⚠ Checked aboard: {hash} can be flown, 1 warning"), p.caution),
        (true, count) => (format!("⚠ Checked aboard: {hash} can be flown, {count} warnings"), p.caution),
        (false, _) => (format!("✖ Checked aboard: {hash} can't be flown. It stays a draft."), p.warning),
    };
    ui.label(RichText::new(text).strong().color(colour));
    if let Some(found) = here.filter(|_| report.acceptable) {
        let so_far = if scene.is_checked() { "" } else { " so far" };
        let text = format!(
            "⚠ Checked here{so_far}: it {found}. Here all of the flight is checked, for other variables, too: see Problems"
        );
        ui.label(RichText::new(text).color(p.caution));
    }
}

/// What Problems say of the plan that is proposed, where that is more than was found aboard: any error, of a plan that was accepted
/// there.
fn found_here(scene: &Scene<'_>, proposal: &Proposal) -> Option<Verdict> {
    let report = &proposal.report;
    let is_shown = scene.analysis.hash_of(scene.document.version()).is_some_and(|hash| *hash == *report.hash);
    let found = problems::found(scene);
    let is_more = found.errors > 0 || scene.problems().count() > report.problems.len();
    (is_shown && is_more).then_some(found)
}

/// `1 stage and 2 legs`: a take-off or a landing is a stage without legs.
fn counted(plan: &FlightPlan, parts: &[Id]) -> String {
    let stages = parts.iter().filter(|id| plan.leg(id).is_none() && plan.stage(id).is_some()).count();
    let of = |count: usize, what: &str| match count {
        0 => None,
        1 => Some(format!("1 {what}")),
        _ => Some(format!("{count} {what}s")),
    };
    let counts = [of(stages, "stage"), of(parts.len() - stages, "leg")];
    counts.into_iter().flatten().collect::<Vec<_>>().join(" and ")
}

/// Legs of which the same is told. Many of them are the first and the last one until all are asked for.
fn difference(ui: &mut Ui, sign: &str, what: &str, plan: &FlightPlan, legs: &[Id], colour: Color32) {
    let (Some(first), Some(last)) = (legs.first(), legs.last()) else { return };
    let count = counted(plan, legs);
    let title = |mark: &str| RichText::new(format!("{mark}{sign} {count} {what}:")).strong().color(colour);
    if legs.len() <= FEW_LEGS {
        ui.horizontal_wrapped(|ui| {
            ui.label(title(""));
            ui.label(legs.iter().map(|leg| plan.label(leg)).collect::<Vec<_>>().join(", "));
        });
        return;
    }
    let id = ui.make_persistent_id(("legs", what));
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, false);
    let header = ui.horizontal_wrapped(|ui| {
        let mark = if state.is_open() { "⏷ " } else { "⏵ " };
        let title = ui.add(Label::new(title(mark)).sense(Sense::click()));
        let ends = format!("{} … {}", plan.label(first), plan.label(last));
        title | ui.add(Label::new(ends).sense(Sense::click()))
    });
    if header.inner.on_hover_text("Show or hide their names").clicked() {
        state.toggle(ui);
    }
    state.show_body_indented(&header.response, ui, |ui| {
        legs.iter().take(MOST_LEGS).for_each(|leg| drop(ui.label(plan.label(leg))));
        if let Some(more) = legs.len().checked_sub(MOST_LEGS).filter(|more| *more > 0) {
            ui.label(RichText::new(format!("and {more} more")).color(theme::of(ui).weak));
        }
    });
}

/// Which of them the flight has behind it.
fn too_late(ui: &mut Ui, scene: &Scene<'_>, legs: &[Id], p: &Palette) {
    let (plan, behind) = (scene.document.plan(), guard::behind(scene));
    let mut late = legs.iter().filter(|leg| behind.contains(leg)).map(|leg| plan.label(leg));
    let first: Vec<_> = late.by_ref().take(FEW_LEGS).collect();
    if first.is_empty() {
        return;
    }
    let more = match late.count() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let text = format!("⚠ Behind the aircraft, flown again only by Go to: {}{more}", first.join(", "));
    ui.label(RichText::new(text).color(p.caution));
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
    let is_old = is_old(scene, proposal);
    if is_old {
        let then = if looks_again(scene, proposal) {
            "looking again"
        } else {
            "and the aircraft flew on: push again"
        };
        let text = format!("⚠ Looked at {} ago, {then}", units::duration(age_s(scene, proposal)));
        ui.label(RichText::new(text).color(p.caution));
    }
    ui.horizontal_wrapped(|ui| {
        let next = if is_old { "It would have flown next:" } else { "The aircraft would fly next:" };
        ui.label(RichText::new(next).color(p.weak));
        ui.label(RichText::new(format!("{leg}{place}{}", in_so_far(way, units))).strong().color(p.active));
    });
    // on the ground none is flown
    if let Some(way) = report.differs_in_m.zip(report.differs_in_s).filter(|_| scene.vehicle.is_airborne()) {
        ui.label(RichText::new(differs(way, units)).color(p.weak));
        let under_way = scene.vehicle.current_leg().filter(|leg| report.changed.contains(leg));
        if let Some(text) = under_way.and_then(|leg| goes_on(scene.document.plan(), leg)) {
            ui.label(RichText::new(text).color(p.text));
        }
    }
}

/// A survey under way that is changed goes on, where what is drawn of the new plan begins anew: the executor leaves out what is flown, and
/// does not turn tracks of which nobody says where they lead.
fn goes_on(plan: &FlightPlan, leg: &Id) -> Option<String> {
    let LegKind::Scan(scan) = &plan.leg(leg)?.leg.kind else { return None };
    let turned = if scan.heading_deg.is_none() {
        ", and its tracks keep their direction (give the scan a heading to turn them)"
    } else {
        ""
    };
    let name = plan.label(leg);
    Some(format!(
        "{name} is under way: what is flown of it is not flown again{turned}. The map shows it from its beginning; once this is committed, the \
         vehicle tells the way that it flies"
    ))
}

/// How long ago it was looked at, seconds.
fn age_s(scene: &Scene<'_>, proposal: &Proposal) -> f64 {
    proposal.told.age_s(scene.now_s, scene.vehicle.clock_s(scene.now_s))
}

/// The aircraft flew on since.
fn is_old(scene: &Scene<'_>, proposal: &Proposal) -> bool {
    age_s(scene, proposal) > OLD_S && scene.vehicle.is_airborne()
}

/// It is looked at again by itself: it is what is shown, and nobody chooses a leg in it.
fn looks_again(scene: &Scene<'_>, proposal: &Proposal) -> bool {
    let hash = scene.analysis.hash_of(scene.document.version());
    let is_shown = hash.is_some_and(|hash| *hash == *proposal.report.hash);
    scene.vehicle.open_link().is_some() && is_shown && !proposal.report.entry_needed
}

/// It is to be looked at again now.
pub fn is_due(scene: &Scene<'_>) -> bool {
    let requests = &scene.vehicle.requests;
    let is_due = |proposal: &Proposal| is_old(scene, proposal) && looks_again(scene, proposal);
    let is_asked = [PUSH, LOOK_AGAIN].iter().any(|label| requests.is_pending(label));
    let rests = requests.asked_s(LOOK_AGAIN).is_some_and(|asked_s| scene.now_s - asked_s < PAUSE_S);
    scene.vehicle.proposal.as_ref().is_some_and(is_due) && !is_asked && !rests
}

/// Where the new path leaves the one that is flown now.
fn differs((m, s): (f64, f64), units: Units) -> String {
    if m < HERE_M {
        return "It leaves the path that is flown now at once.".into();
    }
    let (way, time) = (units.length().show(m), units::duration(s));
    format!("It flies on as now for {way} ({time}), then leaves that path.")
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
        let legs: Vec<&Id> = entries(scene).collect();
        let text = |leg: &&Id| {
            let way = proposal.report.entries.iter().find(|entry| entry.leg == **leg);
            let so_far = in_so_far(way.map(|e| (e.in_m, e.in_s)), scene.units());
            format!("{}{so_far}", scene.document.label(leg))
        };
        let now = legs.iter().position(|leg| proposal.entry.as_ref() == Some(*leg));
        let list = List { salt: "entry", name: current, shown: current, look: |combo| combo };
        if let Some(leg) =
            list.show(ui, now, || legs.iter().map(text).collect()).0.and_then(|taken| legs.get(taken))
        {
            queue.fly(FlyCommand::EnterAt((*leg).clone()));
        }
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

/// What was looked at long ago, and is not looked at again by itself, is committed by who insists on it. Nothing moves below a pointer
/// that is on its way to it.
fn buttons(ui: &mut Ui, scene: &Scene<'_>, proposal: &Proposal, queue: &mut Queue) {
    let p = theme::of(ui);
    let is_old = is_old(scene, proposal);
    let is_stale = is_old && !looks_again(scene, proposal);
    let button =
        |text, is_next: bool| if is_next { super::primary_button(text, p) } else { Button::new(text) };
    let commit = button("Commit", !is_stale);
    if ui.add_enabled(is_ready(proposal), commit).clicked() {
        queue.fly(FlyCommand::Commit);
    }
    if ui.button("Keep as draft").clicked() {
        queue.fly(FlyCommand::DropProposal);
    }
    if is_old && ui.add(button("Push again", is_stale)).clicked() {
        queue.fly(FlyCommand::Propose);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_a_survey_under_way_it_is_said_that_it_goes_on() {
        let said = |heading: &str| {
            let text = format!(
                r#"<flightPlan xmlns="urn:legwork:flight-plan:1"><mainPlan><stage id="m" type="mission">
                <scan id="s" spacing="100"{heading}><area><corner lat="46" lon="9"/><corner lat="46" lon="9.01"/>
                <corner lat="46.01" lon="9"/></area></scan></stage></mainPlan></flightPlan>"#
            );
            goes_on(&flight_plan::read(text.as_bytes()).plan, &"s".into())
        };
        let keeps = |heading: &str| said(heading).unwrap().contains("keep their direction");
        assert!(keeps("") && !keeps(r#" heading="40""#));
        assert_eq!(goes_on(&FlightPlan::default(), &"s".into()), None);
    }

    #[test]
    fn where_the_way_differs_is_said_in_words() {
        assert_eq!(differs((0.2, 0.0), Units::Si), "It leaves the path that is flown now at once.");
        let ahead = differs((850.0, 34.0), Units::Si);
        assert!(
            ahead.starts_with("It flies on as now for 850 m (") && ahead.ends_with("then leaves that path.")
        );
    }
}
