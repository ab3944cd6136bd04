//! Areas of patterns, with the values of now.

use super::ExpandError;
use crate::layout::world::World;
use flight_plan::Area;
use geometry::{LatLon, LocalFrame, Polygon, Vec2};
use serde::{Deserialize, Serialize};

/// Circles become polygons within this, metres.
const CIRCLE_TOLERANCE_M: f64 = 2.0;

/// An area.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Outline {
    /// A circle.
    Circle {
        /// Its centre.
        centre: LatLon,
        /// Metres.
        radius_m: f64,
    },
    /// A simple polygon with holes.
    Polygon {
        /// Not closed.
        corners: Vec<LatLon>,
        /// Each not closed.
        holes: Vec<Vec<LatLon>>,
    },
}

impl Outline {
    /// # Errors
    /// One of its values can't be computed.
    pub fn of(area: &Area, world: &World) -> Result<Self, ExpandError> {
        Ok(match area {
            Area::Circle { centre, radius_m } => {
                Outline::Circle { centre: world.place(centre)?, radius_m: world.number(radius_m)? }
            }
            Area::Polygon { corners, holes } => {
                Outline::Polygon { corners: corners.clone(), holes: holes.clone() }
            }
            Area::Expression(source) => {
                Outline::Polygon { corners: world.polygon(source)?, holes: Vec::new() }
            }
        })
    }

    /// As a polygon in a frame of its own.
    ///
    /// # Errors
    /// It is none.
    pub fn polygon(&self) -> Result<(LocalFrame, Polygon), ExpandError> {
        match self {
            Outline::Circle { centre, radius_m } => {
                let frame = LocalFrame::new(*centre);
                let circle = Polygon::circle(Vec2::default(), *radius_m, CIRCLE_TOLERANCE_M);
                Ok((frame, circle.map_err(geometric)?))
            }
            Outline::Polygon { corners, holes } => {
                // in its middle, where a heading is true
                let frame =
                    LocalFrame::around(corners).unwrap_or_else(|| LocalFrame::new(LatLon::new(0.0, 0.0)));
                Ok((frame, Polygon::from_geo(&frame, corners, holes).map_err(geometric)?))
            }
        }
    }
}

/// What geometry says against it.
pub fn geometric(error: impl std::fmt::Display) -> ExpandError {
    ExpandError::Geometry(error.to_string())
}
