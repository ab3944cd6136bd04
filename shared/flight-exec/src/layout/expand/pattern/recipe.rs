//! What a pattern is made from: the values of its leg as they were.

use super::super::ExpandError;
use super::super::area::{Outline, geometric};
use super::super::spacing::spacing_m;
use super::super::track::{Approach, side};
use super::LaidOut;
use super::heights::Heights;
use crate::layout::world::World;
use flight_plan::{Pattern as Plan, Place, Value};
use geometry::pattern as shapes;
use geometry::scan::Entry;
use geometry::{LatLon, LocalFrame, Pattern, Turn, Vec2};
use serde::{Deserialize, Serialize};

/// Loops of a contour that is to fill its area: more than any has.
const MAX_LOOPS: u64 = 10_000;

/// Numbers and positions only.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Recipe {
    shape: Shape,
    heights: Option<Heights>,
    /// Stays what it was when the pattern was begun: a gust must not move the tracks.
    turn_radius_m: f64,
    tolerance_m: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Shape {
    Spiral { centre: LatLon, inner_m: f64, outer_m: f64, spacing_m: f64, inward: bool, turn: Turn },
    ExpandingSquare { centre: LatLon, spacing_m: f64, heading_deg: f64, radius_m: f64, turn: Turn },
    Sector { centre: LatLon, radius_m: f64, sectors: u64, heading_deg: f64, passes: u64, turn: Turn },
    TrackLine { route: Vec<LatLon>, spacing_m: f64, returns: bool },
    Corridor { route: Vec<LatLon>, width_m: f64, spacing_m: f64 },
    Contour { area: Outline, spacing_m: f64, loops: Option<u64>, inward: bool, turn: Turn },
    FigureEight { centre: LatLon, radius_m: f64, heading_deg: f64, turns: u64, turn: Turn },
}

impl Recipe {
    /// # Errors
    /// Values that can't be computed.
    pub fn of(pattern: &Plan, approach: &Approach, world: &World) -> Result<Self, ExpandError> {
        let heights = match pattern {
            Plan::Contour { levels, level_step_m, .. } => {
                Heights::of(levels.as_ref(), level_step_m.as_ref(), approach.level, world)?
            }
            _ => None,
        };
        Ok(Self {
            shape: Shape::of(pattern, approach, world)?,
            heights,
            turn_radius_m: world.turn_radius_m(approach.airspeed_mps),
            tolerance_m: world.config.arc_tolerance_m,
        })
    }

    /// The same with another one's turns.
    pub fn with_turns_of(self, other: &Self) -> Self {
        Self { turn_radius_m: other.turn_radius_m, ..self }
    }

    /// It is flown round and round: a change doesn't make anything of it new.
    pub fn goes_round(&self) -> bool {
        matches!(self.shape, Shape::FigureEight { .. })
    }

    /// All its points are corners around arcs.
    pub fn is_curve(&self) -> bool {
        matches!(self.shape, Shape::FigureEight { .. } | Shape::Spiral { .. })
    }

    /// The pattern, begun near a position where it can.
    ///
    /// # Errors
    /// There is none.
    pub fn lay_out(&self, from: LatLon) -> Result<LaidOut, ExpandError> {
        let (pattern, frame) = self.in_a_plane(from)?;
        Ok(LaidOut::new(pattern, frame, self.heights))
    }

    fn in_a_plane(&self, from: LatLon) -> Result<(Pattern, LocalFrame), ExpandError> {
        let centre = Vec2::default();
        let tolerance_m = self.tolerance_m;
        match self.shape {
            Shape::TrackLine { ref route, spacing_m, returns } => along(route, |route, _| {
                let p = shapes::TrackLineParameters { spacing_m, returns, pairs: 1, first_side: Turn::Right };
                shapes::TrackLine::new(route, &p).map(Pattern::TrackLine)
            }),
            Shape::Corridor { ref route, width_m, spacing_m } => along(route, |route, frame| {
                let p = shapes::CorridorParameters {
                    width_m,
                    spacing_m,
                    // the turns between tracks are beyond the route's ends
                    overshoot_m: self.turn_radius_m,
                    entry: Entry::Nearest(frame.to_local(from)),
                    turn_radius_m: self.turn_radius_m,
                };
                shapes::Corridor::new(route, &p).map(Pattern::Corridor)
            }),
            Shape::Contour { ref area, spacing_m, loops, inward, turn } => {
                let (frame, polygon) = area.polygon()?;
                let p = shapes::ContourParameters {
                    spacing_m,
                    first_m: 0.5 * spacing_m,
                    side: if inward { shapes::Side::Inward } else { shapes::Side::Outward },
                    levels: loops.unwrap_or(MAX_LOOPS),
                    turn,
                    entry: frame.to_local(from),
                    turn_radius_m: self.turn_radius_m,
                    tolerance_m,
                };
                // without a number of loops the area is to be filled
                let lay_out =
                    if loops.is_none() { shapes::Contours::covering } else { shapes::Contours::new };
                laid_out(lay_out(&polygon, &p).map(Pattern::Contours), frame)
            }
            Shape::Spiral { centre: at, inner_m, outer_m, spacing_m, inward, turn } => {
                let p = shapes::SpiralParameters {
                    centre,
                    radius_m: outer_m,
                    inner_radius_m: inner_m,
                    spacing_m,
                    start_bearing_deg: 0.0,
                    turn,
                    inward,
                    tolerance_m,
                };
                let frame = LocalFrame::new(at);
                laid_out(begun_near(p, frame.to_local(from)).map(Pattern::Spiral), frame)
            }
            Shape::ExpandingSquare { centre: at, spacing_m, heading_deg, radius_m, turn } => {
                let legs = shapes::ExpandingSquare::legs_to_cover(radius_m, spacing_m).map_err(geometric)?;
                let p = shapes::SquareParameters { centre, spacing_m, heading_deg, turn, legs };
                laid_out(shapes::ExpandingSquare::new(&p).map(Pattern::ExpandingSquare), LocalFrame::new(at))
            }
            Shape::Sector { centre: at, radius_m, sectors, heading_deg, passes, turn } => {
                let sectors = u32::try_from(sectors).unwrap_or(u32::MAX);
                let p = shapes::SectorParameters { centre, radius_m, sectors, heading_deg, turn, passes };
                laid_out(shapes::SectorSearch::new(&p).map(Pattern::SectorSearch), LocalFrame::new(at))
            }
            Shape::FigureEight { centre: at, radius_m, heading_deg, turns: laps, turn } => {
                let p =
                    shapes::FigureEightParameters { centre, heading_deg, radius_m, turn, laps, tolerance_m };
                laid_out(shapes::FigureEight::new(&p).map(Pattern::FigureEight), LocalFrame::new(at))
            }
        }
    }
}

