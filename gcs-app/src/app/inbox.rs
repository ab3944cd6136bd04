//! What comes in between two frames: from the links, from the worker, from files. Nothing here waits for any of them.

use super::{App, Now};
use crate::document::Document;
use crate::forecast::{Analysis, Forecast, Question};
use crate::link::{BACKLOG, Call};
use crate::panels::problems;
use crate::state::{LOOK_AHEAD, READ_ABOARD, VehicleName};
use flight_plan::{Id, transform};

impl App {
    /// Takes in all that has come since the last frame, and asks for what is wanted next.
    pub(super) fn drain(&mut self, ctx: &egui::Context) {
        let now = self.now(ctx);
        let now_s = now.window_s;
        self.drain_links(now);
        while let Some(event) = self.files.next_event() {
            self.file_event(event, now_s);
        }
        // after the files: what was found out of one plan is never said of another
        self.drain_worker(ctx);
        self.view.behind_since_s = match self.scene(now).is_behind() {
            true => self.view.behind_since_s.or(Some(now_s)),
            false => None,
        };
        self.look_again(now);
        self.tend_pushes(now_s);
        self.watch_file();
        self.go_on_after_saving();
        if let Some((story, chapter)) = &mut self.story {
            *chapter = story.chapter();
            story.take_work().into_iter().for_each(|job| self.files.adopt(job));
        }
        self.tend_messages(ctx, now_s);
    }

    /// What the vehicles say; and what they are asked because of it.
    fn drain_links(&mut self, now: Now) {
        let now_s = now.window_s;
        let had_proposal = self.vehicles.shown().proposal.is_some();
        // no more than that in a frame: who talks without a break must not stop the drawing
        for _ in 0..=BACKLOG {
            let Some(message) = self.links.message() else { break };
            self.vehicles.receive(message, now_s);
        }
        if !had_proposal {
            self.show_what_is_proposed();
        }
        self.vehicles.look_ahead(self.layers.ground().as_ref());
        self.look_out(now);
        self.adopt_plan_aboard();
        for vehicle in self.vehicles.due_for_plan(now_s) {
            self.call(&vehicle, READ_ABOARD, Call::PlanAboard, now_s);
        }
        // what somebody waits for comes first: one question at a time
        for (vehicle, command) in self.vehicles.due_to_look_ahead(now_s) {
            self.ask_what_follows(&vehicle, command, now_s);
        }
        for vehicle in self.vehicles.due_for_way(now_s) {
            let ticket = self.call(&vehicle, LOOK_AHEAD, Call::Foresee(None), now_s);
            if let (Some(vehicle), Some(ticket)) = (self.vehicles.get_mut(&vehicle), ticket) {
                vehicle.outlook.asked_which_way(ticket, now_s);
            }
        }
        self.compare_with_aboard();
    }

    /// What was found out about the plan; and what is asked about it now.
    fn drain_worker(&mut self, ctx: &egui::Context) {
        if let Some(analysis) = self.worker.answer() {
            self.analysis = analysis;
        }
        let (document, version) = (self.document.id(), self.document.version());
        if self.analysis.document != document {
            self.analysis = Analysis::default();
        }
        self.select_first_error(ctx);
        self.drain_layers(ctx);
        self.worker.ask(Question {
            document,
            version,
            plan: self.document.plan().clone(),
            what_if: self.view.what_if.clone(),
            autopilot: self.vehicles.shown().autopilot(),
            alarm: self.view.alarm_at_cursor(),
            coverage: self.view.coverage,
        });
    }

    /// Shows a path in the place of the one that was found out, until the plan or its world changes.
    pub fn show_path(&mut self, forecast: Forecast) {
        self.analysis = self.worker.put_path(forecast);
    }

    /// In a plan that was opened or imported with errors, what the gravest one is of, once that is known.
    fn select_first_error(&mut self, ctx: &egui::Context) {
        let (analysis, document) = (&self.analysis, &self.document);
        let is_known = (analysis.document, analysis.version) == (document.id(), document.version());
        if self.looked_through == document.id() || !is_known || !analysis.reviewed {
            return;
        }
        self.looked_through = document.id();
        // one that was drawn here, or is shown as it is aboard, was not brought
        let is_brought = !document.is_nobodys() && !document.can_undo();
        if is_brought && self.view.selection.is_none() {
            let first = problems::first_in_error(&self.scene(self.now(ctx)));
            self.view.select(first);
        }
    }

    /// A window without a plan of its own shows the one that is aboard, also when another changes it there.
    fn adopt_plan_aboard(&mut self) {
        let Some(shown) = self.vehicles.shown_name().cloned() else { return };
        self.drop_plan_of_another(&shown);
        let Some(aboard) = &self.vehicles.shown().aboard else { return };
        let version = self.document.version();
        let here = self.analysis.hash_of(version);
        if here.is_some_and(|hash| *hash == *aboard.hash) {
            self.mirrored = Some((shown, version));
            return;
        }
        let is_empty = self.document.plan().stages.is_empty();
        let was_aboard = here.is_some() && self.mirrored == Some((shown.clone(), version));
        if self.document.is_nobodys() && (is_empty || was_aboard) {
            self.document = Document::new(aboard.plan.as_ref().clone(), None, Vec::new());
            self.mirrored = Some((shown, self.document.version()));
            if is_empty {
                self.map.fit();
            }
        }
    }

    /// Another vehicle's plan is not to be seen under this one.
    fn drop_plan_of_another(&mut self, shown: &VehicleName) {
        let version = self.document.version();
        let belongs_to_another =
            self.mirrored.as_ref().is_some_and(|(whose, of)| whose != shown && *of == version);
        if belongs_to_another && self.document.is_nobodys() {
            self.document = Document::default();
            self.view.select(None);
            (self.view.cursor_s, self.view.alarm) = (None, None);
        }
    }

    /// The panel of a proposal takes room from the map: what differs is to be seen while one decides.
    fn show_what_is_proposed(&mut self) {
        let Some(proposal) = &self.vehicles.shown().proposal else { return };
        // another plan that was opened meanwhile may have legs of the same names elsewhere
        let here = self.analysis.hash_of(self.document.version());
        if here.is_some_and(|hash| *hash != *proposal.report.hash) {
            return;
        }
        let differs: Vec<Id> =
            proposal.report.added.iter().chain(&proposal.report.changed).cloned().collect();
        let places = transform::places_of(self.document.plan(), &differs);
        if !places.is_empty() {
            self.map.reveal_all(places);
        }
    }

    /// A proposal is shown beside the plan aboard, and so is a plan that is edited in flight.
    fn compare_with_aboard(&mut self) {
        self.aboard.receive();
        let vehicle = self.vehicles.shown();
        let Some(aboard) = &vehicle.aboard else { return };
        let shown = self.analysis.hash_of(self.document.version());
        let is_another = vehicle.is_airborne() && shown.is_some_and(|shown| *shown != *aboard.hash);
        if is_another || vehicle.proposal.is_some() {
            self.aboard.ask(aboard, vehicle.autopilot());
        }
    }
}
