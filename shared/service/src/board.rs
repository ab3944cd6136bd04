//! What a service shows: its variables, at the rates of the declaration, and its files.

use crate::Time;
use serde::Serialize;
use std::any::Any;
use std::collections::BTreeMap;
use std::time::Duration;
use usal::topics::Variable;
use usal::{FileOffer, Kind, Rate, Session, SessionError, Spec, Untyped, VariablePublisher};

/// Measured values come no closer than this in simulation, where seconds are short, and in flight, where they follow the
/// source's own rate.
const SPACING_SIMULATED: Duration = Duration::from_millis(200);
const SPACING: Duration = Duration::from_millis(5);

/// What a service shows.
pub struct Board {
    now: Time,
    /// Something happened: what is shown periodically is shown now.
    hurried: bool,
    /// When [`Self::is_turn`] was true last.
    turn: Option<Time>,
    spacing: Duration,
    variables: BTreeMap<&'static str, Slot>,
    files: BTreeMap<&'static str, Shown>,
}

struct Slot {
    publisher: VariablePublisher<Untyped>,
    rate: Rate,
    validity_s: f64,
    /// When it was published last, or the source time of what was.
    last: Option<Time>,
    /// By which a change is known.
    key: Option<Box<dyn Any + Send>>,
}

struct Shown {
    offer: FileOffer,
    version: Option<String>,
}

impl Board {
    pub(crate) fn open(spec: &Spec, simulated: bool, session: &Session) -> Result<Self, SessionError> {
        let (mut variables, mut files) = (BTreeMap::new(), BTreeMap::new());
        for said in spec.says {
            match (said.kind, said.rate) {
                (Kind::Variable, Some(rate)) => {
                    let publisher = session.publish_untyped(spec.name, said.name)?;
                    let slot = Slot { publisher, rate, validity_s: said.validity_s, last: None, key: None };
                    variables.insert(said.name, slot);
                }
                (Kind::File, _) => {
                    let shown = Shown { offer: session.offer(spec.name, said.name)?, version: None };
                    files.insert(said.name, shown);
                }
                _ => {}
            }
        }
        let spacing = if simulated { SPACING_SIMULATED } else { SPACING };
        Ok(Self { now: Time::ZERO, hurried: false, turn: None, spacing, variables, files })
    }

    pub(crate) fn hurry(&mut self) {
        self.hurried = true;
    }

    pub(crate) fn begin(&mut self, now: Time) {
        self.now = now;
    }

    pub(crate) fn end(&mut self) {
        self.hurried = false;
    }

    /// Whether it is time to look at what is shown: `pace` has passed since it was, or something happened. For services
    /// whose values cost something to look at.
    pub fn is_turn(&mut self, pace: Duration) -> bool {
        let turn = self.hurried || self.turn.is_none_or(|turn| self.now.saturating_sub(turn) >= pace);
        if turn {
            self.turn = Some(self.now);
        }
        turn
    }

    /// A measured value with its source time: published if it is newer than the last, and not too close to it.
    pub fn measured<T: Serialize>(&mut self, variable: Variable<T>, value: Option<(Time, T)>) {
        let spacing = self.spacing;
        let (Some((time, value)), Some(slot)) = (value, self.slot(variable.name)) else { return };
        if slot.last.is_none_or(|last| time > last && time.saturating_sub(last) >= spacing) {
            slot.last = Some(time);
            slot.publisher.set_any(time.as_secs_f64(), slot.validity_s, &value);
        }
    }

    /// A value of now: published periodically, and at once when an event was emitted or a request answered.
    pub fn current<T: Serialize>(&mut self, variable: Variable<T>, value: impl FnOnce() -> T) {
        let (now, hurried) = (self.now, self.hurried);
        let Some(slot) = self.slot(variable.name) else { return };
        if hurried || slot.is_due(now) {
            slot.publish(now, &value());
        }
    }

    /// A value of now: published whenever `key` is another one than before, and repeated periodically.
    pub fn changing<T, K>(&mut self, variable: Variable<T>, key: K, value: impl FnOnce(&K) -> T)
    where
        T: Serialize,
        K: PartialEq + Send + 'static,
    {
        let now = self.now;
        let Some(slot) = self.slot(variable.name) else { return };
        let before = slot.key.as_ref().and_then(|key| key.downcast_ref::<K>());
        if slot.is_due(now) || before != Some(&key) {
            slot.publish(now, &value(&key));
            slot.key = Some(Box::new(key));
        }
    }

    /// A file, whenever its `version` is another one.
    pub fn file(&mut self, name: &str, version: &str, content: impl FnOnce() -> Vec<u8>) {
        let now = self.now;
        let Some(shown) = self.files.get_mut(name) else { return undeclared(name) };
        if shown.version.as_deref() == Some(version) {
            return;
        }
        shown.version = Some(version.to_owned());
        if let Err(error) = shown.offer.set(now.as_secs_f64(), content()) {
            tracing::warn!("`{name}` cannot be fetched as a file: {error}");
        }
    }

    fn slot(&mut self, name: &'static str) -> Option<&mut Slot> {
        let slot = self.variables.get_mut(name);
        if slot.is_none() {
            undeclared(name);
        }
        slot
    }
}

fn undeclared(name: &str) {
    tracing::error!("`{name}` isn't in the service's declaration and is not published");
}

impl Slot {
    fn is_due(&self, now: Time) -> bool {
        let period = match self.rate {
            Rate::Measured => return true,
            Rate::Every { ms } | Rate::Changed { repeated_ms: ms } => Duration::from_millis(ms),
        };
        self.last.is_none_or(|last| now.saturating_sub(last) >= period)
    }

