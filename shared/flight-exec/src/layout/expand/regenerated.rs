//! What is laid out once and kept beside the recipe it is made from.

use std::sync::{Arc, OnceLock};

/// Something that its recipe makes: not kept in a snapshot but made again, and so no part of its owner's value: equal to any other.
#[derive(Debug)]
pub struct Regenerated<T>(OnceLock<Option<Arc<T>>>);

impl<T> Regenerated<T> {
    /// Made already.
    pub fn of(made: T) -> Self {
        Self(OnceLock::from(Some(Arc::new(made))))
    }

    /// As it was made, or makes it; `None`: it can't be made.
    pub fn get<E>(&self, make: impl FnOnce() -> Result<T, E>) -> Option<&T> {
        self.0.get_or_init(|| make().ok().map(Arc::new)).as_deref()
    }
}

impl<T> Default for Regenerated<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> PartialEq for Regenerated<T> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
