//! What is done on the way, beside pictures at equal distances: those are footprints.

use super::Reader;
use super::photos::Spot;
use flight_plan::{Act, Id, Leg, LegAction, Trigger, Value};

/// Something that is done at a place of a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Acting {
    /// On which leg.
    pub leg: Id,
    /// Where on it.
    pub at: Spot,
    /// What, for people.
    pub words: String,
}

/// What is done on a leg.
pub(super) fn of(leg: &Leg, reader: &Reader<'_>) -> Vec<Acting> {
    let acts = leg.actions.iter().filter_map(|action| {
        let words = words(action)?;
        Some(Acting { leg: leg.id.clone(), at: Spot::of(&action.trigger, reader)?, words })
    });
    acts.collect()
}

/// `None`: pictures at equal distances.
fn words(action: &LegAction) -> Option<String> {
    let what = match &action.act {
        Act::PhotoSeries { .. } => return None,
        Act::Photo if matches!(action.trigger, Trigger::Every(_)) => return None,
        Act::Photo => "picture".into(),
        Act::PhotoStop => "end of the pictures".into(),
        Act::VideoStart => "video on".into(),
        Act::VideoStop => "video off".into(),
        Act::Set { variable, to } => format!("{variable} = {to}"),
        Act::Invoke { service, operation, .. } => format!("{service}: {operation}"),
        Act::Wait { seconds: Value::Constant(seconds) } => format!("wait {seconds} s"),
        Act::Wait { seconds: Value::Expression(formula) } => format!("wait {formula} s"),
    };
    let again = matches!(action.trigger, Trigger::Every(_));
    Some(if again { format!("{what}, and again and again") } else { what })
}
