//! What a file or folder is, by what is in it.

use super::{Content, Server, Source};
use crate::jobs::Progress;
use crate::tiles::{About, Folder, Health, Mbtiles, Online, PmTiles, Reader, Template};
use geometry::LatLon;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Raster, Tile, Tiles};

/// Most entries of a folder that are looked at.
const MOST_ENTRIES: usize = 20_000;
/// Most bytes of elevation tiles that are taken from a folder.
const MOST_BYTES: u64 = 512 << 20;
/// Bytes of the larger kind of elevation tile.
const LARGEST_TILE: u64 = 3601 * 3601 * 2;

/// Opens it.
pub(super) fn open(source: &Source, tiles: Folder, progress: &Progress) -> Result<Content, String> {
    match source {
        Source::File(path) => file(path, progress),
        Source::Online(server) => online(server, tiles),
    }
}

fn online(server: &Server, tiles: Folder) -> Result<Content, String> {
    let health = Arc::<Health>::default();
    let readers = Online::open(Template::new(&server.url)?, tiles, &health)?;
    let readers = readers.into_iter().map(|reader| Box::new(reader) as Box<dyn Reader>).collect();
    Ok(Content::Map { readers, about: Online::about(&server.attribution), health })
}

fn map((reader, about): (impl Reader + 'static, About)) -> Content {
    Content::Map { readers: vec![Box::new(reader)], about, health: Arc::default() }
}

fn file(path: &Path, progress: &Progress) -> Result<Content, String> {
    let unreadable = |error: std::io::Error| format!("it can't be read ({error})");
    let meta = std::fs::metadata(path).map_err(unreadable)?;
    if meta.is_dir() {
        return folder(path, progress);
    }
    if !meta.is_file() {
        return Err("it is neither a file nor a folder".into());
    }
    let mut start = [0; 16];
    let length = File::open(path).and_then(|mut file| file.read(&mut start)).map_err(unreadable)?;
    match kind(path, start.get(..length).unwrap_or_default()) {
        Some(Kind::Mbtiles) => Mbtiles::open(path).map(map),
        Some(Kind::PmTiles) => PmTiles::open(path).map(map),
        Some(Kind::Tiff) => raster(path),
        Some(Kind::Hgt) => tile(path).map(|tile| ground(vec![tile], 0)),
        None => {
            Err("it is none of the known kinds: MBTiles, PMTiles, GeoTIFF elevations, HGT elevations".into())
        }
    }
}

/// What a file may be, by what it begins with; elevations of the Shuttle mission begin with nothing in particular.
pub(super) enum Kind {
    Mbtiles,
    PmTiles,
    Tiff,
    Hgt,
}

pub(super) fn kind(path: &Path, start: &[u8]) -> Option<Kind> {
    match start {
        start if start.starts_with(b"SQLite format 3") => Some(Kind::Mbtiles),
        start if start.starts_with(b"PMTiles") => Some(Kind::PmTiles),
        [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..] => Some(Kind::Tiff),
        _ if is_hgt(path) => Some(Kind::Hgt),
        _ => None,
    }
}

fn raster(path: &Path) -> Result<Content, String> {
    let file = File::open(path).map_err(|error| format!("it can't be read ({error})"))?;
    let raster = Raster::from_geotiff(BufReader::new(file)).map_err(|error| error.to_string())?;
    let (columns, rows) = raster.size();
    let detail = format!("elevations, {columns} × {rows}");
    Ok(Content::Ground { bounds: raster.known_box(), terrain: Arc::new(raster), detail })
}

fn is_hgt(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("hgt"))
}

fn tile(path: &Path) -> Result<Tile, String> {
    let unreadable = |error: std::io::Error| format!("it can't be read ({error})");
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(LARGEST_TILE + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Tile::from_hgt(&name, &bytes).map_err(|error| error.to_string())
}

/// The elevation tiles in a folder, by their names.
///
/// # Errors
/// It can't be read.
pub fn tiles_in(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let paths = std::fs::read_dir(folder)?.take(MOST_ENTRIES).filter_map(|entry| Some(entry.ok()?.path()));
    let mut tiles: Vec<PathBuf> = paths.filter(|path| is_hgt(path)).collect();
    tiles.sort();
    Ok(tiles)
}

/// The elevation tiles in a folder, as many as there is memory for.
fn folder(path: &Path, progress: &Progress) -> Result<Content, String> {
    let paths = tiles_in(path).map_err(|error| format!("it can't be read ({error})"))?;
    let (mut tiles, mut left_out, mut bytes) = (Vec::new(), 0, 0);
    for (done, path) in paths.iter().enumerate() {
        progress.set(done as u64, paths.len() as u64);
        if progress.is_cancelled() {
            return Err("it was cancelled".into());
        }
        bytes += path.metadata().map_or(0, |meta| meta.len());
        if bytes > MOST_BYTES {
            return Err(format!(
                "it holds more than {} MB of elevations: put those of the area that you fly in into a folder of their own",
                MOST_BYTES >> 20
            ));
        }
        match tile(path) {
            Ok(tile) => tiles.push(tile),
            Err(_) => left_out += 1,
        }
    }
    match (tiles.is_empty(), left_out) {
        (true, 0) => Err("there are no elevation tiles (N36W085.hgt and the like) in this folder".into()),
        (true, _) => Err(format!("none of its {left_out} elevation tiles can be read: get them again")),
        (false, _) => Ok(ground(tiles, left_out)),
    }
}

fn ground(tiles: Vec<Tile>, left_out: usize) -> Content {
    let mut all = Tiles::new();
    let number = tiles.len();
    let mut corners: Option<(LatLon, LatLon)> = None;
    for tile in tiles {
        let (south_west, north_east) = tile.known_box();
        let (a, b) = corners.unwrap_or((south_west, north_east));
        corners = Some((
            LatLon::new(a.lat_deg.min(south_west.lat_deg), a.lon_deg.min(south_west.lon_deg)),
            LatLon::new(b.lat_deg.max(north_east.lat_deg), b.lon_deg.max(north_east.lon_deg)),
        ));
        all.add(tile);
    }
    let unreadable =
        if left_out > 0 { format!(", {left_out} unreadable and left out") } else { String::new() };
    let detail = format!("elevations, {number} tile{}{unreadable}", if number == 1 { "" } else { "s" });
    Content::Ground { terrain: Arc::new(all), bounds: corners, detail }
}
