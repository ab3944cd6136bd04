//! From a plan to its canonical document: fixed order, two spaces, shortest numbers.

use super::attributes::allowed;
use super::values::as_it_stood;
use super::write_legs::{alone, leg};
use super::{NAMESPACE, zone};
use crate::{
    Altitude, Cause, EmergencyChoice, EmergencyPlan, Fix, FlightPlan, Leg, Place, PlanWaypoint, Procedure,
    Runway, Stage, TurnDirection, Turnaround, Value, Variable, VariableValue, Zone,
};
use geometry::LatLon;
use std::fmt::{Display, Write};
use std::sync::Arc;

/// The canonical document of a plan. Reading it gives the plan back.
pub fn write(plan: &FlightPlan) -> String {
    let mut out = Writer { text: String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"), depth: 0 };
    let tag = Tag::new("flightPlan")
        .with("xmlns", NAMESPACE)
        .text("name", &plan.name)
        .with("aircraft", &plan.aircraft);
    out.element(tag, |out| {
        out.list("fixes", &plan.fixes, fix);
        out.list("runways", &plan.runways, runway);
        out.list("variables", &plan.variables, variable);
        out.list("zones", &plan.zones, zone::write);
        out.list("procedures", &plan.procedures, procedure);
        out.element(fallback(Tag::new("mainPlan"), &plan.emergency), |out| {
            out.emergencies(&plan.emergency);
            plan.stages.iter().for_each(|s| stage(out, s));
        });
        out.list("emergencyPlans", &plan.emergency_plans, emergency_plan);
    });
    out.text
}

/// A part of a plan by itself, without what has identifiers of its own in it.
pub(crate) enum Piece<'p> {
    /// The plan's own properties.
    Head(&'p FlightPlan),
    Fix(&'p Fix),
    Runway(&'p Runway),
    Variable(&'p Variable),
    Zone(&'p Zone),
    Procedure(&'p Procedure),
    Stage(&'p Stage),
    Leg(&'p Leg),
    EmergencyPlan(&'p EmergencyPlan),
}

/// The canonical text of a part.
pub(crate) fn text(piece: &Piece) -> String {
    let mut out = Writer { text: String::new(), depth: 0 };
    match piece {
        Piece::Head(plan) => {
            let tag = Tag::new("flightPlan").text("name", &plan.name).with("aircraft", &plan.aircraft);
            out.element(fallback(tag, &plan.emergency), |out| out.emergencies(&plan.emergency));
        }
        Piece::Fix(x) => fix(&mut out, x),
        Piece::Runway(x) => runway(&mut out, x),
        Piece::Variable(x) => variable(&mut out, x),
        Piece::Zone(x) => zone::write(&mut out, x),
        Piece::Procedure(x) => out.element(procedure_tag(x), |out| parameters(out, x)),
        Piece::Stage(x) => out.element(stage_tag(x), |out| out.emergencies(&x.emergency)),
        Piece::Leg(x) => alone(&mut out, x),
        Piece::EmergencyPlan(x) => out.leaf(emergency_plan_tag(x)),
    }
    out.text
}

/// Legs by themselves.
pub(super) fn legs(legs: &[Arc<Leg>]) -> String {
    let mut out = Writer { text: String::new(), depth: 0 };
    legs.iter().for_each(|l| leg(&mut out, l));
    out.text
}

/// A start tag being put together.
pub(super) struct Tag {
    name: &'static str,
    text: String,
}

impl Tag {
    pub(super) fn new(name: &'static str) -> Self {
        let mut text = String::with_capacity(120);
        text.push('<');
        text.push_str(name);
        Self { name, text }
    }

    pub(super) fn with(mut self, name: &str, value: impl Display) -> Self {
        self.text.push(' ');
        self.text.push_str(name);
        self.text.push_str("=\"");
        let _ = write!(Escaped(&mut self.text), "{value}");
        self.text.push('"');
        self
    }

    pub(super) fn maybe(self, name: &str, value: Option<impl Display>) -> Self {
        match value {
            Some(value) => self.with(name, value),
            None => self,
        }
    }

    /// Left out when empty.
    pub(super) fn text(self, name: &str, value: &str) -> Self {
        self.maybe(name, Some(value).filter(|v| !v.is_empty()))
    }

    /// Identifiers with spaces between them; left out when there are none.
    pub(super) fn ids(self, name: &str, ids: &[crate::Id]) -> Self {
        self.text(name, &ids.iter().map(|id| id.as_str()).collect::<Vec<_>>().join(" "))
    }

    /// An expression, or nothing.
    pub(super) fn source(self, name: &str, source: &str) -> Self {
        self.with(name, format_args!("= {source}"))
    }

    pub(super) fn value(self, name: &str, value: &Value<f64>) -> Self {
        match value {
            Value::Constant(x) => self.with(name, x),
            Value::Expression(source) => match as_it_stood(source) {
                Some(text) => self.with(name, text),
                None => self.with(name, format_args!("= {source}")),
            },
        }
    }

    pub(super) fn maybe_value(self, name: &str, value: Option<&Value<f64>>) -> Self {
        match value {
            Some(value) => self.value(name, value),
            None => self,
        }
    }

    pub(super) fn altitude(self, altitude: Option<&Altitude>) -> Self {
        let Some(altitude) = altitude else { return self };
        self.value("altitude", &altitude.metres).with("altitudeReference", altitude.reference.name())
    }

    /// A place; a constant as `lat` and `lon`.
    pub(super) fn place(self, place: &Place, expression: &str) -> Self {
        match place {
            Place::Fix(id) => self.with("fix", id),
            Place::Position(Value::Constant(p)) => self.with("lat", p.lat_deg).with("lon", p.lon_deg),
            Place::Position(Value::Expression(source)) => self.with(expression, format_args!("= {source}")),
        }
    }

    pub(super) fn waypoint(self, waypoint: &PlanWaypoint) -> Self {
        self.place(&waypoint.place, "at").maybe("flyOver", waypoint.fly_over.then_some(true))
    }

    pub(super) fn turn(self, turn: TurnDirection) -> Self {
        self.with("turn", if turn == TurnDirection::Left { "left" } else { "right" })
    }
}

/// Attribute values: what reading would change is written as a reference; what XML can't say becomes U+FFFD.
pub(super) struct Escaped<'a>(pub &'a mut String);

impl Write for Escaped<'_> {
    fn write_str(&mut self, value: &str) -> std::fmt::Result {
        let plain = |b: u8| (b' '..=b'~').contains(&b) && !matches!(b, b'&' | b'<' | b'>' | b'"');
        if value.bytes().all(plain) {
            self.0.push_str(value);
            return Ok(());
        }
        value.chars().try_for_each(|c| match c {
            '&' => self.0.write_str("&amp;"),
            '<' => self.0.write_str("&lt;"),
            '>' => self.0.write_str("&gt;"),
            '"' => self.0.write_str("&quot;"),
            '\t' | '\n' | '\r' => write!(self.0, "&#{};", u32::from(c)),
            c if allowed(c) => self.0.write_char(c),
            _ => self.0.write_char('\u{fffd}'),
        })
    }
}

/// The document being written.
pub(super) struct Writer {
    text: String,
    depth: usize,
}

impl Writer {
    fn line(&mut self, parts: [&str; 3]) {
        (0..self.depth).for_each(|_| self.text.push_str("  "));
        parts.iter().for_each(|part| self.text.push_str(part));
        self.text.push('\n');
    }

    pub(super) fn leaf(&mut self, tag: Tag) {
        self.line([&tag.text, "/>", ""]);
    }

    /// An element with its children; without children it is a leaf.
    pub(super) fn element(&mut self, tag: Tag, children: impl FnOnce(&mut Self)) {
        let before = self.text.len();
        self.line([&tag.text, ">", ""]);
        let opened = self.text.len();
        self.depth += 1;
        children(self);
        self.depth -= 1;
        if self.text.len() == opened {
            self.text.truncate(before);
            self.leaf(tag);
        } else {
            self.line(["</", tag.name, ">"]);
        }
    }

    pub(super) fn list<T>(&mut self, name: &'static str, items: &[T], write: fn(&mut Self, &T)) {
        if !items.is_empty() {
            self.element(Tag::new(name), |out| items.iter().for_each(|item| write(out, item)));
        }
    }

    /// Everything but the fallback, which is the `emergency` attribute.
    pub(super) fn emergencies(&mut self, choice: &EmergencyChoice) {
        for (cause, plan) in choice.by_cause.iter().filter(|(cause, _)| cause.is_some()) {
            self.leaf(Tag::new("emergency").maybe("cause", cause.map(Cause::word)).with("plan", plan));
        }
    }
}

pub(super) fn fallback(tag: Tag, choice: &EmergencyChoice) -> Tag {
    tag.maybe("emergency", choice.by_cause.iter().find(|(cause, _)| cause.is_none()).map(|(_, plan)| plan))
}

pub(super) fn lat_lon(p: LatLon) -> String {
    format!("{} {}", p.lat_deg, p.lon_deg)
}

/// `lat lon, lat lon, …`.
pub(super) fn lat_lons(positions: &[LatLon]) -> String {
    positions.iter().map(|p| lat_lon(*p)).collect::<Vec<_>>().join(", ")
}

fn fix(out: &mut Writer, fix: &Fix) {
    let tag = Tag::new("fix")
        .with("id", &fix.id)
        .with("lat", fix.position.lat_deg)
        .with("lon", fix.position.lon_deg);
    out.leaf(tag.text("name", &fix.name).text("description", &fix.description));
}

fn runway(out: &mut Writer, runway: &Runway) {
    let tag = Tag::new("runway")
        .with("id", &runway.id)
        .with("lat", runway.threshold.lat_deg)
        .with("lon", runway.threshold.lon_deg)
        .with("elevation", runway.elevation_amsl_m)
        .with("heading", runway.heading_deg)
        .with("length", runway.length_m)
        .with("priority", runway.priority)
        .maybe("approachEntry", runway.approach_entry.map(lat_lon));
    out.leaf(tag);
}

fn variable(out: &mut Writer, variable: &Variable) {
    let initial = match &variable.initial {
        VariableValue::Bool(b) => b.to_string(),
        VariableValue::Number(x) => x.to_string(),
        VariableValue::Text(text) => text.clone(),
        VariableValue::Position(p) => lat_lon(*p),
        VariableValue::Polygon(corners) => lat_lons(corners),
    };
    let tag = Tag::new("variable")
        .with("name", &variable.name)
        .with("type", variable.initial.type_name())
        .with("initial", initial)
        .text("unit", &variable.unit)
        .maybe("min", variable.min)
        .maybe("max", variable.max)
        .maybe("maxLength", variable.max_length)
        .ids("writers", &variable.writers);
    out.leaf(tag);
}

fn emergency_plan_tag(plan: &EmergencyPlan) -> Tag {
    Tag::new("emergencyPlan").with("id", &plan.id).text("name", &plan.name).with("runway", &plan.runway)
}

fn emergency_plan(out: &mut Writer, plan: &EmergencyPlan) {
    out.element(emergency_plan_tag(plan), |out| plan.stages.iter().for_each(|s| stage(out, s)));
}

fn stage_tag(stage: &Stage) -> Tag {
    let tag =
        Tag::new("stage").with("id", &stage.id).text("name", &stage.name).with("type", stage.kind.word());
    let tag = fallback(tag, &stage.emergency).maybe("runway", stage.runway.as_ref());
    let tag = tag.altitude(stage.altitude.as_ref()).maybe_value("speed", stage.speed_mps.as_ref());
    let Turnaround { energy, time_s } = stage.turnaround;
    tag.maybe("turnaroundEnergy", energy).maybe("turnaroundTime", time_s)
}

fn stage(out: &mut Writer, stage: &Stage) {
    out.element(stage_tag(stage), |out| {
        out.emergencies(&stage.emergency);
        stage.legs.iter().for_each(|l| leg(out, l));
    });
}

fn procedure_tag(procedure: &Procedure) -> Tag {
    let bearing = Some(procedure.bearing_deg).filter(|bearing| *bearing != 0.0);
    let tag = Tag::new("procedure").with("id", &procedure.id).text("name", &procedure.name);
    tag.maybe("reference", procedure.reference.map(lat_lon)).maybe("bearing", bearing)
}

fn parameters(out: &mut Writer, procedure: &Procedure) {
    for parameter in &procedure.parameters {
        let tag = Tag::new("parameter").with("name", &parameter.name);
        out.leaf(match &parameter.default {
            Some(source) => tag.source("default", source),
            None => tag,
        });
    }
}

fn procedure(out: &mut Writer, procedure: &Procedure) {
    out.element(procedure_tag(procedure), |out| {
        parameters(out, procedure);
        procedure.legs.iter().for_each(|l| leg(out, l));
    });
}
