//! From what the executor reported (in flight or in the preview) to the pieces of a record.

use super::record::{Area, Happening, PassageKey, Place, PlaceKind, Track, TrackPoint};
use flight_exec::{Event, IterationPlace, Phase, PlacePointer};
use flight_plan::{
    Altitude, AltitudeReference, Env, FlightPlan, FlightState, Id, Leg, LegKind, Pattern, Program, Spacing,
    StageKind, Value, VariableValue, Variables,
};
use geometry::LatLon;
use geometry::scan::camera_spacing_m;
use std::collections::HashSet;

/// Corners of the polygon that stands for a circle.
const CIRCLE_CORNERS: u32 = 120;

/// Which passage a place belongs to (its `occurrence` is counted by [`Track::begin`]).
pub fn key(place: &PlacePointer) -> PassageKey {
    let pass = |i: &IterationPlace| format!("{} {}", i.leg, i.iteration);
    let loops = place.iterations.iter().filter(|i| !is_call(i, &place.leg));
    PassageKey {
        leg: place.leg.to_string(),
        iterations: loops.map(pass).collect::<Vec<_>>().join(", "),
        reverse: place.reverse,
        occurrence: 0,
    }
}

/// One pass that bears the name of the call whose leg this is: it says nothing that the leg's own name does not.
fn is_call(place: &IterationPlace, leg: &Id) -> bool {
    place.of == Some(1)
        && leg.as_str().strip_prefix(place.leg.as_str()).is_some_and(|rest| rest.starts_with('.'))
}

/// Cuts points, in order of time, into passages where events say that a leg was entered. `plans` are the plan and
/// its updates, as they are flown (with the legs of calls): the newest that knows a leg says what it is.
pub fn track(points: &[TrackPoint], events: &[(f64, Event)], plans: &[&FlightPlan]) -> Track {
    let mut track = Track::default();
    let mut entries = events
        .iter()
        .filter_map(|(time_s, event)| match event {
            Event::LegEntered { place } => Some((*time_s, place)),
            _ => None,
        })
        .peekable();
    for point in points {
        while let Some((_, place)) = entries.next_if(|(time_s, _)| *time_s <= point.time_s) {
            let (kind, stage) = nature(place, plans);
            track.begin(key(place), kind, stage);
        }
        track.push(*point);
    }
    track
}

/// Type of a leg and name of its stage. Take-off and landing have no leg: the stage stands for it.
fn nature(place: &PlacePointer, plans: &[&FlightPlan]) -> (&'static str, String) {
    let find = |plan: &&FlightPlan| {
        let stage = plan.stage(&place.stage)?;
        let leg = plan.leg(&place.leg).map(|c| match &c.leg.kind {
            // the loop itself is flown only where it turns round
            LegKind::Iterative { .. } => "turn-round",
            _ => c.leg.kind_name(),
        });
        let name = if stage.name.is_empty() { stage.id.to_string() } else { stage.name.clone() };
        Some((leg.unwrap_or_else(|| stage_kind(stage.kind)), name))
    };
    plans.iter().rev().find_map(find).unwrap_or(("leg", place.stage.to_string()))
}

fn stage_kind(kind: StageKind) -> &'static str {
    match kind {
        StageKind::TakeOff => "take-off",
        StageKind::Land => "land",
        StageKind::Departure
        | StageKind::EnRoute
        | StageKind::Mission
        | StageKind::Arrival
        | StageKind::Approach => "stage",
    }
}

/// Fixes and runways of a plan.
pub fn places(plan: &FlightPlan) -> Vec<Place> {
    let fixes = plan.fixes.iter().map(|f| Place {
        label: f.id.to_string(),
        position: f.position,
        kind: PlaceKind::Fix,
    });
    let runways = plan.runways.iter().map(|r| Place {
        label: r.id.to_string(),
        position: r.threshold,
        kind: PlaceKind::Runway { heading_deg: r.heading_deg, length_m: r.length_m },
    });
    fixes.chain(runways).collect()
}

/// The areas that the scans and contours of a track had to cover: each with the variables' values at the end of its passage.
pub fn areas(program: &Program, track: &Track, events: &[(f64, Event)]) -> Vec<Area> {
    let covering = track.passages().iter().enumerate().filter(|(_, p)| p.covers_an_area());
    covering
        .filter_map(|(i, passage)| {
            let range = track.range(i);
            let end_s = track.points().get(range.end).map_or(f64::INFINITY, |p| p.time_s);
            let leg = Id::new(&passage.key.leg);
            let (outline, spacing_m) = outline(program, &leg, &variables_at(program, events, end_s))?;
            let holes = holes(program, &leg);
            let label = match passage.key.iterations.is_empty() {
                true => passage.key.leg.clone(),
                false => format!("{}, {}", passage.key.leg, passage.key.iterations),
            };
            Some(Area { label, outline, holes, spacing_m, passage: passage.key.clone() })
        })
        .collect()
}

