//! Legs whose waypoints are generated from parameters.

use super::{Place, TurnDirection, Value};
use geometry::LatLon;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The area of a pattern.
#[derive(Debug, Clone, PartialEq)]
pub enum Area {
    /// A circle.
    Circle {
        /// Its centre.
        centre: Place,
        /// Its radius, metres.
        radius_m: Value<f64>,
    },
    /// A simple polygon: at least three corners, holes are simple and inside.
    Polygon {
        /// Outer ring, not closed.
        corners: Vec<LatLon>,
        /// Inner rings, not closed.
        holes: Vec<Vec<LatLon>>,
    },
    /// An expression that gives a polygon: a variable's name.
    Expression(Arc<str>),
}

/// Distance between neighbouring tracks.
#[derive(Debug, Clone, PartialEq)]
pub enum Spacing {
    /// Metres.
    Metres(Value<f64>),
    /// What a camera sees across the track: S = 2·h·tan(FOV/2)·(1 − overlap).
    Camera {
        /// Field of view across the track, degrees.
        field_of_view_deg: Value<f64>,
        /// Share (0..1) that neighbouring strips have in common.
        overlap: Value<f64>,
        /// Height above the ground, metres; `None`: the leg's altitude, which must then be above ground.
        height_m: Option<Value<f64>>,
    },
}

/// How an area is covered by straight tracks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScanStyle {
    /// Tracks along the long side (or the heading).
    Parallel,
    /// Tracks along the short side (or across the heading).
    Creeping,
    /// Parallel tracks, then tracks across them.
    CrissCross,
}

/// Where a pattern over an area begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ScanEntry {
    /// At the corner nearest to where the path comes from.
    Nearest,
    /// Leftmost track, flown along the heading.
    StartLeft,
    /// Rightmost track, flown along the heading.
    StartRight,
    /// Leftmost track, flown against the heading.
    EndLeft,
    /// Rightmost track, flown against the heading.
    EndRight,
}

/// In which order the tracks of a scan are flown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScanOrder {
    /// Where neighbouring tracks are too near to turn between them, some are passed over and flown later: no turn is tighter than the
    /// aircraft's.
    Interleaved,
    /// Each after its neighbour, whatever the aircraft's turn radius: the shortest way, with turns that swing wide.
    SideBySide,
}

/// Straight tracks over an area.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    /// What is scanned.
    pub area: Area,
    /// Parallel, creeping or criss-cross.
    pub style: ScanStyle,
    /// Distance between neighbouring tracks.
    pub spacing: Spacing,
    /// Direction of the tracks, degrees true; `None`: the one with the fewest turns.
    pub heading_deg: Option<Value<f64>>,
    /// How far each track continues beyond the area's edge before its turn, metres.
    pub overshoot_m: Value<f64>,
    /// Where it begins.
    pub entry: ScanEntry,
    /// Which track follows which.
    pub order: ScanOrder,
}

/// The other patterns.
#[derive(Debug, Clone, PartialEq)]
pub enum Pattern {
    /// An Archimedean spiral between two radii.
    Spiral {
        /// Its centre.
        centre: Place,
        /// Smaller radius, metres; 0 begins or ends at the centre.
        inner_radius_m: Value<f64>,
        /// Greater radius, metres.
        outer_radius_m: Value<f64>,
        /// Distance between neighbouring rounds.
        spacing: Spacing,
        /// From the outer radius to the inner one.
        inward: bool,
        /// Direction.
        turn: TurnDirection,
    },
    /// Legs of S, S, 2S, 2S, 3S, … with right-angled turns to one side.
    ExpandingSquare {
        /// Commence search point.
        centre: Place,
        /// S.
        spacing: Spacing,
        /// Direction of the first leg, degrees true.
        heading_deg: Value<f64>,
        /// Half the side of the area to be covered, metres.
        radius_m: Value<f64>,
        /// Side of the turns.
        turn: TurnDirection,
    },
    /// Sector search: spokes through the datum, joined by chords.
    Sector {
        /// The datum.
        centre: Place,
        /// Length of a spoke, metres.
        radius_m: Value<f64>,
        /// 3, 4 or 6.
        sectors: Value<f64>,
        /// Direction of the first spoke, degrees true.
        heading_deg: Value<f64>,
        /// How often; each further pass is turned by 30°.
        passes: Value<f64>,
        /// Side of the turns.
        turn: TurnDirection,
    },
    /// Parallel to a route, half the spacing to its side.
    TrackLine {
        /// The route's points, two or more.
        route: Vec<Place>,
        /// Distance between the tracks.
        spacing: Spacing,
        /// There on one side and back on the other; else two tracks are flown the same way, with a transit between them.
        returns: bool,
    },
    /// Parallel tracks along a route, as many as its width needs.
    Corridor {
        /// The route's points, two or more.
        route: Vec<Place>,
        /// Whole width, metres.
        width_m: Value<f64>,
        /// Distance between neighbouring tracks.
        spacing: Spacing,
    },
    /// Closed loops along an area's edge, one inside (or outside) the other.
    Contour {
        /// The area.
        area: Area,
        /// Distance between neighbouring loops; the first is half of it off the edge.
        spacing: Spacing,
        /// How many loops; `None`: until the area is filled (inward only).
        loops: Option<Value<f64>>,
        /// How many altitudes all loops are flown at; `None`, with a step: each loop has an altitude of its own.
        levels: Option<Value<f64>>,
        /// From each altitude to the next, metres: more than 0 climbs, less descends; `None`: all at one altitude.
        level_step_m: Option<Value<f64>>,
        /// To the inside of the area.
        inward: bool,
        /// Direction.
        turn: TurnDirection,
    },
    /// Two circles that touch at the centre.
    FigureEight {
        /// Where it crosses itself.
        centre: Place,
        /// Radius of its circles, metres.
        radius_m: Value<f64>,
        /// Direction in which the centre is crossed first, degrees true.
        heading_deg: Value<f64>,
        /// How often.
        turns: Value<f64>,
        /// Direction of the first circle.
        turn: TurnDirection,
    },
}
