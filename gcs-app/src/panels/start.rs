//! The beginning of a plan: a card over the map of an empty document. A few answers give a plan that can be flown.

mod airfield;
mod place;

use super::field::List;
use super::{Scene, field, primary_button};
use crate::airfields::Ground;
use crate::command::{DocumentCommand, Queue, Replacement, ViewCommand};
use crate::guide::{Answer, Drawing, Guide, MissionFigure};
use crate::map::furniture::NARROW;
use crate::map::text;
use crate::map::view::View;
use crate::theme::{self, Palette};
use crate::units::{Unit, Units};
use aircraft::Profile;
use egui::text::LayoutJob;
use egui::{
    Align2, Color32, DragValue, Label, Painter, Pos2, Rect, RichText, Role, ScrollArea, Shape, Stroke,
    TextStyle, Ui, WidgetInfo, vec2,
};
use flight_plan::template::{Extent, Outline, Survey, Template, USUAL_ACROSS_DEG};
use geometry::LatLon;
use std::ops::RangeInclusive;

/// Width of the card, and the height that it needs, screen points.
pub const WIDTH: f32 = 280.0;
/// Its width where it is not to reach over the panels on the left.
pub const NARROW_WIDTH: f32 = 252.0;
/// See [`WIDTH`].
pub const HEIGHT: f32 = 500.0;

/// The document has nothing in it yet, and the card was not closed.
pub fn is_wanted(scene: &Scene<'_>) -> bool {
    !scene.view.guide.closed && scene.document.plan().stages.is_empty() && scene.vehicle.aboard.is_none()
}

/// There is room for the card on a map.
pub fn is_on(map: Rect) -> bool {
    map.width() >= NARROW && map.height() >= HEIGHT
}

/// Height of its title and of its buttons, which are always in view, screen points.
const AROUND: f32 = 90.0;

/// Draws the card, in so much height.
pub fn show(ui: &mut Ui, scene: &Scene<'_>, height: f32, queue: &mut Queue) {
    let mut guide = scene.view.guide.clone();
    let is_narrow = ui.available_width() < WIDTH;
    if is_narrow {
        // a small window: all questions are in sight
        ui.spacing_mut().item_spacing.y = 2.0;
    }
    let closed = title(ui);
    let most = (height - AROUND).max(60.0);
    let questions = ScrollArea::vertical().id_salt("questions").max_height(most).min_scrolled_height(most);
    // the bar lies at the edge of the card
    let questions = questions.auto_shrink([false, true]);
    questions.show(ui, |ui| {
        if is_narrow {
            // and over what reaches so far
            ui.set_max_width(ui.available_width() - ui.spacing().scroll.bar_width);
        }
        ask(ui, scene, &mut guide, queue);
        if guide.threshold.is_some() {
            // the buttons below keep their place when fields come and go
            let used = ui.min_rect().height();
            ui.add_space((HEIGHT - AROUND - used).clamp(0.0, most));
        }
    });
    ui.add_space(6.0);
    buttons(ui, &guide, queue);
    if guide != scene.view.guide {
        queue.view(ViewCommand::Guide(Answer::Form(Box::new(guide))));
    }
    if closed {
        queue.view(ViewCommand::Guide(Answer::Close));
    }
}

/// True: it is to be closed.
fn title(ui: &mut Ui) -> bool {
    ui.horizontal(|ui| {
        ui.label(RichText::new("New mission").strong().size(16.0));
        let right = egui::Layout::right_to_left(egui::Align::Center);
        ui.with_layout(right, |ui| field::small_button(ui, "✖", "Close the card (Esc); New opens it again"))
            .inner
    })
    .inner
}

fn ask(ui: &mut Ui, scene: &Scene<'_>, guide: &mut Guide, queue: &mut Queue) {
    match guide.threshold {
        None => ask_place(ui, scene, guide, queue),
        Some(threshold) => {
            let hint = "Make a plan that can be flown as it is, then change it on the map.";
            ui.label(RichText::new(hint).color(theme::of(ui).weak));
            ui.add_space(4.0);
            templates(ui, guide);
            ui.add_space(4.0);
            answers(ui, threshold, guide, scene, queue);
        }
    }
}

