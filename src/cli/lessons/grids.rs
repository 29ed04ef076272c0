//! Data of the lessons on grids, potential fields and sampling.

use serde_json::{Value, json};

use super::short;
use wildfire_grid::brushfire::brushfire;
use wildfire_grid::descent::{Descent, descend};
use wildfire_grid::path_search::{Heuristic, SearchOrder, search_best_first, theta_star};
use wildfire_grid::potential::{Attraction, Repulsion, attraction, total};
use wildfire_grid::sampling::{PointGraph, PrmSettings, RrtSettings, TreeKind, grow_tree, probabilistic_roadmap};
use wildfire_grid::segment::GridPoint;
use wildfire_grid::{Connectivity, CornerCutting, Grid, Place};

/// As the commands of `wildfire map` do unless told otherwise, so that they print the numbers of the lessons.
const CORNERS: CornerCutting = CornerCutting::Allowed;

/// A map with a start and a goal.
struct LessonMap {
    name: &'static str,
    /// The name under which the page saves the map, and which its commands read.
    file: &'static str,
    occupied: Grid<bool>,
    start: Place,
    goal: Place,
}

impl LessonMap {
    fn new(name: &'static str, file: &'static str, text: &str, start: Place, goal: Place) -> Self {
        let rows: Vec<&str> = text.lines().collect();
        let cells = rows.iter().flat_map(|row| row.bytes().map(|cell| cell == b'1')).collect();
        Self { name, file, occupied: Grid::from_values(rows.len(), rows[0].len(), cells), start, goal }
    }

    fn basic() -> Self {
        let text = include_str!("../../../assets/maps/basic-14x20.txt");
        Self::new("small rocks", "basic-14x20.txt", text, (12, 1), (2, 19))
    }

    fn trap() -> Self {
        let text = include_str!("../../../assets/maps/u-trap.txt");
        Self::new("U-shaped trap", "u-trap.txt", text, (10, 2), (10, 27))
    }

    fn rooms() -> Self {
        let text = include_str!("../../../assets/maps/two-rooms.txt");
        Self::new("two rooms", "two-rooms.txt", text, (2, 3), (2, 27))
    }

    fn maze() -> Self {
        Self::new("maze", "maze.txt", include_str!("../../../assets/maps/maze.txt"), (1, 1), (19, 29))
    }

    fn open() -> Self {
        let occupied = Grid::filled(14, 20, false);
        Self { name: "open field, 4 neighbours", file: "open-14x20.txt", occupied, start: (11, 3), goal: (3, 16) }
    }

    /// The map, and what was computed on it.
    fn data(&self, runs: Vec<Value>) -> Value {
        let walls: String = self.occupied.values().iter().map(|&wall| if wall { '1' } else { '0' }).collect();
        json!({
            "name": self.name,
            "file": self.file,
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
}

/// Brushfire and wavefront, which the page computes.
pub fn fronts() -> Value {
    let runs = ["brushfire", "wavefront"].map(|command| {
        [4, 8].map(|neighbours| {
            let name = format!("{command}, {neighbours} neighbours");
            json!({"name": name, "args": format!("{command} --neighbours {neighbours}")})
        })
    });
    let boards = [LessonMap::basic(), LessonMap::trap(), LessonMap::rooms()].map(|board| board.data(runs.concat()));
    json!({"boards": boards})
}

/// A*, Dijkstra's search, greedy and weighted searches, which the page computes, and their numbers for the text.
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
        json!({
            "name": name,
            "args": search_args(order, connectivity),
            "cost": found.cost.map(|cost| short(cost, 3)),
            "bound": order.cost_bound(connectivity),
            "expanded": found.expanded.len(),
        })
    });
    board.data(runs.collect())
}

/// The options of `wildfire map` for a search.
fn search_args(order: SearchOrder, connectivity: Connectivity) -> String {
    let args = match order {
        SearchOrder::Dijkstra => "dijkstra".to_owned(),
        SearchOrder::AStar { heuristic, weight: 1.0 } => format!("astar --heuristic {heuristic:?}"),
        SearchOrder::AStar { heuristic, weight } => format!("astar --heuristic {heuristic:?} --weight {weight}"),
        SearchOrder::Greedy { heuristic } => format!("greedy --heuristic {heuristic:?}"),
    };
    let neighbours = if connectivity == Connectivity::Four { " --neighbours 4" } else { "" };
    args.to_lowercase() + neighbours
}

/// Potentials, whose descents the page computes, and from how many cells they reach the goal.
pub fn potentials() -> Value {
    let boards = [LessonMap::trap(), LessonMap::rooms(), LessonMap::basic()].map(potentials_of);
    json!({"boards": boards})
}

fn potentials_of(board: LessonMap) -> Value {
    let rows = board.occupied.rows();
    let cols = board.occupied.cols();
    let fire = brushfire(&board.occupied, Connectivity::Eight).expect("the map has obstacles");
    let squared = Attraction::default();
    let fields = [
        ("attraction alone", squared, 0.0, "descend --eta 0"),
        ("weak repulsion (eta 15)", squared, 15.0, "descend --eta 15"),
        ("strong repulsion (eta 100)", squared, 100.0, "descend --eta 100"),
        ("Manhattan attraction, eta 15", Attraction::Manhattan, 15.0, "descend --distance manhattan --eta 15"),
    ];
    let mut runs: Vec<Value> = fields
        .iter()
        // The page computes the fields itself; only what takes a descent from every cell is computed here.
        .map(|&(name, kind, eta, args)| {
            let pull = attraction(rows, cols, board.goal, kind, Some(10.0));
            let field = total(pull, &fire, &Repulsion { eta, ..Repulsion::default() });
            let descents = board
                .free()
                .map(|place| descend(&field, &board.occupied, place, board.goal, Connectivity::Eight, CORNERS));
            let reached = descents.filter(|descent| matches!(descent, Ok(Descent::Reached(_)))).count();
            json!({"name": name, "args": args, "reached": reached, "free": board.free().count()})
        })
        .collect();
    runs.push(json!({"name": "wavefront instead", "args": "wavefront"}));
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
    // There are two seeds, so a reader sees how much of a picture is chance.
    for seed in [1, 2] {
        let rrt = STAGES.map(|samples| graph_data(samples, &tree(TreeKind::Rrt, seed, samples)));
        let star = STAGES.map(|samples| graph_data(samples, &tree(TreeKind::RrtStar, seed, samples)));
        let prm = STAGES.map(|samples| {
            let settings = PrmSettings { seed, samples, neighbours: Some(12), radius: None };
            let roadmap = probabilistic_roadmap(&board.occupied, start, goal, &settings).expect("both ends are free");
            graph_data(samples, &roadmap)
        });
        for (name, command, more, stages) in
            [("RRT", "rrt", "", rrt), ("RRT*", "rrt-star", "", star), ("PRM", "prm", " --neighbours 12", prm)]
        {
            let args = format!("{command} --seed {seed}{more}");
            runs.push(json!({"name": format!("{name}, seed {seed}"), "args": args, "stages": stages}));
        }
    }
    let costs: Vec<_> = (1..=COST_SEEDS)
        .map(|seed| COST_STAGES.map(|samples| tree(TreeKind::RrtStar, seed, samples).cost.map(|cost| short(cost, 2))))
        .collect();
    // Theta* is no optimum over all angles, but close enough to see where the costs settle.
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
