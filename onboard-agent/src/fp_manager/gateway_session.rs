//! Pure: where we stand with the gateway: joined or not, who has control, and what we want of it.

use service::Time;
use std::time::Duration;
use usal::Instance;
use usal::contract::{GatewayRequest, GatewayState, JoinAnswer, SafeRunway};

/// Pause between two attempts to join, or to have a request granted.
const RETRY: Duration = Duration::from_secs(1);
/// After a join, states from before it may still come in for so long.
const SETTLING: Duration = Duration::from_secs(1);
/// A gateway that was joined and is not heard for so long is joined anew.
const SILENT: Duration = Duration::from_secs(3);
/// A request (but for the launch, Safe mode and the runways) is given up after so many refusals; one whose outcome somebody is told,
/// after the first.
const ATTEMPTS: u32 = 5;
/// Pause before what is never given up is asked for again after so many refusals.
const LONG_RETRY: Duration = Duration::from_secs(10);
/// A launch that is not granted is asked for again for so long. Whoever mends what was in the way stands before the propeller: later
/// nobody may be surprised by a take-off.
const LAUNCH_WITHIN: Duration = Duration::from_secs(10);

/// Where we stand.
#[derive(Debug, Default)]
pub struct GatewaySession {
    joined: bool,
    joining: bool,
    not_before: Option<Time>,
    joined_at: Option<Time>,
    state: Option<GatewayState>,
    armed: bool,
    controlled: bool,
    wanted: Option<Pending>,
    /// The storing of runways; it waits for nothing and stands in nobody's way.
    runways: Option<Pending>,
    asking: bool,
    last_reason: String,
    /// The session of the gateway that answered our last join, if it said so: others do not count.
    gateway: Option<Instance>,
    /// When it was heard last.
    heard: Option<Time>,
    /// Reports of others since the join.
    strange: u64,
}

/// Something wanted of the gateway and not granted yet.
#[derive(Debug)]
struct Pending {
    request: GatewayRequest,
    refusals: u32,
    not_before: Option<Time>,
    last_reason: String,
    /// Since when it waits, as far as it was looked at.
    since: Option<Time>,
    /// Whoever wants it is told how it went, and is not surprised by another outcome later.
    once: bool,
}

impl Pending {
    fn new(request: GatewayRequest) -> Self {
        Self { request, refusals: 0, not_before: None, last_reason: String::new(), since: None, once: false }
    }

    fn is_due(&self, now: Time) -> bool {
        self.not_before.is_none_or(|t| now >= t)
    }

    /// Not granted; whether the reason is new.
    fn refused(&mut self, now: Time, reason: &str) -> bool {
        self.refusals += 1;
        let is_patient =
            self.refusals >= ATTEMPTS && matches!(self.request, GatewayRequest::SetRunways { .. });
        self.not_before = Some(now + if is_patient { LONG_RETRY } else { RETRY });
        let new = self.last_reason != reason;
        self.last_reason = reason.to_owned();
        new
    }

    /// It is a launch that has waited for too long: what is told of it. `unjoined`: why nobody may join, if that is why.
    fn overdue(&mut self, now: Time, unjoined: &str) -> Option<String> {
        let since = *self.since.get_or_insert(now);
        let is_late = self.request == GatewayRequest::Launch && now >= since + LAUNCH_WITHIN;
        let reasons = [self.last_reason.as_str(), unjoined, "the gateway did not answer."];
        let why = reasons.into_iter().find(|reason| !reason.is_empty()).unwrap_or_default();
        let seconds = LAUNCH_WITHIN.as_secs();
        is_late.then(|| format!("{why} Given up after {seconds} s: nothing takes off by itself later. Mend that, and start again."))
    }

    fn is_hopeless(&self) -> bool {
        use GatewayRequest::{Launch, Safe, SetRunways};
        let lasting = matches!(self.request, Launch | Safe | SetRunways { .. });
        (self.once || self.refusals >= ATTEMPTS) && !lasting
    }
}

