//! The path flown so far: as many points as a map needs, however long the flight.

use serde::Deserialize;
use serde_json::json;
use std::time::Duration;

/// Points that are kept: when there are more, every second one goes.
const POINTS_MAX: usize = 2000;
/// Least time between two points at first.
const INTERVAL: Duration = Duration::from_secs(1);

/// Where the aircraft was.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    pub lat_deg: f64,
    pub lon_deg: f64,
    pub altitude_amsl_m: f64,
}

impl Point {
    /// Of a `position` of the gateway, as it stands in a recording; `None` for what is no place.
    pub fn of(position: &[u8]) -> Option<Self> {
        let Sample { value } = serde_json::from_slice(position).ok()?;
        let LatLon { lat_deg, lon_deg } = value.position;
        let is_place = (-90.0..=90.0).contains(&lat_deg)
            && (-180.0..=180.0).contains(&lon_deg)
            && value.altitude_amsl_m.is_finite();
        is_place.then_some(Self { lat_deg, lon_deg, altitude_amsl_m: value.altitude_amsl_m })
    }
}

/// What is read of the contract's `Stamped<Position>`.
#[derive(Deserialize)]
struct Sample {
    value: Position,
}

#[derive(Deserialize)]
struct Position {
    position: LatLon,
    altitude_amsl_m: f64,
}

#[derive(Deserialize)]
struct LatLon {
    lat_deg: f64,
    lon_deg: f64,
}

/// The path so far.
#[derive(Debug, Clone)]
pub struct Path {
    points: Vec<Point>,
    interval: Duration,
    next: Duration,
}

impl Default for Path {
    fn default() -> Self {
        Self { points: Vec::new(), interval: INTERVAL, next: Duration::ZERO }
    }
}

impl Path {
    /// Takes a point in, if it is time for one.
    pub fn add(&mut self, at: Duration, point: Point) {
        if at < self.next {
            return;
        }
        self.next = at + self.interval;
        self.points.push(point);
        if self.points.len() > POINTS_MAX {
            let mut index = 0;
            self.points.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.interval *= 2;
        }
    }

    /// As a GeoJSON document; `None` before there is a line to be drawn.
    pub fn geojson(&self) -> Option<String> {
        let line: Vec<_> = self.points.iter().map(|p| (p.lon_deg, p.lat_deg, p.altitude_amsl_m)).collect();
        let feature = json!({
            "type": "Feature",
            "properties": {"name": "path flown"},
            "geometry": {"type": "LineString", "coordinates": line},
        });
        (self.points.len() > 1)
            .then(|| json!({"type": "FeatureCollection", "features": [feature]}).to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_flights_keep_few_points_and_their_beginning() {
        let mut path = Path::default();
        for second in 0..100_000u32 {
            let lat_deg = f64::from(second) / 100_000.0;
            path.add(
                Duration::from_secs(second.into()),
                Point { lat_deg, lon_deg: 1.0, altitude_amsl_m: 2.0 },
            );
        }
        assert!((POINTS_MAX / 2..=POINTS_MAX).contains(&path.points.len()), "{}", path.points.len());
        assert_eq!(path.points[0].lat_deg, 0.0);
        assert!(path.points.last().unwrap().lat_deg > 0.99);
        assert!(path.points.windows(2).all(|w| w[0].lat_deg < w[1].lat_deg));
    }

    #[test]
    fn only_places_are_points() {
        let sample = |lat: &str| {
            format!(
                r#"{{"time_s":1,"validity_s":1,"value":{{"position":{{"lat_deg":{lat},"lon_deg":2}},"altitude_amsl_m":3,"x":4}}}}"#
            )
        };
        assert_eq!(
            Point::of(sample("1.5").as_bytes()),
            Some(Point { lat_deg: 1.5, lon_deg: 2.0, altitude_amsl_m: 3.0 })
        );
        for bad in ["91", "null", "\"x\""] {
            assert_eq!(Point::of(sample(bad).as_bytes()), None, "{bad}");
        }
        assert_eq!(Path::default().geojson(), None);
    }
}
