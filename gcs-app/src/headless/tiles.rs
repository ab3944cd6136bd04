//! Elevation tiles that are named on the command line.

use super::source::read_at_most;
use crate::assets;
use crate::layers::tiles_in;
use anyhow::{Context, ensure};
use std::path::PathBuf;
use std::sync::Arc;
use terrain::{Terrain, Tile, Tiles};

/// Greatest elevation tile there is, bytes (1″), and a little more, so that a longer file is seen as such.
const MAX_TILE_BYTES: u64 = 26_000_000;
/// All tiles together, bytes: 40 of 1″, 360 of 3″.
const MOST_BYTES: u64 = 40 * MAX_TILE_BYTES;

/// The tiles of these files and folders; of none, the bundled one.
///
/// # Errors
/// One can't be read, or is no elevation tile; a folder has none; all together are too many.
pub fn load(named: &[PathBuf]) -> anyhow::Result<Arc<dyn Terrain>> {
    if named.is_empty() {
        return Ok(assets::demo_terrain());
    }
    let (mut tiles, mut left_bytes) = (Tiles::new(), MOST_BYTES);
    for path in &files(named)? {
        let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
        let bytes = read_at_most(path, MAX_TILE_BYTES)?;
        left_bytes = left_bytes.checked_sub(bytes.len() as u64).with_context(|| {
            format!("{}: name the tiles below the plan, all together are too many", path.display())
        })?;
        tiles.add(Tile::from_hgt(name, &bytes).with_context(|| path.display().to_string())?);
    }
    Ok(Arc::new(tiles))
}

/// The files named, and the tiles in the folders named, by their names.
fn files(named: &[PathBuf]) -> anyhow::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for path in named {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let mut found = tiles_in(path).with_context(|| format!("can't read {}", path.display()))?;
        ensure!(!found.is_empty(), "{}: there is no elevation tile (.hgt) in this folder", path.display());
        files.append(&mut found);
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;

    #[test]
    fn a_folder_of_tiles_is_all_of_them() {
        let folder = tempfile::tempdir().unwrap();
        let named = [folder.path().to_owned()];
        let error = load(&named).map(|_| ()).unwrap_err();
        assert!(error.to_string().ends_with("there is no elevation tile (.hgt) in this folder"), "{error}");
        std::fs::write(folder.path().join("README.txt"), "of last summer").unwrap();
        let level = 7_i16.to_be_bytes().repeat(1201 * 1201);
        for name in ["N46E007.hgt", "N46E008.HGT"] {
            std::fs::write(folder.path().join(name), &level).unwrap();
        }
        let terrain = load(&named).unwrap();
        for lon in [7.5, 8.5] {
            assert_eq!(terrain.elevation_m(LatLon::new(46.5, lon)), Some(7.0));
        }
    }
}
