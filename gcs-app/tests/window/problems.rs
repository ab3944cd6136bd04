//! What is wrong with a plan, as people read and find it.

use super::alone::Alone;
use super::filing::window_on;
use super::{SQUARE, Window};
use egui::vec2;
use egui_kittest::kittest::{NodeT, Queryable};
use flight_plan::Id;
use gcs_app::command::Selection;
use gcs_app::panels::Panel;

const LANDING: &str = r#"<stage id="land" type="land" runway="R05"/>"#;
/// Across the way of `side2`; it has no limits of altitude.
pub const ZONE: &str =
    r#"<zones><keepOut id="quarry" lat="36.3241" lon="-84.1567" radius="60"/></zones><mainPlan"#;

fn opened(text: &str) -> Window {
    let mut window = Window::open(text);
    window.until_analysed();
    window
}

/// The heights on the screen of the problems with these texts.
fn tops(window: &Window, texts: [&str; 2]) -> [f32; 2] {
    texts.map(|text| window.harness.query_all_by_label_contains(text).next().unwrap().rect().top())
}

#[test]
fn a_flight_that_ends_in_the_air_is_no_green_plan() {
    let window = opened(&SQUARE.replacen(LANDING, "", 1));
    assert!(window.shows("⚠ This plan can be flown, 2 warnings") && !window.shows("✔ This plan"));
    let [landing, glide] = tops(&window, ["the flight does not end on the ground", "out of glide"]);
    assert!(landing < glide, "how the flight ends stands first");
}

#[test]
fn errors_stand_first_and_say_what_helps() {
    let mut window = opened(&SQUARE.replacen("<mainPlan", ZONE, 1));
    assert!(window.shows("✖ This plan can't be flown, "));
    let [error, warning] = tops(&window, ["goes into the zone", "out of glide"]);
    assert!(error < warning);
    assert!(!window.shows("or change its altitude"), "the zone has no limits");
    // its leg is pointed out as long as the pointer is on it
    let at = window.harness.query_all_by_label_contains("goes into the zone").next().unwrap().rect().center();
    window.harness.hover_at(at);
    window.steps(3);
    assert!(window.app().view().pointed.is_some());
    window.click_at(at);
    assert!(matches!(window.app().view().selection, Some(Selection::Leg(_))));
    window.harness.hover_at(window.centre("Map"));
    window.steps(3);
    assert_eq!(window.app().view().pointed, None);
}

#[test]
fn the_headlines_of_a_plan_are_in_view_and_all_of_a_text_is_behind_its_mark() {
    let mut window = opened(&SQUARE.replacen(LANDING, "", 1));
    let glide = |window: &Window| {
        let row = window
            .harness
            .query_all_by_label_contains("Problem: ")
            .find(|row| row.accesskit_node().label().is_some_and(|label| label.contains("out of glide")));
        row.unwrap().rect()
    };
    let rows: Vec<_> =
        window.harness.query_all_by_label_contains("Problem: ").map(|row| row.rect()).collect();
    assert_eq!(rows.len(), 2);
    assert!(rows.iter().all(|row| row.bottom() < 800.0 && row.height() < 60.0), "{rows:?}");
    assert!(rows.iter().all(|row| row.width() > 220.0), "they have the panel's width: {rows:?}");
    let headline = glide(&window);
    let more = window
        .harness
        .query_all_by_label_contains("More of: ")
        .find(|more| more.accesskit_node().label().is_some_and(|label| label.contains("out of glide")));
    let more = more.unwrap().rect().center();
    window.click_at(more);
    assert!(glide(&window).height() > headline.height() + 20.0);
    assert!(window.shows("Less of: "));
}

/// Its tip, too, is of what the dialog covers, though the pointer still rests there.
#[test]
fn no_tip_stays_over_a_dialog() {
    let mut window = opened(SQUARE);
    let row = window.harness.query_all_by_label_contains("out of glide").next().unwrap().rect().center();
    window.harness.hover_at(row);
    window.steps(60);
    assert!(window.shows("[glide-out-of-reach]"));
    window.press_ctrl(egui::Key::S);
    window.steps(60);
    assert!(window.shows("Save here") && !window.shows("[glide-out-of-reach]"));
}

