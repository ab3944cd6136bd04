//! What the operator did besides the mission logic. What differs from the preview because of it is not held against the flight. Pure.

use crate::report::clock;
use flight_exec::{Branching, Event, Phase};
use flight_plan::{Cause, Id};
use std::sync::Arc;
use usal::contract::OPERATOR;

/// In words, each once; `ours`: hashes of the plans that the demo sent.
pub fn deeds(events: &[(f64, Event)], ours: &[Arc<str>]) -> Vec<String> {
    let mut deeds: Vec<String> = Vec::new();
    for (_, event) in events {
        let deed = match event {
            Event::DecisionTaken { leg, branch, by } if by == OPERATOR => {
                format!("decided for {branch} at {leg}")
            }
            Event::VariableChanged { name, by, .. } if **by == *OPERATOR => format!("set {name}"),
            Event::PlanActivated { hash, .. } if !ours.contains(hash) => "sent another plan".into(),
            Event::EmergencyStarted { cause: Cause::Operator, plan, .. } => format!("had {plan} flown"),
            _ => continue,
        };
        if !deeds.contains(&deed) {
            deeds.push(deed);
        }
    }
    let held_s = held_s(events);
    deeds.extend((held_s > 0.0).then(|| format!("held the aircraft for {}", clock(held_s))));
    deeds
}

/// Nobody but the operator orders a hold.
fn held_s(events: &[(f64, Event)]) -> f64 {
    let phases = events.iter().filter_map(|(time_s, event)| match event {
        Event::PhaseChanged { phase } => Some((*time_s, *phase)),
        _ => None,
    });
    let phases: Vec<(f64, Phase)> = phases.collect();
    let spans = phases.iter().zip(phases.iter().skip(1));
    spans
        .filter(|((_, phase), _)| *phase == Phase::Holding)
        .map(|((from_s, _), (to_s, _))| to_s - from_s)
        .sum()
}

/// The emergency plan on whose leg the flight ended, and why it was flown.
pub fn emergency_at_end(events: &[(f64, Event)]) -> Option<(Id, Cause)> {
    let last = events.iter().rev().find_map(|(_, event)| match event {
        Event::LegEntered { place } => Some(&place.plan),
        _ => None,
    });
    let Branching::Emergency(flown) = last? else { return None };
    let cause = events.iter().rev().find_map(|(_, event)| match event {
        Event::EmergencyStarted { cause, plan, .. } if plan == flown => Some(*cause),
        _ => None,
    });
    Some((flown.clone(), cause?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_exec::PlacePointer;

    fn phase(time_s: f64, phase: Phase) -> (f64, Event) {
        (time_s, Event::PhaseChanged { phase })
    }

    fn decided(by: &str) -> (f64, Event) {
        (1.0, Event::DecisionTaken { leg: "ask".into(), branch: "close".into(), by: by.into() })
    }

    #[test]
    fn what_the_demo_and_the_plan_do_is_not_the_operators() {
        let ours: Arc<str> = "ours".into();
        let events = [
            decided("mission"),
            decided("default"),
            (2.0, Event::PlanActivated { hash: ours.clone(), revision: 1 }),
            phase(0.0, Phase::Flying),
            phase(9.0, Phase::Finished),
        ];
        assert!(deeds(&events, &[ours]).is_empty());
    }

    #[test]
    fn what_the_operator_did_is_told_once_and_a_hold_with_its_time() {
        let events = [
            decided(OPERATOR),
            decided(OPERATOR),
            (2.0, Event::PlanActivated { hash: "theirs".into(), revision: 2 }),
            phase(10.0, Phase::Holding),
            phase(70.0, Phase::Flying),
        ];
        let told = deeds(&events, &["ours".into()]);
        assert_eq!(told, ["decided for close at ask", "sent another plan", "held the aircraft for 1:00"]);
    }

    #[test]
    fn flight_ends_in_the_emergency_of_its_last_leg() {
        let on = |plan: Branching| {
            let (stage, leg) = (Id::new("s"), Id::new("l"));
            let place =
                PlacePointer { plan, stage, leg, iterations: vec![], reverse: false, distance_m: 0.0 };
            (1.0, Event::LegEntered { place })
        };
        let home = || on(Branching::Emergency("home".into()));
        let raised = |cause| (0.5, Event::EmergencyStarted { cause, plan: "home".into(), from_leg: None });
        let (by_hand, by_alarm) = (raised(Cause::Operator), raised(Cause::Engine));
        let ended = [on(Branching::Main), by_hand.clone(), home(), by_alarm, home()];
        assert_eq!(emergency_at_end(&ended), Some(("home".into(), Cause::Engine)), "why it was flown last");
        assert_eq!(emergency_at_end(&[by_hand, home(), on(Branching::Main)]), None, "it went back");
    }
}
