//! Track and events of recordings, by vehicle.

use super::log::time;
use interchange::{MAX_POINTS, RecordedFlight, TrackEvent, TrackPoint};
use recording::Message;
use serde_json::Value;
use std::collections::BTreeMap;
use usal::contract::{Position, Stamped};
use usal::{Key, Kind};

/// Longest description of an event, bytes.
const DESCRIPTION_MAX: usize = 2000;

/// What was read so far.
#[derive(Default)]
pub struct Flights {
    flights: BTreeMap<String, RecordedFlight>,
    /// Points and events of all.
    entries: usize,
    /// Those that found no room.
    left_out: u64,
}

impl Flights {
    /// Takes in a message: a position of the gateway, or an event; nothing else is exported.
    pub fn message(&mut self, message: &Message<'_>) {
        if message.channel.encoding != "json" {
            return;
        }
        let Ok(key) = message.channel.topic.parse::<Key>() else { return };
        match (key.kind, key.service.as_str(), key.name.as_str()) {
            (Kind::Event, _, "log") => {}
            (Kind::Variable, "gateway", "position") | (Kind::Event, ..) if self.entries >= MAX_POINTS => {
                self.left_out += 1;
            }
            (Kind::Variable, "gateway", "position") => self.position(key, message),
            (Kind::Event, ..) => self.event(key, message),
            _ => {}
        }
    }

    fn position(&mut self, key: Key, message: &Message<'_>) {
        let Ok(sample) = serde_json::from_slice::<Stamped<Position>>(message.data) else { return };
        let Position { position, altitude_amsl_m, .. } = sample.value;
        if position.is_valid() && altitude_amsl_m.is_finite() {
            let point = TrackPoint { time: time(message.log_ns), position, altitude_amsl_m };
            self.of(key.vehicle).track.push(point);
        }
    }

    fn event(&mut self, key: Key, message: &Message<'_>) {
        let Ok(sample) = serde_json::from_slice::<Value>(message.data) else { return };
        let value = sample.get("value").unwrap_or(&sample);
        let what =
            ["event", "invocation"].iter().find_map(|name| value.get(name)?.as_str()).unwrap_or(&key.name);
        let name = format!("{}: {what}", key.service);
        let description: String = value.to_string().chars().take(DESCRIPTION_MAX).collect();
        let flight = self.of(key.vehicle);
        // before the first position nobody knows where
        let Some(last) = flight.track.last() else { return };
        let at = TrackPoint { time: time(message.log_ns), ..last.clone() };
        flight.events.push(TrackEvent { at, name, description });
    }

    fn of(&mut self, vehicle: String) -> &mut RecordedFlight {
        self.entries += 1;
        self.flights
            .entry(vehicle.clone())
            .or_insert_with(|| RecordedFlight { vehicle, ..RecordedFlight::default() })
    }

    /// Points and events for which there was no room.
    pub fn left_out(&self) -> u64 {
        self.left_out
    }

    /// The flights, by the vehicles' names.
    pub fn finish(self) -> Vec<RecordedFlight> {
        self.flights.into_values().collect()
    }
}
