//! The map itself: moving about it, and the maps and elevations that users bring.

use super::dock::Memory;
use super::reach::Missing as Dropped;
use super::{PATIENCE, SQUARE, Window};
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, MouseWheelUnit, Pos2, TouchPhase, vec2};
use egui_kittest::kittest::Queryable;
use gcs_app::layers::Layer;
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// Turns the wheel by some notches, and waits until the map stands still.
pub fn wheel(window: &mut Window, at: Pos2, notches: f32) {
    window.harness.hover_at(at);
    window.steps(1);
    window.harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Line,
        delta: vec2(0.0, notches),
        phase: TouchPhase::Move,
        source: egui::MouseWheelSource::Wheel,
        modifiers: Modifiers::NONE,
    });
    window.steps(40);
}

#[test]
fn the_wheel_zooms_in_small_steps_around_the_pointer() {
    let mut window = window();
    let (a, b) = (window.centre("Fix A"), window.centre("Fix B"));
    let apart = a.distance(b);
    wheel(&mut window, a, 1.0);
    assert!(window.centre("Fix A").distance(a) < 1.5, "{a} {}", window.centre("Fix A"));
    let step = window.centre("Fix A").distance(window.centre("Fix B")) / apart;
    assert!((1.1..1.3).contains(&step), "a notch: {step}");
    wheel(&mut window, a, -2.0);
    assert!(window.centre("Fix A").distance(a) < 1.5);
    assert!(window.centre("Fix A").distance(window.centre("Fix B")) < apart * 0.95);
}

#[test]
fn keys_zoom_and_pan_the_map() {
    let mut window = window();
    let (a, b) = (window.centre("Fix A"), window.centre("Fix B"));
    window.press(Key::Minus);
    let apart = window.centre("Fix A").distance(window.centre("Fix B"));
    assert!((apart / a.distance(b) - 0.5f32.sqrt()).abs() < 0.02);
    window.press(Key::Plus);
    assert!(window.centre("Fix A").distance(a) < 1.0);
    window.press(Key::ArrowRight);
    assert!((window.centre("Fix A") - a).x < -50.0, "the map moves under the view");
}

#[test]
fn the_aircraft_is_followed_while_zooming_and_left_by_panning() {
    let mut window = window();
    window.connect();
    window.click("Follow the aircraft");
    assert!(window.app().view().follow);
    let middle = window.centre("Map");
    let away = window.centre("Fix D") - middle;
    wheel(&mut window, middle + vec2(150.0, 100.0), -1.0);
    assert!(window.app().view().follow);
    let zoomed = window.centre("Fix D") - middle;
    assert!((zoomed - away * (-0.25f32).exp2()).length() < 2.0, "around the aircraft: {away} {zoomed}");
    window.click("Zoom out");
    assert!(window.app().view().follow);
    window.press(Key::ArrowLeft);
    assert!(!window.app().view().follow);
}

#[test]
fn a_double_click_does_not_move_the_map() {
    let mut window = window();
    let a = window.centre("Fix A");
    let at = window.centre("Map") + vec2(40.0, 120.0);
    window.click_at(at);
    window.click_at(at);
    window.steps(20);
    assert!(window.centre("Fix A").distance(a) < 0.5);
}

pub fn drop_file(window: &mut Window, path: &Path) {
    window.harness.input_mut().dropped_files.push(Arc::new(Dropped(path.to_owned())));
    window.steps(2);
}

/// An HGT tile of 3″ where all ground is as high as this.
fn hgt(height_m: i16) -> Vec<u8> {
    height_m.to_be_bytes().repeat(1201 * 1201)
}

/// The map of the whole world as one tile.
pub fn world(path: &Path) {
    let database = rusqlite::Connection::open(path).unwrap();
    let tables = "CREATE TABLE metadata (name TEXT, value TEXT);
        CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB);
        INSERT INTO metadata VALUES ('maxzoom', '0'), ('attribution', 'Somebody'), ('bounds', '-170,-80,170,80');";
    database.execute_batch(tables).unwrap();
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::from_pixel(64, 64, image::Rgba([90, 0, 200, 255]))
        .write_to(&mut png, image::ImageFormat::Png)
        .unwrap();
    database.execute("INSERT INTO tiles VALUES (0, 0, 0, ?1)", [png.into_inner()]).unwrap();
}

