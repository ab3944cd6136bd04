//! How a glide comes in to a runway: at which of its ends, and by how long a final approach. An emergency plan and Safe mode choose by the
//! same rule: when the one takes over from the other, a glide does not turn round.

use crate::glide::{Circle, GlidePoint, GlideStart, glide, may_land_unnamed, reserve_m, turn_rad};
use crate::{Profile, Strip, Wind};
use geometry::LatLon;
use geometry::geodesy::normalise_180;
use geometry::near::{distance_and_course, distance_m};

/// Length of a whole final approach, metres.
pub const FINAL_M: f64 = 700.0;
/// Final approaches that a glide may fly, as shares of the whole one.
const FINALS: [f64; 6] = [1.0, 0.8, 0.65, 0.5, 0.4, 0.3];
/// However far it turns onto a final, it is in line after so many radii: it passes the line, and comes back to it.
const LINES_UP_WITHIN_RADII: f64 = 3.0;
/// Off the runway's heading by more than this a path is not on the final approach, which then gets a point to line up at first, degrees.
pub const ALIGNED_DEG: f64 = 30.0;
/// Off by no more than this it is lined up, degrees.
const LINED_UP_DEG: f64 = 10.0;
/// On the final approach a shorter one is ahead, if it is turned onto by no more than this, degrees.
const AHEAD_DEG: f64 = 45.0;
/// The other end of a runway, of which only the place is known, may be so much higher or lower by the elevation model, metres.
const LEVEL_M: f64 = 8.0;
/// A runway that begins so near to another one's end, metres, and leads back by its heading to so many degrees, is the same one.
const SAME_PLACE_M: f64 = 60.0;
const SAME_HEADING_DEG: f64 = 10.0;

/// Heights that differ by less are as good as each other, metres.
const EVEN_M: f64 = 3.0;

/// An end of a runway.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End {
    /// Its ground, from this end on.
    pub strip: Strip,
    /// Metres AMSL.
    pub elevation_amsl_m: f64,
}

impl End {
    /// The other end, if a glide may land there, with what is known of it ([`End::opposite`]).
    pub fn other(
        &self,
        profile: &Profile,
        wind: Wind,
        named: impl IntoIterator<Item = End>,
        ground_m: impl Fn(LatLon) -> Option<f64>,
    ) -> Option<Self> {
        let other = self.opposite(named, ground_m)?;
        may_land_unnamed(profile, wind, other.strip.heading_deg).then_some(other)
    }

    /// The other end: as high as the end among the `named` ones that lies there; if none does, as the ground, and if that is not known, as
    /// this one. `None`: by the ground alone it lies higher or lower. `ground_m`: what is known of the ground at a place, metres AMSL.
    pub fn opposite(
        &self,
        named: impl IntoIterator<Item = End>,
        ground_m: impl Fn(LatLon) -> Option<f64>,
    ) -> Option<Self> {
        let strip = self.strip.from_other_end();
        let at = |elevation_amsl_m| Self { strip, elevation_amsl_m };
        if let Some(end) = named.into_iter().find(|end| end.begins_with(strip)) {
            return Some(at(end.elevation_amsl_m));
        }
        let elevation_m = ground_m(strip.threshold).unwrap_or(self.elevation_amsl_m);
        ((elevation_m - self.elevation_amsl_m).abs() <= LEVEL_M).then(|| at(elevation_m))
    }

    /// It lies where a strip begins, and leads along it.
    fn begins_with(&self, strip: Strip) -> bool {
        let off_deg = normalise_180(self.strip.heading_deg - strip.heading_deg);
        distance_m(self.strip.threshold, strip.threshold) <= SAME_PLACE_M && off_deg.abs() <= SAME_HEADING_DEG
    }

    /// Where a final approach of a length begins.
    pub fn final_begins_at(&self, length_m: f64) -> LatLon {
        self.strip.threshold.destination(self.strip.heading_deg + 180.0, length_m)
    }

    /// Nearer to the threshold than where the final approach begins, and on the runway's line.
    pub fn is_on_final(&self, here: LatLon, begins: LatLon) -> bool {
        let threshold = self.strip.threshold;
        distance_m(here, threshold) <= distance_m(begins, threshold) && self.off_deg(here) <= ALIGNED_DEG
    }

    /// So far off the runway's heading one flies straight to its threshold, degrees.
    fn off_deg(&self, here: LatLon) -> f64 {
        normalise_180(here.bearing_deg(self.strip.threshold) - self.strip.heading_deg).abs()
    }

