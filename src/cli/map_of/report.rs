//! What is said of a map: how much burned, and how sure that is.

use serde::Serialize;

use wildfire_base::document::number::{count, optional, rounded, two_digits};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::object::Members;
use wildfire_batch::maps::{BatchMaps, BatchQuantity, BatchSide, Losses, RunMean};
use wildfire_batch::stats::Interval;
use wildfire_picture::MapQuantity;
use wildfire_timeline::{BurnMap, Setting};

/// The quantity of a map of one run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunQuantity {
    Arrival,
    Intensity,
    FlameLength,
    Direction,
}

impl RunQuantity {
    pub fn in_picture(self) -> MapQuantity {
        match self {
            Self::Arrival => MapQuantity::ArrivalTime,
            Self::Intensity => MapQuantity::Intensity,
            Self::FlameLength => MapQuantity::FlameLength,
            Self::Direction => MapQuantity::Direction,
        }
    }
}

/// The map of one run in figures; members in their order.
#[derive(Debug, Serialize)]
pub struct RunMapReport {
    run: String,
    seed: u64,
    quantity: &'static str,
    unit: &'static str,
    burned_cells: usize,
    burned_ha: f64,
    burned_bushes: usize,
    bushes: usize,
    /// Burned cells by the kind of fire, where there are trees.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fire_types: Option<Members<&'static str, usize>>,
    /// Cells with a value, and the least, the mean and the greatest of these.
    cells: usize,
    #[serde(rename = "least")]
    min: Option<f64>,
    mean: Option<f64>,
    #[serde(rename = "most")]
    max: Option<f64>,
}

impl RunMapReport {
    pub fn new(run: &str, quantity: RunQuantity, map: &BurnMap<'_>, setting: &Setting, values: &[f64]) -> Self {
        let (name, unit) = match quantity {
            RunQuantity::Arrival => ("arrival", "s"),
            RunQuantity::Intensity => ("fireline intensity", "kW/m"),
            RunQuantity::FlameLength => ("flame length", "m"),
            RunQuantity::Direction => ("direction of spread", "degrees"),
        };
        // Cells that did not burn have no finite value.
        let found: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        let [min, max] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|pick| found.iter().copied().reduce(pick));
        // A mean of directions has no meaning: half way between 350 and 10 degrees is not 180.
        let has_mean = quantity != RunQuantity::Direction && !found.is_empty();
        Self {
            run: run.to_owned(),
            seed: setting.seed,
            quantity: name,
            unit,
            burned_cells: map.burned(),
            burned_ha: map.burned() as f64 * hectares(setting),
            burned_bushes: map.burned_bushes(),
            bushes: setting.bushes.len(),
            fire_types: None,
            cells: found.len(),
            min,
            mean: has_mean.then(|| found.iter().sum::<f64>() / found.len() as f64),
            max,
        }
    }
}

fn hectares(setting: &Setting) -> f64 {
    setting.frame.cell_m * setting.frame.cell_m / 10_000.0
}

/// A number with three digits that count.
fn short(number: f64) -> String {
    let digits = two_digits(number);
    rounded(number, if number.abs() < 100.0 { digits + usize::from(digits < 9) } else { 0 })
}

impl From<&RunMapReport> for Document {
    fn from(report: &RunMapReport) -> Self {
        let mut quantity = report.quantity.to_owned();
        quantity[..1].make_ascii_uppercase();
        let mut lines = vec![format!(
            "Burned: {}, {} ha; {} of {}.",
            count(report.burned_cells, "cell"),
            short(report.burned_ha),
            report.burned_bushes,
            if report.bushes == 1 { "1 bush".to_owned() } else { format!("{} bushes", report.bushes) },
        )];
        if let Some(Members(types)) = &report.fire_types {
            let types: Vec<String> = types.iter().map(|(name, cells)| format!("{cells} by {name} fire")).collect();
            lines.push(format!("Cells: {}.", types.join(", ")));
        }
        if let (Some(min), Some(max)) = (report.min, report.max) {
            let mean = report.mean.map_or(String::new(), |mean| format!(", mean {} {}", short(mean), report.unit));
            lines.push(format!("{quantity}: {} to {} {}{mean}.", short(min), short(max), report.unit));
        }
        let mut document = Self::new(format!("{quantity}: {}, seed {}", report.run, report.seed));
        document.add_list(lines);
        document
    }
}

/// Maps over batches in figures; members in their order.
#[derive(Debug, Serialize)]
pub struct BatchMapReport {
    quantity: &'static str,
    unit: &'static str,
    runs: u64,
    recorded: u64,
    simulated: u64,
    not_run: u64,
    unpaired: u64,
    is_same_ground: bool,
    sides: Vec<SideObject>,
    difference: Option<DifferenceObject>,
}

#[derive(Debug, Serialize)]
struct SideObject {
    batch: String,
    #[serde(flatten)]
    losses: Losses,
    /// Cells with a value above zero, and the greatest value.
    cells: usize,
    #[serde(rename = "most")]
    max: Option<f64>,
}

#[derive(Debug, Serialize)]
struct DifferenceObject {
    #[serde(flatten)]
    losses: Losses,
    /// Cells whose interval lies below zero, and above it.
    cells_below: usize,
    cells_above: usize,
    #[serde(rename = "least")]
    min: Option<f64>,
    #[serde(rename = "most")]
    max: Option<f64>,
}

