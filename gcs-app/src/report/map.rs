//! `map.png`: planned and flown over the ground.

use super::canvas::{Anchor, Canvas, Pen, Type};
use super::labels::Labels;
use super::record::{Area, Place, PlaceKind, Record};
use super::style::*;
use super::view::View;
use super::{Findings, hillshade, panel, zones};
use geometry::{LatLon, Vec2};

const WIDTH: f32 = 1600.0;
const HEIGHT: f32 = 1120.0;
const HEADER: f32 = 76.0;
const PANEL: f32 = 372.0;
const MAP_WIDTH: f32 = WIDTH - PANEL;
const MAP_HEIGHT: f32 = HEIGHT - HEADER;
/// Pixels of the map per pixel of the shaded ground.
const SHADE_SCALE: f32 = 2.0;
/// Minutes between the time marks on the track.
const TIME_MARK_MIN: u32 = 5;

/// Side of the enlarged view of the scanned areas, pixels.
const INSET: f32 = 300.0;
/// The enlarged view shows the areas so much larger than the map, or there is none.
const ENLARGED: f64 = 1.4;

/// The picture as PNG bytes.
///
/// # Errors
/// Nothing to draw, or the encoder fails.
pub fn png(record: &Record, findings: &Findings) -> anyhow::Result<Vec<u8>> {
    let mut canvas = Canvas::new(WIDTH as u32, HEIGHT as u32, PAPER)?;
    let view = View::around(shown(record), (0.0, HEADER, MAP_WIDTH, MAP_HEIGHT))
        .ok_or_else(|| anyhow::anyhow!("the track is empty: nothing to draw"))?;
    let enlarged = inset_view(record, &view);
    let elsewhere = enlarged.as_ref().map(|inset| Frame::of(inset, &view));
    draw_ground(&mut canvas, record, &view);
    let mut labels = Labels::new(view.window());
    labels.keep_corner_for_north();
    draw_flight(&mut canvas, record, &view, &mut labels);
    draw_time_marks(&mut canvas, record, &view, &mut labels, elsewhere);
    draw_happenings(&mut canvas, record, &view, elsewhere);
    match elsewhere {
        Some(frame) => draw_frame(&mut canvas, frame),
        None => label_areas(&mut canvas, record, &view),
    }
    draw_scale(&mut canvas, &view, (26.0, HEIGHT - 30.0));
    draw_north(&mut canvas, (MAP_WIDTH - 36.0, HEADER + 42.0));
    draw_header(&mut canvas, record);
    let bottom = if enlarged.is_some() { HEIGHT - INSET - 56.0 } else { HEIGHT };
    panel::draw(&mut canvas, record, findings, (MAP_WIDTH, HEADER, WIDTH, bottom));
    if let Some(view) = enlarged {
        place_inset(&mut canvas, &inset(record, &view)?);
    }
    canvas.png()
}

/// Everything that must be on the map.
fn shown(record: &Record) -> impl Iterator<Item = LatLon> {
    let tracks = record.planned.points().iter().chain(record.flown.points()).map(|p| p.position);
    let areas = record.areas.iter().flat_map(|a| a.outline.iter().copied());
    let flight: Vec<LatLon> = tracks.chain(areas).collect();
    let zones = zones::near(&record.zones, &flight);
    flight.into_iter().chain(zones)
}

fn draw_flight(canvas: &mut Canvas, record: &Record, view: &View, labels: &mut Labels) {
    labels.keep_clear(&view.line(record.main_track()));
    zones::draw(canvas, view, labels, &record.zones, PAPER);
    for area in &record.areas {
        draw_area(canvas, view, area);
    }
    for route in &record.routes {
        canvas.line(&view.pixels(route), Pen::dashed(AREA, 2.4, [10.0, 6.0]));
    }
    draw_tracks(canvas, record, view);
    draw_places(canvas, view, labels, &record.places, PAPER);
}

