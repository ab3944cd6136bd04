//! What the window may ask for. Panels and map borrow the state and push commands; the app carries
//! them out between two frames.

use crate::files::Choices;
use crate::guide::Answer;
use crate::layers::LayerCommand;
use crate::map::furniture::Edge;
use crate::panels::PanelId;
pub use crate::panels::selecting::BranchId;
use crate::panels::tree::Renamed;
use crate::state::VehicleName;
use crate::units::Units;
use flight_exec::Command as PlanCommand;
use flight_exec::rehearse::WhatIf;
use flight_plan::describe::Subject;
use flight_plan::template::Outline;
use flight_plan::{Cause, Edit, Id, Place};
use geometry::LatLon;
use interchange::Format;
use std::path::PathBuf;
use usal::contract::GatewayRequest;

/// Something the operator wants done.
#[derive(Debug, Clone)]
pub enum Command {
    /// To the document.
    Document(DocumentCommand),
    /// To what is shown.
    View(ViewCommand),
    /// To the flight ahead of time.
    Preview(PreviewCommand),
    /// To the links, and which vehicle is shown.
    Link(LinkCommand),
    /// To the maps and elevations that were brought.
    Layer(LayerCommand),
    /// To the vehicle that is shown.
    Fly(FlyCommand),
    /// Each of these, in order.
    Each(Vec<Command>),
}

/// What is done with the clipboard, on the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Clip {
    /// Copy what is selected.
    Copy,
    /// Copy what is selected and take it out of the plan.
    Cut,
    /// Put what was copied behind what is selected.
    Paste,
    /// Copy what is selected, and put the copies beside it.
    Duplicate,
}

/// Commands to the document.
#[derive(Debug, Clone)]
pub enum DocumentCommand {
    /// Put something else in the document's place; asks first if that has unsaved changes.
    Replace(Replacement),
    /// The same without asking: the changes are lost.
    Discard(Replacement),
    /// Open a file that was chosen in the window. It was asked before what becomes of unsaved changes, or nothing was to be lost.
    Open(PathBuf),
    /// A file or folder that was dropped onto the window.
    Dropped(PathBuf),
    /// Put the plan of another program that was read in the document's place.
    TakeImport,
    /// Add what the other program's file draws to the document.
    AddImport,
    /// Reads the other program's file again, as this.
    ImportAs(Box<Choices>),
    /// Put the plan into another program's format.
    Export(Format),
    /// Ask where to write what was exported.
    AskExport,
    /// Write it here.
    ExportTo {
        /// The file.
        path: PathBuf,
        /// It may be there already.
        over: bool,
    },
    /// Save the document, and put something else in its place once that is done; every document, before the window closes.
    SaveThen(Replacement),
    /// A new plan made from a template, in the place of an empty one.
    Create(Box<Outline>),
    /// A runway from its landing threshold to its other end, on the ground there.
    AddRunway {
        /// Its landing threshold.
        threshold: LatLon,
        /// Its other end.
        end: LatLon,
        /// Another one the other way, too.
        both: bool,
    },
    /// An emergency plan that brings the aircraft to a runway.
    BringHome {
        /// The runway.
        runway: Id,
        /// Through these places, from the runway outwards.
        outwards: Vec<Place>,
        /// Where it is drawn from, and how high the path is there, metres AMSL; `None`: from anywhere.
        from: Option<(LatLon, f64)>,
    },
    /// Take over what another program has written in the document's file.
    LoadTheirs,
    /// Keep the document as it is; saving replaces what another program has written.
    KeepMine,
    /// Open what a crashed window left behind: all of it, or the document with this number.
    Recover(Option<usize>),
    /// Delete it.
    ForgetLeftBehind(Option<usize>),
    /// Save where it came from, asking if it came from nowhere.
    Save,
    /// Ask where to save.
    AskSaveAs,
    /// Show a folder in the window's own file dialog, with a name to begin with.
    Browse(PathBuf, String),
    /// Save here.
    SaveTo {
        /// The file.
        path: PathBuf,
        /// It may be there already.
        over: bool,
    },
    /// Apply an edit as an undo step of its own.
    Edit(Edit),
    /// Apply an edit as part of a gesture; the steps of a gesture are undone together.
    DragEdit(Edit),
    /// The gesture is over.
    EndGesture,
    /// Take the last step back.
    Undo,
    /// Redo it.
    Redo,
}

/// What takes a document's place.
#[derive(Debug, Clone, PartialEq)]
pub enum Replacement {
    /// An empty plan.
    New,
    /// A file that is asked for.
    AskOpen,
    /// Another program's file that is asked for.
    AskImport,
    /// This file.
    Open(PathBuf),
    /// Nothing: the window is closed.
    Quit,
}

