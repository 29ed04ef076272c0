//! Comparisons of batches, or of parts of one, paired by seed.

use std::borrow::Cow;
use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use wildfire::batch::comparison::{Amount, Questions, Selection, compare as library_compare};
use wildfire::batch::table::{FileColumn, Kind, Unit};

use crate::batch::{Batch, OneOrMore};
use crate::columns::TableBuilder;
use crate::errors::{error, one_of};

/// A column that divides a batch, optionally with the values to compare.
pub enum By {
    Column(String),
    Values(String, Vec<String>),
}

one_of!(By, "a column, or a column with its values", Self::Column, |(column, values)| Self::Values(column, values));

/// A difference: a number, or one with a unit.
pub enum Size {
    Number(f64),
    Text(String),
}

one_of!(Size, "a number, or a text such as '5 s'", Self::Number, Self::Text);

/// Compares batches, or the parts of one, paired by seed.
///
/// Parameters
/// ----------
/// batches : Batch or path
///     Each is compared with the first; for a single one, its parts are compared.
/// by : str, or (str, sequence of str)
///     The column that divides the runs: scenario, planner or a swept key; and the values to compare, if not all.
/// where : sequence of (str, str)
///     Use only runs with these values in these columns.
/// metric : str or sequence of str
///     Numeric columns of ``runs.csv``, and ``saved``, ``burned``, ``truck_won``, ``wumpus_won``; default: the usual ones.
///
/// power : float or str
///     How many seeds detect a difference of this size? A number in the unit of the metrics, or with a unit: ``"5 ms"``.
/// equivalent : float or str
///     Are the sides equal within this margin? As ``power``.
///
/// Returns
/// -------
/// Columns
///     A row per metric and side: means, their difference with a 95 % interval, p-values, the verdict in words, and
///     the answers about power and equivalence, which are missing where they were not asked for.
///
/// Raises
/// ------
/// WildfireError
///     A batch cannot be read, or the batches do not match.
#[pyfunction]
#[pyo3(signature = (*batches, by = None, r#where = None, metric = None, power = None, equivalent = None))]
pub fn compare<'py>(
    py: Python<'py>,
    batches: &Bound<'py, PyTuple>,
    by: Option<By>,
    r#where: Option<Vec<(String, String)>>,
    metric: Option<OneOrMore<String>>,
    power: Option<Size>,
    equivalent: Option<Size>,
) -> PyResult<Bound<'py, PyAny>> {
    let path = |batch: Bound<'_, PyAny>| match batch.cast::<Batch>() {
        Ok(batch) => Ok(batch.get().path().to_owned()),
        Err(_) => batch.extract::<PathBuf>(),
    };
    let paths = batches.iter().map(path).collect::<PyResult<Vec<_>>>()?;
    if paths.is_empty() {
        return Err(error("no batch; expected at least one"));
    }
    let by = by.map(|by| match by {
        By::Column(column) => (column, Vec::new()),
        By::Values(column, values) => (column, values),
    });
    let selection = Selection { by, only: r#where.unwrap_or_default() };
    let metrics = metric.map_or_else(Vec::new, OneOrMore::into_vec);
    let questions = Questions { power: amount("power", power)?, equivalent: amount("equivalent", equivalent)? };
    let compared = py.detach(|| library_compare(&paths, &selection, &metrics)).map_err(error)?;
    let comparison = compared.asking(questions).map_err(error)?;
    let mut table = TableBuilder::new(columns());
    let description = |letter| {
        let side = comparison.sides.iter().find(|side| side.letter == letter);
        side.map(|side| side.description.clone())
    };
    let description_a = description('A');
    for against in &comparison.against_a {
        let label = description(against.letter);
        for judged in &against.judged {
            let contrast = &judged.contrast;
            table.push([
                against.letter.to_string().into(),
                label.clone().into(),
                description_a.clone().into(),
                contrast.metric.name.to_string().into(),
                (contrast.pairs as u64).into(),
                contrast.means[0].into(),
                contrast.means[1].into(),
                contrast.difference.into(),
                contrast.interval.map(|interval| interval.low).into(),
                contrast.interval.map(|interval| interval.high).into(),
                contrast.p_value.into(),
                judged.p_adjusted.into(),
                contrast.effect_dz.into(),
                contrast.method.name().to_owned().into(),
                contrast.p_method.name().to_owned().into(),
                judged.verdict.name().to_owned().into(),
                judged.sentence(against.letter).into(),
                judged.power.map(|answer| answer.power).into(),
                judged.power.and_then(|answer| answer.seeds_needed).into(),
                judged.power.map(|answer| answer.detectable).into(),
                judged.equivalence.map(|found| found.is_equivalent()).into(),
                judged.equivalence.map(|found| found.interval.low).into(),
                judged.equivalence.map(|found| found.interval.high).into(),
                judged.equivalence.map(|found| found.p_value).into(),
            ]);
        }
    }
    table.finish(py)
}

/// Reads the argument of this name.
fn amount(name: &str, size: Option<Size>) -> PyResult<Option<Amount>> {
    let text = size.map(|size| match size {
        Size::Number(number) => number.to_string(),
        Size::Text(words) => words,
    });
    text.map(|text| text.parse().map_err(|reason| error(format!("{name} {text}: {reason}")))).transpose()
}

fn columns() -> Vec<FileColumn> {
    let column = |(name, kind, description): (&'static str, Kind, &'static str)| FileColumn {
        name: Cow::Borrowed(name),
        description: Cow::Borrowed(description),
        unit: Unit::None,
        kind,
        is_required: false,
    };
    [
        ("side", Kind::Text, "the side that is compared with A"),
        ("description", Kind::Text, "runs of this side"),
        ("description_a", Kind::Text, "runs of side A"),
        ("metric", Kind::Text, "the compared metric"),
        ("pairs", Kind::Count, "pairs of runs with a value on both sides"),
        ("mean_a", Kind::Real, "mean of side A over the pairs"),
        ("mean", Kind::Real, "mean of the other side"),
        ("difference", Kind::Real, "the other side's mean minus A's"),
        ("low", Kind::Real, "lower end of the 95 % interval of the difference"),
        ("high", Kind::Real, "upper end of the 95 % interval of the difference"),
        ("p_value", Kind::Real, "probability of such a difference by chance"),
        ("p_adjusted", Kind::Real, "the p-value adjusted by Holm's method over all comparisons"),
        ("cohens_dz", Kind::Real, "mean difference divided by the standard deviation of the differences"),
        ("method", Kind::Text, "method behind the interval"),
        ("p_method", Kind::Text, "method behind the p-value"),
        ("verdict", Kind::Text, "difference, no-evidence, no-evidence-among-several-tests or equal"),
        ("sentence", Kind::Text, "the verdict in words"),
        ("power", Kind::Real, "probability that these seeds detect the difference asked about"),
        ("seeds_needed", Kind::Count, "seeds that detect it with 80 % power"),
        ("detectable", Kind::Real, "smallest difference that these seeds detect with 80 % power"),
        ("equivalent", Kind::Flag, "whether the sides are equal within the margin, at 5 %"),
        ("equivalence_low", Kind::Real, "lower end of the 90 % interval of the difference"),
        ("equivalence_high", Kind::Real, "upper end of the 90 % interval of the difference"),
        ("equivalence_p", Kind::Real, "p-value of the two one-sided tests"),
    ]
    .map(column)
    .into()
}
