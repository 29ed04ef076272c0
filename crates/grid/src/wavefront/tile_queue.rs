//! The queue of tiles.

use std::collections::VecDeque;
use std::mem;

use crate::wavefront::moves::FAR;

/// Levels that share a round.
const LEVELS: i32 = 16;
/// Rounds that are kept apart; what is due later waits with the last of them.
const ROUNDS: usize = 64;

/// The waiting tiles, in rounds by the levels at which they are due.
///
/// The order within a round is that of coming. Order costs or saves work only; it does not change the answer.
pub struct TileQueue {
    /// The level at which each tile is due, `FAR` for those that do not wait.
    due: Vec<i32>,
    rounds: [VecDeque<usize>; ROUNDS],
    round: usize,
    /// Entries in all rounds. A tile that has been put forward has several, of which the first counts.
    entries: usize,
}

impl TileQueue {
    pub fn new(tiles: usize) -> Self {
        Self { due: vec![FAR; tiles], rounds: [const { VecDeque::new() }; ROUNDS], round: 0, entries: 0 }
    }

    /// Queues a tile for `level`, or for an earlier one if it is queued already.
    pub fn put(&mut self, tile: usize, level: i32) {
        if level < self.due[tile] {
            self.due[tile] = level;
            let round = ((level / LEVELS) as usize).clamp(self.round, self.round + ROUNDS - 1);
            self.rounds[round % ROUNDS].push_back(tile);
            self.entries += 1;
        }
    }

    /// Takes the tile that is due next, with its level.
    pub fn take(&mut self) -> Option<(usize, i32)> {
        while self.entries > 0 {
            let Some(tile) = self.rounds[self.round % ROUNDS].pop_front() else {
                self.round += 1;
                continue;
            };
            self.entries -= 1;
            let level = mem::replace(&mut self.due[tile], FAR);
            // A tile that was put forward since has another entry, which has taken it out already.
            if level < FAR {
                return Some((tile, level));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(agenda: &mut TileQueue) -> Vec<(usize, i32)> {
        std::iter::from_fn(|| agenda.take()).collect()
    }

    #[test]
    fn tiles_come_by_round_and_within_a_round_in_turn() {
        let mut agenda = TileQueue::new(9);
        for (tile, level) in [(1, 40), (2, 5), (3, 0), (4, 1_000_000), (5, 41), (6, 3)] {
            agenda.put(tile, level);
        }
        assert_eq!(all(&mut agenda), [(2, 5), (3, 0), (6, 3), (1, 40), (5, 41), (4, 1_000_000)]);
    }

    #[test]
    fn a_tile_that_is_put_forward_comes_once() {
        let mut agenda = TileQueue::new(3);
        agenda.put(1, 100);
        agenda.put(2, 50);
        agenda.put(1, 10);
        agenda.put(1, 70);
        assert_eq!(all(&mut agenda), [(1, 10), (2, 50)]);
    }

    #[test]
    fn a_tile_can_come_again() {
        let mut agenda = TileQueue::new(2);
        agenda.put(1, 500);
        assert_eq!(all(&mut agenda), [(1, 500)]);
        agenda.put(1, 20);
        assert_eq!(all(&mut agenda), [(1, 20)]);
    }

    #[test]
    fn a_tile_without_an_improvement_does_not_wait() {
        let mut agenda = TileQueue::new(1);
        agenda.put(0, FAR);
        agenda.put(0, FAR + 1);
        assert!(all(&mut agenda).is_empty());
    }
}
