//! Map tiles from any source: read and decoded on threads of their own, a bounded number ahead of the map that shows them.
//!
//! To add a source: a file here with a value that implements [`Reader`].

mod desk;
mod mbtiles;
mod online;
mod picture;
mod pmtiles;
mod relief;

pub use desk::{Desk, Done};
pub use mbtiles::Mbtiles;
pub use online::{Folder, Online, Template};
pub use pmtiles::PmTiles;
pub use relief::Relief;

use egui::ColorImage;
use geometry::LatLon;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Deepest zoom level of a tile: a pixel is a few centimetres.
pub const MAX_ZOOM: u8 = 24;

/// A tile of the Web Mercator pyramid, as all sources number them: y from the north.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TileId {
    /// The level: `2^zoom` tiles a side.
    pub zoom: u8,
    /// From the antimeridian eastwards.
    pub x: u32,
    /// From the northern edge southwards.
    pub y: u32,
}

impl TileId {
    /// The tile above that holds it; `None`: it is the whole world.
    pub fn parent(self) -> Option<Self> {
        Some(Self { zoom: self.zoom.checked_sub(1)?, x: self.x / 2, y: self.y / 2 })
    }
}

/// A picture that is wanted. What depends on the theme is another one for each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Wanted {
    /// Which tile.
    pub tile: TileId,
    /// For the dark theme.
    pub dark: bool,
}

/// What became of a tile.
#[derive(Debug)]
pub enum Answer {
    /// Here it is.
    Picture(ColorImage),
    /// The source has none there.
    Nothing,
    /// There is one, and nothing can be made of it.
    Unreadable,
    /// It can't be had now: ask again in a while.
    Later,
}

/// Reads tiles, on a thread of its own.
pub trait Reader: Send {
    /// Reads and decodes a tile; it may take its time, but not for ever, and not more memory than a few tiles.
    fn read(&mut self, wanted: Wanted) -> Answer;
}

/// What a source says of itself.
#[derive(Debug, Clone, PartialEq)]
pub struct About {
    /// Levels that it has.
    pub zooms: std::ops::RangeInclusive<u8>,
    /// South-west and north-east corner of what it shows, where that is known.
    pub bounds: Option<(LatLon, LatLon)>,
    /// Whom the map has to name.
    pub attribution: String,
    /// Its pictures depend on the theme.
    pub themed: bool,
}

impl Default for About {
    fn default() -> Self {
        Self { zooms: 0..=MAX_ZOOM, bounds: None, attribution: String::new(), themed: false }
    }
}

/// How a source does, for those who look at it from another thread.
#[derive(Debug, Default)]
pub struct Health {
    unreadable: AtomicUsize,
    offline: AtomicBool,
}

impl Health {
    /// So many tiles were left out, because nothing could be made of them.
    pub fn unreadable(&self) -> usize {
        self.unreadable.load(Ordering::Relaxed)
    }
    /// The server did not answer when it was asked last.
    pub fn is_offline(&self) -> bool {
        self.offline.load(Ordering::Relaxed)
    }
    fn set_offline(&self, offline: bool) {
        self.offline.store(offline, Ordering::Relaxed);
    }
    fn note(&self, answer: &Answer) {
        if matches!(answer, Answer::Unreadable) {
            self.unreadable.fetch_add(1, Ordering::Relaxed);
        }
    }
}
