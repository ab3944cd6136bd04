//! Pure: options from the environment, `LEGWORK_STATE_DIR` for `--state-dir`.

use super::Options;
use clap::{Arg, ArgAction, Args, Command, FromArgMatches};
use std::ffi::{OsStr, OsString};

/// What the variables' names begin with.
pub const PREFIX: &str = "LEGWORK_";

/// What is said of them with the options.
pub const HELP: &str = "Every option can also stand in the environment (LEGWORK_STATE_DIR for --state-dir; several values with `;` between them) or \
in the file that --config names. The command line counts first, then the environment, then the file. An annotated file: \
assets/onboard-agent/agent.toml.";

/// The options that variables set; `read` gives a variable's value.
///
/// # Errors
/// Values can't be used: a line for each.
pub fn options(read: impl Fn(&str) -> Option<OsString>) -> anyhow::Result<Options> {
    let (mut options, mut wrong) = (Options::default(), vec![]);
    for option in Options::augment_args(Command::new("environment")).get_arguments() {
        let name = format!("{PREFIX}{}", option.get_id().as_str().to_uppercase());
        let Some(value) = read(&name).filter(|value| !value.is_empty() && !option.is_hide_set()) else {
            continue;
        };
        match set(option, &value) {
            Ok(set) => options = options.over(set),
            Err(why) => wrong.push(format!("{name}: {why}")),
        }
    }
    anyhow::ensure!(wrong.is_empty(), "{}", wrong.join("\n"));
    Ok(options)
}

/// As if it had been given on the command line.
fn set(option: &Arg, value: &OsStr) -> Result<Options, String> {
    let name = format!("--{}", option.get_long().unwrap_or_default());
    let typed = |value: &OsStr| {
        let mut typed = OsString::from(format!("{name}="));
        typed.push(value);
        typed
    };
    let line: Vec<OsString> = match option.get_action() {
        // addresses have colons, and paths may
        ArgAction::Append => match value.to_str() {
            Some(values) => values.split(';').map(|value| typed(OsStr::new(value))).collect(),
            None => vec![typed(value)],
        },
        _ => vec![typed(value)],
    };
    let command = Options::augment_args(Command::new("environment")).no_binary_name(true);
    let matches = command.try_get_matches_from(line).and_then(|matches| Options::from_arg_matches(&matches));
    matches.map_err(|error| {
        let text = error.to_string();
        text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn from(pairs: &[(&str, &str)]) -> anyhow::Result<Options> {
        options(|name| pairs.iter().find(|(known, _)| *known == name).map(|(_, value)| value.into()))
    }

    #[test]
    fn variables_set_what_options_set() {
        let options = from(&[
            ("LEGWORK_STATE_DIR", "/var/lib/legwork"),
            ("LEGWORK_RECORD_QUOTA_MIB", "9"),
            ("LEGWORK_SIMULATED", "true"),
            ("LEGWORK_INSECURE", "no"),
            ("LEGWORK_TERRAIN", "a.hgt;b.hgt"),
            ("LEGWORK_VEHICLE", ""),
            ("LEGWORK_INSIDE", "/tmp/not/for/people"),
            ("LEGWORK_SEED", "of the tests"),
        ])
        .unwrap();
        let expected = Options {
            state_dir: Some("/var/lib/legwork".into()),
            record_quota_mib: Some(9),
            simulated: Some(true),
            insecure: Some(false),
            terrain: vec![Path::new("a.hgt").into(), Path::new("b.hgt").into()],
            ..Options::default()
        };
        assert_eq!(options, expected);
        assert_eq!(from(&[]).unwrap(), Options::default());
    }

    #[test]
    fn every_value_that_cannot_be_used_is_told_with_its_variable() {
        let told = from(&[("LEGWORK_RECORD_QUOTA_MIB", "much"), ("LEGWORK_SIMULATED", "perhaps")]);
        let told = told.unwrap_err().to_string();
        let lines: Vec<&str> = told.lines().collect();
        assert_eq!(lines.len(), 2, "{told}");
        assert!(
            lines.iter().any(|line| line.starts_with("LEGWORK_RECORD_QUOTA_MIB: ") && line.contains("much"))
        );
        assert!(
            lines.iter().any(|line| line.starts_with("LEGWORK_SIMULATED: ") && line.contains("boolean")),
            "{told}"
        );
    }
}
