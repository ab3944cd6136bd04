//! Undo and redo: a history of plan states.

use crate::{Edit, EditError, FlightPlan};
use std::sync::Arc;

/// States that are kept; older ones are forgotten.
const MOST_STATES: usize = 500;

/// A plan and how it came about.
#[derive(Debug, Clone)]
pub struct History {
    states: Vec<Arc<FlightPlan>>,
    present: usize,
    /// Edits with the same gesture make one step.
    gesture: Option<u64>,
    saved: Option<usize>,
}

impl History {
    /// The history of a plan that was just opened (and counts as saved).
    pub fn new(plan: FlightPlan) -> Self {
        Self { states: vec![Arc::new(plan)], present: 0, gesture: None, saved: Some(0) }
    }

    /// The plan as it is now.
    pub fn plan(&self) -> &Arc<FlightPlan> {
        // `present` is always the index of a state; the first one is never removed without another taking its place
        &self.states[self.present]
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
        self.states.truncate(self.present + usize::from(!goes_on));
        self.states.push(Arc::new(plan));
        self.present = self.states.len() - 1;
        self.saved = self.saved.filter(|saved| *saved < self.present);
        self.gesture = gesture;
        if self.states.len() > MOST_STATES {
            self.states.remove(0);
            self.present -= 1;
            self.saved = self.saved.and_then(|saved| saved.checked_sub(1));
        }
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

    /// The present state has been written to disk.
    pub fn mark_saved(&mut self) {
        self.saved = Some(self.present);
    }
}
