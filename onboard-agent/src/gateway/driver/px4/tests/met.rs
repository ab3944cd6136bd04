//! A PX4 that flies already.

use super::*;

#[test]
fn that_it_holds_behind_the_end_of_our_list_is_nobodys_doing() {
    // twelve waypoints, a climb-out, and the loiter behind them; without a memory nothing is known of them
    for (entry, known, by_itself) in [(13, 12, true), (5, 12, false), (13, 0, true), (5, 0, false)] {
        let mut rig = Rig::flying();
        rig.driver = (DEFAULT.make)(&Setup::default());
        rig.px4.mode(4, 3);
        rig.px4.seq = Some(entry);
        rig.run(3);
        rig.reports.clear();
        rig.order(Order::Adopt(waypoints(1, known)));
        let is_read = |rig: &Rig| rig.reports.iter().any(|r| matches!(r, Report::Adopted(_, Some(_))));
        rig.until("it is read", is_read);
        assert_eq!(rig.reports.contains(&Report::HoldsByItself), by_itself, "entry {entry}, {known} known");
    }
}
