//! The panels around the map. Each borrows the scene, draws it, and pushes commands.
//!
//! To add a panel: a file here with a value that implements [`Panel`], and its line in [`all`].

mod aged;
pub mod alarms;
pub mod answer;
pub mod bar;
pub mod binding;
pub mod browse;
pub mod changed;
pub mod consider;
pub mod counted;
pub mod decision;
pub(crate) mod dialog;
pub mod emergency;
pub mod ended;
pub mod field;
pub mod flight;
pub mod help;
pub mod in_force;
pub mod in_place;
pub mod inspector;
pub mod interchange;
pub mod leading;
pub mod link;
pub mod log;
pub mod maps;
pub mod no_start;
mod other_end;
pub mod palette;
pub mod pfd;
pub mod problems;
pub mod profile;
pub mod push;
pub mod reach;
pub mod recover;
pub(crate) mod row_menu;
pub mod selecting;
pub mod services;
pub mod start;
pub mod story;
pub mod table;
pub mod timeline;
pub mod toasts;
pub mod tour;
pub mod tree;
pub(crate) mod unread;
pub mod unsaved;
pub mod what_if;

use crate::command::{Queue, Replacement, Selection};
use crate::connections::Connections;
use crate::document::Document;
use crate::export::Exported;
use crate::files::{Imported, Stamp};
use crate::forecast::{Alarm, Analysis, Forecast};
use crate::guide::Guide;
use crate::jobs::Jobs;
use crate::layers::Layers;
use crate::map::furniture::Edge;
use crate::recent::Recent;
use crate::recovery::LeftBehind;
use crate::shelf::Shelf;
use crate::state::{Toasts, Vehicle, Vehicles};
use crate::story::Chapter;
use crate::theme;
use crate::units::Units;
pub use aged::{age_as_heard, age_of, aged_row, value_with_age};
use browse::Browsing;
use egui::{RichText, Ui};
use flight_exec::rehearse::{Diversion, WhatIf};
use flight_plan::{Cause, Id, Problem};
use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;
use terrain::Terrain;

/// A panel's identifier; never changes, for layouts are stored with it.
pub type PanelId = &'static str;

/// All panels, in the order of the menu.
pub fn all() -> Vec<Box<dyn Panel>> {
    vec![
        Box::new(tree::Tree::default()),
        Box::new(problems::Problems::default()),
        Box::new(inspector::Inspector),
        Box::new(flight::Flight),
        Box::new(profile::Profile::default()),
        Box::new(table::Table::default()),
        Box::new(what_if::WhatIfPanel),
        Box::new(log::EventLog),
        Box::new(services::Services),
    ]
}

/// A panel that can be docked.
pub trait Panel: std::fmt::Debug {
    /// Its identifier.
    fn id(&self) -> PanelId;

    /// For people.
    fn name(&self) -> &'static str;

    /// Where it is unless the operator has put it elsewhere.
    fn place(&self) -> Place;

    /// It is there without being asked for.
    fn is_shown_at_first(&self) -> bool {
        true
    }

    /// What is lower shows too little to be of use; a low window takes it from the others. Without its title, screen points.
    fn least_height(&self) -> f32 {
        0.0
    }

    /// What its title says now.
    fn title(&self, _scene: &Scene<'_>) -> String {
        self.name().into()
    }

    /// It has something to show; else its place is given to its neighbours.
    fn is_relevant(&self, _scene: &Scene<'_>) -> bool {
        true
    }

    /// It waits for the result of work on another thread.
    fn is_busy(&self) -> bool {
        false
    }

    /// What in it gets the keyboard when that comes to the panel; `None`: the panel as a whole.
    fn keyboard(&self) -> Option<egui::Id> {
        None
    }

    /// A row of small things beside its title.
    fn header(&mut self, _ui: &mut Ui, _scene: &Scene<'_>, _queue: &mut Queue) {}

    /// Draws it; its place may be of any size.
    fn ui(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue);
}

/// Where a panel is in the default layout. Heights are for a window of 1280 by 800 points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Place {
    /// On the left, below those before it.
    Left {
        /// Screen points.
        height: f32,
    },
    /// On the right, below those before it.
    Right {
        /// Screen points.
        height: f32,
    },
    /// A tab below the map.
    Below,
}

/// How many times as fast as the flight the preview's cursor runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Speed(pub f64);

impl Default for Speed {
    fn default() -> Self {
        Self(30.0)
    }
}

