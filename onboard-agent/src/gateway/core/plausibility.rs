//! Is a batch of waypoints fit to be flown? One rule, one function.

use crate::gateway::window::CAPACITY;
use aircraft::Profile;
use geometry::LatLon;
use terrain::Terrain;
use usal::contract::{Action, Token, Waypoint};

/// Farther apart than this, two waypoints are a mistake, metres.
const FARTHEST_M: f64 = 50_000.0;
/// Highest and lowest altitudes that make sense at all, metres AMSL.
const ALTITUDES_M: std::ops::RangeInclusive<f64> = -500.0..=12_000.0;
/// Height that an en-route waypoint keeps above the ground, metres.
const TERRAIN_MARGIN_M: f64 = 20.0;
/// Share by which a gradient may exceed the aircraft's: plans are checked to their own margins.
const GRADIENT_SLACK: f64 = 1.5;
/// Longest batch.
const LONGEST_BATCH: usize = CAPACITY;
/// Loiters smaller than this can't be flown by anything, metres.
const SMALLEST_LOITER_M: f64 = 10.0;
/// Standard gravity, m/s².
const G_MPS2: f64 = 9.806_65;

/// A waypoint that is to blame: token, code for programs, sentence for people.
pub type Fault = (Token, String, String);

/// What the rules know about the aircraft and the world.
pub struct Context<'a> {
    /// The aircraft.
    pub profile: &'a Profile,
    /// The ground, if known.
    pub terrain: Option<&'a dyn Terrain>,
    /// Wind speed, m/s.
    pub wind_mps: f64,
    /// Highest token ever accepted.
    pub highest: Token,
}

