//! Numbers as people read them.
//!
//! Files and JSON have the shortest decimals that read back as the same `f64`; those need no help. Everything that is
//! printed for people is rounded here.

/// Writes a number with this count of decimals, zero without a sign.
pub fn rounded(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let is_zero = text.chars().all(|letter| "-0.".contains(letter));
    if is_zero { text.trim_start_matches('-').into() } else { text }
}

/// Writes a number and its limit with as few decimals as show on which side of it the number is, and no fewer than asked
/// for.
pub fn beside_limit(number: f64, limit: f64, decimals: usize) -> [String; 2] {
    let order = number.partial_cmp(&limit);
    let written = (decimals..=15).map(|decimals| [number, limit].map(|value| rounded(value, decimals)));
    let parsed = |text: &String| text.parse::<f64>().ok();
    written
        .into_iter()
        .find(|texts| parsed(&texts[0]).partial_cmp(&parsed(&texts[1])) == order)
        .unwrap_or_else(|| [number, limit].map(|value| value.to_string()))
}

/// The same as [`rounded`] for a number that may not exist, which is shown as a dash.
pub fn optional(number: Option<f64>, decimals: usize) -> String {
    number.map_or_else(|| "-".into(), |number| rounded(number, decimals))
}

/// A number with as few decimals as it needs, at most six.
pub fn short(number: f64) -> String {
    // The sum makes -0 to 0.
    ((number * 1e6).round() / 1e6 + 0.0).to_string()
}

/// Returns the decimals that show a number of this size with two digits that count; at most nine.
pub fn two_digits(size: f64) -> usize {
    let mut decimals = 0;
    let mut shifted = size.abs();
    // From 9.95 on one decimal less shows two digits, as the number rounds up to 10.
    while shifted < 9.95 && decimals < 9 && shifted > 0.0 {
        shifted *= 10.0;
        decimals += 1;
    }
    decimals
}

/// A share of 1 in percent, without its sign.
pub fn percent(share: f64) -> String {
    rounded(100.0 * share, 1)
}

/// A probability with three decimals, or that it is smaller than these can show.
pub fn probability(p: f64) -> String {
    if p < 0.001 { "<0.001".into() } else { rounded(p, 3) }
}

/// A number of things, such as `1 goal`, `2 goals` or `3 entries`.
pub fn count(number: usize, thing: &str) -> String {
    match thing.strip_suffix('y') {
        _ if number == 1 => format!("1 {thing}"),
        Some(stem) => format!("{number} {stem}ies"),
        None => format!("{number} {thing}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_beyond_its_limit_looks_so() {
        assert_eq!(beside_limit(0.078_74, 0.078_69, 4), ["0.07874", "0.07869"]);
        assert_eq!(beside_limit(0.1, 0.05, 2), ["0.10", "0.05"]);
        assert_eq!(beside_limit(0.5 + 1e-6, 0.5, 3), ["0.500001", "0.500000"]);
        assert_eq!(beside_limit(1.0, 1.0, 1), ["1.0", "1.0"]);
        let beyond = 1.0 + f64::EPSILON;
        assert_eq!(beside_limit(beyond, 1.0, 1), ["1.0000000000000002", "1"]);
    }

    #[test]
    fn what_rounds_to_zero_has_no_sign() {
        assert_eq!(rounded(-0.001, 2), "0.00");
        assert_eq!(rounded(-0.0, 0), "0");
        assert_eq!(rounded(-0.04, 1), "0.0");
        assert_eq!(rounded(-0.01, 2), "-0.01");
        assert_eq!(rounded(-10.0, 0), "-10");
        assert_eq!([short(-1e-9), short(-2.5), short(1.0 / 3.0)], ["0", "-2.5", "0.333333"]);
    }

    #[test]
    fn two_digits_of_the_uncertainty_are_shown() {
        for (size, decimals) in
            [(123.0, 0), (12.0, 0), (9.96, 0), (1.2, 1), (0.96, 2), (0.004, 4), (0.0, 0), (1e-30, 9)]
        {
            assert_eq!(two_digits(size), decimals, "{size}");
        }
    }

    #[test]
    fn what_there_is_none_of_is_a_dash_and_one_thing_is_no_plural() {
        assert_eq!([optional(None, 2), optional(Some(0.5), 2)], ["-", "0.50"]);
        assert_eq!([probability(0.0004), probability(0.04)], ["<0.001", "0.040"]);
        assert_eq!([count(1, "goal"), count(0, "goal")], ["1 goal", "0 goals"]);
        assert_eq!(percent(0.12345), "12.3");
    }
}
