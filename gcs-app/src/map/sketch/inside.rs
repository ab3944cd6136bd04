//! Procedures where they are defined: there their legs are dragged, while the procedure or one of its legs is selected.

use super::reader::Reader;
use super::{Circle, Handle, Sketch, ways};
use crate::command::Selection;
use crate::map::view::Mercator;
use flight_plan::{Id, Leg, Procedure};
use geometry::LatLon;
use std::collections::HashSet;
use std::ops::Range;

/// A procedure as it is defined.
#[derive(Debug, Clone, PartialEq)]
pub struct Inside {
    /// Which.
    pub procedure: Id,
    /// The point that calls put at their anchor.
    pub reference: Option<LatLon>,
    /// From place to place.
    pub line: Vec<LatLon>,
    /// The outlines of its areas.
    pub rings: Vec<Vec<LatLon>>,
    /// Its scans and orbits.
    pub circles: Vec<Circle>,
    legs: HashSet<Id>,
    /// Which of the sketch's handles are its.
    handles: Range<usize>,
}

impl Inside {
    /// It, or a leg of it, is selected.
    fn is_open(&self, selected: &Selection) -> bool {
        match selected {
            Selection::Procedure(id) => *id == self.procedure,
            Selection::Leg(id) => self.legs.contains(id),
            _ => false,
        }
    }
}

impl Sketch {
    /// The procedure that is selected, or of which a leg is.
    pub fn open_procedure(&self, selected: Option<&Selection>) -> Option<&Inside> {
        selected.and_then(|selected| self.procedures.iter().find(|inside| inside.is_open(selected)))
    }

    /// The handles that can be taken, each with its number in the sketch and its place on the map: those of a procedure while it,
    /// or a leg of it, is selected.
    pub fn handles_there(
        &self,
        selected: Option<&Selection>,
    ) -> impl Iterator<Item = (usize, &Handle, Mercator)> + use<'_> {
        let first = self.procedures.first().map_or(usize::MAX, |inside| inside.handles.start);
        let last = self.procedures.last().map_or(0, |inside| inside.handles.end);
        let open = self.open_procedure(selected).map_or(0..0, |inside| inside.handles.clone());
        let placed = self.handles.iter().zip(&self.placed.handles).enumerate();
        let there = placed.filter(move |(key, _)| *key < first || *key >= last || open.contains(key));
        there.map(|(key, (handle, at))| (key, handle, *at))
    }

    pub(super) fn add_inside(&mut self, procedure: &Procedure, reader: &Reader<'_>) {
        let mut own = Sketch::default();
        let mut inside = Inside {
            procedure: procedure.id.clone(),
            reference: procedure.reference,
            line: Vec::new(),
            rings: Vec::new(),
            circles: Vec::new(),
            legs: HashSet::new(),
            handles: 0..0,
        };
        procedure.legs.iter().for_each(|leg| inside.add(leg, &mut own, reader));
        let first = self.handles.len();
        self.handles.append(&mut own.handles);
        inside.handles = first..self.handles.len();
        inside.rings = own.polygons.into_iter().flat_map(|(_, rings)| rings).collect();
        inside.circles = own.circles;
        self.procedures.push(inside);
    }
}

impl Inside {
    fn add(&mut self, leg: &Leg, own: &mut Sketch, reader: &Reader<'_>) {
        self.legs.insert(leg.id.clone());
        own.add_leg(leg, reader);
        self.line.extend(ways::places(leg, reader));
        leg.body().iter().for_each(|inner| self.add(inner, own, reader));
    }
}
