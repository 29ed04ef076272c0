//! Batches, or parts of one, in pairs by seed.

use std::borrow::Cow;
use std::path::PathBuf;

use pyo3::prelude::*;
use pyo3::types::PyTuple;
use wildfire::batch::comparison::{Selection, compare as library_compare};
use wildfire::batch::{FileColumn, Kind, Unit};

use crate::batch::{Batch, OneOrMore};
use crate::columns::TableBuilder;
use crate::errors::error;

/// A column that divides a batch, or such a column with the values that are compared.
#[derive(FromPyObject)]
pub enum By {
    Column(String),
    Values(String, Vec<String>),
}

/// Compares batches, or the parts of one, in pairs by seed.
///
/// Parameters
/// ----------
/// batches : Batch or path
///     Each is compared with the first; of a single one, its parts are compared.
/// by : str, or (str, sequence of str)
///     The column that divides runs: scenario, planner or a swept key; and its values, if not all.
/// where : sequence of (str, str)
///     Take only runs with these values in these columns.
/// metric : str or sequence of str
///     Columns of numbers in ``runs.csv``, and ``saved``, ``burned``, ``truck_won``, ``wumpus_won``; the usual ones if it
///     is left out.
///
/// Returns
/// -------
/// Columns
///     A row a metric and side: means, their difference with a 95 % interval, p-values, and the verdict in words.
///
/// Raises
/// ------
/// WildfireError
///     Something cannot be read, or does not go together.
#[pyfunction]
#[pyo3(signature = (*batches, by = None, r#where = None, metric = None))]
pub fn compare<'py>(
    py: Python<'py>,
    batches: &Bound<'py, PyTuple>,
    by: Option<By>,
    r#where: Option<Vec<(String, String)>>,
    metric: Option<OneOrMore<String>>,
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
    let comparison = py.detach(|| library_compare(&paths, &selection, &metrics)).map_err(error)?;
    let mut table = TableBuilder::new(columns());
    let description = |letter| {
        let side = comparison.sides.iter().find(|side| side.letter == letter);
        side.map(|side| side.description.clone())
    };
    let description_a = description('A');
    for against in &comparison.against_a {
        let words = description(against.letter);
        for judged in &against.judged {
            let contrast = &judged.contrast;
            table.push([
                against.letter.to_string().into(),
                words.clone().into(),
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
            ]);
        }
    }
    table.finish(py)
}

fn columns() -> Vec<FileColumn> {
    let column = |(name, kind, words): (&'static str, Kind, &'static str)| FileColumn {
        name: Cow::Borrowed(name),
        words: Cow::Borrowed(words),
        unit: Unit::None,
        kind,
        is_required: false,
    };
    [
        ("side", Kind::Text, "the side that is compared with A"),
        ("description", Kind::Text, "which runs these are"),
        ("description_a", Kind::Text, "which runs side A is"),
        ("metric", Kind::Text, "what is compared"),
        ("pairs", Kind::Count, "pairs of runs that have it on both sides"),
        ("mean_a", Kind::Real, "mean of side A over the pairs"),
        ("mean", Kind::Real, "mean of the other side"),
        ("difference", Kind::Real, "the other side's mean less A's"),
        ("low", Kind::Real, "lower end of the 95 % interval of the difference"),
        ("high", Kind::Real, "upper end of the 95 % interval of the difference"),
        ("p_value", Kind::Real, "probability of such a difference by chance"),
        ("p_adjusted", Kind::Real, "the same by Holm's method over all that is compared"),
        ("cohens_dz", Kind::Real, "difference in standard deviations of the difference"),
        ("method", Kind::Text, "method behind the interval"),
        ("p_method", Kind::Text, "method behind the p-value"),
        ("verdict", Kind::Text, "difference, no-evidence, no-evidence-among-several-tests or equal"),
        ("sentence", Kind::Text, "the verdict in words"),
    ]
    .map(column)
    .into()
}