/// The lines that the legs of a track fly along (each once), and the outlines that they fly around, at the variables' initial values.
pub fn routes(program: &Program, track: &Track) -> Vec<Vec<LatLon>> {
    let variables = Variables::initial(&program.plan);
    let env = Env { variables: &variables, flight: FlightState::at_start(program.plan.home()) };
    let mut seen: HashSet<&str> = HashSet::new();
    let flown = track.passages().iter().map(|passage| passage.key.leg.as_str());
    let legs = flown.filter(|leg| seen.insert(leg)).filter_map(|leg| program.leg(&Id::new(leg)));
    legs.filter_map(|leg| match &leg.kind {
        LegKind::Pattern(Pattern::Contour { area, inward: false, .. }) => {
            let mut ring = corners(program, area, &env)?;
            ring.extend(ring.first().copied());
            Some(ring)
        }
        _ => route(program, leg, &env),
    })
    .collect()
}

/// The line that a leg flies along; `None`: it has none, or its values can't be computed.
pub(super) fn route(program: &Program, leg: &Leg, env: &Env) -> Option<Vec<LatLon>> {
    match &leg.kind {
        LegKind::Pattern(Pattern::TrackLine { route, .. } | Pattern::Corridor { route, .. }) => {
            route.iter().map(|place| program.eval_place(place, env).ok()).collect()
        }
        _ => None,
    }
}

/// The variables' values just before a time, seconds.
pub fn variables_at(program: &Program, events: &[(f64, Event)], time_s: f64) -> Variables {
    let mut variables = Variables::initial(&program.plan);
    for (_, event) in events.iter().filter(|(t, _)| *t < time_s) {
        if let Event::VariableChanged { name, value, .. } = event {
            // the executor had accepted it, for this plan or the one before the update
            let _ = variables.set(&program.plan, name, value.clone());
        }
    }
    variables
}

fn outline(program: &Program, leg: &Id, variables: &Variables) -> Option<(Vec<LatLon>, f64)> {
    let (area, spacing) = covered(program, leg)?;
    let env = Env { variables, flight: FlightState::at_start(program.plan.home()) };
    Some((corners(program, area, &env)?, spacing_m(program, leg, spacing, &env)?))
}

/// What a leg is to cover, and how far apart its tracks are.
fn covered<'p>(program: &'p Program, leg: &Id) -> Option<(&'p flight_plan::Area, &'p Spacing)> {
    match &program.leg(leg)?.kind {
        LegKind::Scan(scan) => Some((&scan.area, &scan.spacing)),
        LegKind::Pattern(Pattern::Contour { area, spacing, inward: true, .. }) => Some((area, spacing)),
        _ => None,
    }
}

/// Metres between the tracks of a leg, as given or as its camera needs them; `None`: a value of it can't be computed.
fn spacing_m(program: &Program, leg: &Id, spacing: &Spacing, env: &Env) -> Option<f64> {
    let number = |value: &Value<f64>| program.eval_number(value, env).ok();
    match spacing {
        Spacing::Metres(metres) => number(metres),
        Spacing::Camera { field_of_view_deg, overlap, height_m } => {
            let height = match height_m {
                Some(height) => height,
                None => &altitude(program, leg).filter(|a| a.reference == AltitudeReference::Agl)?.metres,
            };
            let height_m = number(height)?;
            camera_spacing_m(height_m, number(field_of_view_deg)?, number(overlap)?).ok()
        }
    }
}

/// The altitude of a leg: its own, that of a loop around it, or its stage's.
fn altitude<'p>(program: &'p Program, leg: &Id) -> Option<&'p Altitude> {
    let path = program.path(leg)?;
    let own = program.chain(&path).into_iter().rev().find_map(|leg| leg.altitude.as_ref());
    own.or_else(|| program.stage(&path)?.altitude.as_ref())
}

/// The rings that are left out of what a leg is to cover.
fn holes(program: &Program, leg: &Id) -> Vec<Vec<LatLon>> {
    match covered(program, leg) {
        Some((flight_plan::Area::Polygon { holes, .. }, _)) => holes.clone(),
        _ => Vec::new(),
    }
}

