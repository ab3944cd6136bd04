//! Zones to keep out of or to stay in, and whether a path does.
//!
//! A zone is a circle or a polygon (with holes, its edges geodesics) between two altitudes. A [`Stretch`] is a piece of path
//! with its altitudes; one distance rules out what is far from a zone, so that thousands of stretches can be held
//! against tens of zones.
//!
//! Errors: circles are exact to a millimetre on lines, polygons good to 1 m up to 50 km from the middle of the zone and to 5 m up to
//! the 100 km that a frame reaches; both are tested against geodesics.

mod ball;
mod circle;
mod outline;
mod plate;
#[cfg(test)]
mod tests;

use crate::polygon::PolygonError;
use crate::{LatLon, PathElement};
use ball::Ball;
use circle::Circle;
use outline::Outline;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;

/// What a zone is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rule {
    /// No point of the path may be in it.
    KeepOut,
    /// Every point of the path must be in it.
    KeepIn,
}

/// A zone's ground.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shape {
    /// Everything up to a distance from a point.
    Circle {
        /// The point.
        centre: LatLon,
        /// The distance, metres.
        radius_m: f64,
    },
    /// What geodesics between corners enclose, without its holes.
    Polygon {
        /// Corners of the outer ring.
        outer: Vec<LatLon>,
        /// Corners of each hole.
        holes: Vec<Vec<LatLon>>,
    },
}

/// Altitudes, in the datum of the stretches that are held against it, metres. They may be infinite.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// The lowest.
    pub floor_m: f64,
    /// The highest.
    pub ceiling_m: f64,
}

impl Band {
    /// All altitudes.
    pub const ALL: Band = Band { floor_m: f64::NEG_INFINITY, ceiling_m: f64::INFINITY };

    /// How far an altitude is inside (negative: outside), metres.
    fn inside_m(&self, altitude_m: f64) -> f64 {
        (altitude_m - self.floor_m).min(self.ceiling_m - altitude_m)
    }
}

/// Why there is no such zone.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ZoneError {
    /// The radius is not a positive number, or the centre is no position.
    #[error("a circle of {0} m: give it a position and a positive radius below 1000 km")]
    Circle(f64),
    /// The floor is not below the ceiling.
    #[error("the zone reaches from {floor_m} m up to {ceiling_m} m: put the floor below the ceiling")]
    Band {
        /// The floor.
        floor_m: f64,
        /// The ceiling.
        ceiling_m: f64,
    },
    /// Negative, infinite or not a number.
    #[error("a margin of {0} m: it must be 0 or more")]
    Margin(f64),
    /// The corners are no polygon.
    #[error(transparent)]
    Polygon(#[from] PolygonError),
}

/// A zone, ready to be held against paths.
#[derive(Debug, Clone)]
pub struct Zone {
    ground: Ground,
    band: Band,
    rule: Rule,
    margin_m: f64,
    ball: Ball,
}

#[derive(Debug, Clone)]
enum Ground {
    Circle(Circle),
    Outline(Box<Outline>),
}

/// A piece of path; its altitude changes evenly along it.
#[derive(Debug, Clone, Copy)]
pub struct Stretch {
    element: PathElement,
    start_altitude_m: f64,
    end_altitude_m: f64,
    ball: Ball,
}

/// Where a stretch breaks a zone's rule the most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Breach {
    /// Way along the stretch, metres.
    pub distance_m: f64,
    /// Where that is.
    pub position: LatLon,
    /// Altitude there, metres.
    pub altitude_m: f64,
    /// How far on the wrong side of the zone's edge (moved by the margin) it is, metres. Keeping in, 0 if only the altitude
    /// is wrong.
    pub horizontal_m: f64,
    /// Keeping out: metres to the nearer end of the altitude band, which may be infinite. Keeping in: metres beyond it,
    /// 0 inside.
    pub vertical_m: f64,
}

/// A place on the ground of a stretch and how far it is on the wrong side, metres.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Worst {
    along_m: f64,
    wrong_m: f64,
}

impl Worst {
    /// The worse of two, the earlier one of equals.
    fn or(self, other: Worst) -> Worst {
        if other.wrong_m > self.wrong_m { other } else { self }
    }
}

/// A ball with some stretches in it.
#[derive(Debug, Clone, Copy)]
pub struct Neighbourhood(Ball);

