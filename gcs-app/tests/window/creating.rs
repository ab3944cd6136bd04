//! From an empty document to a plan that flies, and nothing lost on the way.

use super::Window;
use super::small::tool;
use egui::accesskit::Role;
use egui::{Key, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::template::{Extent, Template};
use flight_plan::{LegKind, Pattern, StageKind, Value};

pub const EMPTY: &str = "<flightPlan xmlns='urn:legwork:flight-plan:1' name='New plan' aircraft='trainer'/>";

/// A window without a plan, at the example's hills.
pub fn begun(size: egui::Vec2) -> Window {
    let mut window = Window::open_with(EMPTY, size, None);
    window.steps(3);
    window.click("Among the example's hills");
    window
}

pub const SIZE: egui::Vec2 = vec2(1280.0, 800.0);

/// Clicks these places of the map, from the middle of what the card leaves free.
pub fn draw(window: &mut Window, offsets: &[egui::Vec2]) {
    let middle = window.centre("Map") + vec2(140.0, 0.0);
    for offset in offsets {
        window.click_at(middle + *offset);
    }
}

fn guide(window: &Window) -> &gcs_app::guide::Guide {
    &window.app().view().guide
}

fn stages(window: &Window) -> usize {
    window.app().document().plan().stages.len()
}

#[test]
fn each_template_gives_a_plan_that_can_be_flown_and_undone() {
    for template in Template::ALL {
        let mut window = begun(SIZE);
        assert!(window.shows("New mission"));
        window.click(template.name());
        window.click("Create");
        assert!(!window.shows("New mission") && window.app().document().is_dirty());
        window.until_analysed();
        let errors: Vec<_> = window.app().analysis().problems.iter().filter(|p| p.is_error()).collect();
        assert!(errors.is_empty() && window.shows("can be flown"), "{template:?}: {errors:?}");
        assert!(window.app().analysis().forecast.length_m() > 5000.0);
        window.click("Undo");
        assert!(stages(&window) == 0 && window.shows("New mission"));
        window.until_analysed();
        assert!(window.app().analysis().forecast.points.is_empty(), "the path was that of another plan");
        assert!(window.shows("This plan can't be flown yet") && !window.paints("Out of date"));
        window.click("Redo");
        window.until_analysed();
        assert!(window.app().analysis().forecast.length_m() > 5000.0);
    }
}

/// Nothing that is drawn begins by itself.
/// The plan was empty again, and nothing said why.
#[test]
fn undoing_a_new_mission_is_told() {
    let mut window = begun(vec2(1280.0, 800.0));
    window.click("Create");
    assert!(stages(&window) > 0);
    window.click("Undo");
    assert!(stages(&window) == 0 && window.shows("Redo (Ctrl+Y) brings it back"));
}

#[test]
fn no_tool_is_armed_by_itself() {
    for key in [Key::A, Key::R, Key::E] {
        let mut window = begun(SIZE);
        window.click("✏ Draw the runway");
        window.click("Create");
        assert_eq!(tool(&window), "select", "after Create");
        window.press(key);
        assert!(tool(&window) != "select");
        window.press_ctrl(Key::N);
        window.click("Discard the changes");
        window.click("Among the example's hills");
        window.click("Create");
        assert_eq!(tool(&window), "select", "in the next plan");
    }
}

/// More than was asked for, because of hills beside the way.
#[test]
fn the_height_that_the_ground_asks_for_is_told_before_the_plan_is_made() {
    let mut window = begun(SIZE);
    window.click(Template::Survey.name());
    assert!(window.shows(": the ground around asks for that"));
    let said = window.harness.query_all_by_label_contains("the ground around asks").next().unwrap();
    let said = said.accesskit_node().value().or(said.accesskit_node().label()).unwrap();
    window.click("Create");
    let mission = window.plan().stages.iter().find(|s| s.kind == StageKind::Mission).cloned().unwrap();
    let Some(Value::Constant(height_m)) = mission.altitude.map(|altitude| altitude.metres) else { panic!() };
    assert!(height_m > 160.0 && said.contains(&format!("{height_m:.0} m above the runway")), "{said}");
}

#[test]
fn the_question_on_the_map_has_no_empty_line_below_it() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    let said = "Zoom in and click where you fly, or type it into the card.";
    let text = window.harness.get_by_label(said).rect();
    let below = window.plate_around(text).unwrap().bottom() - text.bottom();
    assert!(below < 16.0, "{below}");
}

