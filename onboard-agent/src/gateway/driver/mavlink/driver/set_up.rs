//! What stands in the way of a flight among the autopilot's parameters: asked for, told, never changed.

use super::super::Peer;
use super::super::dialect::Dialect;
use super::super::examine::Advice;
use super::super::parameters::Asked;
use crate::gateway::driver::examination::Degree;
use crate::gateway::order::Time;
use mavlink::dialects::ardupilotmega::{MavMessage, PARAM_VALUE_DATA};
use std::collections::BTreeMap;

/// Parameters that a flight needs to be in a certain way.
#[derive(Debug, Default)]
pub struct SetUp {
    asked: BTreeMap<&'static str, Asked>,
    /// What was told last.
    told: Vec<String>,
}

impl SetUp {
    /// Asks for those that are not known, or not as they have to be.
    pub fn tick(&mut self, now: Time, dialect: &Dialect, peer: Peer, out: &mut Vec<MavMessage>) {
        for advice in needed(dialect) {
            let asked = self.asked.entry(advice.name).or_default();
            asked.tick(now, advice.name, advice.is_good, peer, out);
        }
    }

    /// The autopilot says a parameter: what is in the way of a flight and what to do, if that has changed.
    pub fn said(&mut self, message: &PARAM_VALUE_DATA, dialect: &Dialect) -> Option<Vec<String>> {
        let mut wrong = vec![];
        for advice in needed(dialect) {
            let asked = self.asked.entry(advice.name).or_default();
            asked.said(advice.name, message, dialect.whole_as_bits);
            let bad = asked.value().filter(|value| !(advice.is_good)(*value));
            wrong.extend(bad.map(|value| advice.sentence(value)));
        }
        (self.told != wrong).then(|| {
            self.told.clone_from(&wrong);
            wrong
        })
    }
}

fn needed(dialect: &Dialect) -> impl Iterator<Item = &'static Advice> {
    dialect.advice.iter().filter(|advice| advice.degree == Degree::ToDo)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gateway::driver::arduplane::DIALECT;
    use mavlink::dialects::ardupilotmega::MavParamType;

    fn value(name: &str, param_value: f32) -> PARAM_VALUE_DATA {
        let param_type = MavParamType::MAV_PARAM_TYPE_REAL32;
        PARAM_VALUE_DATA { param_id: name.into(), param_value, param_type, ..PARAM_VALUE_DATA::DEFAULT }
    }

    #[test]
    fn what_is_in_the_way_of_a_flight_is_told_with_what_to_do_until_it_is_mended() {
        let (mut set_up, mut out) = (SetUp::default(), vec![]);
        set_up.tick(Time::ZERO, &DIALECT, Peer { system: 1, component: 1 }, &mut out);
        assert_eq!(out.len(), needed(&DIALECT).count());
        assert_eq!(set_up.said(&value("MIS_RESTART", 0.0), &DIALECT), None);
        let told = set_up.said(&value("MIS_RESTART", 1.0), &DIALECT).expect("it is told");
        assert_eq!(told.len(), 1);
        assert!(told[0].starts_with("MIS_RESTART is 1: ") && told[0].ends_with("set it to 0"), "{told:?}");
        assert_eq!(set_up.said(&value("MIS_RESTART", 1.0), &DIALECT), None, "it is told already");
        assert_eq!(set_up.said(&value("WP_RADIUS", 1.0), &DIALECT), None, "it flies with that");
        assert_eq!(set_up.said(&value("MIS_RESTART", 0.0), &DIALECT), Some(vec![]));
    }
}
