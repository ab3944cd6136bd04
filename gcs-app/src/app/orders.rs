//! Carrying out commands, one function per owner.

use super::App;
use super::links::gateway_label;
use crate::command::{
    Command, DocumentCommand, FlyCommand, LinkCommand, Replacement, Selection, ViewCommand,
};
use crate::document::Document;
use crate::guide::Answer;
use crate::link::Call;
use crate::panels::{counted, what_if};
use crate::state::{LOOK_AHEAD, Level, Proposal, START, Vehicle, VehicleName};
use flight_exec::Command as PlanCommand;
use flight_plan::{FlightPlan, Id};

/// So long is said why a gesture did nothing, seconds.
const REFUSAL_S: f64 = 20.0;

impl App {
    /// Carries out a command; one to a vehicle goes to `shown`, the one that was drawn when it was given.
    pub(super) fn carry_out(&mut self, command: Command, shown: Option<&VehicleName>, now_s: f64) {
        match command {
            Command::Document(command) => self.change_document(command, now_s),
            Command::View(command) => self.change_view(command, now_s),
            Command::Preview(command) => self.change_preview(command),
            Command::Layer(command) => self.change_layers(command),
            Command::Link(command) => self.change_link(command, now_s),
            Command::Each(commands) => {
                commands.into_iter().for_each(|command| self.carry_out(command, shown, now_s));
            }
            Command::Fly(command) => {
                if let Some(vehicle) = shown {
                    self.fly(vehicle, command, now_s);
                }
            }
        }
    }

    /// What went out of the plan may leave behind a fix that it went to.
    fn tell_of_unused(&mut self, before: &FlightPlan, now_s: f64) {
        let (was, now) = (before.unused_fixes(), self.document.plan().unused_fixes());
        let left: Vec<&str> = now.difference(&was).map(|fix| fix.as_str()).collect();
        if !left.is_empty() {
            let text = format!("No leg goes to {} any more", left.join(", "));
            self.toasts.add(now_s, Level::Info, text);
        }
    }

    /// Much is lost by one key: how much is told, with a way back.
    fn tell_of_removed(&mut self, before: &FlightPlan, now_s: f64) {
        if let Some(text) = counted::removed(before, self.document.plan()) {
            self.toasts.add_with_undo(now_s, text, self.document.version());
        }
    }

    fn change_document(&mut self, command: DocumentCommand, now_s: f64) {
        match command {
            DocumentCommand::Edit(edit) => {
                let before = edit.removes().then(|| self.document.plan().clone());
                let done = self.document.edit(&edit);
                self.tell(done);
                if let Some(before) = before {
                    self.tell_of_removed(&before, now_s);
                    self.tell_of_unused(&before, now_s);
                }
            }
            DocumentCommand::DragEdit(edit) => {
                let done = self.document.drag_edit(&edit);
                self.tell(done);
            }
            DocumentCommand::AddRunway { threshold, end, both } => {
                let made = self.add_runway(threshold, end, both);
                self.tell_of_what_was_made(made, now_s);
            }
            DocumentCommand::BringHome { runway, outwards, from } => {
                let made = self.bring_home(&runway, &outwards, from);
                self.tell_of_what_was_made(made, now_s);
            }
            DocumentCommand::Dropped(path) => self.files.sort_dropped(path),
            DocumentCommand::TakeImport => self.take_import(now_s),
            DocumentCommand::AddImport => self.add_import(now_s),
            DocumentCommand::ImportAs(choices) => self.import_as(*choices),
            DocumentCommand::Export(format) => self.export(format),
            DocumentCommand::AskExport => self.ask_export(),
            DocumentCommand::ExportTo { path, over } => self.export_to(path, over),
            DocumentCommand::SaveThen(with) => {
                self.view.unsaved = None;
                if with != Replacement::Quit {
                    self.save();
                }
                self.after_saving = Some(with);
            }
            DocumentCommand::Replace(with) => self.ask_or_replace(with),
            DocumentCommand::Discard(with) => {
                self.document.set_discarded(true);
                self.replace(with);
            }
            DocumentCommand::Open(path) => self.replace(Replacement::Open(path)),
            DocumentCommand::Create(outline) => self.create(*outline),
            DocumentCommand::Recover(only) => self.recover(only),
            DocumentCommand::ForgetLeftBehind(only) => drop(self.take_left_behind(only)),
            DocumentCommand::Save => self.save(),
            DocumentCommand::AskSaveAs => self.ask_save(),
            DocumentCommand::Browse(folder, name) => self.browse(folder, name),
            DocumentCommand::SaveTo { path, over } => self.save_to(path, over),
            DocumentCommand::EndGesture => self.document.end_gesture(),
            DocumentCommand::LoadTheirs => self.load_theirs(),
            DocumentCommand::KeepMine => self.keep_mine(),
            DocumentCommand::Undo => {
                let left = self.document.plan().clone();
                if self.shelf.undo(&mut self.document) {
                    self.show_another();
                    self.tell_of_turn(&left, ("Undone", "Redo (Ctrl+Y)"), now_s);
                } else if !left.stages.is_empty() && self.document.plan().stages.is_empty() {
                    let text = format!("Undone: “{}” was made. Redo (Ctrl+Y) brings it back", left.name);
                    self.toasts.add(now_s, Level::Info, text);
                }
            }
            DocumentCommand::Redo => {
                let left = self.document.plan().clone();
                if self.shelf.redo(&mut self.document) {
                    self.show_another();
                    self.tell_of_turn(&left, ("Redone", "Undo (Ctrl+Z)"), now_s);
                }
            }
        }
    }

