//! Arming for a launch, and what takes that back.

use super::{Dialect, MavlinkDriver, Seen};
use crate::gateway::driver::mavlink::commands::{Client, Command, Refusal};
use crate::gateway::driver::mavlink::session::SessionEvent;
use crate::gateway::order::{Mode, OrderId, Report, Time};
use std::time::Duration;

/// On a bad link a change of mode may be carried out so long after it was taken back.
const STARTS_LATE: Duration = Duration::from_secs(10);
/// Why it does not arm most autopilots say just behind their answer: so long that is listened to.
const SAYS_WITHIN: Duration = Duration::from_secs(1);

/// It refused to arm, and may still say why.
#[derive(Debug)]
pub(super) struct Refused {
    at: Time,
    id: OrderId,
    /// In its answer.
    why: String,
    /// It says that it may arm later.
    for_now: bool,
}

impl MavlinkDriver {
    pub(super) fn arm(&mut self, now: Time, id: OrderId, events: &mut Vec<SessionEvent>) {
        match self.dialect() {
            Some(dialect) => {
                self.arming = Some(id);
                self.may_arm = false;
                self.starts_late_until = None;
                self.give(now, id, dialect.arm.to_vec(), events);
            }
            None => self.refuse(id),
        }
    }

    /// What was sent already may still be carried out: it is disarmed after it.
    pub(super) fn stand_down(&mut self, now: Time, id: OrderId, events: &mut Vec<SessionEvent>) {
        let Some(dialect) = self.dialect() else { return self.refuse(id) };
        self.keep_armed("ordered again");
        if let Some(arming) = self.arming.take() {
            self.take_back(arming, "the launch was given up");
            self.may_arm = true;
        }
        let shows_armed = self.seen.is_some_and(|seen| seen.armed);
        let mode = self.seen.map(|seen| (dialect.meaning)(seen.mode, false));
        let is_pilots = matches!(mode, Some(Mode::Other(_)));
        let would_fly = self.may_arm || mode == Some(Mode::Waypoints);
        let stands = dialect.stands.filter(|_| would_fly && !is_pilots);
        if self.may_arm && mode != Some(Mode::Waypoints) {
            self.starts_late_until = Some(now + STARTS_LATE);
        }
        if is_pilots && shows_armed && dialect.arms_in_waypoints() {
            // by our order it would have armed in that mode
            self.may_arm = false;
            return self.reports.push_back(Report::Done(id));
        }
        if !self.may_arm && !shows_armed {
            self.standing_down = stands.map(|_| id);
            return self.give(now, id, stands.into_iter().collect(), events);
        }
        self.standing_down = Some(id);
        self.give(now, id, vec![Command::Disarm], events);
        // whatever comes of that, and before what is ordered next
        if let Some(stands) = stands {
            self.session.command(now, Client::Standing, stands, events);
        }
    }

    /// What was to stand is left as it is.
    pub(super) fn keep_armed(&mut self, why: &str) {
        if let Some(id) = self.standing_down.take() {
            self.take_back(id, why);
        }
        self.session.take_back(Client::Standing);
    }

    /// An order to fly its list that was taken back is obeyed after all: whoever arms it by his switch would see it take off.
    pub(super) fn stand_late(&mut self, now: Time, dialect: &Dialect, events: &mut Vec<SessionEvent>) {
        let is_late = self.starts_late_until.is_some_and(|until| now < until);
        let starts = |seen: Seen| !seen.armed && (dialect.meaning)(seen.mode, false) == Mode::Waypoints;
        if let Some(stands) = dialect.stands
            && is_late
            && self.seen.is_some_and(starts)
        {
            self.starts_late_until = None;
            self.session.command(now, Client::Standing, stands, events);
        }
    }

    /// `sent`: the order to arm itself was sent, and not only what comes before it. A refusal is told with the reasons that it gives in words
    /// of its own, once it has given them.
    pub(super) fn not_armed(&mut self, now: Time, id: OrderId, sent: bool, refusal: Refusal) {
        let Refusal { why, for_now, is_answer } = refusal;
        if !is_answer && !sent {
            self.starts_late_until = Some(now + STARTS_LATE);
        }
        // what was not sent is not carried out late
        self.may_arm = !is_answer && sent;
        if is_answer {
            self.refused = Some(Refused { at: now, id, why, for_now });
        } else {
            let why = self.in_its_words(now, why);
            self.reports.push_back(match (for_now, sent) {
                (true, _) => Report::PutOff(id, why),
                (_, true) => Report::Unanswered(id, why),
                (_, false) => Report::Failed(id, why),
            });
        }
    }

    /// That it refused to arm, when it has had the time to say why.
    pub(super) fn tell_refusal(&mut self, now: Time) {
        let is_due = |refused: &mut Refused| now.saturating_sub(refused.at) >= SAYS_WITHIN;
        let Some(Refused { id, why, for_now, .. }) = self.refused.take_if(is_due) else { return };
        let why = self.in_its_words(now, why);
        self.reports.push_back(if for_now { Report::PutOff(id, why) } else { Report::Failed(id, why) });
    }

    fn in_its_words(&self, now: Time, why: String) -> String {
        match self.session.words.lately(now) {
            Some(words) => format!("{why} (it says: {words})"),
            None => why,
        }
    }
}