impl From<&BatchSide> for SideObject {
    fn from(side: &BatchSide) -> Self {
        Self {
            batch: side.title.clone(),
            losses: side.losses,
            cells: side.values.iter().filter(|value| **value > 0.0).count(),
            max: side.values.iter().copied().filter(|value| value.is_finite()).reduce(f64::max),
        }
    }
}

/// The names of the classes of flame lengths.
const FLAME_CLASSES: [&str; 6] = [
    "share of flames up to 0.6 m",
    "share of flames of 0.6 to 1.2 m",
    "share of flames of 1.2 to 1.8 m",
    "share of flames of 1.8 to 2.4 m",
    "share of flames of 2.4 to 3.7 m",
    "share of flames above 3.7 m",
];

impl BatchMapReport {
    pub fn new(quantity: BatchQuantity, maps: &BatchMaps) -> Self {
        let (name, unit) = match quantity {
            BatchQuantity::BurnProbability => ("burn probability", ""),
            BatchQuantity::MeanArrival => ("mean arrival", "s"),
            BatchQuantity::MeanIntensity => ("mean fireline intensity", "kW/m"),
            BatchQuantity::FlameClass(class) => (FLAME_CLASSES[usize::from(class) - 1], ""),
        };
        let difference = maps.difference.as_ref().map(|difference| {
            let found = difference.mean.iter().copied().filter(|mean| mean.is_finite());
            DifferenceObject {
                losses: difference.losses,
                cells_below: difference.upper.iter().filter(|upper| **upper < 0.0).count(),
                // The ends count and not the mean: cells whose interval holds zero may differ by chance.
                cells_above: difference.lower.iter().filter(|lower| **lower > 0.0).count(),
                min: found.clone().reduce(f64::min),
                max: found.reduce(f64::max),
            }
        });
        Self {
            quantity: name,
            unit,
            runs: maps.runs,
            recorded: maps.recorded,
            simulated: maps.simulated,
            not_run: maps.not_run,
            unpaired: maps.unpaired,
            is_same_ground: maps.is_same_ground,
            sides: maps.sides.iter().map(SideObject::from).collect(),
            difference,
        }
    }

    fn sentences(&self) -> Vec<String> {
        let things = if self.difference.is_some() { "pair" } else { "run" };
        let mut lines = vec![format!(
            "{}: {} recorded, {} simulated again from their plan.",
            count(self.runs as usize, things),
            self.recorded,
            self.simulated
        )];
        if self.not_run > 0 {
            lines.push(format!("{} more could not be run.", count(self.not_run as usize, things)));
        }
        if self.unpaired > 0 {
            lines.push(format!(
                "{} without a partner on the other side left out.",
                count(self.unpaired as usize, "seed")
            ));
        }
        if !self.is_same_ground {
            lines.push(
                "Water and roads are not the same in all runs: each cell is a mean over different grounds.".to_owned(),
            );
        }
        let unit = if self.unit.is_empty() { String::new() } else { format!(" {}", self.unit) };
        for side in &self.sides {
            if let Some(max) = side.max {
                let name = &side.batch;
                lines.push(format!(
                    "{name}: {} burned in some run; greatest {}: {}{unit}.",
                    count(side.cells, "cell"),
                    self.quantity,
                    short(max)
                ));
            }
        }
        if let Some(DifferenceObject { cells_below, cells_above, min: Some(min), max: Some(max), .. }) =
            &self.difference
        {
            lines.push(format!("Difference: {} to {}{unit}.", short(*min), short(*max)));
            lines.push(format!(
                "Cells whose 95 % interval does not hold zero: {cells_below} below it, {cells_above} above it."
            ));
        }
        lines
    }
}

impl From<&BatchMapReport> for Document {
    fn from(report: &BatchMapReport) -> Self {
        let mut quantity = report.quantity.to_owned();
        quantity[..1].make_ascii_uppercase();
        let names: Vec<&str> = report.sides.iter().map(|side| side.batch.as_str()).collect();
        let mut document = Self::new(format!("{quantity}: {}", names.join(" minus ")));
        document.add_list(report.sentences());
        let difference = report.difference.as_ref().map(|difference| ("difference", &difference.losses));
        let sides = report.sides.iter().map(|side| (side.batch.as_str(), &side.losses));
        let rows = sides.chain(difference).flat_map(|(name, losses)| loss_rows(name, losses)).collect();
        let table = Table { text_columns: 2, ..Table::new(&["Batch", "", "mean", "95% low", "95% high"], rows) };
        let table =
            table.with_caption("Expected loss: means over runs; lost bushes are burned and nobody put them out");
        document.with([Block::from(table)])
    }
}

/// A row for each mean, with the ends of its interval.
fn loss_rows(name: &str, losses: &Losses) -> [Vec<String>; 4] {
    [
        row(name, "burned cells", losses.burned_cells),
        row("", "burned area, ha", losses.burned_ha),
        row("", "burned bushes", losses.burned_bushes),
        row("", "lost bushes", losses.lost_bushes),
    ]
}

fn row(name: &str, quantity: &str, mean: RunMean) -> Vec<String> {
    let decimals = if mean.mean.abs() < 100.0 { 2 } else { 1 };
    let numbers = Interval::ends(mean.interval).map(|end| optional(end, decimals));
    [vec![name.to_owned(), quantity.to_owned(), rounded(mean.mean, decimals)], numbers.to_vec()].concat()
}
