//! A link that carries nothing but `HIGH_LATENCY2`.

use super::*;

/// It returns, as its summary says.
fn returns() -> MavMessage {
    returns_at(0)
}

/// As of this time of its clock, ms.
fn returns_at(timestamp: u32) -> MavMessage {
    let custom_mode = 0x0504;
    MavMessage::HIGH_LATENCY2(HIGH_LATENCY2_DATA { timestamp, custom_mode, ..HIGH_LATENCY2_DATA::DEFAULT })
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

/// The satellite takes a minute: that summary told the mode of before the pilot took over.
#[test]
fn a_summary_that_was_made_before_the_last_heartbeat_tells_no_mode() {
    let mut rig = Rig::flying();
    let attitude = ATTITUDE_DATA { time_boot_ms: 60_000, ..ATTITUDE_DATA::DEFAULT };
    rig.hear(&MavMessage::ATTITUDE(attitude));
    rig.px4.mode(3, 0);
    rig.run(2);
    rig.pass = Box::new(|_, m| !matches!(m, MavMessage::HEARTBEAT(_)));
    rig.run(6);
    rig.hear(&returns_at(30_000));
    assert_eq!(rig.mode(), Some(Mode::Other(0x3_0000)));
    rig.hear(&returns_at(61_000));
    assert_eq!(rig.mode(), Some(Mode::Return));
}
