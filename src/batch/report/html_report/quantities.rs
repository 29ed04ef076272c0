//! The columns of runs that a report shows, and how.

use super::ReportError;
use super::words;
use crate::batch::table::{RUN_COLUMNS, RunColumn, RunRecord, Unit, is_measured, run_column};
use crate::picture::charts::{Language, Words};
use crate::scenario::nearest_name;
use crate::untrusted::visible_start;

const OBSTACLES: usize = run_column("obstacles");

/// A number of every run that is done: that of a column, in the unit in which charts show it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Quantity(usize);

/// The ends of a run.
pub static STATES: [Quantity; 4] =
    [quantity("intact"), quantity("burning"), quantity("burned_out"), quantity("extinguished")];

/// The parts of the planners' CPU time.
pub static CPU_PARTS: [Quantity; 7] = [
    quantity("cpu_clearance_field_s"),
    quantity("cpu_sampling_s"),
    quantity("cpu_map_generation_s"),
    quantity("cpu_roadmap_search_s"),
    quantity("cpu_local_search_s"),
    quantity("cpu_reachability_s"),
    quantity("cpu_wumpus_s"),
];

/// Further quantities that differ from run to run.
pub static MEASURES: [Quantity; 4] = [
    quantity("mean_response_s"),
    quantity("truck_distance_m"),
    quantity("truck_stuck_s"),
    quantity("cpu_unimog_total_s"),
];

const fn quantity(column: &str) -> Quantity {
    Quantity(run_column(column))
}

/// Which quantities the charts of a report show, and in which language.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartChoice {
    pub quantities: ChosenQuantities,
    pub language: Language,
}

/// The quantities that a report shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChosenQuantities {
    /// Those that were asked for, each once; none for the usual ones.
    asked: Vec<Quantity>,
}

impl ChosenQuantities {
    /// Finds the columns of these names; without any the usual ones are shown.
    ///
    /// # Errors
    /// If there is no such column, or it holds no numbers.
    pub fn new(names: &[String]) -> Result<Self, ReportError> {
        let mut asked = Vec::new();
        for name in names {
            let quantity = Quantity(column_of_numbers(name)?);
            if !asked.contains(&quantity) {
                asked.push(quantity);
            }
        }
        Ok(Self { asked })
    }

    /// Returns the places of those that were asked for, among [`RUN_COLUMNS`].
    pub fn places(&self) -> Vec<usize> {
        self.asked.iter().map(|quantity| quantity.0).collect()
    }

    /// Returns those that were asked for.
    pub fn asked(&self) -> &[Quantity] {
        &self.asked
    }

    /// Returns those of some quantities that are shown, in their order.
    pub fn among(&self, quantities: &[Quantity]) -> Vec<Quantity> {
        let is_shown = |quantity: &Quantity| self.asked.is_empty() || self.asked.contains(quantity);
        quantities.iter().copied().filter(is_shown).collect()
    }

    /// Returns those whose distributions, and means over what is swept, are shown.
    pub fn of_runs(&self) -> Vec<Quantity> {
        let usual = || STATES.iter().chain(&MEASURES).copied().collect();
        if self.asked.is_empty() { usual() } else { self.asked.clone() }
    }

    /// Returns everything that is kept of a run.
    pub fn kept(&self) -> Vec<Quantity> {
        let usual = || STATES.iter().chain(&CPU_PARTS).chain(&MEASURES).copied().collect();
        if self.asked.is_empty() { usual() } else { self.asked.clone() }
    }
}

fn column_of_numbers(name: &str) -> Result<usize, ReportError> {
    let names = || RUN_COLUMNS.iter().filter(|column| column.holds_numbers()).map(|column| column.name);
    match RUN_COLUMNS.iter().position(|column| column.name == name) {
        Some(place) if RUN_COLUMNS[place].holds_numbers() => Ok(place),
        Some(_) => Err(ReportError::NoNumbers { name: name.to_owned() }),
        None => Err(ReportError::UnknownColumn { name: visible_start(name), nearest: nearest_name(name, names()) }),
    }
}

impl Quantity {
    fn about(self) -> &'static RunColumn {
        &RUN_COLUMNS[self.0]
    }

    pub fn column(self) -> &'static str {
        self.about().name
    }

    pub fn label(self, language: Language) -> &'static str {
        words::name_of(self.about(), language)
    }

    /// Returns its name outside of a chart of several.
    pub fn title(self, language: Language) -> String {
        match self.is_state() {
            true => words::AT_THE_END_OF_A_RUN.filled(language, &[self.label(language)]),
            false => self.label(language).into(),
        }
    }

    fn is_state(self) -> bool {
        STATES.contains(&self)
    }

    /// Returns the number of a run; `None` where the run has none. States are shown as shares of all obstacles, CPU times
    /// in milliseconds.
    pub fn number(self, run: &RunRecord) -> Option<f64> {
        let number = run.number(self.0)?;
        match self.about().unit {
            Unit::Cells if self.is_state() => {
                Some(number / run.number(OBSTACLES).filter(|&obstacles| obstacles > 0.0)?)
            }
            Unit::Seconds if is_measured(self.column()) => Some(number * 1e3),
            _ => Some(number),
        }
    }

    /// Returns what an axis is called that shows it.
    pub fn axis(self) -> Words {
        match self.about().unit {
            Unit::Cells if self.is_state() => words::SHARE_OF_OBSTACLES,
            Unit::Cells => words::CELLS,
            Unit::Metres => words::METRES,
            Unit::Seconds if is_measured(self.column()) => words::MILLISECONDS,
            Unit::Seconds => words::SECONDS,
            Unit::CellSeconds => words::CELL_SECONDS,
            Unit::Hectares => words::HECTARES,
            Unit::Points => words::POINTS,
            Unit::Share => words::SHARE,
            Unit::None => words::NUMBER,
        }
    }
}
