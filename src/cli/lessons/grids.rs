//! Data of the lessons on grids, potential fields and sampling.

use serde_json::{Value, json};

use super::short;
use wildfire_grid::brushfire::brushfire;
use wildfire_grid::descent::{Descent, descend};
use wildfire_grid::path_search::{Heuristic, SearchOrder, search_best_first, theta_star};
use wildfire_grid::potential::{Attraction, Repulsion, RepulsionDistance, attraction, total};
use wildfire_grid::sampling::{PointGraph, PrmSettings, RrtSettings, TreeKind, grow_tree, probabilistic_roadmap};
use wildfire_grid::segment::GridPoint;
use wildfire_grid::wavefront::{descend_wavefront, wavefront};
use wildfire_grid::{Connectivity, CornerCutting, Grid, Place, Route, TieOrder};

/// As the commands of `wildfire map` do unless told otherwise, so that they print the numbers of the lessons.
const CORNERS: CornerCutting = CornerCutting::Allowed;

/// A map with a start and a goal.
struct LessonMap {
    name: &'static str,
    occupied: Grid<bool>,
    start: Place,
    goal: Place,
}

impl LessonMap {
    fn new(name: &'static str, text: &str, start: Place, goal: Place) -> Self {
        let rows: Vec<&str> = text.lines().collect();
        let cells = rows.iter().flat_map(|row| row.bytes().map(|cell| cell == b'1')).collect();
        Self { name, occupied: Grid::from_values(rows.len(), rows[0].len(), cells), start, goal }
    }

    fn basic() -> Self {
        let text = include_str!("../../../assets/maps/basic-14x20.txt");
        Self::new("small rocks", text, (12, 1), (2, 19))
    }

    fn trap() -> Self {
        Self::new("U-shaped trap", include_str!("../../../assets/maps/u-trap.txt"), (10, 2), (10, 27))
    }

    fn rooms() -> Self {
        Self::new("two rooms", include_str!("../../../assets/maps/two-rooms.txt"), (2, 3), (2, 27))
    }

    fn maze() -> Self {
        Self::new("maze", include_str!("../../../assets/maps/maze.txt"), (1, 1), (19, 29))
    }

    fn open() -> Self {
        let occupied = Grid::filled(14, 20, false);
        Self { name: "open field, 4 neighbours", occupied, start: (11, 3), goal: (3, 16) }
    }

    /// The map, and what was computed on it.
    fn data(&self, runs: Vec<Value>) -> Value {
        let walls: String = self.occupied.values().iter().map(|&wall| if wall { '1' } else { '0' }).collect();
        json!({
            "name": self.name,
            "rows": self.occupied.rows(),
            "cols": self.occupied.cols(),
            "walls": walls,
            "start": self.index(self.start),
            "goal": self.index(self.goal),
            "runs": runs,
        })
    }

    fn index(&self, (row, col): Place) -> usize {
        row * self.occupied.cols() + col
    }

    fn free(&self) -> impl Iterator<Item = Place> + '_ {
        let places = (0..self.occupied.rows()).flat_map(|row| (0..self.occupied.cols()).map(move |col| (row, col)));
        places.filter(|&place| !self.occupied[place])
    }

    /// The cell that a path goes to from every cell, or -1.
    fn next(&self, path: impl Fn(Place) -> Vec<Place>) -> Vec<i64> {
        let mut next = vec![-1; self.occupied.values().len()];
        for place in self.free() {
            if let Some(&to) = path(place).get(1) {
                next[self.index(place)] = self.index(to) as i64;
            }
        }
        next
    }

    fn wave(&self, connectivity: Connectivity) -> (Grid<u32>, Vec<i64>) {
        let steps = wavefront(&self.occupied, self.goal, connectivity, CORNERS).expect("the goal is free");
        let next =
            self.next(|place| match descend_wavefront(&steps, place, connectivity, CORNERS, TieOrder::CrossFirst) {
                Route::Found(path) => path,
                _ => Vec::new(),
            });
        (steps, next)
    }
}

/// Brushfire and wavefront: the value of every cell, which is also the step in which the front comes to it.
pub fn fronts() -> Value {
    let boards = [LessonMap::basic(), LessonMap::trap(), LessonMap::rooms()].map(fronts_of);
    json!({"boards": boards})
}

