//! How long surveys of QGroundControl become: flown by us, against the transects that QGC itself makes of them.
//!
//! QGC's way, after its documents and what it does: lines one spacing apart, counted from half of the larger side of the area's box and
//! 1 km more beside its middle; each from edge to edge, longer by the turnaround distance at both ends; one after its neighbour, there
//! and back, from the corner that the file names.
#![cfg(test)]

use aircraft::{Profile, Wind};
use flight_exec::rehearse::{Options, Scenario, Start, preview};
use geometry::{LatLon, LocalFrame, Vec2};
use interchange::{Assumptions, Format, read};
use std::sync::Arc;
use terrain::{Flat, Terrain};

const MIDDLE: LatLon = LatLon::new(36.37, -84.12);
const GROUND_M: f64 = 349.0;
/// Nobody's way is the same to the metre: our tracks are spread over the area, those of QGC counted from outside it.
const MOST: f64 = 1.05;

/// A survey, its corners east and north of [`MIDDLE`], metres.
struct Survey {
    name: &'static str,
    corners: &'static [(f64, f64)],
    angle_deg: f64,
    spacing_m: f64,
    turnaround_m: f64,
}

const CONVEX: [Survey; 5] = [
    Survey {
        name: "square",
        corners: &[(-1000.0, -1000.0), (1000.0, -1000.0), (1000.0, 1000.0), (-1000.0, 1000.0)],
        angle_deg: 0.0,
        spacing_m: 80.0,
        turnaround_m: 60.0,
    },
    Survey {
        name: "long side across",
        corners: &[(-1600.0, -500.0), (1600.0, -500.0), (1600.0, 500.0), (-1600.0, 500.0)],
        angle_deg: 20.0,
        spacing_m: 60.0,
        turnaround_m: 120.0,
    },
    Survey {
        name: "triangle",
        corners: &[(-1500.0, -900.0), (1500.0, -700.0), (100.0, 1300.0)],
        angle_deg: 75.0,
        spacing_m: 50.0,
        turnaround_m: 100.0,
    },
    Survey {
        name: "hexagon",
        corners: &[
            (-1200.0, 0.0),
            (-600.0, -1000.0),
            (600.0, -1000.0),
            (1200.0, 0.0),
            (600.0, 1000.0),
            (-600.0, 1000.0),
        ],
        angle_deg: -30.0,
        spacing_m: 70.0,
        turnaround_m: 80.0,
    },
    Survey {
        name: "without turnaround",
        corners: &[(-1000.0, -800.0), (1100.0, -900.0), (900.0, 900.0), (-1100.0, 700.0)],
        angle_deg: 100.0,
        spacing_m: 100.0,
        turnaround_m: 0.0,
    },
];

impl Survey {
    fn corners(&self) -> Vec<Vec2> {
        self.corners.iter().map(|(e, n)| Vec2::new(*e, *n)).collect()
    }

