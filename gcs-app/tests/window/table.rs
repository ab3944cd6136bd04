//! The table of the legs, and that neither it nor the tree lays out more than is to be seen.

use super::alone::Alone;
use super::{SQUARE, Window};
use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{By, NodeT, Queryable};
use flight_plan::{AltitudeReference, FlightPlan, Leg, Value};
use gcs_app::command::Queue;
use gcs_app::document::Document;
use gcs_app::forecast::{Analysis, Forecast, Passage, Point};
use gcs_app::panels::{self, Panel};
use std::cell::Cell;
use std::sync::Arc;
use terrain::Terrain;

/// The window with the table in front, all of it to be seen.
fn opened(text: &str) -> Window {
    opened_in(text, vec2(1600.0, 1000.0))
}

fn opened_in(text: &str, size: Vec2) -> Window {
    let mut window = Window::open_with(text, size, None);
    window.until_analysed();
    window.harness.get_all_by_label("Table").next().unwrap().click();
    window.steps(3);
    window
}

impl Window {
    fn cell(&self, name: &str) -> Pos2 {
        self.harness.get_by_role_and_label(Role::Button, name).rect().center()
    }

    /// Double-clicks a cell of the leg that a row of the tree selects, types over what is in it, and presses Enter.
    fn type_into(&mut self, row: &str, cell: &str, text: &str) {
        self.click(row);
        // or the next click would be the second of a double click
        self.steps(30);
        let at = self.cell(cell);
        self.click_at(at);
        self.click_at(at);
        self.write(text);
        self.press(Key::Enter);
    }

    /// Clicks a place with the Shift key held down.
    fn with_shift(&mut self, at: Pos2) {
        self.harness.event(egui::Event::ModifiersChanged(Modifiers::SHIFT));
        self.click_at(at);
        self.harness.event(egui::Event::ModifiersChanged(Modifiers::NONE));
        self.steps(3);
    }

    fn write(&mut self, text: &str) {
        self.harness.event(egui::Event::Text(text.into()));
        self.steps(2);
    }

    fn altitude(&self, leg: &str) -> Option<(f64, AltitudeReference)> {
        let altitude = self.plan().leg(&leg.into()).unwrap().leg.altitude.clone()?;
        let Value::Constant(metres) = altitude.metres else { panic!() };
        Some((metres, altitude.reference))
    }
}

#[test]
fn altitudes_say_what_they_are_above_and_where_they_come_from() {
    let mut window = opened(&SQUARE.replace("id=\"circuit\"", "id=\"circuit\" name=\"Once around\""));
    assert!(window.shows("100 m above home, own"));
    window.click("TF side2");
    assert!(window.shows("150 m above home, Once around"), "it is brought into view");
    window.click("T/O take-off");
    for stage in ["Stage take-off", "Stage Once around"] {
        assert!(window.shows(stage), "{stage}");
    }
}

/// What stands below the head of a column in the row of a leg.
fn figure(window: &mut Window, leg: &str, head: &str) -> String {
    window.click(&format!("TF {leg}"));
    window.steps(30);
    let row = window.cell(&format!("Altitude of {leg}")).y;
    let [heads] = window.places_of(|text| text == "Energy left")[..] else { panic!("which head?") };
    let heads = window.places_of(|text| text == head).into_iter().find(|at| at.top() == heads.top());
    let left = heads.unwrap_or_else(|| panic!("no column {head}")).left();
    let shapes = window.harness.output().shapes.iter();
    let mut texts = shapes.flat_map(|clipped| super::painted::texts(&clipped.shape)).filter(|text| {
        let at = text.galley.rect.translate(text.pos.to_vec2());
        (at.center().y - row).abs() < 6.0 && (at.left() - left).abs() < 4.0
    });
    texts.next().unwrap_or_else(|| panic!("{leg}: nothing below {head}")).galley.text().to_owned()
}

/// A number, or minutes and seconds.
fn number(text: &str) -> f64 {
    let parts =
        text.trim_end_matches([' ', '%', '°', 's']).split(':').map(|part| part.parse::<f64>().unwrap());
    parts.fold(0.0, |sum, part| sum * 60.0 + part)
}

