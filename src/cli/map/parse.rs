//! Values of options, from text; an error is what was expected. The ranges of parameters are their algorithms' business.

use crate::cli::map::options::Scale;
use crate::cli::numbers;
use crate::grid::Place;
use crate::map_files::MAX_SIDE;

pub fn place(text: &str) -> Result<Place, String> {
    let whole = |text: &str| numbers::parse(text.trim());
    let numbers = text.split_once(',').and_then(|(row, col)| Some((whole(row)?, whole(col)?)));
    numbers.ok_or_else(|| "expected ROW,COLUMN, two whole numbers counted from 0, such as 3,17".to_owned())
}

pub fn grey(text: &str) -> Result<u8, String> {
    numbers::parse(text).ok_or_else(|| "expected a grey value, a whole number from 0 to 255".to_owned())
}

pub fn edge(text: &str) -> Result<usize, String> {
    let width = numbers::parse(text).filter(|&width| width <= MAX_SIDE);
    width.ok_or_else(|| format!("expected a number of rows and columns, from 0 to {MAX_SIDE}"))
}

pub fn distance(text: &str) -> Result<u16, String> {
    numbers::parse(text).ok_or_else(|| format!("expected a distance in cells, a whole number from 1 to {}", u16::MAX))
}

pub fn number(text: &str) -> Result<f64, String> {
    numbers::parse(text).ok_or_else(|| "expected a number".to_owned())
}

pub fn scale(text: &str) -> Result<Scale, String> {
    match text {
        "none" => Ok(Scale(None)),
        _ => {
            let scale = numbers::parse(text).map(|scale| Scale(Some(scale)));
            scale.ok_or_else(|| "expected a number or `none`".to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_two_whole_numbers() {
        assert_eq!(place("3,17"), Ok((3, 17)));
        assert_eq!(place("3, 17"), Ok((3, 17)));
        for wrong in ["", "3", "3;17", "-1,2", "1,2,3", "1.5,2", "a,b", "99999999999999999999,0"] {
            assert!(place(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn text_that_is_no_value_is_refused_with_what_was_expected() {
        assert_eq!(scale("none"), Ok(Scale(None)));
        assert_eq!(scale("2.5"), Ok(Scale(Some(2.5))));
        assert!(scale("all").is_err_and(|expected| expected.contains("`none`")));
        assert!(grey("255").is_ok() && grey("256").is_err_and(|expected| expected.contains("0 to 255")));
        assert!(edge("32767").is_ok() && edge("32768").is_err() && edge("-1").is_err());
        assert!(distance("12").is_ok() && distance("1.5").is_err() && distance("65536").is_err());
    }
}
