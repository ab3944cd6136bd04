//! The handles of a variable that is an area, whether a leg covers it or not: its corners, the marks between them and its middle.

use super::{Handle, Handled, Sketch};
use flight_plan::transform::Motion;
use flight_plan::{Edit, Id, VariableValue};
use geometry::{LatLon, LocalFrame};

/// An area has so many corners at least.
const LEAST: usize = 3;

/// What of an area is dragged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AreaPart {
    /// Its middle: all of it moves.
    Middle,
    /// A corner.
    Corner(usize),
    /// Between two corners: dragged, it is a new one before this corner.
    Ghost(usize),
}

impl AreaPart {
    /// Its name.
    pub fn name(self, variable: &Id) -> String {
        match self {
            Self::Middle => format!("Middle of {variable}"),
            Self::Corner(corner) => format!("Corner {} of {variable}", corner + 1),
            Self::Ghost(before) => format!("New corner {} of {variable}", before + 1),
        }
    }
}

/// Those of every area.
pub(super) fn handles(areas: &[(Id, Vec<LatLon>)]) -> impl Iterator<Item = Handle> {
    areas.iter().flat_map(|(variable, corners)| {
        let handle = |part, at| Handle { what: Handled::Area(variable.clone(), part), at };
        let next = corners.iter().cycle().skip(1);
        let ghosts = corners.iter().zip(next).enumerate();
        let ghosts =
            ghosts.map(|(index, (from, to))| (AreaPart::Ghost(index + 1), from.interpolate(*to, 0.5)));
        let own = corners.iter().enumerate().map(|(corner, at)| (AreaPart::Corner(corner), *at));
        let middle = middle(corners).map(|at| (AreaPart::Middle, at));
        middle.into_iter().chain(own).chain(ghosts).map(|(part, at)| handle(part, at)).collect::<Vec<_>>()
    })
}

fn middle(corners: &[LatLon]) -> Option<LatLon> {
    LocalFrame::around(corners).map(|frame| frame.origin())
}

impl Sketch {
    /// The corners of a variable that is an area.
    pub fn area(&self, variable: &Id) -> Option<&[LatLon]> {
        self.areas.iter().find(|(of, _)| of == variable).map(|(_, corners)| corners.as_slice())
    }

    /// What dragging a part of a variable's area to a place does.
    pub fn drag_area(&self, variable: &Id, part: AreaPart, to: LatLon) -> Option<Edit> {
        let mut corners = self.area(variable)?.to_vec();
        match part {
            AreaPart::Middle => {
                let motion = Motion::shift(middle(&corners)?, to);
                corners.iter_mut().for_each(|at| *at = motion.place(*at));
            }
            AreaPart::Corner(corner) => *corners.get_mut(corner)? = to,
            AreaPart::Ghost(before) => corners.insert(before.min(corners.len()), to),
        }
        Some(set(variable, corners))
    }

    /// Removes a corner of a variable's area, unless too few would be left.
    pub fn remove_area_corner(&self, variable: &Id, corner: usize) -> Option<Edit> {
        let mut corners = self.area(variable)?.to_vec();
        if corners.len() <= LEAST || corner >= corners.len() {
            return None;
        }
        corners.remove(corner);
        Some(set(variable, corners))
    }
}

/// A variable's area by its corners.
fn set(variable: &Id, corners: Vec<LatLon>) -> Edit {
    Edit::SetVariable { name: variable.clone(), value: VariableValue::Polygon(corners) }
}
