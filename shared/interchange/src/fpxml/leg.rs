//! One leg of a document.

use super::Reader;
use crate::mission::placed::{leg, place, waypoint};
use crate::synthetic::altitude;
use crate::xml::{Element, held};
use flight_plan::{
    AltitudeReference, Area, Holding, HoldingLength, Id, Leg, LegKind, PlanWaypoint, Scan, ScanEntry,
    ScanOrder, ScanStyle, Spacing, TurnDirection, Value,
};
use geometry::LatLon;

/// What is read of a leg and of its destination; others are noted.
const KNOWN: [&str; 41] = [
    "altitude",
    "area",
    "body",
    "center",
    "centre",
    "coordinates",
    "course",
    "dest",
    "direction",
    "finalLegs",
    "first",
    "fix",
    "flyOver",
    "flyover",
    "heading",
    "inboundCourse",
    "initialLegs",
    "last",
    "latitude",
    "legLength",
    "legTime",
    "length",
    "longitude",
    "name",
    "next",
    "nextList",
    "radius",
    "speed",
    "time",
    "track",
    "trackseparation",
    "trackSeparation",
    "turn",
    "turnDir",
    "turnDirection",
    "turns",
    "upperBound",
    "laps",
    "north_coordinate",
    "east_coordinate",
    "description",
];

/// The kind of a leg in small letters: `fp:TFLeg`, `fp_TFLeg` and `TFLeg` are `tf`.
pub fn kind_of(element: &Element) -> String {
    let named = element.attribute("type").or_else(|| element.attribute("xsi_type")).unwrap_or_default();
    let local = named.rsplit([':', '_']).next().unwrap_or_default().to_lowercase();
    local.strip_suffix("leg").map_or(local.clone(), str::to_owned)
}

/// The first of these children, of the leg or of its destination.
fn of_leg<'a>(element: &'a Element, names: &[&str]) -> Option<&'a Element> {
    let dest = ["dest", "fix"].into_iter().filter_map(|name| element.child(name));
    std::iter::once(element).chain(dest).find_map(|e| names.iter().find_map(|name| e.child(name)))
}

/// What people call a leg: the name of its destination, else its identifier.
pub fn named(element: &Element) -> &str {
    let name = of_leg(element, &["name"]).map_or("", |name| name.text.as_str());
    if name.is_empty() { element.attribute("id").unwrap_or_default() } else { name }
}