impl Neighbourhood {
    /// `None`: there are no stretches.
    pub fn of<'a>(stretches: impl Iterator<Item = &'a Stretch>) -> Option<Self> {
        Ball::around_all(stretches.map(|stretch| stretch.ball)).map(Self)
    }
}

impl Stretch {
    /// A path element, with the altitude at its start and at its end, metres.
    pub fn new(element: PathElement, (start_altitude_m, end_altitude_m): (f64, f64)) -> Self {
        Self { element, start_altitude_m, end_altitude_m, ball: Ball::around(&element) }
    }

    /// Altitude at its end, metres.
    pub fn end_altitude_m(&self) -> f64 {
        self.end_altitude_m
    }

    /// Altitude after so much of the way, metres.
    pub fn altitude_at_m(&self, along_m: f64) -> f64 {
        let length_m = self.element.length_m();
        self.altitude_m(if length_m > 0.0 { (along_m / length_m).clamp(0.0, 1.0) } else { 0.0 })
    }

    /// Altitude after a share of the way, metres.
    fn altitude_m(&self, share: f64) -> f64 {
        self.start_altitude_m + share * (self.end_altitude_m - self.start_altitude_m)
    }

    /// Shares of the way between which the altitude is inside a band; `None` if it never is.
    fn shares_within(&self, band: &Band) -> Option<(f64, f64)> {
        let climb_m = self.end_altitude_m - self.start_altitude_m;
        if climb_m == 0.0 {
            return (band.inside_m(self.start_altitude_m) > 0.0).then_some((0.0, 1.0));
        }
        let share_at = |altitude_m: f64| (altitude_m - self.start_altitude_m) / climb_m;
        let (a, b) = (share_at(band.floor_m), share_at(band.ceiling_m));
        let (enters, leaves) = (a.min(b).max(0.0), a.max(b).min(1.0));
        (enters < leaves).then_some((enters, leaves))
    }
}

impl Zone {
    /// Prepares a zone. The margin, metres, makes a zone to keep out of larger, and one to stay in smaller.
    ///
    /// # Errors
    /// A shape, band or margin that makes no sense, or a polygon larger than a local frame holds.
    pub fn new(shape: &Shape, band: Band, rule: Rule, margin_m: f64) -> Result<Self, ZoneError> {
        if band.floor_m.partial_cmp(&band.ceiling_m) != Some(Ordering::Less) {
            return Err(ZoneError::Band { floor_m: band.floor_m, ceiling_m: band.ceiling_m });
        }
        if !(margin_m >= 0.0 && margin_m.is_finite()) {
            return Err(ZoneError::Margin(margin_m));
        }
        let (ground, ball) = match shape {
            Shape::Circle { centre, radius_m } => {
                let circle = Circle::new(*centre, *radius_m)?;
                (Ground::Circle(circle), circle.ball())
            }
            Shape::Polygon { outer, holes } => {
                let outline = Outline::new(outer, holes)?;
                let ball = outline.ball();
                (Ground::Outline(Box::new(outline)), ball)
            }
        };
        Ok(Self { ground, band, rule, margin_m, ball: ball.grown(margin_m) })
    }

    /// Where a stretch breaks the rule the most; `None` if it keeps it. The edge of the zone itself belongs to
    /// neither side.
    pub fn breach(&self, stretch: &Stretch) -> Option<Breach> {
        match self.rule {
            Rule::KeepOut => self.intrusion(stretch),
            Rule::KeepIn => self.excursion(stretch),
        }
    }

    /// Whether a stretch keeps the rule: quicker than to find out how much it breaks it.
    pub fn is_kept_by(&self, stretch: &Stretch) -> bool {
        match self.rule {
            Rule::KeepOut => self.intrusion(stretch).is_none(),
            Rule::KeepIn => {
                let ends = || [stretch.element.start(), stretch.element.end()];
                let is_outside = || ends().into_iter().any(|end| self.outside_m(end) > 0.0);
                let inside = self.side(stretch).unwrap_or_else(|| !is_outside());
                inside && self.excursion(stretch).is_none()
            }
        }
    }

    /// Whether a stretch may be in the zone, or nearer than the margin: quick, and no more than a first look.
    #[inline]
    pub fn may_be_near(&self, stretch: &Stretch) -> bool {
        self.may_be_near_any(&Neighbourhood(stretch.ball))
    }

