//! A pilot who takes over right after an order of ours.

use super::*;

/// Position, at his sticks.
const HIS: (u8, u8) = (3, 0);

fn loses_answers(rig: &mut Rig) {
    rig.pass = Box::new(|to, m| to == To::Px4 || !matches!(m, MavMessage::COMMAND_ACK(_)));
}

fn orders() -> [Order; 3] {
    let direct = Aim::Direct { position: place(40), altitude_amsl_m: 600.0 };
    [Aim::Hold, direct, Aim::Return].map(Order::Steer)
}

#[test]
fn who_takes_over_after_the_ordered_mode_was_shown_keeps_it_though_our_order_was_never_answered() {
    for order in orders() {
        let mut rig = Rig::flying();
        loses_answers(&mut rig);
        let id = rig.order(order.clone());
        rig.until("done", |rig| rig.outcome(id).is_some());
        assert_eq!(rig.outcome(id), Some(Ok(())), "{order:?}");
        (0..3).for_each(|_| rig.step());
        rig.px4.mode(HIS.0, HIS.1);
        rig.run(20);
        assert_eq!((rig.px4.main, rig.px4.sub), HIS, "{order:?}");
    }
}

#[test]
fn who_takes_over_before_our_order_is_answered_keeps_it() {
    for order in orders() {
        let mut rig = Rig::flying();
        loses_answers(&mut rig);
        let id = rig.order(order.clone());
        (0..3).for_each(|_| rig.step());
        rig.px4.mode(HIS.0, HIS.1);
        rig.run(20);
        assert_eq!((rig.px4.main, rig.px4.sub), HIS, "{order:?}");
        assert!(rig.outcome(id).is_some_and(|outcome| outcome.is_err()), "{order:?}");
    }
}

#[test]
fn an_order_that_waits_behind_another_one_is_taken_back_when_the_pilot_has_it() {
    let mut rig = Rig::flying();
    loses_answers(&mut rig);
    rig.order(Order::Speed(25.0));
    rig.step();
    let hold = rig.order(Order::Steer(Aim::Hold));
    rig.px4.mode(HIS.0, HIS.1);
    rig.order(Order::HandsOff(true));
    rig.step();
    assert!(rig.outcome(hold).is_some_and(|outcome| outcome.is_err()));
    rig.pass = Box::new(|_, _| true);
    rig.run(20);
    assert_eq!((rig.px4.main, rig.px4.sub), HIS);
}
