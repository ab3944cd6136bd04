//! A path that the vehicle tells (`Foresight`), over the ground as this window knows it. The legs on it are not told.

use super::{Forecast, Point};
use flight_exec::PathPoint;
use geometry::LocalFrame;
use terrain::Terrain;

/// So often the ground below is looked at, metres.
const EVERY_M: f64 = 50.0;
/// But not more often than this on the whole path.
const MOST_POINTS: f64 = 4000.0;
/// Higher above the end of its roll-out an aircraft still flies, metres.
const LEVEL_M: f64 = 0.5;
/// Nobody descends to a runway from farther out, metres.
const FINAL_M: f64 = 4000.0;

/// The path as map and profile need it: without passages.
pub fn told(path: &[PathPoint], terrain: &dyn Terrain) -> Forecast {
    let is_usable = |p: &&PathPoint| {
        p.position.is_valid() && p.altitude_amsl_m.is_finite() && p.time_s.is_finite() && p.time_s >= 0.0
    };
    let path: Vec<&PathPoint> = path.iter().filter(is_usable).collect();
    let spans = || path.iter().zip(path.iter().skip(1));
    let length_m: f64 = spans().map(|(a, b)| a.position.distance_m(b.position)).sum();
    let every_m = EVERY_M.max(length_m / MOST_POINTS);
    let mut points = Vec::new();
    let mut flown_m = 0.0;
    for (from, to) in spans() {
        let frame = LocalFrame::new(from.position);
        let way = frame.to_local(to.position);
        let steps = (way.length() / every_m).ceil().clamp(1.0, MOST_POINTS) as u32;
        for step in 0..steps {
            let share = f64::from(step) / f64::from(steps);
            points.push(Point {
                time_s: from.time_s + (to.time_s - from.time_s) * share,
                distance_m: flown_m + way.length() * share,
                position: frame.to_geo(way * share),
                altitude_amsl_m: from.altitude_amsl_m + (to.altitude_amsl_m - from.altitude_amsl_m) * share,
                ground_amsl_m: None,
                passage: 0,
            });
        }
        flown_m += way.length();
    }
    points.extend(path.last().map(|end| Point {
        time_s: end.time_s,
        distance_m: flown_m,
        position: end.position,
        altitude_amsl_m: end.altitude_amsl_m,
        ground_amsl_m: None,
        passage: 0,
    }));
    points.iter_mut().for_each(|point| point.ground_amsl_m = terrain.elevation_m(point.position));
    Forecast { points, ..Forecast::default() }
}

/// A path that ends on the ground, without its roll-out: who waits for a landing looks at the touch-down.
pub fn until_touch_down(mut path: Forecast) -> Forecast {
    let end_m = path.points.last().map_or(0.0, |end| end.altitude_amsl_m);
    let rolls = |point: &&Point| (point.altitude_amsl_m - end_m).abs() < LEVEL_M;
    let rolling = path.points.iter().rev().take_while(rolls).count();
    // one that is level all along tells nothing of it
    if rolling < path.points.len() {
        path.points.truncate(path.points.len() + 1 - rolling);
    }
    path
}

/// The least height above the ground on a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clearance {
    /// Metres, where the ground is known.
    pub least_m: f64,
    /// The ground is known below all of the path.
    pub is_whole: bool,
}

/// Until the descent to the runway, if the path ends on one; `None`: the ground is known nowhere.
pub fn clearance(path: &Forecast, lands: bool) -> Option<Clearance> {
    let points = &path.points;
    let before = if lands { before_descent(points) } else { points.len() };
    let judged = points.get(..before.max(1))?;
    let heights = judged.iter().filter_map(|point| Some(point.altitude_amsl_m - point.ground_amsl_m?));
    let least_m = heights.min_by(f64::total_cmp)?;
    Some(Clearance { least_m, is_whole: judged.iter().all(|point| point.ground_amsl_m.is_some()) })
}

