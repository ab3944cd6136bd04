//! Whatever a menu or a button offers is in the palette, too.

use super::flying::{connected, flying, flying_its_plan, report};
use super::vehicle::{decision, status};
use super::{SQUARE, Window, announcing};
use egui::Key;
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::{Command, Phase};
use flight_plan::create::LegChoice;
use flight_plan::template::Template;
use flight_plan::{Cause, Id, LegKind};
use gcs_app::guide::Drawing;
use gcs_app::link::{Call, Order, Reply};
use gcs_app::story::{End, Story};
use usal::contract::GatewayState;

/// Opens the palette, and does the first that these words find: it must be called so.
fn choose(window: &mut Window, name: &str) {
    window.ask_for(name);
    window.click(name);
}

/// The palette has this, and it is possible now.
fn offers(window: &mut Window, name: &str) {
    window.ask_for(name);
    let row = window.harness.query_by_label(name);
    let row = row.unwrap_or_else(|| panic!("the palette has no “{name}”"));
    assert!(!row.accesskit_node().is_disabled(), "{name}");
    window.press(Key::Escape);
}

fn asked_for(window: &mut Window) -> Option<Call> {
    window.asked().map(|(_, call)| call)
}

#[test]
fn what_the_menus_of_the_plan_offer() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    for name in [
        "Edit Copy",
        "Edit Cut",
        "Edit Paste",
        "Edit Put into a loop: side2",
        "Edit Fork before it: side2",
        "Edit Make a procedure of it: side2",
        "Edit Add a stage: Mission stage",
        "Edit Add a variable: Position",
        "Edit Emergency plan that lands on R05",
        "What if The operator calls it off here",
        "Flight Connect as before",
    ] {
        offers(&mut window, name);
    }
    let before = window.plan();
    let kind = |window: &Window| window.plan().leg(&"side2".into()).map(|c| c.leg.kind.clone());
    choose(&mut window, &format!("Edit Change the kind of side2 to {}", LegChoice::Orbit.name()));
    assert!(matches!(kind(&window), Some(LegKind::Orbit { .. })));
    window.click("Undo");
    choose(&mut window, "Edit Put into a loop: side2");
    let made = Id::new(&window.selected());
    assert!(
        matches!(window.plan().leg(&made).unwrap().leg.kind, LegKind::Iterative { .. }),
        "it is selected"
    );
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
    window.click("TF side2");
    choose(&mut window, "Edit Duplicate what is selected");
    assert_eq!(window.selected(), "side5");
    window.click("Undo");
    choose(&mut window, "Edit Add a stage: Mission stage");
    assert!(window.plan().stage(&Id::new(&window.selected())).is_some());
}

#[test]
fn what_the_menu_of_several_legs_offers() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.select_row(("TF side2", 0));
    window.select_row_with(("TF side3", 0), egui::Modifiers::COMMAND);
    window.steps(2);
    for name in ["Edit Put them into a loop: 2 legs", "Edit Make a procedure of them: 2 legs"] {
        offers(&mut window, name);
    }
}

#[test]
fn what_map_and_timeline_offer() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let apart = |window: &Window| window.centre("Fix A").distance(window.centre("Fix B"));
    let before = apart(&window);
    choose(&mut window, "View Zoom the map out");
    window.steps(20);
    assert!((apart(&window) / before - 0.5).abs() < 0.02);
    choose(&mut window, "View Play the preview 50× as fast");
    assert_eq!(window.app().view().speed.0, 50.0);
}

#[test]
fn what_is_copied_from_the_palette_is_what_is_selected() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.click("TF side2");
    window.ask_for("copy");
    window.harness.get_by_label("Edit Copy").click();
    let copied = (0..5).find_map(|_| {
        window.harness.step();
        let commands = &window.harness.output().platform_output.commands;
        commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    });
    assert!(copied.is_some_and(|text| text.contains("side2")));
}

#[test]
fn connecting() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    choose(&mut window, "Flight Connect as before");
    let Ok(Order::Connect { endpoint, .. }) = window.far.orders.try_recv() else {
        panic!("nothing was asked")
    };
    assert_eq!(endpoint, "tcp/127.0.0.1:7447");
}

#[test]
fn another_address_is_typed_into_the_palette() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    choose(&mut window, "Flight Connect to another address…");
    window.harness.get_by_label("Search commands").type_text("10.0.0.2");
    window.steps(3);
    assert!(window.harness.get_by_label("Flight Connect to 10.0.0.2").accesskit_node().is_disabled());
    assert!(window.paints("add :7447"));
    window.harness.get_by_label("Search commands").type_text(":7447 falcon");
    window.steps(3);
    window.click("Flight Connect to tcp/10.0.0.2:7447, vehicle falcon");
    let Ok(Order::Connect { endpoint, vehicle, .. }) = window.far.orders.try_recv() else {
        panic!("nothing was asked")
    };
    assert_eq!((endpoint.as_str(), vehicle.as_str()), ("tcp/10.0.0.2:7447", "falcon"));
}

