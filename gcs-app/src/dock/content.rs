//! What is in the tiles: the map and the panels, each with its title.

use super::stops::Stop;
use super::{GAP, MAP, TAB_BAR};
use crate::command::{Queue, ViewCommand};
use crate::map::MapState;
use crate::panels::{Panel, PanelId, Place, Scene, tour, what_if};
use crate::theme;
use egui::{
    Align, Color32, Frame, Layout, Margin, PointerButton, Rect, Response, RichText, Sense, Stroke, Style, Ui,
    Visuals, WidgetText, vec2,
};
use egui_tiles::{Behavior, Container, ResizeState, TabState, Tabs, Tile, TileId, Tiles, UiResponse};
use std::collections::{BTreeSet, HashMap};

/// Everything that is drawn in the tiles of a frame.
#[derive(Debug)]
pub struct Content<'a> {
    map: &'a mut MapState,
    panels: &'a mut [Box<dyn Panel>],
    scene: &'a Scene<'a>,
    queue: &'a mut Queue,
    /// Tiles that have a tab, and so no title of their own.
    tabbed: BTreeSet<u64>,
    /// Panels whose tab bar has no room for their headers.
    crowded: BTreeSet<PanelId>,
    map_rect: Option<Rect>,
    /// What the panels of the plan take.
    plan_rect: Option<Rect>,
    stops: Vec<Stop>,
    drawn: BTreeSet<PanelId>,
}

impl<'a> Content<'a> {
    /// For one frame.
    pub fn new(
        map: &'a mut MapState,
        panels: &'a mut [Box<dyn Panel>],
        scene: &'a Scene<'a>,
        queue: &'a mut Queue,
    ) -> Self {
        Self {
            map,
            panels,
            scene,
            queue,
            tabbed: BTreeSet::new(),
            crowded: BTreeSet::new(),
            map_rect: None,
            plan_rect: None,
            stops: Vec::new(),
            drawn: BTreeSet::new(),
        }
    }

    pub(super) fn begin(&mut self, tiles: &Tiles<PanelId>) {
        let tabs = tiles.tiles().filter_map(|tile| match tile {
            Tile::Container(Container::Tabs(tabs)) => Some(tabs.children.iter().map(|child| child.0)),
            _ => None,
        });
        self.tabbed = tabs.flatten().collect();
    }

    pub(super) fn take_stops(&mut self) -> Vec<Stop> {
        std::mem::take(&mut self.stops)
    }

    pub(super) fn take_drawn(&mut self) -> BTreeSet<PanelId> {
        std::mem::take(&mut self.drawn)
    }

    pub(super) fn map_rect(&self) -> Option<Rect> {
        self.map_rect
    }

    /// Where the panels of the plan are, if any is drawn.
    pub(super) fn plan_rect(&self) -> Option<Rect> {
        self.plan_rect
    }

    /// Has the panel something to show?
    pub(super) fn is_relevant(&self, id: PanelId) -> bool {
        self.panel(id).is_none_or(|panel| panel.is_relevant(self.scene))
    }

    /// One of those that the plan is edited in, on the left unless the operator has put it elsewhere.
    pub(super) fn is_of_the_plan(&self, id: PanelId) -> bool {
        self.panel(id).is_some_and(|panel| matches!(panel.place(), Place::Left { .. }))
    }

    /// One that the flight's values need the room of: it was open when the aircraft took off, and nobody has asked for it since.
    pub(super) fn gives_way_to_flight(&self, id: PanelId) -> bool {
        let is_wanted = self.scene.view.wanted_panel == Some(id);
        id == what_if::ID && self.scene.vehicle.is_airborne() && !is_wanted
    }

    /// The vehicle that is shown is in the air.
    pub(super) fn is_in_flight(&self) -> bool {
        self.scene.vehicle.is_airborne()
    }

    /// The least heights of the panels, with their titles and what is around them, screen points.
    pub(super) fn least_heights(&self) -> HashMap<PanelId, f32> {
        let around = TAB_BAR + MARGIN.sum().y;
        self.panels.iter().map(|panel| (panel.id(), panel.least_height() + around)).collect()
    }

