//! The altitudes of several legs and stages, raised together; those that say none stay as they are.

use super::together::whose;
use crate::command::Queue;
use crate::document::Document;
use crate::map::guard;
use crate::panels::{Scene, field};
use crate::theme;
use crate::units::Unit;
use egui::{Context, Label, RichText, Ui};
use flight_plan::{Altitude, Edit, FlightPlan, Id, Leg, LegKind, Procedure, Stage, StageKind, Value};
use std::collections::HashSet;

/// What is offered at first, metres.
const USUAL_M: f64 = 30.0;
/// So many of those that stay as they are are named.
const NAMED: usize = 4;

fn asked_for() -> egui::Id {
    egui::Id::unique("type by how much altitudes are raised")
}

/// Puts the cursor into the field, as soon as it is there.
pub fn focus(ctx: &Context) {
    ctx.data_mut(|d| d.insert_temp(asked_for(), true));
}

/// By how much, and which of them stay as they are.
pub(super) fn show(ui: &mut Ui, scene: &Scene<'_>, set: &[Id], queue: &mut Queue) {
    let id = egui::Id::unique("raise legs by");
    // what was typed for others is not offered for these
    let of = egui::Id::unique((&scene.document.plan().name, set));
    let typed: Option<(egui::Id, f64)> = ui.data(|d| d.get_temp(id));
    let mut by_m = typed.filter(|(typed_of, _)| *typed_of == of).map_or(USUAL_M, |(_, by_m)| by_m);
    let behind = guard::behind(scene);
    let (flown, all): (Vec<&Id>, HashSet<&Id>) = split(set, &behind);
    let away = away_from_runways(scene.document.plan(), &all);
    let leaves = egui::Id::unique("leave take-off and approaches alone");
    let mut are_left = ui.data(|d| d.get_temp(leaves)).unwrap_or(true);
    let may_leave = !away.is_empty() && away.len() < all.len();
    let set = if may_leave && are_left { away } else { all };
    field::row_with_help(ui, "Raise by", "Above what each leg has or inherits.", |ui| {
        if ui.data_mut(|d| d.remove_temp::<bool>(asked_for())).is_some() {
            field::focus_next(ui.ctx());
        }
        let (change, is_entered) = field::number_to_enter(ui, "Raise by", by_m, scene.units().altitude());
        match change {
            field::Change::Moving(m) | field::Change::Set(m) => by_m = m,
            field::Change::None | field::Change::Ended => {}
        }
        let is_again = Done::told(ui.ctx(), scene).is_some_and(|done| done.is_of(&set));
        let button = if is_again { "Raise them again" } else { "Raise them" };
        let button = ui.button(button).on_hover_text("Less than nothing lowers them");
        if button.clicked() || is_entered {
            raise(ui, scene, &set, by_m, queue);
        }
    });
    ui.data_mut(|d| d.insert_temp(id, (of, by_m)));
    if may_leave {
        ui.checkbox(&mut are_left, LEAVE).on_hover_text("Their altitudes lead to and from a runway");
        ui.data_mut(|d| d.insert_temp(leaves, are_left));
    }
    let p = theme::of(ui);
    let told = Done::told(ui.ctx(), scene).map(|done| (format!("✔ {}", done.text), p.good));
    let stays = Raised::of(scene.document.plan(), &set).stays(scene.document).map(|text| (text, p.weak));
    let flown = flown_words(scene.document, &flown).map(|text| (text, p.weak));
    for (text, colour) in told.into_iter().chain(flown).chain(stays) {
        ui.add(Label::new(RichText::new(text).size(12.0).color(colour)).wrap());
    }
}

/// What is flown already, and the others.
fn split<'a>(set: &'a [Id], behind: &HashSet<&Id>) -> (Vec<&'a Id>, HashSet<&'a Id>) {
    let (flown, ahead): (Vec<&Id>, Vec<&Id>) = set.iter().partition(|id| behind.contains(id));
    (flown, ahead.into_iter().collect())
}

fn flown_words(document: &Document, flown: &[&Id]) -> Option<String> {
    let stay =
        if flown.len() == 1 { "stays as it is: it was flown" } else { "stay as they are: they were flown" };
    (!flown.is_empty()).then(|| format!("{} {stay}.", some_names(document, flown)))
}