/// Against what follows from the fixes, the ground and the aircraft, not from the forecast that they are taken from.
#[test]
fn the_figures_of_a_leg_are_those_of_its_flight() {
    let mut window = opened_in(SQUARE, vec2(2600.0, 1000.0));
    let plan = window.plan();
    let [a, b, c, d] = ["A", "B", "C", "D"].map(|fix| plan.fix(&fix.into()).unwrap().position);
    let cruise_mps = aircraft::Profile::by_name(&plan.aircraft).unwrap().cruise_airspeed_mps;
    let figures = |window: &mut Window, leg: &str| {
        let heads = ["Track", "Distance, km", "Total, km", "ETE", "Elapsed", "Speed, m/s", "Energy left"];
        heads.map(|head| number(&figure(window, leg, head)))
    };
    let [_, _, mut total_km, _, mut elapsed_s, _, mut energy] = figures(&mut window, "side1");
    for (leg, from, to) in [("side2", a, b), ("side3", b, c), ("side4", c, d)] {
        let [track, km, total, ete_s, elapsed, mps, left] = figures(&mut window, leg);
        let (course, way_m) = (from.bearing_deg(to), from.distance_m(to));
        // from where the turn into it began to where the turn into the next one does
        assert!((track - course.rem_euclid(360.0)).abs() < 12.0, "{leg}: {track}° for {course}°");
        assert!((km * 1000.0 - way_m).abs() < 150.0, "{leg}: {km} km for {way_m} m");
        assert!((total - total_km - km).abs() < 0.16, "{leg}: {total_km} + {km} = {total} km");
        assert!((elapsed - elapsed_s - ete_s).abs() < 1.6, "{leg}: {elapsed_s} + {ete_s} = {elapsed} s");
        assert!(
            (mps - cruise_mps).abs() < 2.5 && (mps * ete_s - km * 1000.0).abs() < 80.0,
            "{leg}: {mps} m/s"
        );
        assert!(left < 100.0 && left <= energy, "{leg}: {energy} % and then {left} %");
        (total_km, elapsed_s, energy) = (total, elapsed, left);
    }
    let amsl_m = number(&figure(&mut window, "side3", "Altitude AMSL, m"));
    assert!((amsl_m - 349.0 - 150.0).abs() < 2.0, "{amsl_m}");
    let ground = gcs_app::assets::demo_terrain();
    let forecast = &window.app().analysis().forecast;
    let points = forecast.passages_of(&"side3".into()).next().unwrap().to_vec();
    let above = points.iter().map(|q| q.altitude_amsl_m - ground.elevation_m(q.position).unwrap());
    let least_m = above.fold(f64::INFINITY, f64::min);
    let shown_m = number(&figure(&mut window, "side3", "Above ground, m"));
    assert!((shown_m - least_m).abs() < 2.0, "{shown_m} {least_m}");
    assert_eq!(figure(&mut window, "side3", "Type"), "TF");
}

#[test]
fn names_altitudes_and_speeds_are_typed_into_the_table() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    window.type_into("TF side2", "Altitude of side2", "120 AGL");
    assert_eq!(window.altitude("side2"), Some((120.0, AltitudeReference::Agl)));
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
    window.until_analysed();
    window.type_into("TF side3", "Name of side3", "Far side");
    assert_eq!(window.plan().leg(&"side3".into()).unwrap().leg.name, "Far side");
    window.until_analysed();
    window.type_into("TF Far side", "Airspeed of side3", "22");
    let speed = window.plan().leg(&"side3".into()).unwrap().leg.speed_mps.clone();
    assert_eq!(speed, Some(Value::Constant(22.0)));
    window.until_analysed();
    window.type_into("TF side1", "Altitude of side1", "high");
    assert!(window.shows("is no number in m"), "it says so, and stays open");
    window.press(Key::Escape);
    assert_eq!(window.altitude("side1"), Some((100.0, AltitudeReference::Home)));
    assert!(!window.app().document().can_redo());
}

