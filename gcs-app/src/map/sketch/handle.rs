//! What can be dragged or clicked on the map.

use super::numbers::{self, Ruler};
use super::{AreaPart, RunwayEnd};
use crate::document::Document;
use flight_plan::{Id, ScanEntry};
use geometry::LatLon;

/// Something on the map that can be dragged.
#[derive(Debug, Clone, PartialEq)]
pub struct Handle {
    /// What it is.
    pub what: Handled,
    /// Where.
    pub at: LatLon,
}

/// What a handle moves.
#[derive(Debug, Clone, PartialEq)]
pub enum Handled {
    /// A fix, with every leg that goes there.
    Fix(Id),
    /// A variable that is a position.
    Variable(Id),
    /// A part of a variable that is an area.
    Area(Id, AreaPart),
    /// An end of a runway.
    Runway(Id, RunwayEnd),
    /// Where a leg goes.
    Waypoint(Id),
    /// The middle of a scan or orbit.
    Centre(Id),
    /// The rim of a scan or orbit; the middle is at [`Circle::centre`].
    Radius(Id),
    /// A corner of a scan's polygon, or a point of a route.
    Corner {
        /// The scan.
        leg: Id,
        /// `None`: the outer ring.
        hole: Option<usize>,
        /// Which corner.
        corner: usize,
    },
    /// Between two corners or points: dragged, it is a new one.
    Ghost {
        /// The scan, route or zone.
        leg: Id,
        /// `None`: the outer ring or the route.
        hole: Option<usize>,
        /// Before which corner.
        before: usize,
    },
    /// In the middle of a leg: dragged, it is a new leg before that one.
    Between {
        /// The leg.
        leg: Id,
        /// How long that is, whole metres.
        gap_m: u32,
    },
    /// A number of a leg.
    Number {
        /// The leg.
        leg: Id,
        /// Its name in the document.
        number: &'static str,
        /// How its place says it.
        ruler: Ruler,
    },
    /// The centre of an arc.
    ArcCentre(Id),
    /// A corner where a scan may begin: clicked, it does.
    Entry {
        /// The scan.
        leg: Id,
        /// The corner.
        entry: ScanEntry,
        /// It does already.
        chosen: bool,
    },
    /// The side on which a holding is not, or the other way round a circle: clicked, it is so.
    Side {
        /// The leg.
        leg: Id,
        /// It holds.
        is_holding: bool,
    },
}

impl Handled {
    /// The leg it belongs to, if it is a leg's.
    pub fn leg(&self) -> Option<&Id> {
        match self {
            Self::Fix(_) | Self::Variable(_) | Self::Area(..) | Self::Runway(..) | Self::Between { .. } => {
                None
            }
            Self::Waypoint(leg)
            | Self::Centre(leg)
            | Self::Radius(leg)
            | Self::Corner { leg, .. }
            | Self::Number { leg, .. }
            | Self::ArcCentre(leg)
            | Self::Entry { leg, .. }
            | Self::Side { leg, .. }
            | Self::Ghost { leg, .. } => Some(leg),
        }
    }

    /// It stands for a choice: it is clicked, not dragged.
    pub fn is_choice(&self) -> bool {
        matches!(self, Self::Entry { .. } | Self::Side { .. })
    }

    /// Its name, with what people call that in the plan.
    pub fn name(&self, document: &Document) -> String {
        let of = |id| document.label(id);
        match self {
            Self::Fix(id) => format!("Fix {}", of(id)),
            Self::Variable(name) => format!("Place of {name}"),
            Self::Area(variable, part) => part.name(variable),
            Self::Runway(runway, end) => end.name(runway.as_str()),
            Self::Waypoint(id) => format!("Waypoint {}", of(id)),
            Self::Centre(id) => format!("Centre of {}", of(id)),
            Self::Radius(id) => format!("Radius of {}", of(id)),
            Self::Corner { leg, hole: None, corner } => format!("Corner {} of {}", corner + 1, of(leg)),
            Self::Corner { leg, hole: Some(hole), corner } => {
                format!("Corner {} of hole {} of {}", corner + 1, hole + 1, of(leg))
            }
            Self::Ghost { leg, hole: None, before } => format!("New corner {} of {}", before + 1, of(leg)),
            Self::Ghost { leg, hole: Some(hole), before } => {
                format!("New corner {} of hole {} of {}", before + 1, hole + 1, of(leg))
            }
            Self::Between { leg, .. } => format!("New leg before {}", of(leg)),
            Self::Number { leg, number, .. } => format!("{} of {}", numbers::name(number), of(leg)),
            Self::ArcCentre(leg) => format!("Centre of the arc {}", of(leg)),
            Self::Entry { leg, entry, .. } => format!("Begin {} at its {}", of(leg), corner(*entry)),
            Self::Side { leg, is_holding: true } => format!("Put the holding {} on this side", of(leg)),
            Self::Side { leg, is_holding: false } => format!("Turn {} the other way", of(leg)),
        }
    }
}

/// A corner, seen along the tracks.
fn corner(entry: ScanEntry) -> &'static str {
    match entry {
        ScanEntry::Nearest => "nearest corner",
        ScanEntry::StartLeft => "left start",
        ScanEntry::StartRight => "right start",
        ScanEntry::EndLeft => "left end",
        ScanEntry::EndRight => "right end",
    }
}
