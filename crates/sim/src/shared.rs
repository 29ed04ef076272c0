//! What forks of a run share.

use std::sync::{Arc, Mutex, MutexGuard};

/// Something that the forks of a run share instead of copying it, because its answers do not depend on earlier ones: a
/// planner with what it has worked out so far. Forks on several threads take turns.
pub struct Shared<T>(Arc<Mutex<T>>);

impl<T> Shared<T> {
    pub fn new(value: T) -> Self {
        Self(Arc::new(Mutex::new(value)))
    }

    /// Returns it for one question.
    pub fn lock(&self) -> MutexGuard<'_, T> {
        self.0.lock().expect("nobody panics while it is asked")
    }
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}
