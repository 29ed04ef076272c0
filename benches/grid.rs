//! What brushfire and wavefront cost on large maps of five kinds, on the thread's CPU clock: medians of warm calls.
//!
//! `cargo bench --bench grid` prints the kinds at 4096 cells a side, the growth with the side, and the ratio to plain
//! breadth-first searches. With `-- --huge` the growth goes on to 16384 a side, which takes some 2 GB.
//!
//! `-- --serve` obeys commands from standard input instead, so that another program can time its own calls in turn:
//! `draw KIND SIDE`, `save FILE` (a byte per cell, 1 if occupied, row by row), `brushfire 4|8` (answered by the
//! milliseconds of a call), `compare FILE` (16-bit values, little-endian; answered by the number of cells in which the
//! last brushfire holds another value). Every answer is one line.

#![expect(clippy::print_stdout, reason = "a benchmark prints its figures")]

use std::collections::VecDeque;
use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::io;

use wildfire::grid::brushfire::brushfire_into;
use wildfire::grid::wavefront::wavefront_into;
use wildfire::grid::{Connectivity, CornerCutting, Grid, Place, TieOrder, drawn, place};
use wildfire::rng;
use wildfire::time::cpu::CpuStopwatch;

const REPETITIONS: usize = 9;
const SIDE: usize = 4096;
const SIDES: [usize; 3] = [256, 1024, 4096];
const HUGE_SIDE: usize = 16_384;
const KINDS: [&str; 5] = ["random10", "random30", "blobs", "single", "maze"];
const BOTH: [Connectivity; 2] = [Connectivity::Four, Connectivity::Eight];

fn main() -> Result<(), Box<dyn Error>> {
    let has_option = |option| std::env::args().any(|argument| argument == option);
    if has_option("--serve") {
        return serve();
    }
    print_kinds();
    print_growth(SIDES.into_iter().chain(has_option("--huge").then_some(HUGE_SIDE)));
    print_plain();
    if let Some(peak) = peak_memory() {
        println!("\npeak memory: {peak}");
    }
    Ok(())
}

/// The map of a kind; discs keep their size, so that a larger map has more of them.
fn draw(kind: &str, side: usize) -> Grid<bool> {
    let mut rng = rng::stream(1, kind);
    match kind {
        "random10" => drawn::random(side, side, 0.1, &mut rng),
        "random30" => drawn::random(side, side, 0.3, &mut rng),
        "blobs" => drawn::blobs(side, side, 3000 * side * side / (SIDE * SIDE), 4..=50, &mut rng),
        "single" => drawn::single_obstacle(side, side),
        _ => drawn::maze(side, side, 8, &mut rng),
    }
}

/// What the benchmark keeps from call to call, so that no call waits for memory.
struct CounterfactualRunner {
    occupied: Grid<bool>,
    goal: Place,
    distances: Grid<u16>,
    levels: Grid<u32>,
}

impl CounterfactualRunner {
    fn new(kind: &str, side: usize) -> Self {
        let occupied = draw(kind, side);
        let goal = free_place_nearest_the_centre(&occupied);
        Self { occupied, goal, distances: Grid::filled(side, side, 0), levels: Grid::filled(side, side, 0) }
    }

    fn cells(&self) -> f64 {
        self.occupied.values().len() as f64
    }

    fn brushfire(&mut self, connectivity: Connectivity) {
        black_box(brushfire_into(black_box(&self.occupied), connectivity, &mut self.distances));
    }

    fn wavefront(&mut self, connectivity: Connectivity) {
        wavefront_into(&self.occupied, self.goal, connectivity, CornerCutting::Allowed, &mut self.levels)
            .expect("the goal is free");
        black_box(&self.levels);
    }

    /// Milliseconds of brushfire 4 and 8, then of wavefront 4 and 8.
    fn medians(&mut self) -> [f64; 4] {
        let [brushfire_4, brushfire_8] = BOTH.map(|connectivity| median_ms(|| self.brushfire(connectivity)));
        let [wavefront_4, wavefront_8] = BOTH.map(|connectivity| median_ms(|| self.wavefront(connectivity)));
        [brushfire_4, brushfire_8, wavefront_4, wavefront_8]
    }
}

fn free_place_nearest_the_centre(occupied: &Grid<bool>) -> Place {
    let centre = (occupied.rows() / 2, occupied.cols() / 2);
    let square = |place: &Place| place.0.abs_diff(centre.0).pow(2) + place.1.abs_diff(centre.1).pow(2);
    places(occupied).filter(|&place| !occupied[place]).min_by_key(square).expect("these maps are not full")
}

