//! Where the panels are: the default layout at every size, and what is remembered of it.

use super::alone::Alone;
use super::vehicle::{place, status};
use super::{SQUARE, Window};
use egui::{Pos2, Rect, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use flight_exec::Phase;
use gcs_app::command::Queue;
use gcs_app::panels;
use std::collections::BTreeMap;

const SIZES: [Vec2; 3] = [vec2(960.0, 600.0), vec2(1280.0, 800.0), vec2(1920.0, 1080.0)];

/// What a window leaves behind for the next one.
#[derive(Debug, Default, Clone)]
pub struct Memory(BTreeMap<String, String>);

impl eframe::Storage for Memory {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }
    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.into(), value);
    }
    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }
    fn flush(&mut self) {}
}

impl Memory {
    pub fn of(window: &mut Window) -> Self {
        let mut memory = Self::default();
        eframe::App::save(window.harness.state_mut(), &mut memory);
        memory
    }
    /// A window that remembers this.
    pub fn window(&self) -> Window {
        let storage: &'static Self = Box::leak(Box::new(self.clone()));
        Window::open_with(SQUARE, SIZES[1], Some(storage))
    }
}

fn opened(size: Vec2) -> Window {
    let mut window = Window::open_with(SQUARE, size, None);
    window.steps(3);
    window
}

/// Flying, with an emergency plan in force.
fn fly(window: &mut Window) {
    window.until_analysed();
    window.connect();
    let mut value = status(Phase::Flying);
    value.plan = Some(window.app().analysis().hash.clone().into());
    value.place = Some(place("circuit", "side2"));
    value.emergency_in_force = Some("return".into());
    window.receive_position(false);
    window.receive_status(value);
    window.steps(3);
}

fn rect(window: &Window, label: &str) -> Rect {
    window.harness.get_by_label(label).rect()
}

#[test]
fn the_commands_are_in_view_at_every_size() {
    for size in SIZES {
        let mut window = opened(size);
        fly(&mut window);
        let map = rect(&window, "Map");
        assert!(map.width() >= 300.0 && map.height() >= 200.0, "{size}: the map is {map}");
        for command in ["⏸ Hold", "⏭ Skip leg", "Emergency: fly return (hold)"] {
            let at = rect(&window, command);
            let screen = Rect::from_min_size(Pos2::ZERO, size);
            assert!(screen.contains_rect(at) && !map.intersects(at), "{size}: {command} at {at}, map {map}");
        }
    }
}

#[test]
fn what_stands_beside_the_tabs_is_in_view_at_every_size() {
    for size in SIZES {
        let mut window = opened(size);
        fly(&mut window);
        for tab in ["Profile", "Table"] {
            window.harness.get_all_by_label(tab).next().unwrap().click();
            window.steps(3);
            let (map, preview) = (rect(&window, "Map"), rect(&window, "▶ Preview"));
            assert!(
                preview.left() >= map.left() && preview.right() <= map.right(),
                "{size}: {preview}, {map}"
            );
            let last = rect(&window, "Log");
            assert!(!preview.intersects(last), "{size}: {preview} over {last}");
        }
    }
}

#[test]
fn hidden_tabs_take_no_room_from_the_header() {
    let mut window = opened(SIZES[1]);
    fly(&mut window);
    let before = rect(&window, "▶ Preview").left();
    window.click("Legwork");
    window.click("Panels");
    let log = egui::accesskit::Role::CheckBox;
    window.harness.get_all_by_role_and_label(log, "Log").next().unwrap().click();
    window.steps(3);
    window.harness.key_press(egui::Key::Escape);
    window.steps(3);
    let after = rect(&window, "▶ Preview").left();
    assert!(after < before - 30.0, "{after}, with the tab {before}");
}

#[test]
fn long_text_ends_before_its_age() {
    let text = "0badc0de".repeat(30);
    for width in [260.0, 600.0] {
        let mut harness = Harness::builder().with_size(vec2(width, 60.0)).build_ui(|ui| {
            panels::aged_row(ui, ("hash", 120.0), &text, Some((2.0, false)));
        });
        harness.run_steps(2);
        let (value, age) = (harness.get_by_label(&text).rect(), harness.get_by_label("2.0 s").rect());
        assert!(value.right() <= age.left() && age.right() <= width, "{width}: {value}, {age}");
        assert!(value.width() > 40.0, "{width}: {value}");
    }
}

