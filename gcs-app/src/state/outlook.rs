//! What would follow: of the flight as it is, and of a command that is considered before it is given.

use super::Ticket;
use crate::forecast::{self, Clearance, Forecast};
use flight_exec::{Command, Foresight};
use flight_plan::Id;
use terrain::Terrain;

/// A command that the operator looks at before giving it.
#[derive(Debug, Clone, PartialEq)]
pub struct Considered {
    /// The command.
    pub command: Command,
    /// The leg that was being flown when it was looked at, or else when somebody wanted to.
    pub on_leg: Option<Id>,
    /// What would follow it, or why that is not known; `None`: not known yet.
    pub foresight: Option<Result<Box<Foresight>, String>>,
    /// When that was told.
    told: Option<Told>,
    /// When it was last asked or answered, seconds of the window's clock.
    tried_s: f64,
    /// How long the last answer took, seconds of the window's clock.
    took_s: f64,
    /// The leg that was being flown when it was last asked.
    asked_on: Option<Id>,
    /// The least height above this window's ground on that way; `None`: that is known nowhere, or not yet.
    pub clearance: Option<Clearance>,
    is_over_ground: bool,
    ticket: Option<Ticket>,
}

/// When something was told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Told {
    /// Seconds of the window's clock.
    pub window_s: f64,
    /// Seconds of the aircraft's clock: that of a simulation may run faster.
    pub aircraft_s: Option<f64>,
}

impl Told {
    /// How long ago, by whichever clock is further, seconds. `aircraft_s`: the aircraft's clock, if it is known now.
    pub fn age_s(self, now_s: f64, aircraft_s: Option<f64>) -> f64 {
        let by_aircraft = aircraft_s.zip(self.aircraft_s).map_or(0.0, |(now_s, told_s)| now_s - told_s);
        by_aircraft.max(now_s - self.window_s)
    }
}

impl Considered {
    /// How long ago what follows was told, as [`Told::age_s`]; `None`: it was not.
    pub fn age_s(&self, now_s: f64, aircraft_s: Option<f64>) -> Option<f64> {
        self.told.map(|told| told.age_s(now_s, aircraft_s))
    }

    /// The aircraft flies another leg than when it was looked at.
    pub fn has_gone_on(&self, leg: Option<&Id>) -> bool {
        self.on_leg.as_ref() != leg
    }
}

/// The way that the vehicle says it flies.
#[derive(Debug)]
struct Way {
    foresight: Box<Foresight>,
    /// When it was told, seconds of the aircraft's clock.
    told_s: f64,
    /// Over this window's ground, once that was looked at.
    over_ground: Option<Forecast>,
}

/// What is known of what is to come.
#[derive(Debug, Default)]
pub struct Outlook {
    considered: Option<Considered>,
    /// By the aircraft's clock: that of a simulation may run faster than the window's.
    way: Option<Way>,
    asked: Option<(Ticket, f64)>,
    is_elsewhere: bool,
}

/// While another way is flown than the preview's, the vehicle is asked for it so often, seconds.
const ASK_WAY_S: f64 = 15.0;
/// What was told of a command that is considered is asked anew when it is so old, seconds.
const AGAIN_S: f64 = 0.5;
/// But not sooner after the last question or answer, seconds of the window's clock, nor sooner than the last answer took: looking ahead is
/// work, and the vehicle has other work.
const PAUSE_S: f64 = 0.5;

impl Outlook {
    /// The command that is considered.
    pub fn considered(&self) -> Option<&Considered> {
        self.considered.as_ref()
    }

    /// The way that it said it flies ends on the ground.
    pub fn lands(&self) -> bool {
        self.way.as_ref().is_some_and(|way| way.foresight.landed)
    }

    /// The way that the vehicle said it flies, until it touches down, over this window's ground, and when it said so, seconds of the aircraft's clock.
    pub fn way(&self) -> Option<(&Forecast, f64)> {
        let way = self.way.as_ref()?;
        Some((way.over_ground.as_ref()?, way.told_s))
    }

