//! Why the gateway's Safe mode leads the aircraft, as its agent says it: why it began, and which emergency no plan answers.

use super::is_safe;
use flight_exec::Event;
use flight_plan::{Cause, Id};
use usal::contract::GatewayState;

/// As far as it was heard.
#[derive(Debug, Default)]
pub struct WhySafe {
    /// Why Safe mode began, in its gateway's words; `None`: something else leads, or nobody heard it begin.
    pub began: Option<String>,
    unanswered: Option<Unanswered>,
}

/// An emergency for which no plan is flown.
#[derive(Debug, Clone, PartialEq)]
pub struct Unanswered {
    /// What happened.
    pub cause: Cause,
    /// The plan that would answer it; `None`: there is none.
    pub plan: Option<Id>,
    /// Why that is not flown.
    pub reason: String,
}

impl WhySafe {
    /// The gateway's state changed.
    pub fn state_changed(&mut self, from: GatewayState, to: GatewayState, cause: &str) {
        match (is_safe(from), is_safe(to)) {
            (false, true) => self.began = Some(cause.to_owned()),
            (true, false) => *self = Self::default(),
            _ => {}
        }
    }

    /// The plan has something to tell.
    pub fn happened(&mut self, event: &Event) {
        match event {
            Event::EmergencyUnanswered { cause, plan, reason, .. } => {
                let (cause, plan, reason) = (*cause, plan.clone(), reason.clone());
                self.unanswered = Some(Unanswered { cause, plan, reason });
            }
            Event::EmergencyStarted { .. } => self.unanswered = None,
            _ => {}
        }
    }

    /// The emergency that no plan answers, as long as it goes on.
    pub fn unanswered(&self, goes_on: impl Fn(Cause) -> bool) -> Option<&Unanswered> {
        self.unanswered.as_ref().filter(|unanswered| goes_on(unanswered.cause))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_known_until_something_else_leads() {
        use GatewayState::{Hold, Nav, SafeHold, SafeReturn};
        let mut why = WhySafe::default();
        let (plan, reason) = (Some(Id::new("return")), "its runway is not reached".to_owned());
        why.happened(&Event::EmergencyUnanswered {
            cause: Cause::Engine,
            plan,
            code: "another-runway-reached".into(),
            reason,
        });
        why.state_changed(Nav, SafeHold, "asked for while engine-out");
        why.state_changed(SafeHold, SafeReturn, "gliding to runway R34");
        assert_eq!(why.began.as_deref(), Some("asked for while engine-out"), "not where it goes");
        assert!(why.unanswered(|cause| cause == Cause::Engine).is_some());
        assert_eq!(why.unanswered(|_| false), None, "it is over");
        why.state_changed(SafeReturn, Hold, "recovered");
        assert_eq!((why.began.as_deref(), why.unanswered(|_| true)), (None, None));
    }
}
