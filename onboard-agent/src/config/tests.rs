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
    let options =
        parse(&format!("onboard-agent run --vehicle line --config {}", path.display())).completed().unwrap();
    assert_eq!(options.vehicle.as_deref(), Some("line"));
    assert_eq!(options.state_dir.as_deref(), Some(Path::new("kept")));
    assert_eq!(options.simulated, Some(true));
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
    check_file(Path::new(example), &Options::default()).unwrap();
    let is_option =
        |line: &&str| line.split_once(" = ").is_some_and(|(name, _)| settings().any(|known| known == name));
    let shown: Vec<&str> =
        text.lines().filter_map(|line| line.strip_prefix("# ")).filter(is_option).collect();
    file::parse("agent.toml", &shown.join("\n")).unwrap();
    for name in settings() {
        assert!(shown.iter().any(|line| line.starts_with(&format!("{name} = "))), "{name} is missing");
    }
    // the defaults are the true ones
    let mut options = Options::default();
    for line in shown
        .iter()
        .filter(|line| !["terrain", "plan", "state_dir", "signing_key"].iter().any(|n| line.starts_with(n)))
    {
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
    let told = format!("{:#}", check_file(&path, &Options::default()).unwrap_err());
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

/// The unit gives the state directory by the environment, and checks the file first.
#[test]
fn a_file_is_checked_together_with_the_environment() {
    let directory = tempfile::tempdir().unwrap();
    for (name, text) in [("agent.toml", "tlog = true\n"), ("agent.json", r#"{"tlog": true}"#)] {
        let path = directory.path().join(name);
        std::fs::write(&path, text).unwrap();
        assert!(check_file(&path, &Options::default()).is_err(), "logs need a folder");
        let environment = Options { state_dir: Some("kept".into()), ..Options::default() };
        check_file(&path, &environment).unwrap();
    }
}

#[test]
fn what_is_switched_off_nearer_stays_off() {
    let file = file::parse("agent.toml", "insecure = true\nsimulated = true\ntlog = true\n").unwrap();
    let variables = [("LEGWORK_INSECURE", "false"), ("LEGWORK_TLOG", "no")];
    let variable =
        |name: &str| variables.iter().find(|(known, _)| *known == name).map(|(_, value)| value.into());
    let options = environment::options(variable).unwrap().over(file);
    assert_eq!((options.insecure, options.tlog, options.simulated), (Some(false), Some(false), Some(true)));
    let options = parse("onboard-agent run --insecure --simulated=off").over(options);
    assert_eq!((options.insecure, options.simulated), (Some(true), Some(false)));
}

/// Each of them was taken, and the service that it is for died every five seconds.
#[test]
fn what_no_service_could_start_with_is_found_by_check_config() {
    let directory = tempfile::tempdir().unwrap();
    let (path, no_plan) = (directory.path().join("agent.toml"), directory.path().join("plan.xml"));
    std::fs::write(&no_plan, "a host's name").unwrap();
    let plan = format!("plan = '{}'", no_plan.display());
    for (line, says) in [
        ("vehicle = 'uav 1/*'", "--vehicle"),
        ("vehicle = ''", "--vehicle"),
        ("listen = 'tcp/127.0.0.1:70000'", "--listen tcp/127.0.0.1:70000"),
        ("connect = 'foo'", "--connect foo"),
        ("autopilot = ['udp:127.0.0.1:1', 'udp:127.0.0.1:1']", "twice"),
        (plan.as_str(), "--plan"),
    ] {
        std::fs::write(&path, line).unwrap();
        let error = format!("{:#}", check_file(&path, &Options::default()).unwrap_err());
        assert!(error.contains(says), "{line}: {error}");
    }
    std::fs::write(&path, "vehicle = 'uav-1'\nlisten = 'tcp/[::1]:7447'\nconnect = 'tcp/localhost:7447'\n")
        .unwrap();
    check_file(&path, &Options::default()).unwrap();
}
