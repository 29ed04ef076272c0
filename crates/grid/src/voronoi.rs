//! The generalised Voronoi diagram of a map's obstacles: free cells that are equidistant from two of them.
//!
//! Sites are the components of occupied cells, joined over sides and corners, and the four walls, which are rows and columns
//! of occupied cells around the map. Every cell has a nearest site, by the exact Euclidean distance between centres. Of two
//! cells side by side whose nearest sites differ, the one belongs to the diagram that is less far from the other's nearest
//! occupied cell; both do if they are equally far. So the diagram is the border between the regions of the sites, one or
//! two cells wide, and the distances to the two sites differ by at most 1 cell on it. The rule is that of B. Lau, C. Sprunk,
//! W. Burgard, "Efficient grid-based spatial representations for robot navigation in dynamic environments", Robotics and
//! Autonomous Systems 61(10), 2013, section 4, with sites in place of single cells.
//!
//! Where the walls of a map are one component, as in a maze, no two sites meet. With [`Sites::Cells`] every occupied cell is
//! one, and of two cells side by side those count whose nearest occupied cells are seen at least 60 degrees apart: the
//! simplified medial axis of M. Foskey, M. Lin, D. Manocha, "Efficient computation of a simplified medial axis", Journal of
//! Computing and Information Science in Engineering 3(4), 2003.

use std::collections::VecDeque;

use crate::distance::nearest_occupied;
use crate::octile::{START_LENGTH, StepLength, UNSEEN, legal_moves, longer, metric};
use crate::open_list::{OpenList, Ranked};
use crate::{BadPlace, Connectivity, CornerCutting, Grid, Place, Route, TieOrder, astar, place};

/// The definition of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sites {
    /// Connected components, and each of the four walls.
    Obstacles,
    /// Single cells, seen at least 60 degrees apart.
    Cells,
}

/// A generalised Voronoi diagram.
#[derive(Clone, Debug, PartialEq)]
pub struct Voronoi {
    /// The free cells that belong to the diagram.
    pub diagram: Grid<bool>,
    /// The Euclidean distance from each cell's centre to that of the nearest occupied one, walls included.
    pub clearance: Grid<f64>,
    /// The number of sites: components and walls, or occupied cells and those of the walls.
    pub sites: usize,
}

/// Computes the generalised Voronoi diagram of the occupied cells and the walls around the map.
///
/// # Panics
/// If the map has more cells than 32 bits can number.
pub fn voronoi(occupied: &Grid<bool>, sites: Sites) -> Voronoi {
    // The map's edge counts as an obstacle, as a robot cannot leave it.
    let walled = with_walls(occupied);
    let nearest = nearest_occupied(&walled).expect("walls are occupied");
    let (labels, components) = label_components(&walled);
    let mut diagram = Grid::filled(occupied.rows(), occupied.cols(), false);
    let mut clearance = Grid::filled(occupied.rows(), occupied.cols(), 0.0);
    // Places within the walls are one more than on the map.
    let seen = |from: Place, other: Place| {
        let index = nearest[other] as usize;
        let row = index / walled.cols();
        let col = index % walled.cols();
        (row as i64 - from.0 as i64, col as i64 - from.1 as i64)
    };
    let square = |(row, col): (i64, i64)| row * row + col * col;
    for row in 0..occupied.rows() {
        for col in 0..occupied.cols() {
            let here = (row + 1, col + 1);
            clearance[(row, col)] = (square(seen(here, here)) as f64).sqrt();
            // Each pair of neighbours once: those below and to the right.
            for there in [(row + 2, col + 1), (row + 1, col + 2)] {
                if walled[here] || walled[there] || nearest[here] == nearest[there] {
                    continue;
                }
                let is_border = match sites {
                    Sites::Obstacles => {
                        labels.values()[nearest[here] as usize] != labels.values()[nearest[there] as usize]
                    }
                    Sites::Cells => are_apart(seen(here, here), seen(here, there)),
                };
                if is_border {
                    // The cell nearer to the middle between both is on the diagram; both if they are as near.
                    let to_theirs = square(seen(here, there));
                    let to_ours = square(seen(there, here));
                    diagram[(row, col)] |= to_theirs <= to_ours;
                    diagram[(there.0 - 1, there.1 - 1)] |= to_ours <= to_theirs;
                }
            }
        }
    }
    let sites = match sites {
        Sites::Obstacles => components,
        Sites::Cells => walled.values().iter().filter(|&&is_occupied| is_occupied).count(),
    };
    Voronoi { diagram, clearance, sites }
}