/// The outer ring of an area (of a circle: enough of its points); `None` if its values can't be computed.
pub(super) fn corners(program: &Program, area: &flight_plan::Area, env: &Env) -> Option<Vec<LatLon>> {
    Some(match area {
        flight_plan::Area::Polygon { corners, .. } => corners.clone(),
        flight_plan::Area::Expression(source) => program.expression(source).ok()?.polygon(env).ok()?,
        flight_plan::Area::Circle { centre, radius_m } => {
            let centre = program.eval_place(centre, env).ok()?;
            let radius_m = program.eval_number(radius_m, env).ok()?;
            let bearing = |i: u32| f64::from(i) * 360.0 / f64::from(CIRCLE_CORNERS);
            (0..CIRCLE_CORNERS).map(|i| centre.destination(bearing(i), radius_m)).collect()
        }
    })
}

/// An event for people: a sentence, and whether it deserves a number on the map.
pub fn happening(time_s: f64, event: &Event) -> Happening {
    let (text, important) = sentence(event);
    let details = serde_json::to_value(event).unwrap_or_default();
    Happening { time_s, text, important, details }
}

fn sentence(event: &Event) -> (String, bool) {
    match event {
        Event::LegEntered { place } => (format!("leg {}", key(place)), false),
        Event::IterationFinished { leg, finished, of } => {
            let of = of.map_or(String::new(), |n| format!(" of at most {n}"));
            (format!("pass {finished}{of} of {leg} finished"), false)
        }
        Event::DecisionRequested(request) => {
            (format!("decision asked for at {}, {:.0} s ahead", request.leg, request.time_left_s), false)
        }
        Event::DecisionTaken { leg, branch, by } => (format!("decided at {leg}: {branch} (by {by})"), true),
        Event::VariableChanged { name, value, .. } => (format!("{name} = {}", shown(value)), true),
        Event::ActionDone { leg, act, .. } => (format!("{act} at {leg}"), false),
        Event::ActionRefused { leg, reason, .. } => (format!("action of {leg} not done: {reason}"), true),
        Event::ExpressionFailed { leg, reason } => (format!("value of {leg} missing: {reason}"), true),
        Event::PatternRefused { leg, reason } => (format!("pattern of {leg} refused: {reason}"), true),
        Event::PlanActivated { hash, revision } => {
            (format!("plan {} active, revision {revision}", hash.get(..8).unwrap_or(hash)), *revision > 1)
        }
        Event::EmergencyStarted { cause, plan, .. } => {
            (format!("emergency ({cause:?}): flying {plan}"), true)
        }
        Event::EmergencyUnanswered { cause, plan: Some(plan), reason, .. } => {
            (format!("emergency ({cause:?}): {plan} is not flown: {reason}"), true)
        }
        Event::EmergencyUnanswered { cause, plan: None, .. } => {
            (format!("emergency ({cause:?}) without a plan for it"), true)
        }
        Event::PhaseChanged { phase } => (phase_name(*phase).to_owned(), false),
        Event::WaypointsRejected { leg, reason } => {
            let leg = leg.as_ref().map_or(String::new(), |l| format!(" of {l}"));
            (format!("waypoints{leg} refused: {reason}"), true)
        }
        Event::ProblemAhead { leg, reason, .. } => {
            let leg = leg.as_ref().map_or(String::new(), |l| format!(" on {l}"));
            (format!("problem ahead{leg}: {reason}"), true)
        }
        Event::NotGranted { request, reason } => {
            (format!("`{request}` not granted by the gateway: {reason}"), true)
        }
        Event::NotJournalled { reason } => (format!("not recorded: {reason}"), true),
        Event::Journalled => ("recorded again".to_owned(), true),
    }
}

fn phase_name(phase: Phase) -> &'static str {
    match phase {
        Phase::Idle => "idle",
        Phase::Flying => "flying",
        Phase::Holding => "holding",
        Phase::AwaitingDecision => "waiting for a decision",
        Phase::Finished => "plan finished",
        Phase::Grounded => "standing between two flights",
    }
}

