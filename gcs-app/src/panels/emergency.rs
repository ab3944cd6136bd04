//! An emergency plan that is being flown: what, why, where to, and the way back to the main plan.

use super::field::List;
use super::{Scene, answer, ended, field, flight, in_force, other_end, profile, reach};
use crate::command::Queue;
use crate::state::{Unanswered, is_safe};
use crate::theme;
use crate::units;
use egui::text::LayoutJob;
use egui::{Align, Button, Color32, FontId, Frame, Label, Layout, Margin, Panel, TextStyle, Ui};
use flight_exec::{Command, Phase};
use flight_plan::{Cause, EmergencyPlan, FlightPlan, Id, Section};
use geometry::LatLon;
use usal::contract::GatewayState;

/// Height of the strip, screen points.
const STRIP: f32 = 34.0;
/// Of two lines in it, points.
const SMALL: f32 = 11.5;
/// Most of it that the way back takes.
const WAY_BACK: f32 = 0.55;

/// Draws the banner while an emergency plan is being flown. Its room is kept for as long as the aircraft is in the air, and says what
/// is flown: nothing moves under the pointer when an emergency begins.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let flown = scene.vehicle.status.as_ref().and_then(|s| s.value.emergency.as_ref());
    if flown.is_none() && !scene.vehicle.is_airborne() {
        return;
    }
    let p = theme::of(ui);
    let said =
        flown.map(|flown| sentence(scene, flown)).or_else(|| Some(format!("⛔ {}", safe_mode(scene, "")?)));
    let fill = if said.is_some() { p.warning } else { p.panel };
    let frame = Frame::new().fill(fill).inner_margin(Margin::symmetric(10, 0));
    Panel::top("emergency").exact_size(STRIP).frame(frame).show(ui, |ui| {
        let (text, colour) = match said {
            Some(said) => (said, on(fill)),
            None => match led_otherwise(scene) {
                Some(how) => (format!("⚠ {how}"), p.caution),
                None => {
                    let silence_s = scene.vehicle.autopilot_silence_s(scene.now_s);
                    let old = silence_s.map(|s| format!(" · last heard {} ago", units::age(s)));
                    (format!("{}{}", as_planned(scene), old.unwrap_or_default()), p.weak)
                }
            },
        };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if flown.is_some() && !has_come_down(scene) {
                way_back(ui, scene, queue);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                say(ui, &text, colour);
            });
        });
    });
}

/// In one line or, smaller, in two; the end of what takes more is read by pointing at it.
fn say(ui: &mut Ui, text: &str, colour: Color32) {
    let own = TextStyle::Body.resolve(ui.style());
    let width = ui.available_width();
    let fits = ui.painter().layout_no_wrap(text.to_owned(), own.clone(), colour).size().x <= width;
    let font = if fits { own } else { FontId::proportional(SMALL) };
    let mut job = LayoutJob::simple(text.to_owned(), font, colour, width);
    job.wrap.max_rows = 2;
    ui.add(Label::new(job).wrap()).on_hover_text(text);
}

/// The gateway's Safe mode leads it in the air: it flies its own way, which nobody tells.
pub fn is_safe_mode(scene: &Scene<'_>) -> bool {
    let state = scene.vehicle.gateway.as_ref().map(|gateway| gateway.value.state);
    state.is_some_and(is_safe) && scene.vehicle.is_airborne()
}

/// As [`led_otherwise`], where that is Safe mode in the air.
pub fn led_by_safe_mode(scene: &Scene<'_>) -> Option<String> {
    led_otherwise(scene).filter(|_| is_safe_mode(scene))
}

