//! Names on the map. What draws a thing asks for its name; at the end of the frame each stands at the first of its spots that is
//! free, the most important first. One for which none is free is left out: pointing at the thing or selecting it tells its name.

use super::text;
use crate::chart::labels::Labels;
use crate::theme::Palette;
use egui::{Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Vec2, vec2};
use std::sync::Arc;

/// So many are looked at in a frame; more could not be read.
const MOST: usize = 400;
/// Between two names, screen points.
const GAP: f32 = 1.0;
/// Around the text on a plate, screen points.
const PLATE: Vec2 = vec2(4.0, 1.0);
/// A sentence on a plate takes several lines rather than more of the map's width, screen points.
const WIDEST: f32 = 240.0;

/// What a name is of, the most important first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rank {
    /// What is wrong, or would follow an alarm.
    Fault,
    /// The aircraft's height and speed.
    Aircraft,
    /// What is selected or pointed at: that may be much at once.
    Selected,
    /// A fix, a runway, a place that a variable gives.
    Place,
    /// A leg.
    Leg,
    /// A way from a fork, an emergency plan, a path beside the planned one.
    Way,
    /// A zone.
    Zone,
    /// A line of the graticule, a ring.
    Grid,
}

impl Rank {
    /// The rank of a thing that may be selected.
    pub fn or_selected(self, is_selected: bool) -> Self {
        if is_selected { Self::Selected } else { self }
    }

    /// Rather over the scale or the edge of the map than not there at all.
    fn must_be_seen(self) -> bool {
        self <= Self::Selected
    }
}

/// Where a name may stand: this corner, side or middle of it is there.
pub type Spot = (Pos2, Align2);

/// Beside a point on the right, the left, above and below, so many screen points away.
pub fn beside(at: Pos2, gap: f32) -> [Spot; 4] {
    [
        (at + vec2(gap, -1.0), Align2::LEFT_CENTER),
        (at + vec2(-gap, -1.0), Align2::RIGHT_CENTER),
        (at - vec2(0.0, gap), Align2::CENTER_BOTTOM),
        (at + vec2(0.0, gap), Align2::CENTER_TOP),
    ]
}

/// The same, below and above first.
pub fn below(at: Pos2, gap: f32) -> [Spot; 4] {
    let [right, left, above, below] = beside(at, gap);
    [below, above, right, left]
}

/// At a point's corners, below on the right first.
pub fn corners(at: Pos2, away: Vec2) -> [Spot; 4] {
    let Vec2 { x, y } = away;
    [
        (at + vec2(x, y), Align2::LEFT_TOP),
        (at + vec2(x, -y), Align2::LEFT_BOTTOM),
        (at + vec2(-x, y), Align2::RIGHT_TOP),
        (at + vec2(-x, -y), Align2::RIGHT_BOTTOM),
    ]
}

/// The same, above on the right first.
pub fn corners_above(at: Pos2, away: Vec2) -> [Spot; 4] {
    let [right_below, right_above, left_below, left_above] = corners(at, away);
    [right_above, right_below, left_above, left_below]
}

/// What a name stands on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ground {
    /// A halo around its letters.
    Halo,
    /// A plate, which is kept within the map.
    Plate,
}

/// A name that is asked for.
#[derive(Debug, Clone)]
pub struct Name {
    /// Whose it is.
    pub rank: Rank,
    /// Where it may stand, the best first.
    pub spots: [Spot; 4],
    /// What it says.
    pub text: String,
    /// Of its letters, points.
    pub size: f32,
    /// Of its letters; on a plate they have that of texts.
    pub colour: Color32,
    /// What it stands on.
    pub ground: Ground,
}

/// The names that are asked for in a frame, and what is to be kept clear of them.
#[derive(Debug, Default)]
pub struct Names {
    /// Each with what is left of it where it is drawn faint.
    asked: Vec<(Name, f32)>,
    clear: Vec<Rect>,
}

impl Names {
    /// Asks for a name, as opaque as the painter paints.
    pub fn ask(&mut self, painter: &Painter, name: Name) {
        self.asked.push((name, painter.opacity()));
    }

