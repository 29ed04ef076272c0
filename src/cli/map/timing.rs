//! `wildfire map timing`: what brushfire and wavefront cost on maps.

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use serde::Serialize;

use crate::cli::error::CliError;
use crate::cli::map::options::ReadingArguments;
use crate::cli::report::FormArguments;
use crate::cli::terminal;
use wildfire_base::document::number::optional;
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::time::cpu::CpuStopwatch;
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_grid::brushfire::brushfire_into;
use wildfire_grid::wavefront::wavefront_into;
use wildfire_grid::{Connectivity, CornerCutting, Grid, Place};

#[derive(Debug, Args)]
#[command(after_help = "\
Both with 8 neighbours. The goal of the wavefront is the free cell nearest to the \
centre of the map. Each figure is the median of at least five repetitions and at \
least 0.2 s of CPU time on one thread, into warm memory, without reading the map.

Example:
  wildfire map timing assets/maps/*.png")]
pub struct TimingArguments {
    /// Maps of any kind.
    #[arg(value_name = "MAP", required = true)]
    pub maps: Vec<PathBuf>,
    #[command(flatten)]
    pub reading: ReadingArguments,
    #[command(flatten)]
    pub form: FormArguments,
}

/// The least repetitions, and the least CPU time, that a median is taken over.
const MIN_REPETITIONS: usize = 5;
const MIN_CPU: Duration = Duration::from_millis(200);

/// The members of the JSON in their order; without a free cell there is no goal and no wavefront.
#[derive(Serialize)]
struct Timing {
    map: String,
    rows: usize,
    cols: usize,
    cells: usize,
    goal: Option<Place>,
    brushfire_s: f64,
    wavefront_s: Option<f64>,
}

#[derive(Serialize)]
struct Timings {
    program_version: &'static str,
    connectivity: u8,
    maps: Vec<Timing>,
}

pub fn run(arguments: &TimingArguments, quiet: bool) -> Result<(), CliError> {
    let mut timings = Vec::new();
    for path in &arguments.maps {
        let map = arguments.reading.read(path)?;
        if !quiet {
            let doubts = map.doubts();
            map.notes.iter().chain(&doubts).for_each(|note| terminal::note(&format!("{}: {note}", path.display())));
        }
        timings.push(measure(path, &map.occupied));
    }
    let timings = Timings { program_version: PROGRAM_VERSION, connectivity: 8, maps: timings };
    terminal::print(&arguments.form.render(&timings))
}

impl From<&Timings> for Document {
    fn from(timings: &Timings) -> Self {
        let rows = timings.maps.iter().map(|timing| {
            vec![
                timing.map.clone(),
                timing.cells.to_string(),
                optional(Some(timing.brushfire_s), 7),
                optional(timing.wavefront_s, 7),
                timing.goal.map_or("-".to_owned(), |(row, col)| format!("{row},{col}")),
            ]
        });
        let headings = ["Map", "Cells", "Brushfire\nseconds", "Wavefront\nseconds", "Goal"];
        Self::new("CPU time of brushfire and wavefront").with([
            Block::Table(Table::new(&headings, rows.collect())),
            Block::Text("CPU time of one thread, 8 neighbours, median of repetitions, reading left out.".into()),
            Block::Text("The wavefront's goal, row,column, is the free cell nearest the centre.".into()),
        ])
    }
}

fn measure(path: &Path, occupied: &Grid<bool>) -> Timing {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    let goal = free_cell_nearest_centre(occupied);
    // The grids are made once and filled again, so that the time is that of the algorithm and not of the allocator.
    let mut distances = Grid::filled(rows, cols, 0);
    let mut steps = Grid::filled(rows, cols, 0);
    Timing {
        map: path.display().to_string(),
        rows,
        cols,
        cells: occupied.values().len(),
        goal,
        brushfire_s: median_s(|| {
            brushfire_into(occupied, Connectivity::Eight, &mut distances);
        }),
        wavefront_s: goal.map(|goal| {
            median_s(|| {
                let filled = wavefront_into(occupied, goal, Connectivity::Eight, CornerCutting::Allowed, &mut steps);
                filled.expect("it is free");
            })
        }),
    }
}

/// By the Euclidean distance, ties to the first in reading order.
fn free_cell_nearest_centre(occupied: &Grid<bool>) -> Option<Place> {
    let (rows, cols) = (occupied.rows(), occupied.cols());
    let places = (0..rows).flat_map(|row| (0..cols).map(move |col| (row, col)));
    // Twice the offset from the centre is a whole number.
    places.filter(|&place| !occupied[place]).min_by_key(|&(row, col)| {
        let row = (2 * row).abs_diff(rows - 1);
        let col = (2 * col).abs_diff(cols - 1);
        row * row + col * col
    })
}

/// The median CPU time of some work in seconds, after it was done once.
fn median_s(mut work: impl FnMut()) -> f64 {
    work();
    let (mut laps, mut sum) = (Vec::new(), Duration::ZERO);
    while laps.len() < MIN_REPETITIONS || sum < MIN_CPU {
        let mut stopwatch = CpuStopwatch::start();
        work();
        laps.push(stopwatch.elapsed_since_last());
        sum += laps[laps.len() - 1];
    }
    laps.sort_unstable();
    laps[laps.len() / 2].as_secs_f64()
}
