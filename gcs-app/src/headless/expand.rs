//! `legwork expand`: the waypoints that would be sent.

use super::{Source, check, forecast};
use aircraft::Wind;
use flight_exec::preview::{FlownWaypoint, Scenario};
use flight_exec::{Action, Waypoint};
use std::process::ExitCode;
use std::sync::Arc;

const HEAD: &str =
    "token,leg,latitude_deg,longitude_deg,altitude_amsl_m,airspeed_mps,action,fly_over,steered_to_from_s";

/// Prints the waypoints in the order in which they would be steered to, as CSV or as one JSON document.
/// Intersections take their defaults, variables keep their initial values.
///
/// # Errors
/// A file can't be read.
pub fn run(source: &Source, wind: Wind, json: bool) -> anyhow::Result<ExitCode> {
    let loaded = source.load()?;
    let (program, profile) = match loaded.compile() {
        Ok(compiled) => compiled,
        Err(problems) => {
            problems.iter().for_each(|p| eprintln!("{}:{p}", source.file.display()));
            return Ok(check::status(&problems));
        }
    };
    match forecast::fly(&Arc::new(program), &profile, &loaded.terrain, wind, &Scenario::default()) {
        Ok(preview) if json => say!("{:#}", document(&preview.waypoints)),
        Ok(preview) => say!("{}", csv(&preview.waypoints).trim_end()),
        Err(error) => {
            eprintln!("{}: {error}", source.file.display());
            return Ok(ExitCode::from(1));
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn document(waypoints: &[FlownWaypoint]) -> serde_json::Value {
    serde_json::json!({"waypoints": waypoints})
}

fn csv(waypoints: &[FlownWaypoint]) -> String {
    let mut text = format!("{HEAD}\n");
    for flown in waypoints {
        let w = &flown.waypoint;
        text += &format!(
            "{},{},{:.7},{:.7},{:.1},{:.1},{},{},{:.1}\n",
            w.token.0,
            w.leg,
            w.position.lat_deg,
            w.position.lon_deg,
            w.altitude_amsl_m,
            w.airspeed_mps,
            action(w),
            w.fly_over,
            flown.from_s
        );
    }
    text
}

fn action(waypoint: &Waypoint) -> &'static str {
    match waypoint.action {
        Action::TakeOff { .. } => "take-off",
        Action::Fly => "fly",
        Action::Loiter { .. } => "loiter",
        Action::Land { .. } => "land",
    }
}
