//! Legs of a document.

use super::cursor::Element;
use super::read::Document;
use super::values::number;
use crate::{
    Branch, Call, DecideBefore, EmergencyChoice, Holding, HoldingLength, Id, IterativeForm, Leg, LegAction,
    LegKind, Place, PlanWaypoint, Problem, TurnDirection, Value,
};
use geometry::LatLon;
use std::sync::Arc;

const LEGS: &str = "IF, TF, DF, RF, CF, FA, HF, HA, HM, iterative, intersection, call, scan, creepingLine, crissCross, \
                    spiral, expandingSquare, sector, trackLine, corridor, contour, orbit, figureEight, action, emergency";
const TURNS: [(&str, TurnDirection); 2] = [("left", TurnDirection::Left), ("right", TurnDirection::Right)];

impl<'a> Document<'a> {
    /// The legs of a stage, and its emergencies by cause.
    pub fn legs(&mut self, parent: &Element<'a>, into: &mut Vec<Arc<Leg>>, emergency: &mut EmergencyChoice) {
        while let Some(child) = self.cursor.child(parent) {
            match child.name {
                "emergency" => self.emergency_child(child, emergency),
                _ => self.leg_of(parent, child, into),
            }
        }
    }

    /// A leg, if it is one.
    pub fn leg_of(&mut self, parent: &Element<'a>, child: Element<'a>, into: &mut Vec<Arc<Leg>>) {
        if is_leg(child.name) {
            into.push(Arc::new(self.leg(child)));
        } else {
            self.cursor.unknown(child, parent.name, LEGS);
        }
    }

    pub(super) fn leg(&mut self, element: Element<'a>) -> Leg {
        let id = self.id(&element, "id");
        let name = self.text(&element, "name");
        let mut emergency = self.emergency_attribute(&element);
        let altitude = self.altitude(&element);
        let speed_mps = self.value(&element, "speed");
        let next = self.reference(&element, "next");
        let mut actions = Vec::new();
        let kind = self.leg_kind(&element, &mut emergency, &mut actions);
        self.cursor.end(element);
        Leg { id, name, emergency, altitude, speed_mps, next, actions, kind }
    }

