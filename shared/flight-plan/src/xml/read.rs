//! From bytes to a plan and problems.

pub(super) mod part;
mod variable;

use super::cursor::{Cursor, Element, MAX_BYTES, shown};
use super::values::{number, position};
use super::{NAMESPACE, attributes};
use crate::{
    Altitude, AltitudeReference, Cause, EmergencyChoice, EmergencyPlan, Fix, FlightPlan, Id, Location,
    Parameter, Problem, Procedure, Runway, Stage, StageKind, Turnaround, TurnaroundEnergy, Zone,
};
use geometry::LatLon;
use simdutf8::compat::Utf8Error;
use std::borrow::Cow;
use std::collections::HashMap;

/// What came out of a document.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Reading {
    /// The plan, as far as it could be made out. What was missing or broken is an unknown fix or NaN in it,
    /// so that the checks refuse it too.
    pub plan: FlightPlan,
    /// What is wrong with the document (not yet with the plan: see [`crate::check`]).
    pub problems: Vec<Problem>,
    /// Where everything stands.
    pub places: Places,
    /// Where numbers stand that could not be read, and whose text the plan has in their place.
    kept: Vec<Location>,
}

/// Where the elements with identifiers stand in a document.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Places(
    /// In the order of the document; most plans have no problems, so that it is computed on request.
    Vec<(Id, Location)>,
);

impl Places {
    /// Where a leg, stage, fix, runway, variable, zone, procedure or emergency plan stands (the last one, if the identifier
    /// is there twice); of a leg that a call makes (`call.leg`): where the call stands.
    pub fn get(&self, id: &Id) -> Option<Location> {
        around(id)
            .find_map(|id| self.0.iter().rev().find(|(known, _)| known.as_str() == id))
            .map(|(_, at)| *at)
    }

    pub(super) fn insert(&mut self, id: &Id, location: Location) {
        self.0.push((id.clone(), location));
    }

    /// Adds places to problems that have a subject and no place.
    pub fn locate(&self, problems: &mut [Problem]) {
        let mut nowhere =
            problems.iter_mut().filter(|p| p.location.is_none() && p.subject.is_some()).peekable();
        if nowhere.peek().is_none() {
            return;
        }
        let places: HashMap<&str, Location> = self.0.iter().map(|(id, at)| (id.as_str(), *at)).collect();
        for problem in nowhere {
            let mut ids = problem.subject.iter().flat_map(around);
            problem.location = ids.find_map(|id| places.get(id).copied());
        }
    }
}

/// An identifier, and those of the calls that it may be made by: `a.b.c`, `a.b`, `a`.
fn around(id: &Id) -> impl Iterator<Item = &str> {
    std::iter::successors(Some(id.as_str()), |id| id.rsplit_once('.').map(|(call, _)| call))
}

impl Reading {
    /// The document has problems that forbid flying.
    pub fn has_errors(&self) -> bool {
        self.problems.iter().any(Problem::is_error)
    }

    /// What is wrong with the document and can't be told of its plan: not the numbers of which the plan has the text. Written
    /// over, only this would be lost.
    pub fn losses(&self) -> impl Iterator<Item = &Problem> {
        let is_kept = |problem: &Problem| {
            let stands_at = |at: &Location| problem.location.as_ref() == Some(at);
            problem.code == "bad-value" && self.kept.iter().any(stands_at)
        };
        self.problems.iter().filter(move |problem| !is_kept(problem))
    }
}

