//! The FP Manager joins and feeds waypoints.

use super::batch;
use super::io::{Intent, Output, Snapshot};
use super::states::{Trigger, is_safe};
use super::{Gateway, NOT_HEARD, OFF_AFTER};
use crate::gateway::order::Time;
use flight_exec::review::plausibility::{self, Context};
use usal::Instance;
use usal::contract::{Feed, FeedAnswer, GatewayState, Join, JoinAnswer, Token, Waypoint};
use wire::Convert;

/// Why nobody joins an aircraft that was met in flight before it is known what it flies.
const BEING_READ: &str =
    "The aircraft flies, or may, and what it has aboard is not read yet: try again in a moment.";

impl Gateway {
    /// The FP Manager presents itself. In Safe mode, it gets the aircraft back if it flies the plan of the flight or an
    /// update of it, knows the flight's tokens, and the approach has not begun.
    pub(super) fn join(
        &mut self,
        now: Time,
        join: Join,
        from: Option<Instance>,
        out: &mut Vec<Output>,
    ) -> JoinAnswer {
        let Some(from) = from else {
            return self.join_answer(false, "Join as a session that names itself.".into());
        };
        if self.fp_manager.is_another(Some(from)) && self.fp_manager.lives(now) {
            self.fp_manager.heard_others(now, 1);
            return self.join_answer(false, "Another FP Manager has joined, and lives.".into());
        }
        if let Err(reason) = self.may_join(&join) {
            self.fp_manager.asked_to_join(now);
            return JoinAnswer { waits: self.has_no_place(), ..self.join_answer(false, reason) };
        }
        self.fp_manager.joined(now, join.plan, from);
        if self.state == GatewayState::Stop && join.last_token < self.highest {
            // a new FP Manager on the ground: a new flight
            self.highest = join.last_token;
            if self.control.launch.since.is_some() {
                self.give_up_launch("another FP Manager has joined", out);
            }
            self.forget_waypoints(out);
        }
        self.recover(now, out);
        out.push(Output::Save);
        self.join_answer(true, String::new())
    }

    fn may_join(&self, join: &Join) -> Result<(), String> {
        self.is_real()?;
        self.knows_what_is_aboard()?;
        match self.state {
            GatewayState::Manual => Err("The pilot flies; join again when he gives back control.".into()),
            GatewayState::SafeApproach | GatewayState::SafeLand => {
                Err("Too late: the aircraft is on its way to the runway.".into())
            }
            GatewayState::Terminate => Err("The flight was ended by force.".into()),
            GatewayState::SafeHold | GatewayState::SafeReturn if self.control.safe_until_command => {
                Err("Only the request `recover` ends this Safe mode.".into())
            }
            GatewayState::SafeHold | GatewayState::SafeReturn => self.knows_the_flight(join),
            _ => Ok(()),
        }
    }

    /// What is taken before the list of an aircraft that flies was read would be lost when that is taken over; and whether it
    /// flies is only known once it is heard.
    pub(super) fn knows_what_is_aboard(&self) -> Result<(), String> {
        let is_heard = |at: Time| self.now.saturating_sub(at) <= OFF_AFTER;
        match self.state {
            _ if self.control.is_reading() => Err(BEING_READ.into()),
            GatewayState::Off if !self.telemetry.last_received.is_some_and(is_heard) => Err(NOT_HEARD.into()),
            GatewayState::Off => Err(BEING_READ.into()),
            // armed, with what an earlier gateway launched
            GatewayState::Stop
                if self.telemetry.armed && self.adopting.as_ref().is_some_and(Snapshot::takes_off) =>
            {
                Err(BEING_READ.into())
            }
            _ => Ok(()),
        }
    }

    fn knows_the_flight(&self, join: &Join) -> Result<(), String> {
        // an update may have been made while the link was down
        let known = |plan| self.fp_manager.plan.as_ref().is_none_or(|flown| flown == plan);
        if join.plan.is_none() || !join.plan.iter().chain(&join.earlier).any(known) {
            return Err(
                "It does not fly the plan of this flight; restore that plan, or use the request `recover`."
                    .into(),
            );
        }
        // not the last one aboard: the way home that Safe mode flies has no tokens
        if join.last_token < self.highest {
            return Err("It does not know the waypoints of this flight; restore its state, or use the request `recover`.".into());
        }
        Ok(())
    }

    /// Nobody can join, whoever it is: a pilot has the aircraft, or Safe mode until it is told otherwise.
    fn has_no_place(&self) -> bool {
        use GatewayState::{Manual, SafeApproach, SafeHold, SafeLand, SafeReturn, Terminate};
        match self.state {
            Manual | SafeApproach | SafeLand | Terminate => true,
            SafeHold | SafeReturn => self.control.safe_until_command,
            _ => false,
        }
    }

    fn join_answer(&self, accepted: bool, reason: String) -> JoinAnswer {
        let own = |t: Token| (t.0 > 0).then_some(t);
        JoinAnswer {
            instance: None,
            accepted,
            reason,
            waits: false,
            current: self.buffer.current().and_then(|w| own(w.token)),
            last: self.buffer.last().and_then(|w| own(w.token)),
            highest: self.highest,
            finished: self.finished,
        }
    }

