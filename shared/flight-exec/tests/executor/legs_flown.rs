//! Every kind of leg flown by the simulated aircraft, turns, wind and all; and actions under any reports.

use crate::rig::{GROUND_M, Rig, document_with, fix, program};
use aircraft::{Profile, Wind};
use flight_exec::rehearse::{Options, Scenario, Start};
use flight_exec::{Command, Event, Input, ResolvedAct, Time, preview};
use geometry::LatLon;
use proptest::prelude::*;
use std::sync::Arc;
use terrain::{Flat, Terrain};

const EVERYTHING: &str = r#"
    <TF id="a" fix="B1"><action on="start"><videoStart/></action><action every="500"><photo/></action></TF>
    <FA id="climb" fix="B2" course="45" altitude="700" altitudeReference="amsl"/>
    <CF id="join" fix="D5" course="60"/>
    <HM id="hold" fix="D4" course="180" turn="left" length="500" maxLaps="1"><action on="end"><wait seconds="60"/></action></HM>
    <crissCross id="criss" spacing="400" heading="10"><area fix="C3" radius="600"/></crissCross>
    <spiral id="spiral" spacing="300" outerRadius="700" direction="inward" turn="left"><centre fix="C3"/></spiral>
    <expandingSquare id="square" spacing="500" radius="800" turn="right"><centre fix="C3"/></expandingSquare>
    <sector id="sector" radius="1200" turn="right"><centre fix="C3"/></sector>
    <trackLine id="line" spacing="600" returns="true"><route><point fix="B2"/><point fix="C3"/><point fix="D3"/></route></trackLine>
    <corridor id="corridor" width="800" spacing="400"><route><point fix="B2"/><point fix="C3"/><point fix="D3"/></route></corridor>
    <contour id="contour" spacing="300" levelStep="20" turn="left"><area fix="C3" radius="700"/></contour>
    <figureEight id="eight" radius="400" turns="1" turn="left"><centre fix="C3"/></figureEight>
    <TF id="z" fix="A3"><action on="start"><videoStop/></action></TF>"#;

#[test]
fn every_kind_of_leg_is_flown_in_wind_and_landed_after() {
    let plan = program(&document_with(EVERYTHING, "", ""));
    let profile = Profile { energy_j: 3e7, ..Profile::default() };
    let terrain: Arc<dyn Terrain> = Arc::new(Flat(GROUND_M));
    let wind = Wind::from_direction(250.0, 8.0);
    let (scenario, options) = (Scenario::default(), Options::default());
    let flight = preview(&plan, &profile, &terrain, wind, Start::Runway, &scenario, &options).unwrap();
    assert!(flight.landed);
    let mut legs: Vec<&str> = flight.legs.iter().map(|p| p.place.leg.as_str()).collect();
    legs.dedup();
    let ids: Vec<&str> = plan.plan.stages[1].legs.iter().map(|l| l.id.as_str()).collect();
    assert_eq!(legs[1..legs.len() - 1].to_vec(), ids, "take-off, every leg once and in order, landing");
    let acts = flight.events.iter().filter_map(|(time_s, e)| match e {
        Event::ActionDone { act, .. } => Some((*time_s, act.clone())),
        _ => None,
    });
    let acts: Vec<_> = acts.collect();
    let count = |wanted: &ResolvedAct| acts.iter().filter(|(_, act)| act == wanted).count();
    assert_eq!(count(&ResolvedAct::VideoStart) + count(&ResolvedAct::VideoStop), 2);
    // from the end of the take-off's climb to B1
    assert!((2..=4).contains(&count(&ResolvedAct::Photo)), "{acts:?}");
    let waited = acts.iter().find(|(_, act)| *act == ResolvedAct::Wait { seconds: 60.0 }).unwrap().0;
    let on = flight.legs.iter().find(|p| p.place.leg.as_str() == "criss").unwrap().start_s;
    assert!((60.0..62.0).contains(&(on - waited)), "it goes on after {} s", on - waited);
}

/// B1 to C1, 2 km: one of each, and one each 300 m.
const ACTIONS: &str = r#"<TF id="a" fix="B1"/><TF id="p" fix="C1"><action on="start"><videoStart/></action>
    <action every="300"><photo/></action><action afterDistance="1234"><photo every="20"/></action>
    <action on="abeam" lat="36.53" lon="-84.165"><photoStop/></action><action on="end"><videoStop/></action></TF><TF id="z" fix="D1"/>"#;

