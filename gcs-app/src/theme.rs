//! Colours and spacing, light and dark. Red is warning (and, fainter, what is forbidden), amber is caution, and
//! neither is used for anything else; what colour says, shape or line style says too.

use egui::{Color32, CornerRadius, Margin, Shadow, Stroke, TextStyle, Theme, Ui, Vec2, Visuals, vec2};
use serde::{Deserialize, Serialize};

/// The colours that carry meaning, for one theme.
#[derive(Debug, Clone, Copy)]
pub struct Palette {
    /// Panels.
    pub panel: Color32,
    /// Cards on panels.
    pub card: Color32,
    /// Thin lines between things.
    pub line: Color32,
    /// Text.
    pub text: Color32,
    /// Secondary text.
    pub weak: Color32,
    /// What can be acted on, and the planned path.
    pub accent: Color32,
    /// Text on the accent colour.
    pub on_accent: Color32,
    /// The leg being flown and the guidance towards it.
    pub active: Color32,
    /// What has been flown.
    pub flown: Color32,
    /// Engaged, good.
    pub good: Color32,
    /// Cautions, nothing else.
    pub caution: Color32,
    /// Warnings, and fainter where the flight must not be; nothing else.
    pub warning: Color32,
    /// Emergency plans and other contingencies.
    pub contingency: Color32,
    /// Around lines and texts on the map.
    pub halo: Color32,
    /// Water of the basemap.
    pub water: Color32,
    /// Land of the basemap.
    pub land: Color32,
    /// Borders of the basemap.
    pub border: Color32,
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

const DARK: Palette = Palette {
    panel: rgb(0x14191f),
    card: rgb(0x1d242c),
    line: rgb(0x2d3742),
    text: rgb(0xe2e8ee),
    weak: rgb(0x95a3b1),
    accent: rgb(0x62c4f5),
    on_accent: rgb(0x07222f),
    active: rgb(0xff5fdc),
    flown: rgb(0xa7adb5),
    good: rgb(0x5fd38a),
    caution: rgb(0xffbf3c),
    warning: rgb(0xff6257),
    contingency: rgb(0xb9bfca),
    halo: rgb(0x0c1116),
    water: rgb(0x16293a),
    land: rgb(0x27302b),
    border: rgb(0x4b584f),
};

const LIGHT: Palette = Palette {
    panel: rgb(0xf3f5f7),
    card: rgb(0xffffff),
    line: rgb(0xd3dae1),
    text: rgb(0x17202a),
    weak: rgb(0x566473),
    accent: rgb(0x0069a6),
    on_accent: rgb(0xffffff),
    active: rgb(0xc0008f),
    flown: rgb(0x6c737b),
    good: rgb(0x0c7a3c),
    caution: rgb(0x9a5b00),
    warning: rgb(0xc21b12),
    contingency: rgb(0x59616d),
    halo: rgb(0xffffff),
    water: rgb(0xc6dceb),
    land: rgb(0xedeee4),
    border: rgb(0xa8aea2),
};

/// The least window in which everything has its place, screen points.
const LEAST_WINDOW: Vec2 = vec2(960.0, 600.0);

/// How large everything is; 1 is normal.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Scale(f32);

impl Default for Scale {
    fn default() -> Self {
        Self(1.0)
    }
}

impl Scale {
    /// The largest that a window of this size (points at scale 1) has room for, in tenths; a small window is not made smaller for it.
    pub fn most_in(window: Vec2) -> f32 {
        ((window / LEAST_WINDOW).min_elem() * 10.0).floor().max(10.0) / 10.0
    }