fn fronts_of(board: LessonMap) -> Value {
    let mut runs = Vec::new();
    for (number, connectivity) in [(4, Connectivity::Four), (8, Connectivity::Eight)] {
        let fire = brushfire(&board.occupied, connectivity).expect("the map has obstacles");
        let order: Vec<i64> = fire.values().iter().map(|&value| i64::from(value) - 1).collect();
        let name = format!("brushfire, {number} neighbours");
        runs.push(json!({"name": name, "values": fire.values(), "order": order}));
        let (steps, next) = board.wave(connectivity);
        let order: Vec<i64> = steps.values().iter().map(|&value| i64::from(value) - 2).collect();
        let name = format!("wavefront, {number} neighbours");
        runs.push(json!({"name": name, "values": steps.values(), "order": order, "next": next}));
    }
    board.data(runs)
}

/// A*, Dijkstra's search, greedy and weighted searches: in which step each cell was expanded, and its cost.
pub fn searches() -> Value {
    use Heuristic::{Euclidean, Manhattan, Octile};
    let eight = [
        ("Dijkstra (heuristic zero)", SearchOrder::Dijkstra),
        ("A*, octile", astar(Octile, 1.0)),
        ("A*, Euclidean", astar(Euclidean, 1.0)),
        ("A*, Manhattan (overestimates)", astar(Manhattan, 1.0)),
        ("A*, octile, weight 1.5", astar(Octile, 1.5)),
        ("A*, octile, weight 3", astar(Octile, 3.0)),
        ("A*, octile, weight 0.5", astar(Octile, 0.5)),
        ("greedy, octile", SearchOrder::Greedy { heuristic: Octile }),
    ];
    let four = [
        ("Dijkstra (heuristic zero)", SearchOrder::Dijkstra),
        ("A*, Manhattan", astar(Manhattan, 1.0)),
        ("A*, Manhattan, weight 0.99", astar(Manhattan, 0.99)),
        ("A*, Euclidean", astar(Euclidean, 1.0)),
        ("greedy, Manhattan", SearchOrder::Greedy { heuristic: Manhattan }),
    ];
    let boards = [
        (LessonMap::trap(), Connectivity::Eight, &eight[..]),
        (LessonMap::rooms(), Connectivity::Eight, &eight),
        (LessonMap::basic(), Connectivity::Eight, &eight),
        (LessonMap::maze(), Connectivity::Eight, &eight),
        (LessonMap::open(), Connectivity::Four, &four),
    ];
    let boards = boards.map(|(board, connectivity, orders)| searches_of(board, connectivity, orders));
    json!({"boards": boards})
}

fn astar(heuristic: Heuristic, weight: f64) -> SearchOrder {
    SearchOrder::AStar { heuristic, weight }
}

fn searches_of(board: LessonMap, connectivity: Connectivity, orders: &[(&str, SearchOrder)]) -> Value {
    let runs = orders.iter().map(|&(name, order)| {
        let found = search_best_first(&board.occupied, board.start, board.goal, order, connectivity, CORNERS)
            .expect("both ends are free");
        let mut steps = vec![-1; board.occupied.values().len()];
        for (step, &cell) in found.expanded.iter().enumerate() {
            steps[cell as usize] = step as i64;
        }
        let Route::Found(path) = &found.route else { unreachable!("the goal of {} can be reached", board.name) };
        let path: Vec<usize> = path.iter().map(|&place| board.index(place)).collect();
        // Infinite costs become null.
        let values: Vec<f64> = found.costs.values().iter().map(|&cost| short(cost, 1)).collect();
        json!({
            "name": name,
            "values": values,
            "order": steps,
            "path": path,
            "cost": found.cost.map(|cost| short(cost, 3)),
            "bound": order.cost_bound(connectivity),
            "expanded": found.expanded.len(),
        })
    });
    board.data(runs.collect())
}

/// Potentials, and where a descent goes from every cell.
pub fn potentials() -> Value {
    let boards = [LessonMap::trap(), LessonMap::rooms(), LessonMap::basic()].map(potentials_of);
    json!({"boards": boards})
}

