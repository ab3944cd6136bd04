//! Everything that the window can look like, at the sizes and scales that it promises: nothing is cut off, nothing lies over
//! another thing, everything that can be used has a name, and all of it is as on the sheets in `tests/pictures/states`.

use super::considering::{considered, foresight};
use super::creating::EMPTY;
use super::emergency::in_emergency;
use super::filing::until_listed;
use super::fleet::{tab, two};
use super::flying::{flying, report};
use super::painted::texts;
use super::vehicle::{decision, status};
use super::whatif::FIRE_WATCH;
use super::{SQUARE, Window};
use egui::{Key, LayerId, Order, Pos2, Rect, Role, Vec2, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use flight_exec::Phase;
use gcs_app::link::Reply;
use std::collections::HashMap;
use usal::contract::{Alarm, Severity};

/// In points: the smallest window (at any scale: a window of 960 by 600 is not scaled up), 3840 by 2160 at scale 3, and a large one.
pub const SIZES: [Vec2; 3] = [vec2(960.0, 600.0), vec2(1280.0, 720.0), vec2(1920.0, 1080.0)];
/// Each state is looked at in these, too, without a picture: 1280 by 800, 3840 by 2160 at the scales 1 and 0.8, and 960 by 600,
/// 1280 by 800 and 1920 by 1080 at scale 0.8.
pub const MORE: [Vec2; 6] = [
    vec2(1280.0, 800.0),
    vec2(3840.0, 2160.0),
    vec2(4800.0, 2700.0),
    vec2(1200.0, 750.0),
    vec2(1600.0, 1000.0),
    vec2(2400.0, 1350.0),
];
pub const THEMES: [egui::Theme; 2] = [egui::Theme::Dark, egui::Theme::Light];

/// A widget as it was drawn.
#[derive(Debug, Clone)]
pub struct Widget {
    layer: LayerId,
    /// All of it.
    pub rect: Rect,
    /// What of it is not cut off.
    pub seen: Rect,
    pub role: Role,
    pub name: String,
    interactive: bool,
    enabled: bool,
    has_tooltip: bool,
}

/// Those with a role: rectangles by egui, names by what a screen reader is told.
pub fn widgets(window: &Window) -> Vec<Widget> {
    let told: HashMap<_, _> = window
        .harness
        .root()
        .children_recursive()
        .map(|node| node.accesskit_node())
        .map(|node| {
            let name = node.label().or(node.value()).unwrap_or_default();
            (node.locate().0, (node.role(), name, node.data().description().is_some()))
        })
        .collect();
    window.harness.ctx.viewport(|viewport| {
        let all = &viewport.prev_pass.widgets;
        let layers: Vec<LayerId> = all.layer_ids().collect();
        let widgets = layers.iter().flat_map(|layer| all.get_layer(*layer));
        let named = widgets.filter_map(|widget| {
            let (role, name, has_tooltip) = told.get(&widget.id.accesskit_id())?;
            let interactive = widget.sense.senses_click() || widget.sense.senses_drag();
            let (layer, rect, seen) = (widget.layer_id, widget.rect, widget.interact_rect);
            let (role, name, has_tooltip) = (*role, name.clone(), *has_tooltip);
            let enabled = widget.enabled;
            Some(Widget { layer, rect, seen, role, name, interactive, enabled, has_tooltip })
        });
        named.filter(|widget| !matches!(widget.role, Role::GenericContainer | Role::Unknown)).collect()
    })
}

/// Everything that is wrong with what is drawn now.
fn faults(window: &Window) -> Vec<String> {
    let screen = window.harness.ctx.content_rect();
    let widgets = widgets(window);
    assert!(widgets.len() > 20, "{widgets:?}");
    let mut faults = window.harness.unnamed_widgets();
    faults.extend(cut_off(&widgets, screen));
    faults.extend(overlapping(&widgets));
    faults.extend(cut_texts(window, &widgets));
    faults.extend(unexplained(window, &widgets));
    faults.extend(window.names_over_each_other());
    faults
}

/// On the map, where things lie as the plan has them.
fn is_on_map(widget: &Widget) -> bool {
    widget.rect.size() == Vec2::splat(18.0) || widget.role == Role::Image || widget.role == Role::Canvas
}

/// What is to be read or used where it is, neither on the map nor around other widgets.
pub fn placed(widgets: &[Widget]) -> Vec<&Widget> {
    let around = [Role::ScrollBar, Role::Splitter, Role::Window, Role::Pane, Role::ScrollView];
    let is_placed = |w: &&Widget| w.seen.is_positive() && !is_on_map(w) && !around.contains(&w.role);
    widgets.iter().filter(is_placed).filter(|w| !w.name.is_empty()).collect()
}

/// Only what is scrolled may be cut off.
fn cut_off(widgets: &[Widget], screen: Rect) -> Vec<String> {
    // less than a point of a row below the fold is not to be read
    let seen = placed(widgets).into_iter().filter(|w| w.seen.height() >= 1.0);
    let cut = seen.filter(|w| {
        let sideways = w.rect.left() < w.seen.left() - 1.0 || w.rect.right() > w.seen.right() + 1.0;
        (sideways && !scrolls_sideways(widgets, w.seen)) || !screen.expand(0.5).contains_rect(w.seen)
    });
    cut.map(|w| format!("cut off: {:?} {:?} at {}, seen {}", w.role, w.name, w.rect, w.seen)).collect()
}

/// There is a bar below it by which it is scrolled, or it is in a row of tabs, which are scrolled by arrows.
fn scrolls_sideways(widgets: &[Widget], seen: Rect) -> bool {
    let bars = || widgets.iter().filter(|w| w.role == Role::ScrollBar && w.rect.width() > w.rect.height());
    let below = |bar: &Widget| {
        bar.seen.x_range().intersection(seen.x_range()).span() > 0.0 && bar.seen.top() > seen.top() - 10.0
    };
    seen.height() == 26.0 || bars().any(below)
}

/// Of two widgets on a layer, one may lie within the other, as a button in a row; else they are apart.
fn overlapping(widgets: &[Widget]) -> Vec<String> {
    let shown = placed(widgets);
    let mut faults = Vec::new();
    for (i, a) in shown.iter().enumerate() {
        for b in shown.get(i + 1..).unwrap_or_default().iter().filter(|b| b.layer == a.layer) {
            let common = a.seen.intersect(b.seen);
            let apart = common.width() < 2.0 || common.height() < 2.0;
            let within = a.seen.expand(1.0).contains_rect(b.seen) || b.seen.expand(1.0).contains_rect(a.seen);
            let same = a.interactive == b.interactive && a.seen == b.seen;
            if !apart && (!within || (same && a.interactive)) {
                faults.push(format!("overlap: {:?} {} and {:?} {}", a.name, a.seen, b.name, b.seen));
            }
        }
    }
    faults
}

/// Names have no more words than this; what has more is a sentence, also on the map.
const NAME_WORDS: usize = 3;

/// Texts end with an ellipsis where there is no room for all of them, and then a tooltip has the rest. Only the name of something on the
/// map may hang over its edge, as what is called so does.
fn cut_texts(window: &Window, widgets: &[Widget]) -> Vec<String> {
    let maps: Vec<Rect> =
        window.harness.query_all_by_label_contains("Map").map(|node| node.rect().expand(2.0)).collect();
    let typed: Vec<Rect> = widgets.iter().filter(|w| is_typed(w)).map(|w| w.seen).collect();
    let mut faults = Vec::new();
    for clipped in &window.harness.output().shapes {
        for text in texts(&clipped.shape) {
            let rect = text.galley.rect.translate(text.pos.to_vec2());
            let (clip, words) = (clipped.clip_rect, text.galley.text());
            let seen = rect.intersect(clip);
            if words.trim().is_empty() || seen.width() < 1.0 || seen.height() < 1.0 {
                continue;
            }
            let is_typed = typed.iter().any(|field| field.expand(2.0).contains_rect(seen));
            let is_name = words.split_whitespace().count() <= NAME_WORDS
                && maps.iter().any(|map| map.contains_rect(seen));
            let is_cut = rect.width() > seen.width() + 1.5;
            if is_cut && !is_typed && !is_name && !scrolls_sideways(widgets, seen) {
                faults.push(format!("text cut off: {words:?} at {rect}, clip {clip}"));
            }
            if text.galley.elided && !has_tooltip(widgets, seen.center()) {
                faults.push(format!("no tooltip: {words:?} at {rect}"));
            }
        }
    }
    faults
}

/// The cross and the triangle that egui gives a window.
const OF_EGUI: [&str; 2] = ["Close window", "Hide"];

/// What can be clicked and shows no word says what it does when the pointer rests on it; but for marks on a map or chart.
fn unexplained(window: &Window, widgets: &[Widget]) -> Vec<String> {
    let shapes = window.harness.output().shapes.iter();
    let all = shapes.flat_map(|clipped| texts(&clipped.shape));
    let words: Vec<Rect> = all
        .filter(|text| text.galley.text().chars().any(char::is_alphanumeric))
        .map(|text| text.galley.rect.translate(text.pos.to_vec2()))
        .collect();
    let buttons =
        placed(widgets).into_iter().filter(|w| w.interactive && w.enabled && w.role == Role::Button);
    // one of which less than a half is above the fold has its word below
    let buttons = buttons.filter(|w| 2.0 * w.seen.height() > w.rect.height());
    let wordless = buttons.filter(|w| !words.iter().any(|rect| w.seen.contains(rect.center())));
    let silent =
        wordless.filter(|w| !w.has_tooltip && !is_mark(widgets, w) && !OF_EGUI.contains(&w.name.as_str()));
    silent.map(|w| format!("only a symbol, and no tooltip: {:?} at {}", w.name, w.seen)).collect()
}

/// A small thing on a map or chart.
fn is_mark(widgets: &[Widget], widget: &Widget) -> bool {
    let charts = widgets.iter().filter(|w| matches!(w.role, Role::Image | Role::Canvas));
    widget.rect.width() < 19.0 && charts.into_iter().any(|chart| chart.rect.contains_rect(widget.seen))
}

fn is_typed(widget: &Widget) -> bool {
    matches!(widget.role, Role::TextInput | Role::MultilineTextInput | Role::SearchInput)
}

/// A widget under it says all of it when the pointer is there, as rows of the tree do.
fn has_tooltip(widgets: &[Widget], at: Pos2) -> bool {
    widgets.iter().any(|w| (w.has_tooltip || w.role == Role::TreeItem) && w.seen.contains(at))
}

/// Popups, dialogs and cards are all of them on the screen.
fn off_the_screen(window: &Window) -> Vec<String> {
    let screen = window.harness.ctx.content_rect().expand(1.0);
    window.harness.ctx.memory(|memory| {
        let shown = memory.layer_ids().filter(|layer| {
            matches!(layer.order, Order::Middle | Order::Foreground) && memory.areas().is_visible(layer)
        });
        let off =
            shown.filter_map(|layer| memory.area_rect(layer.id).filter(|rect| !screen.contains_rect(*rect)));
        off.map(|rect| format!("off the screen: {rect}")).collect()
    })
}

/// A way to look at a state; what is wrong with it is added to what was found before.
pub type Look = fn(&str, &mut Window, &mut Vec<String>);

/// What is wrong with the window in this theme.
pub fn examine(state: &str, size: Vec2, theme: egui::Theme, window: &mut Window, found: &mut Vec<String>) {
    window.harness.input_mut().system_theme = Some(theme);
    window.steps(2);
    let faults = faults(window).into_iter().chain(off_the_screen(window));
    found.extend(faults.map(|fault| format!("{state} at {size}, {theme:?}: {fault}")));
}

type Act = (&'static str, fn(&mut Window));

/// Looks at what each act makes of the window that the acts before it have left.
fn check(look: Look, mut window: Window, acts: &[Act]) {
    let mut found = Vec::new();
    for (state, act) in acts {
        act(&mut window);
        window.until_analysed();
        look(state, &mut window, &mut found);
    }
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
}

pub fn opened(text: &str) -> Window {
    let mut window = Window::open(text);
    window.until_analysed();
    window
}

pub fn new_plan(look: Look) {
    check(
        look,
        Window::open(EMPTY),
        &[
            ("no plan", |_| ()),
            ("new mission", |w| w.click("Among the example's hills")),
            ("guide draws a runway", |w| w.click("✏ Draw the runway")),
            ("created", |w| {
                w.press(Key::Escape);
                w.click("Create");
                w.until_analysed();
            }),
            ("unsaved changes", |w| w.press_ctrl(Key::N)),
            ("file dialog", |w| {
                w.click("Cancel");
                w.harness.state_mut().ask_for_files_here();
                w.press_ctrl(Key::S);
                until_listed(w);
            }),
        ],
    );
}

pub fn selections_and_tools(look: Look) {
    check(
        look,
        opened(SQUARE),
        &[
            ("plan", |_| ()),
            ("leg", |w| w.click("TF side2")),
            ("several legs", |w| {
                w.harness.get_by_label("TF side4").click_modifiers(egui::Modifiers::SHIFT);
            }),
            ("fix", |w| w.click("Fix C")),
            ("runway", |w| {
                // a small window has its row below the fold
                w.harness.set_size(SIZES[2]);
                w.steps(2);
                w.click("RWY R05");
                assert_eq!(w.selected(), "R05");
            }),
            ("stage", |w| w.click("ENR circuit")),
            ("emergency plan", |w| w.click("ALT return")),
            ("legs are drawn", |w| w.press(Key::T)),
            ("area", |w| w.press(Key::A)),
            ("circle", |w| w.press(Key::O)),
            ("fix is placed", |w| w.press(Key::X)),
            ("zone", |w| w.press(Key::Z)),
            ("runway is drawn", |w| w.press(Key::R)),
            ("measure", |w| w.press(Key::M)),
            ("menu of the map", |w| {
                w.press(Key::V);
                w.right_click_at(w.centre("Map") + vec2(30.0, 60.0));
            }),
        ],
    );
}

pub fn panels_and_dialogs(look: Look) {
    check(
        look,
        opened(FIRE_WATCH),
        &[
            ("plan with everything", |_| ()),
            ("table", |w| tab(w, "Table")),
            ("what if", |w| tab(w, "What if")),
            ("connect form", |w| w.click("○ Connect")),
            ("menu", |w| {
                w.press(Key::Escape);
                w.click("Legwork");
            }),
            ("maps", |w| {
                w.click("Maps");
                w.click("Maps and elevations…");
                w.click("From a server");
            }),
            ("palette", |w| {
                w.click("Close window");
                w.ask_for("fl");
            }),
            ("help", |w| {
                w.press(Key::Escape);
                w.press(Key::F1);
            }),
        ],
    );
}

pub fn flight(look: Look) {
    let (window, _) = flying();
    check(
        look,
        window,
        &[
            ("flying", Window::receive_attitude),
            ("log", |w| tab(w, "Log")),
            ("services", |w| tab(w, "Services")),
            ("alarms", |w| {
                w.receive_position(false);
                w.receive_attitude();
                let alarm = |id: &str, severity| Alarm {
                    id: id.into(),
                    severity,
                    source: "gateway".into(),
                    advice: "battery at 12 %: the flight ends soon, come home now".into(),
                    cause: None,
                };
                let alarms =
                    vec![alarm("energy-low", Severity::Warning), alarm("gps-lost", Severity::Caution)];
                w.receive_gateway(alarms);
            }),
            ("decision", |w| {
                let plan = Some(w.app().analysis().hash.clone().into());
                let decision = decision(Some("again"));
                w.receive_status(flight_exec::Status {
                    plan,
                    decision: Some(decision),
                    ..status(Phase::Flying)
                });
            }),
            ("proposal", |w| {
                w.receive_status(flight_exec::Status {
                    plan: Some("another".into()),
                    ..status(Phase::Flying)
                });
                while w.asked().is_some() {}
                w.click("Push");
                let (ticket, _) = w.asked().unwrap();
                let hash = w.app().analysis().hash.clone();
                w.answer(ticket, Ok(Reply::Proposal(Box::new(report(&hash, true)))));
            }),
        ],
    );
}

pub fn questions_and_emergencies(look: Look) {
    let (mut window, ticket) = considered();
    let mut found = Vec::new();
    look("looking ahead", &mut window, &mut found);
    window.answer(ticket, Ok(Reply::Foresight(Box::new(foresight()))));
    look("foreseen", &mut window, &mut found);
    look("emergency", &mut in_emergency(), &mut found);
    look("two vehicles", &mut two(), &mut found);
    assert!(found.is_empty(), "{} faults:\n{}", found.len(), found.join("\n"));
}
