//! Additional questions of a comparison: the number of seeds that a difference needs, and equivalence within a margin.
//!
//! Both are about the independent differences that the comparison itself is of, one for each seed, and both take
//! Student's t for all metrics: see [`crate::stats::paired_power`] and [`Equivalence`]. For answers yes or no, whose
//! differences are -1, 0 and 1, that is an approximation. P-values are not adjusted for several tests.

use std::str::FromStr;

use crate::comparison::{Comparison, ComparisonError, Contrast};
use crate::stats::{Equivalence, detectable_effect, paired_power, pairs_for_power};
use crate::table::Unit;
use wildfire_base::document::number::short;

/// A positive difference given by the user.
#[derive(Clone, Debug, PartialEq)]
pub struct Amount {
    /// As it was written.
    text: String,
    /// In the unit of files.
    value: f64,
    /// `None` for a number without a unit, which is in the unit of each metric.
    unit: Option<Unit>,
}

/// The units that an amount can have, and their factors to those of files.
const UNITS: [(&str, Unit, f64); 14] = [
    ("", Unit::None, 1.0),
    ("cells", Unit::Cells, 1.0),
    ("cell", Unit::Cells, 1.0),
    ("ha", Unit::Hectares, 1.0),
    ("%", Unit::Share, 0.01),
    ("s", Unit::Seconds, 1.0),
    ("ms", Unit::Seconds, 1e-3),
    ("min", Unit::Seconds, 60.0),
    ("cells s", Unit::CellSeconds, 1.0),
    ("cell s", Unit::CellSeconds, 1.0),
    ("m", Unit::Metres, 1.0),
    ("km", Unit::Metres, 1e3),
    ("points", Unit::Points, 1.0),
    ("point", Unit::Points, 1.0),
];

impl FromStr for Amount {
    type Err = String;

    /// Reads a number and a unit, such as `1`, `5 ms` or `2%`.
    fn from_str(text: &str) -> Result<Self, String> {
        let trimmed = text.trim();
        // Signs are part of the number so that `-1` is refused as a number and not as an unknown unit.
        let end = trimmed.find(|letter: char| !(letter.is_ascii_digit() || "+-.".contains(letter)));
        let (number, symbol) = trimmed.split_at(end.unwrap_or(trimmed.len()));
        let expected = "expected a number above 0, and a unit or none: 1, 5 ms, 2 %, 0.5 m";
        let value: f64 = number.parse().map_err(|_| expected)?;
        let found = UNITS.into_iter().find(|(found, ..)| *found == symbol.trim());
        let (_, unit, factor) = found.ok_or_else(|| {
            format!(
                "there is no unit `{}`; expected none, or cells, ha, %, ms, s, min, cells s, m, km or points",
                symbol.trim()
            )
        })?;
        // The upper bound also excludes infinity, which parses as a number.
        if !(value > 0.0 && value <= 1e12) {
            return Err(expected.to_owned());
        }
        Ok(Self {
            text: trimmed.to_owned(),
            value: value * factor,
            unit: Some(unit).filter(|&unit| unit != Unit::None),
        })
    }
}

impl Amount {
    /// Returns the difference in the unit of a metric's numbers; `None` if the amount is of another unit, or beyond all
    /// shares.
    fn of(&self, metric_unit: Unit) -> Option<f64> {
        // Two seconds are the same, whatever took them.
        let is_of_metric = self.unit.is_none_or(|unit| unit.symbol() == metric_unit.symbol());
        let is_possible = metric_unit != Unit::Share || self.value < 1.0;
        (is_of_metric && is_possible).then_some(self.value)
    }
}

/// Questions about all metrics in addition to their differences.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Questions {
    /// The difference for which the number of seeds is computed.
    pub power: Option<Amount>,
    /// The margin of the tests of equivalence.
    pub equivalent: Option<Amount>,
}

/// The power of a number of seeds to detect a difference, by the paired t-test, two-sided at 5 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerAnswer {
    /// The difference, in the unit of the metric.
    pub difference: f64,
    /// The probability that the seeds at hand detect it.
    pub power: f64,
    /// The number of seeds that detect it with a probability of [`POWER`](crate::stats::POWER); `None` if it is beyond
    /// a thousand million.
    pub seeds_needed: Option<u64>,
    /// The smallest difference that the seeds at hand detect with that probability.
    pub detectable: f64,
}

