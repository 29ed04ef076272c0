//! Random streams with names.
//!
//! Every use of chance has a stream of its own (`terrain`, `wumpus/0`, `truck/0/prm`), derived from the run's
//! seed and the stream's name. Another draw in one stream never shifts a draw in another.
//!
//! The rule is frozen, because runs are quoted by their seed: the FNV-1a hash (64 bit) of the name is
//! combined by exclusive or with one SplitMix64 output of the seed (Steele, Lea, Flood, "Fast splittable pseudorandom
//! number generators", OOPSLA 2014), and four outputs of SplitMix64 from there are the state of xoshiro256++
//! (Blackman, Vigna, "Scrambled linear pseudorandom number generators", ACM TOMS 2021).

use std::fmt;
use std::sync::Arc;

pub use rand::rngs::Xoshiro256PlusPlus;
use rand::{RngExt, SeedableRng};

const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
const FNV_PRIME: u64 = 0x0000_0100_0000_01b3;

/// The stream called `name` of the run with this seed.
pub fn stream(seed: u64, name: &str) -> Xoshiro256PlusPlus {
    let mut mix = key(seed, name);
    let mut state = [0u8; 32];
    for word in state.chunks_exact_mut(8) {
        word.copy_from_slice(&split_mix(&mut mix).to_le_bytes());
    }
    Xoshiro256PlusPlus::from_seed(state)
}

/// Combines a seed and a name: the number that a stream begins with.
pub fn key(seed: u64, name: &str) -> u64 {
    let name_hash = name.bytes().fold(FNV_OFFSET, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(FNV_PRIME));
    mixed(seed) ^ name_hash
}

/// Returns the output of SplitMix64 that follows on this state.
pub fn mixed(mut state: u64) -> u64 {
    split_mix(&mut state)
}

/// The beginning of the permutation that [`rand::seq::SliceRandom::shuffle`] makes of the numbers below a length.
///
/// Step `i` of a shuffle (Durstenfeld, "Algorithm 235: Random permutation", Communications of the ACM 7(7), 1964) swaps
/// place `i` with a random place that is not behind it. Before that step place `i` still holds `i`, and later steps read
/// no place below `i`, so the places of a prefix need no others: all draws are made, and only what falls into the prefix
/// is kept. The prefix is made longer when a place behind it is asked for, from the stream's first draw on.
#[derive(Clone)]
pub struct ShuffledPrefix {
    length: usize,
    stream: Arc<dyn Fn() -> Xoshiro256PlusPlus + Send + Sync>,
    prefix: Vec<u32>,
}

impl ShuffledPrefix {
    /// The first prefix; each that follows is so many times longer.
    const FIRST: usize = 256;
    const LONGER: usize = 8;

    /// Prepares a shuffle of `length` numbers with the draws of a stream, which is made again for every prefix.
    ///
    /// # Panics
    /// If there are more than 32 bits can number.
    pub fn new(length: usize, stream: impl Fn() -> Xoshiro256PlusPlus + Send + Sync + 'static) -> Self {
        assert!(u32::try_from(length).is_ok(), "{length} is too long to be shuffled");
        Self { length, stream: Arc::new(stream), prefix: Vec::new() }
    }

    /// Returns the number at a place of the permutation.
    ///
    /// # Panics
    /// If the place is not below the length.
    pub fn at(&mut self, place: usize) -> usize {
        if place >= self.prefix.len() {
            let longer = Self::FIRST.max(Self::LONGER * self.prefix.len()).max(place + 1);
            self.shuffle(longer.min(self.length));
        }
        self.prefix[place] as usize
    }

    /// Shuffles with the draws of `rand`, which takes several places from one number as long as they fit into 32 bits.
    fn shuffle(&mut self, kept: usize) {
        self.prefix = (0..kept as u32).collect();
        let mut stream = (self.stream)();
        let (mut chunk, mut left) = (0u32, 1u32);
        for place in 0..self.length as u32 {
            let places = place + 1;
            if left == 0 {
                let mut bound = places;
                // As many places as one number of 32 bits can decide are drawn together.
                while let Some(product) = bound.checked_mul(places + left + 1) {
                    bound = product;
                    left += 1;
                }
                left += 1;
                chunk = stream.random_range(..bound);
            }
            left -= 1;
            let other = if left == 0 { chunk } else { chunk % places };
            chunk = if left == 0 { chunk } else { chunk / places };
            if (place as usize) < kept {
                self.prefix.swap(place as usize, other as usize);
            } else if (other as usize) < kept {
                self.prefix[other as usize] = place;
            }
        }
    }
}

impl fmt::Debug for ShuffledPrefix {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("ShuffledPrefix")
            .field("length", &self.length)
            .field("prefix", &self.prefix)
            .finish_non_exhaustive()
    }
}

fn split_mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use rand::Rng;
    use rand::seq::SliceRandom;

    use super::*;

    #[test]
    fn a_prefix_is_the_beginning_of_the_shuffle() {
        for length in (0..40).chain([255, 256, 257, 1000, 3000, 70_000, 100_000]) {
            let mut shuffled: Vec<usize> = (0..length).collect();
            shuffled.shuffle(&mut stream(7, "shuffle"));
            let mut prefix = ShuffledPrefix::new(length, || stream(7, "shuffle"));
            assert_eq!((0..length).map(|place| prefix.at(place)).collect::<Vec<_>>(), shuffled, "{length}");
            if length > 0 {
                let mut at_once = ShuffledPrefix::new(length, || stream(7, "shuffle"));
                assert_eq!(at_once.at(length / 2), shuffled[length / 2]);
                assert!(at_once.prefix.len() <= ShuffledPrefix::FIRST.max(length / 2 + 1));
            }
        }
    }

    /// Reckoned by a separate program from the rule in the module's text.
    #[test]
    fn the_first_draws_of_two_streams_are_pinned() {
        let draws = |seed, name| {
            let mut stream = stream(seed, name);
            [(); 8].map(|()| stream.next_u64())
        };
        assert_eq!(
            draws(1, "terrain"),
            [
                0x5a2e_4cad_7def_a472,
                0x0bbc_3ac3_f0bf_c132,
                0xc028_8e47_b122_44b1,
                0x3a12_065b_df1d_716d,
                0x6d10_6384_7ccc_3095,
                0xc2e5_ee10_4847_2fa8,
                0x09cf_306a_ac0e_e4cb,
                0xb178_8582_7fa2_7f03,
            ]
        );
        assert_eq!(
            draws(42, "truck/0/prm"),
            [
                0xc8d4_d59f_0082_e9c4,
                0x8834_ebc1_bcbb_6d2f,
                0x2a6a_6bd7_2345_8ad3,
                0x6853_bfef_12f5_eab1,
                0xf052_c71a_d2b5_4c28,
                0x1a56_9ef7_7eac_c307,
                0xd6cf_c94b_1658_5b2d,
                0x481c_6b4f_bb53_7556,
            ]
        );
    }

    #[test]
    fn names_and_seeds_give_separate_streams() {
        let first = |seed, name| stream(seed, name).next_u64();
        let draws = [first(1, "a"), first(1, "b"), first(2, "a"), first(2, "b"), first(0, "")];
        for (i, draw) in draws.iter().enumerate() {
            assert!(!draws[..i].contains(draw));
        }
    }
}
