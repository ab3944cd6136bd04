//! Where a mission begins and ends: take-off, landing and what leads to it, with the runways they need.

use super::commands as cmd;
use super::import::{Importer, racetrack};
use super::placed::{leg, waypoint};
use super::runways::Direction;
use super::{Approach, Item};
use crate::synthetic;
use flight_plan::{Id, LegKind, StageKind, TurnDirection};
use geometry::LatLon;

impl Importer<'_> {
    pub(super) fn take_off(&mut self, item: &Item, ahead: Option<LatLon>) {
        if self.take_off.is_some() || !self.legs.is_empty() {
            return self.notes.push("second-take-off", &item.place, "a take-off in flight is left out");
        }
        if item.command == cmd::VTOL_TAKEOFF {
            self.notes.push("vtol", &item.place, "a vertical take-off becomes one from a runway");
        }
        let Some(position) = self.home.map(|h| h.0).or(item.position()).or(ahead) else {
            return self.notes.push(
                "no-position",
                &item.place,
                "a take-off without home or position is left out",
            );
        };
        let elevation_m = self.datum.home_amsl_m.unwrap_or_else(|| {
            self.notes.push(
                "no-home",
                &item.place,
                "the file has no home position: its elevation is taken as 0 m",
            );
            0.0
        });
        let direction =
            Direction { heading_deg: item.param(4), towards: item.position().or(ahead), from: None };
        let naming = (&mut *self.names, &mut *self.notes);
        let id = self.runways.at("runway", (position, elevation_m), direction, &item.place, naming);
        let mut stage =
            synthetic::stage(self.names.take("take-off", "take-off"), "Take-off", StageKind::TakeOff);
        stage.runway = Some(id);
        stage.altitude = self.altitude(item).or(Some(self.assumptions.altitude()));
        self.take_off = Some(stage);
        self.last = Some(position);
    }

    pub(super) fn land(&mut self, item: &Item) {
        if item.command == cmd::VTOL_LAND {
            self.notes.push("vtol", &item.place, "a vertical landing becomes one on a runway");
        }
        let Some(position) = item.position().or(self.home.map(|h| h.0)) else {
            return self.notes.push(
                "no-position",
                &item.place,
                "a landing without home or position is left out",
            );
        };
        let elevation_m = match item.frame {
            cmd::FRAME_GLOBAL | cmd::FRAME_GLOBAL_INT => item.param(7),
            _ => self.datum.home_amsl_m.unwrap_or(0.0) + item.param(7),
        };
        self.land_at(&item.place, (position, elevation_m), item.param(4));
    }

    pub(super) fn return_home(&mut self, item: &Item) {
        let Some((position, elevation_m)) = self.home else {
            return self.notes.push(
                "no-home",
                &item.place,
                "the return to launch is left out: the file has no home position",
            );
        };
        self.notes.push(
            "return-to-launch",
            &item.place,
            "the return to launch becomes a landing at the home position",
        );
        self.land_at(&item.place, (position, elevation_m), f64::NAN);
    }

    fn land_at(&mut self, at: &str, (position, elevation_m): (LatLon, f64), heading_deg: f64) {
        let elevation_m = if elevation_m.is_finite() { elevation_m } else { 0.0 };
        let direction = Direction { heading_deg, towards: None, from: self.last };
        let naming = (&mut *self.names, &mut *self.notes);
        let id = self.runways.at("landing", (position, elevation_m), direction, at, naming);
        let mut stage = synthetic::stage(self.names.take("land", "land"), "Landing", StageKind::Land);
        stage.runway = Some(id);
        self.land = Some(stage);
    }

    pub(super) fn landing(
        &mut self,
        at: &str,
        number: i64,
        approach: &Approach,
        land: (LatLon, f64),
        relative: bool,
    ) {
        let frame = if approach.relative { cmd::FRAME_RELATIVE } else { cmd::FRAME_GLOBAL };
        let kind = match approach.loiter_radius_m {
            Some(signed_m) => {
                let turn = if signed_m < 0.0 { TurnDirection::Left } else { TurnDirection::Right };
                let message = "a circle to an altitude becomes a holding to that altitude (HA)";
                self.notes.again("loiter-as-racetrack", at, message);
                LegKind::Ha(racetrack(approach.position, turn, signed_m.abs()))
            }
            None => LegKind::Tf(waypoint(approach.position, false)),
        };
        let mut way = leg(Id::new("approach"), kind);
        way.altitude = self.datum.altitude(frame, approach.altitude_m, at, self.notes);
        self.ready(number, way);
        self.last = Some(approach.position);
        let home_m = if relative { self.datum.home_amsl_m.unwrap_or(0.0) } else { 0.0 };
        self.land_at(at, (land.0, land.1 + home_m), f64::NAN);
    }
}
