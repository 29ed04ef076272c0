//! Maps over the runs of a batch: how often each cell burns, when and how intensely if it does, and the paired
//! difference of two batches.
//!
//! Runs are read from their recordings, and simulated again from the plan where there are none: the same seed gives the same
//! run. They are taken one round after the other, so that memory holds some numbers for each cell and the maps of one round,
//! whatever the number of runs; numbers are added in the order of the plan, so that threads do not change them.

mod error;
mod selection;
mod sums;

use rayon::prelude::*;
use serde::{Serialize, Serializer};

pub use error::MapsError;
pub use selection::MapSource;

use crate::execute::BatchError;
use crate::plan::PlannedRun;
use crate::stats::{Interval, MeanEstimate, Series, estimate_mean};
use wildfire_base::{object, rng};
use wildfire_sim::CustomRegistry;
use wildfire_timeline::{BurnMap, Setting, Timeline};

use sums::{PairSums, RunCounts, SideSums};

/// The quantity of a map over a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BatchQuantity {
    /// The share of runs in which the cell burns.
    BurnProbability,
    /// The mean time in seconds until fire arrives, over the runs in which it does.
    MeanArrival,
    /// The mean of Byram's intensity in kW/m, over the runs in which a front arrives.
    MeanIntensity,
    /// The share of runs with flames of a class, 1 to 6, among those in which a front arrives.
    FlameClass(u8),
}

/// The upper ends of the classes of flame lengths in metres, 2, 4, 6, 8 and 12 ft; the sixth has none (Finney and others,
/// "A simulation of probabilistic wildfire risk components for the continental United States", 2011).
const FLAME_CLASSES_M: [f64; 5] = [0.6096, 1.2192, 1.8288, 2.4384, 3.6576];

/// Returns 1 if flames of a length are of a class and 0 if not; NaN where no front came.
fn is_of_class(flame_m: f64, class: u8) -> f64 {
    if flame_m.is_nan() {
        return f64::NAN;
    }
    let found = 1 + FLAME_CLASSES_M.iter().filter(|&&end| flame_m > end).count();
    f64::from(u8::from(found == usize::from(class)))
}

/// The options of reading runs.
#[derive(Clone, Copy, Debug)]
pub struct MapsOptions<'a> {
    pub quantity: BatchQuantity,
    /// The number of threads.
    pub jobs: usize,
    /// The planners and policies of runs that are repeated.
    pub registry: &'a CustomRegistry,
}

/// Maps over one batch, or over two and their difference.
#[derive(Clone, Debug)]
pub struct BatchMaps {
    /// The setting of the first run: field, bushes, ground.
    pub setting: Setting,
    /// Whether anything can burn there in some run, by cell index.
    pub can_burn: Vec<bool>,
    /// True if water, roads and other ground that does not burn are the same in all runs.
    pub is_same_ground: bool,
    /// The batch, then the one that is subtracted.
    pub sides: Vec<BatchSide>,
    pub difference: Option<MapDifference>,
    /// The number of runs, or of pairs.
    pub runs: u64,
    /// The numbers of runs that were read from recordings and that were simulated again, of all sides.
    pub recorded: u64,
    pub simulated: u64,
    /// The number of runs, or pairs, that could not take place.
    pub not_run: u64,
    /// The number of seeds that only one of the batches has.
    pub unpaired: u64,
}

/// The maps and figures of one batch.
#[derive(Clone, Debug)]
pub struct BatchSide {
    pub title: String,
    /// The values by cell index; NaN where nothing can burn, and in maps of means where nothing did.
    pub values: Vec<f64>,
    pub losses: Losses,
}

/// Means over runs, or over pairs: burned cells, the same in hectares, burned bushes, and those that nobody
/// extinguished.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Losses {
    pub burned_cells: RunMean,
    pub burned_ha: RunMean,
    pub burned_bushes: RunMean,
    pub lost_bushes: RunMean,
}

/// A mean over runs, or over pairs, with its 95 % interval, limited to the range from 0 to everything that can burn.
#[derive(Clone, Copy, Debug)]
pub struct RunMean {
    pub mean: f64,
    pub interval: Option<Interval>,
}

impl RunMean {
    fn new(numbers: &[f64], max: f64) -> Self {
        let series = Series::from_values(numbers);
        Self { mean: series.mean().expect("there is a run"), interval: series.mean_interval_within((0.0, max)) }
    }

    /// Returns the same in another unit.
    fn scaled(self, unit: f64) -> Self {
        let interval = self.interval.map(|Interval { low, high }| Interval { low: low * unit, high: high * unit });
        Self { mean: self.mean * unit, interval }
    }

    /// Estimates the mean over pairs of runs of differences that count in this unit.
    fn of_pairs(differences: &[f64], unit: f64) -> Self {
        let scaled: Vec<f64> = differences.iter().map(|number| number * unit).collect();
        let MeanEstimate { mean, interval, .. } =
            estimate_mean(&scaled, &mut rng::stream(SEED, "maps")).expect("there is a pair");
        Self { mean, interval }
    }
}

impl Serialize for RunMean {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let [low, high] = Interval::ends(self.interval);
        object!(Mean { mean: self.mean, low, high }).serialize(serializer)
    }
}

