//! Undo and redo: a history of plan states.

mod size;

use crate::{Edit, EditError, FlightPlan};
use std::sync::Arc;

/// So much is kept of what states have for themselves, bytes: far more than a day's work. The oldest are forgotten then.
const MOST_BYTES: usize = 512 << 20;

#[derive(Debug, Clone)]
struct State {
    plan: Arc<FlightPlan>,
    /// About what it has for itself.
    bytes: usize,
}

/// A plan and how it came about.
#[derive(Debug, Clone)]
pub struct History {
    states: Vec<State>,
    present: usize,
    /// Edits with the same gesture make one step.
    gesture: Option<u64>,
    saved: Option<usize>,
    /// About what all states together hold.
    bytes: usize,
    most_bytes: usize,
}

impl History {
    /// The history of a plan that was just opened (and counts as saved).
    pub fn new(plan: FlightPlan) -> Self {
        let bytes = size::of(&plan, None);
        let first = State { bytes, plan: Arc::new(plan) };
        Self { states: vec![first], present: 0, gesture: None, saved: Some(0), bytes, most_bytes: MOST_BYTES }
    }

    /// The plan as it is now.
    pub fn plan(&self) -> &Arc<FlightPlan> {
        // `present` is always the index of a state; the first one is never removed without another taking its place
        &self.states[self.present].plan
    }

    /// Makes an edit; what was undone before is forgotten. `gesture`: edits in a row with the same number (a drag) are one step.
    ///
    /// # Errors
    /// The edit can't be applied; nothing has changed.
    pub fn apply(&mut self, edit: &Edit, gesture: Option<u64>) -> Result<(), EditError> {
        let edited = edit.apply(self.plan())?;
        self.push(edited, gesture);
        Ok(())
    }

    /// Takes a whole new state (an import, a template), as one step.
    pub fn replace(&mut self, plan: FlightPlan) {
        self.push(plan, None);
    }

    fn push(&mut self, plan: FlightPlan, gesture: Option<u64>) {
        let goes_on = gesture.is_some() && gesture == self.gesture && self.present > 0;
        let undone = self.states.drain(self.present + usize::from(!goes_on)..);
        self.bytes -= undone.map(|state| state.bytes).sum::<usize>();
        let before = self.states.last().map(|state| state.plan.as_ref());
        let bytes = size::of(&plan, before);
        self.bytes += bytes;
        self.states.push(State { bytes, plan: Arc::new(plan) });
        self.present = self.states.len() - 1;
        self.saved = self.saved.filter(|saved| *saved < self.present);
        self.gesture = gesture;
        self.forget_oldest();
    }

    /// The newest state stays, whatever its size.
    fn forget_oldest(&mut self) {
        let mut forgotten = 0;
        while self.bytes > self.most_bytes && forgotten < self.present {
            self.bytes -= self.states[forgotten].bytes;
            forgotten += 1;
        }
        self.states.drain(..forgotten);
        self.present -= forgotten;
        self.saved = self.saved.and_then(|saved| saved.checked_sub(forgotten));
    }

    /// About what all states together hold, bytes.
    pub fn bytes(&self) -> usize {
        self.bytes
    }

    /// Ends a drag: the next edit is a step of its own.
    pub fn end_gesture(&mut self) {
        self.gesture = None;
    }

    /// One step back, if there is one.
    pub fn undo(&mut self) -> bool {
        self.end_gesture();
        let possible = self.can_undo();
        self.present -= usize::from(possible);
        possible
    }

    /// One step forward again, if there is one.
    pub fn redo(&mut self) -> bool {
        self.end_gesture();
        let possible = self.can_redo();
        self.present += usize::from(possible);
        possible
    }

    /// There is something to undo.
    pub fn can_undo(&self) -> bool {
        self.present > 0
    }

    /// There is something to redo.
    pub fn can_redo(&self) -> bool {
        self.present + 1 < self.states.len()
    }

