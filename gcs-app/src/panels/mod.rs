//! The panels around the map. Each borrows the scene, draws it, and pushes commands.

pub mod alarms;
pub mod bar;
pub mod decision;
pub mod field;
pub mod flight;
pub mod inspector;
pub mod link;
pub mod log;
pub mod pfd;
pub mod problems;
pub mod profile;
pub mod push;
pub mod table;
pub mod tree;

use crate::command::{BottomTab, Selection};
use crate::document::Document;
use crate::forecast::{Analysis, Forecast};
use crate::state::{Aged, Vehicle, Vehicles};
use crate::theme;
use crate::units::{self, Units};
use egui::{RichText, Ui};
use flight_plan::Problem;

/// What the operator looks at.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ViewState {
    /// In which units.
    pub units: Units,
    /// What is selected.
    pub selection: Option<Selection>,
    /// What is below the map.
    pub bottom: BottomTab,
    /// The map follows the aircraft.
    pub follow: bool,
    /// Cursor in the preview, seconds from its start.
    pub cursor_s: Option<f64>,
    /// The cursor runs by itself.
    pub playing: bool,
    /// Something the operator should read: a file that can't be opened, and the like.
    pub notice: Option<String>,
}

/// Everything there is to draw, borrowed for a frame.
#[derive(Debug, Clone, Copy)]
pub struct Scene<'a> {
    /// The plan being edited.
    pub document: &'a Document,
    /// What is known of the plan, found out in the background; belongs to an older version for a moment.
    pub analysis: &'a Analysis,
    /// What is known of the vehicle that is shown.
    pub vehicle: &'a Vehicle,
    /// All vehicles that are known.
    pub vehicles: &'a Vehicles,
    /// What the operator looks at.
    pub view: &'a ViewState,
    /// The window's clock, seconds.
    pub now_s: f64,
    /// The time of day.
    pub utc: jiff::Timestamp,
}

impl<'a> Scene<'a> {
    /// The units in use.
    pub fn units(&self) -> Units {
        self.view.units
    }
    /// What will be flown.
    pub fn forecast(&self) -> &'a Forecast {
        &self.analysis.forecast
    }
    /// What is wrong with the plan: first what reading it found, then what checking it found.
    pub fn problems(&self) -> impl Iterator<Item = &'a Problem> {
        self.document.reading_problems().iter().chain(&self.analysis.problems)
    }
    /// Is this selected?
    pub fn is_selected(&self, selection: &Selection) -> bool {
        self.view.selection.as_ref() == Some(selection)
    }
}

/// A heading of a group of things.
pub fn group_title(ui: &mut Ui, text: &str) {
    let weak = theme::of(ui).weak;
    ui.label(RichText::new(text.to_uppercase()).size(10.5).color(weak).strong());
}

/// A value with its name and its age; one that has expired looks expired, and says so.
pub fn value_with_age(ui: &mut Ui, name: &str, text: &str, age: Option<(f64, bool)>) {
    let p = theme::of(ui);
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        field::name(ui, name, 70.0);
        let (shown, age_text) = match age {
            Some((age_s, false)) => (RichText::new(text).color(p.text), units::age(age_s)),
            Some((age_s, true)) => {
                (RichText::new(text).color(p.weak).strikethrough(), format!("{} old", units::age(age_s)))
            }
            None => (RichText::new("–").color(p.weak), String::new()),
        };
        ui.add(egui::Label::new(shown).truncate());
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            // clear of the scroll bar
            ui.add_space(8.0);
            ui.label(RichText::new(age_text).size(10.5).color(p.weak));
        });
    });
}

/// Age and expiry of a value, for [`value_with_age`].
pub fn age_of<T>(value: &Option<Aged<T>>, now_s: f64) -> Option<(f64, bool)> {
    value.as_ref().map(|v| (v.age_s(now_s), v.is_expired(now_s)))
}

/// A button that is the main thing to do here.
pub fn primary_button(text: &str, p: &theme::Palette) -> egui::Button<'static> {
    egui::Button::new(RichText::new(text).color(p.on_accent).strong()).fill(p.accent)
}