impl PowerAnswer {
    /// `None` where differences have no spread, from which the power follows.
    fn new(contrast: &Contrast, difference: f64) -> Option<Self> {
        let seeds = contrast.seeds as u64;
        let spread = contrast.spread.filter(|&spread| spread > 0.0)?;
        let effect = difference / spread;
        Some(Self {
            difference,
            power: paired_power(effect, seeds)?,
            seeds_needed: pairs_for_power(effect),
            detectable: spread * detectable_effect(seeds)?,
        })
    }
}

impl Comparison {
    /// Answers the questions for every metric to which they apply.
    ///
    /// # Errors
    /// If an amount has a unit that no metric has.
    pub fn asking(mut self, questions: Questions) -> Result<Self, ComparisonError> {
        let option =
            questions.power.as_ref().map(|_| "--power").or(questions.equivalent.as_ref().map(|_| "--equivalent"));
        // Power and equivalence assume a number of seeds that was fixed before the runs.
        if let Some(option) = option.filter(|_| self.is_of_stopped_runs()) {
            return Err(ComparisonError::StoppedByRule { option });
        }
        let metrics = || self.against_a.iter().flat_map(|against| &against.judged);
        for (option, amount) in [("--power", &questions.power), ("--equivalent", &questions.equivalent)] {
            let Some(amount) = amount else { continue };
            // A unit that no metric has is a slip of the keyboard; without this error the columns would be dashes only.
            if metrics().next().is_some() && !metrics().any(|it| amount.of(it.contrast.metric.about.unit).is_some()) {
                let mut units: Vec<String> = metrics()
                    .map(|judged| &judged.contrast.metric)
                    .map(|metric| match metric.about.unit {
                        Unit::Share => format!("{}: below 100 %", metric.name),
                        Unit::None => format!("{}: no unit", metric.name),
                        unit => format!("{}: {}", metric.name, unit.symbol()),
                    })
                    .collect();
                units.sort();
                units.dedup();
                return Err(ComparisonError::NoSuchUnit { option, amount: amount.text.clone(), units });
            }
        }
        for judged in self.against_a.iter_mut().flat_map(|against| &mut against.judged) {
            let contrast = &judged.contrast;
            // Metrics of another unit are left unanswered, as one amount cannot be a margin for metres and for seconds.
            let amount = |requested: &Option<Amount>| requested.as_ref()?.of(contrast.metric.about.unit);
            judged.power = amount(&questions.power).and_then(|size| PowerAnswer::new(contrast, size));
            judged.equivalence = amount(&questions.equivalent).and_then(|margin| {
                Equivalence::new(contrast.difference, contrast.spread?, contrast.seeds as u64, margin)
            });
        }
        Ok(Self { questions, ..self })
    }
}

/// Formats a difference in the unit of a metric: `1 cell`, `5 ms`, `2 %`.
pub fn amount_text(value: f64, unit: Unit) -> String {
    match unit {
        Unit::Share => format!("{} %", short(100.0 * value)),
        Unit::CpuSeconds | Unit::WallSeconds => format!("{} ms", short(1e3 * value)),
        Unit::Cells if value == 1.0 => "1 cell".into(),
        Unit::Points if value == 1.0 => "1 point".into(),
        unit if unit.symbol().is_empty() => short(value),
        unit => format!("{} {}", short(value), unit.symbol()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn amount(text: &str) -> Amount {
        text.parse().expect("it is an amount")
    }

    #[test]
    fn amounts_are_in_the_unit_of_files_and_go_with_metrics_of_that_unit() {
        assert_eq!(amount("1").of(Unit::Cells), Some(1.0));
        assert_eq!(amount(" 0.5 ").of(Unit::Seconds), Some(0.5));
        assert_eq!(amount("5 ms").of(Unit::CpuSeconds), Some(0.005));
        assert_eq!(amount("2min").of(Unit::Seconds), Some(120.0));
        assert_eq!(amount("2 %").of(Unit::Share), Some(0.02));
        assert_eq!(amount("3 km").of(Unit::Metres), Some(3000.0));
        assert_eq!(amount("10 cells s").of(Unit::CellSeconds), Some(10.0));
        assert_eq!([amount("1 m").of(Unit::Cells), amount("1 cell").of(Unit::CellSeconds)], [None, None]);
        assert_eq!([amount("1").of(Unit::Share), amount("100 %").of(Unit::Share)], [None, None], "beyond all shares");
    }

    #[test]
    fn amounts_that_mean_nothing_are_refused() {
        for text in ["", "0", "-1", "one", "1e3", "1e", "nan", "inf", "1 1", "m", "5 parsecs", "1..2"] {
            let refusal = text.parse::<Amount>().expect_err(text);
            assert!(refusal.contains("expected"), "{text}: {refusal}");
        }
    }
}
