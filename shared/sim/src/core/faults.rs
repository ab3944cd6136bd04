//! Faults on request: what is broken when, and a link that loses, doubles and swaps frames, or is narrow.

use super::STEP_NS;
use std::collections::VecDeque;
use std::fmt;
use std::str::FromStr;

const NS_PER_S: f64 = 1e9;
/// Requests kept at most; more are refused.
const MAX_REQUESTS: usize = 64;
/// A byte on a serial line has a start bit and a stop bit.
const BITS_A_BYTE: f64 = 10.0;
/// What a narrow line would carry only after this long is lost: a radio keeps no more.
const LATEST_NS: u64 = 1_000_000_000;

/// Something that goes wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Share of the frames lost, each way, 0..=1.
    PacketLoss(f64),
    /// Share of the frames that come twice, 0..=1.
    Duplicate(f64),
    /// Share of the frames that come after the next one, 0..=1.
    Reorder(f64),
    /// The line carries so many bits in a second, each way.
    Bandwidth(f64),
    /// No satellite fix (dead reckoning goes on; arming is refused).
    GpsLoss,
    /// The engine gives nothing.
    EngineOut,
    /// The battery drops to 15 % at once; when that ends, it is a full one.
    LowBattery,
    /// The radio is silent both ways.
    Silence,
    /// Nothing says how fast the engine turns.
    NoRpm,
    /// The message with this number is not sent.
    NoStream(u32),
    /// Ice: full throttle is only enough for the slowest airspeed.
    Ice,
    /// It is down where it is: it stands, and its autopilot flies on.
    Crash,
    /// Its autopilot starts anew, as after its watchdog: mode, arming and list stay, its clock begins again. That is over at once.
    Reboot,
    /// It accepts that its flight is ended by force, and flies on.
    FliesOn,
    /// Its ailerons are jammed level: it flies straight on, wherever it steers to.
    Jammed,
}

/// One of each kind.
const KINDS: [Fault; 15] = [
    Fault::PacketLoss(0.0),
    Fault::Duplicate(0.0),
    Fault::Reorder(0.0),
    Fault::Bandwidth(1.0),
    Fault::GpsLoss,
    Fault::EngineOut,
    Fault::LowBattery,
    Fault::Silence,
    Fault::NoRpm,
    Fault::NoStream(0),
    Fault::Ice,
    Fault::Crash,
    Fault::Reboot,
    Fault::FliesOn,
    Fault::Jammed,
];

impl Fault {
    /// The name of a kind, as it is said to end it.
    ///
    /// # Errors
    /// There is none of that name.
    pub fn known_name(name: &str) -> Result<&'static str, String> {
        let names = KINDS.map(Fault::name);
        let wrong = || format!("{name:?} is no fault; end one of {}", names.join(", "));
        names.into_iter().find(|known| *known == name).ok_or_else(wrong)
    }

    fn name(self) -> &'static str {
        match self {
            Fault::PacketLoss(_) => "packet-loss",
            Fault::Duplicate(_) => "duplicate",
            Fault::Reorder(_) => "reorder",
            Fault::Bandwidth(_) => "bandwidth",
            Fault::GpsLoss => "gps-loss",
            Fault::EngineOut => "engine-out",
            Fault::LowBattery => "low-battery",
            Fault::Silence => "silence",
            Fault::NoRpm => "no-rpm",
            Fault::NoStream(_) => "no-stream",
            Fault::Ice => "ice",
            Fault::Crash => "crash",
            Fault::Reboot => "reboot",
            Fault::FliesOn => "flies-on",
            Fault::Jammed => "jammed",
        }
    }
}

/// A fault with its time: `name[=number][@second[+seconds]]`, as `packet-loss=0.2`, `engine-out@300`,
/// `silence@120+10`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaultRequest {
    /// What.
    pub fault: Fault,
    /// From when, simulated seconds; `None`: from when it is asked for.
    pub at_s: Option<f64>,
    /// For how long, simulated seconds; `None`: for good.
    pub for_s: Option<f64>,
}

impl fmt::Display for FaultRequest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.fault.name())?;
        if let Fault::PacketLoss(number)
        | Fault::Duplicate(number)
        | Fault::Reorder(number)
        | Fault::Bandwidth(number) = self.fault
        {
            write!(f, "={number}")?;
        }
        if let Fault::NoStream(id) = self.fault {
            write!(f, "={id}")?;
        }
        if let Some(at) = self.at_s {
            write!(f, "@{at}")?;
        }
        if let Some(duration) = self.for_s {
            write!(f, "+{duration}")?;
        }
        Ok(())
    }
}

