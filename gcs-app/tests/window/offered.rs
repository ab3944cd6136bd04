//! Whatever can be asked for is in the palette: each command is really offered, in one of these states of the window.

use super::considering::considered;
use super::emergency::in_emergency;
use super::fleet::two;
use super::flying::{connected, flying, flying_its_plan, report};
use super::recovering::{edit_and_kill, window_in};
use super::vehicle::{decision, status};
use super::{SQUARE, Window, announcing};
use flight_exec::{EntryReport, Phase, ProposalReport};
use gcs_app::command::Command;
use gcs_app::layers::State;
use gcs_app::link::Reply;
use gcs_app::story::{End, Story};
use std::collections::BTreeSet;
use usal::contract::GatewayState;

/// What is no command of its own: why, and which ones.
const ELSEWHERE: [(&str, &[&str]); 5] = [
    (
        "the keyboard is in a dialog that asks for it",
        &[
            "Document::Discard",
            "Document::SaveThen",
            "Document::Open",
            "Document::Browse",
            "Document::SaveTo",
            "Document::TakeImport",
            "Document::AddImport",
            "Document::ImportAs",
            "Document::AskExport",
            "Document::ExportTo",
            "Document::LoadTheirs",
            "Document::KeepMine",
            "Document::Recover",
            "Document::ForgetLeftBehind",
            "View::NameFile",
            "View::StopBrowsing",
            "View::KeepUnsaved",
            "View::PutImportAside",
            "View::PutExportAside",
        ],
    ),
    ("a tool of the map draws it", &["Document::AddRunway", "Document::DragEdit", "Document::EndGesture"]),
    (
        "it selects or points where something is shown",
        &[
            "View::PointOut",
            "View::Toggle",
            "View::SelectTogether",
            "View::SelectBranch",
            "View::JumpToPlace",
            "View::KeepToast",
        ],
    ),
    ("a field or slider has the keyboard", &["Preview::Scrub", "Preview::WhatIf"]),
    ("nobody asks for it", &["Document::Dropped", "View::Notice", "View::Toast"]),
];

/// `View::Fit` of all commands.
fn commands() -> Vec<String> {
    let (source, layers) = (include_str!("../../src/command.rs"), include_str!("../../src/layers/mod.rs"));
    let of = |name: &str| {
        let source = if name == "Layer" { layers } else { source };
        let begin = source.find(&format!("pub enum {name}Command {{")).unwrap();
        let body = &source[begin..begin + source[begin..].find("\n}").unwrap()];
        let variants = body.lines().filter_map(|line| line.strip_prefix("    "));
        let variants = variants.filter(|line| line.starts_with(|c: char| c.is_ascii_uppercase()));
        let is_name = |c: char| !c.is_ascii_alphanumeric();
        variants.map(|line| format!("{name}::{}", line.split(is_name).next().unwrap())).collect::<Vec<_>>()
    };
    ["Document", "View", "Preview", "Link", "Layer", "Fly"].into_iter().flat_map(of).collect()
}

/// `View::Fit` of a command; of several in a row those.
fn names(command: &Command) -> Vec<String> {
    let (kind, debug) = match command {
        Command::Document(command) => ("Document", format!("{command:?}")),
        Command::View(command) => ("View", format!("{command:?}")),
        Command::Preview(command) => ("Preview", format!("{command:?}")),
        Command::Link(command) => ("Link", format!("{command:?}")),
        Command::Fly(command) => ("Fly", format!("{command:?}")),
        Command::Layer(command) => ("Layer", format!("{command:?}")),
        Command::Each(commands) => return commands.iter().flat_map(names).collect(),
    };
    let is_name = |c: char| !c.is_ascii_alphanumeric();
    vec![format!("{kind}::{}", debug.split(is_name).next().unwrap())]
}

/// What the palette offers now.
fn offered(window: &Window) -> Vec<String> {
    let actions = window.app().offered(window.harness.ctx.input(|i| i.time), jiff::Timestamp::UNIX_EPOCH);
    actions.iter().filter_map(|action| action.command.as_ref().ok()).flat_map(names).collect()
}