    /// A scale from 0.5 to 3; `None` for any other number.
    pub fn new(scale: f32) -> Option<Self> {
        (0.5..=3.0).contains(&scale).then_some(Self(scale))
    }
    /// That a window has no room for all scales, or for this one, where it has room for `most`; `None`: it has for each.
    pub fn told_in(self, most: f32) -> Option<String> {
        let percent = |scale: f32| format!("{:.0} %", scale * 100.0);
        if self.0 > most {
            let (chosen, shown) = (percent(self.0), percent(most));
            return Some(format!("{chosen} does not fit this window: shown at {shown} until it is larger"));
        }
        (most < 3.0).then(|| format!("This window has room for {} at most", percent(most)))
    }
    /// As a number.
    pub fn get(self) -> f32 {
        self.0
    }
    /// So many tenths larger.
    pub fn larger(self, tenths: f32) -> Option<Self> {
        // in whole tenths, so that the steps up lead through the steps down
        Self::new(((self.0 * 10.0) + tenths).round() / 10.0)
    }
}

/// The colours of a theme.
pub fn palette(dark: bool) -> &'static Palette {
    if dark { &DARK } else { &LIGHT }
}

/// The colours in use in a part of the window.
pub fn of(ui: &Ui) -> &'static Palette {
    palette(ui.visuals().dark_mode)
}

/// Sets fonts, spacing and both themes.
pub fn install(ctx: &egui::Context) {
    ctx.set_fonts(fonts());
    ctx.set_visuals_of(Theme::Dark, visuals(Visuals::dark(), &DARK));
    ctx.set_visuals_of(Theme::Light, visuals(Visuals::light(), &LIGHT));
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = vec2(8.0, 6.0);
        style.spacing.button_padding = vec2(10.0, 4.0);
        style.spacing.interact_size = vec2(36.0, 24.0);
        style.spacing.indent = 16.0;
        style.spacing.menu_margin = Margin::same(8);
        for (kind, size) in [
            (TextStyle::Small, 11.5),
            (TextStyle::Body, 13.5),
            (TextStyle::Button, 13.5),
            (TextStyle::Monospace, 12.5),
            (TextStyle::Heading, 17.0),
        ] {
            if let Some(font) = style.text_styles.get_mut(&kind) {
                font.size = size;
            }
        }
    });
}

/// The default fonts; symbols that the proportional ones lack come from the monospaced one.
fn fonts() -> egui::FontDefinitions {
    let mut fonts = egui::FontDefinitions::default();
    let spare = fonts.families.get(&egui::FontFamily::Monospace).cloned().unwrap_or_default();
    let proportional = fonts.families.entry(egui::FontFamily::Proportional).or_default();
    proportional.extend(spare.into_iter().take(1));
    fonts
}

fn visuals(mut v: Visuals, p: &Palette) -> Visuals {
    let radius = CornerRadius::same(5);
    v.panel_fill = p.panel;
    v.window_fill = p.card;
    v.window_stroke = Stroke::new(1.0, p.line);
    v.window_corner_radius = CornerRadius::same(8);
    v.menu_corner_radius = CornerRadius::same(6);
    v.window_shadow = Shadow { offset: [0, 4], blur: 16, spread: 0, color: Color32::from_black_alpha(70) };
    v.popup_shadow = v.window_shadow;
    v.extreme_bg_color = if v.dark_mode { rgb(0x0e1317) } else { rgb(0xe7ebef) };
    v.faint_bg_color = p.card;
    v.hyperlink_color = p.accent;
    v.warn_fg_color = p.caution;
    v.error_fg_color = p.warning;
    v.weak_text_color = Some(p.weak);
    v.selection.bg_fill = p.accent.gamma_multiply(if v.dark_mode { 0.32 } else { 0.22 });
    v.selection.stroke = Stroke::new(1.0, p.text);
    v.slider_trailing_fill = true;
    let base = if v.dark_mode { 0x2a333d } else { 0xe2e8ed };
    let hover = if v.dark_mode { 0x36424e } else { 0xd3dde5 };
    let press = if v.dark_mode { 0x425160 } else { 0xc3d1db };
    let w = &mut v.widgets;
    for (state, fill, text) in [
        (&mut w.noninteractive, rgb(base), p.text),
        (&mut w.inactive, rgb(base), p.text),
        (&mut w.hovered, rgb(hover), p.text),
        (&mut w.active, rgb(press), p.text),
        (&mut w.open, rgb(hover), p.text),
    ] {
        state.bg_fill = fill;
        state.weak_bg_fill = fill;
        state.fg_stroke = Stroke::new(1.2, text);
        state.bg_stroke = Stroke::NONE;
        state.corner_radius = radius;
        state.expansion = 0.0;
    }
    w.noninteractive.bg_stroke = Stroke::new(1.0, p.line);
    w.hovered.bg_stroke = Stroke::new(1.0, p.weak.gamma_multiply(0.6));
    v
}

