//! The flight ahead of time: its cursor, the world it is flown in, and an alarm at the cursor.

use super::App;
use crate::command::{PreviewCommand, Selection};
use crate::forecast::Forecast;
use crate::panels::Speed;
use flight_exec::rehearse::WhatIf;
use flight_plan::{Cause, Id};

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
            let of_selected_s = selected.and_then(|of| middle_of_s(forecast, of));
            self.view.cursor_s = Some(of_selected_s.unwrap_or(forecast.duration_s() / 2.0));
        }
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

/// Half the time of the first passage of a leg or stage, seconds from the start; `None`: it is not flown.
fn middle_of_s(forecast: &Forecast, what: &Id) -> Option<f64> {
    let passage = forecast.passages.iter().find(|passage| passage.leg == *what || passage.stage == *what)?;
    let part = forecast.part(passage)?;
    Some((part.first()?.time_s + part.last()?.time_s) / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forecast::{Passage, Point};

    #[test]
    fn what_is_selected_has_its_middle_in_time() {
        let point = |(passage, time_s)| Point {
            time_s,
            distance_m: 0.0,
            position: geometry::LatLon::new(46.0, 9.0),
            altitude_amsl_m: 500.0,
            ground_amsl_m: None,
            passage,
        };
        let points = [(0, 0.0), (1, 10.0), (1, 20.0), (1, 40.0), (2, 50.0)].map(point).to_vec();
        let passage = |leg: &str, first, end| Passage {
            leg: leg.into(),
            stage: "m".into(),
            passes: Vec::new(),
            reverse: false,
            first,
            end,
            energy_left: 1.0,
            clearance_m: None,
        };
        let passages = vec![passage("a", 0, 1), passage("b", 1, 4), passage("c", 4, 5)];
        let forecast = Forecast { points, passages, ..Forecast::default() };
        assert_eq!(middle_of_s(&forecast, &"b".into()), Some(30.0), "to where the next one begins");
        assert_eq!(middle_of_s(&forecast, &"m".into()), Some(5.0), "a stage begins with its first leg");
        assert_eq!(middle_of_s(&forecast, &"z".into()), None);
    }
}
