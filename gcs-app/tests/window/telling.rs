//! What the window tells by itself: messages that go again, work that lasts, the story of a demo, and the tour.

use super::filing::{edit, window_on};
use super::flying::flying;
use super::{SQUARE, Window};
use egui::Key;
use egui_kittest::kittest::Queryable;
use gcs_app::app::App;
use gcs_app::story::{End, Story};

fn toasts(app: &App) -> Vec<String> {
    app.toasts().iter().map(|toast| toast.text.clone()).collect()
}

#[test]
fn saving_is_told_goes_by_itself_and_stays_in_the_log() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_on(&folder.path().join("mine.xml"), SQUARE);
    edit(&mut window);
    window.press_ctrl(Key::S);
    let is_told = |app: &App| toasts(app).iter().any(|toast| toast.starts_with("Saved "));
    window.until("the message", is_told);
    assert!(window.shows("mine.xml"));
    window.steps(60 * 7);
    assert!(!is_told(window.app()));
    window.click("Log");
    assert!(window.shows("mine.xml"), "the log has it");
}

#[test]
fn a_message_can_be_put_aside_and_stays_while_it_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window_on(&folder.path().join("mine.xml"), SQUARE);
    edit(&mut window);
    window.press_ctrl(Key::S);
    let saved = |app: &App| toasts(app).into_iter().find(|toast| toast.starts_with("Saved "));
    window.until("the message", |app| saved(app).is_some());
    let text = saved(window.app()).unwrap();
    let close = format!("Put aside: {text}");
    let at = window.centre(&close);
    window.harness.hover_at(at);
    window.steps(60 * 8);
    assert_eq!(toasts(window.app()), [text], "the pointer is on it");
    window.click(&close);
    assert!(toasts(window.app()).is_empty());
}

#[test]
fn a_vehicle_that_falls_silent_is_told_once_and_again_when_it_is_heard() {
    let (mut window, value) = flying();
    window.steps(60 * 5);
    let silent = "uav1: nothing is heard any more. It flies on by its plan";
    assert_eq!(toasts(window.app()), [silent]);
    window.steps(60 * 2);
    window.receive_status(value);
    window.steps(20);
    assert_eq!(toasts(window.app()), ["uav1: is heard again"], "and the other is over");
}

#[test]
fn messages_never_cover_the_commands_of_the_flight() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0)] {
        let (mut window, _) = flying();
        window.harness.set_size(size);
        window.steps(60 * 5);
        let card = window.harness.get_by_label_contains("Put aside: uav1: nothing is heard").rect();
        for command in ["⏸ Hold", "Skip leg", "Emergency: fly"] {
            let button = window.harness.get_all_by_label_contains(command).next().unwrap().rect();
            assert!(!card.intersects(button) && card.bottom() < button.top(), "{command} at {size}");
        }
    }
}

#[test]
fn a_demo_says_what_happens_and_what_comes_next_and_offers_its_report() {
    let mut window = Window::open(SQUARE);
    let story = Story::default();
    window.harness.state_mut().listen_to(story.clone());
    window.steps(2);
    assert!(!window.shows("DEMO"), "it has not begun");
    story.tell("The fire has grown", Some("another round"));
    window.steps(2);
    assert!(window.shows("The fire has grown") && window.shows("Next: another round"));
    assert!(!window.shows("Open report"));
    let report = Some("/no/such/report.html".into());
    story.end("Flown as planned", End { good: true, report });
    window.steps(2);
    assert!(window.shows("Flown as planned") && !window.shows("Next:"));
    window.click("Open report");
    window.until("the reason", |app| app.view().notice.is_some());
    assert!(window.shows("/no/such/report.html"), "where it is, when nothing opens it");
    window.click("Close the demo's strip");
    assert!(!window.shows("DEMO"));
}

/// At the least size, too.
#[test]
fn a_story_that_failed_is_read_whole_and_can_be_tried_again_or_closed() {
    let why =
        "The demo has failed: ".to_owned() + &"the plan was not taken within 15 s, ".repeat(6) + "the end";
    for button in ["Try again", "Close the demo's strip"] {
        let mut window = Window::open_with(SQUARE, egui::vec2(960.0, 600.0), None);
        let story = Story::default();
        window.harness.state_mut().listen_to(story.clone());
        story.end(&why, End { good: false, report: None });
        window.steps(5);
        let text = window.harness.get_by_label_contains("the end").rect();
        assert!(text.height() > 30.0 && text.right() < 960.0, "it is wrapped: {text}");
        window.click(button);
        assert_eq!(
            (story.is_wanted_again(), window.app().is_leaving()),
            (button == "Try again", button == "Try again")
        );
        assert!(button == "Try again" || !window.shows("the end"));
    }
}

