//! A plan of two flights: the FP Manager waits on the ground, dies there, and goes on with the second one.

use super::asks::{MISSION, What};
use super::*;
use flight_exec::Phase;

/// The plan's own flight without its mission, twice.
fn twice() -> String {
    let (before, mission) = MISSION.split_once(r#"<stage id="watch""#).unwrap();
    let (_, behind) = mission.split_once("</stage>\n").unwrap();
    let once = format!("{before}{behind}");
    let land = r#"<stage id="ldg" type="land" runway="R"/>"#;
    let again = r#"<stage id="ldg" type="land" runway="R" turnaroundTime="600"/>
        <stage id="to2" type="take-off" runway="R" altitude="60" altitudeReference="home"/>
        <stage id="dep2" type="departure" altitude="120" altitudeReference="home">
          <TF id="out2" lat="36.499933" lon="-84.256032"/><TF id="final2" lat="36.484951" lon="-84.279805"/>
        </stage>
        <stage id="ldg2" type="land" runway="R"/>"#;
    once.replacen(land, again, 1)
}

fn phase(flight: &Flight) -> Phase {
    flight.process.manager.executor().status_phase()
}

fn run_until(flight: &mut Flight, wanted: Phase) {
    for _ in 0..STEPS_MAX {
        if phase(flight) == wanted {
            return;
        }
        flight.step();
    }
    panic!("never {wanted:?}: {:?}", flight.path());
}

#[test]
fn killed_between_two_flights_it_waits_and_flies_the_second_one() {
    for death in [Death::Kill, Death::PowerLoss] {
        let mut flight = Flight::new(1, false, false);
        flight.asks.clear();
        for (id, what) in
            [What::Propose(twice()), What::Commit, What::Command(Command::Start)].iter().enumerate()
        {
            flight.ask_once(what, &format!("ask-{id}")).unwrap();
            flight.step();
        }
        run_until(&mut flight, Phase::Grounded);
        assert_eq!((flight.gateway.state, flight.gateway.launches()), (GatewayState::Stop, 1));
        let flown = flight.gateway.flown.len();
        flight.disk.reboot(death, &mut Random(1));
        let (process, troubles) = begin(&flight.disk, &flight.config);
        assert!(troubles.is_empty(), "{troubles:?}");
        flight.process = process;
        flight.hand_in_state();
        flight.come_back().unwrap();
        (0..10).for_each(|_| flight.step());
        assert_eq!((phase(&flight), flight.gateway.flown.len()), (Phase::Grounded, flown));
        flight.ask_once(&What::Command(Command::Start), "again").unwrap();
        run_until(&mut flight, Phase::Finished);
        assert_eq!((flight.gateway.state, flight.gateway.launches()), (GatewayState::Stop, 2));
        let legs: Vec<&str> = flight.gateway.flown.iter().skip(flown).map(|w| w.leg.as_str()).collect();
        assert!(
            legs.first() == Some(&"to2") && legs.contains(&"out2") && legs.last() == Some(&"ldg2"),
            "{legs:?}"
        );
    }
}
