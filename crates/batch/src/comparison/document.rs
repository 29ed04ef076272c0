//! A comparison as a document.

use crate::comparison::questions::amount_text;
use crate::comparison::{
    Comparison, ComparisonToA, Contrast, CutOff, JudgedContrast, JudgedStrata, Method, Pairs, SideSummary, Verdict,
    p_text,
};
use crate::stats::Interval;
use wildfire_base::document::number::{count, optional, percent, probability, rounded, two_digits};
use wildfire_base::document::{Block, Document, Figure, Table};
use wildfire_base::untrusted::visible_start;
use wildfire_picture::charts::{Estimate, ForestChart, ForestRow, SCREEN_WIDTH, Titles};

const LEGEND: &str = "\
Differences are of means over pairs, with 95 % intervals. Both p, that of the means and that of Wilcoxon's test by \
ranks, are adjusted by Holm's method over all metrics and sides shown. dz is Cohen's: the difference in standard \
deviations of the differences. r is the rank-biserial correlation, from -1 to 1. The bootstrap cannot resolve p below \
0.0005 before adjustment; beyond that p is Student's, as the column `by` shows.";

const STOPPED_LEGEND: &str = "\
Differences are of means over pairs. A rule stopped the runs when enough was known, so the 95 % intervals are those of a \
confidence sequence (Waudby-Smith et al., 2024), which hold at every number of seeds. There are no p-values, since the \
usual ones would not. dz is Cohen's: the difference in standard deviations of the differences.";

const STRATA_LEGEND: &str = "\
With strata all figures are by seed: the differences of a seed are averaged over its strata, which are treated as \
fixed. p strata tests that the difference is the same in all strata, the values it is averaged over: an analysis of \
variance of the differences with a row for each seed, by Greenhouse and Geisser. These p-values are a family of their \
own for Holm's method, and so are those of the strata.";

/// As `cargo bench --bench coverage` measured it, 4000 samples each.
const FEW_PAIRS: &str = "\
Fewer than 10 seeds: intervals are Student's t. For samples of five of this program's own outcomes they contain the \
true value in 93 to 96 % of cases, for strongly skewed (log-normal) numbers in 82 %.";

const POWER_LEGEND: &str = "\
Power: the probability that the paired t-test, two-sided at 5 %, detects this difference, by the noncentral t \
distribution, if the differences vary as here. Seeds for 80 %: the number that detects it with 80 % power; detectable: \
the smallest difference that the seeds at hand detect with 80 % power.";

const EQUIVALENCE_LEGEND: &str = "\
Equivalent: two one-sided t-tests (Schuirmann, 1987) both find at 5 % that the difference lies within the margin on \
either side of zero; then its 90 % interval does too. Otherwise nothing is shown: a difference may be there or not. These \
p-values are not adjusted.";

impl From<&Comparison> for Document {
    /// Says what the sides differ in first, then the verdicts, then the figures behind them.
    fn from(comparison: &Comparison) -> Self {
        let mut document = Self::new("Runs compared in pairs of the same seed");
        document.add_list(comparison.sides.iter().flat_map(|of| [side(of)].into_iter().chain(of.notes())).collect());
        for against in &comparison.against_a {
            let ComparisonToA { letter, settings, pairs, judged } = against;
            document.add(Block::Heading(format!("{letter} against A")));
            document.add_list(settings.lines(*letter, pairs));
            document.add(Block::Text(settings.conclusion(*letter)));
            document.add(Block::Text(pairing(pairs, *letter)));
            // Without a pair of finished runs there are no figures to explain.
            if judged.is_empty() {
                continue;
            }
            document.add_list(judged.iter().map(|judged| verdict(judged, *letter)).collect());
            document.add(forest(against));
            document = document.with([differences(against), tests(against)]).with(strata(against));
            let questions = [power(against, comparison), equivalence(against, comparison)];
            document = document.with(questions.into_iter().flatten());
            document.add_list(notes(against));
        }
        let missing = comparison.missing.iter();
        document.add_list(
            missing.map(|(letter, metric)| format!("{metric}: no seed has a value in both A and {letter}")).collect(),
        );
        // The legends explain figures, of which there are none.
        if comparison.against_a.iter().all(|against| against.judged.is_empty()) {
            return document;
        }
        let legend = if comparison.is_of_stopped_runs() { STOPPED_LEGEND } else { LEGEND };
        document.add(Block::Text(legend.into()));
        if comparison.against_a.iter().any(has_strata) {
            document.add(Block::Text(STRATA_LEGEND.into()));
        }
        if comparison.questions.power.is_some() {
            document.add(Block::Text(POWER_LEGEND.into()));
        }
        if comparison.questions.equivalent.is_some() {
            document.add(Block::Text(EQUIVALENCE_LEGEND.into()));
        }
        let mut contrasts = comparison.against_a.iter().flat_map(|against| &against.judged);
        // Below 10 seeds the bootstrap gives way to Student's t, whose coverage of skewed numbers is the poorer one.
        if contrasts.any(|judged| judged.contrast.seeds < 10) {
            document.add(Block::Text(FEW_PAIRS.into()));
        }
        document
    }
}