/// The first of them, and how many more.
fn some_names(document: &Document, ids: &[&Id]) -> String {
    let mut names: Vec<String> = ids.iter().take(NAMED).map(|id| whose(document, id)).collect();
    let rest = ids.len() - names.len();
    names.extend((rest > 0).then(|| format!("{rest} more")));
    names.join(", ")
}

const LEAVE: &str = "Leave take-off and approaches alone";

/// Those of a set that lead neither to nor from a runway.
fn away_from_runways<'a>(plan: &FlightPlan, set: &HashSet<&'a Id>) -> HashSet<&'a Id> {
    let near = [StageKind::TakeOff, StageKind::Approach, StageKind::Land];
    let is_near = |id: &Id| stage_of(plan, id).is_some_and(|stage| near.contains(&stage.kind));
    set.iter().copied().filter(|id| !is_near(id)).collect()
}

fn raise(ui: &Ui, scene: &Scene<'_>, set: &HashSet<&Id>, by_m: f64, queue: &mut Queue) {
    let plan = scene.document.plan();
    let raised = Raised::of(plan, set);
    let unit = scene.units().altitude();
    let last = Done::told(ui.ctx(), scene).filter(|done| done.is_of(set));
    let mut text = raised.done(plan, by_m, unit);
    let in_all_m = by_m + last.as_ref().map_or(0.0, |done| done.in_all_m);
    if last.is_some() {
        let how = if in_all_m < 0.0 { "lower" } else { "higher" };
        text = format!("{text} again: {} {how} in all", unit.show(in_all_m.abs()));
    }
    let of = set.iter().map(|id| (*id).clone()).collect();
    let done = Done { before: scene.document.version(), after: None, of, in_all_m, text };
    ui.data_mut(|d| d.insert_temp(Done::id(), done));
    queue.edit(Edit::All(raised.edits(by_m)));
}

/// What was raised last. Who is not told raises again.
#[derive(Debug, Clone)]
struct Done {
    /// The document's version then, and with that edit, once it is made.
    before: u64,
    after: Option<u64>,
    /// What was asked to be raised, and by how much since it was selected.
    of: HashSet<Id>,
    in_all_m: f64,
    text: String,
}

impl Done {
    fn id() -> egui::Id {
        egui::Id::unique("what was raised last")
    }

    fn is_of(&self, set: &HashSet<&Id>) -> bool {
        self.of.len() == set.len() && set.iter().all(|id| self.of.contains(*id))
    }

    /// It is told until something else is edited, or that is undone.
    fn told(ctx: &Context, scene: &Scene<'_>) -> Option<Self> {
        let (id, now) = (Self::id(), scene.document.version());
        let mut done: Self = ctx.data(|d| d.get_temp(id))?;
        if done.after.is_none() && done.before != now {
            done.after = Some(now);
            ctx.data_mut(|d| d.insert_temp(id, done.clone()));
        }
        (done.after == Some(now)).then_some(done)
    }
}

/// Stages whose legs inherit their altitude, with all of their legs in the set.
fn whole_stages<'a>(plan: &'a FlightPlan, set: &HashSet<&Id>) -> HashSet<&'a Id> {
    let says = |stage: &&Stage| stage.altitude.is_some() && stage.kind != StageKind::TakeOff;
    let stages = plan.all_stages().map(|(_, stage)| stage).filter(says);
    let mut whole: HashSet<&Id> =
        stages.filter(|stage| !stage.legs.is_empty()).map(|stage| &stage.id).collect();
    for context in plan.all_legs() {
        if !set.contains(&context.leg.id) && context.leg.as_fork().is_none() {
            whole.remove(&context.stage.id);
        }
    }
    whole
}

/// A stage, or that of a leg.
fn stage_of<'a>(plan: &'a FlightPlan, id: &Id) -> Option<&'a Stage> {
    plan.stage(id).or_else(|| plan.leg(id).map(|context| context.stage))
}

/// What of a set says an altitude that can be raised.
struct Raised<'a> {
    /// What has an altitude of its own then, with what it has now.
    altitudes: Vec<(&'a Id, Altitude)>,
    /// Legs that are flown at the altitude of the leg before, or as their procedure says.
    without: Vec<&'a Id>,
    /// A call is among them whose procedure says an altitude, and is called elsewhere, too.
    calls: bool,
}

