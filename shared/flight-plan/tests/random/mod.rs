//! Any plan, with everything that the language has; its identifiers name nothing.

use flight_plan::*;
use geometry::LatLon;
use proptest::collection::vec;
use proptest::option::of;
use proptest::prelude::*;
use std::sync::Arc;

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

fn reference() -> impl Strategy<Value = AltitudeReference> {
    use AltitudeReference::{Agl, Amsl, Home};
    prop_oneof![Just(Amsl), Just(Agl), Just(Home)]
}

fn altitude() -> BoxedStrategy<Altitude> {
    (value(), reference()).prop_map(|(metres, reference)| Altitude { metres, reference }).boxed()
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
        source().prop_map(Area::Expression),
    ]
    .boxed()
}

fn spacing() -> BoxedStrategy<Spacing> {
    let camera = (value(), value(), of(value()));
    prop_oneof![
        value().prop_map(Spacing::Metres),
        camera.prop_map(|(field_of_view_deg, overlap, height_m)| Spacing::Camera {
            field_of_view_deg,
            overlap,
            height_m
        }),
    ]
    .boxed()
}

fn scan() -> BoxedStrategy<LegKind> {
    use {ScanEntry as E, ScanStyle as S};
    let style = proptest::sample::select(vec![S::Parallel, S::Creeping, S::CrissCross]);
    let entry =
        proptest::sample::select(vec![E::Nearest, E::StartLeft, E::StartRight, E::EndLeft, E::EndRight]);
    let order = proptest::sample::select(vec![ScanOrder::Interleaved, ScanOrder::SideBySide]);
    (area(), style, spacing(), of(value()), value(), entry, order)
        .prop_map(|(area, style, spacing, heading_deg, overshoot_m, entry, order)| {
            LegKind::Scan(Scan { area, style, spacing, heading_deg, overshoot_m, entry, order })
        })
        .boxed()
}

fn pattern() -> BoxedStrategy<Pattern> {
    let (places, yes) = (|| vec(place(), 0..4), any::<bool>);
    prop_oneof![
        (place(), value(), value(), spacing(), yes(), turn()).prop_map(
            |(centre, inner_radius_m, outer_radius_m, spacing, inward, turn)| Pattern::Spiral {
                centre,
                inner_radius_m,
                outer_radius_m,
                spacing,
                inward,
                turn
            }
        ),
        (place(), spacing(), value(), value(), turn()).prop_map(
            |(centre, spacing, heading_deg, radius_m, turn)| Pattern::ExpandingSquare {
                centre,
                spacing,
                heading_deg,
                radius_m,
                turn
            }
        ),
        (place(), value(), value(), value(), value(), turn()).prop_map(
            |(centre, radius_m, sectors, heading_deg, passes, turn)| Pattern::Sector {
                centre,
                radius_m,
                sectors,
                heading_deg,
                passes,
                turn
            }
        ),
        (places(), spacing(), yes()).prop_map(|(route, spacing, returns)| Pattern::TrackLine {
            route,
            spacing,
            returns
        }),
        (places(), value(), spacing()).prop_map(|(route, width_m, spacing)| Pattern::Corridor {
            route,
            width_m,
            spacing
        }),
        (area(), spacing(), of(value()), of(value()), of(value()), yes(), turn()).prop_map(
            |(area, spacing, loops, levels, level_step_m, inward, turn)| {
                Pattern::Contour { area, spacing, loops, levels, level_step_m, inward, turn }
            }
        ),
        (place(), value(), value(), value(), turn()).prop_map(
            |(centre, radius_m, heading_deg, turns, turn)| Pattern::FigureEight {
                centre,
                radius_m,
                heading_deg,
                turns,
                turn
            }
        ),
    ]
    .boxed()
}

fn call() -> BoxedStrategy<LegKind> {
    (id(), vec((id(), source()), 0..3), of(place()), of(value()))
        .prop_map(|(procedure, arguments, anchor, bearing_deg)| {
            LegKind::Call(Call { procedure, arguments, anchor, bearing_deg })
        })
        .boxed()
}

fn action() -> BoxedStrategy<LegAction> {
    let trigger = prop_oneof![
        Just(Trigger::Start),
        Just(Trigger::End),
        value().prop_map(Trigger::Distance),
        value().prop_map(Trigger::Every),
        value().prop_map(Trigger::Time),
        place().prop_map(Trigger::Abeam),
    ];
    let act = prop_oneof![
        Just(Act::Photo),
        Just(Act::PhotoStop),
        Just(Act::VideoStart),
        Just(Act::VideoStop),
        value().prop_map(|every_m| Act::PhotoSeries { every_m }),
        (id(), source()).prop_map(|(variable, to)| Act::Set { variable, to }),
        (text(), text(), text()).prop_map(|(service, operation, argument)| Act::Invoke {
            service,
            operation,
            argument
        }),
        value().prop_map(|seconds| Act::Wait { seconds }),
    ];
    (trigger, act).prop_map(|(trigger, act)| LegAction { trigger, act }).boxed()
}

fn zone() -> BoxedStrategy<Zone> {
    let shape = prop_oneof![
        (lat_lon(), number()).prop_map(|(centre, radius_m)| ZoneShape::Circle { centre, radius_m }),
        vec(lat_lon(), 0..5).prop_map(ZoneShape::Polygon),
    ];
    let limit = || {
        of((number(), reference())).prop_map(|limit| {
            limit.map(|(metres, reference)| Altitude { metres: Value::Constant(metres), reference })
        })
    };
    // years 1 to 9999
    let time = || -62_135_596_800_i64..=253_402_207_200;
    let active =
        (time(), time()).prop_map(|(from_unix_s, until_unix_s)| ZoneTime { from_unix_s, until_unix_s });
    let kind = prop_oneof![Just(ZoneKind::KeepIn), Just(ZoneKind::KeepOut)];
    (id(), text(), kind, shape, limit(), limit(), vec(active, 0..3))
        .prop_map(|(id, name, kind, shape, floor, ceiling, active)| Zone {
            id,
            name,
            kind,
            shape,
            floor,
            ceiling,
            active,
        })
        .boxed()
}