    /// Why the way that it flies ends too early, as the vehicle says; `None`: it does not, or nothing is known of it.
    pub fn ends_early(&self) -> Option<&str> {
        self.way.as_ref()?.foresight.cut_short.as_deref()
    }

    /// Puts what was told over the ground, once.
    pub(super) fn look(&mut self, terrain: &dyn Terrain) {
        if let Some(considered) = self.considered.as_mut().filter(|considered| !considered.is_over_ground)
            && let Some(Ok(foresight)) = &considered.foresight
        {
            let path = forecast::told(&foresight.path, terrain);
            considered.clearance = forecast::clearance(&path, foresight.landed);
            considered.is_over_ground = true;
        }
        if let Some(way) = &mut self.way
            && way.over_ground.is_none()
        {
            let path = forecast::told(&way.foresight.path, terrain);
            way.over_ground =
                Some(if way.foresight.landed { forecast::until_touch_down(path) } else { path });
        }
    }

    /// A command is considered while this leg is flown; nothing is known of it yet.
    pub fn consider(&mut self, command: Command, leg: Option<Id>) {
        self.considered = Some(Considered {
            command,
            on_leg: leg,
            foresight: None,
            told: None,
            tried_s: f64::NEG_INFINITY,
            took_s: 0.0,
            asked_on: None,
            clearance: None,
            is_over_ground: false,
            ticket: None,
        });
    }

    /// It was asked what would follow the command that is considered, while this leg is flown.
    pub fn asked_what_follows(&mut self, ticket: Ticket, leg: Option<Id>, now_s: f64) {
        if let Some(considered) = &mut self.considered {
            (considered.ticket, considered.asked_on, considered.tried_s) = (Some(ticket), leg, now_s);
        }
    }

    /// The command that is considered, if what follows it is to be asked now: it was not asked yet, or the aircraft has flown on
    /// since. Another leg is not skipped than the one that was meant.
    pub fn to_ask(&self, leg: Option<&Id>, now_s: f64, aircraft_s: Option<f64>) -> Option<&Command> {
        let considered = self.considered.as_ref()?;
        let has_gone_on = considered.has_gone_on(leg);
        let is_old = considered.age_s(now_s, aircraft_s).is_none_or(|age_s| age_s > AGAIN_S);
        let is_due = (is_old || has_gone_on) && now_s - considered.tried_s > considered.took_s.max(PAUSE_S);
        let is_of_another = considered.command == Command::SkipLeg && has_gone_on;
        (is_due && !is_of_another).then_some(&considered.command)
    }

    /// The command was given, or is not to be.
    pub fn put_aside(&mut self) {
        self.considered = None;
    }

    /// Another way is flown from now on: what was told of the last one says nothing of it.
    pub fn way_changed(&mut self) {
        (self.way, self.asked) = (None, None);
    }

    /// The aircraft flies elsewhere than the preview has it.
    pub fn is_elsewhere(&self) -> bool {
        self.is_elsewhere
    }

    /// Whether it does was looked at.
    pub fn set_elsewhere(&mut self, is_elsewhere: bool) {
        if self.is_elsewhere && !is_elsewhere {
            self.way_changed();
        }
        self.is_elsewhere = is_elsewhere;
    }

    /// Whether it should be asked now which way it flies, and when it lands.
    pub fn is_due(&self, now_s: f64) -> bool {
        self.asked.is_none_or(|(_, asked_s)| now_s - asked_s > ASK_WAY_S)
    }

    /// It was asked which way it flies.
    pub fn asked_which_way(&mut self, ticket: Ticket, now_s: f64) {
        self.asked = Some((ticket, now_s));
    }