/// The first batch minus the second, paired by seed.
#[derive(Clone, Debug)]
pub struct MapDifference {
    /// By cell index, as the values of sides; means and 95 % intervals. Intervals of probabilities are adjusted Wald ones
    /// (Bonett and Price, 2012, as everywhere in comparisons: for shares near 0 and 1 and few pairs it holds its 95 %
    /// where the plain one does not), those of means Student's t over the pairs in which both burned.
    pub mean: Vec<f64>,
    pub lower: Vec<f64>,
    pub upper: Vec<f64>,
    pub losses: Losses,
}

/// The map of one run.
struct RunMap {
    setting: Setting,
    arrival_s: Vec<f64>,
    /// Empty unless it is asked for.
    intensity: Vec<f64>,
    counts: RunCounts,
    is_recorded: bool,
}

/// Runs between two additions, per thread.
const RUNS_PER_ROUND: usize = 2;

/// Every estimate draws from the streams of this seed: the same runs give the same figures.
const SEED: u64 = 1;

/// Reads all runs of one batch, or all pairs of two, and adds them up. `on_run` is called from the threads after each run, in any
/// order.
///
/// # Errors
/// If batches are on different fields or have no seed in common, if a run has no intensity and that is asked for, if a
/// recording cannot be read or is of another run, or if no run took place.
pub fn map_batches(
    batch: &MapSource,
    minus: Option<&MapSource>,
    options: &MapsOptions<'_>,
    on_run: impl Fn() + Sync,
) -> Result<BatchMaps, MapsError> {
    let jobs = options.jobs;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build();
    let pool = pool.map_err(|error| BatchError::NoWorkers { jobs, reason: error.to_string() })?;
    let sources: Vec<&MapSource> = [Some(batch), minus].into_iter().flatten().collect();
    let selection::RunGroups { groups, unpaired } = selection::groups(&sources)?;
    let mut sums: Option<Sums> = None;
    let mut not_run = 0;
    // In rounds, as the maps of all runs of a large batch would not fit into memory.
    for round in groups.chunks(RUNS_PER_ROUND * jobs) {
        let maps: Vec<_> = pool.install(|| {
            // A run is a job by itself, as making one again takes far longer than reading a recording.
            let maps = round.par_iter().with_max_len(1).map(|group| {
                let maps = sources.iter().zip(group).map(|(source, run)| {
                    let map = read_run(source, run, options);
                    on_run();
                    map
                });
                maps.collect::<Result<Option<Vec<RunMap>>, MapsError>>()
            });
            maps.collect()
        });
        for (maps, group) in maps.into_iter().zip(round) {
            let Some(maps) = maps? else {
                // A pair with one failed run is left out as a whole, or the sides would be of different seeds.
                not_run += 1;
                continue;
            };
            let sums = sums.get_or_insert_with(|| Sums::new(&maps[0].setting, sources.len(), options.quantity));
            sums.add(&maps, group, &sources)?;
        }
    }
    let sums = sums.ok_or(MapsError::NoRuns)?;
    Ok(sums.finish(&sources, not_run, unpaired))
}

/// Reads a run and the cells of the map; `None` if it could not take place.
fn read_run(source: &MapSource, run: &PlannedRun<'_>, options: &MapsOptions<'_>) -> Result<Option<RunMap>, MapsError> {
    let Some((timeline, is_recorded)) = source.timeline(run, options.registry)? else { return Ok(None) };
    let map = RunMap::new(timeline, is_recorded, options.quantity);
    map.map(Some).ok_or_else(|| MapsError::NoIntensity { run: source.batch().name_of(run) })
}

impl RunMap {
    /// `None` if the run has no intensities, and these are asked for.
    fn new(timeline: Timeline, is_recorded: bool, quantity: BatchQuantity) -> Option<Self> {
        let map = BurnMap::new(&timeline);
        let intensity = match quantity {
            BatchQuantity::MeanIntensity => map.behavior()?.intensity_kw_m,
            BatchQuantity::FlameClass(class) => {
                map.behavior()?.flame_length_m.iter().map(|&flame_m| is_of_class(flame_m, class)).collect()
            }
            _ => Vec::new(),
        };
        let counts = RunCounts::new(&map);
        Some(Self { arrival_s: map.arrival_s(), intensity, counts, is_recorded, setting: timeline.setting })
    }

    fn values(&self, quantity: BatchQuantity) -> &[f64] {
        match quantity {
            BatchQuantity::MeanIntensity | BatchQuantity::FlameClass(_) => &self.intensity,
            _ => &self.arrival_s,
        }
    }
}

/// All runs so far.
struct Sums {
    quantity: BatchQuantity,
    setting: Setting,
    can_burn: Vec<bool>,
    is_same_ground: bool,
    sides: Vec<SideSums>,
    pairs: Option<PairSums>,
    runs: u64,
    recorded: u64,
    simulated: u64,
    /// The most bushes of a field.
    max_bushes: usize,
}

