//! Every value of the plan and the executor is the same value on the wire: it comes back as it went, and both sides are the same
//! JSON and the same CBOR, to the byte.
#![cfg(test)]

use contract::{LatLon, PlanEvent};
use flight_exec::{
    Action, BranchOption, Branching, Command, DecisionRequest, EntryReport, Event, Foresight, IterationPlace,
    PathPoint, Phase, PlacePointer, ProposalReport, Refusal, ResolvedAct, Status, Token, Waypoint,
};
use flight_plan::{Cause, Id, VariableValue};
use schemars::{JsonSchema, schema_for};
use serde::Serialize;
use std::collections::BTreeSet;
use std::fmt::Debug;
use std::sync::Arc;
use wire::Convert;

/// Rounds with other numbers and texts in every field; more of them as of other crates' random tests.
fn rounds() -> u64 {
    std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(100)
}

/// Values that differ from field to field and from round to round (the constants are SplitMix64's).
struct Source(u64);

impl Source {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    fn bool(&mut self) -> bool {
        self.bits().is_multiple_of(2)
    }

    fn whole(&mut self) -> u64 {
        let extremes = [0, 1, u64::MAX];
        let bits = self.bits();
        extremes.get((bits % 20) as usize).copied().unwrap_or(bits >> (bits % 64))
    }

    fn small(&mut self) -> usize {
        (self.bits() % 1000) as usize
    }

    fn number(&mut self) -> f64 {
        let extremes = [0.0, -0.0, f64::MAX, f64::MIN_POSITIVE, -1.0];
        let bits = self.bits();
        extremes.get((bits % 30) as usize).copied().unwrap_or((bits as f64 / 1e15) - 9_000.0)
    }

    fn text(&mut self) -> String {
        let length = self.small() % 40;
        (0..length).map(|_| ['a', 'Z', '-', '9', '"', '\\', 'ü', '\u{1F525}'][self.small() % 8]).collect()
    }

    fn shared(&mut self) -> Arc<str> {
        self.text().into()
    }

    fn id(&mut self) -> Id {
        Id::new(&self.text())
    }

    fn at(&mut self) -> LatLon {
        LatLon::new(self.number(), self.number())
    }

    fn token(&mut self) -> Token {
        Token(self.whole())
    }

    fn maybe<T>(&mut self, value: impl FnOnce(&mut Self) -> T) -> Option<T> {
        self.bool().then(|| value(self))
    }

    fn some<T>(&mut self, mut value: impl FnMut(&mut Self) -> T) -> Vec<T> {
        (0..self.small() % 4).map(|_| value(self)).collect()
    }

    fn one<T>(&mut self, all: fn(&mut Self) -> Vec<T>) -> T {
        let mut all = all(self);
        let index = self.small() % all.len();
        all.swap_remove(index)
    }
}

fn causes(_: &mut Source) -> Vec<Cause> {
    vec![
        Cause::Operator,
        Cause::Payload,
        Cause::Traffic,
        Cause::Link,
        Cause::Gps,
        Cause::Energy,
        Cause::Engine,
    ]
}

fn values(s: &mut Source) -> Vec<VariableValue> {
    vec![
        VariableValue::Bool(s.bool()),
        VariableValue::Number(s.number()),
        VariableValue::Text(s.text()),
        VariableValue::Position(s.at()),
        VariableValue::Polygon(s.some(Source::at)),
    ]
}

fn actions(s: &mut Source) -> Vec<Action> {
    vec![
        Action::TakeOff { heading_deg: s.number() },
        Action::Fly,
        Action::Loiter { radius_m: s.number() },
        Action::Land { heading_deg: s.number() },
    ]
}

fn waypoint(s: &mut Source) -> Waypoint {
    Waypoint {
        token: s.token(),
        position: s.at(),
        altitude_amsl_m: s.number(),
        airspeed_mps: s.number(),
        action: s.one(actions),
        fly_over: s.bool(),
        on_arc: s.bool(),
        leg: s.id(),
        end_of_plan: s.bool(),
    }
}

fn commands(s: &mut Source) -> Vec<Command> {
    vec![
        Command::Start,
        Command::Hold,
        Command::Resume,
        Command::SkipLeg,
        Command::GoTo { leg: s.id() },
        Command::SetCount { leg: s.id(), count: s.whole() },
        Command::Decide { leg: s.id(), branch: s.id() },
        Command::SetVariable { name: s.id(), value: s.one(values) },
        Command::Emergency { cause: s.one(causes), plan: s.maybe(Source::id) },
        Command::ReturnToMain { leg: s.id() },
        Command::AbortToSafe,
        Command::Rewind,
        Command::Commit { hash: s.shared(), entry: s.maybe(Source::id) },
    ]
}

