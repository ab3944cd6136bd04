//! What happened, in sentences.

use super::Names;
use flight_exec::{Event, Phase};
use flight_plan::{Id, VariableValue};
use std::collections::VecDeque;
use usal::contract::{GatewayEvent, GatewayRequest, Severity};

/// How much a line matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Level {
    /// For information.
    Info,
    /// Needs attention.
    Caution,
    /// Needs action.
    Warning,
}

impl From<Severity> for Level {
    fn from(severity: Severity) -> Self {
        match severity {
            Severity::Advisory => Self::Info,
            Severity::Caution => Self::Caution,
            Severity::Warning => Self::Warning,
        }
    }
}

/// A line of the log.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// When, seconds of the window's clock.
    pub time_s: f64,
    /// How much it matters.
    pub level: Level,
    /// Who says so.
    pub source: &'static str,
    /// What happened.
    pub text: String,
    /// How often, without a break.
    pub times: u32,
}

/// The latest lines, newest last.
#[derive(Debug, Default)]
pub struct Log {
    lines: VecDeque<Line>,
}

/// Most lines kept.
const CAPACITY: usize = 2000;
/// Longest text kept of one line, characters.
const LONGEST: usize = 400;

impl Log {
    /// Adds a line; one like the last only counts it up.
    pub fn add(&mut self, time_s: f64, level: Level, source: &'static str, text: &str) {
        let text: String = flight_plan::legible(text).chars().take(LONGEST).collect();
        if let Some(last) = self.lines.back_mut().filter(|l| l.text == text && l.source == source) {
            last.times = last.times.saturating_add(1);
            last.time_s = time_s;
            return;
        }
        if self.lines.len() >= CAPACITY {
            self.lines.pop_front();
        }
        self.lines.push_back(Line { time_s, level, source, text, times: 1 });
    }
    /// How many lines there are.
    pub fn len(&self) -> usize {
        self.lines.len()
    }
    /// Nothing happened yet.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }
    /// Every line, the oldest first.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Line> {
        self.lines.iter()
    }
    /// A line, counted from the newest.
    pub fn from_newest(&self, index: usize) -> Option<&Line> {
        self.lines.get(self.lines.len().checked_sub(index + 1)?)
    }
}

/// The lines of two logs, the newest first.
pub fn merged<'a>(a: &'a Log, b: &'a Log) -> Vec<&'a Line> {
    let (mut a, mut b) = (a.iter().rev().peekable(), b.iter().rev().peekable());
    std::iter::from_fn(|| match (a.peek(), b.peek()) {
        (Some(of_a), Some(of_b)) if of_a.time_s < of_b.time_s => b.next(),
        (Some(_), _) => a.next(),
        (None, _) => b.next(),
    })
    .collect()
}

/// Who decided, where nobody did.
const BY_DEFAULT: &str = "default";

/// What nobody must miss, also who looked elsewhere when it happened, as `said` or in words of its own.
pub fn announced(event: &Event, said: String, names: Names<'_>) -> Option<String> {
    if let Event::ProblemAhead { reason, .. } = event {
        return is_of_glide(event).then(|| names.told(reason));
    }
    let is_announced = matches!(event, Event::DecisionTaken { by, .. } if by == BY_DEFAULT)
        || matches!(event, Event::PhaseChanged { phase: Phase::AwaitingDecision | Phase::Grounded })
        || is_refusal(event);
    is_announced.then_some(said)
}

/// Without an engine it does not come to its runway as planned: the last that was said of it counts.
pub fn is_of_glide(event: &Event) -> bool {
    matches!(event, Event::ProblemAhead { code, .. } if GLIDE.contains(&code.as_str()))
}

/// As the executor says it in flight. What a review says of glides is told among the problems.
const GLIDE: [&str; 2] = ["glide-shortened", "glide-long"];

/// What somebody asked for is not done after all. Of reports that do not count there is an alarm.
fn is_refusal(event: &Event) -> bool {
    matches!(event, Event::NotGranted { request, .. } if request != "report")
}

/// The aircraft does not take off after all, though the start was accepted.
pub fn is_no_start(event: &Event) -> bool {
    matches!(event, Event::NotGranted { request, .. } if request == GatewayRequest::Launch.name())
}

/// It lies on the ground: where it would come down is told no more.
pub fn ends_a_flight(event: &Event) -> bool {
    matches!(event, Event::PhaseChanged { phase: Phase::Finished | Phase::Idle })
}

/// Another start was accepted, or it took off: what was said of one that came to nothing is over. Whoever joins late hears all of it again.
pub fn is_of_a_start(event: &Event) -> bool {
    matches!(event, Event::PhaseChanged { phase: Phase::Flying } | Event::LegEntered { .. })
}

