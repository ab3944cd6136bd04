//! What is worked out of the document to be drawn. Of a plan as people draw it that is done within the frame; of a very large one on
//! a thread of its own, and there it is freed, too: no frame waits for either.

use crate::document::Document;
use crate::jobs::{Taken, Task, discard};
use crate::link::Wake;
use flight_plan::FlightPlan;
use std::ops::Deref;
use std::sync::Arc;

/// Of what it is worked out.
#[derive(Debug, Clone)]
pub struct Source<K> {
    document: u64,
    version: u64,
    plan: Arc<FlightPlan>,
    is_large: bool,
    /// What else it depends on.
    with: K,
}

impl<K: PartialEq> Source<K> {
    /// The document as it is, and what else it depends on.
    pub fn new(document: &Document, with: K) -> Self {
        let (plan, is_large) = (document.plan().clone(), document.is_large());
        Self { document: document.id(), version: document.version(), plan, is_large, with }
    }

    fn is(&self, other: &Self) -> bool {
        (self.version, &self.with) == (other.version, &other.with)
    }
}

/// It, and what of: the newest there is. That of another document is never shown.
#[derive(Debug)]
pub struct Derived<K, T> {
    value: Arc<T>,
    /// `None`: it is empty.
    of: Option<Source<K>>,
    /// What will take its place.
    next: Option<(Source<K>, Task<T>)>,
}

impl<K, T: Default> Default for Derived<K, T> {
    fn default() -> Self {
        Self { value: Arc::default(), of: None, next: None }
    }
}

impl<K, T> Deref for Derived<K, T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.value
    }
}

