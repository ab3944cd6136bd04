//! A glide to a landing: where it leads, and the altitude that it has there. What is checked here is what is fed.
//!
//! The autopilot flies straight from altitude to altitude. So it is told at each place the altitude that the glide has there: led
//! down sooner it would lack that height before the runway. What the rest of the way can't lose is lost in circles where the approach
//! begins, and what is left of it on the way there.

use super::gates::{Circles, Gate, is_over_ground};
use super::way::gates;
use super::{Approach, Situation};
use aircraft::glide::{Circle, GlidePoint, GlideStart, glide, reserve_m};
use geometry::geodesy::normalise_180;
use usal::contract::{SafeParameters, SafeRunway};

/// Least height above the ground on the way, metres.
pub(super) const SPARE_M: f64 = 15.0;
/// Share of the steepest descent that is counted on.
const STEEP: f64 = 0.7;

/// A glide that comes to a runway, and above the ground on the way.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Glide {
    /// From the initial approach point, with its circles, to the last gate before the landing.
    pub gates: Vec<Gate>,
    /// Time to the threshold without circles, seconds: these take away nothing but height that is too much.
    pub time_s: f64,
    /// It comes there with the whole reserve, and not only with that of a short one.
    pub keeps_reserve: bool,
}

/// The glide from where the aircraft is; `None`: it does not come there.
pub(super) fn glide_in(
    runway: &SafeRunway,
    approach: Approach,
    safe: &SafeParameters,
    s: &Situation,
) -> Option<Glide> {
    let [initial, last] = gates(runway, approach, safe).map(|(place, _)| place);
    let start =
        GlideStart { position: s.position, altitude_amsl_m: s.altitude_amsl_m, course_deg: s.track_deg };
    let way = [initial, last, runway.threshold];
    let points = glide(s.profile, s.wind().into(), start, &way, runway.heading_deg)?;
    let [.., at_initial, at_last, end] = points.as_slice() else { return None };
    let takes_m = s.altitude_amsl_m - end.altitude_amsl_m;
    let height_m = end.altitude_amsl_m - runway.elevation_amsl_m;
    if height_m < reserve_m(0.0) {
        return None;
    }
    let told = told(runway, s, [at_initial, at_last, end]);
    let right = normalise_180(runway.heading_deg - s.position.bearing_deg(initial)) >= 0.0;
    let sides = [right, !right].map(|right| {
        let altitudes = (at_initial.altitude_amsl_m, told.initial_m);
        let circles =
            Circles { count: told.circles, radius_m: Circle::of(s.profile, s.wind()).radius_m, right };
        let mut gates = circles.gates(initial, runway.heading_deg, altitudes);
        gates.push(Gate { position: last, altitude_amsl_m: told.last_m, on_arc: false });
        gates
    });
    let gates = sides.into_iter().find(|gates| is_over_ground(gates, s, |_| SPARE_M))?;
    Some(Glide { gates, time_s: end.time_s, keeps_reserve: height_m >= reserve_m(takes_m) })
}

/// What it is told.
struct Told {
    /// So many circles first.
    circles: u32,
    /// When the approach begins, metres AMSL.
    initial_m: f64,
    /// Where the final descent begins, metres AMSL.
    last_m: f64,
}

