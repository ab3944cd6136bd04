//! The promise of a smooth window: processor time of a frame (layout, drawing and tessellation, on the window's thread) while a
//! large plan is looked at, panned, and dragged about; and how often an idle window draws at all. Each is shown beside a naive
//! painter that strokes every point of the same path, in the same run.
//!
//! A frame is egui's run, from the input to the shapes and the tree for screen readers, and their tessellation. The harness then
//! goes through that tree to find things by name, as a screen reader would in another process: with that, the mean is beside it.
//!
//! What was promised stands beside what was measured, and whether that is kept: of processor time the mean counts, of time on the
//! wall the longest. `cargo bench -p gcs-app --bench window -- [PART…] [--judge]`: with `--judge` a promise that is not kept is a
//! failure, which makes sense on a machine with nothing else to do. The parts are `legs`, `many`, `million`, `rows`, `work`,
//! `replace` and `idle`; without one, all are measured.
#![expect(clippy::expect_used, reason = "a bench ends where it can't go on")]

use egui::accesskit::Role;
use egui::epaint::ClippedShape;
use egui::{Color32, Context, FullOutput, Plugin, Pos2, RawInput, Shape, Stroke, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use gcs_app::app::App;
use gcs_app::document::Document;
use gcs_app::files::Disk;
use gcs_app::forecast::{Forecast, Passage, Point};
use gcs_app::link::Links;
use gcs_app::map::view::View;
use geometry::LatLon;
use std::fmt::Write as _;
use std::io::{Read, Write as _};
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::ThreadId;
use std::time::{Duration, Instant};
use tempfile::TempDir;
use terrain::{Flat, Terrain};
use walkers::{MapMemory, MercatorProjection, Projector, lat_lon};

const SIZE: Vec2 = vec2(1280.0, 800.0);
const FRAMES: usize = 60;
/// Whatever else is going on, milliseconds.
const LONGEST_MS: f64 = 50.0;
/// Of the largest plan.
const LEGS: usize = 10_000;
/// Legs of a flight.
const TRACKS: usize = 400;
/// Spirals of a flight.
const SPIRALS: usize = 16;

/// Measures something, and judges it.
type Part = fn(&mut Verdicts);

fn main() {
    let heads = ["mean", "longest", "promised", "in all"];
    let [mean, longest, promised, in_all] = heads.map(|head| format!("{head:>9}"));
    println!("{:<40} {mean} {longest} {promised} {:>12} {in_all}", "processor time of a frame", "naive/ours");
    let parts: [(&str, Part); 7] = [
        ("legs", |verdicts| plan_of(500, 500, 100_000, [8.0, 4.0, 4.0], verdicts)),
        ("many", |verdicts| plan_of(LEGS, 0, LEGS, [16.0; 3], verdicts)),
        ("million", million_points),
        ("rows", rows),
        ("work", at_work),
        ("replace", replaced),
        ("idle", idle),
    ];
    let mut verdicts = Verdicts::default();
    let wanted: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let unknown = wanted.iter().find(|wanted| parts.iter().all(|(name, _)| wanted != name));
    assert!(unknown.is_none(), "{unknown:?} is none of {:?}", parts.map(|(name, _)| name));
    for (name, part) in parts {
        if wanted.is_empty() || wanted.iter().any(|wanted| wanted == name) {
            part(&mut verdicts);
        }
    }
    verdicts.tell();
    if std::env::args().any(|arg| arg == "--judge") && !verdicts.missed.is_empty() {
        std::process::exit(1);
    }
}

/// Which promises are kept.
#[derive(Default)]
struct Verdicts {
    kept: usize,
    missed: Vec<String>,
}

impl Verdicts {
    /// In a word.
    fn of(&mut self, what: &str, measured: f64, promised: f64) -> &'static str {
        if measured <= promised {
            self.kept += 1;
            return "ok";
        }
        self.missed.push(format!("{what}: {measured:.1}, promised {promised:.0}"));
        "MISSED"
    }

    fn tell(&self) {
        println!("{} promises are kept, {} are not", self.kept, self.missed.len());
        self.missed.iter().for_each(|missed| println!("  MISSED: {missed}"));
    }
}

