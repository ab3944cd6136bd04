//! From a plan to its forecast, by flying it.

use super::Forecast;
use aircraft::Profile;
use flight_plan::FlightPlan;
use std::sync::Arc;
use terrain::Terrain;

/// Flies a plan ahead of time. The sentence says why it can't be flown.
pub fn fly(_plan: &FlightPlan, _profile: &Profile, _terrain: &Arc<dyn Terrain>) -> Result<Forecast, String> {
    Err("The preview is not available yet".into())
}
