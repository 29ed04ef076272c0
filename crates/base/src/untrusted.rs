//! Text that users or strangers wrote, where it could be taken for more than text.
//!
//! Names of scenarios, files and values go into terminals, pages and tables. A terminal acts on control characters, a
//! reader is misled by characters that turn the direction of writing, and a spreadsheet computes cells that look like
//! formulas. [`visible`] and [`visible_lines`] write such characters as escapes, `\u001b` for instance, which are
//! those of JSON and TOML, so that a document in either form stays one. [`spreadsheet_cell`] marks cells as text, and
//! [`text_of_cell`] gives back what was marked.

use std::borrow::Cow;

/// The text in one line, with control characters and marks of direction as escapes.
pub fn visible(text: &str) -> Cow<'_, str> {
    escape(text, is_hidden)
}

/// The text with its line ends, and all other control characters and marks of direction as escapes.
pub fn visible_lines(text: &str) -> Cow<'_, str> {
    escape(text, |letter| letter != '\n' && is_hidden(letter))
}

/// The first 60 characters of a text, fit for a line as [`visible`] makes it; `…` says that there were more.
pub fn visible_start(text: &str) -> String {
    /// The most characters.
    const MAX: usize = 60;
    let start: String = text.chars().take(MAX).collect();
    let mut shown = visible(&start).into_owned();
    if text.chars().nth(MAX).is_some() {
        shown.push('…');
    }
    shown
}

fn escape(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.chars().any(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for letter in text.chars() {
        if is_escaped(letter) {
            shown += &format!("\\u{:04x}", u32::from(letter));
        } else {
            shown.push(letter);
        }
    }
    Cow::Owned(shown)
}

/// Says whether a character acts on what surrounds it instead of being seen: C0 and C1 controls and DEL, line and
/// paragraph separators, and the marks, embeddings, overrides and isolates of the Unicode bidirectional algorithm.
fn is_hidden(letter: char) -> bool {
    letter.is_control()
        || matches!(letter, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The sign by which a spreadsheet takes the rest of a cell as text.
const TEXT_SIGN: char = '\'';

/// Writes a cell of a CSV file, with [`TEXT_SIGN`] before text that a spreadsheet would take for a formula; numbers
/// stay.
pub fn spreadsheet_cell(text: &str) -> Cow<'_, str> {
    if is_formula(text) && text.parse::<f64>().is_err() {
        Cow::Owned(format!("{TEXT_SIGN}{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// Reads the text that [`spreadsheet_cell`] wrote into a cell.
pub fn text_of_cell(cell: &str) -> &str {
    cell.strip_prefix(TEXT_SIGN).filter(|text| is_formula(text)).unwrap_or(cell)
}

/// Does the same as [`text_of_cell`], for bytes that may be no text.
pub fn bytes_of_cell(cell: &[u8]) -> &[u8] {
    std::str::from_utf8(cell).map_or(cell, |text| text_of_cell(text).as_bytes())
}

/// Says whether a cell begins as formulas do. One that begins with text signs before that counts too, so that every
/// text has a cell of its own and can be read back.
fn is_formula(text: &str) -> bool {
    text.trim_start_matches(TEXT_SIGN).starts_with(['=', '+', '-', '@', '\t', '\r', '\n'])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_acts_on_a_terminal_is_written_as_an_escape() {
        assert_eq!(visible("a\u{1b}[2Jb"), "a\\u001b[2Jb");
        assert_eq!(visible("\u{7}\u{7f}\u{9b}1m\r\t"), "\\u0007\\u007f\\u009b1m\\u000d\\u0009");
        assert_eq!(visible("user\u{202e}txt.exe\u{2066}"), "user\\u202etxt.exe\\u2066");
        let hidden =
            "\u{0}\u{1f}\u{7f}\u{80}\u{9f}\u{61c}\u{200e}\u{200f}\u{2028}\u{2029}\u{202a}\u{202e}\u{2066}\u{2069}";
        assert!(visible(hidden).is_ascii());
    }

    #[test]
    fn long_words_are_cut_and_cannot_steer_a_terminal() {
        assert_eq!(visible_start("a\u{1b}[2Jb\nc"), "a\\u001b[2Jb\\u000ac");
        assert_eq!(visible_start(&"x".repeat(61)).chars().count(), 61);
        assert_eq!(visible_start(&"x".repeat(60)), "x".repeat(60));
    }

    #[test]
    fn other_text_stays_as_it_is() {
        for text in ["", "contest", "Größe 5 µm, 模型, e\u{301}, \u{1f525}", "a\\u001b", "\u{a0}\u{2003}"] {
            assert!(matches!(visible(text), Cow::Borrowed(same) if same == text), "{text}");
        }
        assert_eq!(visible_lines("one\ntwo\r\n"), "one\ntwo\\u000d\n");
        assert_eq!(visible("one\ntwo"), "one\\u000atwo");
    }

    #[test]
    fn cells_that_begin_like_formulas_are_text_and_numbers_are_numbers() {
        for formula in ["=1+1", "+cmd|' /C calc'!A0", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "-", "=", "-1,5"] {
            assert_eq!(spreadsheet_cell(formula), format!("'{formula}"));
        }
        for plain in ["", "contest", "-5", "+1.5e-3", "1=1", "'quoted'", "a-b", "-inf"] {
            assert_eq!(spreadsheet_cell(plain), plain);
        }
    }

    #[test]
    fn every_cell_reads_back_as_what_was_written_into_it() {
        let pieces = ["", "'", "''", "=", "-", "+", "@", "\t", "\r", "a", "-5", "'-5", "5", "' ="];
        let mut cells = std::collections::BTreeSet::new();
        let mut texts = std::collections::BTreeSet::new();
        for (one, other) in pieces.iter().flat_map(|one| pieces.iter().map(move |other| (one, other))) {
            let text = format!("{one}{other}");
            let cell = spreadsheet_cell(&text).into_owned();
            assert_eq!((text_of_cell(&cell), bytes_of_cell(cell.as_bytes())), (text.as_str(), text.as_bytes()));
            cells.insert(cell);
            texts.insert(text);
        }
        assert_eq!(cells.len(), texts.len());
        assert_eq!(bytes_of_cell(b"\xff="), b"\xff=");
    }
}