#[test]
fn a_map_that_is_dropped_is_shown_and_remembered() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("world.mbtiles");
    world(&path);
    let mut window = window();
    drop_file(&mut window, &path);
    window.until("a tile", |app| app.layers().iter().any(|layer| app.map().pictures_of(layer.id) == 1));
    let is_shown = |window: &Window| window.app().layers().iter().all(|layer| layer.kept.shown);
    for (words, shown) in [("hide the layer world", false), ("show the layer world", true)] {
        window.ask_for(words);
        window.press(Key::Enter);
        assert_eq!(is_shown(&window), shown, "{words}");
    }
    let mut next = Memory::of(&mut window).window();
    next.until("a tile", |app| app.layers().iter().any(|layer| app.map().pictures_of(layer.id) == 1));
    next.click("Legwork");
    next.click("Maps");
    next.click("Maps and elevations…");
    next.click("Remove world.mbtiles");
    assert_eq!(next.app().layers().iter().count(), 0);
    assert!(path.exists());
}

/// They were in the dialog alone.
#[test]
fn all_that_is_done_with_a_map_is_done_from_the_palette() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = window();
    let path = |name: &str| {
        let path = folder.path().join(name);
        world(&path);
        path
    };
    window.ask_for("add a map by its path");
    window.press(Key::Enter);
    window.harness.get_by_label("Search commands").type_text(&path("below.mbtiles").display().to_string());
    window.steps(3);
    window.press(Key::Enter);
    window.until("a map", |app| app.layers().iter().any(|layer| layer.bounds().is_some()));
    drop_file(&mut window, &path("above.mbtiles"));
    window.until("two maps", |app| app.layers().iter().filter(|layer| layer.bounds().is_some()).count() == 2);
    let names = |window: &Window| window.app().layers().iter().map(Layer::name).collect::<Vec<_>>();
    assert_eq!(names(&window), ["above.mbtiles", "below.mbtiles"]);
    window.ask_for("raise the layer above");
    assert!(!window.is_enabled("Maps Raise the layer above.mbtiles"), "nothing is above it");
    window.press(Key::Escape);
    for words in ["raise the layer below", "opacity 25 % of the layer below", "go to the layer below"] {
        window.ask_for(words);
        window.press(Key::Enter);
    }
    assert_eq!(names(&window), ["below.mbtiles", "above.mbtiles"]);
    assert_eq!(window.app().layers().iter().next().unwrap().kept.opacity, 0.25);
    let a = window.harness.query_by_label("Fix A").map(|fix| fix.rect());
    assert!(a.is_none_or(|a| a.center().distance(window.centre("Fix B")) < 2.0), "the whole world is shown");
    window.ask_for("remove the layer below");
    window.press(Key::Enter);
    assert_eq!(names(&window), ["above.mbtiles"]);
}

#[test]
fn elevations_that_are_dropped_are_what_the_plan_is_looked_at_over() {
    let folder = tempfile::tempdir().unwrap();
    let hills = folder.path().join("hills");
    std::fs::create_dir(&hills).unwrap();
    std::fs::write(hills.join("N36W085.hgt"), hgt(4000)).unwrap();
    std::fs::write(hills.join("N37W085.hgt"), b"cut off").unwrap();
    let mut window = window();
    assert!(window.errors().is_empty(), "{:?}", window.errors());
    drop_file(&mut window, &hills);
    window.until("the new ground", |app| app.analysis().problems.iter().any(|p| p.is_error()));
    assert!(!window.errors().is_empty(), "the path is below the ground");
    window.click("Legwork");
    window.click("Maps");
    window.click("Maps and elevations…");
    assert!(window.shows("1 tile, 1 unreadable and left out"));
    window.click("hills");
    window.until("the shipped ground", |app| app.analysis().problems.iter().all(|p| !p.is_error()));
}