#[test]
fn a_demo_that_is_quit_is_not_said_to_fly_on() {
    let (mut window, _) = flying();
    window.harness.state_mut().listen_to(Story::default());
    window.press_ctrl(egui::Key::Q);
    assert!(window.shows("The demo ends with this window") && !window.shows("flies on by its plan"));
}

#[test]
fn the_report_of_a_demo_is_made_in_sight_and_can_be_cancelled() {
    let mut window = Window::open(SQUARE);
    let story = Story::default();
    window.harness.state_mut().listen_to(story.clone());
    let work = story.work("Making the report");
    work.progress().set(2, 6);
    window.steps(30);
    assert!(window.shows("Making the report"));
    window.click("Cancel: Making the report");
    assert!(work.progress().is_cancelled() && !window.shows("Making the report"));
}

#[test]
fn enter_goes_on_in_the_tour() {
    let mut window = Window::open(SQUARE);
    window.harness.state_mut().offer_tour();
    window.steps(3);
    let first = window.app().view().tour;
    assert!(first.is_some());
    window.press(egui::Key::Enter);
    assert_eq!(window.app().view().tour, first.map(|step| step + 1));
    while window.app().view().tour.is_some() {
        window.press(egui::Key::Enter);
    }
}

#[test]
fn the_tour_covers_nothing_of_the_card_for_a_new_mission() {
    for size in [egui::vec2(960.0, 600.0), egui::vec2(1280.0, 800.0), egui::vec2(1920.0, 1080.0)] {
        let mut window = Window::open_with(super::creating::EMPTY, size, None);
        window.harness.state_mut().offer_tour();
        window.steps(4);
        let card = ["Next", "Skip the tour"].map(|label| window.harness.get_by_label(label).rect());
        let tour = (card[0] | card[1]).expand2(egui::vec2(12.0, 90.0));
        for label in ["Create", "Open a plan…", "Where do you fly?"] {
            let at = window.harness.get_by_label(label).rect();
            assert!(!tour.intersects(at), "{size}: {label} at {at}, the tour at {tour}");
        }
        assert!(tour.right() < size.x, "{size}: {tour}");
    }
}

#[test]
fn the_tour_leads_to_what_is_there_and_is_offered_once() {
    let mut window = Window::open(SQUARE);
    window.harness.state_mut().offer_tour();
    window.steps(3);
    let at = window.centre("Next");
    for step in 1..=6 {
        assert!(window.shows(&format!("{step} of 6")), "step {step}");
        let button = window.centre(if step < 6 { "Next" } else { "Done" });
        assert!(button.distance(at) < 6.0, "it stays where it is: step {step}, {button}");
        // beside the buttons, over the map
        window.click_at(at - egui::vec2(0.0, 60.0));
        assert!(window.app().view().selection.is_none(), "step {step}");
        window.click(if step < 6 { "Next" } else { "Done" });
    }
    assert_eq!(window.app().view().tour, None);
    let mut next = super::dock::Memory::of(&mut window).window();
    next.harness.state_mut().offer_tour();
    next.steps(2);
    assert_eq!(next.app().view().tour, None, "never again");
    next.click("Legwork");
    next.click("Tour of the window");
    assert_eq!(next.app().view().tour, Some(0));
    next.click("Next");
    next.click("Back");
    next.press(Key::Escape);
    assert_eq!(next.app().view().tour, None);
}

#[cfg(target_os = "linux")]
#[test]
fn loading_is_shown_while_it_lasts_and_can_be_cancelled() {
    // a pipe that nobody writes to is being read until somebody does
    let folder = tempfile::tempdir().unwrap();
    let hills = folder.path().join("hills");
    std::fs::create_dir(&hills).unwrap();
    let pipe = hills.join("N36W085.hgt");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let mut window = Window::open(SQUARE);
    super::interchange::drop_file(&mut window, &hills);
    window.until("the layer", |app| app.layers().iter().next().is_some());
    window.steps(30);
    assert!(window.shows("Loading hills"));
    window.click("Cancel: Loading hills");
    assert!(window.app().layers().iter().next().is_none() && !window.shows("Loading hills"));
    // its thread ends
    drop(std::fs::OpenOptions::new().write(true).open(&pipe));
}
