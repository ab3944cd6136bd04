//! A trace for people: short enough to be read, without the lines of its documents that begin with a bar.

use crate::trace::{Moment, Stimulus};
use flight_exec::{Action, Command, Event, Input, Output, PlacePointer, Waypoint};
use flight_plan::{Leg, LegKind, Program};
use std::sync::Arc;

/// Time, what was done, what came of it, and where that led; nothing of a moment that led to nothing.
pub fn moment(moment: &Moment) -> String {
    let quiet = matches!(moment.stimulus, Stimulus::Input(Input::Tick | Input::Aircraft(_)));
    if quiet && moment.outputs.is_empty() {
        return String::new();
    }
    let mut text = format!("    {:.1} {}\n", moment.now.as_secs_f64(), stimulus(&moment.stimulus));
    for output in &moment.outputs {
        text += &format!("        {}\n", told(output));
    }
    if !moment.outputs.is_empty() {
        text +=
            &format!("        = {:?}, ahead {}\n", moment.after.status.phase, waypoints(&moment.after.ahead));
    }
    text
}

fn stimulus(stimulus: &Stimulus) -> String {
    match stimulus {
        Stimulus::Input(Input::Propose { program, .. }) => format!("propose {}", outline(program)),
        Stimulus::Input(Input::Command { command: Command::Commit { hash, entry }, .. }) => {
            format!("commit {} entering {entry:?}", short(hash))
        }
        Stimulus::Input(Input::Command { command, .. }) => format!("{command:?}"),
        Stimulus::Input(Input::Aircraft(a)) => {
            format!("at {:.4} {:.4}", a.position.lat_deg, a.position.lon_deg)
        }
        other => format!("{other:?}"),
    }
}

fn short(hash: &str) -> &str {
    hash.get(..6).unwrap_or(hash)
}

/// A plan's hash and the legs of its main plan, bodies in brackets; then its document.
fn outline(program: &Program) -> String {
    let legs: Vec<_> = program.flown().stages.iter().map(|s| list(&s.legs)).collect();
    let document: String =
        flight_plan::write(&program.plan).lines().map(|l| format!("\n    | {l}")).collect();
    format!("{}: {}{document}", short(program.hash()), legs.concat())
}

fn list(legs: &[Arc<Leg>]) -> String {
    let one = |leg: &Arc<Leg>| match &leg.kind {
        LegKind::Iterative { form, count, until, .. } => {
            format!("{}:{form:?} {count:?} {until:?}[{}] ", leg.id, list(leg.body()))
        }
        _ => format!("{}:{} ", leg.id, leg.kind_name()),
    };
    legs.iter().map(one).collect()
}

fn told(output: &Output) -> String {
    match output {
        Output::Feed { cancel_after, waypoints } => {
            format!("feed, cancelling after {:?}: {}", cancel_after.map(|t| t.0), self::waypoints(waypoints))
        }
        Output::Answer { result: Ok(_), .. } => "done".into(),
        Output::Event(Event::LegEntered { place: at }) => format!("entered {}", place(at)),
        Output::Event(Event::DecisionRequested(request)) => format!("asked at {}", request.leg),
        other => format!("{other:?}"),
    }
}

/// `k1-s <2/3`: a leg, backwards in the second of three passes.
pub fn place(place: &PlacePointer) -> String {
    let passes = place.iterations.iter().map(|i| {
        let of = i.of.map_or("?".into(), |n| n.to_string());
        format!(" {}{}:{}/{of}", if i.reverse { "<" } else { ">" }, i.leg, i.iteration)
    });
    format!("{}{}", place.leg, passes.collect::<String>())
}

/// `7-9:k1 10:k2.`: numbers and legs, those of one leg in one; a dot for the end of the plan.
fn waypoints(waypoints: &[Waypoint]) -> String {
    let alike = |a: &Waypoint, b: &Waypoint| a.leg == b.leg && a.action == b.action && !a.end_of_plan;
    let runs = waypoints.chunk_by(alike).filter_map(|run| Some((run.first()?, run.last()?)));
    let one = |(first, last): (&Waypoint, &Waypoint)| {
        let numbers = if first.token == last.token { String::new() } else { format!("-{}", last.token.0) };
        let action = match last.action {
            Action::Fly => "",
            Action::Loiter { .. } => "(loiter)",
            Action::TakeOff { .. } => "(take-off)",
            Action::Land { .. } => "(land)",
        };
        format!("{}{numbers}:{}{action}{}", first.token.0, last.leg, if last.end_of_plan { "." } else { "" })
    };
    Vec::from_iter(runs.map(one)).join(" ")
}