fn phases(_: &mut Source) -> Vec<Phase> {
    vec![
        Phase::Idle,
        Phase::Flying,
        Phase::Holding,
        Phase::AwaitingDecision,
        Phase::Finished,
        Phase::Grounded,
    ]
}

fn branchings(s: &mut Source) -> Vec<Branching> {
    vec![Branching::Main, Branching::Emergency(s.id())]
}

fn iteration(s: &mut Source) -> IterationPlace {
    IterationPlace { leg: s.id(), iteration: s.whole(), of: s.maybe(Source::whole), reverse: s.bool() }
}

fn place(s: &mut Source) -> PlacePointer {
    PlacePointer {
        plan: s.one(branchings),
        stage: s.id(),
        leg: s.id(),
        iterations: s.some(iteration),
        reverse: s.bool(),
        distance_m: s.number(),
    }
}

fn decision(s: &mut Source) -> DecisionRequest {
    let option =
        |s: &mut Source| BranchOption { branch: s.id(), label: s.text(), preview: s.some(Source::at) };
    DecisionRequest {
        leg: s.id(),
        options: s.some(option),
        default: s.maybe(Source::id),
        distance_left_m: s.number(),
        time_left_s: s.number(),
    }
}

fn status(s: &mut Source) -> Status {
    Status {
        phase: s.one(phases),
        plan: s.maybe(Source::shared),
        revision: s.whole(),
        place: s.maybe(place),
        emergency: s.maybe(Source::id),
        emergency_in_force: s.maybe(Source::id),
        current: s.maybe(Source::token),
        outstanding: s.small(),
        decision: s.maybe(decision),
        proposed: s.maybe(Source::shared),
        wait_left_s: s.maybe(Source::number),
    }
}

fn report(s: &mut Source) -> ProposalReport {
    let entry =
        |s: &mut Source| EntryReport { leg: s.id(), position: s.at(), in_m: s.number(), in_s: s.number() };
    ProposalReport {
        hash: s.shared(),
        acceptable: s.bool(),
        problems: s.some(Source::text),
        added: s.some(Source::id),
        removed: s.some(Source::id),
        changed: s.some(Source::id),
        unchanged: s.small(),
        next_leg: s.maybe(Source::id),
        next_position: s.maybe(Source::at),
        next_in_m: s.maybe(Source::number),
        next_in_s: s.maybe(Source::number),
        differs_in_m: s.maybe(Source::number),
        differs_in_s: s.maybe(Source::number),
        entry_needed: s.bool(),
        entries: s.some(entry),
    }
}

fn foresight(s: &mut Source) -> Foresight {
    let point =
        |s: &mut Source| PathPoint { time_s: s.number(), position: s.at(), altitude_amsl_m: s.number() };
    Foresight {
        path: s.some(point),
        next_leg: s.maybe(Source::id),
        left_out: s.some(Source::id),
        short_of_altitude_m: s.maybe(Source::number),
        clearance_m: s.maybe(Source::number),
        problems: s.some(Source::text),
        time_s: s.number(),
        distance_m: s.number(),
        battery_left: s.number(),
        landed: s.bool(),
        cut_short: s.maybe(Source::text),
    }
}

fn acts(s: &mut Source) -> Vec<ResolvedAct> {
    vec![
        ResolvedAct::Photo,
        ResolvedAct::PhotoSeries { every_m: s.number() },
        ResolvedAct::PhotoStop,
        ResolvedAct::VideoStart,
        ResolvedAct::VideoStop,
        ResolvedAct::Set { variable: s.id(), value: s.one(values) },
        ResolvedAct::Invoke { service: s.text(), operation: s.text(), argument: s.text() },
        ResolvedAct::Wait { seconds: s.number() },
    ]
}

fn events(s: &mut Source) -> Vec<Event> {
    vec![
        Event::LegEntered { place: place(s) },
        Event::IterationFinished { leg: s.id(), finished: s.whole(), of: s.maybe(Source::whole) },
        Event::DecisionRequested(decision(s)),
        Event::DecisionTaken { leg: s.id(), branch: s.id(), by: s.text() },
        Event::VariableChanged { name: s.id(), value: s.one(values), by: s.shared() },
        Event::ActionDone { leg: s.id(), passage: s.whole(), act: s.one(acts) },
        Event::ActionRefused { leg: s.id(), passage: s.whole(), reason: s.text() },
        Event::PatternRefused { leg: s.id(), reason: s.text() },
        Event::ExpressionFailed { leg: s.id(), reason: s.text() },
        Event::PlanActivated { hash: s.shared(), revision: s.whole() },
        Event::EmergencyStarted { cause: s.one(causes), plan: s.id(), from_leg: s.maybe(Source::id) },
        Event::EmergencyUnanswered {
            cause: s.one(causes),
            plan: s.maybe(Source::id),
            code: s.text(),
            reason: s.text(),
        },
        Event::PhaseChanged { phase: s.one(phases) },
        Event::WaypointsRejected { leg: s.maybe(Source::id), reason: s.text() },
        Event::ProblemAhead { leg: s.maybe(Source::id), code: s.text(), reason: s.text() },
        Event::NotGranted { request: s.text(), reason: s.text() },
        Event::NotJournalled { reason: s.text() },
        Event::Journalled,
    ]
}