    fn panel(&self, id: PanelId) -> Option<&dyn Panel> {
        self.panels.iter().find(|panel| panel.id() == id).map(Box::as_ref)
    }

    fn title(&self, id: PanelId) -> String {
        self.panel(id).map_or_else(|| "Map".into(), |panel| panel.title(self.scene))
    }

    /// The title of a panel that is alone in its place: it is dragged by it. True if that begins.
    fn title_bar(&mut self, ui: &mut Ui, id: PanelId) -> bool {
        let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), TAB_BAR - 4.0), Sense::hover());
        // there is nothing to be done with it by key
        let handle = ui.interact(rect, ui.scope_id().with("title"), Sense::CLICK | Sense::DRAG);
        let mut bar =
            ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(Layout::left_to_right(Align::Center)));
        let weak = theme::of(ui).weak;
        let title = RichText::new(self.title(id).to_uppercase()).size(10.5).color(weak).strong();
        bar.add(egui::Label::new(title).selectable(false).sense(Sense::hover()));
        bar.with_layout(Layout::right_to_left(Align::Center), |ui| {
            self.close_button(ui, id, weak);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| self.header(ui, id));
        });
        handle.on_hover_cursor(egui::CursorIcon::Grab).drag_started()
    }

    fn close_button(&mut self, ui: &mut Ui, id: PanelId, colour: Color32) {
        let button = egui::Button::new(RichText::new("✖").size(10.0).color(colour)).frame(false);
        let name = format!("Hide {}", self.panel(id).map_or(id, Panel::name));
        let response = ui.add(button).on_hover_text("Hide it; the menu shows it again");
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
        if response.clicked() {
            self.queue.view(ViewCommand::ShowPanel(id, false));
        }
    }

    /// The header in a row of its own, or in two where that is narrow; none where the panel has no header.
    fn header_row(&mut self, ui: &mut Ui, id: PanelId) {
        let rect = Rect::from_min_size(ui.cursor().min, vec2(ui.available_width(), TAB_BAR));
        let layout = Layout::left_to_right(Align::Center).with_main_wrap(rect.width() < HEADER);
        let mut row = ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(layout));
        self.header(&mut row, id);
        if row.min_rect().width() > 0.0 {
            ui.advance_cursor_after_rect(rect.union(row.min_rect()));
        }
    }

    fn header(&mut self, ui: &mut Ui, id: PanelId) {
        if let Some(panel) = self.panels.iter_mut().find(|panel| panel.id() == id) {
            panel.header(ui, self.scene, self.queue);
        }
    }
}

/// Least width of a header beside tabs; with less, it stands below them, screen points.
pub(super) const HEADER: f32 = 240.0;
/// Around a panel.
const MARGIN: Margin = Margin { left: 10, right: 10, top: 4, bottom: 8 };

