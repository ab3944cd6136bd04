//! A radio between somebody else's autopilot and the agent, which loses, doubles and swaps frames as our simulator's does, or is as
//! narrow; and beside it the voice that tells the autopilot's simulation what goes wrong. Time is the machine's.

use super::told::Wish;
use super::voice::Voice;
use super::witness::{Heard, Witness};
use anyhow::{Context, ensure};
use autopilot_link::frame::{Beginning, Decoder, Frame, begins};
use autopilot_link::{Address, Event, Link, Peer};
use sim::core::faults::{BadLink, Dice, Effects, Schedule};
use sim::{Control, Fault};
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};

/// Faults begin and end, and what was not answered is said again, this often.
const BEAT: Duration = Duration::from_millis(50);
/// Controls that wait at most.
const MAX_CONTROLS: usize = 64;
/// What is left in a battery that is low, percent: as in our simulator.
const LOW_PERCENT: f32 = 15.0;
/// And in one that is not.
const FULL_PERCENT: f32 = 100.0;

/// What the other side of the thread knows.
#[derive(Debug, Clone, Default)]
struct State {
    is_as_asked: bool,
    trouble: Option<String>,
    heard: Option<Heard>,
}

/// A thread that carries frames; it ends when this is dropped.
pub struct Radio {
    /// Where the agent finds the autopilot (TCP).
    pub address: SocketAddr,
    controls: Option<mpsc::Sender<Control>>,
    state: watch::Receiver<State>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Radio {
    /// A radio to the autopilot at an address. Its world is put right first; then come the conditions. `seed`: of the dice.
    ///
    /// # Errors
    /// The address can't be had, or no thread.
    pub async fn open(autopilot: &Address, conditions: Vec<Control>, seed: u64) -> anyhow::Result<Self> {
        let far = Link::open(autopilot).await.with_context(|| format!("opening {autopilot}"))?;
        let near = TcpListener::bind(("127.0.0.1", 0)).await?;
        let address = near.local_addr()?;
        let (controls, commands) = mpsc::channel(MAX_CONTROLS);
        let (news, state) = watch::channel(State::default());
        let mut relay = Relay::new(Side::new(far), Side::new(Link::listen(near)), seed, commands, news);
        relay.begin(conditions);
        let runtime = tokio::runtime::Handle::current();
        let thread = std::thread::Builder::new()
            .name("radio".into())
            .spawn(move || runtime.block_on(relay.run()))
            .context("the radio's thread")?;
        Ok(Self { address, controls: Some(controls), state, thread: Some(thread) })
    }

    /// Does something to the link, or to the world of the autopilot.
    ///
    /// # Errors
    /// The thread is gone, or takes nothing in.
    pub fn tell(&self, control: Control) -> anyhow::Result<()> {
        let controls = self.controls.as_ref().context("the radio is off")?;
        controls.try_send(control).context("the radio's thread")
    }

    /// What the autopilot says of itself.
    pub fn heard(&self) -> Option<Heard> {
        self.state.borrow().heard
    }

    /// All was told, and the autopilot has confirmed it.
    ///
    /// # Errors
    /// What can't be had from it.
    pub fn is_as_asked(&self) -> anyhow::Result<bool> {
        let state = self.state.borrow();
        ensure!(state.trouble.is_none(), "{}", state.trouble.as_deref().unwrap_or_default());
        Ok(state.is_as_asked)
    }
}

impl Drop for Radio {
    fn drop(&mut self) {
        self.controls = None;
        // so that the autopilot's address is free for the next one
        if let Some(thread) = self.thread.take() {
            // one that panicked has said so
            let _ = thread.join();
        }
    }
}

/// One end of the radio.
struct Side {
    link: Link,
    peer: Option<Peer>,
    decoder: Decoder,
    /// What it sends goes through this.
    radio: BadLink<Vec<u8>>,
}

impl Side {
    fn new(link: Link) -> Self {
        Self {
            peer: link.peers().first().copied(),
            link,
            decoder: Decoder::default(),
            radio: BadLink::default(),
        }
    }

