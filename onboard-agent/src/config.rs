//! What the agent is started with: command line over environment over configuration file over defaults.

pub mod environment;
pub mod file;

mod links;
mod plausible;

use crate::gateway::driver::{self, Registration};
use crate::inside::Address;
use crate::registry::{Entry, SERVICES};
use crate::services::storage;
use crate::{exposure, fp_manager, gateway, supervisor};
use aircraft::Profile;
use anyhow::{Context, bail};
use clap::builder::BoolishValueParser;
use clap::{Arg, Args, Command, ValueEnum};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Terrain, Tile, Tiles};

/// Larger plans and configurations are not read, bytes.
const FILE_MAX: u64 = 64 << 20;
/// Folder of the recordings in the state directory.
const RECORDINGS: &str = "recordings";
const DEFAULT_VEHICLE: &str = "uav1";
const DEFAULT_AIRCRAFT: &str = "trainer";

/// Options of the services. The configuration file has the same names, with `_` for `-`.
#[derive(Debug, Clone, Default, PartialEq, Args, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Options {
    /// Vehicle's name, part of every key [default: uav1].
    #[arg(long)]
    pub vehicle: Option<String>,
    /// Where the gateway listens for the other services and for ground stations [default: tcp/127.0.0.1:7447].
    #[arg(long, value_name = "ENDPOINT")]
    pub listen: Option<String>,
    /// Listen where others than this machine can connect, although nothing protects it: whoever connects can command.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    #[arg(value_parser = BoolishValueParser::new(), hide_possible_values = true)]
    pub insecure: Option<bool>,
    /// Where the FP Manager and storage find the gateway [default: as --listen].
    #[arg(long, value_name = "ENDPOINT")]
    pub connect: Option<String>,
    /// The autopilot: udp:HOST:PORT (listen there), udpout:HOST:PORT, tcp:HOST:PORT or serial:DEVICE:BAUD, as
    /// serial:/dev/ttyUSB0:57600; tlog:FILE plays a telemetry log. Given several times: links to one autopilot, the
    /// preferred one first [default: udp:127.0.0.1:14550].
    #[arg(long, value_name = "ADDRESS")]
    #[serde(deserialize_with = "links::one_or_more")]
    pub autopilot: Vec<String>,
    /// The autopilot's driver, by its name.
    #[arg(long, value_name = "NAME", help = driver_help())]
    pub driver: Option<String>,
    /// Aircraft: the name of a built-in profile or a JSON file [default: trainer].
    #[arg(long, value_name = "NAME|FILE")]
    pub aircraft: Option<String>,
    /// Elevation tile (SRTM .hgt); may be given several times.
    #[arg(long, value_name = "FILE")]
    pub terrain: Vec<PathBuf>,
    /// Flight plan to begin with, unless one is restored from the state directory.
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Where plan, place and runways survive a crash, and recordings go (into `recordings`); without it, neither.
    #[arg(long, value_name = "DIR")]
    pub state_dir: Option<PathBuf>,
    /// All flight recordings together take at most so many MiB, the oldest go first [default: 4096].
    #[arg(long, value_name = "MIB")]
    pub record_quota_mib: Option<u64>,
    /// So many MiB of the disk are left free by the recordings [default: 512].
    #[arg(long, value_name = "MIB")]
    pub record_reserve_mib: Option<u64>,
    /// File with the key of MAVLink 2 signing: 64 hexadecimal digits, or the passphrase that the autopilot was given. Only its
    /// owner may read it. What is sent is signed; what comes unsigned is refused.
    #[arg(long, value_name = "FILE")]
    pub signing_key: Option<PathBuf>,
    /// Where QGroundControl, Mission Planner or MAVProxy may watch, and change nothing: udpout:HOST:PORT (sends there) or
    /// tcp-listen:HOST:PORT (one program connects there).
    #[arg(long, value_name = "ADDRESS")]
    pub mirror: Option<String>,
    /// Log what goes over the links to the autopilot as .tlog files, in `tlogs` of the state directory.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    #[arg(value_parser = BoolishValueParser::new(), hide_possible_values = true)]
    pub tlog: Option<bool>,
    /// All these logs together take at most so many MiB, the oldest go first [default: 1024].
    #[arg(long, value_name = "MIB")]
    pub tlog_quota_mib: Option<u64>,
    /// Configuration file (TOML; JSON is read as well) for what is not given here.
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    pub config: Option<PathBuf>,
    /// The log on standard error: `text` for people, or `json`, a line for each event [default: text].
    #[arg(long, value_name = "FORMAT")]
    pub log_format: Option<LogFormat>,
    /// Time is the simulator's, in lockstep.
    #[arg(long, num_args = 0..=1, require_equals = true, default_missing_value = "true", value_name = "BOOL")]
    #[arg(value_parser = BoolishValueParser::new(), hide_possible_values = true)]
    pub simulated: Option<bool>,
    /// The socket by which the vehicle's own services reach the gateway; `run` tells it to them.
    #[arg(long, value_name = "SOCKET", hide = true)]
    #[serde(skip)]
    pub inside: Option<PathBuf>,
}

