//! Errors of scenarios: what is wrong, and where.

use std::borrow::Cow;
use std::fmt;
use std::io::ErrorKind;
use std::ops::Range;

use annotate_snippets::{Annotation, AnnotationKind, Snippet};
use thiserror::Error;

use crate::BUILT_IN;
use wildfire_base::untrusted::visible;

/// Bytes of a line that may be shown from a fault on: a scenario may be one line of megabytes.
const SHOWN_OF_LONG_LINES: usize = 120;

/// The reason why a scenario is refused, with its location.
///
/// Its text is one sentence without the location; control characters are escaped. [`ScenarioError::location`] gives
/// file, line and column, and [`SourceLocation::snippet`] the line itself.
#[derive(Debug, Error)]
#[error("{}", visible(&fault.to_string()))]
pub struct ScenarioError {
    pub fault: Fault,
    pub location: Option<SourceLocation>,
}

/// A fault of a scenario, without its location.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    #[error("there is neither a file nor a built-in scenario `{name}`")]
    NotFound { name: String, nearest: Option<String> },
    #[error("`{path}` cannot be read: {reason}")]
    Unreadable { path: String, kind: ErrorKind, reason: String },
    #[error("this is not TOML: {message}")]
    Syntax { message: String },
    #[error("this is not JSON: {message}")]
    NotJson { message: String },
    #[error("unknown field `{name}`{}", in_table(.table))]
    UnknownField { name: String, table: String, valid_names: Vec<String>, nearest: Option<String> },
    #[error("missing field `{name}`{}", in_table(.table))]
    MissingField { name: String, table: String },
    #[error("`{field}` cannot be `{found}`; expected one of {}", listed(.valid_names))]
    UnknownWord { field: String, found: String, valid_names: Vec<String>, nearest: Option<String> },
    #[error("`{field}` is `{found}`, and no {kind} of this name is known")]
    UnknownName { kind: &'static str, field: String, found: String, valid_names: Vec<String>, nearest: Option<String> },
    #[error("`{field}` is {found}; expected {expected}")]
    Value { field: String, found: String, expected: String },
    #[error("{message}")]
    Rule { message: String },
    #[error("`{one}` cannot be combined with `{other}`: {reason}")]
    Conflict { one: String, other: String, reason: &'static str },
    #[error("a change is written path=value, as in unimog.prm.samples=1000")]
    NoChange,
    #[error("{message}")]
    CannotChange { message: String },
    #[error(transparent)]
    Map(#[from] MapFault),
}

/// A fault of a map.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MapFault {
    #[error("the map is empty; expected a line of `.` and `#` for each row of cells")]
    Empty,
    #[error("`{found}` is not a cell; expected `.` or `0` for a free cell, `#` or `1` for a bush")]
    UnknownCharacter { found: char },
    #[error("this row has {found} cells; expected {expected} as in the first row")]
    Ragged { found: usize, expected: usize },
    #[error("the map has more than {max} cells along a side; expected at most {max}")]
    TooLarge { max: u16 },
    #[error("{message}")]
    Json { message: String },
    #[error("the map does not give its number of cells; expected `n`, or `size_m` as a whole number of cells")]
    NoSize,
    #[error("a cell of {found} m is impossible; expected a size above 0 m")]
    CellSize { found: f64 },
    #[error("this GeoJSON has no polygon; expected a Polygon or a MultiPolygon, whose inside becomes bushes")]
    NoPolygon,
    #[error("a point of the polygons has coordinates that are not degrees, and the file names no other system")]
    Coordinate,
    #[error(
        "the polygons extend over {} x {} m, more than {max} cells of {cell_m} m along a side; larger cells are \
         expected, by `field.cell_m` (coordinates within 180 and 90 are degrees unless a `crs` names another system)",
        .size[0].round(), .size[1].round()
    )]
    TooWide { size: [f64; 2], cell_m: f64, max: u16 },
    #[error("the outlines of the polygons cross the rows of cells {found} times; at most {max} are expected")]
    TooFine { found: usize, max: usize },
}

/// A span of a file, or of an option of the command line.
#[derive(Clone)]
pub struct SourceLocation {
    /// The name as it is shown, with control characters escaped.
    name: String,
    text: String,
    /// Lies within `text`, between its characters.
    span: Range<usize>,
}

impl Fault {
    pub(crate) fn nowhere(self) -> Box<ScenarioError> {
        Box::new(ScenarioError { fault: self, location: None })
    }

    pub(crate) fn at(self, location: SourceLocation) -> Box<ScenarioError> {
        Box::new(ScenarioError { fault: self, location: Some(location) })
    }

