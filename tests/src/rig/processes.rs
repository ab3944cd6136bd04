//! The agent's processes: how they are started, and what they leave for those that come after them.

use super::Pace;
use crate::binaries::Program;
use crate::logs::Logs;
use anyhow::Context;
use std::ops::Range;
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

/// The vehicle's name.
pub const VEHICLE: &str = "test";

/// Where the agent listens: Linux gives ports from 32768 on, others from 49152.
const PORTS: Range<u32> = 20_000..30_000;

/// Where the agent's processes find each other, the autopilot and their state.
pub struct Places {
    /// Zenoh endpoint of the gateway.
    pub endpoint: String,
    /// How time passes.
    pub pace: Pace,
    /// What the processes log.
    pub logs: Logs,
    autopilot: String,
    state: tempfile::TempDir,
}

impl Places {
    /// New ones: nothing is left of anything earlier.
    pub fn new(autopilot: &str, pace: Pace, logs: Logs) -> anyhow::Result<Self> {
        Ok(Self {
            endpoint: format!("tcp/127.0.0.1:{}", free_port()?),
            pace,
            logs,
            autopilot: autopilot.to_owned(),
            state: tempfile::tempdir()?,
        })
    }

    /// The gateway, over the state that it left before.
    pub fn start_gateway(&self) -> anyhow::Result<Program> {
        let own = ["--listen", &self.endpoint, "--autopilot", &self.autopilot];
        self.start("gateway", &own, &self.state.path().join("gateway"))
    }

    /// The state that the gateway left is gone.
    pub fn forget_gateway(&self) -> anyhow::Result<()> {
        Ok(std::fs::remove_dir_all(self.state.path().join("gateway"))?)
    }

    /// The FP Manager, over the state that it left before.
    pub fn start_fp_manager(&self) -> anyhow::Result<Program> {
        self.start("fp-manager", &["--connect", &self.endpoint], &self.state.path().join("fp-manager"))
    }

    /// The flight recorder.
    pub fn start_storage(&self, state: &Path) -> anyhow::Result<Program> {
        self.start("storage", &["--connect", &self.endpoint], state)
    }

    fn start(&self, service: &'static str, own: &[&str], state: &Path) -> anyhow::Result<Program> {
        let folder = state.display().to_string();
        let mut arguments = vec![service, "--vehicle", VEHICLE, "--state-dir", &folder];
        arguments.extend(own);
        arguments.extend((self.pace == Pace::Lockstep).then_some("--simulated"));
        Program::start("onboard-agent", &arguments, &self.logs, service)
    }
}

/// A TCP port that nobody uses now, below those that the system gives to whoever asks for any: by the time that the gateway listens
/// there, somebody would have got it.
fn free_port() -> anyhow::Result<u16> {
    static ASKED: AtomicU32 = AtomicU32::new(0);
    let mut ports = (0..PORTS.len()).map(|_| {
        let asked = ASKED.fetch_add(1, Ordering::Relaxed);
        // tests that run at the same time are processes with neighbouring numbers
        PORTS.start + std::process::id().wrapping_mul(101).wrapping_add(asked) % PORTS.len() as u32
    });
    let free = ports.find_map(|port| u16::try_from(port).ok().filter(|port| is_free(*port)));
    free.with_context(|| format!("a free port in {PORTS:?}"))
}

fn is_free(port: u16) -> bool {
    std::net::TcpListener::bind(("127.0.0.1", port)).is_ok()
}
