//! The flight: what the vehicle does now, every value with its age, and the strip of commands.

use super::{
    Panel, PanelId, Place, Scene, age_as_heard, age_of, alarms, emergency, ended, field, in_force, leading,
    no_start, pfd, profile, reach, value_with_age,
};
use crate::actions::{flight as actions, written};
use crate::command::{Command, Queue};
use crate::state::Vehicle;
use crate::theme;
use crate::units;
use egui::{Button, Color32, ScrollArea, Ui};
use flight_exec::{IterationPlace, Phase};
use flight_plan::{EmergencyPlan, Id};
use std::borrow::Cow;
use usal::contract::GatewayState;

/// Below the primary flight display there is room for alarms and the vital values, points.
const ROOM_BELOW: f32 = 2.0 * 80.0;

/// The panel: the primary flight display, alarms, and every value with its age.
#[derive(Debug)]
pub struct Flight;

impl Panel for Flight {
    fn id(&self) -> PanelId {
        "flight"
    }
    fn name(&self) -> &'static str {
        "Flight"
    }
    fn place(&self) -> Place {
        Place::Right { height: 468.0 }
    }
    /// It gives nothing away: what is not in sight is not known in time.
    fn least_height(&self) -> f32 {
        430.0
    }
    /// Once something was received from a vehicle.
    fn is_relevant(&self, scene: &Scene<'_>) -> bool {
        scene.vehicle.received_s.is_some()
    }
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, _queue: &mut Queue) {
        // where the display takes all the room it comes last: nobody scrolls for what he does not expect
        let is_low = ui.available_height() < pfd::HEIGHT + ROOM_BELOW;
        if !is_low {
            pfd::show(ui, scene, pfd::HEIGHT);
            ui.add_space(4.0);
        }
        // a display that is cut says less than its numbers
        let vital = if is_low { &[&[pfd::numbers as Row], &VITAL[..]].concat() } else { &VITAL[..] };
        raised(ui, scene, vital.len());
        dense(ui);
        vital.iter().for_each(|row| row(ui, scene));
        ui.add_space(4.0);
        let room = ui.available_height();
        ScrollArea::vertical().id_salt("flight values").auto_shrink(false).show(ui, |ui| {
            if is_low && room >= pfd::LEAST_HEIGHT {
                pfd::show(ui, scene, room);
                ui.add_space(4.0);
            }
            values(ui, scene);
        });
    }
}

