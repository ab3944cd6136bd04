//! What a file or folder is, by what is in it.

use super::lazy::LazyTiles;
use super::{Content, Server, Source, rasters};
use crate::jobs::Progress;
use crate::tiles::{About, Folder, Health, Mbtiles, Online, PmTiles, Reader, Template};
use geometry::LatLon;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Raster, Stack, Tile, Tiles};

/// Most entries of a folder that are looked at.
const MOST_ENTRIES: usize = 20_000;
/// So deep are folders in folders looked into.
const DEEPEST: usize = 4;
/// Most bytes of elevation tiles that are kept in memory.
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
        Some(Kind::Tiff) => raster(path).map(alone),
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

pub(super) fn raster(path: &Path) -> Result<Raster, String> {
    let file = File::open(path).map_err(|error| format!("it can't be read ({error})"))?;
    Raster::from_geotiff(BufReader::new(file)).map_err(|error| error.to_string())
}

fn alone(raster: Raster) -> Content {
    let (columns, rows) = raster.size();
    let detail = format!("elevations, {columns} × {rows}");
    Content::Ground { bounds: raster.known_box(), terrain: Arc::new(raster), detail }
}

fn is_tiff(path: &Path) -> bool {
    let is_one =
        |extension: &std::ffi::OsStr| ["tif", "tiff"].iter().any(|tiff| extension.eq_ignore_ascii_case(tiff));
    path.extension().is_some_and(is_one)
}

fn is_hgt(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("hgt"))
}

