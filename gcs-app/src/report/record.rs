//! What a report is made from.

use super::authored::AuthoredPath;
use super::flights::Energy;
use flight_plan::Zone;
use geometry::LatLon;
use std::collections::HashMap;
use std::sync::Arc;
use terrain::Terrain;

/// One position of a track.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackPoint {
    /// Seconds since the flight began.
    pub time_s: f64,
    /// Where.
    pub position: LatLon,
    /// Metres above mean sea level.
    pub altitude_amsl_m: f64,
}

/// Which passage of a leg: the same key in the plan and in the flight.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct PassageKey {
    /// The leg's id.
    pub leg: String,
    /// Its loops from the outside in, like `patrol 2, bend 1`; empty outside of loops.
    pub iterations: String,
    /// Flown backwards.
    pub reverse: bool,
    /// How often this leg was entered before with the same loops.
    pub occurrence: usize,
}

impl std::fmt::Display for PassageKey {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.leg)?;
        if !self.iterations.is_empty() {
            write!(f, " ({})", self.iterations)?;
        }
        if self.reverse {
            f.write_str(" reversed")?;
        }
        if self.occurrence > 0 {
            write!(f, " #{}", self.occurrence + 1)?;
        }
        Ok(())
    }
}

/// One passage of a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Passage {
    /// Which.
    pub key: PassageKey,
    /// The leg's type as the plan language calls it (`TF`, `RF`, `scan`, …).
    pub kind: &'static str,
    /// Name of the stage.
    pub stage: String,
    /// Index of its first point in the track.
    pub first: usize,
}

impl Passage {
    /// Of a leg that covers an area (a contour does inwards).
    pub fn covers_an_area(&self) -> bool {
        matches!(self.kind, "scan" | "creepingLine" | "crissCross" | "contour")
    }
}

/// A track, cut into passages.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Track {
    points: Vec<TrackPoint>,
    passages: Vec<Passage>,
}

impl Track {
    /// The next point.
    pub fn push(&mut self, point: TrackPoint) {
        self.points.push(point);
    }

    /// A passage begins at the next point. The key's `occurrence` is counted here.
    pub fn begin(&mut self, mut key: PassageKey, kind: &'static str, stage: String) {
        let same =
            |k: &PassageKey| (&k.leg, &k.iterations, k.reverse) == (&key.leg, &key.iterations, key.reverse);
        key.occurrence = self.passages.iter().filter(|p| same(&p.key)).count();
        self.passages.push(Passage { key, kind, stage, first: self.points.len() });
    }

    /// All points, in order.
    pub fn points(&self) -> &[TrackPoint] {
        &self.points
    }

    /// The passages, in order.
    pub fn passages(&self) -> &[Passage] {
        &self.passages
    }

    /// Indices of the points of passage `i`; empty if there is no such passage.
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        let end = self.passages.get(i + 1).map_or(self.points.len(), |p| p.first);
        self.passages.get(i).map_or(0..0, |p| p.first..end)
    }

    /// Seconds from the first point to the last.
    pub fn duration_s(&self) -> f64 {
        match (self.points.first(), self.points.last()) {
            (Some(first), Some(last)) => last.time_s - first.time_s,
            _ => 0.0,
        }
    }

    /// Metres over the ground between two indices.
    pub fn distance_m(&self, range: std::ops::Range<usize>) -> f64 {
        let Some(points) = self.points.get(range) else { return 0.0 };
        points.windows(2).map(|w| w[0].position.distance_m(w[1].position)).sum()
    }

    /// Where it was at a time: the last point not after it.
    pub fn at(&self, time_s: f64) -> Option<&TrackPoint> {
        let after = self.points.partition_point(|p| p.time_s <= time_s);
        self.points.get(after.saturating_sub(1))
    }
}

/// What a place on the map is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaceKind {
    /// A named position of the plan.
    Fix,
    /// A runway, seen from its threshold.
    Runway {
        /// Degrees true.
        heading_deg: f64,
        /// Metres.
        length_m: f64,
    },
}

/// A named place.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// What the map writes beside it.
    pub label: String,
    /// Where.
    pub position: LatLon,
    /// What.
    pub kind: PlaceKind,
}

/// An area that was to be scanned in one passage.
#[derive(Debug, Clone, PartialEq)]
pub struct Area {
    /// What the map writes beside it.
    pub label: String,
    /// Its corners (of a circle: enough of them).
    pub outline: Vec<LatLon>,
    /// What is left out of it: rings of corners.
    pub holes: Vec<Vec<LatLon>>,
    /// Distance between tracks, metres.
    pub spacing_m: f64,
    /// The passage that scanned it.
    pub passage: PassageKey,
}

/// Something worth reporting.
#[derive(Debug, Clone, PartialEq)]
pub struct Happening {
    /// Seconds since the flight began.
    pub time_s: f64,
    /// For people.
    pub text: String,
    /// Worth a number on the map.
    pub important: bool,
    /// For programs.
    pub details: serde_json::Value,
}

