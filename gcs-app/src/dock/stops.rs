//! Where the keyboard stops when it goes from panel to panel.

use egui::{Context, Id, Rect, Role, Sense, Ui, WidgetInfo};

/// A panel that is drawn, and what in it gets the keyboard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stop {
    rect: Rect,
    widget: Id,
}

impl Stop {
    /// What the panel says itself; else the panel as a whole: from there Tab leads into it. That is no stop of the Tab key.
    pub fn new(ui: &Ui, name: &str, widget: Option<Id>) -> Self {
        let rect = ui.max_rect();
        let whole = ui.scope_id().with("panel");
        if ui.memory(|m| m.has_focus(whole)) {
            let response = ui.interact(rect.shrink(3.0), whole, Sense::focusable_noninteractive());
            response.widget_info(|| WidgetInfo::labeled(Role::Pane, true, name));
        }
        Self { rect, widget: widget.unwrap_or(whole) }
    }
}

/// Takes the keyboard to the next panel, or (`-1`) the one before, from where it is now.
pub fn step(stops: &[Stop], by: isize, ctx: &Context) {
    let focused = ctx.memory(|m| m.focused());
    let at = focused.and_then(|id| ctx.read_response(id)).map(|response| response.rect.center());
    let here = stops
        .iter()
        .position(|stop| Some(stop.widget) == focused)
        .or_else(|| stops.iter().position(|stop| at.is_some_and(|at| stop.rect.contains(at))));
    if let Some(stop) = next(here, by, stops.len()).and_then(|index| stops.get(index)) {
        ctx.memory_mut(|m| m.request_focus(stop.widget));
    }
}

/// Around in a ring; from nowhere to one of its ends. `None`: there is none.
fn next(here: Option<usize>, by: isize, count: usize) -> Option<usize> {
    let last = count.checked_sub(1)?;
    Some(match here {
        None if by < 0 => last,
        None => 0,
        Some(here) if by < 0 => here.checked_sub(1).unwrap_or(last),
        Some(here) => Some(here + 1).filter(|next| *next <= last).unwrap_or(0),
    })
}

#[cfg(test)]
mod tests {
    use super::next;

    #[test]
    fn panels_are_a_ring() {
        let cases = [
            ((None, 1, 3), Some(0)),
            ((None, -1, 3), Some(2)),
            ((Some(2), 1, 3), Some(0)),
            ((Some(0), -1, 3), Some(2)),
            ((Some(1), 1, 3), Some(2)),
            ((Some(0), 1, 0), None),
        ];
        for ((here, by, count), expected) in cases {
            assert_eq!(next(here, by, count), expected, "{here:?} {by}");
        }
    }
}