    /// The present state is the one on disk.
    pub fn is_saved(&self) -> bool {
        self.saved == Some(self.present)
    }

    /// No state is on disk any more.
    pub fn mark_unsaved(&mut self) {
        self.saved = None;
    }

    /// The present state has been written to disk.
    pub fn mark_saved(&mut self) {
        self.saved = Some(self.present);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fix;
    use geometry::LatLon;
    use proptest::prelude::*;

    fn start() -> History {
        let fix = Fix {
            id: "A".into(),
            position: LatLon::new(0.0, 0.0),
            name: String::new(),
            description: String::new(),
        };
        History::new(FlightPlan { fixes: vec![fix], ..FlightPlan::default() })
    }

    fn moved(lat: f64) -> Edit {
        Edit::MoveFix { fix: "A".into(), to: LatLon::new(lat, 0.0) }
    }

    fn lat(history: &History) -> f64 {
        history.plan().fixes[0].position.lat_deg
    }

    #[test]
    fn a_drag_is_one_step() {
        let mut history = start();
        for i in 1..=20 {
            history.apply(&moved(f64::from(i)), Some(7)).unwrap();
        }
        history.apply(&moved(30.0), Some(8)).unwrap();
        assert!(history.undo());
        assert_eq!(lat(&history), 20.0);
        assert!(history.undo());
        assert_eq!(lat(&history), 0.0);
        assert!(!history.undo() && history.redo() && history.redo() && !history.redo());
        assert_eq!(lat(&history), 30.0);
    }

    #[test]
    fn a_failed_edit_changes_nothing() {
        let mut history = start();
        assert!(history.apply(&Edit::DeleteLeg { leg: "z".into() }, None).is_err());
        assert!(!history.can_undo() && history.is_saved());
    }

    #[test]
    fn saved_is_the_state_on_disk() {
        let mut history = start();
        history.apply(&moved(1.0), None).unwrap();
        assert!(!history.is_saved());
        history.mark_saved();
        history.undo();
        assert!(!history.is_saved());
        history.redo();
        assert!(history.is_saved());
        history.undo();
        history.apply(&moved(2.0), None).unwrap();
        assert!(!history.is_saved(), "the saved state is gone");
    }

    fn steps_back(history: &mut History) -> usize {
        std::iter::from_fn(|| history.undo().then_some(())).count()
    }

    #[test]
    fn a_days_work_is_undone_to_its_beginning() {
        let mut history = start();
        (1..=20_000).for_each(|i| history.apply(&moved(f64::from(i)), None).unwrap());
        assert_eq!(steps_back(&mut history), 20_000);
        assert_eq!(lat(&history), 0.0);
    }

    #[test]
    fn the_oldest_states_are_forgotten_when_they_hold_too_much() {
        let mut history = History { most_bytes: 100_000, ..start() };
        (1..=5000).for_each(|i| history.apply(&moved(f64::from(i)), None).unwrap());
        assert!(history.bytes() <= 100_000 && !history.is_saved());
        let kept = steps_back(&mut history);
        assert!((50..1000).contains(&kept), "{kept}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Against a model: a list of states and a cursor.
        #[test]
        fn undo_and_redo_walk_the_states(steps in prop::collection::vec(0..3_u8, 0..60)) {
            let mut history = start();
            let (mut states, mut present) = (vec![0.0], 0);
            for (i, step) in steps.into_iter().enumerate() {
                match step {
                    0 => {
                        history.apply(&moved(i as f64 + 1.0), None).unwrap();
                        states.truncate(present + 1);
                        states.push(i as f64 + 1.0);
                        present += 1;
                    }
                    1 => present -= usize::from(history.undo()),
                    _ => present += usize::from(history.redo()),
                }
                prop_assert_eq!(lat(&history), states[present]);
                prop_assert_eq!((history.can_undo(), history.can_redo()), (present > 0, present + 1 < states.len()));
            }
        }
    }
}
