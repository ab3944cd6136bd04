//! What stands in the panel of a proposal, and where the button is.

use super::flying::{connected, flying, flying_its_plan, report};
use super::vehicle::status;
use super::{SQUARE, Window};
use egui::Key;
use egui_kittest::kittest::Queryable;
use flight_exec::{Phase, ProposalReport};
use gcs_app::link::{Call, Reply, Telemetry};
use usal::contract::{Air, Stamped};

#[test]
fn many_legs_are_told_by_the_first_and_the_last_until_all_are_asked_for() {
    let (mut window, hash) = connected();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let added = ["side1", "side2", "side3", "side4"].map(Into::into).to_vec();
    let changed = vec!["side2".into(), "circuit".into()];
    let (differs_in_m, differs_in_s) = (Some(0.0), Some(0.0));
    let report = ProposalReport { added, changed, differs_in_m, differs_in_s, ..report(&hash, true) };
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report))));
    assert!(window.shows("side1 … side4") && window.shows("1 stage and 1 leg changed"));
    let at_once = "It leaves the path that is flown now at once";
    assert!(!window.shows(at_once), "it stands");
    window.receive_position(false);
    assert!(window.shows(at_once));
    let names = |window: &Window| window.harness.query_all_by_label("side3").count();
    let before = names(&window);
    let at = window.harness.get_by_label_contains("4 legs added").rect().center();
    window.click_at(at);
    window.steps(30);
    assert_eq!(names(&window), before + 1);
}

/// At 4 times the speed the card was of a place two tracks behind after half a minute.
#[test]
fn a_proposal_says_how_old_it_is_and_whose_path_is_on_the_map() {
    let mut window = flying_its_plan();
    window.click("TF side4");
    window.press(Key::Delete);
    window.until_analysed();
    let hash = window.app().analysis().hash.clone();
    window.click("Push");
    while let Some((ticket, call)) = window.asked() {
        if matches!(call, Call::Propose(_)) {
            window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
        }
    }
    assert!(window.shows("The aircraft would fly next:") && !window.shows("push again"));
    assert!(window.shows("on the map: this plan"));
    let places = |window: &Window| {
        ["Commit", "Keep as draft"].map(|name| window.harness.get_by_label(name).rect().left_top().x)
    };
    let before = places(&window);
    window.steps(60 * 11);
    assert!(window.shows("ago, looking again") && window.shows("Push again"));
    assert_eq!(places(&window), before, "who is on the way to one of them presses no other");
    let rect = |name: &str| window.harness.get_by_label(name).rect();
    assert!(rect("Push again").top() > rect("Commit").bottom(), "three have no room side by side");
    let accent = gcs_app::theme::palette(true).accent;
    let fill = |window: &Window, button| window.fill_around(window.harness.get_by_label(button).rect());
    assert_eq!(
        [fill(&window, "Push again"), fill(&window, "Commit")].map(|fill| fill == Some(accent)),
        [false, true],
        "it is looked at again by itself: what is left to do is to commit it"
    );
    let again = |(_, call): &(_, Call)| matches!(call, Call::Propose(_));
    let (ticket, _) = std::iter::from_fn(|| window.asked()).find(again).unwrap();
    assert!(window.shows("It would have flown next:") && !window.shows("The aircraft would fly next:"));
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
    assert!(window.shows("The aircraft would fly next:") && !window.shows("Push again"));
    assert!(!window.shows("Propose plan: pending"), "the window did it for itself");
    window.steps(60 * 11);
    let (ticket, _) = std::iter::from_fn(|| window.asked()).find(again).unwrap();
    window.click("Undo");
    window.until_analysed();
    assert!(window.shows("on the map: the edited draft") && !window.shows("on the map: this plan"));
    assert!(window.shows("ago, and the aircraft flew on: push again"), "what is shown is another plan");
    window.click("Keep as draft");
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
    assert!(!window.shows("Push plan"), "it was dropped before the answer came");
}