/// As long as no place is known.
pub const SAY_WHERE: &str = "Say first where you fly: click the map, or type it into the card.";

/// What makes the plan; or why there can't be one yet.
///
/// # Errors
/// What has to be answered first.
pub fn creating(guide: &Guide) -> Result<DocumentCommand, &'static str> {
    if guide.is_too_far() {
        return Err(
            "The mission is too far from the runway: draw it again, or give the runway another place.",
        );
    }
    guide.outline().map(|outline| DocumentCommand::Create(Box::new(outline))).ok_or(SAY_WHERE)
}

fn buttons(ui: &mut Ui, guide: &Guide, queue: &mut Queue) {
    ui.horizontal(|ui| {
        let creating = creating(guide);
        let create = ui.add_enabled(creating.is_ok(), primary_button("Create", theme::of(ui)));
        match creating {
            Ok(command) if create.clicked() => queue.document(command),
            Ok(_) => {}
            Err(why_not) => drop(create.on_disabled_hover_text(why_not)),
        }
        if ui.button("Open a plan…").clicked() {
            queue.document(DocumentCommand::Replace(Replacement::AskOpen));
        }
    });
}

/// The first question: everything else lies around the answer.
fn ask_place(ui: &mut Ui, scene: &Scene<'_>, guide: &mut Guide, queue: &mut Queue) {
    let p = theme::of(ui);
    ui.label("Where do you fly?");
    ui.label(
        RichText::new("Zoom in and click the map, or type it: a position, a city, an airport or its code.")
            .color(p.weak),
    );
    let mut answer = place::ask(ui, "Place", None, guide, scene.units(), queue);
    if let Some(position) = &scene.vehicle.position
        && ui.button("Where the vehicle is").clicked()
    {
        answer = Some(position.value.position);
    }
    if ui.button("Among the example's hills").on_hover_text("Elevations of these come with Legwork").clicked()
    {
        answer = Some(crate::map::HOME);
    }
    if let Some(at) = answer {
        (guide.threshold, guide.drawing, guide.search) = (Some(at), None, None);
    }
}

fn templates(ui: &mut Ui, guide: &mut Guide) {
    ui.horizontal_wrapped(|ui| {
        for template in Template::ALL {
            let chosen = guide.template == template;
            if ui.selectable_label(chosen, template.name()).on_hover_text(template.about()).clicked() {
                guide.choose(template);
            }
        }
    });
    said(ui, guide.template.about(), theme::of(ui).weak);
}

/// What is said of an answer takes two lines, whatever it is: no question below moves for it.
fn said(ui: &mut Ui, text: &str, colour: Color32) {
    const ROWS: usize = 2;
    let font = TextStyle::Body.resolve(ui.style());
    let mut job = LayoutJob::simple(text.to_owned(), font, colour, ui.available_width());
    job.wrap.max_rows = ROWS;
    let letters = ui.fonts_mut(|fonts| fonts.layout_job(job));
    ui.vertical(|ui| {
        ui.set_min_height(ROWS as f32 * ui.text_style_height(&TextStyle::Body).ceil());
        ui.add(Label::new(letters)).on_hover_text(text);
    });
}

fn answers(ui: &mut Ui, threshold: LatLon, guide: &mut Guide, scene: &Scene<'_>, queue: &mut Queue) {
    let u = scene.units();
    if let Some(at) = place::ask(ui, "Runway at", Some(threshold), guide, u, queue) {
        guide.threshold = Some(at);
    }
    airfield::offer(ui, threshold, guide, scene);
    draw_button(ui, "Draw the runway", Drawing::Runway, guide);
    number(ui, "Heading", &mut guide.heading_deg, DEGREES, 0.0..=359.9);
    number(ui, "Length", &mut guide.length_m, u.length(), 50.0..=5000.0);
    if let Some(figure) = MissionFigure::of(guide.template) {
        mission(ui, figure, guide, u, queue);
    }
    number(ui, "Height", &mut guide.height_m, u.altitude(), 30.0..=4000.0);
    height_remark(ui, guide, scene);
    survey_remark(ui, guide, scene);
    aircraft(ui, guide);
}