#[test]
fn the_map_takes_most_of_what_the_window_gains() {
    let side = |window: &Window| rect(window, "Hide Plan").right();
    let maps: Vec<(Rect, f32)> = SIZES
        .map(|size| {
            let window = opened(size);
            (rect(&window, "Map"), side(&window))
        })
        .into();
    let [small, middle, large] = &maps[..] else { panic!() };
    assert!((middle.0.width() - small.0.width() - 320.0).abs() < 1.0, "{maps:?}");
    // a quarter of the sides' 612 goes to them
    assert!((large.0.width() - middle.0.width() - (640.0 - 153.0)).abs() < 2.0, "{maps:?}");
    assert!((large.0.height() - middle.0.height() - 280.0).abs() < 1.0, "{maps:?}");
    assert!((middle.1 - small.1).abs() < 1.0 && (large.1 - middle.1 - 67.0).abs() < 2.0, "{maps:?}");
}

#[test]
fn every_panel_draws_at_every_size_with_and_without_a_vehicle() {
    for is_flying in [false, true] {
        let mut window = opened(SIZES[1]);
        window.until_analysed();
        if is_flying {
            fly(&mut window);
        }
        let app = window.app();
        let alone = Alone::default();
        let scene = alone.scene(app, app.document(), app.analysis());
        for size in [vec2(30.0, 20.0), vec2(320.0, 240.0), vec2(1920.0, 1080.0)] {
            for mut panel in panels::all() {
                let mut queue = Queue::default();
                let mut harness = Harness::builder()
                    .with_size(size)
                    .with_context_setup(gcs_app::theme::install)
                    .build_ui(|ui| {
                        panel.header(ui, &scene, &mut queue);
                        panel.ui(ui, &scene, &mut queue);
                    });
                harness.run_steps(2);
                drop(harness);
                assert!(queue.take().is_empty(), "drawing asks for nothing");
                assert!(!panel.title(&scene).is_empty());
            }
        }
    }
}

#[test]
fn every_panel_of_the_registry_can_be_hidden_and_shown_from_the_menu() {
    let mut window = opened(SIZES[1]);
    fly(&mut window);
    for panel in panels::all() {
        let at_first = window.app().dock().shows(panel.id());
        for shown in [!at_first, at_first] {
            window.click("Legwork");
            window.click("Panels");
            let check_box = window
                .harness
                .get_all_by_role_and_label(egui::accesskit::Role::CheckBox, panel.name())
                .next()
                .unwrap();
            check_box.click();
            window.steps(3);
            window.harness.key_press(egui::Key::Escape);
            window.steps(3);
            assert_eq!(window.app().dock().shows(panel.id()), shown, "{}", panel.name());
        }
    }
}

#[test]
fn a_hidden_panel_gives_its_place_to_its_neighbour_and_the_default_layout_brings_it_back() {
    let mut window = opened(SIZES[1]);
    let before = rect(&window, "Hide Problems").top();
    window.click("Hide Plan");
    assert!(!window.shows("TF side1"));
    assert!(rect(&window, "Hide Problems").top() < before - 300.0);
    window.click("Legwork");
    window.click("Panels");
    window.click("Default layout");
    assert!(window.shows("TF side1"));
    assert!((rect(&window, "Hide Problems").top() - before).abs() < 1.0);
}

/// What is asked there needs the profile's cursor.
#[test]
fn what_if_stands_beside_the_profile_and_says_its_answer_in_full_width() {
    for size in SIZES {
        let mut window = opened(size);
        window.until_analysed();
        let tabs = window.harness.get_all_by_label("Profile").next().unwrap().rect();
        window.click_at(tabs.right_center() - vec2(3.0, 0.0));
        assert!(window.app().dock().shows("profile"), "{size}: a click on its name never closes a tab");
        window.click("What if");
        assert!(window.shows("Vertical profile") && window.app().dock().shows("what-if"), "{size}");
        let profile = window.harness.get_by_label_contains("Vertical profile").rect();
        window.click_at(profile.center());
        window.harness.get_by_label("Engine failure").click_accesskit();
        window.until("the way out", |app| app.analysis().diversion().is_some());
        let answer = window.harness.get_by_label_contains("Engine failure: ").rect();
        let screen = Rect::from_min_size(Pos2::ZERO, size);
        assert!(screen.contains_rect(answer) && answer.width() > 150.0, "{size}: {answer}");
    }
}

#[test]
fn a_middle_click_hides_a_tab() {
    let mut window = opened(SIZES[1]);
    let at = rect(&window, "Table").center();
    window.harness.hover_at(at);
    window.steps(1);
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Middle, egui::Modifiers::NONE);
        window.harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        window.steps(1);
    }
    window.steps(2);
    assert!(!window.app().dock().shows("table"));
}

#[test]
fn the_layout_is_remembered() {
    let mut window = opened(SIZES[1]);
    let wide = rect(&window, "Hide Plan").right();
    // the line between plan and map
    let edge = egui::pos2(rect(&window, "Map").left() - 0.5, 400.0);
    window.drag(edge, vec2(80.0, 0.0));
    assert!((rect(&window, "Hide Plan").right() - wide - 80.0).abs() < 3.0);
    window.click("Hide Inspector");
    window.harness.get_all_by_label("Table").next().unwrap().click();
    window.steps(3);
    assert!(window.shows("Elapsed"));
    let memory = Memory::of(&mut window);
    let mut next = memory.window();
    next.steps(3);
    assert!((rect(&next, "Hide Plan").right() - wide - 80.0).abs() < 3.0);
    assert!(!next.app().dock().shows("inspector") && next.shows("Elapsed"));
}

