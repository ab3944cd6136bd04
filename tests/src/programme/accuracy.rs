//! How near the legs are flown to where they were drawn, and to when that was foreseen.

use super::{Scenario, land_into_calm, on_leg, touch_down};
use crate::rig::Rig;
use anyhow::{Context, ensure};

pub const SCENARIOS: &[Scenario] = &[
    Scenario {
        name: "accuracy",
        happens: "nothing, at 5 m/s of wind; long legs of each kind, without corners",
        expected: "95 % of the positions within 5 m of a TF, 10 m of an RF and of a holding; the time within 3 % of what was foreseen",
        plan: |field| Ok(field.accuracy()),
        simulator: &["--wind", "270,5"],
        fly: |rig| Box::pin(accurate(rig, Promise { straight_m: 5.0, turning_m: 10.0 })),
    },
    Scenario {
        name: "accuracy_at_10_mps",
        happens: "nothing, at 10 m/s of wind until it is down; the same legs",
        expected: "95 % of the positions within 10 m of a TF, 15 m of an RF and of a holding; the time within 3 % of what was foreseen",
        plan: |field| Ok(field.accuracy()),
        simulator: &["--wind", "270,10"],
        fly: |rig| Box::pin(accurate(rig, Promise { straight_m: 10.0, turning_m: 15.0 })),
    },
];

/// Within how many metres of a leg 95 of 100 positions lie, on whichever autopilot.
struct Promise {
    straight_m: f64,
    turning_m: f64,
}

/// The legs, and whether they turn.
const LEGS: [(&str, bool); 6] =
    [("out", false), ("narrow", true), ("back", false), ("wide", true), ("forth", false), ("hold", true)];

/// The time may be another than foreseen by this share.
const TIME_SHARE: f64 = 0.03;

async fn accurate(rig: &mut Rig, promise: Promise) -> anyhow::Result<()> {
    on_time(rig).await?;
    land_into_calm(rig).await?;
    near_the_lines(rig, promise)
}

/// From where it has turned once, and knows the wind, to the touch-down.
async fn on_time(rig: &mut Rig) -> anyhow::Result<()> {
    on_leg(rig, "back").await?;
    let foreseen_s = rig.foresee().await?.time_s;
    let before_s = rig.track.flown_s();
    touch_down(rig).await?;
    let flown_s = rig.track.flown_s() - before_s;
    println!("flown in {flown_s:.0} s, {foreseen_s:.0} s foreseen");
    let off = flown_s / foreseen_s - 1.0;
    ensure!(off.abs() <= TIME_SHARE, "flown in {flown_s:.0} s, where {foreseen_s:.0} s were foreseen");
    Ok(())
}

fn near_the_lines(rig: &Rig, promise: Promise) -> anyhow::Result<()> {
    let flown = LEGS.iter().map(|(leg, turns)| {
        let within_m = rig.track.within_m(leg).with_context(|| format!("{leg} was not flown"))?;
        println!("{leg}: 95 % within {within_m:.1} m");
        Ok((leg, within_m, if *turns { promise.turning_m } else { promise.straight_m }))
    });
    let flown: Vec<_> = flown.collect::<anyhow::Result<_>>()?;
    let beside: Vec<_> = flown.iter().filter(|(_, within_m, promised_m)| within_m > promised_m).collect();
    ensure!(beside.is_empty(), "leg, 95 % within, promised: {beside:.1?}");
    Ok(())
}
