//! On the ground between two flights of a plan.

use super::Flight;
use crate::api::Command;
use crate::rehearse::situation::{microseconds, standing};
use crate::rehearse::{PreviewError, Stop};
use flight_plan::{Id, Runway, Turnaround};

/// Longest time on the ground that is believed, seconds.
const MOST_S: f64 = 86_400.0;

impl Flight<'_> {
    /// What is done on the ground takes its time and brings the energy; then the next flight is started where it takes off.
    pub(super) fn turn_around(&mut self) -> Result<(), PreviewError> {
        let Some((landed, turnaround, runway)) = self.stands_after() else {
            self.at.ended = true;
            return Ok(());
        };
        self.record();
        self.close_waypoint();
        self.close_passage();
        let (from_s, battery_left) = (self.at.time_s(), self.at.aircraft.battery().share());
        self.pass(self.at.now_us + microseconds(turnaround.time_s.unwrap_or(0.0).clamp(0.0, MOST_S)));
        self.at.began_us = self.at.now_us;
        let battery_after = turnaround.energy_after(battery_left);
        let used_in_all_j = self.at.used_in_all_j();
        self.at.aircraft = standing(&runway, &self.at.aircraft.profile().clone());
        self.at.aircraft.set_battery_share(battery_after);
        self.at.used_before_j = used_in_all_j - self.at.used_j();
        let (legs, until_s) = (self.at.passages, self.at.time_s());
        self.result.stops.push(Stop { stage: landed, legs, from_s, until_s, battery_left, battery_after });
        self.report();
        let before = self.result.refusals.len();
        self.command(Command::Start);
        match self.result.refusals.get(before) {
            Some((_, refusal)) => Err(PreviewError::Refused(refusal.clone())),
            None => Ok(()),
        }
    }

    /// The stage that landed, what is said of the time behind it, and the runway that the next flight takes off from.
    fn stands_after(&self) -> Option<(Id, Turnaround, Runway)> {
        let executor = &self.at.executor;
        let next = executor.grounded()?;
        let stages = executor.active().stages(next.section);
        let landed = stages.get(next.stage.checked_sub(1)?)?;
        let runway = stages.get(next.stage)?.runway.as_ref()?;
        Some((landed.id.clone(), landed.turnaround, executor.active().plan.runway(runway)?.clone()))
    }
}
