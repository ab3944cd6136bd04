//! Maps and elevations that are dropped onto the window, by their kinds; and what lies over the map on request.

use super::interchange::drop_file;
use super::{SQUARE, Window};
use egui::Key;
use gcs_app::layers::State;
use std::path::Path;

fn window() -> Window {
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    window
}

/// A PMTiles file with the whole world as one tile; nothing in it is packed.
fn pmtiles() -> Vec<u8> {
    let mut png = std::io::Cursor::new(Vec::new());
    let picture = image::RgbaImage::from_pixel(64, 64, image::Rgba([90, 0, 200, 255]));
    picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
    let tile = png.into_inner();
    [pmtiles_for(tile.len()), tile].concat()
}

/// All of such a file but the tile, which is so long.
fn pmtiles_for(tile: usize) -> Vec<u8> {
    // one entry: tile 0, once, so long, at the beginning
    let mut root = vec![1, 0, 1];
    let mut length = tile;
    while length > 127 {
        root.push((length & 127) as u8 | 128);
        length >>= 7;
    }
    root.extend([length as u8, 1]);
    let metadata = br#"{"attribution":"Somebody"}"#;
    let mut bytes = b"PMTiles\x03".to_vec();
    let mut offset = 127u64;
    for length in [root.len(), metadata.len(), 0, tile] {
        bytes.extend(offset.to_le_bytes());
        bytes.extend((length as u64).to_le_bytes());
        offset += length as u64;
    }
    bytes.extend([0; 24]);
    // clustered, nothing packed, PNG, level 0
    bytes.extend([1, 1, 1, 2, 0, 0]);
    for corner in [-180.0, -85.0, 180.0, 85.0f64] {
        bytes.extend(((corner * 1e7) as i32).to_le_bytes());
    }
    bytes.extend([0; 9]);
    [bytes, root, metadata.to_vec()].concat()
}

/// A GeoTIFF of 2° by 2° around the square, where all ground is as high as this.
fn geotiff(height_m: i16) -> Vec<u8> {
    const SIDE: u32 = 20;
    const DATA: u32 = 8 + 2 + 13 * 12 + 4;
    let (scale, tie, keys) = (DATA, DATA + 24, DATA + 72);
    let pixels = keys + 32;
    let (short, long, double) = (3u16, 4u16, 12u16);
    let fields = [
        (256u16, short, 1u32, SIDE),
        (257, short, 1, SIDE),
        (258, short, 1, 16),
        (259, short, 1, 1),
        (262, short, 1, 1),
        (273, long, 1, pixels),
        (277, short, 1, 1),
        (278, short, 1, SIDE),
        (279, long, 1, SIDE * SIDE * 2),
        (339, short, 1, 2),
        (33_550, double, 3, scale),
        (33_922, double, 6, tie),
        (34_735, short, 16, keys),
    ];
    let mut bytes = b"II\x2a\0\x08\0\0\0".to_vec();
    bytes.extend((fields.len() as u16).to_le_bytes());
    for (tag, kind, count, value) in fields {
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend(value.to_le_bytes());
    }
    bytes.extend(0u32.to_le_bytes());
    for number in [0.1, 0.1, 0.0, 0.0, 0.0, 0.0, -85.0, 37.0, 0.0f64] {
        bytes.extend(number.to_le_bytes());
    }
    // geographic, pixels are areas, WGS84
    for key in [1, 1, 0, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326u16] {
        bytes.extend(key.to_le_bytes());
    }
    bytes.extend(height_m.to_le_bytes().repeat((SIDE * SIDE) as usize));
    bytes
}

#[test]
fn pmtiles_that_are_dropped_are_shown() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("world.pmtiles");
    std::fs::write(&path, pmtiles()).unwrap();
    let mut window = window();
    drop_file(&mut window, &path);
    window.until("a tile", |app| app.layers().iter().any(|layer| app.map().pictures_of(layer.id) == 1));
    assert!(window.paints("Somebody"), "the map is named");
}

#[test]
fn a_geotiff_that_is_dropped_is_the_ground_that_the_plan_is_looked_at_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("hills.tif");
    std::fs::write(&path, geotiff(4000)).unwrap();
    let mut window = window();
    assert!(window.errors().is_empty(), "{:?}", window.errors());
    drop_file(&mut window, &path);
    window.until("the new ground", |app| app.analysis().problems.iter().any(|p| p.is_error()));
    window.harness.hover_at(window.centre("Fix A"));
    window.steps(2);
    assert!(window.shows("ground 4000 m AMSL"));
}

/// It was told that there are no elevation tiles in it.
#[test]
fn a_folder_of_geotiffs_that_is_dropped_is_one_ground_and_says_what_was_not_taken() {
    let folder = tempfile::tempdir().unwrap();
    let dems = folder.path().join("dems");
    std::fs::create_dir_all(dems.join("more")).unwrap();
    std::fs::write(dems.join("hills.tif"), geotiff(4000)).unwrap();
    std::fs::write(dems.join("more/same.TIFF"), geotiff(4000)).unwrap();
    std::fs::write(dems.join("broken.tif"), b"II\x2a\0").unwrap();
    let mut window = window();
    drop_file(&mut window, &dems);
    window.until("the new ground", |app| app.analysis().problems.iter().any(|p| p.is_error()));
    window.harness.hover_at(window.centre("Fix A"));
    window.steps(2);
    assert!(window.shows("ground 4000 m AMSL"));
    let layer = window.app().layers().iter().next().unwrap();
    let State::Ground { detail, .. } = &layer.state else { panic!("no ground") };
    assert!(detail.starts_with("elevations, 2 files, 1 left out (broken.tif: "), "{detail}");
}

