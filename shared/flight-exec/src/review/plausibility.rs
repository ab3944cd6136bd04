//! Is a waypoint fit to be flown after another? What the gateway asks of every waypoint it takes, and the review of every
//! waypoint a plan makes. One rule, one function.

use crate::api::{Action, FARTHEST_M, TERRAIN_MARGIN_M, Waypoint};
use aircraft::Profile;
use flight_plan::LOWEST_AMSL_M;
use geometry::LatLon;
use geometry::geodesy::{NEAR_POLE, normalise_180};
use terrain::Terrain;

/// Highest and lowest altitudes that make sense at all, metres AMSL.
pub const ALTITUDES_M: std::ops::RangeInclusive<f64> = LOWEST_AMSL_M..=12_000.0;
/// Share by which a gradient may exceed the aircraft's: plans are checked to their own margins.
pub const GRADIENT_SLACK: f64 = 1.5;
/// Loiters smaller than this can't be flown by anything, metres.
pub const SMALLEST_LOITER_M: f64 = 10.0;
/// A corner sharper than this is flown as a loop, whatever the segments, degrees.
const LOOPED_DEG: f64 = 135.0;
/// From below here a way of [`FARTHEST_M`] does not come too near to a pole, degrees of latitude.
const POLAR_LATITUDE_DEG: f64 = 88.5;
/// Parts of a way between which is looked whether it is too near.
const POLE_STEPS: u32 = 8;

/// Why a waypoint is not fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Fault {
    /// For programs.
    pub code: &'static str,
    /// For people: what is wrong, and what would be right.
    pub sentence: String,
}

/// What the rules know about the aircraft and the world.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    /// The aircraft.
    pub profile: &'a Profile,
    /// The ground, if known.
    pub terrain: Option<&'a dyn Terrain>,
    /// Wind speed, m/s.
    pub wind_mps: f64,
    /// Its engine is out: it sinks as it does, however steeply it is told to.
    pub glides: bool,
}

type Rule = fn(&Context, Option<&Waypoint>, &Waypoint) -> Option<Fault>;

/// Rules without which the others make no sense.
const NUMBERS: [Rule; 3] = [number, place, pole];
/// Rules on one waypoint and the one before it.
const RULES: [Rule; 6] = [altitude, speed, loiter, distance, gradient, above_terrain];

/// Where the aircraft is, as the waypoint that `first` follows on when nothing is flown before it.
pub fn from_here(here: LatLon, first: &Waypoint) -> Waypoint {
    Waypoint { position: here, action: Action::Fly, fly_over: true, ..first.clone() }
}

/// Everything that is wrong with a waypoint that follows on `previous`, whose own predecessor is at `before_previous`.
/// Empty: it may be flown.
pub fn faults(
    context: &Context,
    before_previous: Option<LatLon>,
    previous: Option<&Waypoint>,
    waypoint: &Waypoint,
) -> Vec<Fault> {
    // nothing else can be said about a place that is none
    if let Some(nonsense) = NUMBERS.iter().find_map(|rule| rule(context, previous, waypoint)) {
        return vec![nonsense];
    }
    let rules = RULES.iter().filter_map(|rule| rule(context, previous, waypoint));
    rules.chain(turn(context, before_previous, previous, waypoint)).collect()
}

fn fault(code: &'static str, sentence: String) -> Fault {
    Fault { code, sentence }
}

fn number(_: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let other = match w.action {
        Action::TakeOff { heading_deg } | Action::Land { heading_deg } => heading_deg,
        Action::Loiter { radius_m } => radius_m,
        Action::Fly => 0.0,
    };
    let all = [w.position.lat_deg, w.position.lon_deg, w.altitude_amsl_m, w.airspeed_mps, other];
    (!all.iter().all(|v| v.is_finite()))
        .then(|| fault("not-a-number", "Every number of a waypoint has to be finite.".into()))
}

