//! Opening the window, and saying what is missing when it can't be opened.

use super::{App, Screenshot};
use crate::assets;
use crate::document::Document;
use crate::link::Links;
use crate::story::Story;
use std::panic::AssertUnwindSafe;
use std::path::PathBuf;
use std::sync::Arc;

/// How the window opens.
#[derive(Debug, Default)]
pub struct Options {
    /// The plan it opens with; without one, it shows the plan aboard as soon as it knows it.
    pub document: Option<Document>,
    /// A file to open, of whatever format.
    pub file: Option<PathBuf>,
    /// Vehicle and endpoint to connect to at once.
    pub connect: Option<(String, String)>,
    /// Take a picture and close.
    pub screenshot: Option<Screenshot>,
    /// Keep the aircraft in the middle of the map from the start.
    pub follow: bool,
    /// Keep a copy of unsaved changes, and offer what a crashed window left behind.
    pub recover: bool,
    /// Offer the tour of the window to who sees it for the first time.
    pub tour: bool,
    /// A demo whose story is told in the window.
    pub story: Option<Story>,
    /// Begin with the light theme instead of the system's or the remembered one.
    pub theme: Option<egui::Theme>,
}

/// Why there is no window.
#[derive(Debug, thiserror::Error)]
pub enum WindowError {
    /// There is nothing to open it on.
    #[error(
        "there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set): log in to a desktop, or use the commands that work without a window (legwork --help)"
    )]
    NoDisplay,
    /// A library of the desktop is missing.
    #[error("the window can't be opened: {0}. On Debian and Ubuntu, install: {PACKAGES}")]
    Missing(String),
}

/// What a bare machine needs for a window.
const PACKAGES: &str = "libx11-6 libx11-xcb1 libxcb1 libxcursor1 libxi6 libxrandr2 libxkbcommon0 libxkbcommon-x11-0 libgl1 libegl1";

/// There is a display to open a window on.
pub fn has_display() -> bool {
    let set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    cfg!(not(target_os = "linux")) || set("DISPLAY") || set("WAYLAND_DISPLAY")
}

/// Opens the window and runs it until it is closed. Must be called on the main thread.
///
/// # Errors
/// There is no display, or a library is missing.
pub fn run(options: Options) -> Result<(), WindowError> {
    if !has_display() {
        return Err(WindowError::NoDisplay);
    }
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Legwork")
            .with_app_id("legwork")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([960.0, 600.0]),
        // pictures are taken at the size they are documented with
        persist_window: options.screenshot.is_none(),
        ..Default::default()
    };
    // winit panics when a library it loads at run time is missing
    let opened = std::panic::catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            "legwork",
            native,
            Box::new(move |creation| Ok(Box::new(build(creation, options)?))),
        )
    }));
    match opened {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => Err(WindowError::Missing(error.to_string())),
        Err(panic) => Err(WindowError::Missing(panic_text(panic.as_ref()))),
    }
}

impl App {
    /// Begins with this theme, in this run alone, until the operator chooses one.
    pub fn begin_in(&mut self, theme: egui::ThemePreference) {
        self.theme_of_old = Some(self.view.theme);
        self.view.theme = theme;
    }
}

fn panic_text(panic: &(dyn std::any::Any + Send)) -> String {
    let text =
        panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    text.unwrap_or("a library of the desktop is missing").to_owned()
}

fn build(creation: &eframe::CreationContext<'_>, options: Options) -> std::io::Result<App> {
    let ctx = creation.egui_ctx.clone();
    let links = Links::spawn(Arc::new(move || ctx.request_repaint()))?;
    let terrain = assets::demo_terrain();
    let mut app = App::new(creation, options.document.unwrap_or_default(), links, terrain)?;
    if let Some(story) = options.story {
        app.listen_to(story);
    }
    if let Some((vehicle, endpoint)) = options.connect {
        app.connect(&endpoint, &vehicle.as_str().into(), creation.egui_ctx.input(|i| i.time));
    }
    if let Some(path) = options.file {
        app.files.open(std::path::absolute(&path).unwrap_or(path));
    }
    app.shade_ground(&creation.egui_ctx);
    let folder = eframe::storage_dir("legwork");
    if let Some(folder) = &folder {
        app.layers.keep_tiles_in(&folder.join("tiles"));
    }
    if options.recover
        && let Some(folder) = &folder
    {
        app.keep_copies(&folder.join("recovery"));
    }
    app.screenshot = options.screenshot;
    if options.tour {
        app.offer_tour();
    }
    if let Some(theme) = options.theme {
        app.begin_in(theme.into());
    }
    if options.follow {
        app.view.follow = true;
        app.map.follow();
    }
    Ok(app)
}
