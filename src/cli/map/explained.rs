//! What the page for a report says about each computation: what it is, why its number is as it is, what to look at.

use crate::cli::map::commands::Computation;
use crate::cli::map::computed::{Computed, Value, WalkResult};
use wildfire_base::document::number::{count, percent};

/// Returns two sentences about a computation; `find` returns another one of the same page by the name of its command.
pub fn explanation<'a>(
    computation: &Computation,
    computed: &Computed,
    find: &dyn Fn(&str) -> Option<&'a Computed>,
) -> String {
    let max = computed.values.max().map_or("none".to_owned(), Value::to_short_text);
    let cells = count(expanded(computed), "cell");
    let of_dijkstra = find("dijkstra").map_or(0, expanded);
    let is_stuck = computed.walk.as_ref().is_some_and(|walk| walk.path.minimum.is_some());
    let has_path = computed.walk.as_ref().is_some_and(|walk| walk.path.answer == WalkResult::Reached);
    let dearer = cost(computed).zip(find("astar").and_then(cost)).map(|(cost, min)| match cost - min {
        // Costs are equal up to rounding: sums of the same steps in another order differ in their last digits.
        excess if excess > 1e-9 * min => format!("{} % longer than that of A*", percent(excess / min)),
        excess if excess < -1e-9 * min => format!("{} % shorter than that of A*", percent(-excess / min)),
        _ => "as long as that of A*".to_owned(),
    });
    let dearer = dearer.unwrap_or_else(|| "missing, so its length cannot be compared".to_owned());
    match computation {
        Computation::Occupancy(_) => "Each cell is occupied or free, and the maximum is 1 if any cell is occupied. Check \
            here that thin walls have survived the tolerance: all other maps depend on it."
            .to_owned(),
        Computation::Brushfire(_) => format!(
            "Brushfire counts the steps from the nearest obstacle, which itself has the value 1; the maximum {max} belongs to \
             the cell with the most room around it. Look for ridges, where fronts from two obstacles meet: they show the \
             Voronoi diagram."
        ),
        Computation::Euclidean(_) => format!(
            "The exact straight distance from the centre of the nearest obstacle cell; the maximum {max} is the radius of the \
             largest empty circle around the centre of a cell. Compare its round contours with the angular ones of brushfire."
        ),
        Computation::Cost(_) => format!(
            "The cost falls with the distance from obstacles, slowly in the safety zone and then at a constant rate; the \
             maximum {max} is the cost of an obstacle. Look at narrow passages: where they are safety zone from wall to wall, \
             no path avoids the high cost."
        ),
        Computation::Voronoi(_) => format!(
            "The diagram has the cells equally far from two sites, and its maximum {max} is the largest clearance on it. Its \
             path keeps away from obstacles at the price of length; look at where it joins and leaves the diagram."
        ),
        Computation::Wavefront(_) => format!(
            "The wavefront counts steps from the goal, which has the value 2; the maximum {max} belongs to the cell farthest \
             from the goal. A path only has to descend, because there is no local minimum; look at how the front bends around \
             obstacles."
        ),
        Computation::Attraction(_) => format!(
            "The potential grows with the distance from the goal and ignores obstacles; the maximum {max} is the value to \
             which it is scaled. Without obstacles a descent on it would lead straight to the goal; look at the walls that its \
             contours cross."
        ),
        Computation::Repulsion(_) => format!(
            "The potential grows near obstacles and is 0 beyond --q; the maximum {max} is its value at an obstacle. Look at \
             whether the hills of two obstacles meet: there they can block a passage."
        ),
        Computation::Total(_) => format!(
            "The sum of attraction and repulsion, with the maximum {max}. Look for basins other than the goal's, above all in \
             front of concave obstacles: there a descent gets stuck."
        ),
        Computation::Descend(_) if is_stuck => "Gradient descent moves to the lowest neighbour and ends in a local minimum \
            here, because every neighbour of that cell has a higher potential. Look at the shape of the obstacle in front of \
            it; the rest of the path comes from the wavefront, which has no local minima."
            .to_owned(),
        Computation::Descend(_) => "Gradient descent moves to the lowest neighbour, and here it reaches the goal because no \
            local minimum lies on its path. Look at where the path bends: the repulsion of an obstacle begins there."
            .to_owned(),
        Computation::Dijkstra(_) => format!(
            "Dijkstra's search expands cells in the order of their cost from the start: {cells}, all that are nearer than the \
             goal. Look at the rings of equal cost; half of them lead away from the goal."
        ),
        Computation::Astar(_) => format!(
            "A* adds an estimate of the cost to the goal, so it expands {cells} where Dijkstra's search expands \
             {of_dijkstra}, for a path of the same cost. Look at the cells in front of obstacles: there the estimate is too \
             optimistic, and the search fills the pocket."
        ),
        Computation::Greedy(_) => format!(
            "Greedy search looks at the estimate alone and expands {cells}; nothing keeps its path short, and here it is \
             {dearer}. Look at where the path turns back after running into an obstacle."
        ),
        Computation::Jps(_) => format!(
            "Jump point search is A* that expands only cells where a shortest path may have to turn: {cells}, and the path is \
             {dearer}. Look at the light cells: the jumps pass through them without putting them on the open list."
        ),
        Computation::Theta(_) => format!(
            "Theta* lets a path go straight from any visible cell to another, so its path is {dearer}. Look at the turns: all \
             are at corners of obstacles."
        ),
        Computation::Rrt(_) if !has_path => no_path("The tree"),
        Computation::RrtStar(_) if !has_path => no_path("The tree"),
        Computation::Prm(_) if !has_path => no_path("The roadmap"),
        Computation::Rrt(_) => format!(
            "The tree grows towards random points and stops when it reaches the goal, so its path is {dearer}. Look at its \
             zigzags: no edge is ever improved, so more samples would not shorten it."
        ),
        Computation::RrtStar(_) => format!(
            "RRT* grows like RRT but also reconnects points over shorter paths, so more samples shorten its path, which is \
             {dearer}. Look at how the branches fan out from the start and around corners."
        ),
        Computation::Prm(_) => format!(
            "The roadmap connects {} with nearby ones where the segment is free; the shortest path through it is {dearer}. \
             Look at narrow passages: they need a sample inside, so they are what a roadmap misses first.",
            computed.graph.as_ref().map_or(String::new(), |graph| count(graph.vertices, "point")),
        ),
    }
}

fn expanded(computed: &Computed) -> usize {
    computed.search.as_ref().map_or(0, |search| search.expanded.len())
}

fn no_path(what: &str) -> String {
    format!(
        "{what} found no path with its samples, which does not prove that there is none. Look at where its edges end, and try \
         more samples."
    )
}

/// The cost of the path that a search, a tree or a roadmap found.
pub fn cost(computed: &Computed) -> Option<f64> {
    let search = computed.search.as_ref().and_then(|search| search.cost);
    search.or_else(|| computed.graph.as_ref().and_then(|graph| graph.cost))
}
