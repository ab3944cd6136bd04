//! Window, agent and simulated autopilot in one process, talking as they always do (MAVLink and Zenoh over the loopback): what is
//! done in the window is flown. Time goes on only when the test says so, however long the window takes.
//!
//! They are together here, and not beside the other system tests, because the demo has them together already, and because only
//! this test has the window's hands.

use super::{PATIENCE, SQUARE, Window};
use egui::accesskit::Role;
use egui::vec2;
use egui_kittest::kittest::Queryable;
use flight_plan::FlightPlan;
use gcs_app::assets;
use gcs_app::demo::components::{Components, Setup, VEHICLE};
use gcs_app::link::Links;
use std::sync::Arc;
use std::time::Instant;
use tempfile::TempDir;
use tokio::runtime::Runtime;
use usal::contract::{Branching, Cause, FpManagerEvent, PlanEvent};
use usal::topics::fp_manager;
use usal::{Config, EventSubscriber, Occurrence, Participant, Session, Start};

/// Longer than this nothing is waited for, simulated seconds.
const LIMIT_S: f64 = 600.0;
/// What the window shows is never older, simulated seconds: a machine that is busy elsewhere would have it look at the past.
const BEHIND_S: f64 = 1.0;
/// Ticks of the simulated clock between two frames.
const TICKS_A_FRAME: usize = 10;

/// A vehicle on the runway of a plan, and a window beside it.
struct Field {
    window: Window,
    events: EventSubscriber<FpManagerEvent>,
    heard: Vec<PlanEvent>,
    clock: Participant,
    // in this order: all of the above is theirs
    _session: Session,
    components: Option<Components>,
    runtime: Runtime,
    _recordings: TempDir,
}

impl Field {
    fn new() -> Self {
        let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build().unwrap();
        let recordings = tempfile::tempdir().unwrap();
        let plan = flight_plan::read(SQUARE).plan;
        let components = {
            let _inside = runtime.enter();
            Components::start(&setup(&plan, &recordings)).unwrap()
        };
        let as_test = Config::client(VEHICLE, &components.endpoint).named("test");
        let session = runtime.block_on(Session::open(as_test)).unwrap();
        let (events, clock) = {
            let _inside = runtime.enter();
            let events = session.listen(fp_manager::EVENTS, Start::Remembered).unwrap();
            (events, Participant::join(&session, "test").unwrap())
        };
        let window = window(&components.endpoint);
        Self {
            window,
            events,
            heard: Vec::new(),
            clock,
            _session: session,
            components: Some(components),
            runtime,
            _recordings: recordings,
        }
    }

    /// Lets time go on, and draws, until something is so.
    fn until(&mut self, what: &str, is_so: impl Fn(&Window, &[PlanEvent]) -> bool) {
        let mut ends_s = None;
        for count in 0.. {
            let tick =
                self.runtime.block_on(async { tokio::time::timeout(PATIENCE, self.clock.next()).await });
            let tick =
                tick.unwrap_or_else(|_| panic!("time stands still: {what}")).expect("the session is open");
            self.listen();
            if count % TICKS_A_FRAME == 0 {
                self.window.held_frame();
                self.keep_up(tick.time_s);
                if is_so(&self.window, &self.heard) {
                    self.clock.acknowledge(tick);
                    return self.window.steps(2);
                }
            }
            self.clock.acknowledge(tick);
            let late = tick.time_s > *ends_s.get_or_insert(tick.time_s + LIMIT_S);
            assert!(!late, "not within {LIMIT_S} s: {what}; heard: {:#?}", self.heard);
        }
    }

    fn until_shown(&mut self, words: &str) {
        self.until(words, |window, _| window.shows(words));
    }

    fn until_leg(&mut self, plan: Branching, leg: &str) {
        self.until(leg, |_, heard| entered(heard).last() == Some(&(plan.clone(), leg.to_owned())));
    }

    /// Draws until the window has heard where the aircraft was just now, if it ever heard that.
    fn keep_up(&mut self, now_s: f64) {
        let deadline = Instant::now() + PATIENCE;
        let is_behind = |window: &Window| {
            window
                .app()
                .vehicle()
                .position
                .as_ref()
                .is_some_and(|position| position.time_s < now_s - BEHIND_S)
        };
        while is_behind(&self.window) {
            assert!(Instant::now() < deadline, "the window hears nothing");
            self.window.wait();
        }
    }

    fn listen(&mut self) {
        while let Some(occurrence) = self.events.try_recv() {
            if let Occurrence::Event { event, .. } = occurrence {
                self.heard.push(event.value);
            }
        }
    }

    /// Commits the plan that is open.
    fn push(&mut self) {
        self.window.click("Push");
        self.until_shown("Commit");
        self.window.click("Commit");
        let hash = flight_plan::hash(&self.window.plan());
        self.until("the plan is active", |_, heard| activated(heard).last() == Some(&hash));
    }