/// Whether two cells are seen at least 60 degrees apart, decided in whole numbers: the cosine is at most a half.
fn are_apart(a: (i64, i64), b: (i64, i64)) -> bool {
    let dot = a.0 * b.0 + a.1 * b.1;
    // Squares have up to 33 bits, so their product does not fit into 64.
    let squares = i128::from(a.0 * a.0 + a.1 * a.1) * i128::from(b.0 * b.0 + b.1 * b.1);
    // Squares have no sign, so angles of 90 degrees and more are decided before.
    dot <= 0 || 4 * i128::from(dot) * i128::from(dot) <= squares
}

fn with_walls(occupied: &Grid<bool>) -> Grid<bool> {
    let mut walled = Grid::filled(occupied.rows() + 2, occupied.cols() + 2, true);
    for row in 0..occupied.rows() {
        walled.row_mut(row + 1)[1..=occupied.cols()].copy_from_slice(occupied.row(row));
    }
    walled
}

/// Numbers the components of occupied cells, from 1, walls first: north, south, west, east. 0 is free.
fn label_components(walled: &Grid<bool>) -> (Grid<u32>, usize) {
    let (rows, cols) = (walled.rows(), walled.cols());
    let mut labels = Grid::filled(rows, cols, 0);
    labels.row_mut(0).fill(1);
    labels.row_mut(rows - 1).fill(2);
    for row in 1..rows - 1 {
        labels[(row, 0)] = 3;
        labels[(row, cols - 1)] = 4;
    }
    let mut last = 4;
    let mut front = VecDeque::new();
    // Walls have their numbers already, so that an obstacle that touches one keeps a number apart.
    for first in (1..rows - 1).flat_map(|row| (1..cols - 1).map(move |col| (row, col))) {
        if !walled[first] || labels[first] != 0 {
            continue;
        }
        last += 1;
        labels[first] = last;
        front.push_back(first);
        while let Some(here) = front.pop_front() {
            for &offset in TieOrder::CrossFirst.steps(Connectivity::Eight) {
                let to = place::neighbour(walled, here, offset).filter(|&to| walled[to] && labels[to] == 0);
                if let Some(to) = to {
                    labels[to] = last;
                    front.push_back(to);
                }
            }
        }
    }
    (labels, last as usize)
}

/// Lengths of a way beside the diagram and along it.
#[derive(Clone, Copy, PartialEq)]
struct RouteLength {
    beside: StepLength,
    along: StepLength,
}

struct OpenVertex {
    lengths: RouteLength,
    index: usize,
}

/// The length beside the diagram comes first, that along it decides between equals.
impl Ranked for OpenVertex {
    type Tie = usize;

    fn priority(&self) -> f64 {
        metric(self.lengths.beside)
    }

    fn cost(&self) -> f64 {
        // Of equal priorities the largest cost comes out first, so the shorter length must be the larger number.
        -metric(self.lengths.along)
    }

    fn tie(&self) -> usize {
        self.index
    }
}

/// Finds the path over 8 neighbours that leaves the diagram least: to the diagram, along it, and from it to the goal.
///
/// Of all paths, those with the least length beside the diagram, and of these the shortest (Dijkstra's search over pairs of
/// lengths). A step is along the diagram if both its cells belong to it. Where the diagram is in pieces, or empty, the
/// path crosses the gaps, so there is one whenever the goal can be reached. A goal outside or in an obstacle is an error,
/// and so is a start outside.
pub fn path_along(
    occupied: &Grid<bool>,
    diagram: &Grid<bool>,
    start: Place,
    goal: Place,
    corners: CornerCutting,
) -> Result<Route, BadPlace> {
    if !place::check_ends(occupied, start, goal)? {
        return Ok(Route::StartOccupied);
    }
    let cols = occupied.cols();
    let moves = legal_moves(occupied, Connectivity::Eight, corners);
    let unseen = RouteLength { beside: UNSEEN, along: UNSEEN };
    let mut lengths = Grid::filled(occupied.rows(), cols, unseen);
    let mut parents = Grid::filled(occupied.rows(), cols, 0_u32);
    lengths[start] = RouteLength { beside: START_LENGTH, along: START_LENGTH };
    let mut open = OpenList::default();
    open.push(OpenVertex { lengths: lengths[start], index: start.0 * cols + start.1 });
    while let Some(OpenVertex { lengths: popped, index }) = open.pop() {
        let here = (index / cols, index % cols);
        // A shorter way to this cell was found since the entry was made, and has been expanded.
        if popped != lengths[here] {
            continue;
        }
        if here == goal {
            return Ok(Route::Found(cells_to(&parents, start, goal)));
        }
        for (_, &offset) in astar::MOVES.iter().enumerate().filter(|(k, _)| moves[here] & (1 << k) != 0) {
            let to = place::neighbour(occupied, here, offset).expect("legal moves stay on the map");
            let RouteLength { beside, along } = popped;
            let next = if diagram[here] && diagram[to] {
                RouteLength { beside, along: longer(along, offset) }
            } else {
                RouteLength { beside: longer(beside, offset), along }
            };
            let best = lengths[to];
            // In this order: a step beside the diagram outweighs any length along it.
            let key = |lengths: RouteLength| (metric(lengths.beside), metric(lengths.along));
            if best == unseen || key(next) < key(best) {
                lengths[to] = next;
                parents[to] = index as u32;
                open.push(OpenVertex { lengths: next, index: to.0 * cols + to.1 });
            }
        }
    }
    Ok(Route::Unreachable)
}