    /// No name stands there.
    pub fn keep_clear(&mut self, rect: Rect) {
        self.clear.push(rect);
    }

    /// Writes those for which there is room. Returns where something stands now.
    pub fn write(mut self, painter: &Painter, p: &Palette) -> Labels {
        // of one rank, those that were asked for first
        self.asked.sort_by_key(|(name, _)| name.rank);
        self.asked.truncate(MOST);
        let wanted: Vec<Wanted> = self.asked.iter().map(|(name, _)| Wanted::from(name)).collect();
        // few have room, and these need not be laid out again to be written
        let mut letters: Vec<Option<Arc<Galley>>> = vec![None; wanted.len()];
        let measure = |index: usize| {
            let laid_out = self.asked.get(index).zip(letters.get_mut(index));
            laid_out.map_or(Vec2::ZERO, |((name, _), letters)| {
                size(letters.insert(laid_out_by(painter, name)), name.ground)
            })
        };
        let (places, labels) = placed(&wanted, &self.clear, painter.clip_rect(), measure);
        for (((name, opacity), rect), letters) in self.asked.iter().zip(places).zip(letters) {
            let (Some(rect), Some(letters)) = (rect, letters) else { continue };
            let mut painter = painter.clone();
            if *opacity < 1.0 {
                painter.multiply_opacity(*opacity);
            }
            match name.ground {
                Ground::Halo => text::with_halo(&painter, rect.min, letters, name.colour, p),
                Ground::Plate => text::on_plate(&painter, rect, PLATE, letters, p),
            }
        }
        labels
    }
}

fn laid_out_by(painter: &Painter, name: &Name) -> Arc<Galley> {
    let wrap_width = match name.ground {
        Ground::Halo => f32::INFINITY,
        Ground::Plate => WIDEST,
    };
    painter.layout(name.text.clone(), FontId::proportional(name.size), Color32::PLACEHOLDER, wrap_width)
}

/// How large it is with its plate, screen points.
fn size(letters: &Galley, ground: Ground) -> Vec2 {
    match ground {
        Ground::Halo => letters.size(),
        Ground::Plate => letters.size() + 2.0 * PLATE,
    }
}

/// What of a name says where it stands.
struct Wanted {
    rank: Rank,
    spots: [Spot; 4],
    ground: Ground,
    /// It is not smaller, whatever its letters are: what has no room for that need not be measured.
    least: Vec2,
}

impl From<&Name> for Wanted {
    fn from(name: &Name) -> Self {
        let &Name { rank, spots, ground, size, .. } = name;
        let least = vec2(name.text.chars().count() as f32 * 0.2, 1.0) * size;
        Self { rank, spots, ground, least }
    }
}

/// Where each of them stands, as large as it measures; those of higher rank come first. With them, where something stands now.
fn placed(
    wanted: &[Wanted],
    clear: &[Rect],
    map: Rect,
    mut measure: impl FnMut(usize) -> Vec2,
) -> (Vec<Option<Rect>>, Labels) {
    let mut furniture = Labels::new(map.into());
    clear.iter().for_each(|rect| furniture.take((*rect).into()));
    let mut names = Labels::new(map.into());
    let mut place = |(index, name): (usize, &Wanted)| {
        let rects = |size: Vec2| {
            name.spots.map(|(at, anchor)| match name.ground {
                Ground::Halo => anchor.anchor_size(at, size),
                Ground::Plate => text::within(anchor.anchor_size(at, size), map),
            })
        };
        let is_apart = |rect: &Rect| names.is_free(&rect.expand(GAP).into());
        let is_inside = |rect: &Rect| name.ground == Ground::Plate || map.contains_rect(*rect);
        let is_free = |rect: &Rect| is_inside(rect) && furniture.is_free(&(*rect).into()) && is_apart(rect);
        let must_be_seen = name.rank.must_be_seen();
        if !must_be_seen && !rects(name.least).iter().any(is_free) {
            return None;
        }
        let rects = rects(measure(index));
        let found = rects.into_iter().find(is_free);
        let beside = || rects.iter().flat_map(|rect| slid(*rect, clear)).filter(is_free);
        let nearest = || beside().min_by(|a, b| far_from(&rects, a).total_cmp(&far_from(&rects, b)));
        let found = found.or_else(|| nearest().filter(|_| must_be_seen));
        let found = found.or_else(|| rects.into_iter().find(is_apart).filter(|_| must_be_seen));
        // a plate can be read over what else is there, too
        let is_never_left_out = name.rank <= Rank::Aircraft && name.ground == Ground::Plate;
        let found = found.or_else(|| rects.first().copied().filter(|_| is_never_left_out));
        found.inspect(|rect| names.take((*rect).into()))
    };
    let places = wanted.iter().enumerate().map(&mut place).collect();
    clear.iter().for_each(|rect| names.take((*rect).into()));
    (places, names)
}