/// Each value in both vocabularies, there and back.
fn check<D, W>(values: impl Fn(&mut Source) -> Vec<D>)
where
    D: Convert<W> + Serialize + Clone + PartialEq + Debug,
    W: Convert<D> + Serialize + Clone + PartialEq + Debug,
{
    for round in 0..rounds() {
        for domain in values(&mut Source(round)) {
            let wire: W = domain.clone().convert();
            assert_eq!(
                serde_json::to_vec(&domain).unwrap(),
                serde_json::to_vec(&wire).unwrap(),
                "{domain:?}"
            );
            assert_eq!(cbor(&domain), cbor(&wire), "{domain:?}");
            let back: D = wire.clone().convert();
            assert_eq!(back, domain);
            let again: W = back.convert();
            assert_eq!(again, wire);
        }
    }
}

fn cbor<T: Serialize>(value: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    ciborium::into_writer(value, &mut bytes).unwrap();
    bytes
}

/// The list has each variant that the schema of the wire type knows, once.
fn check_all<D, W>(values: fn(&mut Source) -> Vec<D>)
where
    D: Convert<W> + Serialize + Clone + PartialEq + Debug,
    W: Convert<D> + Serialize + Clone + PartialEq + Debug + JsonSchema,
{
    let listed = values(&mut Source(0));
    let kinds: BTreeSet<String> = listed.iter().map(|v| format!("{:?}", std::mem::discriminant(v))).collect();
    assert_eq!(kinds.len(), listed.len(), "a variant is listed twice: {listed:?}");
    assert_eq!(listed.len(), variants::<W>(), "a variant is missing: {listed:?}");
    check(values);
}

/// Variants of an enum: its schema lists plain ones together, the others one by one.
fn variants<W: JsonSchema>() -> usize {
    let schema = schema_for!(W).to_value();
    let plain = |schema: &serde_json::Value| schema["enum"].as_array().map_or(1, Vec::len);
    match schema["oneOf"].as_array() {
        Some(several) => several.iter().map(plain).sum(),
        None => plain(&schema),
    }
}

#[test]
fn commands_and_their_refusals() {
    check_all::<_, contract::Command>(commands);
    check::<_, contract::Refusal>(|s| vec![Refusal { code: s.text(), reason: s.text() }]);
    check_all::<_, contract::VariableValue>(values);
    check_all::<_, contract::Cause>(causes);
    check::<_, contract::Id>(|s| vec![s.id()]);
}

#[test]
fn events_and_what_they_are_about() {
    check_all::<_, PlanEvent>(events);
    check_all::<_, contract::ResolvedAct>(acts);
    check_all::<_, contract::Phase>(phases);
}

#[test]
fn status_and_places() {
    check::<_, contract::PlanStatus>(|s| vec![status(s)]);
    check::<_, contract::PlacePointer>(|s| vec![place(s)]);
    check_all::<_, contract::Branching>(branchings);
    check::<_, contract::DecisionRequest>(|s| vec![decision(s)]);
}

#[test]
fn waypoints_and_reports() {
    check::<_, contract::Waypoint>(|s| vec![waypoint(s)]);
    check_all::<_, contract::Action>(actions);
    check::<_, contract::Token>(|s| vec![s.token()]);
    check::<_, contract::ProposalReport>(|s| vec![report(s)]);
    check::<_, contract::Foresight>(|s| vec![foresight(s)]);
}

#[test]
fn lists_absent_values_and_times_are_converted_along() {
    let listed: Vec<contract::Waypoint> = vec![waypoint(&mut Source(1)), waypoint(&mut Source(2))].convert();
    assert_eq!(listed.len(), 2);
    let absent: Option<contract::Token> = None::<Token>.convert();
    assert_eq!(absent, None);
    let refused: Result<contract::Token, contract::Refusal> =
        Err::<Token, _>(Refusal { code: "a".into(), reason: "b".into() }).convert();
    assert_eq!(refused.unwrap_err().to_string(), "a: b");
    let stamped = contract::Stamped { time_s: 1.0, validity_s: 2.0, value: Event::Journalled };
    let told: contract::FpManagerEvent = stamped.convert();
    assert_eq!(told, contract::Stamped { time_s: 1.0, validity_s: 2.0, value: PlanEvent::Journalled });
}
