//! A picture of the window after some time, for tests and documentation.

use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What is to be photographed, and how far that has come.
#[derive(Debug)]
pub struct Screenshot {
    file: PathBuf,
    after_s: f64,
    requested: bool,
}

impl Screenshot {
    /// A PNG of the window `after_s` seconds after it opened; then the window closes.
    pub fn new(file: PathBuf, after_s: f64) -> Self {
        Self { file, after_s, requested: false }
    }

    /// Looks at the clock; called in every frame.
    pub(super) fn run(&mut self, ctx: &egui::Context, now_s: f64) {
        if self.requested {
            return;
        }
        ctx.request_repaint_after(std::time::Duration::from_millis(50));
        if now_s < self.after_s {
            return;
        }
        self.requested = true;
        let (file, closing) = (self.file.clone(), ctx.clone());
        ctx.request_screenshot(move |image: Arc<egui::ColorImage>| {
            if let Err(why) = write_png(&file, &image) {
                complain!("legwork: no picture: {why}");
            }
            closing.send_viewport_cmd(egui::ViewportCommand::Close);
            closing.request_repaint();
        });
    }
}

fn write_png(file: &Path, image: &egui::ColorImage) -> Result<(), String> {
    let [width, height] = image.size;
    let size = |n: usize| u32::try_from(n).map_err(|e| e.to_string());
    let mut pixmap = tiny_skia::Pixmap::new(size(width)?, size(height)?).ok_or("the window has no size")?;
    for (pixel, colour) in pixmap.data_mut().chunks_exact_mut(4).zip(&image.pixels) {
        pixel.copy_from_slice(&[colour.r(), colour.g(), colour.b(), 255]);
    }
    let png = pixmap.encode_png().map_err(|e| e.to_string())?;
    crate::files::write_whole(file, &png).map(drop).map_err(|e| format!("{}: {e}", file.display()))
}
