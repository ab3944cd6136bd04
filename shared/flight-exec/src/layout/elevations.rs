//! What to do where nothing is known of the ground, in words.

use geometry::LatLon;

/// How elevations get to the programs.
pub fn how_to_load(file: &str) -> String {
    format!("`--terrain {file}`, aboard also `terrain` in agent.toml; onto a window it is dropped")
}

/// The tile that has the ground of a position, and how to load it. The same for all positions of a tile.
pub fn wanted_at(at: LatLon) -> String {
    let Some(file) = terrain::tile::file_name(at) else { return "its elevations".into() };
    let how = how_to_load(&file);
    match beyond_srtm(at) {
        None => format!("the elevation tile {file} ({how})"),
        Some(model) => format!("the elevation tile {file}, of {model} ({how})"),
    }
}

/// Which elevations there are where the usual ones end.
pub fn beyond_srtm(at: LatLon) -> Option<&'static str> {
    let model = "an elevation model other than SRTM, which ends at 60° N and 56° S";
    (!terrain::tile::is_within_srtm(at)).then_some(model)
}