fn side(side: &SideSummary) -> String {
    let SideSummary { letter, description, runs, failed, .. } = side;
    let failed = if *failed == 0 { String::new() } else { format!(", {failed} of them failed") };
    format!("{letter}: {description}: {}{failed}", count(*runs, "run"))
}

/// Says how many pairs there are, what was left out, and what the differences are means over.
fn pairing(pairs: &Pairs, letter: char) -> String {
    let runs = pairs.runs.len();
    let mut text = match runs {
        0 => "No pair of runs finished, so that nothing can be compared.".into(),
        1 => "1 pair of runs.".into(),
        _ => format!("{runs} pairs of runs."),
    };
    let [ours, theirs] = pairs.without_partner;
    if ours + theirs > 0 {
        text += &format!(" Left out without a partner: {ours} of A, {theirs} of {letter}.");
    }
    let [only_a, only_other, both] = pairs.failed;
    if only_a + only_other + both > 0 {
        text += &format!(
            " Left out because a run failed: {only_a} in A only, {only_other} in {letter} only, {both} in both"
        );
        // Failures are seldom independent of the outcome, so a mean over the remaining pairs is biased.
        text +=
            if runs == 0 { "." } else { "; if the hard runs are those that failed, these figures are too optimistic." };
    }
    // Without columns there is a single condition, and the sentence above says already that no pair finished.
    if !(pairs.unfinished_strata.is_empty() || pairs.columns.is_empty()) {
        let strata = pairs.strata.len()..pairs.strata.len() + pairs.unfinished_strata.len();
        let conditions: Vec<String> = strata.map(|index| pairs.stratum_text(index)).collect();
        text += &format!(" No pair finished where {}.", conditions.join(" or "));
    }
    if let several @ [_, _, ..] = &pairs.strata[..] {
        let min = several.iter().map(|stratum| stratum.pairs).min().unwrap_or(0);
        let max = several.iter().map(|stratum| stratum.pairs).max().unwrap_or(0);
        let each = if min == max { format!("{min} pairs each") } else { format!("{min} to {max} pairs each") };
        text += &format!(" Every difference is a mean over {}, {each}.", levels(pairs));
    }
    text
}

/// Lists the values of the columns, `field.coverage (0.05, 0.1, 0.2)`; for several with the number of combinations.
fn levels(pairs: &Pairs) -> String {
    /// The most values that are listed; more are counted.
    const MAX: usize = 12;
    let columns = pairs.columns.iter().enumerate().map(|(index, column)| {
        let mut values: Vec<String> = Vec::new();
        for stratum in &pairs.strata {
            let value = visible_start(&stratum.levels[index]);
            // Values stay in the order of the strata; sorted as text, 10 would precede 9.
            if !values.contains(&value) {
                values.push(value);
            }
        }
        let listed = if values.len() > MAX { format!("{} values", values.len()) } else { values.join(", ") };
        format!("{} ({listed})", visible_start(column))
    });
    let columns: Vec<String> = columns.collect();
    match &columns[..] {
        [column] => column.clone(),
        several => format!("{} combinations of {}", pairs.strata.len(), several.join(" and ")),
    }
}

fn has_strata(against: &ComparisonToA) -> bool {
    against.judged.iter().any(|judged| judged.by_stratum.is_some())
}

fn verdict(judged: &JudgedContrast, letter: char) -> String {
    format!("{}: {}", judged.contrast.metric.name, judged.sentence(letter))
}

/// Draws the differences of all metrics. Their units differ, so that each is a share of A's mean.
fn forest(against: &ComparisonToA) -> Block {
    let letter = against.letter;
    let titles = Titles {
        title: format!("{letter} − A, with 95 % intervals"),
        note: "In per cent of A's mean; at the right in the metric's own unit. Filled: evidence of a difference."
            .into(),
        x: format!("{letter} − A (% of A's mean)"),
        y: String::new(),
    };
    let chart = ForestChart { titles, rows: against.judged.iter().map(forest_row).collect() };
    Block::Figure(Figure { svg: chart.draw(SCREEN_WIDTH).to_svg(), file: None, more_files: Vec::new() })
}

