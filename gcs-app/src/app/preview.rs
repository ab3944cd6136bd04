//! The flight ahead of time: its cursor, the world it is flown in, and an alarm at the cursor.

use super::App;
use crate::command::{PreviewCommand, Selection};
use crate::panels::Speed;
use flight_exec::rehearse::WhatIf;
use flight_plan::Cause;

impl App {
    pub(super) fn change_preview(&mut self, command: PreviewCommand) {
        match command {
            PreviewCommand::Scrub(cursor_s) => self.scrub(cursor_s),
            PreviewCommand::Speed(speed) => self.view.speed = Speed(speed),
            PreviewCommand::WhatIf(what_if) => self.view.what_if = *what_if,
            PreviewCommand::Raise(cause) => self.raise(cause),
            PreviewCommand::Coverage(shown) => self.view.coverage = shown,
            PreviewCommand::Play(playing) => self.run_cursor(playing),
            PreviewCommand::Reset => {
                self.view.what_if = WhatIf::default();
                self.view.alarm = None;
            }
        }
    }

    /// What happens at a cursor that is not there is not to be seen.
    fn scrub(&mut self, cursor_s: Option<f64>) {
        self.view.cursor_s = cursor_s;
        self.view.playing = false;
        if cursor_s.is_none() {
            self.view.alarm = None;
        }
    }

    /// An alarm is raised at the cursor; without one, in the middle of what is selected or else of the flight.
    fn raise(&mut self, cause: Option<Cause>) {
        self.view.alarm = cause;
        if cause.is_some() && self.view.cursor_s.is_none() {
            let selected = self.view.selection.as_ref().map(Selection::id);
            let forecast = &self.analysis.forecast;
            let of_selected_s = selected.and_then(|of| forecast.middle_of_s(of));
            self.view.cursor_s = Some(of_selected_s.unwrap_or(forecast.duration_s() / 2.0));
        }
    }

    /// What the panel What if has put on the map goes with it. Its world stays: that is told beside the problems.
    pub(super) fn end_what_happens(&mut self) {
        self.view.alarm = None;
        self.view.coverage = false;
    }

    /// From where it is, or from the start where it stands at the end.
    fn run_cursor(&mut self, playing: bool) {
        self.view.playing = playing;
        if self.view.cursor_s.is_some_and(|c| c >= self.analysis.forecast.duration_s()) {
            self.view.cursor_s = Some(0.0);
        }
    }

    /// The cursor runs so many times as fast as the flight.
    pub(super) fn play(&mut self, ctx: &egui::Context) {
        if !self.view.playing {
            return;
        }
        let step = f64::from(ctx.input(|i| i.stable_dt)).min(0.1) * self.view.speed.0;
        let end = self.analysis.forecast.duration_s();
        let next = self.view.cursor_s.unwrap_or(0.0) + step;
        self.view.cursor_s = Some(next.min(end));
        self.view.playing = next < end;
        ctx.request_repaint();
    }
}