/// A card: a filled, rounded box on a panel.
pub fn card(ui: &Ui) -> egui::Frame {
    let p = of(ui);
    egui::Frame::new()
        .fill(p.card)
        .stroke(Stroke::new(1.0, p.line))
        .corner_radius(CornerRadius::same(6))
        .inner_margin(Margin::symmetric(10, 8))
}

/// The margin of a whole panel.
pub fn panel(ui: &Ui) -> egui::Frame {
    egui::Frame::new().fill(of(ui).panel).inner_margin(Margin::symmetric(10, 8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_is_scaled_as_far_as_everything_has_its_place() {
        for (width, height, most) in [
            (960.0, 600.0, 1.0),
            (500.0, 300.0, 1.0),
            (1280.0, 800.0, 1.3),
            (1920.0, 1080.0, 1.8),
            (3840.0, 2160.0, 3.6),
        ] {
            assert_eq!(Scale::most_in(vec2(width, height)), most, "{width} by {height}");
        }
    }

    /// Of WCAG 2, from 1 to 21.
    fn contrast(a: Color32, b: Color32) -> f64 {
        let luminance = |colour: Color32| {
            let [r, g, b, _] = colour
                .to_array()
                .map(|part| f64::from(part) / 255.0)
                .map(|part| if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) });
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    /// Numbers of the graticule, names: over water, land and their own halo.
    #[test]
    fn text_of_the_map_can_be_read_on_its_ground() {
        for p in [&DARK, &LIGHT] {
            for ground in [p.water, p.land, p.halo] {
                assert!(contrast(p.text, ground) >= 4.5, "{ground:?}");
            }
        }
    }

    #[test]
    fn contrast_is_that_of_the_standard() {
        assert!((contrast(Color32::BLACK, Color32::WHITE) - 21.0).abs() < 1e-9);
        assert!((contrast(rgb(0x767676), Color32::WHITE) - 4.54).abs() < 0.01);
    }

    /// 4.5 is what the standard asks of texts of this size.
    #[test]
    fn every_text_can_be_read_on_its_ground() {
        for (start, p) in [(Visuals::dark(), &DARK), (Visuals::light(), &LIGHT)] {
            let v = visuals(start, p);
            let said = [p.text, p.weak, p.accent, p.good, p.caution, p.warning, p.contingency, p.active];
            let grounds = [v.panel_fill, v.window_fill, v.extreme_bg_color];
            let on_ground = said.into_iter().flat_map(|text| grounds.map(|ground| (text, ground)));
            let w = &v.widgets;
            let buttons = [&w.noninteractive, &w.inactive, &w.hovered, &w.active, &w.open];
            let on_button = buttons.map(|state| (state.fg_stroke.color, state.weak_bg_fill));
            // a row that is selected, in a panel or a card
            let on_row = grounds.map(|ground| (p.text, ground.blend(v.selection.bg_fill)));
            for (text, ground) in on_ground.chain(on_button).chain(on_row).chain([(p.on_accent, p.accent)]) {
                let contrast = contrast(text, ground);
                assert!(contrast >= 4.5, "{text:?} on {ground:?}: {contrast:.2}");
            }
        }
    }
}
