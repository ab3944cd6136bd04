//! Was the mission really flown as planned? Pure: from what was recorded to a verdict.

use super::recorded::Transition;
use crate::report::{Findings, Record, clock};
use flight_exec::Phase;
use flight_plan::{Cause, Id};
use geometry::{LatLon, LocalFrame, Vec2};

/// Greatest cross-track error on TF legs, against the previewed path and against the authored one, metres.
const TF_LIMIT_M: f64 = 15.0;
/// The same on RF legs.
const RF_LIMIT_M: f64 = 25.0;
/// Greatest difference between the flown and the previewed time, as a share of the previewed one.
const TIME_LIMIT: f64 = 0.03;
/// Least share of each scanned area that must have been seen.
const COVERAGE_LIMIT: f64 = 0.99;
/// How far beside the centre line a landed aircraft may stand, metres.
const BESIDE_LIMIT_M: f64 = 30.0;
/// Slower than this it stands, m/s.
const STANDING_MPS: f64 = 1.0;

/// What the demo knows at the end besides the record.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// Where the aircraft really ended.
    pub stands_at: LatLon,
    /// On the ground.
    pub on_ground: bool,
    /// Motor disarmed.
    pub disarmed: bool,
    /// m/s over the ground.
    pub ground_speed_mps: f64,
    /// The runway to land on: that of the plan, or of the emergency plan with which the flight ended.
    pub runway: flight_plan::Runway,
    /// The emergency plan with which the flight ended, and why it was flown.
    pub emergency: Option<(Id, Cause)>,
    /// What the operator did besides the mission logic.
    pub by_hand: Vec<String>,
    /// The executor's last phase.
    pub phase: Phase,
    /// The gateway's states in order, as far as events told; times count from the start of the plan.
    pub states: Vec<Transition>,
    /// Steps of the mission logic that did not happen.
    pub missing_steps: Vec<String>,
    /// Steps in all.
    pub steps: usize,
    /// Waypoints or patterns that were refused.
    pub refusals: Vec<String>,
}

/// The verdict's sentences, each with whether it holds.
pub fn verdict(record: &Record, findings: &Findings, outcome: &Outcome) -> Vec<(bool, String)> {
    let mut verdict = vec![landed(outcome), finished(outcome)];
    let compared = compared(record, findings, outcome);
    verdict.extend(compared.into_iter().map(|(holds, text)| match holds || outcome.by_hand.is_empty() {
        true => (holds, text),
        false => (true, format!("not judged, for the operator took part: {text}")),
    }));
    verdict.extend([never_safe(outcome), nothing_refused(outcome)]);
    verdict.extend(took_part(outcome).map(|text| (true, text)));
    verdict
}

/// `the operator took part: held the aircraft for 1:20`.
fn took_part(outcome: &Outcome) -> Option<String> {
    let deeds = outcome.by_hand.join(", ");
    (!deeds.is_empty()).then(|| format!("the operator took part: {deeds}"))
}

/// Against what was previewed and authored.
fn compared(record: &Record, findings: &Findings, outcome: &Outcome) -> Vec<(bool, String)> {
    let mut verdict = vec![as_previewed(record), on_time(findings)];
    if outcome.steps > 0 {
        verdict.push(scripted(outcome));
    }
    for (kind, limit_m) in [("TF", TF_LIMIT_M), ("RF", RF_LIMIT_M)] {
        if is_planned(record, kind) {
            verdict.push(deviation(findings, kind, limit_m));
            verdict.extend(from_authored(findings, kind, limit_m));
        }
    }
    if is_planned(record, "scan") {
        verdict.push(covered(findings));
    }
    verdict
}

/// The preview has legs of this type.
fn is_planned(record: &Record, kind: &str) -> bool {
    record.planned.passages().iter().any(|p| p.kind == kind)
}

fn landed(outcome: &Outcome) -> (bool, String) {
    let runway = &outcome.runway;
    if !outcome.on_ground || outcome.ground_speed_mps > STANDING_MPS {
        return (
            false,
            format!(
                "still moving at {:.1} m/s when it ended{}, not landed on {}",
                outcome.ground_speed_mps,
                last_state(outcome),
                runway.id
            ),
        );
    }
    let offset = LocalFrame::new(runway.threshold).to_local(outcome.stands_at);
    let ahead = Vec2::from_bearing_rad(runway.heading_deg.to_radians());
    let (along_m, beside_m) = (offset.dot(ahead), ahead.cross(offset).abs());
    let on_it = (0.0..=runway.length_m).contains(&along_m) && beside_m <= BESIDE_LIMIT_M;
    let text = format!(
        "stands on {}, {along_m:.0} m behind the threshold, {beside_m:.1} m off its centre line",
        runway.id
    );
    match (on_it, outcome.disarmed) {
        (true, true) => (true, text),
        (true, false) => (false, format!("{text}, but still armed")),
        (false, _) => {
            (false, format!("landed beside {}: {along_m:.0} m along, {beside_m:.0} m aside", runway.id))
        }
    }
}

