//! The basemap file: what the map layer draws fastest.
//!
//! The format is described in `.ci/assets/basemap.py`, which writes it.

use super::bytes::{Bytes, Damaged};
use geometry::LatLon;

/// Units of the file in a degree.
const UNITS_PER_DEG: f32 = 1000.0;
/// Edges beyond these lie on the cut at the antimeridian or at the south pole and are no coast.
const CUT_LON_DEG: f32 = 179.98;
/// See [`CUT_LON_DEG`].
const CUT_LAT_DEG: f32 = -89.5;

/// Why bytes are not a basemap.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum BasemapError {
    /// Something else altogether.
    #[error("this is no basemap of version 1: make it again with .ci/assets/make")]
    Foreign,
    /// It began well.
    #[error("the basemap is damaged at byte {0}: make it again with .ci/assets/make")]
    Damaged(usize),
}

/// A box in degrees: longitudes and latitudes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Least longitude and latitude, degrees.
    pub min: [f32; 2],
    /// Greatest longitude and latitude, degrees.
    pub max: [f32; 2],
}

impl Bounds {
    /// The box around `points`; empty (nothing overlaps it) without points.
    pub fn around(points: &[[f32; 2]]) -> Self {
        let mut bounds = Self { min: [f32::INFINITY; 2], max: [f32::NEG_INFINITY; 2] };
        for p in points {
            bounds.min = [bounds.min[0].min(p[0]), bounds.min[1].min(p[1])];
            bounds.max = [bounds.max[0].max(p[0]), bounds.max[1].max(p[1])];
        }
        bounds
    }

    /// They share at least a point.
    pub fn overlaps(&self, other: &Bounds) -> bool {
        (0..2).all(|axis| self.min[axis] <= other.max[axis] && other.min[axis] <= self.max[axis])
    }
}

/// A piece of land, as triangles.
#[derive(Debug, Clone, PartialEq)]
pub struct Land {
    /// The box around it.
    pub bounds: Bounds,
    /// Longitude and latitude, degrees.
    pub vertices: Vec<[f32; 2]>,
    /// Corners of the triangles, indices into `vertices`.
    pub triangles: Vec<[u32; 3]>,
}

/// A line to be stroked.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    /// The box around it.
    pub bounds: Bounds,
    /// Longitude and latitude, degrees.
    pub points: Vec<[f32; 2]>,
}

impl Polyline {
    fn new(points: Vec<[f32; 2]>) -> Self {
        Self { bounds: Bounds::around(&points), points }
    }
}

/// The world at one level of detail.
#[derive(Debug, Clone, PartialEq)]
pub struct Detail {
    /// The usual distance between vertices, degrees.
    pub spacing_deg: f32,
    /// Land, greatest first.
    pub lands: Vec<Land>,
    /// Where land meets water.
    pub coasts: Vec<Polyline>,
    /// Between countries.
    pub borders: Vec<Polyline>,
}

/// A country's name.
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Well inside the country.
    pub position: LatLon,
    /// 0 is the greatest country.
    pub rank: u32,
    /// English.
    pub name: String,
}

/// The world.
#[derive(Debug, Clone, PartialEq)]
pub struct Basemap {
    levels: Vec<Detail>,
    labels: Vec<Label>,
}

impl Basemap {
    /// Reads the bytes of a basemap file. Rings are split where they run along the antimeridian.
    ///
    /// # Errors
    /// Other bytes than those of a basemap, or damaged ones (with the place).
    pub fn read(bytes: &[u8]) -> Result<Self, BasemapError> {
        let mut rest = Bytes(bytes.strip_prefix(b"LWBM\x01").ok_or(BasemapError::Foreign)?);
        read_all(&mut rest).map_err(|Damaged| BasemapError::Damaged(bytes.len() - rest.0.len()))
    }

    /// From coarse to fine.
    pub fn levels(&self) -> &[Detail] {
        &self.levels
    }

