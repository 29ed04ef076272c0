//! Drawings that are kept as long as what they follow from stays the same.

use crate::picture::canvas::Canvas;

/// A drawing, and all that it follows from.
pub struct Kept<K> {
    drawn: Option<(K, Canvas)>,
}

impl<K> Default for Kept<K> {
    fn default() -> Self {
        Self { drawn: None }
    }
}

impl<K: PartialEq> Kept<K> {
    /// The drawing of a key, drawn anew if it is not the last one.
    pub fn get(&mut self, key: K, draw: impl FnOnce(&K) -> Canvas) -> &Canvas {
        if self.drawn.as_ref().is_none_or(|(last, _)| *last != key) {
            let canvas = draw(&key);
            self.drawn = Some((key, canvas));
        }
        self.last().expect("it was drawn just now")
    }

    pub fn last(&self) -> Option<&Canvas> {
        self.drawn.as_ref().map(|(_, canvas)| canvas)
    }
}