    /// Takes in what came.
    fn take(&mut self, event: Event, bytes: &[u8]) {
        match event {
            Event::Connected(peer) => {
                self.decoder.restart();
                self.peer = Some(peer);
            }
            Event::Gone(_) => self.peer = None,
            Event::Stream(peer) => {
                self.peer = Some(peer);
                self.decoder.push(bytes);
            }
            Event::Datagram(peer) => {
                self.peer = Some(peer);
                self.decoder.push_datagram(bytes);
            }
        }
    }

    fn send(&mut self, frame: &[u8]) {
        if let Some(peer) = self.peer {
            self.link.send(peer, frame);
        }
    }
}

/// Carries what one side has received to the other; `hear` listens, however bad the radio is.
fn carry(
    from: &mut Side,
    to: &mut Side,
    (now_ns, effects): (u64, &Effects),
    dice: &mut Dice,
    mut hear: impl FnMut(&Frame),
) {
    while let Some(frame) = from.decoder.next_frame() {
        hear(&frame);
        for out in from.radio.pass(now_ns, effects, dice, frame.bytes.to_vec()) {
            to.send(&out);
        }
    }
}

struct Relay {
    autopilot: Side,
    agent: Side,
    faults: Schedule,
    dice: Dice,
    /// What is wrong as far as the autopilot was told.
    told: Effects,
    voice: Voice,
    witness: Witness,
    began: Instant,
    controls: mpsc::Receiver<Control>,
    state: watch::Sender<State>,
}

impl Relay {
    fn new(
        autopilot: Side,
        agent: Side,
        seed: u64,
        controls: mpsc::Receiver<Control>,
        state: watch::Sender<State>,
    ) -> Self {
        Self {
            autopilot,
            agent,
            faults: Schedule::default(),
            dice: Dice::new(seed),
            told: Effects::default(),
            voice: Voice::default(),
            witness: Witness::default(),
            began: Instant::now(),
            controls,
            state,
        }
    }

    /// Whatever the flight before has left: nothing is wrong, and the air is calm. The wind comes first: an autopilot that can't be
    /// told it is in no simulation, and hears nothing more.
    fn begin(&mut self, conditions: Vec<Control>) {
        let calm = Wish::Wind { east_mps: 0.0, north_mps: 0.0 };
        let (battery, power) = (Wish::Battery(FULL_PERCENT), Wish::Power(true));
        for wish in [calm, Wish::Gps(true), Wish::EngineAsNew, power, battery, Wish::Fence(None)] {
            self.voice.wish(wish);
        }
        conditions.into_iter().for_each(|control| self.on_control(control));
    }

    async fn run(mut self) {
        let (mut down, mut up) = (vec![], vec![]);
        let mut beat = tokio::time::interval(BEAT);
        let is_mavlink = |bytes: &[u8]| begins(bytes) != Beginning::Nothing;
        loop {
            tokio::select! {
                event = self.autopilot.link.next(&mut down, is_mavlink) => self.on_autopilot(event, &down),
                event = self.agent.link.next(&mut up, is_mavlink) => self.on_agent(event, &up),
                control = self.controls.recv() => match control {
                    Some(control) => self.on_control(control),
                    None => return,
                },
                _ = beat.tick() => self.on_beat(),
            }
            self.autopilot.link.flush();
            self.agent.link.flush();
        }
    }

    fn now_ns(&self) -> u64 {
        u64::try_from(self.began.elapsed().as_nanos()).unwrap_or(u64::MAX)
    }

    /// The time, and what is wrong now.
    fn effects(&self) -> (u64, Effects) {
        let now_ns = self.now_ns();
        (now_ns, self.faults.effects(now_ns))
    }

