//! Pure: who may stay at the port that everybody reaches.
//!
//! A connection is a **stranger** until the hub has answered its whole handshake; then it is a **guest**. Strangers have few
//! places and little time. When the places are full, one goes that belongs to whoever has most of them: no address, nor a few
//! together, can keep the others out.

use crate::gateway::order::Time;
use std::collections::{BTreeMap, VecDeque};
use std::net::{IpAddr, Ipv6Addr};
use std::time::Duration;

/// A connection.
pub type Id = u64;

/// Strangers at a time.
pub const STRANGERS_MAX: usize = 32;
/// Guests at a time.
pub const GUESTS_MAX: usize = 128;
/// Guests of one address at a time; a tunnel's end is one address.
pub const GUESTS_PER_ADDRESS_MAX: usize = 64;
/// A stranger who says nothing for so long goes.
const IDLE: Duration = Duration::from_secs(3);
/// A stranger who is not let in within this time goes, whatever it says.
const HANDSHAKE: Duration = Duration::from_secs(10);
/// So many turned away within [`PERIOD`] are a flood, which ends when nobody was turned away for so long.
const FLOOD: usize = 20;
const PERIOD: Duration = Duration::from_secs(10);

/// What happens at the door.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// A connection was made from there.
    Came(Id, IpAddr),
    /// A stranger said something.
    Spoke(Id),
    /// The hub has answered a stranger's handshake.
    LetIn(Id),
    /// A connection ended by itself.
    Gone(Id),
    /// Time passed.
    Tick,
}

/// The place that a guest gets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Nobody's.
    Free,
    /// That of this one, who goes.
    Of(Id),
}

/// Who is at the door and inside.
#[derive(Debug, Default)]
pub struct Guests {
    strangers: Vec<Stranger>,
    guests: BTreeMap<Id, IpAddr>,
    /// When the latest were turned away, at most [`FLOOD`].
    turned_away: VecDeque<Time>,
    flooded: bool,
    count: u64,
}

#[derive(Debug)]
struct Stranger {
    id: Id,
    network: IpAddr,
    came: Time,
    spoke: Option<Time>,
}

impl Stranger {
    fn goes_at(&self) -> Time {
        (self.spoke.unwrap_or(self.came) + IDLE).min(self.came + HANDSHAKE)
    }
}

impl Guests {
    /// Takes in what happened. Gives the connections to be closed.
    pub fn step(&mut self, now: Time, input: Input) -> Vec<Id> {
        let mut closed: Vec<Id> = match input {
            Input::Came(id, address) => self.came(now, id, network(address)).into_iter().collect(),
            Input::Spoke(id) => {
                self.strangers.iter_mut().filter(|s| s.id == id).for_each(|s| s.spoke = Some(now));
                vec![]
            }
            Input::LetIn(id) => self.let_in(id).into_iter().collect(),
            Input::Gone(id) => {
                self.strangers.retain(|s| s.id != id);
                self.guests.remove(&id);
                vec![]
            }
            Input::Tick => vec![],
        };
        closed.extend(self.strangers.iter().filter(|s| s.goes_at() <= now).map(|s| s.id));
        self.strangers.retain(|s| s.goes_at() > now);
        closed.iter().for_each(|_| self.turned_away(now));
        self.look(now);
        closed
    }

    /// When [`Self::step`] is due, even if nothing happens.
    pub fn deadline(&self) -> Option<Time> {
        let peace = self.turned_away.back().filter(|_| self.flooded).map(|last| *last + PERIOD);
        self.strangers.iter().map(Stranger::goes_at).chain(peace).min()
    }

    /// More connections come, or stay without a word, than can be meant well.
    pub fn is_flooded(&self) -> bool {
        self.flooded
    }

    /// How many were turned away so far.
    pub fn count(&self) -> u64 {
        self.count
    }

    fn came(&mut self, now: Time, id: Id, network: IpAddr) -> Option<Id> {
        if self.place_for(network).is_none() {
            return Some(id);
        }
        self.strangers.push(Stranger { id, network, came: now, spoke: None });
        (self.strangers.len() > STRANGERS_MAX).then(|| self.victim()).flatten()
    }

    fn let_in(&mut self, id: Id) -> Option<Id> {
        let at = self.strangers.iter().position(|s| s.id == id)?;
        let network = self.strangers.remove(at).network;
        let Some(place) = self.place_for(network) else { return Some(id) };
        let goes = match place {
            Place::Free => None,
            Place::Of(guest) => Some(guest),
        };
        if let Some(guest) = &goes {
            self.guests.remove(guest);
        }
        self.guests.insert(id, network);
        goes
    }

