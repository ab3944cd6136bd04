//! One elevation tile: a square of one degree, as SRTM and NASADEM publish it (`N36W085.hgt`).
//!
//! Format: no header; rows from north to south, samples from west to east, big-endian signed 16-bit
//! metres above the EGM96 geoid; the outermost rows and columns lie on the whole degrees, so that neighbours
//! share them. 1201 samples a side are 3″, 3601 are 1″. −32768 is a void. The name gives the south-west corner.
//! (USGS, *SRTM Topo*, "Documentation".)
// the bytes come from outside
#![warn(clippy::indexing_slicing, clippy::cast_possible_truncation, clippy::cast_sign_loss)]

use crate::METRES_PER_DEGREE;
use crate::grid::Grid;
use geometry::LatLon;

/// What the format calls "not measured".
const VOID: i16 = i16::MIN;
/// Elevations on Earth's land, metres; what is outside is a fault of the data and counts as void.
const PLAUSIBLE_M: std::ops::RangeInclusive<i16> = -500..=9000;
/// Samples a side of the two resolutions in use.
const SIDES: [usize; 2] = [1201, 3601];

/// Why bytes are not an elevation tile.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TileError {
    /// The name does not give a corner.
    #[error(
        "`{0}` is not the name of an elevation tile: name it after its south-west corner, like N36W085.hgt"
    )]
    Name(String),
    /// The length fits neither resolution.
    #[error(
        "an elevation tile has 2884802 bytes (3″) or 25934402 bytes (1″), this one has {0}: get the file again"
    )]
    Length(usize),
    /// Nothing but voids.
    #[error("the elevation tile holds no elevation at all: get the file again")]
    Empty,
}

/// One degree by one degree of ground.
#[derive(Clone, PartialEq, Eq)]
pub struct Tile {
    south_deg: i32,
    west_deg: i32,
    grid: Grid<i16>,
}

impl std::fmt::Debug for Tile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Tile({}°, {}°, {} samples a side)", self.south_deg, self.west_deg, self.grid.size().0)
    }
}

impl Tile {
    /// Reads the bytes of a `.hgt` file; `name` is its file name, with or without the extension.
    ///
    /// # Errors
    /// A name without a corner, a length of neither resolution, or nothing but voids.
    pub fn from_hgt(name: &str, bytes: &[u8]) -> Result<Self, TileError> {
        let (south_deg, west_deg) =
            corner(name).ok_or_else(|| TileError::Name(name.chars().take(80).collect()))?;
        let side = SIDES
            .into_iter()
            .find(|side| bytes.len() == side * side * 2)
            .ok_or(TileError::Length(bytes.len()))?;
        let grid = Grid::new(side, bytes.as_chunks::<2>().0.iter().copied().map(sample).collect());
        if !grid.knows_something() {
            return Err(TileError::Empty);
        }
        Ok(Self { south_deg, west_deg, grid })
    }

    /// South-west corner, whole degrees: `(latitude, longitude)`.
    pub fn corner_deg(&self) -> (i32, i32) {
        (self.south_deg, self.west_deg)
    }

    /// Distance between samples, degrees of latitude and of longitude.
    pub fn spacing_deg(&self) -> f64 {
        1.0 / self.last()
    }

    /// Distance between samples along a meridian, metres, roughly.
    pub fn spacing_m(&self) -> f64 {
        self.spacing_deg() * METRES_PER_DEGREE
    }

    /// The box around everything that is known: `(south-west, north-east)`.
    pub fn known_box(&self) -> (LatLon, LatLon) {
        let ((left, right), (top, bottom)) = self.grid.known();
        (self.place(bottom, left), self.place(top, right))
    }

    /// Metres AMSL at `p`, bilinear between the four samples around it; `None` outside the tile or
    /// where a sample that matters is void.
    pub fn elevation_m(&self, p: LatLon) -> Option<f64> {
        self.grid.at(self.column(p.lon_deg), self.row(p.lat_deg))
    }

    /// Metres that no elevation in a box is above; `None`: nothing is known there.
    pub fn at_most_m(&self, south_west: LatLon, north_east: LatLon) -> Option<f64> {
        let columns = (self.column(south_west.lon_deg), self.column(north_east.lon_deg));
        self.grid.highest(columns, (self.row(north_east.lat_deg), self.row(south_west.lat_deg)))
    }

