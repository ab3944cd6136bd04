//! The sector search: triangles whose common corner is the datum, joined by straight flights through it.

use super::{PatternError, Vertex, counted, finite, positive};
use crate::Vec2;
use crate::turn::Turn;
use serde::{Deserialize, Serialize};

/// A second (third …) pass is turned by this from the one before, degrees (IAMSAR).
pub const PASS_TURN_DEG: f64 = 30.0;
/// After so many passes the first would be repeated.
const MAX_PASSES: u64 = 12;

/// What makes a sector search.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SectorParameters {
    /// The datum.
    pub centre: Vec2,
    /// Length of the legs from and to it, metres.
    pub radius_m: f64,
    /// 3 (every turn 120°, 9 radii in all), 4 (sectors of 90°, every turn 135°) or 6 (the three sectors, then
    /// the three gaps between them).
    pub sectors: u32,
    /// Direction of the first leg, degrees true.
    pub heading_deg: f64,
    /// Side of its turns.
    pub turn: Turn,
    /// How often the whole is flown, each time turned by [`PASS_TURN_DEG`].
    pub passes: u64,
}

/// A sector search; its waypoints are the datum and the corners, its tracks the triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectorSearch {
    p: SectorParameters,
}

impl SectorSearch {
    /// Lays it out.
    ///
    /// # Errors
    /// A parameter that makes no sense.
    pub fn new(p: &SectorParameters) -> Result<Self, PatternError> {
        finite("centre", p.centre.length())?;
        positive("radius", p.radius_m)?;
        finite("heading", p.heading_deg)?;
        counted("passes", p.passes, MAX_PASSES)?;
        if !matches!(p.sectors, 3 | 4 | 6) {
            return Err(PatternError::Sectors(p.sectors));
        }
        Ok(Self { p: *p })
    }

    fn triangles(&self) -> u64 {
        u64::from(self.p.sectors) * self.p.passes
    }

    /// Angle of a sector at the datum, degrees. Flying straight on through the datum ends where it began after
    /// three sectors of 60°, or four of 90°.
    fn sector_deg(&self) -> f64 {
        if self.p.sectors == 4 { 90.0 } else { 60.0 }
    }

    /// Bearing of a triangle's first corner from the datum, degrees.
    fn first_corner_deg(&self, triangle: u64) -> f64 {
        let sectors = u64::from(self.p.sectors);
        let (pass, place) = (triangle / sectors, triangle % sectors);
        let onward_deg = (180.0 + self.sector_deg()) * place as f64;
        // the second three of six lie between the first
        let between_deg = if self.p.sectors == 6 && place >= 3 { self.sector_deg() } else { 0.0 };
        let side = self.p.turn.sign();
        self.p.heading_deg + PASS_TURN_DEG * pass as f64 + side * (onward_deg + between_deg)
    }

    /// See [`super::Pattern::count`].
    pub fn count(&self) -> u64 {
        1 + 3 * self.triangles()
    }

    /// See [`super::Pattern::vertex`].
    pub fn vertex(&self, index: u64) -> Option<Vertex> {
        if index >= self.count() {
            return None;
        }
        let Some(later) = index.checked_sub(1) else {
            return Some(Vertex { at: self.p.centre, track: 0, on_track: false });
        };
        let track = later / 3;
        let first_deg = self.first_corner_deg(track);
        let corner = |deg: f64| self.p.centre + Vec2::from_bearing_rad(deg.to_radians()) * self.p.radius_m;
        let at = match later % 3 {
            0 => corner(first_deg),
            1 => corner(first_deg + self.p.turn.sign() * self.sector_deg()),
            _ => self.p.centre,
        };
        Some(Vertex { at, track, on_track: true })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::course_change_deg;

    fn search(sectors: u32, turn: Turn, passes: u64) -> Vec<Vec2> {
        let p = SectorParameters {
            centre: Vec2::new(700.0, 300.0),
            radius_m: 2000.0,
            sectors,
            heading_deg: 345.0,
            turn,
            passes,
        };
        let search = SectorSearch::new(&p).unwrap();
        assert_eq!(search.vertex(search.count()), None);
        (0..search.count()).map(|i| search.vertex(i).unwrap().at).collect()
    }

    fn courses_deg(points: &[Vec2]) -> Vec<f64> {
        points.windows(2).map(|w| (w[1] - w[0]).bearing_rad().to_degrees()).collect()
    }

    fn turns_deg(points: &[Vec2]) -> Vec<f64> {
        courses_deg(points).windows(2).map(|c| course_change_deg(c[0], c[1]).round()).collect()
    }

    #[test]
    fn three_sectors_are_nine_radii_and_every_turn_is_120_degrees() {
        for turn in [Turn::Right, Turn::Left] {
            let points = search(3, turn, 1);
            let length_m: f64 = points.windows(2).map(|w| (w[1] - w[0]).length()).sum();
            assert!((length_m - 9.0 * 2000.0).abs() < 1e-6);
            let side = turn.sign() * 120.0;
            // straight on through the datum
            assert_eq!(turns_deg(&points), [side, side, 0.0, side, side, 0.0, side, side]);
            assert!((courses_deg(&points)[0] - -15.0).abs() < 1e-9);
            // back at the datum on the course of the first leg
            assert!((courses_deg(&points)[8] - -15.0).abs() < 1e-9);
            assert_eq!(points[0], points[9]);
        }
    }

    #[test]
    fn the_second_pass_is_turned_by_30_degrees() {
        let points = search(3, Turn::Right, 2);
        assert_eq!(points.len(), 19);
        let courses = courses_deg(&points);
        for (first, second) in courses[..9].iter().zip(&courses[9..]) {
            assert!((course_change_deg(*first, *second) - 30.0).abs() < 1e-6);
        }
    }

    #[test]
    fn four_and_six_sectors_fill_the_circle() {
        for (sectors, sector_deg) in [(4, 90.0), (6, 60.0)] {
            let points = search(sectors, Turn::Left, 1);
            let mut middles: Vec<f64> = points
                .chunks(3)
                .filter_map(|c| c.get(1..3))
                .map(|c| ((c[0] + c[1]) * 0.5 - points[0]).bearing_rad().to_degrees().rem_euclid(360.0))
                .collect();
            middles.sort_by(f64::total_cmp);
            assert_eq!(middles.len(), sectors as usize);
            assert!(middles.windows(2).all(|w| (w[1] - w[0] - sector_deg).abs() < 1e-6), "{middles:?}");
        }
        let quarter_turns = turns_deg(&search(4, Turn::Left, 1));
        assert!(quarter_turns.iter().all(|&t| t == 0.0 || t == -135.0), "{quarter_turns:?}");
    }

    #[test]
    fn other_numbers_of_sectors_are_refused() {
        let p = SectorParameters {
            centre: Vec2::default(),
            radius_m: 500.0,
            sectors: 5,
            heading_deg: 0.0,
            turn: Turn::Right,
            passes: 1,
        };
        assert_eq!(SectorSearch::new(&p), Err(PatternError::Sectors(5)));
        let endless = SectorParameters { sectors: 3, passes: 13, ..p };
        assert!(SectorSearch::new(&endless).is_err());
    }
}
