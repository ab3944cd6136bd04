//! A link that carries nothing but `HIGH_LATENCY2`.

use super::*;

/// It returns, as its summary says.
fn returns() -> MavMessage {
    MavMessage::HIGH_LATENCY2(HIGH_LATENCY2_DATA { custom_mode: 0x0504, ..HIGH_LATENCY2_DATA::DEFAULT })
}

/// The radio is gone, and a failsafe takes the aircraft home.
#[test]
fn the_mode_of_a_summary_counts_while_no_heartbeats_come() {
    let mut rig = Rig::flying();
    rig.hear(&returns());
    assert_eq!(rig.mode(), Some(Mode::Waypoints), "a heartbeat is newer");
    rig.pass = Box::new(|_, m| !matches!(m, MavMessage::HEARTBEAT(_)));
    rig.run(6);
    rig.hear(&returns());
    assert_eq!(rig.mode(), Some(Mode::Return));
    let armed = rig.reports.iter().rev().find_map(|report| match report {
        Report::Heartbeat { armed, .. } => Some(*armed),
        _ => None,
    });
    assert_eq!(armed, Some(true), "of that it says nothing");
}
