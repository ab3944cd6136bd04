//! A window that is open for a long time remembers no more than after a while.

use super::store::plan_event;
use super::vehicle::{position, status};
use super::{SQUARE, Window};
use egui::{Key, vec2};
use flight_exec::Phase;
use gcs_app::link::{LinkEvent, LinkId, LinkMessage, LinkState, Telemetry};
use gcs_app::state::{VehicleName, Vehicles};
use usal::contract::Stamped;

const HOUR_S: u32 = 3600;

/// What a vehicle says within a second: ten positions, its status, and something that happened.
fn said_in(second: u32) -> Vec<Telemetry> {
    let time_s = f64::from(second);
    let place = |tenth: u32| {
        // up and down, so that altitude alarms come and go
        let altitude_m = 500.0 + 80.0 * (time_s / 90.0).sin();
        position(time_s + f64::from(tenth) * 0.1, altitude_m, false)
    };
    let value = flight_exec::Status { revision: u64::from(second / 600), ..status(Phase::Flying) };
    let status = Telemetry::Status(Box::new(Stamped { time_s, validity_s: 2.0, value }));
    (0..10).map(place).chain([status, plan_event(second, time_s)]).collect()
}

fn message(event: LinkEvent) -> LinkMessage {
    LinkMessage { link: LinkId(1), vehicle: "uav1".into(), event }
}

#[test]
fn four_hours_of_telemetry_leave_no_more_than_two() {
    let (mut vehicles, name) = (Vehicles::default(), VehicleName::from("uav1"));
    let ground = gcs_app::assets::demo_terrain();
    vehicles.open(&name, LinkId(1), "tcp/127.0.0.1:7447", 0.0);
    vehicles.receive(message(LinkEvent::Link(LinkState::Connected("tcp/127.0.0.1:7447".into()))), 0.0);
    let mut sizes = Vec::new();
    for second in 1..=4 * HOUR_S {
        let now_s = f64::from(second);
        for telemetry in said_in(second) {
            vehicles.receive(message(LinkEvent::Telemetry(telemetry)), now_s);
        }
        vehicles.look(ground.as_ref(), now_s, 0);
        if let Some(vehicle) = vehicles.get_mut(&name).filter(|_| second % 10 == 0) {
            vehicle.requests.open("Hold", now_s);
        }
        if second % HOUR_S == 0 {
            // everything that is known, to the last field
            sizes.push(format!("{vehicles:?}").len());
        }
    }
    assert!(sizes[3] < sizes[1] + sizes[1] / 4, "bytes after each hour: {sizes:?}");
}

#[test]
fn a_window_that_watches_a_flight_for_four_hours_keeps_no_more_than_after_two() {
    // alone in its process: what else is tested here takes memory, too
    let own = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "lasting::four_hours", "--ignored"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&own.stdout);
    assert!(own.status.success() && said.contains("1 passed"), "{said}");
}

/// Of this process, in pages; nothing where the system doesn't tell.
fn pages() -> u64 {
    let counts = std::fs::read_to_string("/proc/self/statm").unwrap_or_default();
    counts.split_whitespace().nth(1).map_or(0, |resident| resident.parse().unwrap())
}

#[test]
#[ignore = "the test above runs it in a process of its own"]
fn four_hours() {
    const STEP_S: u32 = 20;
    let ground = gcs_app::assets::demo_terrain();
    let mut window = Window::open_stepping(SQUARE, vec2(1280.0, 800.0), None, ground, STEP_S as f32);
    window.until_analysed();
    window.connect();
    let mut kept = Vec::new();
    for second in (1..=4 * HOUR_S).step_by(STEP_S as usize) {
        for telemetry in said_in(second) {
            window.far.messages.try_send(message(LinkEvent::Telemetry(telemetry))).unwrap();
        }
        match second / STEP_S % 60 {
            // what an operator does now and then
            20 => window.harness.key_press(Key::ArrowDown),
            30 => window.harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::K),
            31 => window.harness.key_press(Key::Escape),
            _ => {}
        }
        window.steps(1);
        while window.asked().is_some() {}
        if second % (HOUR_S / 2) < STEP_S {
            let remembered = window.harness.ctx.data(|data| data.len());
            let toasts = window.app().toasts().iter().count();
            kept.push((remembered, toasts, window.app().vehicle().log.len(), pages()));
        }
    }
    let (half, end) = (kept[kept.len() / 2], kept[kept.len() - 1]);
    // of the toolkit's memory a few entries come and go with what is shown
    assert!(end.0 <= half.0 + half.0 / 10 + 20, "{kept:?}");
    assert!(end.1 <= 4 && end.2 <= 2000, "{kept:?}");
    assert!(end.3 <= half.3 + half.3 / 20, "the memory of the process: {kept:?}");
}
