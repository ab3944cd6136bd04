//! What a step costs: aircraft alone, and with guidance, as in a preview. Two hours are 72,000 steps.

use aircraft::{Action, Aircraft, Demand, Guidance, Profile, Target, Wind};
use divan::Bencher;
use geometry::LatLon;
use std::hint::black_box;

fn main() {
    divan::main();
}

const WIND: Wind = Wind { east_mps: 3.0, north_mps: -4.0 };
const HOME: LatLon = LatLon::new(36.4905, -84.2710);

fn aircraft() -> Aircraft {
    Aircraft::in_flight(Profile::default(), HOME, 900.0, 0.0)
}

#[divan::bench]
fn aircraft_step(bencher: Bencher) {
    let mut a = aircraft();
    let demand = Demand { bank_rad: 0.2, climb_mps: 0.5, airspeed_mps: 25.0, ground_amsl_m: None };
    bencher.bench_local(|| a.step(black_box(0.1), black_box(&demand), &WIND));
}

#[divan::bench(sample_count = 10)]
fn two_hours_of_flight_with_guidance() -> LatLon {
    let mut a = aircraft();
    let mut guidance = Guidance::new(Profile::default());
    let target = |i: u32| Target {
        position: HOME.destination(f64::from(i % 4) * 90.0, 2000.0),
        altitude_amsl_m: 900.0 + f64::from(i % 3) * 20.0,
        airspeed_mps: 25.0,
        action: Action::Fly,
        fly_over: false,
        acceptance_m: None,
    };
    let mut i = 0;
    let mut next = target(1);
    guidance.direct(a.state(), target(0));
    for _ in 0..72_000 {
        let guided = guidance.step(a.state(), Some(&next));
        if guided.reached {
            i += 1;
            guidance.proceed(a.state(), next);
            next = target(i + 1);
        }
        a.step(0.1, &guided.demand, &WIND);
    }
    a.state().position
}