    fn leg_kind(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> LegKind {
        match element.name {
            "iterative" => self.iterative(element, emergency, actions),
            "intersection" => self.intersection(element, emergency, actions),
            "call" => self.call(element, emergency, actions),
            "IF" | "TF" | "DF" | "RF" | "CF" | "FA" | "HF" | "HA" | "HM" => {
                let kind = self.basic(element);
                self.children(element, emergency, actions, &[], |_, child| Some(child));
                kind
            }
            _ => self.pattern(element, emergency, actions),
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
            "CF" => {
                LegKind::Cf { to: self.waypoint(element), course_deg: self.required_value(element, "course") }
            }
            "FA" => LegKind::Fa {
                from: self.waypoint(element),
                course_deg: self.required_value(element, "course"),
            },
            "HM" => LegKind::Hm {
                holding: self.holding(element),
                until: self.condition(element, "until"),
                max_laps: self.value(element, "maxLaps"),
            },
            "HF" => LegKind::Hf(self.holding(element)),
            _ => LegKind::Ha(self.holding(element)),
        }
    }

    /// The children of a leg: emergencies by cause, actions, and what `take` takes; it gives back what it does not know.
    pub(super) fn children(
        &mut self,
        parent: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
        allowed: &[&str],
        mut take: impl FnMut(&mut Self, Element<'a>) -> Option<Element<'a>>,
    ) {
        while let Some(child) = self.cursor.child(parent) {
            if child.name == "emergency" {
                self.emergency_child(child, emergency);
            } else if child.name == "action" {
                actions.extend(self.action(child));
            } else if let Some(stranger) = take(self, child) {
                let allowed: Vec<&str> = allowed.iter().copied().chain(["action", "emergency"]).collect();
                self.cursor.unknown(stranger, parent.name, &allowed.join(", "));
            }
        }
    }

    fn waypoint(&mut self, element: &Element<'a>) -> PlanWaypoint {
        PlanWaypoint { place: self.place(element, "at"), fly_over: self.flag(element, "flyOver") }
    }

    /// `fix="…"`, `lat="…" lon="…"`, or a position or expression in `other`: exactly one of them.
    pub(super) fn place(&mut self, element: &Element<'a>, other: &str) -> Place {
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

    pub(super) fn turn(&mut self, element: &Element<'a>, default: Option<TurnDirection>) -> TurnDirection {
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

    fn iterative(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> LegKind {
        const FORMS: [(&str, IterativeForm); 2] =
            [("forward", IterativeForm::Forward), ("reverse", IterativeForm::Reverse)];
        self.require(element, "form");
        let form = self.choice(element, "form", &FORMS).unwrap_or(IterativeForm::Forward);
        let count = self.value(element, "count");
        let until = self.condition(element, "until");
        let turn = self.turn(element, Some(TurnDirection::Right));
        let mut body = Vec::new();
        self.children(element, emergency, actions, &[LEGS], |document, child| {
            if !is_leg(child.name) {
                return Some(child);
            }
            body.push(Arc::new(document.leg(child)));
            None
        });
        LegKind::Iterative { form, count, until, turn, body }
    }

    fn intersection(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> LegKind {
        let default = self.reference(element, "default");
        let wanted = "a time or distance as in 30s or 800m";
        let decide_before =
            self.parsed(element, "decideBefore", wanted, decide_before).unwrap_or(DecideBefore::Time(30.0));
        let mut branches = Vec::new();
        self.children(element, emergency, actions, &["branch"], |document, child| {
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
            when: self.condition(&element, "when"),
        };
        self.cursor.close(element);
        branch
    }

    fn call(
        &mut self,
        element: &Element<'a>,
        emergency: &mut EmergencyChoice,
        actions: &mut Vec<LegAction>,
    ) -> LegKind {
        let procedure =
            self.reference(element, "procedure").unwrap_or_else(|| self.missing(element, "procedure"));
        let anchored = ["fix", "lat", "lon", "at"].iter().any(|n| element.attributes.has(n));
        let anchor = anchored.then(|| self.place(element, "at"));
        let bearing_deg = self.value(element, "bearing");
        let mut arguments = Vec::new();
        self.children(element, emergency, actions, &["argument"], |document, child| {
            if child.name != "argument" {
                return Some(child);
            }
            let name = document.reference(&child, "name").unwrap_or_else(|| document.missing(&child, "name"));
            arguments.push((name, document.required_source(&child, "value")));
            document.cursor.close(child);
            None
        });
        LegKind::Call(Call { procedure, arguments, anchor, bearing_deg })
    }

    pub(super) fn missing_child(&mut self, element: &Element<'a>, name: &str) {
        let message = format!("give <{}> a <{name}>", element.name);
        self.cursor.report(Problem::error("missing-element", message).at(element.location));
    }
}

/// A leg's element.
pub(super) fn is_leg(name: &str) -> bool {
    matches!(
        name,
        "IF" | "TF"
            | "DF"
            | "RF"
            | "CF"
            | "FA"
            | "HF"
            | "HA"
            | "HM"
            | "iterative"
            | "intersection"
            | "call"
            | "scan"
            | "creepingLine"
            | "crissCross"
            | "spiral"
            | "expandingSquare"
            | "sector"
            | "trackLine"
            | "corridor"
            | "contour"
            | "orbit"
            | "figureEight"
    )
}

/// `30s` or `800m`.
fn decide_before(text: &str) -> Option<DecideBefore> {
    let time = text.strip_suffix('s').and_then(|t| number(t.trim())).map(DecideBefore::Time);
    time.or_else(|| text.strip_suffix('m').and_then(|t| number(t.trim())).map(DecideBefore::Distance))
}
