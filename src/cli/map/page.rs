//! `wildfire map report`: every map and every search of one problem, as one page with pictures and tables.

use std::ffi::OsString;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::{Args, Parser};

use crate::cli::error::CliError;
use crate::cli::map::commands::Computation;
use crate::cli::map::computed::{Computed, Value, WalkResult, timed};
use crate::cli::map::explained::{cost, explanation};
use crate::cli::map::graphs::{TreeStep, parse_count, parse_step};
use crate::cli::map::options::{CornerArguments, EndArguments, NeighbourArguments, ReadingArguments};
use crate::cli::map::report::{MapReport, with_scene};
use crate::cli::map::{MapCommand, refused};
use crate::cli::output_files;
use crate::cli::terminal;
use wildfire_base::document::number::{count, rounded};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::input_file::is_standard_stream;
use wildfire_base::whole_file::{WholeFile, write_whole};
use wildfire_batch::plan::{PROGRAM_VERSION, shell_word};
use wildfire_grid::map_files::MapFile;
use wildfire_picture::draw_small_map;

#[derive(Debug, Args)]
#[command(after_help = "\
Writes report.html, which is self-contained, and searches.csv, and creates the \
folder if it is missing. Theta* and jump point search always have 8 neighbours. \
Each CPU time is that of a single run.

Example:
  wildfire map report assets/maps/u-trap.txt --goal 10,27 --start 10,2 \\
    --out lab")]
pub struct MapPageArguments {
    /// A map of any kind.
    #[arg(value_name = "MAP")]
    pub map: PathBuf,
    #[command(flatten)]
    pub reading: ReadingArguments,
    #[command(flatten)]
    pub ends: EndArguments,
    #[command(flatten)]
    pub neighbours: NeighbourArguments,
    #[command(flatten)]
    pub corners: CornerArguments,
    /// Seed of the random samples of trees and roadmaps.
    #[arg(short, long, default_value_t = 1)]
    pub seed: u64,
    /// Maximum number of samples of the trees, from 1 to 100000 [default: 5000].
    #[arg(long, allow_hyphen_values = true, value_parser = parse_count)]
    pub samples: Option<u32>,
    /// Maximum edge length of trees in cells; `auto`: 1/20 of the map's longer side, at least 5.
    #[arg(long, value_name = "CELLS|auto", default_value = "auto", allow_hyphen_values = true, value_parser = parse_step)]
    pub step: TreeStep,
    /// Output folder.
    #[arg(short, long, value_name = "FOLDER")]
    pub out: PathBuf,
}

const PAGE: &str = "report.html";
const SEARCHES: &str = "searches.csv";

/// A command of `wildfire map`, read from its words, so that all that was not asked for is as on the command line.
#[derive(Debug, Parser)]
#[command(no_binary_name = true)]
struct OneCommand {
    #[command(subcommand)]
    command: MapCommand,
}

/// One computation of the page.
struct PagePart {
    /// The words that compute it again, `wildfire map` left out.
    args: Vec<OsString>,
    computation: Computation,
    computed: Computed,
}

pub fn run(arguments: &MapPageArguments, quiet: bool) -> Result<(), CliError> {
    // The folder is tried before anything is computed, as it must take the files.
    check_folder(&arguments.out)?;
    let (map, cpu_read) = timed(|| arguments.reading.read(&arguments.map));
    let map = map?;
    let mut parts = Vec::new();
    for args in commands(arguments) {
        // The command line's own parser reads them, so each picture's caption is a command that gives its numbers.
        let Ok(OneCommand { command: MapCommand::Compute(computation) }) = OneCommand::try_parse_from(&args) else {
            unreachable!("{args:?} is a command");
        };
        computation.parameters().check().map_err(|problem| CliError::bad_input(problem, None))?;
        let computed = computation.compute(&map.occupied).map_err(|problem| refused(&arguments.map, &problem))?;
        parts.push(PagePart { args, computation, computed });
    }
    if !quiet {
        let path = arguments.map.display();
        of_map(&map).iter().for_each(|note| terminal::note(&format!("{path}: {note}")));
    }
    let page = page(arguments, &map, &parts, cpu_read).to_html();
    fs::create_dir_all(&arguments.out).map_err(|error| CliError::unwritable(&arguments.out, &error))?;
    let page_path = arguments.out.join(PAGE);
    let table_path = arguments.out.join(SEARCHES);
    output_files::write_all(
        &[
            (Some(&page_path), &|path| write_whole(path, page.as_bytes())),
            (Some(&table_path), &|path| write_searches(path, &parts)),
        ],
        quiet,
    )
}

