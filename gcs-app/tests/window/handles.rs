//! The numbers of a leg by their handles on the map, and several legs as one.

use super::drawing::choose;
use super::{SQUARE, Window};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, Vec2, vec2};
use flight_plan::create::LegChoice;
use flight_plan::{
    FlightPlan, Id, LegKind, Pattern, Place, ScanEntry, TurnDirection, Value, ZoneShape, transform,
};
use gcs_app::command::Selection;
use geometry::LatLon;

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// A window in which a leg of a kind was drawn, and the leg.
fn with(tool: Key, figure: &[Vec2], choice: LegChoice) -> (Window, Id) {
    let mut window = window();
    window.click("TF side4");
    window.press(tool);
    choose(&mut window, "Kind: ", &choice.name());
    let at = window.centre("Map") + vec2(60.0, 40.0);
    figure.iter().for_each(|offset| window.click_at(at + *offset));
    if figure.len() > 2 {
        window.press(Key::Enter);
    }
    window.press(Key::V);
    let made = Id::new(&window.selected());
    assert_eq!(LegChoice::of(&window.plan().leg(&made).unwrap().leg.kind), choice);
    (window, made)
}

fn number(window: &Window, leg: &Id, name: &str) -> Option<f64> {
    let plan = window.plan();
    let numbers = plan.leg(leg).unwrap().leg.numbers();
    match numbers.into_iter().find(|(known, _)| *known == name)?.1 {
        Some(Value::Constant(number)) => Some(*number),
        _ => None,
    }
}

const CIRCLE: [Vec2; 2] = [vec2(0.0, 0.0), vec2(90.0, 0.0)];
const LINE: [Vec2; 3] = [vec2(0.0, 0.0), vec2(150.0, 0.0), vec2(150.0, 60.0)];
const AREA: [Vec2; 4] = [vec2(0.0, 0.0), vec2(150.0, 0.0), vec2(150.0, 100.0), vec2(0.0, 100.0)];

/// A tool, what is drawn with it, what that becomes, and its handles with their numbers.
type Case = (Key, &'static [Vec2], LegChoice, &'static [(&'static str, &'static str)]);

#[test]
fn every_handle_sets_its_number_in_one_step_and_no_altitude() {
    let cases: [Case; 12] = [
        (
            Key::A,
            &AREA,
            LegChoice::Scan,
            &[("Heading", "heading"), ("Spacing", "spacing"), ("Overshoot", "overshoot")],
        ),
        (Key::A, &AREA, LegChoice::Contour, &[("Spacing", "spacing")]),
        (Key::L, &LINE, LegChoice::Corridor, &[("Width", "width"), ("Spacing", "spacing")]),
        (Key::L, &LINE, LegChoice::TrackLine, &[("Spacing", "spacing")]),
        (Key::O, &CIRCLE, LegChoice::Spiral, &[("Inner radius", "innerRadius"), ("Spacing", "spacing")]),
        (Key::O, &CIRCLE, LegChoice::ExpandingSquare, &[("Heading", "heading"), ("Spacing", "spacing")]),
        (Key::O, &CIRCLE, LegChoice::Sector, &[("Heading", "heading"), ("Radius", "radius")]),
        (Key::O, &CIRCLE, LegChoice::FigureEight, &[("Heading", "heading"), ("Turns", "turns")]),
        (Key::O, &CIRCLE, LegChoice::Orbit, &[("Turns", "turns"), ("Radius", "radius")]),
        (Key::T, &CIRCLE[..1], LegChoice::Hm, &[("Length", "length"), ("Course", "course")]),
        (Key::T, &CIRCLE[..1], LegChoice::Cf, &[("Course", "course")]),
        (Key::T, &CIRCLE[..1], LegChoice::Fa, &[("Course", "course")]),
    ];
    for (tool, figure, choice, handles) in cases {
        let (mut window, leg) = with(tool, figure, choice);
        for (name, attribute) in handles {
            let handle = format!("{name} of {leg}");
            let altitude = window.plan().leg(&leg).unwrap().leg.altitude.clone();
            let before = number(&window, &leg, attribute);
            let at = window.centre(&handle);
            window.drag(at, vec2(13.0, 17.0));
            let after = number(&window, &leg, attribute);
            assert!(after.is_some() && after != before, "{handle}: {before:?}, {after:?}");
            assert_eq!(window.plan().leg(&leg).unwrap().leg.altitude, altitude);
            window.click("Undo");
            assert_eq!(number(&window, &leg, attribute), before, "one step: {handle}");
        }
    }
}

