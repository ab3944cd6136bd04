//! Any plan is written and read back unchanged, and the same plan gives the same bytes.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use flight_plan::*;
use geometry::LatLon;
use proptest::collection::vec;
use proptest::option::of;
use proptest::prelude::*;

// The strategies are boxed: their types are too large for a test's stack otherwise.

fn id() -> impl Strategy<Value = Id> {
    "[A-Za-z0-9_.-]{1,8}".prop_map(|text| Id::new(&text))
}

/// Text with everything that needs care in XML.
fn text() -> impl Strategy<Value = String> {
    prop_oneof![
        Just(String::new()),
        "[a-z <>&\"'\\n\\r\\t=éß漢😀]{0,12}",
        Just("]]> &amp; &#0; <!-- -->".into())
    ]
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![-1e4..1e4, proptest::num::f64::NORMAL, Just(0.0), Just(1e300), Just(5e-324), Just(0.1 + 0.2)]
}

fn lat_lon() -> impl Strategy<Value = LatLon> {
    (-90.0..=90.0, -180.0..=180.0).prop_map(|(lat, lon)| LatLon::new(lat, lon))
}

fn source() -> impl Strategy<Value = std::sync::Arc<str>> {
    "[a-z(][a-z0-9 <>&\"'+*()]{0,12}[a-z)]".prop_map(|s| s.as_str().into())
}

fn value() -> BoxedStrategy<Value<f64>> {
    prop_oneof![number().prop_map(Value::Constant), source().prop_map(Value::Expression)].boxed()
}

fn place() -> BoxedStrategy<Place> {
    prop_oneof![
        id().prop_map(Place::Fix),
        lat_lon().prop_map(|p| Place::Position(Value::Constant(p))),
        source().prop_map(|s| Place::Position(Value::Expression(s))),
    ]
    .boxed()
}

fn waypoint() -> BoxedStrategy<PlanWaypoint> {
    (place(), any::<bool>()).prop_map(|(place, fly_over)| PlanWaypoint { place, fly_over }).boxed()
}

fn turn() -> impl Strategy<Value = TurnDirection> {
    prop_oneof![Just(TurnDirection::Left), Just(TurnDirection::Right)]
}

fn altitude() -> BoxedStrategy<Altitude> {
    use AltitudeReference::{Agl, Amsl, Home};
    let reference = prop_oneof![Just(Amsl), Just(Agl), Just(Home)];
    (value(), reference).prop_map(|(metres, reference)| Altitude { metres, reference }).boxed()
}

fn emergency() -> BoxedStrategy<EmergencyChoice> {
    let causes =
        proptest::sample::subsequence(vec![Cause::Operator, Cause::Link, Cause::Gps, Cause::Engine], 0..3);
    (of(id()), causes, id())
        .prop_map(|(fallback, causes, plan)| {
            let by_cause = causes.into_iter().map(|cause| (Some(cause), plan.clone()));
            EmergencyChoice { by_cause: fallback.map(|id| (None, id)).into_iter().chain(by_cause).collect() }
        })
        .boxed()
}

fn holding() -> BoxedStrategy<Holding> {
    let length =
        prop_oneof![value().prop_map(HoldingLength::Distance), value().prop_map(HoldingLength::Time)];
    (waypoint(), of(value()), turn(), length)
        .prop_map(|(fix, inbound_course_deg, turn, leg)| Holding { fix, inbound_course_deg, turn, leg })
        .boxed()
}

fn area() -> BoxedStrategy<Area> {
    prop_oneof![
        (place(), value()).prop_map(|(centre, radius_m)| Area::Circle { centre, radius_m }),
        (vec(lat_lon(), 0..5), vec(vec(lat_lon(), 0..4), 0..3))
            .prop_map(|(corners, holes)| Area::Polygon { corners, holes }),
    ]
    .boxed()
}

fn intersection() -> BoxedStrategy<LegKind> {
    let branch = (id(), text(), of(id()), of(source())).prop_map(|(id, label, next, when)| Branch {
        id,
        label,
        next,
        when,
    });
    let before =
        prop_oneof![number().prop_map(DecideBefore::Time), number().prop_map(DecideBefore::Distance)];
    (vec(branch, 0..3), of(id()), before)
        .prop_map(|(branches, default, decide_before)| LegKind::Intersection {
            branches,
            default,
            decide_before,
        })
        .boxed()
}

fn simple_kind() -> BoxedStrategy<LegKind> {
    prop_oneof![
        waypoint().prop_map(LegKind::If),
        waypoint().prop_map(LegKind::Tf),
        (waypoint(), of(turn())).prop_map(|(to, turn)| LegKind::Df { to, turn }),
        (waypoint(), lat_lon(), turn()).prop_map(|(to, centre, turn)| LegKind::Rf { to, centre, turn }),
        holding().prop_map(LegKind::Hf),
        holding().prop_map(LegKind::Ha),
        intersection(),
        (area(), value(), of(value()), value()).prop_map(|(area, spacing, heading_deg, overshoot_m)| {
            let (style, entry) = (ScanStyle::Parallel, ScanEntry::Nearest);
            LegKind::Scan(Scan {
                area,
                style,
                spacing: Spacing::Metres(spacing),
                heading_deg,
                overshoot_m,
                entry,
            })
        }),
        (place(), value(), value(), turn()).prop_map(|(centre, radius_m, turns, turn)| LegKind::Orbit {
            centre,
            radius_m,
            turns,
            turn
        }),
    ]
    .boxed()
}