impl Behavior<PanelId> for Content<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, tile: TileId, pane: &mut PanelId) -> UiResponse {
        let id = *pane;
        let (name, keyboard) = match self.panel(id) {
            Some(panel) => (panel.name(), panel.keyboard()),
            None => ("Map", self.map.keyboard()),
        };
        self.stops.push(Stop::new(ui, name, keyboard));
        self.drawn.insert(id);
        if id == MAP {
            self.map_rect = Some(ui.max_rect());
            self.map.show(ui, self.scene, self.queue);
            return UiResponse::None;
        }
        if self.is_of_the_plan(id) {
            self.plan_rect = Some(self.plan_rect.map_or(ui.max_rect(), |rect| rect | ui.max_rect()));
        }
        let frame = Frame::new().fill(theme::of(ui).panel).inner_margin(MARGIN);
        tour::mark(ui.ctx(), id, ui.max_rect());
        let dragged = frame.show(ui, |ui| {
            let dragged = !self.tabbed.contains(&tile.0) && self.title_bar(ui, id);
            if self.crowded.contains(id) {
                self.header_row(ui, id);
            }
            if let Some(panel) = self.panels.iter_mut().find(|panel| panel.id() == id) {
                panel.ui(ui, self.scene, self.queue);
            }
            // the frame fills the tile, however little is in it
            ui.allocate_space(ui.available_size().max(egui::Vec2::ZERO));
            dragged
        });
        if dragged.inner { UiResponse::DragStarted } else { UiResponse::None }
    }

    fn tab_title_for_pane(&mut self, pane: &PanelId) -> WidgetText {
        self.title(pane).into()
    }

    fn top_bar_right_ui(
        &mut self,
        tiles: &Tiles<PanelId>,
        ui: &mut Ui,
        _tile: TileId,
        tabs: &Tabs,
        _scroll: &mut f32,
    ) {
        let active = tabs.active.and_then(|id| tiles.get_pane(&id)).copied();
        let titles: Vec<PanelId> = tabs
            .children
            .iter()
            .filter(|id| tiles.is_visible(**id))
            .filter_map(|id| tiles.get_pane(id))
            .copied()
            .collect();
        let width: f32 = titles.into_iter().map(|id| tab_width(ui, self.title(id))).sum();
        let Some(id) = active else { return };
        let room = vec2((ui.available_width() - width - 8.0).max(0.0), TAB_BAR);
        if room.x < HEADER {
            self.crowded.insert(id);
            return;
        }
        ui.allocate_ui_with_layout(room, Layout::left_to_right(Align::Center), |ui| {
            ui.set_min_width(room.x);
            self.header(ui, id);
        });
    }

    /// A click on a name never closes: there is no cross beside it that is hit instead.
    fn on_tab_button(&mut self, tiles: &mut Tiles<PanelId>, tile: TileId, response: Response) -> Response {
        let Some(panel) = tiles.get_pane(&tile).copied().filter(|panel| *panel != MAP) else {
            return response;
        };
        let mut hides = response.clicked_by(PointerButton::Middle);
        response.context_menu(|ui| hides |= ui.button("Hide").clicked());
        if hides {
            // it keeps its place
            self.queue.view(ViewCommand::ShowPanel(panel, false));
        }
        response.on_hover_text("A middle click hides it; the menu shows it again")
    }

    fn is_tile_draggable(&self, tiles: &Tiles<PanelId>, tile: TileId) -> bool {
        tiles.get_pane(&tile).is_none_or(|panel| *panel != MAP)
    }

    fn tab_bar_height(&self, _style: &Style) -> f32 {
        TAB_BAR
    }

    fn gap_width(&self, _style: &Style) -> f32 {
        GAP
    }

    fn min_size(&self) -> f32 {
        64.0
    }

    fn tab_bar_color(&self, visuals: &Visuals) -> Color32 {
        theme::palette(visuals.dark_mode).panel
    }

    fn tab_bg_color(&self, visuals: &Visuals, _: &Tiles<PanelId>, _: TileId, state: &TabState) -> Color32 {
        if state.active { visuals.selection.bg_fill } else { Color32::TRANSPARENT }
    }

    fn tab_outline_stroke(&self, _: &Visuals, _: &Tiles<PanelId>, _: TileId, _: &TabState) -> Stroke {
        Stroke::NONE
    }

    fn tab_text_color(&self, visuals: &Visuals, _: &Tiles<PanelId>, _: TileId, _: &TabState) -> Color32 {
        theme::palette(visuals.dark_mode).text
    }

    fn resize_stroke(&self, style: &Style, state: ResizeState) -> Stroke {
        let p = theme::palette(style.visuals.dark_mode);
        match state {
            ResizeState::Idle => Stroke::new(GAP, p.line),
            ResizeState::Hovering | ResizeState::Dragging => Stroke::new(2.0, p.accent),
        }
    }
}

/// How wide a tab with this title is.
fn tab_width(ui: &Ui, title: String) -> f32 {
    let font = egui::TextStyle::Button.resolve(ui.style());
    ui.painter().layout_no_wrap(title, font, Color32::PLACEHOLDER).size().x + 20.0
}