/// An emergency that the operator raised is no failure, and no plan that was flown.
fn finished(outcome: &Outcome) -> (bool, String) {
    match (outcome.phase, &outcome.emergency) {
        (Phase::Finished, None) => (true, "the plan was flown to its end".into()),
        (Phase::Finished, Some((plan, cause))) => (
            *cause == Cause::Operator,
            format!("the plan was not flown to its end: emergency plan {plan} was flown instead"),
        ),
        (other, _) => {
            (false, format!("the plan did not come to its end: it was {other:?}{}", last_state(outcome)))
        }
    }
}

/// `, with the gateway in SafeHold`.
fn last_state(outcome: &Outcome) -> String {
    outcome.states.last().map_or_else(String::new, |last| format!(", with the gateway in {:?}", last.to))
}

/// Every passage of the preview was flown, in the same order, and no other.
fn as_previewed(record: &Record) -> (bool, String) {
    let (planned, flown) = (record.planned.passages(), record.flown.passages());
    let differing = planned.iter().zip(flown).position(|(p, f)| p.key != f.key);
    match differing {
        Some(i) => (
            false,
            format!("passage {}: {} was flown, {} was previewed", i + 1, flown[i].key, planned[i].key),
        ),
        None if planned.len() != flown.len() => {
            (false, format!("{} passages of legs were flown, {} were previewed", flown.len(), planned.len()))
        }
        None => (!flown.is_empty(), format!("all {} passages of legs as previewed", flown.len())),
    }
}

/// The passages that were previewed took as long as there, all together.
fn on_time(findings: &Findings) -> (bool, String) {
    let times = || findings.passages.iter().filter_map(|row| Some((row.time_s, row.planned_time_s?)));
    let (flown_s, planned_s) = times().fold((0.0, 0.0), |sum, (f, p)| (sum.0 + f, sum.1 + p));
    let off = (flown_s - planned_s) / planned_s.max(1.0);
    let text = format!(
        "flown in {}, previewed {}: {:+.1} % (limit {:.0} %)",
        clock(flown_s),
        clock(planned_s),
        off * 100.0,
        TIME_LIMIT * 100.0
    );
    (planned_s > 0.0 && off.abs() <= TIME_LIMIT, text)
}

fn scripted(outcome: &Outcome) -> (bool, String) {
    match outcome.missing_steps.as_slice() {
        [] => (true, format!("the mission logic did its {} steps", outcome.steps)),
        missing => (false, format!("the mission logic did not come to: {}", missing.join(", "))),
    }
}

fn deviation(findings: &Findings, kind: &str, limit_m: f64) -> (bool, String) {
    match findings.worst(kind) {
        Some(worst) => (
            worst.worst_m() < limit_m,
            format!(
                "cross-track error on {kind} legs {:.1} m at most, on {} (limit {limit_m} m)",
                worst.worst_m(),
                worst.passage.key
            ),
        ),
        None => (false, format!("no {kind} leg was flown")),
    }
}

/// Against the path as authored, if a leg of this type has one that can be measured.
fn from_authored(findings: &Findings, kind: &str, limit_m: f64) -> Option<(bool, String)> {
    let (farthest, max_m) = findings.farthest_from_authored(kind)?;
    let key = &farthest.passage.key;
    let text =
        format!("{kind} legs {max_m:.1} m at most from their authored path, on {key} (limit {limit_m} m)");
    Some((max_m < limit_m, text))
}

fn covered(findings: &Findings) -> (bool, String) {
    let least = findings.coverages.iter().min_by(|a, b| a.share.total_cmp(&b.share));
    match least {
        Some(least) => (
            least.share >= COVERAGE_LIMIT,
            format!(
                "{} scans, {:.2} % seen at least (limit {:.0} %)",
                findings.coverages.len(),
                least.share * 100.0,
                COVERAGE_LIMIT * 100.0
            ),
        ),
        None => (false, "nothing was scanned".into()),
    }
}