impl Options {
    /// These options, completed from the environment and the configuration file that they name.
    ///
    /// # Errors
    /// A variable can't be used, or the file can't be read or says something unknown.
    pub fn completed(self) -> anyhow::Result<Self> {
        let given = self.over(environment::options(|name| std::env::var_os(name))?);
        let Some(path) = &given.config else { return Ok(given) };
        let file = from_file(path)?;
        Ok(Self { config: None, ..given.over(file) })
    }

    /// These, and for what they leave out those of `file`.
    fn over(self, file: Self) -> Self {
        Self {
            vehicle: self.vehicle.or(file.vehicle),
            listen: self.listen.or(file.listen),
            insecure: self.insecure.or(file.insecure),
            connect: self.connect.or(file.connect),
            autopilot: if self.autopilot.is_empty() { file.autopilot } else { self.autopilot },
            driver: self.driver.or(file.driver),
            aircraft: self.aircraft.or(file.aircraft),
            terrain: if self.terrain.is_empty() { file.terrain } else { self.terrain },
            plan: self.plan.or(file.plan),
            state_dir: self.state_dir.or(file.state_dir),
            record_quota_mib: self.record_quota_mib.or(file.record_quota_mib),
            record_reserve_mib: self.record_reserve_mib.or(file.record_reserve_mib),
            signing_key: self.signing_key.or(file.signing_key),
            mirror: self.mirror.or(file.mirror),
            tlog: self.tlog.or(file.tlog),
            tlog_quota_mib: self.tlog_quota_mib.or(file.tlog_quota_mib),
            log_format: self.log_format.or(file.log_format),
            config: self.config.or(file.config),
            simulated: self.simulated.or(file.simulated),
            inside: self.inside.or(file.inside),
        }
    }

    fn is_insecure(&self) -> bool {
        self.insecure.unwrap_or_default()
    }

    fn is_simulated(&self) -> bool {
        self.simulated.unwrap_or_default()
    }

    fn vehicle(&self) -> &str {
        self.vehicle.as_deref().unwrap_or(DEFAULT_VEHICLE)
    }

    fn listen(&self) -> &str {
        self.listen.as_deref().unwrap_or(usal::DEFAULT_ENDPOINT)
    }

    /// Where the other services find the gateway.
    fn hub(&self) -> String {
        let inside = || self.inside.as_ref().map(|socket| Address::new(socket).endpoint());
        self.connect.clone().or_else(inside).unwrap_or_else(|| self.listen().to_owned())
    }

    /// Every service that is wanted can be started with these.
    ///
    /// # Errors
    /// One can't.
    pub fn check(&self) -> anyhow::Result<()> {
        self.plausible()?;
        for entry in SERVICES.iter().filter(|entry| (entry.is_wanted)(self)) {
            // it runs only once it is awaited
            drop((entry.start)(self, crate::shutdown().1)?);
        }
        Ok(())
    }

    /// The gateway's configuration.
    ///
    /// # Errors
    /// An address, profile or tile can't be used.
    pub fn gateway(&self) -> anyhow::Result<gateway::Config> {
        exposure::allow(self.listen(), self.is_insecure())?;
        Ok(gateway::Config {
            vehicle: self.vehicle().to_owned(),
            listen: self.listen().to_owned(),
            inside: self.inside.as_ref().map(Address::new),
            autopilots: self.autopilots()?,
            key: self.key()?,
            mirror: self.mirror()?,
            tlog: self.tlogs()?,
            driver: self.driver()?,
            profile: self.profile()?,
            terrain: match self.tiles()? {
                Some(tiles) => Some(Arc::new(tiles)),
                None => None,
            },
            state_dir: self.state_dir.clone(),
            simulated: self.is_simulated(),
        })
    }