/// A window with so many track legs and spirals, that lay out at least so many waypoints: what is done to it is timed frame by
/// frame. What is promised of a drag, of panning and of looking, milliseconds.
fn plan_of(tracks: usize, spirals: usize, least: usize, promised_ms: [f64; 3], verdicts: &mut Verdicts) {
    let mut window = open(&plan(tracks, spirals));
    let forecast = &window.state().analysis().forecast;
    let (points, waypoints) = (forecast.points.len(), forecast.waypoints.len());
    assert!(waypoints >= least && forecast.cut_short.is_none(), "{waypoints}: {:?}", forecast.cut_short);
    let path: Vec<LatLon> = forecast.points.iter().map(|point| point.position).collect();
    println!("{} legs, {waypoints} waypoints, a path of {points} points", tracks + spirals);
    for (gesture, promised_ms) in ["drag a waypoint", "pan", "look"].into_iter().zip(promised_ms) {
        let before = window.state().document().version();
        let times: Vec<Frame> = match gesture {
            "drag a waypoint" => {
                let waypoint = centre(&window, "Waypoint leg2");
                drag(&mut window, waypoint)
            }
            "pan" => pan(&mut window),
            _ => (0..FRAMES).map(|_| frame(&mut window)).collect(),
        };
        let is_changed = window.state().document().version() != before;
        assert_eq!(is_changed, gesture == "drag a waypoint", "{gesture}");
        report(gesture, &times, Some(naive(&window, &path)), promised_ms, verdicts);
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

/// A path that is longer than any preview, in the window; its legs are those of a plan.
fn million_points(verdicts: &mut Verdicts) {
    const POINTS: usize = 1_000_000;
    let mut window = open(&plan(LEGS, 0));
    let shown = path(POINTS, LEGS);
    let path: Vec<LatLon> = shown.points.iter().map(|point| point.position).collect();
    window.state_mut().show_path(shown);
    window.step();
    until(&mut window, |_| true);
    let times = pan(&mut window);
    report("pan over a path of a million points", &times, Some(naive(&window, &path)), 16.0, verdicts);
}

/// A path of so many points, along the first legs of a plan.
fn path(points: usize, legs: usize) -> Forecast {
    let point = |n: usize| Point {
        time_s: n as f64,
        distance_m: n as f64 * 25.0,
        position: LatLon::new(36.3 + 1e-5 * (n % 1000) as f64, -84.2 + 1e-6 * (n / 10) as f64),
        altitude_amsl_m: 500.0,
        ground_amsl_m: Some(300.0),
        passage: n / (points / legs),
    };
    let passage = |n: usize| Passage {
        leg: format!("leg{}", n + 1).as_str().into(),
        stage: "m".into(),
        passes: Vec::new(),
        reverse: false,
        first: n * (points / legs),
        end: (n + 1) * (points / legs),
        energy_left: 1.0,
        clearance_m: None,
    };
    Forecast {
        points: (0..points).map(point).collect(),
        passages: (0..legs).map(passage).collect(),
        ..Forecast::default()
    }
}

/// Scrolls the tree and the table of a plan that has more legs than anybody looks at.
fn rows(verdicts: &mut Verdicts) {
    const ROWS: usize = 100_000;
    let mut window = open(&plan(ROWS, 0));
    let in_the_tree = centre(&window, "Main plan") + vec2(0.0, 200.0);
    report_rows("scroll the tree", &scroll(&mut window, in_the_tree), verdicts);
    window.get_by_label("Table").click();
    window.run_steps(3);
    window.state_mut().show_path(path(2 * ROWS, ROWS));
    window.step();
    until(&mut window, |_| true);
    let in_the_table = window.get_by_label("Table").rect().center() + vec2(150.0, 100.0);
    let times = scroll(&mut window, in_the_table);
    assert_eq!(window.state().analysis().forecast.passages.len(), ROWS, "another path came meanwhile");
    report_rows("scroll the table", &times, verdicts);
}

fn report_rows(what: &str, frames: &[Frame], verdicts: &mut Verdicts) {
    report(&format!("{what} of 100,000 legs"), frames, None, 16.0, verdicts);
}

/// Turns the wheel in every frame.
fn scroll(window: &mut Harness<'_, App>, at: Pos2) -> Vec<Frame> {
    window.hover_at(at);
    window.step();
    let times = (0..FRAMES).map(|_| {
        window.event(egui::Event::MouseWheel {
            unit: egui::MouseWheelUnit::Point,
            delta: vec2(0.0, -400.0),
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: egui::Modifiers::NONE,
        });
        frame(window)
    });
    times.collect()
}

/// Ground for which everybody but the window's own thread has to wait.
struct SlowGround(ThreadId);

impl Terrain for SlowGround {
    fn elevation_m(&self, _at: LatLon) -> Option<f64> {
        if std::thread::current().id() != self.0 {
            std::thread::sleep(Duration::from_micros(50));
        }
        Some(300.0)
    }
}

/// A disk with one long file, that comes a little at a time.
struct SlowDisk;

impl Disk for SlowDisk {
    fn length(&self, _path: &Path) -> std::io::Result<Option<u64>> {
        Ok(Some(60 << 20))
    }

    fn open(&self, _path: &Path) -> std::io::Result<Box<dyn Read>> {
        Ok(Box::new(SlowFile))
    }
}

struct SlowFile;

impl Read for SlowFile {
    fn read(&mut self, into: &mut [u8]) -> std::io::Result<usize> {
        std::thread::sleep(Duration::from_millis(5));
        let part = into.len().min(4096);
        into.iter_mut().take(part).for_each(|byte| *byte = b' ');
        Ok(part)
    }
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }
    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("it is read from the disk".into())
    }
}

