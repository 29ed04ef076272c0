//! A set of cells by their index, which yields them in ascending order.

/// Cell indices as bits, with a bit for every 64 of them that says whether any is there: what is in a large set with few
/// members is found without a look at all cells.
#[derive(Clone, Debug)]
pub struct CellSet {
    words: Vec<u64>,
    /// Bit `n` of word `m` says whether `words[64 * m + n]` has any bit.
    summary: Vec<u64>,
    len: usize,
}

impl CellSet {
    /// Creates an empty set for cells below an index.
    pub fn new(cells: usize) -> Self {
        let words = cells.div_ceil(64);
        Self { words: vec![0; words], summary: vec![0; words.div_ceil(64)], len: 0 }
    }

    /// Adds a cell that the set does not hold.
    pub fn insert(&mut self, cell: usize) {
        let (word, bit) = (cell / 64, 1 << (cell % 64));
        debug_assert_eq!(self.words[word] & bit, 0, "the cell is there already");
        self.words[word] |= bit;
        self.summary[word / 64] |= 1 << (word % 64);
        self.len += 1;
    }

    /// Removes a cell that is there.
    pub fn remove(&mut self, cell: usize) {
        let (word, bit) = (cell / 64, 1 << (cell % 64));
        debug_assert_ne!(self.words[word] & bit, 0, "the cell is not there");
        self.words[word] &= !bit;
        if self.words[word] == 0 {
            self.summary[word / 64] &= !(1 << (word % 64));
        }
        self.len -= 1;
    }

    /// Says whether a cell is there.
    pub fn contains(&self, cell: usize) -> bool {
        self.words[cell / 64] & (1 << (cell % 64)) != 0
    }

    /// Iterates in ascending order over the cells that are not below `first`, up to the one before `end`.
    pub fn within(&self, first: usize, end: usize) -> impl Iterator<Item = usize> + '_ {
        let from = first / 64;
        let to = end.div_ceil(64).min(self.words.len());
        (from..to).flat_map(move |word| {
            let below_first = if word == from { (1 << (first % 64)) - 1 } else { 0 };
            let mut bits = self.words[word] & !below_first;
            std::iter::from_fn(move || {
                let cell = 64 * word + bits.trailing_zeros() as usize;
                let is_there = bits != 0 && cell < end;
                bits &= bits.wrapping_sub(1);
                is_there.then_some(cell)
            })
        })
    }

    /// Iterates over the cells in ascending order.
    pub fn iter(&self) -> CellSetIter<'_> {
        CellSetIter { set: self, next_summary: 0, words_left: 0, bits_left: 0, word: 0, left: self.len }
    }
}

/// The members of a [`CellSet`], ascending.
#[derive(Debug)]
pub struct CellSetIter<'a> {
    set: &'a CellSet,
    next_summary: usize,
    /// Bits of the summary word before `next_summary` whose words are still to come.
    words_left: u64,
    /// Bits of `word` that are still to come.
    bits_left: u64,
    word: usize,
    left: usize,
}

impl Iterator for CellSetIter<'_> {
    type Item = usize;

    fn next(&mut self) -> Option<usize> {
        while self.bits_left == 0 {
            while self.words_left == 0 {
                self.words_left = *self.set.summary.get(self.next_summary)?;
                self.next_summary += 1;
            }
            self.word = 64 * (self.next_summary - 1) + self.words_left.trailing_zeros() as usize;
            self.words_left &= self.words_left - 1;
            self.bits_left = self.set.words[self.word];
        }
        let cell = 64 * self.word + self.bits_left.trailing_zeros() as usize;
        self.bits_left &= self.bits_left - 1;
        self.left -= 1;
        Some(cell)
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        (self.left, Some(self.left))
    }
}

impl ExactSizeIterator for CellSetIter<'_> {}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use rand::RngExt;

    use super::*;

    #[test]
    fn members_come_in_ascending_order_whatever_came_and_went() {
        let mut rng = wildfire_base::rng::stream(1, "cell set");
        for cells in [1, 63, 64, 65, 5_000, 300_000] {
            let mut set = CellSet::new(cells);
            let mut model = BTreeSet::new();
            for _ in 0..2_000 {
                let cell = rng.random_range(0..cells as u64) as usize;
                if model.remove(&cell) {
                    set.remove(cell);
                } else {
                    model.insert(cell);
                    set.insert(cell);
                }
            }
            assert_eq!(set.iter().len(), model.len());
            assert!(set.iter().eq(model.iter().copied()));
            for _ in 0..50 {
                let first = rng.random_range(0..cells as u64) as usize;
                let end = rng.random_range(first as u64..=cells as u64) as usize;
                assert!(set.within(first, end).eq(model.range(first..end).copied()), "{first}..{end} of {cells}");
                assert_eq!(set.contains(first), model.contains(&first));
            }
        }
    }
}
