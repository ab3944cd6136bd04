//! What is asked of the vehicle: connecting, pushing a plan, and the commands of the flight.

use super::table::Asked;
use super::{Action, Group, Kind};
use crate::command::{Command, FlyCommand, LinkCommand};
use crate::connections::{self, Connection};
use crate::panels::{
    Scene, decision, emergency as banner, flight as panel, in_force, leading, link, no_start, push,
};
use flight_exec::{Command as PlanCommand, Phase};
use flight_plan::{Cause, Id};
use std::borrow::Cow;
use usal::contract::{GatewayRequest, GatewayState};

/// What depends on the plan aboard and on what is asked: branches, emergency plans, legs to go to.
pub fn of(scene: &Scene<'_>) -> Vec<Action> {
    let mut actions = Vec::new();
    let mut add = |kind: Kind, name: String, command: Command| {
        let command = match command {
            Command::Fly(_) => linked(scene).map(|()| command),
            _ => Ok(command),
        };
        actions.push(Action { kind, ..Action::now(Group::Flight, name, command) });
    };
    let fly = |command: PlanCommand| Command::Fly(FlyCommand::Plan(command));
    if let Some((request, _)) = decision::open(scene) {
        for option in request.options {
            let command = PlanCommand::Decide { leg: request.leg.clone(), branch: option.branch };
            add(Kind::Do, format!("Decide: {}", option.label), fly(command));
        }
    }
    if is_in_the_air(scene) && !panel::is_on_ground(scene) {
        let aboard = scene.vehicle.aboard.as_ref();
        for alternate in aboard.map(|aboard| aboard.plan.emergency_plans.as_slice()).unwrap_or_default() {
            let name = format!("Emergency: fly {}", scene.vehicle.name_of(&alternate.id));
            let plan = Some(alternate.id.clone());
            add(Kind::Hold, name, fly(PlanCommand::Emergency { cause: Cause::Operator, plan }));
        }
    }
    for (name, command) in leading::all(scene) {
        add(Kind::Do, name, consider(command));
    }
    let proposal = scene.vehicle.proposal.as_ref().filter(|proposal| proposal.report.entry_needed);
    for leg in proposal.iter().flat_map(|_| push::entries(scene)) {
        let name = format!("Enter what was pushed at {}", scene.document.label(leg));
        add(Kind::Do, name, Command::Fly(FlyCommand::EnterAt(leg.clone())));
    }
    for connection in link::offers(scene) {
        let name = format!("Connect to {} at {}", connection.vehicle, connection.endpoint);
        add(Kind::Do, name, Command::Link(link::connecting(connection)));
    }
    for (name, _) in scene.vehicles.choices() {
        let is_shown = scene.vehicles.shown_name() == Some(name);
        let command = Command::Link(LinkCommand::Show(name.clone()));
        add(Kind::Choice(is_shown), format!("Show vehicle {}", name.as_str()), command);
    }
    actions
}

/// The action that opens the palette for an address.
pub const CONNECT_TO: &str = "connect-to";
/// What is typed there then, before the address.
pub const QUERY: &str = "connect to ";

/// What is typed may be an address, and behind it the name of a vehicle; else it is the one that is shown.
pub fn connect_to(query: &str, scene: &Scene<'_>) -> Option<Action> {
    let (begin, typed) = query.split_at_checked(QUERY.len())?;
    let typed = begin.eq_ignore_ascii_case(QUERY).then(|| typed.trim())?;
    let (address, named) = typed.split_once(char::is_whitespace).unwrap_or((typed, ""));
    let made = connections::endpoint(address).and_then(|endpoint| {
        let vehicle =
            if named.is_empty() { link::default_connection(scene).vehicle } else { named.trim().into() };
        connections::name_problem(&vehicle).map_or(Ok(Connection { endpoint, vehicle }), Err)
    });
    let name = made
        .as_ref()
        .map_or_else(|_| typed.to_owned(), |made| format!("{}, vehicle {}", made.endpoint, made.vehicle));
    let command = made.map(|made| Command::Link(link::connecting(&made))).map_err(Cow::Owned);
    Some(Action { command, ..Action::now(Group::Flight, format!("Connect to {name}"), Err("")) })
}

/// As the form would.
pub(super) fn connect(scene: &Scene<'_>) -> Asked {
    if scene.vehicle.open_link().is_some() {
        return Err("A link is open: disconnect it first");
    }
    let made = link::default_connection(scene);
    Ok(Command::Link(link::connecting(&made)))
}