#[test]
fn window_without_a_plan_shows_the_world_and_asks_where() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    assert!(window.shows("Where do you fly?") && !window.is_enabled("Create"));
    draw(&mut window, &[vec2(20.0, 40.0)]);
    let at = guide(&window).threshold.unwrap();
    assert!(at.lat_deg.abs() < 60.0 && at.lon_deg > 5.0, "a place right of the world's middle: {at:?}");
    assert!(window.is_enabled("Create") && guide(&window).drawing.is_none());
}

#[test]
fn place_is_typed_and_what_is_none_is_refused() {
    for (typed, expected) in [
        ("nowhere", None),
        ("47.1, 8.2", Some(geometry::LatLon::new(47.1, 8.2))),
        ("lowi", Some(geometry::LatLon::new(47.26, 11.344))),
    ] {
        let mut window = Window::open(EMPTY);
        window.steps(3);
        window.harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "Place").focus();
        window.steps(2);
        window.harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "Place").type_text(typed);
        window.press(Key::Enter);
        let off_m = guide(&window).threshold.zip(expected).map(|(at, expected)| at.distance_m(expected));
        // an airport is where its runway begins
        assert_eq!(guide(&window).threshold.is_some(), expected.is_some(), "{typed}");
        assert!(off_m.is_none_or(|metres| metres < 2000.0), "{typed}: {off_m:?}");
    }
}

#[test]
fn coordinates_that_are_pasted_are_where_the_mission_is() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.paste("47°06'00\"N 8°12'00\"E");
    let off_m = |window: &Window, lat, lon| {
        guide(window).threshold.unwrap().distance_m(geometry::LatLon::new(lat, lon))
    };
    assert!(off_m(&window, 47.1, 8.2) < 1.0 && window.app().view().notice.is_none());
    assert!(window.is_enabled("Create"));
    window.paste("36.3, -84.2");
    assert!(off_m(&window, 36.3, -84.2) < 1.0, "another place in the second step");
    window.paste("nowhere at all");
    assert!(off_m(&window, 36.3, -84.2) < 1.0 && window.app().view().notice.is_some());
}

#[test]
fn heading_and_aircraft_are_those_of_the_card() {
    let mut window = begun(SIZE);
    let place = guide(&window).threshold;
    window.fill_in(Role::SpinButton, "Heading", "127");
    let list = window.harness.get_by_role_and_label(Role::ComboBox, "Aircraft: trainer");
    list.scroll_to_me();
    window.steps(3);
    window.click("Aircraft: trainer");
    window.click("fast-wing");
    window.steps(2);
    assert!(window.harness.query_by_role_and_label(Role::ComboBox, "Aircraft: fast-wing").is_some());
    window.click("Create");
    window.until_analysed();
    let plan = window.plan();
    assert_eq!((plan.aircraft.as_str(), plan.runways[0].id.as_str()), ("fast-wing", "R13"));
    assert_eq!((plan.runways[0].heading_deg, Some(plan.runways[0].threshold)), (127.0, place));
    assert_eq!(window.errors(), Vec::<String>::new());
    assert!(window.app().analysis().forecast.length_m() > 5000.0);
}

/// Types something into a field of the card, and presses Enter.
fn type_into(window: &mut Window, field: &str, text: &str) {
    window.harness.get_by_role_and_label(Role::TextInput, field).focus();
    window.steps(2);
    window.press_ctrl(Key::A);
    window.harness.get_by_role_and_label(Role::TextInput, field).type_text(text);
    window.press(Key::Enter);
}