#[derive(Debug, Clone)]
enum Occurrence {
    Report(f64),
    Hold,
    Update,
    Restart,
    Variable(f64),
}

fn happening() -> impl Strategy<Value = Occurrence> {
    prop_oneof![
        6 => (0.0..500.0f64).prop_map(Occurrence::Report),
        1 => Just(Occurrence::Hold),
        1 => Just(Occurrence::Update),
        1 => Just(Occurrence::Restart),
        1 => (0.0..9.0f64).prop_map(Occurrence::Variable),
    ]
}

proptest! {
    // each case is a flight: a fifth of the usual number
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases / 5, ..ProptestConfig::default() })]

    /// Whatever is reported when, held, updated, written or restarted: each action exactly once, each multiple once.
    #[test]
    fn actions_are_done_once_whatever_happens(happenings in prop::collection::vec(happening(), 0..25)) {
        let variables = r#"<variable name="v" type="number" initial="0"/>"#;
        let text = document_with(ACTIONS, variables, "");
        let other = document_with(&ACTIONS.replace("D1", "D2"), variables, "");
        let plans = [program(&text), program(&other)];
        let mut rig = Rig::flying(&text);
        rig.fly_to("p");
        let (mut metres, mut active) = (0.0_f64, 0);
        for happening in happenings {
            match happening {
                Occurrence::Report(more) => metres = (metres + more).min(1990.0),
                Occurrence::Hold => {
                    rig.command(Command::Hold).unwrap();
                    rig.now += Time::from_secs(30);
                    rig.report();
                    rig.command(Command::Resume).unwrap();
                    rig.steer();
                    // it goes on through where the hold was given
                    if rig.buffer.front().is_some_and(|w| w.position.distance_m(fix("C1")) > 1.0) {
                        rig.fly_one();
                    }
                }
                Occurrence::Update => {
                    active = 1 - active;
                    rig.update(&plans[active]).unwrap();
                }
                Occurrence::Restart => restart(&mut rig),
                Occurrence::Variable(v) => rig.set("v", v).unwrap(),
            }
            rig.position = on_the_way(metres);
            rig.now += Time::from_secs(2);
            rig.report();
        }
        rig.position = fix("C1");
        rig.report();
        rig.fly_to_the_end();
        let mut done: Vec<String> = rig.acts.iter().map(|(_, _, act)| act.to_string()).collect();
        done.sort();
        let once = ["end of the photos", "photo", "photo", "photo", "photo", "photo", "photo", "photos every 20 m", "video off", "video on"];
        prop_assert_eq!(done, once);
    }
}

fn on_the_way(metres: f64) -> LatLon {
    fix("B1").destination(90.0, metres)
}

fn restart(rig: &mut Rig) {
    let snapshot = rig.executor.snapshot();
    let (config, profile) = (flight_exec::Config::default(), Profile::default());
    let plan = rig.executor.program().cloned();
    let terrain = Arc::new(Flat(GROUND_M));
    rig.executor = flight_exec::Executor::restore(config, terrain, profile, plan, snapshot).unwrap();
    rig.step(Input::Tick);
}

/// Spread over its waypoints, eight metres ahead of the aircraft: not eight more at each of them.
#[test]
fn a_climb_along_a_circle_is_no_steeper_than_the_aircraft_climbs() {
    let profile = Profile::default();
    let legs = r#"<TF id="a" fix="A3"/>
        <orbit id="arc" radius="700" turns="2" turn="right" altitude="900" altitudeReference="amsl"><centre fix="B3"/></orbit>
        <TF id="z" fix="A4"/>"#;
    let mut rig = Rig::started(legs);
    rig.fly_to_the_end();
    let at = rig.flown.iter().position(|w| w.leg.as_str() == "arc").unwrap();
    let (mut way_m, begun_m) = (0.0, rig.flown[at - 1].altitude_amsl_m);
    let mut waypoints = 0;
    for pair in rig.flown[at - 1..].windows(2).take_while(|pair| pair[1].leg.as_str() == "arc") {
        way_m += pair[0].position.distance_m(pair[1].position);
        let climbed_m = pair[1].altitude_amsl_m - begun_m;
        let most_m = profile.max_climb_mps * way_m / pair[1].airspeed_mps + 8.0;
        assert!(climbed_m <= most_m + 0.1, "{climbed_m} m after {way_m} m, {most_m} at most");
        waypoints += 1;
    }
    assert!(waypoints > 4 && rig.flown[at - 1 + waypoints].altitude_amsl_m > 899.0);
}
