//! The kinds of legs, as a person chooses among them.

use crate::{LegKind, Pattern, ScanStyle};

/// A kind of leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LegChoice {
    /// Initial fix.
    If,
    /// Track to a fix.
    Tf,
    /// Direct to a fix.
    Df,
    /// Constant-radius arc.
    Rf,
    /// Course to a fix.
    Cf,
    /// Fix to an altitude.
    Fa,
    /// Hold once.
    Hf,
    /// Hold to an altitude.
    Ha,
    /// Hold until told.
    Hm,
    /// Loop.
    Iterative,
    /// Fork.
    Intersection,
    /// Parallel tracks.
    Scan,
    /// Parallel tracks along the short side.
    CreepingLine,
    /// Parallel tracks twice.
    CrissCross,
    /// Loops along an edge.
    Contour,
    /// Beside a route.
    TrackLine,
    /// A strip along a route.
    Corridor,
    /// Circle.
    Orbit,
    /// Spiral.
    Spiral,
    /// Expanding square.
    ExpandingSquare,
    /// Sector search.
    Sector,
    /// Figure of eight.
    FigureEight,
    /// A procedure.
    Call,
}

/// What is drawn for a leg.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Shape {
    /// A place.
    Place,
    /// An open line of two places or more.
    Line,
    /// An outline of three corners or more.
    Area,
    /// A middle and a rim.
    Circle,
    /// Nothing: it is put around other legs, or between them.
    Nothing,
}

impl LegChoice {
    /// All of them, in the order of a menu.
    pub const ALL: [Self; 23] = [
        Self::Tf,
        Self::Df,
        Self::Cf,
        Self::Rf,
        Self::If,
        Self::Fa,
        Self::Hf,
        Self::Ha,
        Self::Hm,
        Self::Scan,
        Self::CreepingLine,
        Self::CrissCross,
        Self::Contour,
        Self::Corridor,
        Self::TrackLine,
        Self::Orbit,
        Self::Spiral,
        Self::ExpandingSquare,
        Self::Sector,
        Self::FigureEight,
        Self::Call,
        Self::Iterative,
        Self::Intersection,
    ];

