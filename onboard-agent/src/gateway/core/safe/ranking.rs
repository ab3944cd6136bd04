//! Which runway: of those within reach the one with the least cost, in seconds of flight.
//!
//! With its engine an aircraft reaches a runway if the energy lasts for the way in this wind, and if that leads above all ground and below
//! its ceiling (`powered`). Gliding, if it comes to the threshold with height to spare, and above all ground on the way (`gliding`). The
//! cost is the time for the way; a lower priority, a tailwind on landing, a short runway and the other end of
//! one make it worse.

use super::gliding::{Glide, glides_in};
use super::ground::along;
use super::powered::powered;
use super::way::gates;
use super::{Approach, Landing, Situation, is_usable};
use aircraft::Strip;
use aircraft::glide_in::{End, FINAL_M};
use geometry::LatLon;
use usal::contract::{SafeParameters, SafeRunway};

/// Share of the energy left that may be planned with.
const USABLE: f64 = 0.8;
/// A runway of the next lower priority has to save this share of the way.
const PRIORITY_PENALTY: f64 = 0.25;
/// A tailwind of 1 m/s on landing counts like so many seconds of flight, and with its square, as the way that it rolls grows.
const TAILWIND_PENALTY_S: f64 = 5.0;
/// So much does a runway cost that is only as long as the aircraft needs, seconds of flight; nothing one of twice that.
const SHORT_PENALTY_S: f64 = 60.0;
/// So much does the end of a runway cost that nobody has named, seconds of flight.
const REVERSED_PENALTY_S: f64 = 40.0;
/// The ground before the other end of a runway stays below this share of the final approach's height, and a few metres
/// that elevation models are wrong by.
const CLEAR_SHARE: f64 = 0.5;
const MODEL_ERROR_M: f64 = 5.0;

/// The best landing of those within reach. A glide that would come there without its whole reserve is one only if there is no other, and then
/// the one with most of it; then one that can't lose its height before the runway; the last is one across a runway.
pub fn choose(runways: &[SafeRunway], safe: &SafeParameters, s: &Situation) -> Option<Landing> {
    let usable = || runways.iter().filter(|runway| is_usable(runway, s.profile));
    if !s.glides {
        return best(usable().flat_map(|runway| with_engine(runway, runways, safe, s)), s);
    }
    let glides: Vec<_> = usable().flat_map(|runway| gliding(runway, runways, s)).collect();
    let (in_line, across): (Vec<_>, Vec<_>) = glides.into_iter().partition(|(_, glide)| glide.is_in_line);
    best_glide(&in_line, s).or_else(|| best_glide(&across, s))
}

fn best(ways: impl Iterator<Item = (Landing, f64)>, s: &Situation) -> Option<Landing> {
    let ranked = ways.map(|(landing, time_s)| (cost_s(&landing, time_s, s), landing));
    ranked.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, landing)| landing)
}

fn best_glide(glides: &[(Landing, Glide)], s: &Situation) -> Option<Landing> {
    let of_kind = |is_meant: fn(&Glide) -> bool| glides.iter().filter(move |(_, glide)| is_meant(glide));
    let timed = |(landing, glide): &(Landing, Glide)| (landing.clone(), glide.time_s);
    let with_reserve = best(of_kind(|glide| glide.spare_m >= 0.0 && !glide.is_too_high).map(timed), s);
    let most = || {
        let without = of_kind(|glide| !glide.is_too_high);
        without.min_by(|(_, a), (_, b)| b.spare_m.total_cmp(&a.spare_m)).map(|(landing, _)| landing.clone())
    };
    with_reserve.or_else(most).or_else(|| best(glides.iter().map(timed), s))
}

/// The glides to the ends of a runway, of all that are known.
fn gliding(runway: &SafeRunway, all: &[SafeRunway], s: &Situation) -> impl Iterator<Item = (Landing, Glide)> {
    let named = end_of(runway);
    let other =
        named.other(s.profile, s.wind(), all.iter().map(end_of), |place| s.terrain?.elevation_m(place));
    let ends = [(Some(named), false), (other, true)].into_iter();
    let glides = ends.flat_map(|(end, reversed)| {
        let glides = end.map_or([None, None], |end| glides_in(end, s));
        glides.into_iter().flatten().map(move |glide| (glide, reversed))
    });
    glides.map(|(glide, reversed)| {
        let approach = match glide.final_m {
            Some(metres) if metres >= FINAL_M => Approach::Whole,
            Some(_) => Approach::Short,
            None if glide.is_in_line => Approach::Straight,
            None => Approach::Across,
        };
        let gates = glide.gates.clone();
        (Landing { runway: landed_on(runway, glide.end), reversed, approach, gates }, glide)
    })
}

