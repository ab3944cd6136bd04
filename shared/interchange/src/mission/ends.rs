//! Where a mission begins and ends: take-off, approach and landing, with the runways they need.

use super::commands as cmd;
use super::import::Importer;
use super::loiters::racetrack;
use super::placed::{leg, waypoint};
use super::runways::{Direction, SAME_M};
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
        // another flight takes off where the one before has landed
        let Some((id, position)) = self.landed.take().or_else(|| self.home_runway(item, ahead)) else {
            return self.notes.push(
                "no-position",
                &item.place,
                "a take-off without home or position is left out",
            );
        };
        let mut stage =
            synthetic::stage(self.names.take("take-off", "take-off"), "Take-off", StageKind::TakeOff);
        stage.runway = Some(id);
        stage.altitude = self.altitude(item).or(Some(self.assumptions.altitude()));
        self.level = stage.altitude.clone();
        self.take_off = Some(stage);
        self.arrive(Some(position));
    }

    fn home_runway(&mut self, item: &Item, ahead: Option<LatLon>) -> Option<(Id, LatLon)> {
        let position = self.home.or(item.position()).or(ahead)?;
        let elevation_m = self.home_amsl_m(&item.place);
        // many write the take-off at home itself
        let away = item.position().filter(|at| at.distance_m(position) > SAME_M);
        let direction = Direction { heading_deg: item.param(4), towards: away.or(ahead), from: None };
        let naming = (&mut *self.names, &mut *self.notes);
        let id = self.runways.at("runway", (position, elevation_m), direction, &item.place, naming);
        Some((id, position))
    }

    pub(super) fn land(&mut self, item: &Item) {
        if item.command == cmd::VTOL_LAND {
            self.notes.push("vtol", &item.place, "a vertical landing becomes one on a runway");
        }
        if item.param(1) > 0.0 {
            let message = "the altitude to climb to when a landing is broken off is left out";
            self.notes.push("landing-setting", &item.place, message);
        }
        let Some(position) = item.position().or(self.last).or(self.home) else {
            return self.notes.push(
                "no-position",
                &item.place,
                "a landing without home or position is left out",
            );
        };
        if item.position().or(self.here()).is_none() {
            let message = "the landing is put at home: the file doesn't say where the pattern before it ends";
            self.notes.push("no-position", &item.place, message);
        }
        if matches!(item.frame, cmd::FRAME_TERRAIN | cmd::FRAME_TERRAIN_INT) {
            let message = "the ground where this lands is taken to be as high as home: the file doesn't say how high it is";
            self.notes.push("terrain-landing", &item.place, message);
        }
        let elevation_m = match item.frame {
            cmd::FRAME_GLOBAL | cmd::FRAME_GLOBAL_INT => item.param(7),
            _ => self.home_amsl_m(&item.place) + item.param(7),
        };
        self.land_at(&item.place, (position, elevation_m), item.param(4));
    }

    pub(super) fn return_home(&mut self, item: &Item) {
        let Some(position) = self.home else {
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
        let elevation_m = self.home_amsl_m(&item.place);
        self.land_at(&item.place, (position, elevation_m), f64::NAN);
    }

    /// The elevation of home, or 0 with a note.
    fn home_amsl_m(&mut self, place: &str) -> f64 {
        self.datum.home_amsl_m.unwrap_or_else(|| {
            let message = "the file doesn't say how high home is: its elevation is taken as 0 m";
            self.notes.push("no-home", place, message);
            0.0
        })
    }

    fn land_at(&mut self, at: &str, (position, elevation_m): (LatLon, f64), heading_deg: f64) {
        let elevation_m = if elevation_m.is_finite() {
            elevation_m
        } else {
            self.notes.push(
                "bad-altitude",
                at,
                "the landing has no altitude: its elevation is taken as home's",
            );
            self.home_amsl_m(at)
        };
        // a landing on the spot continues in the direction of arrival
        let mut before = [self.last, self.passed].into_iter().flatten();
        let from = before.find(|p| p.distance_m(position) > SAME_M);
        let direction = Direction { heading_deg, towards: None, from };
        let naming = (&mut *self.names, &mut *self.notes);
        let id = self.runways.at("landing", (position, elevation_m), direction, at, naming);
        let mut stage = synthetic::stage(self.names.take("land", "land"), "Landing", StageKind::Land);
        stage.runway = Some(id.clone());
        self.landed = Some((id, position));
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
        self.arrive(Some(approach.position));
        let home_m = if relative { self.home_amsl_m(at) } else { 0.0 };
        self.land_at(at, (land.0, land.1 + home_m), f64::NAN);
    }
}
