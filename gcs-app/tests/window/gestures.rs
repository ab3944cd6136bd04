//! What a person does with hands: clicks, choices from lists, words typed into fields. Everything is found by the name that
//! it has for people. What happens quickly happens in one frame: these tests make hundreds of gestures.

use super::Window;
use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, PointerButton, Pos2};
use egui_kittest::Node;
use egui_kittest::kittest::{NodeT, Queryable};

fn key(key: Key, modifiers: Modifiers) -> [Event; 2] {
    [true, false].map(|pressed| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers })
}

impl Window {
    /// One frame with all of these events.
    fn at_once(&mut self, events: impl IntoIterator<Item = Event>) {
        self.harness.input_mut().events.extend(events);
        self.harness.step();
    }

    fn tap(&mut self, pos: Pos2, button: PointerButton, modifiers: Modifiers) {
        self.gestures += 1;
        let press = |pressed| Event::PointerButton { pos, button, pressed, modifiers };
        let now = [Event::ModifiersChanged(modifiers), Event::PointerMoved(pos), press(true), press(false)];
        self.at_once(now);
        self.at_once([Event::ModifiersChanged(Modifiers::NONE)]);
    }

    /// The place of the one of this role and name; of several the first.
    fn find(&self, role: Role, name: &str) -> Pos2 {
        self.nth(role, name, 0)
    }

    fn nth(&self, role: Role, name: &str, which: usize) -> Pos2 {
        let found = self.harness.query_all_by_role_and_label(role, name).nth(which);
        found.unwrap_or_else(|| panic!("nothing is called {name:?}: {:?}", self.names())).rect().center()
    }

    /// Of those of this role the first whose name begins so.
    pub fn find_beginning(&self, role: Role, name: &str) -> Pos2 {
        let begins = |node: &Node<'_>| node.accesskit_node().label().is_some_and(|l| l.starts_with(name));
        let found = self.harness.query_all_by_role(role).find(begins);
        found.unwrap_or_else(|| panic!("nothing begins with {name:?}: {:?}", self.names())).rect().center()
    }

    /// Clicks what has this role and name.
    pub fn click_role(&mut self, role: Role, name: &str) {
        let at = self.find(role, name);
        self.tap(at, PointerButton::Primary, Modifiers::NONE);
    }

    /// Clicks the button whose name begins so.
    pub fn click_beginning(&mut self, name: &str) {
        let at = self.find_beginning(Role::Button, name);
        self.tap(at, PointerButton::Primary, Modifiers::NONE);
    }

    /// Clicks a place of the screen.
    pub fn tap_at(&mut self, at: Pos2) {
        self.tap(at, PointerButton::Primary, Modifiers::NONE);
    }

    /// Takes an option of a list; one that begins so, if none is called so.
    pub fn choose_option(&mut self, list: &str, option: &str) {
        self.click_role(Role::ComboBox, list);
        self.steps(1);
        let whole = self.harness.query_all_by_role_and_label(Role::Button, option).last();
        let whole = whole.map(|node| node.rect().center());
        let at = whole.unwrap_or_else(|| self.find_beginning(Role::Button, option));
        self.tap(at, PointerButton::Primary, Modifiers::NONE);
    }

    /// Chooses the kind of leg that the tool in use draws.
    pub fn choose_kind(&mut self, kind: &str) {
        let list = format!("Kind: {kind}");
        if self.harness.query_by_role_and_label(Role::ComboBox, &list).is_none() {
            let at = self.find_beginning(Role::ComboBox, "Kind: ");
            self.tap(at, PointerButton::Primary, Modifiers::NONE);
            self.steps(1);
            self.click_role(Role::Button, kind);
        }
    }

    /// Writes a text into a field, in the place of what is there, and Enter.
    pub fn fill_in(&mut self, role: Role, name: &str, text: &str) {
        self.click_role(role, name);
        self.gestures += 1;
        let typed = match text {
            "" => key(Key::Backspace, Modifiers::NONE).to_vec(),
            text => vec![Event::Text(text.into())],
        };
        let all = key(Key::A, Modifiers::COMMAND).into_iter();
        self.at_once(all.chain(typed).chain(key(Key::Enter, Modifiers::NONE)));
        self.steps(1);
    }

    /// Pastes a text.
    pub fn paste(&mut self, text: &str) {
        self.gestures += 1;
        self.harness.event(Event::Paste(text.into()));
        self.steps(3);
        // what was read in the last of these is drawn
        self.steps(2);
    }

    /// Takes an entry of what a heading of the tree can add.
    pub fn add_to(&mut self, heading: &str, entry: &str) {
        self.click_role(Role::Button, &format!("Add to {heading}"));
        self.steps(1);
        self.click_role(Role::Button, entry);
    }

    /// Takes an entry of a row's menu; of several rows that are called so, of that one.
    pub fn row_menu(&mut self, (row, which): (&str, usize), entry: &str) {
        let at = self.nth(Role::TreeItem, row, which);
        self.tap(at, PointerButton::Secondary, Modifiers::NONE);
        self.steps(1);
        // its key stands behind it
        self.click_beginning(entry);
    }

    /// Selects a row of the tree.
    pub fn select_row(&mut self, row: (&str, usize)) {
        self.select_row_with(row, Modifiers::NONE);
    }

    /// Clicks a row with a key held down.
    pub fn select_row_with(&mut self, (row, which): (&str, usize), modifiers: Modifiers) {
        let at = self.nth(Role::TreeItem, row, which);
        self.tap(at, PointerButton::Primary, modifiers);
    }

    /// All that has a name now.
    fn names(&self) -> Vec<String> {
        let nodes = self.harness.root().children_recursive();
        nodes.filter_map(|node| node.accesskit_node().label()).collect()
    }
}
