//! Short texts, such as the command line takes them.

use arbitrary::Unstructured;

use super::fuzz::text::{NUMBERS, SCRAPS};
use super::fuzz::{below, one_of};

/// Draws some of these words one after another.
pub fn phrase(dice: &mut Unstructured<'_>, vocabulary: &[&str]) -> String {
    let count = below(dice, 6);
    let word = |dice: &mut Unstructured<'_>| match below(dice, 8) {
        0..=3 => (*one_of(dice, vocabulary)).to_owned(),
        4 | 5 => (*one_of(dice, NUMBERS)).to_owned(),
        6 => {
            let scrap = *one_of(dice, SCRAPS);
            String::from_utf8_lossy(scrap).into_owned()
        }
        _ => below(dice, 1000).to_string(),
    };
    (0..count).map(|_| word(dice)).collect()
}
