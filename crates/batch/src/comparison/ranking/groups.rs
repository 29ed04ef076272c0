//! The results of pairwise tests for a whole list: possible ranks, and groups of entries without significant
//! differences.
//!
//! Possible ranks: an entry that differs significantly from `b` better and `w` worse of `n` entries has a rank from
//! `b + 1` to `n - w`. If all pairs are tested together so that no true equality is denied with 95 % probability, all
//! these ranges hold the true ranks with that probability (Mogstad, Romano, Shaikh, Wilhelm, "Inference for ranks with
//! applications to mobility across neighbourhoods and academic achievement across countries", Review of Economic
//! Studies 91, 2024).
//!
//! Groups: the compact letter display of Piepho ("An algorithm for a letter-based representation of all-pairwise
//! comparisons", Journal of Computational and Graphical Statistics 13, 2004), by inserting and absorbing. Two entries
//! have a letter in common just when they are not significantly different.

/// The maximum number of entries: one bit each.
pub const MAX_ENTRIES: usize = 100;

/// The letters of groups, in their order.
const LETTERS: &str = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";

/// The most groups on the way to the last ones. Groups can be exponentially many, and whoever wrote the tables chose
/// which pairs differ.
const MAX_GROUPS: usize = 200;

/// The pairs of a list of entries, best first, that are significantly different.
pub struct Significance {
    count: usize,
    /// For each entry the others that it is significantly different from, as bits.
    from: Vec<u128>,
}

impl Significance {
    /// Creates the set of significantly different pairs, of entries with numbers below `count`, which is at most
    /// [`MAX_ENTRIES`].
    pub fn new(count: usize, pairs: impl IntoIterator<Item = (usize, usize)>) -> Self {
        let mut from = vec![0; count];
        for (one, other) in pairs {
            from[one] |= 1 << other;
            from[other] |= 1 << one;
        }
        Self { count, from }
    }

    /// Returns the first and the last rank that an entry may have, from 1. `is_better(one, other)` says which of two
    /// entries that are significantly different is the better one.
    pub fn ranks(&self, entry: usize, is_better: impl Fn(usize, usize) -> bool) -> [usize; 2] {
        let others = || (0..self.count).filter(|&other| self.from[entry] >> other & 1 == 1);
        let better = others().filter(|&other| is_better(other, entry)).count();
        let worse = others().filter(|&other| is_better(entry, other)).count();
        [better + 1, self.count - worse]
    }

    /// Returns the letters of each entry; `None` if there are more groups than letters.
    pub fn letters(&self) -> Option<Vec<String>> {
        // At first no pair differs and all entries share one group; each pair that differs splits the groups that hold both.
        let all = (0..self.count).fold(0, |bits, entry| bits | 1 << entry);
        let mut groups: Vec<u128> = vec![all];
        for (one, &differs) in self.from.iter().enumerate() {
            for other in (one + 1..self.count).filter(|other| differs >> other & 1 == 1) {
                let both = 1 << one | 1 << other;
                let (split, mut kept): (Vec<u128>, Vec<u128>) =
                    groups.into_iter().partition(|group| group & both == both);
                // A half that another group holds says nothing new.
                for half in split.into_iter().flat_map(|group| [group & !(1 << one), group & !(1 << other)]) {
                    if !kept.iter().any(|group| half & !group == 0) {
                        // Groups within the new half are absorbed: their members already share its letter.
                        kept.retain(|group| group & !half != 0);
                        kept.push(half);
                    }
                }
                groups = kept;
                if groups.len() > MAX_GROUPS {
                    return None;
                }
            }
        }
        // Groups are named in the order of their best members.
        // The best entry has the lowest bit, which the reversal makes the highest.
        groups.sort_unstable_by_key(|group| group.reverse_bits());
        groups.reverse();
        if groups.len() > LETTERS.len() {
            return None;
        }
        let letters = (0..self.count).map(|entry| {
            let named = groups.iter().zip(LETTERS.chars()).filter(|(group, _)| *group >> entry & 1 == 1);
            named.map(|(_, letter)| letter).collect()
        });
        Some(letters.collect())
    }
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    fn letters(count: usize, pairs: &[(usize, usize)]) -> Vec<String> {
        Significance::new(count, pairs.iter().copied()).letters().expect("few groups")
    }

    #[test]
    fn letters_of_small_lists_are_those_found_by_hand() {
        assert_eq!(letters(0, &[]), Vec::<String>::new());
        assert_eq!(letters(1, &[]), ["a"]);
        assert_eq!(letters(3, &[]), ["a", "a", "a"]);
        assert_eq!(letters(3, &[(0, 1), (0, 2), (1, 2)]), ["a", "b", "c"]);
        assert_eq!(letters(3, &[(0, 2)]), ["a", "ab", "b"]);
        // The middle one is noisy: the best is significantly different from the second and not from the third.
        assert_eq!(letters(3, &[(0, 1)]), ["a", "b", "ab"]);
        // Neighbours are alike, all others are significantly different.
        assert_eq!(letters(4, &[(0, 2), (0, 3), (1, 3)]), ["a", "ab", "bc", "c"]);
    }

    #[test]
    fn common_letters_join_just_those_without_a_significant_difference() {
        for case in 0..200 {
            let random = &mut rng::stream(case, "test/groups");
            let count = random.random_range(1..=12);
            let density = random.random_range(0.0..1.0);
            let mut pairs = Vec::new();
            for one in 0..count {
                for other in one + 1..count {
                    if random.random_bool(density) {
                        pairs.push((one, other));
                    }
                }
            }
            let Some(letters) = Significance::new(count, pairs.iter().copied()).letters() else { continue };
            for one in 0..count {
                for other in one + 1..count {
                    let share = letters[one].chars().any(|letter| letters[other].contains(letter));
                    assert_eq!(share, !pairs.contains(&(one, other)), "{case}: {one} {other} {letters:?}");
                }
            }
        }
    }

    #[test]
    fn groups_without_number_end_without_letters() {
        // Three by three, where all but those of one triple are together: 3^33 groups.
        let triples = (0..MAX_ENTRIES / 3).flat_map(|triple| {
            let [a, b, c] = [0, 1, 2].map(|place| 3 * triple + place);
            [(a, b), (a, c), (b, c)]
        });
        assert_eq!(Significance::new(MAX_ENTRIES, triples).letters(), None);
        // Everybody significantly different from everybody needs a letter each.
        let all = (0..60).flat_map(|one| (one + 1..60).map(move |other| (one, other)));
        assert_eq!(Significance::new(60, all).letters(), None);
    }

    #[test]
    fn ranks_count_who_is_better_and_who_is_worse_for_sure() {
        let significance = Significance::new(4, [(0, 2), (0, 3), (1, 3)]);
        let ranks: Vec<_> = (0..4).map(|entry| significance.ranks(entry, |one, other| one < other)).collect();
        assert_eq!(ranks, [[1, 2], [1, 3], [2, 4], [3, 4]]);
        assert_eq!(Significance::new(1, []).ranks(0, |one, other| one < other), [1, 1]);
    }
}