/// What the height counts from, and what the ground around makes of it.
fn height_remark(ui: &mut Ui, guide: &Guide, scene: &Scene<'_>) {
    let p = theme::of(ui);
    let flown_m = guide.outline().map_or(guide.height_m, |outline| flown_height_m(outline, scene));
    // heights are made round
    const ROUND_M: f64 = 10.0;
    match flown_m - guide.height_m > ROUND_M {
        true => {
            let flown = scene.units().altitude().show(flown_m);
            let asked = scene.units().altitude().show(guide.height_m);
            let text =
                format!("⚠ flown {flown} above the runway, not {asked}: the ground around asks for that");
            said(ui, &text, p.caution);
        }
        false => said(ui, "above the runway; more where the ground asks for it", p.weak),
    }
}

fn flown_height_m(outline: Outline, scene: &Scene<'_>) -> f64 {
    let (outline, profile) = on_the_ground(outline, scene);
    outline.mission_height_m(&profile, scene.layers.ground().as_ref())
}

/// How far apart the tracks of a survey are, and what that is good for.
fn survey_remark(ui: &mut Ui, guide: &Guide, scene: &Scene<'_>) {
    let survey = guide.outline().and_then(|outline| {
        let (outline, profile) = on_the_ground(outline, scene);
        outline.survey(&profile, scene.layers.ground().as_ref())
    });
    let Some(survey) = survey else { return };
    let p = theme::of(ui);
    ui.label(RichText::new(survey_words(&survey, scene.units())).color(p.weak)).on_hover_text(format!(
        "As a camera sees it that sees {USUAL_ACROSS_DEG:.0}° across the track. Change it afterwards: it is the spacing of the scan"
    ));
}

/// `Tracks 50 m apart: 71 % side overlap at 150 m above the ground`.
fn survey_words(survey: &Survey, u: Units) -> String {
    let Survey { spacing_m, side_overlap, above_ground_m } = *survey;
    let apart = format!("Tracks {} apart", u.length().show(spacing_m));
    let height = u.altitude().show(above_ground_m);
    match side_overlap > 0.0 {
        true => format!("{apart}: {:.0} % side overlap at {height} above the ground", 100.0 * side_overlap),
        false => format!("{apart}: more than is seen from {height} above the ground"),
    }
}

/// With its runway as high as the ground there, and its aircraft.
fn on_the_ground(mut outline: Outline, scene: &Scene<'_>) -> (Outline, Profile) {
    let ground = scene.layers.ground().as_ref();
    outline.runway.elevation_amsl_m = Ground::of(ground, outline.runway.threshold).amsl_m().round();
    let profile = Profile::by_name(&outline.aircraft).unwrap_or_default();
    (outline, profile)
}

/// Where the mission is: drawn, or around a place.
fn mission(ui: &mut Ui, figure: MissionFigure, guide: &mut Guide, u: Units, queue: &mut Queue) {
    let extent = guide.extent();
    if let Some(Extent::Drawn(places)) = &extent {
        let size = u.distance().show(2.0 * extent.as_ref().map_or(0.0, Extent::radius_m));
        let text = format!("{} of {} points, {size} across", figure.name(), places.len());
        field::row(ui, "Mission", |ui| ui.add(Label::new(text).truncate()));
        away(ui, guide, u);
        draw_button(ui, &format!("Draw the {} again", figure.name()), Drawing::Mission, guide);
        return;
    }
    let Some(centre) = extent.map(|extent| extent.centre()) else { return };
    let mut radius_m = match &guide.extent {
        Some(Extent::Around { radius_m, .. }) => *radius_m,
        _ => guide.radius_m,
    };
    let before_m = radius_m;
    let moved = place::ask(ui, "Mission at", Some(centre), guide, u, queue);
    draw_button(ui, &format!("Draw the {}", figure.name()), Drawing::Mission, guide);
    number(ui, "Reaches", &mut radius_m, u.length(), 200.0..=20_000.0);
    if moved.is_some() || (guide.extent.is_some() && radius_m != before_m) {
        guide.extent = Some(Extent::Around { centre: moved.unwrap_or(centre), radius_m });
    }
    guide.radius_m = radius_m;
}