/// Row of a metric, its difference as a share of A's mean.
fn forest_row(judged: &JudgedContrast) -> ForestRow {
    let Contrast { metric, means: [mean_a, _], .. } = &judged.contrast;
    let is_different = judged.verdict == Verdict::Difference;
    let row = judged.contrast.forest_row(metric.name.to_string(), decimals(&judged.contrast), is_different);
    let unit = match metric.about.unit.symbol() {
        "" | "1" => String::new(),
        symbol => format!(" {symbol}"),
    };
    // A percentage of a mean of zero is no number; the difference itself is still shown.
    let of_zero = if *mean_a == 0.0 { "; A's mean is 0" } else { "" };
    // The divisor is the size of the mean: by a negative one, a higher value would be drawn as a lower one.
    let percent = |value: f64| 100.0 * value / mean_a.abs();
    ForestRow {
        difference: row.difference.filter(|_| *mean_a != 0.0).map(|Estimate { value, interval }| Estimate {
            value: percent(value),
            interval: interval.map(|(low, high)| (percent(low), percent(high))),
        }),
        text: format!("{}{unit}{of_zero}", row.text),
        ..row
    }
}

fn differences(against: &ComparisonToA) -> Table {
    let letter = against.letter;
    let headings = ["Metric", "Pairs", "A", &letter.to_string(), &format!("{letter} − A"), "95% low", "95% high"];
    let rows = against.judged.iter().map(|judged| {
        let contrast = &judged.contrast;
        let decimals = decimals(contrast);
        let ends = Interval::ends(contrast.interval).map(|end| optional(end, decimals));
        let [ours, theirs] = contrast.means.map(|value| rounded(value, decimals));
        let cells = [contrast.metric.name.to_string(), contrast.pairs.to_string(), ours, theirs];
        cells.into_iter().chain([rounded(contrast.difference, decimals)]).chain(ends).collect()
    });
    Table::new(&headings, rows.collect())
}

fn tests(against: &ComparisonToA) -> Table {
    let has_strata = has_strata(against);
    let rows = against.judged.iter().map(|judged| {
        let contrast = &judged.contrast;
        // Strata have one test for all of them, so the p-value is that of the metric and not of a stratum.
        let of_strata = judged.by_stratum.as_ref().and_then(|strata| strata.p_adjusted);
        let cells = [
            contrast.metric.name.to_string(),
            or_dash(judged.p_adjusted.map(probability)),
            method(contrast.p_method).into(),
            optional(contrast.effect_dz, 2),
            or_dash(judged.ranks_p_adjusted.map(probability)),
            optional(contrast.ranks.map(|ranks| ranks.rank_biserial()), 2),
        ];
        cells.into_iter().chain(has_strata.then(|| or_dash(of_strata.map(probability)))).collect()
    });
    let mut headings = vec!["Metric", "p", "by", "dz", "p by ranks", "r"];
    headings.extend(has_strata.then_some("p strata"));
    Table::new(&headings, rows.collect())
}

fn or_dash(value: Option<String>) -> String {
    value.unwrap_or_else(|| "-".into())
}

/// The strata of every metric in which they say something else than the mean, each with its own verdict.
fn strata(against: &ComparisonToA) -> Vec<Block> {
    let ComparisonToA { letter, pairs, judged, .. } = against;
    // Strata that agree with the mean are left out: a table of all would hide those that do not.
    let blocks = judged.iter().filter_map(|judged| {
        let found = judged.by_stratum.as_ref().filter(|_| judged.varies_by_stratum())?;
        let JudgedStrata { by, strata, p_adjusted, .. } = found;
        let how = match p_adjusted.filter(|_| found.differ()) {
            Some(p) => format!("is not the same in all, {}", p_text(p)),
            None => "is not significant in all".to_owned(),
        };
        let heading = format!("{} by {by}: {letter} − A {how}", judged.contrast.metric.name);
        Some([
            Block::Text(heading),
            Block::List(
                strata
                    .iter()
                    .map(|(stratum, judged)| format!("{}: {}", pairs.stratum_text(*stratum), judged.sentence(*letter)))
                    .collect(),
            ),
        ])
    });
    blocks.flatten().collect()
}

/// A difference with its uncertainty's digits, in the unit of the amounts that people give.
fn sized(value: f64, contrast: &Contrast) -> String {
    let unit = contrast.metric.about.unit;
    let scale: f64 = std::iter::repeat_n(10.0, two_digits(value)).product();
    amount_text((value * scale).round() / scale, unit)
}