/// The colour that most of the map's pixels have, and how many of a hundred have it.
fn ground(window: &mut Window) -> ([u8; 4], usize) {
    let rect = window.harness.get_by_label("Map").rect();
    let picture = window.harness.render().unwrap();
    let mut counts = HashMap::<[u8; 4], usize>::new();
    for y in rect.top() as u32..rect.bottom() as u32 {
        for x in rect.left() as u32..rect.right() as u32 {
            *counts.entry(picture.get_pixel(x, y).0).or_default() += 1;
        }
    }
    let pixels: usize = counts.values().sum();
    let (colour, count) = counts.into_iter().max_by_key(|(_, count)| *count).unwrap();
    (colour, count * 100 / pixels)
}

/// Draws until the ground looks so.
fn until_ground(window: &mut Window, what: &str, is_so: impl Fn([u8; 4], usize) -> bool) {
    let deadline = Instant::now() + PATIENCE;
    loop {
        window.steps(10);
        let (colour, share) = ground(window);
        if is_so(colour, share) {
            return;
        }
        assert!(Instant::now() < deadline, "waited in vain: {what}; {colour:?} at {share} %");
    }
}

#[test]
fn the_ground_in_use_is_shaded_in_the_dark_and_in_the_light() {
    let folder = tempfile::tempdir().unwrap();
    let flat = folder.path().join("flat");
    std::fs::create_dir(&flat).unwrap();
    std::fs::write(flat.join("N36W085.hgt"), hgt(300)).unwrap();
    let mut window = window();
    let (plain, share) = ground(&mut window);
    assert!(share > 50, "{share} %");
    let ctx = window.harness.ctx.clone();
    window.harness.state_mut().shade_ground(&ctx);
    until_ground(&mut window, "hills", |colour, share| colour[1] < 128 && share < 20);
    window.harness.input_mut().system_theme = Some(egui::Theme::Light);
    until_ground(&mut window, "hills in the light", |colour, share| colour[1] > 128 && share < 20);
    window.harness.input_mut().system_theme = Some(egui::Theme::Dark);
    drop_file(&mut window, &flat);
    until_ground(&mut window, "the flat ground", |colour, share| colour != plain && share > 50);
}

/// They say where one looks before there is any plan.
#[test]
fn cities_and_airports_have_their_names_on_the_map() {
    let mut window = Window::open(super::creating::EMPTY);
    window.steps(3);
    assert_eq!(window.colour_within("Map", "Innsbruck"), None, "it is too small for the map of the world");
    window.fill_in(Role::TextInput, "Place", "47.26 11.37");
    window.steps(3);
    for name in ["Innsbruck", "LOWI"] {
        assert!(window.colour_within("Map", name).is_some(), "{name}");
    }
}

#[test]
fn a_file_that_is_no_map_gives_one_clear_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.pmtiles");
    std::fs::write(&path, b"PMTiles\x03 and no more").unwrap();
    let mut window = window();
    drop_file(&mut window, &path);
    window.until("a message", |app| app.view().notice.is_some());
    let text = window.app().view().notice.clone().unwrap();
    assert!(text.contains("bad.pmtiles is not used") && text.contains("get it again"), "{text}");
}

#[test]
fn elevations_that_are_none_give_one_clear_message() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.tif");
    // the first directory would be behind the end
    std::fs::write(&path, b"II\x2a\0\xff\xff\0\0").unwrap();
    let mut window = window();
    drop_file(&mut window, &path);
    window.until("a message", |app| app.view().notice.is_some());
    let text = window.app().view().notice.clone().unwrap();
    assert!(
        text.contains("bad.tif is not used: ") && text.len() > "bad.tif is not used: ".len() + 10,
        "{text}"
    );
    assert_eq!(window.errors(), Vec::<String>::new());
}

#[test]
fn the_pointer_says_where_it_is_and_how_high_the_ground_is() {
    let mut window = window();
    window.harness.hover_at(window.centre("Fix A"));
    window.steps(2);
    assert!(window.shows("36.32") && window.shows("ground "), "position and elevation");
}
