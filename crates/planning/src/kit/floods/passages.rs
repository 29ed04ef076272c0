//! A proof that no lattice reaches a place: the body does not fit through any gap.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec2;

use crate::GoalDisc;
use crate::collision::CollisionChecker;
use crate::memory::{MemoryKind, MemoryMeter, MemoryShare};
use wildfire_base::geometry::{FieldFrame, Pose};

/// Side of a square.
const SQUARE_M: f64 = 0.5;
/// On larger fields nothing is excluded.
const MAX_SQUARES: usize = 4_000_000;

/// The most squares of a pocket that is recognised by itself, and the radius of the largest disc that is asked for.
const LARGEST_POCKET: usize = 4096;
const LARGEST_DISC_M: f64 = 20.0;

/// Bytes of every square for whether it was met, and for its place among those that wait.
const BYTES_AT_WORK: usize = 1 + size_of::<usize>();

/// The part of the field that the body's centre could reach if only the largest disc in the body had to pass.
///
/// The field is cut into squares. A square is open if its middle is no nearer to a bush than that disc's radius less
/// half the square's diagonal, so every square in which the body's centre can be is open, and every way of the body's
/// centre leads through open squares that share sides. Squares that are not joined to the start's are out of reach: a
/// proof of "no".
#[derive(Debug)]
pub struct CorridorGraph {
    squares: Squares,
    /// For every square, row by row from the south-west, whether it is joined to the start's; empty when there are too
    /// many.
    joined: Vec<bool>,
    /// The memory of the squares that are joined.
    memory: MemoryShare,
}

impl CorridorGraph {
    pub fn new(checker: &CollisionChecker, memory: &MemoryMeter, start: Pose) -> Self {
        let squares = Squares::new(checker.field().frame());
        let count = squares.count();
        let mut passages = Self { squares, joined: Vec::new(), memory: memory.holder(MemoryKind::Floods) };
        if count <= MAX_SQUARES && passages.memory.cover(count) {
            passages.join(checker, checker.body().body_centre(start));
        }
        passages
    }

    /// Spreads over open squares from the start's, judging each when it is first met.
    fn join(&mut self, checker: &CollisionChecker, start: DVec2) {
        let squares = self.squares;
        let mut at_work = self.memory.beside();
        // Without memory nothing is joined, and nothing is proven.
        if !at_work.cover(squares.count() * BYTES_AT_WORK) {
            return;
        }
        let mut met = vec![false; squares.count()];
        self.joined = met.clone();
        let first = squares.at(start);
        // The truck stands there, so the square counts as open whatever the distance of its middle says.
        met[first] = true;
        self.joined[first] = true;
        let mut pending = vec![first];
        while let Some(square) = pending.pop() {
            for next in squares.beside(square) {
                if !met[next] {
                    met[next] = true;
                    if squares.is_open(checker, next) {
                        self.joined[next] = true;
                        pending.push(next);
                    }
                }
            }
        }
    }

    /// Returns whether no place in a disc is connected to the start.
    pub fn exclude(&self, disc: GoalDisc) -> bool {
        if self.joined.is_empty() {
            return false;
        }
        !self.squares.in_disc(disc).any(|square| self.joined[square])
    }
}

/// Returns whether a disc lies in a pocket of the field that the body's centre cannot reach from the start: the answer
/// of [`CorridorGraph`] at the cost of the pocket alone. A large pocket is not recognised.
pub fn lies_in_pocket(checker: &CollisionChecker, start: Pose, disc: GoalDisc) -> bool {
    if disc.radius_m > LARGEST_DISC_M {
        return false;
    }
    let squares = Squares::new(checker.field().frame());
    let first = squares.at(checker.body().body_centre(start));
    let is_open = |square: usize| square == first || squares.is_open(checker, square);
    let mut pending: Vec<usize> = squares.in_disc(disc).filter(|&square| is_open(square)).collect();
    // A set in place of an array over all squares: the cost must follow the pocket and not the field.
    let mut met: BTreeSet<usize> = pending.iter().copied().collect();
    while let Some(square) = pending.pop() {
        if square == first || met.len() > LARGEST_POCKET {
            return false;
        }
        pending.extend(squares.beside(square).filter(|&next| is_open(next) && met.insert(next)));
    }
    true
}

/// The squares of a field, numbered row by row from the south-west.
#[derive(Clone, Copy, Debug)]
struct Squares {
    cols: usize,
    rows: usize,
}

impl Squares {
    fn new(frame: &FieldFrame) -> Self {
        let count = |side: f64| (side / SQUARE_M).ceil() as usize;
        Self { cols: count(frame.width_m()), rows: count(frame.height_m()) }
    }

    fn count(self) -> usize {
        self.cols * self.rows
    }

    /// Returns whether the body's centre can be in a square, as far as the largest disc in the body decides that.
    fn is_open(self, checker: &CollisionChecker, square: usize) -> bool {
        let body = checker.body();
        let needed = 0.5 * body.width_m.min(body.length_m) - SQUARE_M * FRAC_1_SQRT_2;
        let middle = self.middle(square);
        let field = checker.field();
        // The field's bound is cheaper than the exact distance, and mostly enough.
        field.lower_bound(middle) >= needed || field.distance(middle) >= needed
    }

    /// Returns the squares that have a place in a disc.
    fn in_disc(self, disc: GoalDisc) -> impl Iterator<Item = usize> {
        let reach = disc.radius_m + SQUARE_M * FRAC_1_SQRT_2;
        let range = move |middle: f64, count: usize| {
            let low = (middle - reach) / SQUARE_M;
            let high = (middle + reach) / SQUARE_M;
            low as usize..(high as usize).saturating_add(1).min(count)
        };
        let cols = range(disc.centre.x, self.cols);
        let squares =
            range(disc.centre.y, self.rows).flat_map(move |row| cols.clone().map(move |col| row * self.cols + col));
        squares.filter(move |&square| self.middle(square).distance(disc.centre) <= reach)
    }

    fn middle(self, square: usize) -> DVec2 {
        DVec2::new((square % self.cols) as f64 + 0.5, (square / self.cols) as f64 + 0.5) * SQUARE_M
    }

    fn at(self, point: DVec2) -> usize {
        square_index(point.y, self.rows) * self.cols + square_index(point.x, self.cols)
    }

    /// Returns the squares that share a side with one.
    fn beside(self, square: usize) -> impl Iterator<Item = usize> + use<> {
        let col = square % self.cols;
        let row = square / self.cols;
        let cols = self.cols;
        let rows = self.rows;
        let west = (col > 0).then(|| square - 1);
        let east = (col + 1 < cols).then_some(square + 1);
        let south = (row > 0).then(|| square - cols);
        let north = (row + 1 < rows).then_some(square + cols);
        [west, east, south, north].into_iter().flatten()
    }
}

fn square_index(metres: f64, count: usize) -> usize {
    ((metres / SQUARE_M) as usize).min(count - 1)
}
