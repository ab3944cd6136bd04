//! GeoTIFF elevations in a folder: together they are one ground.

use super::Content;
use super::open::{around, raster};
use crate::jobs::Progress;
use geometry::LatLon;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Raster, Stack, Terrain};

/// Most bytes of elevations that are kept in memory.
const MOST_BYTES: usize = 512 << 20;
/// Most files that are named with why they were not taken.
const MOST_NAMED: usize = 3;

/// What was taken of them so far.
#[derive(Default)]
struct Found {
    rasters: Vec<Raster>,
    bytes: usize,
    /// What was not, and why.
    left_out: Vec<String>,
}

/// The ground of these files, the finer ones over the coarser ones.
pub(super) fn ground(paths: &[PathBuf], progress: &Progress) -> Result<Content, String> {
    let mut found = Found::default();
    for (done, path) in paths.iter().enumerate() {
        progress.set(done as u64, paths.len() as u64);
        if progress.is_cancelled() {
            return Err("it was cancelled".into());
        }
        if let Err(why) = found.add(path) {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            found.left_out.push(format!("{name}: {why}"));
        }
    }
    let Found { mut rasters, left_out, .. } = found;
    if rasters.is_empty() {
        return Err(format!("none of its {} GeoTIFFs can be taken ({})", paths.len(), named(&left_out)));
    }
    rasters.sort_by(|a, b| spacing_m(a).total_cmp(&spacing_m(b)));
    let detail = detail(rasters.len(), &left_out);
    let bounds = around(rasters.iter().filter_map(Raster::known_box));
    let terrain = rasters.into_iter().map(|raster| Arc::new(raster) as Arc<dyn Terrain>).collect();
    Ok(Content::Ground { terrain: Arc::new(Stack(terrain)), bounds, detail })
}

impl Found {
    fn add(&mut self, path: &Path) -> Result<(), String> {
        let no_room =
            || "there is no memory for it beside the others: add it alone, or make it coarser".to_owned();
        if self.bytes >= MOST_BYTES {
            return Err(no_room());
        }
        let raster = raster(path)?;
        let (columns, rows) = raster.size();
        let bytes = self.bytes.saturating_add(columns.saturating_mul(rows).saturating_mul(size_of::<f32>()));
        if bytes > MOST_BYTES && !self.rasters.is_empty() {
            return Err(no_room());
        }
        self.bytes = bytes;
        self.rasters.push(raster);
        Ok(())
    }
}

/// Between its samples in its middle.
fn spacing_m(raster: &Raster) -> f64 {
    let middle = raster
        .known_box()
        .map(|(a, b)| LatLon::new(f64::midpoint(a.lat_deg, b.lat_deg), f64::midpoint(a.lon_deg, b.lon_deg)));
    middle.and_then(|at| raster.spacing_m(at)).unwrap_or(f64::INFINITY)
}

/// `elevations, 2 files, 1 left out (b.tif: it is a picture)`.
fn detail(taken: usize, left_out: &[String]) -> String {
    let files = format!("elevations, {taken} file{}", if taken == 1 { "" } else { "s" });
    match left_out.len() {
        0 => files,
        number => format!("{files}, {number} left out ({})", named(left_out)),
    }
}

fn named(left_out: &[String]) -> String {
    let mut said: Vec<String> = left_out.iter().take(MOST_NAMED).cloned().collect();
    if let more @ 1.. = left_out.len().saturating_sub(MOST_NAMED) {
        said.push(format!("and {more} more"));
    }
    said.join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_taken_is_named_with_the_reason_as_far_as_there_is_room() {
        let left_out = |number: usize| (0..number).map(|n| format!("{n}.tif: why")).collect::<Vec<_>>();
        assert_eq!(detail(1, &[]), "elevations, 1 file");
        assert_eq!(detail(2, &left_out(1)), "elevations, 2 files, 1 left out (0.tif: why)");
        let many = detail(2, &left_out(9));
        assert!(many.ends_with("9 left out (0.tif: why; 1.tif: why; 2.tif: why; and 6 more)"), "{many}");
    }
}
