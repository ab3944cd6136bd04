//! A flight as `legwork preview` foresees it: by the autopilot's habits, in the wind and air of the flight.

use crate::rig::Rig;
use aircraft::{Profile, Wind, air};
use anyhow::{Context, anyhow};
use flight_exec::rehearse::{Options, Preview, Scenario, Start, preview};
use geometry::LatLon;
use std::sync::Arc;
use terrain::{Flat, Terrain};

/// So many points before and behind a leg belong to it, one a second.
const MARGIN: usize = 8;

/// A whole flight, ahead of it.
pub struct Foreseen {
    preview: Preview,
}

impl Foreseen {
    /// That of a plan around the field of a rig, whose autopilot and air are known, in a wind.
    ///
    /// # Errors
    /// The plan can't be flown, or the habits of this autopilot are not known.
    pub fn of(rig: &Rig, plan: &str, wind: Wind) -> anyhow::Result<Self> {
        let kind = rig.gateway_status().and_then(|status| status.autopilot).context("no autopilot")?;
        let habits = kind.habits.with_context(|| format!("habits of {}", kind.name))?;
        let (around, position) = (rig.air().context("no air")?, rig.position().context("no position")?);
        let warmer_c =
            air::isa_deviation_c(position.altitude_amsl_m, around.pressure_hpa, around.temperature_c);
        let options = Options {
            autopilot: Some(habits.parse().map_err(anyhow::Error::msg)?),
            isa_deviation_c: warmer_c.unwrap_or_default(),
            ..Options::default()
        };
        let profile = Profile::default();
        let terrain: Arc<dyn Terrain> = Arc::new(Flat(rig.field.elevation_m));
        let plan = flight_plan::read(plan.as_bytes()).plan;
        let program = flight_plan::compile(plan, &profile, terrain.as_ref())
            .map_err(|problems| anyhow!("{problems:?}"))?;
        let scenario = Scenario::default();
        let preview =
            preview(&Arc::new(program), &profile, &terrain, wind, Start::Runway, &scenario, &options)?;
        Ok(Self { preview })
    }

    /// How long it is on a leg, seconds; `None`: it never is.
    pub fn leg_s(&self, leg: &str) -> Option<f64> {
        let passages = self.preview.legs.iter().filter(|passage| passage.place.leg.as_str() == leg);
        passages.map(|passage| passage.end_s - passage.start_s).reduce(|sum, s| sum + s)
    }

    /// Where it flies on a leg, with a little of what is before and behind it, for no two fly exactly as quickly.
    pub fn path(&self, leg: &str) -> Vec<LatLon> {
        let is_on = |index: usize| {
            let near = index.saturating_sub(MARGIN)..(index + MARGIN).min(self.preview.track.len());
            let passages = self.preview.track[near].iter().filter_map(|point| point.passage);
            passages.into_iter().any(|passage| self.preview.legs[passage].place.leg.as_str() == leg)
        };
        let track = self.preview.track.iter().enumerate();
        track.filter(|(index, _)| is_on(*index)).map(|(_, point)| point.position).collect()
    }
}