    /// The place of one more guest of a network, if there is one: when all are taken, that of who has most of them, as long as he
    /// keeps no fewer.
    fn place_for(&self, network: IpAddr) -> Option<Place> {
        let count = |of: IpAddr| self.guests.values().filter(|guest| **guest == of).count();
        let same = count(network);
        if same >= GUESTS_PER_ADDRESS_MAX {
            return None;
        }
        if self.guests.len() < GUESTS_MAX {
            return Some(Place::Free);
        }
        // of these who came last: the operator's window has been there for long
        let (newest, of) = self.guests.iter().max_by_key(|(id, of)| (count(**of), **id))?;
        (count(*of) > same + 1).then_some(Place::Of(*newest))
    }

    /// Of whoever has most places: first who said nothing, of these who is there for the longest time.
    fn victim(&mut self) -> Option<Id> {
        let places = |network: IpAddr| self.strangers.iter().filter(|s| s.network == network).count();
        let rank = |s: &Stranger| (places(s.network), s.spoke.is_none(), std::cmp::Reverse(s.came));
        let at = (0..self.strangers.len()).rev().max_by_key(|at| self.strangers.get(*at).map(rank))?;
        Some(self.strangers.remove(at).id)
    }

    fn turned_away(&mut self, now: Time) {
        self.count += 1;
        self.turned_away.push_back(now);
        if self.turned_away.len() > FLOOD {
            self.turned_away.pop_front();
        }
    }

    fn look(&mut self, now: Time) {
        let within = |at: Option<&Time>| at.is_some_and(|at| now.saturating_sub(*at) < PERIOD);
        let many = self.turned_away.len() >= FLOOD && within(self.turned_away.front());
        self.flooded = many || (self.flooded && within(self.turned_away.back()));
    }
}