#[test]
fn a_right_click_on_a_row_offers_what_one_in_the_tree_does() {
    let mut window = opened(SQUARE);
    // which brings its row into view
    window.click("TF side2");
    window.steps(30);
    for (role, at, entry) in
        [(Role::Button, "Altitude of side2", "Put into a loop"), (Role::Label, "Stage circuit", "Rename")]
    {
        let at = window.harness.get_by_role_and_label(role, at).rect().center();
        window.right_click_at(at);
        assert!(window.shows(entry) && window.shows("Move up"), "{entry}");
        window.press(Key::Escape);
    }
    let time = window.harness.get_by_role_and_label(Role::Label, "ETE").rect().center().x;
    window.right_click_at(Pos2::new(time, window.cell("Airspeed of side2").y));
    window.click_beginning("Duplicate");
    window.steps(3);
    assert_eq!(window.plan().stage(&"circuit".into()).unwrap().legs.len(), 5, "where nothing is typed too");
    window.click("Undo");
    assert!(!window.is_enabled("Undo"), "one step");
}

#[test]
fn legs_that_are_selected_are_changed_together_by_keyboard() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    window.click("TF side3");
    let at = window.cell("Altitude of side3");
    window.click_at(at);
    for _ in 0..2 {
        window.harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowUp);
        window.steps(3);
    }
    assert!(window.shows("3 legs"));
    window.press(Key::F2);
    window.write("90");
    window.press(Key::Enter);
    for leg in ["side1", "side2", "side3"] {
        assert_eq!(window.altitude(leg), Some((90.0, AltitudeReference::Home)), "{leg}");
    }
    assert_eq!(window.altitude("side4"), Some((110.0, AltitudeReference::Home)));
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
}

#[test]
fn legs_that_are_selected_are_changed_together_by_a_double_click() {
    let mut window = opened(SQUARE);
    let before = window.plan();
    window.click("TF side3");
    // or the next click would be the second of a double click
    window.steps(30);
    let at = window.cell("Altitude of side2");
    window.with_shift(at);
    assert!(window.shows("2 legs"));
    window.steps(30);
    window.click_at(at);
    assert!(!window.shows("2 legs"), "a click chooses one of them");
    window.click_at(at);
    assert!(window.shows("2 legs"), "a double click is for both");
    window.write("90 AGL");
    window.press(Key::Enter);
    for leg in ["side2", "side3"] {
        assert_eq!(window.altitude(leg), Some((90.0, AltitudeReference::Agl)), "{leg}");
    }
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
    // one that is not among them is changed alone
    window.until_analysed();
    window.type_into("TF side4", "Altitude of side3", "70");
    assert_eq!(window.altitude("side3"), Some((70.0, AltitudeReference::Home)));
    assert_eq!(window.altitude("side4"), Some((110.0, AltitudeReference::Home)));
}

const MANY: usize = 100_000;

/// A stage of very many legs.
fn huge() -> FlightPlan {
    let mut plan = flight_plan::read(SQUARE.as_bytes()).plan;
    let leg = plan.stages[1].legs[1].as_ref().clone();
    let numbered = |n: usize| Arc::new(Leg { id: format!("leg{n}").as_str().into(), ..leg.clone() });
    plan.stages[1].legs = (0..MANY).map(numbered).collect();
    plan
}