    fn on_autopilot(&mut self, event: Event, bytes: &[u8]) {
        let (now_ns, effects) = self.effects();
        self.autopilot.take(event, bytes);
        let (voice, witness) = (&mut self.voice, &mut self.witness);
        carry(&mut self.autopilot, &mut self.agent, (now_ns, &effects), &mut self.dice, |frame| {
            if let Some(message) = frame.message() {
                voice.hear(frame.sender, &message);
                witness.hear_autopilot(&message);
            }
        });
    }

    fn on_agent(&mut self, event: Event, bytes: &[u8]) {
        let (now_ns, effects) = self.effects();
        self.agent.take(event, bytes);
        let witness = &mut self.witness;
        carry(&mut self.agent, &mut self.autopilot, (now_ns, &effects), &mut self.dice, |frame| {
            if let Some(message) = frame.message() {
                witness.hear_agent(&message);
            }
        });
    }

    fn on_control(&mut self, control: Control) {
        match control {
            Control::Inject(request) => {
                let now_ns = self.now_ns();
                if !is_had(request.fault) || !self.faults.add(request, now_ns) {
                    self.complain(format!("{request} can't be had"));
                }
            }
            Control::Clear(name) => {
                if !self.faults.clear(name, self.now_ns()) {
                    self.complain(format!("no {name} to clear"));
                }
            }
            Control::Wind(wind) => {
                self.voice.wish(Wish::Wind { east_mps: wind.east_mps, north_mps: wind.north_mps });
            }
            Control::Mode(mode) => self.voice.wish(Wish::Mode(mode)),
            Control::Fence(radius_m) => self.voice.wish(Wish::Fence(radius_m)),
            Control::Visit { around, starts } => {
                self.voice.wish(Wish::List(around));
                if starts {
                    self.voice.wish(Wish::FlyList);
                }
            }
            Control::Stop => self.complain("nobody can stop it".into()),
        }
        self.on_beat();
    }

    fn complain(&self, trouble: String) {
        self.state.send_modify(|state| {
            state.trouble.get_or_insert(trouble);
        });
    }

    /// Tells the autopilot what has changed, and says how far that is.
    fn on_beat(&mut self) {
        let (now_ns, now) = self.effects();
        let before = std::mem::replace(&mut self.told, now);
        if now.gps_lost != before.gps_lost {
            self.voice.wish(Wish::Gps(!now.gps_lost));
        }
        if now.engine_out != before.engine_out {
            self.voice.wish(Wish::Engine(!now.engine_out));
        }
        if now.ice != before.ice {
            self.voice.wish(Wish::Power(!now.ice));
        }
        if now.low_battery != before.low_battery {
            self.voice.wish(Wish::Battery(if now.low_battery { LOW_PERCENT } else { FULL_PERCENT }));
        }
        if let Some(frame) = self.voice.speak(self.began.elapsed()) {
            self.autopilot.send(&frame);
        }
        for late in self.autopilot.radio.release(now_ns, &now) {
            self.agent.send(&late);
        }
        for late in self.agent.radio.release(now_ns, &now) {
            self.autopilot.send(&late);
        }
        if let Some(trouble) = self.voice.trouble() {
            self.complain(trouble.to_owned());
        }
        let (is_as_asked, heard) = (self.voice.is_done(), self.witness.heard());
        self.state.send_modify(|state| {
            state.is_as_asked = is_as_asked;
            state.heard = heard;
        });
    }
}

/// It can be made of the radio, or be told to their worlds. As they come, nothing tells how fast the engine turns.
fn is_had(fault: Fault) -> bool {
    match fault {
        Fault::PacketLoss(_)
        | Fault::Duplicate(_)
        | Fault::Reorder(_)
        | Fault::Bandwidth(_)
        | Fault::Silence => true,
        Fault::GpsLoss | Fault::EngineOut | Fault::Ice | Fault::LowBattery | Fault::NoRpm => true,
        Fault::NoStream(_) | Fault::Crash | Fault::Reboot | Fault::FliesOn | Fault::Jammed => false,
    }
}

#[cfg(test)]
mod tests;