    /// The transects that QGC makes, from its first corner on (`entryLocation` 0).
    fn transects(&self) -> Vec<[Vec2; 2]> {
        let (corners, along) = (self.corners(), Vec2::from_bearing_rad(self.angle_deg.to_radians()));
        let aside = Vec2::from_bearing_rad((self.angle_deg + 90.0).to_radians());
        let box_of = |metres: fn(&Vec2) -> f64| {
            let all = corners.iter().map(metres);
            all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), m| (low.min(m), high.max(m)))
        };
        let ((west, east), (south, north)) = (box_of(|c| c.e), box_of(|c| c.n));
        let middle = Vec2::new(f64::midpoint(west, east), f64::midpoint(south, north));
        let half_m = f64::midpoint((east - west).max(north - south), 2000.0);
        let lines = (0..).map(|i| f64::from(i) * self.spacing_m - half_m).take_while(|m| *m < half_m);
        let across = lines.filter_map(|m| {
            let cuts: Vec<f64> = edges(&corners)
                .filter_map(|(a, b)| {
                    let (ma, mb) = ((a - middle).dot(aside) - m, (b - middle).dot(aside) - m);
                    let at = a + (b - a) * (ma / (ma - mb));
                    ((ma < 0.0) != (mb < 0.0)).then(|| (at - middle).dot(along))
                })
                .collect();
            let (low, high) =
                (cuts.iter().copied().reduce(f64::min)?, cuts.iter().copied().reduce(f64::max)?);
            let place = |metres: f64| middle + aside * m + along * metres;
            Some([place(high + self.turnaround_m), place(low - self.turnaround_m)])
        });
        across.enumerate().map(|(i, [a, b])| if i % 2 == 0 { [a, b] } else { [b, a] }).collect()
    }

    fn file(&self) -> String {
        let frame = LocalFrame::new(MIDDLE);
        let place = |at: &Vec2| {
            let at = frame.to_geo(*at);
            serde_json::json!([at.lat_deg, at.lon_deg])
        };
        let transects: Vec<_> = self.transects().iter().flatten().map(place).collect();
        let polygon: Vec<_> = self.corners().iter().map(place).collect();
        let take_off = serde_json::json!({"autoContinue": true, "command": 22, "doJumpId": 1, "frame": 3, "params": [15, 0, 0, null, 36.3273, -84.1598, 80], "type": "SimpleItem"});
        let survey = serde_json::json!({
            "TransectStyleComplexItem": {
                "CameraCalc": {"AdjustedFootprintFrontal": 25, "AdjustedFootprintSide": self.spacing_m, "CameraName": "Manual (no camera specs)",
                    "DistanceMode": 1, "DistanceToSurface": 120, "version": 2},
                "CameraShots": 0, "CameraTriggerInTurnAround": true, "HoverAndCapture": false, "Items": [],
                "Refly90Degrees": false, "TurnAroundDistance": self.turnaround_m, "VisualTransectPoints": transects, "version": 2},
            "angle": self.angle_deg, "complexItemType": "survey", "entryLocation": 0, "flyAlternateTransects": false,
            "polygon": polygon, "splitConcavePolygons": false, "type": "ComplexItem", "version": 5});
        let mission = serde_json::json!({"version": 2, "firmwareType": 3, "vehicleType": 1, "cruiseSpeed": 20,
            "plannedHomePosition": [36.319, -84.173, GROUND_M], "items": [take_off, survey]});
        serde_json::json!({"fileType": "Plan", "version": 1, "groundStation": "QGroundControl", "mission": mission}).to_string()
    }

    /// The waypoints that we fly it by, in the plane.
    fn flown(&self) -> Vec<Vec2> {
        let import = read(Format::Plan, self.file().as_bytes(), &Assumptions::default()).unwrap();
        let ground: Arc<dyn Terrain> = Arc::new(Flat(GROUND_M));
        let profile = Profile::default();
        let program = flight_plan::compile(import.plan, &profile, ground.as_ref()).unwrap();
        let options = Options { step_s: 0.2, ..Options::default() };
        // it has more energy than the plan asks for
        let profile = Profile { energy_j: profile.energy_j * 20.0, ..profile };
        let flown = preview(
            &Arc::new(program),
            &profile,
            &ground,
            Wind::CALM,
            Start::Runway,
            &Scenario::default(),
            &options,
        );
        let frame = LocalFrame::new(MIDDLE);
        let waypoints = flown.unwrap().waypoints;
        let of_survey = waypoints.iter().filter(|w| !w.replaced && w.waypoint.leg.as_str() == "survey");
        of_survey.map(|w| frame.to_local(w.waypoint.position)).collect()
    }
}

fn edges(corners: &[Vec2]) -> impl Iterator<Item = (Vec2, Vec2)> + '_ {
    corners.iter().copied().zip(corners.iter().copied().cycle().skip(1))
}

fn length_m(way: &[Vec2]) -> f64 {
    way.windows(2).map(|pair| (pair[1] - pair[0]).length()).sum()
}

#[test]
fn an_imported_survey_is_no_longer_than_qgc_flies_it_and_begins_where_it_does() {
    for survey in &CONVEX {
        let qgc: Vec<Vec2> = survey.transects().into_iter().flatten().collect();
        let ours = survey.flown();
        let ratio = length_m(&ours) / length_m(&qgc);
        println!(
            "{}: {} tracks, {:.1} km by QGC, {:.1} km by us: {ratio:.3}",
            survey.name,
            qgc.len() / 2,
            length_m(&qgc) / 1e3,
            length_m(&ours) / 1e3
        );
        // ours may be one track more: QGC leaves up to a spacing at the edges of the area uncovered
        let tracks = qgc.len() as f64 / 2.0;
        let most = MOST.max((tracks + 1.0) / tracks * 1.015);
        assert!((1.0 / MOST..most).contains(&ratio), "{}: {ratio:.3}", survey.name);
        let apart_m = (ours[0] - qgc[0]).length();
        assert!(
            apart_m < 2.0 * survey.spacing_m + 0.5 * survey.turnaround_m,
            "{}: begins {apart_m:.0} m away",
            survey.name
        );
        // one track after its neighbour
        let aside = Vec2::from_bearing_rad((survey.angle_deg + 90.0).to_radians());
        let tracks: Vec<f64> = ours.chunks(2).map(|track| track[0].dot(aside)).collect();
        let skipped = tracks.windows(2).find(|pair| (pair[1] - pair[0]).abs() > 1.25 * survey.spacing_m);
        assert_eq!(skipped, None, "{}", survey.name);
    }
}