impl<'a> Raised<'a> {
    fn of(plan: &'a FlightPlan, set: &HashSet<&Id>) -> Self {
        let mut raised = Self { altitudes: Vec::new(), without: Vec::new(), calls: false };
        // a stage of which all legs are raised is raised with them: they go on inheriting, and so do those that are added
        let whole = whole_stages(plan, set);
        let is_raised = |id: &Id| set.contains(id) || whole.contains(id);
        for stage in plan.all_stages().map(|(_, stage)| stage).filter(|stage| is_raised(&stage.id)) {
            match &stage.altitude {
                Some(own) => raised.altitudes.push((&stage.id, own.clone())),
                None => raised.without.extend(stage.legs.is_empty().then_some(&stage.id)),
            }
        }
        for context in plan.all_legs() {
            let leg = context.leg;
            // at a fork nothing is flown
            if !set.contains(&leg.id) || leg.as_fork().is_some() {
                continue;
            }
            // what it inherits from comes with it
            let around = context.loops.iter().rev().map(|leg| (&leg.id, &leg.altitude));
            let mut around = around.chain([(&context.stage.id, &context.stage.altitude)]);
            let from = around.find(|(_, altitude)| altitude.is_some());
            match context.altitude() {
                Some(_) if leg.altitude.is_none() && from.is_some_and(|(id, _)| is_raised(id)) => {}
                Some(said) => raised.altitudes.push((&leg.id, said.clone())),
                None => raised.without.push(&leg.id),
            }
        }
        plan.procedures.iter().for_each(|procedure| raised.add_procedure(plan, procedure, set));
        raised
    }

    /// What a procedure says itself, if all that call it are raised.
    fn add_procedure(&mut self, plan: &'a FlightPlan, procedure: &Procedure, set: &HashSet<&Id>) {
        let calls = |leg: &Leg| matches!(&leg.kind, LegKind::Call(call) if call.procedure == procedure.id);
        let calling = plan.all_legs().into_iter().map(|context| context.leg).filter(|leg| calls(leg));
        let (among, elsewhere): (Vec<&Leg>, Vec<&Leg>) = calling.partition(|leg| set.contains(&leg.id));
        let is_its = |leg: &Leg| plan.procedure_leg(&leg.id).is_some_and(|(of, _)| of.id == procedure.id);
        let legs = plan.procedure_legs().into_iter().filter(|leg| is_its(leg));
        let own: Vec<_> = legs.filter_map(|leg| Some((&leg.id, leg.altitude.clone()?))).collect();
        match (among.is_empty(), elsewhere.is_empty()) {
            (false, true) => self.altitudes.extend(own),
            (false, false) => self.calls |= !own.is_empty(),
            (true, _) => {}
        }
    }

    fn edits(&self, by_m: f64) -> Vec<Edit> {
        let raised = |(of, now): &(&Id, Altitude)| {
            let metres = match &now.metres {
                Value::Constant(metres) => Value::Constant(metres + by_m),
                Value::Expression(formula) => Value::Expression(format!("({formula}) + {by_m:?}").into()),
            };
            let altitude = Some(Altitude { metres, reference: now.reference });
            Edit::SetAltitude { of: (*of).clone(), altitude }
        };
        self.altitudes.iter().map(raised).collect()
    }

    /// What was done, for people: `14 altitudes raised by 30 m; the final approach too`.
    fn done(&self, plan: &FlightPlan, by_m: f64, unit: Unit) -> String {
        let count = match self.altitudes.len() {
            1 => "1 altitude".to_owned(),
            count => format!("{count} altitudes"),
        };
        let how = if by_m < 0.0 { "lowered" } else { "raised" };
        let is_final = |id| stage_of(plan, id).is_some_and(|stage| stage.kind == StageKind::Approach);
        let finals = self.altitudes.iter().any(|(id, _)| is_final(id));
        let finals = if finals { "; the final approach too" } else { "" };
        format!("{count} {how} by {}{finals}", unit.show(by_m.abs()))
    }