/// In plans that nobody flies.
fn planning(found: &mut BTreeSet<String>) {
    let mut window = Window::open(super::creating::EMPTY);
    window.steps(3);
    found.extend(offered(&window));
    window.click("Among the example's hills");
    found.extend(offered(&window));
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    for row in ["TF side2", "ENR circuit", "FIX C", "RWY R05", "ALT return"] {
        window.select_row((row, 0));
        window.steps(2);
        found.extend(offered(&window));
    }
    window.select_row(("TF side2", 0));
    window.select_row_with(("TF side3", 0), egui::Modifiers::COMMAND);
    window.steps(2);
    window.press(egui::Key::Delete);
    window.paste("nowhere at all");
    let story = Story::default();
    window.harness.state_mut().listen_to(story.clone());
    let work = story.work("Making the report");
    window.steps(30);
    found.extend(offered(&window));
    drop(work);
    story.end("It went wrong", End { good: false, report: Some("report".into()) });
    window.press_ctrl(egui::Key::Z);
    found.extend(offered(&window));
    let folder = tempfile::tempdir().unwrap();
    edit_and_kill(folder.path());
    found.extend(offered(&window_in(folder.path(), "")));
}

/// With two maps, one above the other.
fn over_maps(found: &mut BTreeSet<String>) {
    let folder = tempfile::tempdir().unwrap();
    let mut window = Window::open(SQUARE);
    window.until_analysed();
    for name in ["below.mbtiles", "above.mbtiles"] {
        let path = folder.path().join(name);
        super::maps::world(&path);
        super::maps::drop_file(&mut window, &path);
    }
    window.until("two maps", |app| {
        app.layers().iter().filter(|layer| matches!(layer.state, State::Map(..))).count() == 2
    });
    found.extend(offered(&window));
}

/// Connected, on the ground and in the air.
fn in_flight(found: &mut BTreeSet<String>) {
    let (mut window, hash) = connected();
    while window.asked().is_some() {}
    found.extend(offered(&window));
    window.click("Push");
    let (ticket, _) = window.asked().unwrap();
    let position = geometry::LatLon::new(36.3, -84.2);
    let entry = EntryReport { leg: "side3".into(), position, in_m: 900.0, in_s: 36.0 };
    let proposed = ProposalReport { entry_needed: true, entries: vec![entry], ..report(&hash, true) };
    window.answer(ticket, Ok(Reply::Proposal(Box::new(proposed))));
    found.extend(offered(&window));
    let (mut window, value) = flying();
    window.receive_position(true);
    window.receive_gateway_state(GatewayState::Stop);
    window.receive_status(value);
    found.extend(offered(&window));
    window.click("⏸ Hold");
    let (ticket, _) = std::iter::from_fn(|| window.asked()).last().unwrap();
    window.answer(ticket, Err("not now".into()));
    window.receive_gateway_state(GatewayState::SafeHold);
    found.extend(offered(&window));
    window.receive_status(status(Phase::Idle));
    found.extend(offered(&window));
    let mut window = flying_its_plan();
    let mut value = window.app().vehicle().status.as_ref().unwrap().value.clone();
    value.decision = Some(decision(None));
    window.receive_status(value);
    found.extend(offered(&window));
    window.send(announcing::event(9, announcing::taken("ask", "default")));
    window.steps(2);
    found.extend(offered(&window));
    for window in [considered().0, in_emergency(), two()] {
        found.extend(offered(&window));
    }
}

#[test]
fn every_command_is_in_the_palette_or_it_is_said_where_it_is() {
    let all = commands();
    assert!(all.len() > 90, "{all:?}");
    let elsewhere: BTreeSet<&str> = ELSEWHERE.iter().flat_map(|(_, commands)| *commands).copied().collect();
    let mut found = BTreeSet::new();
    planning(&mut found);
    over_maps(&mut found);
    in_flight(&mut found);
    let missing: Vec<_> = all
        .iter()
        .filter(|command| !found.contains(*command) && !elsewhere.contains(command.as_str()))
        .collect();
    assert!(missing.is_empty(), "nowhere in the palette: {missing:?}");
    let offered_too: Vec<_> = elsewhere.iter().filter(|command| found.contains(**command)).collect();
    assert!(offered_too.is_empty(), "in the palette all the same: {offered_too:?}");
    let gone: Vec<_> = elsewhere.iter().filter(|command| !all.iter().any(|c| c == *command)).collect();
    assert!(gone.is_empty(), "{gone:?}");
}
