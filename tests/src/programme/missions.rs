//! The mission as it is planned, in all weathers.

use super::{Scenario, expect_whole_mission, land_by_plan, land_into_calm, of_field};
use crate::rig::Rig;

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "nominal",
        happens: "nothing, at 5 m/s of wind",
        expected: "three sweeps of the loop, landing on the runway",
        plan: of_field,
        simulator: &["--wind", "270,5"],
        fly: |rig| Box::pin(whole(rig)),
    },
    Scenario {
        name: "strong_wind",
        happens: "12 m/s of wind until it is down",
        expected: "three sweeps of the loop, landing on the runway",
        plan: of_field,
        simulator: &["--wind", "250,12"],
        fly: |rig| {
            Box::pin(async {
                land_into_calm(rig).await?;
                expect_whole_mission(rig)
            })
        },
    },
    Scenario {
        name: "strong_wind_in_flight",
        happens: "12 m/s of wind from lift-off until it is down",
        expected: "three sweeps of the loop, landing on the runway",
        plan: of_field,
        simulator: &[],
        fly: |rig| {
            Box::pin(async {
                rig.disturb("wind 250,12")?;
                land_into_calm(rig).await?;
                expect_whole_mission(rig)
            })
        },
    },
    Scenario {
        name: "bad_radio",
        happens: "a radio of 57.6 kbit/s loses a fifth of all packets, some come twice or late",
        expected: "three sweeps of the loop, landing on the runway",
        plan: of_field,
        simulator: &[
            "--fault",
            "packet-loss=0.2",
            "--fault",
            "duplicate=0.05",
            "--fault",
            "reorder=0.05",
            "--fault",
            "bandwidth=57600",
            "--seed",
            "7",
        ],
        fly: |rig| Box::pin(whole(rig)),
    },
];

async fn whole(rig: &mut Rig) -> anyhow::Result<()> {
    land_by_plan(rig).await?;
    expect_whole_mission(rig)
}