    /// Lengths of the final approaches that may be flown from a place, the longest first, and `None`: straight, as it is on one. Nobody goes
    /// back to where a final begins from nearer on the runway's line: what begins ahead there lines it up.
    fn finals(&self, here: LatLon, whole_m: f64) -> impl Iterator<Item = Option<f64>> + use<> {
        let end = *self;
        let is_there = end.is_on_final(here, end.final_begins_at(whole_m));
        let is_lined_up = is_there && end.off_deg(here) <= LINED_UP_DEG;
        let is_ahead = move |metres: &f64| end.turn_onto_rad(here, *metres) <= AHEAD_DEG.to_radians();
        let lengths_m = FINALS.into_iter().map(move |share| share * whole_m);
        let flown_m = lengths_m.filter(move |metres| !is_there || !is_lined_up && is_ahead(metres));
        flown_m.map(Some).chain(is_there.then_some(None))
    }

    /// How far it turns onto a final approach of a length to which it flies straight, radians.
    fn turn_onto_rad(&self, here: LatLon, final_m: f64) -> f64 {
        let (metres, course_deg) = distance_and_course(here, self.final_begins_at(final_m));
        if metres < 1.0 { 0.0 } else { turn_rad(course_deg, self.strip.heading_deg) }
    }
}

/// How a glide ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrival {
    /// Height above the threshold there, metres; what is lacking, if it is negative.
    pub height_m: f64,
    /// Height that the way takes, metres.
    pub taken_m: f64,
}

impl Arrival {
    /// Of a glide that ends over the threshold of a runway, at this altitude, metres AMSL.
    pub fn along(points: &[GlidePoint], elevation_amsl_m: f64) -> Option<Self> {
        let (from, end) = (points.first()?, points.last()?);
        Some(Self {
            height_m: end.altitude_amsl_m - elevation_amsl_m,
            taken_m: from.altitude_amsl_m - end.altitude_amsl_m,
        })
    }

    /// So much more than the reserve, metres; what of it is lacking, if it is negative.
    pub fn spare_m(&self) -> f64 {
        self.height_m - reserve_m(self.taken_m)
    }
}

/// A way in.
#[derive(Debug, Clone, PartialEq)]
pub struct WayIn {
    /// Which of the ends it lands at.
    pub end: usize,
    /// By a place so far before the threshold, in line with the runway, metres. `None`: straight to the threshold.
    pub final_m: Option<f64>,
    /// In line with the runway at last.
    is_in_line: bool,
    /// Its final has room for the turn onto it. The whole one is there for that.
    has_room: bool,
    /// From where the glide is to the threshold; empty: the wind does not let it get there.
    pub points: Vec<GlidePoint>,
    /// `None`: the wind does not let it get there.
    pub arrival: Option<Arrival>,
}

impl WayIn {
    /// All ways in to some ends of a runway, the end that is wanted most first: in line with it by longer and shorter finals, then those
    /// straight to the threshold from wherever the glide is.
    pub fn all((profile, wind): (&Profile, Wind), from: GlideStart, ends: &[End], whole_m: f64) -> Vec<Self> {
        let radius_m = Circle::smallest(profile, wind).radius_m;
        let way = |index: usize, end: &End, final_m: Option<f64>, is_in_line: bool| {
            let Strip { threshold, heading_deg, .. } = end.strip;
            let gate = final_m.map(|metres| end.final_begins_at(metres));
            let places: Vec<LatLon> = gate.into_iter().chain([threshold]).collect();
            // across a runway nobody turns
            let lands_deg = if is_in_line { heading_deg } else { from.position.bearing_deg(threshold) };
            let points = glide(profile, wind.into(), from, &places, lands_deg).unwrap_or_default();
            let arrival = Arrival::along(&points, end.elevation_amsl_m);
            let is_short = |metres: f64| {
                let radii = (0.5 * end.turn_onto_rad(from.position, metres)).tan();
                metres < whole_m && metres < radius_m * radii.min(LINES_UP_WITHIN_RADII)
            };
            let has_room = !final_m.is_some_and(is_short);
            Self { end: index, final_m, is_in_line, has_room, points, arrival }
        };
        let numbered = || ends.iter().enumerate();
        let in_line = numbered()
            .flat_map(|(i, end)| end.finals(from.position, whole_m).map(move |m| (i, end, m)))
            .map(|(i, end, final_m)| way(i, end, final_m, true));
        in_line.chain(numbered().map(|(i, end)| way(i, end, None, false))).collect()
    }

    /// The best of these that is no way through the ground: in line with the runway and with the whole reserve, with room for its last turn
    /// if one has that, else what has most of the reserve, else straight.
    pub fn best(ways: &[Self], clears: impl Fn(&Self) -> bool) -> Option<&Self> {
        let keeps = |way: &&Self| way.is_in_line && way.keeps_reserve() && clears(way);
        let whole = ways.iter().filter(|way| way.has_room).find(keeps).or_else(|| ways.iter().find(keeps));
        let most = |in_line: bool| {
            let is_good = |way: &&Self| way.is_in_line == in_line && way.gets_there() && clears(way);
            let most_m = ways.iter().filter(is_good).map(Self::spare_m).fold(f64::NEG_INFINITY, f64::max);
            ways.iter().filter(is_good).find(|way| way.spare_m() > most_m - EVEN_M)
        };
        whole.or_else(|| most(true)).or_else(|| most(false))
    }