fn shown(value: &VariableValue) -> String {
    match value {
        VariableValue::Bool(b) => b.to_string(),
        VariableValue::Number(n) => format!("{n}"),
        VariableValue::Text(t) => format!("{t:?}"),
        VariableValue::Position(p) => format!("{:.4} {:.4}", p.lat_deg, p.lon_deg),
        VariableValue::Polygon(corners) => format!("a polygon of {} corners", corners.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_exec::Branching;

    const HOME: LatLon = LatLon::new(36.3, -84.2);

    fn place(leg: &str, iterations: &[(&str, u64)]) -> PlacePointer {
        let pass = |(around, iteration): &(&str, u64)| IterationPlace {
            leg: Id::new(around),
            iteration: *iteration,
            // a call's only one
            of: Some(if leg.starts_with("c.") { 1 } else { 9 }),
            reverse: false,
        };
        PlacePointer {
            plan: Branching::Main,
            stage: "watch".into(),
            leg: Id::new(leg),
            iterations: iterations.iter().map(pass).collect(),
            reverse: false,
            distance_m: 0.0,
        }
    }

    #[test]
    fn passages_begin_where_legs_are_entered() {
        let points: Vec<TrackPoint> = (0..30)
            .map(|i| TrackPoint { time_s: f64::from(i), position: HOME, altitude_amsl_m: 0.0 })
            .collect();
        let entered =
            |t: f64, leg: &str, passes: &[(&str, u64)]| (t, Event::LegEntered { place: place(leg, passes) });
        let events = [
            entered(0.0, "a", &[]),
            (3.0, Event::PhaseChanged { phase: Phase::Flying }),
            entered(9.5, "b", &[("loop", 1)]),
            entered(20.0, "b", &[("loop", 2)]),
            entered(25.0, "b", &[("loop", 2)]),
        ];
        let track = track(&points, &events, &[]);
        let keys: Vec<String> = track.passages().iter().map(|p| p.key.to_string()).collect();
        assert_eq!(keys, ["a", "b (loop 1)", "b (loop 2)", "b (loop 2) #2"]);
        assert_eq!((0..4).map(|i| track.range(i)).collect::<Vec<_>>(), [0..10, 10..20, 20..25, 25..30]);
    }

    const SCANS: &str = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer">
      <fixes><fix id="A" lat="36.3" lon="-84.2"/></fixes>
      <procedures><procedure id="p"><scan id="in" spacing="200"><area fix="A" radius="600"/></scan></procedure></procedures>
      <mainPlan><stage id="s" type="mission" altitude="150" altitudeReference="agl">
        <creepingLine id="creeping" fieldOfView="90" overlap="0.5" height="200"><area fix="A" radius="500"/></creepingLine>
        <crissCross id="criss" fieldOfView="90" overlap="0"><area fix="A" radius="500"/></crissCross>
        <contour id="rings" spacing="150" turn="left"><area fix="A" radius="500"/></contour>
        <contour id="round" spacing="150" loops="2" direction="outward" turn="left"><area fix="A" radius="500"/></contour>
        <TF id="tf" fix="A"/><call id="c" procedure="p"/>
      </stage></mainPlan></flightPlan>"#;

    /// Of every style, in calls too, with the spacing that their camera gives.
    #[test]
    fn every_scan_has_an_area() {
        let profile = aircraft::Profile::default();
        let program = flight_plan::compile(flight_plan::read(SCANS).plan, &profile, &terrain::Flat(200.0));
        let program = program.unwrap();
        let legs: [(&str, &[(&str, u64)]); 6] = [
            ("creeping", &[]),
            ("criss", &[]),
            ("rings", &[]),
            ("round", &[]),
            ("tf", &[]),
            ("c.in", &[("c", 1)]),
        ];
        let places =
            legs.iter().map(|(leg, passes)| PlacePointer { stage: "s".into(), ..place(leg, passes) });
        let events: Vec<(f64, Event)> =
            (0..6).zip(places).map(|(i, place)| (f64::from(i), Event::LegEntered { place })).collect();
        let point = |i| TrackPoint { time_s: f64::from(i), position: HOME, altitude_amsl_m: 350.0 };
        let track = track(&(0..6).map(point).collect::<Vec<_>>(), &events, &[program.flown()]);
        let kinds: Vec<&str> = track.passages().iter().map(|p| p.kind).collect();
        assert_eq!(kinds, ["creepingLine", "crissCross", "contour", "contour", "TF", "scan"]);
        let areas = areas(&program, &track, &events);
        let found: Vec<(&str, f64)> = areas.iter().map(|a| (a.label.as_str(), a.spacing_m.round())).collect();
        assert_eq!(found, [("creeping", 200.0), ("criss", 300.0), ("rings", 150.0), ("c.in", 200.0)]);
    }

    #[test]
    fn values_are_told_as_people_write_them() {
        let by: std::sync::Arc<str> = "operator".into();
        let changed = |value| sentence(&Event::VariableChanged { name: "v".into(), value, by: by.clone() }).0;
        assert_eq!(changed(VariableValue::Number(800.0)), "v = 800");
        assert_eq!(changed(VariableValue::Position(HOME)), "v = 36.3000 -84.2000");
    }
}
