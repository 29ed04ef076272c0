//! States of obstacles over time, from `states.parquet`.

use std::fs::File;
use std::io::ErrorKind;
use std::mem;
use std::path::Path;

use super::quantities::STATES;
use crate::execute::{STATE_STEPS, STATES_PARQUET};
use crate::plan::BatchPlan;
use crate::stats::quantile;
use crate::table::{FinishedError, ParquetReader, RowGroup};
use wildfire_picture::charts::Estimate;

/// The quantiles of the runs that limit a band.
pub const BAND: [f64; 2] = [0.1, 0.9];

/// For each of [`STATES`] its share of the obstacles at points of time in seconds: means, and the middle 80 % of runs.
#[derive(Debug, Default)]
pub struct StateCurves(pub [Vec<(f64, Estimate)>; STATES.len()]);

impl StateCurves {
    /// Returns whether some run of the variant is done.
    pub fn is_there(&self) -> bool {
        self.0[0].len() > 1
    }

    /// Reads the curves of each variant; `None` if the folder has no such file.
    pub fn read(folder: &Path, plan: &BatchPlan) -> Result<Option<Vec<Self>>, FinishedError> {
        let path = folder.join(STATES_PARQUET);
        let file = match File::open(&path) {
            Ok(file) => file,
            Err(source) if source.kind() == ErrorKind::NotFound => return Ok(None),
            Err(source) => return Err(FinishedError::Unreadable { path, source }),
        };
        let curves = ParquetReader::read(file, |file| read_all(file, plan));
        curves.map(Some).map_err(|reason| FinishedError::Damaged { path, reason })
    }
}

fn read_all(file: &ParquetReader, plan: &BatchPlan) -> Result<Vec<StateCurves>, String> {
    let mut curves = Vec::new();
    let mut counts = Counts::default();
    for group in file.groups() {
        for row in rows_of(&group?)? {
            // The file may have been written by another program, so its run numbers are not trusted.
            let place = (1..=plan.count()).contains(&row.run).then(|| plan.place(row.run));
            let variant = place.map_or(plan.variants.len(), |place| place.variant);
            // Variants without a finished run have no rows, and still need their place.
            while curves.len() < variant.min(plan.variants.len()) {
                curves.push(mem::take(&mut counts).curves());
            }
            if curves.len() != variant || variant >= plan.variants.len() {
                return Err(format!("run {} is not expected there", row.run));
            }
            counts.add(&row)?;
        }
    }
    while curves.len() < plan.variants.len() {
        curves.push(mem::take(&mut counts).curves());
    }
    Ok(curves)
}

/// The obstacles of a run at one time.
struct StateRow {
    run: u64,
    t_s: f64,
    /// The share of each state.
    shares: [f64; STATES.len()],
}

fn rows_of(group: &RowGroup<'_>) -> Result<Vec<StateRow>, String> {
    let runs = group.counts("run")?;
    let times = group.numbers("t_s")?;
    let states = STATES.iter().map(|state| group.counts(&state.name)).collect::<Result<Vec<_>, _>>()?;
    let rows = runs.iter().zip(&times).enumerate().map(|(index, (&run, &t_s))| {
        let counts: [f64; STATES.len()] = std::array::from_fn(|state| states[state][index] as f64);
        let all: f64 = counts.iter().sum();
        let shares = counts.map(|count| if all > 0.0 { count / all } else { 0.0 });
        if run == 0 { Err("runs are numbered from 1".into()) } else { Ok(StateRow { run, t_s, shares }) }
    });
    rows.collect()
}

/// Shares in the runs of a variant, by points of time.
#[derive(Default)]
struct Counts {
    run: u64,
    step: usize,
    times_s: Vec<f64>,
    shares: Vec<[Vec<f64>; STATES.len()]>,
}

impl Counts {
    fn add(&mut self, row: &StateRow) -> Result<(), String> {
        self.step = if self.run == row.run { self.step + 1 } else { 0 };
        self.run = row.run;
        if self.step as u64 > STATE_STEPS {
            return Err(format!("run {} has more than {} times", row.run, STATE_STEPS + 1));
        }
        if self.times_s.len() == self.step {
            self.times_s.push(row.t_s);
            self.shares.push(Default::default());
        }
        // Runs of one variant are counted at the same times; a mean over other times would mean nothing.
        if self.times_s[self.step] != row.t_s || self.step > 0 && self.times_s[self.step - 1] >= row.t_s {
            return Err(format!("run {} has {} s where another time is expected", row.run, row.t_s));
        }
        self.shares[self.step].iter_mut().zip(row.shares).for_each(|(all, share)| all.push(share));
        Ok(())
    }

    fn curves(self) -> StateCurves {
        let mut curves = StateCurves::default();
        for (t_s, shares) in self.times_s.into_iter().zip(self.shares) {
            for (curve, shares) in curves.0.iter_mut().zip(shares) {
                curve.push((t_s, estimate(shares)));
            }
        }
        curves
    }
}

fn estimate(mut shares: Vec<f64>) -> Estimate {
    let value = shares.iter().sum::<f64>() / shares.len() as f64;
    shares.sort_by(f64::total_cmp);
    let [low, high] = BAND.map(|share| quantile(&shares, share));
    Estimate { value, interval: low.zip(high) }
}