    /// The FP Manager's configuration.
    ///
    /// # Errors
    /// A profile, tile or plan can't be read.
    pub fn fp_manager(&self) -> anyhow::Result<fp_manager::Config> {
        let plan = self.plan.as_deref().map(read_text).transpose().context("--plan")?;
        let terrain: Arc<dyn Terrain> = Arc::new(self.tiles()?.unwrap_or_default());
        let replay = self.autopilots()?.iter().any(gateway::Address::is_replay);
        Ok(fp_manager::Config {
            profile: self.profile()?,
            terrain,
            plan,
            // what is played is no flight to go on with
            state_dir: self.state_dir.clone().filter(|_| !replay),
            simulated: self.is_simulated(),
            replay,
            ..fp_manager::Config::new(self.vehicle(), &self.hub())
        })
    }

    /// Storage's configuration.
    ///
    /// # Errors
    /// There is no state directory, or a profile or tile can't be read.
    pub fn storage(&self) -> anyhow::Result<storage::Config> {
        let folder = self.state_dir.as_ref().context("recordings need a folder: give --state-dir")?;
        let usual = storage::Config::new(self.vehicle(), &self.hub(), folder.join(RECORDINGS));
        let bytes = |mib: Option<u64>, usual: u64| mib.map_or(usual, |mib| mib.saturating_mul(1 << 20));
        Ok(storage::Config {
            limits: storage::Limits {
                quota_bytes: bytes(self.record_quota_mib, usual.limits.quota_bytes),
                reserve_bytes: bytes(self.record_reserve_mib, usual.limits.reserve_bytes),
            },
            simulated: self.is_simulated(),
            profile: self.profile()?,
            terrain: Arc::new(self.tiles()?.unwrap_or_default()),
            ..usual
        })
    }

    /// The command lines of the services' processes.
    pub fn processes(&self) -> Vec<supervisor::Process> {
        let arguments = self.arguments();
        let process = |entry: &Entry| supervisor::Process {
            may_stay: entry.may_stay,
            ..supervisor::Process::new(entry.spec.name, arguments.clone())
        };
        SERVICES.iter().filter(|entry| (entry.is_wanted)(self)).map(process).collect()
    }

    /// As they would be typed.
    fn arguments(&self) -> Vec<std::ffi::OsString> {
        let mut arguments = Vec::new();
        let texts = [
            ("--vehicle", &self.vehicle),
            ("--listen", &self.listen),
            ("--connect", &self.connect),
            ("--driver", &self.driver),
            ("--mirror", &self.mirror),
            ("--aircraft", &self.aircraft),
        ];
        for (name, value) in texts.into_iter().filter_map(|(name, value)| Some((name, value.as_ref()?))) {
            arguments.extend([name.into(), value.into()]);
        }
        if let Some(format) = self.log_format {
            arguments.extend(["--log-format".into(), format.name().into()]);
        }
        let paths = [
            ("--plan", &self.plan),
            ("--state-dir", &self.state_dir),
            ("--inside", &self.inside),
            ("--signing-key", &self.signing_key),
        ];
        for (name, value) in paths.into_iter().filter_map(|(name, value)| Some((name, value.as_ref()?))) {
            arguments.extend([name.into(), value.into()]);
        }
        let sizes = [
            ("--record-quota-mib", self.record_quota_mib),
            ("--record-reserve-mib", self.record_reserve_mib),
            ("--tlog-quota-mib", self.tlog_quota_mib),
        ];
        for (name, value) in sizes.into_iter().filter_map(|(name, value)| Some((name, value?))) {
            arguments.extend([name.into(), value.to_string().into()]);
        }
        for address in &self.autopilot {
            arguments.extend(["--autopilot".into(), address.into()]);
        }
        for tile in &self.terrain {
            arguments.extend(["--terrain".into(), tile.into()]);
        }
        let flags = [("--insecure", self.insecure), ("--simulated", self.simulated), ("--tlog", self.tlog)];
        let given = flags.into_iter().filter_map(|(name, given)| Some(format!("{name}={}", given?)));
        arguments.extend(given.map(Into::into));
        arguments
    }