/// A row of values.
type Row = fn(&mut Ui, &Scene<'_>);
/// What nobody flies without: in sight at every size. That of the link is in the bar.
const VITAL: [Row; 4] = [leg, next, above_ground, battery];

/// The alarms, in all that is left of the panel above what is vital: they say what to do.
fn raised(ui: &mut Ui, scene: &Scene<'_>, vital: usize) {
    // with the gaps around them
    let vital_height = vital as f32 * 18.0 + 8.0;
    let most = (ui.available_height() - vital_height).max(0.0);
    ScrollArea::vertical().id_salt("raised alarms").max_height(most).show(ui, |ui| alarms::show(ui, scene));
    ui.add_space(4.0);
}

/// Nothing there is clicked: rows hardly higher than their text.
fn dense(ui: &mut Ui) {
    ui.spacing_mut().item_spacing.y = 1.0;
    ui.spacing_mut().interact_size.y = 17.0;
}

/// What the vehicle does now, besides what is vital.
fn values(ui: &mut Ui, scene: &Scene<'_>) {
    dense(ui);
    iterations(ui, scene);
    alternate(ui, scene);
    off_track(ui, scene);
    ui.add_space(4.0);
    buffer(ui, scene);
    ui.add_space(4.0);
    above_home(ui, scene);
    over_ground(ui, scene);
    climb(ui, scene);
    engine(ui, scene);
    gps(ui, scene);
}

fn leg(ui: &mut Ui, scene: &Scene<'_>) {
    let status = &scene.vehicle.status;
    let name = |id| scene.vehicle.name_of(id);
    let place = status.as_ref().and_then(|s| s.value.place.as_ref());
    let leg = place.map_or_else(|| "–".to_owned(), |p| format!("{} ▸ {}", name(&p.stage), name(&p.leg)));
    // where the plan would go on is not where it goes
    let leg = if emergency::is_safe_mode(scene) { "none: Safe mode leads".to_owned() } else { leg };
    value_with_age(ui, "Leg", &leg, age_as_heard(status, scene));
}

fn iterations(ui: &mut Ui, scene: &Scene<'_>) {
    let status = &scene.vehicle.status;
    let place = status.as_ref().and_then(|s| s.value.place.as_ref());
    if let Some(place) = place.filter(|p| !p.iterations.is_empty()) {
        let loops: Vec<String> = place.iterations.iter().map(|i| iteration(i, scene.vehicle)).collect();
        value_with_age(ui, "Iteration", &loops.join(" ▸ "), age_as_heard(status, scene));
    }
}

fn alternate(ui: &mut Ui, scene: &Scene<'_>) {
    let status = &scene.vehicle.status;
    if let Some(alternate) = status.as_ref().and_then(|s| s.value.emergency_in_force.as_ref()) {
        value_with_age(ui, "Alternate", &scene.vehicle.name_of(alternate), age_of(status, scene.now_s));
    }
    if let Some(plan) = in_force::of_engine(scene) {
        value_with_age(ui, "If engine", &scene.vehicle.name_of(&plan), age_of(status, scene.now_s));
    }
}

fn next(ui: &mut Ui, scene: &Scene<'_>) {
    let navigation = &scene.vehicle.navigation;
    let next = navigation.as_ref().map(|n| {
        let far = scene.units().distance().show(n.value.distance_m);
        // the turn to the runway is still before it
        match profile::lands_in_s(scene).filter(|_| leading::is_last_landing(scene)) {
            Some(down_s) => format!("{far} · down in {}", units::duration(down_s)),
            None => format!("{far} · {}", units::duration(n.value.eta_s)),
        }
    });
    value_with_age(ui, "Next", &next.unwrap_or_default(), age_as_heard(navigation, scene));
}

fn off_track(ui: &mut Ui, scene: &Scene<'_>) {
    let navigation = &scene.vehicle.navigation;
    let off = navigation.as_ref().map(|n| {
        let side = if n.value.cross_track_m < 0.0 { "left" } else { "right" };
        format!("{} {side}", scene.units().length().show(n.value.cross_track_m.abs()))
    });
    value_with_age(ui, "Off track", &off.unwrap_or_default(), age_as_heard(navigation, scene));
}

/// `patrol 3/20 ↩`: the pass being flown, how many there are, and an arrow when it goes backwards.
pub fn iteration(place: &IterationPlace, vehicle: &Vehicle) -> String {
    let of = place.of.map_or_else(|| "∞".to_owned(), |n| n.to_string());
    let back = if place.reverse { " ◀" } else { "" };
    format!("{} {}/{of}{back}", vehicle.name_of(&place.leg), place.iteration)
}

/// Waypoints and seconds in the gateway's buffer, as a bar that is full at a minute.
fn buffer(ui: &mut Ui, scene: &Scene<'_>) {
    let navigation = &scene.vehicle.navigation;
    let text = navigation.as_ref().map(|n| {
        let end = if n.value.end_of_plan { ", end of plan" } else { "" };
        format!("{} wp · {}{end}", n.value.buffer_waypoints, units::duration(n.value.buffer_s))
    });
    value_with_age(ui, "Buffer", &text.unwrap_or_default(), age_as_heard(navigation, scene));
    if let Some(n) =
        navigation.as_ref().filter(|_| age_as_heard(navigation, scene).is_some_and(|(_, expired)| !expired))
    {
        let p = theme::of(ui);
        let short = n.value.buffer_s < 10.0 && !n.value.end_of_plan && scene.vehicle.is_airborne();
        let colour = if short { p.caution } else { p.accent };
        let share = (n.value.buffer_s / 60.0).clamp(0.0, 1.0) as f32;
        ui.add(egui::ProgressBar::new(share).desired_height(4.0).fill(colour));
    }
}

fn above_home(ui: &mut Ui, scene: &Scene<'_>) {
    let position = &scene.vehicle.position;
    let altitude = scene.units().altitude();
    let home = position.as_ref().map(|v| format!("{} above home", altitude.show(v.value.altitude_home_m)));
    value_with_age(ui, "Height", &home.unwrap_or_default(), age_as_heard(position, scene));
}

fn above_ground(ui: &mut Ui, scene: &Scene<'_>) {
    let watch = &scene.vehicle.watch;
    let height = |m| format!("{} above {}", scene.units().altitude().show(m), watch.below());
    // elevations are off by some: it stands on nothing else
    let agl = if is_on_ground(scene) { Some("on the ground".to_owned()) } else { watch.agl_m.map(height) };
    let age = age_as_heard(&scene.vehicle.position, scene);
    value_with_age(ui, "AGL", agl.as_deref().unwrap_or("ground not known"), age);
}

fn over_ground(ui: &mut Ui, scene: &Scene<'_>) {
    let position = &scene.vehicle.position;
    let ground = position.as_ref().map(|v| {
        let speed = scene.units().speed().show(v.value.ground_speed_mps);
        format!("{speed} · track {}", units::bearing(v.value.track_deg))
    });
    value_with_age(ui, "Ground", &ground.unwrap_or_default(), age_as_heard(position, scene));
}

fn climb(ui: &mut Ui, scene: &Scene<'_>) {
    let position = &scene.vehicle.position;
    let climb = position.as_ref().map(|v| scene.units().climb().show(-v.value.velocity_down_mps));
    value_with_age(ui, "Climb", &climb.unwrap_or_default(), age_as_heard(position, scene));
}

fn battery(ui: &mut Ui, scene: &Scene<'_>) {
    let power = &scene.vehicle.power;
    let text = power.as_ref().map(|p| {
        format!("{:.0} % · {:.1} V · {:.1} A", p.value.battery * 100.0, p.value.voltage_v, p.value.current_a)
    });
    value_with_age(ui, "Battery", &text.unwrap_or_default(), age_as_heard(power, scene));
}

fn engine(ui: &mut Ui, scene: &Scene<'_>) {
    let engine = &scene.vehicle.engine;
    let text = engine.as_ref().map(|e| {
        let (rpm, temperature) = (e.value.rpm, e.value.temperature_c);
        format!("{rpm:.0} rpm · {temperature:.0} °C · {:.0} %", e.value.throttle * 100.0)
    });
    value_with_age(ui, "Engine", &text.unwrap_or_default(), age_as_heard(engine, scene));
}

fn gps(ui: &mut Ui, scene: &Scene<'_>) {
    let gps = &scene.vehicle.gps;
    let text = gps.as_ref().map(|g| {
        let fix = if g.value.fix_3d { "3D fix" } else { "NO FIX" };
        let satellites = g.value.satellites.map_or("?".into(), |count| count.to_string());
        format!("{fix} · {satellites} sats · HDOP {:.1}", g.value.hdop)
    });
    value_with_age(ui, "GPS", &text.unwrap_or_default(), age_as_heard(gps, scene));
}

/// Why no command can be given.
const NOT_CONNECTED: &str = "Not connected: no command reaches the aircraft";

/// Who should obey does not hear.
const NOT_HEARD: &str = "The autopilot is silent: nobody hears a command now";

/// In a narrower bar the commands stand closer: all of them in one row, screen points.
const NARROW: f32 = 1000.0;

/// The strip of commands. Each has its place, whether it can be given now or not, and says why if it can't: nothing moves under the
/// pointer. What there is to say stands behind them (see [`remark`]).
pub fn commands(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let p = theme::of(ui);
    ui.spacing_mut().interact_size.y = field::HOLD_HEIGHT;
    if ui.available_width() < NARROW {
        ui.spacing_mut().item_spacing.x = 4.0;
    }
    choose_emergency(ui, scene, queue);
    let circles = "The aircraft circles where it is now, until it resumes";
    pressed(ui, scene, "hold", (Button::new("⏸ Hold"), circles), queue);
    let resume = "▶ Resume";
    let resume = if can_resume(scene) { super::primary_button(resume, p) } else { Button::new(resume) };
    pressed(ui, scene, "resume", (resume, "The plan leads the aircraft again"), queue);
    pressed(ui, scene, "skip-leg", (Button::new("⏭ Skip leg"), "Shows what would follow, then asks"), queue);
    if stands(scene) {
        let colour = if another_aboard(scene).is_some() { p.caution } else { p.accent };
        held(ui, scene, "start", (&start(scene), colour, HELD), queue);
    }
    if can_rewind(scene) {
        held(ui, scene, "rewind", ("Rewind", p.caution, 0.0), queue);
    }
    let state = scene.vehicle.gateway.as_ref().map(|gateway| gateway.value.state);
    if matches!(state, Some(GatewayState::SafeHold | GatewayState::SafeReturn)) {
        held(ui, scene, "leave-safe", ("Leave Safe mode", p.caution, 0.0), queue);
    }
}

/// One of the actions, by a button; whoever points at it reads this, or why it is not possible.
fn pressed(ui: &mut Ui, scene: &Scene<'_>, id: &str, (button, tip): (Button<'_>, &str), queue: &mut Queue) {
    let Some(action) = written(scene, id) else { return };
    let response = ui.add_enabled(action.command.is_ok(), button);
    match action.command {
        Ok(command) => {
            if field::is_pressed(&response.on_hover_text(tip)) {
                queue.push(command);
            }
        }
        Err(why_not) => drop(response.on_disabled_hover_text(why_not)),
    }
}

