//! The rows of the table: a heading where a stage begins, and the passages of its legs.

use super::typed::Column;
use super::unflown::{self, Flown};
use crate::command::Selection;
use crate::forecast::{Forecast, Passage, Point};
use crate::panels::Scene;
use crate::panels::inspector::inherited::{self, Inherited};
use crate::panels::tree::title;
use crate::units;
use flight_plan::{
    Altitude, AltitudeReference, FlightPlan, Id, LegContext, Problem, Section, Value, instantiate,
};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};

/// One row.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Row {
    /// A stage begins, or what stands behind all that is flown: an emergency plan, a procedure.
    Heading(Selection),
    /// A passage of the forecast, by its index.
    Passage(usize),
    /// A leg that would be left out, by its index in the forecast.
    LeftOut(usize),
    /// A leg that the forecast does not come to: there is none yet, or the plan has an error; and its stage.
    Written(Id, Id),
    /// A leg that the preview does not fly, what it is in, and why.
    Aside(Id, Id, Aside),
}

/// What a leg is of that the preview does not fly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aside {
    /// Another way on from a fork.
    Way,
    Emergency,
    Procedure,
}

/// A leg in the table.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry<'a> {
    pub leg: &'a Id,
    pub stage: &'a Id,
    /// A passage of it; else why it is not flown.
    pub flown: Result<&'a Passage, Why<'a>>,
}

/// Why a leg is not flown.
#[derive(Debug, Clone, Copy)]
pub(super) enum Why<'a> {
    /// The aircraft would leave it out.
    LeftOut(&'a str),
    /// The forecast does not come so far, or there is none.
    NotForeseen,
    /// The preview goes elsewhere.
    Aside(Aside),
}

impl Why<'_> {
    /// In words.
    pub fn told(&self, scene: &Scene<'_>) -> String {
        match self {
            Self::LeftOut(why) => format!("⚠ Left out: {why}"),
            Self::NotForeseen if scene.problems().any(Problem::is_error) => {
                "Not flown yet: the plan has an error, see its problems".into()
            }
            Self::NotForeseen => format!("Not flown yet. {}", scene.analysis.why_no_forecast()),
            Self::Aside(Aside::Way) => "Not flown in this preview: it goes another way".into(),
            Self::Aside(Aside::Emergency) => "Flown in an emergency only".into(),
            Self::Aside(Aside::Procedure) => "Not flown in this preview: nothing calls it".into(),
        }
    }
}

impl Row {
    /// `None`: it is a heading.
    pub fn entry<'a>(&'a self, forecast: &'a Forecast) -> Option<Entry<'a>> {
        match self {
            Self::Heading(_) => None,
            Self::Passage(index) => {
                let passage = forecast.passages.get(*index)?;
                Some(Entry { leg: &passage.leg, stage: &passage.stage, flown: Ok(passage) })
            }
            Self::LeftOut(index) => {
                let left = forecast.left_out.get(*index)?;
                Some(Entry { leg: &left.leg, stage: &left.stage, flown: Err(Why::LeftOut(&left.reason)) })
            }
            Self::Written(leg, stage) => Some(Entry { leg, stage, flown: Err(Why::NotForeseen) }),
            Self::Aside(leg, stage, of) => Some(Entry { leg, stage, flown: Err(Why::Aside(*of)) }),
        }
    }
}