    /// Samples a side, less one.
    fn last(&self) -> f64 {
        (self.grid.size().0 - 1) as f64
    }

    fn column(&self, lon_deg: f64) -> f64 {
        (lon_deg - f64::from(self.west_deg)) * self.last()
    }

    fn row(&self, lat_deg: f64) -> f64 {
        (f64::from(self.south_deg) + 1.0 - lat_deg) * self.last()
    }

    fn place(&self, row: usize, column: usize) -> LatLon {
        let step = self.spacing_deg();
        LatLon::new(
            f64::from(self.south_deg) + 1.0 - row as f64 * step,
            f64::from(self.west_deg) + column as f64 * step,
        )
    }
}

/// The corner that a tile's file name gives, and whether it is as long as a tile of one of the resolutions, bytes.
pub fn announced(name: &str, bytes: u64) -> Option<(i32, i32)> {
    let is_whole = SIDES.iter().any(|side| bytes == (side * side * 2) as u64);
    corner(name).filter(|_| is_whole)
}

fn sample(pair: [u8; 2]) -> i16 {
    let value = i16::from_be_bytes(pair);
    if PLAUSIBLE_M.contains(&value) { value } else { VOID }
}

/// The name of the file (`N36W085.hgt`) that has the elevation of a position; `None`: it is none on Earth.
pub fn file_name(of: LatLon) -> Option<String> {
    if !of.is_valid() {
        return None;
    }
    // the tile of the last degree has its northern and eastern edges, too
    let (south, west) = (of.lat_deg.floor().min(89.0), of.lon_deg.floor().min(179.0));
    let (ns, ew) = (if south < 0.0 { 'S' } else { 'N' }, if west < 0.0 { 'W' } else { 'E' });
    Some(format!("{ns}{:02}{ew}{:03}.hgt", south.abs(), west.abs()))
}

/// The Shuttle Radar Topography Mission measured it: from 56° S to 60° N. (USGS, *SRTM Topo*, "Documentation".)
pub fn is_within_srtm(position: LatLon) -> bool {
    (-56.0..=60.0).contains(&position.lat_deg)
}

/// `N36W085` (any case, any extension) as degrees of the south-west corner.
fn corner(name: &str) -> Option<(i32, i32)> {
    let stem = name.split('.').next()?.as_bytes();
    let [ns, lat @ .., ew, e1, e2, e3] = stem else {
        return None;
    };
    let lat_deg = signed(*ns, b'N', b'S', lat, 2, 90)?;
    let lon_deg = signed(*ew, b'E', b'W', &[*e1, *e2, *e3], 3, 180)?;
    // the tile extends one degree north and east of its corner
    (lat_deg < 90 && lon_deg < 180).then_some((lat_deg, lon_deg))
}

fn signed(sign: u8, plus: u8, minus: u8, digits: &[u8], count: usize, limit: i32) -> Option<i32> {
    if digits.len() != count || !digits.iter().all(u8::is_ascii_digit) {
        return None;
    }
    let value = digits.iter().fold(0, |n, d| n * 10 + i32::from(d - b'0'));
    let value = match sign.to_ascii_uppercase() {
        s if s == plus => value,
        s if s == minus => -value,
        _ => return None,
    };
    (value.abs() <= limit).then_some(value)
}

#[cfg(test)]
pub(crate) mod tests {
    #![expect(clippy::cast_possible_truncation, reason = "made-up elevations are small")]

    use super::*;
    use proptest::prelude::*;

    /// HGT bytes of a 3″ tile whose samples are `f(row, column)`.
    pub(crate) fn hgt(f: impl Fn(usize, usize) -> i16) -> Vec<u8> {
        (0..1201 * 1201).flat_map(|i| f(i / 1201, i % 1201).to_be_bytes()).collect()
    }

    #[test]
    fn the_file_of_a_position_is_named() {
        for (lat, lon, expected) in [
            (36.3, -84.2, "N36W085.hgt"),
            (-0.5, 0.5, "S01E000.hgt"),
            (36.0, -84.0, "N36W084.hgt"),
            (-90.0, 180.0, "S90E179.hgt"),
            (90.0, -180.0, "N89W180.hgt"),
        ] {
            let name = file_name(LatLon::new(lat, lon)).unwrap();
            assert_eq!(name, expected);
            assert!(corner(&name).is_some());
        }
        assert_eq!(file_name(LatLon::new(f64::NAN, 0.0)), None);
    }