#[test]
fn a_handle_is_where_its_number_says() {
    let (mut window, leg) = with(Key::O, &CIRCLE, LegChoice::Sector);
    let handle = format!("Heading of {leg}");
    let before = number(&window, &leg, "heading").unwrap();
    for by in [vec2(30.0, 40.0), vec2(-60.0, 20.0)] {
        let at = window.centre(&handle);
        window.drag(at, by);
        let heading = number(&window, &leg, "heading").unwrap();
        let way = window.centre(&handle) - window.centre(&format!("Centre of {leg}"));
        let shown = f64::from(way.x.atan2(-way.y).to_degrees()).rem_euclid(360.0);
        assert!(heading != before && (shown - heading).abs() < 1.5, "{shown} {heading}");
    }
}

fn route(window: &Window, leg: &Id) -> Vec<Place> {
    match window.plan().leg(leg).unwrap().leg.kind.clone() {
        LegKind::Pattern(Pattern::Corridor { route, .. } | Pattern::TrackLine { route, .. }) => route,
        other => panic!("{other:?} has no line"),
    }
}

#[test]
fn a_line_gets_and_loses_corners_after_it_was_drawn() {
    for choice in [LegChoice::Corridor, LegChoice::TrackLine] {
        let (mut window, leg) = with(Key::L, &LINE, choice);
        let corner = |number: usize| format!("Corner {number} of {leg}");
        let drawn = route(&window, &leg);
        let mark = window.centre(&format!("New corner 2 of {leg}"));
        let by = vec2(10.0, -40.0);
        window.drag(mark, by);
        let bent = route(&window, &leg);
        assert_eq!((bent.len(), &bent[..1], &bent[2..]), (4, &drawn[..1], &drawn[1..]), "{choice:?}");
        assert!(window.centre(&corner(2)).distance(mark + by) < 3.0, "it is where the pointer left it");
        window.click("Undo");
        assert_eq!(route(&window, &leg), drawn, "one step");
        window.click("Redo");
        window.click(&corner(2));
        window.press(Key::Delete);
        assert_eq!(route(&window, &leg), drawn, "and straight again");
    }
}

/// Of a line that is not selected it moves all: that is how a line is put elsewhere.
#[test]
fn the_first_point_of_a_selected_line_is_a_corner_like_the_others() {
    let (mut window, leg) = with(Key::L, &LINE, LegChoice::Corridor);
    let first = format!("Waypoint {leg}");
    let drawn = route(&window, &leg);
    let at = window.centre(&first);
    window.drag(at, vec2(-20.0, 30.0));
    let bent = route(&window, &leg);
    assert!(bent[0] != drawn[0] && bent[1..] == drawn[1..], "{bent:?}");
    assert!(window.centre(&first).distance(at + vec2(-20.0, 30.0)) < 3.0);
    window.click(&first);
    window.press(Key::Delete);
    assert_eq!(route(&window, &leg), drawn[1..]);
    window.click(&first);
    window.press(Key::Delete);
    assert!(window.shows("A line has at least 2 points") && route(&window, &leg).len() == 2);
    window.click("TF side4");
    let at = window.centre(&first);
    window.drag(at, vec2(30.0, 20.0));
    assert!(route(&window, &leg).iter().zip(&drawn[1..]).all(|(now, was)| now != was), "all of it");
}

#[test]
fn a_click_on_a_corner_begins_a_scan_there() {
    let (mut window, leg) = with(Key::A, &AREA, LegChoice::Scan);
    let entry = |window: &Window| match &window.plan().leg(&leg).unwrap().leg.kind {
        LegKind::Scan(scan) => scan.entry,
        _ => panic!("no scan"),
    };
    let mark = format!("Begin {leg} at its right end");
    window.click(&mark);
    assert_eq!(entry(&window), ScanEntry::EndRight);
    window.click(&mark);
    assert_eq!(entry(&window), ScanEntry::Nearest);
    window.click("Undo");
    assert_eq!(entry(&window), ScanEntry::EndRight);
}