/// All rows of a flight: legs that would be left out stand where they would be flown; of a plan with errors those behind it, too.
/// `shows_all`: with the legs that are not flown at all.
pub(super) fn rows(forecast: &Forecast, plan: &FlightPlan, shows_all: bool) -> Vec<Row> {
    let flown = Flown::of(forecast, plan);
    let behind: Vec<_> = match forecast.is_beginning || forecast.passages.is_empty() {
        true => behind(forecast, plan).collect(),
        false => Vec::new(),
    };
    let told = forecast.left_out.iter().map(|left| &left.leg).chain(behind.iter().map(|(leg, _)| *leg));
    let told: HashSet<&Id> = told.collect();
    let mut beside = if shows_all { unflown::beside(plan, &flown) } else { Vec::new() };
    beside.retain(|beside| !told.contains(beside.leg));
    let mut beside = beside.into_iter().peekable();
    let mut rows = Vec::with_capacity(forecast.passages.len());
    let mut left_out = forecast.left_out.iter().enumerate().peekable();
    let mut stage: Option<&Id> = None;
    let mut push = |rows: &mut Vec<Row>, of, row| {
        if stage != Some(of) {
            rows.push(Row::Heading(Selection::Stage(of.clone())));
            stage = Some(of);
        }
        rows.push(row);
    };
    for index in 0..=forecast.passages.len() {
        while let Some((number, left)) = left_out.next_if(|(_, left)| left.before <= index) {
            push(&mut rows, &left.stage, Row::LeftOut(number));
        }
        while let Some(aside) = beside.next_if(|beside| beside.before <= index) {
            let row = Row::Aside(aside.leg.clone(), aside.stage.clone(), Aside::Way);
            push(&mut rows, aside.stage, row);
        }
        if let Some(passage) = forecast.passages.get(index) {
            push(&mut rows, &passage.stage, Row::Passage(index));
        }
    }
    for (leg, stage) in behind {
        push(&mut rows, stage, Row::Written(leg.clone(), stage.clone()));
    }
    if shows_all {
        rows.extend(unflown::elsewhere(plan, &flown));
    }
    rows
}

/// The legs of the main plan behind all that is flown, with their stages.
fn behind<'p>(forecast: &Forecast, plan: &'p FlightPlan) -> impl Iterator<Item = (&'p Id, &'p Id)> {
    let flown: HashSet<&Id> = forecast.passages.iter().map(|passage| &passage.leg).collect();
    let legs: Vec<_> = plan.all_legs();
    let main = legs.into_iter().filter(|context| context.section == Section::Main);
    let main = main.filter(|context| !unflown::is_around_others(context.leg));
    let main: Vec<_> = main.map(|context| (&context.leg.id, &context.stage.id)).collect();
    let first = main.iter().rposition(|(leg, _)| flown.contains(leg)).map_or(0, |last| last + 1);
    main.into_iter().skip(first)
}

/// What the plan says of a leg's altitude and airspeed, and where it says it.
#[derive(Debug, Clone, Default)]
pub(super) struct Said {
    pub altitude: Option<Inherited<Altitude>>,
    pub speed_mps: Option<Inherited<Value<f64>>>,
}

/// What the plan says of every leg: looked up once for a version of it.
pub(super) fn said(plan: &FlightPlan) -> HashMap<Id, Said> {
    let of_leg = |context: LegContext<'_>| {
        let (altitude, speed_mps) = (inherited::altitude_said(&context), inherited::speed_said(&context));
        (context.leg.id.clone(), Said { altitude, speed_mps })
    };
    let of_legs = plan.all_legs().into_iter().map(of_leg);
    // legs that calls make have these around them
    let (flown, _) = instantiate(plan);
    let made = match &flown {
        Cow::Owned(flown) => flown.all_legs(),
        Cow::Borrowed(_) => Vec::new(),
    };
    // of a procedure that nothing calls, what is around it is not known
    // what has no legs is flown by the stage itself
    let stages = plan.all_stages().map(|(_, stage)| {
        let altitude = stage.altitude.as_ref().map(Inherited::own);
        (stage.id.clone(), Said { altitude, speed_mps: stage.speed_mps.as_ref().map(Inherited::own) })
    });
    let of_procedures = plan.procedure_legs().into_iter().map(|leg| {
        let altitude = leg.altitude.as_ref().map(Inherited::own);
        (leg.id.clone(), Said { altitude, speed_mps: leg.speed_mps.as_ref().map(Inherited::own) })
    });
    stages.chain(of_procedures).chain(made.into_iter().map(of_leg)).chain(of_legs).collect()
}

/// What a row is of: a leg, also that of a procedure, or a stage without legs.
pub(super) fn part(scene: &Scene<'_>, entry: &Entry<'_>) -> Selection {
    scene.document.part_of(entry.leg)
}

/// What people call it.
pub(super) fn label(scene: &Scene<'_>, entry: &Entry<'_>) -> String {
    let stage = scene.document.plan().stage(entry.stage).filter(|stage| stage.id == *entry.leg);
    stage.map_or_else(
        || scene.document.label(entry.leg).to_owned(),
        |stage| title(&stage.name, stage.id.as_str()),
    )
}