fn laid_out(
    pattern: Result<Pattern, shapes::PatternError>,
    frame: LocalFrame,
) -> Result<(Pattern, LocalFrame), ExpandError> {
    Ok((pattern.map_err(geometric)?, frame))
}

/// A pattern along a route, in a frame around it.
fn along(
    route: &[LatLon],
    pattern: impl FnOnce(&shapes::Route, &LocalFrame) -> Result<Pattern, shapes::PatternError>,
) -> Result<(Pattern, LocalFrame), ExpandError> {
    let frame = LocalFrame::around(route)
        .filter(|frame| route.iter().all(|p| frame.origin().distance_m(*p) <= frame.radius_m()));
    let frame = frame.ok_or_else(|| {
        let advice =
            "give it two points or more, none of them beyond the pole, or divide it among several legs";
        ExpandError::Geometry(format!("the route is too short or too long for one pattern: {advice}"))
    })?;
    let points: Vec<Vec2> = route.iter().map(|p| frame.to_local(*p)).collect();
    let route = shapes::Route::new(&points).map_err(geometric)?;
    laid_out(pattern(&route, &frame), frame)
}

impl Shape {
    fn of(pattern: &Plan, approach: &Approach, world: &World) -> Result<Self, ExpandError> {
        let number = |value: &Value<f64>| world.number(value);
        let spacing = |spacing| spacing_m(spacing, approach.level, world);
        Ok(match pattern {
            Plan::Spiral { centre, inner_radius_m, outer_radius_m, spacing: s, inward, turn } => {
                Shape::Spiral {
                    centre: world.place(centre)?,
                    inner_m: number(inner_radius_m)?,
                    outer_m: number(outer_radius_m)?,
                    spacing_m: spacing(s)?,
                    inward: *inward,
                    turn: side(*turn),
                }
            }
            Plan::ExpandingSquare { centre, spacing: s, heading_deg, radius_m, turn } => {
                Shape::ExpandingSquare {
                    centre: world.place(centre)?,
                    spacing_m: spacing(s)?,
                    heading_deg: number(heading_deg)?,
                    radius_m: number(radius_m)?,
                    turn: side(*turn),
                }
            }
            Plan::Sector { centre, radius_m, sectors, heading_deg, passes, turn } => Shape::Sector {
                centre: world.place(centre)?,
                radius_m: number(radius_m)?,
                sectors: whole("sectors", number(sectors)?)?,
                heading_deg: number(heading_deg)?,
                passes: whole("passes", number(passes)?)?,
                turn: side(*turn),
            },
            Plan::TrackLine { route, spacing: s, returns } => {
                Shape::TrackLine { route: places(route, world)?, spacing_m: spacing(s)?, returns: *returns }
            }
            Plan::Corridor { route, width_m, spacing: s } => Shape::Corridor {
                route: places(route, world)?,
                width_m: number(width_m)?,
                spacing_m: spacing(s)?,
            },
            Plan::Contour { area, spacing: s, loops, inward, turn, .. } => Shape::Contour {
                area: Outline::of(area, world)?,
                spacing_m: spacing(s)?,
                loops: loops.as_ref().map(|n| whole("loops", number(n)?)).transpose()?,
                inward: *inward,
                turn: side(*turn),
            },
            Plan::FigureEight { centre, radius_m, heading_deg, turns, turn } => Shape::FigureEight {
                centre: world.place(centre)?,
                radius_m: number(radius_m)?,
                heading_deg: number(heading_deg)?,
                turns: whole("turns", number(turns)?)?,
                turn: side(*turn),
            },
        })
    }
}

/// A spiral turned so that its first waypoint is on the side the path comes from.
fn begun_near(p: shapes::SpiralParameters, from: Vec2) -> Result<shapes::Spiral, shapes::PatternError> {
    let spiral = shapes::Spiral::new(&p)?;
    let begin = spiral.vertex(0).map(|v| v.at).filter(|at| at.length() > 1.0);
    let Some(begin) = begin.filter(|_| from.length() > 1.0) else { return Ok(spiral) };
    let start_bearing_deg = (from.bearing_rad() - begin.bearing_rad()).to_degrees();
    shapes::Spiral::new(&shapes::SpiralParameters { start_bearing_deg, ..p })
}

fn places(route: &[Place], world: &World) -> Result<Vec<LatLon>, ExpandError> {
    route.iter().map(|place| Ok(world.place(place)?)).collect()
}

/// A value that counts something.
pub(super) fn whole(what: &str, value: f64) -> Result<u64, ExpandError> {
    if (1.0..=1e9).contains(&value) && value.fract() == 0.0 {
        return Ok(value as u64);
    }
    Err(ExpandError::Geometry(format!("{value} {what}: give a whole number from 1 on")))
}