/// What is out of date for so long is shown as that, seconds: less is a flicker.
const OUT_OF_DATE_AFTER_S: f64 = 0.3;

/// What the operator looks at.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ViewState {
    /// In which units.
    pub units: Units,
    /// Light, dark, or as the system.
    pub theme: egui::ThemePreference,
    /// How large everything is, where there is room for that.
    pub scale: theme::Scale,
    /// The window has room for no more, if it is known.
    pub most_scale: Option<f32>,
    /// The command palette is open; what is typed in it begins with this.
    pub palette: Option<&'static str>,
    /// The topic of the help that is read, by its key.
    pub help: Option<String>,
    /// So many panels further the keyboard is about to go.
    pub panel_step: isize,
    /// The plan's search is about to get the keyboard.
    pub search: bool,
    /// The menu of what is selected is about to open in the plan's tree.
    pub row_menu: bool,
    /// What is about to be renamed in the plan's tree.
    pub rename: Option<tree::Renamed>,
    /// By how much altitudes are raised is about to be typed.
    pub raise: bool,
    /// The panel that was asked for last: it gives way to nothing.
    pub wanted_panel: Option<PanelId>,
    /// What is selected.
    pub selection: Option<Selection>,
    /// Legs, stages, fixes, zones and runways that are selected besides one of these.
    pub also: BTreeSet<Selection>,
    /// The branch that is selected of the selected fork; `None`: the fork itself.
    pub branch: Option<Id>,
    /// Whose problem the pointer is on.
    pub pointed: Option<Id>,
    /// The dialog of the maps is open.
    pub maps: bool,
    /// What lies on the map's edge and over it.
    pub edge: Edge,
    /// Nothing of the plan can be dragged.
    pub locked: bool,
    /// The map follows the aircraft.
    pub follow: bool,
    /// Cursor in the preview, seconds from its start.
    pub cursor_s: Option<f64>,
    /// The cursor runs by itself.
    pub playing: bool,
    /// So fast.
    pub speed: Speed,
    /// The world that the preview is flown in.
    pub what_if: WhatIf,
    /// An alarm that is raised at the cursor.
    pub alarm: Option<Cause>,
    /// The path shows how alarms would end.
    pub coverage: bool,
    /// Since when what is shown is not what was asked for, seconds on the window's clock.
    pub behind_since_s: Option<f64>,
    /// A demo is flown: its aircraft ends with the window.
    pub is_demo: bool,
    /// What was answered of a new plan.
    pub guide: Guide,
    /// What would replace a plan with unsaved changes, until the operator has decided.
    pub unsaved: Option<Replacement>,
    /// What the last window left behind is not asked about now.
    pub recovers_later: bool,
    /// The state of the document's file after another program has changed it, until the operator has decided.
    pub changed_outside: Option<Stamp>,
    /// The step of the tour that is shown, from 0.
    pub tour: Option<usize>,
    /// A plan of another program, until the operator has decided.
    pub imported: Option<Arc<Imported>>,
    /// The plan in another program's format, until it is written.
    pub exported: Option<Arc<Exported>>,
    /// A file is being chosen in the window.
    pub browsing: Option<Browsing>,
    /// Something the operator should read: a file that can't be opened, and the like.
    pub notice: Option<String>,
}

impl ViewState {
    /// The alarm that is raised, with its time.
    pub fn alarm_at_cursor(&self) -> Option<Alarm> {
        Some(Alarm { time_s: self.cursor_s?, cause: self.alarm? })
    }
    /// Selects this, and nothing else.
    pub fn select(&mut self, selection: Option<Selection>) {
        self.selection = selection;
        self.branch = None;
        self.also.clear();
    }
    /// Adds a leg, stage, fix, zone, runway or variable to what is selected, or takes it out.
    pub fn toggle(&mut self, what: Selection) {
        self.branch = None;
        match &self.selection {
            Some(first) if *first == what => self.selection = self.also.pop_first(),
            Some(first) if first.is_in_sets() => {
                if !self.also.remove(&what) {
                    self.also.insert(what);
                }
            }
            _ => self.select(Some(what)),
        }
    }
}

/// The ground, as far as its elevation is known.
#[derive(Clone, Copy)]
pub struct Elevations<'a>(pub &'a dyn Terrain);

impl std::fmt::Debug for Elevations<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Elevations")
    }
}