/// What is for programs is for who points at it.
#[test]
fn what_the_vehicle_finds_is_told_in_words_and_names() {
    let named =
        SQUARE.replacen(r#"<TF id="side2" fix="B"/>"#, r#"<TF id="side2" name="To the quarry" fix="B"/>"#, 1);
    let mut window = Window::open(&named);
    window.until_analysed();
    window.connect();
    let hash = window.app().analysis().hash.clone();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let said = "17:7: warning [low-clearance] side2: fly higher on `side2`";
    let problems = vec![said.to_owned(), "warning [no-landing] land it".to_owned()];
    let report = ProposalReport { problems, ..report(&hash, true) };
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report))));
    assert!(window.shows("⚠ “To the quarry”: fly higher on “To the quarry”") && window.shows("⚠ land it"));
    assert!(!window.shows("low-clearance"));
    let at = window.harness.get_by_label_contains("fly higher on").rect().center();
    window.harness.hover_at(at);
    window.steps(60);
    assert!(window.shows(said), "the code and the place in the document are in the tooltip");
    // refused outright: so in the log
    window.click("Keep as draft");
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Err("35:7: error [too-steep] side2: climb earlier; and 3 more".into()));
    super::fleet::tab(&mut window, "Log");
    window.steps(3);
    assert!(window.shows("Propose plan: refused, “To the quarry”: climb earlier; and 3 more"));
    assert!(!window.shows("too-steep"));
}

/// As many sentences from aboard as here, but one here is an error: whoever commits is told.
#[test]
fn an_error_that_is_found_here_is_said_beside_as_many_warnings_from_aboard() {
    let mut window = Window::open(&SQUARE.replacen("<mainPlan", super::problems::ZONE, 1));
    window.until_analysed();
    assert!(!window.errors().is_empty());
    window.connect();
    let (hash, found) = (window.app().analysis().hash.clone(), window.app().analysis().problems.len());
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let problems = vec!["warning [low-clearance] side2: fly higher".to_owned(); found];
    let report = ProposalReport { problems, ..report(&hash, true) };
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report))));
    assert!(window.shows("⚠ Checked here: it can't be flown, "));
}

/// The button stays under the pointer whatever is said beside it.
#[test]
fn the_push_button_has_one_place() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0)] {
        let (mut window, mut value) = flying();
        window.harness.set_size(size);
        window.steps(3);
        let before = window.harness.get_by_label("Push").rect();
        assert!(before.right() <= size.x && before.right() > size.x - 20.0, "{size}: {before}");
        for plan in [None, Some("another")] {
            value.plan = plan.map(Into::into);
            window.receive_status(value.clone());
            window.steps(3);
            assert_eq!(window.harness.get_by_label("Push").rect(), before, "{size}: {plan:?}");
        }
        window.click("TF side2");
        window.press(Key::Delete);
        assert_eq!(window.harness.get_by_label("Push").rect(), before, "{size}: edited");
    }
}

/// The least window, with a proposal beside the map: there is room for nothing more.
#[test]
fn scale_and_sources_wind_and_heading_are_apart_in_the_least_window() {
    let (mut window, mut value) = flying();
    value.plan = Some("another".into());
    window.receive_status(value);
    while window.asked().is_some() {}
    window.harness.set_size(egui::vec2(960.0, 600.0));
    window.receive_attitude();
    let air = Air {
        airspeed_mps: 24.0,
        wind_east_mps: 5.0,
        wind_north_mps: 0.0,
        pressure_hpa: 980.0,
        temperature_c: 15.0,
    };
    window.receive(Telemetry::Air(Stamped { time_s: 1.0, validity_s: 2.0, value: air }));
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let hash = window.app().analysis().hash.clone();
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
    window.steps(3);
    let only = |what: &str, found: Vec<egui::Rect>| {
        assert_eq!(found.len(), 1, "{what}: {found:?}");
        found[0]
    };
    let is_scale = |text: &str| {
        let number = text.strip_suffix(" km").or(text.strip_suffix(" m"));
        number.is_some_and(|number| number.parse::<u32>().is_ok())
    };
    let map = window.harness.get_by_label("Map").rect();
    let on_map = |found: Vec<egui::Rect>| found.into_iter().filter(|rect| map.contains_rect(*rect)).collect();
    let scale = only("scale", on_map(window.places_of(is_scale)));
    let sources = only("sources", on_map(window.places_of(|text| text.contains("OurAirports"))));
    assert!(!scale.intersects(sources), "{scale} {sources}");
    let heading = only("heading", window.places_of(|text| text.starts_with("HDG ")));
    let wind = window.places_of(|text| text == "5.0");
    assert!(!wind.is_empty() && wind.iter().all(|wind| !wind.intersects(heading)), "{wind:?} {heading}");
}

