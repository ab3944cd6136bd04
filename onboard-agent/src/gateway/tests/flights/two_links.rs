//! A second link to the autopilot, far slower than the one in use.

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
        let links = vec!["fast".into(), "slow".into()];
        let setup = Setup { lockstep: true, links, ..Setup::default() };
        self.station = Station::new(settings(), None, (driver::DEFAULT.make)(&setup));
        self.slower =
            Some(Slower { lag, decoder: Decoder::default(), sequence: 0, on_its_way: VecDeque::new() });
        self
    }
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