/// Everything there is to draw, borrowed for a frame.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The plan being edited.
    pub document: &'a Document,
    /// The documents before and after it.
    pub shelf: &'a Shelf,
    /// What is being done with files.
    pub jobs: &'a Jobs,
    /// What a demo tells.
    pub story: Option<&'a Chapter>,
    /// Messages that go by themselves.
    pub toasts: &'a Toasts,
    /// There is something to undo and to redo, in this document or from one to another.
    pub can_undo: (bool, bool),
    /// What is known of the plan, found out in the background; belongs to an older version for a moment.
    pub analysis: &'a Analysis,
    /// What is known of the vehicle that is shown.
    pub vehicle: &'a Vehicle,
    /// The path of the plan aboard that vehicle, where it is wanted for a comparison and known.
    pub aboard: Option<&'a Forecast>,
    /// All vehicles that are known.
    pub vehicles: &'a Vehicles,
    /// What the operator looks at.
    pub view: &'a ViewState,
    /// The maps and elevations that were brought.
    pub layers: &'a Layers,
    /// The files that were open last.
    pub recent: &'a Recent,
    /// The connections that were made last.
    pub connections: &'a Connections,
    /// What a window left behind that crashed, until the operator has decided.
    pub left_behind: Option<&'a LeftBehind>,
    /// The ground.
    pub ground: Elevations<'a>,
    /// The window's clock, seconds.
    pub now_s: f64,
    /// The time of day.
    pub utc: jiff::Timestamp,
}