/// The same by a button that is held.
fn held(ui: &mut Ui, scene: &Scene<'_>, id: &str, look: (&str, Color32, f32), queue: &mut Queue) {
    let Some(action) = written(scene, id) else { return };
    hold_or_why(ui, look, action.command, queue, field::hold_button);
}

/// Draws a button that is held: its text, colour and least width. True: it was held long enough.
type HoldButton = fn(&mut Ui, &str, Color32, f32) -> bool;

/// Width of the start's button, at least, screen points: no other one moves with its words.
const HELD: f32 = 180.0;

fn hold_or_why(
    ui: &mut Ui,
    (text, colour, width): (&str, Color32, f32),
    command: Result<Command, Cow<'static, str>>,
    queue: &mut Queue,
    button: HoldButton,
) {
    let shown = ui.add_enabled_ui(command.is_ok(), |ui| button(ui, text, colour, width));
    match command {
        Ok(command) if shown.inner => queue.push(command),
        Ok(_) => {}
        Err(why_not) => drop(shown.response.on_hover_text(why_not)),
    }
}

/// Named by what would be flown: that is the plan aboard, whatever is shown.
fn start(scene: &Scene<'_>) -> String {
    let start =
        if scene.vehicle.phase() == Phase::Grounded { "Start the next flight" } else { "Start and take off" };
    match another_aboard(scene) {
        Some(_) => format!("{start} with the plan aboard"),
        None => start.to_owned(),
    }
}

