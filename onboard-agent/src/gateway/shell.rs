//! Shell: the gateway as it is run, with the links to the autopilot and the port for everybody as its adapter.

use super::config::Config;
use super::core::Settings;
use super::door::Door;
use super::driver::{Registration, Setup};
use super::links::{Links, Recognises};
use super::service::{FILE, FcsGateway, Input, Output};
use super::station::Station;
use super::tlog::Tlog;
use crate::exposure::{WHAT_A_STRANGER_CAN_DO, is_loopback};
use crate::inside::{Address, Inside};
use anyhow::Context;
use autopilot_link::Link;
use autopilot_link::signing::Signing;
use service::{Adapter, Beginning, Shutdown, Tasks, Time, Timing};
use std::time::{Instant, SystemTime};
use usal::Role;

/// What the gateway has to do with: the links to the autopilot, and who comes to its port.
struct Outside {
    links: Links,
    door: Door,
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
        // what a log tells is not to be flown after a restart
        state_dir: config.state_dir.clone().filter(|_| !config.is_replay()),
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
    let exposed = !is_loopback(&config.listen);
    if exposed {
        tracing::warn!(
            "listening on {} without protection: whoever connects can {WHAT_A_STRANGER_CAN_DO}",
            config.listen
        );
    }
    let replay = config.is_replay();
    let mut links = open_links(&config.autopilots).await?;
    let tlog = match config.tlog {
        Some(tlog) => Some(Tlog::begin(tlog, links.len()).context("--tlog")?),
        None => None,
    };
    if let Some(mirror) = &config.mirror {
        links.push(mirror.open().await.context("--mirror")?);
    }
    let Config { vehicle, profile, terrain, .. } = config;
    let settings = Settings { vehicle, profile, terrain, exposed, replay };
    let Registration { recognises, make, .. } = config.driver;
    let addresses = config.autopilots.iter().map(ToString::to_string).collect();
    let unix = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let signing = config.key.map(|key| Signing::new(key, unix));
    let setup =
        Setup { lockstep: config.simulated, links: addresses, mirror: config.mirror.is_some(), signing };
    let station = Station::new(settings, restored, make(&setup));
    let recogniser = || -> Recognises {
        // what was recorded and is sent again is not recognised: each link knows by itself what came over it
        let (mut signing, start) = (setup.signing.clone(), Instant::now());
        Box::new(move |datagram: &[u8]| {
            recognises(datagram, signing.as_mut().map(|signing| (signing, start.elapsed())))
        })
    };
    let links = Links::new(links, recogniser, tlog);
    Ok((FcsGateway::new(station, !(config.simulated || replay)), Outside { links, door }))
}

async fn open_links(addresses: &[autopilot_link::Address]) -> anyhow::Result<Vec<Link>> {
    let mut links = Vec::with_capacity(addresses.len());
    for address in addresses {
        let link = Link::open(address).await.with_context(|| format!("the autopilot's link {address}"))?;
        if let Some(at) = link.local_address() {
            tracing::info!(%at, "listening for the autopilot");
        }
        links.push(link);
    }
    Ok(links)
}

impl Adapter<FcsGateway> for Outside {
    async fn next(&mut self) -> Input {
        tokio::select! {
            input = self.links.event() => input,
            flooded = self.door.changed() => Input::Flooded(flooded),
        }
    }

    async fn perform(&mut self, _: Time, outputs: Vec<Output>, _: bool, _: &mut Tasks<Input>) {
        for outbox in &outputs {
            self.links.send(outbox);
        }
    }
}
