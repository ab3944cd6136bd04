//! The form for a connection: what it refuses, what it remembers, and what is left when a link is closed.

use super::flying::flying;
use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::vec2;
use egui_kittest::kittest::Queryable;
use gcs_app::link::{LinkEvent, LinkState, Order};
use gcs_app::story::Story;
use std::collections::HashMap;
use std::sync::Mutex;

/// Types into a field of the form, the first or the second.
fn type_into(window: &mut Window, field: usize, text: &str) {
    let at = window.harness.get_all_by_role(Role::TextInput).nth(field).unwrap().rect().center();
    window.click_at(at);
    window.harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    window.harness.event(egui::Event::Text(text.into()));
    window.steps(3);
}

#[test]
fn an_address_without_a_port_is_told_at_once() {
    let mut window = Window::open(SQUARE);
    window.click("○ Connect");
    type_into(&mut window, 0, "10.0.0.2");
    assert!(window.shows("add :7447") && !window.is_enabled("Connect"));
    assert!(window.far.orders.try_recv().is_err());
    type_into(&mut window, 0, "10.0.0.2:7447");
    assert!(!window.shows("add :7447"));
    type_into(&mut window, 1, "uav/1");
    assert!(window.shows("The vehicle's name") && !window.is_enabled("Connect"));
    type_into(&mut window, 1, "falcon");
    window.click("Connect");
    let Ok(Order::Connect { endpoint, vehicle, .. }) = window.far.orders.try_recv() else { panic!() };
    assert_eq!((endpoint.as_str(), vehicle.as_str()), ("tcp/10.0.0.2:7447", "falcon"));
}

#[test]
fn form_stays_open_until_the_vehicle_answers() {
    let mut window = Window::open(SQUARE);
    window.click("○ Connect");
    window.click("Connect");
    assert!(window.shows("Looking for the vehicle at tcp/127.0.0.1:7447"));
    window.send(LinkEvent::Link(LinkState::Failed("nobody listens there".into())));
    assert!(window.shows("nobody listens there") && window.shows("Gateway at"));
    window.click("Connect");
    window.send_of("uav1", gcs_app::link::LinkId(2), LinkEvent::Link(LinkState::Connected("there".into())));
    window.steps(3);
    assert!(!window.shows("Gateway at"), "it closes when the vehicle answers");
}

/// What a run leaves for the next.
#[derive(Default)]
struct Store(Mutex<HashMap<String, String>>);

impl eframe::Storage for Store {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.lock().unwrap().get(key).cloned()
    }
    fn set_string(&mut self, key: &str, value: String) {
        self.0.lock().unwrap().insert(key.into(), value);
    }
    fn remove_string(&mut self, key: &str) {
        self.0.lock().unwrap().remove(key);
    }
    fn flush(&mut self) {}
}

#[test]
fn connections_are_remembered_from_run_to_run() {
    let mut store = Box::new(Store::default());
    let mut window = Window::open(SQUARE);
    window.click("○ Connect");
    for (endpoint, vehicle) in [("10.0.0.2:7447", "falcon"), ("10.0.0.3:7447", "heron")] {
        type_into(&mut window, 0, endpoint);
        type_into(&mut window, 1, vehicle);
        window.click("Connect");
    }
    eframe::App::save(window.harness.state_mut(), store.as_mut());
    drop(window);

    let mut window = Window::open_with(SQUARE, vec2(1280.0, 800.0), Some(Box::leak(store)));
    window.click("○ Connect");
    window.click("falcon at tcp/10.0.0.2:7447");
    let Ok(Order::Connect { endpoint, vehicle, .. }) = window.far.orders.try_recv() else { panic!() };
    assert_eq!((endpoint.as_str(), vehicle.as_str()), ("tcp/10.0.0.2:7447", "falcon"));
}

#[test]
fn return_connects_and_a_demos_connection_is_not_offered_again() {
    let mut store = Box::new(Store::default());
    let mut window = Window::open(SQUARE);
    window.harness.state_mut().listen_to(Story::default());
    window.click("○ Connect");
    type_into(&mut window, 0, "127.0.0.1:37973");
    window.press(egui::Key::Enter);
    let Ok(Order::Connect { endpoint, .. }) = window.far.orders.try_recv() else { panic!() };
    assert_eq!(endpoint, "tcp/127.0.0.1:37973");
    eframe::App::save(window.harness.state_mut(), store.as_mut());
    drop(window);

    let mut window = Window::open_with(SQUARE, vec2(1280.0, 800.0), Some(Box::leak(store)));
    window.click("○ Connect");
    assert!(!window.shows("37973"));
    window.click("Connect");
    let Ok(Order::Connect { endpoint, .. }) = window.far.orders.try_recv() else { panic!() };
    assert_eq!(endpoint, "tcp/127.0.0.1:7447");
}

#[test]
fn nothing_looks_live_after_the_link_was_closed() {
    let (mut window, _) = flying();
    assert!(window.shows("active") && window.is_enabled("⏸ Hold"));
    window.send(LinkEvent::Link(LinkState::Off));
    assert!(!window.shows("◆ active") && window.shows("was aboard"));
    assert!(window.shows("no command reaches the aircraft"));
    assert!(!window.is_enabled("⏸ Hold"));
    assert!(!window.is_enabled("Emergency: fly the alternate in force (hold)"));
    window.hold("Emergency: fly the alternate in force (hold)", 90);
    assert!(window.far.orders.try_recv().is_err());
}