/// It is said on the ground, too: a start would end beside the runway.
const NO_ENGINE: &str = "⚠ Its engine has failed: look at it before a start";

/// What whoever commands should know, what matters most first; and whether it is a caution.
pub fn remark(scene: &Scene<'_>) -> Option<(String, bool)> {
    let heard = if scene.vehicle.open_link().is_none() {
        Some(NOT_CONNECTED.to_owned())
    } else {
        // they may be given all the same: agent and gateway do what was asked for as soon as they can
        scene.vehicle.autopilot_silence_s(scene.now_s).map(|_| format!("⚠ {NOT_HEARD}"))
    };
    let dead = (is_on_ground(scene) && scene.vehicle.is_engine_out()).then(|| NO_ENGINE.to_owned());
    let unfit = scene.vehicle.unfit().filter(|_| is_on_ground(scene));
    let unfit = unfit.map(|why| format!("⚠ Can't be started. {why}"));
    let another = another_aboard(scene).filter(|_| can_launch(scene)).map(str::to_owned);
    let ended = ended::otherwise(scene).map(|how| format!("⚠ {how}"));
    let rest = no_start::nothing_to_do(scene).map(str::to_owned);
    let cautions: Vec<String> = [heard, dead, unfit, another, ended].into_iter().flatten().collect();
    let is_caution = !cautions.is_empty();
    let all: Vec<String> = cautions.into_iter().chain(rest).collect();
    (!all.is_empty()).then(|| (all.join(" · "), is_caution))
}

