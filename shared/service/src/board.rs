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