fn place(_: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let LatLon { lat_deg, lon_deg } = w.position;
    let null_island = lat_deg == 0.0 && lon_deg == 0.0;
    (!w.position.is_valid() || null_island).then(|| {
        fault("no-such-place", format!("{lat_deg}, {lon_deg} is not a place to fly to; latitude is within ±90, longitude within ±180 degrees, and 0, 0 means that it was left out."))
    })
}

fn altitude(c: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let (h, ceiling) = (w.altitude_amsl_m, c.profile.ceiling_amsl_m);
    let bad = !ALTITUDES_M.contains(&h) || h > ceiling;
    bad.then(|| {
        fault("altitude", format!("{h:.0} m AMSL is out of range; the ceiling is {ceiling:.0} m AMSL."))
    })
}

fn speed(c: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let (low, high) = (c.profile.min_airspeed_mps, c.profile.max_airspeed_mps);
    (!(low..=high).contains(&w.airspeed_mps))
        .then(|| fault("speed", format!("{:.1} m/s is outside {low:.1} to {high:.1} m/s.", w.airspeed_mps)))
}

fn loiter(_: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let Action::Loiter { radius_m } = w.action else { return None };
    (radius_m.abs() < SMALLEST_LOITER_M).then(|| {
        fault(
            "loiter-radius",
            format!("A loiter of {radius_m:.0} m can't be flown; give at least {SMALLEST_LOITER_M:.0} m."),
        )
    })
}

fn distance(_: &Context, p: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let far_m = p?.position.distance_m(w.position);
    (far_m > FARTHEST_M).then(|| {
        fault(
            "too-far",
            format!("{:.0} km from the waypoint before it; at most {:.0} km.", far_m / 1e3, FARTHEST_M / 1e3),
        )
    })
}

/// Climb or descent along the segment against what the aircraft does at that ground speed.
fn gradient(c: &Context, p: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let previous = p?;
    if matches!(previous.action, Action::TakeOff { .. }) || matches!(w.action, Action::TakeOff { .. }) {
        return None;
    }
    let length_m = previous.position.distance_m(w.position);
    let rise_m = w.altitude_amsl_m - previous.altitude_amsl_m;
    if c.glides && rise_m <= 0.0 {
        return None;
    }
    let rate = if rise_m > 0.0 { c.profile.max_climb_mps } else { c.profile.max_descent_mps };
    let ground_mps = (w.airspeed_mps + c.wind_mps).max(1.0);
    // ten metres of grace: corners are rounded, and short segments carry rounded altitudes
    let most_m = GRADIENT_SLACK * rate * length_m / ground_mps + 10.0;
    (rise_m.abs() > most_m).then(|| {
        fault("gradient", format!("{rise_m:+.0} m over {length_m:.0} m is steeper than the aircraft can fly; at most {most_m:.0} m."))
    })
}

fn above_terrain(c: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    if matches!(w.action, Action::Land { .. } | Action::TakeOff { .. }) {
        return None;
    }
    let ground_m = c.terrain?.elevation_m(w.position)?;
    let (h, least_m) = (w.altitude_amsl_m, ground_m + TERRAIN_MARGIN_M);
    (h < least_m).then(|| {
        let by_m = (least_m - h).ceil();
        let sentence = format!(
            "{h:.0} m AMSL is too low over ground of {ground_m:.0} m AMSL; raise its leg by {by_m:.0} m, or move it to lower ground."
        );
        fault("below-terrain", sentence)
    })
}

/// Too near to a pole, itself or the way to it.
fn pole(_: &Context, previous: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let steps = || (1..POLE_STEPS).map(|step| f64::from(step) / f64::from(POLE_STEPS));
    let on_the_way = |from: LatLon| steps().any(|share| !from.interpolate(w.position, share).is_navigable());
    let high = w.position.lat_deg.abs() > POLAR_LATITUDE_DEG;
    let bad = high && (!w.position.is_navigable() || previous.is_some_and(|p| on_the_way(p.position)));
    bad.then(|| fault("near-pole", format!("{}.", NEAR_POLE)))
}

