//! A second link to the autopilot: one far slower than the one in use, and one as good as that.

use super::*;
use autopilot_link::frame::{Decoder, encode};
use mavlink::dialects::ardupilotmega::MavMessage;
use std::collections::VecDeque;

/// What it brings later: what the autopilot says of its state, with numbers of its own, as a router sends it that thins out.
pub struct Slower {
    lag: Duration,
    decoder: Decoder,
    sequence: u8,
    on_its_way: VecDeque<(Time, Vec<u8>)>,
}

impl Slower {
    /// The same came over the link in use.
    pub fn hear(&mut self, now: Time, bytes: &[u8]) {
        use MavMessage::{EXTENDED_SYS_STATE, HEARTBEAT, MISSION_CURRENT};
        self.decoder.push(bytes);
        while let Some(frame) = self.decoder.next_frame() {
            let message = frame.message();
            let carried =
                |m: &MavMessage| matches!(m, HEARTBEAT(_) | MISSION_CURRENT(_) | EXTENDED_SYS_STATE(_));
            if let Some(message) = message.filter(carried) {
                let bytes = encode(frame.sender, self.sequence, &message);
                self.sequence = self.sequence.wrapping_add(1);
                self.on_its_way.push_back((now + self.lag, bytes));
            }
        }
    }

    /// What comes now.
    pub fn next(&mut self, now: Time) -> Option<Vec<u8>> {
        self.on_its_way.pop_front_if(|(comes, _)| *comes <= now).map(|(_, bytes)| bytes)
    }
}

impl Flight {
    /// With such a link, which is so much slower.
    fn with_slower_link(mut self, lag: Duration) -> Self {
        self.station = station_with_two_links();
        self.slower =
            Some(Slower { lag, decoder: Decoder::default(), sequence: 0, on_its_way: VecDeque::new() });
        self
    }
}

fn station_with_two_links() -> Station {
    let links = vec!["first".into(), "second".into()];
    let setup = Setup { lockstep: true, links, ..Setup::default() };
    Station::new(settings(), None, (driver::DEFAULT.make)(&setup))
}

/// Whatever it says of the past, nobody took over, nothing was lost, and nothing is flown that was not next.
fn check(personality: Personality, lag_ms: u64) {
    let mut flight = Flight::of(personality, 5, &[]).with_slower_link(Duration::from_millis(lag_ms));
    if personality == Personality::Px4 {
        assert!(flight.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0));
    }
    // it says what it is, and is asked for a parameter
    while !flight.ask(GatewayRequest::Launch).unwrap_err().contains("nothing to fly") {
        flight.step();
    }
    let way = zigzag(0, 10, 300.0).into_iter().chain(landing());
    flight.launch(std::iter::once(take_off()).chain(way).collect());
    flight.run_until(100.0, "waypoint 5", |f| f.has_reached(5));
    flight.ask(GatewayRequest::Hold).unwrap();
    flight.run_until(5.0, "Hold", |f| f.state() == GatewayState::Hold);
    flight.run(10.0);
    assert_eq!(flight.state(), GatewayState::Hold);
    flight.ask(GatewayRequest::Resume).unwrap();
    flight.run_until(800.0, "landed", |f| f.state() == GatewayState::Stop);
    let states: Vec<_> = flight.changes().into_iter().map(|(_, state)| state).collect();
    use GatewayState::*;
    assert_eq!(states, [Stop, TakeOff, Nav, Hold, Nav, Approach, Land, Stop]);
    let told: Vec<u64> = flight.progress().into_iter().flatten().collect();
    assert!(told.is_sorted() && told.last() == Some(&14), "{told:?}");
}

#[test]
fn a_far_slower_second_link_changes_nothing_in_flight() {
    check(Personality::ArduPlane, 1200);
    check(Personality::Px4, 4000);
}

/// The first link is cut in flight, is back, and then the other one is cut.
fn check_cut(personality: Personality) {
    let mut flight = Flight::of(personality, 6, &[]);
    flight.station = station_with_two_links();
    assert!(flight.sim.connect(PEERS[1]));
    flight.second = Some(sim::frame::Decoder::default());
    if personality == Personality::Px4 {
        assert!(flight.sim.autopilot.params.set("MIS_TKO_LAND_REQ", 0.0));
    }
    while !flight.ask(GatewayRequest::Launch).unwrap_err().contains("nothing to fly") {
        flight.step();
    }
    flight.launch(std::iter::once(take_off()).chain(zigzag(0, 30, 300.0)).collect());
    let mut longest_s = 0.0_f64;
    for (cut, until) in [(vec![], 4), (vec![0], 12), (vec![], 16), (vec![1], 20), (vec![0], 24)] {
        flight.cut = cut;
        flight.run_until(200.0, "farther", |f| {
            longest_s = longest_s.max(f.station.gateway().status(f.now).autopilot_age_s);
            f.has_reached(until)
        });
    }
    assert!(longest_s < 2.5, "it was not heard for {longest_s} s");
    let states: Vec<_> = flight.changes().into_iter().map(|(_, state)| state).collect();
    assert_eq!(states, [GatewayState::Stop, GatewayState::TakeOff, GatewayState::Nav]);
    let told: Vec<u64> = flight.progress().into_iter().flatten().collect();
    assert!(told.windows(2).all(|w| w[1] == w[0] + 1), "{told:?}");
    let low = |event: &(f64, GatewayEvent)| matches!(event.1, GatewayEvent::BufferLow { .. });
    assert!(!flight.events.iter().any(low), "{:?}", flight.events);
}

#[test]
fn a_link_that_is_cut_in_flight_is_followed_by_the_other_one_without_a_gap() {
    check_cut(Personality::ArduPlane);
    check_cut(Personality::Px4);
}