    /// What was asked for, or why there is no answer; `aircraft_s` is the aircraft's clock, if it is known. What is known stays
    /// where a later question has no answer: its age is told.
    pub fn answered(
        &mut self,
        ticket: Ticket,
        answer: Result<Box<Foresight>, String>,
        now_s: f64,
        aircraft_s: Option<f64>,
    ) {
        if self.asked.is_some_and(|(asked, _)| asked == ticket) {
            let told = answer.ok().zip(aircraft_s);
            self.way = told.map(|(foresight, told_s)| Way { foresight, told_s, over_ground: None });
        } else if let Some(considered) = self.considered.as_mut().filter(|c| c.ticket == Some(ticket)) {
            let leg = considered.asked_on.take();
            (considered.took_s, considered.tried_s) = (now_s - considered.tried_s, now_s);
            if answer.is_ok() || !matches!(considered.foresight, Some(Ok(_))) {
                considered.foresight = Some(answer);
                considered.told = Some(Told { window_s: now_s, aircraft_s });
                (considered.on_leg, considered.is_over_ground) = (leg, false);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn foresight(least_m: f64) -> Result<Box<Foresight>, String> {
        Ok(Box::new(Foresight {
            path: Vec::new(),
            next_leg: None,
            left_out: Vec::new(),
            short_of_altitude_m: None,
            clearance_m: Some(least_m),
            problems: Vec::new(),
            time_s: 0.0,
            distance_m: 0.0,
            battery_left: 1.0,
            landed: true,
            cut_short: None,
        }))
    }

    fn least_m(outlook: &Outlook) -> Option<f64> {
        outlook.considered()?.foresight.as_ref()?.as_ref().ok()?.clearance_m
    }

    /// The aircraft came down from 230 m to 2 m while a card of 40 s ago said 191 m.
    #[test]
    fn what_follows_is_asked_anew_while_it_is_considered() {
        let mut outlook = Outlook::default();
        let go_on = Command::ReturnToMain { leg: "valley".into() };
        let (hold, land) = (Some(Id::new("hold")), Some(Id::new("land")));
        outlook.consider(go_on.clone(), hold.clone());
        outlook.asked_what_follows(Ticket(1), hold.clone(), 10.0);
        outlook.answered(Ticket(1), foresight(191.0), 11.0, None);
        let anew =
            |outlook: &Outlook, leg: &Option<Id>, now_s| outlook.to_ask(leg.as_ref(), now_s, None).cloned();
        assert_eq!(anew(&outlook, &hold, 11.4), None, "it is fresh");
        let asked = Some(go_on);
        assert_eq!(anew(&outlook, &hold, 12.1), asked, "also where the aircraft's clock was not known");
        assert_eq!(anew(&outlook, &land, 11.9), None, "looking ahead is work: the answer took a second");
        outlook.asked_what_follows(Ticket(2), land.clone(), 17.0);
        assert!(
            outlook.considered().is_some_and(|considered| considered.has_gone_on(land.as_ref())),
            "as long as no answer is there"
        );
        outlook.answered(Ticket(2), Err("others are being looked ahead for".into()), 18.0, Some(100.0));
        assert_eq!(
            (least_m(&outlook), anew(&outlook, &land, 19.0)),
            (Some(191.0), None),
            "what is known stays"
        );
        assert_eq!(outlook.considered().and_then(|considered| considered.age_s(21.0, None)), Some(10.0));
        outlook.asked_what_follows(Ticket(3), land.clone(), 21.0);
        outlook.answered(Ticket(3), foresight(2.0), 22.0, Some(104.0));
        assert_eq!(least_m(&outlook), Some(2.0));
        let considered = outlook.considered().unwrap();
        assert!(!considered.has_gone_on(land.as_ref()));
        assert_eq!(considered.age_s(23.0, Some(144.0)), Some(40.0), "a simulation's clock is faster");
    }

    #[test]
    fn no_other_leg_is_skipped_than_the_one_that_was_meant() {
        let mut outlook = Outlook::default();
        outlook.consider(Command::SkipLeg, Some("side2".into()));
        outlook.asked_what_follows(Ticket(1), Some("side2".into()), 0.0);
        outlook.answered(Ticket(1), foresight(80.0), 1.0, None);
        let leg = |id: &str| Some(Id::new(id));
        assert_eq!(outlook.to_ask(leg("side2").as_ref(), 10.0, None), Some(&Command::SkipLeg));
        assert_eq!(outlook.to_ask(leg("side3").as_ref(), 10.0, None), None);
    }
}
