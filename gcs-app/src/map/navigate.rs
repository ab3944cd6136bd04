//! Moving about the map: the wheel zooms around the pointer in small steps, keys zoom and pan. While the aircraft is
//! followed, it stays in the middle.

use super::view::View;
use egui::{Context, EventFilter, Id, Key, Modifiers, Pos2, Response, Vec2, vec2};
use walkers::{MapMemory, lat_lon};

/// Zoom levels of a map; each doubles the scale.
pub const ZOOMS: std::ops::RangeInclusive<f64> = 1.0..=21.0;
/// Zoom levels of a notch of the wheel, which comes as so many points.
const NOTCH: f64 = 0.25;
const NOTCH_POINTS: f32 = 40.0;
/// Zoom levels of a key.
const KEY_ZOOM: f64 = 0.5;
/// Screen points that an arrow key moves the map.
const KEY_PAN: f32 = 80.0;

/// What keys have asked for, until the map is drawn.
#[derive(Debug, Default)]
pub struct Navigation {
    /// The map's widget, which has the arrow keys while it has the focus.
    widget: Option<Id>,
    zoom: f64,
    pan: Vec2,
}

impl Navigation {
    /// The map's widget, once it was drawn.
    pub fn widget(&self) -> Option<Id> {
        self.widget
    }

    /// Zooms by so many levels in the next frame.
    pub fn zoom(&mut self, by: f64) {
        self.zoom += by;
    }

    /// Takes the keys that move the map, unless another widget has the focus.
    pub fn keys(&mut self, ctx: &Context) {
        let pressed = |key| ctx.input_mut(|i| i.count_and_consume_key(Modifiers::NONE, key)) as f32;
        let shifted = |key| ctx.input_mut(|i| i.count_and_consume_key(Modifiers::SHIFT, key)) as f32;
        let closer = pressed(Key::Plus) + pressed(Key::Equals) + shifted(Key::Plus) + shifted(Key::Equals);
        self.zoom += f64::from(closer - pressed(Key::Minus)) * KEY_ZOOM;
        let focused = ctx.memory(|m| m.focused());
        if focused.is_none() || focused == self.widget {
            let right = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
            let down = pressed(Key::ArrowDown) - pressed(Key::ArrowUp);
            self.pan += vec2(right, down) * KEY_PAN;
        }
    }

    /// Moves the map by what the wheel and the keys say; `follows`: the aircraft stays in the middle unless it is panned.
    pub fn run(&mut self, map: &Response, view: &View, follows: bool, memory: &mut MapMemory) {
        self.widget = Some(map.id);
        if map.has_focus() {
            let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
            map.ctx.memory_mut(|m| m.set_focus_lock_filter(map.id, arrows));
        }
        let pointer = map.ctx.pointer_hover_pos().filter(|at| {
            map.interact_rect.contains(*at)
                && map.ctx.layer_id_at(*at).is_none_or(|layer| layer == map.layer_id)
        });
        let wheel = pointer.map_or(0.0, |_| wheel(&map.ctx));
        if wheel != 0.0 {
            zoom(memory, view, pointer.filter(|_| !follows), wheel);
        }
        if self.zoom != 0.0 {
            zoom(memory, view, None, self.zoom);
        }
        if self.pan != Vec2::ZERO {
            let middle = view.geo(view.rect.center() + self.pan);
            memory.center_at(lat_lon(middle.lat_deg, middle.lon_deg));
        }
        if wheel != 0.0 || self.zoom != 0.0 || self.pan != Vec2::ZERO {
            map.ctx.request_repaint();
        }
        (self.zoom, self.pan) = (0.0, Vec2::ZERO);
    }
}

/// Zoom levels that wheel or fingers ask for; nothing else gets them.
fn wheel(ctx: &Context) -> f64 {
    ctx.input_mut(|i| {
        let notches = i.smooth_scroll_delta.y / NOTCH_POINTS;
        i.smooth_scroll_delta = Vec2::ZERO;
        f64::from(notches) * NOTCH + f64::from(i.zoom_delta()).log2()
    })
}

/// Zooms by some levels; what is at `around` stays there. Without it the middle stays, or who is followed there.
pub fn zoom(memory: &mut MapMemory, view: &View, around: Option<Pos2>, by: f64) {
    let before = memory.zoom();
    let after = (before + by).clamp(*ZOOMS.start(), *ZOOMS.end());
    if !after.is_finite() || memory.set_zoom(after).is_err() {
        return;
    }
    if let Some(around) = around {
        let middle = view.middle_after(around, (after - before).exp2());
        memory.center_at(lat_lon(middle.lat_deg, middle.lon_deg));
    }
}