fn cells_to(parents: &Grid<u32>, start: Place, goal: Place) -> Vec<Place> {
    let mut cells = vec![goal];
    let mut here = goal;
    while here != start {
        let parent = parents[here] as usize;
        here = (parent / parents.cols(), parent % parents.cols());
        cells.push(here);
    }
    cells.reverse();
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawn;
    use wildfire_base::rng;

    fn picture(diagram: &Grid<bool>) -> Vec<String> {
        let line = |row| diagram.row(row).iter().map(|&is_on| if is_on { 'o' } else { '.' }).collect();
        (0..diagram.rows()).map(line).collect()
    }

    #[test]
    fn diagram_of_an_empty_room_is_that_of_its_walls() {
        let room = Grid::filled(5, 9, false);
        let found = voronoi(&room, Sites::Obstacles);
        assert_eq!(picture(&found.diagram), ["o.......o", ".o.....o.", "..ooooo..", ".o.....o.", "o.......o"]);
        assert_eq!((found.sites, found.clearance[(2, 4)], found.clearance[(0, 4)]), (4, 3.0, 1.0));
        assert_eq!(voronoi(&room, Sites::Cells).diagram, found.diagram);
    }

    /// Distances of cells to every site by brute force.
    #[test]
    fn diagram_cells_are_as_far_from_a_second_site_up_to_the_resolution() {
        let mut rng = rng::stream(1, "grid/voronoi");
        for _ in 0..60 {
            let map = drawn::blobs(20, 24, 4, 0..=3, &mut rng);
            let found = voronoi(&map, Sites::Obstacles);
            let walled = with_walls(&map);
            let (labels, count) = label_components(&walled);
            assert_eq!(count, found.sites);
            for (row, col) in (0..20).flat_map(|row| (0..24).map(move |col| (row, col))) {
                let mut squares = vec![usize::MAX; count + 1];
                for (index, &label) in labels.values().iter().enumerate().filter(|(_, label)| **label > 0) {
                    let r = index / walled.cols();
                    let c = index % walled.cols();
                    let square = r.abs_diff(row + 1).pow(2) + c.abs_diff(col + 1).pow(2);
                    squares[label as usize] = squares[label as usize].min(square);
                }
                squares.sort_unstable();
                let [first, second] = [squares[0], squares[1]].map(|square| (square as f64).sqrt());
                assert!((found.clearance[(row, col)] - first).abs() < 1e-12);
                if found.diagram[(row, col)] {
                    assert!(!map[(row, col)] && second - first < 1.0 + 1e-9, "{row}, {col}: {first} and {second}");
                }
            }
        }
    }

    #[test]
    fn path_keeps_to_the_middle_between_walls() {
        let room = Grid::filled(5, 9, false);
        let found = voronoi(&room, Sites::Obstacles);
        let route = path_along(&room, &found.diagram, (1, 0), (3, 8), CornerCutting::Allowed).unwrap();
        let Route::Found(cells) = route else { panic!("{route:?}") };
        assert!((2..7).all(|col| cells.contains(&(2, col))), "{cells:?}");
        let empty = Grid::filled(5, 9, false);
        let route = path_along(&room, &empty, (0, 0), (0, 8), CornerCutting::Allowed).unwrap();
        assert_eq!(route, Route::Found((0..9).map(|col| (0, col)).collect()));
    }

    #[test]
    fn mazes_of_one_component_have_a_diagram_of_cells() {
        let maze = drawn::maze(31, 31, 5, &mut rng::stream(2, "grid/voronoi"));
        assert!(!voronoi(&maze, Sites::Obstacles).diagram.values().contains(&true));
        let found = voronoi(&maze, Sites::Cells);
        let route = path_along(&maze, &found.diagram, (3, 3), (27, 27), CornerCutting::Forbidden).unwrap();
        let Route::Found(cells) = route else { panic!("{route:?}") };
        let on = cells.iter().filter(|&&cell| found.diagram[cell]).count();
        assert!(10 * on > 9 * cells.len(), "{on} of {} cells", cells.len());
    }
}
