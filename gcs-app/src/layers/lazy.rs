//! Elevation tiles of a folder that is larger than memory: each is read when somebody asks for its ground, and the ones that nobody has asked
//! for longest are given up.

use super::open;
use geometry::LatLon;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, OnceLock, PoisonError, RwLock};
use std::task::Poll;
use terrain::tiles::{Corner, corners_at, corners_in};
use terrain::{Terrain, Tile};

/// A bound of the elevations in a larger box is not worth reading more tiles than this.
const MOST_FOR_A_BOUND: usize = 4;

/// A tile on disk.
struct Stored {
    path: PathBuf,
    bytes: u64,
}

/// A tile in memory, or being read; `None`: it can't be.
struct Slot {
    tile: OnceLock<Option<Tile>>,
    bytes: u64,
    /// When it was asked for last, in questions.
    used: AtomicU64,
}

/// Tiles that are read where they are needed.
pub(super) struct LazyTiles {
    stored: BTreeMap<Corner, Stored>,
    slots: RwLock<BTreeMap<Corner, Arc<Slot>>>,
    questions: AtomicU64,
    /// So much is kept in memory, bytes; what is asked for is, whatever it takes.
    most_bytes: u64,
}

impl LazyTiles {
    /// Of these files, with their corners and lengths, bytes; of several of one corner the last counts.
    pub fn new(files: impl IntoIterator<Item = (Corner, PathBuf, u64)>, most_bytes: u64) -> Self {
        let stored =
            files.into_iter().map(|(corner, path, bytes)| (corner, Stored { path, bytes })).collect();
        Self { stored, slots: RwLock::default(), questions: AtomicU64::new(0), most_bytes }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.stored.len()
    }

    /// South-west and north-east corner of all of them.
    pub fn bounds(&self) -> Option<(LatLon, LatLon)> {
        let at = |south: i32, west: i32| LatLon::new(f64::from(south), f64::from(west));
        let corners = || self.stored.keys();
        let (south, west) = (corners().map(|c| c.0).min()?, corners().map(|c| c.1).min()?);
        let (north, east) = (corners().map(|c| c.0).max()?, corners().map(|c| c.1).max()?);
        Some((at(south, west), at(north + 1, east + 1)))
    }

    /// Asks a tile, which is read if it has to be.
    fn ask<T>(&self, corner: Corner, question: impl FnOnce(&Tile) -> Option<T>) -> Option<T> {
        let slot = self.slot(corner)?;
        // other threads that ask for this tile wait for it, those that ask for others don't
        let read = || open::tile(&self.stored.get(&corner)?.path).ok();
        question(slot.tile.get_or_init(read).as_ref()?)
    }

    /// A tile that is in memory, or being read.
    fn read(&self, corner: Corner) -> Option<Arc<Slot>> {
        let now = self.questions.fetch_add(1, Ordering::Relaxed);
        let slots = self.slots.read().unwrap_or_else(PoisonError::into_inner);
        let slot = slots.get(&corner)?;
        slot.used.store(now, Ordering::Relaxed);
        Some(slot.clone())
    }

    fn slot(&self, corner: Corner) -> Option<Arc<Slot>> {
        if let Some(slot) = self.read(corner) {
            return Some(slot);
        }
        let now = self.questions.fetch_add(1, Ordering::Relaxed);
        let bytes = self.stored.get(&corner)?.bytes;
        let mut slots = self.slots.write().unwrap_or_else(PoisonError::into_inner);
        make_room(&mut slots, self.most_bytes.saturating_sub(bytes));
        let new = || Arc::new(Slot { tile: OnceLock::new(), bytes, used: AtomicU64::new(now) });
        Some(slots.entry(corner).or_insert_with(new).clone())
    }

    #[cfg(test)]
    fn kept(&self) -> Vec<Corner> {
        self.slots.read().unwrap().keys().copied().collect()
    }
}

/// Gives up the tiles that nobody has asked for longest, until the others have no more than this, bytes.
fn make_room(slots: &mut BTreeMap<Corner, Arc<Slot>>, most_bytes: u64) {
    while slots.values().map(|slot| slot.bytes).sum::<u64>() > most_bytes {
        let oldest = slots.iter().min_by_key(|(_, slot)| slot.used.load(Ordering::Relaxed));
        let Some(corner) = oldest.map(|(corner, _)| *corner) else { return };
        slots.remove(&corner);
    }
}

