//! `wildfire fire spread --model alexandridis`: many fires of the automaton, and how much they burn.

use std::io::{self, Write};
use std::path::Path;
use std::sync::Arc;
use std::thread;

use serde::{Serialize, Serializer};

use super::automaton_arguments::AutomatonArguments;
use super::{SpreadArguments, TimedIgnition};
use crate::cli::args::jobs_or_all;
use crate::cli::error::CliError;
use crate::cli::fire::options::WindStep;
use crate::cli::output_files::{self, Files, Format};
use wildfire_base::document::number::{count, rounded, short};
use wildfire_base::document::{Document, Table};
use wildfire_base::geometry::{Cell, FieldFrame, compass, ops};
use wildfire_base::object;
use wildfire_base::whole_file::WholeFile;
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_batch::stats::{Series, quantile};
use wildfire_fire::models::{Alexandridis, AlexandridisRules};
use wildfire_fire::{FireField, Landscape, Relief};

/// What became of one fire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Burned {
    area: usize,
    last_step: u32,
}

pub fn run(arguments: &SpreadArguments, quiet: bool) -> Result<(), CliError> {
    let files = Files { form: arguments.form, ..Files::default() };
    let stream = files.writing([(Format::Csv, &arguments.automaton.areas)]).check()?;
    let frame = arguments.frame();
    let report = AutomatonReport::new(arguments, frame, ignited_at_start(arguments, frame)?);
    let printed = stream.print(&arguments.form.render(&report));
    let areas = arguments.automaton.areas.as_deref();
    printed.and(output_files::write_all(&[(areas, &|path| write_areas(path, &report.fires))], quiet))
}

fn ignited_at_start(arguments: &SpreadArguments, frame: FieldFrame) -> Result<Vec<Cell>, CliError> {
    let ignited = arguments.ignitions(frame)?.into_iter().map(|ignition| {
        let TimedIgnition { cell: cell @ Cell { col, row }, seconds } = ignition;
        if seconds > 0.0 {
            Err(CliError::bad_input(format!("--ignite {row},{col}@{seconds}: the automaton ignites only at 0 s"), None))
        } else {
            Ok(cell)
        }
    });
    ignited.collect()
}

fn write_areas(path: &Path, fires: &[Burned]) -> io::Result<()> {
    let mut table = WholeFile::create(path)?;
    writeln!(table, "run,area,last_step")?;
    for (run, Burned { area, last_step }) in fires.iter().enumerate() {
        writeln!(table, "{run},{area},{last_step}")?;
    }
    table.finish()
}

/// Fires of the automaton under one set of conditions.
struct AutomatonReport<'a> {
    arguments: &'a SpreadArguments,
    rules: AlexandridisRules,
    frame: FieldFrame,
    ignited: Vec<Cell>,
    /// In the order of their seeds.
    fires: Vec<Burned>,
}

impl<'a> AutomatonReport<'a> {
    fn new(arguments: &'a SpreadArguments, frame: FieldFrame, ignited: Vec<Cell>) -> Self {
        let seed = arguments.automaton.seed;
        let [slope_deg, uphill_deg] = arguments.automaton.slope_and_uphill_deg(&arguments.slope);
        let rules = arguments.automaton.rules();
        let uphill = compass::unit_toward(uphill_deg) * ops::tan(slope_deg.to_radians());
        let fuel = 102;
        let landscape = Landscape { relief: Relief::Plane(uphill), ..Landscape::uniform(frame, fuel) };
        let automaton = Alexandridis::new(Arc::new(landscape), Arc::new(arguments.weather()), rules, seed);
        let fires = burn_all(&automaton, &frame, &ignited, &arguments.automaton);
        Self { arguments, rules, frame, ignited, fires }
    }

    fn areas(&self) -> Vec<f64> {
        let mut areas: Vec<f64> = self.fires.iter().map(|fire| fire.area as f64).collect();
        areas.sort_unstable_by(f64::total_cmp);
        areas
    }
}

/// Burns all fires on a few threads, in the order of their seeds whatever thread has burned which.
fn burn_all(
    automaton: &Alexandridis,
    frame: &FieldFrame,
    ignited: &[Cell],
    arguments: &AutomatonArguments,
) -> Vec<Burned> {
    let &AutomatonArguments { runs, seed, steps, jobs, .. } = arguments;
    let fuel = FireField::new(*frame, &[], false).with_ground((0..frame.cell_count()).map(|index| frame.cell(index)));
    // Seeds are consecutive, so that any single fire of the list can be burned again by itself.
    let burn = |run: u32| {
        let mut fires = fuel.clone();
        let automaton = automaton.with_seed(seed.wrapping_add(run.into()));
        let last_step = automaton.burn_alone(&mut fires, ignited, steps.unwrap_or(u32::MAX));
        // All that was lit has burned or burns; what is left could still be lit.
        Burned { area: frame.cell_count() - fires.flammable().len(), last_step }
    };
    let jobs = jobs_or_all(jobs) as u32;
    let mut fires = vec![Burned { area: 0, last_step: 0 }; runs as usize];
    // Each job has a part of the list, so no lock is needed and the order is that of the seeds.
    let share = runs.div_ceil(jobs.min(runs)) as usize;
    thread::scope(|scope| {
        for (job, fires) in fires.chunks_mut(share).enumerate() {
            let burn = &burn;
            scope.spawn(move || {
                for (place, fire) in fires.iter_mut().enumerate() {
                    *fire = burn((job * share + place) as u32);
                }
            });
        }
    });
    fires
}

