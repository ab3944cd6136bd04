//! How near the legs are flown to where they were drawn.

use super::{Scenario, land_by_plan};
use crate::rig::Rig;
use anyhow::{Context, ensure};

pub const SCENARIOS: &[Scenario] = &[Scenario {
    name: "accuracy",
    happens: "nothing, at 5 m/s of wind; long legs of each kind, without corners",
    expected: "95 % of the positions within 5 m of a TF, 10 m of an RF and of a holding",
    plan: |field| Ok(field.accuracy()),
    simulator: &["--wind", "270,5"],
    fly: |rig| Box::pin(accurate(rig)),
}];

/// The legs, and within how many metres of each 95 of 100 positions lie, on whichever autopilot.
const PROMISED: [(&str, f64); 6] =
    [("out", 5.0), ("narrow", 10.0), ("back", 5.0), ("wide", 10.0), ("forth", 5.0), ("hold", 10.0)];

async fn accurate(rig: &mut Rig) -> anyhow::Result<()> {
    land_by_plan(rig).await?;
    let flown = PROMISED.iter().map(|(leg, promised_m)| {
        let within_m = rig.track.within_m(leg).with_context(|| format!("{leg} was not flown"))?;
        println!("{leg}: 95 % within {within_m:.1} m");
        Ok((leg, within_m, promised_m))
    });
    let flown: Vec<_> = flown.collect::<anyhow::Result<_>>()?;
    let beside: Vec<_> = flown.iter().filter(|(_, within_m, promised_m)| within_m > promised_m).collect();
    ensure!(beside.is_empty(), "leg, 95 % within, promised: {beside:.1?}");
    Ok(())
}