#[test]
fn the_default_layout_goes_on_growing_with_the_window_from_run_to_run() {
    let side = |window: &Window| rect(window, "Hide Plan").right();
    let (small, mut wide) = (side(&opened(SIZES[1])), opened(vec2(1920.0, 1080.0)));
    assert!(side(&wide) > small + 20.0, "{small}");
    let memory = Memory::of(&mut wide);
    let storage: &'static Memory = Box::leak(Box::new(memory));
    let mut next = Window::open_with(SQUARE, SIZES[1], Some(storage));
    next.steps(3);
    assert!((side(&next) - small).abs() < 3.0, "{} {small}", side(&next));
}

#[test]
fn a_panel_is_dragged_by_its_title() {
    let mut window = opened(SIZES[1]);
    let from = rect(&window, "Hide Problems");
    let to = rect(&window, "Hide Inspector").center() + vec2(-100.0, 300.0);
    window.drag(from.center() - vec2(60.0, 0.0), to - from.center() + vec2(60.0, 0.0));
    let moved = window.harness.query_all_by_label_contains("Problems").next().map(|node| node.rect());
    assert!(moved.is_some_and(|at| at.left() > 800.0), "{moved:?}");
    let mut next = Memory::of(&mut window).window();
    next.steps(3);
    let there = next.harness.query_all_by_label_contains("Problems").next().map(|node| node.rect());
    assert!(there.is_some_and(|at| at.left() > 800.0), "{there:?}");
}

#[test]
fn a_layout_that_makes_no_sense_is_replaced_by_the_default_one() {
    let mut window = opened(SIZES[1]);
    window.click("Hide Inspector");
    let good = Memory::of(&mut window);
    let text = good.0["layout"].clone();
    let deep = format!("{}{}", "(root:Tabs(active:0,children:[".repeat(5000), "])".repeat(5000));
    let broken = [
        String::new(),
        "garbage".into(),
        "\u{0}\u{ffff}".into(),
        text[..text.len() / 2].into(),
        text.replacen("version:1", "version:0", 1),
        text.replace("\"problems\"", "\"plan\""),
        text.replace("\"problems\"", "\"radio\""),
        text.replacen("length:", "length:-", 1),
        deep,
    ];
    for layout in broken {
        assert_ne!(layout, text, "a fault was put in");
        let mut memory = good.clone();
        memory.0.insert("layout".into(), layout.clone());
        let mut next = memory.window();
        next.steps(3);
        let dock = next.app().dock();
        assert!(dock.shows("inspector"), "{:?}", layout.chars().take(60).collect::<String>());
        assert!((rect(&next, "Map").left() - rect(&window, "Map").left()).abs() < 1.0);
    }
    let mut same = good.window();
    same.steps(3);
    assert!(!same.app().dock().shows("inspector"), "the sound one is taken");
}

#[test]
fn the_sides_of_the_default_layout_are_wider_in_a_wide_window_until_somebody_changes_them() {
    let left = |window: &Window| rect(window, "Map").left();
    let (nominal, mut wide) = (left(&opened(SIZES[1])), opened(SIZES[2]));
    assert!((left(&wide) - nominal * 1.25).abs() < 3.0, "{nominal} {}", left(&wide));
    wide.harness.set_size(SIZES[1]);
    wide.steps(3);
    assert!((left(&wide) - nominal).abs() < 3.0);
    let edge = egui::pos2(left(&wide) - 0.5, 400.0);
    wide.drag(edge, vec2(40.0, 0.0));
    wide.harness.set_size(SIZES[2]);
    wide.steps(3);
    assert!((left(&wide) - nominal - 40.0).abs() < 3.0, "{}", left(&wide));
}

/// `--light` was for one start, and all later ones were light.
#[test]
fn a_theme_that_one_start_was_told_is_not_remembered_and_one_that_is_chosen_is() {
    let light = egui::ThemePreference::Light;
    let mut window = opened(SIZES[1]);
    let before = window.app().view().theme;
    assert_ne!(before, light);
    window.harness.state_mut().begin_in(light);
    window.steps(3);
    assert_eq!(window.app().view().theme, light);
    assert_eq!(Memory::of(&mut window).window().app().view().theme, before);
    window.ask_for("light");
    let row = window.harness.query_all_by_label_contains("Light").last().unwrap().rect().center();
    window.click_at(row);
    assert_eq!(Memory::of(&mut window).window().app().view().theme, light, "by hand");
}
