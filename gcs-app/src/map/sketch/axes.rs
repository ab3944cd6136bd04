//! How far an outline reaches along a heading.

use geometry::Vec2;

/// How far an outline reaches along a heading and across it.
pub(super) struct Axes {
    along: Vec2,
    across: Vec2,
    along_m: (f64, f64),
    across_m: (f64, f64),
}

impl Axes {
    /// Of an outline's corners.
    pub(super) fn of(corners: &[Vec2], heading_deg: f64) -> Self {
        let along = Vec2::from_bearing_rad(heading_deg.to_radians());
        let across = Vec2::from_bearing_rad((heading_deg + 90.0).to_radians());
        let reach = |axis: Vec2| {
            corners
                .iter()
                .map(|corner| corner.dot(axis))
                .fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
        };
        Self { along, across, along_m: reach(along), across_m: reach(across) }
    }

    /// -1 is at one end, 1 at the other.
    pub(super) fn place(&self, across: f64, along: f64) -> Vec2 {
        let on = |(low, high): (f64, f64), share: f64| (low + high) / 2.0 + (high - low) / 2.0 * share;
        self.across * on(self.across_m, across) + self.along * on(self.along_m, along)
    }

    /// The middle of the outline.
    pub(super) fn middle(&self) -> Vec2 {
        self.place(0.0, 0.0)
    }

    /// Half of its length along the heading, metres.
    pub(super) fn half_m(&self) -> f64 {
        (self.along_m.1 - self.along_m.0) / 2.0
    }
}
