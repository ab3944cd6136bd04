//! Zones to stay in are one area: where they touch or overlap, the edge of one is no edge.

use super::prepared::{At, Piece, Prepared};
use geometry::PathElement;
use geometry::zone::Breach;
use terrain::Terrain;

/// Pieces of path shorter than this, metres, and than a share of the margin are not halved any more, if they climb less, too.
const FINEST_M: f64 = 2.0;
const FINEST_SHARE_OF_MARGIN: f64 = 0.25;
const FINEST_CLIMB_M: f64 = 1.0;
/// More halvings than any flight needs.
const MAX_HALVINGS: u32 = 24;
/// Between zones that share an edge, less than this is no gap, metres: each edge is exact to that in the frame of its zone.
const SEAM_M: f64 = 1.0;
/// It is looked for the outside in so many directions, and at so many shares of the margin.
const BEARINGS: u32 = 16;
const SHARES: [f64; 2] = [0.5, 1.0];

/// A zone, and whether it is only perhaps active.
type Active<'z> = (&'z Prepared, bool);

/// How the zones to stay in are held against a track.
#[derive(Clone, Copy)]
pub(super) struct StayIn<'t> {
    /// Distance to keep from the area's edge, metres.
    pub margin_m: f64,
    pub terrain: &'t dyn Terrain,
}

impl StayIn<'_> {
    /// The first part of a straight piece of track that leaves the area of these zones, and the zone it is nearest to.
    pub fn left<'z>(self, zones: &[Active<'z>], from: At, to: At) -> Option<(&'z Prepared, Breach, bool)> {
        match zones {
            [] => None,
            [(zone, perhaps)] => {
                let breach = zone.excursion(&Piece::new(from, to, self.terrain))?;
                Some((zone, breach, *perhaps))
            }
            _ => self.left_at_most_halved(zones, (from, to), MAX_HALVINGS),
        }
    }

    /// Halved until each part lies in one zone or is very short.
    fn left_at_most_halved<'z>(
        self,
        zones: &[Active<'z>],
        (from, to): (At, At),
        halvings: u32,
    ) -> Option<(&'z Prepared, Breach, bool)> {
        let piece = Piece::new(from, to, self.terrain);
        let gap_m = |zone: &Prepared| zone.outline.gap_m(&piece.amsl);
        let is_near = |(zone, _): &Active| zone.outline.may_be_near(&piece.amsl);
        let near: Vec<Active> = zones.iter().copied().filter(is_near).collect();
        if near.iter().any(|(zone, _)| zone.holds(&piece)) {
            return None;
        }
        if near.is_empty() {
            let nearest = zones.iter().min_by(|(a, _), (b, _)| gap_m(a).total_cmp(&gap_m(b)));
            return nearest.and_then(|(zone, perhaps)| Some((*zone, zone.excursion(&piece)?, *perhaps)));
        }
        let climb_m = (to.altitude_amsl_m - from.altitude_amsl_m).abs();
        let length_m = crate::layout::path::distance_m(from.position, to.position);
        let middle = middle(from, to);
        if halvings == 0 || near.len() == 1 || (length_m < self.finest_m() && climb_m < FINEST_CLIMB_M) {
            let surrounded = near.len() > 1 && self.is_surrounded(&near, middle);
            return if surrounded { None } else { self.nearest(&near, &piece, middle) };
        }
        let half = |ends| self.left_at_most_halved(&near, ends, halvings - 1);
        half((from, middle)).or_else(|| half((middle, to)))
    }

    fn finest_m(self) -> f64 {
        FINEST_M.max(FINEST_SHARE_OF_MARGIN * self.margin_m)
    }

    /// Within all the zones together, and nothing outside is nearer than the margin.
    fn is_surrounded(self, zones: &[Active], at: At) -> bool {
        let here = Piece::new(at, at, self.terrain);
        let at_this_height: Vec<_> =
            zones.iter().map(|(zone, _)| *zone).filter(|zone| zone.off_limits_m(&here) <= 0.0).collect();
        let is_inside = |position| {
            let mut beside = 0;
            at_this_height.iter().any(|zone| {
                let outside_m = zone.ground.outside_m(position);
                beside += u32::from(outside_m <= SEAM_M);
                outside_m <= 0.0 || beside > 1
            })
        };
        let around = |share: f64| {
            let bearing_deg = |i: u32| f64::from(i) * 360.0 / f64::from(BEARINGS);
            (0..BEARINGS).map(move |i| at.position.destination(bearing_deg(i), share * self.margin_m))
        };
        is_inside(at.position) && SHARES.into_iter().flat_map(around).all(is_inside)
    }

    /// How the piece breaks the zone that its middle is nearest to.
    fn nearest<'z>(
        self,
        zones: &[Active<'z>],
        piece: &Piece,
        middle: At,
    ) -> Option<(&'z Prepared, Breach, bool)> {
        let here = Piece::new(middle, middle, self.terrain);
        let off_m = |zone: &Prepared| zone.ground.outside_m(middle.position) + zone.off_limits_m(&here);
        let nearest = zones.iter().min_by(|(a, _), (b, _)| off_m(a).total_cmp(&off_m(b)));
        nearest.and_then(|(zone, perhaps)| Some((*zone, zone.excursion(piece)?, *perhaps)))
    }
}

