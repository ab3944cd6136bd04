//! Random plans and random inputs; what must hold whatever happens.

use crate::rig::{Rig, document_with, program};
use flight_exec::{Command, Config, Event, Executor, Input, Phase, Time, Token};
use flight_plan::{Cause, VariableValue};
use proptest::prelude::*;
use std::sync::Arc;

const VARIABLES: &str = r#"<variable name="r" type="number" initial="500" min="10" max="1500"/>
    <variable name="stop" type="bool" initial="false"/>"#;

/// A leg without a name; lists give them theirs.
#[derive(Debug, Clone)]
enum Kind {
    Track(&'static str),
    Direct(&'static str),
    Holding,
    Scan,
    Orbit,
    Loop { reverse: bool, count: u64, until: bool, body: Vec<Kind> },
    Fork { default: bool },
}

fn leaf() -> impl Strategy<Value = Kind> {
    prop_oneof![
        4 => prop::sample::select(vec!["A2", "B3", "C2", "D4", "B5"]).prop_map(Kind::Track),
        1 => prop::sample::select(vec!["A3", "C4"]).prop_map(Kind::Direct),
        1 => Just(Kind::Holding),
        1 => Just(Kind::Scan),
        1 => Just(Kind::Orbit),
        1 => any::<bool>().prop_map(|default| Kind::Fork { default }),
    ]
}

fn legs() -> impl Strategy<Value = Vec<Kind>> {
    let kind = leaf().prop_recursive(2, 12, 4, |inner| {
        (any::<bool>(), 1..4u64, any::<bool>(), prop::collection::vec(inner, 1..4))
            .prop_map(|(reverse, count, until, body)| Kind::Loop { reverse, count, until, body })
    });
    prop::collection::vec(kind, 1..5)
}

fn write(legs: &[Kind], prefix: &str) -> String {
    let one = |(i, kind): (usize, &Kind)| {
        let id = format!("{prefix}{i}");
        match kind {
            Kind::Track(fix) => format!(r#"<TF id="{id}" fix="{fix}"/>"#),
            Kind::Direct(fix) => format!(r#"<DF id="{id}" fix="{fix}"/>"#),
            Kind::Holding => format!(r#"<HF id="{id}" fix="B2" course="0" turn="left" length="600"/>"#),
            Kind::Scan => format!(
                r#"<scan id="{id}" spacing="250" heading="0" overshoot="50"><area fix="C3" radius="= r"/></scan>"#
            ),
            Kind::Orbit => {
                format!(r#"<orbit id="{id}" radius="300" turns="1" turn="left"><centre fix="D2"/></orbit>"#)
            }
            Kind::Loop { reverse, count, until, body } => {
                let form = if *reverse { "reverse" } else { "forward" };
                let until = if *until { r#" until="stop""# } else { "" };
                let body = write(body, &format!("{id}-"));
                format!(r#"<iterative id="{id}" form="{form}" count="{count}"{until}>{body}</iterative>"#)
            }
            Kind::Fork { default } => {
                let default = if *default { format!(r#" default="{id}-s""#) } else { String::new() };
                format!(
                    r#"<intersection id="{id}"{default} decideBefore="200m">
                       <branch id="{id}-s" label="s" next="{id}-e"/><branch id="{id}-l" label="l" next="{id}-d" when="r &gt; 900.0"/></intersection>
                       <TF id="{id}-d" fix="E2"/><TF id="{id}-e" fix="A4"/>"#
                )
            }
        }
    };
    // a track at each end: every body flies something
    let body: String = legs.iter().enumerate().map(one).collect();
    format!(r#"<TF id="{prefix}s" fix="B1"/>{body}<TF id="{prefix}z" fix="D3"/>"#)
}

#[derive(Debug, Clone)]
enum Happening {
    Fly(usize),
    Set(f64),
    Stop(bool),
    Hold,
    Resume,
    Skip,
    GoTo(usize),
    Emergency(u8),
    Return(usize),
    Decide(usize, bool),
    Count(u64),
    Update,
    Reject(usize),
    Control,
    Wait(u64),
    Kill,
}

fn happening() -> impl Strategy<Value = Happening> {
    use Happening as H;
    prop_oneof![
        8 => (1..12usize).prop_map(H::Fly),
        2 => (0.0..1600.0f64).prop_map(H::Set),
        1 => any::<bool>().prop_map(H::Stop),
        1 => Just(H::Hold),
        2 => Just(H::Resume),
        1 => Just(H::Skip),
        1 => (0..40usize).prop_map(H::GoTo),
        1 => (0..7u8).prop_map(H::Emergency),
        1 => (0..40usize).prop_map(H::Return),
        1 => (0..40usize, any::<bool>()).prop_map(|(i, b)| H::Decide(i, b)),
        1 => (0..5u64).prop_map(H::Count),
        1 => Just(H::Update),
        1 => (0..5usize).prop_map(H::Reject),
        1 => Just(H::Control),
        1 => (0..5000u64).prop_map(H::Wait),
        1 => Just(H::Kill),
    ]
}

struct Flight {
    rig: Rig,
    ids: Vec<flight_plan::Id>,
    plans: [Arc<flight_plan::Program>; 2],
    active: usize,
}

impl Flight {
    fn happen(&mut self, what: &Happening) {
        let causes = [
            Cause::Operator,
            Cause::Payload,
            Cause::Traffic,
            Cause::Link,
            Cause::Gps,
            Cause::Energy,
            Cause::Engine,
        ];
        let id = |i: usize| self.ids[i % self.ids.len()].clone();
        let command = match what {
            Happening::Fly(n) => return self.fly(*n),
            Happening::Set(r) => Command::SetVariable { name: "r".into(), value: VariableValue::Number(*r) },
            Happening::Stop(b) => {
                Command::SetVariable { name: "stop".into(), value: VariableValue::Bool(*b) }
            }
            Happening::Hold => Command::Hold,
            Happening::Resume => Command::Resume,
            Happening::Skip => Command::SkipLeg,
            Happening::GoTo(i) => Command::GoTo { leg: id(*i) },
            Happening::Emergency(c) => Command::Emergency { cause: causes[usize::from(*c)], plan: None },
            Happening::Return(i) => Command::ReturnToMain { leg: id(*i) },
            Happening::Decide(i, straight) => {
                let leg = id(*i);
                let branch = format!("{leg}-{}", if *straight { "s" } else { "l" });
                Command::Decide { leg, branch: branch.as_str().into() }
            }
            Happening::Count(count) => Command::SetCount { leg: id(*count as usize), count: *count },
            Happening::Update => return self.update(),
            Happening::Reject(i) => return self.reject(*i),
            Happening::Control => return self.control(),
            Happening::Wait(ms) => {
                self.rig.now += Time::from_millis(*ms);
                self.rig.report();
                return;
            }
            Happening::Kill => return self.kill(),
        };
        let _ = self.rig.command(command);
    }

    fn fly(&mut self, waypoints: usize) {
        for _ in 0..waypoints {
            if self.rig.executor.status().phase == Phase::Holding || !self.rig.fly_one() {
                break;
            }
        }
    }

    fn update(&mut self) {
        self.active = 1 - self.active;
        let program = self.plans[self.active].clone();
        self.rig.propose(&program);
        let entry = Some("z".into());
        if self.rig.command(Command::Commit { hash: program.hash.clone(), entry: None }).is_err() {
            self.rig.command(Command::Commit { hash: program.hash.clone(), entry }).unwrap();
        }
    }

    /// The gateway refuses the end of its buffer, as if it had just been sent.
    fn reject(&mut self, keep: usize) {
        let keep = keep.max(1);
        if let Some(first) = self.rig.buffer.get(keep).map(|w| w.token) {
            self.rig.buffer.truncate(keep);
            self.rig.step(Input::Rejected { first, reason: "no".into() });
        }
    }

    /// Safe mode for a moment: the gateway forgets its buffer.
    fn control(&mut self) {
        self.rig.step(Input::GatewayControls(true));
        self.rig.buffer.clear();
        self.rig.now += Time::from_secs(5);
        self.rig.report();
        self.rig.step(Input::GatewayControls(false));
    }

    fn kill(&mut self) {
        let mut bytes = Vec::new();
        ciborium::into_writer(&self.rig.executor.snapshot(), &mut bytes).unwrap();
        let snapshot = ciborium::from_reader(bytes.as_slice()).unwrap();
        let terrain = Arc::new(terrain::Flat(crate::rig::GROUND_M));
        let (profile, plan) = (aircraft::Profile::default(), self.rig.executor.program().cloned());
        let before = self.rig.executor.status();
        let restored = Executor::restore(Config::default(), terrain, profile, plan, snapshot).unwrap();
        self.rig.executor = restored;
        let proposed = None;
        assert_eq!(self.rig.executor.status(), flight_exec::Status { proposed, ..before });
    }

    /// What the executor believes is ahead is what the gateway has.
    fn check(&self) {
        let status = self.rig.executor.status();
        if matches!(status.phase, Phase::Flying | Phase::AwaitingDecision) {
            let ahead: Vec<Token> = self.rig.executor.ahead().map(|w| w.token).collect();
            let buffer: Vec<Token> = self.rig.buffer.iter().map(|w| w.token).collect();
            assert_eq!(ahead, buffer);
            assert!(!buffer.is_empty(), "dry while flying");
            let ends = self.rig.buffer.iter().filter(|w| w.end_of_plan).count();
            assert!(ends <= 1 && self.rig.buffer.iter().rev().skip(1).all(|w| !w.end_of_plan));
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, max_shrink_iters: 200, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happens(kinds in legs(), changed in legs(), happenings in prop::collection::vec(happening(), 0..40)) {
        let text = |kinds: &[Kind]| document_with(&write(kinds, ""), VARIABLES, "");
        let plans = [program(&text(&kinds)), program(&text(&changed))];
        let ids = plans.iter().flat_map(|p| p.plan.all_legs().into_iter().map(|c| c.leg.id.clone()).collect::<Vec<_>>()).collect();
        let mut flight = Flight { rig: Rig::flying(&text(&kinds)), ids, plans, active: 0 };
        for what in &happenings {
            flight.happen(what);
            flight.check();
        }
    }

    /// Undisturbed, each pass is flown once and counted once.
    #[test]
    fn no_iteration_is_lost_or_doubled(kinds in legs()) {
        let kinds = with_defaults(kinds);
        let mut rig = Rig::flying(&document_with(&write(&kinds, ""), VARIABLES, ""));
        rig.fly_to_the_end();
        let mut finished: Vec<(String, u64)> = Vec::new();
        for event in &rig.events {
            if let Event::IterationFinished { leg, finished: n, of } = event {
                let last = finished.iter().rev().find(|(l, _)| l == leg.as_str()).map_or(0, |(_, n)| *n);
                prop_assert!(*n == last + 1 || *n == 1, "{leg}: {n} after {last}");
                if *n == 1 && last > 0 {
                    prop_assert_eq!(Some(last), *of, "left before its count");
                }
                finished.push((leg.to_string(), *n));
            }
        }
        let passages = rig.events.iter().filter(|e| matches!(e, Event::LegEntered { .. })).count();
        let changes = rig.flown.windows(2).filter(|w| w[0].leg != w[1].leg).count();
        prop_assert!(passages > changes, "{passages} entries, {changes} changes of leg");
    }
}

fn with_defaults(kinds: Vec<Kind>) -> Vec<Kind> {
    let given = |kind| match kind {
        Kind::Fork { .. } => Kind::Fork { default: true },
        Kind::Loop { reverse, count, body, .. } => {
            Kind::Loop { reverse, count, until: false, body: with_defaults(body) }
        }
        other => other,
    };
    kinds.into_iter().map(given).collect()
}