/// A server of tiles that lets everybody wait for ten seconds: where it is asked.
fn slow_server() -> String {
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = server.local_addr().expect("its address");
    std::thread::spawn(move || {
        for mut asked in server.incoming().flatten() {
            std::thread::spawn(move || {
                std::thread::sleep(Duration::from_secs(10));
                asked.write_all(b"HTTP/1.1 404 Not Found\r\ncontent-length: 0\r\n\r\n")
            });
        }
    });
    format!("http://{address}/{{z}}/{{x}}/{{y}}.png")
}

/// Has the map shown from a server, as somebody does by hand.
fn add_server(window: &mut Harness<'_, App>, address: &str) {
    for name in ["Legwork", "Maps", "Maps and elevations…", "From a server"] {
        window.get_by_label(name).click();
        window.run_steps(3);
    }
    window.run_steps(30);
    for (hint, text) in
        [("https://server/{z}/{x}/{y}.png", address), ("Whom the map has to name", "Somebody")]
    {
        window.get_by_role_and_label(Role::TextInput, hint).focus();
        window.run_steps(2);
        window.event(egui::Event::Text(text.into()));
        window.run_steps(2);
    }
    for name in ["Add the server", "Close window"] {
        window.get_by_label(name).click();
        window.run_steps(3);
    }
}

/// Elevations of four degrees by a second of arc: a folder of 100 MB.
fn elevations() -> TempDir {
    const SIDE: usize = 3601;
    let folder = tempfile::tempdir().expect("a folder");
    let tile = 300i16.to_be_bytes().repeat(SIDE * SIDE);
    for name in ["N35W084", "N35W085", "N36W084", "N36W085"] {
        std::fs::write(folder.path().join(format!("{name}.hgt")), &tile).expect("room on the disk");
    }
    folder
}