/// Without a link no command arrives.
fn linked(scene: &Scene<'_>) -> Result<(), &'static str> {
    scene.vehicle.open_link().map(drop).ok_or("Not connected")
}

pub(super) fn commit(scene: &Scene<'_>) -> Asked {
    linked(scene)?;
    let proposal = scene.vehicle.proposal.as_ref().ok_or(NOT_PUSHED)?;
    if !proposal.report.acceptable {
        Err("What was pushed can't be flown: it stays a draft")
    } else if !push::is_ready(proposal) {
        Err("Choose the leg at which it is entered first")
    } else {
        Ok(Command::Fly(FlyCommand::Commit))
    }
}

pub(super) fn keep_as_draft(scene: &Scene<'_>) -> Asked {
    scene.vehicle.proposal.as_ref().ok_or(NOT_PUSHED)?;
    Ok(Command::Fly(FlyCommand::DropProposal))
}

const NOT_PUSHED: &str = "Push a plan first";

pub(super) fn rewind(scene: &Scene<'_>) -> Asked {
    linked(scene)?;
    let why_not = "A vehicle that stands disarmed with a plan that was begun can be rewound";
    if panel::can_rewind(scene) { plan(PlanCommand::Rewind) } else { Err(why_not) }
}

pub(super) fn skip(scene: &Scene<'_>) -> Asked {
    led_by_plan(scene)?;
    flying(scene, PlanCommand::SkipLeg)?;
    if leading::is_last_landing(scene) {
        return Err("The landing is the last leg of the flight: there is nothing to skip to");
    }
    Ok(consider(PlanCommand::SkipLeg))
}

/// Where the banner of the emergency leads back to.
pub(super) fn return_to_main(scene: &Scene<'_>) -> Asked {
    linked(scene)?;
    let leg = banner::way_back_to(scene).ok_or("No emergency plan is being flown")?;
    Ok(consider(PlanCommand::ReturnToMain { leg }))
}

fn plan(command: PlanCommand) -> Asked {
    Ok(Command::Fly(FlyCommand::Plan(command)))
}

/// What leads elsewhere is looked at before it is given.
fn consider(command: PlanCommand) -> Command {
    Command::Fly(FlyCommand::Consider(command))
}

const NOT_FLYING: &str = "No plan is being flown";

fn is_flying(scene: &Scene<'_>) -> bool {
    matches!(scene.vehicle.phase(), Phase::Flying | Phase::AwaitingDecision) && !banner::has_come_down(scene)
}

fn is_in_the_air(scene: &Scene<'_>) -> bool {
    let is_holding = scene.vehicle.phase() == Phase::Holding && !banner::has_come_down(scene);
    is_holding || is_flying(scene)
}

fn flying(scene: &Scene<'_>, command: PlanCommand) -> Asked {
    linked(scene)?;
    match scene.vehicle.phase() {
        _ if is_flying(scene) => plan(command),
        Phase::Holding => Err("It holds: resume first"),
        _ => Err(NOT_FLYING),
    }
}

/// What the plan would do next is not what Safe mode does.
fn led_by_plan(scene: &Scene<'_>) -> Result<(), &'static str> {
    let why_not = "Safe mode leads the aircraft: the plan's commands reach it once Safe mode is left";
    if banner::is_safe_mode(scene) { Err(why_not) } else { Ok(()) }
}

/// A glide has no height for circles: the executor refuses them.
pub(super) fn hold(scene: &Scene<'_>) -> Asked {
    led_by_plan(scene)?;
    let command = flying(scene, PlanCommand::Hold)?;
    if scene.vehicle.is_engine_out() && banner::is_flown(scene) {
        return Err("Without an engine it would sink while it holds, and lack that height before the runway");
    }
    Ok(command)
}

pub(super) fn in_the_air(scene: &Scene<'_>, command: PlanCommand) -> Asked {
    linked(scene)?;
    if is_in_the_air(scene) { plan(command) } else { Err(NOT_FLYING) }
}

pub(super) fn resume(scene: &Scene<'_>) -> Asked {
    linked(scene)?;
    if panel::can_resume(scene) {
        plan(PlanCommand::Resume)
    } else {
        Err("The plan is being flown, or none is")
    }
}

pub(super) fn start(scene: &Scene<'_>) -> Asked {
    linked(scene)?;
    if scene.vehicle.unfit().is_some() {
        return Err("Its autopilot is not set up for it: the bar of the commands says what to do");
    }
    no_start::why(scene).map_or(Ok(Command::Fly(FlyCommand::Launch)), Err)
}

/// Why there is nothing to fly where no alternate is in force.
const NO_ALTERNATE: &str =
    "No emergency plan is in force here. \u{201c}Abort: Safe mode flies home\u{201d} is in the palette";

/// The alternate of this name, or else the one in force.
pub fn emergency(scene: &Scene<'_>, plan: Option<Id>) -> Asked {
    linked(scene)?;
    let plan = plan.or_else(|| in_force::without_engine(scene));
    if panel::is_on_ground(scene) {
        return Err(panel::ON_GROUND);
    }
    let status = scene.vehicle.status.as_ref().map(|status| &status.value);
    let has_one = status.is_some_and(|s| s.emergency_in_force.is_some() || s.emergency.is_some());
    let command = in_the_air(scene, PlanCommand::Emergency { cause: Cause::Operator, plan: plan.clone() })?;
    if plan.is_some() || has_one { Ok(command) } else { Err(NO_ALTERNATE) }
}

pub(super) fn leave_safe(scene: &Scene<'_>) -> Asked {
    linked(scene)?;
    let state = scene.vehicle.gateway.as_ref().map(|g| g.value.state);
    if matches!(state, Some(GatewayState::SafeHold | GatewayState::SafeReturn)) {
        Ok(Command::Fly(FlyCommand::Gateway(GatewayRequest::Recover)))
    } else {
        Err("The gateway is not in Safe mode")
    }
}

pub(super) fn disconnect(scene: &Scene<'_>) -> Asked {
    let name = scene.vehicles.shown_name().filter(|_| scene.vehicle.open_link().is_some());
    let name = name.ok_or("No link is open")?;
    Ok(Command::Link(LinkCommand::Disconnect(name.clone())))
}