/// The enlarged view of the scanned areas with the turns around them, where the map shows them too small.
fn inset_view(record: &Record, map: &View) -> Option<View> {
    let track = record.main_track();
    let covering = track.passages().iter().enumerate().filter(|(_, p)| p.covers_an_area());
    let flown = covering.flat_map(|(i, _)| track.points().get(track.range(i)).unwrap_or_default());
    let corners = record.areas.iter().flat_map(|a| a.outline.iter().copied());
    let view = View::around(corners.chain(flown.map(|p| p.position)), (0.0, 0.0, INSET, INSET))?;
    (view.metres_per_pixel * ENLARGED <= map.metres_per_pixel).then_some(view)
}

fn inset(record: &Record, view: &View) -> anyhow::Result<Canvas> {
    let mut canvas = Canvas::new(INSET as u32, INSET as u32, PAPER)?;
    draw_ground(&mut canvas, record, view);
    draw_flight(&mut canvas, record, view, &mut Labels::new(view.window()));
    draw_happenings(&mut canvas, record, view, None);
    label_areas(&mut canvas, record, view);
    Ok(canvas)
}

/// The part of the map that is left to the enlarged view: marks and names would cover everything there.
#[derive(Debug, Clone, Copy)]
struct Frame {
    left: f32,
    top: f32,
    right: f32,
    bottom: f32,
}

impl Frame {
    /// What `inset` shows, on the map.
    fn of(inset: &View, map: &View) -> Self {
        let half_m = f64::from(INSET) / 2.0 * inset.metres_per_pixel;
        let corner = |e: f64, n: f64| map.place(inset.frame.to_geo(Vec2::new(e, n)));
        let ((left, top), (right, bottom)) = (corner(-half_m, half_m), corner(half_m, -half_m));
        Self { left, top, right, bottom }
    }

    fn contains(self, (x, y): (f32, f32)) -> bool {
        (self.left..self.right).contains(&x) && (self.top..self.bottom).contains(&y)
    }
}

fn draw_frame(canvas: &mut Canvas, Frame { left, top, right, bottom }: Frame) {
    canvas.outline(&[(left, top), (right, top), (right, bottom), (left, bottom)], Pen::solid(TEXT, 1.4));
    let below = ((left + right) / 2.0, bottom + 13.0);
    canvas.text(below, Anchor::Middle, "enlarged on the right", Type::plain(14.0, TEXT).on(PAPER));
}

fn place_inset(canvas: &mut Canvas, inset: &Canvas) {
    let (x, y) = (MAP_WIDTH + (PANEL - INSET) / 2.0, HEIGHT - INSET - 20.0);
    canvas.rectangle(MAP_WIDTH + 1.0, y - 40.0, PANEL, INSET + 60.0, PAPER);
    canvas.text((x + 2.0, y - 18.0), Anchor::Left, "Scanned areas, enlarged", Type::bold(17.0, TEXT));
    canvas.draw(inset, x, y);
    canvas.outline(&[(x, y), (x + INSET, y), (x + INSET, y + INSET), (x, y + INSET)], Pen::solid(RULE, 1.5));
}

fn draw_ground(canvas: &mut Canvas, record: &Record, view: &View) {
    let (left, top, width, height) = view.window();
    let (columns, rows) = ((width / SHADE_SCALE) as u32, (height / SHADE_SCALE) as u32);
    let spacing_m = view.metres_per_pixel * f64::from(SHADE_SCALE);
    if let Some(ground) = hillshade::picture(record.terrain.as_ref(), &view.frame, spacing_m, columns, rows) {
        canvas.picture(&ground, left, top, SHADE_SCALE);
    }
}

fn draw_area(canvas: &mut Canvas, view: &View, area: &Area) {
    let points = view.pixels(&area.outline);
    canvas.polygon(&points, AREA.faded(22));
    canvas.outline(&points, Pen::solid(PAPER.faded(200), 4.5));
    canvas.outline(&points, Pen::dashed(AREA, 2.4, [9.0, 5.0]));
    for hole in &area.holes {
        canvas.outline(&view.pixels(hole), Pen::dashed(AREA, 2.4, [9.0, 5.0]));
    }
}

