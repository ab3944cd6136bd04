//! A plan in a few lines, for tests.

use flight_plan::{
    Act, Altitude, Area, FlightPlan, Leg, LegAction, LegKind, Pattern, Place, PlanWaypoint, Spacing,
    StageKind, Trigger, Value, ZoneKind, ZoneShape,
};
use geometry::LatLon;

/// Fixes, stages with legs, zones and emergency plans.
pub fn outline(plan: &FlightPlan) -> Vec<String> {
    let mut lines: Vec<String> =
        plan.fixes.iter().map(|f| format!("fix {} {} {}", f.id, at(f.position), f.description)).collect();
    for stage in &plan.stages {
        let runway = stage.runway.as_ref().map_or("", |r| r.as_str());
        match stage.kind {
            StageKind::TakeOff => {
                lines.push(format!("take-off on {runway}{}", height(" at ", stage.altitude.as_ref())))
            }
            StageKind::Land => lines.push(format!("land on {runway}")),
            _ => lines.push(stage.id.to_string()),
        }
        stage.legs.iter().for_each(|l| leg(l, 1, &mut lines));
    }
    for zone in &plan.zones {
        let kind = if zone.kind == ZoneKind::KeepIn { "keep-in" } else { "keep-out" };
        let shape = match &zone.shape {
            ZoneShape::Polygon(corners) => format!("of {} corners", corners.len()),
            ZoneShape::Circle { centre, radius_m } => format!("around {}, {radius_m} m", at(*centre)),
        };
        lines.push(format!("{} {kind} {shape}", zone.id));
    }
    lines.extend(plan.emergency_plans.iter().map(|e| format!("emergency {} on {}", e.id, e.runway)));
    lines
}

fn leg(leg: &Leg, depth: usize, lines: &mut Vec<String>) {
    let kind = match &leg.kind {
        LegKind::Df { to, .. } => format!("DF {}", waypoint(to)),
        LegKind::Tf(to) => format!("TF {}", waypoint(to)),
        LegKind::Rf { to, centre, turn } => format!("RF {} around {} {turn:?}", waypoint(to), at(*centre)),
        LegKind::Cf { to, course_deg } => format!("CF {} course {}", waypoint(to), value(course_deg)),
        LegKind::Intersection { branches, .. } => {
            let named =
                |branch: &flight_plan::Branch| format!(" {} to {}", branch.id, id(branch.next.as_ref()));
            format!("fork{}", branches.iter().map(named).collect::<String>())
        }
        LegKind::Ha(holding) => format!("HA {} {:?}", waypoint(&holding.fix), holding.turn),
        LegKind::Hm { holding, .. } => format!("HM {} {:?}", waypoint(&holding.fix), holding.turn),
        LegKind::Orbit { centre, radius_m, turns, turn } => {
            format!("orbit {}, {} m, {} times {turn:?}", place(centre), value(radius_m), value(turns))
        }
        LegKind::Iterative { until: Some(until), .. } => format!("until {until}"),
        LegKind::Iterative { count, .. } => format!("{} times", count.as_ref().map_or(0.0, value)),
        LegKind::Scan(scan) => {
            let Area::Polygon { corners, holes } = &scan.area else { panic!("{scan:?}") };
            let heading =
                scan.heading_deg.as_ref().map_or(String::new(), |h| format!(", heading {}", value(h)));
            let holes = if holes.is_empty() { String::new() } else { format!(", {} holes", holes.len()) };
            format!(
                "scan of {} corners, {} m{heading}, overshoot {}, {:?}{holes}",
                corners.len(),
                spacing(&scan.spacing),
                value(&scan.overshoot_m),
                scan.entry
            )
        }
        LegKind::Pattern(Pattern::Corridor { route, width_m, spacing: s }) => {
            format!("along {} points, {} m wide, {} m", route.len(), value(width_m), spacing(s))
        }
        other => panic!("{other:?}"),
    };
    let speed = leg.speed_mps.as_ref().map_or(String::new(), |s| format!(", {} m/s", value(s)));
    let actions: String = leg.actions.iter().map(|a| format!(", {}", action(a))).collect();
    let next = leg.next.as_ref().map_or(String::new(), |next| format!(", then {next}"));
    let indent = "  ".repeat(depth);
    let altitude = height(", ", leg.altitude.as_ref());
    lines.push(format!("{indent}{}: {kind}{altitude}{speed}{actions}{next}", leg.id));
    leg.body().iter().for_each(|inside| self::leg(inside, depth + 1, lines));
}

fn id(id: Option<&flight_plan::Id>) -> &str {
    id.map_or("the next", |id| id.as_str())
}

fn action(action: &LegAction) -> String {
    let when = match action.trigger {
        Trigger::Start => "start",
        Trigger::End => "end",
        ref other => panic!("{other:?}"),
    };
    match &action.act {
        Act::Photo => format!("{when} photo"),
        Act::PhotoSeries { every_m } => format!("{when} series {}", value(every_m)),
        Act::PhotoStop => format!("{when} stop"),
        Act::Wait { seconds } => format!("{when} wait {}", value(seconds)),
        other => panic!("{other:?}"),
    }
}

fn spacing(spacing: &Spacing) -> f64 {
    match spacing {
        Spacing::Metres(metres) => value(metres),
        Spacing::Camera { field_of_view_deg, overlap, height_m } => {
            let half = (value(field_of_view_deg) / 2.0).to_radians();
            let metres = 2.0 * value(height_m.as_ref().unwrap()) * half.tan() * (1.0 - value(overlap));
            (metres * 1e6).round() / 1e6
        }
    }
}

fn height(before: &str, altitude: Option<&Altitude>) -> String {
    altitude.map_or(String::new(), |a| format!("{before}{} {}", value(&a.metres), a.reference.name()))
}

fn waypoint(waypoint: &PlanWaypoint) -> String {
    place(&waypoint.place) + if waypoint.fly_over { " over" } else { "" }
}

fn place(place: &Place) -> String {
    match place {
        Place::Position(Value::Constant(position)) => at(*position),
        other => panic!("{other:?}"),
    }
}

fn at(position: LatLon) -> String {
    format!("{} {}", position.lat_deg, position.lon_deg)
}

fn value(value: &Value<f64>) -> f64 {
    match value {
        Value::Constant(number) => *number,
        Value::Expression(source) => panic!("{source}"),
    }
}