/// The turn at the waypoint before: the tangent length r·tan(Δ/2) of the tightest turn has to fit
/// into both segments together (steepest bank, wind added to the speed).
fn turn(c: &Context, before: Option<LatLon>, previous: Option<&Waypoint>, w: &Waypoint) -> Option<Fault> {
    let (a, b) = (before?, previous?);
    if b.fly_over || !matches!(b.action, Action::Fly) || !matches!(w.action, Action::Fly) {
        return None;
    }
    let (first, second) = (a.inverse(b.position), b.position.inverse(w.position));
    let angle_deg = normalise_180(second.bearing_start_deg - first.bearing_end_deg).abs();
    if angle_deg > LOOPED_DEG || second.distance_m < 1.0 || first.distance_m < 1.0 {
        return None;
    }
    let radius_m = geometry::turn::radius_m(b.airspeed_mps + c.wind_mps, c.profile.max_bank_deg);
    let need_m = geometry::turn::anticipation_m(radius_m, angle_deg);
    let have_m = first.distance_m + second.distance_m;
    (need_m > have_m).then(|| {
        fault("turn", format!("Turning {angle_deg:.0}° needs {need_m:.0} m before and after the corner; there are {have_m:.0} m."))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::Token;
    use flight_plan::Id;
    use proptest::prelude::*;

    const GROUND_M: f64 = 300.0;

    fn waypoint(east_m: f64, north_m: f64) -> Waypoint {
        Waypoint {
            token: Token(1),
            position: LatLon::new(36.49, -84.27).destination(90.0, east_m).destination(0.0, north_m),
            altitude_amsl_m: 600.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            on_arc: false,
            leg: Id::from("leg"),
            end_of_plan: false,
        }
    }

    fn context(profile: &Profile, glides: bool) -> Context<'_> {
        Context { profile, terrain: Some(&terrain::Flat(GROUND_M)), wind_mps: 5.0, glides }
    }

    /// The codes for the last of up to three waypoints.
    fn codes(path: &[Waypoint]) -> Vec<&'static str> {
        let profile = Profile::default();
        let context = context(&profile, false);
        let mut back = path.iter().rev();
        let Some(waypoint) = back.next() else { return vec![] };
        let (previous, before) = (back.next(), back.next().map(|w| w.position));
        faults(&context, before, previous, waypoint).into_iter().map(|f| f.code).collect()
    }

    /// The codes for the last of three good waypoints after it was spoilt.
    fn spoilt(spoil: impl FnOnce(&mut Waypoint)) -> Vec<&'static str> {
        let mut last = waypoint(300.0, 900.0);
        spoil(&mut last);
        codes(&[waypoint(0.0, 0.0), waypoint(0.0, 500.0), last])
    }

    #[test]
    fn a_good_waypoint_passes() {
        assert!(spoilt(|_| {}).is_empty());
    }

    #[test]
    fn each_rule_refuses_what_it_is_there_for() {
        type Spoil = fn(&mut Waypoint);
        let cases: [(&str, Spoil); 17] = [
            ("not-a-number", |w| w.position.lat_deg = f64::NAN),
            ("not-a-number", |w| w.altitude_amsl_m = f64::INFINITY),
            ("not-a-number", |w| w.airspeed_mps = f64::NAN),
            ("not-a-number", |w| w.action = Action::Land { heading_deg: f64::NAN }),
            ("no-such-place", |w| w.position.lat_deg = 91.0),
            ("no-such-place", |w| w.position.lon_deg = -180.5),
            ("no-such-place", |w| w.position = LatLon::new(0.0, 0.0)),
            ("near-pole", |w| w.position.lat_deg = 89.999),
            ("near-pole", |w| w.position.lat_deg = -89.1),
            ("altitude", |w| w.altitude_amsl_m = 3100.0),
            ("altitude", |w| w.altitude_amsl_m = -900.0),
            ("speed", |w| w.airspeed_mps = 15.0),
            ("speed", |w| w.airspeed_mps = 36.0),
            ("loiter-radius", |w| w.action = Action::Loiter { radius_m: 0.0 }),
            ("too-far", |w| w.position = w.position.destination(10.0, 100_000.0)),
            ("gradient", |w| w.altitude_amsl_m = 900.0),
            ("below-terrain", |w| w.altitude_amsl_m = 310.0),
        ];
        for (i, (code, spoil)) in cases.into_iter().enumerate() {
            let found = spoilt(spoil);
            assert!(found.contains(&code), "case {i}: {code} not in {found:?}");
        }
    }

    /// Refused, it would be flown by nobody, and the aircraft come down no higher. A climb is none of a glide's.
    #[test]
    fn of_a_glide_a_descent_is_not_judged_but_a_climb_and_the_ground_are() {
        let profile = Profile::default();
        let [here, high, steep, low] = [600.0, 900.0, 330.0, 310.0].map(|altitude_amsl_m| Waypoint {
            altitude_amsl_m,
            ..waypoint(0.0, if altitude_amsl_m == 600.0 { 0.0 } else { 500.0 })
        });
        let codes = |glides, last| -> Vec<_> {
            faults(&context(&profile, glides), None, Some(&here), last).into_iter().map(|f| f.code).collect()
        };
        assert_eq!((codes(false, &steep), codes(true, &steep)), (vec!["gradient"], vec![]));
        assert_eq!((codes(false, &high), codes(true, &high)), (vec!["gradient"], vec!["gradient"]));
        assert_eq!(codes(true, &low), ["below-terrain"]);
    }

    #[test]
    fn a_waypoint_too_low_says_by_how_much_its_leg_has_to_be_raised() {
        let low = Waypoint { altitude_amsl_m: GROUND_M + TERRAIN_MARGIN_M - 12.4, ..waypoint(0.0, 0.0) };
        let profile = Profile::default();
        let context = context(&profile, false);
        let faults = faults(&context, None, None, &low);
        let below = faults.iter().find(|fault| fault.code == "below-terrain").unwrap();
        assert!(
            below.sentence.ends_with("raise its leg by 13 m, or move it to lower ground."),
            "{}",
            below.sentence
        );
    }

    #[test]
    fn way_past_the_pole_is_refused_although_its_ends_are_not() {
        let at = |lon: f64| Waypoint { position: LatLon::new(88.995, lon), ..waypoint(0.0, 0.0) };
        assert_eq!(codes(&[at(0.0), at(20.0)]), ["near-pole"]);
        assert!(!codes(&[at(0.0), at(1.0)]).contains(&"near-pole"));
    }

    #[test]
    fn a_turn_that_does_not_fit_is_refused() {
        let corner = |out_m: f64| [waypoint(0.0, 0.0), waypoint(0.0, 30.0), waypoint(-out_m, 30.0)];
        assert_eq!(codes(&corner(20.0)), ["turn"]);
        assert!(codes(&corner(400.0)).is_empty());
    }

    /// Any number of a range, and what is none.
    fn number_in(range: std::ops::Range<f64>) -> impl Strategy<Value = f64> {
        prop_oneof![8 => range, 1 => prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY])]
    }

    proptest! {
        #[test]
        fn whatever_the_numbers_a_verdict_comes_and_nothing_unfit_passes(
            lat in number_in(-100.0..100.0), lon in number_in(-200.0..200.0),
            h in number_in(200.0..3_200.0), v in number_in(10.0..40.0),
        ) {
            let mut w = waypoint(0.0, 0.0);
            (w.position, w.altitude_amsl_m, w.airspeed_mps) = (LatLon::new(lat, lon), h, v);
            let profile = Profile::default();
            let fit = w.position.is_navigable()
                && (GROUND_M + TERRAIN_MARGIN_M..=profile.ceiling_amsl_m).contains(&h)
                && (profile.min_airspeed_mps..=profile.max_airspeed_mps).contains(&v);
            let alone = codes(std::slice::from_ref(&w));
            prop_assert_eq!(alone.is_empty(), fit);
            let after = codes(&[waypoint(0.0, 0.0), waypoint(0.0, 500.0), w]);
            prop_assert!(alone.iter().all(|code| after.contains(code)));
        }
    }
}
