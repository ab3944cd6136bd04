//! An emergency plan that is being flown: what, why, where to, and the way back to the main plan.

use super::{Scene, field, flight};
use crate::command::Queue;
use crate::theme;
use crate::units;
use egui::{Color32, ComboBox, Frame, Margin, Panel, RichText, Ui};
use flight_exec::Command;
use flight_plan::{Cause, EmergencyPlan, FlightPlan, Id, Section};

/// Draws the banner, while an emergency plan is being flown.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(flown) = scene.vehicle.status.as_ref().and_then(|s| s.value.emergency.as_ref()) else { return };
    let fill = theme::of(ui).warning;
    Panel::top("emergency").frame(Frame::new().fill(fill).inner_margin(Margin::symmetric(10, 6))).show(
        ui,
        |ui| {
            steady(ui, flown, |ui| {
                let text = RichText::new(sentence(scene, flown)).strong().color(on(fill));
                ui.label(text);
                if !has_come_down(scene) {
                    way_back(ui, scene, queue);
                }
            });
        },
    );
}

/// As high as it was at most since this plan is flown, in a window of this width: where its text gets shorter, nothing below moves
/// away under the pointer.
fn steady(ui: &mut Ui, flown: &Id, show: impl FnOnce(&mut Ui)) {
    let id = egui::Id::unique("height of the emergency's banner");
    let width = ui.available_width();
    let kept = ui.data(|d| d.get_temp::<(Id, f32, f32)>(id));
    let least =
        kept.filter(|(plan, of, _)| plan == flown && *of == width).map_or(0.0, |(_, _, height)| height);
    ui.set_min_height(least);
    let height = ui.horizontal_wrapped(show).response.rect.height();
    ui.data_mut(|d| d.insert_temp(id, (flown.clone(), width, height.max(least))));
}

/// What can be read on a warning's colour.
fn on(fill: Color32) -> Color32 {
    if fill.intensity() > 0.5 { Color32::BLACK } else { Color32::WHITE }
}

/// `EMERGENCY: flying Return home, because the engine failed, to runway 27, lands in 6:20`; once it is down, where it lies.
fn sentence(scene: &Scene<'_>, flown: &Id) -> String {
    let plan = scene.vehicle.aboard.as_ref().and_then(|a| plan_named(&a.plan, flown));
    let name = plan.map(|plan| plan.name.as_str()).filter(|name| !name.is_empty()).unwrap_or(flown.as_str());
    let raised = scene.vehicle.raised.as_ref().filter(|raised| raised.plan == *flown);
    let cause = raised.map_or_else(String::new, |raised| format!(", because {}", because(raised.cause)));
    if has_come_down(scene) {
        return format!("⛔ EMERGENCY: {name}{cause}, ended on the ground{}", beside(scene, plan));
    }
    let runway = plan.map_or_else(String::new, |plan| format!(", to runway {}", plan.runway));
    let clock_s = scene.vehicle.clock_s(scene.now_s);
    let lands = clock_s.and_then(|aircraft_s| scene.vehicle.outlook.lands_in_s(aircraft_s));
    let lands = lands.map_or_else(String::new, |s| format!(", lands in {}", units::duration(s)));
    format!("⛔ EMERGENCY: flying {name}{cause}{runway}{lands}")
}

/// `, 2.5 km from runway 27`.
fn beside(scene: &Scene<'_>, plan: Option<&EmergencyPlan>) -> String {
    let aboard = scene.vehicle.aboard.as_ref();
    let runway = plan.and_then(|plan| aboard?.plan.runway(&plan.runway));
    let lies = scene.vehicle.position.as_ref().map(|position| position.value.position);
    let (Some(runway), Some(lies)) = (runway, lies) else { return String::new() };
    let off = scene.units().distance().show(lies.distance_m(runway.threshold));
    format!(", {off} from runway {}", runway.id)
}

/// The emergency plan of this identifier.
pub fn plan_named<'a>(plan: &'a FlightPlan, id: &Id) -> Option<&'a EmergencyPlan> {
    plan.emergency_plans.iter().find(|plan| plan.id == *id)
}

fn because(cause: Cause) -> &'static str {
    match cause {
        Cause::Engine => "the engine failed",
        Cause::Energy => "the energy is low",
        Cause::Link => "the link was lost",
        Cause::Gps => "the position was lost",
        Cause::Traffic => "of traffic",
        Cause::Payload => "the payload failed",
        Cause::Operator => "the operator said so",
    }
}

/// One is being flown.
pub fn is_flown(scene: &Scene<'_>) -> bool {
    scene.vehicle.status.as_ref().is_some_and(|status| status.value.emergency.is_some())
}

/// An emergency plan was being flown, and the aircraft stands, disarmed: wherever that is, nothing is flown any more.
pub fn has_come_down(scene: &Scene<'_>) -> bool {
    is_flown(scene) && flight::can_rewind(scene)
}

/// The leg at which the main plan would be gone on with: where the emergency was raised, else its first.
pub fn way_back_to(scene: &Scene<'_>) -> Option<Id> {
    let aboard = scene.vehicle.aboard.as_ref().filter(|_| is_flown(scene))?;
    let raised = scene.vehicle.raised.as_ref().and_then(|raised| raised.from_leg.as_ref());
    let main = main_legs(&aboard.plan);
    raised.filter(|leg| main.contains(leg)).or(main.first().copied()).cloned()
}

fn main_legs(plan: &FlightPlan) -> Vec<&Id> {
    let legs = plan.all_legs().into_iter().filter(|context| context.section == Section::Main);
    legs.map(|context| &context.leg.id).collect()
}

/// Which leg, then the command: it goes on where the emergency was raised unless another leg is chosen.
fn way_back(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(aboard) = &scene.vehicle.aboard else { return };
    let main = main_legs(&aboard.plan);
    let id = ui.make_persistent_id("way back");
    let chosen: Option<Id> = ui.data(|d| d.get_temp(id));
    let Some(leg) = chosen.filter(|leg| main.contains(&leg)).or_else(|| way_back_to(scene)) else { return };
    let back = ui.button(format!("Return to the main plan at {}", scene.vehicle.name_of(&leg)));
    if field::is_pressed(&back) {
        queue.consider(Command::ReturnToMain { leg: leg.clone() });
    }
    let combo = ComboBox::from_id_salt("way back").selected_text("another leg").width(96.0);
    let shown = combo.show_ui(ui, |ui| {
        for other in main {
            if ui.selectable_label(*other == leg, scene.vehicle.name_of(other)).clicked() {
                ui.data_mut(|d| d.insert_temp(id, other.clone()));
            }
        }
    });
    shown.response.on_hover_text("Return to the main plan at another leg");
}