    /// Country names, the greatest country first.
    pub fn labels(&self) -> &[Label] {
        &self.labels
    }

    /// The level to draw at a scale: the coarsest whose vertices are closer than about 8 pixels, else
    /// the finest.
    pub fn level_for(&self, deg_per_pixel: f32) -> Option<&Detail> {
        self.levels.iter().find(|l| l.spacing_deg < 8.0 * deg_per_pixel).or(self.levels.last())
    }
}

fn read_all(rest: &mut Bytes) -> Result<Basemap, Damaged> {
    let levels = (0..rest.count()?).map(|_| read_level(rest)).collect::<Result<_, _>>()?;
    let labels = (0..rest.count()?).map(|_| read_label(rest)).collect::<Result<_, _>>()?;
    if rest.0.is_empty() { Ok(Basemap { levels, labels }) } else { Err(Damaged) }
}

fn read_level(rest: &mut Bytes) -> Result<Detail, Damaged> {
    let spacing_deg = rest.unsigned()? as f32 / UNITS_PER_DEG;
    let (mut lands, mut coasts) = (Vec::new(), Vec::new());
    for _ in 0..rest.count()? {
        lands.push(read_land(rest, &mut coasts)?);
    }
    let borders =
        (0..rest.count()?).map(|_| read_points(rest).map(Polyline::new)).collect::<Result<_, _>>()?;
    Ok(Detail { spacing_deg, lands, coasts, borders })
}

fn read_land(rest: &mut Bytes, coasts: &mut Vec<Polyline>) -> Result<Land, Damaged> {
    let mut vertices = Vec::new();
    for _ in 0..rest.count()? {
        let ring = read_points(rest)?;
        coasts.extend(coasts_of(&ring));
        vertices.extend(ring);
    }
    let triangles =
        (0..rest.count()?).map(|_| read_triangle(rest, vertices.len())).collect::<Result<_, _>>()?;
    Ok(Land { bounds: Bounds::around(&vertices), vertices, triangles })
}

fn read_triangle(rest: &mut Bytes, vertices: usize) -> Result<[u32; 3], Damaged> {
    let corners = [rest.unsigned()?, rest.unsigned()?, rest.unsigned()?];
    if corners.iter().all(|c| (*c as usize) < vertices) { Ok(corners) } else { Err(Damaged) }
}

fn read_points(rest: &mut Bytes) -> Result<Vec<[f32; 2]>, Damaged> {
    let (mut x, mut y) = (0i32, 0i32);
    (0..rest.count()?)
        .map(|_| {
            x = x.checked_add(rest.signed()?).ok_or(Damaged)?;
            y = y.checked_add(rest.signed()?).ok_or(Damaged)?;
            if x.abs() > 180_000 || y.abs() > 90_000 {
                return Err(Damaged);
            }
            Ok([x as f32 / UNITS_PER_DEG, y as f32 / UNITS_PER_DEG])
        })
        .collect()
}

fn read_label(rest: &mut Bytes) -> Result<Label, Damaged> {
    let (lon, lat) = (rest.signed()?, rest.signed()?);
    let rank = rest.unsigned()?;
    let length = rest.count()?;
    let name = std::str::from_utf8(rest.take(length)?).map_err(|_| Damaged)?.to_owned();
    let unit = f64::from(UNITS_PER_DEG);
    let position = LatLon::new(f64::from(lat) / unit, f64::from(lon) / unit);
    if position.is_valid() { Ok(Label { position, rank, name }) } else { Err(Damaged) }
}

/// The parts of a ring that are coast: all of it, or what is left when edges on the cut are taken out.
fn coasts_of(ring: &[[f32; 2]]) -> Vec<Polyline> {
    let mut parts: Vec<Vec<[f32; 2]>> = vec![Vec::new()];
    let closed = ring.iter().chain(ring.first());
    let mut before: Option<[f32; 2]> = None;
    for p in closed {
        if before.is_some_and(|b| on_cut(b) && on_cut(*p)) {
            parts.push(Vec::new());
        }
        if let Some(part) = parts.last_mut() {
            part.push(*p);
        }
        before = Some(*p);
    }
    parts.into_iter().filter(|part| part.len() > 1).map(Polyline::new).collect()
}

