//! What the tool in use says, and the choices that it offers. On a small map that is at the lower edge, in as few lines as it takes,
//! its choices behind a button, and while something is drawn it is where the pointer is not.

use super::chips;
use super::furniture::NARROW;
use super::tools::Toolbox;
use crate::command::Queue;
use crate::panels::{Scene, start};
use crate::theme;
use egui::{
    Context, FontId, Id, Label, Margin, Popup, PopupCloseBehavior, Pos2, Rangef, Rect, Role, Sense, Ui,
    UiBuilder, WidgetInfo, pos2, text::LayoutJob, vec2,
};

/// Least height of the line on a small map, and most of what it says there, screen points.
const LINE: f32 = 28.0;
const ROWS: usize = 3;
/// Beside and around the text, and the button before it.
const EDGES: f32 = 18.0;
const BUTTON: f32 = 24.0;
/// From its lower edge to that of the map: the scale, the sources and the place of the pointer stand there.
const BELOW: f32 = 36.0;
/// From the map's edge, and from the tools.
const BESIDE: f32 = 12.0;
/// The buttons at the map's right edge take so much.
const BUTTONS: f32 = 52.0;
/// Tools say it last; the line has no room for it.
const ENDING: &str = " Esc ends it.";
/// The line gives way to a pointer that comes so near.
const CLEAR: f32 = 40.0;

/// Draws it. `columns`: what the tools take of the map.
pub fn show(ui: &mut Ui, tools: &mut Toolbox, columns: &[Rect], scene: &Scene<'_>, queue: &mut Queue) {
    let map = ui.min_rect();
    let shown = tools.status(scene).map(|status| match map.width() < NARROW {
        true => {
            let line = line(ui, tools, &status, columns, (scene, queue));
            Shown { said: line, takes: line }
        }
        false => whole(ui, tools, status, columns, (scene, queue)),
    });
    let takes_clicks = tools.takes_clicks();
    ui.data_mut(|data| data.insert_temp(clicks_id(), takes_clicks));
    ui.data_mut(|data| match shown {
        Some(shown) => _ = data.insert_temp(said_id(), shown),
        None => data.remove::<Shown>(said_id()),
    });
}

/// Where it is on the map.
#[derive(Debug, Clone, Copy)]
struct Shown {
    /// All of it.
    said: Rect,
    /// What of it takes clicks: the rest lets them through.
    takes: Rect,
}

/// Everything, in as many lines as that takes.
fn whole(
    ui: &mut Ui,
    tools: &mut Toolbox,
    status: String,
    columns: &[Rect],
    (scene, queue): (&Scene<'_>, &mut Queue),
) -> Shown {
    let map = ui.min_rect();
    // beside the card for a new mission, where that lies on the map
    let card = if start::is_wanted(scene) && start::is_on(map) { start::WIDTH + 36.0 } else { 0.0 };
    let left = columns.iter().map(|column| column.right()).fold(map.left(), f32::max) + 4.0 + card;
    let room = Rect::from_min_max(pos2(left, map.top() + BESIDE), map.right_bottom() - vec2(BUTTONS, 0.0));
    let mut chip = ui.new_child(UiBuilder::new().max_rect(room).id_salt("tool status"));
    if tools.takes_places() && is_looked_through(ui) {
        chip.multiply_opacity(THROUGH);
    }
    let mut takes = Rect::NOTHING;
    theme::card(&chip).show(&mut chip, |ui| {
        // above what is said, which takes one line or two: nothing moves under the pointer
        if tools.has_options() {
            let choices = opaque(UiBuilder::new());
            let choices =
                ui.scope_builder(choices, |ui| ui.horizontal_wrapped(|ui| tools.options(ui, scene, queue)));
            takes = choices.response.rect;
        }
        ui.add(Label::new(status).selectable(false).wrap());
    });
    Shown { said: chip.min_rect(), takes }
}

/// The pointer is on what is said: a click there is for the map behind it, which is to be seen.
fn is_looked_through(ui: &Ui) -> bool {
    let at = ui.ctx().pointer_hover_pos();
    let shown = ui.data(|data| data.get_temp::<Shown>(said_id()));
    at.zip(shown).is_some_and(|(at, shown)| shown.said.contains(at) && !shown.takes.contains(at))
}

/// So much is left of it then.
const THROUGH: f32 = 0.35;

/// Choices over the map take clicks and drags, beside them, too: who misses one draws nothing behind it.
fn opaque(place: UiBuilder) -> UiBuilder {
    place.sense(Sense::click_and_drag())
}

fn line(
    ui: &mut Ui,
    tools: &mut Toolbox,
    status: &str,
    columns: &[Rect],
    (scene, queue): (&Scene<'_>, &mut Queue),
) -> Rect {
    let map = ui.min_rect();
    let text = status.strip_suffix(ENDING).unwrap_or(status);
    let with_choices = tools.has_options() && tools.takes_places();
    let letters = |width: f32| {
        let font = FontId::proportional(12.0);
        let mut job = LayoutJob::simple(text.to_owned(), font, theme::of(ui).text, width - EDGES);
        job.wrap.max_rows = ROWS;
        job
    };
    let button = if with_choices { BUTTON } else { 0.0 };
    let height = |width: f32| ui.fonts_mut(|fonts| fonts.layout_job(letters(width - button))).size().y;
    let room = place(ui.ctx(), map, columns, tools.is_drawing(), &height);
    let letters = ui.fonts_mut(|fonts| fonts.layout_job(letters(room.width() - button)));
    let mut chip = ui.new_child(opaque(UiBuilder::new().max_rect(room).id_salt("tool status")));
    theme::card(&chip).inner_margin(Margin::symmetric(8, 4)).show(&mut chip, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            ui.spacing_mut().button_padding.x = 3.0;
            if with_choices {
                choices(ui, tools, scene, queue);
            }
            ui.add(Label::new(letters).selectable(false)).on_hover_text(status);
        });
    });
    chip.min_rect()
}

