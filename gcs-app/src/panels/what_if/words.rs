//! What is otherwise, and what would happen, in words.

use super::autopilot;
use super::here::reach_name;
use super::start;
use crate::forecast::Alarm;
use crate::panels::{ended, other_end};
use crate::units::{self, Units};
use aircraft::Wind;
use flight_exec::rehearse::{Diversion, Glide, Glided, Powered, Reach, TrackPoint, WhatIf};
use flight_exec::review::Margins;
use flight_plan::words::yes_or_no;
use flight_plan::{Cause, FlightPlan, Runway, VariableValue};
use geometry::Vec2;

/// A wind: `8.0 m/s from 240°`, or `calm`.
fn wind(wind: Wind, units: Units) -> String {
    if wind.speed_mps() < 0.05 {
        return "calm".into();
    }
    format!("{} from {}", units.speed().show(wind.speed_mps()), units::bearing(wind.direction_from_deg()))
}

/// Wind from behind that is worth a word before a take-off or landing, m/s: ten knots, the most that many aircraft may have.
const MUCH_FROM_BEHIND_MPS: f64 = 5.0;

/// `10.0 m/s from behind for take-off and landing on R05`; `None`: there is not much.
pub fn from_behind(what_if: &WhatIf, plan: &FlightPlan, units: Units) -> Option<String> {
    let behind_mps = |runway: &Runway| {
        let way = Vec2::from_bearing_rad(runway.heading_deg.to_radians());
        what_if.wind.vector().dot(way)
    };
    let of = |what: &str, runway: Option<&Runway>| {
        let runway = runway.filter(|runway| behind_mps(runway) >= MUCH_FROM_BEHIND_MPS)?;
        Some(format!("{} from behind for the {what} {}", units.speed().show(behind_mps(runway)), runway.id))
    };
    let both = [of("take-off from", plan.home()), of("landing on", ended::destination(plan))];
    let said: Vec<String> = both.into_iter().flatten().collect();
    (!said.is_empty()).then(|| format!("⚠ {}", said.join(", ")))
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
pub fn world(what_if: &WhatIf, plan: &FlightPlan, units: Units, now: jiff::Timestamp) -> String {
    let standard = WhatIf::default();
    let mut parts = Vec::new();
    if what_if.wind != standard.wind || what_if.aloft != standard.aloft {
        parts.push(format!("wind {}", winds(what_if, units)));
    }
    if let Some(start_unix_s) = what_if.start_unix_s {
        parts.push(format!("start {} UTC", start::written(start_unix_s, now)));
    }
    if what_if.energy_share < 1.0 {
        parts.push(format!("{:.0} % energy at the start", what_if.energy_share * 100.0));
    }
    if let Some(autopilot) = what_if.autopilot {
        parts.push(format!("flown by {}", autopilot::name(autopilot)));
    }
    if let Some(warmth) = warmth(what_if.isa_deviation_c) {
        parts.push(warmth);
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

/// `air 20 °C warmer than standard`; `None`: it is as the standard's.
fn warmth(isa_deviation_c: f64) -> Option<String> {
    let compared = match isa_deviation_c.round() {
        0.0 => return None,
        colder if colder < 0.0 => "colder",
        _ => "warmer",
    };
    Some(format!("air {:.0} °C {compared} than standard", isa_deviation_c.abs()))
}

/// `Engine failure at 3:20`.
pub fn alarm(alarm: Alarm) -> String {
    format!("{} at {}", alarm.cause.name(), units::duration(alarm.time_s))
}

fn value_in_words(value: &VariableValue, unit: &str) -> String {
    match value {
        VariableValue::Number(n) => format!("{n:.1} {unit}").trim_end().to_owned(),
        VariableValue::Bool(yes) => yes_or_no(*yes).to_owned(),
        VariableValue::Text(text) => text.clone(),
        VariableValue::Position(at) => units::position(*at),
        VariableValue::Polygon(corners) => format!("{} corners", corners.len()),
    }
}

/// What would happen after an alarm: first, in one sentence, whether the runway is reached; then what else there is to know.
pub fn diversion(diversion: &Diversion, flown: &FlightPlan, units: Units) -> Vec<String> {
    let alarm = diversion.cause.name();
    let Some((plan, runway)) = &diversion.plan else {
        return vec![format!("{alarm}: no emergency plan answers here. The gateway's Safe mode decides.")];
    };
    let margins = Margins::default();
    let reach = diversion.reach(margins.glide_m, margins.energy_share);
    let (plan, is_reached) = (flown.label(plan), format!("{runway} is {}", reach_name(reach)));
    let glide = diversion.glide.as_ref();
    let counts = match (&diversion.powered, &diversion.glided) {
        (Err(why), _) => format!("{plan} is not flown: {why}."),
        (Ok(_), Some(glided)) => {
            let how = without_engine(glided, glide, (plan, flown.runway(runway)), units);
            format!("{is_reached} without the engine{how}.")
        }
        (Ok(powered), None) => format!("{is_reached} on {plan}{}.", with_engine(powered)),
    };
    let spare = spare(diversion, reach, &margins, units);
    let ran = diversion.powered.as_ref().ok().filter(|_| diversion.glided.is_some());
    let ran = ran.map(|powered| format!("With an engine that runs: {plan}{}.", with_engine(powered)));
    // two ways without the engine: it matters which of them comes true
    let begin = if diversion.glided.is_some() { "Not flown, for comparison: a" } else { "A" };
    let glide = glide.map(|glide| format!("{begin} {}", calculated(glide, margins.glide_m, units)));
    [format!("{alarm}: {counts}")].into_iter().chain(spare).chain(glide).chain(ran).collect()
}

/// What decides between reached and just reached: that is not the height over the threshold as flown, where a glide comes low on purpose.
fn spare(diversion: &Diversion, reach: Reach, margins: &Margins, units: Units) -> Option<String> {
    let is_tight = reach == Reach::Tight;
    if diversion.cause != Cause::Engine {
        let percent = margins.energy_share * 100.0;
        return is_tight.then(|| format!("Just: less than {percent:.0} % energy is to spare."));
    }
    if reach == Reach::Out || diversion.glided.is_none() {
        return None;
    }
    let height = |metres| units.altitude().show(metres);
    let least = height(margins.glide_m);
    let (word, less) =
        if is_tight { ("Just", format!(", less than {least},")) } else { ("To spare", String::new()) };
    Some(match best_glide(diversion) {
        Some((way, spare_m)) => {
            let spare = if is_tight { format!("{} to spare", height(spare_m)) } else { height(spare_m) };
            format!(
                "{word}: {spare}{less} at the threshold in a glide {way}. As flown, that height is lost before."
            )
        }
        None => format!(
            "Just: at best a glide, along the plan or straight, is at the threshold less than {least} high."
        ),
    })
}

/// The glide with the most height at the threshold, metres, if one comes there.
fn best_glide(diversion: &Diversion) -> Option<(&'static str, f64)> {
    let along = diversion.glide.as_ref().filter(|glide| glide.hill.is_none());
    let along = along
        .map(|glide| (if glide.along_plan { "along all of the plan" } else { STRAIGHT }, glide.margin_m));
    let straight = diversion.straight_m.map(|metres| (STRAIGHT, metres));
    let there = along.into_iter().chain(straight).filter(|(_, metres)| metres.is_finite() && *metres >= 0.0);
    there.max_by(|a, b| a.1.total_cmp(&b.1))
}

const STRAIGHT: &str = "straight to the runway";

/// Behind the word whether the runway is reached: how the plan ends that is flown with an engine.
fn with_engine(flown: &Powered) -> String {
    let end =
        format!("after {}, {:.0} % energy left", units::duration(flown.time_s), flown.battery_left * 100.0);
    match &flown.cut_short {
        _ if flown.landed => format!(", {end}"),
        Some(why) => format!(": {why}"),
        None => format!(": it ends in the air {end}"),
    }
}

/// The same of a plan that is flown without the engine.
fn without_engine(
    flown: &Glided,
    glide: Option<&Glide>,
    (plan, runway): (&str, Option<&Runway>),
    units: Units,
) -> String {
    let time = units::duration(flown.time_s);
    if flown.missed_m > 0.0 {
        let unit = if flown.missed_m < 1000.0 { units.length() } else { units.distance() };
        let missed = unit.show(flown.missed_m);
        return format!(": as it is flown, on {plan}, it comes down {missed} from the runway after {time}");
    }
    let part = match glide.filter(|glide| glide.along_plan).map(|glide| glide.reach(0.0)) {
        Some(Reach::Out) => "on a part of",
        Some(_) => "along",
        None => "on",
    };
    let track = flown.track.iter().map(|at| at.position);
    let other = runway.filter(|runway| other_end::is_come_to(track, runway)).map(Runway::from_other_end);
    let height = other.as_ref().or(runway).and_then(|runway| height_at_threshold_m(flown, runway));
    let from = if other.is_some() { ", landing from its other end" } else { "" };
    let down = match height {
        Some(..TOUCHING_M) => format!("{from}, touching down at the threshold"),
        Some(height_m) => {
            let height = units.altitude().show(height_m);
            format!(", over the threshold {height} high{from}, down")
        }
        None => format!("{from}, down"),
    };
    format!(" {part} {plan}{down} after {time}")
}

/// So near to the threshold it is passed, metres.
const AT_THRESHOLD_M: f64 = 100.0;

/// What is lower over the threshold is said to touch down there, metres.
const TOUCHING_M: f64 = 1.0;

/// How high the threshold is passed; `None`: it is not.
fn height_at_threshold_m(flown: &Glided, runway: &Runway) -> Option<f64> {
    let away_m = |at: &TrackPoint| at.position.distance_m(runway.threshold);
    let nearest = flown.track.iter().min_by(|a, b| away_m(a).total_cmp(&away_m(b)))?;
    let height_m = nearest.altitude_amsl_m - runway.elevation_amsl_m;
    (away_m(nearest) < AT_THRESHOLD_M).then_some(height_m.max(0.0))
}

/// What a glide comes to that is worked out beside the flight.
fn calculated(glide: &Glide, reserve_m: f64, units: Units) -> String {
    let way = if glide.along_plan { "glide along all of the plan" } else { "glide straight to the runway" };
    let height = units.altitude();
    if glide.hill.is_some() {
        return format!("{way}: it runs into a hill.");
    }
    match glide.reach(reserve_m) {
        _ if !glide.time_s.is_finite() => format!("{way}: it does not get there against the wind."),
        Reach::Out => {
            format!("{way}: at the threshold it would be {} too low.", height.show(-glide.margin_m))
        }
        _ => format!(
            "{way}: at the threshold {} high, after {}.",
            height.show(glide.margin_m),
            units::duration(glide.time_s)
        ),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_exec::rehearse::GlidePoint;
    use geometry::LatLon;

    #[test]
    fn what_is_otherwise_is_said_and_nothing_else() {
        let plan = FlightPlan::default();
        let words = |what_if: &WhatIf| world(what_if, &plan, Units::Si, jiff::Timestamp::UNIX_EPOCH);
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

    /// The plan of the alarm, with its runway.
    fn plan() -> FlightPlan {
        let text = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer">
            <runways><runway id="R05" lat="46" lon="9" elevation="300" heading="50" length="400"/></runways>
            <mainPlan/><emergencyPlans><emergencyPlan id="return" name="Return home" runway="R05"/></emergencyPlans>
            </flightPlan>"#;
        flight_plan::read(text.as_bytes()).plan
    }

    fn point(lon: f64, altitude_amsl_m: f64) -> TrackPoint {
        TrackPoint {
            time_s: 0.0,
            position: LatLon::new(46.0, lon),
            altitude_amsl_m,
            airspeed_mps: 16.0,
            passage: None,
            iteration: 0,
        }
    }

    fn words(found: &Diversion) -> Vec<String> {
        diversion(found, &plan(), Units::Si)
    }

    /// The engine fails 500 m up: it is down on the runway after 1:30, over whose threshold it comes 12 m high.
    fn engine_fails() -> Diversion {
        let start = GlidePoint { time_s: 0.0, position: LatLon::new(46.0, 8.9), altitude_amsl_m: 500.0 };
        let glide = Glide { along_plan: true, path: vec![start], time_s: 95.0, margin_m: 40.0, hill: None };
        let track = vec![point(8.99, 380.0), point(9.0001, 312.0), point(9.002, 300.0)];
        Diversion {
            time_s: 10.0,
            cause: Cause::Engine,
            leg: "a".into(),
            plan: Some(("return".into(), "R05".into())),
            powered: Ok(Powered {
                track: Vec::new(),
                time_s: 200.0,
                battery_left: 0.62,
                landed: true,
                cut_short: None,
            }),
            glide: Some(glide),
            glided: Some(Glided { track, time_s: 90.0, missed_m: 0.0 }),
            straight_m: None,
        }
    }

    /// Which of three answers counts was not to be seen.
    #[test]
    fn an_engine_failure_says_first_whether_the_runway_is_reached_how_high_and_when() {
        let mut found = engine_fails();
        assert_eq!(
            words(&found),
            [
                "Engine failure: R05 is reached without the engine along Return home, over the threshold 12 m high, down after 1:30.",
                "To spare: 40 m at the threshold in a glide along all of the plan. As flown, that height is lost before.",
                "Not flown, for comparison: a glide along all of the plan: at the threshold 40 m high, after 1:35.",
                "With an engine that runs: Return home, after 3:20, 62 % energy left.",
            ]
        );
        if let Some(glide) = &mut found.glide {
            glide.margin_m = -480.0;
        }
        assert_eq!(
            words(&found)[..3],
            [
                "Engine failure: R05 is just reached without the engine on a part of Return home, over the threshold 12 m high, \
                 down after 1:30.",
                "Just: at best a glide, along the plan or straight, is at the threshold less than 15 m high.",
                "Not flown, for comparison: a glide along all of the plan: at the threshold it would be 480 m too low.",
            ]
        );
        let straight = words(&Diversion { straight_m: Some(61.0), ..found.clone() });
        assert!(straight[0].starts_with("Engine failure: R05 is reached without the engine on a part of"));
        assert_eq!(
            straight[1],
            "To spare: 61 m at the threshold in a glide straight to the runway. As flown, that height is lost before."
        );
        let tight = words(&Diversion { straight_m: Some(7.0), ..found.clone() });
        assert_eq!(
            tight[1],
            "Just: 7 m to spare, less than 15 m, at the threshold in a glide straight to the runway. As flown, that height is lost before."
        );
        if let Some(glided) = &mut found.glided {
            let runway = &plan().runways[0];
            let along = |along_m: f64, amsl_m| TrackPoint {
                position: runway.threshold.destination(runway.heading_deg, along_m),
                ..point(9.0, amsl_m)
            };
            glided.track = vec![along(900.0, 380.0), along(410.0, 312.0), along(200.0, 300.0)];
        }
        assert_eq!(
            words(&found)[0],
            "Engine failure: R05 is just reached without the engine on a part of Return home, over the threshold 12 m high, \
             landing from its other end, down after 1:30."
        );
        if let Some(glided) = &mut found.glided {
            glided.track = vec![point(8.99, 380.0), point(9.0001, 300.4), point(9.002, 300.0)];
        }
        assert!(words(&found)[0].ends_with(", touching down at the threshold after 1:30."), "not 0 m high");
        if let Some(glided) = &mut found.glided {
            glided.missed_m = 480.0;
        }
        assert_eq!(
            words(&found)[0],
            "Engine failure: R05 is not reached without the engine: as it is flown, on Return home, it comes down 480 m from the runway \
             after 1:30."
        );
        (found.powered, found.glided) = (Err("the aircraft has not taken off".into()), None);
        assert_eq!(
            words(&found)[0],
            "Engine failure: Return home is not flown: the aircraft has not taken off."
        );
        found.plan = None;
        assert!(words(&found)[0].contains("Safe mode"));
    }

    #[test]
    fn a_way_out_with_the_engine_says_when_it_lands_and_with_how_much_energy() {
        let powered = |landed, battery_left| {
            let powered = engine_fails().powered.map(|flown| Powered { landed, battery_left, ..flown });
            words(&Diversion { cause: Cause::Link, powered, glided: None, ..engine_fails() })
        };
        assert_eq!(
            powered(true, 0.62),
            [
                "Link lost: R05 is reached on Return home, after 3:20, 62 % energy left.",
                "A glide along all of the plan: at the threshold 40 m high, after 1:35.",
            ]
        );
        assert_eq!(
            powered(true, 0.04)[..2],
            [
                "Link lost: R05 is just reached on Return home, after 3:20, 4 % energy left.",
                "Just: less than 5 % energy is to spare.",
            ]
        );
        let in_the_air =
            "Link lost: R05 is not reached on Return home: it ends in the air after 3:20, 62 % energy left.";
        assert_eq!(powered(false, 0.62)[0], in_the_air);
    }
}