/// The shares of fires whose areas are printed.
const SHARES: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

impl From<&AutomatonReport<'_>> for Document {
    fn from(report: &AutomatonReport<'_>) -> Self {
        let AutomatonReport { rules, frame, .. } = report;
        let arguments = &report.arguments.automaton;
        let mut document = Self::new(format!("{} of the automaton", count(report.fires.len(), "fire")));
        let wind = report.arguments.wind.as_ref().map_or_else(
            || "no wind".to_owned(),
            |wind| {
                let steps = wind.0.iter().map(|step| {
                    let WindStep { from, speed_mps, from_deg } = *step;
                    format!("from {} s on {} m/s from {}", short(from.as_seconds()), short(speed_mps), short(from_deg))
                });
                format!("wind {}", steps.collect::<Vec<_>>().join(", "))
            },
        );
        let slope = match arguments.slope_and_uphill_deg(&report.arguments.slope) {
            [0.0, _] => "level ground".to_owned(),
            [slope, uphill] => format!("slope of {} degrees, uphill to {}", short(slope), short(uphill)),
        };
        document.add_list(vec![
            format!("{} rows of {} cells; {} lit", frame.rows, frame.cols, count(report.ignited.len(), "cell")),
            format!("Probability of spread {}; {wind}; {slope}", short(rules.p0)),
        ]);
        let areas = report.areas();
        let series = Series::from_values(&areas);
        let decimals = |number: Option<f64>| number.map_or_else(|| "-".to_owned(), |number| rounded(number, 1));
        let last_step = report.fires.iter().map(|fire| f64::from(fire.last_step)).collect::<Vec<_>>();
        let mut row = vec![decimals(series.mean()), decimals(series.standard_deviation())];
        row.extend(SHARES.map(|share| decimals(quantile(&areas, share))));
        row.push(decimals(Series::from_values(&last_step).mean()));
        let headings =
            ["Cells burned,\nmean", "Standard\ndeviation", "5 %", "25 %", "50 %", "75 %", "95 %", "Last step,\nmean"];
        document.add(Table { text_columns: 0, ..Table::new(&headings, vec![row]) });
        document
    }
}

impl Serialize for AutomatonReport<'_> {
    /// Serialises the members in their order.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let arguments = &self.arguments.automaton;
        let areas = self.areas();
        let series = Series::from_values(&areas);
        let last_steps: Vec<f64> = self.fires.iter().map(|fire| f64::from(fire.last_step)).collect();
        let [slope_deg, uphill_deg] = arguments.slope_and_uphill_deg(&self.arguments.slope);
        let wind = self.arguments.wind.iter().flat_map(|wind| &wind.0);
        let wind = wind.map(|&WindStep { from, speed_mps, from_deg }| {
            object!(Wind { at_s: from.as_seconds(), speed_mps, from_deg })
        });
        let report = object!(Fires {
            program_version: PROGRAM_VERSION,
            model: "alexandridis",
            rows: self.frame.rows,
            cols: self.frame.cols,
            cell_m: self.frame.cell_m,
            p0: self.rules.p0,
            wind_c1: self.rules.wind_c1,
            wind_c2: self.rules.wind_c2,
            slope_a: self.rules.slope_a,
            vegetation: self.rules.vegetation,
            density: self.rules.density,
            slope_deg,
            uphill_deg,
            step_s: self.rules.step.as_seconds(),
            steps: arguments.steps,
            runs: arguments.runs,
            seed: arguments.seed,
            wind: wind.collect::<Vec<_>>(),
            // Row from the south and column of each cell that was lit.
            lit: self.ignited.iter().map(|cell| [cell.row, cell.col]).collect::<Vec<_>>(),
            area_mean: series.mean(),
            area_sd: series.standard_deviation(),
            area_sem: series.standard_error(),
            area_quantiles: SHARES.map(|share| object!(Quantile { share, area: quantile(&areas, share) })),
            last_step_mean: Series::from_values(&last_steps).mean(),
        });
        report.serialize(serializer)
    }
}