    fn driver(&self) -> anyhow::Result<Registration> {
        let Some(name) = self.driver.as_deref() else { return Ok(driver::DEFAULT) };
        driver::by_name(name).with_context(|| {
            format!("--driver: there is no driver `{name}`; choose from: {}", driver::names())
        })
    }

    fn profile(&self) -> anyhow::Result<Profile> {
        let name = self.aircraft.as_deref().unwrap_or(DEFAULT_AIRCRAFT);
        if !name.ends_with(".json") {
            return Profile::by_name(name).context("--aircraft");
        }
        let text = read_text(Path::new(name)).context("--aircraft")?;
        Profile::from_json(&text).with_context(|| format!("--aircraft {name}"))
    }

    fn tiles(&self) -> anyhow::Result<Option<Tiles>> {
        let mut tiles = Tiles::new();
        for path in &self.terrain {
            let name = path
                .file_name()
                .and_then(|n| n.to_str())
                .context("--terrain: a tile's name, like N36W085.hgt")?;
            let tile = Tile::from_hgt(name, &read(path).context("--terrain")?)
                .with_context(|| format!("--terrain {}", path.display()))?;
            tiles.add(tile);
        }
        Ok((!self.terrain.is_empty()).then_some(tiles))
    }
}

/// How the log is written.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LogFormat {
    /// For people.
    #[default]
    Text,
    /// For programs: a JSON object a line.
    Json,
}

impl LogFormat {
    fn name(self) -> &'static str {
        match self {
            Self::Text => "text",
            Self::Json => "json",
        }
    }
}

impl From<LogFormat> for service::logging::Format {
    fn from(format: LogFormat) -> Self {
        match format {
            LogFormat::Text => Self::Text,
            LogFormat::Json => Self::Json,
        }
    }
}

/// The names that a configuration file may set.
fn settings() -> impl Iterator<Item = String> {
    let names = |option: &Arg| option.get_id().as_str().to_owned();
    let command = Options::augment_args(Command::new("file"));
    let visible = command.get_arguments().filter(|option| !option.is_hide_set()).map(names);
    visible.filter(|name| name != "config").collect::<Vec<_>>().into_iter()
}

/// The options that a configuration file sets.
fn from_file(path: &Path) -> anyhow::Result<Options> {
    let (name, text) = (path.display().to_string(), read_text(path)?);
    if is_json(path) {
        eprintln!("note: {name}: JSON is still read; TOML has comments, see assets/onboard-agent/agent.toml");
        return serde_json::from_str(&text)
            .with_context(|| format!("{name}: correct it (`onboard-agent run --help` names the options)"));
    }
    Ok(file::parse(&name, &text)?)
}

/// All that is wrong with a configuration file: how it is written, and what it says, together with the environment's options,
/// which count before it.
///
/// # Errors
/// Something is, or it can't be read.
pub fn check_file(path: &Path, environment: &Options) -> anyhow::Result<()> {
    let check = |options: &Options| {
        let options = environment.clone().over(options.clone());
        options.check().and_then(|()| options.plan_can_be_flown())
    };
    if is_json(path) {
        return check(&from_file(path)?);
    }
    let (name, text) = (path.display().to_string(), read_text(path)?);
    file::parse_and_check(&name, &text, check)?;
    Ok(())
}

fn is_json(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"))
}

fn driver_help() -> String {
    format!("The autopilot's driver: {} [default: {}]", driver::names(), driver::DEFAULT.name)
}

fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    let size = std::fs::metadata(path).with_context(|| path.display().to_string())?.len();
    if size > FILE_MAX {
        bail!("{} has {size} bytes, at most {FILE_MAX} are read", path.display());
    }
    std::fs::read(path).with_context(|| path.display().to_string())
}

fn read_text(path: &Path) -> anyhow::Result<String> {
    String::from_utf8(read(path)?).with_context(|| format!("{}: save it as UTF-8", path.display()))
}

#[cfg(test)]
mod tests;
