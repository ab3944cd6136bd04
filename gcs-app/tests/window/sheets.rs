//! The pictures of every state, at every size in both themes: a sheet each, kept in `tests/pictures/states`.

use super::states::{MORE, SIZES, THEMES, Widget, examine, opened, placed, widgets};
use super::{SQUARE, Window, states};
use egui::{Rect, vec2};
use image::RgbaImage;
use pictures::Sheet;

/// It lists what lies in a folder of this machine, and its path: no picture of it is kept.
const WITHOUT_PICTURE: &str = "file dialog";

/// Longer than what comes into sight takes for it, seconds.
const SETTLED_S: f64 = 0.2;

/// A cross, a plus or one digit: no more than a faint dot there.
fn is_a_dot(widget: &Widget) -> bool {
    widget.rect.width() < 34.0
}

/// Leaves there only what is beside it.
fn erase(picture: &mut RgbaImage, rect: Rect) {
    let (left, top) = (rect.left().max(1.0) as u32, rect.top().max(0.0) as u32);
    for y in top..(rect.bottom().ceil() as u32).min(picture.height()) {
        let beside = *picture.get_pixel(left - 1, y);
        (left..(rect.right().ceil() as u32).min(picture.width()))
            .for_each(|x| picture.put_pixel(x, y, beside));
    }
}

/// A row for each size, the dark one before the light one; of more sizes no picture is kept.
fn in_all(state: &str, window: &mut Window, found: &mut Vec<String>) {
    let mut sheet = Sheet::default();
    // nothing grows older from picture to picture
    window.stop_clock(SETTLED_S);
    for size in SIZES {
        window.harness.set_size(size);
        sheet.begin_row();
        for theme in THEMES {
            examine(state, size, theme, window, found);
            sheet.add(&window.harness.render().unwrap());
        }
    }
    window.start_clock();
    for (size, theme) in MORE.into_iter().zip(THEMES.into_iter().cycle()) {
        window.harness.set_size(size);
        examine(state, size, theme, window, found);
    }
    found.extend(check(&sheet, state).err());
    window.harness.set_size(vec2(1280.0, 800.0));
    window.steps(2);
}

/// Compares a state's sheet with the one that is kept; `LEGWORK_BLESS=1` keeps this one. What differs is left in
/// `target/tmp/states`.
fn check(sheet: &Sheet, state: &str) -> Result<(), String> {
    if state == WITHOUT_PICTURE {
        return Ok(());
    }
    let name = state.replace(' ', "-");
    let path = format!("{}/tests/pictures/states/{name}.png", env!("CARGO_MANIFEST_DIR"));
    let scratch = format!("{}/states", env!("CARGO_TARGET_TMPDIR"));
    sheet.check(path.as_ref(), scratch.as_ref()).map_err(|mismatch| mismatch.to_string())
}

fn sheet_of(picture: &RgbaImage) -> Sheet {
    let mut sheet = Sheet::default();
    sheet.add(picture);
    sheet
}

#[test]
fn of_a_new_plan() {
    states::new_plan(in_all);
}

#[test]
fn of_selections_and_tools() {
    states::selections_and_tools(in_all);
}

#[test]
fn of_panels_and_dialogs() {
    states::panels_and_dialogs(in_all);
}

#[test]
fn of_a_flight() {
    states::flight(in_all);
}

#[test]
fn of_questions_and_emergencies() {
    states::questions_and_emergencies(in_all);
}

/// Whatever is read or used: each in turn is taken out of the picture.
#[test]
fn a_widget_that_is_gone_is_seen_on_a_sheet() {
    let mut window = opened(SQUARE);
    for theme in THEMES {
        window.harness.input_mut().system_theme = Some(theme);
        window.steps(2);
        let whole = window.harness.render().unwrap();
        let kept = sheet_of(&whole);
        let all = widgets(&window);
        let shown = placed(&all).into_iter().filter(|w| w.seen == w.rect && !is_a_dot(w));
        let unseen = shown.filter(|gone| {
            let mut without = whole.clone();
            erase(&mut without, gone.rect);
            sheet_of(&without).difference(&kept).is_none()
        });
        let unseen: Vec<_> =
            unseen.map(|gone| format!("{:?} {:?} {}", gone.role, gone.name, gone.rect)).collect();
        assert!(unseen.is_empty(), "{theme:?}: {unseen:#?}");
    }
}
