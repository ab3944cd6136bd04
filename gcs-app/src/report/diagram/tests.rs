use super::*;
use crate::headless::wind::Air;
use crate::headless::{Source, forecast};
use crate::report::canvas::count;
use flight_exec::rehearse::Scenario;
use std::path::Path;
use std::sync::Arc;

fn fragment(name: &str) -> (Arc<Program>, Preview) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/docs/fragments").join(name);
    let loaded = Source { file, ..Source::default() }.load().unwrap();
    let (program, profile) = loaded.compile().unwrap();
    let (terrain, air, scenario) = (&loaded.terrain, Air::default(), &Scenario::default());
    let ahead = forecast::Ahead { program: &program, profile, terrain, air, scenario };
    let preview = ahead.fly().unwrap();
    (program, preview)
}

#[test]
fn what_is_flown_backwards_has_its_own_colour_and_legend() {
    let (program, preview) = fragment("iterative-reverse.xml");
    let of_stage = png(&program, &preview, Some(&Id::new("demo"))).unwrap();
    assert!(count(&of_stage, FORTH) > 300, "the path is drawn");
    assert!(count(&of_stage, BACK) > 300, "the way back is drawn");
    let whole = png(&program, &preview, None).unwrap();
    assert_ne!(of_stage, whole, "the stage fills the picture");
    assert_eq!(of_stage, png(&program, &preview, Some(&Id::new("demo"))).unwrap(), "always the same bytes");
}

/// The map of a preview draws them, too: how far the path is from its line is seen there.
#[test]
fn what_is_flown_along_or_around_is_a_route() {
    let routes = |name: &str| {
        let (program, preview) = fragment(name);
        assemble::routes(&program, &forecast::track(&preview, &[program.flown()]))
    };
    let line = routes("track-line.xml");
    assert!(line.len() == 1 && line[0].len() > 2 && line[0].first() != line[0].last(), "{line:?}");
    assert_eq!(routes("corridor.xml").len(), 1);
    assert!(routes("scan.xml").is_empty());
}

#[test]
fn a_stage_that_is_not_flown_is_refused() {
    let (program, preview) = fragment("iterative-reverse.xml");
    assert!(png(&program, &preview, Some(&Id::new("elsewhere"))).is_err());
}

#[test]
fn arrow_heads_come_at_even_distances_over_pieces() {
    let mut canvas = Canvas::new(10, 10, DIAGRAM_PAPER).unwrap();
    let line = |from: f32, to: f32| -> Vec<(f32, f32)> { vec![(from, 0.0), (to, 0.0)] };
    let left = arrows(&mut canvas, &line(0.0, 70.0), 0.0, FORTH);
    assert_eq!(left, 70.0, "none yet");
    assert_eq!(arrows(&mut canvas, &line(70.0, 130.0), left, FORTH), 0.0, "one at the end");
}