/// Refuses a name that is taken by a file, and one in no folder.
fn check_folder(folder: &Path) -> Result<(), CliError> {
    let refuse =
        |reason: &str| Err(CliError::bad_input(format_args!("cannot write to {}: {reason}", folder.display()), None));
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if is_standard_stream(folder) {
        refuse("a page cannot be written to stdout; expected a folder")
    } else if folder.exists() && !folder.is_dir() {
        refuse("it is not a folder")
    } else if !parent.is_dir() {
        refuse("its parent folder does not exist")
    } else {
        Ok(())
    }
}

/// The words of every computation, maps first.
fn commands(arguments: &MapPageArguments) -> Vec<Vec<OsString>> {
    let goal = format!("--goal {}", place_text(arguments.ends.goal.goal));
    let ends = format!("{goal} --start {}", place_text(arguments.ends.start));
    let neighbours = format!("--neighbours {}", arguments.neighbours.connectivity.0);
    let corners = if arguments.corners.no_corner_cutting { "--no-corner-cutting" } else { "" };
    let mut growth = format!("--seed {}", arguments.seed);
    growth.extend(arguments.samples.map(|samples| format!(" --samples {samples}")));
    growth.extend(arguments.step.requested().map(|step| format!(" --step {step}")));
    let seed = format!("--seed {}", arguments.seed);
    let reading = arguments.reading.args();
    let options = [
        ("occupancy", String::new()),
        ("brushfire", neighbours.clone()),
        ("euclidean", String::new()),
        ("cost", String::new()),
        ("voronoi", format!("{ends} {corners}")),
        ("wavefront", format!("{ends} {neighbours} {corners}")),
        ("attraction", goal.clone()),
        ("repulsion", neighbours.clone()),
        ("total", format!("{goal} {neighbours}")),
        ("descend", format!("{ends} {neighbours} {corners} --escape wavefront")),
        ("dijkstra", format!("{ends} {neighbours} {corners}")),
        ("astar", format!("{ends} {neighbours} {corners}")),
        ("greedy", format!("{ends} {neighbours} {corners}")),
        // Jump points are defined on eight neighbours, and lines of sight do not go by neighbours at all.
        ("jps", format!("{ends} {corners}")),
        ("theta", format!("{ends} {corners}")),
        ("rrt", format!("{ends} {growth}")),
        ("rrt-star", format!("{ends} {growth}")),
        ("prm", format!("{ends} {seed}")),
    ];
    let commands = options.into_iter().map(|(command, options)| {
        let options = format!("{options} {reading}");
        let first = [OsString::from(command), "--".into(), arguments.map.clone().into_os_string()];
        // Options stand before the map, whose name may begin with a hyphen.
        let [command, end, map] = first;
        let options = options.split_whitespace().map(OsString::from).collect::<Vec<_>>();
        [command].into_iter().chain(options).chain([end, map]).collect()
    });
    commands.collect()
}

fn place_text((row, col): (usize, usize)) -> String {
    format!("{row},{col}")
}

/// Notes on the map.
fn of_map(map: &MapFile) -> Vec<String> {
    [map.notes.clone(), map.doubts()].concat()
}

fn page(arguments: &MapPageArguments, map: &MapFile, parts: &[PagePart], cpu_read: Duration) -> Document {
    let name = arguments.map.file_name().unwrap_or(arguments.map.as_os_str()).to_string_lossy();
    let start = arguments.ends.start;
    let goal = arguments.ends.goal.goal;
    // Notes on the map is said once.
    let of_map = of_map(map);
    let rows = map.occupied.rows();
    let occupied = map.occupied.values().iter().filter(|&&is_occupied| is_occupied).count();
    let mut facts = vec![
        format!(
            "{} x {}, {} occupied",
            count(rows, "row"),
            count(map.occupied.cols(), "column"),
            count(occupied, "cell")
        ),
        format!("Start: row {}, column {}; goal: row {}, column {}", start.0, start.1, goal.0, goal.1),
        format!("wildfire {PROGRAM_VERSION}"),
    ];
    facts.extend(of_map.iter().cloned());
    let mut document = Document::new(format!("Grid maps of {name}")).with([Block::List(facts)]);
    document.add(Block::Heading("Searches".into()));
    document.add(search_table(parts));
    document.add(Block::Text(
        "Costs are lengths in cells. Each CPU time is that of one run on one thread, without reading the map.".into(),
    ));
    document.add(Block::Heading("Maps".into()));
    document.add(map_table(parts));
    let find = |command: &str| parts.iter().find(|part| part.args[0] == command).map(|part| &part.computed);
    for part in parts {
        let report = MapReport::new(&part.computation, map, &part.computed, cpu_read);
        let png = with_scene(&report, draw_small_map).to_png();
        let mut lines = report.sentences();
        lines.retain(|line| !of_map.iter().any(|sentence| line.contains(sentence.as_str())));
        document.add(Block::Heading(part.computed.title.clone()));
        document.add(Block::Text(explanation(&part.computation, &part.computed, &find)));
        document.add_list(lines);
        document.add(Block::Image { caption: part.command_line(), png });
    }
    document
}