/// Everything a report knows.
#[derive(Clone)]
pub struct Record {
    /// The mission's name.
    pub title: String,
    /// Lines below it: aircraft, wind, plan hash.
    pub notes: Vec<String>,
    /// What the preview said would be flown.
    pub planned: Track,
    /// What was flown; empty for a preview's own pictures.
    pub flown: Track,
    /// The paths of flown passages as their author wrote them.
    pub authored: HashMap<PassageKey, AuthoredPath>,
    /// Fixes and runways.
    pub places: Vec<Place>,
    /// Zones to keep out of and to stay inside.
    pub zones: Vec<Zone>,
    /// Scanned areas.
    pub areas: Vec<Area>,
    /// Lines that legs fly along, and outlines that they fly around.
    pub routes: Vec<Vec<LatLon>>,
    /// What each flight of the plan took, in order; empty: not known.
    pub energy: Vec<Energy>,
    /// What happened, in order.
    pub happenings: Vec<Happening>,
    /// The verdict's sentences, with whether each holds.
    pub verdict: Vec<(bool, String)>,
    /// What the operator did that nobody had planned.
    pub by_hand: Vec<String>,
    /// The ground.
    pub terrain: Arc<dyn Terrain>,
}

impl Record {
    /// The track of the flight, or of the plan where nothing was flown.
    pub fn main_track(&self) -> &Track {
        if self.flown.points().is_empty() { &self.planned } else { &self.flown }
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// An out-and-back flight with a scan, made up: enough for everything to be drawn.
    pub(crate) fn record() -> Record {
        let home = LatLon::new(36.319, -84.173);
        let planned = made_up(home, 0.0);
        let centre = home.destination(250.0, 6000.0);
        Record {
            title: "Fire watch, Cumberland".into(),
            notes: vec!["trainer · wind 5 m/s from 270°".into()],
            flown: made_up(home, 6.0),
            planned,
            authored: HashMap::new(),
            places: vec![
                Place {
                    label: "R05".into(),
                    position: home,
                    kind: PlaceKind::Runway { heading_deg: 52.0, length_m: 600.0 },
                },
                Place { label: "COVE".into(), position: home.destination(0.0, 2500.0), kind: PlaceKind::Fix },
            ],
            zones: Vec::new(),
            areas: vec![Area {
                label: "fire, pass 1".into(),
                outline: (0..36).map(|i| centre.destination(f64::from(i) * 10.0, 900.0)).collect(),
                holes: Vec::new(),
                spacing_m: 150.0,
                passage: key("sweep", "patrol 1"),
            }],
            routes: Vec::new(),
            energy: Vec::new(),
            happenings: vec![
                Happening {
                    time_s: 300.0,
                    text: "fire moved north".into(),
                    important: true,
                    details: serde_json::json!({"event": "variable-changed"}),
                },
                Happening {
                    time_s: 620.0,
                    text: "plan update aboard".into(),
                    important: true,
                    details: serde_json::json!({"event": "plan-activated"}),
                },
            ],
            by_hand: Vec::new(),
            verdict: vec![
                (true, "landed on R05".into()),
                (false, "cross-track 16.2 m on TF legs (limit 15 m)".into()),
            ],
            terrain: crate::assets::demo_terrain(),
        }
    }

    fn key(leg: &str, iterations: &str) -> PassageKey {
        PassageKey { leg: leg.into(), iterations: iterations.into(), reverse: false, occurrence: 0 }
    }

    /// Flown wobbles `wobble_m` to each side.
    fn made_up(home: LatLon, wobble_m: f64) -> Track {
        let mut track = Track::default();
        let mut pen = Pen { at: home, altitude_m: 349.0, time_s: 0.0, wobble_m };
        for (leg, kind, stage, bearing, seconds, climb) in [
            ("to", "take-off", "Take-off", 52.0, 60, 2.5),
            ("d1", "TF", "Departure", 340.0, 90, 4.0),
            ("d2", "TF", "En route", 232.0, 190, 2.4),
        ] {
            track.begin(key(leg, ""), kind, stage.into());
            pen.line(&mut track, bearing, seconds, climb);
        }
        track.begin(key("sweep", "patrol 1"), "scan", "Fire watch".into());
        for i in 0..12 {
            pen.line(&mut track, if i % 2 == 0 { 180.0 } else { 0.0 }, 70, 0.0);
            pen.line(&mut track, 270.0, 6, 0.0);
        }
        track.begin(key("back", ""), "TF", "Return".into());
        pen.line(&mut track, 63.0, 300, -2.0);
        track.begin(key("land", ""), "land", "Landing".into());
        pen.line(&mut track, 80.0, 60, -2.0);
        track
    }

    struct Pen {
        at: LatLon,
        altitude_m: f64,
        time_s: f64,
        wobble_m: f64,
    }

    impl Pen {
        fn line(&mut self, track: &mut Track, bearing_deg: f64, seconds: u32, climb_mps: f64) {
            for _ in 0..seconds {
                let aside = self.wobble_m * (self.time_s / 25.0).sin();
                track.push(TrackPoint {
                    time_s: self.time_s,
                    position: self.at.destination(bearing_deg + 90.0, aside),
                    altitude_amsl_m: self.altitude_m + aside,
                });
                self.at = self.at.destination(bearing_deg, 25.0);
                self.altitude_m += climb_mps;
                self.time_s += 1.0;
            }
        }
    }
}
