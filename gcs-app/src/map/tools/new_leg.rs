//! What the tools that draw legs share: where a new leg goes, and how the path arrives there.

use super::Canvas;
use crate::command::{Queue, Selection, ViewCommand};
use crate::map::sketch::{Handle, Handled};
use crate::panels::Scene;
use crate::panels::field::{About, List};
use aircraft::Profile;
use egui::Ui;
use flight_plan::create::{self, Approach, Drawn, LegChoice, Shape, Way};
use flight_plan::{
    Altitude, FlightPlan, Id, Leg, LegContext, LegKind, Place, Section, Spot, StageKind, TurnDirection, Value,
};
use geometry::LatLon;
use geometry::geodesy::normalise_360;
use std::sync::Arc;

/// Height of the list of kinds, screen points: all of them are seen.
const LIST: f32 = 420.0;

/// On which side of the selected leg a new one goes.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Side {
    /// After it.
    #[default]
    Behind,
    /// Before it.
    Before,
    /// At its end, if it is a loop.
    Inside,
    /// At the beginning of a way on from it.
    Way(Way),
}

impl Side {
    /// Those that a leg has.
    fn of(leg: &Leg) -> Vec<Self> {
        let inside = leg.as_loop().is_some().then_some(Self::Inside);
        let branches = leg.as_fork().map_or(&[][..], |fork| fork.branches);
        let ways = branches.iter().map(|branch| Way::Branch(branch.id.clone())).chain([Way::New]);
        [Self::Behind, Self::Before].into_iter().chain(inside).chain(ways.map(Self::Way)).collect()
    }
}

/// Where a new leg goes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Aim {
    /// Among other legs.
    Spot(Spot),
    /// At the beginning of a way on from a leg.
    Way {
        /// A fork, or a leg behind which one is made.
        from: Id,
        /// Which way.
        way: Way,
    },
}

/// Where a new leg goes: beside the selected one, or to the end of what is selected, or of the mission.
pub fn aim(plan: &FlightPlan, selected: Option<&Selection>, side: &Side) -> Option<Aim> {
    match selected {
        Some(Selection::Leg(id)) => {
            if let Some(leg) = plan.any_leg(id) {
                return Some(beside(leg, side));
            }
        }
        Some(Selection::Stage(id)) if plan.stage(id).is_some_and(|s| has_legs(s.kind)) => {
            return Some(Aim::Spot(Spot::EndOf(id.clone())));
        }
        Some(Selection::Procedure(id)) if plan.procedure(id).is_some() => {
            return Some(Aim::Spot(Spot::EndOf(id.clone())));
        }
        Some(Selection::Emergency(id)) => {
            let stages = plan.emergency_plan(id).into_iter().flat_map(|e| &e.stages);
            if let Some(stage) = stages.into_iter().find(|stage| has_legs(stage.kind)) {
                return Some(Aim::Spot(Spot::EndOf(stage.id.clone())));
            }
        }
        _ => {}
    }
    let stages = plan.stages.iter().filter(|stage| has_legs(stage.kind));
    let stage =
        stages.clone().find(|stage| stage.kind == StageKind::Mission).or_else(|| stages.clone().next());
    stage.map(|stage| Aim::Spot(Spot::EndOf(stage.id.clone())))
}

/// Where a new leg goes that is what the flight is for, as a pattern or a drawing: none goes between the hold and the final by itself,
/// only beside what is selected in a stage of such legs.
pub fn mission_aim(plan: &FlightPlan, selected: Option<&Selection>, side: &Side) -> Option<Aim> {
    let aim = aim(plan, selected, side)?;
    let end = if *side == Side::Behind { end_of_mission(plan, &aim) } else { None };
    Some(end.unwrap_or(aim))
}

/// The end of the mission, if this place is in another stage of the main plan that such a leg does not belong to.
fn end_of_mission(plan: &FlightPlan, aim: &Aim) -> Option<Aim> {
    let id = place_in(aim);
    let of_leg = plan.leg(id).filter(|context| matches!(context.section, Section::Main));
    let stage = match of_leg {
        Some(context) => context.stage,
        None => plan.stages.iter().find(|stage| stage.id == *id)?,
    };
    if !matches!(stage.kind, StageKind::Departure | StageKind::Arrival | StageKind::Approach) {
        return None;
    }
    let last = |kind| plan.stages.iter().rfind(|stage| stage.kind == kind);
    let stage = last(StageKind::Mission).or_else(|| last(StageKind::EnRoute))?;
    Some(Aim::Spot(Spot::EndOf(stage.id.clone())))
}