/// When, why and with which alarms it entered Safe mode, and what helps: who reads it was not there.
fn never_safe(outcome: &Outcome) -> (bool, String) {
    let Some(entered) = outcome.states.iter().find(|state| state.is_safe_mode()) else {
        return (true, "the gateway never had to enter Safe mode".into());
    };
    let Transition { time_s, to, cause, alarms } = entered;
    let alarms = match alarms.as_slice() {
        [] => "No alarm was raised then.".into(),
        raised => {
            let raised: Vec<String> =
                raised.iter().map(|alarm| format!("{}: {}", alarm.id, alarm.advice)).collect();
            format!("Alarms: {}", raised.join(" "))
        }
    };
    (false, format!("the gateway went to {to:?} at {}, for {cause}. {alarms} {REMEDY}", clock(*time_s)))
}

/// The demo's own FP Manager and waypoints are late where everything else is, too.
const REMEDY: &str = "What to do: read what came before in the list of what happened; on a busy machine fly with a lower --speed.";

fn nothing_refused(outcome: &Outcome) -> (bool, String) {
    match outcome.refusals.first() {
        Some(first) => (false, format!("{} refusals, first: {first}", outcome.refusals.len())),
        None => (true, "no waypoint and no pattern was refused".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use flight_plan::Runway;
    use usal::contract::{Alarm, GatewayState, Severity};

    fn outcome() -> Outcome {
        let threshold = LatLon::new(36.319, -84.173);
        Outcome {
            stands_at: threshold.destination(52.0, 300.0),
            on_ground: true,
            disarmed: true,
            ground_speed_mps: 0.0,
            runway: Runway {
                id: "R05".into(),
                threshold,
                elevation_amsl_m: 349.0,
                heading_deg: 52.0,
                length_m: 600.0,
                priority: 1,
                approach_entry: None,
            },
            emergency: None,
            by_hand: vec![],
            phase: Phase::Finished,
            states: [GatewayState::Stop, GatewayState::TakeOff, GatewayState::Nav].map(went_to).to_vec(),
            missing_steps: vec![],
            steps: 6,
            refusals: vec![],
        }
    }

    fn went_to(to: GatewayState) -> Transition {
        Transition { time_s: 754.0, to, cause: "the FP Manager is silent".into(), alarms: vec![] }
    }

    fn in_safe_hold(alarms: Vec<Alarm>) -> Outcome {
        let states =
            vec![went_to(GatewayState::Nav), Transition { alarms, ..went_to(GatewayState::SafeHold) }];
        Outcome { states, on_ground: false, ground_speed_mps: 22.0, phase: Phase::Flying, ..outcome() }
    }

    #[test]
    fn safe_mode_is_told_with_its_time_its_cause_its_alarms_and_what_helps() {
        let alarm = Alarm {
            id: "fp-manager-silent".into(),
            severity: Severity::Warning,
            source: "gateway".into(),
            advice: "Restart it.".into(),
            cause: None,
        };
        let (holds, text) = never_safe(&in_safe_hold(vec![alarm]));
        let told = "the gateway went to SafeHold at 12:34, for the FP Manager is silent. Alarms: fp-manager-silent: Restart it. What to do: ";
        assert!(!holds && text.starts_with(told) && text.contains("--speed"), "{text}");
        assert!(never_safe(&in_safe_hold(vec![])).1.contains("No alarm was raised then."));
    }

    #[test]
    fn a_flight_that_did_not_end_says_in_which_state_it_was() {
        let ended = in_safe_hold(vec![]);
        assert_eq!(
            finished(&ended).1,
            "the plan did not come to its end: it was Flying, with the gateway in SafeHold"
        );
        let (_, text) = landed(&ended);
        assert_eq!(
            text,
            "still moving at 22.0 m/s when it ended, with the gateway in SafeHold, not landed on R05"
        );
    }

    #[test]
    fn a_good_landing_and_bad_ones() {
        let at = |along: f64, aside: f64| {
            let good = outcome();
            let stands_at = good.runway.threshold.destination(52.0, along).destination(142.0, aside);
            landed(&Outcome { stands_at, ..good }).0
        };
        assert!(at(300.0, 0.0) && at(1.0, 29.0) && at(599.0, -29.0));
        assert!(!at(-5.0, 0.0) && !at(605.0, 0.0) && !at(300.0, 31.0) && !at(300.0, -31.0));
        assert!(!landed(&Outcome { on_ground: false, ..outcome() }).0);
        assert!(!landed(&Outcome { ground_speed_mps: 5.0, ..outcome() }).0);
        assert!(!landed(&Outcome { disarmed: false, ..outcome() }).0);
    }

    #[test]
    fn each_fault_spoils_its_own_sentence() {
        assert!(
            finished(&outcome()).0
                && scripted(&outcome()).0
                && never_safe(&outcome()).0
                && nothing_refused(&outcome()).0
        );
        assert!(!finished(&Outcome { phase: Phase::Holding, ..outcome() }).0);
        assert!(!scripted(&Outcome { missing_steps: vec!["fire out".into()], ..outcome() }).0);
        assert!(!never_safe(&in_safe_hold(vec![])).0);
        assert!(!nothing_refused(&Outcome { refusals: vec!["too steep".into()], ..outcome() }).0);
    }

    #[test]
    fn emergency_that_ended_the_flight_is_told_and_a_failure_unless_the_operator_raised_it() {
        let ended = |cause| Outcome {
            emergency: Some(("home".into(), cause)),
            by_hand: vec!["decided for close at ask".into()],
            ..outcome()
        };
        let (holds, text) = finished(&ended(Cause::Engine));
        assert!(!holds && text.contains("not flown to its end: emergency plan home"), "{text}");
        assert!(finished(&ended(Cause::Operator)).0);
    }

    #[test]
    fn what_the_operator_changed_is_not_held_against_the_flight() {
        let record = crate::report::made_up_record();
        let held = Outcome { by_hand: vec!["held the aircraft for 1:20".into()], ..outcome() };
        let verdict = verdict(&record, &Findings::default(), &held);
        assert!(verdict.iter().all(|(holds, _)| *holds), "{verdict:?}");
        let texts: Vec<&str> = verdict.iter().map(|(_, text)| text.as_str()).collect();
        assert!(
            texts.iter().any(|text| text.starts_with("not judged, for the operator took part: flown in"))
        );
        assert!(texts.contains(&"the operator took part: held the aircraft for 1:20"), "{texts:?}");
        // what has nothing to do with it is
        let refused = Outcome { refusals: vec!["too steep".into()], ..held };
        assert!(super::verdict(&record, &Findings::default(), &refused).iter().any(|(holds, _)| !*holds));
    }

    #[test]
    fn flight_that_takes_another_time_than_previewed_is_told() {
        let mut findings = Findings::of(&crate::report::made_up_record());
        assert!(on_time(&findings).0);
        for (share, holds) in [(1.029, true), (0.971, true), (1.031, false), (0.969, false)] {
            findings.passages.iter_mut().for_each(|row| row.time_s = share * row.planned_time_s.unwrap());
            let (held, text) = on_time(&findings);
            assert!(held == holds && text.contains("previewed"), "{text}");
        }
        assert!(!on_time(&Findings::default()).0, "nothing was flown");
    }

    #[test]
    fn legs_far_from_their_authored_path_are_missed_however_well_previewed() {
        let mut findings = Findings::of(&crate::report::made_up_record());
        assert_eq!(from_authored(&findings, "TF", TF_LIMIT_M), None, "no authored paths are known");
        let row = findings.passages.iter_mut().find(|p| p.passage.kind == "TF").unwrap();
        for (max_m, holds) in [(14.9, true), (15.0, false)] {
            row.from_authored = Some(crate::report::Statistics { rms_m: 1.0, p95_m: 2.0, max_m });
            let one = Findings { passages: vec![row.clone()], ..Findings::default() };
            let (held, text) = from_authored(&one, "TF", TF_LIMIT_M).unwrap();
            assert!(held == holds && text.contains(&row.passage.key.leg), "{text}");
        }
    }

    #[test]
    fn legs_that_were_planned_but_not_flown_are_missed_and_no_others() {
        let record = crate::report::made_up_record();
        let failed: Vec<String> = verdict(&record, &Findings::default(), &outcome())
            .into_iter()
            .filter_map(|(holds, text)| (!holds).then_some(text))
            .collect();
        assert_eq!(failed.len(), 3, "{failed:?}");
        assert!(failed[0].starts_with("flown in 0:00"), "{failed:?}");
        assert_eq!(failed[1..], ["no TF leg was flown", "nothing was scanned"]);
    }
}
