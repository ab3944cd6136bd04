//! Keys that work wherever the pointer is, as long as nothing is being typed.

use crate::command::{DocumentCommand, Queue, Replacement, Selection, ViewCommand};
use crate::panels::{Scene, tree};
use egui::{Context, Key, KeyboardShortcut, Modifiers};
use flight_plan::{Edit, edit::Spot};

/// Turns keys into commands.
pub fn read(ctx: &Context, scene: &Scene<'_>, queue: &mut Queue) {
    let ctrl = |key| KeyboardShortcut::new(Modifiers::COMMAND, key);
    let ctrl_shift = |key| KeyboardShortcut::new(Modifiers::COMMAND | Modifiers::SHIFT, key);
    let pressed = |shortcut: &KeyboardShortcut| ctx.input_mut(|i| i.consume_shortcut(shortcut));
    // the longer ones first: Ctrl-Z is part of Ctrl-Shift-Z
    let document = [
        (ctrl_shift(Key::S), DocumentCommand::AskSaveAs),
        (ctrl(Key::S), DocumentCommand::Save),
        (ctrl(Key::O), DocumentCommand::Replace(Replacement::AskOpen)),
        (ctrl(Key::N), DocumentCommand::Replace(Replacement::New)),
    ];
    for (shortcut, command) in document {
        if pressed(&shortcut) {
            queue.document(command);
        }
    }
    if pressed(&ctrl(Key::F)) {
        queue.view(ViewCommand::ShowPanel(tree::ID, true));
        tree::focus_search(ctx);
    }
    if ctx.text_edit_focused() {
        return;
    }
    let undo_redo = [
        (ctrl_shift(Key::Z), DocumentCommand::Redo),
        (ctrl(Key::Z), DocumentCommand::Undo),
        (ctrl(Key::Y), DocumentCommand::Redo),
    ];
    for (shortcut, command) in undo_redo {
        if pressed(&shortcut) {
            queue.document(command);
        }
    }
    view_keys(ctx, scene, queue);
    leg_keys(ctx, scene, queue);
}

fn view_keys(ctx: &Context, scene: &Scene<'_>, queue: &mut Queue) {
    let pressed = |key| ctx.input_mut(|i| i.consume_key(Modifiers::NONE, key));
    if pressed(Key::F) {
        queue.view(ViewCommand::Fit);
    }
    // a focused button takes the space bar for itself
    let nothing_focused = ctx.memory(|m| m.focused().is_none());
    if nothing_focused && pressed(Key::Space) {
        queue.view(ViewCommand::Play(!scene.view.playing));
    }
    // not consumed: the field that it ends needs it, too
    if ctx.input(|i| i.key_pressed(Key::Escape)) {
        queue.view(ViewCommand::Select(None));
    }
}

/// Del removes the selected legs, Ctrl-Up and Ctrl-Down move it among its neighbours.
fn leg_keys(ctx: &Context, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(Selection::Leg(id)) = &scene.view.selection else { return };
    let leg = || id.clone();
    if ctx.input_mut(|i| i.consume_key(Modifiers::NONE, Key::Delete)) {
        let legs = scene.selected_legs().into_iter();
        queue.edit(Edit::All(legs.map(|leg| Edit::DeleteLeg { leg }).collect()));
    }
    let Some(context) = scene.document.plan().leg(id) else { return };
    let neighbour =
        |offset: isize| context.index.checked_add_signed(offset).and_then(|i| context.siblings.get(i));
    if ctx.input_mut(|i| i.consume_key(Modifiers::COMMAND, Key::ArrowUp))
        && let Some(before) = neighbour(-1)
    {
        queue.edit(Edit::MoveLeg { leg: leg(), at: Spot::Before(before.id.clone()) });
    }
    if ctx.input_mut(|i| i.consume_key(Modifiers::COMMAND, Key::ArrowDown))
        && let Some(after) = neighbour(1)
    {
        queue.edit(Edit::MoveLeg { leg: leg(), at: Spot::After(after.id.clone()) });
    }
}