/// Labels stand at the bottom of their area, one above the other where areas overlap; areas that lie in the same place
/// (within a few pixels) share the first one's.
fn label_areas(canvas: &mut Canvas, record: &Record, view: &View) {
    let mut taken: Vec<(f32, f32)> = Vec::new();
    let mut named: Vec<((f32, f32), f32)> = Vec::new();
    for area in &record.areas {
        let points = view.pixels(&area.outline);
        let Some((x, top)) = points.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1)) else { continue };
        let bottom = points.iter().fold(top, |y, p| y.max(p.1));
        if named.iter().any(|((nx, ny), nb)| (nx - x).abs() + (ny - top).abs() + (nb - bottom).abs() < 4.0) {
            continue;
        }
        named.push(((x, top), bottom));
        let mut y = bottom - 12.0;
        while taken.iter().any(|(tx, ty)| (tx - x).abs() < 150.0 && (ty - y).abs() < 19.0) {
            y -= 20.0;
        }
        taken.push((x, y));
        canvas.text((x, y), Anchor::Middle, &area.label, Type::bold(17.0, AREA).on(PAPER));
    }
}

fn draw_tracks(canvas: &mut Canvas, record: &Record, view: &View) {
    let planned = view.line(&record.planned);
    if record.flown.points().is_empty() {
        canvas.line(&planned, Pen::solid(PAPER.faded(190), 5.5));
        canvas.line(&planned, Pen::solid(PLANNED, 2.6));
        return;
    }
    canvas.line(&planned, Pen::solid(PLANNED.faded(150), 7.0));
    canvas.line(&view.line(&record.flown), Pen::solid(FLOWN, 1.9));
}

/// Fixes and runways within the window, on a picture of this colour. Names come last: no sign covers one.
pub(super) fn draw_places(
    canvas: &mut Canvas,
    view: &View,
    labels: &mut Labels,
    places: &[Place],
    paper: Ink,
) {
    let placed = places.iter().map(|place| (place, view.place(place.position)));
    let shown: Vec<(&Place, (f32, f32))> = placed.filter(|(_, at)| view.shows(*at)).collect();
    shown.iter().for_each(|(place, at)| draw_sign(canvas, view, place, *at));
    for (place, at) in shown {
        labels.beside(canvas, at, &place.label, Type::bold(16.0, FIX).on(paper));
    }
}

fn draw_sign(canvas: &mut Canvas, view: &View, place: &Place, (x, y): (f32, f32)) {
    match place.kind {
        PlaceKind::Fix => {
            let corners = [(x, y - 7.0), (x + 6.5, y + 4.5), (x - 6.5, y + 4.5)];
            canvas.polygon(&corners, PAPER);
            canvas.outline(&corners, Pen::solid(FIX, 1.8));
        }
        PlaceKind::Runway { heading_deg, length_m } => {
            let end = view.place(place.position.destination(heading_deg, length_m));
            canvas.line(&[(x, y), end], Pen::solid(PAPER, 11.0));
            canvas.line(&[(x, y), end], Pen::solid(RUNWAY, 7.5));
            canvas.line(&[(x, y), end], Pen::dashed(PAPER, 1.2, [6.0, 4.0]));
        }
    }
}

