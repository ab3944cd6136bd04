//! Which point of a path an aircraft has come to.

use super::Point;
use geometry::{LatLon, LocalFrame, Vec2};

/// Where an aircraft is, and which way it goes.
#[derive(Debug, Clone, Copy)]
pub struct Underway {
    /// Where.
    pub at: LatLon,
    /// Its track; `None`: it circles, and goes every way in turn.
    pub track_deg: Option<f64>,
}

impl Underway {
    /// The nearest point of these parts of a path, of those where it goes the aircraft's way: the way out to an approach and the way
    /// in lie one above the other, and so do the lines of a scan.
    pub fn nearest<'a>(&self, parts: impl Iterator<Item = &'a [Point]>) -> Option<&'a Point> {
        let frame = LocalFrame::new(self.at);
        let track = self.track_deg.map(|deg| Vec2::from_bearing_rad(deg.to_radians()));
        let goes_its_way = |way: Vec2| track.is_none_or(|track| way.dot(track) >= 0.0);
        let spans = parts.flat_map(|part| part.iter().zip(part.iter().skip(1)));
        let spans =
            spans.map(|(from, to)| (from, frame.to_local(from.position), frame.to_local(to.position)));
        let same_way = spans.filter(|(_, from, to)| goes_its_way(*to - *from));
        same_way.min_by(|(_, a, _), (_, b, _)| a.length().total_cmp(&b.length())).map(|(point, ..)| point)
    }
}
