//! What is made from a heading of the tree: by its `+`, or a right click on it.

use super::alternates;
use crate::command::{Command, DocumentCommand, Queue, Selection, ViewCommand};
use crate::panels::Scene;
use egui::Ui;
use flight_plan::{Edit, FlightPlan, StageKind, Thing, VariableValue, create};
use geometry::LatLon;

/// A heading of the tree.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Group {
    /// The main plan's.
    Stages,
    /// With their stages.
    EmergencyPlans,
    /// With their legs.
    Procedures,
    /// Where the flight must and must not be.
    Zones,
    /// What services write in flight.
    Variables,
    /// Named positions.
    Fixes,
    /// In their landing directions.
    Runways,
}

impl Group {
    /// From top to bottom.
    pub const ALL: [Self; 7] = [
        Self::Stages,
        Self::EmergencyPlans,
        Self::Procedures,
        Self::Zones,
        Self::Variables,
        Self::Fixes,
        Self::Runways,
    ];

    /// What the heading says.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stages => "Main plan",
            Self::EmergencyPlans => "Emergency plans",
            Self::Procedures => "Procedures",
            Self::Zones => "Zones",
            Self::Variables => "Variables",
            Self::Fixes => "Fixes",
            Self::Runways => "Runways",
        }
    }

    /// What its `+` does.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Stages => "Add a stage",
            Self::EmergencyPlans => "Add an emergency plan",
            Self::Procedures => "How procedures are made",
            Self::Zones => "Draw a zone",
            Self::Variables => "Add a variable",
            Self::Fixes => "Place a fix",
            Self::Runways => "Draw a runway",
        }
    }

    /// An empty plan shows where to begin; a plan with procedures shows them.
    pub fn is_shown(self, plan: &FlightPlan) -> bool {
        match self {
            Self::Stages => true,
            Self::Procedures => !plan.procedures.is_empty(),
            _ => !plan.stages.is_empty() || !plan.runways.is_empty(),
        }
    }
}

/// The menu of a heading.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, group: Group, queue: &mut Queue) {
    match group {
        Group::Stages => {
            stages(ui, scene.document.plan(), queue);
            alternates::submenu(ui, scene.document.plan(), &[None], queue);
        }
        Group::EmergencyPlans => emergency_plans(ui, scene.document.plan(), queue),
        Group::Procedures => {
            ui.label("Right-click a leg and make a procedure of it,\nthen draw calls of it on the map.");
        }
        Group::Variables => variables(ui, scene, queue),
        Group::Zones => tool(ui, group.hint(), "zone", queue),
        Group::Fixes => tool(ui, group.hint(), "fix", queue),
        Group::Runways => tool(ui, group.hint(), "runway", queue),
    }
}

fn tool(ui: &mut Ui, name: &str, id: &'static str, queue: &mut Queue) {
    if ui.button(format!("{name} on the map")).clicked() {
        queue.view(ViewCommand::Tool(id));
    }
}

/// Kinds of stages that can be added.
pub const STAGES: [(StageKind, &str); 7] = [
    (StageKind::TakeOff, "Take-off stage"),
    (StageKind::Departure, "Departure stage"),
    (StageKind::EnRoute, "En-route stage"),
    (StageKind::Mission, "Mission stage"),
    (StageKind::Arrival, "Arrival stage"),
    (StageKind::Approach, "Approach stage"),
    (StageKind::Land, "Landing stage"),
];

fn stages(ui: &mut Ui, plan: &FlightPlan, queue: &mut Queue) {
    for (kind, name) in STAGES {
        if ui.button(name).clicked() {
            queue.push(stage(plan, kind));
        }
    }
}

/// Adds a stage and selects it.
pub fn stage(plan: &FlightPlan, kind: StageKind) -> Command {
    let (id, edit) = create::add_stage(plan, kind);
    making(edit, Selection::Stage(id))
}

fn making(edit: Edit, made: Selection) -> Command {
    let select = Command::View(ViewCommand::Select(Some(made)));
    Command::Each(vec![Command::Document(DocumentCommand::Edit(edit)), select])
}

fn emergency_plans(ui: &mut Ui, plan: &FlightPlan, queue: &mut Queue) {
    if plan.runways.is_empty() {
        ui.label("Draw a runway first: an emergency plan lands on one.");
    }
    for runway in &plan.runways {
        if ui.button(format!("Land on {}", runway.id)).clicked() {
            queue.document(DocumentCommand::BringHome {
                runway: runway.id.clone(),
                outwards: Vec::new(),
                from: None,
            });
        }
    }
}

fn variables(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    for initial in kinds_of_variables(scene) {
        if ui.button(initial.kind()).clicked() {
            queue.push(variable(scene.document.plan(), initial));
        }
    }
}

/// What variables that can be added begin with, one of each kind.
pub fn kinds_of_variables(scene: &Scene<'_>) -> [VariableValue; 5] {
    let here = middle(scene);
    [
        VariableValue::Number(0.0),
        VariableValue::Bool(false),
        VariableValue::Text(String::new()),
        VariableValue::Position(here),
        VariableValue::Polygon(square(here)),
    ]
}

/// Adds a variable and selects it.
pub fn variable(plan: &FlightPlan, initial: VariableValue) -> Command {
    let variable = create::variable(plan, initial);
    let made = Selection::Variable(variable.name.clone());
    making(Edit::Add(Box::new(Thing::Variable(variable))), made)
}

/// Where something new is seen: halfway along the path, else at the runway.
fn middle(scene: &Scene<'_>) -> LatLon {
    let forecast = scene.forecast();
    let halfway = forecast.at(forecast.duration_s() / 2.0).map(|point| point.position);
    let home = || scene.document.plan().home().map(|runway| runway.threshold);
    halfway.or_else(home).unwrap_or(crate::map::HOME)
}

/// 400 m wide.
fn square(middle: LatLon) -> Vec<LatLon> {
    const TO_CORNER_M: f64 = 283.0;
    [45.0, 135.0, 225.0, 315.0].map(|bearing_deg| middle.destination(bearing_deg, TO_CORNER_M)).to_vec()
}