fn print_kinds() {
    println!("{SIDE} x {SIDE} cells, ms (ns per cell), medians of {REPETITIONS}");
    print_heading("map");
    for kind in KINDS {
        let mut bench = CounterfactualRunner::new(kind, SIDE);
        let cells = bench.cells();
        let columns = bench.medians().map(|ms| format!("{ms:9.2} ({:5.2})", ms * 1e6 / cells));
        println!("{kind:12} {}", columns.join(" "));
    }
}

fn print_growth(sides: impl Iterator<Item = usize>) {
    println!("\ngrowth, ns per cell, mean of the kinds");
    print_heading("side");
    for side in sides {
        let mut sums = [0.0; 4];
        for kind in KINDS {
            let mut bench = CounterfactualRunner::new(kind, side);
            let cells = bench.cells();
            for (sum, ms) in sums.iter_mut().zip(bench.medians()) {
                *sum += ms * 1e6 / cells;
            }
        }
        println!("{side:<12} {}", sums.map(|sum| format!("{:17.2}", sum / KINDS.len() as f64)).join(" "));
    }
}

fn print_heading(first: &str) {
    let columns = ["brushfire 4", "brushfire 8", "wavefront 4", "wavefront 8"];
    println!("{first:12} {}", columns.map(|column| format!("{column:>17}")).join(" "));
}

fn print_plain() {
    let kind = KINDS[0];
    println!("\nplain breadth-first searches on {kind}, {SIDE} a side, ms (times slower)");
    print_heading("");
    let mut bench = CounterfactualRunner::new(kind, SIDE);
    let obstacles: Vec<Place> = places(&bench.occupied).filter(|&place| bench.occupied[place]).collect();
    let plain =
        |start: &[Place]| BOTH.map(|connectivity| ms(|| drop(black_box(search(&bench.occupied, start, connectivity)))));
    let (distances, levels) = (plain(&obstacles), plain(&[bench.goal]));
    let slow = [distances, levels].concat();
    let columns = slow.iter().zip(bench.medians()).map(|(slow, fast)| format!("{slow:9.1} ({:5.1})", slow / fast));
    println!("{:12} {}", "", columns.collect::<Vec<_>>().join(" "));
}

fn places(map: &Grid<bool>) -> impl Iterator<Item = Place> {
    let cols = map.cols();
    (0..map.rows()).flat_map(move |row| (0..cols).map(move |col| (row, col)))
}

/// Steps to free cells from the nearest of some places, plus one; 0 where none leads.
fn search(occupied: &Grid<bool>, start: &[Place], connectivity: Connectivity) -> Grid<u32> {
    let mut values = Grid::filled(occupied.rows(), occupied.cols(), 0);
    let mut front = VecDeque::from(start.to_vec());
    start.iter().for_each(|&place| values[place] = 1);
    while let Some(from) = front.pop_front() {
        for &step in TieOrder::CrossFirst.steps(connectivity) {
            if let Some(to) = place::step(occupied, from, step, CornerCutting::Allowed).filter(|&to| values[to] == 0) {
                values[to] = values[from] + 1;
                front.push_back(to);
            }
        }
    }
    values
}

fn serve() -> Result<(), Box<dyn Error>> {
    let mut bench = CounterfactualRunner::new("single", 2);
    for line in io::stdin().lines() {
        let line = line?;
        let fields: Vec<&str> = line.split_whitespace().collect();
        match fields[..] {
            ["draw", kind, side] => {
                bench = CounterfactualRunner::new(kind, side.parse()?);
                println!("drawn");
            }
            ["save", file] => {
                fs::write(file, bench.occupied.values().iter().map(|&cell| cell.into()).collect::<Vec<u8>>())?;
                println!("saved");
            }
            ["brushfire", "4"] => println!("{}", ms(|| bench.brushfire(Connectivity::Four))),
            ["brushfire", "8"] => println!("{}", ms(|| bench.brushfire(Connectivity::Eight))),
            ["compare", file] => println!("{}", differences(&bench.distances, &fs::read(file)?)),
            _ => return Err(format!("not a command: {line}").into()),
        }
    }
    Ok(())
}

fn differences(values: &Grid<u16>, bytes: &[u8]) -> usize {
    let expected = bytes.as_chunks().0.iter().map(|&pair| u16::from_le_bytes(pair));
    let missing = values.values().len().abs_diff(bytes.len() / 2);
    missing + values.values().iter().zip(expected).filter(|(found, expected)| *found != expected).count()
}

fn median_ms(mut work: impl FnMut()) -> f64 {
    work();
    let mut costs: Vec<f64> = (0..REPETITIONS).map(|_| ms(&mut work)).collect();
    costs.sort_by(f64::total_cmp);
    costs[REPETITIONS / 2]
}

fn ms(work: impl FnOnce()) -> f64 {
    let mut watch = CpuStopwatch::start();
    work();
    watch.elapsed_since_last().as_secs_f64() * 1e3
}

/// The most memory that this process held at once, where the system tells.
fn peak_memory() -> Option<String> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().to_owned())
}