/// Commands to the view.
#[derive(Debug, Clone)]
pub enum ViewCommand {
    /// Select something, or nothing.
    Select(Option<Selection>),
    /// Point out something (a leg, a stage) without selecting it, or nothing any more.
    PointOut(Option<Id>),
    /// Add a leg, stage, fix, zone, runway or variable to what is selected, or take it out.
    Toggle(Selection),
    /// Select all of these together; what can't be selected with others is left out.
    SelectTogether(Vec<Selection>),
    /// Select every leg of the plan.
    SelectAllLegs,
    /// Select all that is flown, and type by how much its altitudes are raised.
    RaiseAll,
    /// Select it and bring it into the map's middle.
    JumpTo(Selection),
    /// Select something, and bring this place into the middle of the map.
    JumpToPlace(LatLon, Option<Selection>),
    /// Show the whole plan.
    Fit,
    /// Lock the plan against being dragged by accident, or unlock it.
    Lock(bool),
    /// Bring the map nearer, so many levels of zoom; less than 0 takes it further away.
    Zoom(f64),
    /// Copy or paste on the map.
    Clip(Clip),
    /// Keep the aircraft in the map's middle, or stop that.
    Follow(bool),
    /// An answer to the guide to a new plan.
    Guide(Answer),
    /// Put a map tool to use, by its identifier.
    Tool(&'static str),
    /// Draw a new way on from this leg.
    DrawWay(Id),
    /// Other units.
    Units(Units),
    /// Light, dark, or as the system.
    Theme(egui::ThemePreference),
    /// How large everything is.
    Scale(crate::theme::Scale),
    /// Open the command palette with the beginning of what is typed there, or close it.
    Palette(Option<&'static str>),
    /// Show this topic of the help, by its key; `None` closes it.
    Help(Option<String>),
    /// Show the plan and type what to search in it.
    Search,
    /// Show it in the plan and type another name for it.
    Rename(Renamed),
    /// Show the plan and open the menu of what is selected there.
    RowMenu,
    /// Select a branch of a fork in the plan's tree.
    SelectBranch(BranchId),
    /// Take the keyboard to the next panel, or (`-1`) the one before.
    StepPanel(isize),
    /// Show a panel, or hide it.
    ShowPanel(PanelId, bool),
    /// Open the dialog of the maps, or close it.
    Maps(bool),
    /// Show other things on the map's edge.
    Edge(Edge),
    /// Put all panels back to where they are by default.
    ResetLayout,
    /// Show a message.
    Notice(String),
    /// Show one that goes by itself.
    Toast(String),
    /// Take a message away.
    DismissNotice,
    /// The name of a file as it is typed.
    NameFile(String),
    /// No file is asked for any more.
    StopBrowsing,
    /// The unsaved plan stays.
    KeepUnsaved,
    /// What was read of another program's file is not wanted.
    PutImportAside,
    /// What was exported is not written.
    PutExportAside,
    /// Open the report of a demo.
    OpenReport(PathBuf),
    /// The demo's strip is not wanted any more.
    EndStory,
    /// The demo is to be flown once more, from the beginning, in a new window.
    TellAgain,
    /// Asks what is to become of the changes that the last window left behind, or puts the question aside.
    AskRecovery(bool),
    /// This step of the tour, from 0; `None` ends it.
    Tour(Option<usize>),
    /// A message is being read: it stays.
    KeepToast(u64),
    /// A message has been read.
    DismissToast(u64),
    /// The result of this work is not wanted.
    Cancel(u64),
}

/// Commands to the preview: where its cursor is, and in which world it is flown.
#[derive(Debug, Clone)]
pub enum PreviewCommand {
    /// Move the cursor along the preview, seconds from its start; `None` hides it, and ends the alarm there.
    Scrub(Option<f64>),
    /// Run the preview's cursor, or stop it.
    Play(bool),
    /// The preview's cursor runs so many times as fast as the flight.
    Speed(f64),
    /// The world that the preview is flown in.
    WhatIf(Box<WhatIf>),
    /// Raise an alarm at the preview's cursor, or none.
    Raise(Option<Cause>),
    /// Show how alarms would end all along the path.
    Coverage(bool),
    /// The plan's own world, and no alarm.
    Reset,
}

/// Commands to the links.
#[derive(Debug, Clone)]
pub enum LinkCommand {
    /// Open a link to a vehicle and show that vehicle.
    Connect {
        /// Where its gateway listens, as `tcp/127.0.0.1:7447`.
        endpoint: String,
        /// Its name.
        vehicle: VehicleName,
    },
    /// Close the link to a vehicle; what is known of it stays.
    Disconnect(VehicleName),
    /// Show another vehicle.
    Show(VehicleName),
    /// What a vehicle announced has been read.
    PutAside(VehicleName),
}

/// Commands to the vehicle.
#[derive(Debug, Clone)]
pub enum FlyCommand {
    /// Propose the document.
    Propose,
    /// Choose the leg at which the proposal is entered.
    EnterAt(Id),
    /// Make the proposal the active plan.
    Commit,
    /// Put the proposal aside.
    DropProposal,
    /// Replace the document by the plan aboard.
    TakeAboard,
    /// A command for the plan's executor.
    Plan(PlanCommand),
    /// Look at what would follow a command, to give it then.
    Consider(PlanCommand),
    /// Give the command that is considered up.
    PutAside,
    /// What became of the last command has been read.
    PutAnswerAside,
    /// A request for the gateway.
    Gateway(GatewayRequest),
    /// Start the plan: the aircraft takes off.
    Launch,
}

/// What can be selected.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Selection {
    /// A leg, anywhere in the document.
    Leg(Id),
    /// A stage of the main plan or of an emergency plan.
    Stage(Id),
    /// An emergency plan.
    Emergency(Id),
    /// A fix.
    Fix(Id),
    /// A runway.
    Runway(Id),
    /// A variable.
    Variable(Id),
    /// A keep-in or keep-out zone.
    Zone(Id),
    /// A procedure.
    Procedure(Id),
}

impl Selection {
    /// It can be selected together with others: it, or what is in it, has a place of its own.
    pub fn is_in_sets(&self) -> bool {
        matches!(
            self,
            Self::Leg(_)
                | Self::Stage(_)
                | Self::Fix(_)
                | Self::Zone(_)
                | Self::Runway(_)
                | Self::Variable(_)
        )
    }