/// The power of the seeds at hand, and how many would suffice.
fn power(against: &ComparisonToA, comparison: &Comparison) -> Option<Table> {
    comparison.questions.power.as_ref()?;
    let rows = against.judged.iter().map(|judged| {
        let contrast = &judged.contrast;
        let cells = judged.power.map(|answer| {
            let needed = answer.seeds_needed.map_or("over 1e9".to_owned(), |seeds| seeds.to_string());
            let size = amount_text(answer.difference, contrast.metric.about.unit);
            [size, percent(answer.power), needed, sized(answer.detectable, contrast)]
        });
        let cells = cells.unwrap_or_else(|| std::array::from_fn(|_| "-".into()));
        [contrast.metric.name.to_string(), contrast.seeds.to_string()].into_iter().chain(cells).collect()
    });
    let headings = ["Metric", "Seeds", "Difference", "Power\n%", "Seeds\nfor 80 %", "Detectable"];
    let caption = format!("Seeds that a difference between A and {} needs", against.letter);
    Some(Table::new(&headings, rows.collect()).with_caption(&caption))
}

/// Tests of whether the sides are equal within a margin.
fn equivalence(against: &ComparisonToA, comparison: &Comparison) -> Option<Table> {
    comparison.questions.equivalent.as_ref()?;
    let rows = against.judged.iter().map(|judged| {
        let contrast = &judged.contrast;
        let cells = judged.equivalence.map(|found| {
            let decimals = two_digits(0.5 * (found.interval.high - found.interval.low));
            let ends = [found.interval.low, found.interval.high].map(|end| rounded(end, decimals));
            let margin = amount_text(found.margin, contrast.metric.about.unit);
            let answer = if found.is_equivalent() { "yes" } else { "not shown" };
            let [low, high] = ends;
            [margin, low, high, probability(found.p_value), answer.into()]
        });
        let cells = cells.unwrap_or_else(|| std::array::from_fn(|_| "-".into()));
        [contrast.metric.name.to_string()].into_iter().chain(cells).collect()
    });
    let headings = ["Metric", "Margin", "90% low", "90% high", "p", "Equivalent"];
    let caption = format!("Equivalence of A and {}", against.letter);
    Some(Table::new(&headings, rows.collect()).with_caption(&caption))
}

fn method(method: Method) -> &'static str {
    match method {
        Method::StudentisedBootstrap => "bootstrap",
        Method::StudentsT => "Student's t",
        Method::Ranks => "ranks",
        Method::Answers => "McNemar",
        Method::Sequence => "interval",
    }
}

/// Decimals that show the uncertainty with two digits.
fn decimals(contrast: &Contrast) -> usize {
    match contrast.interval {
        Some(interval) => two_digits(0.5 * (interval.high - interval.low)),
        None => two_digits(contrast.difference.abs().max(contrast.means[0].abs() * 1e-3)).min(3),
    }
}

fn notes(against: &ComparisonToA) -> Vec<String> {
    let fewer = against.judged.iter().filter(|judged| judged.contrast.pairs < against.pairs.runs.len());
    let fewer = fewer.map(|judged| {
        let left_out = against.pairs.runs.len() - judged.contrast.pairs;
        format!("{}: {left_out} pairs left out, which do not have it on both sides", judged.contrast.metric.name)
    });
    let untested = against.judged.iter().filter(|judged| judged.by_stratum.as_ref().is_some_and(|it| it.seeds < 2));
    let untested = untested.map(|judged| {
        let name = &judged.contrast.metric.name;
        format!("{name}: fewer than two seeds have it in all strata, so the strata are not tested")
    });
    against
        .judged
        .iter()
        .filter_map(|judged| {
            let cut_off = judged.contrast.cut_off.as_ref()?;
            Some(format!("{}: {}", judged.contrast.metric.name, cut_off_note(cut_off, against.letter)))
        })
        .chain(fewer)
        .chain(untested)
        .collect()
}

fn cut_off_note(cut_off: &CutOff, letter: char) -> String {
    let [our_median, their_median] = [0, 1].map(|side: usize| {
        let [low, high] = cut_off.median_intervals[side];
        format!("{} ({} to {})", time_text(cut_off.medians[side]), time_text(low), time_text(high))
    });
    let [ours, theirs] = cut_off.counts;
    let horizon = cut_off.horizon.map_or(String::new(), |horizon| {
        format!("; cut off in {ours} and {theirs} runs, and longer times count as {}", rounded(horizon, 0))
    });
    format!("medians with 95 % intervals: A {our_median}, {letter} {their_median}{horizon}")
}

fn time_text(end: Option<f64>) -> String {
    end.map_or("beyond the end".into(), |end| rounded(end, 0))
}
