//! Looks ahead for people: on threads, so that nothing of the flight waits for them, one for each asker at a time and few at once,
//! because anybody may ask and each costs a whole flight.

use super::manager::Manager;
use super::service::{Input, Out};
use flight_exec::{Command, Refusal};
use service::{Reply, Request, Time};
use usal::contract::{ANONYMOUS, Foresee, Foresight};
use wire::Convert;

/// Looks ahead at a time.
const MOST: usize = 2;

/// What would follow, and who wants to know.
pub type Foreseen = (Reply<Foresight>, Result<flight_exec::Foresight, Refusal>);

/// The looks ahead that are under way: who asked for each.
#[derive(Default)]
pub struct Foreseeing(Vec<String>);

impl Foreseeing {
    /// Begins one, or refuses it; those without a name are one asker.
    pub fn begin(&mut self, manager: &Manager, now: Time, asked: Request<Foresee, Foresight>, out: &mut Out) {
        let Request { request, caller, reply, .. } = asked;
        let by = caller.unwrap_or_else(|| ANONYMOUS.to_owned());
        if let Err(refusal) = self.admit(&by) {
            return out.answer(reply, Err(refusal.convert()));
        }
        let (flight, conditions) = (manager.executor().clone(), manager.conditions(now));
        let (command, caller): (Option<Command>, _) = (request.command.convert(), by.clone());
        let look = move || (reply, flight_exec::foresee(&flight, &by, command.as_ref(), conditions));
        out.work(look, move |foreseen| Input::Foreseen(caller, foreseen));
    }

    /// One is done. Who asked for one that broke off has his answer: it was dropped.
    pub fn end(&mut self, caller: &str, foreseen: Result<Foreseen, String>, out: &mut Out) {
        if let Some(index) = self.0.iter().position(|known| known == caller) {
            self.0.swap_remove(index);
        }
        match foreseen {
            Ok((reply, foresight)) => out.answer(reply, foresight.convert()),
            Err(error) => tracing::error!("looking ahead: {error} (please report this as a bug)"),
        }
    }

    fn admit(&mut self, caller: &str) -> Result<(), Refusal> {
        let busy = |reason: &str| Err(Refusal { code: "busy".into(), reason: reason.into() });
        if self.0.iter().any(|known| known == caller) {
            return busy("your last question is still being looked into: ask again when it is answered");
        }
        if self.0.len() >= MOST {
            return busy("others are being looked ahead for: ask again in a moment");
        }
        self.0.push(caller.to_owned());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_asks_for_one_at_a_time_and_few_at_once() {
        let mut foreseeing = Foreseeing::default();
        let asked = |foreseeing: &mut Foreseeing, by| foreseeing.admit(by).map_err(|refusal| refusal.code);
        let busy = || Err("busy".to_owned());
        assert_eq!(asked(&mut foreseeing, ANONYMOUS), Ok(()));
        assert_eq!(asked(&mut foreseeing, ANONYMOUS), busy());
        assert_eq!(asked(&mut foreseeing, "operator"), Ok(()));
        assert_eq!(asked(&mut foreseeing, "camera"), busy());
        foreseeing.end(ANONYMOUS, Err("it broke off".into()), &mut Out::new(Time::ZERO));
        assert_eq!(asked(&mut foreseeing, "camera"), Ok(()));
    }
}