    #[test]
    fn names() {
        for (name, expected) in [
            ("N36W085.hgt", Some((36, -85))),
            ("s01e000", Some((-1, 0))),
            ("N00E179.SRTMGL1.hgt", Some((0, 179))),
            ("S90W180.hgt", Some((-90, -180))),
            ("N90E000.hgt", None),
            ("N00E180.hgt", None),
            ("N91E000.hgt", None),
            ("N3W085.hgt", None),
            ("N36W85.hgt", None),
            ("X36W085.hgt", None),
            ("N3éW085", None),
            ("", None),
            (".hgt", None),
        ] {
            assert_eq!(corner(name), expected, "{name}");
        }
    }

    #[test]
    fn bad_bytes_are_errors() {
        let good = hgt(|_, _| 7);
        assert!(matches!(Tile::from_hgt("tile.hgt", &good), Err(TileError::Name(_))));
        assert_eq!(Tile::from_hgt("N36W085.hgt", &good[1..]), Err(TileError::Length(good.len() - 1)));
        assert_eq!(Tile::from_hgt("N36W085.hgt", &[]), Err(TileError::Length(0)));
        assert_eq!(Tile::from_hgt("N36W085.hgt", &hgt(|_, _| VOID)), Err(TileError::Empty));
        // 32767 is what some tools write for "nothing"
        assert_eq!(Tile::from_hgt("N36W085.hgt", &hgt(|_, _| i16::MAX)), Err(TileError::Empty));
    }

    #[test]
    fn voids_and_outside_are_unknown() {
        let bytes = hgt(|row, column| if (row, column) == (600, 600) { VOID } else { 100 });
        let tile = Tile::from_hgt("N36W085.hgt", &bytes).unwrap();
        let step = tile.spacing_deg();
        for (north, east, known) in
            [(0.0, 0.0, false), (0.5, 0.5, false), (1.5, 0.0, true), (0.0, -1.5, true)]
        {
            let p = LatLon::new(36.5 + north * step, -84.5 + east * step);
            assert_eq!(tile.elevation_m(p).is_some(), known, "{north} {east}");
        }
        for (lat, lon) in
            [(35.999, -84.5), (37.001, -84.5), (36.5, -85.001), (36.5, -83.999), (f64::NAN, -84.5)]
        {
            assert_eq!(tile.elevation_m(LatLon::new(lat, lon)), None);
        }
    }

    #[test]
    fn known_box_is_the_box_of_the_data() {
        let bytes =
            hgt(|r, c| if (321..=664).contains(&r) && (704..=1106).contains(&c) { 300 } else { VOID });
        let (sw, ne) = Tile::from_hgt("N36W085.hgt", &bytes).unwrap().known_box();
        assert!(
            (sw.lat_deg - (37.0 - 664.0 / 1200.0)).abs() < 1e-9
                && (sw.lon_deg + 85.0 - 704.0 / 1200.0).abs() < 1e-9
        );
        assert!(
            (ne.lat_deg - (37.0 - 321.0 / 1200.0)).abs() < 1e-9
                && (ne.lon_deg + 85.0 - 1106.0 / 1200.0).abs() < 1e-9
        );
    }

    /// A plane: 2 m a row southwards, 3 m a column eastwards.
    static PLANE: std::sync::LazyLock<Tile> = std::sync::LazyLock::new(|| {
        Tile::from_hgt("S01E006.hgt", &hgt(|r, c| (r * 2 + c * 3) as i16)).unwrap()
    });

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn bilinear_is_exact_on_a_plane(points in prop::collection::vec((0.0..=1200.0f64, 0.0..=1200.0f64), 64)) {
                        for (row, column) in points {
                let p = LatLon::new(-row / 1200.0, 6.0 + column / 1200.0);
                let elevation = PLANE.elevation_m(p).unwrap();
                prop_assert!((elevation - (row * 2.0 + column * 3.0)).abs() < 1e-6);
            }
        }

        #[test]
        fn any_bytes_and_name_never_panic(name in ".{0,12}", bytes in prop::collection::vec(any::<u8>(), 0..64)) {
            prop_assert!(Tile::from_hgt(&name, &bytes).is_err());
        }
    }
}