    fn publish<T: Serialize>(&mut self, now: Time, value: &T) {
        self.last = Some(now);
        self.publisher.set_any(now.as_secs_f64(), self.validity_s, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tokio::sync::mpsc;
    use usal::{Document, Raw, Said, Start};

    const MEASURED: Variable<f64> = Variable::new("shower", "measured");
    const CURRENT: Variable<u64> = Variable::new("shower", "current");
    const CHANGING: Variable<u64> = Variable::new("shower", "changing");
    const SPEC: Spec = Spec {
        name: "shower",
        about: "shows",
        says: &[
            Said::variable(MEASURED, Rate::Measured, 1.0),
            Said::variable(CURRENT, Rate::Every { ms: 1000 }, 2.0),
            Said::variable(CHANGING, Rate::Changed { repeated_ms: 1000 }, 2.0),
            Said::file("drawing"),
        ],
    };

    async fn board(simulated: bool) -> (Session, Board) {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let endpoint = format!("tcp/{}", listener.local_addr().unwrap());
        drop(listener);
        let session = Session::open(usal::Config::hub("uav1", &endpoint)).await.unwrap();
        let board = Board::open(&SPEC, simulated, &session).unwrap();
        (session, board)
    }

    /// The instants, out of all that are looked at, at which `show` says that it was wanted. Milliseconds.
    fn shown(board: &mut Board, looks: &[u64], mut show: impl FnMut(&mut Board, u64) -> bool) -> Vec<u64> {
        let mut look = |ms: u64| {
            board.begin(Duration::from_millis(ms));
            let wanted = show(board, ms);
            board.end();
            wanted
        };
        looks.iter().copied().filter(|ms| look(*ms)).collect()
    }

    fn current(board: &mut Board) -> bool {
        let mut wanted = false;
        board.current(CURRENT, || {
            wanted = true;
            7
        });
        wanted
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn value_of_now_is_asked_for_when_it_is_due_and_when_something_happened() {
        let (_session, mut board) = board(false).await;
        let looks = [0, 1, 999, 1000, 1001, 1999, 2000, 5000, 5999];
        assert_eq!(shown(&mut board, &looks, |board, _| current(board)), [0, 1000, 2000, 5000]);
        board.hurry();
        // the period begins anew with what was shown in a hurry
        assert_eq!(shown(&mut board, &[5999, 6000, 6998, 6999], |board, _| current(board)), [5999, 6999]);
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn value_that_changes_is_shown_at_each_change_and_repeated() {
        let (_session, mut board) = board(false).await;
        let keys = [(0, 'a'), (10, 'a'), (20, 'b'), (30, 'a'), (1029, 'a'), (1030, 'a'), (1040, 'a')];
        let times = keys.map(|(ms, _)| ms);
        let wanted = shown(&mut board, &times, |board, ms| {
            let key = keys.iter().find(|(at, _)| *at == ms).map(|(_, key)| *key);
            let mut wanted = false;
            board.changing(CHANGING, key, |_| {
                wanted = true;
                ms
            });
            wanted
        });
        assert_eq!(wanted, [0, 20, 30, 1030]);
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn measured_value_is_published_if_it_is_newer_and_not_too_close() {
        let (session, mut board) = board(true).await;
        let (sender, mut published) = mpsc::unbounded_channel();
        let take = move |raw| {
            if let Raw::Sample { key, format, payload } = raw
                && key.name == "measured"
            {
                let said = Document { format, size_bytes: payload.len(), bytes: Some(payload) }.to_json();
                let _ = sender.send((said["time_s"].as_f64(), said["value"].as_f64()));
            }
        };
        let _everything = session.follow_everything(Start::Now, take).unwrap();
        let mut measure = |ms: u64, value: f64| {
            board.measured(MEASURED, Some((Duration::from_millis(ms), value)));
        };
        // again, too close, older; then the next one
        for (ms, value) in [(1000, 1.0), (1000, 2.0), (1199, 3.0), (500, 4.0), (1200, 5.0), (1400, 6.0)] {
            measure(ms, value);
        }
        board.measured(MEASURED, None);
        for expected in [(1.0, 1.0), (1.2, 5.0), (1.4, 6.0)] {
            let said = tokio::time::timeout(Duration::from_secs(30), published.recv()).await.unwrap();
            assert_eq!(said, Some((Some(expected.0), Some(expected.1))));
        }
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn file_is_made_once_for_each_version_and_what_is_undeclared_never() {
        let (_session, mut board) = board(false).await;
        let mut made = Vec::new();
        for version in ["1", "1", "2", "1"] {
            board.file("drawing", version, || {
                made.push(version);
                version.into()
            });
        }
        assert_eq!(made, ["1", "2", "1"]);
        board.file("secret", "1", || panic!("nobody can fetch it"));
        board.current(Variable::<u64>::new("shower", "secret"), || panic!("nobody can follow it"));
    }

    #[tokio::test(flavor = "multi_thread")]
    async fn it_is_its_turn_at_its_pace_and_when_something_happened() {
        let (_session, mut board) = board(false).await;
        let pace = Duration::from_millis(300);
        let looks = [0, 299, 300, 301, 900, 1199];
        assert_eq!(shown(&mut board, &looks, |board, _| board.is_turn(pace)), [0, 300, 900]);
        board.hurry();
        assert_eq!(shown(&mut board, &[1199, 1200, 1499], |board, _| board.is_turn(pace)), [1199, 1499]);
    }
}
