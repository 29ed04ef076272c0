//! Differences as sentences.

use crate::stats::Interval;
use crate::table::Phrase;
use wildfire_base::document::number::{rounded, two_digits};

/// Returns a difference as a sentence: `B saves 6.1 more bushes per run, 95 % interval 4.8 to 7.4`. A metric without
/// a phrase appears by its name.
pub fn sentence(
    metric: &str,
    phrase: Option<Phrase>,
    side: char,
    difference: f64,
    interval: Option<Interval>,
) -> String {
    let scale = phrase.map_or(1.0, |phrase| phrase.scale);
    let is_less = difference < 0.0;
    // The word gives the direction, so the amount is positive: "saves -3 more" reads as its opposite.
    let scaled = |value: f64| if is_less { -scale * value } else { scale * value };
    // The width of the interval says how many digits mean something; without one the difference has to.
    let decimals = interval.map_or_else(|| two_digits(difference * scale), |it| decimals_of_interval(it, scale));
    let amount = number(scaled(difference), decimals);
    let text = match phrase {
        Some(Phrase { subject, more, .. }) => {
            format!("{} {amount} {}", subject.replace('$', &side.to_string()), more[usize::from(is_less)])
        }
        None => format!("{metric} is {amount} {} with {side}", if is_less { "lower" } else { "higher" }),
    };
    match interval {
        Some(Interval { low, high }) => {
            format!("{text}, 95 % interval {}", ends([low, high].map(scaled), decimals))
        }
        None => text,
    }
}

/// Formats the interval of a signed difference, such as `−0.4 to 1.2`.
pub fn interval_text(phrase: Option<Phrase>, interval: Interval) -> String {
    let scale = phrase.map_or(1.0, |phrase| phrase.scale);
    ends([interval.low, interval.high].map(|end| end * scale), decimals_of_interval(interval, scale))
}

fn decimals_of_interval(interval: Interval, scale: f64) -> usize {
    two_digits(0.5 * (interval.high - interval.low) * scale)
}

fn ends(ends: [f64; 2], decimals: usize) -> String {
    let [low, high] = [ends[0].min(ends[1]), ends[0].max(ends[1])].map(|end| number(end, decimals));
    format!("{low} to {high}")
}

/// A number in a sentence, with a minus sign in place of a hyphen.
fn number(number: f64, decimals: usize) -> String {
    rounded(number, decimals).replace('-', "−")
}

/// Joins words to a list: `a`, `a and b`, `a, b and c`.
pub fn listed(items: &[String]) -> String {
    match items {
        [first @ .., before, last] => {
            let first: String = first.iter().map(|word| format!("{word}, ")).collect();
            format!("{first}{before} and {last}")
        }
        items => items.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SAVES: Option<Phrase> =
        Some(Phrase { subject: "$ saves", more: ["more bushes per run", "fewer bushes per run"], scale: 1.0 });
    const WINS: Option<Phrase> = Some(Phrase {
        subject: "with $ the truck wins",
        more: ["more runs in 100", "fewer runs in 100"],
        scale: 100.0,
    });

    #[test]
    fn differences_are_worded_in_the_direction_they_have() {
        let interval = Interval { low: 4.78, high: 7.41 };
        assert_eq!(
            sentence("saved", SAVES, 'B', 6.1, Some(interval)),
            "B saves 6.1 more bushes per run, 95 % interval 4.8 to 7.4"
        );
        let mirrored = Interval { low: -7.41, high: -4.78 };
        assert_eq!(
            sentence("saved", SAVES, 'C', -6.1, Some(mirrored)),
            "C saves 6.1 fewer bushes per run, 95 % interval 4.8 to 7.4"
        );
        assert_eq!(sentence("saved", SAVES, 'B', 2.0, None), "B saves 2.0 more bushes per run");
        assert_eq!(sentence("truck_goals", None, 'B', -31.0, None), "truck_goals is 31 lower with B");
    }

    #[test]
    fn rates_are_in_hundreds() {
        let interval = Some(Interval { low: -0.2, high: -0.05 });
        let text = sentence("truck_won", WINS, 'B', -0.125, interval);
        assert_eq!(text, "with B the truck wins 12.5 fewer runs in 100, 95 % interval 5.0 to 20.0");
    }

    #[test]
    fn lists_end_with_and() {
        let of = |items: &[&str]| listed(&items.iter().map(|&word| word.to_owned()).collect::<Vec<_>>());
        assert_eq!([of(&[]), of(&["a"]), of(&["a", "b"]), of(&["a", "b", "c"])], ["", "a", "a and b", "a, b and c"]);
    }
}