/// While everything else is slow and at work, no frame waits for it: here the time on the wall counts.
fn at_work(verdicts: &mut Verdicts) {
    let ground = SlowGround(std::thread::current().id());
    let mut window = begin(&plan(LEGS, 0), Arc::new(ground));
    add_server(&mut window, &slow_server());
    let folder = elevations();
    window.state_mut().use_disk(Arc::new(SlowDisk));
    for dropped in [std::env::temp_dir().join("slow.xml"), folder.path().to_owned()] {
        window.input_mut().dropped_files.push(Arc::new(Dropped(dropped)));
    }
    println!(
        "with a slow disk, slow ground, a server that answers after 10 s, 100 MB of elevations that are dropped, and a preview of \
         {LEGS} legs at work, on the wall"
    );
    for gesture in ["pan", "drag a waypoint", "undo"] {
        let before = window.state().document().version();
        let times: Vec<Duration> = match gesture {
            "pan" => circled(&mut window, beside_the_plan),
            "drag a waypoint" => circled(&mut window, |window| centre(window, "Waypoint leg2")),
            _ => undone(&mut window),
        };
        assert!(!window.state().analysis().reviewed, "it is still being looked at");
        assert_eq!(window.state().document().version() != before, gesture != "pan", "{gesture}");
        let longest_ms = ms(times.iter().copied().max().unwrap_or_default());
        let verdict =
            verdicts.of(&format!("the longest frame at work, {gesture}, ms"), longest_ms, LONGEST_MS);
        println!("  {gesture:<38} {} {LONGEST_MS:>6.0} ms {verdict}", told(&times));
    }
}

/// What is there is dragged about, and let go where it was taken.
fn circled(window: &mut Harness<'_, App>, place: fn(&Harness<'_, App>) -> Pos2) -> Vec<Duration> {
    let from = place(window);
    window.hover_at(from);
    window.drag_at(from);
    let mut times: Vec<Duration> = (0..4 * FRAMES)
        .map(|i| {
            window.hover_at(from + 20.0 * Vec2::angled(i as f32 * 0.2));
            on_the_wall(window)
        })
        .collect();
    window.drop_at(from);
    times.extend((0..FRAMES).map(|_| on_the_wall(window)));
    times
}

fn undone(window: &mut Harness<'_, App>) -> Vec<Duration> {
    window.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    (0..FRAMES).map(|_| on_the_wall(window)).collect()
}

/// A plan of tens of megabytes takes the place of the one that is shown and is analysed, and that its place again: on the wall, too.
fn replaced(verdicts: &mut Verdicts) {
    const MANY: usize = 100_000;
    const SAID: &str = r#"<TF altitude="320" altitudeReference="agl" speed="21.5" name="As it was agreed upon with the owners of the
        fields below, who want to be told a day before, and with those of the wood behind" "#;
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("room on the disk");
        path
    };
    let large = plan(MANY, 0).replace("<TF ", SAID);
    println!("a plan of {MANY} legs and {} MB takes the place of another, on the wall", large.len() >> 20);
    let (large, small) = (file("large.xml", &large), file("small.xml", &plan(TRACKS, 0)));
    let mut window = open(&plan(1_000, 0));
    for (what, path) in [("until it is there, and on", large), ("and a small one its", small)] {
        let before = window.state().document().version();
        window.input_mut().dropped_files.push(Arc::new(Dropped(path)));
        let (mut times, mut own) = (Vec::new(), Duration::ZERO);
        let deadline = Instant::now() + Duration::from_secs(300);
        let mut after = 0;
        while after < 2 * FRAMES {
            assert!(Instant::now() < deadline, "it was not opened");
            own = own.max(processor_time(|| times.push(on_the_wall(&mut window))));
            let (version, analysed) =
                (window.state().document().version(), window.state().analysis().version);
            after += usize::from(version != before && version == analysed);
        }
        let longest_ms = ms(times.iter().copied().max().unwrap_or_default());
        let verdict = verdicts.of(&format!("the longest frame {what}, ms"), longest_ms, LONGEST_MS);
        println!(
            "  {what:<38} {} {LONGEST_MS:>6.0} ms {verdict}, {:.2} ms of its own time",
            told(&times),
            ms(own)
        );
    }
}

fn on_the_wall(window: &mut Harness<'_, App>) -> Duration {
    let begun = Instant::now();
    window.step();
    tessellated(window);
    begun.elapsed()
}