impl Terrain for LazyTiles {
    fn elevation_m(&self, p: LatLon) -> Option<f64> {
        corners_at(p).find_map(|corner| self.ask(corner, |tile| tile.elevation_m(p)))
    }

    fn at_once_m(&self, p: LatLon) -> Poll<Option<f64>> {
        for corner in corners_at(p).filter(|corner| self.stored.contains_key(corner)) {
            match self.read(corner).as_ref().and_then(|slot| slot.tile.get()) {
                None => return Poll::Pending,
                Some(tile) => match tile.as_ref().and_then(|tile| tile.elevation_m(p)) {
                    None => {}
                    known => return Poll::Ready(known),
                },
            }
        }
        Poll::Ready(None)
    }

    fn spacing_m(&self, at: LatLon) -> Option<f64> {
        self.ask(corners_at(at).next()?, |tile| Some(tile.spacing_m()))
    }

    fn at_most_m(&self, south_west: LatLon, north_east: LatLon) -> Option<f64> {
        let corners: Vec<Corner> = corners_in(south_west, north_east)?
            .filter(|corner| self.stored.contains_key(corner))
            .take(MOST_FOR_A_BOUND + 1)
            .collect();
        if corners.len() > MOST_FOR_A_BOUND {
            return None;
        }
        let most_m = |corner| self.ask(corner, |tile| tile.at_most_m(south_west, north_east));
        corners.into_iter().filter_map(most_m).reduce(f64::max).or(Some(f64::NEG_INFINITY))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tile that is as high everywhere, metres.
    fn hgt(height_m: i16) -> Vec<u8> {
        height_m.to_be_bytes().repeat(1201 * 1201)
    }

    #[test]
    fn tiles_are_read_where_they_are_asked_for_and_the_oldest_are_given_up() {
        let folder = tempfile::tempdir().unwrap();
        let bytes = 1201 * 1201 * 2;
        let files = [(36, 100), (37, 200), (38, 300)].map(|(south, height_m)| {
            let path = folder.path().join(format!("N{south}W085.hgt"));
            std::fs::write(&path, hgt(height_m)).unwrap();
            ((south, -85), path, bytes)
        });
        let gone = ((39, -85), folder.path().join("N39W085.hgt"), bytes);
        let tiles = LazyTiles::new(files.into_iter().chain([gone]), 2 * bytes);
        assert_eq!((tiles.len(), tiles.kept()), (4, vec![]));
        assert_eq!(tiles.bounds(), Some((LatLon::new(36.0, -85.0), LatLon::new(40.0, -84.0))));
        let at = |lat_deg: f64| tiles.elevation_m(LatLon::new(lat_deg, -84.5));
        let at_once = |lat_deg: f64| tiles.at_once_m(LatLon::new(lat_deg, -84.5));
        assert_eq!([at_once(36.5), at_once(40.5)], [Poll::Pending, Poll::Ready(None)]);
        assert_eq!(tiles.kept(), vec![], "nothing is read for who can't wait");
        assert_eq!([at(36.5), at(37.5), at(36.6), at(38.5)], [100.0, 200.0, 100.0, 300.0].map(Some));
        assert_eq!(tiles.kept(), [(36, -85), (38, -85)]);
        assert_eq!([at_once(36.5), at_once(37.5)], [Poll::Ready(Some(100.0)), Poll::Pending]);
        assert_eq!([at(37.5), at(39.5), at(40.5)], [Some(200.0), None, None]);
        assert_eq!(at_once(39.5), Poll::Ready(None), "it was tried, and can't be read");
        let most_m = |north: f64| tiles.at_most_m(LatLon::new(36.2, -84.9), LatLon::new(north, -84.1));
        assert_eq!((most_m(36.4), most_m(38.4)), (Some(100.0), Some(300.0)));
        assert_eq!(tiles.at_most_m(LatLon::new(50.0, 3.0), LatLon::new(60.0, 5.0)), Some(f64::NEG_INFINITY));
        assert!((tiles.spacing_m(LatLon::new(36.5, -84.5)).unwrap() - 92.5).abs() < 0.1);
    }
}
