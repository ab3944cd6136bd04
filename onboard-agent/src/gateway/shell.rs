//! Shell: the gateway as it is run, with the autopilot's link and the port for everybody as its adapter.

use super::config::Config;
use super::core::Settings;
use super::door::Door;
use super::driver::{Registration, Setup};
use super::service::{FILE, FcsGateway, Input, Output};
use super::station::Station;
use crate::exposure::{WHAT_A_STRANGER_CAN_DO, is_loopback};
use crate::inside::{Address, Inside};
use anyhow::Context;
use autopilot_link::Link;
use service::{Adapter, Beginning, Shutdown, Tasks, Time, Timing};
use usal::Role;

/// What the gateway has to do with: the autopilot's link, and who comes to its port.
struct Outside {
    link: Link,
    door: Door,
    /// A datagram from an unknown sender is from the autopilot.
    recognises: fn(&[u8]) -> bool,
    received: Vec<u8>,
}

/// Runs the gateway until `shutdown`: the session is the vehicle's hub.
///
/// # Errors
/// If the session or the link's own socket can't be had.
pub async fn run(config: Config, shutdown: Shutdown) -> anyhow::Result<()> {
    let own = if config.inside.is_none() { Some(Inside::new()?) } else { None };
    let inside = config.inside.as_ref().or(own.as_ref().map(Inside::address));
    let inside = inside.context("the hub has no place to listen")?.clone();
    let runs = service::Config {
        vehicle: config.vehicle.clone(),
        role: Role::Hub { listen: inside.endpoint() },
        state_dir: config.state_dir.clone(),
        timing: if config.simulated { Timing::Leads } else { Timing::Machine },
    };
    service::run(runs, shutdown, move |beginning| open(config, inside, beginning)).await
}

async fn open(
    config: Config,
    inside: Address,
    beginning: Beginning,
) -> anyhow::Result<(FcsGateway, Outside)> {
    let door = Door::open(&config.listen, &inside).await?;
    let restored = beginning.load(FILE, |bytes| serde_json::from_slice(bytes));
    let link = Link::open(&config.autopilot).await;
    let link = link.with_context(|| format!("the autopilot's link {}", config.autopilot))?;
    if let Some(at) = link.local_address() {
        tracing::info!(%at, "listening for the autopilot");
    }
    let exposed = !is_loopback(&config.listen);
    if exposed {
        tracing::warn!(
            "listening on {} without protection: whoever connects can {WHAT_A_STRANGER_CAN_DO}",
            config.listen
        );
    }
    let Config { vehicle, profile, terrain, .. } = config;
    let settings = Settings { vehicle, profile, terrain, exposed };
    let Registration { recognises, make, .. } = config.driver;
    let setup = Setup { lockstep: config.simulated, links: vec![config.autopilot.to_string()] };
    let station = Station::new(settings, restored, make(&setup));
    Ok((FcsGateway::new(station, config.simulated), Outside { link, door, recognises, received: Vec::new() }))
}

impl Adapter<FcsGateway> for Outside {
    async fn next(&mut self) -> Input {
        tokio::select! {
            event = self.link.next(&mut self.received, self.recognises) => {
                // the bytes go on to the driver as they are, and the next ones get a buffer of their own
                Input::Received(event, std::mem::take(&mut self.received))
            }
            flooded = self.door.changed() => Input::Flooded(flooded),
        }
    }

    async fn perform(&mut self, _: Time, outputs: Vec<Output>, _: bool, _: &mut Tasks<Input>) {
        for outbox in &outputs {
            self.link.send_all(outbox);
        }
    }
}