impl Reader<'_> {
    /// What a leg that flies something is, with its altitude and speed; `None`: it can't be carried, which is noted.
    pub(super) fn track(&mut self, element: &Element, id: Id) -> Option<Leg> {
        self.unknown_parts(element);
        let kind = self.kind(element)?;
        let mut made = leg(id, kind);
        made.name = held(named(element)).trim().to_owned();
        made.altitude = self
            .metres(element, &["altitude"], self.locale.altitude_m)
            .map(|metres| altitude(metres, AltitudeReference::Amsl));
        made.speed_mps = self.speed(element);
        Some(made)
    }

    fn kind(&mut self, element: &Element) -> Option<LegKind> {
        let kind = kind_of(element);
        if matches!(kind.as_str(), "scan" | "areascan") {
            return self.scan(element).map(LegKind::Scan);
        }
        let Some(to) = self.destination(element) else {
            self.notes.again("no-position", element.place(), "a leg without a good position is left out");
            return None;
        };
        let course =
            self.number(element, &["course", "track", "inboundCourse", "heading"]).map(Value::Constant);
        let at = element.child("center").or_else(|| element.child("centre"));
        let centre = at.and_then(|at| self.position(at));
        let made = match (kind.as_str(), centre, course) {
            ("if", ..) => LegKind::If(to),
            ("tf", ..) => LegKind::Tf(to),
            ("df", ..) => LegKind::Df { to, turn: of_leg(element, TURNS).and_then(|e| turn(&e.text)) },
            ("rf", Some(centre), _) => LegKind::Rf { to, centre, turn: self.turn(element) },
            ("cf", _, Some(course_deg)) => LegKind::Cf { to, course_deg },
            ("fa", _, Some(course_deg)) => LegKind::Fa { from: to, course_deg },
            ("hf", _, course) => LegKind::Hf(self.holding(element, to, course)),
            ("ha", _, course) => LegKind::Ha(self.holding(element, to, course)),
            ("hm" | "hold" | "holding", _, course) => LegKind::Hm {
                holding: self.holding(element, to, course),
                until: None,
                max_laps: self.number(element, &["laps", "turns", "upperBound"]).map(Value::Constant),
            },
            (other, ..) => {
                let message =
                    format!("a leg of the kind `{other}` becomes a straight track to its destination");
                self.notes.again("leg-as-track", element.place(), &message);
                LegKind::Tf(to)
            }
        };
        Some(made)
    }

    fn destination(&mut self, element: &Element) -> Option<PlanWaypoint> {
        let dest = ["dest", "fix"].iter().find_map(|name| element.child(name)).unwrap_or(element);
        if dest.child("north_coordinate").is_some() {
            let message = "a place in metres is left out: the file doesn't say where they count from";
            self.notes.again("local-frame", element.place(), message);
        }
        let fly_over = of_leg(element, &["flyOver", "flyover"]).is_some_and(|e| e.text.trim() == "true");
        self.position(dest).map(|position| waypoint(position, fly_over))
    }

    /// Where an element is: of its latitude and longitude, its coordinates or its text. 0/0 is nowhere.
    fn position(&self, element: &Element) -> Option<LatLon> {
        let part = |name: &str| self.locale.number(element.text_of(name));
        let pair = part("latitude").zip(part("longitude"));
        let written =
            || self.locale.pair(element.text_of("coordinates")).or_else(|| self.locale.pair(&element.text));
        let (lat_deg, lon_deg) = pair.or_else(written)?;
        let position = LatLon::new(lat_deg, lon_deg);
        (position.is_valid() && (lat_deg, lon_deg) != (0.0, 0.0)).then_some(position)
    }

    fn holding(&mut self, element: &Element, fix: PlanWaypoint, course: Option<Value<f64>>) -> Holding {
        let length =
            self.metres(element, &["legLength", "length"], self.locale.distance_m).map(Value::Constant);
        let seconds = self.number(element, &["legTime", "time"]).map(Value::Constant);
        let leg = match (length, seconds) {
            (Some(length), _) => HoldingLength::Distance(length),
            (None, Some(seconds)) => HoldingLength::Time(seconds),
            (None, None) => {
                let message = "a holding that doesn't say how long it is gets straight legs of one minute";
                self.notes.again("holding-length", element.place(), message);
                HoldingLength::Time(Value::Constant(60.0))
            }
        };
        Holding { fix, inbound_course_deg: course, turn: self.turn(element), leg }
    }

    fn turn(&mut self, element: &Element) -> TurnDirection {
        of_leg(element, TURNS).and_then(|e| turn(&e.text)).unwrap_or_else(|| {
            let message = "a turn that doesn't say which way goes right";
            self.notes.again("turn-assumed", element.place(), message);
            TurnDirection::Right
        })
    }

    fn scan(&mut self, element: &Element) -> Option<Scan> {
        let area = self.area(element);
        if area.is_none() {
            let message =
                "a scan without a good area is left out: it needs three corners, or a centre and a radius";
            self.notes.again("no-area", element.place(), message);
        }
        let names = ["trackseparation", "trackSeparation"];
        let apart = self.metres(element, &names, self.locale.separation_m).filter(|metres| *metres > 0.0);
        let apart_m = apart.unwrap_or_else(|| {
            let spacing_m = self.assumptions.spacing_m;
            let message =
                format!("a scan that doesn't say how far apart its tracks are gets {spacing_m:.0} m");
            self.notes.again("spacing-assumed", element.place(), &message);
            spacing_m
        });
        Some(Scan {
            area: area?,
            style: ScanStyle::Parallel,
            spacing: Spacing::Metres(Value::Constant(apart_m)),
            heading_deg: self.number(element, &["heading", "direction"]).map(Value::Constant),
            overshoot_m: Value::Constant(0.0),
            entry: ScanEntry::Nearest,
            order: ScanOrder::Interleaved,
        })
    }

    fn area(&mut self, element: &Element) -> Option<Area> {
        let drawn = element.child("area")?;
        let radius_m = self.metres(drawn, &["radius"], self.locale.distance_m).filter(|metres| *metres > 0.0);
        let centre =
            ["center", "centre"].iter().find_map(|name| drawn.child(name)).and_then(|c| self.position(c));
        if let Some((centre, radius_m)) = centre.zip(radius_m) {
            return Some(Area::Circle { centre: place(centre), radius_m: Value::Constant(radius_m) });
        }
        let mut corners = Vec::new();
        for corner in &drawn.children {
            match self.position(corner) {
                Some(position) => corners.push(position),
                None => self.notes.again(
                    "no-position",
                    corner.place(),
                    "a corner without a good position is left out",
                ),
            }
        }
        if let Some(ordered) = flight_plan::checks::untied(&corners, &[]) {
            let message =
                "the corners of an area are put in order around it: as they are, they make a bow tie";
            self.notes.again("corners-ordered", element.place(), message);
            corners = ordered;
        }
        (corners.len() >= 3).then_some(Area::Polygon { corners, holes: Vec::new() })
    }

    fn speed(&mut self, element: &Element) -> Option<Value<f64>> {
        let speed_mps = self.metres(element, &["speed"], self.locale.speed_mps)?;
        let (least, most) = (self.profile.min_airspeed_mps, self.profile.max_airspeed_mps);
        if (least..=most).contains(&speed_mps) {
            return Some(Value::Constant(speed_mps));
        }
        let message = format!(
            "a speed of {speed_mps} m/s is left out: the aircraft flies {least} to {most} m/s, and its cruise speed there"
        );
        self.notes.again("speed-not-flown", element.place(), &message);
        None
    }

    fn metres(&mut self, element: &Element, names: &[&str], unit: f64) -> Option<f64> {
        self.number(element, names).map(|number| number * unit)
    }

    /// The number in the first of these children; what is none is noted.
    pub(super) fn number(&mut self, element: &Element, names: &[&str]) -> Option<f64> {
        let child = of_leg(element, names)?;
        let number = self.locale.number(&child.text).filter(|number| number.abs() < 1e7);
        if number.is_none() {
            let message = format!("a <{}> that is no number is left out", child.name);
            self.notes.again("bad-number", child.place(), &message);
        }
        number
    }

    pub(super) fn unknown_parts(&mut self, element: &Element) {
        let dest = element.child("dest").into_iter();
        for child in std::iter::once(element).chain(dest).flat_map(|e| &e.children) {
            if !KNOWN.contains(&child.name.as_str()) {
                let name: String = child.name.chars().take(60).collect();
                let message = format!("<{name}> of a leg is left out");
                self.notes.again("element-not-carried", child.place(), &message);
            }
        }
    }
}

/// Children that say which way a turn goes.
const TURNS: &[&str] = &["turn", "turnDir", "turnDirection", "direction"];

fn turn(text: &str) -> Option<TurnDirection> {
    match text.trim().to_lowercase().as_str() {
        "left" | "l" | "ccw" | "counterclockwise" => Some(TurnDirection::Left),
        "right" | "r" | "cw" | "clockwise" => Some(TurnDirection::Right),
        _ => None,
    }
}