/// At the map's lower edge; at the upper one while something is drawn and the pointer is near.
fn place(ctx: &Context, map: Rect, columns: &[Rect], is_drawing: bool, height: &dyn Fn(f32) -> f32) -> Rect {
    let lower = chips::shown(ctx).map_or(map.bottom(), |chips| chips.top() + BELOW - 4.0).min(map.bottom());
    // how wide it is depends on the tools beside it, and how high on how wide
    let lowest = beside(map, (lower - BELOW - LINE, LINE), BESIDE, columns);
    let tall = (height(lowest.width()) + 8.0).max(LINE);
    let low = beside(map, (lower - BELOW - tall, tall), BESIDE, columns);
    let pointer = ctx.pointer_hover_pos().filter(|_| is_drawing);
    match pointer.is_some_and(|at| at.y > low.top() - CLEAR) {
        true => {
            let high = beside(map, (map.top() + BESIDE, LINE), BUTTONS, columns);
            let tall = (height(high.width()) + 8.0).max(LINE);
            beside(map, (map.top() + BESIDE, tall), BUTTONS, columns)
        }
        false => low,
    }
}

/// From so far down and so tall, right of those columns of the tools that reach there.
fn beside(map: Rect, (top, tall): (f32, f32), right: f32, columns: &[Rect]) -> Rect {
    let rows = Rangef::new(top, top + tall);
    let taken = columns.iter().filter(|column| column.y_range().intersection(rows).span() > 0.0);
    let left = taken.map(|column| column.right()).fold(map.left() + BESIDE - 4.0, f32::max) + 4.0;
    Rect::from_x_y_ranges(left..=(map.right() - right).max(left), rows)
}

/// The choices, behind a button.
fn choices(ui: &mut Ui, tools: &mut Toolbox, scene: &Scene<'_>, queue: &mut Queue) {
    let open_id = Id::unique("choices of the tool");
    let mut open = ui.data(|data| data.get_temp::<bool>(open_id)).unwrap_or(false);
    let button = ui.small_button("⏷").on_hover_text("What is drawn, and where");
    let name = "Choices of the tool";
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    open ^= button.clicked();
    // a list among them has a popup of its own, of which there is one at a time
    let popup = Popup::menu(&button).open_bool(&mut open);
    popup.close_behavior(PopupCloseBehavior::CloseOnClickOutside).show(|ui| {
        ui.set_max_width(CHOICES);
        ui.horizontal_wrapped(|ui| tools.options(ui, scene, queue));
    });
    ui.data_mut(|data| data.insert_temp(open_id, open));
}

/// Width of the choices, screen points.
const CHOICES: f32 = 260.0;

fn said_id() -> Id {
    Id::unique("what the tool in use says")
}

fn clicks_id() -> Id {
    Id::unique("the tool in use takes clicks")
}

/// A click on the map is for the tool in use: what comes and goes by itself gives way to the pointer.
pub fn takes_clicks(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(clicks_id())).unwrap_or(false)
}

/// What is left of the map below what the tool in use says at its upper edge.
pub fn below(ctx: &Context, map: Rect) -> Rect {
    let above = shown(ctx, map).filter(|said| said.center().y < map.center().y);
    above.map_or(map, |said| map.with_min_y(said.bottom()))
}

/// What is left of the map above it, where that is at its lower edge.
pub fn above(ctx: &Context, map: Rect) -> Rect {
    let low = shown(ctx, map).filter(|said| said.center().y > map.center().y);
    low.map_or(map, |said| map.with_max_y(said.top() + BELOW - 4.0))
}

/// A click there was for it in the last frame, and not for the map.
pub fn takes(ctx: &Context, at: Pos2) -> bool {
    ctx.data(|data| data.get_temp::<Shown>(said_id())).is_some_and(|shown| shown.takes.contains(at))
}

/// Where it was on the map in the last frame.
pub fn shown(ctx: &Context, map: Rect) -> Option<Rect> {
    let shown = ctx.data(|data| data.get_temp::<Shown>(said_id()))?;
    Some(shown.said).filter(|said| map.intersects(*said))
}