    /// Another plan is shown in the place of this one: what was done, and what leads back.
    fn tell_of_turn(&mut self, left: &FlightPlan, (done, back): (&str, &str), now_s: f64) {
        let (left, shown) = (&left.name, &self.document.plan().name);
        let text = format!("{done}: the plan “{shown}” is shown. {back} brings “{left}” back");
        self.toasts.add(now_s, Level::Info, text);
    }

    /// Says why it could not be made, or else what should be known of it.
    fn tell_of_what_was_made(&mut self, made: Result<impl IntoIterator<Item = String>, String>, now_s: f64) {
        match made {
            Ok(texts) => texts.into_iter().for_each(|text| self.toasts.add(now_s, Level::Caution, text)),
            Err(why) => self.tell(Err(why)),
        }
    }

    /// Says why an edit could not be done.
    pub(super) fn tell(&mut self, done: Result<(), String>) {
        if let Err(why) = done {
            self.view.notice = Some(self.document.plan().in_names(&why));
        }
    }

    pub(super) fn ask_or_replace(&mut self, with: Replacement) {
        let would_be_lost = match with {
            Replacement::Quit => self.may_not_close(),
            // what is read may be added to the plan; and undo brings a plan back that it takes the place of
            Replacement::AskImport => false,
            _ => self.document.is_dirty(),
        };
        if would_be_lost {
            self.view.unsaved = Some(with);
        } else {
            // whatever was given up for another plan that did not come after all is wanted
            self.document.set_discarded(false);
            self.replace(with);
        }
    }

    pub(super) fn replace(&mut self, with: Replacement) {
        self.view.unsaved = None;
        // a file that turns out to be none leaves the dialog as it was
        if !matches!(with, Replacement::Open(_)) {
            self.view.browsing = None;
        }
        match with {
            Replacement::New => {
                self.shelf.open(&mut self.document, Document::default());
                self.view.guide.open();
                self.forget_the_last();
            }
            Replacement::AskOpen => self.files.ask_open(false),
            Replacement::AskImport => self.files.ask_open(true),
            Replacement::Open(path) => self.files.open(path),
            Replacement::Quit => self.leaving = true,
        }
    }