type Rule = fn(&Context, Option<&Waypoint>, &Waypoint) -> Option<(&'static str, String)>;

/// Rules without which the others make no sense.
const NUMBERS: [Rule; 2] = [number, place];
/// Rules on one waypoint and the one before it.
const RULES: [Rule; 6] = [altitude, speed, loiter, distance, gradient, above_terrain];

/// Everything that is wrong with a batch that follows on `previous`, whose own predecessor is
/// `before_previous`. Empty: it may be flown.
pub fn faults(
    context: &Context,
    before_previous: Option<LatLon>,
    previous: Option<&Waypoint>,
    batch: &[Waypoint],
) -> Vec<Fault> {
    if batch.len() > LONGEST_BATCH {
        let token = batch.first().map_or(Token(0), |w| w.token);
        return vec![fault(
            token,
            ("batch-too-long", format!("Send at most {LONGEST_BATCH} waypoints at once.")),
        )];
    }
    let mut found: Vec<Fault> = sequence(context, batch).map(|(t, f)| fault(t, f)).into_iter().collect();
    let mut last = previous;
    let mut before = before_previous;
    for waypoint in batch {
        let broken = match NUMBERS.iter().find_map(|rule| rule(context, last, waypoint)) {
            // nothing else can be said about a place that is none
            Some(nonsense) => vec![nonsense],
            None => {
                let rules = RULES.iter().filter_map(|rule| rule(context, last, waypoint));
                rules.chain(turn(context, before, last, waypoint)).collect()
            }
        };
        found.extend(broken.into_iter().map(|f| fault(waypoint.token, f)));
        before = last.map(|w| w.position);
        last = Some(waypoint);
    }
    found
}

fn fault(token: Token, (code, sentence): (&'static str, String)) -> Fault {
    (token, code.to_owned(), sentence)
}

/// Tokens rise by one within a batch and are above every token accepted before.
fn sequence(context: &Context, batch: &[Waypoint]) -> Option<(Token, (&'static str, String))> {
    let mut expected = None;
    for waypoint in batch {
        let token = waypoint.token;
        let repeated = token <= context.highest;
        if repeated || expected.is_some_and(|e| e != token) {
            let code = if repeated { "token-repeated" } else { "token-gap" };
            let highest = context.highest.0;
            let text = format!("Number waypoints one by one from above {highest}; got {}.", token.0);
            return Some((token, (code, text)));
        }
        expected = Some(Token(token.0.saturating_add(1)));
    }
    None
}

fn number(_: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    let heading = match w.action {
        Action::TakeOff { heading_deg } | Action::Land { heading_deg } => heading_deg,
        Action::Loiter { radius_m } => radius_m,
        Action::Fly => 0.0,
    };
    let all = [w.position.lat_deg, w.position.lon_deg, w.altitude_amsl_m, w.airspeed_mps, heading];
    (!all.iter().all(|v| v.is_finite()))
        .then(|| ("not-a-number", "Every number of a waypoint has to be finite.".to_owned()))
}

fn place(_: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    let LatLon { lat_deg, lon_deg } = w.position;
    let null_island = lat_deg == 0.0 && lon_deg == 0.0;
    (!w.position.is_valid() || null_island).then(|| {
        ("no-such-place", format!("{lat_deg}, {lon_deg} is not a place to fly to; latitude is within ±90, longitude within ±180 degrees, and 0, 0 means that it was left out."))
    })
}

fn altitude(c: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    let (h, ceiling) = (w.altitude_amsl_m, c.profile.ceiling_amsl_m);
    let bad = !ALTITUDES_M.contains(&h) || h > ceiling;
    bad.then(|| ("altitude", format!("{h:.0} m AMSL is out of range; the ceiling is {ceiling:.0} m.")))
}

fn speed(c: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    let (low, high) = (c.profile.min_airspeed_mps, c.profile.max_airspeed_mps);
    (!(low..=high).contains(&w.airspeed_mps))
        .then(|| ("speed", format!("{:.1} m/s is outside {low:.1} to {high:.1} m/s.", w.airspeed_mps)))
}

fn loiter(_: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    match w.action {
        Action::Loiter { radius_m } if radius_m.abs() < SMALLEST_LOITER_M => Some((
            "loiter-radius",
            format!("A loiter of {radius_m:.0} m can't be flown; give at least {SMALLEST_LOITER_M:.0} m."),
        )),
        _ => None,
    }
}

fn distance(_: &Context, p: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    let far_m = p?.position.distance_m(w.position);
    (far_m > FARTHEST_M).then(|| {
        (
            "too-far",
            format!("{:.0} km from the waypoint before it; at most {:.0} km.", far_m / 1e3, FARTHEST_M / 1e3),
        )
    })
}

/// Climb or descent along the segment against what the aircraft does at that ground speed.
fn gradient(c: &Context, p: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    let previous = p?;
    if matches!(previous.action, Action::TakeOff { .. }) || matches!(w.action, Action::TakeOff { .. }) {
        return None;
    }
    let length_m = previous.position.distance_m(w.position);
    let rise_m = w.altitude_amsl_m - previous.altitude_amsl_m;
    let rate = if rise_m > 0.0 { c.profile.max_climb_mps } else { c.profile.max_descent_mps };
    let ground_mps = (w.airspeed_mps + c.wind_mps).max(1.0);
    // ten metres of grace: corners are rounded, and short segments carry rounded altitudes
    let most_m = GRADIENT_SLACK * rate * length_m / ground_mps + 10.0;
    (rise_m.abs() > most_m).then(|| {
        ("gradient", format!("{rise_m:+.0} m over {length_m:.0} m is steeper than the aircraft can fly; at most {most_m:.0} m."))
    })
}

fn above_terrain(c: &Context, _: Option<&Waypoint>, w: &Waypoint) -> Option<(&'static str, String)> {
    if matches!(w.action, Action::Land { .. } | Action::TakeOff { .. }) {
        return None;
    }
    let ground_m = c.terrain?.elevation_m(w.position)?;
    let least_m = ground_m + TERRAIN_MARGIN_M;
    (w.altitude_amsl_m < least_m).then(|| {
        (
            "below-terrain",
            format!(
                "{:.0} m AMSL is too low over ground of {ground_m:.0} m; fly at least {least_m:.0} m.",
                w.altitude_amsl_m
            ),
        )
    })
}

/// The turn at the waypoint before: the tangent length r·tan(Δ/2) of the tightest turn has to fit
/// into both segments together (steepest bank, wind added to the speed).
fn turn(
    c: &Context,
    before: Option<LatLon>,
    previous: Option<&Waypoint>,
    w: &Waypoint,
) -> Option<(&'static str, String)> {
    let (a, b) = (before?, previous?);
    if b.fly_over || !matches!(b.action, Action::Fly) || !matches!(w.action, Action::Fly) {
        return None;
    }
    let (first, second) = (a.inverse(b.position), b.position.inverse(w.position));
    let angle_deg = geometry::geodesy::normalise_180(second.bearing_start_deg - first.bearing_end_deg).abs();
    // a reversal is flown as a loop, whatever the segments
    if angle_deg > 135.0 || second.distance_m < 1.0 || first.distance_m < 1.0 {
        return None;
    }
    let ground_mps = b.airspeed_mps + c.wind_mps;
    let radius_m = ground_mps.powi(2) / (G_MPS2 * c.profile.max_bank_deg.to_radians().tan());
    let need_m = radius_m * (angle_deg / 2.0).to_radians().tan();
    let have_m = first.distance_m + second.distance_m;
    (need_m > have_m).then(|| {
        ("turn", format!("Turning {angle_deg:.0}° needs {need_m:.0} m before and after the corner; there are {have_m:.0} m."))
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use proptest::prelude::*;
    use usal::contract::Id;

    const BASE: LatLon = LatLon::new(36.49, -84.27);

    fn waypoint(token: u64, east_m: f64, north_m: f64) -> Waypoint {
        let place = BASE.destination(90.0, east_m).destination(0.0, north_m);
        Waypoint {
            token: Token(token),
            position: place,
            altitude_amsl_m: 600.0,
            airspeed_mps: 25.0,
            action: Action::Fly,
            fly_over: false,
            leg: Id::from("leg"),
            end_of_plan: false,
        }
    }

    /// The codes for a batch of three good waypoints, the last of which was spoilt.
    fn check(spoil: impl FnOnce(&mut Waypoint)) -> Vec<String> {
        let mut batch = vec![waypoint(8, 0.0, 0.0), waypoint(9, 0.0, 500.0), waypoint(10, 300.0, 900.0)];
        spoil(&mut batch[2]);
        codes(&batch, Token(7))
    }

    fn codes(batch: &[Waypoint], highest: Token) -> Vec<String> {
        let profile = Profile::default();
        let ground = terrain::Flat(300.0);
        let context = Context { profile: &profile, terrain: Some(&ground), wind_mps: 5.0, highest };
        faults(&context, None, None, batch).into_iter().map(|f| f.1).collect()
    }

    #[test]
    fn a_good_batch_passes() {
        assert_eq!(check(|_| {}), Vec::<String>::new());
    }

    #[test]
    fn each_rule_refuses_what_it_is_there_for() {
        type Spoil = fn(&mut Waypoint);
        let cases: [(&str, Spoil); 16] = [
            ("not-a-number", |w| w.position.lat_deg = f64::NAN),
            ("not-a-number", |w| w.altitude_amsl_m = f64::INFINITY),
            ("not-a-number", |w| w.airspeed_mps = f64::NAN),
            ("not-a-number", |w| w.action = Action::Land { heading_deg: f64::NAN }),
            ("no-such-place", |w| w.position.lat_deg = 91.0),
            ("no-such-place", |w| w.position.lon_deg = -180.5),
            ("no-such-place", |w| w.position = LatLon::new(0.0, 0.0)),
            ("altitude", |w| w.altitude_amsl_m = 3100.0),
            ("altitude", |w| w.altitude_amsl_m = -900.0),
            ("speed", |w| w.airspeed_mps = 15.0),
            ("speed", |w| w.airspeed_mps = 36.0),
            ("loiter-radius", |w| w.action = Action::Loiter { radius_m: 0.0 }),
            ("too-far", |w| w.position = w.position.destination(10.0, 100_000.0)),
            ("gradient", |w| w.altitude_amsl_m = 900.0),
            ("below-terrain", |w| w.altitude_amsl_m = 310.0),
            ("token-gap", |w| w.token = Token(11)),
        ];
        for (i, (code, spoil)) in cases.into_iter().enumerate() {
            let found = check(spoil);
            assert!(found.contains(&code.to_owned()), "case {i}: {code} not in {found:?}");
        }
    }

    #[test]
    fn a_turn_that_does_not_fit_is_refused() {
        let corner = |out_m: f64| [waypoint(1, 0.0, 0.0), waypoint(2, 0.0, 30.0), waypoint(3, -out_m, 30.0)];
        assert_eq!(codes(&corner(20.0), Token(0)), ["turn"]);
        assert_eq!(codes(&corner(400.0), Token(0)), Vec::<String>::new());
    }

    #[test]
    fn repeated_tokens_are_refused() {
        assert_eq!(codes(&[waypoint(7, 0.0, 0.0)], Token(7)), ["token-repeated"]);
        assert_eq!(codes(&[waypoint(8, 0.0, 0.0), waypoint(8, 0.0, 400.0)], Token(7)), ["token-gap"]);
    }

    #[test]
    fn a_batch_larger_than_the_buffer_is_refused_at_once() {
        let batch: Vec<_> = (1..=300).map(|i| waypoint(i, 0.0, i as f64 * 50.0)).collect();
        assert_eq!(codes(&batch, Token(0)), ["batch-too-long"]);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn whatever_the_numbers_a_verdict_comes_and_nothing_unfit_passes(
            lat in prop_oneof![Just(f64::NAN), -200.0..200.0f64], lon in -400.0..400.0f64,
            h in prop_oneof![Just(f64::NEG_INFINITY), -1e4..2e4f64], v in -10.0..100.0f64,
        ) {
            let mut w = waypoint(1, 0.0, 0.0);
            (w.position, w.altitude_amsl_m, w.airspeed_mps) = (LatLon::new(lat, lon), h, v);
            if codes(std::slice::from_ref(&w), Token(0)).is_empty() {
                prop_assert!(w.position.is_valid() && (320.0..=3000.0).contains(&h) && (16.0..=35.0).contains(&v));
            }
        }
    }
}