/// `not in command: the pilot switched to FBWA`: the plan does not lead the aircraft, though it is in force.
pub fn led_otherwise(scene: &Scene<'_>) -> Option<String> {
    use GatewayState::{Directed, Hold, Manual};
    let gateway = &scene.vehicle.gateway.as_ref()?.value;
    let cause = &gateway.cause;
    match gateway.state {
        Manual => Some(format!("not in command: {cause}")),
        Directed => Some(format!("directed: {cause}")),
        Hold => (scene.vehicle.phase() != Phase::Holding).then(|| format!("held: {cause}")),
        state if is_safe(state) => Some(match &scene.vehicle.watch.safe_mode {
            // where it goes was said before
            Some(whereto) if whereto != cause => format!("Safe mode: {whereto}, {cause}"),
            _ => format!("Safe mode: {cause}"),
        }),
        _ => None,
    }
}

/// `Safe mode: gliding to runway R05, straight in, touches down in 1:10, because the engine failed`, or for this cause, and why no emergency
/// plan is flown.
fn safe_mode(scene: &Scene<'_>, cause: &str) -> Option<String> {
    let how = led_by_safe_mode(scene)?;
    let status = &scene.vehicle.gateway.as_ref()?.value;
    // what is left in the autopilot's list is its way to the ground
    let left = scene.vehicle.navigation.as_ref().filter(|left| !left.is_expired(scene.now_s));
    let left = left.filter(|left| left.value.end_of_plan && status.state != GatewayState::SafeHold);
    let down = left.map(|left| format!(", touches down in {}", units::duration(left.value.buffer_s)));
    let why = why_safe(scene, cause, &status.cause);
    Some(format!("{how}{}{why}", down.unwrap_or_default()))
}

/// What the executor says with each of its reasons, and the banner before them.
const SAFE_DECIDES: &str = ": the gateway's Safe mode decides";

/// `, because the engine failed; Return home is not flown: its runway is not reached without the engine`. What is `shown` before is not said again.
fn why_safe(scene: &Scene<'_>, cause: &str, shown: &str) -> String {
    let unanswered = scene.vehicle.unanswered();
    let engine = scene.vehicle.is_engine_out().then_some(Cause::Engine);
    let because = match engine.or_else(|| Some(unanswered?.cause)) {
        Some(cause) => format!(", because {}", because(cause)),
        None if cause.is_empty() => {
            let began = scene.vehicle.why_safe.began.as_deref().filter(|began| *began != shown);
            began.map_or_else(String::new, |began| format!(" · {began}"))
        }
        None => cause.to_owned(),
    };
    let not_flown = unanswered.map(|Unanswered { plan, reason, .. }| match plan {
        Some(plan) => {
            let reason = scene.vehicle.told(reason.strip_suffix(SAFE_DECIDES).unwrap_or(reason));
            format!("; {} is not flown: {reason}", scene.vehicle.name_of(plan))
        }
        None => "; no emergency plan is named for that".to_owned(),
    });
    format!("{because}{}", not_flown.unwrap_or_default())
}

/// `Flying Departure ▸ Climb in the hold · alternate: Return home`.
fn as_planned(scene: &Scene<'_>) -> String {
    let vehicle = scene.vehicle;
    let status = vehicle.status.as_ref().map(|status| &status.value);
    let place = status.and_then(|status| status.place.as_ref());
    let is_holding = vehicle.phase() == Phase::Holding;
    if let Some(height) = answer::until_height(scene) {
        let then = if is_holding { "then it holds" } else { "then the changed way is flown" };
        return format!("Climbing straight ahead {height}, {then}");
    }
    let does = if is_holding { "Holding on" } else { "Flying" };
    let does = place.map_or_else(
        || "In the air".to_owned(),
        |at| format!("{does} {} ▸ {}", vehicle.name_of(&at.stage), vehicle.name_of(&at.leg)),
    );
    let answer = status.and_then(|status| status.emergency_in_force.as_ref());
    let answer = answer.map(|plan| format!(" · alternate: {}", vehicle.name_of(plan)));
    let engine = in_force::of_engine(scene).map(|plan| format!(" · engine: {}", vehicle.name_of(&plan)));
    format!("{does}{}{}", answer.unwrap_or_default(), engine.unwrap_or_default())
}