    /// Whether one of some stretches may be in the zone, or nearer than the margin: one look for all of them.
    #[inline]
    pub fn may_be_near_any(&self, stretches: &Neighbourhood) -> bool {
        let Neighbourhood(ball) = stretches;
        self.ball.meets(ball)
            && match &self.ground {
                Ground::Circle(_) => true,
                Ground::Outline(outline) => outline.may_be_near(ball, self.margin_m),
            }
    }

    /// A lower bound of the distance between a stretch and the zone, margin included, metres; negative or 0 if they may meet.
    pub fn gap_m(&self, stretch: &Stretch) -> f64 {
        self.ball.gap_m(&stretch.ball)
    }

    /// How far a position is outside, without regard to altitude and margin, metres; 0 inside.
    pub fn outside_m(&self, position: LatLon) -> f64 {
        match &self.ground {
            Ground::Circle(circle) => circle.outside_m(position),
            Ground::Outline(outline) => outline.outside_m(position),
        }
    }

    /// How far an altitude is outside the band, metres; 0 inside.
    pub fn off_band_m(&self, altitude_m: f64) -> f64 {
        (-self.band.inside_m(altitude_m)).max(0.0)
    }

    /// The side of the edge, or of where the margin moves it, a stretch is certainly on: inside (true) or outside.
    fn side(&self, stretch: &Stretch) -> Option<bool> {
        match &self.ground {
            Ground::Circle(_) => None,
            Ground::Outline(outline) => outline.side(stretch, self.margin_m),
        }
    }

    fn intrusion(&self, stretch: &Stretch) -> Option<Breach> {
        if !self.may_be_near(stretch) || self.side(stretch) == Some(false) {
            return None;
        }
        let (from, to) = stretch.shares_within(&self.band)?;
        let length_m = stretch.element.length_m();
        let part = part_of(&stretch.element, from, to);
        let worst = match &self.ground {
            Ground::Circle(circle) => circle.deepest(&part, self.margin_m),
            Ground::Outline(outline) => outline.deepest(&part, self.margin_m),
        }?;
        let share = if length_m > 0.0 { from + worst.along_m / length_m } else { from };
        let altitude_m = stretch.altitude_m(share);
        Some(Breach {
            distance_m: share * length_m,
            position: part.point_at(worst.along_m),
            altitude_m,
            horizontal_m: worst.wrong_m,
            vertical_m: self.band.inside_m(altitude_m),
        })
    }

    fn excursion(&self, stretch: &Stretch) -> Option<Breach> {
        let worst = match &self.ground {
            _ if self.side(stretch) == Some(true) => None,
            Ground::Circle(circle) => circle.farthest(&stretch.element, self.margin_m),
            Ground::Outline(outline) => outline.farthest(&stretch.element, self.margin_m),
        };
        let too_far = |altitude_m: f64| self.off_band_m(altitude_m);
        let length_m = stretch.element.length_m();
        let (along_m, horizontal_m) = match worst {
            Some(worst) => (worst.along_m, worst.wrong_m),
            None if too_far(stretch.end_altitude_m) > too_far(stretch.start_altitude_m) => (length_m, 0.0),
            None => (0.0, 0.0),
        };
        let altitude_m = stretch.altitude_m(if length_m > 0.0 { along_m / length_m } else { 0.0 });
        let vertical_m = too_far(altitude_m);
        (horizontal_m > 0.0 || vertical_m > 0.0).then(|| Breach {
            distance_m: along_m,
            position: stretch.element.point_at(along_m),
            altitude_m,
            horizontal_m,
            vertical_m,
        })
    }
}

/// The part of an element between two shares of its length.
fn part_of(element: &PathElement, from: f64, to: f64) -> PathElement {
    if from <= 0.0 && to >= 1.0 {
        return *element;
    }
    match *element {
        PathElement::Line { .. } => {
            let length_m = element.length_m();
            PathElement::Line { from: element.point_at(from * length_m), to: element.point_at(to * length_m) }
        }
        PathElement::Arc { centre, radius_m, start_bearing_deg, sweep_deg } => PathElement::Arc {
            centre,
            radius_m,
            start_bearing_deg: start_bearing_deg + from * sweep_deg,
            sweep_deg: (to - from) * sweep_deg,
        },
    }
}
