//! The simulator is looked over, in simulated time.

use super::*;
use crate::gateway::driver::examination::Degree;
use crate::gateway::driver::{arduplane, px4};
use autopilot_link::frame::Decoder;
use autopilot_link::signing::{Key, Signing};
use sim::core::{Peer as SimPeer, Simulator};
use sim::{FaultRequest, Personality};

const PEER: SimPeer = SimPeer(1);

/// What is found out about a simulator after `prepare`.
fn look_over(personality: Personality, prepare: impl Fn(&mut Simulator)) -> Vec<Finding> {
    look_over_signed(personality, [None; 2], prepare).expect("it is heard")
}

/// With the keys of the autopilot and of the doctor; `None`: they don't believe each other.
fn look_over_signed(
    personality: Personality,
    keys: [Option<&str>; 2],
    prepare: impl Fn(&mut Simulator),
) -> Option<Vec<Finding>> {
    let config = sim::Config::default();
    let mut sim = Simulator::of(personality, config.profile, config.home, aircraft::Wind::default(), 1);
    sim.connect(PEER);
    prepare(&mut sim);
    let signing = |key: &str| Signing::new(Key::read(key).unwrap(), Duration::from_secs(1_763_884_800));
    let [mut far, own] = keys.map(|key| key.map(signing));
    let mut looked = Looked::new(&Setup { signing: own, ..Setup::default() });
    let mut outbox = Outbox::default();
    let mut decoder = sim::frame::Decoder::default();
    for _ in 0..1000 {
        sim.step();
        let now = Duration::from_nanos(sim.now_ns());
        for mut outgoing in sim.take_outgoing() {
            far.iter_mut().for_each(|far| far.sign(now, 0, &mut outgoing.bytes, 0));
            looked.receive(now, FromLink::Stream(&outgoing.bytes));
        }
        looked.tick(now);
        if looked.is_complete(now) {
            return Some(looked.findings(now));
        }
        outbox.clear();
        looked.send(&mut outbox);
        for bytes in outbox.frames() {
            if !far.as_mut().is_none_or(|far| believes(far, now, bytes)) {
                continue;
            }
            decoder.push(bytes);
            for frame in sim::frame::take_frames(&mut decoder) {
                sim.receive(PEER, frame);
            }
        }
    }
    assert!(!looked.has_heard(), "never complete: {:?}", looked.findings(Time::MAX));
    None
}

fn believes(signing: &mut Signing, now: Time, bytes: &[u8]) -> bool {
    let mut decoder = Decoder::default();
    decoder.push(bytes);
    decoder.next_frame().is_some_and(|frame| signing.believes(now, &frame))
}

#[test]
fn an_autopilot_with_a_key_is_looked_over_with_it() {
    let ready =
        |keys| look_over_signed(Personality::ArduPlane, keys, warm_up).map(|findings| to_do(&findings));
    assert_eq!(ready([Some("ours"), Some("ours")]), Some(vec![]));
    assert_eq!(ready([Some("ours"), Some("another")]), None);
    assert_eq!(ready([None, Some("ours")]), None);
}

fn warm_up(sim: &mut Simulator) {
    // its position is found first
    (0..600).for_each(|_| sim.step());
    sim.take_outgoing();
}

fn set(sim: &mut Simulator, name: &str, value: f32) {
    assert!(sim.autopilot.params.set(name, value), "{name}");
}

fn to_do(findings: &[Finding]) -> Vec<String> {
    let in_the_way = findings.iter().filter(|finding| finding.degree == Degree::ToDo);
    in_the_way.map(|finding| format!("{}: {}", finding.about, finding.says)).collect()
}

#[test]
fn a_good_autopilot_is_ready_and_everything_is_said_of_it() {
    for personality in [Personality::ArduPlane, Personality::Px4] {
        let findings = look_over(personality, |sim| {
            warm_up(sim);
            if personality == Personality::Px4 {
                set(sim, "MIS_TKO_LAND_REQ", 0.0);
            }
        });
        assert_eq!(to_do(&findings), Vec::<String>::new(), "{findings:#?}");
        for about in
            ["autopilot", "version", "state", "parameters", "gps", "home", "battery", "streams", "arming"]
        {
            assert!(findings.iter().any(|finding| finding.about == about), "{about}: {findings:#?}");
        }
    }
}