/// Draws a panel with the huge plan a few times, and looks at what there is then.
fn drawn(mut panel: Box<dyn Panel>, scrolled: f32, look: impl Fn(&Harness<'_>)) {
    let window = Window::open(SQUARE);
    let app = window.app();
    let document = Document::new(huge(), None, Vec::new());
    let point = |n: usize| Point {
        time_s: n as f64,
        distance_m: n as f64 * 25.0,
        position: geometry::LatLon::new(46.0, 8.0),
        altitude_amsl_m: 500.0,
        ground_amsl_m: None,
        passage: n,
    };
    let passage = |n: usize| Passage {
        leg: format!("leg{n}").as_str().into(),
        stage: "circuit".into(),
        passes: Vec::new(),
        reverse: false,
        first: n,
        end: n + 1,
        energy_left: 1.0,
        clearance_m: None,
    };
    let forecast = Forecast {
        points: (0..MANY).map(point).collect(),
        passages: (0..MANY).map(passage).collect(),
        ..Forecast::default()
    };
    let analysis = Analysis { forecast: Arc::new(forecast), forecast_version: 1, ..Analysis::default() };
    let alone = Alone::default();
    let scene = alone.scene(app, &document, &analysis);
    let mut queue = Queue::default();
    let builder =
        Harness::builder().with_size(vec2(900.0, 600.0)).with_context_setup(gcs_app::theme::install);
    let is_busy = Cell::new(true);
    let mut harness = builder.build_ui(|ui| {
        panel.ui(ui, &scene, &mut queue);
        is_busy.set(panel.is_busy());
    });
    while is_busy.get() {
        std::thread::yield_now();
        harness.step();
    }
    harness.run_steps(2);
    harness.hover_at(Pos2::new(300.0, 300.0));
    let (unit, phase) = (egui::MouseWheelUnit::Point, egui::TouchPhase::Move);
    let source = egui::MouseWheelSource::Wheel;
    let (delta, modifiers) = (vec2(0.0, -scrolled), Modifiers::NONE);
    harness.event(egui::Event::MouseWheel { unit, delta, phase, source, modifiers });
    harness.run_steps(30);
    look(&harness);
}

/// So many rows are seen at most in 600 points.
const IN_VIEW: usize = 32;

#[test]
fn of_a_hundred_thousand_legs_the_tree_lays_out_what_is_seen() {
    drawn(Box::new(panels::tree::Tree::default()), 50_000.0, |harness| {
        let rows = harness.query_all_by_role(Role::TreeItem).count();
        assert!((10..=IN_VIEW).contains(&rows), "{rows} rows");
        assert!(harness.query_by_label("Main plan").is_none(), "it is scrolled");
    });
}

#[test]
fn of_a_hundred_thousand_passages_the_table_lays_out_what_is_seen() {
    drawn(Box::new(panels::table::Table::default()), 50_000.0, |harness| {
        let rows = harness.query_all(By::new().role(Role::Button).label_contains("Altitude of leg")).count();
        assert!((10..=IN_VIEW).contains(&rows), "{rows} rows");
        assert!(harness.query_by_label("Altitude of leg0").is_none(), "it is scrolled");
    });
}

/// Nobody knows how high the ground is.
#[derive(Debug)]
pub struct Unknown;

impl Terrain for Unknown {
    fn elevation_m(&self, _: geometry::LatLon) -> Option<f64> {
        None
    }
}

#[test]
fn a_leg_that_would_be_left_out_stays_in_the_table_and_on_the_map() {
    let agl = r#"<TF id="side2" fix="B" altitude="120" altitudeReference="agl"/>"#;
    let text = SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, agl);
    let mut window = Window::open_over(&text, vec2(1600.0, 1000.0), None, Arc::new(Unknown));
    window.until_analysed();
    super::fleet::tab(&mut window, "Table");
    window.steps(3);
    let top = |name: &str| window.centre(&format!("Name of {name}")).y;
    assert!(top("side1") < top("side2") && top("side2") < top("side3"), "it stands where it would be flown");
    assert!(window.shows("⚠ Left out: "), "with the reason");
    assert!(window.paints("left out: side2"), "and as a broken line on the map");
    // which brings its row into view
    window.click("TF side2");
    let at = window.centre("Name of side2");
    window.press(Key::Escape);
    window.click_at(at);
    assert_eq!(window.selected(), "side2");
    window.fill_in(Role::SpinButton, "Altitude", "130");
    window.choose_option("Above", "home");
    window.until_analysed();
    assert!(!window.shows("⚠ Left out: ") && !window.paints("left out: side2"));
}