/// From each place on it keeps the reserve of the way from there.
fn told(runway: &SafeRunway, s: &Situation, [initial, last, end]: [&GlidePoint; 3]) -> Told {
    let (height_m, sinks_m) = (initial.altitude_amsl_m, initial.altitude_amsl_m - last.altitude_amsl_m);
    let needed_m = |from: &GlidePoint| {
        let takes_m = from.altitude_amsl_m - end.altitude_amsl_m;
        runway.elevation_amsl_m + takes_m + reserve_m(takes_m)
    };
    let falls_m =
        |from: &GlidePoint, to: &GlidePoint| STEEP * s.profile.max_descent_mps * (to.time_s - from.time_s);
    let most_last_m = needed_m(last).max(runway.elevation_amsl_m + falls_m(last, end));
    let most_initial_m = needed_m(initial).max(most_last_m + falls_m(initial, last));
    let circle = Circle::of(s.profile, s.wind());
    let circles = if height_m > most_initial_m { circle.most(height_m - needed_m(initial)) } else { 0 };
    let initial_m = (height_m - f64::from(circles) * circle.height_m).min(most_initial_m);
    Told { circles, initial_m, last_m: (initial_m - sinks_m).min(most_last_m) }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{runway, situation};
    use super::super::{choose, path};
    use super::*;
    use aircraft::autopilot::{Action as Does, Guidance, Target};
    use aircraft::{Aircraft, Profile, Wind};
    use geometry::LatLon;
    use usal::contract::{Action, Air, Waypoint};

    const LENGTH_M: f64 = 600.0;

    fn target(w: &Waypoint) -> Target {
        let action = match w.action {
            Action::Land { heading_deg } => Does::Land { heading_deg },
            _ => Does::Fly,
        };
        let Waypoint { position, altitude_amsl_m, airspeed_mps, fly_over, .. } = *w;
        Target { position, altitude_amsl_m, airspeed_mps, action, fly_over, acceptance_m: None }
    }

    /// Flies a way with a dead engine; where it comes down.
    fn comes_down(way: &[Waypoint], s: &Situation) -> LatLon {
        let mut aircraft = Aircraft::in_flight(s.profile.clone(), s.position, s.altitude_amsl_m, s.track_deg);
        aircraft.set_engine_healthy(false);
        let mut guidance = Guidance::new(s.profile.clone());
        let mut targets = way.iter().map(target).peekable();
        guidance.direct(aircraft.state(), targets.next().unwrap());
        for _ in 0..20_000 {
            let guided = guidance.step(aircraft.state(), targets.peek());
            if let Some(next) = guided.reached.then(|| targets.next()).flatten() {
                guidance.proceed(aircraft.state(), next);
            }
            aircraft.step(0.2, &guided.demand, &s.wind());
            if aircraft.state().on_ground {
                return aircraft.state().position;
            }
            assert!(aircraft.state().altitude_amsl_m > 322.0, "{:?} it is in the ground", guided);
        }
        panic!("it never comes down")
    }

    fn air(wind: Wind) -> Air {
        let Wind { east_mps: wind_east_mps, north_mps: wind_north_mps } = wind;
        Air { airspeed_mps: 25.0, wind_east_mps, wind_north_mps, pressure_hpa: 970.0, temperature_c: 20.0 }
    }

    /// Bearing and distance of the runway, its heading, height above it.
    const SITUATIONS: [(f64, f64, f64, f64); 7] = [
        (0.0, 8.0, 0.0, 1200.0),
        (0.0, 3.0, 0.0, 330.0),
        (90.0, 3.0, 0.0, 420.0),
        (180.0, 4.0, 300.0, 900.0),
        (40.0, 1.0, 220.0, 250.0),
        (300.0, 0.3, 100.0, 1500.0),
        (10.0, 5.0, 90.0, 700.0),
    ];

    #[test]
    fn every_runway_that_is_chosen_for_a_glide_is_landed_on() {
        for name in Profile::names() {
            let profile = Profile::by_name(name).unwrap();
            let mut landed = 0;
            for (bearing_deg, km, heading_deg, height_m) in SITUATIONS {
                let runways = [runway("it", bearing_deg, km, heading_deg, 1)];
                let wind = Wind::from_direction(heading_deg + 30.0, 0.15 * profile.cruise_airspeed_mps);
                let s = Situation {
                    glides: true,
                    altitude_amsl_m: 322.0 + height_m,
                    air: Some(air(wind)),
                    ..situation(&profile)
                };
                let Some(landing) = choose(&runways, &SafeParameters::default(), &s) else { continue };
                let down = comes_down(&path(&landing, &SafeParameters::default(), &s), &s);
                let threshold = landing.runway.threshold;
                let off_deg = threshold.bearing_deg(down) - landing.runway.heading_deg;
                let (distance_m, off_rad) = (threshold.distance_m(down), off_deg.to_radians());
                let (along_m, aside_m) = (distance_m * off_rad.cos(), distance_m * off_rad.sin());
                let case = format!("{name}, {bearing_deg}° {km} km, {height_m} m: {landing}");
                assert!((0.0..LENGTH_M).contains(&along_m), "{case}: {along_m:.0} m behind the threshold");
                assert!(aside_m.abs() < 40.0, "{case}: {aside_m:.0} m beside it");
                landed += 1;
            }
            assert!(landed >= 4, "{name}: {landed}");
        }
    }

    #[test]
    fn it_is_told_what_the_glide_has_and_loses_the_rest_in_circles() {
        let profile = Profile::default();
        let s = Situation { glides: true, altitude_amsl_m: 1522.0, ..situation(&profile) };
        let runway = runway("it", 0.0, 4.0, 0.0, 1);
        let glide = glide_in(&runway, Approach::Whole, &SafeParameters::default(), &s).unwrap();
        let has_m = 1522.0 - s.position.distance_m(glide.gates[0].position) / profile.glide_ratio;
        assert!((glide.gates[0].altitude_amsl_m - has_m).abs() < 5.0, "{glide:?}");
        assert!(glide.gates.iter().filter(|gate| gate.on_arc).count() > 16, "{glide:?}");
        let last = glide.gates.last().unwrap();
        let needed_m = last.position.distance_m(runway.threshold) / profile.glide_ratio;
        assert!((needed_m..1.5 * needed_m).contains(&(last.altitude_amsl_m - 322.0)), "{glide:?}");
        let turned = glide.gates.windows(2).all(|pair| pair[0].altitude_amsl_m > pair[1].altitude_amsl_m);
        assert!(turned, "nothing is level: {glide:?}");
    }
}