    fn change_view(&mut self, command: ViewCommand, now_s: f64) {
        match command {
            ViewCommand::Select(selection) => {
                if let Some(selection) = &selection {
                    self.map.reveal(selection);
                }
                self.view.select(selection);
            }
            ViewCommand::PointOut(what) => self.view.pointed = what,
            ViewCommand::Toggle(what) => self.view.toggle(what),
            ViewCommand::SelectTogether(all) => self.view.select_together(all),
            ViewCommand::SelectAllLegs => self.view.select_all_legs(self.document.plan()),
            ViewCommand::RaiseAll => {
                self.dock.show_panel(crate::panels::inspector::ID, true);
                self.view.raise_all(self.document.plan());
            }
            ViewCommand::JumpTo(selection) => self.jump_to(selection),
            ViewCommand::JumpToPlace(at, selection) => {
                self.view.follow = false;
                self.map.jump_to(at);
                self.view.select(selection);
            }
            ViewCommand::Fit => {
                self.view.follow = false;
                self.map.fit();
            }
            ViewCommand::Lock(locked) => self.view.locked = locked,
            ViewCommand::Zoom(by) => self.map.zoom(by),
            ViewCommand::Clip(clip) => self.map.clip(clip),
            ViewCommand::Follow(follow) => self.follow(follow),
            ViewCommand::Guide(answer) => self.answer(answer),
            ViewCommand::Tool(id) => {
                self.view.guide.take(Answer::Draw(None));
                self.map.choose_tool(id);
            }
            ViewCommand::DrawWay(from) => {
                self.view.select(Some(Selection::Leg(from)));
                self.map.draw_way();
            }
            ViewCommand::Units(units) => self.view.units = units,
            ViewCommand::Theme(theme) => (self.view.theme, self.theme_of_old) = (theme, None),
            ViewCommand::Scale(scale) => self.view.scale = scale,
            ViewCommand::Palette(begins) => self.view.palette = begins,
            ViewCommand::Help(topic) => self.view.help = topic,
            ViewCommand::Search => {
                self.dock.show_panel(crate::panels::tree::ID, true);
                self.view.search = true;
            }
            ViewCommand::Rename(what) => {
                self.dock.show_panel(crate::panels::tree::ID, true);
                self.view.rename = Some(what);
            }
            ViewCommand::RowMenu => {
                self.dock.show_panel(crate::panels::tree::ID, true);
                self.view.row_menu = true;
            }
            ViewCommand::SelectBranch(branch) => self.view.select_branch(branch),
            ViewCommand::StepPanel(by) => self.view.panel_step = by,
            ViewCommand::ShowPanel(panel, shown) => {
                self.view.wanted_panel = Some(panel).filter(|_| shown && self.vehicles.shown().is_airborne());
                self.dock.show_panel(panel, shown);
                if panel == what_if::ID && !shown {
                    self.end_what_happens();
                }
            }
            ViewCommand::Maps(open) => self.view.maps = open,
            ViewCommand::Edge(edge) => self.view.edge = edge,
            ViewCommand::ResetLayout => self.dock.reset(&self.panels),
            ViewCommand::Notice(text) => {
                self.refusal = Some((text.clone(), now_s + REFUSAL_S));
                self.view.notice = Some(text);
            }
            ViewCommand::Toast(text) => self.toasts.add(now_s, Level::Info, text),
            ViewCommand::DismissNotice => self.view.notice = None,
            ViewCommand::NameFile(name) => {
                self.view.browsing.iter_mut().for_each(|browsing| browsing.name.clone_from(&name));
            }
            ViewCommand::StopBrowsing => self.stop_browsing(),
            ViewCommand::PutImportAside => self.view.imported = None,
            ViewCommand::PutExportAside => self.view.exported = None,
            ViewCommand::Cancel(job) => {
                self.files.cancel(job);
                self.layers.cancel(job);
            }
            ViewCommand::OpenReport(path) => self.files.show(path),
            ViewCommand::EndStory => self.story = None,
            ViewCommand::TellAgain => self.tell_again(),
            ViewCommand::AskRecovery(asked) => self.view.recovers_later = !asked,
            ViewCommand::Tour(step) => self.view.tour = step,
            ViewCommand::KeepToast(id) => self.toasts.keep(id, now_s),
            ViewCommand::DismissToast(id) => self.toasts.dismiss(id),
            ViewCommand::KeepUnsaved => self.view.unsaved = None,
        }
    }

    fn follow(&mut self, follow: bool) {
        self.view.follow = follow;
        if follow {
            self.map.follow();
        }
    }

    fn jump_to(&mut self, selection: Selection) {
        if let Some(at) = self.map.place_of(&selection, self.document.plan()) {
            self.view.follow = false;
            self.map.jump_to(at);
        }
        self.view.select(Some(selection));
    }

    fn answer(&mut self, answer: Answer) {
        if let Some(at) = self.view.guide.new_place(&answer) {
            self.map.begin_at(at);
            // what was typed before is no longer what is wrong
            self.view.notice = None;
        }
        self.view.guide.take(answer);
    }

    fn change_link(&mut self, command: LinkCommand, now_s: f64) {
        match command {
            LinkCommand::Connect { endpoint, vehicle } => self.connect(&endpoint, &vehicle, now_s),
            LinkCommand::Disconnect(vehicle) => self.disconnect(&vehicle),
            LinkCommand::Show(vehicle) => self.vehicles.show(&vehicle),
            LinkCommand::PutAside(vehicle) => {
                if let Some(vehicle) = self.vehicles.get_mut(&vehicle) {
                    vehicle.unread.clear();
                }
            }
        }
    }