/// What can be read on a warning's colour.
fn on(fill: Color32) -> Color32 {
    if fill.intensity() > 0.5 { Color32::BLACK } else { Color32::WHITE }
}

/// `EMERGENCY: flying Return home, touches down in 6:20, to runway 27, because the link was lost`; while something else than that plan
/// leads the aircraft, what does; once it is down, where it lies. In a narrow window the end is cut.
fn sentence(scene: &Scene<'_>, flown: &Id) -> String {
    let plan = scene.vehicle.aboard.as_ref().and_then(|a| plan_named(&a.plan, flown));
    let name = plan.map(|plan| plan.name.as_str()).filter(|name| !name.is_empty()).unwrap_or(flown.as_str());
    let raised = scene.vehicle.raised.as_ref().filter(|raised| raised.plan == *flown);
    let cause = raised.map_or_else(String::new, |raised| format!(", because {}", because(raised.cause)));
    if has_come_down(scene) {
        return format!("⛔ EMERGENCY: {name}, ended {}{cause}", where_it_ended(scene, plan));
    }
    if is_down(scene) {
        return format!("⛔ EMERGENCY: {name}, down {}{cause}", where_it_ended(scene, plan));
    }
    if let Some(how) = safe_mode(scene, &cause) {
        return format!("⛔ EMERGENCY: {how}");
    }
    if let Some(how) = led_otherwise(scene) {
        return format!("⛔ EMERGENCY: {how}{cause}");
    }
    if let Some(height) = answer::until_height(scene) {
        return format!("⛔ EMERGENCY: climbing straight ahead {height}, then flying {name}{cause}");
    }
    if let Some(why) = scene.vehicle.outlook.ends_early() {
        let another = another_reached(scene, plan).map(|other| format!(" · reached straight: {other}"));
        let (why, another) = (answer::told(scene, false, why), another.unwrap_or_default());
        return format!("⛔ EMERGENCY: flying {name}, {why}{another}{cause}");
    }
    let runway = plan
        .map_or_else(String::new, |plan| format!(", to runway {}{}", plan.runway, from_where(scene, plan)));
    let runway = format!("{runway}{}", at_first(scene, plan).unwrap_or_default());
    let lands = profile::lands_in_s(scene);
    let lands = lands.map_or_else(String::new, |s| format!(", touches down in {}", units::duration(s)));
    format!("⛔ EMERGENCY: flying {name}{lands}{runway}{cause}")
}

/// What this window can say of the glide before the vehicle has told where it ends: those are the seconds that count.
fn at_first(scene: &Scene<'_>, plan: Option<&EmergencyPlan>) -> Option<String> {
    if scene.vehicle.outlook.way().is_some() || !scene.vehicle.is_engine_out() {
        return None;
    }
    let runway = scene.vehicle.aboard.as_ref()?.plan.runway(&plan?.runway)?;
    Some(format!(", straight {}", reach::in_words(scene, runway)?))
}

/// While it glides to a runway that it does not reach.
fn another_reached(scene: &Scene<'_>, plan: Option<&EmergencyPlan>) -> Option<String> {
    reach::another(scene, scene.vehicle.aboard.as_ref()?.plan.runway(&plan?.runway)?)
}