#[test]
fn a_holding_changes_its_side_and_an_arc_its_centre() {
    let (mut window, leg) = with(Key::T, &CIRCLE[..1], LegChoice::Hf);
    let mark = format!("Put the holding {leg} on this side");
    let right = window.centre(&mark);
    window.click(&mark);
    let LegKind::Hf(holding) = window.plan().leg(&leg).unwrap().leg.kind.clone() else { panic!("no hold") };
    assert_eq!(holding.turn, TurnDirection::Left);
    assert!(window.centre(&mark).distance(right) > 10.0, "the mark is on the other side");
    let (mut window, leg) = with(Key::T, &CIRCLE[..1], LegChoice::Rf);
    let at = window.centre(&format!("Centre of the arc {leg}"));
    window.drag(at, vec2(20.0, 12.0));
    assert!(window.centre(&format!("Centre of the arc {leg}")).distance(at + vec2(20.0, 12.0)) < 2.0);
}

#[test]
fn every_pattern_that_turns_is_turned_the_other_way_by_a_click() {
    let cases: [(Key, &[Vec2], LegChoice); 6] = [
        (Key::O, &CIRCLE, LegChoice::Orbit),
        (Key::O, &CIRCLE, LegChoice::Spiral),
        (Key::O, &CIRCLE, LegChoice::ExpandingSquare),
        (Key::O, &CIRCLE, LegChoice::Sector),
        (Key::O, &CIRCLE, LegChoice::FigureEight),
        (Key::A, &AREA, LegChoice::Contour),
    ];
    for (tool, figure, choice) in cases {
        let (mut window, leg) = with(tool, figure, choice);
        let kind = |window: &Window| format!("{:?}", window.plan().leg(&leg).unwrap().leg.kind);
        let before = kind(&window);
        let (from, to) = if before.contains("turn: Right") { ("Right", "Left") } else { ("Left", "Right") };
        window.click(&format!("Turn {leg} the other way"));
        assert_eq!(kind(&window), before.replace(&format!("turn: {from}"), &format!("turn: {to}")));
        window.click("Undo");
        assert_eq!(kind(&window), before, "one step");
    }
}

/// Drags with Shift.
pub fn sweep(window: &mut Window, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::SHIFT,
    };
    window.harness.key_down_modifiers(Modifiers::SHIFT, Key::F12);
    window.harness.hover_at(from);
    window.harness.event_modifiers(button(from, true), Modifiers::SHIFT);
    window.steps(1);
    for part in 1..=4 {
        let pos = from + (to - from) * (part as f32 / 4.0);
        window.harness.event_modifiers(Event::PointerMoved(pos), Modifiers::SHIFT);
        window.steps(1);
    }
    window.harness.event_modifiers(button(to, false), Modifiers::SHIFT);
    window.steps(1);
    window.harness.key_up(Key::F12);
    window.steps(3);
}

/// Three waypoints of their own, all selected.
fn group() -> (Window, Vec<Id>) {
    let mut window = window();
    window.click("TF side4");
    window.press(Key::T);
    let at = window.centre("Map") + vec2(60.0, 40.0);
    for offset in [vec2(0.0, 0.0), vec2(80.0, 10.0), vec2(40.0, 70.0)] {
        window.click_at(at + offset);
    }
    window.press(Key::V);
    window.press(Key::Escape);
    sweep(&mut window, at - vec2(30.0, 30.0), at + vec2(120.0, 100.0));
    let legs = ["leg1", "leg2", "leg3"].map(Id::new).to_vec();
    let also = &window.app().view().also;
    assert_eq!((window.selected().as_str(), also.len()), ("leg1", 2), "{also:?}");
    (window, legs)
}

fn places(window: &Window, legs: &[Id]) -> Vec<LatLon> {
    let plan = window.plan();
    legs.iter().flat_map(|id| transform::places(&plan, plan.leg(id).unwrap().leg)).collect()
}

#[test]
fn what_is_drawn_around_with_shift_moves_as_one() {
    let (mut window, legs) = group();
    let before = places(&window, &legs);
    let grip = window.centre("Move what is selected");
    window.drag(grip, vec2(40.0, -30.0));
    let after = places(&window, &legs);
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        let (was, is) = (before[a].distance_m(before[b]), after[a].distance_m(after[b]));
        assert!((was - is).abs() < 0.5 && before[a].distance_m(after[a]) > 10.0, "{was} {is}");
    }
    assert!(window.centre("Move what is selected").distance(grip + vec2(40.0, -30.0)) < 3.0);
    window.click("Undo");
    assert_eq!(places(&window, &legs), before, "one step");
}