fn draw_time_marks(
    canvas: &mut Canvas,
    record: &Record,
    view: &View,
    labels: &mut Labels,
    elsewhere: Option<Frame>,
) {
    let track = record.main_track();
    let Some(start) = track.points().first() else { return };
    let ink = if record.flown.points().is_empty() { PLANNED } else { FLOWN };
    let mut taken: Vec<(f32, f32)> = Vec::new();
    let marks = (track.duration_s() / 60.0) as u32 / TIME_MARK_MIN;
    for minute in (1..=marks).map(|i| i * TIME_MARK_MIN) {
        let time_s = start.time_s + f64::from(minute) * 60.0;
        let (Some(before), Some(here)) = (track.at(time_s - 2.0), track.at(time_s)) else { continue };
        let ((ax, ay), (x, y)) = (view.place(before.position), view.place(here.position));
        // a pattern flown again and again would be covered with them
        if elsewhere.is_some_and(|frame| frame.contains((x, y))) {
            continue;
        }
        if taken.iter().any(|(tx, ty)| (tx - x).hypot(ty - y) < 60.0) {
            continue;
        }
        taken.push((x, y));
        let length = (x - ax).hypot(y - ay).max(0.01);
        let (dx, dy) = ((x - ax) / length, (y - ay) / length);
        arrow(canvas, (x, y), (dx, dy), ink);
        let beside = (x - dy * 26.0, y + dx * 20.0);
        // the arrow says enough where the time would cover another name
        let text = format!("{minute} min");
        labels.where_free(canvas, beside, &text, Type::plain(14.0, TEXT).on(PAPER));
    }
}

/// A small arrow head in the direction of flight.
pub(super) fn arrow(canvas: &mut Canvas, (x, y): (f32, f32), (dx, dy): (f32, f32), ink: Ink) {
    let (tip, back, half) = (9.0, 6.0, 6.0);
    let points = [
        (x + dx * tip, y + dy * tip),
        (x - dx * back - dy * half, y - dy * back + dx * half),
        (x - dx * back + dy * half, y - dy * back - dx * half),
    ];
    canvas.polygon(&points, ink);
    canvas.outline(&points, Pen::solid(PAPER, 1.2));
}

/// Numbered discs where important things happened; the panel says what they are.
fn draw_happenings(canvas: &mut Canvas, record: &Record, view: &View, elsewhere: Option<Frame>) {
    let mut taken: Vec<(f32, f32)> = Vec::new();
    for (i, happening) in record.happenings.iter().filter(|h| h.important).enumerate() {
        let Some(point) = record.main_track().at(happening.time_s) else { continue };
        let (mut x, y) = view.place(point.position);
        if !view.shows((x, y)) || elsewhere.is_some_and(|frame| frame.contains((x, y))) {
            continue;
        }
        while taken.iter().any(|(tx, ty)| (tx - x).hypot(ty - y) < 24.0) {
            x += 24.0;
        }
        taken.push((x, y));
        numbered(canvas, (x, y), i + 1);
    }
}

/// A disc with a number.
pub fn numbered(canvas: &mut Canvas, at: (f32, f32), number: usize) {
    canvas.disc(at, 12.5, PAPER);
    canvas.disc(at, 11.0, MARK);
    canvas.text(at, Anchor::Middle, &number.to_string(), Type::bold(14.0, PAPER));
}

/// A scale of round length, its left end at `(x, y)`.
pub(super) fn draw_scale(canvas: &mut Canvas, view: &View, (x, y): (f32, f32)) {
    let length_m = round_length_m(view.metres_per_pixel * 260.0);
    let length = (length_m / view.metres_per_pixel) as f32;
    canvas.rectangle(x - 14.0, y - 32.0, length + 28.0, 50.0, PAPER.faded(215));
    canvas.rectangle(x, y, length / 2.0, 6.0, TEXT);
    canvas.outline(&[(x, y), (x + length, y), (x + length, y + 6.0), (x, y + 6.0)], Pen::solid(TEXT, 1.2));
    let text = if length_m >= 1000.0 { format!("{} km", length_m / 1000.0) } else { format!("{length_m} m") };
    canvas.text((x, y - 15.0), Anchor::Left, "0", Type::plain(15.0, TEXT));
    canvas.text((x + length, y - 15.0), Anchor::Right, &text, Type::plain(15.0, TEXT));
}

/// The greatest of 1, 2, 5, 10, … not above `most`.
fn round_length_m(most: f64) -> f64 {
    let decade = 10f64.powf(most.max(1.0).log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|k| k * decade).find(|m| *m <= most).unwrap_or(decade)
}

