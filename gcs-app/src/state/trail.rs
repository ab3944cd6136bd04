//! Where the aircraft has been: bounded, and as fine as it can be within that bound.

use geometry::LatLon;

/// Most points kept.
const CAPACITY: usize = 8192;

/// A flown track. When it is full, every second point of it goes, and from then on points are
/// taken at twice the interval: a flight of any length keeps its whole shape.
#[derive(Debug, Clone)]
pub struct Trail {
    points: Vec<LatLon>,
    last_s: f64,
    interval_s: f64,
    changes: u64,
}

impl Default for Trail {
    fn default() -> Self {
        Self { points: Vec::new(), last_s: f64::NEG_INFINITY, interval_s: 0.4, changes: 0 }
    }
}

impl Trail {
    /// Adds a position with its source time, seconds; one that is too soon is left out. A clock
    /// that went back (another flight) starts a new trail.
    pub fn add(&mut self, position: LatLon, time_s: f64) {
        if !position.is_valid() || !time_s.is_finite() {
            return;
        }
        if time_s < self.last_s - 5.0 {
            *self = Self { changes: self.changes + 1, ..Self::default() };
        }
        if time_s < self.last_s + self.interval_s {
            return;
        }
        if self.points.len() >= CAPACITY {
            self.thin();
        }
        self.points.push(position);
        self.last_s = time_s;
        self.changes += 1;
    }

    fn thin(&mut self) {
        let mut keep = false;
        self.points.retain(|_| {
            keep = !keep;
            keep
        });
        self.interval_s *= 2.0;
    }

    /// The points, oldest first.
    pub fn points(&self) -> &[LatLon] {
        &self.points
    }
    /// Differs whenever the points differ.
    pub fn changes(&self) -> u64 {
        self.changes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flight_of_a_week_stays_bounded_and_keeps_its_shape() {
        let mut trail = Trail::default();
        for i in 0..604_800 {
            trail.add(LatLon::new(0.0, f64::from(i) * 1e-4), f64::from(i));
        }
        assert!(trail.points().len() <= CAPACITY && trail.points().len() > CAPACITY / 4);
        assert!(trail.points()[0].lon_deg < 0.1, "the beginning is still there");
        assert!(trail.points().last().unwrap().lon_deg > 60.3, "so is the end");
    }

    #[test]
    fn a_clock_that_goes_back_starts_a_new_trail() {
        let mut trail = Trail::default();
        trail.add(LatLon::new(1.0, 1.0), 1000.0);
        trail.add(LatLon::new(2.0, 2.0), 3.0);
        assert_eq!(trail.points(), [LatLon::new(2.0, 2.0)]);
        trail.add(LatLon::new(f64::NAN, 2.0), 9.0);
        assert_eq!(trail.points().len(), 1);
    }
}