/// A name that is moved farther is taken for another thing's, screen points.
const FARTHEST: f32 = 120.0;

/// Where a name comes clear of what it covers on the map's edge: beside each of that, and not far away.
fn slid(rect: Rect, clear: &[Rect]) -> impl Iterator<Item = Rect> + use<'_> {
    let covered = clear.iter().filter(move |taken| taken.intersects(rect));
    let moves = covered.flat_map(move |taken| {
        let taken = taken.expand(GAP);
        [
            vec2(taken.right() - rect.left(), 0.0),
            vec2(taken.left() - rect.right(), 0.0),
            vec2(0.0, taken.top() - rect.bottom()),
            vec2(0.0, taken.bottom() - rect.top()),
        ]
    });
    moves.filter(|by| by.length() <= FARTHEST).map(move |by| rect.translate(by))
}

/// How far a place is from the best spot, screen points.
fn far_from(spots: &[Rect], place: &Rect) -> f32 {
    spots.first().map_or(0.0, |best| best.center().distance(place.center()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    const MAP: Rect = Rect { min: pos2(0.0, 0.0), max: pos2(800.0, 600.0) };

    /// A name and its size.
    type Asked = (Wanted, Vec2);

    fn name(rank: Rank, at: Pos2, width: f32) -> Asked {
        let (spots, ground, size) = (beside(at, 9.0), Ground::Halo, vec2(width, 14.0));
        (Wanted { rank, spots, ground, least: 0.4 * size }, size)
    }

    fn places(asked: Vec<Asked>, clear: &[Rect]) -> Vec<Option<Rect>> {
        let (wanted, sizes): (Vec<Wanted>, Vec<Vec2>) = asked.into_iter().unzip();
        placed(&wanted, clear, MAP, |index| sizes[index]).0
    }

    /// Names at places as they come, the higher ranks first.
    fn crowd(shift: Vec2) -> Vec<Asked> {
        let ranks = [Rank::Aircraft, Rank::Selected, Rank::Place, Rank::Leg, Rank::Zone];
        let mut seed = 7_u32;
        let mut next = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        let mut all: Vec<Asked> = (0..300)
            .map(|n| {
                let at = pos2(150.0 + 400.0 * next(), 120.0 + 360.0 * next()) + shift;
                name(ranks[n / 60], at, 20.0 + 80.0 * next())
            })
            .collect();
        all.sort_by_key(|asked| asked.0.rank);
        all
    }

    #[test]
    fn no_name_stands_over_another() {
        let shown: Vec<Rect> = places(crowd(Vec2::ZERO), &[]).into_iter().flatten().collect();
        assert!(shown.len() > 40, "{}", shown.len());
        for (i, a) in shown.iter().enumerate() {
            assert!(shown.iter().skip(i + 1).all(|b| !a.intersects(*b)), "{a}");
        }
    }

    #[test]
    fn of_two_at_a_place_the_more_important_one_has_the_best_spot_and_the_other_gives_way() {
        let at = pos2(400.0, 300.0);
        let found = places(vec![name(Rank::Place, at, 60.0), name(Rank::Zone, at, 60.0)], &[]);
        assert_eq!(found[0].map(|rect| rect.left_center()), Some(pos2(409.0, 299.0)));
        assert_eq!(found[1].map(|rect| rect.right_center()), Some(pos2(391.0, 299.0)));
        let five = [Rank::Place, Rank::Place, Rank::Leg, Rank::Leg, Rank::Zone];
        let found = places(five.map(|rank| name(rank, at, 60.0)).into(), &[]);
        assert_eq!(found.iter().position(Option::is_none), Some(4), "there is no fifth spot");
    }

    #[test]
    fn names_keep_clear_of_the_scale_and_of_the_edge_unless_they_must_be_seen() {
        let at = pos2(400.0, 300.0);
        let right = Rect::from_min_size(pos2(405.0, 290.0), vec2(80.0, 20.0));
        let found = places(vec![name(Rank::Leg, at, 60.0)], &[right]);
        assert_eq!(found[0].map(|rect| rect.right()), Some(391.0));
        let corner = name(Rank::Leg, pos2(795.0, 300.0), 60.0);
        assert_eq!(places(vec![corner], &[])[0].map(|rect| rect.right()), Some(786.0));
        let all = Rect::from_center_size(at, vec2(300.0, 300.0));
        assert_eq!(places(vec![name(Rank::Place, at, 60.0)], &[all]), [None]);
        assert!(places(vec![name(Rank::Selected, at, 60.0)], &[all])[0].is_some());
    }

    /// What is selected may be much: its names lay over the legend.
    #[test]
    fn a_name_that_must_be_seen_is_moved_beside_what_lies_on_the_edge() {
        let legend = Rect::from_min_size(pos2(10.0, 450.0), vec2(124.0, 116.0));
        for rank in [Rank::Fault, Rank::Aircraft, Rank::Selected] {
            for at in [pos2(70.0, 500.0), pos2(120.0, 460.0), pos2(20.0, 560.0)] {
                let found = places(vec![name(rank, at, 60.0)], &[legend])[0].unwrap();
                assert!(
                    !found.intersects(legend) && found.center().distance(at) < 150.0,
                    "{rank:?} {at}: {found}"
                );
            }
        }
        let found = places(vec![name(Rank::Leg, pos2(70.0, 500.0), 60.0)], &[legend]);
        assert_eq!(found, [None], "what can be asked for is left out");
        let found = places(vec![plate(pos2(70.0, 500.0))], &[legend])[0].unwrap();
        assert!(!found.intersects(legend), "{found}");
    }

    #[test]
    fn panning_changes_no_choice() {
        let before = places(crowd(Vec2::ZERO), &[]);
        for step in 1..60 {
            let shift = vec2(1.37, -0.61) * step as f32;
            let now = places(crowd(shift), &[]);
            for (before, now) in before.iter().zip(&now) {
                let moved = before.map(|rect| rect.translate(shift));
                let is_same = match (moved, now) {
                    (Some(moved), Some(now)) => moved.min.distance(now.min) < 0.01,
                    (moved, now) => moved.is_none() && now.is_none(),
                };
                assert!(is_same, "{before:?} {now:?} after {shift}");
            }
        }
    }

    fn plate(at: Pos2) -> Asked {
        let (spots, ground, size) = (corners(at, vec2(12.0, 9.0)), Ground::Plate, vec2(120.0, 16.0));
        (Wanted { rank: Rank::Aircraft, spots, ground, least: size }, size)
    }

    #[test]
    fn however_much_is_selected_or_wrong_there_the_aircraft_has_its_plate() {
        let at = pos2(400.0, 300.0);
        assert!(Rank::Aircraft < Rank::Selected, "of much that is selected only the first are looked at");
        let faults =
            corners(at, vec2(30.0, 16.0)).map(|(at, _)| name(Rank::Fault, at - vec2(60.0, 0.0), 120.0));
        let asked = faults.into_iter().chain([plate(at)]).collect();
        assert!(places(asked, &[])[4].is_some());
    }

    #[test]
    fn a_plate_at_the_edge_is_moved_inside() {
        let found = places(vec![plate(pos2(780.0, 590.0))], &[])[0];
        assert!(found.is_some_and(|rect| MAP.contains_rect(rect)), "{found:?}");
    }
}
