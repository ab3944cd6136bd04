//! An autopilot that complains of whatever comes, and asks for nothing.

use super::*;

/// It does so until then.
const UNTIL: Time = Duration::from_secs(100);

/// What it asks for first arrives, none of what it is sent does, and each is complained of.
struct Complaining {
    /// Times that a list was begun.
    begun: u32,
    asked: u32,
}

impl Radio for Complaining {
    fn pass(&mut self, now: Time, sent: Delivery, out: &mut Vec<Delivery>) {
        let is_item = matches!(sent.message, MavMessage::MISSION_ITEM_INT(_));
        let is_ack = matches!(sent.message, MavMessage::MISSION_ACK(_));
        match sent.to {
            _ if now >= UNTIL => out.push(sent),
            To::Autopilot if is_item => {
                let message = ack(Code::MAV_MISSION_INVALID_SEQUENCE);
                out.push(Delivery { to: To::Driver, from: AUTOPILOT, message });
            }
            To::Driver if is_ack => {}
            To::Driver if asks_for_an_item(sent.to, &sent.message) => {
                let is_first = self.asked < self.begun;
                self.asked = self.begun;
                out.extend(is_first.then_some(sent));
            }
            _ => {
                self.begun += u32::from(matches!(sent.message, MavMessage::MISSION_COUNT(_)));
                out.push(sent);
            }
        }
    }
}

#[test]
fn it_is_given_up_and_begun_anew_until_it_takes_the_list() {
    for personality in PERSONALITIES {
        let mut field = Rig::new(personality, Fitted::new(), Complaining { begun: 0, asked: 0 });
        field.end.feed(field.now, waypoints(1, 12));
        field.until(UNTIL.as_secs() + 1, "until then", |field| field.now >= UNTIL);
        let begun = field.radio.begun;
        assert!(!field.end.ready && (2..8).contains(&begun), "{personality}: begun {begun} times");
        field.until(WITHIN_S, "aboard", |field| field.end.ready);
    }
}