fn text_of(window: &Window, field: &str) -> String {
    let node = window.harness.get_by_role_and_label(Role::TextInput, field);
    node.accesskit_node().value().unwrap_or_default()
}

#[test]
fn a_name_of_several_places_is_chosen_from_a_list_and_nothing_typed_is_lost() {
    let mut window = Window::open_with(EMPTY, vec2(960.0, 600.0), None);
    window.steps(3);
    type_into(&mut window, "Place", "nowhere at all");
    assert_eq!(text_of(&window, "Place"), "nowhere at all");
    type_into(&mut window, "Place", "springfield");
    assert_eq!(text_of(&window, "Place"), "springfield");
    assert!(window.shows("Choose which of them is meant"), "Enter does not do nothing");
    let named = guide(&window).search.clone().unwrap().named;
    assert!(named.len() > 1 && guide(&window).threshold.is_none(), "{named:?}");
    window.click(&named[1].name);
    assert!(guide(&window).threshold.unwrap().distance_m(named[1].at) < 2000.0);
    assert!(guide(&window).search.is_none());
}

#[test]
fn the_map_goes_to_another_place_that_is_typed_in_the_second_step() {
    let mut window = begun(SIZE);
    type_into(&mut window, "Runway at", "lowi");
    let innsbruck = guide(&window).threshold.unwrap();
    window.click("✏ Draw the runway");
    draw(&mut window, &[vec2(0.0, 0.0), vec2(40.0, 0.0)]);
    let drawn = guide(&window).threshold.unwrap();
    assert!(drawn.distance_m(innsbruck) < 3000.0, "{drawn:?}");
}

#[test]
fn the_card_is_closed_and_comes_back_with_a_new_plan() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.click("Close the card (Esc); New opens it again");
    assert!(!window.shows("New mission"));
    window.press_ctrl(Key::N);
    assert!(window.shows("New mission"));
    window.press(Key::Escape);
    assert!(!window.shows("New mission"), "first step");
    window.press_ctrl(Key::N);
    window.click("Among the example's hills");
    window.harness.get_by_role_and_label(Role::TextInput, "Runway at").focus();
    window.steps(2);
    window.press(Key::Escape);
    assert!(window.shows("New mission"), "the field first");
    window.press(Key::Escape);
    assert!(!window.shows("New mission"), "second step");
    window.press_ctrl(Key::N);
    assert!(guide(&window).threshold.is_some(), "what was answered stays");
}

#[test]
fn the_buttons_of_the_card_stay_in_view_however_low_the_window_is() {
    for size in [vec2(960.0, 600.0), vec2(960.0, 420.0)] {
        let mut window = begun(size);
        window.click("Corridor");
        window.steps(5);
        let rect = window.harness.get_by_label("Create").rect();
        assert!(rect.max.y < size.y, "{rect:?} of {size}");
    }
}

/// A survey of which runway and area were drawn, begun with nothing.
pub fn drawn_survey(size: egui::Vec2) -> Window {
    let mut window = begun(size);
    draw_runway_and_area(&mut window);
    window.click("Create");
    window.until_analysed();
    window
}

#[test]
fn runway_and_area_are_drawn_and_the_plan_flies_there() {
    let window = drawn_survey(SIZE);
    assert_eq!(window.errors(), Vec::<String>::new());
    let LegKind::Scan(scan) = window.plan().leg(&"scan".into()).unwrap().leg.kind.clone() else {
        panic!("no scan")
    };
    assert!(matches!(scan.area, flight_plan::Area::Polygon { corners, .. } if corners.len() == 4));
    assert!((window.plan().runways[0].heading_deg - 90.0).abs() < 1.0);
}

fn draw_runway_and_area(window: &mut Window) {
    window.click("✏ Draw the runway");
    assert!(window.shows("click the landing threshold"));
    draw(window, &[vec2(0.0, 60.0), vec2(40.0, 60.0)]);
    assert!((guide(window).heading_deg - 90.0).abs() < 1.0 && guide(window).drawing.is_none());
    window.click("✏ Draw the area");
    draw(window, &[vec2(0.0, -60.0), vec2(90.0, -70.0), vec2(100.0, -150.0), vec2(10.0, -140.0)]);
    window.press(Key::Enter);
    assert!(window.shows("area of 4 points"));
}

