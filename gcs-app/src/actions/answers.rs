//! How what is asked or told just now is answered: the card of a new mission, what the vehicle says, messages, work that is
//! being done, the end of a demo.

use super::table::Asked;
use super::{Action, Group, Kind};
use crate::command::{Command, FlyCommand, LinkCommand, ViewCommand};
use crate::guide::{Answer, Drawing, Guide, MissionFigure};
use crate::panels::{Scene, answer, start};
use flight_plan::template::Template;

/// All of them.
pub fn of(scene: &Scene<'_>) -> Vec<Action> {
    let mut actions = if start::is_wanted(scene) { guide(&scene.view.guide) } else { Vec::new() };
    actions.extend(vehicle(scene));
    actions.extend(messages(scene));
    actions.extend(work(scene));
    actions.extend(story(scene));
    actions
}

fn view(group: Group, name: String, command: ViewCommand) -> Action {
    Action::now(group, name, Ok(Command::View(command)))
}

/// What the card offers besides its fields.
fn guide(guide: &Guide) -> Vec<Action> {
    let placed = |command: Command| guide.threshold.map(|_| command).ok_or(start::SAY_WHERE);
    let add = |name: String, asked: Asked| Action::now(Group::File, format!("New mission: {name}"), asked);
    let templates = Template::ALL.into_iter().map(|template| {
        let mut chosen = guide.clone();
        chosen.choose(template);
        let choose = Command::View(ViewCommand::Guide(Answer::Form(Box::new(chosen))));
        Action {
            kind: Kind::Choice(guide.template == template),
            ..add(template.name().into(), placed(choose))
        }
    });
    let draw = |drawing| placed(Command::View(ViewCommand::Guide(Answer::Draw(Some(drawing)))));
    let mission = MissionFigure::of(guide.template)
        .map(|figure| add(format!("draw the {}", figure.name()), draw(Drawing::Mission)));
    let others = [
        add("draw the runway".into(), draw(Drawing::Runway)),
        add("create it".into(), start::creating(guide).map(Command::Document)),
    ];
    templates.chain(mission).chain(others).collect()
}

/// What the vehicle says. A command that is considered is given beside what would follow, and nowhere else.
fn vehicle(scene: &Scene<'_>) -> Vec<Action> {
    let fly = |name: String, command| Action::now(Group::Flight, name, Ok(Command::Fly(command)));
    let mut actions = Vec::new();
    if let Some(considered) = scene.vehicle.outlook.considered() {
        let again = FlyCommand::Consider(considered.command.clone());
        actions.push(fly("Look again at what would follow".into(), again));
        actions.push(fly("Give the considered command up".into(), FlyCommand::PutAside));
    }
    if answer::is_refused(scene) {
        actions.push(fly("Put the answer of the vehicle aside".into(), FlyCommand::PutAnswerAside));
    }
    let announced = scene.vehicles.choices().filter(|(_, vehicle)| !vehicle.unread.is_empty());
    actions.extend(announced.map(|(name, _)| {
        let put_aside = Command::Link(LinkCommand::PutAside(name.clone()));
        Action::now(Group::Flight, format!("Put aside what {name} announced"), Ok(put_aside))
    }));
    actions
}

fn messages(scene: &Scene<'_>) -> impl Iterator<Item = Action> {
    let notice = scene.view.notice.as_ref();
    let notice = notice.map(|_| view(Group::View, "Close the message".into(), ViewCommand::DismissNotice));
    let toasts = scene.toasts.iter().map(|toast| {
        view(Group::View, format!("Put aside: {}", toast.text), ViewCommand::DismissToast(toast.id))
    });
    notice.into_iter().chain(toasts)
}

fn work(scene: &Scene<'_>) -> impl Iterator<Item = Action> {
    let jobs = scene.jobs.lasting(scene.now_s).chain(scene.layers.jobs().lasting(scene.now_s));
    jobs.map(|job| view(Group::File, format!("Cancel: {}", job.label), ViewCommand::Cancel(job.id)))
}

fn story(scene: &Scene<'_>) -> Vec<Action> {
    let Some(end) = scene.story.and_then(|chapter| chapter.end.as_ref()) else { return Vec::new() };
    let report = end.report.clone();
    let report =
        report.map(|path| view(Group::Help, "Open the demo's report".into(), ViewCommand::OpenReport(path)));
    let again = (!end.good).then(|| view(Group::Help, "Fly the demo again".into(), ViewCommand::TellAgain));
    let close = view(Group::Help, "Close the demo's strip".into(), ViewCommand::EndStory);
    report.into_iter().chain(again).chain([close]).collect()
}
