//! What never happens, whatever is sent.

use super::*;

/// What a ground station does to a mission, well or badly.
#[derive(Debug, Clone)]
enum Deed {
    /// Uploads so many items, of which so many arrive; the one marked as current.
    Upload {
        items: u16,
        arrive: u16,
        marked: Option<u16>,
        lands: bool,
    },
    Clear,
    SetCurrent(u16),
    Mode(u8),
    Wait(u8),
}

fn deeds() -> impl Strategy<Value = Vec<Deed>> {
    let upload = (1_u16..12, 0_u16..14, prop::option::of(0_u16..12), prop::bool::weighted(0.8))
        .prop_map(|(items, arrive, marked, lands)| Deed::Upload { items, arrive, marked, lands });
    let deed = prop_oneof![
        4 => upload,
        1 => Just(Deed::Clear),
        2 => (0_u16..14).prop_map(Deed::SetCurrent),
        3 => (2_u8..7).prop_map(Deed::Mode),
        4 => (1_u8..200).prop_map(Deed::Wait),
    ];
    prop::collection::vec(deed, 1..25)
}

/// A list whose places no other list has.
fn distinct_list(number: usize, items: u16, lands: bool) -> Vec<MISSION_ITEM_INT_DATA> {
    let home = Config::default().home.position;
    let out_m = |i: u16| 1500.0 + 300.0 * f64::from(i) + number as f64;
    let mut list: Vec<_> = (0..items).map(|i| waypoint(home.destination(52.0, out_m(i)))).collect();
    if lands {
        let touch_down = home.destination(52.0, out_m(items) + 2500.0);
        list.push(wire(MavCmd::MAV_CMD_NAV_LAND, touch_down, 0.0));
    }
    list
}

fn places(list: &[MISSION_ITEM_INT_DATA]) -> Vec<(i32, i32)> {
    list.iter().map(|w| (w.x, w.y)).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    /// However uploads go, and whatever is asked for, in mission mode it steers to an item of the list that was accepted
    /// last, and only if that list can be flown.
    #[test]
    fn it_never_flies_to_an_item_of_a_list_that_was_not_accepted(deeds in deeds()) {
        let first = circuit(Config::default().home.position);
        let mut ground = Ground::px4_airborne(&first);
        let (mut aboard, mut is_fit) = (places(&first), true);
        for (number, deed) in deeds.into_iter().enumerate() {
            match deed {
                Deed::Upload { items, arrive, marked, lands } => {
                    let list = distinct_list(number, items, lands);
                    ground.count(list.len() as u16);
                    let mut answer = None;
                    for (i, item) in list.iter().enumerate().take(arrive.into()) {
                        let current = u8::from(marked == Some(i as u16));
                        answer = ground.item(&MISSION_ITEM_INT_DATA { seq: i as u16, current, ..item.clone() });
                    }
                    if answer == Some(MavMissionResult::MAV_MISSION_ACCEPTED) {
                        (aboard, is_fit) = (places(&list), lands);
                    } else {
                        let given_up = MavMissionResult::MAV_MISSION_OPERATION_CANCELLED;
                        let cancel = MISSION_ACK_DATA { mavtype: given_up, ..MISSION_ACK_DATA::DEFAULT };
                        ground.say(MavMessage::MISSION_ACK(cancel));
                    }
                }
                Deed::Clear => {
                    ground.say(MavMessage::MISSION_CLEAR_ALL(MISSION_CLEAR_ALL_DATA::DEFAULT));
                    (aboard, is_fit) = (vec![], false);
                }
                Deed::SetCurrent(seq) => {
                    ground.select(seq);
                }
                Deed::Mode(sub) => {
                    ground.enter([4.0, sub.into()]);
                }
                Deed::Wait(steps) => {
                    ground.fly_until(f64::from(steps) / 10.0, |_| false);
                }
            }
            let a = &ground.sim.autopilot;
            if let Some(target) = a.steered_to().filter(|_| a.mode() == Mode::Auto) {
                let place = (degrees_e7(target.position.lat_deg), degrees_e7(target.position.lon_deg));
                prop_assert!(is_fit && aboard.contains(&place), "flies to {place:?}, not of {aboard:?}");
            }
        }
    }

    /// Hostile messages: nothing panics, the list stays within its size, the aircraft on Earth.
    #[test]
    fn whatever_is_sent_it_stays_sane(bytes in hostile()) {
        let mut ground = Ground::px4_airborne(&circuit(Config::default().home.position));
        ground.endure(bytes);
        prop_assert!(ground.sim.autopilot.mission.items().len() <= 2000);
        prop_assert!(ground.position().is_valid());
    }
}
