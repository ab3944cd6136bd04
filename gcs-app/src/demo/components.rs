//! Simulator, gateway, FP Manager and recorder, started in this process and watched. They talk as they always do: MAVLink
//! over TCP, Zenoh over TCP, both on ports of the loopback that were free.

use super::recording::Recording;
use aircraft::Wind;
use anyhow::Context;
use flight_plan::Runway;
use onboard_agent::{Shutdown, Trigger, fp_manager, gateway, shutdown};
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use terrain::Terrain;
use tokio::task::{JoinError, JoinHandle};

pub use super::recorded::VEHICLE;

/// Simulated seconds between points of the flown track.
const TRACK_INTERVAL_S: f64 = 0.5;

/// A service's name and its task.
type Service = (&'static str, JoinHandle<anyhow::Result<()>>);

/// The embedded system.
pub struct Components {
    /// The simulated autopilot.
    pub simulator: sim::Handle,
    /// Zenoh endpoint of the gateway.
    pub endpoint: String,
    /// The recorder; `None` when its recording was finished.
    pub recording: Option<Recording>,
    services: Vec<Service>,
    trigger: Trigger,
}

/// How they are to be started.
#[derive(Clone)]
pub struct Setup<'a> {
    /// Where the aircraft stands.
    pub home: &'a Runway,
    /// The aircraft.
    pub profile: aircraft::Profile,
    /// The wind.
    pub wind: Wind,
    /// Which autopilot is simulated.
    pub autopilot: sim::Personality,
    /// Simulated seconds per second; 0: as fast as possible.
    pub speed: f64,
    /// The ground.
    pub terrain: Arc<dyn Terrain>,
    /// Where the recording goes.
    pub recordings: &'a Path,
}

impl Components {
    /// Starts everything; inside a multi-threaded runtime.
    ///
    /// # Errors
    /// A port can't be had, or the simulator can't be started.
    pub fn start(setup: &Setup) -> anyhow::Result<Self> {
        let simulator = sim::spawn(sim::Config {
            personality: setup.autopilot,
            params: params(setup.autopilot),
            link: sim::Link::Tcp(SocketAddr::from((Ipv4Addr::LOCALHOST, 0))),
            home: sim::Home {
                position: setup.home.threshold,
                altitude_amsl_m: setup.home.elevation_amsl_m,
                heading_deg: setup.home.heading_deg,
            },
            wind: setup.wind,
            profile: setup.profile.clone(),
            speed: setup.speed,
            lockstep: true,
            track_interval_s: TRACK_INTERVAL_S,
            ..sim::Config::default()
        })
        .context("the simulator can't be started")?;
        let endpoint = format!("tcp/{}", free_address()?);
        let (trigger, shutdown) = shutdown();
        let services = services(setup, simulator.address(), &endpoint, &shutdown)?;
        let recording = Some(Recording::start(setup, &endpoint, setup.recordings));
        Ok(Self { simulator, endpoint, recording, services, trigger })
    }

    /// The first component that has ended, and why; `None` while all are running.
    pub async fn failure(&mut self) -> Option<String> {
        if self.simulator.is_finished() {
            return Some("the simulator has ended".into());
        }
        if let Some(ended) = self.services.iter().position(|(_, task)| task.is_finished()) {
            let (name, task) = self.services.remove(ended);
            return Some(why_ended(name, task.await));
        }
        match &mut self.recording {
            Some(recording) if recording.has_ended() => Some(recording.why_ended().await),
            _ => None,
        }
    }

    /// Ends everything; what does not end in time is cut off.
    pub async fn stop(self) {
        self.trigger.shut_down();
        for (name, mut task) in self.services {
            if tokio::time::timeout(std::time::Duration::from_secs(3), &mut task).await.is_err() {
                tracing::warn!("the {name} does not end, it is cut off");
                task.abort();
            }
        }
        self.simulator.stop();
    }
}

/// Why a service is not there any more.
pub fn why_ended(name: &str, ended: Result<anyhow::Result<()>, JoinError>) -> String {
    match ended {
        Ok(Ok(())) => format!("the {name} has ended by itself"),
        Ok(Err(error)) => format!("the {name} has failed: {error:#}"),
        Err(error) => format!("the {name} has crashed: {error}"),
    }
}

/// What has to be set of an autopilot before it flies plans: PX4 wants a landing in every list, else.
fn params(autopilot: sim::Personality) -> Vec<(String, f32)> {
    match autopilot {
        sim::Personality::ArduPlane => Vec::new(),
        sim::Personality::Px4 | sim::Personality::Px4Vtol => vec![("MIS_TKO_LAND_REQ".to_owned(), 0.0)],
    }
}

/// Gateway and FP Manager as tasks.
fn services(
    setup: &Setup,
    autopilot: SocketAddr,
    endpoint: &str,
    shutdown: &Shutdown,
) -> anyhow::Result<Vec<Service>> {
    let mut for_gateway = gateway::Config::new(VEHICLE, endpoint, format!("tcp:{autopilot}").parse()?);
    for_gateway.profile = setup.profile.clone();
    for_gateway.terrain = Some(setup.terrain.clone());
    for_gateway.simulated = true;
    let mut for_manager = fp_manager::Config::new(VEHICLE, endpoint);
    for_manager.profile = setup.profile.clone();
    for_manager.terrain = setup.terrain.clone();
    for_manager.simulated = true;
    Ok(vec![
        ("gateway", tokio::spawn(gateway::run(for_gateway, shutdown.clone()))),
        ("FP Manager", tokio::spawn(fp_manager::run(for_manager, shutdown.clone()))),
    ])
}

/// A loopback address that nobody listens on.
fn free_address() -> anyhow::Result<SocketAddr> {
    TcpListener::bind((Ipv4Addr::LOCALHOST, 0))
        .and_then(|listener| listener.local_addr())
        .context("no free port on the loopback interface")
}