/// A refusal that is a paragraph moved the commands of the flight, for minutes, and nothing ended it.
#[test]
fn a_refused_push_is_one_line_that_moves_nothing_and_goes_with_an_edit_or_when_it_is_put_aside() {
    let (mut window, mut value) = flying();
    value.plan = Some("another".into());
    window.receive_status(value);
    window.harness.set_size(egui::vec2(960.0, 600.0));
    window.steps(3);
    let why = "12:7: error [too-steep] side2: climb earlier; ".repeat(20) + "and 3 more";
    let hold = window.harness.get_by_label("⏸ Hold").rect();
    let refuse = |window: &mut Window| {
        while window.asked().is_some() {}
        window.click("Push");
        let (ticket, _) = window.asked().unwrap();
        window.answer(ticket, Err(why.clone()));
    };
    refuse(&mut window);
    let told = window.harness.get_by_label_contains("refused, “side2”: climb earlier; “side2”").rect();
    assert!(told.height() < 30.0 && told.right() <= 960.0, "{told}");
    assert_eq!(window.harness.get_by_label("⏸ Hold").rect(), hold);
    window.click("Put this answer aside");
    assert!(!window.shows("refused"));
    refuse(&mut window);
    assert!(window.shows("refused, “side2”"));
    window.click("TF side2");
    window.press(Key::Delete);
    assert!(!window.shows("refused"), "it was said of another plan");
}

#[test]
fn push_is_not_the_thing_to_do_with_a_plan_that_cannot_be_flown() {
    let colour = |plan: &str| {
        let mut window = Window::open(plan);
        window.until_analysed();
        window.connect();
        assert!(window.is_enabled("Push"), "the vehicle decides");
        window.colour_of("⬆ Push").unwrap()
    };
    assert_ne!(colour(SQUARE), colour(&SQUARE.replace(r#"fix="B""#, r#"fix="BB""#)));
}

/// It was put aside, and the bar went on calling it proposed.
#[test]
fn what_is_kept_as_a_draft_is_not_called_proposed() {
    let (mut window, hash) = connected();
    window.leave_open();
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    window.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
    let (plan, proposed) = (Some("another".into()), Some(hash.into()));
    window.receive_status(flight_exec::Status { plan, proposed, ..status(Phase::Flying) });
    assert!(window.shows("◈ proposed"));
    window.click("Keep as draft");
    assert!(!window.shows("◈ proposed") && window.shows(", edited "));
}

/// The panel takes the map's right part, and with it half of what is to be decided about.
#[test]
fn what_is_proposed_is_seen_while_one_decides() {
    let (mut window, hash) = connected();
    while window.asked().is_some() {}
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    window.harness.set_size(egui::vec2(960.0, 600.0));
    for _ in 0..3 {
        window.click("Zoom in");
    }
    let changed = vec!["side1".into(), "side3".into()];
    window.answer(ticket, Ok(Reply::Proposal(Box::new(ProposalReport { changed, ..report(&hash, true) }))));
    window.steps(3);
    let map = window.harness.get_by_label("Map").rect();
    for fix in ["Fix A", "Fix C"] {
        let at = window.centre(fix);
        assert!(map.contains(at), "{fix} at {at}, the map is {map}");
    }
}
