//! Everything that can be in a plan is drawn on the map.

use super::{SQUARE, Window};
use egui::{Key, Pos2, Vec2, vec2};
use egui_kittest::kittest::Queryable;
use flight_plan::create::{LegChoice, Shape};
use flight_plan::{Area, Id, LegKind, Pattern, Place, ZoneKind, ZoneShape};

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// What is south-east of the square, on the screen.
fn free(window: &Window) -> Pos2 {
    window.centre("Map") + vec2(90.0, 60.0)
}

fn kind_of(window: &Window, id: &str) -> LegChoice {
    LegChoice::of(&window.plan().leg(&Id::new(id)).unwrap().leg.kind)
}

/// Opens the list that begins so and takes an entry of it.
pub fn choose(window: &mut Window, list: &str, entry: &str) {
    let opened = window.harness.get_all_by_label_contains(list).next().unwrap();
    opened.click();
    window.steps(3);
    let last = window.harness.get_all_by_label(entry).last().unwrap();
    last.click();
    window.steps(3);
}

fn figure(shape: Shape) -> &'static [Vec2] {
    const AREA: [Vec2; 4] = [vec2(0.0, 0.0), vec2(130.0, 0.0), vec2(130.0, 90.0), vec2(0.0, 90.0)];
    match shape {
        Shape::Place => &AREA[..1],
        Shape::Line => &AREA[..3],
        Shape::Area => &AREA,
        Shape::Circle | Shape::Nothing => &AREA[..2],
    }
}

#[test]
fn every_kind_of_leg_is_drawn_on_the_map() {
    let tools = [
        (Shape::Place, "Draw legs (T)", "Kind: TF"),
        (Shape::Line, "Draw a line to follow (L)", "Kind: Corridor"),
        (Shape::Area, "Draw an area to scan (A)", "Kind: Scan"),
        (Shape::Circle, "Draw a circle or search (O)", "Kind: Orbit"),
    ];
    for (shape, tool, list) in tools {
        for choice in LegChoice::drawn_as(shape).filter(|choice| *choice != LegChoice::Call) {
            let mut window = window();
            window.click("TF side4");
            window.click(tool);
            choose(&mut window, list, &choice.name());
            let at = free(&window);
            for offset in figure(shape) {
                window.click_at(at + *offset);
            }
            if matches!(shape, Shape::Line | Shape::Area) {
                window.press(Key::Enter);
            }
            let id = window.selected();
            assert_eq!(kind_of(&window, &id), choice, "{id}");
            assert_eq!(window.app().view().notice, None);
            window.until_analysed();
            // how an arc goes on is the next click; a small figure may be too tight, and is said to be
            let allowed = ["rf-not-tangent", "turn-too-tight", "tracks-too-close", "course-not"];
            let errors = window.errors();
            let odd = errors.iter().find(|e| !allowed.iter().any(|code| e.contains(code)));
            assert_eq!(odd, None, "{choice:?}");
            window.click("Undo");
            assert!(window.plan().leg(&Id::new(&id)).is_none(), "one step: {choice:?}");
            assert!(!window.is_enabled("Undo"));
        }
    }
}

#[test]
fn a_leg_is_drawn_before_the_selected_one_when_that_is_chosen() {
    let mut window = window();
    window.click("TF side2");
    window.click("Draw legs (T)");
    choose(&mut window, "Where: behind side2", "before side2");
    assert!(window.shows("Draw legs before side2"));
    let at = free(&window);
    window.click_at(at);
    window.click_at(at + vec2(80.0, 0.0));
    let stage = window.plan().stage(&"circuit".into()).unwrap().clone();
    let ids: Vec<&str> = stage.legs.iter().map(|leg| leg.id.as_str()).collect();
    assert_eq!(ids, ["side1", "leg1", "leg2", "side2", "side3", "side4"]);
}

#[test]
fn a_double_click_ends_a_line() {
    let mut window = window();
    window.click("TF side4");
    window.press(Key::L);
    let at = free(&window);
    window.click_at(at);
    window.click_at(at + vec2(90.0, 10.0));
    window.click_at(at + vec2(150.0, 60.0));
    window.click_at(at + vec2(150.0, 60.0));
    let LegKind::Pattern(Pattern::Corridor { route, .. }) =
        window.plan().leg(&"corridor1".into()).unwrap().leg.kind.clone()
    else {
        panic!("no corridor")
    };
    assert_eq!(route.len(), 3, "{route:?}");
}

/// Corners from the first one of [`AREA`], screen points.
fn square(from: Vec2, side: f32) -> [Vec2; 4] {
    [vec2(0.0, 0.0), vec2(side, 0.0), vec2(side, side), vec2(0.0, side)].map(|corner| from + corner)
}

