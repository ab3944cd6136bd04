//! The same agent on a real autopilot, whatever is there; opt-in:
//!
//! `LEGWORK_AUTOPILOT=tcp:127.0.0.1:5760 cargo test -p system-tests --test autopilot -- --nocapture`
//!
//! The mission is laid around the place where the autopilot stands: take-off, departure with an RF, one sweep of the
//! scan loop, a plan update in flight, an emergency plan, landing. It prints what it saw.
#![cfg(test)]

use system_tests::rig::{Rig, id};
use usal::contract::{Cause, Command, GatewayState, VariableValue};

/// Longest wait for the next thing to happen, seconds of the autopilot's time.
const LIMIT_S: f64 = 1200.0;

async fn on_leg(rig: &mut Rig, leg: &str) {
    rig.until(leg, LIMIT_S, |_, seen| seen.entered(leg)).await.unwrap();
    println!("{:8.1} s  on leg {leg}", rig.seen.time_s);
}

#[tokio::test(flavor = "multi_thread")]
async fn real_autopilot_flies_the_mission() {
    let Ok(autopilot) = std::env::var("LEGWORK_AUTOPILOT") else {
        println!("not flown: set LEGWORK_AUTOPILOT, for example to tcp:127.0.0.1:5760");
        return;
    };
    let mut rig = Rig::attach(&autopilot).await.unwrap();
    println!("autopilot stands at {:?}", rig.field);
    rig.fly_mission().await.unwrap();
    for leg in ["out", "round", "far", "sweep"] {
        on_leg(&mut rig, leg).await;
    }
    let report = rig.load(&rig.field.mission(2400.0)).await.unwrap();
    println!("{:8.1} s  plan updated in flight: {report:?}", rig.seen.time_s);
    rig.command(Command::SetVariable { name: id("found"), value: VariableValue::Bool(true) }).await.unwrap();
    on_leg(&mut rig, "back").await;
    rig.command(Command::Emergency { cause: Cause::Operator, plan: None }).await.unwrap();
    println!("{:8.1} s  emergency raised", rig.seen.time_s);
    on_leg(&mut rig, "home-df").await;
    rig.until("landed", LIMIT_S, |_, seen| seen.landed()).await.unwrap();
    println!("{:8.1} s  landed\n{}", rig.seen.time_s, rig.story());
    rig.expect_on_runway().unwrap();
    assert!(!rig.seen.went_to(GatewayState::SafeHold), "{}", rig.story());
}