    /// The last leg as low as it may be told, down to the threshold, which is so high, metres AMSL: in line with the runway from where height
    /// that is too much was lost, with the reserve, else from where it is.
    pub fn lowest_end(&self, elevation_amsl_m: f64) -> Option<[GlidePoint; 2]> {
        let [.., from, end] = self.points.as_slice() else { return None };
        let takes_m = from.altitude_amsl_m - end.altitude_amsl_m;
        let needed_m = elevation_amsl_m + takes_m + reserve_m(takes_m);
        let lowest_m =
            if self.is_in_line { from.altitude_amsl_m.min(needed_m) } else { from.altitude_amsl_m };
        let from = GlidePoint { altitude_amsl_m: lowest_m, ..*from };
        Some([from, GlidePoint { altitude_amsl_m: elevation_amsl_m, ..*end }])
    }

    /// Above the threshold, metres.
    pub fn height_m(&self) -> f64 {
        self.arrival.map_or(f64::NEG_INFINITY, |arrival| arrival.height_m)
    }

    /// The height suffices.
    pub fn gets_there(&self) -> bool {
        self.height_m() >= 0.0
    }

    /// Above the reserve at the threshold, metres.
    pub fn spare_m(&self) -> f64 {
        self.arrival.map_or(f64::NEG_INFINITY, |arrival| arrival.spare_m())
    }

    /// With the whole reserve.
    pub fn keeps_reserve(&self) -> bool {
        self.spare_m() >= 0.0
    }

