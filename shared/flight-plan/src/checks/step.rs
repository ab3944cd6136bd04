//! The plan's legs with what is known of them before the flight.

use super::extent::Region;
use super::path::{Path, leaves_deg};
use crate::{Altitude, EmergencyChoice, Id, IterativeForm, Leg, LegKind, Problem, Stage, StageKind, Value};
use geometry::LatLon;
use std::sync::Arc;

/// A leg with the geometry that is known before the flight.
pub(super) struct Step {
    pub leg: Arc<Leg>,
    pub around: Arc<Around>,
    /// Where it is entered; `None` when that is only known in flight.
    pub start: Option<Point>,
    /// Where it ends, as for the start.
    pub end: Option<Point>,
    /// What its entry is within, if not even that is known.
    pub start_within: Option<Region>,
    /// The circle that its end is within, as for the start.
    pub end_within: Option<Region>,
    /// Airspeed, m/s.
    pub speed_mps: f64,
    /// Its ground path from start to end.
    pub path: Option<Path>,
    /// The step that is flown before it, if the document says so.
    pub before: Option<usize>,
    /// The step with a direction that is flown after it.
    pub after: Option<usize>,
    pub marks: Marks,
    /// What the rules about one leg said, each with the number of the rule.
    pub found: Vec<(usize, Problem)>,
}

/// What a leg has, for rules that only concern such legs.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Marks {
    /// It names its successor.
    pub jumps: bool,
    /// It has expressions.
    pub expressions: bool,
    /// It names something that is not there.
    pub strangers: bool,
}

/// A point of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Point {
    pub position: LatLon,
    pub altitude_amsl_m: Option<f64>,
}

/// What the legs of one list have around them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Around {
    /// They are of the main plan.
    pub main: bool,
    /// What `home` altitudes count from, metres AMSL; `None`: only known in flight.
    pub home_m: Option<f64>,
    /// Loops, outermost first.
    pub loops: Vec<Loop>,
    /// Their stage, without its legs.
    pub stage: Arc<Stage>,
}

/// What an iterative leg is for the legs inside it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Loop {
    pub id: Id,
    pub form: IterativeForm,
    pub emergency: EmergencyChoice,
    pub altitude: Option<Altitude>,
    pub speed_mps: Option<Value<f64>>,
}

impl Step {
    /// The altitude that is written for the leg: its own, else that of the loops around it, else the stage's.
    pub fn altitude(&self) -> Option<&Altitude> {
        self.around.altitude_of(&self.leg)
    }

    /// Its path, if it is long enough to have a direction.
    pub fn directed(&self) -> Option<Path> {
        self.path.filter(|path| path.length_m() >= super::path::SHORTEST_M)
    }

    /// The course on which its path ends, degrees true; known for an arc even if its start is not.
    pub fn course_end_deg(&self) -> Option<f64> {
        let directed = self.directed().map(|path| path.course_end_deg());
        directed.or_else(|| match &self.leg.kind {
            LegKind::Rf { centre, turn, .. } if self.start.is_none() => {
                leaves_deg(*centre, self.end?.position, *turn)
            }
            _ => None,
        })
    }

    /// The altitude at which it is entered, metres AMSL.
    pub fn entry_altitude_amsl_m(&self) -> Option<f64> {
        let start = self.start.and_then(|start| start.altitude_amsl_m);
        start.or_else(|| self.start_within.and_then(|region| region.altitude_amsl_m))
    }
}

impl Around {
    fn altitude_of<'a>(&'a self, leg: &'a Leg) -> Option<&'a Altitude> {
        leg.altitude.as_ref().or_else(|| self.says_altitude().map(|(_, altitude)| altitude))
    }

    /// The loop or stage that says the altitude of a leg without one of its own, and which that is.
    pub fn says_altitude(&self) -> Option<(&Id, &Altitude)> {
        let loops = self.loops.iter().rev().map(|l| (&l.id, l.altitude.as_ref()));
        let stage = (&self.stage.id, self.stage.altitude.as_ref());
        let stage = std::iter::once(stage).filter(|_| self.stage.kind != StageKind::TakeOff);
        loops.chain(stage).find_map(|(id, altitude)| Some((id, altitude?)))
    }

    /// Likewise, the speed.
    pub fn speed_of<'a>(&'a self, leg: &'a Leg) -> Option<&'a Value<f64>> {
        let loops = self.loops.iter().rev().map(|l| &l.speed_mps);
        let inner = std::iter::once(&leg.speed_mps).chain(loops).find_map(Option::as_ref);
        inner.or(self.stage.speed_mps.as_ref())
    }

    /// Every altitude and speed around the legs, metres and m/s.
    pub fn numbers(&self) -> impl Iterator<Item = &Value<f64>> {
        let of = |altitude, speed| Option::map(altitude, |a: &Altitude| &a.metres).into_iter().chain(speed);
        let loops = self.loops.iter().flat_map(move |l| of(l.altitude.as_ref(), l.speed_mps.as_ref()));
        loops.chain(of(self.stage.altitude.as_ref(), self.stage.speed_mps.as_ref()))
    }

    /// What the legs inside a loop have around them.
    pub fn inside(&self, leg: &Leg, form: IterativeForm) -> Self {
        let mut inside = self.clone();
        inside.loops.push(Loop {
            id: leg.id.clone(),
            form,
            emergency: leg.emergency.clone(),
            altitude: leg.altitude.clone(),
            speed_mps: leg.speed_mps.clone(),
        });
        inside
    }
}

impl Leg {
    /// It says itself what follows it.
    pub(super) fn jumps(&self) -> bool {
        self.next.is_some()
            || matches!(&self.kind, LegKind::Intersection { branches, .. } if !branches.is_empty())
    }
}