impl Sums {
    fn new(setting: &Setting, sides: usize, quantity: BatchQuantity) -> Self {
        let cells = setting.frame.cell_count();
        Self {
            quantity,
            setting: setting.clone(),
            can_burn: vec![false; cells],
            is_same_ground: true,
            sides: (0..sides).map(|_| SideSums::new(cells)).collect(),
            pairs: (sides == 2).then(|| PairSums::new(cells, quantity)),
            runs: 0,
            recorded: 0,
            simulated: 0,
            max_bushes: 0,
        }
    }

    /// Adds the runs of one seed, one of each side.
    fn add(&mut self, maps: &[RunMap], group: &[PlannedRun<'_>], sources: &[&MapSource]) -> Result<(), MapsError> {
        // Values are added by cell index, which is another place on a field of another size.
        for ((map, run), source) in maps.iter().zip(group).zip(sources) {
            if map.setting.frame != self.setting.frame {
                let other = map.setting.frame;
                let first = self.setting.frame;
                return Err(MapsError::OtherField { run: source.batch().name_of(run), other, first });
            }
        }
        if let ([first, second], [run, _]) = (maps, group)
            // Two runs of one seed on different ground are no pair, since their difference is also that of the ground.
            && (first.setting.bushes != second.setting.bushes || !has_same_ground(&first.setting, &second.setting))
        {
            return Err(MapsError::OtherGround { seed: run.seed });
        }
        let setting = &maps[0].setting;
        self.max_bushes = self.max_bushes.max(setting.bushes.len());
        let mut can_burn: Vec<bool> =
            (0..self.can_burn.len()).map(|index| setting.is_ground(setting.frame.cell(index))).collect();
        setting.bushes.iter().for_each(|&bush| can_burn[setting.frame.index(bush)] = true);
        // Bushes alone are on other cells with every seed.
        let is_comparable = self.runs > 0 && setting.spread.is_some();
        self.is_same_ground = self.is_same_ground && (!is_comparable || can_burn == self.can_burn);
        // A cell that can burn with some seeds belongs to the map, with the probability over all of them.
        self.can_burn.iter_mut().zip(can_burn).for_each(|(so_far, now)| *so_far = *so_far || now);
        for (side, map) in self.sides.iter_mut().zip(maps) {
            side.add(map.values(self.quantity), map.counts);
        }
        if let (Some(pairs), [first, second]) = (&mut self.pairs, maps) {
            pairs.add(first.values(self.quantity), second.values(self.quantity));
        }
        self.runs += 1;
        let recorded = maps.iter().filter(|map| map.is_recorded).count() as u64;
        self.recorded += recorded;
        self.simulated += maps.len() as u64 - recorded;
        Ok(())
    }

    fn finish(self, sources: &[&MapSource], not_run: u64, unpaired: u64) -> BatchMaps {
        let Self { quantity, setting, can_burn, is_same_ground, sides, pairs, runs, recorded, simulated, .. } = self;
        // All cells and all bushes bound the intervals: no run burns more than there is.
        let [all_cells, all_bushes] =
            [can_burn.iter().filter(|can_burn| **can_burn).count(), self.max_bushes].map(|count| count as f64);
        let hectares = setting.frame.cell_m * setting.frame.cell_m / 10_000.0;
        let difference = pairs.map(|pairs| {
            let [mean, lower, upper] = pairs.finish(&can_burn);
            let less = |of: fn(&RunCounts) -> f64| {
                // Pairs come from the same groups, so both lists are in the same order.
                let pairs = sides[0].runs.iter().zip(&sides[1].runs);
                pairs.map(|(first, second)| of(first) - of(second)).collect::<Vec<f64>>()
            };
            let cells = less(|run| run.cells);
            let losses = Losses {
                burned_cells: RunMean::of_pairs(&cells, 1.0),
                burned_ha: RunMean::of_pairs(&cells, hectares),
                burned_bushes: RunMean::of_pairs(&less(|run| run.bushes), 1.0),
                lost_bushes: RunMean::of_pairs(&less(|run| run.lost), 1.0),
            };
            MapDifference { mean, lower, upper, losses }
        });
        let sides = sides.into_iter().zip(sources).map(|(side, source)| {
            let of_runs = |of: fn(&RunCounts) -> f64| side.runs.iter().map(of).collect::<Vec<f64>>();
            let burned_cells = RunMean::new(&of_runs(|run| run.cells), all_cells);
            let losses = Losses {
                burned_cells,
                burned_ha: burned_cells.scaled(hectares),
                burned_bushes: RunMean::new(&of_runs(|run| run.bushes), all_bushes),
                lost_bushes: RunMean::new(&of_runs(|run| run.lost), all_bushes),
            };
            BatchSide { title: source.title(), losses, values: side.finish(quantity, &can_burn) }
        });
        let sides = sides.collect();
        BatchMaps { setting, can_burn, is_same_ground, sides, difference, runs, recorded, simulated, not_run, unpaired }
    }
}

/// Returns whether fire would find the same fuel on all cells.
fn has_same_ground(first: &Setting, second: &Setting) -> bool {
    let [first, second] =
        [first, second].map(|setting| setting.spread.as_ref().map(|spread| spread.landscape().fuel.clone()));
    first == second
}
