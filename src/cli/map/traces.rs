//! What searches did, and the trees and roadmaps that they left.

use std::io::{self, Write};
use std::path::Path;

use wildfire_base::document::number::{count, percent, rounded, short};
use wildfire_base::whole_file::{WholeFile, write_whole};
use wildfire_grid::map_files::MapValue;
use wildfire_grid::{Grid, Place};
use wildfire_picture::{GrownPath, Spot};

/// What a search did.
#[derive(Debug)]
pub struct SearchTrace {
    /// The cost of the path; `None` without one.
    pub cost: Option<f64>,
    /// The cost of a shortest path, of a path that may be longer.
    pub shortest: Option<ShortestCost>,
    /// Cells in the order in which they were expanded, as `row * cols + col`.
    pub expanded: Vec<u32>,
    pub touched: usize,
    /// The cells that jumps went through.
    pub swept: Option<Grid<bool>>,
}

/// What a search that need not find a shortest path is compared with.
#[derive(Clone, Copy, Debug)]
pub struct ShortestCost {
    pub cost: f64,
    /// How many times this cost the path found costs at most; `None` without such a bound.
    pub bound: Option<f64>,
}

impl SearchTrace {
    pub fn sentence(&self) -> String {
        let cost = self.cost.map(|cost| format!(", cost {}", rounded(cost, 3))).unwrap_or_default();
        let expanded = format!("{} expanded, {} touched{cost}.", count(self.expanded.len(), "cell"), self.touched);
        let Some((cost, ShortestCost { cost: min, bound })) = self.cost.zip(self.shortest) else { return expanded };
        let limit = bound.map_or(", without a bound".to_owned(), |bound| format!(", at most {} times", short(bound)));
        let excess = if min > 0.0 { percent(cost / min - 1.0) } else { "0.0".to_owned() };
        format!(
            "{expanded} The path may be longer than the shortest{limit}: the shortest costs {}, this one {excess} % more.",
            rounded(min, 3)
        )
    }

    /// Writes the order of expansion under the names of its columns.
    pub fn write_expansions(&self, path: &Path, cols: usize, cost: &dyn Fn(Place) -> String) -> io::Result<()> {
        let mut file = WholeFile::create(path)?;
        file.write_all(b"order,row,col,cost\n")?;
        for (order, &index) in self.expanded.iter().enumerate() {
            let row = index as usize / cols;
            let col = index as usize % cols;
            writeln!(file, "{order},{row},{col},{}", cost((row, col)))?;
        }
        file.finish()
    }
}

/// A tree or a roadmap.
#[derive(Debug)]
pub struct GraphTrace {
    /// The cost of the path; `None` without one.
    pub cost: Option<f64>,
    /// Number of points that were drawn.
    pub samples: u32,
    /// Number of points of the graph.
    pub vertices: usize,
    /// Ends of the edges, in the order in which they came.
    pub edges: Vec<[Spot; 2]>,
    /// The paths of RRT* before its last.
    pub earlier: Vec<GrownPath>,
}

impl GraphTrace {
    pub fn sentence(&self) -> String {
        let cost = self.cost.map(|cost| format!(", cost {}", rounded(cost, 3))).unwrap_or_default();
        let samples = count(self.samples as usize, "sample");
        let edges = count(self.edges.len(), "edge");
        let points = count(self.vertices, "point");
        format!("{samples}, {points} and {edges}{cost}.")
    }

    /// Writes the edges under the names of their columns.
    pub fn write_edges(&self, path: &Path) -> io::Result<()> {
        let mut file = WholeFile::create(path)?;
        file.write_all(b"order,from_row,from_col,to_row,to_col\n")?;
        for (order, [from, to]) in self.edges.iter().enumerate() {
            let [a, b, c, d] = [from.0, from.1, to.0, to.1].map(real_text);
            writeln!(file, "{order},{a},{b},{c},{d}")?;
        }
        file.finish()
    }
}

/// Writes a path through points, `row,column` a line, whole numbers at the centres of cells.
pub fn write_points(path: &Path, points: &[Spot]) -> io::Result<()> {
    write_whole(
        path,
        points
            .iter()
            .map(|&(row, col)| format!("{},{}\n", real_text(row), real_text(col)))
            .collect::<String>()
            .as_bytes(),
    )
}

/// The text of a number as tables of values have it.
fn real_text(value: f64) -> String {
    let mut text = Vec::new();
    value.append_text(&mut text);
    String::from_utf8(text).expect("numbers are ASCII")
}
