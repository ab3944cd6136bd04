//! The promise of a smooth window: processor time of a frame (layout, drawing and tessellation, on the window's thread) while a
//! large plan is looked at, panned, and dragged about; and how often an idle window draws at all. Each is shown beside a naive
//! painter that strokes every point of the same path, in the same run.
#![expect(clippy::expect_used, reason = "a bench ends where it can't go on")]

use egui::epaint::ClippedShape;
use egui::{Color32, Pos2, Shape, Stroke, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gcs_app::app::App;
use gcs_app::document::Document;
use gcs_app::link::Links;
use gcs_app::map::polyline::Cached;
use gcs_app::map::view::{Mercator, View};
use geometry::LatLon;
use std::fmt::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrain::Flat;
use walkers::{MapMemory, MercatorProjection, Projector, lat_lon};

const SIZE: Vec2 = vec2(1280.0, 800.0);
const FRAMES: usize = 60;

fn main() {
    println!("{:<44} {:>9} {:>9} {:>12}", "processor time of a frame", "mean", "promised", "naive/ours");
    plan_of(500, 500, [8.0, 4.0, 4.0]);
    plan_of(10_000, 1, [16.0; 3]);
    million_points();
    idle();
}

/// A window with so many track legs and dense scans: what is done to it is timed frame by frame. What is promised of a drag,
/// of panning and of looking, milliseconds.
fn plan_of(tracks: usize, scans: usize, promised_ms: [f64; 3]) {
    let mut window = open(&plan(tracks, scans));
    let forecast = &window.state().analysis().forecast;
    let (points, waypoints) = (forecast.points.len(), forecast.waypoints.len());
    let path: Vec<LatLon> = forecast.points.iter().map(|point| point.position).collect();
    println!("{} legs, {waypoints} waypoints, a path of {points} points", tracks + scans);
    for (gesture, promised_ms) in ["drag a waypoint", "pan", "look"].into_iter().zip(promised_ms) {
        let times: Vec<Duration> = match gesture {
            "drag a waypoint" => drag(&mut window, "Waypoint leg2"),
            "pan" => drag(&mut window, "Map"),
            _ => (0..FRAMES).map(|_| frame(&mut window)).collect(),
        };
        report(gesture, times.into_iter(), naive(&window, &path), promised_ms);
    }
}

/// A frame that strokes every point of a path, and nothing else.
fn naive(window: &Harness<'_, App>, path: &[LatLon]) -> Duration {
    let view = view(11.0);
    mean((0..20).map(|_| {
        processor_time(|| {
            let line: Vec<Pos2> = path.iter().map(|at| view.place(*at)).collect();
            let shape = Shape::line(line, Stroke::new(2.0, Color32::WHITE));
            std::hint::black_box(window.ctx.tessellate(vec![clipped(shape, &view)], 1.0));
        })
    }))
}

fn clipped(shape: Shape, view: &View) -> ClippedShape {
    ClippedShape {
        clip_rect: view.rect,
        shape,
        transform_after_tessellation: egui::emath::TSTransform::IDENTITY,
    }
}

/// A path that is longer than any preview: as the map's layer draws it, in a view that moves.
fn million_points() {
    let line: Vec<Mercator> = (0..1_000_000)
        .map(|i| LatLon::new(36.3 + 1e-5 * f64::from(i % 1000), -84.2 + 1e-6 * f64::from(i / 10)).into())
        .collect();
    let ctx = egui::Context::default();
    let stroke = |parts: &[Vec<Pos2>], view: &View| {
        let line = |part: &Vec<Pos2>| Shape::line(part.clone(), Stroke::new(2.0, Color32::WHITE));
        let shapes = parts.iter().map(line).map(|shape| clipped(shape, view));
        std::hint::black_box(ctx.tessellate(shapes.collect(), 1.0));
    };
    // the fonts are loaded in the first frame
    ctx.run_ui(egui::RawInput::default(), |_| {}).textures_delta.clear();
    let mut cached = Cached::default();
    let times = (0..FRAMES).map(|i| {
        let view = view(10.0 + i as f64 * 1e-3);
        processor_time(|| stroke(cached.parts(|| line.clone(), 1, &view), &view))
    });
    let times: Vec<Duration> = times.collect();
    let all = view(10.0);
    let naive = processor_time(|| stroke(&[line.iter().map(|m| all.screen(*m)).collect()], &all));
    let times = times.into_iter();
    report("a million points, in a view that moves", times, naive, 16.0);
}

/// An idle window draws nothing: nobody asks for another frame, but the clock for one at each full minute.
fn idle() {
    let mut window = open(&plan(1_000, 1));
    window.run_steps(30);
    let asked = (0..120)
        .filter(|_| {
            window.step();
            let viewport = window.output().viewport_output.values().next();
            viewport.is_some_and(|viewport| viewport.repaint_delay < Duration::from_millis(100))
        })
        .count();
    println!("frames asked for by an idle window, of 120: {asked}");
}

fn open(text: &str) -> Harness<'static, App> {
    let document = Document::read(text.as_bytes(), None);
    let (links, far) = Links::pair();
    // nobody answers
    std::mem::forget(far);
    let mut window =
        Harness::builder().with_size(SIZE).with_step_dt(1.0 / 60.0).build_eframe(move |creation| {
            App::new(creation, document, links, Arc::new(Flat(300.0))).expect("no threads")
        });
    let deadline = Instant::now() + Duration::from_secs(300);
    while window.state().analysis().version != window.state().document().version() {
        assert!(Instant::now() < deadline, "the plan was not analysed");
        window.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    window.run_steps(5);
    window
}

/// Presses what has this name, and moves it a little in every frame.
fn drag(window: &mut Harness<'_, App>, name: &str) -> Vec<Duration> {
    let from = window.get_all_by_label(name).next().expect(name).rect().center();
    window.hover_at(from);
    window.drag_at(from);
    window.step();
    let times = (0..FRAMES).map(|i| {
        let angle = i as f32 * 0.2;
        window.hover_at(from + 20.0 * vec2(angle.cos(), angle.sin()));
        frame(window)
    });
    let times = times.collect();
    window.drop_at(from);
    window.run_steps(5);
    times
}

fn frame(window: &mut Harness<'_, App>) -> Duration {
    processor_time(|| {
        window.step();
        let output = window.output();
        std::hint::black_box(window.ctx.tessellate(output.shapes.clone(), output.pixels_per_point));
    })
}

fn report(what: &str, times: impl ExactSizeIterator<Item = Duration>, naive: Duration, promised_ms: f64) {
    let ours = mean(times);
    let ratio = naive.as_secs_f64() / ours.as_secs_f64();
    println!("  {what:<42} {:>6.2} ms {promised_ms:>6.0} ms {ratio:>11.2}x", ours.as_secs_f64() * 1e3);
}

/// The kernel counts in ticks of milliseconds: one frame says little, all of them together do.
fn mean(times: impl ExactSizeIterator<Item = Duration>) -> Duration {
    let count = u32::try_from(times.len()).unwrap_or(1);
    times.sum::<Duration>() / count
}

/// What this thread has used; the wall clock where the system doesn't tell.
fn processor_time(work: impl FnOnce()) -> Duration {
    let used = || {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
    };
    let (before, begun) = (used(), Instant::now());
    work();
    used().zip(before).map_or_else(|| begun.elapsed(), |(after, before)| after.saturating_sub(before))
}

fn view(zoom: f64) -> View {
    let mut memory = MapMemory::default();
    memory.set_zoom(zoom).expect("within the map's range");
    let rect = egui::Rect::from_min_size(pos2(0.0, 0.0), SIZE);
    View::of(&Projector::new(rect, &MercatorProjection, &memory, lat_lon(36.305, -84.15)))
}

/// Track legs forth and back, and dense scans of some two hundred waypoints: what one can draw in a long day.
fn plan(tracks: usize, scans: usize) -> String {
    let mut text = String::from(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="bench" aircraft="trainer">
        <runways><runway id="R" lat="36.3" lon="-84.2" elevation="300" heading="90" length="600" priority="1"/></runways>
        <mainPlan><stage id="to" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
        <stage id="m" type="mission" altitude="250" altitudeReference="agl">"#,
    );
    for leg in 1..=tracks {
        let (row, column) = (leg / 40, leg % 40);
        let column = if row % 2 == 0 { column } else { 39 - column };
        let (lat, lon) = (36.31 + 0.004 * row as f64 / 4.0, -84.19 + 0.003 * column as f64);
        let _ = write!(text, r#"<TF id="leg{leg}" lat="{lat:.5}" lon="{lon:.5}"/>"#);
    }
    for scan in 1..=scans {
        let (lat, lon) = (36.25 - 0.02 * (scan / 25) as f64, -84.40 + 0.02 * (scan % 25) as f64);
        let area = format!(r#"<area lat="{lat:.5}" lon="{lon:.5}" radius="1000"/>"#);
        let _ = write!(text, r#"<scan id="s{scan}" spacing="20" heading="0">{area}</scan>"#);
    }
    text + r#"</stage><stage id="land" type="land" runway="R"/></mainPlan></flightPlan>"#
}