fn holes(window: &Window, scan: &str) -> Vec<usize> {
    match window.plan().leg(&Id::new(scan)).and_then(|context| context.leg.area().cloned()) {
        Some(Area::Polygon { holes, .. }) => holes.iter().map(Vec::len).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_hole_is_cut_into_an_area_dragged_and_filled_again() {
    let mut window = window();
    let at = free(&window);
    window.press(Key::A);
    for offset in figure(Shape::Area) {
        window.click_at(at + *offset * 1.4);
    }
    window.press(Key::Enter);
    let scan = window.selected();
    window.press(Key::Escape);
    window.press(Key::H);
    window.click_at(at - vec2(200.0, 0.0));
    assert!(window.shows("Begin the hole inside of an area"), "there is none");
    for corner in square(vec2(60.0, 40.0), 40.0) {
        window.click_at(at + corner);
    }
    // over the edge of the area: it is red, is said, and does not end
    let red = gcs_app::theme::palette(true).warning;
    window.harness.hover_at(at + vec2(-50.0, 60.0));
    window.steps(2);
    assert!(window.lines_within("Map", red) > 0 && window.shows("A hole crosses another outline"));
    window.click_at(at + vec2(-50.0, 60.0));
    window.press(Key::Enter);
    assert!(holes(&window, &scan).is_empty());
    window.press(Key::Backspace);
    window.click_at(at + square(vec2(60.0, 40.0), 40.0)[0]);
    assert_eq!(
        (window.selected(), holes(&window, &scan)),
        (scan.clone(), vec![4]),
        "the first one closes it"
    );
    window.until_analysed();
    assert!(!window.errors().iter().any(|error| error.contains("polygon")), "{:?}", window.errors());
    window.press(Key::Escape);
    let corner = |number: usize| format!("Corner {number} of hole 1 of {scan}");
    let from = window.centre(&corner(1));
    window.drag(from, vec2(10.0, 10.0));
    let to = from + vec2(10.0, 10.0);
    assert!(window.centre(&corner(1)).distance(to) < 1.5, "it is dragged as any corner");
    for left in [vec![3], vec![]] {
        window.click(&corner(1));
        window.press(Key::Delete);
        assert_eq!(holes(&window, &scan), left, "a hole with two corners is none");
    }
    for _ in 0..4 {
        window.press_ctrl(Key::Z);
    }
    assert!(holes(&window, &scan).is_empty(), "each was a step");
    assert!(window.plan().leg(&Id::new(&scan)).is_some());
}

#[test]
fn an_area_that_crosses_itself_is_said_to() {
    let mut window = window();
    window.press(Key::A);
    let at = free(&window);
    for offset in [vec2(0.0, 0.0), vec2(90.0, 90.0), vec2(90.0, 0.0)] {
        window.click_at(at + offset);
    }
    let red = gcs_app::theme::palette(true).warning;
    let drawn_to = |window: &mut Window, corner: Vec2| {
        window.harness.hover_at(at + corner);
        window.steps(2);
        (window.lines_within("Map", red) > 0, window.shows("crosses itself"))
    };
    assert_eq!(drawn_to(&mut window, vec2(130.0, -30.0)), (false, false));
    assert_eq!(drawn_to(&mut window, vec2(0.0, 90.0)), (true, true), "it is red, too");
    window.press(Key::Escape);
    assert!(!window.shows("crosses itself") && !window.is_enabled("Undo"));
}

/// Before it is in the plan: the words at the tool tell why, the figure that it is so.
#[test]
fn a_circle_that_is_too_tight_to_be_flown_is_red_while_it_is_drawn() {
    let red = gcs_app::theme::palette(true).warning;
    let mut window = window();
    window.press(Key::O);
    let at = free(&window);
    window.click_at(at);
    let mut drawn_to = |rim: Vec2| {
        window.harness.hover_at(at + rim);
        window.steps(3);
        (window.lines_within("Map", red), window.shows("It can't be flown so"))
    };
    assert_eq!(drawn_to(vec2(90.0, 0.0)), (0, false));
    let (lines, is_said) = drawn_to(vec2(6.0, 0.0));
    assert!(lines >= 2 && is_said, "the circle and its middle: {lines}");
    assert_eq!(drawn_to(vec2(90.0, 0.0)), (0, false), "one that is wider is as any other");
}

#[test]
fn fixes_runways_and_zones_are_drawn_on_the_map() {
    let mut window = window();
    let at = free(&window);
    window.press(Key::X);
    window.click_at(at);
    assert_eq!(window.selected(), "FIX1");
    window.press(Key::Z);
    for offset in figure(Shape::Area) {
        window.click_at(at + *offset * 0.5 + vec2(20.0, 20.0));
    }
    window.press(Key::Enter);
    assert_eq!(window.selected(), "keep-out-1");
    window.click("keep in");
    window.click("circle");
    window.click_at(at);
    window.click_at(at + vec2(200.0, 0.0));
    assert_eq!(window.selected(), "keep-in-1");
    // what is half drawn stays, whatever else could be drawn
    window.press(Key::Z);
    let corners = figure(Shape::Area).iter().map(|offset| at + *offset * 0.5 - vec2(300.0, 0.0));
    corners.for_each(|corner| window.click_at(corner));
    assert!(!window.shows("(Z: circle)") && !window.is_enabled("circle"));
    window.press(Key::Z);
    window.press(Key::Enter);
    let drawn = window.plan().zone(&window.selected().as_str().into()).unwrap().shape.clone();
    assert!(matches!(drawn, ZoneShape::Polygon(ref corners) if corners.len() == 4), "{drawn:?}");
    window.click("Undo");
    window.press(Key::Escape);
    window.press(Key::R);
    window.click_at(at + vec2(-20.0, 40.0));
    window.click_at(at + vec2(60.0, 40.0));
    let plan = window.plan();
    let (one, other) = (&plan.runways[1], &plan.runways[2]);
    assert_eq!((one.id.as_str(), other.id.as_str(), plan.runways.len()), ("R09", "R27", 3));
    assert!(one.elevation_amsl_m > 250.0, "it lies on the ground: {}", one.elevation_amsl_m);
    assert!(one.threshold.destination(90.0, one.length_m).distance_m(other.threshold) < 5.0);
    let kinds: Vec<ZoneKind> = plan.zones.iter().map(|zone| zone.kind).collect();
    assert_eq!(kinds, [ZoneKind::KeepOut, ZoneKind::KeepIn]);
    assert!(matches!(plan.zones[1].shape, ZoneShape::Circle { radius_m, .. } if radius_m > 100.0));
    for _ in 0..4 {
        window.click("Undo");
    }
    assert!(!window.is_enabled("Undo"), "four gestures, four steps");
}

fn corners(window: &Window) -> usize {
    match &window.plan().zones[0].shape {
        ZoneShape::Polygon(corners) => corners.len(),
        ZoneShape::Circle { .. } => 0,
    }
}

#[test]
fn corners_of_a_zone_are_moved_added_and_removed() {
    let mut window = window();
    let at = free(&window);
    window.press(Key::Z);
    for offset in figure(Shape::Area) {
        window.click_at(at + *offset);
    }
    window.press(Key::Enter);
    window.press(Key::V);
    let ghost = window.centre("New corner 2 of keep-out-1");
    window.drag(ghost, vec2(10.0, -40.0));
    assert_eq!(corners(&window), 5);
    let new = window.centre("Corner 2 of keep-out-1");
    assert!(new.distance(ghost + vec2(10.0, -40.0)) < 3.0, "it is where the pointer left it");
    window.click("Undo");
    assert_eq!(corners(&window), 4, "one step");
    window.click("Redo");
    window.click("Corner 2 of keep-out-1");
    window.press(Key::Delete);
    assert_eq!((corners(&window), window.plan().zones.len()), (4, 1));
    window.click("Corner 1 of keep-out-1");
    window.press(Key::Delete);
    window.click("Corner 1 of keep-out-1");
    window.press(Key::Delete);
    assert!(window.shows("at least 3 points") && corners(&window) == 3);
}

#[test]
fn the_middle_of_a_leg_is_dragged_to_become_a_leg() {
    let mut window = window();
    let middle = window.centre("New leg before side3");
    window.drag(middle, vec2(50.0, 30.0));
    let stage = window.plan().stage(&"circuit".into()).unwrap().clone();
    let ids: Vec<&str> = stage.legs.iter().map(|leg| leg.id.as_str()).collect();
    assert_eq!(ids, ["side1", "side2", "leg1", "side3", "side4"]);
    assert!(window.centre("Waypoint leg1").distance(middle + vec2(50.0, 30.0)) < 3.0);
    assert!(matches!(stage.legs[2].place(), Some(Place::Position(_))));
    window.click("Undo");
    assert_eq!(window.plan().stage(&"circuit".into()).unwrap().legs.len(), 4, "one step");
}

/// As an area is, until a circle is asked for: by its key, or a click, also when its first place is clicked.
#[test]
fn four_clicks_around_a_village_are_an_outline_and_the_key_makes_it_a_circle() {
    let mut window = window();
    let at = free(&window);
    let clicks = |window: &mut Window, count: usize| {
        figure(Shape::Area).iter().take(count).for_each(|by| window.click_at(at + *by));
    };
    let shape = |window: &Window| window.plan().zones.last().map(|zone| zone.shape.clone());
    window.press(Key::Z);
    assert!(
        window.shows(
            "Keep-out zone (Z: circle): click the corners; the first, Enter or a double click closes it"
        )
    );
    clicks(&mut window, 4);
    assert!(window.shows("outline") && window.shows("circle"), "the choice stays while it is drawn");
    clicks(&mut window, 1);
    assert!(matches!(shape(&window), Some(ZoneShape::Polygon(corners)) if corners.len() == 4));
    // no double click
    window.steps(30);
    clicks(&mut window, 1);
    window.press(Key::Z);
    assert!(window.shows("Keep-out zone (Z: outline): click the rim"), "about the place clicked");
    window.click_at(at + figure(Shape::Area)[0] + vec2(60.0, 0.0));
    assert!(matches!(shape(&window), Some(ZoneShape::Circle { .. })));
    window.press(Key::V);
    window.press(Key::Z);
    assert!(window.shows("Keep-out zone (Z: circle)"), "the next one begins as an outline");
}

#[test]
fn a_zone_is_selected_by_its_edge() {
    let mut window = window();
    let at = free(&window);
    window.press(Key::Z);
    window.click("circle");
    window.click_at(at + vec2(60.0, 0.0));
    window.click_at(at + vec2(120.0, 0.0));
    window.press(Key::Escape);
    window.press(Key::Escape);
    assert_eq!(window.selected(), "");
    window.click_at(at + vec2(60.0, 60.0));
    assert_eq!(window.selected(), "keep-out-1");
    let rim = window.centre("Radius of keep-out-1");
    window.drag(rim, vec2(30.0, 0.0));
    assert!(matches!(window.plan().zones[0].shape, ZoneShape::Circle { .. }));
    assert!(window.centre("Radius of keep-out-1").distance(rim + vec2(30.0, 0.0)) < 3.0);
}

#[test]
fn a_click_on_what_covers_the_map_is_explained() {
    let (mut window, _) = super::flying::flying();
    let missing = super::reach::Missing("/nowhere/missing.xml".into());
    window.harness.input_mut().dropped_files.push(std::sync::Arc::new(missing));
    window.until("notice", |app| app.view().notice.is_some());
    window.press(Key::T);
    window.harness.hover_at(window.centre("Close this message"));
    window.steps(2);
    assert!(window.shows("The map is covered where the pointer is"));
    window.harness.hover_at(window.centre("Map"));
    window.steps(2);
    assert!(!window.shows("The map is covered"));
}

/// Who draws a plan by hand closes the card of the new mission first.
#[test]
fn a_tool_without_a_stage_to_draw_into_says_how_to_get_one() {
    let mut window = Window::open(super::creating::EMPTY);
    window.steps(3);
    window.press(Key::Escape);
    for key in [Key::T, Key::O] {
        window.press(key);
        assert!(
            window.shows(": add a stage first, with the + of Main plan in the tree, or make a new mission"),
            "{key:?}"
        );
    }
    window.add_to("main plan", "Mission stage");
    let at = window.centre("Map");
    window.press(Key::T);
    window.click_at(at);
    assert_eq!(window.plan().all_legs().len(), 1);
}

/// Who chose a kind there planned a leg behind it, and the choices moved when that leg went into the ground.
#[test]
fn choices_of_a_tool_take_clicks_and_nothing_is_drawn_behind_them() {
    let mut window = window();
    window.click("TF side4");
    window.press(Key::T);
    let at = free(&window);
    window.harness.hover_at(at);
    window.steps(3);
    assert!(window.paints("° · "), "the leg to the pointer");
    let before = window.plan();
    let status = window.harness.get_by_label_contains("Draw legs behind side4").rect();
    let kind = window.harness.get_all_by_label_contains("Kind: ").next().unwrap().rect();
    assert!(kind.bottom() <= status.top(), "more words move no choice");
    for over in [kind.center(), kind.left_bottom() + vec2(2.0, -2.0)] {
        window.harness.hover_at(over);
        window.steps(3);
        assert!(!window.paints("° · "), "{over}");
        window.click_at(over);
        assert_eq!(window.plan(), before, "{over}");
    }
}

/// They were swallowed without a word.
#[test]
fn clicks_on_what_a_tool_says_are_for_the_map_behind_it() {
    let mut window = window();
    window.click("TF side4");
    window.press(Key::T);
    let status = window.harness.get_by_label_contains("Draw legs behind side4").rect();
    window.harness.hover_at(status.center());
    window.steps(3);
    let legs = window.plan().all_legs().len();
    window.click_at(status.center());
    assert_eq!(window.plan().all_legs().len(), legs + 1);
}

/// A corner of a zone that is drawn to the centre line lies in the final; a leg there is on it.
#[test]
fn a_zone_keeps_off_the_centre_line_that_legs_are_drawn_to() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    let is_on_line = |window: &mut Window, tool: Key| {
        window.press(tool);
        let runway = window.plan().runways[0].clone();
        let [fix, other] = ["A", "C"].map(|fix| window.plan().fix(&fix.into()).unwrap().position);
        let [at, to] = ["Fix A", "Fix C"].map(|fix| window.centre(fix));
        let before = runway.threshold.destination(runway.heading_deg + 180.0, 1500.0);
        let share = vec2(
            ((before.lon_deg - fix.lon_deg) / (other.lon_deg - fix.lon_deg)) as f32,
            ((before.lat_deg - fix.lat_deg) / (other.lat_deg - fix.lat_deg)) as f32,
        );
        window.harness.hover_at(at + (to - at) * share + vec2(0.0, 4.0));
        window.steps(3);
        window.paints("centre line of R05")
    };
    assert!(is_on_line(&mut window, Key::T));
    let pointer = window.harness.ctx.pointer_hover_pos().unwrap();
    window.click_at(pointer);
    let leg = window.plan().leg(&"leg1".into()).unwrap().leg.clone();
    let Some(Place::Position(flight_plan::Value::Constant(at))) = leg.place() else {
        panic!("no place: {leg:?}")
    };
    assert_eq!(flight_plan::figures::place(*at), *at, "with no more digits than others");
    assert!(!is_on_line(&mut window, Key::Z));
}

/// Rule 5: a new leg flies as high as those beside it, whatever its stage says.
#[test]
fn a_new_leg_has_the_altitude_of_its_neighbours() {
    let altitude =
        |window: &Window, leg: &str| window.plan().leg(&Id::new(leg)).unwrap().leg.altitude.clone();
    let mut low = SQUARE.to_owned();
    for leg in [r#"id="side2" fix="B""#, r#"id="side3" fix="C""#] {
        low = low.replace(leg, &format!(r#"{leg} altitude="130" altitudeReference="home""#));
    }
    for (plan, own) in [(low.as_str(), true), (SQUARE, false)] {
        let mut window = Window::open(plan);
        window.until_analysed();
        window.click("TF side2");
        window.press(Key::T);
        let at = window.centre("Map") + vec2(60.0, 40.0);
        window.click_at(at);
        window.press(Key::V);
        assert_eq!(altitude(&window, "leg1"), altitude(&window, "side2"), "drawn");
        assert_eq!(altitude(&window, "leg1").is_some(), own);
        window.click("TF leg1");
        assert_eq!(window.shows("from circuit"), !own, "what it inherits it shows as inherited");
        let middle = window.centre("Fix B") + (window.centre("Waypoint leg1") - window.centre("Fix B")) * 0.5;
        window.drag(middle, vec2(10.0, -20.0));
        assert_eq!(
            altitude(&window, &window.selected()),
            altitude(&window, "side2"),
            "dragged out of the line"
        );
        assert_ne!(window.selected(), "leg1");
    }
}

#[test]
fn no_length_is_told_where_the_pointer_has_just_clicked() {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window.press(Key::A);
    let at = window.centre("Map") + vec2(60.0, 60.0);
    window.tap_at(at);
    window.harness.hover_at(at);
    window.steps(2);
    assert!(!window.paints("0 m ·"));
    window.harness.hover_at(at + vec2(80.0, 0.0));
    window.steps(2);
    assert!(window.paints("m · 0"), "the track of its first edge");
}

/// Only when two corners were there already it said how the area is closed.
#[test]
fn tools_say_from_the_first_click_on_how_an_area_or_a_line_is_ended() {
    let mut window = window();
    let at = free(&window);
    for (key, ends) in
        [(Key::A, "closes it"), (Key::L, "a double click ends"), (Key::T, "a double click ends")]
    {
        window.press(key);
        // the first leg is drawn by one click
        assert!(key == Key::T || window.shows(ends), "{key:?}");
        for by in figure(Shape::Area).iter().take(2) {
            window.click_at(at + *by);
            window.harness.hover_at(window.centre("Zoom in"));
            window.steps(40);
            assert!(window.shows(ends), "{key:?}");
        }
        window.press(Key::Escape);
        window.press(Key::Escape);
    }
}
