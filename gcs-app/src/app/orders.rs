//! Carrying out commands, one function per owner.

use super::App;
use crate::command::{Command, DocumentCommand, FlyCommand, ViewCommand};
use crate::document::Document;
use crate::link::{Call, Order};
use crate::panels::bar::PUSH;
use flight_exec::Command as PlanCommand;
use usal::contract::{GatewayRequest, Propose};

impl App {
    pub(super) fn carry_out(&mut self, command: Command, now_s: f64) {
        match command {
            Command::Document(command) => self.change_document(command),
            Command::View(command) => self.change_view(command),
            Command::Fly(command) => self.fly(command, now_s),
        }
    }

    fn change_document(&mut self, command: DocumentCommand) {
        let done = match command {
            DocumentCommand::Edit(edit) => self.document.edit(&edit),
            DocumentCommand::DragEdit(edit) => self.document.drag_edit(&edit),
            other => {
                self.handle_file(other);
                Ok(())
            }
        };
        if let Err(why) = done {
            self.view.notice = Some(why);
        }
    }

    fn handle_file(&mut self, command: DocumentCommand) {
        match command {
            DocumentCommand::New => {
                self.document = Document::default();
                self.view.selection = None;
            }
            DocumentCommand::AskOpen => self.files.ask_open(),
            DocumentCommand::Open(path) => self.files.open(path),
            DocumentCommand::Save => match self.document.path() {
                Some(path) => self.save_to(path.to_owned()),
                None => self.ask_save(),
            },
            DocumentCommand::AskSaveAs => self.ask_save(),
            DocumentCommand::SaveTo(path) => self.save_to(path),
            DocumentCommand::EndGesture => self.document.end_gesture(),
            DocumentCommand::Undo => self.document.undo(),
            DocumentCommand::Redo => self.document.redo(),
            DocumentCommand::Edit(_) | DocumentCommand::DragEdit(_) => {}
        }
    }

    fn save_to(&mut self, path: std::path::PathBuf) {
        self.files.save(path, flight_plan::write(self.document.plan()), self.document.version());
    }

    fn ask_save(&mut self) {
        let name = self.document.path().and_then(|p| p.file_name()).map(|n| n.to_string_lossy().into_owned());
        let text = flight_plan::write(self.document.plan());
        self.files.ask_save(name.unwrap_or_else(|| "plan.xml".into()), text, self.document.version());
    }

    fn change_view(&mut self, command: ViewCommand) {
        match command {
            ViewCommand::Select(selection) => self.view.selection = selection,
            ViewCommand::JumpTo(selection) => {
                if let Some(at) = self.map.place_of(&selection, self.document.plan()) {
                    self.view.follow = false;
                    self.map.jump_to(at);
                }
                self.view.selection = Some(selection);
            }
            ViewCommand::Fit => {
                self.view.follow = false;
                self.map.fit();
            }
            ViewCommand::Follow(follow) => {
                self.view.follow = follow;
                if follow {
                    self.map.follow();
                }
            }
            ViewCommand::Units(units) => self.view.units = units,
            ViewCommand::BottomTab(tab) => self.view.bottom = tab,
            ViewCommand::Scrub(cursor_s) => {
                self.view.cursor_s = cursor_s;
                self.view.playing = false;
            }
            ViewCommand::Play(playing) => {
                self.view.playing = playing;
                if self.view.cursor_s.is_some_and(|c| c >= self.analysis.forecast.duration_s()) {
                    self.view.cursor_s = Some(0.0);
                }
            }
            ViewCommand::DismissNotice => self.view.notice = None,
        }
    }

    fn fly(&mut self, command: FlyCommand, now_s: f64) {
        match command {
            FlyCommand::Connect { endpoint, vehicle } => {
                self.link.order(Order::Connect { endpoint, vehicle });
            }
            FlyCommand::Disconnect => {
                self.link.order(Order::Disconnect);
            }
            FlyCommand::Propose => self.propose(now_s),
            FlyCommand::EnterAt(leg) => {
                if let Some(proposal) = &mut self.vehicle.proposal {
                    proposal.entry = Some(leg);
                }
            }
            FlyCommand::Commit => self.commit(now_s),
            FlyCommand::DropProposal => self.vehicle.proposal = None,
            FlyCommand::TakeAboard => {
                if let Some(aboard) = &self.vehicle.aboard {
                    self.document.replace(aboard.plan.as_ref().clone());
                }
            }
            FlyCommand::Plan(command) => {
                let label = plan_label(&command);
                self.call(&label, Call::Plan(command), now_s);
            }
            FlyCommand::Gateway(request) => {
                let label = gateway_label(&request);
                self.call(label, Call::Gateway(request), now_s);
            }
            FlyCommand::Launch => self.call("Start and take off", Call::Plan(PlanCommand::Start), now_s),
        }
    }

    fn propose(&mut self, now_s: f64) {
        self.vehicle.proposal = None;
        let seen_revision = self.vehicle.status.as_ref().map(|s| s.value.revision);
        let xml = flight_plan::write(self.document.plan());
        self.call(PUSH, Call::Propose(Propose { xml, seen_revision }), now_s);
    }

    fn commit(&mut self, now_s: f64) {
        let Some(proposal) = self.vehicle.proposal.take() else { return };
        let command = PlanCommand::Commit { hash: proposal.report.hash, entry: proposal.entry };
        self.call("Commit plan", Call::Plan(command), now_s);
    }
}

/// A command, for people.
fn plan_label(command: &PlanCommand) -> String {
    match command {
        PlanCommand::Start => "Start".into(),
        PlanCommand::Hold => "Hold".into(),
        PlanCommand::Resume => "Resume".into(),
        PlanCommand::SkipLeg => "Skip leg".into(),
        PlanCommand::GoTo { leg } => format!("Go to {leg}"),
        PlanCommand::SetCount { leg, count } => format!("{leg}: count {count}"),
        PlanCommand::Decide { leg, branch } => format!("{leg}: take {branch}"),
        PlanCommand::SetVariable { name, value } => {
            format!("Set {name} to {}", crate::state::log::variable(value))
        }
        PlanCommand::Emergency { plan: Some(plan), .. } => format!("Emergency: fly {plan}"),
        PlanCommand::Emergency { plan: None, .. } => "Emergency: fly the alternate in force".into(),
        PlanCommand::ReturnToMain { leg } => format!("Return to the main plan at {leg}"),
        PlanCommand::AbortToSafe => "Abort: Safe mode".into(),
        PlanCommand::Commit { .. } => "Commit plan".into(),
    }
}

fn gateway_label(request: &GatewayRequest) -> &'static str {
    match request {
        GatewayRequest::Launch => "Launch",
        GatewayRequest::Hold => "Hold (gateway)",
        GatewayRequest::Resume => "Resume (gateway)",
        GatewayRequest::Direct { .. } => "Direct",
        GatewayRequest::Safe => "Enter Safe mode",
        GatewayRequest::Recover => "Leave Safe mode",
        GatewayRequest::SetRunways { .. } => "Store runways",
        GatewayRequest::SetSafe(_) => "Set Safe mode",
        GatewayRequest::Terminate { .. } => "Terminate",
    }
}
