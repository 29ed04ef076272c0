//! Differences as sentences, and numbers as they are printed.

use crate::stats::Interval;
use crate::untrusted::visible;

/// How a difference of a metric is spoken of.
#[derive(Clone, Debug, PartialEq)]
pub struct Phrase {
    /// What a side does, for `B saves`.
    verb: String,
    /// What follows the amount of a difference above zero, and of one below.
    more: String,
    less: String,
    /// What the amount is multiplied with.
    scale: f64,
}

impl Phrase {
    /// Of a metric; those without words of their own are higher or lower.
    pub fn of(metric: &str) -> Self {
        let counted = |verb: &str, what: &str| Self::new(verb, &format!("more {what}"), &format!("fewer {what}"));
        match metric {
            "saved" => counted("saves", "obstacles per run"),
            "burned" => counted("loses", "obstacles per run"),
            "extinguished" => counted("extinguishes", "obstacles per run"),
            "truck_won" => counted("wins for the truck", "runs of a hundred").in_hundreds(),
            "wumpus_won" => counted("wins for the Wumpus", "runs of a hundred").in_hundreds(),
            "all_out_s" => Self::new("has all fires out", "s later", "s sooner"),
            "mean_response_s" => Self::new("puts a fire out", "s later", "s sooner"),
            "burning_cell_s" => counted("has", "seconds of a burning cell per run"),
            "cpu_unimog_total_s" => counted("has the truck's planners take", "CPU seconds per run"),
            other => {
                let subject = format!("has {other}");
                Self::new(&subject, "higher", "lower")
            }
        }
    }

    fn new(verb: &str, more: &str, less: &str) -> Self {
        Self { verb: verb.into(), more: more.into(), less: less.into(), scale: 1.0 }
    }

    fn in_hundreds(self) -> Self {
        Self { scale: 100.0, ..self }
    }

    /// `B saves 6.1 more obstacles per run, 95 % interval 4.8 to 7.4`.
    pub fn sentence(&self, side: &str, difference: f64, interval: Option<Interval>) -> String {
        let sign = if difference < 0.0 { -1.0 } else { 1.0 };
        let scaled = |value: f64| sign * self.scale * value;
        let decimals = interval.map_or_else(|| decimals_of(difference * self.scale), |it| self.decimals(it));
        let amount = rounded(scaled(difference), decimals);
        let direction = if difference < 0.0 { &self.less } else { &self.more };
        let said = format!("{side} {} {amount} {direction}", self.verb);
        match interval {
            Some(interval) => {
                format!("{said}, 95 % interval {}", ends([interval.low, interval.high].map(scaled), decimals))
            }
            None => said,
        }
    }

    /// An interval of a difference as it is, such as `-0.4 to 1.2`.
    pub fn interval(&self, interval: Interval) -> String {
        ends([interval.low, interval.high].map(|end| end * self.scale), self.decimals(interval))
    }

    fn decimals(&self, interval: Interval) -> usize {
        decimals_of(0.5 * (interval.high - interval.low) * self.scale)
    }
}

fn ends(ends: [f64; 2], decimals: usize) -> String {
    let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|end| rounded(end, decimals));
    format!("{low} to {high}")
}

/// Decimals that show a number of this size with two digits that count; at most nine.
pub fn decimals_of(size: f64) -> usize {
    let mut decimals = 0;
    let mut shifted = size.abs();
    while shifted < 9.95 && decimals < 9 && shifted > 0.0 {
        shifted *= 10.0;
        decimals += 1;
    }
    decimals
}

/// The number with so many decimals, zero without a sign.
pub fn rounded(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let is_zero = text.chars().all(|letter| "-0.".contains(letter));
    if is_zero { text.trim_start_matches('-').into() } else { text }
}

/// A probability with three decimals, or that it is smaller than that.
pub fn probability(p: f64) -> String {
    if p < 0.0005 { "<.001".into() } else { rounded(p, 3) }
}

/// Joins words to a list: `a`, `a and b`, `a, b and c`.
pub fn listed(words: &[String]) -> String {
    match words {
        [first @ .., before, last] => {
            let first: String = first.iter().map(|word| format!("{word}, ")).collect();
            format!("{first}{before} and {last}")
        }
        words => words.concat(),
    }
}

/// Makes a word from a file fit for a line: control characters become escapes, and no more than 60 characters are kept.
pub fn shown(word: &str) -> String {
    /// The most characters.
    const MOST: usize = 60;
    let start: String = word.chars().take(MOST).collect();
    let mut text = visible(&start).into_owned();
    if word.chars().nth(MOST).is_some() {
        text.push('…');
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_are_said_in_the_direction_they_have() {
        let saved = Phrase::of("saved");
        let interval = Interval { low: 4.78, high: 7.41 };
        assert_eq!(
            saved.sentence("B", 6.1, Some(interval)),
            "B saves 6.1 more obstacles per run, 95 % interval 4.8 to 7.4"
        );
        let mirrored = Interval { low: -7.41, high: -4.78 };
        assert_eq!(
            saved.sentence("C", -6.1, Some(mirrored)),
            "C saves 6.1 fewer obstacles per run, 95 % interval 4.8 to 7.4"
        );
        assert_eq!(saved.sentence("B", 2.0, None), "B saves 2.0 more obstacles per run");
        assert_eq!(Phrase::of("truck_cusps").sentence("B", -31.0, None), "B has truck_cusps 31 lower");
    }

    #[test]
    fn rates_are_said_in_hundreds() {
        let said = Phrase::of("truck_won").sentence("B", -0.125, Some(Interval { low: -0.2, high: -0.05 }));
        assert_eq!(said, "B wins for the truck 12.5 fewer runs of a hundred, 95 % interval 5.0 to 20.0");
    }

    #[test]
    fn two_digits_of_the_uncertainty_are_shown() {
        for (size, decimals) in
            [(123.0, 0), (12.0, 0), (9.96, 0), (1.2, 1), (0.96, 2), (0.004, 4), (0.0, 0), (1e-30, 9)]
        {
            assert_eq!(decimals_of(size), decimals, "{size}");
        }
        assert_eq!(rounded(-0.04, 1), "0.0");
    }

    #[test]
    fn lists_end_with_and() {
        let of = |words: &[&str]| listed(&words.iter().map(|&word| word.to_owned()).collect::<Vec<_>>());
        assert_eq!([of(&[]), of(&["a"]), of(&["a", "b"]), of(&["a", "b", "c"])], ["", "a", "a and b", "a, b and c"]);
    }

    #[test]
    fn words_from_files_cannot_steer_a_terminal() {
        assert_eq!(shown("a\u{1b}[2Jb\nc"), "a\\u001b[2Jb\\u000ac");
        assert_eq!(shown(&"x".repeat(61)).chars().count(), 61);
        assert_eq!(shown(&"x".repeat(60)), "x".repeat(60));
    }
}