    /// It has a name and no place: it is selected alone.
    pub fn is_named(&self) -> bool {
        matches!(self, Self::Emergency(_) | Self::Procedure(_) | Self::Variable(_))
    }

    /// What it is in the plan.
    pub fn subject(&self) -> Subject {
        match self.clone() {
            Self::Leg(id) => Subject::Leg(id),
            Self::Stage(id) => Subject::Stage(id),
            Self::Emergency(id) => Subject::EmergencyPlan(id),
            Self::Fix(id) => Subject::Fix(id),
            Self::Runway(id) => Subject::Runway(id),
            Self::Variable(id) => Subject::Variable(id),
            Self::Zone(id) => Subject::Zone(id),
            Self::Procedure(id) => Subject::Procedure(id),
        }
    }

    /// The identifier it stands for.
    pub fn id(&self) -> &Id {
        match self {
            Self::Leg(id)
            | Self::Stage(id)
            | Self::Emergency(id)
            | Self::Fix(id)
            | Self::Runway(id)
            | Self::Variable(id)
            | Self::Zone(id)
            | Self::Procedure(id) => id,
        }
    }

    /// The same under another identifier.
    pub fn renamed(&self, to: Id) -> Self {
        let mut renamed = self.clone();
        match &mut renamed {
            Self::Leg(id)
            | Self::Stage(id)
            | Self::Emergency(id)
            | Self::Fix(id)
            | Self::Runway(id)
            | Self::Variable(id)
            | Self::Zone(id)
            | Self::Procedure(id) => *id = to,
        }
        renamed
    }
}

/// Commands on their way to the app.
#[derive(Debug, Default)]
pub struct Queue(Vec<Command>);

impl Queue {
    /// Whatever it is to.
    pub fn push(&mut self, command: Command) {
        self.0.push(command);
    }
    /// To the document.
    pub fn document(&mut self, command: DocumentCommand) {
        self.0.push(Command::Document(command));
    }
    /// An edit as one undo step.
    pub fn edit(&mut self, edit: Edit) {
        self.document(DocumentCommand::Edit(edit));
    }
    /// To the view.
    pub fn view(&mut self, command: ViewCommand) {
        self.0.push(Command::View(command));
    }
    /// To the flight ahead of time.
    pub fn preview(&mut self, command: PreviewCommand) {
        self.0.push(Command::Preview(command));
    }
    /// To the maps and elevations that were brought.
    pub fn layer(&mut self, command: LayerCommand) {
        self.0.push(Command::Layer(command));
    }
    /// To the links.
    pub fn link(&mut self, command: LinkCommand) {
        self.0.push(Command::Link(command));
    }
    /// To the vehicle that is shown.
    pub fn fly(&mut self, command: FlyCommand) {
        self.0.push(Command::Fly(command));
    }
    /// To the plan's executor.
    pub fn plan(&mut self, command: PlanCommand) {
        self.fly(FlyCommand::Plan(command));
    }
    /// To be looked at before it goes to the plan's executor.
    pub fn consider(&mut self, command: PlanCommand) {
        self.fly(FlyCommand::Consider(command));
    }
    /// Everything that was asked for, in order.
    pub fn take(&mut self) -> Vec<Command> {
        std::mem::take(&mut self.0)
    }
}