impl<K, T> Derived<K, T>
where
    K: PartialEq + Send + Sync + 'static,
    T: Default + Send + Sync + 'static,
{
    /// What is asked for is still being worked out.
    pub fn is_busy(&self) -> bool {
        self.next.is_some()
    }

    /// To change it, unless the next one is being worked out from it.
    pub fn get_mut(&mut self) -> Option<&mut T> {
        Arc::get_mut(&mut self.value)
    }

    /// It, for as long as it is used.
    pub fn shared(&self) -> Arc<T> {
        self.value.clone()
    }

    /// It is of that, and nothing takes its place.
    pub fn is_of(&self, source: &Source<K>) -> bool {
        !self.is_busy() && self.of.as_ref().is_some_and(|of| of.is(source))
    }

    /// Lets it be of that, too, if only the version of its document is another and nothing that it says differs. True: it does so.
    pub fn keep_for(
        &mut self,
        source: &Source<K>,
        is_alike: impl FnOnce(&FlightPlan, &FlightPlan) -> bool,
    ) -> bool {
        let of = self.of.as_mut().filter(|of| (of.document, &of.with) == (source.document, &source.with));
        let Some(of) = of.filter(|of| self.next.is_none() && is_alike(&of.plan, &source.plan)) else {
            return false;
        };
        (of.version, of.plan, of.is_large) = (source.version, source.plan.clone(), source.is_large);
        true
    }

    /// Brings it up to date: `work` makes it of the plan, and of what it was. True: it is another one now.
    pub fn refresh(
        &mut self,
        source: Source<K>,
        wake: Wake,
        work: impl FnOnce(&FlightPlan, &T) -> T + Send + 'static,
    ) -> bool {
        let is_left = self.leave(&source);
        let taken = self.next.as_ref().map(|(_, task)| task.take());
        if matches!(taken, Some(Taken::NotYet)) {
            return is_left;
        }
        let (of, has_failed) = (self.next.take().map(|(of, _)| of), matches!(taken, Some(Taken::Failed)));
        let is_done = if let Some(Taken::Done(value)) = taken { self.put(of, value) } else { false };
        if self.is_of(&source) {
            return is_left || is_done;
        }
        // also where there was no thread for it
        if !source.is_large || has_failed {
            let value = work(&source.plan, &self.value);
            return self.put(Some(source), value);
        }
        let (plan, former) = (source.plan.clone(), self.value.clone());
        self.next = Some((source, Task::begin(wake, move || work(&plan, &former))));
        is_left || is_done
    }

    /// Nothing stays of another document. True: there was something.
    fn leave(&mut self, source: &Source<K>) -> bool {
        let is_others = |of: &Source<K>| of.document != source.document;
        if let Some(next) = self.next.take_if(|(of, _)| is_others(of)) {
            discard(next);
        }
        self.of.as_ref().is_some_and(is_others) && self.put(None, T::default())
    }

    /// True: as always, it is another one now.
    fn put(&mut self, of: Option<Source<K>>, value: T) -> bool {
        let former = std::mem::replace(&mut self.value, Arc::new(value));
        let was = std::mem::replace(&mut self.of, of);
        if was.as_ref().is_some_and(|was| was.is_large) {
            discard((former, was));
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, Sender, channel};
    use std::thread::ThreadId;

    /// On which thread it was made, and where it is told on which it is freed.
    #[derive(Debug, Default)]
    struct Made {
        on: Option<ThreadId>,
        freed: Option<Sender<ThreadId>>,
    }

    impl Drop for Made {
        fn drop(&mut self) {
            if let Some(freed) = &self.freed {
                // nobody may ask
                let _ = freed.send(here());
            }
        }
    }

    fn here() -> ThreadId {
        std::thread::current().id()
    }

    fn document(is_large: bool) -> Document {
        let fixes = r#"<fix id="A" lat="46" lon="9"/>"#.repeat(if is_large { 30_000 } else { 3 });
        let text =
            format!(r#"<flightPlan xmlns="urn:legwork:flight-plan:1"><fixes>{fixes}</fixes></flightPlan>"#);
        Document::read(text.as_bytes(), None)
    }

    /// Has it made, and draws frames until it is there; on which thread it will be freed.
    fn make(derived: &mut Derived<u8, Made>, document: &Document, with: u8) -> Receiver<ThreadId> {
        let (freed, where_freed) = channel();
        let (wake, woken) = channel();
        let wake: Wake = Arc::new(move || wake.send(()).unwrap_or_default());
        let work = |freed| move |_: &FlightPlan, _: &Made| Made { on: Some(here()), freed };
        derived.refresh(Source::new(document, with), wake.clone(), work(Some(freed)));
        if derived.is_busy() {
            woken.recv().unwrap();
            assert!(derived.refresh(Source::new(document, with), wake, work(None)));
        }
        assert!(derived.is_of(&Source::new(document, with)));
        where_freed
    }

    #[test]
    fn of_a_large_plan_it_is_made_and_freed_on_another_thread_and_of_a_small_one_at_once() {
        let (small, large) = (document(false), document(true));
        let mut derived = Derived::default();
        let small_freed = make(&mut derived, &small, 0);
        assert_eq!(derived.on, Some(here()));
        let large_freed = make(&mut derived, &large, 0);
        assert!(derived.on.is_some_and(|on| on != here()));
        assert_eq!(small_freed.recv(), Ok(here()));
        let again_freed = make(&mut derived, &large, 1);
        assert!(large_freed.recv().unwrap() != here());
        make(&mut derived, &small, 1);
        assert!(again_freed.recv().unwrap() != here());
    }

    #[test]
    fn until_the_next_one_is_there_the_last_one_of_the_same_document_is_shown_and_none_of_another() {
        let (one, other) = (document(true), document(true));
        let mut derived = Derived::default();
        let (open, gate) = channel::<()>();
        let wake: Wake = Arc::new(|| ());
        make(&mut derived, &one, 0);
        let wait = move |_: &FlightPlan, _: &Made| {
            gate.recv().unwrap();
            Made::default()
        };
        assert!(!derived.refresh(Source::new(&one, 1), wake.clone(), wait));
        assert!(derived.is_busy() && derived.on.is_some() && derived.get_mut().is_none());
        let newest = |_: &FlightPlan, _: &Made| panic!("the one before is not there yet");
        assert!(!derived.refresh(Source::new(&one, 2), wake.clone(), newest));
        assert!(derived.refresh(Source::new(&other, 2), wake, |_, _| Made::default()));
        assert!(derived.on.is_none());
        open.send(()).unwrap();
    }

    #[test]
    fn it_is_kept_for_a_plan_in_which_nothing_of_it_differs() {
        let mut document = document(false);
        let mut derived = Derived::default();
        make(&mut derived, &document, 0);
        document.replace(FlightPlan::default());
        let source = |with| Source::new(&document, with);
        assert!(!derived.keep_for(&source(0), |_, _| false) && !derived.keep_for(&source(1), |_, _| true));
        assert!(derived.keep_for(&source(0), |was, is| was.fixes.len() == 3 && is.fixes.is_empty()));
        assert!(derived.is_of(&source(0)) && !derived.is_of(&source(1)));
    }
}
