//! The actions, one a line: group, identifier, name, kind, keys, and what it asks for or why it can't.

use super::{Action, Group, Kind, bindings, flight, layers};
use crate::command::{
    BranchId, Clip, Command, DocumentCommand, FlyCommand, PreviewCommand, Replacement, Selection, ViewCommand,
};
use crate::guide::Answer;
use crate::help::topic_of;
use crate::layers::LayerCommand;
use crate::map::furniture::Edge;
use crate::panels::tree::Renamed;
use crate::panels::tree::menu::NOT_ONE_LIST;
use crate::panels::{Scene, bar, flight as panel, start};
use crate::theme::Scale;
use crate::units::Units;
use egui::{Key, KeyboardShortcut, Modifiers, ThemePreference};
use flight_exec::Command as PlanCommand;
use flight_plan::{Cause, Id, create};
use interchange::Format;

/// What an action asks for; or why it is not possible now.
pub(super) type Asked = Result<Command, &'static str>;

/// An action as it is written down.
pub struct Entry {
    group: Group,
    pub id: &'static str,
    pub name: &'static str,
    kind: fn(&Scene<'_>) -> Kind,
    pub keys: &'static [KeyboardShortcut],
    ask: fn(&Scene<'_>) -> Asked,
    caution: fn(&Scene<'_>) -> Option<&'static str>,
}

impl Entry {
    /// As it is now.
    pub fn action(&self, scene: &Scene<'_>) -> Action {
        Action {
            id: self.id.into(),
            name: self.name.into(),
            group: self.group,
            kind: (self.kind)(scene),
            keys: self.keys.to_vec(),
            while_typing: self.group != Group::Edit && self.keys.iter().all(|key| !is_plain(key)),
            caution: (self.caution)(scene),
            command: (self.ask)(scene).map_err(Into::into),
        }
    }
}

/// A key that types something.
fn is_plain(key: &KeyboardShortcut) -> bool {
    key.modifiers.is_none() && !(Key::F1..=Key::F12).contains(&key.logical_key)
}

const fn plain(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::NONE, key)
}
const fn ctrl(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}
const fn ctrl_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}
const fn with_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::SHIFT, key)
}

const fn alt(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::ALT, key)
}