    /// Names the values of a list's only entry without its number: `unimog.planner` instead of `unimog.0.planner`.
    pub(crate) fn without_number_in(mut self, list: &str) -> Self {
        // A file with one truck does not number it, so a number in a message would name nothing that its author wrote.
        let numbered = format!("{list}.0");
        let shorten = |path: &mut String| {
            let rest = path.strip_prefix(&numbered).filter(|rest| rest.is_empty() || rest.starts_with('.'));
            if let Some(shorter) = rest.map(|rest| format!("{list}{rest}")) {
                *path = shorter;
            }
        };
        match &mut self {
            Self::UnknownField { table, .. } | Self::MissingField { table, .. } => shorten(table),
            Self::UnknownWord { field, .. } | Self::UnknownName { field, .. } | Self::Value { field, .. } => {
                shorten(field);
            }
            Self::Conflict { one, other, .. } => [one, other].into_iter().for_each(shorten),
            // Messages of rules hold paths within their text.
            Self::Rule { message } => *message = message.replace(&format!("`{numbered}."), &format!("`{list}.")),
            _ => {}
        }
        self
    }

    /// Returns what may help: the nearest name, or the names that are known.
    pub fn advice(&self) -> Option<String> {
        match self {
            Self::NotFound { nearest, .. } => {
                let names: Vec<_> = BUILT_IN.iter().map(|(name, _)| *name).collect();
                Some(format!("{}the built-in scenarios are {}", did_you_mean(nearest.as_deref()), names.join(", ")))
            }
            Self::Unreadable { path, kind: ErrorKind::NotFound, .. }
                // The likely slip is the name of a built-in scenario in the place of a path.
                if BUILT_IN.iter().any(|(name, _)| name == path) =>
            {
                Some(format!("a scenario of this name is built in: `--scenario {path}`"))
            }
            Self::UnknownField { nearest, valid_names, .. } if !valid_names.is_empty() => {
                Some(format!("{}expected one of {}", did_you_mean(nearest.as_deref()), valid_names.join(", ")))
            }
            Self::UnknownWord { nearest: Some(nearest), .. } => Some(format!("did you mean `{nearest}`?")),
            Self::UnknownName { kind, nearest, valid_names, .. } => Some(format!(
                "{}expected one of {}; register another one with a table [{kind}.NAME] or --command NAME='PROGRAM ...'",
                did_you_mean(nearest.as_deref()),
                valid_names.join(", ")
            )),
            _ => None,
        }
    }
}

impl SourceLocation {
    /// Locates a span of bytes in a named text; a span beyond its end is cut off.
    pub(crate) fn new(name: &str, text: &str, span: Range<usize>) -> Self {
        let start = text.floor_char_boundary(span.start);
        let end = text.floor_char_boundary(span.end).max(start);
        Self { name: visible(name).into_owned(), text: text.to_owned(), span: start..end }
    }

    /// Returns line and column of the first byte, both from 1; columns count characters.
    pub fn line_and_column(&self) -> (usize, usize) {
        let before = &self.text[..self.span.start];
        let line_start = before.rfind('\n').map_or(0, |at| at + 1);
        let line = 1 + before.bytes().filter(|&byte| byte == b'\n').count();
        (line, 1 + before[line_start..].chars().count())
    }

    /// Says whether this is a place in the given text.
    pub fn is_in(&self, text: &str) -> bool {
        self.text == text
    }

    /// Returns what is shown below a message: the place, and its line with the span marked as far as it is on that line.
    pub fn snippet(&self) -> Snippet<'_, Annotation<'_>> {
        let (before, after) = self.text.split_at(self.span.start);
        let before = &before[before.rfind('\n').map_or(0, |at| at + 1)..];
        let after = after.lines().next().unwrap_or_default();
        let after = &after[..after.floor_char_boundary(SHOWN_OF_LONG_LINES)];
        let (marked, after) = after.split_at(self.span.len().min(after.len()));
        let [before, marked, after] = [before, marked, after].map(|part| part.replace(acts_on_terminal, "\u{fffd}"));
        let mark = AnnotationKind::Primary.span(before.len()..before.len() + marked.len());
        let line = before + &marked + &after;
        Snippet::source(line).path(&self.name).line_start(self.line_and_column().0).annotation(mark)
    }
}

/// Says whether a snippet has to show another character; tabs it shows as blanks.
fn acts_on_terminal(letter: char) -> bool {
    letter != '\t' && matches!(visible(letter.encode_utf8(&mut [0; 4])), Cow::Owned(_))
}

impl fmt::Display for SourceLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_and_column();
        write!(f, "{}:{line}:{column}", self.name)
    }
}