/// A north arrow about `(x, y)`.
pub(super) fn draw_north(canvas: &mut Canvas, (x, y): (f32, f32)) {
    canvas.disc((x, y), 25.0, PAPER.faded(215));
    canvas.polygon(&[(x, y - 19.0), (x + 7.0, y + 4.0), (x, y), (x - 7.0, y + 4.0)], TEXT);
    canvas.text((x, y + 13.0), Anchor::Middle, "N", Type::bold(14.0, TEXT));
}

fn draw_header(canvas: &mut Canvas, record: &Record) {
    canvas.rectangle(0.0, 0.0, WIDTH, HEADER, PAPER);
    canvas.line(&[(0.0, HEADER), (WIDTH, HEADER)], Pen::solid(RULE, 1.5));
    canvas.text((26.0, 28.0), Anchor::Left, &record.title, Type::bold(30.0, TEXT));
    canvas.text((26.0, 57.0), Anchor::Left, &record.notes.join("  ·  "), Type::plain(16.0, QUIET));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths() {
        for (most, length) in
            [(1.0, 1.0), (4.9, 2.0), (5.0, 5.0), (999.0, 500.0), (2600.0, 2000.0), (0.0, 1.0)]
        {
            assert_eq!(round_length_m(most), length, "{most}");
        }
    }

    /// A map with these places, all in the same spot.
    fn map_with(places: &[(&str, PlaceKind)]) -> tiny_skia::Pixmap {
        let mut record = crate::report::record::tests::record();
        let position = record.planned.points()[0].position.destination(300.0, 3000.0);
        let place =
            |(label, kind): &(&str, PlaceKind)| Place { label: (*label).into(), position, kind: *kind };
        record.places = places.iter().map(place).collect();
        tiny_skia::Pixmap::decode_png(&png(&record, &Findings::default()).unwrap()).unwrap()
    }

    #[test]
    fn names_of_places_in_the_same_spot_are_both_read() {
        let runway = PlaceKind::Runway { heading_deg: 52.0, length_m: 600.0 };
        let [bare, fix, strip, both] = [("", ""), ("FIX", ""), ("", "STRIP"), ("FIX", "STRIP")]
            .map(|(fix, strip)| map_with(&[(fix, PlaceKind::Fix), (strip, runway)]));
        let written =
            |map: &tiny_skia::Pixmap| map.pixels().iter().zip(bare.pixels()).filter(|(a, b)| a != b).count();
        let (alone, together) = (written(&fix) + written(&strip), written(&both));
        assert!(alone > 500 && together > alone * 9 / 10, "{alone} {together}");
    }

    #[test]
    fn enlarged_areas_lie_in_their_frame() {
        let record = crate::report::record::tests::record();
        let points = record.planned.points().iter().map(|p| p.position);
        let map = View::around(points, (0.0, HEADER, MAP_WIDTH, MAP_HEIGHT)).unwrap();
        let corners: Vec<LatLon> = record.areas.iter().flat_map(|a| a.outline.iter().copied()).collect();
        let inset = View::around(corners.iter().copied(), (0.0, 0.0, INSET, INSET)).unwrap();
        let frame = Frame::of(&inset, &map);
        assert!(corners.iter().all(|p| frame.contains(map.place(*p))), "{frame:?}");
        assert!(!frame.contains((frame.right + 1.0, frame.top)));
    }

    #[test]
    fn everything_shown_is_inside_the_map() {
        let record = crate::report::record::tests::record();
        let points = record.planned.points().iter().chain(record.flown.points());
        let view = View::around(points.map(|p| p.position), (0.0, HEADER, MAP_WIDTH, MAP_HEIGHT)).unwrap();
        for p in record.planned.points().iter().chain(record.flown.points()) {
            let (x, y) = view.place(p.position);
            assert!((0.0..MAP_WIDTH).contains(&x) && (HEADER..HEIGHT).contains(&y));
        }
    }
}
