//! What the window tells by itself: messages that go again, the story of a demo, the tour.

use super::{App, Now, REFRESH};
use crate::panels::{emergency, profile};
use crate::state::Level;
use crate::story::Story;
use std::time::Duration;

/// Altitudes and ground are watched so often, seconds.
const LOOK_OUT_S: f64 = 0.25;

/// What is said of a vehicle that falls silent, and when it is heard again.
const SILENT: &str = "nothing is heard any more. It flies on by its plan";
const HEARD: &str = "is heard again";

impl App {
    /// Offers the tour of the window, once.
    pub fn offer_tour(&mut self) {
        if !std::mem::replace(&mut self.tour_seen, true) {
            self.view.tour = Some(0);
        }
    }

    /// Shows what this story tells from now on.
    pub fn listen_to(&mut self, story: Story) {
        let chapter = story.chapter();
        self.story = Some((story, chapter));
        self.view.is_demo = true;
    }

    /// Closes the window for another one, in which the story begins anew.
    pub(super) fn tell_again(&mut self) {
        if self.has_unsaved() {
            let why = "Save or undo your changes first: the demo begins anew in another window.";
            self.view.notice = Some(why.into());
        } else if self.vehicles.flying().count() > 1 {
            let names: Vec<&str> = self.vehicles.flying().map(|name| name.as_str()).collect();
            self.view.notice = Some(format!(
                "{} are in the air: disconnect whoever is not of the demo first, it begins anew in another window.",
                names.join(", ")
            ));
        } else if let Some((story, _)) = &self.story {
            story.want_again();
            self.leaving = true;
        }
    }

    /// Work that has ended and messages whose time is over go away.
    pub(super) fn tend_messages(&mut self, ctx: &egui::Context, now_s: f64) {
        if self.files.tend(now_s) | self.layers.tend(now_s) {
            ctx.request_repaint_after(REFRESH);
        }
        if let Some(left_s) = self.toasts.tend(now_s) {
            ctx.request_repaint_after(Duration::from_secs_f64(left_s));
        }
        // what stays until it is read is in the log, too
        if self.view.notice != self.noted {
            self.noted.clone_from(&self.view.notice);
            self.noted.iter().for_each(|text| self.toasts.note(now_s, Level::Caution, text));
        }
        self.lapse(ctx, now_s);
    }

    /// Why a gesture did nothing is not true for ever: that goes by itself.
    fn lapse(&mut self, ctx: &egui::Context, now_s: f64) {
        let Some((text, until_s)) = &self.refusal else { return };
        let is_shown = self.view.notice.as_ref() == Some(text);
        if is_shown && now_s < *until_s {
            return ctx.request_repaint_after(Duration::from_secs_f64(until_s - now_s));
        }
        self.refusal = None;
        self.view.notice.take_if(|_| is_shown);
    }

    /// Watches altitude, ground and way, a few times a second.
    pub(super) fn look_out(&mut self, now: Now) {
        let now_s = now.window_s;
        if now_s - self.looked_s >= LOOK_OUT_S {
            self.looked_s = now_s;
            let unix_s = now.utc.as_second();
            for (name, is_silent) in self.vehicles.look(self.layers.ground().as_ref(), now_s, unix_s) {
                let (level, text, over) = match is_silent {
                    true => (Level::Caution, SILENT, HEARD),
                    false => (Level::Info, HEARD, SILENT),
                };
                self.toasts.withdraw(|said| *said == format!("{name}: {over}"));
                self.toasts.add(now_s, level, format!("{name}: {text}"));
            }
            let is_elsewhere = profile::is_elsewhere(&self.scene(now));
            self.vehicles.set_elsewhere(is_elsewhere);
            self.look_for_emergency(now);
        }
    }

    /// An emergency that begins is brought into view, with where it leads: the map may have been left anywhere. Once: who looks elsewhere
    /// afterwards means to.
    fn look_for_emergency(&mut self, now: Now) {
        let places = emergency::places(&self.scene(now));
        let whose = self.vehicles.shown_name().filter(|_| places.is_some()).cloned();
        if let Some(places) = places.filter(|_| whose != self.in_emergency) {
            self.map.reveal_all(places);
        }
        self.in_emergency = whose;
    }
}
