//! Everything that can be done, in one list. The keys, the menus and the command palette read it: an
//! action has one name, one key and one reason why it is not possible now, wherever it is met.
//!
//! To add an action: a line in [`table`]. Tools and panels come from their own registries.

pub mod aliases;
pub mod alternates;
pub mod answers;
pub mod bindings;
pub mod flight;
pub mod fuzzy;
pub mod layers;
pub mod offers;
pub mod places;
mod table;

use crate::command::{Command, ViewCommand};
use crate::map::tools::{Card, is_guided};
use crate::panels::{PanelId, Scene};
use egui::{Context, Event, KeyboardShortcut, ModifierNames, Modifiers};
use std::borrow::Cow;

/// Where an action stands in menus, and what it is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Files.
    File,
    /// To other programs' formats.
    Export,
    /// The plan.
    Edit,
    /// What is shown, and how.
    View,
    /// The maps that users bring, and what lies over the map.
    Maps,
    /// The preview in another world.
    WhatIf,
    /// In which units.
    Units,
    /// Light or dark.
    Theme,
    /// How large everything is.
    Size,
    /// Map tools.
    Tool,
    /// Panels.
    Panel,
    /// The vehicle.
    Flight,
    /// A part of the plan.
    Show,
    /// Help.
    Help,
    /// The end.
    Quit,
}

impl Group {
    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Export => "Export",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Maps => "Maps",
            Self::WhatIf => "What if",
            Self::Units => "Units",
            Self::Theme => "Theme",
            Self::Size => "Size",
            Self::Tool => "Tool",
            Self::Panel => "Panel",
            Self::Flight => "Flight",
            Self::Show => "Show",
            Self::Help => "Help",
            Self::Quit => "End",
        }
    }
}

/// What kind of action it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Something happens.
    Do,
    /// Something happens that can't be taken back: it must be held.
    Hold,
    /// Something is on or off.
    Switch(bool),
    /// One of several is so.
    Choice(bool),
}

/// Something that can be done.
#[derive(Debug, Clone)]
pub struct Action {
    /// Never changes; no two are alike.
    pub id: Cow<'static, str>,
    /// For people.
    pub name: Cow<'static, str>,
    /// What it is about.
    pub group: Group,
    /// What kind of action it is.
    pub kind: Kind,
    /// Keys for it; the first is shown.
    pub keys: Vec<KeyboardShortcut>,
    /// The keys work while text is being typed, too.
    pub while_typing: bool,
    /// What whoever does it should know first.
    pub caution: Option<&'static str>,
    /// What it asks for; or why it is not possible now.
    pub command: Result<Command, Cow<'static, str>>,
}

impl Action {
    /// Something of the moment, without a key.
    fn now(group: Group, name: String, command: Result<Command, &'static str>) -> Self {
        Self {
            id: format!("{} {name}", group.name()).into(),
            name: name.into(),
            group,
            kind: Kind::Do,
            keys: Vec::new(),
            while_typing: false,
            caution: None,
            command: command.map_err(Into::into),
        }
    }

    /// Its key as people write it, if it has one.
    pub fn key(&self, ctx: &Context) -> Option<String> {
        self.keys.first().map(|key| ctx.format_shortcut(key))
    }

    /// Its key in brackets for the end of a tooltip; nothing without one.
    pub fn key_in_brackets(&self, ctx: &Context) -> String {
        self.key(ctx).map_or_else(String::new, |key| format!(" ({key})"))
    }
}

/// A panel as an action sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PanelEntry {
    /// Its identifier.
    pub id: PanelId,
    /// For people.
    pub name: &'static str,
    /// It is not hidden.
    pub shown: bool,
}

/// What the window has besides the [`Scene`].
#[derive(Debug, Clone, Default)]
pub struct Fittings {
    /// The panels.
    pub panels: Vec<PanelEntry>,
    /// The map tools, and whether each is in use.
    pub tools: Vec<(&'static Card, bool)>,
}

/// All actions but the places of the plan, in the order of the menus.
pub fn all(scene: &Scene<'_>, fittings: &Fittings) -> Vec<Action> {
    let mut actions: Vec<Action> = table::ENTRIES.iter().map(|entry| entry.action(scene)).collect();
    let guided = is_guided(scene);
    actions.extend(fittings.tools.iter().map(|(card, in_use)| tool(card, *in_use, guided)));
    actions.extend(fittings.panels.iter().map(panel));
    actions
}

/// One action of [`table`], by its identifier.
pub fn written(scene: &Scene<'_>, id: &str) -> Option<Action> {
    table::ENTRIES.iter().find(|entry| entry.id == id).map(|entry| entry.action(scene))
}

/// What has a key, with all of its keys: `Undo`, `Ctrl+Z`.
pub fn keys() -> impl Iterator<Item = (&'static str, String)> {
    let written = |key: &KeyboardShortcut| key.format(&ModifierNames::NAMES, cfg!(target_os = "macos"));
    let keys = move |entry: &table::Entry| entry.keys.iter().map(written).collect::<Vec<_>>().join(" or ");
    table::ENTRIES.iter().filter(|entry| !entry.keys.is_empty()).map(move |entry| (entry.name, keys(entry)))
}

/// A key that opens the palette.
pub fn opens_palette(event: &Event) -> bool {
    let Event::Key { key, modifiers, pressed: true, .. } = event else { return false };
    let opens = |shortcut: &KeyboardShortcut| {
        shortcut.logical_key == *key && modifiers.matches_logically(shortcut.modifiers)
    };
    table::ENTRIES.iter().any(|entry| entry.id == "palette" && entry.keys.iter().any(opens))
}

fn tool(card: &'static Card, in_use: bool, guided: bool) -> Action {
    let choose = Command::View(ViewCommand::Tool(card.id));
    Action {
        id: format!("tool-{}", card.id).into(),
        name: card.name.into(),
        group: Group::Tool,
        kind: Kind::Choice(in_use),
        keys: vec![KeyboardShortcut::new(Modifiers::NONE, card.key)],
        while_typing: false,
        caution: None,
        command: if guided {
            Err("Draw what the card of the new mission asks for first".into())
        } else {
            Ok(choose)
        },
    }
}

fn panel(entry: &PanelEntry) -> Action {
    Action {
        id: format!("panel-{}", entry.id).into(),
        name: entry.name.into(),
        group: Group::Panel,
        kind: Kind::Switch(entry.shown),
        keys: Vec::new(),
        while_typing: false,
        caution: None,
        command: Ok(Command::View(ViewCommand::ShowPanel(entry.id, !entry.shown))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn no_two_actions_share_an_identifier_or_a_key() {
        let (mut ids, mut keys) = (BTreeSet::new(), BTreeSet::new());
        for entry in table::ENTRIES {
            assert!(ids.insert(entry.id), "{} is there twice", entry.id);
            for key in entry.keys {
                assert!(keys.insert(format!("{key:?}")), "{}: {key:?} is taken", entry.id);
            }
        }
        for (card, _) in crate::map::tools::Toolbox::default().cards() {
            let key = KeyboardShortcut::new(Modifiers::NONE, card.key);
            assert!(keys.insert(format!("{key:?}")), "{}: {key:?} is taken", card.id);
        }
    }
}
