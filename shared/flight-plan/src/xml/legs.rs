//! Legs of a document.

use super::cursor::Element;
use super::read::Document;
use super::values::number;
use crate::{
    Area, Branch, DecideBefore, EmergencyChoice, Holding, HoldingLength, Id, IterativeForm, Leg, LegKind,
    Place, PlanWaypoint, Problem, Scan, TurnDirection, Value,
};
use geometry::LatLon;

const LEGS: &str = "IF, TF, DF, RF, HF, HA, iterative, intersection, scan, orbit, emergency";
const TURNS: [(&str, TurnDirection); 2] = [("left", TurnDirection::Left), ("right", TurnDirection::Right)];

impl<'a> Document<'a> {
    /// The legs of a stage or loop, and its emergencies by cause.
    pub fn legs(&mut self, parent: &Element<'a>, into: &mut Vec<Leg>, emergency: &mut EmergencyChoice) {
        while let Some(child) = self.cursor.child(parent) {
            match child.name {
                "emergency" => self.emergency_child(child, emergency),
                "IF" | "TF" | "DF" | "RF" | "HF" | "HA" | "iterative" | "intersection" | "scan" | "orbit" => {
                    let leg = self.leg(child);
                    into.push(leg);
                }
                _ => self.cursor.unknown(child, parent.name, LEGS),
            }
        }
    }

    fn leg(&mut self, element: Element<'a>) -> Leg {
        let id = self.id(&element, "id");
        let name = self.text(&element, "name");
        let mut emergency = self.emergency_attribute(&element);
        let altitude = self.altitude(&element);
        let speed_mps = self.value(&element, "speed");
        let next = self.reference(&element, "next");
        let kind = self.leg_kind(&element, &mut emergency);
        self.cursor.finish(&element);
        Leg { id, name, emergency, altitude, speed_mps, next, kind }
    }

    fn leg_kind(&mut self, element: &Element<'a>, emergency: &mut EmergencyChoice) -> LegKind {
        match element.name {
            "iterative" => self.iterative(element, emergency),
            "intersection" => self.intersection(element, emergency),
            "scan" => self.scan(element, emergency),
            "orbit" => self.orbit(element, emergency),
            _ => {
                let kind = self.basic(element);
                self.children(element, emergency, &[], |_, child| Some(child));
                kind
            }
        }
    }

    fn basic(&mut self, element: &Element<'a>) -> LegKind {
        match element.name {
            "IF" => LegKind::If(self.waypoint(element)),
            "TF" => LegKind::Tf(self.waypoint(element)),
            "DF" => LegKind::Df { to: self.waypoint(element), turn: self.choice(element, "turn", &TURNS) },
            "RF" => LegKind::Rf {
                to: self.waypoint(element),
                centre: self
                    .lat_lon(element, "centreLat", "centreLon")
                    .unwrap_or(LatLon::new(f64::NAN, f64::NAN)),
                turn: self.turn(element, None),
            },
            "HF" => LegKind::Hf(self.holding(element)),
            _ => LegKind::Ha(self.holding(element)),
        }
    }