/// The place alone: the text may have megabytes.
impl fmt::Debug for SourceLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Finds the name in `valid_names` that is most like `name`, if any is similar enough to be meant.
pub fn nearest_name<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let name = name.to_lowercase();
    let scored = candidates.into_iter().map(|other| {
        // A whole word is no slip, such as `astar` for `hybrid-astar`.
        let is_word = other.split(['-', '_', '+']).any(|word| word == name);
        (strsim::jaro_winkler(&name, other).max(if is_word { 0.8 } else { 0.0 }), other)
    });
    let best = scored.max_by(|one, other| one.0.total_cmp(&other.0).then(other.1.cmp(one.1)))?;
    (best.0 > 0.75).then(|| best.1.to_owned())
}

fn in_table(table: &str) -> String {
    if table.is_empty() { String::new() } else { format!(" in `{table}`") }
}

fn listed(names: &[String]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or(String::new(), |nearest| format!("did you mean `{nearest}`? "))
}

#[cfg(test)]
mod tests {
    use annotate_snippets::{Level, Renderer};

    use super::*;

    fn shown(name: &str, text: &str, span: Range<usize>) -> String {
        let place = SourceLocation::new(name, text, span);
        Renderer::plain().term_width(60).render(&[Level::ERROR.primary_title("wrong").element(place.snippet())])
    }

    /// What is shown of a text in the file `f`.
    fn shown_of(text: &str, span: Range<usize>) -> String {
        let shown = shown("f", text, span);
        let (head, picture) = shown.split_once("f:").expect("the place is shown");
        assert_eq!(head, "error: wrong\n --> ");
        picture.replace("\n  |\n", "\n")
    }

    #[test]
    fn the_line_is_shown_with_a_mark_wherever_it_is() {
        for (text, span, picture) in [
            ("a = 1\nb = -3\nc = 1\n", 10..12, "2:5\n2 | b = -3\n  |     ^^"),
            ("", 0..0, "1:1\n1 |\n  | ^"),
            ("a = [\n", 6..6, "2:1\n2 |\n  | ^"),
            ("a = [", 5..9, "1:6\n1 | a = [\n  |      ^"),
            ("a = [\n1,\n2]\n", 4..12, "1:5\n1 | a = [\n  |     ^"),
            ("a = 1\r\nb = [\r\nc = 3\r\n", 11..12, "2:5\n2 | b = [\n  |     ^"),
            ("a = 1\r\n", 5..7, "1:6\n1 | a = 1\n  |      ^"),
            ("\ta = 1", 1..2, "1:2\n1 |     a = 1\n  |     ^"),
            ("é = \"模型\" # \u{1f525}", 6..12, "1:6\n1 | é = \"模型\" # \u{1f525}\n  |      ^^^^"),
            ("é = \"模型\"", 7..8, "1:6\n1 | é = \"模型\"\n  |      ^"),
        ] {
            assert_eq!(shown_of(text, span), picture, "{text:?}");
        }
    }

    #[test]
    fn of_a_long_line_only_what_is_around_the_fault_is_shown() {
        for letter in ["x", "模", "\t", "\u{85}", "e\u{301}"] {
            let text = letter.repeat(100_000);
            for at in [0, text.len() / 2, text.len()] {
                for len in [0, 1, 50, text.len()] {
                    let picture = shown_of(&text, at..at + len);
                    assert!(picture.len() < 2000 && picture.contains('^'), "{letter:?} {at} {len}: {picture}");
                }
            }
        }
        let ascii = "x".repeat(100_000);
        assert!(shown_of(&ascii, 5000..5003).lines().all(|line| line.len() <= 60));
    }

    #[test]
    fn a_location_is_that_in_the_text_and_shows_no_control_characters() {
        let text = "x = 1\n\u{1b}[2J\u{202e}y = \u{7}z\n";
        let span = text.find('\u{7}').expect("it is there")..text.len() - 1;
        let place = SourceLocation::new("a\u{1b}b", text, span.clone());
        assert_eq!((place.line_and_column(), place.to_string()), ((2, 10), "a\\u001bb:2:10".to_owned()));
        let picture = "error: wrong\n --> a\\u001bb:2:10\n  |\n2 | \u{fffd}[2J\u{fffd}y = \u{fffd}z\n  |          ^^";
        assert_eq!(shown("a\u{1b}b", text, span), picture);
    }

    #[test]
    fn what_a_fault_quotes_cannot_act_on_a_terminal() {
        let error = Fault::NotFound { name: "\u{1b}[31m\u{2066}".into(), nearest: None }.nowhere();
        assert_eq!(error.to_string(), "there is neither a file nor a built-in scenario `\\u001b[31m\\u2066`");
    }
}
