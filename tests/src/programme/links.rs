//! The link between gateway and autopilot is cut.

use super::{Scenario, alarmed, land, of_field, on_leg};
use crate::rig::Rig;
use anyhow::ensure;

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "link_cut_1_s",
        happens: "the autopilot is not heard for 1 s",
        expected: "the mission is flown as if nothing had been",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(unnoticed(rig, 1.0)),
    },
    Scenario {
        name: "link_cut_5_s",
        happens: "the autopilot is not heard for 5 s",
        expected: "alarm; the mission goes on by the list aboard",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(gone_on_with(rig, 5.0)),
    },
    Scenario {
        name: "link_cut_30_s",
        happens: "the autopilot is not heard for 30 s",
        expected: "alarm; the mission goes on by the list aboard",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(gone_on_with(rig, 30.0)),
    },
    Scenario {
        name: "link_cut_300_s",
        happens: "the autopilot is not heard for 5 min, longer than its list lasts",
        expected: "alarm; it waits by its own means, then lands on the runway",
        plan: of_field,
        simulator: &[],
        fly: |rig| Box::pin(come_home(rig, 300.0)),
    },
];

async fn unnoticed(rig: &mut Rig, for_s: f64) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.disturb(&format!("fault silence+{for_s}"))?;
    super::land_by_plan(rig).await?;
    super::expect_whole_mission(rig)
}

async fn gone_on_with(rig: &mut Rig, for_s: f64) -> anyhow::Result<()> {
    cut(rig, for_s).await?;
    super::land_by_plan(rig).await?;
    super::expect_whole_mission(rig)
}

async fn cut(rig: &mut Rig, for_s: f64) -> anyhow::Result<()> {
    on_leg(rig, "sweep").await?;
    rig.disturb(&format!("fault silence+{for_s}"))?;
    alarmed(rig, "autopilot-silent", for_s + 10.0).await?;
    rig.until("it is heard again", for_s + 30.0, |_, seen| seen.calmed("autopilot-silent")).await
}

/// Whatever was flown until then.
async fn come_home(rig: &mut Rig, for_s: f64) -> anyhow::Result<()> {
    cut(rig, for_s).await?;
    land(rig).await?;
    ensure!(rig.seen.passes("final") <= 1, "the last leg was flown twice");
    Ok(())
}
