//! The altitudes of several legs and stages, raised together; those that say none stay as they are.

use crate::command::Queue;
use crate::panels::{Scene, field};
use crate::theme;
use egui::{Context, Label, RichText, Ui};
use flight_plan::{Altitude, Edit, FlightPlan, Id, LegKind, Value};
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
    let mut by_m = ui.data(|d| d.get_temp(id)).unwrap_or(USUAL_M);
    let set: HashSet<&Id> = set.iter().collect();
    field::row_with_help(ui, "Raise by", "Above what each leg has or inherits.", |ui| {
        if ui.data_mut(|d| d.remove_temp::<bool>(asked_for())).is_some() {
            field::focus_next(ui.ctx());
        }
        match field::number(ui, "Raise by", by_m, scene.units().altitude(), f64::MIN) {
            field::Change::Moving(m) | field::Change::Set(m) => by_m = m,
            field::Change::None | field::Change::Ended => {}
        }
        if ui.button("Raise them").on_hover_text("Less than nothing lowers them").clicked() {
            queue.edit(Edit::All(Raised::of(scene.document.plan(), &set).edits(by_m)));
        }
    });
    ui.data_mut(|d| d.insert_temp(id, by_m));
    if let Some(text) = Raised::of(scene.document.plan(), &set).stays(scene) {
        ui.add(Label::new(RichText::new(text).size(12.0).color(theme::of(ui).weak)).wrap());
    }
}

/// What of a set says an altitude that can be raised.
struct Raised<'a> {
    /// What has an altitude of its own then, with what it has now.
    altitudes: Vec<(&'a Id, Altitude)>,
    /// Legs that are flown at the altitude of the leg before, or as their procedure says.
    without: Vec<&'a Id>,
    /// A call is among them whose procedure says an altitude.
    calls: bool,
}

impl<'a> Raised<'a> {
    fn of(plan: &'a FlightPlan, set: &HashSet<&Id>) -> Self {
        let mut raised = Self { altitudes: Vec::new(), without: Vec::new(), calls: false };
        let stages = plan.all_stages().map(|(_, stage)| stage).filter(|stage| set.contains(&stage.id));
        for stage in stages {
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
            if let LegKind::Call(call) = &leg.kind {
                let procedure = plan.procedure(&call.procedure);
                raised.calls |= procedure.is_some_and(|p| p.legs.iter().any(|leg| leg.altitude.is_some()));
            }
            // what it inherits from comes with it
            let around = context.loops.iter().rev().map(|leg| (&leg.id, &leg.altitude));
            let mut around = around.chain([(&context.stage.id, &context.stage.altitude)]);
            let from = around.find(|(_, altitude)| altitude.is_some());
            let is_raised = from.is_some_and(|(id, _)| set.contains(id));
            match context.altitude() {
                Some(_) if leg.altitude.is_none() && is_raised => {}
                Some(said) => raised.altitudes.push((&leg.id, said.clone())),
                None => raised.without.push(&leg.id),
            }
        }
        raised
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

    /// Which stay as they are, and why.
    fn stays(&self, scene: &Scene<'_>) -> Option<String> {
        let mut names: Vec<&str> =
            self.without.iter().take(NAMED).map(|id| scene.document.label(id)).collect();
        let rest = self.without.len() - names.len();
        let rest = if rest > 0 { format!("{rest} more") } else { String::new() };
        names.extend(Some(rest.as_str()).filter(|rest| !rest.is_empty()));
        let mut sentences = Vec::new();
        if !names.is_empty() {
            let say = if self.without.len() == 1 {
                "stays as it is: it says"
            } else {
                "stay as they are: they say"
            };
            sentences.push(format!("{} {say} no altitude.", names.join(", ")));
        }
        if self.calls {
            sentences.push("Procedures stay as they are where they say altitudes of their own.".into());
        }
        (!sentences.is_empty()).then(|| sentences.join(" "))
    }
}
