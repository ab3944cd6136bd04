//! Where the aircraft stands, and how it is turned, before it takes off: an autopilot takes off to where it points, from where it is.

use super::Executor;
use crate::api::{AircraftState, Refusal};
use crate::flight::{RefusedStart, refusal};
use flight_plan::{Runway, StageKind};
use geometry::geodesy::normalise_180;

/// An aircraft that stands farther off a runway's heading would leave the runway before it flies, degrees.
const MOST_OFF_DEG: f64 = 45.0;
const ALL_THE_SAME: &str = "or start again within a minute to do so all the same";

impl Executor {
    /// The aircraft stands on the runway that the flight is to take off from, along it; or the same one starts it again, who was told that
    /// it does not.
    pub(super) fn check_at_runway(&mut self, by: &str) -> Result<(), Refusal> {
        let now_s = self.life.clock.now_s();
        let insists = self.life.refused_start.is_insisted_on(by, now_s);
        let checked = if insists { Ok(()) } else { self.stands_ready() };
        self.life.refused_start =
            if checked.is_ok() { RefusedStart::default() } else { RefusedStart::of(by, now_s) };
        checked
    }

    fn stands_ready(&self) -> Result<(), Refusal> {
        let stage = self.later_flight().map_or(0, |cursor| cursor.stage);
        let stage = self.setup.program.flown().stages.get(stage).filter(|s| s.kind == StageKind::TakeOff);
        let runway = stage.and_then(|s| self.setup.program.plan.runway(s.runway.as_ref()?));
        let aircraft = self.life.aircraft().filter(|aircraft| aircraft.on_ground);
        let Some((runway, aircraft)) = runway.zip(aircraft) else { return Ok(()) };
        let (away_m, off_deg) = (self.away_m(runway, aircraft), self.off_deg(runway, aircraft));
        let Some(away_m) = away_m else {
            return off_deg.map_or(Ok(()), |off_deg| Err(wrong_way(runway, off_deg)));
        };
        let turned = off_deg.map_or_else(String::new, |deg| format!(", and {deg:.0}° off its heading"));
        let reason = format!(
            "the aircraft stands {} from runway `{}`, from which the plan takes off{turned}: bring it there, fly a plan of where it stands, {ALL_THE_SAME}",
            distance(away_m),
            runway.id
        );
        Err(refusal("not-at-the-runway", reason))
    }

    /// How far from the runway it stands; `None`: on it. What rises upright does so beside it as well.
    fn away_m(&self, runway: &Runway, aircraft: &AircraftState) -> Option<f64> {
        let (strip, place) = (runway.strip(), aircraft.position);
        let is_there = match self.setup.profile.rises_upright {
            true => strip.is_near(place),
            false => strip.is_stood_on(place),
        };
        (!is_there).then(|| strip.beside_m(place))
    }

    /// By how much it points elsewhere, if it is known how it is turned, and that matters.
    fn off_deg(&self, runway: &Runway, aircraft: &AircraftState) -> Option<f64> {
        let heading_deg = aircraft.heading_deg.filter(|_| !self.setup.profile.rises_upright)?;
        Some(normalise_180(heading_deg - runway.heading_deg).abs()).filter(|deg| *deg > MOST_OFF_DEG)
    }
}

fn wrong_way(runway: &Runway, off_deg: f64) -> Refusal {
    let reason = format!(
        "the aircraft stands {off_deg:.0}° off the heading of runway `{}`, and would take off the wrong way: turn it, {ALL_THE_SAME}",
        runway.id
    );
    refusal("wrong-way", reason)
}

fn distance(metres: f64) -> String {
    if metres < 1000.0 { format!("{metres:.0} m") } else { format!("{:.1} km", metres / 1000.0) }
}
