//! The tools, and the one in use: what the pointer and the keys do goes to it, and what it offers to be grabbed becomes widgets.

use super::new_leg::Side;
use super::sweep::Sweep;
use super::typed::Typed;
use super::{Asked, Canvas, Card, Grip, Pointer, Tool, Touch, all, guided, handles, is_guided, track};
use crate::command::Queue;
use crate::panels::Scene;
use crate::theme::Palette;
use egui::{Context, CursorIcon, Id, Key, Modifiers, Order, Rect, Response, Role, Sense, Ui, Vec2};

/// Keys that a tool in use may take.
const KEYS: [Key; 4] = [Key::Escape, Key::Enter, Key::Backspace, Key::Delete];
/// Reach of a grip, screen points.
const REACH: f32 = 18.0;
/// So many grips are offered wherever the pointer is.
const OFFERED: usize = 150;

/// A hand that is not quite still moves nothing, however long it presses, screen points.
const JITTER: f32 = 4.0;

/// The pointer is not where it was pressed, and not only by a hand that is not quite still.
pub fn has_left(response: &Response) -> bool {
    response.total_drag_delta().is_some_and(|by| by.length() > JITTER)
}

/// A drag on its way.
#[derive(Debug, Default)]
struct Drag {
    /// From the pointer to the grip when it began, so that nothing jumps.
    offset: Vec2,
    /// The pointer has left where it was pressed.
    has_left: bool,
}

/// The tools, and the one in use.
#[derive(Debug)]
pub struct Toolbox {
    tools: Vec<Box<dyn Tool>>,
    current: usize,
    drag: Drag,
    /// Keys that the tool in use has not seen yet.
    pressed: Vec<Key>,
    sweep: Sweep,
    typed: Typed,
    /// Draws the answers to the guide to a new plan.
    guided: guided::Guided,
    /// The guide asks for something: its tool is in use, whichever was chosen.
    is_guided: bool,
    /// The pointer is over something that lies over the map: a click there does not reach the tool.
    is_covered: bool,
}

impl Default for Toolbox {
    fn default() -> Self {
        Self {
            tools: all(),
            current: 0,
            drag: Drag::default(),
            sweep: Sweep::default(),
            typed: Typed::default(),
            pressed: Vec::new(),
            guided: guided::Guided::default(),
            is_guided: false,
            is_covered: false,
        }
    }
}

impl Toolbox {
    /// Each tool's card, and whether it is in use.
    pub fn cards(&self) -> impl Iterator<Item = (&'static Card, bool)> {
        let current = (!self.is_guided).then_some(self.current);
        self.tools.iter().enumerate().map(move |(i, tool)| (tool.card(), Some(i) == current))
    }

    /// The plan's places can be grabbed now.
    pub fn offers_handles(&self) -> bool {
        !self.is_guided && self.current == 0
    }

    fn in_use(&self) -> Option<&dyn Tool> {
        if self.is_guided {
            return Some(&self.guided);
        }
        self.tools.get(self.current).map(AsRef::as_ref)
    }

    /// Something is being drawn around: the map stays where it is.
    pub fn is_sweeping(&self) -> bool {
        self.sweep.is_active()
    }

    /// The tool in use waits for the result of work on another thread.
    pub fn is_busy(&self) -> bool {
        self.in_use().is_some_and(|tool| tool.is_busy())
    }

    /// What the tool in use says.
    pub fn status(&self, scene: &Scene<'_>) -> Option<String> {
        let status = self.in_use()?.status(scene)?;
        let covered = "The map is covered where the pointer is: click beside that.";
        Some(if self.is_covered { covered.to_owned() } else { status })
    }

    /// The card for a new mission has none beside its question.
    pub fn has_options(&self) -> bool {
        !self.is_guided
    }

    /// A place can be typed for the tool in use: whoever draws takes one.
    pub fn takes_places(&self) -> bool {
        self.in_use().is_some_and(|tool| tool.typed_from().is_some())
    }

    /// A click on the map is for the tool in use: it begins something with it, or goes on.
    pub fn takes_clicks(&self) -> bool {
        self.current > 0 || self.takes_places()
    }