/// Why a fault request can't be understood.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "{0:?} is no fault; write one of packet-loss=SHARE, duplicate=SHARE, reorder=SHARE (shares from 0 to 1), \
     bandwidth=BITS-PER-SECOND, gps-loss, engine-out, low-battery, silence, no-rpm, no-stream=MESSAGE-NUMBER, ice, crash, reboot, \
     flies-on, jammed, then @SECOND and +SECONDS if it has its time, as in silence@120+10"
)]
pub struct FaultSyntax(String);

impl FromStr for FaultRequest {
    type Err = FaultSyntax;

    fn from_str(text: &str) -> Result<Self, FaultSyntax> {
        let bad = || FaultSyntax(text.to_owned());
        let number = |t: &str| {
            t.parse::<f64>().ok().filter(|n| n.is_finite() && (0.0..1e9).contains(n)).ok_or_else(bad)
        };
        let (rest, for_s) = match text.split_once('+') {
            Some((rest, duration)) => (rest, Some(number(duration)?)),
            None => (text, None),
        };
        let (rest, at_s) = match rest.split_once('@') {
            Some((rest, at)) => (rest, Some(number(at)?)),
            None => (rest, None),
        };
        let (name, share) = match rest.split_once('=') {
            Some((name, share)) => (name, Some(number(share)?)),
            None => (rest, None),
        };
        let fault = match (name, share.filter(|s| *s <= 1.0), share) {
            ("packet-loss", Some(share), _) => Fault::PacketLoss(share),
            ("duplicate", Some(share), _) => Fault::Duplicate(share),
            ("reorder", Some(share), _) => Fault::Reorder(share),
            ("bandwidth", _, Some(bits_per_s)) if bits_per_s >= 1.0 => Fault::Bandwidth(bits_per_s),
            ("gps-loss", _, None) => Fault::GpsLoss,
            ("engine-out", _, None) => Fault::EngineOut,
            ("low-battery", _, None) => Fault::LowBattery,
            ("silence", _, None) => Fault::Silence,
            ("no-rpm", _, None) => Fault::NoRpm,
            ("no-stream", _, Some(id)) if id.fract() == 0.0 => Fault::NoStream(id as u32),
            ("ice", _, None) => Fault::Ice,
            ("crash", _, None) => Fault::Crash,
            ("reboot", _, None) => Fault::Reboot,
            ("flies-on", _, None) => Fault::FliesOn,
            ("jammed", _, None) => Fault::Jammed,
            _ => return Err(bad()),
        };
        Ok(Self { fault, at_s, for_s })
    }
}

/// What is wrong now.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Effects {
    /// Share of frames lost.
    pub loss: f64,
    /// Share of frames doubled.
    pub duplicate: f64,
    /// Share of frames swapped with the next.
    pub reorder: f64,
    /// What the line carries, bits per second; `None`: all there is.
    pub bits_per_s: Option<f64>,
    /// No satellite fix.
    pub gps_lost: bool,
    /// No engine power.
    pub engine_out: bool,
    /// Nothing sent or received.
    pub silent: bool,
    /// The battery dropped.
    pub low_battery: bool,
    /// No message says how fast the engine turns.
    pub no_rpm: bool,
    /// The message with this number is not sent.
    pub no_stream: Option<u32>,
    /// Full throttle is only enough for the slowest airspeed.
    pub ice: bool,
    /// It is down where it is.
    pub crash: bool,
    /// It started anew when this began.
    pub reboot: bool,
    /// It accepts that its flight is ended, and flies on.
    pub flies_on: bool,
    /// It does not bank.
    pub jammed: bool,
}

#[derive(Debug, Clone, Copy)]
struct Scheduled {
    fault: Fault,
    from_ns: u64,
    until_ns: u64,
}

/// All that was asked for.
#[derive(Debug, Default)]
pub struct Schedule(Vec<Scheduled>);

impl Schedule {
    /// Adds a request; false if there are too many already.
    pub fn add(&mut self, request: FaultRequest, now_ns: u64) -> bool {
        self.0.retain(|s| s.until_ns > now_ns);
        if self.0.len() >= MAX_REQUESTS {
            return false;
        }
        let from_ns = request.at_s.map_or(now_ns, |s| (s * NS_PER_S) as u64);
        let lasts_ns = match request.fault {
            // as long as it is sure to be seen once
            Fault::Reboot => STEP_NS + 1,
            _ => request.for_s.map_or(u64::MAX, |s| (s * NS_PER_S) as u64),
        };
        let until_ns = from_ns.saturating_add(lasts_ns);
        self.0.push(Scheduled { fault: request.fault, from_ns, until_ns });
        true
    }

    /// Forgets every request for the kind of fault that has this name; false if there was none that is not over.
    pub fn clear(&mut self, name: &str, now_ns: u64) -> bool {
        self.0.retain(|s| s.until_ns > now_ns);
        let before = self.0.len();
        self.0.retain(|s| s.fault.name() != name);
        self.0.len() < before
    }