    /// It is in line with the runway at last.
    pub fn is_in_line(&self) -> bool {
        self.is_in_line
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const THRESHOLD: LatLon = LatLon::new(36.49, -84.27);

    /// A runway to the north, 600 m long, at sea level.
    fn named() -> End {
        let strip = Strip { threshold: THRESHOLD, heading_deg: 0.0, length_m: 600.0 };
        End { strip, elevation_amsl_m: 0.0 }
    }

    /// The ways to it from a place as seen from its threshold, towards it.
    fn ways(bearing_deg: f64, metres: f64, altitude_amsl_m: f64, ends: &[End]) -> Vec<WayIn> {
        let position = THRESHOLD.destination(bearing_deg, metres);
        let from = GlideStart { position, altitude_amsl_m, course_deg: bearing_deg + 180.0 };
        WayIn::all((&Profile::default(), Wind::CALM), from, ends, FINAL_M)
    }

    /// From the side: by the whole final it takes 200 m, by the shortest 130 m, straight 103 m; the reserve is 25 to 35 m.
    #[test]
    fn the_longest_final_with_the_whole_reserve_comes_first_then_one_without_it_then_straight() {
        let final_m = |altitude_m: f64| {
            let ways = ways(90.0, 1000.0, altitude_m, &[named()]);
            WayIn::best(&ways, |_| true).map(|way| way.final_m.map(f64::round))
        };
        assert_eq!(final_m(260.0), Some(Some(700.0)));
        assert_eq!(final_m(210.0), Some(Some(560.0)), "the whole one has no reserve");
        assert_eq!(final_m(140.0), Some(Some(210.0)), "none has the reserve");
        assert_eq!([final_m(110.0), final_m(80.0)], [Some(None), None]);
    }

    /// The whole final arrives with 6 m, 1 % of that glide: a little more head wind and it is down before the runway.
    #[test]
    fn without_the_whole_reserve_the_way_with_most_of_it_is_flown() {
        let ways = ways(90.0, 6000.0, 590.0, &[named()]);
        assert!(
            ways.iter().filter(|way| way.is_in_line()).all(|way| way.gets_there() && !way.keeps_reserve())
        );
        let best = WayIn::best(&ways, |_| true).unwrap();
        assert_eq!(best.final_m.map(f64::round), Some(210.0), "{} m above the threshold", best.height_m());
    }

    #[test]
    fn a_way_that_leads_through_the_ground_is_none_and_the_named_end_comes_first() {
        let other = named().other(&Profile::default(), Wind::CALM, [], |_| None).unwrap();
        let ways = ways(90.0, 1000.0, 400.0, &[named(), other]);
        let best = |clears: fn(&WayIn) -> bool| WayIn::best(&ways, clears).map(|way| (way.end, way.final_m));
        assert_eq!(best(|_| true), Some((0, Some(700.0))));
        assert_eq!(best(|way| way.final_m != Some(700.0)), Some((0, Some(560.0))));
        assert_eq!(best(|way| way.end == 1), Some((1, Some(700.0))));
        assert_eq!(best(|_| false), None);
    }

    #[test]
    fn nobody_goes_back_to_where_a_final_begins_from_nearer_on_it() {
        for (bearing_deg, metres, is_straight) in
            [(180.0, 600.0, true), (200.0, 300.0, true), (180.0, 800.0, false)]
        {
            let ways = ways(bearing_deg, metres, 300.0, &[named()]);
            let best = WayIn::best(&ways, |_| true).unwrap();
            assert_eq!(
                (best.final_m.is_none(), best.is_in_line()),
                (is_straight, true),
                "{bearing_deg}° {metres} m"
            );
        }
    }

    /// All finals were dropped there, those that begin ahead too: it turned onto the runway over its threshold.
    #[test]
    fn beside_the_runways_line_a_shorter_final_that_begins_ahead_lines_it_up() {
        let finals = |bearing_deg: f64, metres: f64| {
            let ways = ways(bearing_deg, metres, 300.0, &[named()]);
            ways.iter()
                .filter(|way| way.is_in_line())
                .map(|way| way.final_m.map(f64::round))
                .collect::<Vec<_>>()
        };
        assert_eq!(finals(205.0, 650.0), [Some(280.0), Some(210.0), None]);
        assert_eq!(
            finals(180.0 + 31.0, 650.0).last(),
            Some(&Some(210.0)),
            "too far beside it to go straight"
        );
    }

    /// It passed the runway's line by more than it had room to come back to it, with the other end straight ahead.
    #[test]
    fn a_final_that_is_too_short_for_the_turn_onto_it_comes_behind_the_other_end() {
        let other = named().other(&Profile::default(), Wind::CALM, [], |_| None).unwrap();
        let chosen = |ends: &[End]| {
            let ways = ways(0.0, 2000.0, 285.0, ends);
            WayIn::best(&ways, |_| true).map(|way| (way.end, way.final_m.map(f64::round)))
        };
        assert_eq!(chosen(&[named()]), Some((0, Some(210.0))));
        assert_eq!(chosen(&[named(), other]), Some((1, Some(700.0))));
    }

    #[test]
    fn the_other_end_is_one_where_it_is_level_and_without_much_tailwind() {
        let other = |wind: Wind, ground_m: Option<f64>| {
            named().other(&Profile::default(), wind, [], |_| ground_m).map(|end| end.strip)
        };
        let strip = other(Wind::CALM, Some(7.0)).unwrap();
        assert!((strip.heading_deg - 180.0).abs() < 1e-9);
        assert!(strip.threshold.distance_m(THRESHOLD.destination(0.0, 600.0)) < 0.1);
        assert!(other(Wind::CALM, None).is_some() && other(Wind::CALM, Some(9.0)).is_none());
        assert!(other(Wind::from_direction(0.0, 4.0), None).is_none());
    }

    /// It was landed on 33 m above its ground: at the height of the end that the plan names.
    #[test]
    fn the_other_end_is_as_high_as_the_runway_that_is_drawn_there_else_as_the_ground() {
        let back = named().strip.from_other_end();
        let drawn = |beside_m: f64, off_deg: f64| {
            let threshold = back.threshold.destination(90.0, beside_m);
            let strip = Strip { threshold, heading_deg: back.heading_deg + off_deg, ..back };
            End { strip, elevation_amsl_m: -33.0 }
        };
        let elevation_m = |other: End, ground_m: Option<f64>| {
            let of = |ends: [End; 2]| named().opposite(ends, |_| ground_m).map(|end| end.elevation_amsl_m);
            of([named(), other])
        };
        assert_eq!(elevation_m(drawn(0.0, 0.0), Some(-30.0)), Some(-33.0));
        assert_eq!(elevation_m(drawn(20.0, 5.0), None), Some(-33.0), "by its place to a few metres");
        for another in [drawn(0.0, 90.0), drawn(300.0, 0.0)] {
            assert_eq!(elevation_m(another, Some(4.0)), Some(4.0), "its ground");
            assert_eq!(elevation_m(another, None), Some(0.0), "nothing else is known");
            assert_eq!(elevation_m(another, Some(-30.0)), None, "by the ground alone it is not level");
        }
    }

    #[test]
    fn against_a_wind_that_is_faster_than_it_no_way_gets_there() {
        let position = THRESHOLD.destination(180.0, 900.0);
        let from = GlideStart { position, altitude_amsl_m: 500.0, course_deg: 0.0 };
        let storm = Wind::from_direction(0.0, 40.0);
        let ways = WayIn::all((&Profile::default(), storm), from, &[named()], FINAL_M);
        assert!(ways.iter().all(|way| !way.gets_there()) && WayIn::best(&ways, |_| true).is_none());
    }
}