#[test]
fn a_set_turns_and_scales_by_its_handles() {
    let (mut window, legs) = group();
    let before = places(&window, &legs);
    let grip = window.centre("Scale what is selected");
    window.drag(grip, vec2(60.0, 50.0));
    let larger = places(&window, &legs);
    let ratio = |a: usize, b: usize| larger[a].distance_m(larger[b]) / before[a].distance_m(before[b]);
    assert!(ratio(0, 1) > 1.2 && (ratio(0, 1) - ratio(1, 2)).abs() < 1e-3);
    window.click("Undo");
    let grip = window.centre("Turn what is selected");
    window.drag(grip, vec2(90.0, 60.0));
    let turned = places(&window, &legs);
    let by = |a: usize, b: usize| {
        (turned[a].bearing_deg(turned[b]) - before[a].bearing_deg(before[b])).rem_euclid(360.0)
    };
    assert!(by(0, 1) > 30.0 && (by(0, 1) - by(1, 2)).abs() < 0.05, "{} {}", by(0, 1), by(1, 2));
    window.click("Undo");
    assert_eq!(places(&window, &legs), before);
}

#[test]
fn a_click_with_shift_adds_a_leg_and_takes_it_out() {
    let (mut window, _) = group();
    let at = window.centre("Waypoint leg2");
    let button = |pressed| Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::SHIFT,
    };
    window.harness.hover_at(at);
    window.steps(1);
    for pressed in [true, false] {
        window.harness.event_modifiers(button(pressed), Modifiers::SHIFT);
        window.steps(1);
    }
    window.steps(2);
    assert_eq!(window.app().view().also.len(), 1);
    assert!(!window.app().view().also.contains(&Selection::Leg("leg2".into())));
}

/// A zone is its inside, too: one click selects it, one drag moves all of it, and the map stays.
#[test]
fn a_zone_is_selected_by_a_click_inside_and_moved_by_a_drag_there() {
    let zone = r#"<zones><keepOut id="quarry" lat="36.345" lon="-84.215" radius="1500"/></zones><mainPlan"#;
    let mut window = Window::open(&SQUARE.replacen("<mainPlan", zone, 1));
    window.until_analysed();
    let [fix, other] = ["Fix A", "Fix C"].map(|fix| window.centre(fix));
    // in degrees from Fix A, eastwards and northwards
    let per_deg = (other - fix) / vec2(-0.018402, -0.021926);
    // its own handles are in its middle and at its rim
    let inside = fix + per_deg * vec2(-0.055164, 0.017678) + vec2(0.0, 28.0);
    window.click_at(inside);
    assert_eq!(window.selected(), "quarry");
    let before = window.plan();
    window.harness.hover_at(inside);
    window.harness.drag_at(inside);
    window.steps(90);
    window.harness.drop_at(inside);
    window.steps(3);
    assert!(
        window.plan() == before && !window.shows("Moved the selected zone"),
        "it was only pressed for long"
    );
    window.drag(inside, vec2(20.0, 15.0));
    let shape = |plan: &FlightPlan| match plan.zone(&"quarry".into()).unwrap().shape {
        ZoneShape::Circle { centre, radius_m } => (centre, radius_m),
        ZoneShape::Polygon(_) => panic!("it was a circle"),
    };
    let ((from, radius_m), (to, same_m)) = (shape(&before), shape(&window.plan()));
    assert!(from.distance_m(to) > 50.0 && same_m == radius_m, "{from:?} {to:?}");
    assert!(window.centre("Fix A").distance(fix) < 1.0, "the map stays");
    assert!(window.shows("Moved the selected zone. Ctrl+Z takes it back."));
    assert_eq!(window.app().view().notice, None, "it goes by itself");
    window.click("Undo");
    assert_eq!(window.plan(), before, "one step");
    // beside it nothing is selected
    window.click_at(inside + vec2(0.0, 1.5 * per_deg.y.abs() * 1500.0 / 111_000.0));
    assert_eq!(window.selected(), "");
}
