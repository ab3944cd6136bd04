//! What is otherwise, and what would happen, in words.

use super::autopilot;
use super::here::{cause_name, reach_name};
use crate::forecast::Alarm;
use crate::units::{self, Units};
use aircraft::Wind;
use flight_exec::rehearse::{Diversion, Glide, Glided, Powered, Reach, WhatIf};
use flight_exec::review::Margins;
use flight_plan::{Cause, FlightPlan, Id, VariableValue};

/// A wind: `8.0 m/s from 240°`, or `calm`.
fn wind(wind: Wind, units: Units) -> String {
    if wind.speed_mps() < 0.05 {
        return "calm".into();
    }
    format!("{} from {}", units.speed().show(wind.speed_mps()), units::bearing(wind.direction_from_deg()))
}

/// The winds by height.
pub fn winds(what_if: &WhatIf, units: Units) -> String {
    let low = wind(what_if.wind, units);
    if what_if.aloft.is_empty() {
        return low;
    }
    let mut aloft = what_if.aloft.clone();
    aloft.sort_by(|a, b| a.0.total_cmp(&b.0));
    let said = |(amsl_m, aloft): (f64, Wind)| {
        format!(", {} at {} AMSL", wind(aloft, units), units.altitude().show(amsl_m))
    };
    std::iter::once(format!("{low} at the runway")).chain(aloft.into_iter().map(said)).collect()
}

/// Everything that is otherwise than the plan says, in one line; empty: nothing is.
pub fn world(what_if: &WhatIf, plan: &FlightPlan, units: Units) -> String {
    let standard = WhatIf::default();
    let mut parts = Vec::new();
    if what_if.wind != standard.wind || what_if.aloft != standard.aloft {
        parts.push(format!("wind {}", winds(what_if, units)));
    }
    if let Some(start) = what_if.start_unix_s.and_then(|s| jiff::Timestamp::from_second(s).ok()) {
        parts.push(format!("start {}", start.strftime("%H:%M UTC")));
    }
    if what_if.energy_share < 1.0 {
        parts.push(format!("{:.0} % energy at the start", what_if.energy_share * 100.0));
    }
    if let Some(autopilot) = what_if.autopilot {
        parts.push(format!("flown by {}", autopilot::name(autopilot)));
    }
    for (name, value) in &what_if.variables {
        let unit = plan.variable(name).map_or("", |variable| variable.unit.as_str());
        parts.push(format!("{name} {}", value_in_words(value, unit)));
    }
    let branches = what_if.decisions.iter();
    parts.extend(
        branches.map(|(leg, branch)| format!("{}: {}", plan.label(leg), plan.branch_label(leg, branch))),
    );
    parts.join(" · ")
}

/// `Engine failure at 3:20`.
pub fn alarm(alarm: Alarm) -> String {
    format!("{} at {}", cause_name(alarm.cause), units::duration(alarm.time_s))
}

fn value_in_words(value: &VariableValue, unit: &str) -> String {
    match value {
        VariableValue::Number(n) => format!("{n:.1} {unit}").trim_end().to_owned(),
        VariableValue::Bool(yes) => yes.to_string(),
        VariableValue::Text(text) => text.clone(),
        VariableValue::Position(at) => units::position(*at),
        VariableValue::Polygon(corners) => format!("{} corners", corners.len()),
    }
}

/// What would happen after an alarm: what counts first, then the rest.
pub fn diversion(diversion: &Diversion, flown: &FlightPlan, units: Units) -> Vec<String> {
    let margins = Margins::default();
    let verdict = reach_name(diversion.reach(margins.glide_m, margins.energy_share));
    let alarm = cause_name(diversion.cause);
    let Some((plan, runway)) = &diversion.plan else {
        return vec![format!("{alarm}: no emergency plan answers here. The gateway's Safe mode decides.")];
    };
    let mut lines = vec![format!("{alarm}: {}, runway {runway}: {verdict}", flown.label(plan))];
    let glided = diversion.glided.as_ref().map(|flown| glided(flown, runway, units));
    let glide = diversion.glide.as_ref().map(|g| glide(g, margins.glide_m, units));
    let powered = match &diversion.powered {
        Ok(flown) => powered(flown),
        Err(why) => format!("Not flown: {why}."),
    };
    match diversion.cause {
        Cause::Engine => lines.extend(glided.into_iter().chain(glide).chain([powered])),
        _ => lines.extend([powered].into_iter().chain(glide)),
    }
    lines
}

