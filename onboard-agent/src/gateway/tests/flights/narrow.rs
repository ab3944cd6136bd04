//! The whole agent over a radio of 50 kbit/s that loses a fifth of all frames: how soon a change is flown.

use super::whole::{Whole, plan};
use super::*;
use flight_exec::Command;
use std::collections::VecDeque;

/// Bytes that 50 kbit/s carry in a step of 100 ms.
const A_STEP: usize = 50_000 / 8 / 10;
/// Bytes that wait in a radio; what comes on top is lost.
const BUFFER: usize = 4096;
/// A frame of MAVLink 2 that has to do with time: time has to go on.
const TIMESYNC: [u8; 3] = [111, 0, 0];

/// Whether a radio gets through.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub enum Air {
    #[default]
    Clear,
    /// What is sent waits in the radio.
    Blocked,
    /// What is sent is lost.
    Lost,
}

/// One direction of a radio.
#[derive(Debug, Default)]
pub struct Radio {
    pub air: Air,
    waiting: VecDeque<(usize, Vec<u8>)>,
    credit: usize,
}

impl Radio {
    /// What comes out of it in a step in which this goes in.
    pub fn pass(&mut self, sent: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)> {
        let is_time = |(_, bytes): &(usize, Vec<u8>)| bytes.get(7..10) == Some(&TIMESYNC);
        let (time, sent): (Vec<_>, Vec<_>) = sent.into_iter().partition(is_time);
        for frame in sent.into_iter().filter(|_| self.air != Air::Lost) {
            let waiting: usize = self.waiting.iter().map(|(_, bytes)| bytes.len()).sum();
            self.waiting.extend((waiting + frame.1.len() <= BUFFER).then_some(frame));
        }
        self.credit = A_STEP + if self.waiting.is_empty() { 0 } else { self.credit };
        if self.air != Air::Clear {
            return time;
        }
        let mut out = vec![];
        while let Some(frame) = self.waiting.pop_front_if(|(_, bytes)| bytes.len() <= self.credit) {
            self.credit -= frame.1.len();
            out.push(frame);
        }
        out.extend(time);
        out
    }
}

/// Seconds from a command in flight until the aircraft steers by it.
fn flown_after_s(personality: Personality, seed: u64, command: impl FnOnce(&mut Whole) -> Command) -> f64 {
    let mut whole = Whole::flying(personality, seed, &["packet-loss=0.2"], &plan(0.0));
    whole.flight.narrow = Some([Radio::default(), Radio::default()]);
    whole.run(20.0 + (seed % 10) as f64);
    let before = whole.manager.executor().last_token();
    let (command, since) = (command(&mut whole), whole.flight.now);
    whole.command(command).unwrap();
    let target = whole.manager.executor().ahead().find(|w| w.token > before).map(|w| w.position);
    let target = target.expect("the change is of what is flown now");
    whole.run_until(60.0, "it is steered to", |whole| {
        let active = &whole.flight.sim.autopilot.run.active;
        active.as_ref().is_some_and(|item| item.position.distance_m(target) < 1.0)
    });
    (whole.flight.now - since).as_secs_f64()
}

fn within_3_s(what: &str, personality: Personality, command: impl Fn(&mut Whole) -> Command) {
    let seeds = if cfg!(debug_assertions) { 5 } else { 40 };
    let mut times_s: Vec<f64> = (0..seeds).map(|seed| flown_after_s(personality, seed, &command)).collect();
    times_s.sort_by(f64::total_cmp);
    println!("{personality}: {what} flown after {times_s:.1?}");
    let in_time = times_s.iter().filter(|s| **s < 3.0).count() as f64;
    assert!(in_time >= 0.95 * times_s.len() as f64, "{personality}: {what} flown after {times_s:.1?} s");
}

#[test]
fn a_changed_plan_is_steered_by_within_3_s_over_a_bad_radio() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        within_3_s("a changed plan", personality, |whole| whole.propose(&plan(900.0)));
    }
}

#[test]
fn an_emergency_is_steered_by_within_3_s_over_a_bad_radio() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let emergency = Command::Emergency { cause: flight_plan::Cause::Operator, plan: None };
        within_3_s("an emergency", personality, |_| emergency.clone());
    }
}
