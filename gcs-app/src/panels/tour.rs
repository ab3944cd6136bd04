//! The tour of the window: a few cards, each with an arrow to what it is about. Parts of the window say where they are.

use super::{Scene, primary_button};
use crate::command::{Queue, ViewCommand};
use crate::theme::{self, Palette};
use egui::emath::Rot2;
use egui::{
    Align, Align2, Area, Context, Id, Key, LayerId, Layout, Modifiers, Order, Painter, Pos2, Rect, RichText,
    Sense, Stroke, Ui, pos2, vec2,
};

/// What a card says, and about which part of the window.
struct Card {
    about: &'static str,
    title: &'static str,
    text: &'static str,
}

/// The menu of the window.
pub const MENU: &str = "menu";
/// The tools on the map.
pub const TOOLS: &str = "tools";
/// Where a vehicle is connected to.
pub const LINK: &str = "link";
/// The card for a new mission: no card of the tour lies over it.
pub const NEW_MISSION: &str = "new mission";

const CARDS: [Card; 6] = [
    Card {
        about: MENU,
        title: "Everything is in here",
        text: "This menu has every command. Ctrl+K finds one by its name, and F1 explains what is selected.",
    },
    Card {
        about: TOOLS,
        title: "Draw the flight",
        text: "Choose a tool and click on the map. Esc puts it away again, and undo takes any step back.",
    },
    Card {
        about: super::tree::ID,
        title: "The plan, leg by leg",
        text: "Stages, legs, loops and emergency plans. A right click shows what can be done with one.",
    },
    Card {
        about: "inspector",
        title: "Change what is selected",
        text: "Every number and choice of it, with its unit. A number may follow the plan's variables.",
    },
    Card {
        about: "profile",
        title: "See what will be flown",
        text: "After every change the plan is flown ahead of time. Move the cursor along it; Space plays it.",
    },
    Card {
        about: LINK,
        title: "Then fly it",
        text: "Connect to a vehicle, push the plan, start. “legwork demo” shows a whole flight without one.",
    },
];

const WIDTH: f32 = 280.0;
/// Height of a card.
const HEIGHT: f32 = 150.0;
/// Between a card and what it lies beside, with its frame.
const AROUND: f32 = 24.0;
/// Height of its text: three lines.
const TEXT: f32 = 66.0;
/// Of the arrow's head, however far it reaches.
const HEAD: f32 = 14.0;

/// Says where a part of the window is.
pub fn mark(ctx: &Context, part: &str, rect: Rect) {
    let now = ctx.cumulative_pass_nr();
    ctx.data_mut(|d| d.insert_temp(id_of(part), (now, rect)));
}

/// Where a part is; `None`: it is not shown.
fn place_of(ctx: &Context, part: &str) -> Option<Rect> {
    let (pass, rect) = ctx.data(|d| d.get_temp::<(u64, Rect)>(id_of(part)))?;
    (pass + 1 >= ctx.cumulative_pass_nr()).then_some(rect)
}

fn id_of(part: &str) -> Id {
    Id::unique("tour").with(part)
}

/// Draws the present card.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(step) = scene.view.tour.filter(|_| !scene.is_asking()) else { return };
    let Some(card) = CARDS.get(step) else { return };
    let (window, about) = (ui.max_rect(), place_of(ui.ctx(), card.about));
    let p = theme::of(ui);
    let at = beside(place_of(ui.ctx(), NEW_MISSION), in_the_middle(window), window);
    let frame = theme::card(ui).stroke(Stroke::new(1.5, p.accent)).shadow(ui.visuals().popup_shadow);
    let area = Area::new(Id::unique("tour")).order(Order::Foreground).fixed_pos(at).constrain_to(window);
    // a click beside its buttons is for nothing below it
    let shown = area.sense(Sense::click()).show(ui.ctx(), |ui| {
        ui.set_max_width(WIDTH);
        frame.show(ui, |ui| content(ui, card, step, queue));
    });
    if let Some(about) = about {
        let painter =
            Painter::new(ui.ctx().clone(), LayerId::new(Order::Foreground, Id::unique("arrow")), window);
        point(&painter, shown.response.rect, about, p);
    }
}

fn content(ui: &mut Ui, card: &Card, step: usize, queue: &mut Queue) {
    let p = theme::of(ui);
    ui.label(RichText::new(card.title).strong().size(15.0));
    let text = Layout::top_down(Align::LEFT);
    // the buttons stay where they are from step to step
    ui.allocate_ui_with_layout(vec2(WIDTH, TEXT), text, |ui| {
        ui.set_min_size(vec2(WIDTH - 20.0, TEXT));
        ui.label(card.text);
    });
    ui.horizontal(|ui| {
        let is_last = step + 1 == CARDS.len();
        let next = ui.add(primary_button(if is_last { "Done" } else { "Next" }, p));
        if next.clicked() || is_entered(ui) {
            queue.view(ViewCommand::Tour((!is_last).then_some(step + 1)));
        }
        if step > 0 && ui.button("Back").clicked() {
            queue.view(ViewCommand::Tour(Some(step - 1)));
        }
        if !is_last && ui.button("Skip the tour").clicked() {
            queue.view(ViewCommand::Tour(None));
        }
        ui.label(RichText::new(format!("{} of {}", step + 1, CARDS.len())).color(p.weak));
    });
}

/// Enter goes on, unless something else has the keyboard.
fn is_entered(ui: &Ui) -> bool {
    let is_free = ui.memory(|memory| memory.focused().is_none());
    is_free && ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter))
}

/// The upper left corner of every card: the pointer stays over its buttons, and what they are about lies around it.
fn in_the_middle(window: Rect) -> Pos2 {
    Align2::CENTER_CENTER.align_size_within_rect(vec2(WIDTH, HEIGHT), window).min
}

/// The same place, or right of what would be covered there, as far as there is room.
fn beside(other: Option<Rect>, at: Pos2, window: Rect) -> Pos2 {
    let card = Rect::from_min_size(at, vec2(WIDTH + AROUND, HEIGHT));
    match other.filter(|other| other.intersects(card)) {
        Some(other) => pos2((other.right() + AROUND).min(window.right() - WIDTH - AROUND), at.y),
        None => at,
    }
}

/// A frame around what is meant, and an arrow to it.
fn point(painter: &Painter, card: Rect, about: Rect, p: &Palette) {
    let stroke = Stroke::new(2.5, p.accent);
    painter.rect_stroke(about.shrink(1.0), 4.0, stroke, egui::StrokeKind::Inside);
    let to = about.clamp(card.center());
    let from = card.clamp(to);
    if from.distance(to) > 8.0 {
        painter.line_segment([from, to], stroke);
        let back = (from - to).normalized() * HEAD;
        for side in [0.4, -0.4] {
            painter.line_segment([to, to + Rot2::from_angle(side) * back], stroke);
        }
    }
}
