//! Where the parts of the window are: the bar above, the dock with map and panels below, and what
//! floats over it.

use super::{App, Now, path_aboard};
use crate::command::{DocumentCommand, LinkCommand, Queue, ViewCommand};
use crate::dock::Content;
use crate::map::tool_chip;
use crate::panels::{
    Elevations, Scene, answer, bar, browse, changed, consider, decision, emergency, field, flight,
    interchange, maps, push, recover, start, story, toasts, tour, unsaved,
};
use crate::recovery::Keeper;
use crate::theme;
use egui::{Align2, Area, CentralPanel, Frame, LayerId, Order, Panel, Rect, RichText, Ui};

impl App {
    pub(super) fn lay_out(&mut self, ui: &mut Ui, now: Now, queue: &mut Queue) {
        // fields apart, so that the panels borrow the rest
        let fittings = self.fittings();
        let Self {
            document,
            shelf,
            vehicles,
            view,
            analysis,
            map,
            panels,
            dock,
            keeper,
            recent,
            connections,
            palette,
            aboard,
            layers,
            help,
            files,
            toasts,
            story,
            ..
        } = self;
        let vehicle = vehicles.shown();
        let scene = Scene {
            document,
            shelf,
            jobs: files.jobs(),
            toasts,
            story: story.as_ref().map(|(_, chapter)| chapter),
            can_undo: (shelf.can_undo(document), shelf.can_redo(document)),
            analysis,
            vehicle,
            aboard: path_aboard(aboard, vehicle),
            vehicles,
            view,
            layers,
            recent,
            connections,
            left_behind: keeper.as_ref().and_then(Keeper::left_behind),
            ground: Elevations(layers.ground().as_ref()),
            now_s: now.window_s,
            utc: now.utc,
        };
        let frame = theme::panel(ui);
        Panel::top("bar")
            .exact_size(42.0)
            .frame(frame.inner_margin(egui::Margin::symmetric(10, 4)))
            .show(ui, |ui| bar::show(ui, &scene, &fittings, queue));
        let is_read = strips(ui, &scene, dock.place_to_read(), queue);
        let room = CentralPanel::default().frame(Frame::new()).show(ui, |ui| {
            let whole = ui.max_rect();
            let map = dock.show(ui, &mut Content::new(map, panels, &scene, queue), is_read);
            let floor = floor(map, whole);
            if start::is_wanted(&scene) {
                let (room, width) = room_of_start(floor, whole);
                floating(ui, "new mission", room, Align2::LEFT_TOP, |ui| {
                    ui.set_width(width);
                    start::show(ui, &scene, room.height(), queue);
                    tour::mark(ui.ctx(), tour::NEW_MISSION, ui.min_rect());
                });
            }
            decision_card(ui, floor.with_max_y(whole.bottom()), &scene, queue);
            if let Some(found) = scene.left_behind.filter(|_| !scene.view.recovers_later) {
                let keys = (!scene.is_asking(), scene.vehicles.flying().next().is_none());
                let ask = |ui: &mut Ui| recover::show(ui, found, (floor.height(), scene.utc), keys, queue);
                floating(ui, "recover", floor, Align2::CENTER_CENTER, ask);
                // it is asked first, and the card for a new mission comes up with each click on it
                ui.ctx().move_to_top(LayerId::new(Order::Middle, egui::Id::unique("recover")));
            }
            notice(ui, floor, &scene, queue);
            toasts::show(ui, tool_chip::above(ui.ctx(), floor), &scene, queue);
            whole
        });
        dialogs(ui, room.inner, &scene, queue);
        help.show(ui, room.inner, &scene, queue);
        palette.show(ui, &scene, &fittings, queue);
        dropped_files(ui, queue);
    }
}

/// What takes its place before map and panels. True: something is read beside the map, so wide if that is given.
fn strips(ui: &mut Ui, scene: &Scene<'_>, width: Option<f32>, queue: &mut Queue) -> bool {
    // before all that may take its place
    commands(ui, scene, queue);
    emergency::show(ui, scene, queue);
    story::show(ui, scene, queue);
    announcements(ui, scene, queue);
    consider::show(ui, scene, width, queue) || push::show(ui, scene, width, queue)
}

/// What lies over map and panels until something is decided, and the tour.
fn dialogs(ui: &mut Ui, room: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    maps::show(ui, room, scene, queue);
    unsaved::show(ui, room, scene, queue);
    changed::show(ui, room, scene, queue);
    browse::show(ui, room, scene, queue);
    interchange::show(ui, room, scene, queue);
    tour::show(ui, scene, queue);
}

/// The commands of the flight have a bar of their own: it hides nothing, and nothing hides it.
fn commands(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    if scene.vehicle.status.is_none() {
        return;
    }
    let frame = theme::panel(ui);
    Panel::bottom("commands").frame(frame).show(ui, |ui| {
        // a button held for one vehicle is not held for another
        ui.push_id(scene.vehicles.shown_name(), |ui| {
            ui.horizontal_wrapped(|ui| {
                flight::commands(ui, scene, queue);
                answer::show(ui, scene, queue);
            });
        });
    });
}

