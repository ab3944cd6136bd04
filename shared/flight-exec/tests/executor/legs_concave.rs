//! Scans over areas with bays and holes: what is flown, where it is flown, and that nothing of the area is left out.

use crate::rig::{Rig, document_with, fix};
use aircraft::Profile;
use geometry::scan::coverage;
use geometry::{LatLon, LocalFrame, Polygon, Vec2};
use proptest::prelude::*;

const SPEED_MPS: f64 = 16.0;

/// Of turns between tracks, metres: at the design wind.
fn radius_m() -> f64 {
    Profile::default().turn_radius_m(SPEED_MPS + 6.0)
}

fn frame() -> LocalFrame {
    LocalFrame::new(fix("C3"))
}

fn ring(corners: &[Vec2]) -> String {
    let corner = |c: &Vec2| frame().to_geo(*c);
    corners
        .iter()
        .map(corner)
        .map(|p| format!(r#"<corner lat="{}" lon="{}"/>"#, p.lat_deg, p.lon_deg))
        .collect()
}

fn scan(kind: &str, attributes: &str, area: &Polygon) -> String {
    let holes: String = area.holes().iter().map(|hole| format!("<hole>{}</hole>", ring(hole))).collect();
    let outer = ring(area.outer());
    format!(r#"<{kind} id="p" speed="{SPEED_MPS}" {attributes}><area>{outer}{holes}</area></{kind}>"#)
}

fn flying(scan: &str) -> Rig {
    let variables = r#"<variable name="s" type="number" initial="200" min="50" max="900"/>"#;
    let legs = format!(r#"<TF id="a" fix="C2"/>{scan}<TF id="z" fix="A3"/>"#);
    let mut rig = Rig::flying(&document_with(&legs, variables, ""));
    rig.fly_to("p");
    rig
}

/// The waypoints of the scan.
fn flown(rig: &Rig) -> Vec<Vec2> {
    let own = rig.flown.iter().filter(|w| w.leg.as_str() == "p");
    own.map(|w| frame().to_local(w.position)).collect()
}

/// The farthest that a path leads outside an area, metres.
fn farthest_outside_m(path: &[Vec2], area: &Polygon) -> f64 {
    let along = path.windows(2).flat_map(|w| {
        let steps = ((w[1] - w[0]).length() / 10.0).ceil().max(1.0) as u32;
        (0..=steps).map(move |i| w[0] + (w[1] - w[0]) * (f64::from(i) / f64::from(steps)))
    });
    along.map(|p| area.distance_outside_m(p)).fold(0.0, f64::max)
}

/// Turns begin up to a radius beyond the ends of tracks, which are up to the overshoot beyond the edge; and from one track
/// to the next they lead beside the area: at most 2k + 1 spacings, where k of them are a turn's width and up to one more.
fn allowed_m(spacing_m: f64, overshoot_m: f64) -> f64 {
    let aside_m = 4.0 * radius_m() + 3.0 * spacing_m;
    // and what a position that is written down is rounded by
    aside_m.hypot((radius_m() - overshoot_m).max(0.0)) + overshoot_m + 0.1
}

fn polygon(corners: &[(f64, f64)], holes: &[&[(f64, f64)]]) -> Polygon {
    let ring = |corners: &[(f64, f64)]| corners.iter().map(|&(e, n)| Vec2::new(e, n)).collect();
    Polygon::new(ring(corners), holes.iter().map(|hole| ring(hole)).collect()).unwrap()
}

/// A bay of 2.7 km between two arms of 1 km, open to the north.
fn bay() -> Polygon {
    let corners = [
        (0.0, 0.0),
        (4700.0, 0.0),
        (4700.0, 2500.0),
        (3700.0, 2500.0),
        (3700.0, 700.0),
        (1000.0, 700.0),
        (1000.0, 2500.0),
        (0.0, 2500.0),
    ];
    polygon(&corners, &[])
}

/// Without overshoot nothing is flown outside but turns, which reach a radius beyond tracks' ends.
#[test]
fn a_bay_is_not_flown_across() {
    for (kind, heading_deg) in [("scan", 90), ("scan", 0), ("crissCross", 90), ("creepingLine", 0)] {
        let spacing_m = 250.0;
        let area = bay();
        let attributes = format!(r#"spacing="{spacing_m}" heading="{heading_deg}""#);
        let mut rig = flying(&scan(kind, &attributes, &area));
        rig.fly_to_the_end();
        let path = flown(&rig);
        let outside_m = farthest_outside_m(&path, &area);
        // edges are straight: neighbours end side by side
        assert!(outside_m < radius_m() + 1.0, "{kind} {heading_deg}: {outside_m}");
        let ways = path.windows(2).map(|w| (w[0], w[1]));
        // along the arms, tracks would have to go beyond an edge to see what of a strip is inside it
        let whole = coverage(&area, ways, spacing_m / 2.0) > 0.999_9;
        assert!(whole || (kind, heading_deg) == ("scan", 0), "{kind} {heading_deg}");
    }
}

/// Most tracks are others then; what is flown already and stays is left out.
#[test]
fn with_another_spacing_on_the_way_between_two_arms_the_scan_begins_anew() {
    let area = bay();
    let mut rig = flying(&scan("scan", r#"spacing="= s" heading="90""#, &area));
    let is_corner =
        |p: Vec2| (p.n - 700.0).abs() < 1.0 && [1000.0, 3700.0].iter().any(|e| (p.e - e).abs() < 1.0);
    while !rig.buffer.front().is_some_and(|w| is_corner(frame().to_local(w.position))) {
        assert!(rig.fly_one());
    }
    rig.set("s", 300.0).unwrap();
    rig.fly_to_the_end();
    let path = flown(&rig);
    let share = coverage(&area, path.windows(2).map(|w| (w[0], w[1])), 150.0);
    assert!(share > 0.999, "{share}");
    assert!(farthest_outside_m(&path, &area) < radius_m() + 1.0);
}

#[test]
fn an_overshoot_of_half_a_gap_is_leave_to_fly_across_it() {
    // a centimetre less than twice the overshoot: a local frame is no more exact than that
    let gap = [(1000.0, 500.0), (1000.0, 1500.0), (1299.99, 1500.0), (1299.99, 500.0)];
    // a metre less than eight strips: the tracks are true to heading 90 in its middle, not at its corners
    let area = polygon(&[(0.0, 0.0), (2300.0, 0.0), (2300.0, 1999.0), (0.0, 1999.0)], &[&gap]);
    let tracks = |overshoot_m: u32| {
        let attributes = format!(r#"spacing="250" heading="90" overshoot="{overshoot_m}""#);
        let mut rig = flying(&scan("scan", &attributes, &area));
        rig.fly_to_the_end();
        flown(&rig)
            .windows(2)
            .filter(|w| (w[1] - w[0]).length() > 600.0 && (w[1] - w[0]).n.abs() < 1.0)
            .count()
    };
    assert_eq!(tracks(150), 8);
    // three of the lines are in two pieces: the strip of a fourth one touches what is beyond the gap's end
    assert_eq!(tracks(140), 5 + 2 * 3);
}

/// An area, and how it is scanned.
#[derive(Debug, Clone)]
struct Case {
    area: Polygon,
    spacing_m: f64,
    heading_deg: f64,
    /// As a share of the spacing.
    overshoot: f64,
}

/// Teeth of some kilometres with bays between them on a bar with a hole in it; or a star with a star for a hole.
fn areas() -> impl Strategy<Value = Polygon> {
    let teeth = prop::collection::vec((700.0..1500.0_f64, 1200.0..3000.0_f64, 500.0..3000.0_f64), 1..4);
    let comb = (teeth, 500.0..1500.0_f64, any::<bool>()).prop_map(|(teeth, bar_m, holed)| {
        let (mut outer, mut east) = (vec![(0.0, 0.0), (0.0, bar_m)], 0.0);
        for (width_m, gap_m, height_m) in teeth {
            outer.extend([(east + gap_m, bar_m), (east + gap_m + 100.0, bar_m + height_m)]);
            east += gap_m + width_m;
            outer.extend([(east, bar_m + height_m), (east, bar_m)]);
        }
        outer.extend([(east + 300.0, bar_m), (east + 300.0, 0.0)]);
        let hole = [(150.0, 150.0), (150.0, bar_m - 150.0), (900.0, bar_m - 200.0), (900.0, 160.0)];
        let holes: &[&[(f64, f64)]] = &[&hole];
        polygon(&outer, if holed { holes } else { &[] })
    });
    let star = (prop::collection::vec(800.0..4000.0_f64, 5..12), any::<bool>()).prop_map(|(radii, holed)| {
        let step = std::f64::consts::TAU / radii.len() as f64;
        let corner = |(i, r): (usize, &f64)| Vec2::from_bearing_rad(i as f64 * step) * *r;
        let outer: Vec<Vec2> = radii.iter().enumerate().map(corner).collect();
        let hole = outer.iter().map(|&c| c * 0.4).collect();
        Polygon::new(outer, if holed { vec![hole] } else { vec![] }).unwrap()
    });
    prop_oneof![comb, star]
}

fn cases() -> impl Strategy<Value = Case> {
    (areas(), 150.0..500.0_f64, 0.0..180.0_f64, prop_oneof![Just(0.0), Just(0.5), 0.0..1.0_f64]).prop_map(
        |(area, spacing_m, heading_deg, overshoot)| Case { area, spacing_m, heading_deg, overshoot },
    )
}

impl Case {
    fn attributes(&self, spacing: &str) -> String {
        let (heading_deg, overshoot_m) = (self.heading_deg, self.overshoot_m());
        format!(r#"spacing="{spacing}" heading="{heading_deg}" overshoot="{overshoot_m}""#)
    }
    fn overshoot_m(&self) -> f64 {
        self.overshoot * self.spacing_m
    }
}

/// From half the spacing on, what these areas' slanted edges leave unseen is next to nothing.
fn is_covered(path: &[Vec2], case: &Case, spacing_m: f64) -> bool {
    let ways = path.windows(2).map(|w| (w[0], w[1]));
    case.overshoot_m() < spacing_m / 2.0 || coverage(&case.area, ways, spacing_m / 2.0 + 0.1) >= 0.995
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_metre_is_flown_over_the_area_or_turning_beside_it(case in cases()) {
        let mut rig = flying(&scan("scan", &case.attributes(&case.spacing_m.to_string()), &case.area));
        rig.fly_to_the_end();
        let path = flown(&rig);
        let outside_m = farthest_outside_m(&path, &case.area);
        let allowed_m = allowed_m(case.spacing_m, case.overshoot_m());
        prop_assert!(outside_m <= allowed_m, "{outside_m} > {allowed_m}");
        prop_assert!(is_covered(&path, &case, case.spacing_m));
    }

    /// Begun with one spacing, gone on with another: the way to what is left leads over the area as well, and nothing is missed.
    #[test]
    fn a_changed_scan_stays_over_its_area(case in cases(), after in 0.0..0.9_f64, wider in any::<bool>()) {
        let mut rig = flying(&scan("scan", &case.attributes("= s"), &case.area));
        rig.set("s", case.spacing_m).unwrap();
        let mut whole = rig.clone();
        whole.fly_to_the_end();
        let until = (flown(&whole).len() as f64 * after) as usize;
        while flown(&rig).len() < until {
            rig.fly_one();
        }
        let spacing_m = case.spacing_m * if wider { 1.3 } else { 0.7 };
        rig.set("s", spacing_m).unwrap();
        rig.fly_to_the_end();
        let path = flown(&rig);
        let outside_m = farthest_outside_m(&path, &case.area);
        // the new pattern is joined from where the path is: at a corner of a turn, as far outside as that is
        let widest_m = case.spacing_m.max(spacing_m);
        let allowed_m = allowed_m(widest_m, case.overshoot_m());
        prop_assert!(outside_m <= allowed_m, "{outside_m} > {allowed_m}");
        prop_assert!(is_covered(&path, &case, widest_m));
    }
}

/// As the waypoints of the way out, backwards.
#[test]
fn flown_back_the_ways_between_cells_are_the_same() {
    let area = bay();
    let pattern = scan("scan", r#"spacing="300" heading="90""#, &area);
    let legs = format!(
        r#"<iterative id="l" form="reverse" count="2"><TF id="b" fix="B2"/>{pattern}</iterative><TF id="z" fix="A3"/>"#
    );
    let mut rig = Rig::flying(&document_with(&legs, "", ""));
    rig.fly_to_the_end();
    let runs = rig.flown.chunk_by(|a, b| a.leg == b.leg).filter(|run| run[0].leg.as_str() == "p");
    let passages: Vec<Vec<LatLon>> = runs.map(|run| run.iter().map(|w| w.position).collect()).collect();
    let [out, back, _] = &passages[..] else { panic!("{}", passages.len()) };
    let expected: Vec<LatLon> = out.iter().rev().skip(1).copied().collect();
    assert_eq!(back[..expected.len()], expected);
    // both corners of the bay's bottom are gone round, or one of them
    let corners = [(1000.0, 700.0), (3700.0, 700.0)].map(|(e, n)| frame().to_geo(Vec2::new(e, n)));
    assert!(out.iter().any(|p| corners.iter().any(|c| c.distance_m(*p) < 0.1)));
}

/// A turn ahead of time where the way leads straight back would leave a piece of the track out: between cells, and at the very end.
#[test]
fn ends_of_tracks_between_cells_and_of_the_last_one_are_flown_over() {
    let field = polygon(&[(0.0, 0.0), (2000.0, 0.0), (2000.0, 1000.0), (0.0, 1000.0)], &[]);
    for (area, cells) in [(field, 1), (bay(), 3)] {
        let mut rig = flying(&scan("scan", r#"spacing="200" heading="90""#, &area));
        rig.fly_to("z");
        let over = rig.flown.iter().filter(|w| w.leg.as_str() == "p" && w.fly_over).count();
        assert_eq!(over, 2 * (cells - 1) + 1);
    }
}