    /// What is wrong at a time.
    pub fn effects(&self, now_ns: u64) -> Effects {
        let mut effects = Effects::default();
        for s in self.0.iter().filter(|s| (s.from_ns..s.until_ns).contains(&now_ns)) {
            match s.fault {
                Fault::PacketLoss(share) => effects.loss = share,
                Fault::Duplicate(share) => effects.duplicate = share,
                Fault::Reorder(share) => effects.reorder = share,
                Fault::Bandwidth(bits_per_s) => effects.bits_per_s = Some(bits_per_s),
                Fault::GpsLoss => effects.gps_lost = true,
                Fault::EngineOut => effects.engine_out = true,
                Fault::LowBattery => effects.low_battery = true,
                Fault::Silence => effects.silent = true,
                Fault::NoRpm => effects.no_rpm = true,
                Fault::NoStream(id) => effects.no_stream = Some(id),
                Fault::Ice => effects.ice = true,
                Fault::Crash => effects.crash = true,
                Fault::Reboot => effects.reboot = true,
                Fault::FliesOn => effects.flies_on = true,
                Fault::Jammed => effects.jammed = true,
            }
        }
        effects
    }
}

/// A small reproducible generator (Steele, Lea and Flood, *SplitMix*, 2014).
#[derive(Debug, Clone)]
pub struct Dice(u64);

impl Dice {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// True with that probability.
    pub fn roll(&mut self, probability: f64) -> bool {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64;
        unit < probability
    }
}

/// Something that a line carries.
pub trait OnAir: Clone {
    /// How many bytes it has there.
    fn bytes(&self) -> usize;
}

impl OnAir for Vec<u8> {
    fn bytes(&self) -> usize {
        self.len()
    }
}

/// One direction of a bad link. Holds at most one frame back to swap it, and a second's worth where it is narrow.
#[derive(Debug)]
pub struct BadLink<T> {
    held: Option<T>,
    line: Line<T>,
}

impl<T> Default for BadLink<T> {
    fn default() -> Self {
        Self { held: None, line: Line { waiting: VecDeque::new(), free_ns: 0 } }
    }
}

impl<T: OnAir> BadLink<T> {
    /// What comes out when a frame goes in.
    pub fn pass(&mut self, now_ns: u64, effects: &Effects, dice: &mut Dice, frame: T) -> Vec<T> {
        if effects.silent {
            return Vec::new();
        }
        if dice.roll(effects.loss) {
            // on the air all the same
            self.line.occupy(now_ns, effects.bits_per_s, &frame);
            return Vec::new();
        }
        let twice = dice.roll(effects.duplicate);
        if self.held.is_none() && dice.roll(effects.reorder) {
            self.held = Some(frame);
            return Vec::new();
        }
        let copy = twice.then(|| frame.clone());
        let frames = [Some(frame), copy, self.held.take()].into_iter().flatten();
        frames.filter_map(|frame| self.line.carry(now_ns, effects.bits_per_s, frame)).collect()
    }

    /// What was held back for too long, and what the line has carried by now.
    pub fn release(&mut self, now_ns: u64, effects: &Effects) -> Vec<T> {
        let held = self.held.take().and_then(|held| self.line.carry(now_ns, effects.bits_per_s, held));
        self.line.arrived(now_ns).into_iter().chain(held).collect()
    }
}

/// A line that takes its time for each byte. What it carries within a step arrives at once.
#[derive(Debug)]
struct Line<T> {
    waiting: VecDeque<(u64, T)>,
    /// It is busy until then.
    free_ns: u64,
}

impl<T: OnAir> Line<T> {
    /// When a frame that is sent now has passed; `None`: too much waits, it is lost.
    fn occupy(&mut self, now_ns: u64, bits_per_s: Option<f64>, frame: &T) -> Option<u64> {
        let Some(bits_per_s) = bits_per_s else { return Some(now_ns) };
        let takes_ns = frame.bytes() as f64 * BITS_A_BYTE / bits_per_s * NS_PER_S;
        let passed_ns = self.free_ns.max(now_ns).saturating_add(takes_ns as u64);
        if passed_ns > now_ns + LATEST_NS {
            return None;
        }
        self.free_ns = passed_ns;
        Some(passed_ns)
    }

    fn carry(&mut self, now_ns: u64, bits_per_s: Option<f64>, frame: T) -> Option<T> {
        let passed_ns = self.occupy(now_ns, bits_per_s, &frame)?;
        if passed_ns <= now_ns + STEP_NS && self.waiting.is_empty() {
            return Some(frame);
        }
        self.waiting.push_back((passed_ns, frame));
        None
    }

