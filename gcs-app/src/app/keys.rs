//! Keys that work wherever the pointer is: those of the actions.

use crate::actions::{Action, Fittings, all, opens_palette};
use crate::command::Queue;
use crate::panels::{Scene, field, table};
use egui::{Context, Event, Key, KeyboardShortcut};

/// Turns keys into commands.
pub fn read(ctx: &Context, scene: &Scene<'_>, fittings: &Fittings, queue: &mut Queue) {
    if !ctx.input(|i| i.events.iter().any(|event| matches!(event, Event::Key { pressed: true, .. }))) {
        return;
    }
    let typing = field::is_typing(ctx);
    let actions = all(scene, fittings);
    let mut keys: Vec<(&KeyboardShortcut, &Action)> = actions
        .iter()
        .filter(|action| action.while_typing || !typing)
        .flat_map(|action| action.keys.iter().map(move |key| (key, action)))
        .collect();
    // the longer ones first: Ctrl-Z is part of Ctrl-Shift-Z
    keys.sort_by_key(|(key, _)| !(key.modifiers.shift || key.modifiers.alt));
    for (key, action) in keys {
        match &action.command {
            Ok(command) if is_pressed(ctx, key) => queue.push(command.clone()),
            // nothing to redo: the key goes no further, to Undo
            Err(_) if key.modifiers.command && key.modifiers.shift => {
                is_pressed(ctx, key);
            }
            _ => {}
        }
    }
}

/// Takes what was typed in this frame after a key that opens the palette: it is for the palette, in the next frame.
pub fn typed_for_palette(ctx: &Context) -> Vec<Event> {
    let later = ctx.input_mut(|input| match input.events.iter().position(opens_palette) {
        Some(opens) => input.events.split_off(opens + 1),
        None => Vec::new(),
    });
    if !later.is_empty() {
        ctx.request_repaint();
    }
    later
}

/// Most bytes that are pasted into a field.
const LONGEST_IN_A_FIELD: usize = 64 << 10;

/// Takes a paste away that no field could lay out in a frame; the sentence says so. What is pasted into the plan has its own
/// limit.
pub fn refuse_long_paste(ctx: &Context) -> Option<String> {
    if !ctx.text_edit_focused() {
        return None;
    }
    ctx.input_mut(|input| {
        let too_long = |event: &Event| match event {
            Event::Paste(text) if text.len() > LONGEST_IN_A_FIELD => Some(text.len()),
            _ => None,
        };
        let bytes = input.events.iter().find_map(too_long)?;
        input.events.retain(|event| too_long(event).is_none());
        Some(format!(
            "Nothing was pasted: the clipboard holds {} kB, and at most {} kB are taken here.",
            bytes >> 10,
            LONGEST_IN_A_FIELD >> 10
        ))
    })
}

fn is_pressed(ctx: &Context, key: &KeyboardShortcut) -> bool {
    match key.logical_key {
        // not consumed: the field that it ends needs it, too
        Key::Escape => ctx.input(|i| i.key_pressed(Key::Escape)),
        // a focused button takes the space bar for itself
        Key::Space if ctx.memory(|m| m.focused().is_some()) => false,
        // the row with the keyboard opens its own
        Key::F10 | Key::Menu if ctx.memory(|m| m.focused().is_some()) => false,
        // a cell of the table is renamed where it stands
        Key::F2 if table::has_focus(ctx) => false,
        _ => ctx.input_mut(|i| i.consume_shortcut(key)),
    }
}