/// What to do where a leg can't be put anywhere.
pub const NO_STAGE: &str =
    "add a stage first, with the + of Main plan in the tree, or make a new mission (Ctrl+N).";

/// Where a new leg goes that is drawn on this side of what is selected.
pub fn aim_of(scene: &Scene<'_>, side: &Side) -> Option<Aim> {
    aim(scene.document.plan(), scene.view.selection.as_ref(), &meant(scene, side))
}

/// The same of a pattern.
pub fn mission_aim_of(scene: &Scene<'_>, side: &Side) -> Option<Aim> {
    mission_aim(scene.document.plan(), scene.view.selection.as_ref(), &meant(scene, side))
}

/// Of a branch that is selected its beginning, unless another side is chosen.
pub fn meant(scene: &Scene<'_>, side: &Side) -> Side {
    let branch = scene.selected_branch().filter(|_| *side == Side::Behind);
    branch.map_or_else(|| side.clone(), |of| Side::Way(Way::Branch(of.branch)))
}

fn beside(leg: &Leg, side: &Side) -> Aim {
    let side = if Side::of(leg).contains(side) { side } else { &Side::Behind };
    Aim::Spot(match side {
        Side::Before => Spot::Before(leg.id.clone()),
        Side::Inside => Spot::EndOf(leg.id.clone()),
        Side::Behind => Spot::After(leg.id.clone()),
        Side::Way(way) => return Aim::Way { from: leg.id.clone(), way: way.clone() },
    })
}

/// The autopilot performs take-off and landing by itself.
fn has_legs(kind: StageKind) -> bool {
    !matches!(kind, StageKind::TakeOff | StageKind::Land)
}

/// Where that is, for people.
pub fn words(aim: &Aim, plan: &FlightPlan) -> String {
    match aim {
        Aim::Spot(Spot::Before(id)) => format!("before {}", plan.label(id)),
        Aim::Spot(Spot::After(id)) => format!("behind {}", plan.label(id)),
        Aim::Spot(Spot::EndOf(id)) => format!("at the end of {}", plan.label(id)),
        Aim::Way { from, way: Way::New } => format!("on a new way from {}", plan.label(from)),
        Aim::Way { from, way: Way::Branch(branch) } => {
            let branches = plan.any_leg(from).and_then(Leg::as_fork).map_or(&[][..], |fork| fork.branches);
            let label = branches.iter().find(|b| b.id == *branch).map(|b| b.label.as_str());
            let label = label.filter(|label| !label.is_empty()).unwrap_or(branch.as_str());
            format!("on “{label}” from {}", plan.label(from))
        }
    }
}

/// Whose place that is, for people: `Main plan > Survey`.
pub fn whose(aim: &Aim, plan: &FlightPlan) -> Option<String> {
    let id = place_in(aim);
    if let Some((procedure, _)) = plan.procedure_leg(id) {
        return Some(format!("procedure {}", plan.label(&procedure.id)));
    }
    let of_leg = plan.leg(id).map(|context| (context.section, context.stage));
    let (section, stage) = of_leg.or_else(|| plan.all_stages().find(|(_, stage)| stage.id == *id))?;
    let stage = plan.label(&stage.id);
    Some(match section {
        Section::Main => format!("Main plan > {stage}"),
        Section::Emergency(emergency) => format!("emergency plan {} > {stage}", plan.label(&emergency.id)),
    })
}

/// Whose place that is, for people, where it is not in the main plan.
pub fn aside(aim: &Aim, plan: &FlightPlan) -> Option<String> {
    let id = place_in(aim);
    let is_main = match plan.leg(id) {
        Some(context) => matches!(context.section, Section::Main),
        None => plan.stages.iter().any(|stage| stage.id == *id),
    };
    whose(aim, plan).filter(|_| !is_main)
}

/// The leg, stage or procedure that a place is told by.
fn place_in(aim: &Aim) -> &Id {
    let (Aim::Spot(Spot::Before(id) | Spot::After(id) | Spot::EndOf(id)) | Aim::Way { from: id, .. }) = aim;
    id
}