impl GatewaySession {
    /// As an earlier process knew it: what it wanted, and whether it had control.
    pub fn restored(wanted: Option<GatewayRequest>, controlled: bool) -> Self {
        Self { wanted: wanted.map(Pending::new), controlled, ..Self::default() }
    }

    /// The gateway takes our waypoints.
    pub fn is_joined(&self) -> bool {
        self.joined
    }

    /// The gateway or the pilot flies.
    pub fn is_controlled(&self) -> bool {
        self.controlled
    }

    /// The same, and it is over now.
    pub fn take_controlled(&mut self) -> bool {
        std::mem::take(&mut self.controlled)
    }

    /// Before take-off or after landing.
    pub fn is_on_ground(&self) -> bool {
        self.state == Some(GatewayState::Stop)
    }

    /// The gateway says that it flies, or that somebody does.
    pub fn is_airborne(&self) -> bool {
        self.state.is_some_and(|state| !is_down(state))
    }

    /// The gateway says that the pilot has the aircraft.
    pub fn is_pilots(&self) -> bool {
        self.state == Some(GatewayState::Manual)
    }

    /// The gateway says that the aircraft stands disarmed on the ground.
    pub fn stands_disarmed(&self) -> bool {
        self.is_on_ground() && !self.armed
    }

    /// The gateway may have forgotten us, or does not know what we know.
    pub fn lost(&mut self) {
        self.joined = false;
        self.not_before = None;
    }

    /// Whether the aircraft is armed, as published.
    pub fn armed(&mut self, armed: bool) {
        self.armed = armed;
    }

    /// Its state, as published.
    pub fn state(&mut self, now: Time, state: GatewayState) {
        if state == GatewayState::Manual && self.state != Some(state) {
            // whoever asked for that did not mean to take the aircraft from the pilot
            self.unwant(GatewayRequest::Resume);
        }
        if self.state.replace(state) == Some(GatewayState::Off) && state != GatewayState::Off {
            // it knows now what the aircraft does
            self.not_before = None;
        }
        // neither is given up as long as it makes sense
        self.unwant(if is_down(state) { GatewayRequest::Safe } else { GatewayRequest::Launch });
        let settling = self.joined && self.joined_at.is_some_and(|at| now < at + SETTLING);
        if takes_control(state) && !settling {
            self.controlled = true;
            self.joined = false;
        } else if !takes_control(state) && self.controlled {
            // it may be over; a join says so
            self.joined = false;
        }
    }

    /// The gateway that answered our last join, if it said which session it is.
    pub fn gateway(&self) -> Option<Instance> {
        self.gateway
    }

    /// Something is reported by a session: whether it counts, as that of the gateway that we joined, or may join.
    pub fn hears(&mut self, now: Time, from: Option<Instance>) -> bool {
        let ours = self.gateway.is_none() || from == self.gateway;
        if ours {
            self.heard = Some(now);
        }
        ours
    }

    /// So many reports of others came. When that is to be told, how many there were at least since the join: one, ten, a
    /// hundred, …
    pub fn strangers(&mut self, count: u64) -> Option<u64> {
        let before = self.strange;
        self.strange = before.saturating_add(count);
        let digits =
            self.strange.checked_ilog10().filter(|digits| before.checked_ilog10() != Some(*digits))?;
        Some(10_u64.pow(digits))
    }

    /// Time has passed: a gateway that is not heard any more may have been followed by another one, which has to be joined.
    /// Gives why a launch is given up.
    pub fn tick(&mut self, now: Time) -> Option<String> {
        let silent = self.gateway.is_some() && self.heard.is_some_and(|at| now > at + SILENT);
        if silent && self.joined {
            self.lost();
        }
        let why = self.wanted.as_mut()?.overdue(now, &self.last_reason)?;
        self.wanted = None;
        Some(why)
    }