/// Who does not end the outline means what is drawn of it, and what is drawn of another template is no outline.
#[test]
fn what_is_drawn_counts_without_its_end() {
    let mut window = begun(SIZE);
    window.click("✏ Draw the area");
    let corners = [vec2(0.0, -60.0), vec2(90.0, -70.0), vec2(100.0, -150.0), vec2(10.0, -140.0)];
    draw(&mut window, &corners[..2]);
    assert_eq!(guide(&window).extent, None);
    draw(&mut window, &corners[2..]);
    window.press(Key::Backspace);
    assert!(matches!(guide(&window).extent, Some(Extent::Drawn(ref drawn)) if drawn.len() == 3));
    window.click("Create");
    window.until_analysed();
    let LegKind::Scan(scan) = window.plan().leg(&"scan".into()).unwrap().leg.kind.clone() else {
        panic!("no scan")
    };
    assert!(matches!(scan.area, flight_plan::Area::Polygon { corners, .. } if corners.len() == 3));
    let mut window = begun(SIZE);
    window.click("✏ Draw the area");
    draw(&mut window, &corners[..3]);
    window.click(Template::Search.name());
    window.click("✏ Draw the circle");
    draw(&mut window, &corners[..2]);
    assert!(matches!(guide(&window).extent, Some(Extent::Around { .. })), "{:?}", guide(&window).extent);
}

#[test]
fn each_template_asks_on_the_map_for_what_it_is_about() {
    for (template, button, clicks) in [
        (Template::Corridor, "✏ Draw the line", 3),
        (Template::Patrol, "✏ Draw the line", 3),
        (Template::Search, "✏ Draw the circle", 2),
        (Template::FireWatch, "✏ Draw the circle", 2),
    ] {
        let mut window = begun(SIZE);
        window.click(template.name());
        window.click(button);
        let line = [vec2(0.0, -90.0), vec2(110.0, -90.0), vec2(200.0, -110.0)];
        draw(&mut window, &line[..clicks]);
        if clicks == 3 {
            window.press(Key::Enter);
        }
        assert!(guide(&window).extent.is_some() && guide(&window).drawing.is_none(), "{template:?}");
        window.click("Create");
        window.until_analysed();
        assert_eq!(window.errors(), Vec::<String>::new(), "{template:?}");
    }
}

#[test]
fn escape_or_another_tool_ends_what_the_guide_asks_for() {
    let mut window = begun(SIZE);
    window.click("✏ Draw the runway");
    draw(&mut window, &[vec2(0.0, 60.0)]);
    window.press(Key::Escape);
    assert!(window.shows("click the landing threshold"), "the gesture first");
    window.press(Key::Escape);
    assert!(guide(&window).drawing.is_none());
    window.click("✏ Draw the area");
    window.click("Place a fix (X)");
    assert!(guide(&window).drawing.is_none());
    draw(&mut window, &[vec2(0.0, 60.0)]);
    assert_eq!(window.plan().fixes.len(), 1);
}

#[test]
fn point_of_a_new_corridor_is_dragged_by_itself() {
    let mut window = begun(SIZE);
    window.click("Corridor");
    window.click("Create");
    window.until_analysed();
    let route = |window: &Window| {
        let context = window.app().document().plan().leg(&"strip".into()).unwrap().leg.clone();
        let LegKind::Pattern(Pattern::Corridor { route, .. }) = context.kind else { panic!("no corridor") };
        route
    };
    let before = route(&window);
    window.click("CORR Along the line");
    let at = window.centre("Corner 3 of Along the line");
    window.drag(at, vec2(-40.0, -30.0));
    let after = route(&window);
    assert_eq!(after[..2], before[..2]);
    assert_ne!(after[2], before[2]);
}

