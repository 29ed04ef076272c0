//! The wave with a queue, cell by cell: for maps thinner than a tile, and the standard by which the tiles are judged.

use std::collections::VecDeque;

use super::{GOAL, OBSTACLE, UNREACHED};
use crate::grid::{Connectivity, CornerCutting, Grid, Place, TieOrder, place};

pub fn fill(
    occupied: &Grid<bool>,
    goal: Place,
    connectivity: Connectivity,
    corners: CornerCutting,
    values: &mut Grid<u32>,
) {
    for (value, &is_occupied) in values.values_mut().iter_mut().zip(occupied.values()) {
        *value = if is_occupied { OBSTACLE } else { UNREACHED };
    }
    values[goal] = GOAL;
    let mut front = VecDeque::from([goal]);
    while let Some(from) = front.pop_front() {
        for &offset in TieOrder::CrossFirst.steps(connectivity) {
            if let Some(to) = place::step(occupied, from, offset, corners)
                && values[to] == UNREACHED
            {
                values[to] = values[from] + 1;
                front.push_back(to);
            }
        }
    }
}