fn on_cut(p: [f32; 2]) -> bool {
    p[0].abs() > CUT_LON_DEG || p[1] < CUT_LAT_DEG
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &[u8] = include_bytes!("../../../assets/basemap/world.lwbm");

    /// The land of a level that covers a place.
    fn covered(level: &Detail, lon: f32, lat: f32) -> bool {
        level.lands.iter().any(|land| {
            land.triangles.iter().any(|t| {
                let [a, b, c] = t.map(|i| land.vertices[i as usize]);
                let side =
                    |p: [f32; 2], q: [f32; 2]| (q[0] - p[0]) * (lat - p[1]) - (q[1] - p[1]) * (lon - p[0]);
                let sides = [side(a, b), side(b, c), side(c, a)];
                sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
            })
        })
    }

    #[test]
    fn land_is_where_land_is() {
        let map = Basemap::read(FILE).unwrap();
        for (place, lat, lon, land) in [
            ("Tennessee", 36.3, -84.2, true),
            ("Paris", 48.86, 2.35, true),
            ("Chukotka, beyond the antimeridian", 66.5, -175.0, true),
            ("Chukotka, before it", 66.5, 175.0, true),
            ("South Pole", -84.0, 0.0, true),
            ("Atlantic", 40.0, -40.0, false),
            ("Pacific", 0.0, -150.0, false),
            ("Caspian Sea", 42.0, 50.5, false),
        ] {
            for level in map.levels() {
                assert_eq!(covered(level, lon, lat), land, "{place} at {}°", level.spacing_deg);
            }
        }
    }

    #[test]
    fn no_line_crosses_the_map() {
        let map = Basemap::read(FILE).unwrap();
        for line in map.levels().iter().flat_map(|l| l.coasts.iter().chain(&l.borders)) {
            for pair in line.points.windows(2) {
                assert!((pair[0][0] - pair[1][0]).abs() < 30.0, "{pair:?}");
                assert!(!(on_cut(pair[0]) && on_cut(pair[1])), "{pair:?}");
            }
        }
    }

    #[test]
    fn detail_follows_the_scale() {
        let map = Basemap::read(FILE).unwrap();
        let far = map.level_for(360.0 / 1024.0).unwrap();
        let near = map.level_for(0.001).unwrap();
        assert!(far.spacing_deg > near.spacing_deg);
        assert_eq!(near.spacing_deg, map.levels().last().unwrap().spacing_deg);
    }

    #[test]
    fn a_label_lies_in_its_country() {
        let map = Basemap::read(FILE).unwrap();
        let usa = map.labels().iter().find(|l| l.name == "United States of America").unwrap();
        assert!((30.0..50.0).contains(&usa.position.lat_deg) && usa.rank < 5, "{usa:?}");
    }

    #[test]
    fn damaged_bytes_are_an_error() {
        assert_eq!(Basemap::read(b""), Err(BasemapError::Foreign));
        assert_eq!(Basemap::read(b"LWBM\x02"), Err(BasemapError::Foreign));
        for length in [5, 6, 7, 1000, FILE.len() / 2, FILE.len() - 1] {
            assert!(matches!(Basemap::read(&FILE[..length]), Err(BasemapError::Damaged(_))), "{length}");
        }
        let longer = [FILE, b"x"].concat();
        assert!(Basemap::read(&longer).is_err());
        // every kind of damage either reads as something drawable or is refused
        for at in (5..FILE.len()).step_by(FILE.len() / 97) {
            let mut bytes = FILE.to_vec();
            bytes[at] ^= 0xff;
            if let Ok(map) = Basemap::read(&bytes) {
                assert!(map.labels().iter().all(|l| l.position.is_valid()));
            }
        }
    }
}