    /// Whether to join now; if so, it is under way. Its state has to be known before. One that does not hear the autopilot lets
    /// nobody join: it is asked to say so only if something is wanted of it, or if it is joined anew and may have heard it since.
    pub fn should_join(&mut self, now: Time) -> bool {
        let is_off = self.state == Some(GatewayState::Off) && self.gateway.is_none();
        let known = self.state.is_some() && (!is_off || self.wanted.is_some());
        let due = known && !self.joined && !self.joining && self.not_before.is_none_or(|t| now >= t);
        self.joining |= due;
        due
    }

    /// How the join went: the answer, if it was accepted.
    ///
    /// # Errors
    /// It was not; a reason that was not reported yet.
    pub fn joined(&mut self, now: Time, answer: Option<JoinAnswer>) -> Result<JoinAnswer, Option<String>> {
        self.joining = false;
        self.not_before = Some(now + RETRY);
        let answer = answer.ok_or(None)?;
        self.gateway = answer.instance.as_deref().and_then(|instance| instance.parse().ok());
        self.heard = Some(now);
        if !answer.accepted {
            // the gateway's state says who has the aircraft meanwhile
            if answer.waits && self.controlled && self.joined_at.is_some() {
                return Err(None);
            }
            let new = self.last_reason != answer.reason;
            self.last_reason.clone_from(&answer.reason);
            return Err(new.then_some(answer.reason));
        }
        tracing::info!(highest = answer.highest.0, "joined the gateway");
        self.last_reason.clear();
        self.joined = true;
        self.joined_at = Some(now);
        self.strange = 0;
        Ok(answer)
    }

    /// What is wanted of the gateway and not granted yet.
    pub fn wanted(&self) -> Option<&GatewayRequest> {
        self.wanted.as_ref().map(|pending| &pending.request)
    }

    /// Wants something; what was wanted before is no longer. Who waits for Safe mode doesn't make do with a hold.
    pub fn want(&mut self, request: GatewayRequest) {
        if request == GatewayRequest::Hold && self.wanted() == Some(&GatewayRequest::Safe) {
            return;
        }
        self.wanted = Some(Pending::new(request));
    }

    /// Wants runways stored, best first; Safe mode needs them.
    pub fn want_runways(&mut self, runways: Vec<SafeRunway>) {
        self.runways = Some(Pending::new(GatewayRequest::SetRunways { runways }));
    }

    /// This is no longer wanted.
    pub fn unwant(&mut self, request: GatewayRequest) {
        if self.wanted() == Some(&request) {
            self.wanted = None;
        }
    }

    /// Nothing is wanted any more but that its runways are stored.
    pub fn forget_wanted(&mut self) {
        for request in [GatewayRequest::Launch, GatewayRequest::Hold, GatewayRequest::Resume] {
            self.unwant(request);
        }
    }

    /// The executor flies on: if the gateway holds or follows a direct command, it should too. If the pilot flies, a hold that waits
    /// for him to give the aircraft back is not wanted any more, and that is all.
    pub fn flies_on(&mut self) {
        if self.is_pilots() {
            return self.unwant(GatewayRequest::Hold);
        }
        let led_away = match self.state {
            Some(GatewayState::Hold | GatewayState::Directed) => true,
            // it may have been told to hold once it is clear of the ground; Safe mode, too, waits for that
            Some(GatewayState::TakeOff) => self.wanted() != Some(&GatewayRequest::Safe),
            _ => false,
        };
        if led_away || self.wanted() == Some(&GatewayRequest::Hold) {
            self.want(GatewayRequest::Resume);
        }
    }

    /// The operator wants the plan flown on. False: nobody but the plan leads the aircraft, as far as is known.
    pub fn take_back(&mut self) -> bool {
        if self.is_pilots() {
            self.want(GatewayRequest::Resume);
        } else {
            self.flies_on();
        }
        let resume = self.wanted.as_mut().filter(|pending| pending.request == GatewayRequest::Resume);
        resume.map(|pending| pending.once = true).is_some()
    }