/// How many points are before the last descent.
fn before_descent(points: &[Point]) -> usize {
    let end_m = points.last().map_or(0.0, |end| end.distance_m);
    let pairs = points.iter().zip(points.iter().skip(1)).rev();
    let sinks =
        |(a, b): &(&Point, &Point)| a.altitude_amsl_m >= b.altitude_amsl_m && end_m - a.distance_m < FINAL_M;
    points.len().saturating_sub(1 + pairs.take_while(sinks).count())
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::LatLon;
    use terrain::Flat;

    /// North over the runway's end: level, then down to 300 m.
    fn path() -> Vec<PathPoint> {
        [(0.0, 8000.0, 500.0), (200.0, 3000.0, 500.0), (320.0, 0.0, 300.0)]
            .map(|(time_s, out_m, altitude_amsl_m)| PathPoint {
                time_s,
                position: LatLon::new(36.3, -84.2).destination(180.0, out_m),
                altitude_amsl_m,
            })
            .to_vec()
    }

    /// Known in the south only, with a hill there.
    struct Hill;

    impl Terrain for Hill {
        fn elevation_m(&self, p: LatLon) -> Option<f64> {
            let out_m = p.distance_m(LatLon::new(36.3, -84.2));
            (out_m > 5000.0).then_some(if (6000.0..6200.0).contains(&out_m) { 450.0 } else { 300.0 })
        }
    }

    #[test]
    fn hill_between_two_points_is_found_and_what_is_not_known_is_told() {
        let found = clearance(&told(&path(), &Hill), true).unwrap();
        assert!((found.least_m - 50.0).abs() < 1e-6 && !found.is_whole, "{found:?}");
        struct Unknown;
        impl Terrain for Unknown {
            fn elevation_m(&self, _: LatLon) -> Option<f64> {
                None
            }
        }
        assert_eq!(clearance(&told(&path(), &Unknown), true), None);
    }

    #[test]
    fn descent_to_the_runway_is_not_low_and_one_to_nowhere_is() {
        let over_ground = told(&path(), &Flat(300.0));
        let least_m = |lands| clearance(&over_ground, lands).unwrap().least_m;
        assert!((least_m(true) - 200.0).abs() < 1e-6 && least_m(false).abs() < 1e-6);
        // from afar it is no final descent
        let mut steep = path();
        steep.remove(1);
        let steep = clearance(&told(&steep, &Flat(300.0)), true).unwrap();
        assert!((90.0..110.0).contains(&steep.least_m), "{steep:?}");
    }

    #[test]
    fn landing_ends_where_it_touches_down_and_not_where_it_stands() {
        let end = path()[2];
        let rolled =
            |s, m| PathPoint { time_s: end.time_s + s, position: end.position.destination(0.0, m), ..end };
        let with_roll_out: Vec<_> =
            path().into_iter().chain([rolled(20.0, 200.0), rolled(36.0, 250.0)]).collect();
        let duration_s = |path: &[PathPoint]| until_touch_down(told(path, &Flat(300.0))).duration_s();
        assert_eq!((duration_s(&with_roll_out), duration_s(&path())), (320.0, 320.0));
        assert_eq!(
            duration_s(&with_roll_out[3..]),
            356.0,
            "it stands already, or nothing is known of a descent"
        );
        assert_eq!(duration_s(&[]), 0.0);
    }

    #[test]
    fn what_makes_no_sense_is_left_out_and_a_long_path_has_few_points() {
        let mut bad = path();
        bad.push(PathPoint { altitude_amsl_m: f64::NAN, ..bad[0] });
        bad.push(PathPoint { position: LatLon::new(f64::NAN, 0.0), ..bad[0] });
        assert_eq!(told(&bad, &Flat(0.0)), told(&path(), &Flat(0.0)));
        let far = [LatLon::new(10.0, 0.0), LatLon::new(-10.0, 60.0), LatLon::new(10.0, 120.0)];
        let far: Vec<_> = far.map(|position| PathPoint { position, ..path()[0] }).into();
        assert!(told(&far, &Flat(0.0)).points.len() < 5000);
        assert!(told(&[], &Flat(0.0)).points.is_empty());
        assert_eq!(clearance(&told(&[], &Flat(0.0)), true), None);
    }
}