#[test]
fn card_fits_the_smallest_window() {
    let mut window = begun(vec2(960.0, 600.0));
    window.steps(5);
    for label in ["Create", "Open a plan…", "Survey", "Height"] {
        let rect = window.harness.get_all_by_label(label).next().unwrap().rect();
        assert!(rect.min.y > 42.0 && rect.max.y < 600.0 && rect.max.x < 960.0, "{label}: {rect:?}");
    }
    // nothing that is written lies under the bar by which the questions are scrolled
    let all = super::states::widgets(&window);
    let is_bar = |w: &&super::states::Widget| w.role == Role::ScrollBar && w.rect.left() < 270.0;
    let bar = all.iter().find(is_bar).expect("they do not fit").rect;
    let questions = bar.with_min_x(20.0);
    let written = window
        .places_of(|text| text.chars().count() > 1)
        .into_iter()
        .filter(|at| questions.contains(at.left_top()));
    let under: Vec<_> = written.filter(|at| at.right() > bar.left() + 0.5).collect();
    assert!(under.is_empty(), "{under:?} {bar}");
    // the map, its tools and the tabs below it stay free
    let map = window.harness.get_by_label("Map").rect();
    for label in ["Create", "Open a plan…", "Survey", "Height", "New mission"] {
        let rect = window.harness.get_all_by_label(label).next().unwrap().rect();
        assert!(rect.max.x < map.min.x, "{label}: {rect:?} over {map:?}");
    }
    // by the pointer: what is covered can't be clicked
    let at = window.centre("Create");
    window.harness.hover_at(at);
    window.harness.drag_at(at);
    window.harness.drop_at(at);
    window.steps(3);
    assert!(stages(&window) > 0);
}

#[test]
fn plan_with_unsaved_changes_gives_way_only_when_told_to() {
    let mut window = begun(SIZE);
    window.click("Create");
    let made = stages(&window);
    window.press_ctrl(Key::N);
    assert!(window.shows("has unsaved changes") && stages(&window) == made);
    window.click("Cancel");
    assert!(!window.shows("has unsaved changes") && stages(&window) == made);
    window.press_ctrl(Key::N);
    window.click("Discard the changes");
    assert!(stages(&window) == 0 && !window.shows("has unsaved changes"));
    assert_eq!(guide(&window).threshold, None, "the next mission may be elsewhere");
    window.press_ctrl(Key::N);
    assert!(!window.shows("has unsaved changes"), "there is nothing to be lost");
}

/// As other programs draw it, about this place.
fn drawn_area(lat: f64, lon: f64) -> String {
    let ring: Vec<String> = [(0.0, 0.0), (0.0, 0.02), (0.02, 0.02), (0.02, 0.0), (0.0, 0.0)]
        .iter()
        .map(|(up, right)| format!("[{},{}]", lon + right, lat + up))
        .collect();
    format!(r#"{{"type":"Polygon","coordinates":[[{}]]}}"#, ring.join(","))
}

#[test]
fn a_mission_pasted_far_away_is_said_to_be_and_create_keeps_its_place() {
    let mut window = begun(SIZE);
    let create = window.centre("Create");
    window.paste(&drawn_area(36.34, -84.15));
    assert!(
        window.shows("area of 4 points") && window.is_enabled("Create") && !window.shows("from the runway")
    );
    assert_eq!(window.centre("Create"), create);
    window.paste(&drawn_area(36.34, -4.15));
    assert!(window.shows("km from the runway") && !window.is_enabled("Create"));
    assert_eq!(window.centre("Create"), create);
}

#[test]
fn the_beginning_of_the_only_place_of_that_name_is_enough() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    type_into(&mut window, "Place", "Salzbu");
    assert!(guide(&window).threshold.unwrap().distance_m(geometry::LatLon::new(47.79, 13.0)) < 5000.0);
}