fn powered(flown: &Powered) -> String {
    let end = format!("{}, {:.0} % energy left", units::duration(flown.time_s), flown.battery_left * 100.0);
    match &flown.cut_short {
        _ if flown.landed => format!("With the engine: on the runway after {end}."),
        Some(why) => format!("With the engine: {why}."),
        None => format!("With the engine: it ends in the air after {end}."),
    }
}

fn glided(flown: &Glided, runway: &Id, units: Units) -> String {
    let time = units::duration(flown.time_s);
    if flown.missed_m <= 0.0 {
        return format!("Flown without the engine: on runway {runway} after {time}.");
    }
    let missed = units.distance().show(flown.missed_m);
    format!("Flown without the engine: it comes down {missed} beside runway {runway} after {time}.")
}

fn glide(glide: &Glide, reserve_m: f64, units: Units) -> String {
    let way = if glide.along_plan { "Glide along the plan" } else { "Glide straight to the runway" };
    let height = units.altitude();
    if glide.hill.is_some() {
        return format!("{way}: it runs into a hill.");
    }
    match glide.reach(reserve_m) {
        _ if !glide.time_s.is_finite() => format!("{way}: it does not get there against the wind."),
        Reach::Out => format!("{way}: ends before it, {} too low.", height.show(-glide.margin_m)),
        _ => format!(
            "{way}: there after {}, {} above the threshold.",
            units::duration(glide.time_s),
            height.show(glide.margin_m)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_exec::rehearse::GlidePoint;

    #[test]
    fn what_is_otherwise_is_said_and_nothing_else() {
        let plan = FlightPlan::default();
        let words = |what_if: &WhatIf| world(what_if, &plan, Units::Si);
        assert_eq!(words(&WhatIf::default()), "");
        let what_if = WhatIf {
            wind: Wind::from_direction(240.0, 8.0),
            energy_share: 0.8,
            start_unix_s: Some(6 * 3600),
            variables: [("size".into(), VariableValue::Number(700.0))].into(),
            decisions: [("ask".into(), "close".into())].into(),
            ..WhatIf::default()
        };
        let expected =
            "wind 8.0 m/s from 240° · start 06:00 UTC · 80 % energy at the start · size 700.0 · ask: close";
        assert_eq!(words(&what_if), expected);
        let aloft = WhatIf { aloft: vec![(900.0, what_if.wind), (600.0, Wind::CALM)], ..WhatIf::default() };
        let expected = "wind calm at the runway, calm at 600 m AMSL, 8.0 m/s from 240° at 900 m AMSL";
        assert_eq!(words(&aloft), expected, "from below");
    }

    #[test]
    fn a_way_out_says_what_counts_first() {
        let start =
            GlidePoint { time_s: 0.0, position: geometry::LatLon::new(0.0, 0.0), altitude_amsl_m: 500.0 };
        let glide = Glide { along_plan: false, path: vec![start], time_s: 95.0, margin_m: -40.0, hill: None };
        let mut found = Diversion {
            time_s: 10.0,
            cause: Cause::Engine,
            leg: "a".into(),
            plan: Some(("return".into(), "R05".into())),
            powered: Err("the aircraft has not taken off".into()),
            glide: Some(glide),
            glided: Some(Glided { track: Vec::new(), time_s: 90.0, missed_m: 480.0 }),
        };
        let words = |found: &Diversion| diversion(found, &FlightPlan::default(), Units::Si);
        assert_eq!(
            words(&found),
            [
                "Engine failure: return, runway R05: not reached",
                "Flown without the engine: it comes down 0.5 km beside runway R05 after 1:30.",
                "Glide straight to the runway: ends before it, 40 m too low.",
                "Not flown: the aircraft has not taken off."
            ]
        );
        found.cause = Cause::Link;
        assert!(words(&found)[1].starts_with("Not flown"), "an engine that runs is used");
        let flown =
            Powered { track: Vec::new(), time_s: 200.0, battery_left: 0.62, landed: true, cut_short: None };
        found.powered = Ok(flown.clone());
        assert_eq!(
            words(&found)[..2],
            [
                "Link lost: return, runway R05: reached",
                "With the engine: on the runway after 3:20, 62 % energy left."
            ]
        );
        found.powered = Ok(Powered { landed: false, ..flown });
        assert_eq!(words(&found)[1], "With the engine: it ends in the air after 3:20, 62 % energy left.");
        found.plan = None;
        assert!(words(&found)[0].contains("Safe mode"));
    }
}