fn middle(from: At, to: At) -> At {
    let line = PathElement::Line { from: from.position, to: to.position };
    At {
        position: line.point_at(0.5 * from.position.distance_m(to.position)),
        altitude_amsl_m: 0.5 * (from.altitude_amsl_m + to.altitude_amsl_m),
        when: from.when,
        home_m: from.home_m,
    }
}

#[cfg(test)]
mod tests {
    use super::super::prepared::{When, Zones};
    use super::super::{Conditions, Margins};
    use super::*;
    use aircraft::Profile;
    use geometry::LatLon;
    use terrain::Flat;

    fn zones(zones: &[String], margin_m: f64) -> Zones {
        let document = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="x">
            <runways><runway id="r" lat="36.2" lon="-84.1" elevation="100" heading="90" length="500"/></runways><zones>{}</zones>
            <mainPlan><stage id="t" type="take-off" runway="r" altitude="100" altitudeReference="home"/>
            <stage id="s" type="mission" altitude="500" altitudeReference="amsl"><TF id="a" lat="36.3" lon="-84.1"/></stage>
            <stage id="l" type="land" runway="r"/></mainPlan></flightPlan>"#,
            zones.concat()
        );
        let plan = flight_plan::read(document.as_bytes()).plan;
        let program = flight_plan::compile(plan, &Profile::default(), &Flat(100.0)).unwrap();
        let margins = Margins { zone_m: margin_m, ..Margins::default() };
        Zones::of(&program, &Profile::default(), Conditions { margins, ..Conditions::default() })
    }

    /// A zone to stay in between two meridians, in degrees.
    fn strip(id: usize, (west, east): (f64, f64), (south, north): (f64, f64)) -> String {
        let corner = |(lat, lon): (f64, f64)| format!(r#"<corner lat="{lat}" lon="{lon}"/>"#);
        let ring = [(south, west), (south, east), (north, east), (north, west)];
        format!(r#"<keepIn id="z{id}">{}</keepIn>"#, ring.map(corner).concat())
    }

    fn is_left(zones: &Zones, from: (f64, f64), to: (f64, f64)) -> bool {
        let at = |(lat, lon)| At {
            position: LatLon::new(lat, lon),
            altitude_amsl_m: 500.0,
            when: When::At(0.0),
            home_m: 300.0,
        };
        !zones.breaches(&[(at(from), at(to))], &Flat(100.0)).is_empty()
    }

    /// Each zone has a frame of its own, in which the common edge of 39 km is drawn: what is between the two is no gap.
    #[test]
    fn a_long_edge_that_two_zones_share_is_no_edge() {
        for (width_deg, margin_m) in [(0.4, 10.0), (0.05, 10.0), (0.9, 50.0), (0.4, 0.0)] {
            let west = strip(0, (-84.2 - width_deg, -84.2), (36.10, 36.45));
            let east = strip(1, (-84.2, -83.9), (36.10, 36.45));
            let both = zones(&[west, east], margin_m);
            for (name, from, to) in [
                ("across", (36.3, -84.22), (36.3, -84.18)),
                ("at a slant", (36.2, -84.201), (36.21, -84.1985)),
                ("along", (36.27, -84.2), (36.28, -84.2)),
                ("beside", (36.42, -84.20005), (36.43, -84.20005)),
            ] {
                assert!(!is_left(&both, from, to), "{name}, {width_deg}°, {margin_m} m");
            }
            assert!(is_left(&both, (36.3, -84.1), (36.46, -84.1)), "out of it");
            assert!(is_left(&both, (36.3, -83.95), (36.3, -83.89)), "out of it");
        }
    }

    #[test]
    fn a_gap_of_some_metres_is_one() {
        for gap_m in [3.0, 12.0] {
            let gap_deg = gap_m / 89_900.0;
            let west = strip(0, (-84.6, -84.2), (36.10, 36.45));
            let east = strip(1, (-84.2 + gap_deg, -83.9), (36.10, 36.45));
            let both = zones(&[west, east], 10.0);
            assert!(is_left(&both, (36.3, -84.22), (36.3, -84.18)), "{gap_m}");
            // 5 m and 8 m from it: nearer than the margin
            for beside_m in [5.0, 8.0] {
                let lon = -84.2 - beside_m / 89_900.0;
                assert!(is_left(&both, (36.2, lon), (36.21, lon)), "{gap_m} {beside_m}");
            }
            let lon = -84.2 - 13.0 / 89_900.0;
            assert!(!is_left(&both, (36.2, lon), (36.21, lon)), "{gap_m}");
        }
    }

    /// Most zones of a plan are far from where it flies: they cost next to nothing, and the nearest is named.
    #[test]
    fn many_zones_side_by_side_are_one_area() {
        let wide_deg = 0.01;
        let strips: Vec<_> = (0..200)
            .map(|i| {
                let west = -84.6 + wide_deg * f64::from(i);
                strip(i as usize, (west, west + wide_deg), (36.10, 36.45))
            })
            .collect();
        let all = zones(&strips, 10.0);
        assert!(!is_left(&all, (36.2, -83.695), (36.3, -83.6)));
        assert!(is_left(&all, (36.44, -83.695), (36.46, -83.6)));
        let at = |lat, lon| At {
            position: LatLon::new(lat, lon),
            altitude_amsl_m: 500.0,
            when: When::At(0.0),
            home_m: 300.0,
        };
        let far_away = all.breaches(&[(at(36.6, -84.595), at(36.6, -84.596))], &Flat(100.0));
        assert_eq!(far_away.first().map(|(_, (zone, ..))| zone.id.to_string()), Some("z0".to_owned()));
    }
}