fn leg_of(kind: impl Strategy<Value = LegKind> + 'static) -> BoxedStrategy<Leg> {
    (id(), text(), emergency(), of(altitude()), of(value()), of(id()), kind)
        .prop_map(|(id, name, emergency, altitude, speed_mps, next, kind)| Leg {
            id,
            name,
            emergency,
            altitude,
            speed_mps,
            next,
            actions: Vec::new(),
            kind,
        })
        .boxed()
}

fn leg() -> BoxedStrategy<Leg> {
    let single = leg_of(simple_kind());
    single
        .prop_recursive(3, 12, 4, |inner| {
            let form = prop_oneof![Just(IterativeForm::Forward), Just(IterativeForm::Reverse)];
            let kind = (form, of(value()), of(source()), turn(), vec(inner, 0..4)).prop_map(
                |(form, count, until, turn, body)| LegKind::Iterative { form, count, until, turn, body },
            );
            leg_of(kind)
        })
        .boxed()
}

fn stage() -> BoxedStrategy<Stage> {
    use StageKind::{Approach, Arrival, Departure, EnRoute, Land, Mission, TakeOff};
    let kind = proptest::sample::select(vec![TakeOff, Departure, EnRoute, Mission, Arrival, Approach, Land]);
    (id(), text(), kind, emergency(), of(id()), of(altitude()), of(value()), vec(leg(), 0..5))
        .prop_map(|(id, name, kind, emergency, runway, altitude, speed_mps, legs)| Stage {
            id,
            name,
            kind,
            emergency,
            runway,
            altitude,
            speed_mps,
            legs,
        })
        .boxed()
}

fn variable() -> BoxedStrategy<Variable> {
    let initial = prop_oneof![
        any::<bool>().prop_map(VariableValue::Bool),
        number().prop_map(VariableValue::Number),
        text().prop_map(VariableValue::Text),
        lat_lon().prop_map(VariableValue::Position),
    ];
    (id(), initial, text(), of(number()), of(number()), of(any::<usize>()))
        .prop_map(|(name, initial, unit, min, max, max_length)| Variable {
            name,
            initial,
            unit,
            min,
            max,
            max_length,
            writers: Vec::new(),
        })
        .boxed()
}

fn fix() -> BoxedStrategy<Fix> {
    (id(), lat_lon(), text(), text())
        .prop_map(|(id, position, name, description)| Fix { id, position, name, description })
        .boxed()
}

fn runway() -> BoxedStrategy<Runway> {
    (id(), lat_lon(), number(), number(), number(), any::<u32>(), of(lat_lon()))
        .prop_map(|(id, threshold, elevation_amsl_m, heading_deg, length_m, priority, approach_entry)| {
            Runway { id, threshold, elevation_amsl_m, heading_deg, length_m, priority, approach_entry }
        })
        .boxed()
}

fn plan() -> BoxedStrategy<FlightPlan> {
    let emergency_plan = (id(), text(), id(), vec(stage(), 0..3))
        .prop_map(|(id, name, runway, stages)| EmergencyPlan { id, name, runway, stages });
    let lists = (vec(fix(), 0..3), vec(runway(), 0..3), vec(variable(), 0..3));
    (text(), text(), lists, emergency(), vec(stage(), 0..4), vec(emergency_plan, 0..3))
        .prop_map(|(name, aircraft, (fixes, runways, variables), emergency, stages, emergency_plans)| {
            let (zones, procedures) = (Vec::new(), Vec::new());
            FlightPlan {
                name,
                aircraft,
                fixes,
                runways,
                variables,
                zones,
                procedures,
                emergency,
                stages,
                emergency_plans,
            }
        })
        .boxed()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn reading_what_was_written_gives_the_plan_back(plan in plan()) {
        let document = write(&plan);
        let reading = read(&document);
        prop_assert_eq!(&reading.problems, &[]);
        prop_assert_eq!(&reading.plan, &plan);
        prop_assert_eq!(write(&reading.plan), document);
        prop_assert_eq!(hash(&reading.plan), hash(&plan));
    }

    #[test]
    fn different_plans_have_different_hashes(a in plan(), b in plan()) {
        prop_assert_eq!(hash(&a) == hash(&b), a == b);
    }

    #[test]
    fn a_plan_does_not_differ_from_itself(plan in plan()) {
        prop_assert!(Difference::between(&plan, &plan).is_empty() || has_duplicates(&plan));
    }
}

fn has_duplicates(plan: &FlightPlan) -> bool {
    let legs = plan.all_legs();
    let ids: std::collections::HashSet<&Id> = legs.iter().map(|c| &c.leg.id).collect();
    ids.len() < legs.len()
}
