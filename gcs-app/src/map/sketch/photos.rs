//! Pictures that are taken along legs: where they begin, and where a series of them ends.

use super::Reader;
use crate::forecast::Point;
use flight_plan::{Act, Id, Leg, LegAction, Trigger};
use geometry::LatLon;

/// A plan with pictures nearer to each other says that of a video, metres.
const LEAST_M: f64 = 1.0;

/// Pictures at equal distances.
#[derive(Debug, Clone, PartialEq)]
pub struct Photos {
    /// The leg on which they begin.
    pub leg: Id,
    /// Metres between two of them.
    pub every_m: f64,
    /// Where the first one is taken.
    pub from: Spot,
    /// They go on along the legs behind that one, until something ends them.
    pub is_series: bool,
    /// What the camera sees across the track, degrees; `None`: the leg does not say it.
    pub across_deg: Option<f64>,
}

/// A place on the passage of a leg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spot {
    /// So many metres from its beginning.
    Metres(f64),
    /// So many seconds from its beginning.
    Seconds(f64),
    /// Abeam of a position.
    Abeam(LatLon),
    /// Its end.
    End,
}

impl Spot {
    pub(super) fn of(trigger: &Trigger, reader: &Reader<'_>) -> Option<Self> {
        let number = |value| reader.number(value).filter(|number| number.is_finite() && *number >= 0.0);
        Some(match trigger {
            Trigger::Start => Self::Metres(0.0),
            Trigger::End => Self::End,
            Trigger::Distance(metres) | Trigger::Every(metres) => Self::Metres(number(metres)?),
            Trigger::Time(seconds) => Self::Seconds(number(seconds)?),
            Trigger::Abeam(place) => Self::Abeam(reader.place(place)?),
        })
    }

    /// Metres from the start of the flight, on a passage with these points; `None`: it has none.
    pub fn distance_m(self, passage: &[Point]) -> Option<f64> {
        let (first, last) = (passage.first()?, passage.last()?);
        Some(match self {
            Self::Metres(metres) => first.distance_m + metres,
            Self::Seconds(seconds) => {
                let after = passage.iter().find(|point| point.time_s - first.time_s >= seconds);
                after.unwrap_or(last).distance_m
            }
            Self::Abeam(at) => {
                let far = |point: &&Point| point.position.distance_m(at);
                passage.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?.distance_m
            }
            Self::End => last.distance_m,
        })
    }
}

/// Those of a leg.
pub(super) fn of(leg: &Leg, reader: &Reader<'_>) -> Vec<Photos> {
    if leg.actions.is_empty() {
        return Vec::new();
    }
    let field = leg.numbers().into_iter().find(|(name, _)| *name == "fieldOfView");
    let across_deg =
        field.and_then(|(_, value)| reader.number(value?)).filter(|deg| (1.0..179.0).contains(deg));
    let series = leg.actions.iter().filter_map(|action| {
        let from = Spot::of(&action.trigger, reader)?;
        let (every_m, is_series) = match (&action.trigger, &action.act) {
            (Trigger::Every(every_m), Act::Photo) => (reader.number(every_m)?, false),
            (Trigger::Every(_), _) => return None,
            (_, Act::PhotoSeries { every_m }) => (reader.number(every_m)?, true),
            _ => return None,
        };
        let is_good = every_m >= LEAST_M && every_m.is_finite();
        is_good.then(|| Photos { leg: leg.id.clone(), every_m, from, is_series, across_deg })
    });
    series.collect()
}

/// Where a leg ends a series that is going on: it stops the camera, or begins another one.
pub(super) fn ends(leg: &Leg, reader: &Reader<'_>) -> Vec<Spot> {
    let ends = |action: &&LegAction| matches!(action.act, Act::PhotoStop | Act::PhotoSeries { .. });
    leg.actions.iter().filter(ends).filter_map(|action| Spot::of(&action.trigger, reader)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::sketch::Sketch;
    use flight_plan::Variables;

    fn point(east_m: f64) -> Point {
        Point {
            time_s: east_m / 20.0,
            distance_m: 1000.0 + east_m,
            position: LatLon::new(46.0, 9.0).destination(90.0, east_m),
            altitude_amsl_m: 500.0,
            ground_amsl_m: None,
            passage: 0,
        }
    }

    #[test]
    fn what_is_done_on_a_leg_is_where_its_trigger_says() {
        let plan = r#"<flightPlan xmlns="urn:legwork:flight-plan:1" aircraft="trainer"><mainPlan><stage id="m" type="mission">
            <TF id="t" lat="46" lon="9.01"><action on="start"><videoStart/></action><action afterDistance="100"><photo/></action>
            <action afterTime="10"><photo/></action><action on="abeam" at="46.01 9.0052"><photo/></action>
            <action on="end"><videoStop/></action></TF></stage></mainPlan></flightPlan>"#;
        let plan = flight_plan::read(plan).plan;
        let sketch = Sketch::new(&plan, &Variables::initial(&plan), &Sketch::default());
        let part: Vec<Point> = (0..=8).map(|i| point(100.0 * f64::from(i))).collect();
        let done = sketch.acts.iter().map(|act| (act.words.as_str(), act.at.distance_m(&part).unwrap()));
        let expected = [
            ("video on", 1000.0),
            ("picture", 1100.0),
            ("picture", 1200.0),
            ("picture", 1400.0),
            ("video off", 1800.0),
        ];
        assert_eq!(done.collect::<Vec<_>>(), expected);
        assert_eq!(Spot::End.distance_m(&[]), None);
    }
}