/// What whoever starts should know first: the plan aboard is another one than what is shown.
pub fn another_aboard(scene: &Scene<'_>) -> Option<&'static str> {
    let shown = scene.analysis.hash_of(scene.document.version())?;
    let is_another = scene.vehicle.active_hash().as_deref() != Some(shown);
    is_another.then_some("⚠ What is shown is not aboard and would not be flown: push it first")
}

/// The plan holds, or is not what leads the aircraft: the gateway holds or follows a direct command, or a pilot flies.
pub fn can_resume(scene: &Scene<'_>) -> bool {
    use GatewayState::{Directed, Hold, Manual};
    let state = scene.vehicle.gateway.as_ref().map(|g| g.value.state);
    match scene.vehicle.phase() {
        Phase::Holding => true,
        Phase::Flying | Phase::AwaitingDecision => matches!(state, Some(Hold | Directed | Manual)),
        _ => false,
    }
}

/// The vehicle stands on the ground, with a plan to be flown.
pub fn can_launch(scene: &Scene<'_>) -> bool {
    no_start::why(scene).is_none()
}

/// On the ground, as far as was ever heard.
pub fn stands(scene: &Scene<'_>) -> bool {
    scene.vehicle.position.as_ref().is_some_and(|position| position.value.on_ground)
}

/// Why no emergency plan can be flown.
pub const ON_GROUND: &str = "The aircraft is on the ground";

/// It is known to be on the ground: no emergency plan can be flown from there.
pub fn is_on_ground(scene: &Scene<'_>) -> bool {
    let position = scene.vehicle.position.as_ref().filter(|position| !position.is_expired(scene.now_s));
    position.is_some_and(|position| position.value.on_ground)
}

/// It stands disarmed with a plan that was flown, or was being flown when the vehicle was switched off.
pub fn can_rewind(scene: &Scene<'_>) -> bool {
    let gateway = scene.vehicle.gateway.as_ref();
    let is_disarmed = gateway.is_some_and(|g| g.value.state == GatewayState::Stop && !g.value.armed);
    stands(scene)
        && is_disarmed
        && scene.vehicle.phase() != Phase::Idle
        && scene.vehicle.active_hash().is_some()
}

/// Least width of the emergency's button, screen points: most names fit, and what is beside it stays in its place.
const EMERGENCY: f32 = 290.0;

/// `Return to R34 · 0.8 km, 120 m to spare at the threshold`.
fn label(scene: &Scene<'_>, plan: &EmergencyPlan) -> String {
    let runway = scene.vehicle.aboard.as_ref().and_then(|aboard| aboard.plan.runway(&plan.runway));
    let reach = runway.and_then(|runway| reach::in_words(scene, runway)).map(|reach| format!(" · {reach}"));
    format!("{}{}", scene.vehicle.name_of(&plan.id), reach.unwrap_or_default())
}

/// Which emergency plan, then hold: named by its effect.
fn choose_emergency(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let p = theme::of(ui);
    let id = ui.make_persistent_id("emergency plan");
    let mut chosen: Option<Id> = ui.data(|d| d.get_temp(id)).unwrap_or_default();
    let in_force = scene.vehicle.status.as_ref().and_then(|s| s.value.emergency_in_force.clone());
    let of_engine = in_force::without_engine(scene);
    let name = chosen
        .as_ref()
        .or(of_engine.as_ref())
        .or(in_force.as_ref())
        .map_or_else(|| "the alternate in force".to_owned(), |id| scene.vehicle.name_of(id));
    let plans = scene.vehicle.aboard.as_ref().map(|a| a.plan.emergency_plans.as_slice()).unwrap_or_default();
    let flown = scene.vehicle.status.as_ref().and_then(|s| s.value.emergency.as_ref());
    let flown = flown.filter(|flown| chosen.as_ref().is_none_or(|chosen| chosen == *flown));
    // what something else leads does not fly it
    let flown = flown.filter(|_| emergency::led_otherwise(scene).is_none());
    let text = match flown {
        Some(flown) => format!("Emergency: flying {}", scene.vehicle.name_of(flown)),
        None => format!("Emergency: fly {name}"),
    };
    let command = actions::emergency(scene, chosen.clone()).map_err(Cow::Borrowed);
    // what is flown already asks for nothing; held, it is given again
    let button: HoldButton = if flown.is_some() { field::held_already } else { field::hold_button };
    hold_or_why(ui, (&text, p.warning, EMERGENCY), command, queue, button);
    if plans.len() > 1 {
        // which one is chosen stands in the button before it
        let ids: Vec<Option<Id>> =
            std::iter::once(None).chain(plans.iter().map(|plan| Some(plan.id.clone()))).collect();
        let labels =
            || std::iter::once("In force here".into()).chain(plans.iter().map(|plan| label(scene, plan)));
        let list =
            field::List { salt: "alternate", name: "Alternate", shown: "", look: |combo| combo.width(0.0) };
        let (taken, _) =
            list.show(ui, ids.iter().position(|id| *id == chosen), || labels().collect::<Vec<String>>());
        if let Some(id) = taken.and_then(|taken| ids.get(taken)) {
            chosen.clone_from(id);
        }
        ui.data_mut(|d| d.insert_temp(id, chosen));
    }
}