    /// What is to be asked of a gateway whose aircraft the pilot has: to take it back, if the operator wants that. It can't be
    /// joined before.
    pub fn request_back(&mut self, now: Time) -> Option<GatewayRequest> {
        let due = |pending: &&Pending| pending.request == GatewayRequest::Resume && pending.is_due(now);
        if self.asking || !self.is_pilots() {
            return None;
        }
        let request = self.wanted.as_ref().filter(due)?.request.clone();
        self.asking = true;
        Some(request)
    }

    /// The request to be made now, if any; runways come first, and all but them, a hold and Safe mode
    /// wait for the waypoints.
    pub fn request(&mut self, now: Time, fed: bool) -> Option<GatewayRequest> {
        if self.asking {
            return None;
        }
        let ready = |pending: &&Pending| {
            fed || matches!(pending.request, GatewayRequest::Hold | GatewayRequest::Safe)
        };
        let due = |pending: &&Pending| pending.is_due(now);
        let runways = self.runways.as_ref().filter(due);
        let request = runways.or(self.wanted.as_ref().filter(due).filter(ready))?.request.clone();
        self.asking = true;
        Some(request)
    }

    /// How it went; a reason against it that was not reported yet.
    pub fn requested(
        &mut self,
        now: Time,
        request: &GatewayRequest,
        answer: Result<(), String>,
    ) -> Option<String> {
        self.asking = false;
        let slot = match request {
            GatewayRequest::SetRunways { .. } => &mut self.runways,
            _ => &mut self.wanted,
        };
        let pending = slot.as_mut().filter(|pending| pending.request == *request)?;
        let Err(reason) = answer else {
            *slot = None;
            return None;
        };
        let new = pending.refused(now, &reason);
        if pending.is_hopeless() {
            tracing::error!(request = request.name(), "given up: {reason}");
            *slot = None;
        }
        new.then_some(reason)
    }
}

/// Before take-off or after landing.
fn is_down(state: GatewayState) -> bool {
    matches!(state, GatewayState::Off | GatewayState::Stop)
}

