//! What the agent is started with: command line over environment over configuration file over defaults.

pub mod environment;
pub mod file;

mod links;

use crate::gateway::driver::{self, Registration};
use crate::inside::Address;
use crate::registry::{Entry, SERVICES};
use crate::services::storage;
use crate::{exposure, fp_manager, gateway, supervisor};
use aircraft::Profile;
use anyhow::{Context, bail};
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
    #[arg(long)]
    pub insecure: bool,
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
    #[arg(long)]
    pub tlog: bool,
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
    #[arg(long)]
    pub simulated: bool,
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
            insecure: self.insecure || file.insecure,
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
            tlog: self.tlog || file.tlog,
            tlog_quota_mib: self.tlog_quota_mib.or(file.tlog_quota_mib),
            log_format: self.log_format.or(file.log_format),
            config: self.config.or(file.config),
            simulated: self.simulated || file.simulated,
            inside: self.inside.or(file.inside),
        }
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
        exposure::allow(self.listen(), self.insecure)?;
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
            simulated: self.simulated,
        })
    }

    /// The FP Manager's configuration.
    ///
    /// # Errors
    /// A profile, tile or plan can't be read.
    pub fn fp_manager(&self) -> anyhow::Result<fp_manager::Config> {
        let plan = self.plan.as_deref().map(read_text).transpose().context("--plan")?;
        let terrain: Arc<dyn Terrain> = Arc::new(self.tiles()?.unwrap_or_default());
        Ok(fp_manager::Config {
            profile: self.profile()?,
            terrain,
            plan,
            state_dir: self.state_dir.clone(),
            simulated: self.simulated,
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
            simulated: self.simulated,
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
        arguments.extend(flags.into_iter().filter(|(_, given)| *given).map(|(name, _)| name.into()));
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

/// All that is wrong with a configuration file: how it is written, and what it says.
///
/// # Errors
/// Something is, or it can't be read.
pub fn check_file(path: &Path) -> anyhow::Result<()> {
    if is_json(path) {
        return from_file(path)?.check();
    }
    let (name, text) = (path.display().to_string(), read_text(path)?);
    file::parse_and_check(&name, &text, Options::check)?;
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
mod tests {
    use super::*;
    use crate::cli::{Cli, Task};
    use clap::Parser;

    fn parse(line: &str) -> Options {
        match Cli::try_parse_from(line.split(' ')).unwrap().task {
            Task::Run(options) | Task::Service(_, options) | Task::Doctor(options) => options,
            Task::Describe | Task::CheckConfig(_) => panic!("no options"),
        }
    }

    #[test]
    fn every_option_reaches_the_children() {
        let line = "onboard-agent run --vehicle v --listen tcp/127.0.0.1:1 --connect tcp/127.0.0.1:2 --autopilot tcp:h:3 --autopilot serial:/dev/ttyUSB0:57600 --tlog --tlog-quota-mib 7 --signing-key k --mirror udpout:h:4 --driver d \
                    --aircraft trainer --plan p.xml --state-dir s --record-quota-mib 9 --record-reserve-mib 8 --terrain a.hgt --terrain b.hgt --inside i.sock --log-format json --insecure --simulated";
        let options = parse(line);
        let mut again = Cli::try_parse_from(
            ["onboard-agent".into(), "gateway".into()]
                .into_iter()
                .chain(options.arguments())
                .collect::<Vec<std::ffi::OsString>>(),
        )
        .unwrap();
        let Task::Service(_, again) = &mut again.task else { panic!("another task") };
        assert_eq!(*again, options);
    }

    #[test]
    fn the_command_line_wins_over_the_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("agent.toml");
        std::fs::write(&path, "vehicle = 'file'\nstate_dir = 'kept'\nsimulated = true\n").unwrap();
        let options = parse(&format!("onboard-agent run --vehicle line --config {}", path.display()))
            .completed()
            .unwrap();
        assert_eq!(options.vehicle.as_deref(), Some("line"));
        assert_eq!(options.state_dir.as_deref(), Some(Path::new("kept")));
        assert!(options.simulated);
    }

    #[test]
    fn unknown_setting_is_refused_with_the_file_it_stands_in() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("agent.json");
        std::fs::write(&path, r#"{"vehikel": "x"}"#).unwrap();
        let error = parse(&format!("onboard-agent run --config {}", path.display())).completed().unwrap_err();
        assert!(
            format!("{error:#}").contains("vehikel") && format!("{error:#}").contains("agent.json"),
            "{error:#}"
        );
    }

    /// What is commented out, with a space behind the sign and a name, is an option.
    #[test]
    fn the_example_can_be_used_and_shows_every_option() {
        let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../assets/onboard-agent/agent.toml");
        let text = std::fs::read_to_string(example).unwrap();
        assert_eq!(file::parse("agent.toml", &text).unwrap(), Options::default());
        check_file(Path::new(example)).unwrap();
        let is_option = |line: &&str| {
            line.split_once(" = ").is_some_and(|(name, _)| settings().any(|known| known == name))
        };
        let shown: Vec<&str> =
            text.lines().filter_map(|line| line.strip_prefix("# ")).filter(is_option).collect();
        file::parse("agent.toml", &shown.join("\n")).unwrap();
        for name in settings() {
            assert!(shown.iter().any(|line| line.starts_with(&format!("{name} = "))), "{name} is missing");
        }
        // the defaults are the true ones
        let mut options = Options::default();
        for line in shown.iter().filter(|line| {
            !["terrain", "plan", "state_dir", "signing_key"].iter().any(|n| line.starts_with(n))
        }) {
            options = options.over(file::parse("agent.toml", line).unwrap());
        }
        let (shown, usual) = (options.gateway().unwrap(), Options::default().gateway().unwrap());
        assert_eq!(
            (shown.vehicle, shown.listen, shown.autopilots),
            (usual.vehicle, usual.listen, usual.autopilots)
        );
        assert_eq!((shown.driver.name, shown.profile.name), (usual.driver.name, usual.profile.name));
    }

    #[test]
    fn all_that_is_wrong_with_a_file_is_said_at_once() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("agent.toml");
        let text = "aircraft = 'zeppelin'\nautopilot = 'pigeon'\nlisten = 'tcp/0.0.0.0:1'\nplan = 'nowhere.xml'\nvehicle = 'v'\n";
        std::fs::write(&path, text).unwrap();
        let told = format!("{:#}", check_file(&path).unwrap_err());
        assert_eq!(told.lines().count(), 4, "{told}");
        for (line, says) in
            told.lines().zip(["1:12: --aircraft", "2:13: --autopilot", "3:10: --listen", "nowhere.xml"])
        {
            assert!(line.contains(says), "{told}");
        }
    }

    #[test]
    fn unusable_values_are_named() {
        for (line, told) in [
            ("onboard-agent run --aircraft zeppelin", "zeppelin"),
            ("onboard-agent run --terrain nowhere/N36W085.hgt", "N36W085.hgt"),
            ("onboard-agent run --plan nowhere.xml", "nowhere.xml"),
        ] {
            let error = parse(line).fp_manager().err().expect(line);
            assert!(format!("{error:#}").contains(told), "{error:#}");
        }
        assert!(parse("onboard-agent run --autopilot carrier-pigeon").gateway().is_err());
        assert!(parse("onboard-agent run --listen tcp/0.0.0.0:7447").gateway().is_err());
    }

    #[test]
    fn every_driver_is_chosen_by_its_name_and_an_unknown_name_gives_the_list() {
        use clap::CommandFactory;
        let chosen = |line: &str| parse(line).gateway().map(|config| config.driver.name);
        for known in driver::DRIVERS {
            let line = format!("onboard-agent gateway --driver {}", known.name);
            assert_eq!(chosen(&line).unwrap(), known.name);
        }
        assert_eq!(chosen("onboard-agent gateway").unwrap(), "mavlink");
        let error = format!("{:#}", chosen("onboard-agent gateway --driver kite").unwrap_err());
        assert!(error.contains("`kite`") && error.contains(&driver::names()), "{error}");
        let mut command = Cli::command();
        let help = command.find_subcommand_mut("run").unwrap().render_long_help().to_string();
        assert!(help.contains(&driver_help()), "{help}");
    }
}
