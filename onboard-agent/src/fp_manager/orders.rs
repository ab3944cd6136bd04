//! Pure: a command's way to the executor, and what it means for the gateway, where the aircraft may be led by somebody else.

use super::manager::{Effect, Manager, unanswered};
use flight_exec::{Command, Input, Phase, Refusal};
use service::Time;
use usal::contract::GatewayRequest;

impl Manager {
    /// Has a command carried out.
    ///
    /// # Errors
    /// The executor's refusal.
    pub(super) fn order(
        &mut self,
        now: Time,
        command: Command,
        by: &str,
        out: &mut Vec<Effect>,
    ) -> Result<(), Refusal> {
        let (starts, rewinds) = (command == Command::Start, command == Command::Rewind);
        if rewinds && !self.gateway_session.stands_disarmed() {
            let reason =
                "the gateway does not say that the aircraft stands disarmed on the ground: wait for that";
            return Err(Refusal { code: "in-the-air".into(), reason: reason.into() });
        }
        if command == Command::Resume && self.resumes_without_the_executor() {
            self.send(now, out);
            return Ok(());
        }
        let (resumes, leads) = (command == Command::Resume, leads_the_aircraft(&command));
        // writes are reviewed one after the other
        self.turns += u64::from(!matches!(command, Command::SetVariable { .. }));
        let in_emergency = self.is_in_emergency();
        let request = self.next_request();
        let answer = self.step(now, Input::Command { request, by: by.into(), command }, out);
        answer.unwrap_or_else(|| Err(unanswered())).map(drop).map_err(|r| self.explained(r))?;
        if starts {
            self.gateway_session.want(GatewayRequest::Launch);
            // whatever became of them since the commit
            self.want_runways();
            self.alarms.new_flight();
            self.plan_history.new_flight();
        } else if rewinds {
            // nothing of the earlier flight is wanted any more
            self.gateway_session.forget_wanted();
        } else if in_emergency && !self.is_in_emergency() {
            self.alarms.read_again();
        }
        if resumes && self.is_flying() {
            self.gateway_session.take_back();
        } else if leads && self.is_flying() {
            self.gateway_session.flies_on();
        }
        self.send(now, out);
        Ok(())
    }

    /// The plan itself does not hold: it is the gateway that holds or follows a direct command, or the pilot who flies.
    fn resumes_without_the_executor(&mut self) -> bool {
        self.is_flying() && self.gateway_session.take_back()
    }

    fn is_flying(&self) -> bool {
        matches!(self.executor.status_phase(), Phase::Flying | Phase::AwaitingDecision)
    }

    /// Without a plan because the earlier one could not be restored, that is said with every refusal.
    fn explained(&self, refusal: Refusal) -> Refusal {
        let reason = self.without_past.as_ref().filter(|_| self.executor.program().is_none());
        match reason {
            Some(why) => Refusal {
                reason: format!("{}. The flight before the restart is lost: {why}", refusal.reason),
                ..refusal
            },
            None => refusal,
        }
    }
}

/// Who gives such a command wants the aircraft where the plan then goes, whatever the gateway does by direct commands.
fn leads_the_aircraft(command: &Command) -> bool {
    matches!(command, Command::GoTo { .. } | Command::Emergency { .. } | Command::ReturnToMain { .. })
}
