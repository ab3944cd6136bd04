//! The thread around the core: it owns the link and the clock.
//!
//! Pace: with a lockstep partner, a step is taken when the partner has answered the question before it; without
//! one, in real time times `speed`. A partner is the first that answers; it is lost after eight silent
//! seconds and found again when it answers.

use crate::config::{Config, Control};
use crate::core::mode::Mode;
use crate::core::{Peer, STEP_NS, Simulator};
use crate::frame::{self, Decoder, Frame};
use crate::link::Bound;
use crate::turns::Turns;
use aircraft::air::MOST_DEVIATION_C;
use anyhow::Context;
use autopilot_link::{Event, Link};
use geometry::LatLon;
use std::collections::VecDeque;
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::Instant;

/// Points of the track log kept when nobody fetches them.
const MAX_TRACK_POINTS: usize = 100_000;
/// A lockstep question not answered for this long is asked again.
const ASK_AGAIN: Duration = Duration::from_secs(1);
/// And after this long it is given up: longer than the partner itself waits for those behind it (5 s), so that
/// one of them dying does not end the lockstep.
const GIVE_UP: Duration = Duration::from_secs(8);

/// Where the aircraft really is, and how the simulator does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Truth {
    /// Simulated time, s.
    pub time_s: f64,
    /// Where.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Direction over the ground, degrees true.
    pub track_deg: f64,
    /// Over the ground, m/s.
    pub ground_speed_mps: f64,
    /// Through the air, m/s.
    pub airspeed_mps: f64,
    /// Share of the energy left, 0..1.
    pub battery: f64,
    /// On the ground.
    pub on_ground: bool,
    /// Armed.
    pub armed: bool,
    /// Flight mode.
    pub mode: Mode,
    /// Current mission item.
    pub mission_item: u16,
    /// A lockstep partner sets the pace.
    pub lockstep: bool,
    /// Bytes on the link that were no frames.
    pub ignored_bytes: u64,
}

/// A point of the track log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrackPoint {
    /// Simulated time, s.
    pub time_s: f64,
    /// Where it really was.
    pub position: LatLon,
    /// Metres AMSL.
    pub altitude_amsl_m: f64,
    /// Current mission item.
    pub mission_item: u16,
    /// Off its line, metres, positive to the right, as the autopilot sees it.
    pub cross_track_m: f64,
}

#[derive(Debug)]
struct Shared {
    truth: Truth,
    track: VecDeque<TrackPoint>,
}

/// A running simulator; stops when dropped.
#[derive(Debug)]
pub struct Handle {
    address: SocketAddr,
    shared: Arc<Mutex<Shared>>,
    controls: mpsc::Sender<Control>,
    thread: Option<JoinHandle<()>>,
}

impl Handle {
    /// Where it listens (or, with [`crate::Link::UdpOut`], sends from).
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Where the aircraft really is.
    pub fn truth(&self) -> Truth {
        lock(&self.shared).truth
    }

    /// The track log since the last call; the oldest points are dropped beyond 100,000.
    pub fn take_track(&self) -> Vec<TrackPoint> {
        lock(&self.shared).track.drain(..).collect()
    }

    /// Asks for something; false if it is over or too much is waiting.
    pub fn control(&self, control: Control) -> bool {
        self.controls.try_send(control).is_ok()
    }

    /// For controlling it from elsewhere.
    pub fn controls(&self) -> mpsc::Sender<Control> {
        self.controls.clone()
    }

    /// It has ended.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for its end.
    pub fn join(mut self) {
        self.wait();
    }

    /// Ends it.
    pub fn stop(self) {
        drop(self);
    }

    fn wait(&mut self) {
        if let Some(thread) = self.thread.take() {
            // a panic of the thread has been printed; there is nothing to add
            let _ = thread.join();
        }
    }
}

impl Drop for Handle {
    fn drop(&mut self) {
        if self.thread.is_some() {
            // full: the thread is busy and gets it when the channel closes
            let _ = self.controls.try_send(Control::Stop);
            let (closed, _) = mpsc::channel(1);
            self.controls = closed;
            self.wait();
        }
    }
}