    fn arrived(&mut self, now_ns: u64) -> Vec<T> {
        let mut arrived = vec![];
        while let Some((_, frame)) =
            self.waiting.pop_front_if(|(passed_ns, _)| *passed_ns <= now_ns + STEP_NS)
        {
            arrived.push(frame);
        }
        arrived
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn requests_are_read_and_written() {
        for text in [
            "packet-loss=0.2",
            "duplicate=0.1@5",
            "reorder=1",
            "bandwidth=57600@5",
            "gps-loss@120",
            "engine-out",
            "low-battery@1.5+2",
            "silence@120+10",
            "ice@60",
            "no-stream=24@60",
            "crash@60",
            "reboot@60",
            "flies-on",
            "jammed@60+20",
        ] {
            let request: FaultRequest = text.parse().unwrap();
            assert_eq!(request.to_string(), text);
        }
    }

    #[test]
    fn nonsense_is_refused_with_the_syntax() {
        for text in [
            "",
            "fire",
            "packet-loss",
            "packet-loss=2",
            "packet-loss=NaN",
            "bandwidth",
            "bandwidth=0",
            "no-stream",
            "no-stream=0.5",
            "gps-loss=1",
            "silence@-1",
            "silence@1+x",
        ] {
            let error = text.parse::<FaultRequest>().unwrap_err().to_string();
            assert!(error.contains("silence@120+10"), "{text}: {error}");
        }
    }

    #[test]
    fn faults_begin_and_end_in_time_and_can_be_cleared() {
        let mut schedule = Schedule::default();
        schedule.add("silence@10+5".parse().unwrap(), 0);
        schedule.add("engine-out".parse().unwrap(), 3_000_000_000);
        let at = |schedule: &Schedule, s: u64| schedule.effects(s * 1_000_000_000);
        assert_eq!(at(&schedule, 2), Effects::default());
        assert!(at(&schedule, 4).engine_out && !at(&schedule, 9).silent);
        assert!(at(&schedule, 10).silent && at(&schedule, 14).silent && !at(&schedule, 15).silent);
        let now_ns = 20_000_000_000;
        assert!(schedule.clear("engine-out", now_ns) && !schedule.clear("engine-out", now_ns));
        assert!(!schedule.clear("silence", now_ns), "it is over");
        assert_eq!(at(&schedule, 20), Effects::default());
    }

    #[test]
    fn only_a_kind_of_fault_can_be_ended() {
        for kind in KINDS {
            assert_eq!(Fault::known_name(kind.name()), Ok(kind.name()));
        }
        let error = Fault::known_name("fire").unwrap_err();
        assert!(error.contains("fire") && error.contains("low-battery"), "{error}");
    }

    impl OnAir for u32 {
        fn bytes(&self) -> usize {
            48
        }
    }

    #[test]
    fn a_bad_link_loses_doubles_and_swaps_about_as_much_as_asked() {
        let effects = Effects { loss: 0.2, duplicate: 0.1, reorder: 0.1, ..Effects::default() };
        let (mut link, mut dice) = (BadLink::default(), Dice::new(7));
        let out: Vec<u32> = (0..10_000).flat_map(|i| link.pass(0, &effects, &mut dice, i)).collect();
        let mut distinct = out.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let swapped = out.windows(2).filter(|w| w[1] < w[0]).count();
        assert!((7_800..8_200).contains(&distinct.len()), "{}", distinct.len());
        assert!((600..1_000).contains(&(out.len() - distinct.len())));
        assert!((600..900).contains(&swapped), "{swapped}");
    }

    #[test]
    fn a_narrow_line_carries_so_much_in_a_step_keeps_a_second_and_loses_the_rest() {
        let effects = Effects { bits_per_s: Some(57_600.0), ..Effects::default() };
        let (mut link, mut dice) = (BadLink::default(), Dice::new(7));
        let at_once: Vec<u32> = (0..1000).flat_map(|i| link.pass(0, &effects, &mut dice, i)).collect();
        // 5,760 bytes a second
        assert_eq!(at_once, (0..12).collect::<Vec<_>>());
        let steps = (1..20).map(|step| link.release(step * STEP_NS, &effects));
        let later: Vec<Vec<u32>> = steps.take_while(|came| !came.is_empty()).collect();
        assert!(later.iter().all(|came| came.len() == 12), "{later:?}");
        assert_eq!(later.concat(), (12..120).collect::<Vec<_>>(), "in order, and what a second carries");
        // what is lost on the air takes its time, too
        let lossy = Effects { loss: 0.5, ..effects };
        let mut link = BadLink::default();
        let came = (0..24).flat_map(|i| link.pass(0, &lossy, &mut dice, i)).count();
        assert!((1..12).contains(&came), "{came}");
    }
}
