//! From positions to the coordinates of a raster: degrees, transverse Mercator (UTM), Web Mercator.

use geometry::LatLon;
use geometry::geodesy::normalise_180;

/// WGS84: equatorial radius, metres, and flattening. NAD83 and ETRS89 lie within 2 m of it.
const RADIUS_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// So far from its central meridian a transverse Mercator is used, degrees.
const REACH_DEG: f64 = 20.0;

/// How a raster's coordinates come from positions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Projection {
    /// Degrees east and north.
    Geographic,
    /// Metres.
    Transverse(Transverse),
    /// Metres on a sphere: EPSG:3857.
    WebMercator,
}

/// A transverse Mercator projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Transverse {
    pub meridian_deg: f64,
    pub latitude_deg: f64,
    pub scale: f64,
    pub false_east_m: f64,
    pub false_north_m: f64,
}

impl Projection {
    /// The projection of an EPSG code, if it is one of those that are understood.
    pub fn of_epsg(code: u16) -> Option<Self> {
        match code {
            // WGS84 in two and three dimensions, NAD83, ETRS89
            4326 | 4979 | 4269 | 4258 => Some(Self::Geographic),
            3857 => Some(Self::WebMercator),
            32601..=32660 => Some(Self::utm(code - 32600, true)),
            32701..=32760 => Some(Self::utm(code - 32700, false)),
            26901..=26923 => Some(Self::utm(code - 26900, true)),
            25828..=25838 => Some(Self::utm(code - 25800, true)),
            _ => None,
        }
    }

    /// A zone of the Universal Transverse Mercator grid.
    fn utm(zone: u16, north: bool) -> Self {
        Self::Transverse(Transverse {
            meridian_deg: f64::from(zone) * 6.0 - 183.0,
            latitude_deg: 0.0,
            scale: 0.9996,
            false_east_m: 500_000.0,
            false_north_m: if north { 0.0 } else { 10_000_000.0 },
        })
    }

    /// East and north, in the projection's units; `None` where it doesn't reach.
    pub fn forward(&self, p: LatLon) -> Option<(f64, f64)> {
        if !p.is_valid() {
            return None;
        }
        match self {
            Self::Geographic => Some((p.lon_deg, p.lat_deg)),
            Self::WebMercator => {
                let north = p.lat_deg.to_radians().tan().asinh();
                (p.lat_deg.abs() < 89.0).then_some((p.lon_deg.to_radians() * RADIUS_M, north * RADIUS_M))
            }
            Self::Transverse(transverse) => transverse.forward(p),
        }
    }

    /// Back to a position, to some centimetres.
    pub fn inverse(&self, (east, north): (f64, f64)) -> Option<LatLon> {
        let p = match self {
            Self::Geographic => LatLon::new(north, east),
            Self::WebMercator => {
                LatLon::new((north / RADIUS_M).sinh().atan().to_degrees(), (east / RADIUS_M).to_degrees())
            }
            Self::Transverse(transverse) => transverse.inverse(east, north)?,
        };
        p.is_valid().then_some(p)
    }
}

impl Transverse {
    /// Its numbers are finite, and of this world.
    pub(crate) fn is_plausible(&self) -> bool {
        let all = [self.meridian_deg, self.latitude_deg, self.scale, self.false_east_m, self.false_north_m];
        let is_on_earth = self.meridian_deg.abs() <= 180.0 && self.latitude_deg.abs() <= 89.0;
        all.iter().all(|x| x.is_finite()) && is_on_earth && self.scale > 0.0
    }

    /// Krüger's series, to the third order of the third flattening: millimetres within [`REACH_DEG`].
    fn forward(&self, p: LatLon) -> Option<(f64, f64)> {
        let away = (p.lon_deg - self.meridian_deg + 540.0).rem_euclid(360.0) - 180.0;
        if away.abs() > REACH_DEG || p.lat_deg.abs() > 89.0 {
            return None;
        }
        let (east, north) = kruger(p.lat_deg.to_radians(), away.to_radians());
        let (_, origin) = kruger(self.latitude_deg.to_radians(), 0.0);
        Some((self.false_east_m + self.scale * east, self.false_north_m + self.scale * (north - origin)))
    }

    /// By correcting a guess: it halves its error many times over at each step.
    fn inverse(&self, east: f64, north: f64) -> Option<LatLon> {
        let mut p = LatLon::new(self.latitude_deg, self.meridian_deg);
        for _ in 0..20 {
            let (x, y) = self.forward(p)?;
            let lat_deg = (p.lat_deg + ((north - y) / RADIUS_M).to_degrees()).clamp(-88.0, 88.0);
            let parallel_m = RADIUS_M * lat_deg.to_radians().cos();
            let lon_deg = p.lon_deg + ((east - x) / parallel_m).to_degrees();
            let (west, limit) = (self.meridian_deg - REACH_DEG, self.meridian_deg + REACH_DEG);
            p = LatLon::new(lat_deg, lon_deg.clamp(west, limit));
        }
        // a zone at the antimeridian reaches over it
        Some(LatLon::new(p.lat_deg, normalise_180(p.lon_deg)))
    }
}

