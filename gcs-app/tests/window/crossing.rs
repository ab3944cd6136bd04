//! An outline that is dragged so that it crosses itself: red at once, before anything is checked.

use super::waiting::over_held_ground;
use egui::vec2;

const SQUARE: &str = super::SQUARE;
const CORNERS: [(f64, f64); 4] = [(36.335, -84.19), (36.335, -84.15), (36.315, -84.15), (36.315, -84.19)];

fn corners(tag: &str) -> String {
    CORNERS.map(|(lat, lon)| format!(r#"<{tag} lat="{lat}" lon="{lon}"/>"#)).concat()
}

/// A zone, and an area that is scanned.
fn plans() -> [(String, &'static str, &'static str); 2] {
    let zone = format!(r#"<zones><keepOut id="field">{}</keepOut></zones><mainPlan"#, corners("corner"));
    let scan = format!(r#"<scan id="field" spacing="400"><area>{}</area></scan>"#, corners("corner"));
    [
        (SQUARE.replacen("<mainPlan", &zone, 1), "OUT field", "Corner 2 of field"),
        (SQUARE.replace(r#"<TF id="side3" fix="C"/>"#, &scan), "SCAN field", "Corner 2 of field"),
    ]
}

#[test]
fn a_corner_that_is_dragged_across_the_outline_makes_it_red_while_it_is_dragged_and_afterwards() {
    const WORDS: &str = "The outline crosses itself";
    let red = gcs_app::theme::palette(true).warning;
    for (plan, row, corner) in plans() {
        let (mut window, _gate) = over_held_ground(&plan);
        window.steps(10);
        window.harness.set_size(vec2(1280.0, 1200.0));
        window.steps(3);
        window.select_row((row, 0));
        window.steps(3);
        let before = window.plan();
        assert!(!window.paints(WORDS), "{row}");
        let lines = window.lines_within("Map", red);
        let from = window.centre(corner);
        // beyond the opposite edge
        let [a, b] = ["Corner 3 of field", "Corner 4 of field"].map(|corner| window.centre(corner));
        let to = a.lerp(b, 0.5) + vec2(0.0, 40.0);
        window.harness.hover_at(from);
        window.harness.drag_at(from);
        for part in 1..=5 {
            window.harness.hover_at(from + (to - from) * (part as f32 / 5.0));
            window.harness.run_steps(1);
        }
        window.harness.run_steps(2);
        assert_ne!(window.plan(), before, "{row}: it is dragged");
        assert_eq!(window.colour_of(WORDS), Some(red), "{row}: while it is dragged");
        assert!(window.lines_within("Map", red) > lines, "{row}");
        window.harness.drop_at(to);
        window.harness.run_steps(4);
        assert!(!window.app().analysis().reviewed, "{row}: the ground is held fast");
        assert_eq!(window.colour_of(WORDS), Some(red), "{row}: it stays, with what is wrong");
        window.press_ctrl(egui::Key::Z);
        assert!(window.plan() == before && !window.paints(WORDS), "{row}: one step");
    }
}

/// A variable takes no such value: its corner stays where it was last possible, and it is said why.
#[test]
fn a_corner_of_a_variable_stays_where_the_outline_does_not_cross_itself() {
    let said = CORNERS.map(|(lat, lon)| format!("{lat} {lon}")).join(", ");
    let variable = format!(
        r#"<variables><variable name="field" type="polygon" initial="{said}"/></variables><mainPlan"#
    );
    let (mut window, _gate) = over_held_ground(&SQUARE.replacen("<mainPlan", &variable, 1));
    window.steps(10);
    window.harness.set_size(vec2(1280.0, 1200.0));
    window.steps(3);
    window.select_row(("VAR field", 0));
    window.steps(3);
    let from = window.centre("Corner 2 of field");
    let [a, b] = ["Corner 3 of field", "Corner 4 of field"].map(|corner| window.centre(corner));
    window.drag(from, a.lerp(b, 0.5) + vec2(0.0, 40.0) - from);
    let corner = window.centre("Corner 2 of field");
    assert!(corner.y > from.y && corner.y < a.y, "{corner} above {a}");
    let notice = window.app().view().notice.clone().unwrap_or_default();
    assert!(notice.contains("cross"), "{notice:?}");
}