#[test]
fn graticule_and_range_rings_lie_over_the_map_when_they_are_asked_for() {
    let mut window = window();
    let rings = gcs_app::theme::palette(true).text.gamma_multiply(0.5);
    assert!(!window.paints("° N") && !window.paints("′ N") && !window.paints("″ N"));
    assert_eq!(window.lines_within("Map", rings), 0);
    for asked in ["graticule", "range rings"] {
        window.ask_for(asked);
        window.press(Key::Enter);
    }
    assert!(window.paints("° N") || window.paints("′ N") || window.paints("″ N"));
    assert_eq!(window.lines_within("Map", rings), 5);
    // also in the light theme
    window.ask_for("theme light");
    window.press(Key::Enter);
    let colour = window.colour_of("° N").or(window.colour_of("′ N")).or(window.colour_of("″ N"));
    assert_eq!(colour, Some(gcs_app::theme::palette(false).text));
}

#[test]
fn nothing_is_fetched_from_a_server_until_one_is_added() {
    let mut window = window();
    assert_eq!(window.app().layers().iter().count(), 0);
    window.ask_for("maps and elevations");
    window.press(Key::Enter);
    assert!(window.shows("Nothing yet. The map shows the world and the shipped elevations."));
    window.click("From a server");
    window.steps(20);
    assert!(!window.is_enabled("Add the server"));
    window.click("OpenStreetMap");
    assert!(window.is_enabled("Add the server"));
    assert_eq!(window.app().layers().iter().count(), 0, "its address is only filled in");
}

#[test]
fn coordinates_that_are_nowhere_are_told_and_the_window_goes_on() {
    let absurd = SQUARE
        .replace(r#"id="A" lat="36.327322" lon="-84.159836""#, r#"id="A" lat="99.5" lon="1e300""#)
        .replace(r#"id="C" lat="36.305396""#, r#"id="C" lat="NaN""#);
    let mut window = Window::open(&absurd);
    window.until_analysed();
    assert!(window.app().analysis().problems.iter().any(|p| p.is_error()), "{:?}", window.errors());
    for key in [Key::F, Key::Minus, Key::Plus] {
        window.press(key);
    }
    window.click("TF side1");
    let legs = window.plan().all_legs().len();
    window.paste("99.5, 1e300");
    let notice = window.app().view().notice.clone();
    assert!(notice.is_some() && window.plan().all_legs().len() == legs, "{notice:?}");
    window.click("TF side2");
    assert_eq!(window.selected(), "side2");
}

/// Writes a file that goes on for a gigabyte: a hole on the disk.
fn gigabyte(path: &Path, begins: &[u8]) {
    std::fs::write(path, begins).unwrap();
    std::fs::File::options().write(true).open(path).unwrap().set_len(1 << 30).unwrap();
}

#[test]
fn a_geotiff_bomb_and_a_gigabyte_of_directory_give_one_clear_message_each() {
    let folder = tempfile::tempdir().unwrap();
    let [picture, tiles] = ["bomb.tif", "bomb.pmtiles"].map(|name| folder.path().join(name));
    let mut bomb = geotiff(300);
    // columns, rows, and rows of its one strip: each of 32 bits now
    for field in [0, 1, 7] {
        let at = 10 + 12 * field;
        bomb[at + 2] = 4;
        bomb[at + 8..at + 12].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
    }
    std::fs::write(&picture, bomb).unwrap();
    let mut directory = pmtiles();
    directory[16..24].copy_from_slice(&(1_u64 << 29).to_le_bytes());
    gigabyte(&tiles, &directory);
    for (path, why) in [(&picture, "4000000000 × 4000000000 samples"), (&tiles, "it is damaged")] {
        let mut window = window();
        drop_file(&mut window, path);
        window.until("a message", |app| app.view().notice.is_some());
        let text = window.app().view().notice.clone().unwrap();
        assert!(text.contains(" is not used: ") && text.contains(why), "{text}");
        assert!(window.app().toasts().iter().all(|toast| !toast.text.contains("bomb")), "said once");
        assert_eq!(window.errors(), Vec::<String>::new());
    }
}

/// What can be read of the file is shown, and the map goes on.
#[test]
fn a_tile_of_almost_a_gigabyte_is_left_out_and_said_where_the_maps_are_listed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("world.pmtiles");
    gigabyte(&path, &pmtiles_for(900 << 20));
    let mut window = window();
    drop_file(&mut window, &path);
    window.until("its name on the map", |app| app.layers().attributions().any(|whom| whom == "Somebody"));
    window.click("Legwork");
    window.click("Maps");
    window.click("Maps and elevations…");
    window.until("the tile", |app| {
        app.layers()
            .iter()
            .any(|layer| matches!(&layer.state, State::Map(_, health) if health.unreadable() == 1))
    });
    assert!(window.shows("1 tile is unreadable and left out"));
    assert_eq!(window.app().view().notice, None);
}
