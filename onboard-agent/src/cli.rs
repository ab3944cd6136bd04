//! The command line: what the agent can do.

use crate::config::{Options, environment};
use crate::registry::{Entry, SERVICES};
use clap::error::ErrorKind;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, Parser, Subcommand, value_parser};
use std::path::PathBuf;

/// The argument of `check-config`.
const CONFIG_FILE: &str = "file";

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
    /// Say what is wrong with a configuration file.
    CheckConfig(PathBuf),
    /// Say whether the autopilot is ready to fly a plan, and what to change.
    Doctor(Options),
}

impl FromArgMatches for Task {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let missing = || clap::Error::new(ErrorKind::MissingSubcommand);
        let (name, matches) = matches.subcommand().ok_or_else(missing)?;
        match name {
            "run" => Ok(Self::Run(Options::from_arg_matches(matches)?)),
            "describe" => Ok(Self::Describe),
            "check-config" => {
                let file = matches.get_one::<PathBuf>(CONFIG_FILE).ok_or_else(missing)?;
                Ok(Self::CheckConfig(file.clone()))
            }
            "doctor" => Ok(Self::Doctor(Options::from_arg_matches(matches)?)),
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
        let with_options = |name: &'static str, about: String| {
            Options::augment_args(Command::new(name)).about(about).after_help(environment::HELP)
        };
        let run = with_options("run", "Run every service in a process of its own; restart what dies".into());
        let services =
            SERVICES.iter().map(|entry| with_options(entry.spec.name, format!("Run {}", entry.spec.about)));
        let describe = Command::new("describe");
        let describe = describe.about("Print the services' descriptions with their JSON Schemas");
        let file = Arg::new(CONFIG_FILE).value_name("FILE").required(true);
        let file = file.value_parser(value_parser!(PathBuf)).help("The configuration file (TOML, or JSON)");
        let check = Command::new("check-config").arg(file);
        let check = check.about("Say what is wrong with a configuration file, if anything; starts nothing");
        let doctor = "Look the autopilot over: whether it is ready to fly a plan, and what to change; changes no setting";
        let doctor = with_options("doctor", doctor.into());
        command.subcommand(run).subcommands(services).subcommands([describe, check, doctor])
    }

    fn augment_subcommands_for_update(command: Command) -> Command {
        Self::augment_subcommands(command)
    }

    fn has_subcommand(name: &str) -> bool {
        ["run", "describe", "check-config", "doctor"].contains(&name)
            || SERVICES.iter().any(|entry| entry.spec.name == name)
    }
}