    /// Which stay as they are, and why.
    fn stays(&self, document: &Document) -> Option<String> {
        let mut sentences = Vec::new();
        if !self.without.is_empty() {
            let say = if self.without.len() == 1 {
                "stays as it is: it says"
            } else {
                "stay as they are: they say"
            };
            sentences.push(format!("{} {say} no altitude.", some_names(document, &self.without)));
        }
        if self.calls {
            sentences.push("Procedures that are called elsewhere, too, keep altitudes of their own.".into());
        }
        (!sentences.is_empty()).then(|| sentences.join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The orbits at three pylons stayed 30 m lower than the rest.
    #[test]
    fn a_procedure_of_which_all_calls_are_raised_is_raised() {
        let procedure = r#"<procedures><procedure id="look" reference="36.3 -84.1">
            <orbit id="round" radius="150" turns="1" altitude="420"><centre lat="36.3" lon="-84.1"/></orbit></procedure></procedures>"#;
        let calls = r#"<call id="one" procedure="look"/><call id="two" procedure="look" lat="36.3150" lon="-84.1750"/>"#;
        let text = String::from_utf8_lossy(PLAN).replace("<mainPlan", &format!("{procedure}<mainPlan"));
        let plan = flight_plan::read(text.replace(r#"<TF id="side3" fix="C"/>"#, calls).as_bytes()).plan;
        let has_round = |ids: &[&str]| raised(&plan, ids).iter().any(|id| id == "round");
        assert!(has_round(&["side1", "one", "two"]));
        assert!(!has_round(&["one"]) && !has_round(&["side1"]));
        let one = Id::new("one");
        assert!(Raised::of(&plan, &HashSet::from([&one])).calls, "and that is told");
    }

    const PLAN: &[u8] = include_bytes!("../../../../assets/plans/square.xml");

    fn raised(plan: &FlightPlan, ids: &[&str]) -> Vec<String> {
        let set: Vec<Id> = ids.iter().map(|id| Id::new(id)).collect();
        let raised = Raised::of(plan, &set.iter().collect());
        raised.altitudes.iter().map(|(id, _)| id.to_string()).collect()
    }

    #[test]
    fn a_stage_of_which_all_legs_are_raised_is_raised_and_they_inherit() {
        let plan = flight_plan::read(PLAN).plan;
        let sides = ["side1", "side2", "side3", "side4"];
        assert_eq!(raised(&plan, &sides), ["circuit", "side1", "side4"]);
        assert_eq!(raised(&plan, &sides[..3]), ["side1", "side2", "side3"], "side4 stays where it is");
    }

    #[test]
    fn what_stays_as_it_is_is_told_with_the_emergency_plan_that_it_is_of() {
        let document = Document::read(PLAN, None);
        let ids = ["land", "r-land"].map(Id::new);
        let stays = Raised::of(document.plan(), &ids.iter().collect()).stays(&document).unwrap();
        assert_eq!(stays, "land, r-land of return stay as they are: they say no altitude.");
    }

    #[test]
    fn take_off_and_approaches_are_known_among_others() {
        let text = String::from_utf8_lossy(PLAN).replace(r#"type="arrival""#, r#"type="approach""#);
        let plan = flight_plan::read(text.as_bytes()).plan;
        let ids = ["take-off", "side1", "circuit", "r1", "land"].map(Id::new);
        let mut away: Vec<&str> =
            away_from_runways(&plan, &ids.iter().collect()).into_iter().map(Id::as_str).collect();
        away.sort_unstable();
        assert_eq!(away, ["circuit", "side1"]);
    }

    #[test]
    fn what_was_raised_is_said_and_the_final_approach_by_name() {
        let text = String::from_utf8_lossy(PLAN).replace(r#"type="arrival""#, r#"type="approach""#);
        let plan = flight_plan::read(text.as_bytes()).plan;
        let done = |ids: [&str; 2], by_m| {
            let ids = ids.map(Id::new);
            Raised::of(&plan, &ids.iter().collect()).done(&plan, by_m, crate::units::Units::Si.altitude())
        };
        assert_eq!(done(["side1", "side2"], 30.0), "2 altitudes raised by 30 m");
        assert_eq!(done(["side1", "r1"], -30.0), "2 altitudes lowered by 30 m; the final approach too");
    }
}