    /// Gives the aircraft back to the FP Manager: on with the waypoints aboard, or holding until
    /// it sends some.
    pub(super) fn recover(&mut self, now: Time, out: &mut Vec<Output>) {
        let theirs = self.buffer.waypoints().any(|w| w.token.0 > 0);
        match self.state {
            GatewayState::SafeHold if theirs => {
                self.control.set_intent(Intent::Fly, self.telemetry.mode);
                self.change(Trigger::Recovered, "the FP Manager is back", out);
            }
            GatewayState::SafeHold | GatewayState::SafeReturn => {
                self.feed_driver(Some(Token(0)), vec![], out);
                self.control.set_intent(Intent::Hold, self.telemetry.mode);
                self.fp_manager.awaited_since = Some(now);
                self.change(Trigger::RecoveredDry, "the FP Manager is back; waiting for its waypoints", out);
            }
            _ => return,
        }
        self.control.safe_until_command = false;
    }

    /// One transaction: taken whole, or the buffer stays as it was.
    pub(super) fn feed(
        &mut self,
        now: Time,
        feed: Feed,
        from: Option<Instance>,
        out: &mut Vec<Output>,
    ) -> FeedAnswer {
        if self.fp_manager.is_another(from) {
            self.fp_manager.heard_others(now, 1);
            return FeedAnswer::NotNow("Another FP Manager has joined: join first.".into());
        }
        if self.fp_manager.instance.is_none() {
            // it may not know what this gateway, which started anew, has met or forgotten
            return FeedAnswer::NotNow("Nobody has joined this gateway: join first.".into());
        }
        if let Err(why) = self.takes_waypoints(now) {
            return FeedAnswer::NotNow(why);
        }
        let feed = self.in_place_of_own(feed);
        if is_take_back(&feed) && self.state != GatewayState::Stop {
            let why = "a start is taken back on the ground only: in flight, hold or land elsewhere";
            return FeedAnswer::Refused { faults: vec![(Token(0), "in-flight".into(), why.into())] };
        }
        let faults = self.faults(&feed);
        if !faults.is_empty() {
            return FeedAnswer::Refused { faults };
        }
        if feed.waypoints.len() > self.buffer.room(feed.cancel_after) {
            return FeedAnswer::Full;
        }
        self.take(feed, out);
        FeedAnswer::Accepted
    }

    fn takes_waypoints(&self, now: Time) -> Result<(), String> {
        self.knows_what_is_aboard()?;
        match self.state {
            GatewayState::SafeHold if self.is_only_dry(now) => Ok(()),
            s if is_safe(s) => Err("Safe mode flies; join first.".into()),
            GatewayState::Manual => Err("The pilot flies.".into()),
            GatewayState::Terminate => Err("The flight was ended by force.".into()),
            _ => Ok(()),
        }
    }

    /// Nothing follows on our own way home: it has no tokens, and a later batch that keeps what came behind it would cancel both.
    fn in_place_of_own(&self, feed: Feed) -> Feed {
        let follows_own = self.buffer.last().is_some_and(|last| last.token == Token(0));
        if feed.waypoints.is_empty() || !follows_own {
            return feed;
        }
        Feed { cancel_after: Some(Token(0)), ..feed }
    }

    /// Safe.Hold because the buffer ran dry, with an FP Manager that is alive: waypoints heal it.
    fn is_only_dry(&self, now: Time) -> bool {
        !self.control.safe_until_command && !self.fp_manager.is_silent(now, &self.safe)
    }

    fn faults(&self, feed: &Feed) -> Vec<batch::Fault> {
        let terrain = self.settings.terrain.as_deref();
        let context = Context {
            profile: &self.settings.profile,
            terrain,
            wind_mps: self.telemetry.wind_mps(),
            glides: self.glides(),
        };
        let here = self.here(feed);
        let previous = self.buffer.predecessor(feed.cancel_after).or(here.as_ref());
        batch::faults(&context, self.highest, previous, &feed.waypoints)
    }

    /// Where the aircraft is, as a waypoint that the batch follows on; in flight only.
    fn here(&self, feed: &Feed) -> Option<Waypoint> {
        let position = self.place_now().filter(|_| self.telemetry.is_up(self.now))?;
        let first = feed.waypoints.first()?.clone().convert();
        Some(plausibility::from_here(position, &first).convert())
    }

    fn take(&mut self, feed: Feed, out: &mut Vec<Output>) {
        if is_take_back(&feed) {
            return self.stand_down(out);
        }
        let last = feed.waypoints.last().map(|w| w.token);
        self.highest = self.highest.max(last.unwrap_or(Token(0)));
        let cancel_after = self.cancels(&feed);
        self.feed_driver(cancel_after, feed.waypoints, out);
        self.ended = false;
        self.finished = false;
        self.low_reported = false;
        let awaited = self.fp_manager.awaited_since.is_some() || self.state == GatewayState::SafeHold;
        if last.is_some() && awaited {
            self.fp_manager.awaited_since = None;
            self.control.set_intent(Intent::Fly, self.telemetry.mode);
            self.change(Trigger::Recovered, "the FP Manager sent waypoints", out);
        }
        out.push(Output::Save);
    }
}

/// Nothing of a start is wanted any more.
fn is_take_back(feed: &Feed) -> bool {
    feed.cancel_after == Some(Token(0)) && feed.waypoints.is_empty()
}