#[test]
fn window_with_unsaved_changes_asks_before_it_closes() {
    let mut window = begun(SIZE);
    window.click("Create");
    let viewport = window.harness.ctx.viewport_id();
    let input = window.harness.input_mut();
    input.viewports.entry(viewport).or_default().events.push(egui::ViewportEvent::Close);
    window.steps(1);
    window.harness.input_mut().viewports.entry(viewport).or_default().events.clear();
    window.steps(1);
    assert!(window.shows("The window is about to close"));
    window.click("Cancel");
    assert!(!window.shows("The window is about to close"));
}

#[test]
fn a_new_mission_begins_where_the_vehicle_is() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    assert!(!window.shows("Where the vehicle is"), "there is none");
    window.connect();
    window.steps(3);
    window.click("Where the vehicle is");
    let vehicle = window.app().vehicle().position.as_ref().unwrap().value.position;
    assert_eq!(guide(&window).threshold, Some(vehicle));
}

/// No elevations are loaded there.
#[test]
fn an_airport_gives_the_runway_and_the_ground_of_a_new_mission() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.harness.get_by_role_and_label(Role::TextInput, "Place").focus();
    window.steps(2);
    window.harness.get_by_role_and_label(Role::TextInput, "Place").type_text("LEGE");
    window.steps(2);
    window.press(Key::Enter);
    assert!(window.shows("123 m AMSL, as LEGE Girona-Costa Brava has it"));
    window.click("Runway 19");
    assert!((guide(&window).heading_deg - 196.0).abs() < 2.0 && window.shows("143 m AMSL"));
    window.click("Create");
    let runway = window.plan().runways[0].clone();
    assert_eq!((runway.id.as_str(), runway.elevation_amsl_m), ("R19", 143.0));
    assert_eq!(window.app().view().notice, None);
}

#[test]
fn ground_that_nobody_knows_is_said_to_be_assumed() {
    let mut window = Window::open(EMPTY);
    window.steps(3);
    window.harness.get_by_role_and_label(Role::TextInput, "Place").focus();
    window.steps(2);
    window.harness.get_by_role_and_label(Role::TextInput, "Place").type_text("-48.9 -123.4");
    window.steps(2);
    window.press(Key::Enter);
    assert!(window.shows("not known here: 0 m assumed"));
    window.click("Create");
    assert!(window.app().view().notice.as_ref().unwrap().contains("Load elevations"));
    let map = window.harness.get_by_label("Map").rect();
    window.click("Close this message");
    assert_eq!(window.app().view().notice, None);
    assert_eq!(window.harness.get_by_label("Map").rect(), map, "a message moves nothing");
}

/// What was said of an answer took one line or several, and the next question moved under the pointer.
#[test]
fn no_question_moves_while_the_card_is_filled_in_nor_lies_over_the_scale() {
    let mut window = begun(SIZE);
    let at = |window: &Window| {
        ["Heading", "Length", "Height"]
            .map(|name| window.harness.get_by_role_and_label(Role::SpinButton, name).rect().top())
    };
    window.click(Template::Survey.name());
    let before = at(&window);
    window.click(Template::FireWatch.name());
    assert_eq!(at(&window), before);
    window.click(Template::Survey.name());
    window.harness.get_by_role_and_label(Role::TextInput, "Runway at").focus();
    window.steps(2);
    window.press_ctrl(Key::A);
    window.harness.get_by_role_and_label(Role::TextInput, "Runway at").type_text("LEGE");
    window.steps(2);
    window.press(Key::Enter);
    window.steps(3);
    assert!(window.shows("Runway 19"), "another place");
    assert_eq!(at(&window), before);
    let card = window.plate_around(window.harness.get_by_label("Create").rect().expand(4.0)).unwrap();
    let scale = window.places_of(|text| text.ends_with(" m") || text.ends_with(" km"));
    let map = window.harness.get_by_label("Map").rect();
    let scale = scale.into_iter().find(|at| at.bottom() > map.bottom() - 24.0).unwrap();
    assert!(!card.intersects(scale), "{card} {scale}");
    let sources = window.places_of(|text| text.contains("OurAirports"))[0];
    assert!(!card.intersects(sources), "{card} {sources}");
}