    fn fly(&mut self, vehicle: &VehicleName, command: FlyCommand, now_s: f64) {
        match command {
            FlyCommand::Propose => self.propose(vehicle),
            FlyCommand::EnterAt(leg) => {
                if let Some(proposal) = self.vehicles.get_mut(vehicle).and_then(|v| v.proposal.as_mut()) {
                    proposal.entry = Some(leg);
                }
            }
            FlyCommand::Commit => self.commit(vehicle, now_s),
            FlyCommand::DropProposal => drop(self.take_proposal(vehicle)),
            FlyCommand::TakeAboard => {
                if let Some(aboard) = self.vehicles.get(vehicle).and_then(|v| v.aboard.as_ref()) {
                    self.document.replace(aboard.plan.as_ref().clone());
                }
            }
            FlyCommand::Plan(command) => {
                let Some(known) = self.vehicles.get(vehicle) else { return };
                let label = plan_label(&command, known);
                self.put_aside(vehicle);
                self.call(vehicle, &label, Call::Plan(command), now_s);
            }
            FlyCommand::Consider(command) => self.consider(vehicle, command, now_s),
            FlyCommand::PutAside => self.put_aside(vehicle),
            FlyCommand::PutAnswerAside => {
                self.vehicles.get_mut(vehicle).into_iter().for_each(|vehicle| vehicle.requests.put_aside());
            }
            FlyCommand::Gateway(request) => {
                let label = gateway_label(&request);
                self.call(vehicle, label, Call::Gateway(request), now_s);
            }
            FlyCommand::Launch => {
                self.call(vehicle, START, Call::Plan(PlanCommand::Start), now_s);
            }
        }
    }

    fn put_aside(&mut self, vehicle: &VehicleName) {
        if let Some(vehicle) = self.vehicles.get_mut(vehicle) {
            vehicle.outlook.put_aside();
        }
    }

    fn consider(&mut self, name: &VehicleName, command: PlanCommand, now_s: f64) {
        let Some(vehicle) = self.vehicles.get_mut(name) else { return };
        let leg = vehicle.current_leg().cloned();
        vehicle.outlook.consider(command.clone(), leg);
        // while another such question is answered, it is asked behind that one
        if vehicle.may_look_ahead() || vehicle.open_link().is_none() {
            self.ask_what_follows(name, command, now_s);
        }
    }

    /// Asks what would follow the command that is considered.
    pub(super) fn ask_what_follows(&mut self, name: &VehicleName, command: PlanCommand, now_s: f64) {
        let ticket = self.call(name, LOOK_AHEAD, Call::Foresee(Some(command)), now_s);
        if let (Some(vehicle), Some(ticket)) = (self.vehicles.get_mut(name), ticket) {
            let leg = vehicle.current_leg().cloned();
            vehicle.outlook.asked_what_follows(ticket, leg, now_s);
            if vehicle.open_link().is_none() {
                vehicle.outlook.answered(ticket, Err("there is no link: connect first".into()), now_s, None);
            }
        }
    }

    pub(super) fn take_proposal(&mut self, vehicle: &VehicleName) -> Option<Proposal> {
        self.vehicles.get_mut(vehicle)?.proposal.take()
    }

    fn commit(&mut self, vehicle: &VehicleName, now_s: f64) {
        let Some(proposal) = self.take_proposal(vehicle) else { return };
        let command = PlanCommand::Commit { hash: proposal.report.hash, entry: proposal.entry };
        self.call(vehicle, "Commit plan", Call::Plan(command), now_s);
    }
}

/// A command, for people, with what they call the parts of the plan aboard.
pub(crate) fn plan_label(command: &PlanCommand, vehicle: &Vehicle) -> String {
    let of = |id: &Id| vehicle.name_of(id);
    match command {
        PlanCommand::Start => "Start".into(),
        PlanCommand::Hold => "Hold".into(),
        PlanCommand::Resume => "Resume".into(),
        PlanCommand::SkipLeg => "Skip leg".into(),
        PlanCommand::GoTo { leg } => format!("Go to {}", of(leg)),
        PlanCommand::SetCount { leg, count } => format!("{}: count {count}", of(leg)),
        PlanCommand::Decide { leg, branch } => {
            format!("{}: take {}", of(leg), vehicle.name_of_branch(leg, branch))
        }
        PlanCommand::SetVariable { name, value } => {
            format!("Set {name} to {}", crate::state::log::variable(value))
        }
        PlanCommand::Emergency { plan: Some(plan), .. } => format!("Emergency: fly {}", of(plan)),
        PlanCommand::Emergency { plan: None, .. } => "Emergency: fly the alternate in force".into(),
        PlanCommand::ReturnToMain { leg } => format!("Return to the main plan at {}", of(leg)),
        PlanCommand::Rewind => "Rewind to the start".into(),
        PlanCommand::AbortToSafe => "Abort: Safe mode".into(),
        PlanCommand::Commit { .. } => "Commit plan".into(),
    }
}