    /// The children of a leg: emergencies by cause, and what `take` takes; it gives back what it does not know.
    fn children(
        &mut self,
        parent: &Element<'a>,
        emergency: &mut EmergencyChoice,
        allowed: &[&str],
        mut take: impl FnMut(&mut Self, Element<'a>) -> Option<Element<'a>>,
    ) {
        while let Some(child) = self.cursor.child(parent) {
            if child.name == "emergency" {
                self.emergency_child(child, emergency);
            } else if let Some(stranger) = take(self, child) {
                let allowed: Vec<&str> = allowed.iter().copied().chain(["emergency"]).collect();
                self.cursor.unknown(stranger, parent.name, &allowed.join(", "));
            }
        }
    }

    fn waypoint(&mut self, element: &Element<'a>) -> PlanWaypoint {
        PlanWaypoint { place: self.place(element, "at"), fly_over: self.flag(element, "flyOver") }
    }

    /// `fix="…"`, `lat="…" lon="…"`, or a position or expression in `other`: exactly one of them.
    fn place(&mut self, element: &Element<'a>, other: &str) -> Place {
        let fix = self.reference(element, "fix").map(Place::Fix);
        let has_lat_lon = ["lat", "lon"].iter().any(|name| element.attributes.take(name).is_some());
        let lat_lon = has_lat_lon.then(|| self.lat_lon(element, "lat", "lon"));
        let at = element.attributes.take(other).is_some().then(|| self.position_value(element, other));
        let given = usize::from(fix.is_some()) + usize::from(lat_lon.is_some()) + usize::from(at.is_some());
        if given != 1 {
            let message = format!(
                "say where <{}> is in exactly one way: `fix`, `lat` and `lon`, or `{other}`",
                element.name
            );
            self.cursor.report(Problem::error("missing-attribute", message).at(element.location));
        }
        let position = at.flatten().or_else(|| lat_lon.flatten().map(Value::Constant)).map(Place::Position);
        // an unknown fix, which the checks refuse
        fix.or(position).unwrap_or_else(|| Place::Fix(Id::new("")))
    }

    fn turn(&mut self, element: &Element<'a>, default: Option<TurnDirection>) -> TurnDirection {
        if default.is_none() {
            self.require(element, "turn");
        }
        self.choice(element, "turn", &TURNS).or(default).unwrap_or(TurnDirection::Right)
    }

    fn holding(&mut self, element: &Element<'a>) -> Holding {
        let length = self.value(element, "length").map(HoldingLength::Distance);
        let time = self.value(element, "time").map(HoldingLength::Time);
        if length.is_some() == time.is_some() {
            let message = format!(
                "give <{}> its straight legs' `length` (metres) or `time` (seconds), not both",
                element.name
            );
            self.cursor.report(Problem::error("missing-attribute", message).at(element.location));
        }
        Holding {
            fix: self.waypoint(element),
            inbound_course_deg: self.value(element, "course"),
            turn: self.turn(element, None),
            leg: length.or(time).unwrap_or(HoldingLength::Distance(Value::Constant(f64::NAN))),
        }
    }

    fn iterative(&mut self, element: &Element<'a>, emergency: &mut EmergencyChoice) -> LegKind {
        const FORMS: [(&str, IterativeForm); 2] =
            [("forward", IterativeForm::Forward), ("reverse", IterativeForm::Reverse)];
        self.require(element, "form");
        let form = self.choice(element, "form", &FORMS).unwrap_or(IterativeForm::Forward);
        let count = self.value(element, "count");
        let until = element.attributes.take("until").map(|source| source.trim().into());
        let turn = self.turn(element, Some(TurnDirection::Right));
        let mut body = Vec::new();
        self.legs(element, &mut body, emergency);
        LegKind::Iterative { form, count, until, turn, body }
    }

    fn intersection(&mut self, element: &Element<'a>, emergency: &mut EmergencyChoice) -> LegKind {
        let default = self.reference(element, "default");
        let wanted = "a time or distance as in 30s or 800m";
        let decide_before =
            self.parsed(element, "decideBefore", wanted, decide_before).unwrap_or(DecideBefore::Time(30.0));
        let mut branches = Vec::new();
        self.children(element, emergency, &["branch"], |document, child| {
            if child.name != "branch" {
                return Some(child);
            }
            branches.push(document.branch(child));
            None
        });
        LegKind::Intersection { branches, default, decide_before }
    }

    fn branch(&mut self, element: Element<'a>) -> Branch {
        let branch = Branch {
            id: self.reference(&element, "id").unwrap_or_else(|| self.missing(&element, "id")),
            label: self.text(&element, "label"),
            next: self.reference(&element, "next"),
            when: element.attributes.take("when").map(|source| source.trim().into()),
        };
        self.cursor.close(element);
        branch
    }

    fn scan(&mut self, element: &Element<'a>, emergency: &mut EmergencyChoice) -> LegKind {
        let spacing_m = self.required_value(element, "spacing");
        let heading_deg = self.value(element, "heading");
        let overshoot_m = self.value(element, "overshoot").unwrap_or(Value::Constant(0.0));
        let mut area = None;
        self.children(element, emergency, &["area"], |document, child| {
            if child.name != "area" || area.is_some() {
                return Some(child);
            }
            area = Some(document.area(child));
            None
        });
        if area.is_none() {
            self.missing_child(element, "area");
        }
        let area = area.unwrap_or(Area::Polygon { corners: Vec::new(), holes: Vec::new() });
        LegKind::Scan(Scan { area, spacing_m, heading_deg, overshoot_m })
    }

    /// A circle when it has a radius, else a polygon.
    fn area(&mut self, element: Element<'a>) -> Area {
        if element.attributes.location("radius").is_some() {
            let area = Area::Circle {
                centre: self.place(&element, "centre"),
                radius_m: self.required_value(&element, "radius"),
            };
            self.cursor.close(element);
            return area;
        }
        let mut holes = Vec::new();
        let corners = self.ring(&element, Some(&mut holes));
        self.cursor.finish(&element);
        Area::Polygon { corners, holes }
    }

    fn ring(&mut self, parent: &Element<'a>, mut holes: Option<&mut Vec<Vec<LatLon>>>) -> Vec<LatLon> {
        let mut corners = Vec::new();
        while let Some(child) = self.cursor.child(parent) {
            match (child.name, &mut holes) {
                ("corner", _) => {
                    corners.extend(self.lat_lon(&child, "lat", "lon"));
                    self.cursor.close(child);
                }
                ("hole", Some(holes)) => {
                    holes.push(self.ring(&child, None));
                    self.cursor.finish(&child);
                }
                _ => self.cursor.unknown(child, parent.name, "corner"),
            }
        }
        corners
    }

    fn orbit(&mut self, element: &Element<'a>, emergency: &mut EmergencyChoice) -> LegKind {
        let radius_m = self.required_value(element, "radius");
        let turns = self.value(element, "turns").unwrap_or(Value::Constant(1.0));
        let turn = self.turn(element, None);
        let mut centre = None;
        self.children(element, emergency, &["centre"], |document, child| {
            if child.name != "centre" || centre.is_some() {
                return Some(child);
            }
            centre = Some(document.place(&child, "at"));
            document.cursor.close(child);
            None
        });
        if centre.is_none() {
            self.missing_child(element, "centre");
        }
        LegKind::Orbit { centre: centre.unwrap_or_else(|| Place::Fix(Id::new(""))), radius_m, turns, turn }
    }

    fn missing_child(&mut self, element: &Element<'a>, name: &str) {
        let message = format!("give <{}> a <{name}>", element.name);
        self.cursor.report(Problem::error("missing-element", message).at(element.location));
    }
}

/// `30s` or `800m`.
fn decide_before(text: &str) -> Option<DecideBefore> {
    let time = text.strip_suffix('s').and_then(|t| number(t.trim())).map(DecideBefore::Time);
    time.or_else(|| text.strip_suffix('m').and_then(|t| number(t.trim())).map(DecideBefore::Distance))
}