impl PagePart {
    /// The line that computes it again.
    fn command_line(&self) -> String {
        let (map, options) = self.args.split_last().expect("the map comes last");
        // Only a name that looks like an option needs the hyphens before it.
        let needs_hyphens = map.to_string_lossy().starts_with('-');
        let options = options.iter().filter(|word| needs_hyphens || *word != "--");
        let args = options.chain([map]).map(|word| shell_word(&word.to_string_lossy()));
        args.fold("wildfire map".to_owned(), |line, word| line + " " + &word)
    }

    fn is_search(&self) -> bool {
        self.computed.search.is_some() || self.computed.graph.is_some()
    }

    /// Number of points or cells that it looked at from all sides.
    fn expansions(&self) -> Option<usize> {
        self.computed.search.as_ref().map(|search| search.expanded.len())
    }

    fn touched(&self) -> Option<usize> {
        self.computed.search.as_ref().map(|search| search.touched)
    }

    fn vertices(&self) -> Option<usize> {
        self.computed.graph.as_ref().map(|graph| graph.vertices)
    }

    /// The length of its path, if it has one that reaches the goal.
    fn cost(&self) -> Option<f64> {
        cost(&self.computed)
    }

    fn cpu(&self) -> Duration {
        self.computed.cpu_map + self.computed.cpu_path.unwrap_or_default()
    }
}

fn or_dash<T: ToString>(value: Option<T>) -> String {
    value.map_or_else(|| "-".to_owned(), |value| value.to_string())
}

fn search_table(parts: &[PagePart]) -> Table {
    let rows = parts.iter().filter(|part| part.is_search()).map(|part| {
        vec![
            part.computed.title.clone(),
            or_dash(part.cost().map(|cost| rounded(cost, 3))),
            or_dash(part.expansions()),
            or_dash(part.touched()),
            or_dash(part.vertices()),
            rounded(part.cpu().as_secs_f64() * 1e3, 3),
        ]
    });
    let headings = ["Search", "Cost", "Expansions", "Cells\ntouched", "Points", "CPU\nms"];
    Table::new(&headings, rows.collect())
}

fn map_table(parts: &[PagePart]) -> Table {
    let rows = parts.iter().filter(|part| !part.is_search()).map(|part| {
        let maximum = part.computed.values.max().map(Value::to_short_text);
        let length = part.computed.walk.as_ref().and_then(|walk| match walk.path.answer {
            WalkResult::Reached => Some(rounded(walk.path.length, 3)),
            _ => walk.path.minimum.map(|_| "stuck".to_owned()),
        });
        vec![part.computed.title.clone(), or_dash(maximum), or_dash(length), rounded(part.cpu().as_secs_f64() * 1e3, 3)]
    });
    let headings = ["Map", "Maximum", "Length\nof path", "CPU\nms"];
    Table::new(&headings, rows.collect())
}

/// The searches as a table for other programs; what there is none of is empty.
fn write_searches(path: &Path, parts: &[PagePart]) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    file.write_all(b"search,cost,expansions,touched,points,cpu_s\n")?;
    for part in parts.iter().filter(|part| part.is_search()) {
        let cost = part.cost().map_or_else(String::new, |cost| cost.to_string());
        let [expansions, touched, points] = [part.expansions(), part.touched(), part.vertices()]
            .map(|value| value.map_or_else(String::new, |value| value.to_string()));
        let name = part.args[0].to_string_lossy();
        writeln!(file, "{name},{cost},{expansions},{touched},{points},{}", part.cpu().as_secs_f64())?;
    }
    file.finish()
}