/// Whose an address is: everybody has as many addresses of version 6 as they like.
fn network(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(v6) => IpAddr::V6(Ipv6Addr::from_bits(v6.to_bits() & (u128::MAX << 64))),
        v4 => v4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOBODY: [Id; 0] = [];
    const HERE: &str = "127.0.0.1";
    const THERE: &str = "10.0.0.7";

    fn at(seconds: f64) -> Time {
        Time::from_secs_f64(seconds)
    }

    fn came(guests: &mut Guests, seconds: f64, id: Id, from: &str) -> Vec<Id> {
        guests.step(at(seconds), Input::Came(id, from.parse().unwrap()))
    }

    fn let_in(guests: &mut Guests, seconds: f64, id: Id, from: &str) -> Vec<Id> {
        let mut closed = came(guests, seconds, id, from);
        closed.extend(guests.step(at(seconds), Input::Spoke(id)));
        closed.extend(guests.step(at(seconds), Input::LetIn(id)));
        closed
    }

    #[test]
    fn a_stranger_who_says_nothing_goes_after_three_seconds_and_a_guest_stays() {
        let mut guests = Guests::default();
        assert_eq!(let_in(&mut guests, 0.0, 1, HERE), NOBODY);
        assert_eq!(came(&mut guests, 0.5, 2, HERE), NOBODY);
        assert_eq!(guests.deadline(), Some(at(3.5)));
        assert_eq!(guests.step(at(3.4), Input::Tick), NOBODY);
        assert_eq!(guests.step(at(3.5), Input::Tick), [2]);
        assert_eq!(guests.deadline(), None);
        assert_eq!(guests.step(at(3600.0), Input::Tick), NOBODY);
        assert!(!guests.is_flooded(), "one is no flood");
    }

    #[test]
    fn a_stranger_who_only_talks_goes_after_ten_seconds() {
        let mut guests = Guests::default();
        came(&mut guests, 0.0, 1, HERE);
        for tenth in 0..100 {
            assert_eq!(guests.step(at(f64::from(tenth) * 0.1), Input::Spoke(1)), NOBODY, "{tenth}");
        }
        assert_eq!(guests.step(at(10.0), Input::Spoke(1)), [1]);
    }

    #[test]
    fn when_the_places_are_full_the_oldest_who_said_nothing_goes() {
        let mut guests = Guests::default();
        for id in 0..STRANGERS_MAX as Id {
            assert_eq!(came(&mut guests, 0.001 * id as f64, id, HERE), NOBODY);
        }
        guests.step(at(0.5), Input::Spoke(0));
        assert_eq!(came(&mut guests, 1.0, 100, HERE), [1]);
        assert_eq!(came(&mut guests, 1.0, 101, HERE), [2]);
        assert_eq!(guests.step(at(1.0), Input::LetIn(0)), NOBODY, "who talks is let in");
        assert_eq!(guests.guests.len(), 1);
    }

    #[test]
    fn who_has_many_places_makes_room_for_who_has_few() {
        let mut guests = Guests::default();
        came(&mut guests, 0.0, 1000, THERE);
        for id in 0..500 {
            let closed = came(&mut guests, 0.001 * (1 + id) as f64, id, HERE);
            assert!(!closed.contains(&1000), "{id}");
        }
        assert_eq!(guests.strangers.len(), STRANGERS_MAX);
        // all addresses of one network are one
        let mut guests = Guests::default();
        came(&mut guests, 0.0, 1000, THERE);
        for id in 0..500 {
            let closed = came(&mut guests, 0.001 * (1 + id) as f64, id, &format!("2001:db8::{id:x}"));
            assert!(!closed.contains(&1000), "{id}");
        }
    }

    #[test]
    fn an_address_has_so_many_guests_and_leaves_room_for_others() {
        let mut guests = Guests::default();
        for id in 0..GUESTS_PER_ADDRESS_MAX as Id {
            assert_eq!(let_in(&mut guests, 0.0, id, HERE), NOBODY);
        }
        assert_eq!(came(&mut guests, 0.0, 1000, HERE), [1000]);
        assert_eq!(came(&mut guests, 0.0, 1001, "::ffff:127.0.0.1"), [1001], "the same address");
        for id in 2000..2000 + GUESTS_PER_ADDRESS_MAX as Id {
            assert_eq!(let_in(&mut guests, 0.0, id, THERE), NOBODY);
        }
        assert_eq!(came(&mut guests, 0.0, 3000, HERE), [3000], "it has its share");
        guests.step(at(1.0), Input::Gone(5));
        assert_eq!(let_in(&mut guests, 1.0, 4000, HERE), NOBODY);
    }

    #[test]
    fn two_addresses_that_have_all_places_make_room_for_a_third_up_to_its_share() {
        let mut guests = Guests::default();
        let half = GUESTS_PER_ADDRESS_MAX as Id;
        (0..half).for_each(|id| drop(let_in(&mut guests, 0.0, id, HERE)));
        (half..2 * half).for_each(|id| drop(let_in(&mut guests, 0.0, id, THERE)));
        assert_eq!(guests.guests.len(), GUESTS_MAX);
        assert_eq!(
            let_in(&mut guests, 0.0, 1000, "10.0.0.8"),
            [2 * half - 1],
            "who came last of those with most"
        );
        assert_eq!(let_in(&mut guests, 0.0, 1001, "10.0.0.8"), [half - 1]);
        for id in 1002..1200 {
            let_in(&mut guests, 0.0, id, "10.0.0.8");
        }
        let count =
            |of: &str| guests.guests.values().filter(|guest| **guest == network(of.parse().unwrap())).count();
        assert_eq!(guests.guests.len(), GUESTS_MAX);
        assert_eq!([HERE, THERE, "10.0.0.8"].map(count), [43, 43, 42]);
    }

    #[test]
    fn strangers_who_are_let_in_together_are_not_too_many_either() {
        let mut guests = Guests::default();
        for id in 0..GUESTS_PER_ADDRESS_MAX as Id - 1 {
            let_in(&mut guests, 0.0, id, HERE);
        }
        assert_eq!(came(&mut guests, 0.0, 1000, HERE), NOBODY);
        assert_eq!(came(&mut guests, 0.0, 1001, HERE), NOBODY);
        assert_eq!(guests.step(at(0.0), Input::LetIn(1000)), NOBODY);
        assert_eq!(guests.step(at(0.0), Input::LetIn(1001)), [1001]);
    }

    #[test]
    fn a_flood_is_told_and_ends_with_ten_seconds_of_peace() {
        let mut guests = Guests::default();
        for id in 0..(STRANGERS_MAX + FLOOD) as Id - 1 {
            came(&mut guests, 0.001 * id as f64, id, HERE);
        }
        assert!(!guests.is_flooded());
        came(&mut guests, 0.1, 1000, HERE);
        assert!(guests.is_flooded());
        // the rest goes by itself
        assert_eq!(guests.step(at(3.5), Input::Tick).len(), STRANGERS_MAX);
        assert_eq!(guests.count(), (STRANGERS_MAX + FLOOD) as u64);
        assert_eq!(guests.deadline(), Some(at(13.5)));
        guests.step(at(13.4), Input::Tick);
        assert!(guests.is_flooded());
        guests.step(at(13.5), Input::Tick);
        assert!(!guests.is_flooded());
        assert_eq!(guests.deadline(), None);
    }

    #[test]
    fn what_is_said_of_somebody_unknown_means_nothing() {
        let mut guests = Guests::default();
        for input in [Input::Spoke(1), Input::LetIn(1), Input::Gone(1), Input::Tick] {
            assert_eq!(guests.step(at(1.0), input), NOBODY, "{input:?}");
        }
        assert!(guests.guests.is_empty() && guests.strangers.is_empty());
    }

    #[test]
    fn nothing_grows_however_many_come() {
        let mut guests = Guests::default();
        for id in 0..100_000_u32 {
            came(&mut guests, 1e-5 * f64::from(id), id.into(), &std::net::Ipv4Addr::from(id).to_string());
        }
        assert_eq!(guests.strangers.len(), STRANGERS_MAX);
        assert_eq!(guests.turned_away.len(), FLOOD);
    }
}