/// An idle window draws nothing: nobody asks for another frame, but the clock for one at each full minute.
fn idle(verdicts: &mut Verdicts) {
    let mut window = open(&plan(1_000, 0));
    // until then it is at work, and shows that
    until(&mut window, |app| app.analysis().reviewed);
    window.state_mut().tell_time_by(|| jiff::Timestamp::constant(1_790_000_000, 0));
    window.run_steps(30);
    let asked = (0..120)
        .filter(|_| {
            window.step();
            let viewport = window.output().viewport_output.values().next();
            viewport.is_some_and(|viewport| viewport.repaint_delay < Duration::from_secs(30))
        })
        .count();
    let verdict = verdicts.of("frames of an idle window", asked as f64, 0.0);
    println!("frames asked for by an idle window, of 120: {asked} (promised: 0) {verdict}");
}

fn open(text: &str) -> Harness<'static, App> {
    let mut window = begin(text, Arc::new(Flat(300.0)));
    until(&mut window, |app| app.analysis().version == app.document().version());
    window
}

/// Draws until something is found out, and on until all of it is drawn.
fn until(window: &mut Harness<'_, App>, is_so: impl Fn(&App) -> bool) {
    let deadline = Instant::now() + Duration::from_secs(300);
    while !is_so(window.state()) || window.state().is_busy() {
        assert!(Instant::now() < deadline, "the plan was not analysed");
        window.step();
        std::thread::sleep(Duration::from_millis(5));
        if is_so(window.state()) {
            window.run_steps(5);
        }
    }
}

/// The window as it opens, before anything was found out about its plan.
fn begin(text: &str, ground: Arc<dyn Terrain>) -> Harness<'static, App> {
    let document = Document::read(text.as_bytes(), None);
    let (links, far) = Links::pair();
    // nobody answers
    std::mem::forget(far);
    let window = Harness::builder()
        .with_size(SIZE)
        .with_step_dt(1.0 / 60.0)
        .build_eframe(move |creation| App::new(creation, document, links, ground).expect("no threads"));
    window.ctx.add_plugin(Meter::default());
    window
}

/// What this thread had used when egui's run began, and when it ended.
#[derive(Default)]
struct Meter {
    begun: Option<Duration>,
    ended: Option<Duration>,
}

impl Plugin for Meter {
    fn debug_name(&self) -> &'static str {
        "meter"
    }
    fn input_hook(&mut self, _ctx: &Context, _input: &mut RawInput) {
        self.begun = used();
    }
    fn output_hook(&mut self, _ctx: &Context, _output: &mut FullOutput) {
        self.ended = used();
    }
}

fn centre(window: &Harness<'_, App>, name: &str) -> Pos2 {
    window.get_all_by_label(name).next().expect(name).rect().center()
}

/// A place of the map with nothing to be grabbed: the plan is higher than wide.
fn beside_the_plan(window: &Harness<'_, App>) -> Pos2 {
    window.get_all_by_label("Map").next().expect("the map").rect().right_center() - vec2(40.0, 0.0)
}

fn pan(window: &mut Harness<'_, App>) -> Vec<Frame> {
    let from = beside_the_plan(window);
    drag(window, from)
}