/// What is announced of a start that came to nothing.
pub fn says_no_start(text: &str) -> bool {
    text.starts_with(NOT_STARTED)
}

const NOT_STARTED: &str = "Not started: ";

/// A plan event as a sentence.
pub fn plan_event(event: &Event, names: Names<'_>) -> (Level, String) {
    let info = |text: String| (Level::Info, text);
    let name = |id: &Id| names.of(id);
    match event {
        Event::LegEntered { place } => info(entered(&place.leg, &place.stage, names)),
        Event::IterationFinished { leg, finished, of } => info(format!(
            "Loop {}: pass {finished}{} done",
            name(leg),
            of.map(|n| format!(" of {n}")).unwrap_or_default()
        )),
        Event::DecisionRequested(d) => {
            (Level::Caution, format!("Decision asked for at {}: {} choices", name(&d.leg), d.options.len()))
        }
        Event::DecisionTaken { leg, branch, by } => decided(leg, branch, by, names),
        Event::VariableChanged { name, value, by } => {
            info(format!("{name} is now {}, written by {by}", variable(value)))
        }
        Event::ActionDone { leg, act, .. } => info(format!("{}: {act}", name(leg))),
        Event::ActionRefused { leg, reason, .. } => {
            (Level::Caution, format!("{}: an action was not done: {reason}", name(leg)))
        }
        Event::ExpressionFailed { leg, reason } => {
            (Level::Caution, format!("{}: an expression has no value: {reason}", name(leg)))
        }
        Event::PatternRefused { leg, reason } => {
            (Level::Caution, format!("{} keeps its old pattern: {reason}", name(leg)))
        }
        Event::PlanActivated { hash, revision } => {
            info(format!("Plan {} is active, revision {revision}", short_hash(hash)))
        }
        Event::EmergencyStarted { cause, plan, .. } => {
            (Level::Warning, format!("Emergency plan {} is being flown ({cause:?})", name(plan)))
        }
        Event::EmergencyUnanswered { cause, plan: Some(plan), reason, .. } => {
            (Level::Warning, format!("{} is not flown ({cause:?}): {reason}", name(plan)))
        }
        Event::EmergencyUnanswered { cause, plan: None, .. } => {
            (Level::Warning, format!("No emergency plan for {cause:?}: Safe mode decides"))
        }
        Event::PhaseChanged { phase: Phase::AwaitingDecision } => {
            (Level::Caution, "Nobody decided in time: the aircraft circles until somebody does".to_owned())
        }
        Event::PhaseChanged { phase: Phase::Grounded } => {
            (Level::Caution, "Landed: the plan goes on with its next flight when it is started".to_owned())
        }
        Event::PhaseChanged { phase } => info(format!("Phase: {phase:?}")),
        Event::WaypointsRejected { leg, reason } => {
            let leg = leg.as_ref().map(|l| format!(" of {}", name(l))).unwrap_or_default();
            (Level::Warning, format!("Waypoints{leg} were refused: {reason}"))
        }
        Event::ProblemAhead { leg, code, reason } => {
            let leg = leg.as_ref().map(|leg| format!("{leg}: ")).unwrap_or_default();
            // as problems are displayed: whoever shows it puts words and names in the place of that
            (Level::Warning, format!("The way ahead has a problem: warning [{code}] {leg}{reason}"))
        }
        Event::NotGranted { reason, .. } if is_no_start(event) => {
            (Level::Caution, format!("{NOT_STARTED}{reason}"))
        }
        Event::NotGranted { request, reason } => {
            (Level::Caution, format!("The gateway does not grant `{request}`: {reason}"))
        }
        Event::NotJournalled { reason } => (Level::Caution, format!("The flight is not recorded: {reason}")),
        Event::Journalled => info("The flight is recorded again".to_owned()),
    }
}

/// A stage that is flown without legs is its own leg.
fn entered(leg: &Id, stage: &Id, names: Names<'_>) -> String {
    let of = names.of(stage);
    if leg == stage { format!("Stage {of}") } else { format!("Leg {} of stage {of}", names.of(leg)) }
}

fn decided(leg: &Id, branch: &Id, by: &str, names: Names<'_>) -> (Level, String) {
    let (fork, way) = (names.of(leg), names.of_branch(leg, branch));
    if by == BY_DEFAULT {
        return (Level::Caution, format!("Nobody decided at {fork} in time: {way} was taken by default"));
    }
    (Level::Info, format!("{fork}: branch {way}, decided by {by}"))
}

