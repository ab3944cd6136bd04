//! A press means what is under it. egui looks for the pressed widget where the pointer is at the end of a frame's events; so what the
//! pointer does in the same frame behind a press, as in a fast drag, waits for the next frame.

use egui::{Context, Event, Plugin, RawInput};

/// Holds back what comes behind a press.
#[derive(Debug, Default)]
pub(super) struct PressFirst {
    later: Vec<Event>,
}

impl Plugin for PressFirst {
    fn debug_name(&self) -> &'static str {
        "press first"
    }

    fn input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        input.events.splice(0..0, self.later.drain(..));
        let is_press = |event: &Event| matches!(event, Event::PointerButton { pressed: true, .. });
        let press = input.events.iter().position(is_press);
        let moved = press.and_then(|press| {
            let mut behind = input.events.iter().enumerate().skip(press);
            behind.find(|(_, event)| matches!(event, Event::PointerMoved(_))).map(|(index, _)| index)
        });
        if let Some(moved) = moved {
            self.later = input.events.split_off(moved);
            ctx.request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, PointerButton, Pos2, pos2};

    #[test]
    fn what_comes_behind_a_press_comes_in_the_next_frame_and_nothing_is_lost() {
        let button = |pos: Pos2, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let (from, to) = (pos2(10.0, 10.0), pos2(500.0, 10.0));
        let moved = Event::PointerMoved;
        let drag =
            [moved(from), button(from, true), moved(to), button(to, false), button(to, true), moved(from)];
        let (mut hook, ctx) = (PressFirst::default(), Context::default());
        let mut frame = |events: &[Event]| {
            let mut input = RawInput { events: events.to_vec(), ..RawInput::default() };
            hook.input_hook(&ctx, &mut input);
            input.events
        };
        assert_eq!(frame(&drag), drag[..2]);
        assert_eq!(frame(&[Event::Copy]), drag[2..5]);
        assert_eq!(frame(&[]), [moved(from), Event::Copy]);
        assert_eq!(frame(&[moved(to)]), [moved(to)]);
    }
}