pub(super) fn tile(path: &Path) -> Result<Tile, String> {
    let unreadable = |error: std::io::Error| format!("it can't be read ({error})");
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(unreadable)?;
    file.take(LARGEST_TILE + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    Tile::from_hgt(&name, &bytes).map_err(|error| error.to_string())
}

/// The elevation tiles in a folder and in those in it: finer ones after coarser ones, else by their names.
///
/// # Errors
/// It can't be read.
pub fn tiles_in(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    files_in(folder, is_hgt)
}

/// The files of a kind in a folder and in those in it, by their lengths and names.
fn files_in(folder: &Path, is_wanted: fn(&Path) -> bool) -> std::io::Result<Vec<PathBuf>> {
    let (mut found, mut left) = (Vec::new(), MOST_ENTRIES);
    look_into(folder, is_wanted, DEEPEST, &mut left, &mut found)?;
    found.sort();
    Ok(found.into_iter().map(|(_, path)| path).collect())
}

/// Takes down the files with their lengths, bytes. What can't be read below the folder is left out.
fn look_into(
    folder: &Path,
    is_wanted: fn(&Path) -> bool,
    deep: usize,
    left: &mut usize,
    found: &mut Vec<(u64, PathBuf)>,
) -> std::io::Result<()> {
    for entry in std::fs::read_dir(folder)?.filter_map(Result::ok) {
        let Some(fewer) = left.checked_sub(1) else { return Ok(()) };
        *left = fewer;
        let path = entry.path();
        if is_wanted(&path) {
            found.push((length(&path), path));
        } else if deep > 0 && path.is_dir() {
            let _ = look_into(&path, is_wanted, deep - 1, left, found);
        }
    }
    Ok(())
}

fn length(path: &Path) -> u64 {
    path.metadata().map_or(0, |meta| meta.len())
}

/// The elevations in a folder: GeoTIFFs over tiles.
fn folder(path: &Path, progress: &Progress) -> Result<Content, String> {
    let in_it = |is_wanted| files_in(path, is_wanted).map_err(|error| format!("it can't be read ({error})"));
    let (pictures, paths) = (in_it(is_tiff)?, in_it(is_hgt)?);
    if pictures.is_empty() {
        return tiles(paths, progress);
    }
    let above = rasters::ground(&pictures, progress);
    if paths.is_empty() { above } else { both(above, tiles(paths, progress)) }
}

/// Two kinds of elevations in one folder. What is wrong with all of one kind is told beside the other.
fn both(above: Result<Content, String>, below: Result<Content, String>) -> Result<Content, String> {
    match (above, below) {
        (
            Ok(Content::Ground { terrain: above, bounds, detail }),
            Ok(Content::Ground { terrain: below, bounds: other, detail: more }),
        ) => Ok(Content::Ground {
            terrain: Arc::new(Stack(vec![above, below])),
            bounds: around(bounds.into_iter().chain(other)),
            detail: format!("{detail}; {more}"),
        }),
        (Ok(Content::Ground { terrain, bounds, detail }), Err(why))
        | (Err(why), Ok(Content::Ground { terrain, bounds, detail })) => {
            Ok(Content::Ground { terrain, bounds, detail: format!("{detail}; {why}") })
        }
        (above, _) => above,
    }
}

/// Elevation tiles: at once, or where there is no memory for all of them, as they are needed.
fn tiles(paths: Vec<PathBuf>, progress: &Progress) -> Result<Content, String> {
    if paths.iter().map(|path| length(path)).sum::<u64>() > MOST_BYTES {
        return lazily(paths);
    }
    let (mut tiles, mut left_out) = (Vec::new(), 0);
    for (done, path) in paths.iter().enumerate() {
        progress.set(done as u64, paths.len() as u64);
        if progress.is_cancelled() {
            return Err("it was cancelled".into());
        }
        match tile(path) {
            Ok(tile) => tiles.push(tile),
            Err(_) => left_out += 1,
        }
    }
    if tiles.is_empty() { Err(nothing_in_it(left_out)) } else { Ok(ground(tiles, left_out)) }
}

/// By their names and lengths alone.
fn lazily(paths: Vec<PathBuf>) -> Result<Content, String> {
    let number = paths.len();
    let files: Vec<_> = paths
        .into_iter()
        .filter_map(|path| {
            let (name, bytes) = (path.file_name()?.to_string_lossy().into_owned(), length(&path));
            Some((terrain::tile::announced(&name, bytes)?, path, bytes))
        })
        .collect();
    let left_out = number - files.len();
    let tiles = LazyTiles::new(files, MOST_BYTES);
    if tiles.len() == 0 {
        return Err(nothing_in_it(left_out));
    }
    let detail = format!("{}, read where they are needed", number_of(tiles.len(), left_out));
    Ok(Content::Ground { bounds: tiles.bounds(), terrain: Arc::new(tiles), detail })
}

fn nothing_in_it(left_out: usize) -> String {
    match left_out {
        0 => "there are no elevation tiles (N36W085.hgt and the like) and no GeoTIFFs in this folder".into(),
        _ => format!("none of its {left_out} elevation tiles can be read: get them again"),
    }
}

/// `elevations, 3 tiles, 1 unreadable and left out`.
fn number_of(tiles: usize, left_out: usize) -> String {
    let unreadable =
        if left_out > 0 { format!(", {left_out} unreadable and left out") } else { String::new() };
    format!("elevations, {tiles} tile{}{unreadable}", if tiles == 1 { "" } else { "s" })
}

fn ground(tiles: Vec<Tile>, left_out: usize) -> Content {
    let mut all = Tiles::new();
    let number = tiles.len();
    let bounds = around(tiles.iter().map(Tile::known_box));
    tiles.into_iter().for_each(|tile| all.add(tile));
    let detail = number_of(number, left_out);
    Content::Ground { terrain: Arc::new(all), bounds, detail }
}

/// South-west and north-east corners of boxes together.
pub(super) fn around(boxes: impl Iterator<Item = (LatLon, LatLon)>) -> Option<(LatLon, LatLon)> {
    boxes.reduce(|(a, b), (south_west, north_east)| {
        (
            LatLon::new(a.lat_deg.min(south_west.lat_deg), a.lon_deg.min(south_west.lon_deg)),
            LatLon::new(b.lat_deg.max(north_east.lat_deg), b.lon_deg.max(north_east.lon_deg)),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_in_a_folder_are_looked_into_and_finer_tiles_come_last() {
        let folder = tempfile::tempdir().unwrap();
        let at = |path: &str, bytes: usize| {
            let path = folder.path().join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, vec![0; bytes]).unwrap();
        };
        at("N36/1s/N36W085.hgt", 9);
        at("N36/3s/N36W085.HGT", 3);
        at("N37W085.hgt", 5);
        at("a/b/c/d/N38W085.hgt", 7);
        at("a/b/c/d/e/N39W085.hgt", 8);
        let found = tiles_in(folder.path()).unwrap();
        let found: Vec<_> = found.iter().map(|path| path.strip_prefix(folder.path()).unwrap()).collect();
        let expected = ["N36/3s/N36W085.HGT", "N37W085.hgt", "a/b/c/d/N38W085.hgt", "N36/1s/N36W085.hgt"];
        assert_eq!(found, expected.map(Path::new));
    }

    /// It was refused.
    #[test]
    fn a_folder_that_is_larger_than_memory_is_taken() {
        let folder = tempfile::tempdir().unwrap();
        let sparse = |name: String| {
            let file = File::create(folder.path().join(name)).unwrap();
            file.set_len(LARGEST_TILE).unwrap();
        };
        (0..22).for_each(|n| sparse(format!("N{:02}E007.hgt", 40 + n)));
        std::fs::write(folder.path().join("N30E007.hgt"), b"cut off").unwrap();
        let (jobs, source) = (crate::jobs::Progress::default(), Source::File(folder.path().into()));
        let Ok(Content::Ground { terrain, bounds, detail }) = open(&source, Folder::default(), &jobs) else {
            panic!("refused")
        };
        assert_eq!(detail, "elevations, 22 tiles, 1 unreadable and left out, read where they are needed");
        assert_eq!(bounds, Some((LatLon::new(40.0, 7.0), LatLon::new(62.0, 8.0))));
        assert_eq!(terrain.elevation_m(LatLon::new(40.5, 7.5)), Some(0.0));
    }
}
