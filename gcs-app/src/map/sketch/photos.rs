//! Pictures that are taken along legs.

use super::Reader;
use flight_plan::{Act, Id, Leg, Trigger};

/// What a camera sees across the track where the leg does not say it, degrees.
pub const USUAL_ACROSS_DEG: f64 = 60.0;
/// A plan with pictures nearer to each other says that of a video, metres.
const LEAST_M: f64 = 1.0;

/// Pictures at equal distances along a leg.
#[derive(Debug, Clone, PartialEq)]
pub struct Photos {
    /// The leg.
    pub leg: Id,
    /// Metres between two of them.
    pub every_m: f64,
    /// Metres from the leg's beginning to the first.
    pub from_m: f64,
    /// What the camera sees across the track, degrees; `None`: the leg does not say it.
    pub across_deg: Option<f64>,
}

/// Those of a leg.
pub(super) fn of(leg: &Leg, reader: &Reader<'_>) -> Vec<Photos> {
    let field = leg.numbers().into_iter().find(|(name, _)| *name == "fieldOfView");
    let across_deg =
        field.and_then(|(_, value)| reader.number(value?)).filter(|deg| (1.0..179.0).contains(deg));
    let series = leg.actions.iter().filter_map(|action| {
        let (every_m, from_m) = match (&action.trigger, &action.act) {
            (Trigger::Every(every_m), Act::Photo) => {
                let every_m = reader.number(every_m)?;
                (every_m, every_m)
            }
            (Trigger::Start, Act::PhotoSeries { every_m }) => (reader.number(every_m)?, 0.0),
            (Trigger::Distance(from_m), Act::PhotoSeries { every_m }) => {
                (reader.number(every_m)?, reader.number(from_m)?)
            }
            _ => return None,
        };
        let is_good = every_m >= LEAST_M && every_m.is_finite() && from_m >= 0.0 && from_m.is_finite();
        is_good.then(|| Photos { leg: leg.id.clone(), every_m, from_m, across_deg })
    });
    series.collect()
}
