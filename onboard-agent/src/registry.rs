//! The services aboard: a new one is a line here. Command line, supervisor and descriptions follow.

use crate::config::Options;
use crate::services::storage;
use crate::{Shutdown, fp_manager, gateway};
use std::fmt;
use std::pin::Pin;
use usal::{Spec, spec};

/// A service that runs once it is awaited.
pub type Running = Pin<Box<dyn Future<Output = anyhow::Result<()>> + Send>>;

/// A service aboard.
pub struct Entry {
    /// What it is called and says.
    pub spec: &'static Spec,
    /// With these options `run` starts it.
    pub is_wanted: fn(&Options) -> bool,
    /// Asked to end, it may stay for as long as an aircraft needs it.
    pub may_stay: bool,
    /// Makes it of the options, unless these are wrong.
    pub start: fn(&Options, Shutdown) -> anyhow::Result<Running>,
}

/// The services aboard, in the order in which they are started.
pub const SERVICES: &[Entry] = &[
    Entry {
        spec: &spec::GATEWAY,
        is_wanted: |_| true,
        may_stay: true,
        start: |options, end| Ok(Box::pin(gateway::run(options.gateway()?, end))),
    },
    Entry {
        spec: &spec::FP_MANAGER,
        is_wanted: |_| true,
        may_stay: false,
        start: |options, end| Ok(Box::pin(fp_manager::run(options.fp_manager()?, end))),
    },
    Entry {
        spec: &spec::STORAGE,
        // without a folder there is nowhere to record to
        is_wanted: |options| options.state_dir.is_some(),
        may_stay: false,
        start: |options, end| {
            Ok(Box::pin(storage::run(options.storage()?, storage::Monitor::default(), end)))
        },
    },
];

impl fmt::Debug for Entry {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.spec.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
    use clap::CommandFactory;
    use usal::contract::Kind;

    #[test]
    fn help_says_what_each_service_is_in_words_for_who_runs_it() {
        let help = Cli::command().render_long_help().to_string();
        for spec in spec::SERVICES {
            assert!(help.contains(spec.about), "`{}` is missing: {help}", spec.name);
        }
        let first = help.lines().next().unwrap_or_default();
        assert!(first.contains("flight recorder") && !first.starts_with("Shell"), "{first}");
    }

    /// What is aboard is in the contract, in its order; the command line names it; what it follows is said by somebody.
    #[test]
    fn services_aboard_are_those_of_the_contract_and_of_the_command_line() {
        let names = |specs: &[&Spec]| specs.iter().map(|spec| spec.name).collect::<Vec<_>>();
        let aboard: Vec<&Spec> = SERVICES.iter().map(|entry| entry.spec).collect();
        assert_eq!(names(&aboard), names(spec::SERVICES));
        let command = Cli::command();
        let told: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        let expected =
            ["run"].into_iter().chain(names(spec::SERVICES)).chain(["describe", "check-config", "doctor"]);
        assert_eq!(told, expected.collect::<Vec<_>>());
        let followed = service::followed::<fp_manager::FpManager>();
        assert!(followed.iter().any(|topic| topic.kind == Kind::Event));
        for topic in followed {
            let whose = spec::SERVICES.iter().find(|spec| spec.name == topic.service).unwrap();
            assert!(whose.says.iter().any(|s| (s.kind, s.name) == (topic.kind, topic.name)), "{topic:?}");
        }
    }
}