/// The ways to the ends of a runway that the energy lasts for.
fn with_engine(
    runway: &SafeRunway,
    all: &[SafeRunway],
    safe: &SafeParameters,
    s: &Situation,
) -> impl Iterator<Item = (Landing, f64)> {
    let ends = [Some((runway.clone(), false)), other_end(runway, all, safe, s)].into_iter().flatten();
    ends.filter_map(move |(runway, reversed)| {
        let way = powered(&runway, safe, s)?;
        let lasts = way.energy_j < USABLE * s.battery * s.profile.energy_j;
        let landing = Landing { runway, reversed, approach: Approach::Whole, gates: way.gates };
        lasts.then_some((landing, way.time_s))
    })
}

fn cost_s(landing: &Landing, time_s: f64, s: &Situation) -> f64 {
    let runway = &landing.runway;
    let priority = 1.0 + PRIORITY_PENALTY * f64::from(runway.priority.saturating_sub(1));
    let spare = runway.length_m / s.profile.min_runway_m.max(1.0) - 1.0;
    time_s * priority
        + TAILWIND_PENALTY_S * tailwind_mps(s, runway.heading_deg).max(0.0).powi(2)
        + SHORT_PENALTY_S * (1.0 - spare).clamp(0.0, 1.0)
        + if landing.reversed { REVERSED_PENALTY_S } else { 0.0 }
}

/// Wind along a direction, m/s (tailwind positive).
fn tailwind_mps(s: &Situation, direction_deg: f64) -> f64 {
    s.wind().vector().dot(geometry::Vec2::from_bearing_rad(direction_deg.to_radians()))
}

/// The end that is named.
fn end_of(runway: &SafeRunway) -> End {
    let &SafeRunway { threshold, heading_deg, length_m, elevation_amsl_m, .. } = runway;
    End { strip: Strip { threshold, heading_deg, length_m }, elevation_amsl_m }
}

/// A runway, as it is landed on.
fn landed_on(runway: &SafeRunway, End { strip, elevation_amsl_m }: End) -> SafeRunway {
    let Strip { threshold, heading_deg, length_m } = strip;
    SafeRunway { threshold, heading_deg, length_m, elevation_amsl_m, ..runway.clone() }
}