    /// The tool in use has begun something that is not ended.
    pub fn is_drawing(&self) -> bool {
        self.in_use().is_some_and(|tool| tool.wants(Key::Escape))
    }

    /// Draws the choices that the tool in use offers.
    pub fn options(&mut self, ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
        if let Some(tool) = self.tools.get_mut(self.current) {
            tool.options(ui, scene, queue);
            if let Some(from) = tool.typed_from()
                && self.typed.show(ui, scene, from)
            {
                self.pressed.push(Key::Enter);
            }
        }
    }

    /// Puts the tool of this name to use; of none, the first. One that is in use is asked for its other choice.
    pub fn choose(&mut self, id: &str) {
        let next = self.tools.iter().position(|tool| tool.card().id == id).unwrap_or(0);
        if next == self.current {
            return self.tools.get_mut(next).into_iter().for_each(|tool| tool.again());
        }
        if let Some(left) = self.tools.get_mut(self.current) {
            left.leave();
        }
        self.current = next;
        self.typed = Typed::default();
        self.pressed.clear();
    }

    /// Puts the tool that draws legs to use; the first of them goes there, seen from the selected leg.
    pub fn draw_legs(&mut self, side: Side) {
        self.choose(track::ID);
        if let Some(tool) = self.tools.get_mut(self.current) {
            tool.aim_at(side);
        }
    }

    /// Keys that the tool in use takes. Escape ends its gesture, then the mode.
    pub fn keys(&mut self, ctx: &Context) {
        let pressed = |key: Key| ctx.input(|i| i.modifiers.is_none() && i.key_pressed(key));
        let consume = |key: Key| ctx.input_mut(|i| i.consume_key(Modifiers::NONE, key));
        for key in KEYS.into_iter().filter(|key| pressed(*key)) {
            let wanted = self.in_use().is_some_and(|tool| tool.wants(key));
            if wanted || (key == Key::Escape && self.current != 0) {
                consume(key);
            }
            if wanted {
                self.pressed.push(key);
            } else if key == Key::Escape {
                self.choose("");
            }
        }
    }

    /// Passes what happened on the map to the tool in use, and lets it paint. Gives what a menu was asked for.
    pub fn run(
        &mut self,
        ui: &Ui,
        map: &Response,
        canvas: &Canvas<'_>,
        queue: &mut Queue,
        p: &Palette,
    ) -> Option<Asked> {
        self.is_guided = is_guided(canvas.scene);
        self.is_covered = !self.is_guided && is_covered(map, canvas);
        let tool: &mut dyn Tool = match self.is_guided {
            true => &mut self.guided,
            false => self.tools.get_mut(self.current)?.as_mut(),
        };
        tool.hover(map.hover_pos(), canvas);
        for mark in self.typed.take() {
            tool.put(mark, canvas, queue);
        }
        for key in std::mem::take(&mut self.pressed) {
            tool.key(key, canvas, queue);
        }
        if map.hovered() {
            ui.ctx().set_cursor_icon(tool.cursor());
        }
        let mut touch = Touch::default();
        let mut asks = map.secondary_clicked();
        for (grip, id) in offered(ui, tool.grips(canvas)) {
            let response = widget(ui, &grip, id);
            if response.hovered() {
                touch.hovered = Some(grip.key);
                ui.ctx().set_cursor_icon(CursorIcon::Grab);
            }
            if response.dragged() {
                touch.dragged = Some(grip.key);
            }
            asks |= response.secondary_clicked();
            react(tool, &mut self.drag, &response, &grip, canvas, queue);
        }
        if map.double_clicked() || map.triple_clicked() {
            tool.finish(canvas, queue);
        } else if map.clicked()
            && let Some(at) = map.interact_pointer_pos()
        {
            tool.press(Pointer { at, grip: None, adds: adds(ui.ctx()), clicks: true }, canvas, queue);
        }
        if let Some(area) = self.sweep.follow(map) {
            tool.sweep(area, canvas, queue);
        }
        if self.is_guided || self.current != 0 {
            handles::draw_faint(ui.painter(), canvas, p);
        }
        tool.paint(ui.painter(), canvas, touch, p);
        self.sweep.paint(ui.painter(), p);
        let at = ui.input(|i| i.pointer.interact_pos())?;
        match tool.among() {
            _ if asks => Some(Asked::Menu(at)),
            several if several.len() > 1 => Some(Asked::Which(at, several)),
            _ => None,
        }
    }
}