    /// Those that are drawn in a way.
    pub fn drawn_as(shape: Shape) -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(move |choice| choice.shape() == shape)
    }

    /// Which one a leg is.
    pub fn of(kind: &LegKind) -> Self {
        match kind {
            LegKind::If(_) => Self::If,
            LegKind::Tf(_) => Self::Tf,
            LegKind::Df { .. } => Self::Df,
            LegKind::Rf { .. } => Self::Rf,
            LegKind::Cf { .. } => Self::Cf,
            LegKind::Fa { .. } => Self::Fa,
            LegKind::Hf(_) => Self::Hf,
            LegKind::Ha(_) => Self::Ha,
            LegKind::Hm { .. } => Self::Hm,
            LegKind::Iterative { .. } => Self::Iterative,
            LegKind::Intersection { .. } => Self::Intersection,
            LegKind::Scan(scan) => match scan.style {
                ScanStyle::Parallel => Self::Scan,
                ScanStyle::Creeping => Self::CreepingLine,
                ScanStyle::CrissCross => Self::CrissCross,
            },
            LegKind::Pattern(pattern) => match pattern {
                Pattern::Spiral { .. } => Self::Spiral,
                Pattern::ExpandingSquare { .. } => Self::ExpandingSquare,
                Pattern::Sector { .. } => Self::Sector,
                Pattern::TrackLine { .. } => Self::TrackLine,
                Pattern::Corridor { .. } => Self::Corridor,
                Pattern::Contour { .. } => Self::Contour,
                Pattern::FigureEight { .. } => Self::FigureEight,
            },
            LegKind::Call(_) => Self::Call,
            LegKind::Orbit { .. } => Self::Orbit,
        }
    }

    /// What is drawn for it. Scans and contours take a circle too.
    pub fn shape(self) -> Shape {
        match self {
            Self::If | Self::Tf | Self::Df | Self::Rf | Self::Cf | Self::Fa => Shape::Place,
            Self::Hf | Self::Ha | Self::Hm | Self::Call => Shape::Place,
            Self::Scan | Self::CreepingLine | Self::CrissCross | Self::Contour => Shape::Area,
            Self::TrackLine | Self::Corridor => Shape::Line,
            Self::Orbit | Self::Spiral | Self::ExpandingSquare | Self::Sector | Self::FigureEight => {
                Shape::Circle
            }
            Self::Iterative | Self::Intersection => Shape::Nothing,
        }
    }

    /// What it is called wherever it is met; see [`LegChoice::code`].
    pub const fn label(self) -> &'static str {
        self.words().1
    }

    /// The two letters that pilots know it by; empty: it has none.
    pub const fn code(self) -> &'static str {
        self.words().0
    }

    /// Both: `HM hold until released`.
    pub fn name(self) -> String {
        match self.code() {
            "" => self.label().into(),
            code => format!("{code} {}", self.label().to_lowercase()),
        }
    }

    /// What it does, in a line.
    pub const fn about(self) -> &'static str {
        self.words().2
    }

    /// What its identifiers begin with.
    pub(super) fn stem(self) -> &'static str {
        match self {
            Self::Hf | Self::Ha | Self::Hm => "hold",
            Self::Iterative => "loop",
            Self::Intersection => "fork",
            Self::Scan | Self::CreepingLine | Self::CrissCross => "scan",
            Self::Contour => "contour",
            Self::TrackLine => "track",
            Self::Corridor => "corridor",
            Self::Orbit => "orbit",
            Self::Spiral => "spiral",
            Self::ExpandingSquare | Self::Sector => "search",
            Self::FigureEight => "eight",
            Self::Call => "call",
            Self::If | Self::Tf | Self::Df | Self::Rf | Self::Cf | Self::Fa => "leg",
        }
    }

    const fn words(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::If => ("IF", "Initial fix", "Where a path starts; flies nothing itself"),
            Self::Tf => ("TF", "Track to a fix", "The shortest way from the fix before"),
            Self::Df => ("DF", "Direct to a fix", "Straight from wherever the aircraft is"),
            Self::Rf => ("RF", "Arc to a fix", "An arc that leaves the path before it smoothly"),
            Self::Cf => ("CF", "Course to a fix", "Intercepts a course and follows it to the fix"),
            Self::Fa => ("FA", "Fix to an altitude", "Follows a course until the altitude is reached"),
            Self::Hf => ("HF", "Hold once", "A racetrack, left at its first crossing of the fix"),
            Self::Ha => ("HA", "Hold to an altitude", "A racetrack until the altitude is reached"),
            Self::Hm => (
                "HM",
                "Hold until released",
                "A racetrack until somebody releases it, a condition holds or its laps are flown",
            ),
            Self::Iterative => ("", "Loop", "Legs that are flown several times"),
            Self::Intersection => ("", "Fork", "A choice between ways on, made in flight"),
            Self::Scan => ("", "Scan", "Parallel tracks over an area, along its long side"),
            Self::CreepingLine => ("", "Creeping line", "Parallel tracks along the short side of an area"),
            Self::CrissCross => ("", "Criss-cross", "Parallel tracks, then tracks across them"),
            Self::Contour => ("", "Contour", "Loops along an area's edge, one inside the other"),
            Self::TrackLine => ("", "Track line", "There on one side of a line, and back on the other"),
            Self::Corridor => ("", "Corridor", "A strip along a line, in parallel tracks"),
            Self::Orbit => ("", "Orbit", "Circles around a point"),
            Self::Spiral => ("", "Spiral", "From the rim to the middle"),
            Self::ExpandingSquare => ("", "Expanding square", "A search that begins in the middle"),
            Self::Sector => ("", "Sector search", "Spokes through the middle"),
            Self::FigureEight => ("", "Figure of eight", "Two circles that touch in the middle"),
            Self::Call => ("", "Call of a procedure", "Its legs, put here"),
        }
    }
}