/// Reads a document. Never fails as a whole: see [`Reading`]. Time and memory are bounded by the
/// limits beside this function, for any bytes.
pub fn read(document: impl AsRef<[u8]>) -> Reading {
    let bytes = document.as_ref();
    if bytes.len() > MAX_BYTES {
        let message = format!(
            "this document has {} bytes, at most {MAX_BYTES} are accepted: split the plan",
            bytes.len()
        );
        return Reading { problems: vec![Problem::error("too-large", message)], ..Reading::default() };
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let (text, encoding) = match simdutf8::compat::from_utf8(bytes) {
        Ok(text) => (Cow::Borrowed(text), character_problem(text)),
        Err(error) => (String::from_utf8_lossy(bytes), encoding_problem(bytes, error)),
    };
    let (places, kept) = (Places::default(), Vec::new());
    let mut document = Document { cursor: Cursor::new(&text), places, kept };
    encoding.into_iter().for_each(|p| document.cursor.report(p));
    let plan = document.flight_plan();
    let (places, kept) = (document.places, document.kept);
    Reading { plan, problems: document.cursor.into_problems(), places, kept }
}

fn encoding_problem(bytes: &[u8], error: Utf8Error) -> Option<Problem> {
    let before = String::from_utf8_lossy(bytes.get(..error.valid_up_to())?);
    let message = match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "save the document as UTF-8: it is in UTF-16",
        _ => "save the document as UTF-8: this byte does not belong to it",
    };
    Some(Problem::error("not-utf8", message).at(location_of(&before)))
}

fn character_problem(text: &str) -> Option<Problem> {
    // of ASCII, only control characters are not allowed: a quick test of all bytes at once
    let harmless = |b: &u8| (b' '..0x80).contains(b) || matches!(b, b'\t' | b'\n' | b'\r');
    if text.as_bytes().chunks(1024).all(|chunk| chunk.iter().fold(true, |all, b| all & harmless(b))) {
        return None;
    }
    let (offset, character) = text.char_indices().find(|(_, c)| !attributes::allowed(*c))?;
    let message = format!("remove this character (U+{:04X}): XML does not allow it", u32::from(character));
    Some(Problem::error("bad-character", message).at(location_of(text.get(..offset)?)))
}

/// The place just behind a text.
fn location_of(before: &str) -> Location {
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    let column = before.get(line_start..).map_or(0, |l| l.chars().count()) + 1;
    Location::new(before.matches('\n').count() + 1, column)
}

/// A document being read.
pub(super) struct Document<'a> {
    pub cursor: Cursor<'a>,
    pub places: Places,
    pub kept: Vec<Location>,
}

impl<'a> Document<'a> {
    fn flight_plan(&mut self) -> FlightPlan {
        let mut plan = FlightPlan::default();
        let Some(root) = self.cursor.root() else {
            self.cursor.report(Problem::error(
                "not-a-plan",
                "this is not a flight plan: it has no <flightPlan> element",
            ));
            return plan;
        };
        if root.name != "flightPlan" {
            let message = format!(
                "this is not a flight plan: the first element is <{}>, not <flightPlan>",
                shown(root.name)
            );
            self.cursor.report(Problem::error("not-a-plan", message).at(root.location));
            return plan;
        }
        if root.attributes.take("xmlns").is_none_or(|n| n != NAMESPACE) {
            let message = format!("write xmlns=\"{NAMESPACE}\" on <flightPlan>");
            self.cursor.report(Problem::error("namespace", message).at(root.location));
        }
        plan.name = self.text(&root, "name");
        plan.aircraft = self.required_text(&root, "aircraft");
        while let Some(part) = self.cursor.child(&root) {
            self.part(part, &mut plan);
        }
        self.cursor.finish(&root);
        if let Some(second) = self.cursor.root() {
            self.cursor.unknown(second, "document", "one <flightPlan>");
        }
        plan
    }

    fn part(&mut self, part: Element<'a>, plan: &mut FlightPlan) {
        match part.name {
            "fixes" => self.list(&part, "fix", &mut plan.fixes, Self::fix),
            "runways" => self.list(&part, "runway", &mut plan.runways, Self::runway),
            "variables" => self.list(&part, "variable", &mut plan.variables, Self::variable),
            "zones" => self.zones(&part, &mut plan.zones),
            "procedures" => self.list(&part, "procedure", &mut plan.procedures, Self::procedure),
            "emergencyPlans" => {
                self.list(&part, "emergencyPlan", &mut plan.emergency_plans, Self::emergency_plan)
            }
            "mainPlan" => {
                plan.emergency = self.emergency_attribute(&part);
                self.stages(&part, &mut plan.stages, Some(&mut plan.emergency));
            }
            _ => {
                return self.cursor.unknown(
                    part,
                    "flightPlan",
                    "fixes, runways, variables, zones, procedures, mainPlan, emergencyPlans",
                );
            }
        }
        self.cursor.finish(&part);
    }