/// Each call of a procedure has its problems; they are mended once, and listed so.
#[test]
fn a_problem_inside_a_procedure_is_listed_once_with_the_calls_that_have_it() {
    let procedure = r#"<procedures><procedure id="look" reference="36.3209 -84.1537">
        <TF id="up" name="Up" lat="36.3209" lon="-84.1537" altitude="-900" altitudeReference="amsl"/></procedure></procedures><mainPlan"#;
    let calls = r#"<TF id="side2" fix="B"/><call id="west" name="West" procedure="look"/>
        <call id="east" name="East" procedure="look" lat="36.3150" lon="-84.1600"/>"#;
    let mut window =
        opened(&SQUARE.replacen("<mainPlan", procedure, 1).replacen(r#"<TF id="side2" fix="B"/>"#, calls, 1));
    let of_both =
        window.app().analysis().problems.iter().filter(|problem| problem.code == "bad-value").count();
    assert_eq!(of_both, 2, "{:?}", window.app().analysis().problems);
    let rows = |window: &Window| -> Vec<String> {
        let rows = window.harness.query_all_by_label_contains("Problem: ");
        rows.filter_map(|row| row.accesskit_node().label()).collect()
    };
    let said: Vec<String> = rows(&window).into_iter().filter(|row| row.contains("below any land")).collect();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(said[0].starts_with("Problem: Up (in West and East): "), "{said:?}");
    let by_calls = |row: &String| row.starts_with("Problem: west.up") || row.starts_with("Problem: east.up");
    assert!(!rows(&window).iter().any(by_calls), "{:?}", rows(&window));
    let first = window.harness.query_all_by_label_contains("Problem: Up (in").next().unwrap().rect().center();
    window.click_at(first);
    assert_eq!(window.selected(), "up", "it is mended in the procedure");
}

/// What is mended, and by how much, is told before the button is pressed.
#[test]
fn a_remedy_says_what_it_does_before_it_is_made() {
    let steep = SQUARE.replacen(
        r#"<TF id="side2" fix="B"/>"#,
        r#"<TF id="side2" fix="B" altitude="1900" altitudeReference="home"/>"#,
        1,
    );
    let mut window = opened(&steep);
    let fix = window.harness.get_all_by_label("Fix").next().unwrap().rect().center();
    window.harness.hover_at(fix);
    window.steps(60);
    assert!(window.shows("leg side2 changed: altitude 1900 → "));
    assert_eq!(window.plan(), flight_plan::read(steep).plan);
}

/// The stage's 20 m are wrong for all that inherit them; the leg alone may be raised, too.
#[test]
fn a_stage_that_is_too_low_is_named_and_can_be_raised_itself() {
    let low = SQUARE.replacen(
        r#"altitude="150" altitudeReference="home">"#,
        r#"altitude="20" altitudeReference="amsl">"#,
        1,
    );
    let mut window = opened(&low);
    assert!(window.shows("Problem: side2: it goes into the ground"), "{:?}", window.errors());
    assert!(window.shows("raise this leg"));
    assert!(window.shows("it inherits 20 m AMSL from"));
    let of_leg = |window: &Window| window.plan().leg(&"side2".into()).unwrap().leg.altitude.clone();
    window.harness.get_all_by_label("Fix “circuit”").next().unwrap().scroll_to_me();
    window.steps(10);
    let there = window.harness.get_all_by_label("Fix “circuit”").next().unwrap().rect().center();
    window.click_at(there);
    window.until_analysed();
    let said = window.plan().stage(&"circuit".into()).unwrap().altitude.clone().unwrap();
    assert!(matches!(said.metres, flight_plan::Value::Constant(metres) if metres > 300.0), "{said:?}");
    assert_eq!(of_leg(&window), None, "it goes on inheriting");
    window.click("Undo");
    assert_eq!(window.plan(), flight_plan::read(&low).plan, "one step");
}

/// Whoever clicks twice has read one of them.
#[test]
fn a_remedy_that_comes_under_the_pointer_is_pressed_when_there_was_time_to_read_it() {
    let wrong = |fix: &str| format!(r#"<TF id="x{fix}" fix="{fix}"/>"#);
    let legs = format!(r#"<TF id="side2" fix="B"/>{}{}"#, wrong("RIGDE"), wrong("RIDEG"));
    let fixes = r#"<fix id="RIDGE" lat="36.3150" lon="-84.1600"/></fixes>"#;
    let text = SQUARE.replacen(r#"<TF id="side2" fix="B"/>"#, &legs, 1).replacen("</fixes>", fixes, 1);
    let mut window = opened(&text);
    let wrong =
        |window: &Window| window.errors().iter().filter(|error| error.contains("[unknown-fix]")).count();
    assert_eq!(wrong(&window), 2);
    let fix = window.harness.get_all_by_label("Fix").next().unwrap().rect().center();
    window.click_at(fix);
    window.until_analysed();
    assert_eq!(wrong(&window), 1);
    // apart from the first by more than a double click is, at the same place
    window.steps(40);
    assert!(window.harness.get_all_by_label("Fix").any(|other| other.rect().contains(fix)));
    let once = window.plan();
    window.click_at(fix);
    window.until_analysed();
    assert_eq!(window.plan(), once, "it was not read");
    window.steps(90);
    window.click_at(fix);
    window.until_analysed();
    assert_eq!(wrong(&window), 0);
}

/// It lay kilometres from where it was, and nothing said so.
#[test]
fn of_a_fix_that_was_missing_it_is_said_that_its_place_is_a_guess() {
    let mut window = opened(&SQUARE.replacen(r#"side3" fix="C"/"#, r#"side3" fix="NOWHERE"/"#, 1));
    let fix = window.harness.get_all_by_label("Fix").next().unwrap().rect().center();
    window.click_at(fix);
    assert!(window.plan().fix(&"NOWHERE".into()).is_some());
    assert!(window.shows("NOWHERE was put at 36.") && window.shows("which is a guess"));
}

/// While a change is reviewed nobody knows that the error is gone: what the last review found, of what is still there.
#[test]
fn what_was_wrong_stays_in_grey_until_the_change_is_reviewed() {
    let window = opened(&SQUARE.replacen("<mainPlan", ZONE, 1));
    let known = window.app().analysis().clone();
    assert!(known.unsettled.is_empty());
    let unsettled = known.problems.iter().filter(|problem| problem.code == "keep-out").cloned().collect();
    let mut checked = known.clone();
    (checked.problems, checked.unsettled) = (Vec::new(), unsettled);
    (checked.reviewed, checked.is_complete) = (false, false);
    let alone = Alone::default();
    let scene = alone.scene(window.app(), window.app().document(), &checked);
    assert!(scene.faulty().is_empty() && scene.perhaps_faulty().contains(&Id::new("side2")));
    let mut panel = gcs_app::panels::problems::Problems::default();
    let mut queue = gcs_app::command::Queue::default();
    let drawn = |ui: &mut egui::Ui| panel.ui(ui, &scene, &mut queue);
    let builder = egui_kittest::Harness::builder().with_size(vec2(320.0, 400.0));
    let mut harness = builder.with_context_setup(gcs_app::theme::install).build_ui(drawn);
    harness.run_steps(2);
    let row = |of: &str| harness.query_all_by_label_contains(of).count();
    assert!(row("Being checked: side2: ") == 1 && row("Problem: ") == 0 && row("Fix") == 0);
}

/// Moving the scan is no help where the zone is inside of what is to be seen. The remedy has to be tried, and comes a little later.
#[test]
fn a_zone_inside_of_a_scanned_area_is_left_out_of_it_by_one_click() {
    let corners = [(36.290, -84.150), (36.290, -84.122), (36.312, -84.122), (36.312, -84.150)];
    let corners = corners.map(|(lat, lon)| format!(r#"<corner lat="{lat}" lon="{lon}"/>"#)).concat();
    let side = r#"<TF id="side2" fix="B"/>"#;
    let scan = format!(
        r#"{side}<scan id="sweep" spacing="400" altitude="300" altitudeReference="home"><area>{corners}</area></scan>"#
    );
    let village =
        r#"<zones><keepOut id="village" lat="36.301" lon="-84.136" radius="120"/></zones><mainPlan"#;
    let mut window = opened(&SQUARE.replacen(side, &scan, 1).replacen("<mainPlan", village, 1));
    let keep_outs = |window: &Window| window.errors().iter().filter(|e| e.contains("[keep-out]")).count();
    assert!(keep_outs(&window) > 0, "{:?}", window.errors());
    window.until("the remedy", |app| {
        app.analysis().problems.iter().any(|p| p.message.starts_with("leave the"))
    });
    let row = window.harness.query_all_by_label_contains("leave the zone out").next().unwrap().rect();
    let fixes = window.harness.get_all_by_label("Fix").map(|fix| fix.rect().center());
    let fix = fixes.min_by(|a, b| (a.y - row.bottom()).abs().total_cmp(&(b.y - row.bottom()).abs())).unwrap();
    window.click_at(fix);
    window.until_analysed();
    assert_eq!(keep_outs(&window), 0, "{:?}", window.errors());
    let plan = window.plan();
    let flight_plan::LegKind::Scan(scan) = &plan.leg(&"sweep".into()).unwrap().leg.kind else { panic!() };
    assert!(matches!(&scan.area, flight_plan::Area::Polygon { holes, .. } if holes.len() == 1));
    window.click("Undo");
    assert!(!window.is_enabled("Undo"), "one step");
}

#[test]
fn a_slip_in_a_coordinate_stands_first_and_names_its_leg() {
    let far =
        SQUARE.replacen(r#"<TF id="side2" fix="B"/>"#, r#"<TF id="side2" lat="37.3" lon="-84.15"/>"#, 1);
    let mut window = opened(&far);
    window.steps(3);
    let rows = window.harness.query_all_by_label_contains("Problem: ");
    let first = rows.min_by(|a, b| a.rect().top().total_cmp(&b.rect().top())).unwrap();
    let label = first.accesskit_node().label().unwrap();
    assert!(label.starts_with("Problem: side2: is its position right? It lies 1"), "{label}");
}

#[test]
fn the_button_in_a_problem_is_not_the_problem() {
    let steep = SQUARE.replacen(
        r#"<TF id="side2" fix="B"/>"#,
        r#"<TF id="side2" fix="B" altitude="1900" altitudeReference="home"/>"#,
        1,
    );
    let mut window = opened(&steep);
    let before = window.app().view().selection.clone();
    let fix = window.harness.get_all_by_label("Fix").next().unwrap().rect().center();
    window.click_at(fix + vec2(1.0, 0.0));
    assert_ne!(window.plan(), flight_plan::read(steep).plan);
    assert_eq!(window.app().view().selection, before);
    let altitude = window.plan().leg(&"side2".into()).unwrap().leg.altitude.clone().unwrap();
    assert_eq!(altitude.reference.name(), "home");
}

#[test]
fn the_first_error_of_a_plan_that_is_opened_is_selected_and_problems_follow_the_selection() {
    let folder = tempfile::tempdir().unwrap();
    let legs: String = (0..10).map(|i| format!(r#"<TF id="bad{i}" fix="NOWHERE{i}"/>"#)).collect();
    let side = r#"<TF id="side2" fix="B"/>"#;
    let bad = SQUARE.replacen(side, &format!("{side}{legs}"), 1);
    let mut window = window_on(&folder.path().join("bad.xml"), &bad);
    window.until_analysed();
    assert_eq!(window.selected(), "bad0");
    let rect_of = |window: &Window, of: &str| {
        window.harness.query_all_by_label_contains(&format!("Problem: {of}:")).next().map(|row| row.rect())
    };
    assert!(rect_of(&window, "bad0").is_some() && rect_of(&window, "bad9").is_none(), "it is folded");
    // it scrolls there step by step
    let choose = |window: &mut Window, leg: &str| {
        window.click(&format!("TF {leg}"));
        window.steps(30);
        rect_of(window, leg).unwrap()
    };
    let shown = choose(&mut window, "bad9");
    assert!(shown.bottom() < 800.0, "{shown}");
    let top = window.harness.get_by_label("Hide Problems").rect().bottom();
    let above = rect_of(&window, "bad0").unwrap();
    assert!(above.bottom() < top, "it is out of view: {above}");
    let shown = choose(&mut window, "bad0");
    assert!(shown.top() > top, "{shown}");
    window.press(egui::Key::Escape);
    assert_eq!(window.selected(), "", "it is selected once");
}

/// On the map and on the profile; what is in order has no red.
#[test]
fn a_leg_and_a_zone_in_error_are_red_on_map_and_profile() {
    let red = gcs_app::theme::palette(true).warning;
    let places = ["Map", "Vertical profile"];
    let lines = |window: &Window| places.map(|place| window.lines_within(place, red));
    let good = opened(SQUARE);
    assert_eq!(lines(&good), [0, 0]);
    let zone = ZONE.replace("radius=\"60\"", "radius=\"150\"");
    let bad = opened(&SQUARE.replacen("<mainPlan", &zone, 1));
    let [map, profile] = lines(&bad);
    assert!(map > 0 && profile > 0, "{map} {profile}");
    assert_eq!(bad.colour_within("Map", "quarry"), Some(red), "the zone");
    // one that is out of the way is as any other, and so is the leg
    let aside = opened(&SQUARE.replacen("<mainPlan", &zone.replace("36.3241", "36.3141"), 1));
    assert_eq!(aside.errors(), Vec::<String>::new());
    assert_eq!(lines(&aside), [0, 0]);
    // thin letters in a fainter red could not be read in the light
    assert_eq!(aside.colour_within("Map", "quarry"), Some(gcs_app::theme::palette(true).text));
}

/// Those of an orbit lie so close together that nothing was seen of the red.
#[test]
fn what_is_red_lies_over_the_waypoints_of_the_path() {
    let p = gcs_app::theme::palette(true);
    let zone = ZONE.replace("radius=\"60\"", "radius=\"150\"");
    let orbit = r#"<orbit id="round" radius="200" turns="1" turn="left"><centre lat="36.3241" lon="-84.1566"/></orbit><TF id="side2""#;
    let bad = opened(&SQUARE.replacen("<mainPlan", &zone, 1).replacen(r#"<TF id="side2""#, orbit, 1));
    assert!(bad.errors().iter().any(|error| error.contains("round")), "{:?}", bad.errors());
    let last = |colour| bad.last_triangles_within("Map", colour);
    assert!(last(p.accent).is_some() && last(p.warning) > last(p.accent));
}

/// A dozen entries with the same remedy took a press each.
#[test]
fn many_problems_of_one_sort_are_one_entry_with_one_remedy() {
    let leg = |n| {
        format!(
            r#"<TF id="wrong{n}" fix="LAKE{n}{n}{n}"/><TF id="good{n}" fix="C"/><TF id="back{n}" fix="A"/>"#
        )
    };
    let legs: String = (0..6).map(leg).collect();
    let mut window = opened(&SQUARE.replacen(r#"<TF id="side2""#, &format!(r#"{legs}<TF id="side2""#), 1));
    let listed = |window: &Window| window.harness.query_all_by_label_contains("Problem: wrong").count();
    assert_eq!(listed(&window), 1);
    window.click("5 more like it ⏷");
    assert_eq!(listed(&window), 6);
    window.click("5 more like it ⏶");
    assert_eq!(listed(&window), 1);
    window.click("Fix all 6");
    window.until_analysed();
    assert!(window.errors().iter().all(|error| !error.contains("LAKE")), "{:?}", window.errors());
    window.click("Undo");
    assert!(window.plan().fix(&"LAKE000".into()).is_none(), "one step");
}

#[test]
fn a_fix_that_is_not_there_is_made_by_its_remedy() {
    let mut window = opened(&SQUARE.replace(r#"<TF id="side2" fix="B""#, r#"<TF id="side2" fix="LAKE""#));
    window.click("Fix");
    window.until_analysed();
    assert!(window.plan().fix(&"LAKE".into()).is_some());
    assert!(!window.errors().iter().any(|error| error.contains("LAKE")), "{:?}", window.errors());
}

/// A leg that the path does not come to is marked with a cross.
#[test]
fn a_leg_in_error_that_is_not_flown_has_a_red_cross_at_its_place() {
    let red = gcs_app::theme::palette(true).warning;
    let agl = r#"<TF id="side2" fix="B" altitude="120" altitudeReference="agl"/>"#;
    let text = SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, agl);
    let ground = std::sync::Arc::new(super::table::Unknown);
    let mut window = Window::open_over(&text, vec2(1280.0, 800.0), None, ground);
    window.until_analysed();
    assert!(window.errors().iter().any(|error| error.contains("side2")), "{:?}", window.errors());
    assert!(window.lines_within("Map", red) >= 3, "a circle and its two strokes");
}

/// Only the close look leads through the zone, on its way to a leg that is flown by default, too.
#[test]
fn a_click_on_what_only_a_branch_flies_goes_to_where_that_is_wrong_and_not_to_the_planned_leg() {
    let fork = r#"<TF id="side2" fix="B"/>
      <intersection id="ask" default="on"><branch id="on" next="side3"/><branch id="close" label="Close look" next="look"/></intersection>
      <TF id="look" lat="36.300" lon="-84.130" next="side3"/>"#;
    let zone = r#"<zones><keepOut id="quarry" lat="36.3025" lon="-84.150" radius="150"/></zones><mainPlan"#;
    let plan = SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, fork).replacen("<mainPlan", zone, 1);
    let mut window = opened(&plan);
    let problems = &window.app().analysis().problems;
    let error = problems.iter().find(|problem| problem.code == "keep-out").unwrap().clone();
    assert!(error.message.contains("where it follows `look` (branch “Close look”)"), "{}", error.message);
    let spot = error.place.unwrap();
    assert!(spot.is_off_plan, "the way that is planned is far away, and is not drawn red");
    let row = window.harness.query_all_by_label_contains("(branch “Close look”)").next().unwrap().rect();
    window.click_at(row.center());
    assert_eq!(window.selected(), "side3");
    let middle = window.app().map().middle().unwrap();
    let far_m = middle.distance_m(spot.position);
    assert!(far_m < 10.0, "{far_m} m beside it");
}

/// Its legs are under *Procedures*, at the end of the plan: nobody finds that by a name that only calls have.
#[test]
fn a_click_on_a_problem_of_a_call_goes_to_the_leg_of_the_procedure() {
    let called = r#"<TF id="side2" fix="B"/><call id="call1" procedure="look"/>"#;
    let procedure = r#"<procedures><procedure id="look" reference="36.3209 -84.1537"><orbit id="round" radius="20" turn="left"><centre
        fix="B"/></orbit></procedure></procedures><mainPlan"#;
    let plan = SQUARE.replace(r#"<TF id="side2" fix="B"/>"#, called).replacen("<mainPlan", procedure, 1);
    let mut window = opened(&plan);
    let row =
        window.harness.query_all_by_label_contains("Problem: round (in call1): ").next().unwrap().rect();
    window.click_at(row.center());
    assert_eq!(window.selected(), "round");
    window.press(egui::Key::Escape);
    window.ask_for("show leg round");
    window.press(egui::Key::Enter);
    assert_eq!(window.selected(), "round", "the palette knows it, too");
}

/// Two were, and the others were scrolled to by who knew of them.
#[test]
fn five_problems_and_their_remedies_are_in_view() {
    let corners = ["A", "B", "C", "D"];
    let broken = corners.iter().fold(SQUARE.to_owned(), |text, fix| {
        text.replace(&format!(r#" fix="{fix}""#), &format!(r#" fix="{fix}{fix}""#))
    });
    let broken = broken.replacen(LANDING, "", 1);
    for (size, least) in [(vec2(1280.0, 800.0), 5), (vec2(960.0, 600.0), 3)] {
        let mut window = Window::open_with(&broken, size, None);
        window.until_analysed();
        let panel = window.harness.get_by_label("Hide Problems").rect();
        let in_view = |rect: egui::Rect| rect.top() > panel.bottom() && rect.bottom() <= size.y;
        let rows = window.harness.query_all_by_label_contains("Problem: ").map(|row| row.rect());
        let rows: Vec<_> = rows.filter(|row| in_view(*row)).collect();
        assert!(rows.len() >= least, "{size}: {rows:?}");
    }
}

/// It stood where the departure ended.
#[test]
fn the_mark_of_a_missing_fix_or_runway_is_where_what_names_it_begins() {
    let mark_of = |from: &str, to: &str, words: &str| {
        let window = opened(&SQUARE.replacen(from, to, 1));
        let marks = window.places_of(|text| text.starts_with(words));
        let map = window.harness.get_by_label("Map").rect();
        let mark = marks.into_iter().find(|mark| map.contains_rect(*mark));
        (mark, ["A", "B", "C", "D"].map(|fix| window.centre(&format!("Fix {fix}"))))
    };
    let near =
        |mark: Option<egui::Rect>, at: egui::Pos2| mark.is_some_and(|mark| mark.distance_to_pos(at) < 30.0);
    let (mark, [_, b, ..]) = mark_of(r#"side3" fix="C"/"#, r#"side3" fix="NOWHERE"/"#, "there is no fix");
    assert!(near(mark, b), "{mark:?} {b}");
    let (mark, [.., d]) = mark_of(
        r#""land" type="land" runway="R05"#,
        r#""land" type="land" runway="R99"#,
        "there is no runway",
    );
    assert!(near(mark, d), "{mark:?} {d}");
    let (mark, _) = mark_of(r#"<DF id="r1" fix="D""#, r#"<DF id="r1" fix="NOWHERE""#, "there is no fix");
    assert!(mark.is_some(), "nobody knows where an emergency plan begins: at the runway that it leads to");
}