fn procedure() -> BoxedStrategy<Procedure> {
    let parameter = (id(), of(source())).prop_map(|(name, default)| Parameter { name, default });
    (id(), text(), vec(parameter, 0..3), of(lat_lon()), number(), vec(leg(), 0..4))
        .prop_map(|(id, name, parameters, reference, bearing_deg, legs)| Procedure {
            id,
            name,
            parameters,
            reference,
            bearing_deg,
            legs: shared(legs),
        })
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
        (waypoint(), value()).prop_map(|(to, course_deg)| LegKind::Cf { to, course_deg }),
        (waypoint(), value()).prop_map(|(from, course_deg)| LegKind::Fa { from, course_deg }),
        (holding(), of(source()), of(value())).prop_map(|(holding, until, max_laps)| LegKind::Hm {
            holding,
            until,
            max_laps
        }),
        holding().prop_map(LegKind::Hf),
        holding().prop_map(LegKind::Ha),
        intersection(),
        scan(),
        pattern().prop_map(LegKind::Pattern),
        call(),
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
    (id(), text(), emergency(), of(altitude()), of(value()), of(id()), vec(action(), 0..3), kind)
        .prop_map(|(id, name, emergency, altitude, speed_mps, next, actions, kind)| Leg {
            id,
            name,
            emergency,
            altitude,
            speed_mps,
            next,
            actions,
            kind,
        })
        .boxed()
}

fn shared(legs: Vec<Leg>) -> Vec<Arc<Leg>> {
    legs.into_iter().map(Arc::new).collect()
}

fn leg() -> BoxedStrategy<Leg> {
    let single = leg_of(simple_kind());
    single
        .prop_recursive(3, 12, 4, |inner| {
            let form = prop_oneof![Just(IterativeForm::Forward), Just(IterativeForm::Reverse)];
            let kind = (form, of(value()), of(source()), turn(), vec(inner, 0..4)).prop_map(
                |(form, count, until, turn, body)| LegKind::Iterative {
                    form,
                    count,
                    until,
                    turn,
                    body: shared(body),
                },
            );
            leg_of(kind)
        })
        .boxed()
}

fn stage() -> BoxedStrategy<Stage> {
    use StageKind::{Approach, Arrival, Departure, EnRoute, Land, Mission, TakeOff};
    let kind = proptest::sample::select(vec![TakeOff, Departure, EnRoute, Mission, Arrival, Approach, Land]);
    let energy = prop_oneof![Just(TurnaroundEnergy::Kept), number().prop_map(TurnaroundEnergy::Share)];
    let turnaround = (of(energy), of(number())).prop_map(|(energy, time_s)| Turnaround { energy, time_s });
    (id(), text(), kind, emergency(), of(id()), of(altitude()), of(value()), turnaround, vec(leg(), 0..5))
        .prop_map(|(id, name, kind, emergency, runway, altitude, speed_mps, turnaround, legs)| Stage {
            id,
            name,
            kind,
            emergency,
            runway,
            altitude,
            speed_mps,
            turnaround,
            legs: shared(legs),
        })
        .boxed()
}

fn variable() -> BoxedStrategy<Variable> {
    let initial = prop_oneof![
        any::<bool>().prop_map(VariableValue::Bool),
        number().prop_map(VariableValue::Number),
        text().prop_map(VariableValue::Text),
        lat_lon().prop_map(VariableValue::Position),
        vec(lat_lon(), 0..5).prop_map(VariableValue::Polygon),
    ];
    (id(), initial, text(), of(number()), of(number()), of(any::<usize>()), vec(id(), 0..3))
        .prop_map(|(name, initial, unit, min, max, max_length, writers)| Variable {
            name,
            initial,
            unit,
            min,
            max,
            max_length,
            writers,
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

pub fn plan() -> BoxedStrategy<FlightPlan> {
    let emergency_plan = (id(), text(), id(), vec(stage(), 0..3))
        .prop_map(|(id, name, runway, stages)| EmergencyPlan { id, name, runway, stages });
    let lists = (vec(fix(), 0..3), vec(runway(), 0..3), vec(variable(), 0..3));
    let more = (vec(zone(), 0..3), vec(procedure(), 0..3));
    (text(), text(), lists, more, emergency(), vec(stage(), 0..4), vec(emergency_plan, 0..3))
        .prop_map(|(name, aircraft, lists, (zones, procedures), emergency, stages, emergency_plans)| {
            let (fixes, runways, variables) = lists;
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

/// Some leg, stage or procedure is there twice.
pub fn has_duplicates(plan: &FlightPlan) -> bool {
    fn add<'a>(legs: &'a [Arc<Leg>], ids: &mut Vec<&'a Id>) {
        for leg in legs {
            ids.push(&leg.id);
            add(leg.body(), ids);
        }
    }
    let mut ids: Vec<&Id> = plan.procedures.iter().map(|p| &p.id).collect();
    plan.procedures.iter().for_each(|p| add(&p.legs, &mut ids));
    for (_, stage) in plan.all_stages() {
        ids.push(&stage.id);
        add(&stage.legs, &mut ids);
    }
    let different: std::collections::HashSet<&Id> = ids.iter().copied().collect();
    different.len() < ids.len()
}