/// Where a tool puts a leg on this side of what is selected.
pub type AimOf = fn(&Scene<'_>, &Side) -> Option<Aim>;

/// Lets the side be chosen, where there is a choice.
pub fn choose_side(ui: &mut Ui, scene: &Scene<'_>, side: &mut Side, aim: AimOf) {
    let (plan, selected) = (scene.document.plan(), scene.view.selection.as_ref());
    let Some(Selection::Leg(id)) = selected else { return };
    let Some(leg) = plan.any_leg(id) else { return };
    let named_by = |side: &Side| aim(scene, side).map_or_else(String::new, |aim| words(&aim, plan));
    let shown = named_by(side);
    let sides: Vec<Side> = Side::of(leg).into_iter().collect();
    let name = format!("Where: {shown}");
    let list = List { salt: "side", name: &name, shown: &shown, look: |combo| combo };
    let (taken, _) = list.show(ui, sides.iter().position(|other| other == side), || {
        sides.iter().map(named_by).collect::<Vec<_>>()
    });
    if let Some(taken) = taken.and_then(|taken| sides.into_iter().nth(taken)) {
        *side = taken;
    }
}

/// Lets a kind of leg be chosen.
pub fn choose_kind(ui: &mut Ui, choices: impl Iterator<Item = LegChoice>, choice: &mut LegChoice) {
    let shown = choice.name();
    let choices: Vec<LegChoice> = choices.collect();
    let texts: Vec<(String, String)> =
        choices.iter().map(|other| (other.name().to_string(), other.about().to_string())).collect();
    let texts: Vec<About<'_>> = texts.iter().map(|(name, about)| (name.as_str(), about.as_str())).collect();
    let name = format!("Kind: {shown}");
    let list = List { salt: "kind", name: &name, shown: &shown, look: |combo| combo.height(LIST) };
    let (taken, _) = list.show_with_help(ui, choices.iter().position(|other| other == choice), &texts);
    if let Some(taken) = taken.and_then(|taken| choices.get(taken)) {
        *choice = *taken;
    }
}

/// Puts what was drawn into the plan as a leg, and selects it; says why if that can't be.
pub fn add(
    choice: LegChoice,
    drawn: &Drawn,
    aim: Aim,
    approach: Option<Approach>,
    plan: &FlightPlan,
    queue: &mut Queue,
) -> Option<Id> {
    let Some(leg) = leg(choice, drawn, &aim, approach, plan) else {
        queue.view(ViewCommand::Notice(impossible(choice).into()));
        return None;
    };
    put(leg, aim, plan, queue)
}

/// The leg that what was drawn there would become.
pub fn leg(
    choice: LegChoice,
    drawn: &Drawn,
    aim: &Aim,
    approach: Option<Approach>,
    plan: &FlightPlan,
) -> Option<Leg> {
    let profile = Profile::by_name(&plan.aircraft).unwrap_or_default();
    let leg = create::leg(plan, &profile, choice, drawn, approach, level(plan, aim))?;
    Some(match aim {
        Aim::Spot(at) => create::like_beside(plan, leg, at),
        Aim::Way { from, .. } => create::like_beside(plan, leg, &Spot::After(from.clone())),
    })
}

/// Puts a leg into the plan, and selects it.
pub fn put(leg: Leg, aim: Aim, plan: &FlightPlan, queue: &mut Queue) -> Option<Id> {
    let id = leg.id.clone();
    queue.edit(match aim {
        Aim::Spot(at) => create::insert(plan, leg, at),
        Aim::Way { from, way } => create::begin_way(plan, &from, &way, leg)?,
    });
    queue.view(ViewCommand::Select(Some(Selection::Leg(id.clone()))));
    Some(id)
}

fn impossible(choice: LegChoice) -> &'static str {
    match choice {
        LegChoice::Rf => {
            "An arc needs a leg before it, and leads to its side: click a place to the left or right of the path's end."
        }
        LegChoice::Call => "There is no procedure to call: select a leg and make one of it (right-click).",
        _ => "Nothing can be made of that: draw it larger.",
    }
}

/// The altitude in force at a place of the plan.
pub fn level<'a>(plan: &'a FlightPlan, aim: &Aim) -> Option<&'a Altitude> {
    let (Aim::Spot(Spot::Before(id) | Spot::After(id) | Spot::EndOf(id)) | Aim::Way { from: id, .. }) = aim;
    if let Some(stage) = plan.stage(id) {
        return stage.altitude.as_ref();
    }
    plan.leg(id)?.altitude()
}