/// A gateway event as a sentence; `None` for what would only fill the log.
pub fn gateway_event(event: &GatewayEvent) -> Option<(Level, String)> {
    match event {
        GatewayEvent::StateChanged { from, to, cause } => {
            Some((Level::Info, format!("Gateway: {from:?} to {to:?}, {cause}")))
        }
        // the FP Manager tells it
        GatewayEvent::Progress { .. } | GatewayEvent::NotLaunched { .. } => None,
        GatewayEvent::NotDone { request, reason } => {
            Some((Level::Warning, format!("Granted in the climb, `{request}` is not done: {reason}")))
        }
        GatewayEvent::BufferLow { waypoints, seconds } => {
            Some((Level::Caution, format!("Buffer low: {waypoints} waypoints, {seconds:.0} s")))
        }
        GatewayEvent::AlarmRaised(alarm) => {
            Some((alarm.severity.into(), format!("{}: {}", alarm.id, alarm.advice)))
        }
        GatewayEvent::AlarmCleared { id } => Some((Level::Info, format!("{id}: cleared"))),
    }
}

/// A variable's value as text.
pub fn variable(value: &VariableValue) -> String {
    match value {
        VariableValue::Bool(b) => flight_plan::words::yes_or_no(*b).to_owned(),
        VariableValue::Number(n) => n.to_string(),
        VariableValue::Text(t) => t.clone(),
        VariableValue::Position(p) => crate::units::position(*p),
        VariableValue::Polygon(corners) => format!("a polygon of {} corners", corners.len()),
    }
}

/// Enough of a hash to tell plans apart.
pub fn short_hash(hash: &str) -> String {
    hash.chars().take(7).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_are_told_by_names() {
        let legs = r#"<TF id="n1" name="To the ridge" lat="36.3" lon="-84.1"/><intersection id="ask" default="n1">
            <branch id="n1" label="Over the ridge"/><branch id="n2"/></intersection>"#;
        let text = format!(
            r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan><stage id="home" type="mission">{legs}</stage></mainPlan></flightPlan>"#
        );
        let plan = flight_plan::read(text).plan;
        let names = Names(Some(&plan));
        let event = Event::IterationFinished { leg: "n1".into(), finished: 1, of: Some(2) };
        assert_eq!(plan_event(&event, names).1, "Loop To the ridge: pass 1 of 2 done");
        assert_eq!(plan_event(&event, Names(None)).1, "Loop n1: pass 1 of 2 done");
        assert_eq!(entered(&"n1".into(), &"home".into(), names), "Leg To the ridge of stage Mission");
        assert_eq!(entered(&"n1".into(), &"n1".into(), names), "Stage To the ridge");
        // a branch may be called as a leg is
        for (by, told) in [
            (BY_DEFAULT, "Nobody decided at ask in time: Over the ridge was taken by default"),
            ("gcs", "ask: branch Over the ridge, decided by gcs"),
        ] {
            let taken = Event::DecisionTaken { leg: "ask".into(), branch: "n1".into(), by: by.into() };
            assert_eq!(plan_event(&taken, names).1, told);
        }
    }

    #[test]
    fn what_the_gateway_granted_and_does_not_do_is_told() {
        let event = GatewayEvent::NotDone { request: "direct".into(), reason: "too low".into() };
        let told = "Granted in the climb, `direct` is not done: too low".to_owned();
        assert_eq!(gateway_event(&event), Some((Level::Warning, told)));
    }

    #[test]
    fn two_logs_are_one_by_time() {
        let (mut a, mut b) = (Log::default(), Log::default());
        for (log, time_s) in [(&mut a, 1.0), (&mut b, 2.0)] {
            log.add(time_s, Level::Info, "x", &format!("{time_s}"));
            log.add(time_s + 2.0, Level::Info, "x", &format!("{}", time_s + 2.0));
        }
        let texts = |a, b| merged(a, b).iter().map(|line| line.text.as_str()).collect::<Vec<_>>().join(" ");
        assert_eq!(texts(&a, &b), "4 3 2 1");
        assert_eq!((texts(&b, &a), texts(&a, &Log::default())), ("4 3 2 1".into(), "3 1".into()));
    }

    #[test]
    fn a_flood_of_lines_stays_bounded_and_repetitions_are_counted() {
        let mut log = Log::default();
        for i in 0..5000 {
            log.add(0.0, Level::Info, "plan", &format!("line {i}"));
        }
        assert_eq!(log.len(), CAPACITY);
        for _ in 0..3 {
            log.add(1.0, Level::Info, "plan", "again");
        }
        assert_eq!(log.from_newest(0).map(|l| (l.text.as_str(), l.times)), Some(("again", 3)));
        assert_eq!(log.from_newest(1).map(|l| l.text.as_str()), Some("line 4999"));
        assert_eq!(log.from_newest(CAPACITY), None);
        log.add(1.0, Level::Info, "plan", &"x".repeat(10_000));
        assert_eq!(log.from_newest(0).map(|l| l.text.len()), Some(LONGEST));
    }
}
