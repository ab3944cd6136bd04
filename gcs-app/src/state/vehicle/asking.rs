//! What a vehicle is asked by itself, and what it answered.

use super::{Proposal, Vehicle, alarms::LINK_CAUTION_S};
use crate::link::Reply;
use crate::state::{LOOK_AGAIN, LOOK_AHEAD, Level, Outcome, Outlook, Ticket, Told};

/// The plan aboard is asked for again at most so often, seconds.
const ASK_ABOARD_S: f64 = 3.0;

impl Vehicle {
    pub(super) fn give_up_requests(&mut self, now_s: f64) {
        self.requests.settle_all("the link was closed before the answer came", now_s);
        self.proposal = None;
        self.outlook = Outlook::default();
    }

    pub(super) fn answered(&mut self, ticket: Ticket, result: Result<Reply, String>, now_s: f64) {
        let outcome = match &result {
            Ok(Reply::Proposal(report)) if !report.acceptable => Outcome::Refused("see its problems".into()),
            Ok(_) => Outcome::Accepted,
            Err(reason) => Outcome::Refused(reason.clone()),
        };
        let Some(label) = self.requests.settle(ticket, outcome.clone(), now_s) else { return };
        if label == LOOK_AHEAD {
            let foresight = result.and_then(|reply| match reply {
                Reply::Foresight(foresight) => Ok(foresight),
                _ => Err("it answered something else".into()),
            });
            let aircraft_s = self.clock_s(now_s);
            return self.outlook.answered(ticket, foresight, now_s, aircraft_s);
        }
        if let Outcome::Refused(reason) = &outcome {
            self.log.add(now_s, Level::Caution, "command", &format!("{label}: refused, {reason}"));
        }
        match result {
            // it was committed or dropped meanwhile
            Ok(Reply::Proposal(_)) if label == LOOK_AGAIN && self.proposal.is_none() => {}
            Ok(Reply::Proposal(report)) => {
                let entry = report.entry_needed.then(|| report.next_leg.clone()).flatten();
                let changes = std::mem::take(&mut self.put_forward);
                let told = Told { window_s: now_s, aircraft_s: self.clock_s(now_s) };
                self.proposal = Some(Proposal { report: *report, changes, entry, told });
            }
            Ok(Reply::Plan(aboard)) => self.aboard = aboard,
            // a command may lead elsewhere
            Ok(Reply::Done) => self.outlook.way_changed(),
            Ok(Reply::Foresight(_)) | Err(_) => {}
        }
    }

    /// Whether the plan aboard should be asked for now; it is taken to be asked for then.
    pub(in crate::state) fn should_ask_for_plan(&mut self, now_s: f64) -> bool {
        let is_heard = self.silence_s(now_s).is_some_and(|silence| silence < LINK_CAUTION_S);
        let is_due = self.asked_aboard_s.is_none_or(|asked| now_s - asked > ASK_ABOARD_S);
        let should = is_heard && is_due && self.open_link().is_some() && self.lacks_plan_aboard();
        if should {
            self.asked_aboard_s = Some(now_s);
        }
        should
    }

    /// It flies an emergency plan, or otherwise than the preview has it, and should be asked now which way.
    pub(in crate::state) fn should_ask_which_way(&self, now_s: f64) -> bool {
        let wanted = self.outlook.is_elsewhere() || self.emergency().is_some();
        wanted && self.outlook.is_due(now_s) && self.may_look_ahead()
    }

    /// The command that is considered, if it should be asked now what follows.
    pub(in crate::state) fn should_ask_what_follows(&self, now_s: f64) -> Option<&flight_exec::Command> {
        let due = self.outlook.to_ask(self.current_leg(), now_s, self.clock_s(now_s));
        due.filter(|_| self.may_look_ahead())
    }

    /// The vehicle answers one such question at a time, and refuses another one of the same asker.
    pub(crate) fn may_look_ahead(&self) -> bool {
        self.open_link().is_some() && !self.requests.is_pending(LOOK_AHEAD)
    }

    fn lacks_plan_aboard(&self) -> bool {
        let Some(active) = self.active_hash() else { return false };
        self.aboard.as_ref().is_none_or(|aboard| aboard.hash != active)
    }
}