    fn list<T>(
        &mut self,
        parent: &Element<'a>,
        name: &str,
        into: &mut Vec<T>,
        read: fn(&mut Self, Element<'a>) -> T,
    ) {
        while let Some(child) = self.cursor.child(parent) {
            if child.name == name {
                let item = read(self, child);
                into.push(item);
            } else {
                self.cursor.unknown(child, parent.name, name);
            }
        }
    }

    fn zones(&mut self, parent: &Element<'a>, into: &mut Vec<Zone>) {
        while let Some(child) = self.cursor.child(parent) {
            if matches!(child.name, "keepIn" | "keepOut") {
                let zone = self.zone(child);
                into.push(zone);
            } else {
                self.cursor.unknown(child, parent.name, "keepIn, keepOut");
            }
        }
    }

    fn procedure(&mut self, element: Element<'a>) -> Procedure {
        let wanted = "a position: latitude and longitude in degrees";
        let (mut parameters, mut legs) = (Vec::new(), Vec::new());
        let procedure = Procedure {
            id: self.id(&element, "id"),
            name: self.text(&element, "name"),
            parameters: Vec::new(),
            reference: self.parsed(&element, "reference", wanted, position),
            bearing_deg: self.number(&element, "bearing").unwrap_or(0.0),
            legs: Vec::new(),
        };
        while let Some(child) = self.cursor.child(&element) {
            if child.name == "parameter" {
                parameters.push(self.parameter(child));
            } else {
                self.leg_of(&element, child, &mut legs);
            }
        }
        self.cursor.finish(&element);
        Procedure { parameters, legs, ..procedure }
    }

    fn parameter(&mut self, element: Element<'a>) -> Parameter {
        let name = self.reference(&element, "name").unwrap_or_else(|| self.missing(&element, "name"));
        let parameter = Parameter { name, default: self.source(&element, "default") };
        self.cursor.close(element);
        parameter
    }

    fn fix(&mut self, element: Element<'a>) -> Fix {
        let fix = Fix {
            id: self.id(&element, "id"),
            position: self.lat_lon(&element, "lat", "lon").unwrap_or(NOWHERE),
            name: self.text(&element, "name"),
            description: self.text(&element, "description"),
        };
        self.cursor.close(element);
        fix
    }

    fn runway(&mut self, element: Element<'a>) -> Runway {
        let runway = Runway {
            id: self.id(&element, "id"),
            threshold: self.lat_lon(&element, "lat", "lon").unwrap_or(NOWHERE),
            elevation_amsl_m: self.required_number(&element, "elevation"),
            heading_deg: self.required_number(&element, "heading"),
            length_m: self.required_number(&element, "length"),
            priority: self.whole(&element, "priority").unwrap_or(1),
            approach_entry: self.parsed(
                &element,
                "approachEntry",
                "a position: latitude and longitude in degrees",
                position,
            ),
        };
        self.cursor.close(element);
        runway
    }

    fn emergency_plan(&mut self, element: Element<'a>) -> EmergencyPlan {
        let mut plan = EmergencyPlan {
            id: self.id(&element, "id"),
            name: self.text(&element, "name"),
            runway: self.reference(&element, "runway").unwrap_or_else(|| self.missing(&element, "runway")),
            stages: Vec::new(),
        };
        self.stages(&element, &mut plan.stages, None);
        self.cursor.finish(&element);
        plan
    }

    /// Stages, and where the element may have them, emergencies by cause.
    fn stages(
        &mut self,
        parent: &Element<'a>,
        into: &mut Vec<Stage>,
        mut emergency: Option<&mut EmergencyChoice>,
    ) {
        while let Some(child) = self.cursor.child(parent) {
            match (child.name, &mut emergency) {
                ("stage", _) => {
                    let stage = self.stage(child);
                    into.push(stage);
                }
                ("emergency", Some(choice)) => self.emergency_child(child, choice),
                _ => self.cursor.unknown(child, parent.name, "stage"),
            }
        }
    }

    fn stage(&mut self, element: Element<'a>) -> Stage {
        const KINDS: [(&str, StageKind); 7] = [
            ("take-off", StageKind::TakeOff),
            ("departure", StageKind::Departure),
            ("en-route", StageKind::EnRoute),
            ("mission", StageKind::Mission),
            ("arrival", StageKind::Arrival),
            ("approach", StageKind::Approach),
            ("land", StageKind::Land),
        ];
        self.require(&element, "type");
        let mut stage = Stage {
            id: self.id(&element, "id"),
            name: self.text(&element, "name"),
            kind: self.choice(&element, "type", &KINDS).unwrap_or(StageKind::EnRoute),
            emergency: self.emergency_attribute(&element),
            runway: self.reference(&element, "runway"),
            altitude: self.altitude(&element),
            speed_mps: self.value(&element, "speed"),
            turnaround: Turnaround {
                energy: self.turnaround_energy(&element),
                time_s: self.number(&element, "turnaroundTime"),
            },
            legs: Vec::new(),
        };
        self.legs(&element, &mut stage.legs, &mut stage.emergency);
        self.cursor.finish(&element);
        stage
    }

    fn turnaround_energy(&mut self, element: &Element<'a>) -> Option<TurnaroundEnergy> {
        self.parsed(element, "turnaroundEnergy", "a finite number, or kept", |text| match text {
            TurnaroundEnergy::KEPT => Some(TurnaroundEnergy::Kept),
            share => number(share).map(TurnaroundEnergy::Share),
        })
    }

    /// The `emergency` attribute: the fallback for every cause.
    pub fn emergency_attribute(&mut self, element: &Element<'a>) -> EmergencyChoice {
        let by_cause = self.reference(element, "emergency").map_or_else(Vec::new, |plan| vec![(None, plan)]);
        EmergencyChoice { by_cause }
    }

    /// `<emergency cause="…" plan="…"/>`.
    pub fn emergency_child(&mut self, element: Element<'a>, into: &mut EmergencyChoice) {
        let causes = Cause::ALL.map(|cause| (cause.word(), cause));
        self.require(&element, "cause");
        let cause = self.choice(&element, "cause", &causes);
        let plan = self.reference(&element, "plan").unwrap_or_else(|| self.missing(&element, "plan"));
        into.by_cause.push((cause, plan));
        self.cursor.close(element);
    }

    pub fn altitude(&mut self, element: &Element<'a>) -> Option<Altitude> {
        let reference = self.choice(element, "altitudeReference", &AltitudeReference::NAMES);
        let metres = self.value(element, "altitude");
        self.both_or_neither(element, "altitude", "altitudeReference");
        Some(Altitude { metres: metres?, reference: reference.unwrap_or(AltitudeReference::Amsl) })
    }

    /// Metres and what they are measured from.
    pub fn both_or_neither(&mut self, element: &Element<'a>, metres: &str, reference: &str) {
        if element.attributes.take(metres).is_some() != element.attributes.take(reference).is_some() {
            let message = format!(
                "give <{}> both `{metres}` and `{reference}` (amsl, agl or home), or neither",
                element.name
            );
            self.cursor.report(Problem::error("missing-attribute", message).at(element.location));
        }
    }
}

/// Stands for a position that could not be read: never valid.
const NOWHERE: LatLon = LatLon::new(f64::NAN, f64::NAN);