#[test]
fn parameters_in_the_way_are_named_with_the_value_to_set() {
    let px4 = to_do(&look_over(Personality::Px4, warm_up));
    assert!(
        matches!(&px4[..], [only] if only.contains("MIS_TKO_LAND_REQ is 2") && only.contains("to 0")),
        "{px4:?}"
    );
    let plane = to_do(&look_over(Personality::ArduPlane, |sim| {
        warm_up(sim);
        set(sim, "ARMING_CHECK", 0.0);
    }));
    assert!(matches!(&plane[..], [only] if only.contains("ARMING_CHECK is 0")), "{plane:?}");
}

/// What is said of a parameter that is set so.
fn said_of(personality: Personality, name: &str, value: f32) -> Vec<(Degree, String)> {
    let findings = look_over(personality, |sim| {
        warm_up(sim);
        set(sim, name, value);
    });
    let of_it = findings.into_iter().filter(|finding| finding.says.starts_with(name));
    of_it.map(|finding| (finding.degree, finding.says)).collect()
}

#[test]
fn what_takes_the_aircraft_from_the_plan_or_off_its_path_is_told_with_what_to_do() {
    use Personality::{ArduPlane, Px4};
    for (personality, name, bad, good, degree, remedy) in [
        (ArduPlane, "FS_GCS_ENABL", 1.0, 0.0, Degree::ToDo, "set it to 0"),
        (ArduPlane, "FS_SHORT_ACTN", 1.0, 3.0, Degree::Note, "set it to 0"),
        (ArduPlane, "FS_LONG_ACTN", 1.0, 4.0, Degree::Note, "set it to 0"),
        (ArduPlane, "ARSPD_USE", 0.0, 1.0, Degree::Note, "set it to 1"),
        (Px4, "FW_T_CLMB_R_SP", 3.0, 6.0, Degree::Note, "in cruise"),
        (Px4, "FW_T_SINK_R_SP", 2.0, 4.0, Degree::Note, "in cruise"),
        (Px4, "NAV_FW_ALT_RAD", 1.0, 10.0, Degree::Note, "set it to 10"),
        (Px4, "FW_LND_ANG", 3.0, 8.0, Degree::Note, "set it to 5"),
    ] {
        let told = said_of(personality, name, bad);
        assert!(matches!(&told[..], [(of, says)] if *of == degree && says.contains(remedy)), "{told:?}");
        let told = said_of(personality, name, good);
        assert!(matches!(&told[..], [(Degree::Ok, _)]), "{told:?}");
    }
}

/// The simulator does not let all of them be set.
#[test]
fn the_limits_of_what_is_flown_well_are_those_that_were_flown() {
    let (plane, px4) = (&arduplane::DIALECT, &px4::FIXED_WING);
    let cases: [(&Dialect, &str, &[f64], &[f64]); 4] = [
        (plane, "NAVL1_PERIOD", &[8.0, 15.0, 20.0], &[7.9, 20.1]),
        (plane, "WP_RADIUS", &[10.0, 50.0], &[2.0, 9.9]),
        // an aircraft that climbs and sinks more slowly than by default is set so, too
        (px4, "FW_T_CLMB_R_SP", &[2.5, 6.0], &[3.0]),
        (px4, "FW_T_SINK_R_SP", &[1.5, 4.0], &[2.0]),
    ];
    for (dialect, name, good, bad) in cases {
        let advice = dialect.advice.iter().find(|advice| advice.name == name).unwrap();
        assert!(good.iter().all(|value| (advice.is_good)(*value)), "{name}");
        assert!(!bad.iter().any(|value| (advice.is_good)(*value)), "{name}");
    }
}

#[test]
fn what_is_missing_in_flight_is_missed_on_the_ground() {
    for (fault, about) in [("gps-loss", "gps: no 3D fix"), ("low-battery", "battery: ")] {
        let found = to_do(&look_over(Personality::ArduPlane, |sim| {
            warm_up(sim);
            assert!(sim.inject(fault.parse::<FaultRequest>().unwrap()));
            (0..20).for_each(|_| sim.step());
        }));
        assert!(found.iter().any(|line| line.starts_with(about)), "{fault}: {found:?}");
    }
}

#[test]
fn silence_is_never_complete_and_finds_nothing() {
    let mut looked = Looked::default();
    looked.tick(Duration::from_secs(100));
    assert!(!looked.has_heard() && !looked.is_complete(Duration::from_secs(100)));
    assert_eq!(looked.findings(Duration::from_secs(100)), vec![]);
}
