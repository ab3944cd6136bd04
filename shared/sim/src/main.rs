//! Command line of the simulator.

use anyhow::Context;
use clap::Parser;
use sim::config::{parse_home, parse_param, parse_wind};
use sim::{Config, Control, FaultRequest, Home, Link, Personality};
use std::io::BufRead;
use std::net::SocketAddr;
use std::process::ExitCode;

/// A simulated fixed-wing autopilot that speaks MAVLink 2 as ArduPlane does, or PX4.
///
/// While it runs, lines on standard input control it: fault FAULT, clear NAME, wind DIRECTION,SPEED,
/// mode NAME (as by the pilot's switch: manual, circle, fbwa, auto, rtl, loiter or land), fence METRES (of the autopilot's own
/// around home, behind which it returns; 0: none), upload LAT,LON and upload-and-fly LAT,LON (another ground station's list, round
/// a place), stop.
#[derive(Debug, Parser)]
#[command(name = "legwork-sim", version)]
struct Options {
    /// Which autopilot it behaves as: arduplane, px4 or px4-vtol.
    #[arg(long, value_name = "AUTOPILOT", default_value_t = Personality::ArduPlane)]
    personality: Personality,
    /// A parameter of the autopilot that is set when it is switched on; may be given often.
    #[arg(long, value_name = "NAME=VALUE", value_parser = parse_param)]
    param: Vec<(String, f32)>,
    /// Where it stands: latitude, longitude, elevation (m AMSL), heading (degrees true).
    #[arg(long, value_name = "LAT,LON,ALT,HDG", value_parser = parse_home, allow_hyphen_values = true)]
    home: Option<Home>,
    /// Listen for a TCP client (the default, on 127.0.0.1:5760); port 0: any free one.
    #[arg(long, value_name = "ADDRESS", group = "link")]
    tcp: Option<SocketAddr>,
    /// Listen for UDP datagrams.
    #[arg(long, value_name = "ADDRESS", group = "link")]
    udp: Option<SocketAddr>,
    /// Send UDP datagrams to a ground station, from the start.
    #[arg(long, value_name = "ADDRESS", group = "link")]
    udp_out: Option<SocketAddr>,
    /// Wind: the direction it comes from (degrees true) and its speed (m/s).
    #[arg(long, value_name = "DIRECTION,SPEED", value_parser = parse_wind, allow_hyphen_values = true)]
    wind: Option<aircraft::Wind>,
    /// So much warmer than the standard atmosphere is the air at any height, °C.
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, default_value_t = 0.0)]
    isa_deviation: f64,
    /// What flies: a built-in profile, or a JSON file.
    #[arg(long, default_value = "trainer")]
    aircraft: String,
    /// Simulated seconds per second; 0: as fast as possible, with --lockstep.
    #[arg(long, default_value_t = 1.0)]
    speed: f64,
    /// Let the partner on the link drive time (TIMESYNC before every step).
    #[arg(long)]
    lockstep: bool,
    /// A fault: packet-loss=SHARE, duplicate=SHARE, reorder=SHARE, bandwidth=BITS-PER-SECOND, gps-loss, engine-out, low-battery,
    /// silence, no-rpm, no-stream=MESSAGE-NUMBER, ice, crash, reboot, flies-on or jammed, with @SECOND and +SECONDS; may be given often.
    #[arg(long, value_name = "FAULT")]
    fault: Vec<FaultRequest>,
    /// Seed of the faults' dice.
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

impl Options {
    fn config(self) -> anyhow::Result<Config> {
        let defaults = Config::default();
        let link = match (self.tcp, self.udp, self.udp_out) {
            (_, Some(udp), _) => Link::Udp(udp),
            (_, _, Some(target)) => Link::UdpOut(target),
            (tcp, ..) => Link::Tcp(tcp.unwrap_or(SocketAddr::from(([127, 0, 0, 1], 5760)))),
        };
        Ok(Config {
            personality: self.personality,
            params: self.param,
            link,
            home: self.home.unwrap_or(defaults.home),
            wind: self.wind.unwrap_or(defaults.wind),
            isa_deviation_c: self.isa_deviation,
            profile: load_profile(&self.aircraft)?,
            speed: self.speed,
            lockstep: self.lockstep,
            faults: self.fault,
            seed: self.seed,
            track_interval_s: defaults.track_interval_s,
        })
    }
}

fn load_profile(name: &str) -> anyhow::Result<aircraft::Profile> {
    if !name.ends_with(".json") {
        return Ok(aircraft::Profile::by_name(name)?);
    }
    let text = std::fs::read_to_string(name).with_context(|| format!("can't read {name}"))?;
    aircraft::Profile::from_json(&text).with_context(|| format!("{name} is no aircraft"))
}

/// Lines of standard input become controls; its end is not the simulator's end.
fn read_controls(controls: &tokio::sync::mpsc::Sender<Control>) {
    for line in std::io::stdin().lock().lines() {
        let Ok(line) = line else { return };
        if line.trim().is_empty() {
            continue;
        }
        match line.parse::<Control>() {
            Ok(control) => {
                answer(format_args!("ok {}", line.trim()));
                if controls.blocking_send(control).is_err() {
                    return;
                }
            }
            Err(error) => answer(format_args!("error {error}")),
        }
    }
}

/// The flight goes on although nobody can be told.
fn answer(line: std::fmt::Arguments<'_>) {
    if let Err(error) = stdio::line(line) {
        tracing::warn!("{error}");
    }
}

fn main() -> ExitCode {
    tracing_subscriber::fmt().with_writer(std::io::stderr).init();
    let outcome = match stdio::arguments::<Options>() {
        Ok(options) => options.config().and_then(simulate),
        Err(status) => return status,
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("legwork-sim: {error:#}");
            ExitCode::from(stdio::USAGE)
        }
    }
}

fn simulate(config: Config) -> anyhow::Result<()> {
    let (link, seed) = (config.link, config.seed);
    let handle = sim::spawn(config)?;
    stdio::line(format_args!("seed {seed}"))?;
    match link {
        Link::Tcp(_) => stdio::line(format_args!("listening on tcp {}", handle.address())),
        Link::Udp(_) => stdio::line(format_args!("listening on udp {}", handle.address())),
        Link::UdpOut(target) => {
            stdio::line(format_args!("sending to udp {target} from {}", handle.address()))
        }
    }?;
    let controls = handle.controls();
    std::thread::spawn(move || read_controls(&controls));
    handle.join();
    Ok(())
}