/// A click with Shift or Ctrl adds to what is selected.
fn adds(ctx: &Context) -> bool {
    ctx.input(|i| i.modifiers.shift || i.modifiers.command)
}

/// The pointer is over the map, and a card or message lies between.
fn is_covered(map: &Response, canvas: &Canvas<'_>) -> bool {
    let at = map.ctx.pointer_hover_pos().filter(|at| canvas.view.rect.contains(*at));
    let layer = at.and_then(|at| map.ctx.layer_id_at(at));
    // what is open for a moment is no cover: a menu, a list, a tooltip
    layer.is_some_and(|layer| layer != map.layer_id && layer.order == Order::Middle)
}

/// Those that become widgets: where there are many, those that the pointer can reach, and so many others for keyboard and screen
/// reader.
fn offered(ui: &Ui, grips: Vec<Grip>) -> impl Iterator<Item = (Grip, Id)> {
    let scope = ui.scope_id();
    let pointer = ui.input(|i| i.pointer.press_origin().or(i.pointer.latest_pos()));
    let held = [ui.ctx().dragged_id(), ui.memory(|memory| memory.focused())];
    let with_ids = grips.into_iter().map(move |grip| (scope.with(&grip.name), grip));
    let offered = with_ids.enumerate().filter(move |(number, (id, grip))| {
        let is_near = || pointer.is_some_and(|at| at.distance(grip.at) < 2.0 * REACH);
        *number < OFFERED || grip.first || is_near() || held.contains(&Some(*id))
    });
    offered.map(|(_, (id, grip))| (grip, id))
}

fn widget(ui: &Ui, grip: &Grip, id: Id) -> Response {
    let rect = Rect::from_center_size(grip.at, Vec2::splat(REACH));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    response.widget_info(|| egui::WidgetInfo::labeled(Role::Button, true, &grip.name));
    response
}

/// Turns what happened to a grip's widget into what the tool understands.
fn react(
    tool: &mut dyn Tool,
    drag: &mut Drag,
    response: &Response,
    grip: &Grip,
    canvas: &Canvas<'_>,
    queue: &mut Queue,
) {
    let pointer = response.interact_pointer_pos();
    if response.clicked() || response.drag_started() {
        let pointer = Pointer {
            at: pointer.unwrap_or(grip.at),
            grip: Some(grip.key),
            adds: response.clicked() && adds(&response.ctx),
            clicks: response.clicked(),
        };
        tool.press(pointer, canvas, queue);
    }
    if response.double_clicked() {
        tool.finish(canvas, queue);
    }
    let Some(pointer) = pointer else { return };
    if response.drag_started() {
        let pressed = response.ctx.input(|i| i.pointer.press_origin()).unwrap_or(pointer);
        *drag = Drag { offset: grip.at - pressed, has_left: false };
    }
    drag.has_left |= has_left(response);
    if response.dragged() && drag.has_left && response.drag_delta() != Vec2::ZERO {
        tool.drag(grip.key, pointer + drag.offset, canvas, queue);
    }
    if response.drag_stopped() {
        *drag = Drag::default();
        tool.release(queue);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_tool_has_a_name_and_a_key_of_its_own() {
        let toolbox = Toolbox::default();
        let cards: Vec<&Card> = toolbox.cards().map(|(card, _)| card).collect();
        let ids: BTreeSet<&str> = cards.iter().map(|c| c.id).collect();
        let keys: BTreeSet<Key> = cards.iter().map(|c| c.key).collect();
        assert_eq!((ids.len(), keys.len()), (cards.len(), cards.len()));
        // keys of the window: fit, and the cursor
        assert!(!keys.contains(&Key::F) && !keys.contains(&Key::Space));
    }

    #[test]
    fn an_unknown_tool_is_the_first_one() {
        let mut toolbox = Toolbox::default();
        toolbox.choose("measure");
        assert_ne!(toolbox.current, 0);
        toolbox.choose("no such tool");
        assert_eq!(toolbox.current, 0);
    }
}