/// Where the path is before a new leg, and which way it goes there.
pub fn approach(canvas: &Canvas<'_>, aim: &Aim) -> Option<Approach> {
    let plan = canvas.scene.document.plan();
    match aim {
        Aim::Spot(Spot::After(id)) | Aim::Way { from: id, .. } => behind(canvas, &plan.leg(id)?),
        Aim::Spot(Spot::Before(id)) => before(canvas, &plan.leg(id)?),
        Aim::Spot(Spot::EndOf(id)) => {
            let inside = plan.stage(id).map(|s| s.legs.as_slice());
            let inside: Option<&[Arc<Leg>]> = inside.or_else(|| plan.leg(id).map(|c| c.leg.body()));
            let last = inside.and_then(<[_]>::last).or_else(|| before_stage(plan, id))?;
            behind(canvas, &plan.leg(&last.id)?)
        }
    }
}

/// At a fork nothing is flown: the path is where it was before.
fn behind(canvas: &Canvas<'_>, context: &LegContext<'_>) -> Option<Approach> {
    match context.leg.as_fork() {
        Some(_) => before(canvas, context),
        None => end_of(canvas, last_flown(context.leg)),
    }
}

fn before(canvas: &Canvas<'_>, context: &LegContext<'_>) -> Option<Approach> {
    match context.index.checked_sub(1).and_then(|i| context.siblings.get(i)) {
        Some(before) => behind(canvas, &canvas.scene.document.plan().leg(&before.id)?),
        None => canvas.scene.forecast().start_of(&context.leg.first_flown().id),
    }
}

/// The last leg before an empty stage.
fn before_stage<'a>(plan: &'a FlightPlan, id: &Id) -> Option<&'a Arc<Leg>> {
    let stages = plan.stages.iter().take_while(|stage| stage.id != *id);
    stages.filter_map(|stage| stage.legs.last()).last()
}

/// Where a leg leads, if it leads to a place.
pub fn place_of(canvas: &Canvas<'_>, leg: &Leg) -> Option<LatLon> {
    match leg.place()? {
        Place::Fix(id) => canvas.scene.document.plan().fix(id).map(|fix| fix.position),
        Place::Position(_) => {
            let is_its =
                |h: &&Handle| matches!(&h.what, Handled::Waypoint(id) | Handled::Centre(id) if *id == leg.id);
            canvas.sketch.handles.iter().find(is_its).map(|handle| handle.at)
        }
    }
}

/// The end of a leg: by its place and course where it has them, else as it was flown ahead last.
fn end_of(canvas: &Canvas<'_>, leg: &Leg) -> Option<Approach> {
    let flown = canvas.scene.forecast().end_of(&leg.id);
    let is_track = LegChoice::of(&leg.kind).shape() == Shape::Place && !matches!(leg.kind, LegKind::Call(_));
    let Some(from) = place_of(canvas, leg).filter(|_| is_track) else { return flown };
    let constant = |value: &Value<f64>| match value {
        Value::Constant(x) => Some(*x),
        Value::Expression(_) => None,
    };
    let course_deg = match &leg.kind {
        LegKind::If(_) => None,
        LegKind::Tf(_) => start_of_track(canvas, &leg.id).map(|start| start.inverse(from).bearing_end_deg),
        LegKind::Cf { course_deg, .. } => constant(course_deg),
        LegKind::Hf(h) | LegKind::Ha(h) | LegKind::Hm { holding: h, .. } => {
            h.inbound_course_deg.as_ref().and_then(constant)
        }
        LegKind::Rf { centre, turn, .. } => {
            let aside_deg = if *turn == TurnDirection::Right { 90.0 } else { -90.0 };
            Some(normalise_360(centre.bearing_deg(from) + aside_deg))
        }
        _ => flown.and_then(|flown| flown.course_deg),
    };
    Some(Approach { from, course_deg })
}

/// Where a track begins: where the leg before it leads.
fn start_of_track(canvas: &Canvas<'_>, id: &Id) -> Option<LatLon> {
    let context = canvas.scene.document.plan().leg(id)?;
    let before = context.index.checked_sub(1).and_then(|i| context.siblings.get(i))?;
    place_of(canvas, last_flown(before))
}

fn last_flown(leg: &Leg) -> &Leg {
    leg.body().last().map_or(leg, |last| last_flown(last))
}
