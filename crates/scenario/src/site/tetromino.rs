//! The seven one-sided tetrominoes and their rotations.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A one-sided tetromino: mirror images count as different, rotations do not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub enum Shape {
    I,
    J,
    L,
    O,
    S,
    T,
    Z,
}

/// The four cells of a piece as offsets (col, row) from the south-west corner of its bounding box.
pub type Piece = [(u16, u16); 4];

impl Shape {
    pub const ALL: [Self; 7] = [Self::I, Self::J, Self::L, Self::O, Self::S, Self::T, Self::Z];

    /// Returns the distinct rotations: 1 of O, 2 of I, S and Z, 4 of J, L and T; 19 in all.
    pub fn rotations(self) -> &'static [Piece] {
        match self {
            Self::I => &I,
            Self::J => &J,
            Self::L => &L,
            Self::O => &O,
            Self::S => &S,
            Self::T => &T,
            Self::Z => &Z,
        }
    }
}

const I: [Piece; 2] = [[(0, 0), (1, 0), (2, 0), (3, 0)], [(0, 0), (0, 1), (0, 2), (0, 3)]];
const J: [Piece; 4] = [
    [(0, 0), (1, 0), (2, 0), (0, 1)],
    [(0, 0), (0, 1), (0, 2), (1, 2)],
    [(2, 0), (0, 1), (1, 1), (2, 1)],
    [(0, 0), (1, 0), (1, 1), (1, 2)],
];
const L: [Piece; 4] = [
    [(0, 0), (1, 0), (2, 0), (2, 1)],
    [(0, 0), (1, 0), (0, 1), (0, 2)],
    [(0, 0), (0, 1), (1, 1), (2, 1)],
    [(1, 0), (1, 1), (0, 2), (1, 2)],
];
const O: [Piece; 1] = [[(0, 0), (1, 0), (0, 1), (1, 1)]];
const S: [Piece; 2] = [[(0, 0), (1, 0), (1, 1), (2, 1)], [(1, 0), (0, 1), (1, 1), (0, 2)]];
const T: [Piece; 4] = [
    [(0, 0), (1, 0), (2, 0), (1, 1)],
    [(0, 0), (0, 1), (1, 1), (0, 2)],
    [(1, 0), (0, 1), (1, 1), (2, 1)],
    [(1, 0), (0, 1), (1, 1), (1, 2)],
];
const Z: [Piece; 2] = [[(1, 0), (2, 0), (0, 1), (1, 1)], [(0, 0), (0, 1), (1, 1), (1, 2)]];

/// Returns columns and rows of a piece's bounding box.
pub fn extent(piece: &Piece) -> (u16, u16) {
    let reach = |side: fn(&(u16, u16)) -> u16| 1 + piece.iter().map(side).max().expect("a piece has four cells");
    (reach(|cell| cell.0), reach(|cell| cell.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn normalised(cells: [(i32, i32); 4]) -> Vec<(u16, u16)> {
        let west = cells.map(|c| c.0).into_iter().min().unwrap();
        let south = cells.map(|c| c.1).into_iter().min().unwrap();
        let mut moved: Vec<_> = cells.iter().map(|c| ((c.0 - west) as u16, (c.1 - south) as u16)).collect();
        moved.sort_unstable();
        moved
    }

    fn turned_left(piece: &Piece) -> Vec<(u16, u16)> {
        normalised(piece.map(|(col, row)| (-i32::from(row), i32::from(col))))
    }

    fn mirrored(piece: &Piece) -> Vec<(u16, u16)> {
        normalised(piece.map(|(col, row)| (-i32::from(col), i32::from(row))))
    }

    fn sorted(piece: &Piece) -> Vec<(u16, u16)> {
        normalised(piece.map(|(col, row)| (i32::from(col), i32::from(row))))
    }

    #[test]
    fn rotations_are_closed_under_turning_and_nineteen_in_all() {
        let mut all: Vec<Vec<(u16, u16)>> = Vec::new();
        for shape in Shape::ALL {
            let rotations: Vec<_> = shape.rotations().iter().map(sorted).collect();
            for piece in shape.rotations() {
                assert!(rotations.contains(&turned_left(piece)), "{shape:?}: {piece:?} turned is another piece");
            }
            all.extend(rotations);
        }
        assert_eq!(all.len(), 19);
        all.sort();
        all.dedup();
        assert_eq!(all.len(), 19, "some rotation is listed twice");
    }

    #[test]
    fn mirrors_pair_up_and_name_the_shapes() {
        let holds = |shape: Shape, piece: &Vec<(u16, u16)>| shape.rotations().iter().any(|p| &sorted(p) == piece);
        let pairs = [
            (Shape::J, Shape::L),
            (Shape::S, Shape::Z),
            (Shape::I, Shape::I),
            (Shape::O, Shape::O),
            (Shape::T, Shape::T),
        ];
        for (one, other) in pairs {
            assert!(one.rotations().iter().all(|piece| holds(other, &mirrored(piece))), "{one:?} against {other:?}");
        }
        assert!(holds(Shape::L, &vec![(0, 0), (0, 1), (0, 2), (1, 0)]), "L stands on a foot that points east");
        assert!(holds(Shape::S, &vec![(0, 0), (1, 0), (1, 1), (2, 1)]), "S climbs to the east");
    }

    #[test]
    fn every_piece_is_connected_and_touches_its_corner_box() {
        for piece in Shape::ALL.iter().flat_map(|shape| shape.rotations()) {
            let mut joined = vec![piece[0]];
            for _ in 0..3 {
                for &cell in piece {
                    let touches = |other: &(u16, u16)| cell.0.abs_diff(other.0) + cell.1.abs_diff(other.1) == 1;
                    if !joined.contains(&cell) && joined.iter().any(touches) {
                        joined.push(cell);
                    }
                }
            }
            assert_eq!(joined.len(), 4, "{piece:?} falls apart");
            assert_eq!(
                sorted(piece),
                {
                    let mut p = piece.to_vec();
                    p.sort_unstable();
                    p
                },
                "{piece:?} is not at the origin"
            );
            let (cols, rows) = extent(piece);
            assert_eq!(cols.max(rows) + cols.min(rows), if cols == rows { 4 } else { 5 });
        }
    }
}