/// States in which the gateway or the pilot flies and our waypoints are not taken.
fn takes_control(state: GatewayState) -> bool {
    use GatewayState::*;
    matches!(state, SafeHold | SafeReturn | SafeApproach | SafeLand | Manual | Terminate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_waits_for_safe_mode_does_not_make_do_with_a_hold() {
        let mut gateway_session = GatewaySession::restored(Some(GatewayRequest::Safe), false);
        gateway_session.want(GatewayRequest::Hold);
        assert_eq!(gateway_session.wanted(), Some(&GatewayRequest::Safe));
        gateway_session.state(Duration::ZERO, GatewayState::Stop);
        gateway_session.want(GatewayRequest::Hold);
        assert_eq!(
            gateway_session.wanted(),
            Some(&GatewayRequest::Hold),
            "on the ground nobody waits for it"
        );
    }

    /// In the climb Safe mode is refused until the aircraft is clear of the ground, and an alarm comes meanwhile.
    #[test]
    fn an_abort_that_waits_in_the_climb_is_not_taken_back_by_what_flies_on() {
        let mut session = GatewaySession::default();
        session.state(Duration::ZERO, GatewayState::TakeOff);
        session.want(GatewayRequest::Safe);
        session.flies_on();
        assert_eq!(session.wanted(), Some(&GatewayRequest::Safe));
        session.unwant(GatewayRequest::Safe);
        session.flies_on();
        assert_eq!(session.wanted(), Some(&GatewayRequest::Resume), "it may have been told to hold");
    }

    #[test]
    fn one_that_hears_no_autopilot_is_joined_once_it_does_or_when_something_is_wanted() {
        let mut session = GatewaySession::default();
        session.state(Duration::ZERO, GatewayState::Off);
        assert!(!session.should_join(Duration::ZERO));
        session.want(GatewayRequest::Launch);
        assert!(session.should_join(Duration::ZERO), "it says why not");
        let refused =
            JoinAnswer { accepted: false, reason: "not heard".into(), ..answer(Some("a1")).unwrap() };
        session.joined(Duration::ZERO, Some(refused)).unwrap_err();
        assert!(!session.should_join(Duration::ZERO));
        session.state(Duration::ZERO, GatewayState::Nav);
        assert!(session.should_join(Duration::ZERO), "without another second of waiting");
    }

    #[test]
    fn a_resume_that_was_on_its_way_takes_nothing_from_the_pilot() {
        let mut session = GatewaySession::default();
        session.state(Duration::ZERO, GatewayState::Hold);
        session.flies_on();
        assert_eq!(session.wanted(), Some(&GatewayRequest::Resume));
        session.state(Duration::ZERO, GatewayState::Manual);
        assert_eq!(session.request_back(Duration::ZERO), None);
        assert!(session.take_back(), "but who asks for it now gets it");
        session.state(Duration::ZERO, GatewayState::Manual);
        assert_eq!(session.request_back(Duration::ZERO), Some(GatewayRequest::Resume));
    }

    /// The pilot flies, the operator holds, and an alarm leads on: it took the aircraft from him.
    #[test]
    fn a_hold_that_waits_for_the_pilot_becomes_no_resume() {
        let mut session = GatewaySession::default();
        for hold_first in [true, false] {
            session.state(Duration::ZERO, GatewayState::Nav);
            if hold_first {
                session.want(GatewayRequest::Hold);
            }
            session.state(Duration::ZERO, GatewayState::Manual);
            session.want(GatewayRequest::Hold);
            session.flies_on();
            assert_eq!(session.wanted(), None);
            assert_eq!(session.request_back(Duration::ZERO), None);
        }
    }

    /// He turns to the pilot; a second later the aircraft left the pilot's mode all the same.
    #[test]
    fn a_resume_whose_asker_was_told_no_is_not_asked_for_again() {
        let mut session = GatewaySession::default();
        use GatewayState::{Hold, Manual};
        for (state, by_operator) in [(Manual, true), (Hold, true), (Hold, false)] {
            session.state(Duration::ZERO, state);
            session.flies_on();
            assert!(!by_operator || session.take_back());
            assert_eq!(session.wanted(), Some(&GatewayRequest::Resume));
            session.requested(Duration::ZERO, &GatewayRequest::Resume, Err("no".into()));
            assert_eq!(session.wanted().is_some(), !by_operator, "{state:?}");
        }
    }

    #[test]
    fn a_launch_that_is_refused_for_long_is_given_up_and_told() {
        let mut session = GatewaySession::default();
        let now = Duration::from_secs;
        session.want(GatewayRequest::Launch);
        assert_eq!(session.tick(now(5)), None);
        assert_eq!(session.request(now(5), true), Some(GatewayRequest::Launch));
        let refused = Err("There is no GPS fix.".to_owned());
        session.requested(now(5), &GatewayRequest::Launch, refused);
        assert_eq!(session.tick(now(14)), None);
        let why = session.tick(now(15)).unwrap();
        assert!(why.starts_with("There is no GPS fix.") && why.contains("start again"), "{why}");
        assert_eq!(session.tick(now(16)), None);
        assert_eq!(session.wanted(), None);
        session.want(GatewayRequest::Safe);
        assert_eq!(session.tick(now(20)), None);
        assert_eq!(session.tick(now(99)), None, "Safe mode is never given up");
    }

    /// The gateway did answer: it let nobody join.
    #[test]
    fn a_launch_that_waited_for_a_join_is_given_up_with_the_reason_against_that() {
        let mut session = GatewaySession::default();
        session.want(GatewayRequest::Launch);
        session.tick(Duration::ZERO);
        let reason = "The autopilot is not heard; check its link.";
        let refused = JoinAnswer { accepted: false, reason: reason.into(), ..answer(None).unwrap() };
        session.joined(Duration::ZERO, Some(refused)).unwrap_err();
        let why = session.tick(Duration::from_secs(10)).unwrap();
        assert!(why.starts_with(reason), "{why}");
    }

    /// That a pilot flies is known of the gateway's state; that something is wrong with who asks is not.
    #[test]
    fn of_a_join_that_is_refused_only_what_can_be_mended_is_told() {
        let mut session = GatewaySession::default();
        let now = Duration::from_secs;
        session.joined(now(0), answer(None)).unwrap();
        session.state(now(9), GatewayState::Manual);
        let mut refused = |reason: &str, waits| {
            let answer =
                JoinAnswer { accepted: false, waits, reason: reason.into(), ..answer(None).unwrap() };
            session.joined(now(10), Some(answer)).unwrap_err()
        };
        assert_eq!(refused("The pilot flies.", true), None);
        assert_eq!(refused("Restore that plan.", false).as_deref(), Some("Restore that plan."));
        assert_eq!(refused("Restore that plan.", false), None, "once");
    }

    /// "Try again when there is a position": it comes when it comes.
    #[test]
    fn runways_that_are_refused_are_asked_for_until_they_are_taken() {
        let mut session = GatewaySession::default();
        session.want_runways(vec![]);
        let mut asked = 0;
        for second in 0..60 {
            let now = Duration::from_secs(second);
            if let Some(request) = session.request(now, true) {
                asked += 1;
                let told = session.requested(now, &request, Err("there is no position".into()));
                assert_eq!(told.is_some(), asked == 1, "it is told once");
            }
        }
        assert!((8..20).contains(&asked), "{asked} times: seldom, later on");
    }

    fn answer(instance: Option<&str>) -> Option<JoinAnswer> {
        Some(JoinAnswer {
            instance: instance.map(Into::into),
            accepted: true,
            reason: String::new(),
            waits: false,
            current: None,
            last: None,
            highest: usal::contract::Token(0),
            finished: false,
        })
    }

    #[test]
    fn only_the_gateway_that_was_joined_is_heard() {
        let [ours, other]: [Instance; 2] = ["a1", "b2"].map(|text| text.parse().unwrap());
        let mut session = GatewaySession::default();
        let now = Duration::from_secs;
        assert!(session.hears(now(0), Some(other)), "nobody was joined yet");
        session.joined(now(0), answer(Some("a1"))).unwrap();
        assert!(session.hears(now(1), Some(ours)));
        assert!(!session.hears(now(1), Some(other)) && !session.hears(now(1), None));
        session.tick(now(3));
        assert!(session.is_joined());
        session.tick(now(5));
        assert!(!session.is_joined(), "whatever others say, ours is silent: join anew");
        assert!(!session.hears(now(5), Some(other)), "nor do they count until then");
        session.joined(now(5), answer(None)).unwrap();
        assert!(session.hears(now(6), Some(other)), "an older gateway doesn't say who it is");
        session.joined(now(7), answer(Some("a1"))).unwrap();
        assert!(!session.hears(now(8), None));
    }

    #[test]
    fn strangers_are_told_at_the_first_the_tenth_and_the_hundredth_report_and_anew_after_a_join() {
        let mut session = GatewaySession::default();
        session.joined(Duration::ZERO, answer(Some("a1"))).unwrap();
        let told = [1, 1, 7, 5, 3, 2000].map(|count| session.strangers(count));
        assert_eq!(told, [Some(1), None, None, Some(10), None, Some(1000)]);
        session.joined(Duration::ZERO, answer(Some("a1"))).unwrap();
        assert_eq!(session.strangers(20), Some(10));
    }
}