#[test]
fn the_card_of_a_new_mission() {
    let mut window = Window::open(super::creating::EMPTY);
    window.steps(3);
    window.ask_for("new mission create");
    assert!(window.harness.get_by_label("File New mission: create it").accesskit_node().is_disabled());
    window.press(Key::Escape);
    window.click("Among the example's hills");
    choose(&mut window, "File New mission: Search");
    assert_eq!(window.app().view().guide.template, Template::Search);
    choose(&mut window, "File New mission: draw the circle");
    assert_eq!(window.app().view().guide.drawing, Some(Drawing::Mission));
    choose(&mut window, "File New mission: draw the runway");
    assert_eq!(window.app().view().guide.drawing, Some(Drawing::Runway));
    choose(&mut window, "File New mission: create it");
    assert!(!window.plan().stages.is_empty());
    window.ask_for("new mission");
    assert!(window.harness.query_by_label("File New mission: create it").is_none(), "there is no card");
}

#[test]
fn messages_and_work() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.paste("nowhere at all");
    assert!(window.app().view().notice.is_some());
    choose(&mut window, "View Close the message");
    assert_eq!(window.app().view().notice, None);
    let story = Story::default();
    window.harness.state_mut().listen_to(story.clone());
    let work = story.work("Making the report");
    window.steps(30);
    choose(&mut window, "File Cancel: Making the report");
    assert!(work.progress().is_cancelled());
}

#[test]
fn what_the_vehicle_answered_is_put_aside() {
    let mut window = flying_its_plan();
    choose(&mut window, "Flight Hold now: the aircraft circles where it is");
    let is_hold = |(_, call): &(_, Call)| *call == Call::Plan(Command::Hold);
    let (ticket, _) = std::iter::from_fn(|| window.asked()).find(is_hold).unwrap();
    window.answer(ticket, Err("not now".into()));
    assert!(window.shows("refused, not now"));
    choose(&mut window, "Flight Put the answer of the vehicle aside");
    assert!(!window.shows("refused, not now"));
    window.send(announcing::event(9, announcing::taken("ask", "default")));
    assert!(announcing::is_announced(&window, "Nobody decided"));
    choose(&mut window, "Flight Put aside what uav1 announced");
    assert!(!announcing::is_announced(&window, ""));
    let (mut window, _) = super::considering::considered();
    choose(&mut window, "Flight Give the considered command up");
    assert!(window.app().vehicle().outlook.considered().is_none());
}

#[test]
fn the_end_of_a_demo() {
    let mut window = Window::open(SQUARE);
    let story = Story::default();
    window.harness.state_mut().listen_to(story.clone());
    story.end("It went wrong", End { good: false, report: None });
    window.steps(3);
    offers(&mut window, "Help Fly the demo again");
    choose(&mut window, "Help Close the demo's strip");
    assert!(!window.shows("It went wrong"));
}

#[test]
fn what_was_pushed_is_committed_or_kept_as_a_draft() {
    for name in ["Flight Commit what was pushed", "Flight Keep what was pushed as a draft"] {
        let (mut window, hash) = connected();
        while window.asked().is_some() {}
        window.click("Push");
        let (ticket, _) = window.asked().unwrap();
        window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
        choose(&mut window, name);
        let commits = matches!(asked_for(&mut window), Some(Call::Plan(Command::Commit { .. })));
        assert_eq!(commits, name.contains("Commit"));
        assert!(!window.shows("Push plan"), "it is decided");
    }
}

#[test]
fn decisions_and_other_emergency_plans() {
    let mut window = flying_its_plan();
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.decision = Some(decision(None));
    window.receive_status(value);
    choose(&mut window, "Flight Decide: Close look");
    let decide = Command::Decide { leg: "ask".into(), branch: "close".into() };
    assert_eq!(asked_for(&mut window), Some(Call::Plan(decide)));
    choose(&mut window, "Flight Emergency: fly return");
    assert_eq!(asked_for(&mut window), None, "it has to be held");
    window.hold("Emergency: fly return (hold)", 90);
    let emergency = Command::Emergency { cause: Cause::Operator, plan: Some("return".into()) };
    assert_eq!(asked_for(&mut window), Some(Call::Plan(emergency)));
}

#[test]
fn the_way_back_from_an_emergency() {
    let mut window = flying_its_plan();
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.emergency = Some("return".into());
    window.receive_status(value);
    window.leave_open();
    choose(&mut window, "Flight Return to the main plan…");
    let back = Call::Foresee(Some(Command::ReturnToMain { leg: "side1".into() }));
    assert_eq!(asked_for(&mut window), Some(back));
}

#[test]
fn rewinding_on_the_ground() {
    let (mut window, value) = flying();
    window.receive_position(true);
    window.receive_gateway_state(GatewayState::Stop);
    window.receive_status(value);
    offers(&mut window, "Flight Rewind to the start");
    window.receive_status(status(Phase::Idle));
    window.ask_for("rewind to the start");
    let row = window.harness.get_by_label("Flight Rewind to the start");
    assert!(row.accesskit_node().is_disabled(), "there is nothing to rewind");
}