/// A drawing may come from elsewhere: how far it is, where that is far. The row is there all the same: nothing moves for it.
fn away(ui: &mut Ui, guide: &Guide, u: Units) {
    const FAR_M: f64 = 20_000.0;
    let far_m = guide.way_m().filter(|way_m| *way_m > FAR_M);
    let text = far_m.map(|far_m| format!("⚠ {} from the runway", u.distance().show(far_m)));
    let text = RichText::new(text.unwrap_or_default()).color(theme::of(ui).caution);
    field::row(ui, "", |ui| ui.label(text));
}

/// A button that has the next clicks on the map answer.
fn draw_button(ui: &mut Ui, name: &str, drawing: Drawing, guide: &mut Guide) {
    field::row(ui, "", |ui| {
        let on = guide.drawing == Some(drawing);
        if ui.selectable_label(on, format!("✏ {name}")).on_hover_text("On the map").clicked() {
            guide.drawing = (!on).then_some(drawing);
        }
    });
}

fn aircraft(ui: &mut Ui, guide: &mut Guide) {
    field::row(ui, "Aircraft", |ui| {
        let shown = guide.aircraft.clone();
        let names = Profile::names();
        let now = names.iter().position(|name| *name == shown);
        let name = format!("Aircraft: {shown}");
        let list = List { salt: "aircraft", name: &name, shown: &shown, look: |combo| combo };
        let (taken, _) = list.show(ui, now, || names.clone());
        if let Some(name) = taken.and_then(|taken| names.get(taken)) {
            guide.aircraft = (*name).to_owned();
        }
    });
}

const DEGREES: Unit = Unit { symbol: "°", per_si: 1.0, decimals: 0 };

fn number(ui: &mut Ui, name: &str, si: &mut f64, unit: Unit, range_si: RangeInclusive<f64>) {
    field::row(ui, name, |ui| {
        let mut shown = unit.from_si(*si);
        let range = unit.from_si(*range_si.start())..=unit.from_si(*range_si.end());
        let value = DragValue::new(&mut shown).range(range).suffix(format!(" {}", unit.symbol));
        let typed = field::Typed::of(ui);
        let value = value.update_while_editing(false).custom_parser(|text| typed.read(unit, text));
        let response = ui.add(value.max_decimals(0));
        typed.tell(ui, &response);
        response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, name));
        if response.changed() {
            *si = unit.to_si(shown);
        }
    });
}

/// Draws on the map where runway and mission would be.
pub fn draw(painter: &Painter, view: &View, scene: &Scene<'_>, p: &Palette) {
    let Some(outline) = scene.view.guide.outline().filter(|_| is_wanted(scene)) else { return };
    draw_runway(painter, view, &outline, p);
    let drawing_it = scene.view.guide.drawing == Some(Drawing::Mission);
    if let Some(figure) = MissionFigure::of(outline.template).filter(|_| !drawing_it) {
        draw_mission(painter, view, &outline, figure, p);
    }
}

fn draw_runway(painter: &Painter, view: &View, outline: &Outline, p: &Palette) {
    let runway = &outline.runway;
    let ends = [runway.threshold, runway.threshold.destination(runway.heading_deg, runway.length_m)];
    let [threshold, end] = ends.map(|at| view.place(at));
    for (width, colour) in [(6.0, p.halo), (3.0, p.text)] {
        painter.line_segment([threshold, end], Stroke::new(width, colour));
    }
    let below = vec2(0.0, 8.0);
    text::haloed(painter, threshold + below, Align2::CENTER_TOP, runway.id.as_str(), 12.0, p.text, p);
}

fn draw_mission(painter: &Painter, view: &View, outline: &Outline, figure: MissionFigure, p: &Palette) {
    let stroke = Stroke::new(1.5, p.accent);
    let middle = view.place(outline.extent.centre());
    match &outline.extent {
        Extent::Around { radius_m, .. } => {
            painter.circle_stroke(middle, (radius_m * view.points_per_metre()) as f32, stroke);
        }
        Extent::Drawn(places) => {
            let points: Vec<Pos2> = places.iter().map(|at| view.place(*at)).collect();
            let closed = figure == MissionFigure::Area;
            painter.add(if closed {
                Shape::closed_line(points, stroke)
            } else {
                Shape::line(points, stroke)
            });
        }
    }
    text::haloed(painter, middle, Align2::CENTER_CENTER, outline.template.name(), 12.0, p.accent, p);
}
