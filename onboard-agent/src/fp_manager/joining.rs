//! Pure: joining the gateway, at the beginning, after a loss of either side, and after a restart.

use super::journal::Record;
use super::manager::{Effect, Manager};
use super::runways::safe_runways;
use flight_exec::{Action, Command, Event, Input, Phase, Token};
use service::Time;
use usal::contract::{GatewayRequest, Join, JoinAnswer};
use wire::Convert;

/// Who asks for what the FP Manager does of itself.
const FP_MANAGER: &str = "fp-manager";

impl Manager {
    /// What it joins with: the gateway knows by it whether it flies the flight that it gives the aircraft back for.
    pub(super) fn presentation(&self) -> Join {
        Join {
            plan: self.executor.program().map(|p| p.hash().to_string()),
            earlier: self.plan_history.earlier().to_vec(),
            last_token: self.executor.last_token().convert(),
        }
    }

    /// The answer to [`Effect::Join`]; `None`: none came.
    pub fn joined(&mut self, now: Time, answer: Option<JoinAnswer>, out: &mut Vec<Effect>) {
        let answer = match self.gateway_session.joined(now, answer) {
            Ok(answer) => answer,
            Err(None) => return,
            Err(Some(reason)) => {
                tracing::warn!("the gateway does not let us join: {reason}");
                return out.push(Effect::Event(Event::NotGranted { request: "join".into(), reason }));
            }
        };
        self.want_runways();
        self.alarms.read_again();
        self.feeder.settle(answer.highest);
        let highest: Token = answer.highest.convert();
        let lost = std::mem::take(&mut self.returning) && highest > self.executor.last_token();
        if highest > self.executor.last_token() {
            self.record(now, Record::NumberAfter(highest), out);
            self.executor.number_after(highest);
        }
        if let Some(current) = answer.current {
            self.progress(now, current.convert(), out);
        }
        let controlled = self.gateway_session.take_controlled();
        let flying =
            matches!(self.executor.status_phase(), Phase::Flying | Phase::AwaitingDecision | Phase::Holding);
        if flying && lost {
            self.hold_for_want_of_a_place(now, out);
            if controlled {
                self.step(now, Input::GatewayControls(false), out);
            }
        } else if flying {
            self.agree(now, &answer, controlled, out);
        } else {
            self.step(now, Input::GatewayControls(false), out);
        }
        self.send(now, out);
    }

    /// After a join in flight: the gateway must have what we believe it has. Waypoints that it took and has no more, while the
    /// aircraft stands, have been flown, if that was by its landing; or else somebody has brought it down: nothing is flown twice.
    fn agree(&mut self, now: Time, answer: &JoinAnswer, controlled: bool, out: &mut Vec<Effect>) {
        let taken = self.executor.ahead().next().is_some_and(|w| {
            // before the take-off it is the gateway that has lost them
            w.token <= answer.highest.convert()
                && (answer.finished || !matches!(w.action, Action::TakeOff { .. }))
        });
        let stands = self.gateway_session.is_on_ground() && answer.last.is_none();
        let is_wanted = self.gateway_session.wanted() == Some(&GatewayRequest::Launch);
        if stands && !taken && !is_wanted && !self.feeder.is_under_way() && self.takes_off_next() {
            let reason = "the gateway has nothing of it any more: start again";
            self.not_launched(now, reason.into(), out);
            self.step(now, Input::GatewayControls(false), out);
        } else if stands && taken {
            self.gateway_session.unwant(GatewayRequest::Launch);
            let flown = answer.finished;
            self.step(now, if flown { Input::Progress { current: None } } else { Input::Landed }, out);
            self.step(now, Input::GatewayControls(false), out);
        } else if controlled || self.has_gap(answer.last.convert()) {
            self.feeder.clear();
            // having given control back, the executor sends everything ahead anew
            self.step(now, Input::GatewayControls(true), out);
            self.step(now, Input::GatewayControls(false), out);
            if self.executor.status_phase() == Phase::Holding {
                // given back, the gateway flies on with what it has
                self.gateway_session.want(GatewayRequest::Hold);
            }
        }
    }

    fn takes_off_next(&self) -> bool {
        self.executor.ahead().next().is_some_and(|w| matches!(w.action, Action::TakeOff { .. }))
    }

    /// What waits to be sent does not continue what the gateway has.
    fn has_gap(&self, last: Option<Token>) -> bool {
        let sent = self.executor.ahead().map(|w| w.token);
        let first_waiting = self.feeder.first_waiting().map_or(Token(u64::MAX), Convert::convert);
        !self.feeder.is_under_way() && last != sent.take_while(|token| *token < first_waiting).last()
    }

    /// The gateway was given waypoints by an earlier process that no record knows of (its disk had failed, or was too
    /// slow): the place we know is an old one. To fly on from there is for people to say.
    fn hold_for_want_of_a_place(&mut self, now: Time, out: &mut Vec<Effect>) {
        let reason = "the gateway has waypoints that are not in the journal, so the place in the plan is not known: \
                      it holds; go to a leg, or resume from the last place recorded";
        tracing::error!("{reason}");
        out.push(Effect::Event(Event::NotJournalled { reason: reason.into() }));
        self.feeder.clear();
        let held = self.order(now, Command::Hold, FP_MANAGER, out);
        if held.is_err() {
            // it held before
            self.gateway_session.want(GatewayRequest::Hold);
        }
    }

    /// The gateway should know the plan's runways. A plan without any leaves it those it has.
    pub(super) fn want_runways(&mut self) {
        let runways = self.executor.program().map(|p| safe_runways(&p.plan)).unwrap_or_default();
        if !runways.is_empty() {
            self.gateway_session.want_runways(runways);
        }
    }
}