/// `, from its other end`, where the way that the vehicle told ends so.
fn from_where(scene: &Scene<'_>, plan: &EmergencyPlan) -> &'static str {
    let runway = scene.vehicle.aboard.as_ref().and_then(|aboard| aboard.plan.runway(&plan.runway));
    let ends_so = runway.zip(scene.vehicle.outlook.way()).is_some_and(|(runway, (way, _))| {
        other_end::is_come_to(way.points.iter().map(|point| point.position), runway)
    });
    if ends_so { ", from its other end" } else { "" }
}

/// `on runway 27`, or `on the ground, 2.5 km from runway 27`: a runway is as long and as wide as it is.
fn where_it_ended(scene: &Scene<'_>, plan: Option<&EmergencyPlan>) -> String {
    let aboard = scene.vehicle.aboard.as_ref();
    let runway = plan.and_then(|plan| aboard?.plan.runway(&plan.runway));
    let lies = scene.vehicle.position.as_ref().map(|position| position.value.position);
    let (Some(runway), Some(lies)) = (runway, lies) else {
        return "on the ground".to_owned();
    };
    if runway.strip().is_landed_on(lies) {
        return format!("on runway {}{}", runway.id, ended::from_which_end(scene, runway));
    }
    let off = scene.units().distance().show(runway.strip().beside_m(lies));
    format!("on the ground, {off} from runway {}", runway.id)
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

/// It is on the ground, still armed.
fn is_down(scene: &Scene<'_>) -> bool {
    let position = scene.vehicle.position.as_ref().filter(|position| !position.is_expired(scene.now_s));
    position.is_some_and(|position| position.value.on_ground)
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

/// Where the aircraft is, and the runway that its emergency plan leads to, while one is flown or Safe mode leads it; `None`: neither.
pub fn places(scene: &Scene<'_>) -> Option<Vec<LatLon>> {
    let vehicle = scene.vehicle;
    let flown = vehicle.emergency().filter(|_| vehicle.is_airborne());
    if flown.is_none() && !is_safe_mode(scene) {
        return None;
    }
    let aboard = vehicle.aboard.as_ref().map(|aboard| aboard.plan.as_ref());
    let runway = aboard.zip(flown).and_then(|(plan, id)| plan.runway(&plan_named(plan, id)?.runway));
    let here = vehicle.position.as_ref()?.value.position;
    Some(std::iter::once(here).chain(runway.map(|runway| runway.threshold)).collect())
}

/// Why the way back is the last thing to do.
const NO_ENGINE: &str =
    "⚠ Without its engine it comes down on the way of the main plan. Hold to see what would follow";

/// The way back while the engine is out: nobody presses it in a hurry.
fn way_back_without_engine(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(leg) = way_back_to(scene) else { return };
    let colour = on(theme::of(ui).warning);
    let held = ui.scope(|ui| field::hold_button(ui, "⚠ Main plan, no engine", colour, 0.0));
    held.response.on_hover_text(NO_ENGINE);
    if held.inner {
        queue.consider(Command::ReturnToMain { leg });
    }
}

/// Which leg, then the command: it goes on where the emergency was raised unless another leg is chosen.
fn way_back(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    if scene.vehicle.is_engine_out() {
        return way_back_without_engine(ui, scene, queue);
    }
    let Some(aboard) = &scene.vehicle.aboard else { return };
    let main = main_legs(&aboard.plan);
    let id = ui.make_persistent_id("way back");
    let chosen: Option<Id> = ui.data(|d| d.get_temp(id));
    let Some(leg) = chosen.filter(|leg| main.contains(&leg)).or_else(|| way_back_to(scene)) else { return };
    // a long name leaves the sentence its room
    let most = ui.available_width() * WAY_BACK;
    let names = || main.iter().map(|other| scene.vehicle.name_of(other)).collect();
    let list = List {
        salt: "way back list",
        name: "another leg",
        shown: "another leg",
        look: |combo| combo.width(96.0),
    };
    let (taken, button) = list.show::<String>(ui, main.iter().position(|other| **other == leg), names);
    if let Some(other) = taken.and_then(|taken| main.get(taken)) {
        ui.data_mut(|d| d.insert_temp(id, (*other).clone()));
    }
    let taken = button.rect.width();
    button.on_hover_text("Return to the main plan at another leg");
    let text = format!("Return to the main plan at {}", scene.vehicle.name_of(&leg));
    let back = ui.scope(|ui| {
        ui.set_max_width(most - taken);
        ui.add(Button::new(text.as_str()).truncate())
    });
    if field::is_pressed(&back.inner.on_hover_text(text)) {
        queue.consider(Command::ReturnToMain { leg });
    }
}