fn potentials_of(board: LessonMap) -> Value {
    let rows = board.occupied.rows();
    let cols = board.occupied.cols();
    let fire = brushfire(&board.occupied, Connectivity::Eight).expect("the map has obstacles");
    let squared = Attraction::Squared { zeta: 1.0 };
    let fields = [
        ("attraction alone", squared, 1e-9),
        ("weak repulsion (eta 15)", squared, 15.0),
        ("strong repulsion (eta 100)", squared, 100.0),
        ("Manhattan attraction, eta 15", Attraction::Manhattan, 15.0),
    ];
    let mut runs = fields
        .map(|(name, kind, eta)| {
            let pull = attraction(rows, cols, board.goal, kind, Some(10.0));
            let push = Repulsion { q: 5.0, eta, distance: RepulsionDistance::Brushfire };
            let field = total(pull, &fire, &push);
            let walk = |place| descend(&field, &board.occupied, place, board.goal, Connectivity::Eight, CORNERS);
            let next = board.next(|place| match walk(place) {
                Ok(Descent::Reached(path) | Descent::Stuck(path)) => path,
                _ => Vec::new(),
            });
            let reached = board.free().filter(|&place| matches!(walk(place), Ok(Descent::Reached(_)))).count();
            let values: Vec<f64> = field.values().iter().map(|&value| short(value, 2)).collect();
            json!({"name": name, "values": values, "next": next, "reached": reached, "free": board.free().count()})
        })
        .to_vec();
    let (steps, next) = board.wave(Connectivity::Eight);
    // Cells without a way on: obstacles and the goal.
    let reached = 1 + next.iter().filter(|&&to| to >= 0).count();
    runs.push(json!({
        "name": "wavefront instead",
        "values": steps.values(),
        "next": next,
        "reached": reached,
        "free": board.free().count(),
    }));
    board.data(runs)
}

/// Numbers of samples at which trees and roadmaps are shown.
const STAGES: [u32; 5] = [25, 50, 100, 200, 400];
/// Those of the chart, and its seeds.
const COST_STAGES: [u32; 6] = [50, 100, 200, 400, 800, 1600];
const COST_SEEDS: u64 = 12;

/// Trees and roadmaps after more and more samples, and how the cost of RRT* falls with them.
pub fn samples() -> Value {
    let boards = [LessonMap::trap(), LessonMap::rooms()].map(samples_of);
    json!({"boards": boards})
}

fn samples_of(board: LessonMap) -> Value {
    let start = board.start;
    let goal = board.goal;
    let tree = |kind, seed, samples| {
        let (neighbours, radius) = (None, None);
        let settings = RrtSettings { seed, samples, step: 5.0, goal_bias: 0.05, neighbours, radius };
        grow_tree(&board.occupied, start, goal, kind, &settings).expect("both ends are free")
    };
    let mut runs = Vec::new();
    for seed in [1, 2] {
        let rrt = STAGES.map(|samples| graph_data(samples, &tree(TreeKind::Rrt, seed, samples)));
        let star = STAGES.map(|samples| graph_data(samples, &tree(TreeKind::RrtStar, seed, samples)));
        let prm = STAGES.map(|samples| {
            let settings = PrmSettings { seed, samples, neighbours: Some(12), radius: None };
            let roadmap = probabilistic_roadmap(&board.occupied, start, goal, &settings).expect("both ends are free");
            graph_data(samples, &roadmap)
        });
        for (name, stages) in [("RRT", rrt), ("RRT*", star), ("PRM", prm)] {
            runs.push(json!({"name": format!("{name}, seed {seed}"), "stages": stages}));
        }
    }
    let costs: Vec<_> = (1..=COST_SEEDS)
        .map(|seed| COST_STAGES.map(|samples| tree(TreeKind::RrtStar, seed, samples).cost.map(|cost| short(cost, 2))))
        .collect();
    let any_angle = theta_star(&board.occupied, start, goal, CORNERS).expect("both ends are free");
    let mut data = board.data(runs);
    data["costs"] =
        json!({"samples": COST_STAGES, "seeds": costs, "reference": any_angle.cost.map(|cost| short(cost, 2))});
    data
}

fn graph_data(samples: u32, graph: &PointGraph) -> Value {
    let cost = graph.cost.map(|cost| short(cost, 2));
    let points = rounded_points(&graph.points);
    let path = rounded_points(&graph.path);
    json!({"samples": samples, "points": points, "edges": graph.edges, "path": path, "cost": cost})
}

fn rounded_points(points: &[GridPoint]) -> Vec<[f64; 2]> {
    points.iter().map(|point| point.coordinates()).map(|(row, col)| [short(row, 1), short(col, 1)]).collect()
}