/// What happened to a vehicle, shown or not, that nobody must miss; until it is put aside.
fn announcements(ui: &mut Ui, scene: &Scene<'_>, queue: &mut Queue) {
    for (name, vehicle) in scene.vehicles.choices().filter(|(_, vehicle)| !vehicle.unread.is_empty()) {
        let id = egui::Id::unique("announcements").with(name);
        Panel::top(id).frame(theme::panel(ui)).show(ui, |ui| {
            ui.horizontal(|ui| {
                let close = ui.small_button("✖").on_hover_text("Put these aside");
                let label = format!("Put aside what {name} announced");
                close.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
                if close.clicked() {
                    queue.link(LinkCommand::PutAside(name.clone()));
                }
                ui.vertical(|ui| {
                    for text in &vehicle.unread {
                        let text = RichText::new(format!("⚠ {name}: {text}")).color(theme::of(ui).caution);
                        ui.add(egui::Label::new(text).wrap());
                    }
                });
            });
        });
    }
}

/// Over the map, so that nothing moves under the pointer.
fn notice(ui: &Ui, map: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    let Some(text) = &scene.view.notice else { return };
    floating(ui, "notice", tool_chip::below(ui.ctx(), map), Align2::CENTER_TOP, |ui| {
        ui.set_max_width(ui.available_width().min(NOTICE));
        ui.horizontal(|ui| {
            if field::small_button(ui, "✖", "Close this message") {
                queue.view(ViewCommand::DismissNotice);
            }
            ui.add(egui::Label::new(RichText::new(text).color(theme::of(ui).caution)).wrap());
        });
    });
}

/// Greatest width of a message, screen points.
const NOTICE: f32 = 440.0;

/// Smallest map that a card fits on, screen points.
const MIN_MAP: egui::Vec2 = egui::vec2(300.0, 160.0);

/// Where cards float: over the map, or over everything where there is no room on it.
fn floor(map: Option<Rect>, whole: Rect) -> Rect {
    map.filter(|m| m.width() >= MIN_MAP.x && m.height() >= MIN_MAP.y).unwrap_or(whole)
}

/// Where the card for a new mission floats, and its width: beside the map's tools, or where there is no room for it at
/// the window's left edge, over the plan that is empty.
fn room_of_start(floor: Rect, whole: Rect) -> (Rect, f32) {
    const TOOLS: f32 = 44.0;
    const OUTWARDS: f32 = 9.0;
    // the map's scale and sources stay in sight below it
    const BELOW: f32 = 28.0;
    if start::is_on(floor) {
        let room = Rect::from_min_max(floor.min + egui::vec2(TOOLS, 0.0), floor.max - egui::vec2(0.0, BELOW));
        (room, start::WIDTH)
    } else {
        (Rect::from_min_max(whole.min - egui::vec2(OUTWARDS, 0.0), whole.max), start::NARROW_WIDTH)
    }
}

/// The decision that is asked for: over what stands below the map, so that the aircraft and what lies ahead of it stay in sight.
/// `column`: the map and what is below it.
fn decision_card(ui: &Ui, column: Rect, scene: &Scene<'_>, queue: &mut Queue) {
    if let Some((request, left_s)) = decision::open(scene) {
        floating(ui, "decision", column, Align2::CENTER_BOTTOM, |ui| {
            ui.set_width(ui.available_width().min(DECISION));
            decision::show(ui, &request, left_s, scene, queue);
        });
    }
}

/// Width of a decision where there is room for it, screen points.
const DECISION: f32 = 300.0;

fn floating(ui: &Ui, id: &str, map: Rect, side: Align2, show: impl FnOnce(&mut Ui)) {
    let at = side.pos_in_rect(&map.shrink(12.0));
    let frame = theme::card(ui).shadow(ui.visuals().popup_shadow);
    Area::new(egui::Id::unique(id)).fixed_pos(at).pivot(side).constrain_to(map).show(ui.ctx(), |ui| {
        ui.set_max_width((map.width() - 24.0).max(160.0));
        frame.show(ui, show);
    });
}

fn dropped_files(ui: &Ui, queue: &mut Queue) {
    let dropped =
        ui.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_path_buf()).collect::<Vec<_>>());
    dropped.into_iter().for_each(|path| queue.document(DocumentCommand::Dropped(path)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{pos2, vec2};

    #[test]
    fn cards_float_over_everything_where_the_map_has_no_room() {
        let whole = Rect::from_min_size(pos2(0.0, 42.0), vec2(960.0, 558.0));
        let large = Rect::from_min_size(pos2(270.0, 42.0), vec2(400.0, 300.0));
        let small = Rect::from_min_size(pos2(270.0, 42.0), vec2(100.0, 300.0));
        for (map, expected) in [(Some(large), large), (Some(small), whole), (None, whole)] {
            assert_eq!(floor(map, whole), expected);
        }
    }
}