/// Metres east of the central meridian and north of the equator, on a scale of 1.
fn kruger(lat: f64, away: f64) -> (f64, f64) {
    let n = FLATTENING / (2.0 - FLATTENING);
    let series = [
        n / 2.0 - n * n * 2.0 / 3.0 + n * n * n * 5.0 / 16.0,
        n * n * 13.0 / 48.0 - n * n * n * 3.0 / 5.0,
        n * n * n * 61.0 / 240.0,
    ];
    let eccentricity = (FLATTENING * (2.0 - FLATTENING)).sqrt();
    let sine = lat.sin();
    // tangent of the conformal latitude
    let t = (sine.atanh() - eccentricity * (eccentricity * sine).atanh()).sinh();
    let xi = t.atan2(away.cos());
    let eta = (away.sin() / (t * t + away.cos().powi(2)).sqrt()).asinh();
    let (mut east, mut north) = (eta, xi);
    for (factor, k) in series.into_iter().zip([2.0, 4.0, 6.0]) {
        east += factor * (k * xi).cos() * (k * eta).sinh();
        north += factor * (k * xi).sin() * (k * eta).cosh();
    }
    let rectifying_m = RADIUS_M / (1.0 + n) * (1.0 + n * n / 4.0 + n.powi(4) / 64.0);
    (rectifying_m * east, rectifying_m * north)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn utm_agrees_with_known_points() {
        // computed by PROJ
        for (epsg, lat, lon, east, north) in [
            (32631, 0.0, 3.0, 500_000.0, 0.0),
            (32734, -33.92, 18.42, 261_488.826, 6_243_716.333),
            (32616, 36.319, -84.173, 753_791.700, 4_023_041.232),
            (25832, 67.9, 16.2, 801_722.000, 7_549_309.879),
        ] {
            let (x, y) = Projection::of_epsg(epsg).unwrap().forward(LatLon::new(lat, lon)).unwrap();
            assert!((x - east).abs() < 0.005 && (y - north).abs() < 0.005, "{epsg}: {x} {y}");
        }
    }

    #[test]
    fn a_step_in_utm_is_as_long_as_the_geodesic() {
        let utm = Projection::of_epsg(32616).unwrap();
        for (lat, lon) in [(36.3, -87.0), (36.3, -84.2), (60.0, -86.0), (-12.0, -88.5)] {
            let from = LatLon::new(lat, lon);
            let to = from.destination(37.0, 100.0);
            let ((ax, ay), (bx, by)) = (utm.forward(from).unwrap(), utm.forward(to).unwrap());
            let scale = (bx - ax).hypot(by - ay) / 100.0;
            // grows with the square of the distance from the meridian
            let radius_m = 6.37e6 / 0.9996;
            let expected = 0.9996 * (1.0 + ((ax - 500_000.0) / radius_m).powi(2) / 2.0);
            assert!((scale - expected).abs() < 2e-5, "{lat} {lon}: {scale} {expected}");
        }
        // the meridian's length from the equator to 45°, scaled
        let (_, north) = utm.forward(LatLon::new(45.0, -87.0)).unwrap();
        assert!((north - 0.9996 * 4_984_944.378).abs() < 0.01, "{north}");
    }

    #[test]
    fn what_is_not_understood_is_none() {
        assert_eq!(Projection::of_epsg(2154), None, "Lambert-93");
        assert_eq!(Projection::of_epsg(32661), None, "UPS");
        let utm = Projection::of_epsg(32616).unwrap();
        assert_eq!(utm.forward(LatLon::new(36.0, 87.0)), None, "the other side of the Earth");
        assert_eq!(utm.forward(LatLon::new(f64::NAN, -87.0)), None);
    }

    proptest! {
        #[test]
        fn inverse_undoes_forward(lat in -80.0..80.0f64, away in -4.0..4.0f64, code in prop_oneof![
            Just(4326u16), Just(3857), 32601..=32660u16, 32701..=32760u16,
        ]) {
            let projection = Projection::of_epsg(code).unwrap();
            let meridian = match projection {
                Projection::Transverse(t) => t.meridian_deg,
                _ => 10.0,
            };
            let p = LatLon::new(lat, (meridian + away).clamp(-180.0, 180.0));
            let back = projection.inverse(projection.forward(p).unwrap()).unwrap();
            prop_assert!(back.distance_m(p) < 0.1, "{:?} {:?}", p, back);
        }
    }
}