/// Presses what is there, and moves it a little in every frame.
fn drag(window: &mut Harness<'_, App>, from: Pos2) -> Vec<Frame> {
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

/// What a frame took.
#[derive(Clone, Copy)]
struct Frame {
    /// Run and tessellation.
    window: Duration,
    /// And the harness with its tree.
    in_all: Duration,
}

fn frame(window: &mut Harness<'_, App>) -> Frame {
    let step = processor_time(|| window.step());
    let run = window.ctx.with_plugin(|meter: &mut Meter| Some(meter.ended?.saturating_sub(meter.begun?)));
    let tessellated = tessellated(window);
    Frame { window: run.flatten().unwrap_or(step) + tessellated, in_all: step + tessellated }
}

/// A window hands its shapes over; only the harness keeps them, so they are copied outside the measured time.
fn tessellated(window: &Harness<'_, App>) -> Duration {
    let output = window.output();
    let (shapes, scale) = (output.shapes.clone(), output.pixels_per_point);
    processor_time(|| drop(std::hint::black_box(window.ctx.tessellate(shapes, scale))))
}

fn report(what: &str, frames: &[Frame], naive: Option<Duration>, promised_ms: f64, verdicts: &mut Verdicts) {
    let times: Vec<Duration> = frames.iter().map(|frame| frame.window).collect();
    let ours = mean(times.iter().copied());
    let ratio =
        naive.map_or_else(String::new, |naive| format!("{:.2}x", naive.as_secs_f64() / ours.as_secs_f64()));
    let verdict = verdicts.of(&format!("{what}, ms"), ms(ours), promised_ms);
    let in_all = ms(mean(frames.iter().map(|frame| frame.in_all)));
    println!("  {what:<38} {} {promised_ms:>6.0} ms {ratio:>12} {in_all:>6.2} ms {verdict}", told(&times));
}

/// The mean and the longest of frames.
fn told(times: &[Duration]) -> String {
    let longest = times.iter().copied().max().unwrap_or_default();
    format!("{:>6.2} ms {:>6.2} ms", ms(mean(times.iter().copied())), ms(longest))
}

fn ms(time: Duration) -> f64 {
    time.as_secs_f64() * 1e3
}

/// The kernel counts in ticks of milliseconds: one frame says little, all of them together do.
fn mean(times: impl ExactSizeIterator<Item = Duration>) -> Duration {
    let count = u32::try_from(times.len()).unwrap_or(1);
    times.sum::<Duration>() / count
}

/// What this thread has used; the wall clock where the system doesn't tell.
fn processor_time(work: impl FnOnce()) -> Duration {
    let (before, begun) = (used(), Instant::now());
    work();
    used().zip(before).map_or_else(|| begun.elapsed(), |(after, before)| after.saturating_sub(before))
}

/// By this thread since it began, if the system tells.
fn used() -> Option<Duration> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    text.split_whitespace().next()?.parse().ok().map(Duration::from_nanos)
}

fn view(zoom: f64) -> View {
    let mut memory = MapMemory::default();
    memory.set_zoom(zoom).expect("within the map's range");
    let rect = egui::Rect::from_min_size(pos2(0.0, 0.0), SIZE);
    View::of(&Projector::new(rect, &MercatorProjection, &memory, lat_lon(36.305, -84.15)))
}

/// Track legs forth and back, and spirals of some two hundred waypoints each: as much as somebody draws for a season, in flights
/// that a battery lasts for.
fn plan(tracks: usize, spirals: usize) -> String {
    let mut text = String::from(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="bench" aircraft="trainer">
        <runways><runway id="R" lat="36.3" lon="-84.2" elevation="300" heading="90" length="600" priority="1"/></runways>
        <mainPlan>"#,
    );
    let tracks: Vec<String> = (1..=tracks).map(track).collect();
    let spirals: Vec<String> = (1..=spirals).map(spiral).collect();
    for (flight, legs) in tracks.chunks(TRACKS).chain(spirals.chunks(SPIRALS)).enumerate() {
        let legs = legs.concat();
        let _ = write!(
            text,
            r#"<stage id="to{flight}" type="take-off" runway="R" altitude="100" altitudeReference="agl"/>
            <stage id="m{flight}" type="mission" altitude="250" altitudeReference="agl">{legs}</stage>
            <stage id="land{flight}" type="land" runway="R" turnaroundEnergy="1" turnaroundTime="1800"/>"#
        );
    }
    text + "</mainPlan></flightPlan>"
}

fn track(leg: usize) -> String {
    let (row, column) = (leg / 40, leg % 40);
    let column = if row % 2 == 0 { column } else { 39 - column };
    let (lat, lon) = (36.31 + 0.001 * row as f64, -84.19 + 0.003 * column as f64);
    format!(r#"<TF id="leg{leg}" lat="{lat:.5}" lon="{lon:.5}"/>"#)
}

fn spiral(leg: usize) -> String {
    let (row, column) = (leg / 25, leg % 25);
    let (lat, lon) = (36.28 - 0.012 * row as f64, -84.35 + 0.012 * column as f64);
    let size = r#"innerRadius="180" outerRadius="250" spacing="20""#;
    format!(r#"<spiral id="s{leg}" {size}><centre lat="{lat:.5}" lon="{lon:.5}"/></spiral>"#)
}