#[test]
fn of_a_plan_with_an_error_the_table_shows_what_is_not_flown_and_changes_it() {
    let text = SQUARE.replace(r#"<TF id="side1" fix=""#, r#"<TF id="side1" fix="NO"#);
    assert_ne!(text, SQUARE);
    let mut window = opened(&text);
    assert!(!window.errors().is_empty());
    for side in 1..=3 {
        assert!(window.harness.query_by_label(&format!("Name of side{side}")).is_some(), "{side}");
    }
    let not_flown = window.harness.query_all_by_label_contains("Not flown yet").count();
    assert!(not_flown > 2, "{not_flown}");
    window.type_into("TF side3", "Altitude of side3", "120 AGL");
    let said = &window.app().view().notice;
    assert_eq!(window.altitude("side3"), Some((120.0, AltitudeReference::Agl)), "{said:?}");
}

/// Its row comes with the next forecast, or stands behind an error.
#[test]
fn what_is_selected_elsewhere_comes_into_view_as_soon_as_it_has_a_row() {
    let side = r#"<TF id="side2" fix="B"/>"#;
    let more: String =
        (0..12).map(|i| format!(r#"<TF id="x{i}" fix="{}"/>"#, if i % 2 == 0 { "A" } else { "B" })).collect();
    let long = SQUARE.replacen(side, &format!("{side}{more}"), 1);
    for text in [long.clone(), long.replace(r#"<TF id="side1" fix=""#, r#"<TF id="side1" fix="NO"#)] {
        let mut window = Window::open(&text);
        window.until_analysed();
        super::fleet::tab(&mut window, "Table");
        window.click("T/O take-off");
        window.steps(3);
        assert!(!window.shows("Name of side4"), "the end is out of view");
        // to the end of the circuit, for a take-off has no legs
        window.paste("36.3, -84.19");
        let new = window.selected();
        assert_ne!(new, "take-off");
        window.until_analysed();
        let named = window.harness.query_all_by_label_contains("Name of ");
        let named: Vec<String> = named.filter_map(|cell| cell.accesskit_node().label()).collect();
        assert!(named.contains(&format!("Name of {new}")), "{new}: {named:?}");
    }
}

#[test]
fn a_leg_of_a_procedure_has_the_altitude_that_its_call_says() {
    let procedure = r#"<procedures><procedure id="look" reference="36.3 -84.19"><TF id="up" lat="36.3" lon="-84.19"/></procedure></procedures>"#;
    let calls = r#"<call id="west" name="West" procedure="look" altitude="150" altitudeReference="home"/><TF id="side2" "#;
    let text = SQUARE.replacen("<mainPlan", &format!("{procedure}<mainPlan"), 1);
    let window = opened(&text.replacen(r#"<TF id="side2" "#, calls, 1));
    assert_eq!(window.errors(), Vec::<String>::new());
    assert!(window.shows("150 m above home, West"));
    let own = window.harness.query_all_by_label_contains("AMSL, the leg before").count();
    assert_eq!(own, 0, "what its call says, it does not have from elsewhere");
}

#[test]
fn the_menu_of_a_row_opens_by_key() {
    for (modifiers, key) in [(Modifiers::SHIFT, Key::F10), (Modifiers::NONE, Key::Menu)] {
        let mut window = opened(SQUARE);
        let at = window.cell("Altitude of side2");
        window.click_at(at);
        window.press_with(modifiers, key);
        assert!(window.shows("Put into a loop"), "{key:?}");
        let duplicate = window.harness.get_by_label_contains("Duplicate").rect();
        window.click_at(duplicate.center());
        assert_eq!(window.plan().stages[1].legs.len(), 5);
    }
}

/// Columns were cut with room beside them.
#[test]
fn in_a_large_window_no_cell_is_cut() {
    let mut window = opened_in(super::whatif::FIRE_WATCH, vec2(1920.0, 1080.0));
    window.steps(3);
    let heads = window.places_of(|text| text == "Energy left")[0];
    let shapes = window.harness.output().shapes.iter();
    let texts = shapes.flat_map(|clipped| {
        super::painted::texts(&clipped.shape).into_iter().map(|text| (clipped.clip_rect, text))
    });
    let cut: Vec<_> = texts
        .filter(|(_, text)| text.pos.y >= heads.top() - 2.0 && (330.0..1560.0).contains(&text.pos.x))
        .filter(|(clip, text)| {
            text.galley.elided || text.galley.rect.translate(text.pos.to_vec2()).right() > clip.right() + 1.0
        })
        .map(|(_, text)| text.galley.text().to_owned())
        .collect();
    assert!(cut.is_empty(), "{cut:?}");
}