/// What the table says above its columns.
pub(super) fn heads(units: crate::units::Units) -> [String; Column::COUNT] {
    let (distance, altitude) = (units.distance().symbol, units.altitude().symbol);
    [
        "Leg".into(),
        "Altitude".into(),
        "Airspeed".into(),
        "ETE".into(),
        "Energy left".into(),
        format!("Above ground, {altitude}"),
        "Type".into(),
        "Pass".into(),
        "Track".into(),
        format!("Distance, {distance}"),
        format!("Total, {distance}"),
        format!("Altitude AMSL, {altitude}"),
        "Elapsed".into(),
        format!("Speed, {}", units.speed().symbol),
    ]
}

/// What stands in the columns of a leg.
pub(super) fn cells(scene: &Scene<'_>, entry: &Entry<'_>, said: &Said) -> [String; Column::COUNT] {
    let kind = scene.document.kind_name(entry.leg);
    let passage = entry.flown.ok();
    let pass = passage.map_or_else(String::new, pass);
    let points = passage.and_then(|passage| scene.forecast().part(passage)).unwrap_or_default();
    let name = label(scene, entry);
    let (altitude, airspeed) = (altitude_text(scene, said, points), airspeed_text(scene, said));
    let (Some(passage), Some(first), Some(last)) = (passage, points.first(), points.last()) else {
        let mut cells = [(); Column::COUNT].map(|()| "–".to_owned());
        cells[..3].clone_from_slice(&[name, altitude, airspeed]);
        cells[6..8].clone_from_slice(&[kind.into(), pass]);
        return cells;
    };
    let u = scene.units();
    [
        name,
        altitude,
        airspeed,
        units::duration(last.time_s - first.time_s),
        format!("{:.0} %", 100.0 * passage.energy_left),
        passage.clearance_m.map_or_else(|| "–".into(), |metres| u.altitude().number(on_ground(metres))),
        kind.into(),
        pass,
        track(first, last),
        u.distance().number(last.distance_m - first.distance_m),
        u.distance().number(last.distance_m),
        u.altitude().number(last.altitude_amsl_m),
        units::duration(last.time_s),
        u.speed().number((last.distance_m - first.distance_m) / (last.time_s - first.time_s)),
    ]
}

/// What is a little below the ground by the elevations that are loaded stands on it.
fn on_ground(clearance_m: f64) -> f64 {
    if (-ON_GROUND_M..0.0).contains(&clearance_m) { 0.0 } else { clearance_m }
}

/// A runway and the elevations under it agree within this, metres.
const ON_GROUND_M: f64 = 1.0;

/// `1400 m AMSL, Fire watch`: what is said, and where.
fn altitude_text(scene: &Scene<'_>, said: &Said, points: &[Point]) -> String {
    let arrival = || {
        let metres = Value::Constant(points.first()?.altitude_amsl_m.round());
        let value = Altitude { metres, reference: AltitudeReference::Amsl };
        Some(Inherited { value, from: "the leg before".into() })
    };
    let altitude = said.altitude.clone().or_else(arrival);
    altitude.map_or_else(
        || "–".into(),
        |altitude| format!("{}, {}", inherited::altitude_text(scene, &altitude.value), altitude.from),
    )
}

/// `2`, or `2 ◀ back` of a leg that is flown from its end to its beginning.
fn pass(passage: &Passage) -> String {
    let number = passage.passes.last().map_or_else(String::new, u64::to_string);
    if passage.reverse { format!("{number} ◀ back") } else { number }
}

fn airspeed_text(scene: &Scene<'_>, said: &Said) -> String {
    said.speed_mps.as_ref().map_or_else(
        || "cruise".into(),
        |speed| format!("{}, {}", inherited::value_text(&speed.value, scene.units().speed()), speed.from),
    )
}

/// Direction from start to end, where that means something.
fn track(first: &Point, last: &Point) -> String {
    let way = first.position.inverse(last.position);
    let straight = way.distance_m > 0.8 * (last.distance_m - first.distance_m);
    if straight && way.distance_m > 1.0 { units::bearing(way.bearing_start_deg) } else { "–".into() }
}