impl<'a> Scene<'a> {
    /// The units in use.
    pub fn units(&self) -> Units {
        self.view.units
    }
    /// What will be flown.
    pub fn forecast(&self) -> &'a Forecast {
        &self.analysis.forecast
    }
    /// What is known is of another version of the plan, or of another world, than the present one.
    pub fn is_behind(&self) -> bool {
        self.analysis.version != self.document.version() || self.analysis.what_if != self.view.what_if
    }
    /// All that can be found out of this revision of the plan is known.
    pub fn is_checked(&self) -> bool {
        self.analysis.version == self.document.version() && self.analysis.is_complete
    }
    /// Why the path that is drawn is not that of the present plan.
    pub fn out_of_date(&self) -> Option<&'static str> {
        let since_s = self.view.behind_since_s.map_or(0.0, |since_s| self.now_s - since_s);
        let drawn = !self.forecast().points.is_empty();
        match &self.analysis.no_forecast {
            Some(_) if drawn && self.forecast().is_beginning => {
                Some("A draft: drawn as far as it can be flown. The plan has errors")
            }
            Some(_) if drawn => Some("Out of date: the last path that could be flown. The plan has errors"),
            Some(_) if !self.document.plan().stages.is_empty() => Some("A draft: the plan has errors"),
            None if drawn && since_s > OUT_OF_DATE_AFTER_S => Some("Out of date: being computed…"),
            _ => None,
        }
    }
    /// The path of the plan aboard, where it is flown while another plan is shown, or one is proposed.
    pub fn path_aboard(&self) -> Option<&'a Forecast> {
        let shown = self.analysis.hash_of(self.document.version());
        // what an agent before this one had aboard is compared with nothing
        let active = self.vehicle.active_hash()?;
        let is_another = self.vehicle.is_airborne() && Some(&*active) != shown;
        self.aboard.filter(|_| is_another || self.vehicle.proposal.is_some())
    }
    /// The way out after the alarm that is raised, as soon as one is known.
    pub fn diversion(&self) -> Option<&'a Diversion> {
        self.analysis.diversion().filter(|_| self.view.alarm_at_cursor().is_some())
    }
    /// What is wrong with the plan: first what reading it found, then what checking it found.
    pub fn problems(&self) -> impl Iterator<Item = &'a Problem> {
        self.document.reading_problems().iter().chain(&self.analysis.problems)
    }
    /// What was wrong with an earlier version of the plan, and may be still: that is being looked into. Of what is still there.
    pub fn unsettled(&self) -> impl Iterator<Item = &'a Problem> {
        let document = self.document;
        let is_there = move |problem: &&Problem| {
            problem.subject.as_ref().is_none_or(|of| problems::find(document, of).is_some())
        };
        self.analysis.unsettled.iter().take(problems::MOST).filter(is_there)
    }
    /// What an error forbids to fly: legs and stages as they are planned, and the zones that flights come into conflict with.
    pub fn faulty(&self) -> HashSet<&'a Id> {
        let errors = self.problems().filter(|problem| problem.is_error());
        let planned = |problem: &'a Problem| problem.subject.as_ref().filter(|_| !problem.is_off_plan());
        errors.flat_map(|problem| planned(problem).into_iter().chain(problem.zone.as_deref())).collect()
    }
    /// What an error forbade to fly, until it is known whether it still does.
    pub fn perhaps_faulty(&self) -> HashSet<&'a Id> {
        let errors = self.unsettled().filter(|problem| problem.is_error() && !problem.is_off_plan());
        errors.filter_map(|problem| problem.subject.as_ref()).collect()
    }
    /// A question or a dialog has the operator's attention: keys mean nothing to what is behind it.
    pub fn is_asking(&self) -> bool {
        self.view.unsaved.is_some()
            || self.view.changed_outside.is_some()
            || self.view.browsing.is_some()
            || self.view.imported.is_some()
            || self.view.exported.is_some()
            || self.view.palette.is_some()
    }
    /// Is this selected?
    pub fn is_selected(&self, selection: &Selection) -> bool {
        self.view.selection.as_ref() == Some(selection) || self.view.also.contains(selection)
    }
    /// The legs that are selected and still in the plan, in its order; in a set, those of a stage are selected with it.
    pub fn selected_legs(&self) -> Vec<Id> {
        let plan = self.document.plan();
        match &self.view.selection {
            Some(Selection::Leg(leg)) if self.view.also.is_empty() => {
                plan.leg(leg).map(|_| leg.clone()).into_iter().collect()
            }
            Some(first) if first.is_in_sets() && !self.view.also.is_empty() => {
                let legs = plan.all_legs();
                let chosen = legs.iter().filter(|c| {
                    let (leg, stage) =
                        (Selection::Leg(c.leg.id.clone()), Selection::Stage(c.stage.id.clone()));
                    self.is_selected(&leg) || (c.loops.is_empty() && self.is_selected(&stage))
                });
                chosen.map(|context| context.leg.id.clone()).collect()
            }
            _ => Vec::new(),
        }
    }
    /// All legs, stages, fixes, zones and runways that are selected and still in the plan, with the legs of those stages.
    pub fn selected_things(&self) -> Vec<Id> {
        let plan = self.document.plan();
        let all = self.view.selection.iter().chain(&self.view.also);
        let things = all.filter(|what| match what {
            Selection::Fix(id) => plan.fix(id).is_some(),
            Selection::Zone(id) => plan.zone(id).is_some(),
            Selection::Runway(id) => plan.runway(id).is_some(),
            Selection::Stage(id) => !self.view.also.is_empty() && plan.stage(id).is_some(),
            _ => false,
        });
        self.selected_legs().into_iter().chain(things.map(|what| what.id().clone())).collect()
    }
    /// All variables that are selected and still in the plan.
    pub fn selected_variables(&self) -> Vec<Id> {
        let plan = self.document.plan();
        let all = self.view.selection.iter().chain(&self.view.also);
        let variables = all.filter(|what| matches!(what, Selection::Variable(_))).map(Selection::id);
        variables.filter(|name| plan.variable(name).is_some()).cloned().collect()
    }
    /// All that is selected and still in the plan: things and variables.
    pub fn selected_set(&self) -> Vec<Id> {
        [self.selected_things(), self.selected_variables()].concat()
    }
}

/// A heading of a group of things.
pub fn group_title(ui: &mut Ui, text: &str) {
    let weak = theme::of(ui).weak;
    ui.label(RichText::new(text.to_uppercase()).size(10.5).color(weak).strong());
}

/// Width of what is read beside the map where the plan's panels have no place beside it, screen points.
const READ: f32 = 260.0;

/// What is read with the map, in the place of the plan's panels, which is so wide.
fn read_beside_map(ui: &mut Ui, width: Option<f32>, show: impl FnOnce(&mut Ui)) {
    egui::Panel::left("read beside the map")
        .exact_size(width.unwrap_or(READ))
        .resizable(false)
        .frame(theme::panel(ui).inner_margin(12.0))
        .show(ui, show);
}

/// A button that is the main thing to do here.
pub fn primary_button(text: &str, p: &theme::Palette) -> egui::Button<'static> {
    egui::Button::new(RichText::new(text).color(p.on_accent).strong()).fill(p.accent)
}
