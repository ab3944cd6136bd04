//! What the agent is started with: command line over configuration file over defaults.

use crate::gateway::driver::{self, Registration};
use crate::inside::Address;
use crate::registry::{Entry, SERVICES};
use crate::services::storage;
use crate::{exposure, fp_manager, gateway, supervisor};
use aircraft::Profile;
use anyhow::{Context, bail};
use clap::error::ErrorKind;
use clap::{ArgMatches, Args, Command, FromArgMatches, Parser, Subcommand};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use terrain::{Terrain, Tile, Tiles};

/// Larger plans and configurations are not read, bytes.
const FILE_MAX: u64 = 64 << 20;
/// Folder of the recordings in the state directory.
const RECORDINGS: &str = "recordings";
const DEFAULT_VEHICLE: &str = "uav1";
const DEFAULT_AUTOPILOT: &str = "udp:127.0.0.1:14550";
const DEFAULT_AIRCRAFT: &str = "trainer";

/// Legwork's onboard agent: FCS Gateway, FP Manager and storage, the flight recorder.
#[derive(Debug, Parser)]
#[command(name = "onboard-agent", version)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub task: Task,
}

/// What the agent can do.
#[derive(Debug)]
pub enum Task {
    /// Run every service in a process of its own; restart what dies.
    Run(Options),
    /// Run one of them alone.
    Service(&'static Entry, Options),
    /// Print the services' descriptions with their JSON Schemas.
    Describe,
}

impl FromArgMatches for Task {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let missing = || clap::Error::new(ErrorKind::MissingSubcommand);
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        match name {
            "run" => Ok(Self::Run(Options::from_arg_matches(matches)?)),
            "describe" => Ok(Self::Describe),
            name => {
                let entry = SERVICES.iter().find(|entry| entry.spec.name == name).ok_or_else(missing)?;
                Ok(Self::Service(entry, Options::from_arg_matches(matches)?))
            }
        }
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Subcommand for Task {
    fn augment_subcommands(command: Command) -> Command {
        let with_options =
            |name: &'static str, about: String| Options::augment_args(Command::new(name)).about(about);
        let run = with_options("run", "Run every service in a process of its own; restart what dies".into());
        let services =
            SERVICES.iter().map(|entry| with_options(entry.spec.name, format!("Run {}", entry.spec.about)));
        let describe = Command::new("describe");
        let describe = describe.about("Print the services' descriptions with their JSON Schemas");
        command.subcommand(run).subcommands(services).subcommand(describe)
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        Self::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        ["run", "describe"].contains(&name) || SERVICES.iter().any(|entry| entry.spec.name == name)
    }
}

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
    /// The autopilot: udp:HOST:PORT (listen there), udpout:HOST:PORT or tcp:HOST:PORT [default: udp:127.0.0.1:14550].
    #[arg(long, value_name = "ADDRESS")]
    pub autopilot: Option<String>,
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
    /// Configuration file (JSON) for what is not given here.
    #[arg(long, value_name = "FILE")]
    #[serde(skip)]
    pub config: Option<PathBuf>,
    /// Time is the simulator's, in lockstep.
    #[arg(long)]
    pub simulated: bool,
    /// The socket by which the vehicle's own services reach the gateway; `run` tells it to them.
    #[arg(long, value_name = "SOCKET", hide = true)]
    #[serde(skip)]
    pub inside: Option<PathBuf>,
}

impl Options {
    /// These options, completed from the configuration file they name.
    ///
    /// # Errors
    /// The file can't be read or says something unknown.
    pub fn completed(self) -> anyhow::Result<Self> {
        let Some(path) = &self.config else { return Ok(self) };
        let bytes = read(path)?;
        let file: Self = serde_json::from_slice(&bytes).with_context(|| {
            format!("{}: correct it (`onboard-agent run --help` names the options)", path.display())
        })?;
        Ok(Self {
            vehicle: self.vehicle.or(file.vehicle),
            listen: self.listen.or(file.listen),
            insecure: self.insecure || file.insecure,
            connect: self.connect.or(file.connect),
            autopilot: self.autopilot.or(file.autopilot),
            driver: self.driver.or(file.driver),
            aircraft: self.aircraft.or(file.aircraft),
            terrain: if self.terrain.is_empty() { file.terrain } else { self.terrain },
            plan: self.plan.or(file.plan),
            state_dir: self.state_dir.or(file.state_dir),
            record_quota_mib: self.record_quota_mib.or(file.record_quota_mib),
            record_reserve_mib: self.record_reserve_mib.or(file.record_reserve_mib),
            config: None,
            simulated: self.simulated || file.simulated,
            inside: self.inside,
        })
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

    /// The gateway's configuration.
    ///
    /// # Errors
    /// An address, profile or tile can't be used.
    pub fn gateway(&self) -> anyhow::Result<gateway::Config> {
        exposure::allow(self.listen(), self.insecure)?;
        let autopilot = self.autopilot.as_deref().unwrap_or(DEFAULT_AUTOPILOT);
        Ok(gateway::Config {
            vehicle: self.vehicle().to_owned(),
            listen: self.listen().to_owned(),
            inside: self.inside.as_ref().map(Address::new),
            autopilot: autopilot.parse().context("--autopilot")?,
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
        let plan = self.plan.as_deref().map(read_text).transpose()?;
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
        let process = |entry: &Entry| supervisor::Process::new(entry.spec.name, arguments.clone());
        SERVICES.iter().filter(|entry| (entry.is_wanted)(self)).map(process).collect()
    }

    /// As they would be typed.
    fn arguments(&self) -> Vec<std::ffi::OsString> {
        let mut arguments = Vec::new();
        let texts = [
            ("--vehicle", &self.vehicle),
            ("--listen", &self.listen),
            ("--connect", &self.connect),
            ("--autopilot", &self.autopilot),
            ("--driver", &self.driver),
            ("--aircraft", &self.aircraft),
        ];
        for (name, value) in texts.into_iter().filter_map(|(name, value)| Some((name, value.as_ref()?))) {
            arguments.extend([name.into(), value.into()]);
        }
        let paths = [("--plan", &self.plan), ("--state-dir", &self.state_dir), ("--inside", &self.inside)];
        for (name, value) in paths.into_iter().filter_map(|(name, value)| Some((name, value.as_ref()?))) {
            arguments.extend([name.into(), value.into()]);
        }
        let sizes = [
            ("--record-quota-mib", self.record_quota_mib),
            ("--record-reserve-mib", self.record_reserve_mib),
        ];
        for (name, value) in sizes.into_iter().filter_map(|(name, value)| Some((name, value?))) {
            arguments.extend([name.into(), value.to_string().into()]);
        }
        for tile in &self.terrain {
            arguments.extend(["--terrain".into(), tile.into()]);
        }
        let flags = [("--insecure", self.insecure), ("--simulated", self.simulated)];
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
        let text = read_text(Path::new(name))?;
        Profile::from_json(&text).with_context(|| format!("--aircraft {name}"))
    }

    fn tiles(&self) -> anyhow::Result<Option<Tiles>> {
        let mut tiles = Tiles::new();
        for path in &self.terrain {
            let name = path
                .file_name()
                .and_then(|n| n.to_str())
                .context("--terrain: a tile's name, like N36W085.hgt")?;
            let tile = Tile::from_hgt(name, &read(path)?)
                .with_context(|| format!("--terrain {}", path.display()))?;
            tiles.add(tile);
        }
        Ok((!self.terrain.is_empty()).then_some(tiles))
    }
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

    fn parse(line: &str) -> Options {
        match Cli::try_parse_from(line.split(' ')).unwrap().task {
            Task::Run(options) | Task::Service(_, options) => options,
            Task::Describe => panic!("no options"),
        }
    }

    #[test]
    fn every_option_reaches_the_children() {
        let line = "onboard-agent run --vehicle v --listen tcp/127.0.0.1:1 --connect tcp/127.0.0.1:2 --autopilot tcp:h:3 --driver d \
                    --aircraft trainer --plan p.xml --state-dir s --record-quota-mib 9 --record-reserve-mib 8 --terrain a.hgt --terrain b.hgt --inside i.sock --insecure --simulated";
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
        let path = directory.path().join("agent.json");
        std::fs::write(&path, r#"{"vehicle": "file", "state_dir": "kept", "simulated": true}"#).unwrap();
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