const DO: fn(&Scene<'_>) -> Kind = |_| Kind::Do;
const HOLD: fn(&Scene<'_>) -> Kind = |_| Kind::Hold;
const NONE: fn(&Scene<'_>) -> Option<&'static str> = |_| None;

const fn entry(
    group: Group,
    id: &'static str,
    name: &'static str,
    keys: &'static [KeyboardShortcut],
    ask: fn(&Scene<'_>) -> Asked,
) -> Entry {
    Entry { group, id, name, kind: DO, keys, ask, caution: NONE }
}

const fn choice(
    group: Group,
    id: &'static str,
    name: &'static str,
    kind: fn(&Scene<'_>) -> Kind,
    ask: fn(&Scene<'_>) -> Asked,
) -> Entry {
    Entry { group, id, name, kind, keys: &[], ask, caution: NONE }
}

const fn hold(id: &'static str, name: &'static str, ask: fn(&Scene<'_>) -> Asked) -> Entry {
    Entry { group: Group::Flight, id, name, kind: HOLD, keys: &[], ask, caution: NONE }
}

/// All of them, in the order of the menus.
#[rustfmt::skip]
pub const ENTRIES: &[Entry] = &[
    entry(Group::File, "new", "New", &[ctrl(Key::N)], |_| document(DocumentCommand::Replace(Replacement::New))),
    entry(Group::File, "open", "Open…", &[ctrl(Key::O)], |_| document(DocumentCommand::Replace(Replacement::AskOpen))),
    entry(Group::File, "save", "Save", &[ctrl(Key::S)], |_| document(DocumentCommand::Save)),
    entry(Group::File, "save-as", "Save as…", &[ctrl_shift(Key::S)], |_| document(DocumentCommand::AskSaveAs)),
    entry(Group::File, "import", "Import…", &[], |_| document(DocumentCommand::Replace(Replacement::AskImport))),
    entry(Group::File, "recover", "Recover unsaved changes…", &[], recover),
    entry(Group::Export, "export-plan", "Export as QGC plan…", &[], |s| export(s, Format::Plan)),
    entry(Group::Export, "export-waypoints", "Export as WPL waypoints…", &[], |s| export(s, Format::Waypoints)),
    entry(Group::Export, "export-kml", "Export as KML…", &[], |s| export(s, Format::Kml)),
    entry(Group::Export, "export-kmz", "Export as KMZ…", &[], |s| export(s, Format::Kmz)),
    entry(Group::Export, "export-geojson", "Export as GeoJSON…", &[], |s| export(s, Format::GeoJson)),
    entry(Group::Export, "export-gpx", "Export as GPX…", &[], |s| export(s, Format::Gpx)),
    entry(Group::Export, "export-csv", "Export as CSV…", &[], |s| export(s, Format::Csv)),
    entry(Group::File, "take-aboard", "Take the plan aboard", &[], take_aboard),
    entry(Group::Quit, "quit", "Quit", &[ctrl(Key::Q)], |_| document(DocumentCommand::Replace(Replacement::Quit))),

    entry(Group::Edit, "undo", "Undo", &[ctrl(Key::Z)], undo),
    entry(Group::Edit, "redo", "Redo", &[ctrl_shift(Key::Z), ctrl(Key::Y)], redo),
    entry(Group::Edit, "copy", "Copy", &[ctrl(Key::C)], |s| clip(s, Clip::Copy)),
    entry(Group::Edit, "cut", "Cut", &[ctrl(Key::X)], |s| clip(s, Clip::Cut)),
    entry(Group::Edit, "paste", "Paste", &[ctrl(Key::V)], |_| view(ViewCommand::Clip(Clip::Paste))),
    entry(Group::Edit, "duplicate", "Duplicate what is selected", &[ctrl(Key::D)], |s| clip(s, Clip::Duplicate)),
    entry(Group::Edit, "delete", "Delete what is selected", &[plain(Key::Delete)], delete),
    entry(Group::Edit, "rename", "Rename what is selected", &[plain(Key::F2)], rename),
    entry(Group::Edit, "row-menu", "Open the menu of what is selected", &[with_shift(Key::F10), plain(Key::Menu)], row_menu),
    entry(Group::Edit, "earlier", "Move what is selected up", &[ctrl(Key::ArrowUp), alt(Key::ArrowUp)], |scene| shift(scene, -1)),
    entry(Group::Edit, "later", "Move what is selected down", &[ctrl(Key::ArrowDown), alt(Key::ArrowDown)], |scene| shift(scene, 1)),
    entry(Group::Edit, "new-way", "Draw a new way from the selected leg", &[plain(Key::W)], new_way),
    entry(Group::Edit, bindings::ID, "Bind the selected leg to a variable…", &[plain(Key::B)], bind),
    entry(Group::Edit, "select-all-legs", "Select all legs", &[ctrl(Key::A)], |s| has_legs(s).and_then(|()| view(ViewCommand::SelectAllLegs))),
    entry(Group::Edit, "raise-all", "Raise or lower all altitudes…", &[], raise_all),
    choice(Group::Edit, "lock", "Lock the plan against dragging", |s| Kind::Switch(s.view.locked), |s| view(ViewCommand::Lock(!s.view.locked))).with_keys(&[ctrl(Key::L)]),
    entry(Group::Edit, "select-nothing", "Close help, tour or card, or select nothing", &[plain(Key::Escape)], escape),
    entry(Group::View, "search", "Search in the plan", &[ctrl(Key::F)], |_| view(ViewCommand::Search)),

    entry(Group::View, "fit", "Show the whole plan", &[plain(Key::F)], |_| view(ViewCommand::Fit)),
    entry(Group::View, "zoom-in", "Zoom the map in", &[], |_| view(ViewCommand::Zoom(1.0))),
    entry(Group::View, "zoom-out", "Zoom the map out", &[], |_| view(ViewCommand::Zoom(-1.0))),
    choice(Group::View, "follow", "Follow the aircraft", |s| Kind::Switch(s.view.follow), follow),
    choice(Group::View, "play", "Play the preview", |s| Kind::Switch(s.view.playing), play).with_keys(&[plain(Key::Space)]),
    choice(Group::WhatIf, "coverage", "Coverage: the path by its worst alarm", |s| Kind::Switch(s.view.coverage), |s| preview(PreviewCommand::Coverage(!s.view.coverage))),
    choice(Group::WhatIf, "what-if-engine", "The engine fails here", |s| alarm_is(s, Cause::Engine), |s| raise(s, Cause::Engine)),
    choice(Group::WhatIf, "what-if-energy", "The energy is too low here", |s| alarm_is(s, Cause::Energy), |s| raise(s, Cause::Energy)),
    choice(Group::WhatIf, "what-if-link", "The link is lost here", |s| alarm_is(s, Cause::Link), |s| raise(s, Cause::Link)),
    choice(Group::WhatIf, "what-if-gps", "GPS is lost here", |s| alarm_is(s, Cause::Gps), |s| raise(s, Cause::Gps)),
    choice(Group::WhatIf, "what-if-operator", "The operator calls it off here", |s| alarm_is(s, Cause::Operator), |s| raise(s, Cause::Operator)),
    entry(Group::WhatIf, "what-if-reset", "Back to the plan's own world", &[], |_| preview(PreviewCommand::Reset)),
    entry(Group::Maps, "maps", "Maps and elevations…", &[], |_| view(ViewCommand::Maps(true))),
    entry(Group::Maps, "add-map-file", "Add a file of a map or of elevations…", &[], |_| layer(LayerCommand::Ask { folder: false })),
    entry(Group::Maps, "add-map-folder", "Add a folder of elevations…", &[], |_| layer(LayerCommand::Ask { folder: true })),
    entry(Group::Maps, layers::ADD, "Add a map by its path…", &[], |_| view(ViewCommand::Palette(Some(layers::QUERY)))),
    choice(Group::Maps, "graticule", "Graticule", |s| Kind::Switch(s.view.edge.graticule), |s| view(ViewCommand::Edge(Edge { graticule: !s.view.edge.graticule, ..s.view.edge }))),
    choice(Group::Maps, "legend", "Legend of the lines", |s| Kind::Switch(!s.view.edge.no_legend), |s| view(ViewCommand::Edge(Edge { no_legend: !s.view.edge.no_legend, ..s.view.edge }))),
    choice(Group::Maps, "rings", "Range rings", |s| Kind::Switch(s.view.edge.rings), |s| view(ViewCommand::Edge(Edge { rings: !s.view.edge.rings, ..s.view.edge }))),
    entry(Group::Panel, "next-panel", "Keyboard to the next panel", &[plain(Key::F6)], |_| view(ViewCommand::StepPanel(1))),
    entry(Group::Panel, "previous-panel", "Keyboard to the panel before", &[with_shift(Key::F6)], |_| view(ViewCommand::StepPanel(-1))),
    entry(Group::Panel, "default-layout", "Default layout", &[], |_| view(ViewCommand::ResetLayout)),

    choice(Group::Units, "units-si", Units::Si.label(), |s| Kind::Choice(s.units() == Units::Si), |_| view(ViewCommand::Units(Units::Si))),
    choice(Group::Units, "units-aviation", Units::Aviation.label(), |s| Kind::Choice(s.units() == Units::Aviation), |_| view(ViewCommand::Units(Units::Aviation))),

    choice(Group::Theme, "theme-dark", "Dark", |s| theme_is(s, ThemePreference::Dark), |_| view(ViewCommand::Theme(ThemePreference::Dark))),
    choice(Group::Theme, "theme-light", "Light", |s| theme_is(s, ThemePreference::Light), |_| view(ViewCommand::Theme(ThemePreference::Light))),
    choice(Group::Theme, "theme-system", "As the system", |s| theme_is(s, ThemePreference::System), |_| view(ViewCommand::Theme(ThemePreference::System))),

    entry(Group::Size, "larger", "Larger", &[ctrl(Key::Plus), ctrl(Key::Equals)], |s| scale(s, 1.0, "It can't be larger")),
    entry(Group::Size, "smaller", "Smaller", &[ctrl(Key::Minus)], |s| scale(s, -1.0, "It can't be smaller")),
    choice(Group::Size, "normal-size", "Normal size: 100 %", |s| is_scale(s, 1.0), |s| scale_to(s, 1.0)).with_keys(&[ctrl(Key::Num0)]),
    choice(Group::Size, "size-150", "Size 150 %", |s| is_scale(s, 1.5), |s| scale_to(s, 1.5)),
    choice(Group::Size, "size-200", "Size 200 %", |s| is_scale(s, 2.0), |s| scale_to(s, 2.0)),
    choice(Group::Size, "size-300", "Size 300 %", |s| is_scale(s, 3.0), |s| scale_to(s, 3.0)),

    entry(Group::Flight, "connect", "Connect as before", &[], flight::connect),
    entry(Group::Flight, flight::CONNECT_TO, "Connect to another address…", &[], |_| view(ViewCommand::Palette(Some(flight::QUERY)))),
    entry(Group::Flight, "disconnect", "Disconnect", &[], flight::disconnect),
    entry(Group::Flight, "push", "Push the plan to the vehicle", &[], |s| bar::may_push(s).map(|()| Command::Fly(FlyCommand::Propose))),
    entry(Group::Flight, "commit", "Commit what was pushed", &[], flight::commit),
    entry(Group::Flight, "keep-as-draft", "Keep what was pushed as a draft", &[], flight::keep_as_draft),
    entry(Group::Flight, "hold", "Hold now: the aircraft circles where it is", &[], flight::hold),
    entry(Group::Flight, "resume", "Resume", &[], flight::resume),
    hold("start", "Start and take off", flight::start).with_caution(panel::another_aboard),
    hold("rewind", "Rewind to the start", flight::rewind),
    entry(Group::Flight, "skip-leg", "Skip the leg…", &[], flight::skip),
    entry(Group::Flight, "return-to-main", "Return to the main plan…", &[], flight::return_to_main),
    hold("emergency", "Emergency: fly the alternate in force", |s| flight::emergency(s, None)),
    hold("abort", "Abort: Safe mode flies home", |s| flight::in_the_air(s, PlanCommand::AbortToSafe)),
    hold("leave-safe", "Leave Safe mode", flight::leave_safe),

    choice(Group::Help, "help", "Help about what is selected", |s| Kind::Switch(s.view.help.is_some()), help).with_keys(&[plain(Key::F1)]),
    entry(Group::Help, "tour", "Tour of the window", &[], |_| view(ViewCommand::Tour(Some(0)))),
    entry(Group::Help, "palette", "All commands…", &[ctrl(Key::K), ctrl_shift(Key::P)], |_| view(ViewCommand::Palette(Some("")))),
];

impl Entry {
    const fn with_keys(mut self, keys: &'static [KeyboardShortcut]) -> Self {
        self.keys = keys;
        self
    }

    const fn with_caution(mut self, caution: fn(&Scene<'_>) -> Option<&'static str>) -> Self {
        self.caution = caution;
        self
    }
}

fn document(command: DocumentCommand) -> Asked {
    Ok(Command::Document(command))
}

fn view(command: ViewCommand) -> Asked {
    Ok(Command::View(command))
}

fn layer(command: LayerCommand) -> Asked {
    Ok(Command::Layer(command))
}

fn recover(scene: &Scene<'_>) -> Asked {
    match scene.left_behind {
        Some(_) => view(ViewCommand::AskRecovery(true)),
        None => Err("The last window left nothing behind"),
    }
}

fn preview(command: PreviewCommand) -> Asked {
    Ok(Command::Preview(command))
}

/// The help lies over everything: it goes first, then the tour, then the card for a new mission.
fn escape(scene: &Scene<'_>) -> Asked {
    if scene.view.help.is_none() && scene.view.tour.is_none() && scene.vehicle.outlook.considered().is_some()
    {
        return Ok(Command::Fly(FlyCommand::PutAside));
    }
    view(match (&scene.view.help, scene.view.tour) {
        (Some(_), _) => ViewCommand::Help(None),
        (None, Some(_)) => ViewCommand::Tour(None),
        (None, None) if scene.view.selection.is_none() && start::is_wanted(scene) => {
            ViewCommand::Guide(Answer::Close)
        }
        (None, None) => ViewCommand::Select(None),
    })
}

fn alarm_is(scene: &Scene<'_>, cause: Cause) -> Kind {
    Kind::Switch(scene.view.alarm == Some(cause))
}

fn raise(scene: &Scene<'_>, cause: Cause) -> Asked {
    preview(PreviewCommand::Raise(Some(cause).filter(|_| scene.view.alarm != Some(cause))))
}

fn export(scene: &Scene<'_>, format: Format) -> Asked {
    if scene.document.plan().stages.is_empty() {
        return Err("There is nothing to be flown yet: add stages and legs first");
    }
    document(DocumentCommand::Export(format))
}

fn take_aboard(scene: &Scene<'_>) -> Asked {
    scene.vehicle.aboard.as_ref().ok_or("No plan aboard is known: connect first")?;
    Ok(Command::Fly(FlyCommand::TakeAboard))
}

fn undo(scene: &Scene<'_>) -> Asked {
    if scene.can_undo.0 { document(DocumentCommand::Undo) } else { Err("Nothing was changed yet") }
}

fn redo(scene: &Scene<'_>) -> Asked {
    if scene.can_undo.1 { document(DocumentCommand::Redo) } else { Err("Nothing was undone") }
}

const NOTHING: &str = "Select something of the plan first";

fn delete(scene: &Scene<'_>) -> Asked {
    let plan = scene.document.plan();
    if let Some(BranchId { fork, branch }) = scene.selected_branch() {
        let edit = create::delete_branch(plan, &fork, &branch)
            .ok_or("A fork keeps its last branch: delete the fork")?;
        return document(DocumentCommand::Edit(edit));
    }
    let edit = match &scene.view.selection {
        Some(_) if !scene.view.also.is_empty() => create::delete_set(plan, &scene.selected_set()),
        Some(Selection::Leg(first)) => {
            let mut legs = scene.selected_legs();
            // those of procedures are selected one by one
            legs.extend(plan.procedure_leg(first).filter(|_| legs.is_empty()).map(|_| first.clone()));
            create::delete_legs(plan, if legs.is_empty() { return Err(NOTHING) } else { &legs })
        }
        Some(other) => create::remove(plan, other.id()),
        None => return Err(NOTHING),
    };
    document(DocumentCommand::Edit(edit))
}

fn has_legs(scene: &Scene<'_>) -> Result<(), &'static str> {
    let has = scene.document.plan().all_stages().any(|(_, stage)| !stage.legs.is_empty());
    has.then_some(()).ok_or("The plan has no legs yet")
}

/// By how much is typed in the inspector.
fn raise_all(scene: &Scene<'_>) -> Asked {
    has_legs(scene)?;
    view(ViewCommand::RaiseAll)
}

/// What is selected, or all legs of a stage, to the clipboard.
fn clip(scene: &Scene<'_>, clip: Clip) -> Asked {
    let is_stage = matches!(scene.view.selection, Some(Selection::Stage(_)));
    let is_named =
        scene.view.also.is_empty() && scene.view.selection.as_ref().is_some_and(Selection::is_named);
    if scene.selected_things().is_empty() && !is_named && !(clip == Clip::Copy && is_stage) {
        return Err("Select legs or something else of the plan, or several stages, first");
    }
    view(ViewCommand::Clip(clip))
}

fn rename(scene: &Scene<'_>) -> Asked {
    if let Some(branch) = scene.selected_branch() {
        return view(ViewCommand::Rename(Renamed::Branch(branch)));
    }
    alone(scene)?;
    view(ViewCommand::Rename(Renamed::Part(scene.view.selection.clone().ok_or(NOTHING)?)))
}

fn row_menu(scene: &Scene<'_>) -> Asked {
    let is_any = scene.view.selection.is_some() || scene.selected_branch().is_some();
    is_any.then_some(()).ok_or(NOTHING).and_then(|()| view(ViewCommand::RowMenu))
}

/// Of a set only the first one would be meant, and nobody sees which that is.
fn alone(scene: &Scene<'_>) -> Result<(), &'static str> {
    if scene.selected_set().len() > 1 { Err(SEVERAL) } else { Ok(()) }
}

const SEVERAL: &str = "Several are selected: select one alone";

/// A leg of the flight, alone.
fn one_leg<'a>(scene: &'a Scene<'_>) -> Result<&'a Id, &'static str> {
    alone(scene)?;
    match &scene.view.selection {
        Some(Selection::Leg(leg)) if scene.document.plan().leg(leg).is_some() => Ok(leg),
        _ => Err("Select a leg first"),
    }
}

fn new_way(scene: &Scene<'_>) -> Asked {
    view(ViewCommand::DrawWay(one_leg(scene)?.clone()))
}

/// Which variable and what of the leg is chosen in the palette.
fn bind(scene: &Scene<'_>) -> Asked {
    if !create::has_bindings(scene.document.plan(), one_leg(scene)?) {
        return Err("The selected leg has no place and no number");
    }
    view(ViewCommand::Palette(Some(bindings::QUERY)))
}

/// Moves what is selected among its neighbours.
fn shift(scene: &Scene<'_>, offset: isize) -> Asked {
    const NO_NEIGHBOUR: &str = "It has no neighbour there";
    let plan = scene.document.plan();
    if let Some(BranchId { fork, branch }) = scene.selected_branch() {
        let moved = create::shift_branch(plan, &fork, &branch, offset).ok_or(NO_NEIGHBOUR)?;
        return document(DocumentCommand::Edit(moved));
    }
    let (set, legs) = (scene.selected_set(), scene.selected_legs());
    if set.len() > 1 && (set.len() > legs.len() || !create::are_neighbours(plan, &legs)) {
        return Err(NOT_ONE_LIST);
    }
    let moved = match &scene.view.selection {
        Some(Selection::Stage(stage)) => create::shift_stage(plan, stage, offset),
        Some(Selection::Leg(_)) if legs.len() > 1 => create::shift_legs(plan, &legs, offset),
        Some(Selection::Leg(leg)) => create::shift(plan, leg, offset),
        Some(other) => create::shift_thing(plan, other.id(), offset),
        None => return Err(NOTHING),
    };
    document(DocumentCommand::Edit(moved.ok_or(NO_NEIGHBOUR)?))
}

fn follow(scene: &Scene<'_>) -> Asked {
    scene.vehicle.position.as_ref().ok_or("The aircraft's position is not known")?;
    view(ViewCommand::Follow(!scene.view.follow))
}

fn play(scene: &Scene<'_>) -> Asked {
    preview(PreviewCommand::Play(!scene.view.playing))
}

fn theme_is(scene: &Scene<'_>, theme: ThemePreference) -> Kind {
    Kind::Choice(scene.view.theme == theme)
}

const NO_ROOM: &str = "The window has no room for that: make it larger";

fn is_scale(scene: &Scene<'_>, scale: f32) -> Kind {
    Kind::Choice((scene.view.scale.get() - scale).abs() < 0.01)
}

fn scale_to(scene: &Scene<'_>, to: f32) -> Asked {
    let has_room = to <= scene.view.most_scale.unwrap_or(f32::INFINITY);
    let scale = Scale::new(to).filter(|_| has_room || to <= 1.0).ok_or(NO_ROOM)?;
    view(ViewCommand::Scale(scale))
}

/// So many tenths larger.
fn scale(scene: &Scene<'_>, tenths: f32, why_not: &'static str) -> Asked {
    let most = scene.view.most_scale.unwrap_or(f32::INFINITY);
    let now = Scale::new(scene.view.scale.get().min(most)).unwrap_or_default();
    let next = now.larger(tenths).ok_or(why_not)?;
    if tenths > 0.0 && next.get() > most {
        return Err(NO_ROOM);
    }
    view(ViewCommand::Scale(next))
}

fn help(scene: &Scene<'_>) -> Asked {
    let topic = if scene.view.help.is_some() { None } else { Some(topic_of(scene)) };
    view(ViewCommand::Help(topic))
}