fn lock(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts a simulator on a thread of its own.
///
/// # Errors
/// The address can't be had, the speed or the profile makes no sense, or no thread can be started.
pub fn spawn(config: Config) -> anyhow::Result<Handle> {
    anyhow::ensure!(
        config.speed.is_finite() && config.speed >= 0.0,
        "speed must be 0 or a positive number, not {}",
        config.speed
    );
    anyhow::ensure!(
        config.isa_deviation_c.abs() <= MOST_DEVIATION_C,
        "no air is {} °C beside the standard's: it may be {MOST_DEVIATION_C} warmer or colder",
        config.isa_deviation_c
    );
    config.profile.validate()?;
    let bound = Bound::bind(config.link)?;
    let address = bound.address()?;
    let mut simulator =
        Simulator::of(config.personality, config.profile.clone(), config.home, config.wind, config.seed);
    simulator.autopilot.set_isa_deviation_c(config.isa_deviation_c);
    for (name, value) in &config.params {
        let params = &mut simulator.autopilot.params;
        anyhow::ensure!(
            params.set(name, *value),
            "{name} can't be set to {value}: {} has no such parameter to be set, or not to that value",
            config.personality
        );
    }
    for fault in &config.faults {
        anyhow::ensure!(simulator.inject(*fault), "too many faults: ask for 64 at most");
    }
    let shared = Arc::new(Mutex::new(Shared { truth: truth(&simulator, false, 0), track: VecDeque::new() }));
    let (controls, inbox) = mpsc::channel(64);
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let for_thread = Arc::clone(&shared);
    let thread = std::thread::Builder::new()
        .name("legwork-sim".into())
        .spawn(move || {
            let run = async {
                let link = bound.open()?;
                let runner = Runner::new(config, simulator, link, inbox, for_thread);
                runner.run().await;
                anyhow::Ok(())
            };
            if let Err(error) = runtime.block_on(run) {
                tracing::error!("the simulator stopped: {error:#}");
            }
        })
        .context("can't start the simulator's thread")?;
    Ok(Handle { address, shared, controls, thread: Some(thread) })
}

fn truth(simulator: &Simulator, lockstep: bool, ignored_bytes: u64) -> Truth {
    let a = &simulator.autopilot;
    let s = a.aircraft.state();
    Truth {
        time_s: simulator.now_ns() as f64 / 1e9,
        position: s.position,
        altitude_amsl_m: s.altitude_amsl_m,
        track_deg: s.track_deg(),
        ground_speed_mps: s.ground_speed_mps(),
        airspeed_mps: s.airspeed_mps,
        battery: a.aircraft.battery().share(),
        on_ground: s.on_ground,
        armed: a.is_armed(),
        mode: a.mode(),
        mission_item: a.run.current,
        lockstep,
        ignored_bytes,
    }
}

/// Simulated seconds per second, where nobody drives time.
fn pace(speed: f64) -> f64 {
    if speed > 0.0 { speed } else { 1.0 }
}

struct Runner {
    config: Config,
    simulator: Simulator,
    link: Link,
    decoder: Decoder,
    /// What came last over the link.
    received: Vec<u8>,
    /// Its main loop; `None`: what comes is read at once.
    turns: Option<Turns>,
    /// What came since the last turn, and when the next one is.
    unread: Vec<(Peer, Frame)>,
    reads_at: Option<Instant>,
    controls: mpsc::Receiver<Control>,
    shared: Arc<Mutex<Shared>>,
    partner: Option<Peer>,
    answered: bool,
    next_wall: Instant,
    next_track_s: f64,
}

impl Runner {
    fn new(
        config: Config,
        mut simulator: Simulator,
        link: Link,
        controls: mpsc::Receiver<Control>,
        shared: Arc<Mutex<Shared>>,
    ) -> Self {
        for peer in link.peers() {
            simulator.connect(peer);
        }
        let now = Instant::now();
        // in lockstep everything that comes between two steps is done between them
        let turn = if config.lockstep { Duration::ZERO } else { simulator.turn() };
        Self {
            turns: Turns::new(now, turn.div_f64(pace(config.speed))),
            unread: Vec::new(),
            reads_at: None,
            config,
            simulator,
            link,
            decoder: Decoder::default(),
            received: Vec::new(),
            controls,
            shared,
            partner: None,
            answered: false,
            next_wall: now,
            next_track_s: 0.0,
        }
    }

    async fn run(mut self) {
        loop {
            self.simulator.step();
            self.answered = false;
            self.tell_time();
            self.publish();
            self.plan_next_step();
            if !self.wait_for_leave().await {
                return;
            }
        }
    }

    /// Sends what waits, and in lockstep the question that says how late it is. Who comes hears that first: to a partner whose clock
    /// still stands at zero, all that it was told before would seem to be as old as the simulation.
    fn tell_time(&mut self) {
        if self.config.lockstep {
            self.simulator.ask_time();
        }
        self.flush();
    }

    fn flush(&mut self) {
        for frame in self.simulator.take_outgoing() {
            self.link.send(frame.to, &frame.bytes);
        }
        self.link.flush();
    }

    fn publish(&mut self) {
        let ignored_bytes = self.decoder.ignored_bytes + self.link.stats().stranger_bytes;
        let truth = truth(&self.simulator, self.partner.is_some(), ignored_bytes);
        let mut shared = lock(&self.shared);
        shared.truth = truth;
        if truth.time_s + 1e-9 < self.next_track_s {
            return;
        }
        self.next_track_s = truth.time_s + self.config.track_interval_s.max(0.0);
        if shared.track.len() >= MAX_TRACK_POINTS {
            shared.track.pop_front();
        }
        shared.track.push_back(TrackPoint {
            time_s: truth.time_s,
            position: truth.position,
            altitude_amsl_m: truth.altitude_amsl_m,
            mission_item: truth.mission_item,
            cross_track_m: self.simulator.autopilot.guided.map_or(0.0, |g| g.cross_track_m),
        });
    }

    /// When the next step is due by the wall clock. Lost time is not made up for in a burst.
    fn plan_next_step(&mut self) {
        let now = Instant::now();
        if self.config.speed == 0.0 && self.partner.is_some() {
            self.next_wall = now;
            return;
        }
        let step = Duration::from_nanos(STEP_NS).div_f64(pace(self.config.speed));
        self.next_wall = (self.next_wall + step).max(now);
    }

    /// Serves the link until the next step may be taken; false: it is to stop.
    async fn wait_for_leave(&mut self) -> bool {
        let asked = Instant::now();
        let mut again = asked + ASK_AGAIN;
        loop {
            let now = Instant::now();
            if self.reads_at.take_if(|at| now >= *at).is_some() {
                self.read();
            }
            let waits_for_partner = self.partner.is_some() && !self.answered;
            if waits_for_partner && now >= asked + GIVE_UP {
                tracing::warn!("the lockstep partner is silent: going on in real time");
                self.partner = None;
                self.next_wall = now;
                continue;
            }
            if waits_for_partner && now >= again {
                again = now + ASK_AGAIN;
                self.simulator.ask_time();
                self.flush();
            }
            if !waits_for_partner && now >= self.next_wall {
                return self.drain_controls();
            }
            let until = if waits_for_partner { again } else { self.next_wall };
            if !self.serve_until(self.reads_at.map_or(until, |reads_at| until.min(reads_at))).await {
                return false;
            }
        }
    }

    /// Does the next thing that comes in, or waits until a time; false: it is to stop.
    async fn serve_until(&mut self, until: Instant) -> bool {
        tokio::select! {
            event = self.link.next(&mut self.received, frame::is_mavlink) => self.on_link(event),
            control = self.controls.recv() => return self.on_control(control),
            () = tokio::time::sleep_until(until) => {}
        }
        true
    }

    fn drain_controls(&mut self) -> bool {
        loop {
            match self.controls.try_recv() {
                Ok(control) => {
                    if !self.on_control(Some(control)) {
                        return false;
                    }
                }
                Err(mpsc::error::TryRecvError::Empty) => return true,
                Err(mpsc::error::TryRecvError::Disconnected) => return false,
            }
        }
    }

    fn on_link(&mut self, event: Event) {
        match event {
            Event::Connected(peer) => {
                self.decoder.restart();
                self.simulator.connect(peer);
                self.tell_time();
            }
            Event::Gone(peer) => {
                self.simulator.disconnect(peer);
                if self.partner == Some(peer) {
                    self.partner = None;
                    self.next_wall = Instant::now();
                }
            }
            Event::Stream(peer) => {
                self.decoder.push(&self.received);
                self.receive(peer);
            }
            Event::Datagram(peer) => {
                self.decoder.push_datagram(&self.received);
                self.receive(peer);
            }
        }
    }

    fn receive(&mut self, peer: Peer) {
        self.simulator.connect(peer);
        self.unread.extend(frame::take_frames(&mut self.decoder).into_iter().map(|frame| (peer, frame)));
        match &self.turns {
            Some(turns) => self.reads_at = self.reads_at.or_else(|| Some(turns.after(Instant::now()))),
            None => self.read(),
        }
    }

    /// Does all that was asked for.
    fn read(&mut self) {
        for (peer, frame) in std::mem::take(&mut self.unread) {
            self.simulator.receive(peer, frame);
        }
        self.note_answers();
        self.flush();
    }

    fn note_answers(&mut self) {
        let now = self.simulator.now_ns() as i64;
        for (peer, time) in self.simulator.take_sync_answers() {
            if self.config.lockstep && *self.partner.get_or_insert(peer) == peer {
                self.answered |= time == now;
            }
        }
    }

    fn on_control(&mut self, control: Option<Control>) -> bool {
        match control {
            None | Some(Control::Stop) => return false,
            Some(Control::Inject(fault)) => {
                if !self.simulator.inject(fault) {
                    tracing::warn!("too many faults: clear some first");
                }
            }
            Some(Control::Clear(name)) => {
                if !self.simulator.clear_fault(name) {
                    tracing::warn!("nothing to clear: no {name} is on or to come");
                }
            }
            Some(Control::Wind(wind)) => self.simulator.autopilot.wind = wind,
            Some(Control::Fence(radius_m)) => self.simulator.autopilot.fence.radius_m = radius_m,
            Some(Control::Visit { around, starts }) => self.simulator.is_visited(around, starts),
            Some(Control::Mode(mode)) => {
                if !self.simulator.autopilot.set_mode(mode) {
                    tracing::warn!("the autopilot does not take {mode:?} now");
                }
            }
        }
        true
    }
}