/// With the engine: the same runway from its other end, where the wind is better there and the ground before it is known to be low.
fn other_end(
    runway: &SafeRunway,
    all: &[SafeRunway],
    safe: &SafeParameters,
    s: &Situation,
) -> Option<(SafeRunway, bool)> {
    if tailwind_mps(s, runway.heading_deg) <= 0.0 {
        return None;
    }
    let terrain = s.terrain?;
    let other = end_of(runway).opposite(all.iter().map(end_of), |place| terrain.elevation_m(place))?;
    let reversed = landed_on(runway, other);
    let [initial, last] = gates(&reversed, safe);
    let is_low = |place: LatLon, height_m: f64| {
        let ground_m = terrain.elevation_m(place);
        ground_m.is_some_and(|m| m < reversed.elevation_amsl_m + CLEAR_SHARE * height_m + MODEL_ERROR_M)
    };
    let height_m = last.1 - reversed.elevation_amsl_m;
    let level = along(terrain, initial.0, last.0).all(|(_, place)| is_low(place, height_m));
    let is_clear = level
        && along(terrain, last.0, reversed.threshold)
            .all(|(share, place)| is_low(place, height_m * (1.0 - share)));
    is_clear.then_some((reversed, true))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{HOME, Wall, runway, situation};
    use super::*;
    use aircraft::Profile;
    use terrain::{Flat, Terrain};
    use usal::contract::Air;

    fn wind(east_mps: f64, north_mps: f64) -> Option<Air> {
        let (wind_east_mps, wind_north_mps) = (east_mps, north_mps);
        Some(Air {
            airspeed_mps: 25.0,
            wind_east_mps,
            wind_north_mps,
            pressure_hpa: 970.0,
            temperature_c: 20.0,
        })
    }

    fn chosen(runways: &[SafeRunway], s: &Situation) -> Option<String> {
        choose(runways, &SafeParameters::default(), s).map(|landing| landing.to_string())
    }

    #[test]
    fn the_best_runway_is_chosen() {
        let main = runway("main", 0.0, 8.0, 0.0, 1);
        let near = runway("near", 180.0, 2.0, 180.0, 2);
        let similar = runway("similar", 180.0, 7.5, 180.0, 2);
        let downwind = runway("downwind", 0.0, 8.0, 90.0, 1);
        let mut short = runway("short", 0.0, 1.0, 0.0, 1);
        short.length_m = 80.0;
        let mut tight = runway("tight", 0.0, 8.0, 0.0, 1);
        tight.length_m = Profile::default().min_runway_m;
        type Case<'a> = (&'a str, Vec<SafeRunway>, f64, f64, Option<&'a str>);
        let cases: [Case; 7] = [
            ("nothing stored", vec![], 1.0, 0.0, None),
            ("much closer alternate", vec![main.clone(), near.clone()], 1.0, 0.0, Some("runway near")),
            ("hardly closer alternate", vec![main.clone(), similar], 1.0, 0.0, Some("runway main")),
            ("tailwind on landing", vec![downwind, main.clone()], 1.0, 8.0, Some("runway main")),
            ("too short", vec![short, near], 1.0, 0.0, Some("runway near")),
            ("just long enough", vec![tight, main.clone()], 1.0, 0.0, Some("runway main")),
            ("out of reach", vec![main], 0.02, 0.0, None),
        ];
        let profile = Profile::default();
        for (name, runways, battery, east_mps, expected) in cases {
            let s = Situation { battery, air: wind(east_mps, 0.0), ..situation(&profile) };
            assert_eq!(chosen(&runways, &s).as_deref(), expected, "{name}");
        }
    }

    #[test]
    fn gliding_it_takes_what_the_height_allows() {
        let profile = Profile::default();
        let (far, near) = (runway("far", 0.0, 8.0, 0.0, 1), runway("near", 0.0, 3.0, 0.0, 2));
        let glides = |altitude_amsl_m, air| {
            let s = Situation { glides: true, altitude_amsl_m, air, ..situation(&profile) };
            chosen(&[far.clone(), near.clone()], &s)
        };
        let reach_m = |metres: f64| 322.0 + metres / profile.glide_ratio;
        assert_eq!(glides(reach_m(16_000.0), None).as_deref(), Some("runway near"));
        assert_eq!(glides(reach_m(3_600.0), None).as_deref(), Some("runway near"));
        assert_eq!(glides(reach_m(2_900.0), None), None);
        assert_eq!(glides(reach_m(3_600.0), wind(0.0, -12.0)), None, "against the wind");
        let behind = Situation { glides: true, altitude_amsl_m: reach_m(4_400.0), ..situation(&profile) };
        let abeam = runway("abeam", 90.0, 3.0, 0.0, 1);
        assert_eq!(chosen(&[abeam], &behind).as_deref(), Some("runway abeam by a short final"));
    }

    /// One that it reaches with hardly anything to spare is better than none, and worse than any other.
    #[test]
    fn a_runway_without_the_whole_reserve_is_glided_to_only_if_there_is_no_other() {
        let profile = Profile::default();
        let (tight, safe) = (runway("tight", 0.0, 5.0, 0.0, 1), runway("safe", 180.0, 3.0, 180.0, 9));
        let s =
            Situation { glides: true, altitude_amsl_m: 322.0 + 5000.0 / 12.0 + 30.0, ..situation(&profile) };
        assert_eq!(chosen(std::slice::from_ref(&tight), &s).as_deref(), Some("runway tight"));
        let way = chosen(&[tight, safe], &s).unwrap();
        assert!(way.starts_with("runway safe"), "{way}");
    }

    #[test]
    fn no_glide_leads_through_a_hill_and_no_climb_above_the_ceiling() {
        let wall = Wall(HOME.lat_deg + 0.02, 1500.0);
        let (behind, here) = (runway("behind", 0.0, 8.0, 0.0, 1), runway("here", 180.0, 7.0, 180.0, 2));
        let runways = [behind, here];
        let profile = Profile::default();
        let high = Situation { altitude_amsl_m: 1200.0, terrain: Some(&wall), ..situation(&profile) };
        assert_eq!(chosen(&runways, &Situation { glides: true, ..high }).as_deref(), Some("runway here"));
        let low = Profile { ceiling_amsl_m: 1300.0, ..profile.clone() };
        let under_it = Situation { terrain: Some(&wall), ..situation(&low) };
        assert_eq!(chosen(&runways, &under_it).as_deref(), Some("runway here"));
        let over_it = Situation { terrain: Some(&wall), battery: 1.0, ..situation(&profile) };
        assert_eq!(chosen(&runways[..1], &over_it).as_deref(), Some("runway behind"));
    }

    /// It is told the altitude that the glide has before the runway, not that of a powered approach.
    #[test]
    fn no_glide_is_led_into_a_hill_that_it_could_clear() {
        let hill = Wall(HOME.lat_deg + 0.043, 850.0);
        let runways = [runway("behind", 0.0, 8.0, 0.0, 1), runway("here", 180.0, 7.0, 180.0, 2)];
        let profile = Profile::default();
        let s =
            Situation { glides: true, altitude_amsl_m: 1200.0, terrain: Some(&hill), ..situation(&profile) };
        assert_eq!(chosen(&runways, &s).as_deref(), Some("runway here"));
        let lower = Wall(hill.0, 650.0);
        assert_eq!(
            chosen(&runways, &Situation { terrain: Some(&lower), ..s }).as_deref(),
            Some("runway behind")
        );
    }

    /// High as it is it passes far above; but it is to lose that height in circles, and to come in as low as any.
    #[test]
    fn no_final_leads_through_a_hill_below_the_height_that_is_lost_before_it() {
        let profile = Profile::default();
        let near = [runway("near", 0.0, 3.0, 0.0, 1)];
        let before = |hill_m: f64| Wall(HOME.lat_deg + (3000.0 - 617.0) / 111_195.0, 322.0 + hill_m);
        let over = |hill: &Wall| {
            let s = Situation { glides: true, altitude_amsl_m: 872.0, ..situation(&profile) };
            chosen(&near, &Situation { terrain: Some(hill), ..s })
        };
        assert_eq!(over(&before(10.0)).as_deref(), Some("runway near"));
        let way = over(&before(60.0));
        assert!(way.as_deref() != Some("runway near"), "{way:?}");
    }

    /// It touched down beyond the far end, at 25 m/s; the other end has room.
    #[test]
    fn what_can_t_lose_its_height_before_a_runway_does_not_go_straight_in() {
        let profile = Profile::default();
        let s = Situation { glides: true, altitude_amsl_m: 322.0 + 160.0, ..situation(&profile) };
        let way = chosen(&[runway("ahead", 0.0, 0.3, 0.0, 1)], &s).unwrap();
        assert!(way.contains("from its other end"), "{way}");
    }

    /// It glided to a runway that it did not reach, or returned by the autopilot's own means, with a runway beside it.
    #[test]
    fn a_runway_that_only_a_way_across_it_reaches_comes_after_all_others_and_before_none() {
        let profile = Profile::default();
        // straight it takes 103 m of height, by the shortest final 130 m
        let beside = runway("beside", 90.0, 1.0, 0.0, 1);
        let ahead = runway("ahead", 80.0, 1.0, 80.0, 9);
        let s = Situation {
            glides: true,
            track_deg: 90.0,
            altitude_amsl_m: 322.0 + 110.0,
            ..situation(&profile)
        };
        let across = "runway beside, straight across it";
        assert_eq!(chosen(std::slice::from_ref(&beside), &s).as_deref(), Some(across));
        assert_eq!(chosen(&[beside.clone(), ahead], &s).as_deref(), Some("runway ahead"));
        let low = Situation { altitude_amsl_m: 322.0 + 60.0, ..s };
        assert_eq!(chosen(&[beside], &low), None);
    }

    /// It touched down 33 m above the ground: at the height of the end that is named.
    #[test]
    fn the_other_end_is_landed_on_at_its_own_height_where_that_is_known() {
        let profile = Profile::default();
        let south = runway("south", 180.0, 2.0, 0.0, 1);
        let back = end_of(&south).strip.from_other_end();
        let north = SafeRunway {
            id: "north".into(),
            ..landed_on(&south, End { strip: back, elevation_amsl_m: 289.0 })
        };
        let s = Situation { glides: true, track_deg: 180.0, ..situation(&profile) };
        let landing =
            choose(&[SafeRunway { priority: 9, ..north }, south], &SafeParameters::default(), &s).unwrap();
        assert_eq!(landing.to_string(), "runway south from its other end");
        assert_eq!(landing.runway.elevation_amsl_m, 289.0);
    }

    /// Straight in on the one, past the other and round.
    #[test]
    fn without_an_engine_it_takes_the_end_that_it_reaches() {
        let (profile, flat) = (Profile::default(), Flat(320.0));
        let main = runway("main", 230.0, 2.6, 50.0, 1);
        let s = Situation { track_deg: 230.0, altitude_amsl_m: 542.0, ..situation(&profile) };
        let gliding = Situation { glides: true, terrain: Some(&flat), ..s };
        let way = chosen(&[main], &gliding).unwrap();
        assert!(way.starts_with("runway main from its other end"), "{way}");
    }

    #[test]
    fn it_lands_against_the_wind_where_the_other_end_is_known_to_be_free() {
        let profile = Profile::default();
        let runways = [runway("main", 0.0, 4.0, 0.0, 1)];
        let (flat, hilly) = (Flat(320.0), Wall(HOME.lat_deg + 0.05, 1500.0));
        let landing = |terrain, north_mps| {
            let air = wind(0.0, north_mps);
            chosen(&runways, &Situation { terrain, air, ..situation(&profile) }).unwrap()
        };
        assert_eq!(landing(Some(&flat as &dyn Terrain), 9.0), "runway main from its other end");
        assert_eq!(landing(Some(&flat), 1.0), "runway main", "hardly any wind");
        assert_eq!(landing(None, 9.0), "runway main", "nothing is known of the ground");
        assert_eq!(landing(Some(&hilly), 9.0), "runway main", "a hill before its other end");
    }
}