    /// Connects, commits the plan, and takes off.
    fn take_off(&mut self) {
        self.until("ready", |window, _| {
            window.app().vehicle().position.is_some() && window.is_enabled("Push")
        });
        self.push();
        // before it has heard that this plan is aboard, it would start another one
        self.until_shown("Start and take off (hold)");
        self.window.hold("Start and take off (hold)", 80);
        self.until_leg(Branching::Main, "side2");
    }
}

impl Drop for Field {
    fn drop(&mut self) {
        self.components.take().into_iter().for_each(|components| self.runtime.block_on(components.stop()));
    }
}

fn setup<'a>(plan: &'a FlightPlan, recordings: &'a TempDir) -> Setup<'a> {
    Setup {
        home: &plan.runways[0],
        profile: aircraft::Profile::by_name(&plan.aircraft).unwrap(),
        wind: aircraft::Wind::CALM,
        autopilot: sim::Personality::ArduPlane,
        speed: 0.0,
        terrain: assets::demo_terrain(),
        recordings: recordings.path(),
    }
}

/// A window that was told where the gateway is.
fn window(endpoint: &str) -> Window {
    let (_, nobody) = Links::pair();
    let links = Links::spawn(Arc::new(|| ())).unwrap();
    let size = vec2(1280.0, 1000.0);
    let mut window =
        Window::open_linked(SQUARE, size, None, assets::demo_terrain(), 1.0 / 60.0, (links, nobody));
    window.until_analysed();
    window.click("○ Connect");
    let fields = window.harness.get_all_by_role(Role::TextInput).map(|field| field.rect().center());
    let [address, vehicle] = fields.take(2).collect::<Vec<_>>()[..] else { panic!("no form") };
    for (at, text) in [(address, endpoint), (vehicle, VEHICLE)] {
        window.click_at(at);
        window.press_ctrl(egui::Key::A);
        window.harness.event(egui::Event::Text(text.into()));
        window.steps(2);
    }
    window.click("Connect");
    window
}

fn activated(heard: &[PlanEvent]) -> Vec<String> {
    let hashes = heard.iter().filter_map(|event| match event {
        PlanEvent::PlanActivated { hash, .. } => Some(hash.to_string()),
        _ => None,
    });
    hashes.collect()
}

fn entered(heard: &[PlanEvent]) -> Vec<(Branching, String)> {
    let legs = heard.iter().filter_map(|event| match event {
        PlanEvent::LegEntered { place } => Some((place.plan.clone(), place.leg.to_string())),
        _ => None,
    });
    legs.collect()
}

#[test]
fn a_leg_that_is_moved_in_flight_and_pushed_is_flown() {
    let mut field = Field::new();
    field.take_off();
    let at = field.window.centre("Fix C");
    field.window.drag(at, vec2(40.0, 40.0));
    field.window.until_analysed();
    field.push();
    assert_eq!(activated(&field.heard).len(), 2);
    field.until_leg(Branching::Main, "side4");
    let moved = field.window.plan().fix(&"C".into()).unwrap().position;
    let position = field.window.app().vehicle().position.as_ref().unwrap().value.position;
    assert!(position.distance_m(moved) < 200.0, "it turned at {position:?}, the fix is at {moved:?}");
}

#[test]
fn the_landing_is_gone_to_at_once() {
    let mut field = Field::new();
    field.take_off();
    field.window.ask_for("land now");
    field.window.click("Flight Land now on R05: go to the landing…");
    field.until_shown("energy left");
    field.window.hold("Go to Landing (hold)", 80);
    field.until_leg(Branching::Main, "land");
    assert!(!entered(&field.heard).iter().any(|(_, leg)| leg == "side3"), "from where it was");
}

#[test]
fn an_emergency_is_flown_and_the_way_back_is_taken() {
    let mut field = Field::new();
    field.take_off();
    field.until_shown("Emergency: fly return (hold)");
    field.window.hold("Emergency: fly return (hold)", 80);
    let emergency = Branching::Emergency("return".into());
    field.until_leg(emergency.clone(), "r1");
    let started = PlanEvent::EmergencyStarted {
        cause: Cause::Operator,
        plan: "return".into(),
        from_leg: Some("side2".into()),
    };
    assert!(field.heard.contains(&started), "{:#?}", field.heard);
    field.until_shown("EMERGENCY: flying return");
    // where it was raised comes as an event, beside the status that the banner comes of
    field.until_shown("Return to the main plan at side2");
    field.window.click("Return to the main plan at side2");
    // what would follow is looked at first
    field.until_shown("Flies next: side");
    field.window.hold("Return to the main plan at side2 (hold)", 80);
    field.until("it is back", |_, heard| {
        entered(heard).last().is_some_and(|(plan, _)| *plan == Branching::Main)
    });
    assert!(entered(&field.heard).contains(&(emergency, "r1".into())));
    field.until("the banner is gone", |window, _| !window.shows("EMERGENCY"));
}
