use super::*;
use crate::Raster;
use egui::{Button, Color32, Theme, Ui, vec2};
use egui_kittest::Harness;
use std::path::PathBuf;

/// A panel as the window has them: labels, values, buttons.
fn panel(ui: &mut Ui, labels: &[&str; 4]) {
    // as far from its ground as the window's text
    let text = if ui.visuals().dark_mode { 210 } else { 40 };
    ui.visuals_mut().override_text_color = Some(Color32::from_gray(text));
    for label in labels {
        ui.horizontal(|ui| {
            ui.label(*label);
            ui.label("24.1 V");
        });
        ui.horizontal(|ui| {
            if !label.is_empty() {
                let _ = ui.button("Raise");
            }
            ui.add_space(30.0);
            ui.add(Button::new("Lower").min_size(vec2(60.0, 0.0)));
        });
    }
}

const LABELS: [&str; 4] = ["Altitude", "Hold", "Speed", "Push"];

fn sheet_of(labels: &'static [&'static str; 4], theme: Theme) -> Sheet {
    let mut harness = Harness::builder()
        .with_size(vec2(600.0, 400.0))
        .renderer(Raster::default())
        .build_ui(move |ui| panel(ui, labels));
    harness.input_mut().system_theme = Some(theme);
    harness.run_steps(3);
    let mut sheet = Sheet::default();
    sheet.add(&harness.render().unwrap());
    sheet
}

fn folder(name: &str) -> PathBuf {
    let folder = std::env::temp_dir().join(format!("legwork-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn one_changed_label_or_one_button_that_is_gone_is_seen() {
    let folder = folder("sheets");
    let path = folder.join("panel.png");
    for theme in [Theme::Dark, Theme::Light] {
        save(&sheet_of(&LABELS, theme).whole(), &path).unwrap();
        assert!(compare(&sheet_of(&LABELS, theme).whole(), &path, &folder).is_ok());
        const CHANGED: [[&str; 4]; 4] = [
            ["Altitude", "Skip", "Speed", "Push"],
            ["Altitude", "Hold", "Speed", "Send"],
            ["Altitude", "Hold", "", "Push"],
            ["Attitude", "Hold", "Track", "Push"],
        ];
        for labels in &CHANGED {
            let found = compare(&sheet_of(labels, theme).whole(), &path, &folder.join("new"));
            assert!(matches!(found, Err(Mismatch::Place(..))), "{labels:?} in {theme:?}: {found:?}");
        }
    }
    assert!(folder.join("new/panel.png").exists() && folder.join("new/panel-difference.png").exists());
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_digit_and_a_little_other_colour_may_differ() {
    let before = RgbImage::from_pixel(60, 40, Rgb([40, 40, 40]));
    let lighter = RgbImage::from_pixel(60, 40, Rgb([50, 40, 40]));
    assert_eq!(first_difference(&before, &lighter), None);
    let with = |width: u32| {
        let mut now = before.clone();
        (0..width * 3).for_each(|i| now.put_pixel(30 + i % width, 20 + i / width, Rgb([200, 200, 200])));
        now
    };
    assert_eq!(first_difference(&before, &with(2)), None, "two pixels of a digit");
    assert_eq!(first_difference(&before, &with(5)), Some((32, 16)), "a word");
}

#[test]
fn a_sheet_is_as_its_own_file_also_where_it_has_more_colours_than_the_file() {
    let folder = folder("colours");
    let path = folder.join("colours.png");
    let mut sheet = RgbImage::from_fn(64, 64, |x, y| Rgb([(x % 17 * 8) as u8, (y % 17 * 8) as u8, 0]));
    (0..12).for_each(|x| sheet.put_pixel(x, 30, Rgb([255, 0, 255])));
    save(&sheet, &path).unwrap();
    let kept = image::open(&path).unwrap().to_rgb8();
    assert!(
        palette(&sheet).len() < COLOURS
            && kept.pixels().zip(sheet.pixels()).any(|(a, b)| apart(a.0, b.0) > 4)
    );
    assert!(kept.pixels().zip(sheet.pixels()).all(|(a, b)| apart(a.0, b.0) <= 12));
    assert!(compare(&sheet, &path, &folder).is_ok());
    (0..12).for_each(|x| sheet.put_pixel(x, 30, Rgb([255, 0, 0])));
    assert!(matches!(compare(&sheet, &path, &folder.join("new")), Err(Mismatch::Place(..))));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn rows_stand_below_each_other() {
    let mut sheet = Sheet::default();
    for (side, grey) in [(40, 10), (80, 20)] {
        sheet.begin_row();
        for light in [0, 100] {
            sheet.add(&RgbaImage::from_pixel(side, side, image::Rgba([grey + light, 0, 0, 255])));
        }
    }
    let whole = sheet.whole();
    assert_eq!(whole.dimensions(), (40, 30));
    let at = |x, y| whole.get_pixel(x, y).0[0];
    assert_eq!([at(0, 0), at(10, 9), at(39, 0), at(0, 10), at(39, 29)], [10, 110, 0, 20, 120]);
}
