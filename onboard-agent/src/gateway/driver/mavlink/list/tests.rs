//! The list with a window that only notes what it is told.

use super::*;
use std::sync::{Arc, Mutex};

/// What a window was told, and what it answers.
#[derive(Debug, Default)]
struct Notes {
    told: Vec<&'static str>,
    change: Option<Change>,
    is_astray: bool,
    adopted: Option<usize>,
}

/// A window without a strategy.
#[derive(Debug)]
struct Noting(Arc<Mutex<Notes>>);

impl Noting {
    fn note(&self, what: &'static str) {
        self.0.lock().unwrap().told.push(what);
    }
}

impl Feeding for Noting {
    fn feed(&mut self, _after: Serial, _waypoints: Vec<Fed>) {
        self.note("feed");
    }

    fn leave(&mut self, _serial: Serial) {
        self.note("leave");
    }

    fn clear(&mut self) {
        self.note("clear");
    }

    fn invalidate(&mut self) {
        self.note("invalidate");
    }

    fn adopt(&mut self, _list: &[Item], _current: u16, _waypoints: Vec<Fed>) -> Option<usize> {
        self.note("adopt");
        self.0.lock().unwrap().adopted
    }

    fn reported(&mut self, _seq: u16) {
        self.note("reported");
    }

    fn is_astray(&self, _seq: u16) -> bool {
        self.0.lock().unwrap().is_astray
    }

    fn bring_back(&mut self) {
        self.note("bring back");
    }

    fn moved(&mut self, _fix: &Fix) {
        self.note("moved");
    }

    fn next_change(&mut self, _may_install: bool, _home: Option<Item>) -> Option<Change> {
        self.0.lock().unwrap().change.clone()
    }

    fn done(&mut self) {
        self.note("done");
    }

    fn failed(&mut self) {
        self.note("failed");
    }

    fn installed(&self) -> bool {
        true
    }

    fn ready(&self) -> bool {
        true
    }

    fn target(&self) -> Target {
        Target::End
    }
}

const ID: OrderId = OrderId(7);
const CHANGE: Change = Change::SetCurrent(3);

/// A list that has something to change, and its window's notes. The window is given to it as the driver does, once it is known.
fn list() -> (List, Arc<Mutex<Notes>>) {
    let notes = Arc::new(Mutex::new(Notes { change: Some(CHANGE), ..Notes::default() }));
    let window: Box<dyn Feeding> = Box::new(Noting(notes.clone()));
    (List { window: Some(window), supported: true, ..List::default() }, notes)
}

fn told(notes: &Arc<Mutex<Notes>>) -> Vec<&'static str> {
    std::mem::take(&mut notes.lock().unwrap().told)
}

fn at(seconds: u64) -> Time {
    Duration::from_secs(seconds)
}

#[test]
fn before_the_autopilot_is_known_nothing_is_done_to_its_list() {
    let mut list = List { supported: true, ..List::default() };
    list.feed(Serial(0), vec![]);
    list.leave(Serial(1));
    list.lost();
    list.steers_to(at(0), 3);
    let (position, altitude_amsl_m) = (LatLon::new(36.0, -84.0), 500.0);
    let [altitude_home_m, north_mps, east_mps, down_mps] = [100.0, 25.0, 0.0, 0.0];
    list.moved(&Fix { position, altitude_amsl_m, altitude_home_m, north_mps, east_mps, down_mps });
    list.forget();
    assert_eq!((list.next(at(0)), list.new_course(), list.is_at_end()), (None, None, false));
    assert_eq!(list.read(&[]), None);
}

#[test]
fn what_may_not_be_changed_is_left_as_it_is() {
    let (mut list, _) = list();
    list.hands_off = true;
    assert_eq!(list.next(at(0)), None, "the pilot flies");
    (list.hands_off, list.supported) = (false, false);
    assert_eq!(list.next(at(0)), None, "it can't be flown");
    list.supported = true;
    assert_eq!(list.next(at(0)), Some(Step::Change(CHANGE)));
    assert_eq!(list.next(at(0)), None, "one thing at a time");
}

#[test]
fn a_circle_is_left_by_the_window() {
    let (mut list, notes) = list();
    list.leave(Serial(1));
    assert_eq!(told(&notes), ["leave"]);
    assert!(list.is_at_end() && list.new_course().is_some() && list.new_course().is_none(), "told once");
}

#[test]
fn a_change_that_failed_is_made_again_after_a_while() {
    let (mut list, notes) = list();
    list.next(at(0));
    assert_eq!(list.failed(at(5), "no answer".into()), None);
    assert_eq!(told(&notes), ["failed"]);
    assert_eq!(list.next(at(5)), None);
    assert_eq!(list.next(at(6)), Some(Step::Change(CHANGE)));
    list.done();
    assert_eq!(told(&notes), ["done"]);
    list.done();
    assert_eq!((told(&notes), list.failed(at(6), "late".into())), (vec![], None), "nothing was under way");
}

#[test]
fn a_list_is_read_once_it_is_known_what_is_steered_to_and_whoever_asked_is_told() {
    for adopted in [Some(4), None] {
        let (mut list, notes) = list();
        notes.lock().unwrap().adopted = adopted;
        list.supported = false;
        list.adopt(ID, vec![]);
        assert_eq!(list.next(at(0)), None);
        list.steers_to(at(0), 3);
        assert_eq!(list.next(at(0)), Some(Step::Read));
        assert_eq!(list.read(&[]), Some(Report::Adopted(ID, adopted)));
        assert_eq!(list.read(&[]), None, "nobody asks any more");
    }
    let (mut list, _) = list();
    list.steers_to(at(0), 3);
    list.adopt(ID, vec![]);
    list.next(at(0));
    assert_eq!(list.failed(at(0), "no answer".into()), Some(Report::Failed(ID, "no answer".into())));
    list.adopt(ID, vec![]);
    list.forget();
    assert_eq!(list.next(at(9)), Some(Step::Change(CHANGE)), "the flight is over");
}

#[test]
fn what_flies_elsewhere_for_a_while_is_brought_back_and_a_moment_is_none() {
    let (mut list, notes) = list();
    list.flown = true;
    let steers = |list: &mut List, seconds: u64, is_astray: bool| {
        notes.lock().unwrap().is_astray = is_astray;
        list.steers_to(at(seconds), 30);
        told(&notes).contains(&"bring back")
    };
    assert!(!steers(&mut list, 0, true) && !steers(&mut list, 2, true));
    assert!(!steers(&mut list, 3, false), "it came back by itself");
    assert!(!steers(&mut list, 4, true) && !steers(&mut list, 6, true) && steers(&mut list, 7, true));
    assert!(!steers(&mut list, 8, true), "that takes a while, too");
    list.flown = false;
    assert!(!steers(&mut list, 20, true), "what is not flown leads nowhere");
}
