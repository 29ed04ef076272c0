//! Errors of scenarios: what is wrong, and where.

use std::fmt;
use std::io::ErrorKind;
use std::ops::Range;

use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteSpanContents, NamedSource, SourceCode, SourceSpan, SpanContents,
};
use thiserror::Error;

use super::built_in::BUILT_IN;
use wildfire_base::untrusted::{visible, visible_lines};

/// The longest line that is shown whole, in bytes.
const LONGEST_LINE: usize = 400;

/// Bytes of a longer line that are shown on either side of a fault, and most of the fault itself.
const SHOWN_OF_LONG_LINES: usize = 60;

/// The reason why a scenario is refused, with its location.
///
/// Its text is one sentence without the location; control characters are escaped. [`ScenarioError::location`] gives
/// file, line and column; as a [`miette::Diagnostic`] it shows the line itself.
#[derive(Debug, Error)]
#[error("{}", visible(&fault.to_string()))]
pub struct ScenarioError {
    pub fault: Fault,
    pub location: Option<SourceLocation>,
}

/// A fault of a scenario, without its location.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Fault {
    #[error("there is no file and no built-in scenario `{name}`")]
    NotFound { name: String, nearest: Option<String> },
    #[error("`{path}` cannot be read: {reason}")]
    Unreadable { path: String, kind: ErrorKind, reason: String },
    #[error("this is not TOML: {message}")]
    Syntax { message: String },
    #[error("this is not JSON: {message}")]
    NotJson { message: String },
    #[error("unknown field `{name}`{}", in_table(.table))]
    UnknownField { name: String, table: String, known: Vec<String>, nearest: Option<String> },
    #[error("missing field `{name}`{}", in_table(.table))]
    MissingField { name: String, table: String },
    #[error("`{field}` cannot be `{found}`: one of {} is expected", listed(.known))]
    UnknownWord { field: String, found: String, known: Vec<String>, nearest: Option<String> },
    #[error("`{field}` is `{found}`, and no {kind} of this name is known")]
    UnknownName { kind: &'static str, field: String, found: String, known: Vec<String>, nearest: Option<String> },
    #[error("`{field}` is {found}; expected {expected}")]
    Value { field: String, found: String, expected: String },
    #[error("{message}")]
    Rule { message: String },
    #[error("`{one}` cannot go with `{other}`: {reason}")]
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
    #[error("the map is empty: a line of `.` and `#` for each row of cells is expected")]
    Empty,
    #[error("`{found}` is no cell: `.` or `0` for a free cell, `#` or `1` for a bush are expected")]
    UnknownCharacter { found: char },
    #[error("this row has {found} cells, {expected} like the first row are expected")]
    Ragged { found: usize, expected: usize },
    #[error("the map has more than {most} cells along a side, at most {most} are expected")]
    TooLarge { most: u16 },
    #[error("{message}")]
    Json { message: String },
    #[error("the map must say how many cells it has: `n`, or `size_m` as a whole number of cells, is expected")]
    NoSize,
    #[error("a cell of {found} m is no cell: a size above 0 m is expected")]
    CellSize { found: f64 },
    #[error("this GeoJSON has no polygon; a Polygon or a MultiPolygon is expected, whose inside is bushes")]
    NoPolygon,
    #[error("a point of the polygons has coordinates that are no degrees, and the file names no other system")]
    Coordinate,
    #[error(
        "the polygons extend over {} x {} m, more than {most} cells of {cell_m} m along a side; larger cells are \
         expected, by `field.cell_m` (coordinates within 180 and 90 are degrees unless a `crs` names another system)",
        .size[0].round(), .size[1].round()
    )]
    TooWide { size: [f64; 2], cell_m: f64, most: u16 },
    #[error("the outlines of the polygons cross the rows of cells {found} times; at most {most} are expected")]
    TooFine { found: usize, most: usize },
}

/// A span of a file, or of an option of the command line.
#[derive(Clone, Debug)]
pub struct SourceLocation {
    /// The source as it is shown, with control characters escaped; `span` refers to that text.
    source: NamedSource<String>,
    span: Range<usize>,
    /// Line and column of the first byte in the text as it was written.
    line_and_column: (usize, usize),
}

impl Fault {
    pub(super) fn nowhere(self) -> Box<ScenarioError> {
        Box::new(ScenarioError { fault: self, location: None })
    }

    pub(super) fn at(self, location: SourceLocation) -> Box<ScenarioError> {
        Box::new(ScenarioError { fault: self, location: Some(location) })
    }

    /// Names the values of a list's only entry without its number: `unimog.planner` instead of `unimog.0.planner`.
    pub(super) fn without_number_in(mut self, list: &str) -> Self {
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
                Some(format!("{}built in are {}", did_you_mean(nearest.as_deref()), names.join(", ")))
            }
            Self::Unreadable { path, kind: ErrorKind::NotFound, .. }
                if BUILT_IN.iter().any(|(name, _)| name == path) =>
            {
                Some(format!("a scenario of this name is built in: `--scenario {path}`"))
            }
            Self::UnknownField { nearest, known, .. } if !known.is_empty() => {
                Some(format!("{}known here are {}", did_you_mean(nearest.as_deref()), known.join(", ")))
            }
            Self::UnknownWord { nearest: Some(nearest), .. } => Some(format!("did you mean `{nearest}`?")),
            Self::UnknownName { kind, nearest, known, .. } => Some(format!(
                "{}known are {}; a table [{kind}.NAME] makes another one known, as does --command NAME='PROGRAM ...'",
                did_you_mean(nearest.as_deref()),
                known.join(", ")
            )),
            _ => None,
        }
    }
}

impl SourceLocation {
    /// Locates a span of bytes in a named text; a span beyond its end is cut off.
    pub(super) fn new(name: &str, text: &str, span: Range<usize>) -> Self {
        let start = text.floor_char_boundary(span.start);
        let end = text.floor_char_boundary(span.end).max(start);
        let [before, span_text, after] = [&text[..start], &text[start..end], &text[end..]];
        let shown = [before, span_text, after].map(visible_lines);
        let shown_start = shown[0].len();
        Self {
            span: shown_start..shown_start + shown[1].len(),
            source: NamedSource::new(visible(name), shown.concat()),
            line_and_column: line_and_column_after(before),
        }
    }

    /// Returns line and column of the first byte, both from 1; columns count characters.
    pub fn line_and_column(&self) -> (usize, usize) {
        self.line_and_column
    }

    /// Says whether this is a place in the given text.
    pub fn is_in(&self, text: &str) -> bool {
        *self.source.inner() == visible_lines(text)
    }

    /// Returns the part of the span that is shown: no more than its first line, and of a long line the beginning.
    fn shown(&self) -> Range<usize> {
        let text = self.source.inner();
        let span_text = &text[self.span.clone()];
        let line = span_text.lines().next().unwrap_or_default();
        let most = if span_text.len() > LONGEST_LINE { SHOWN_OF_LONG_LINES } else { LONGEST_LINE };
        self.span.start..self.span.start + line.floor_char_boundary(most)
    }

    /// Returns the bytes around the shown part that fit beside it, on its line only.
    fn window(&self) -> Range<usize> {
        let text = self.source.inner();
        let shown = self.shown();
        let line_start = text[..shown.start].rfind('\n').map_or(0, |at| at + 1);
        let line_end = text[shown.end..].find('\n').map_or(text.len(), |at| shown.end + at);
        let start = text.ceil_char_boundary(shown.start.saturating_sub(SHOWN_OF_LONG_LINES)).max(line_start);
        let end = text.floor_char_boundary((shown.end + SHOWN_OF_LONG_LINES).min(line_end));
        start..end
    }

    /// Returns the text of the span.
    pub fn excerpt(&self) -> &str {
        self.source.inner().get(self.span.clone()).unwrap_or_default()
    }
}

fn line_and_column_after(text: &str) -> (usize, usize) {
    let line_start = text.rfind('\n').map_or(0, |at| at + 1);
    let line = 1 + text.bytes().filter(|&byte| byte == b'\n').count();
    (line, 1 + text[line_start..].chars().count())
}

impl fmt::Display for SourceLocation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (line, column) = self.line_and_column();
        write!(f, "{}:{line}:{column}", self.source.name())
    }
}

/// A scenario may be a single line of megabytes; a message shows only what surrounds the fault.
impl SourceCode for SourceLocation {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let whole = self.source.read_span(span, lines_before, lines_after)?;
        if whole.data().split(|&byte| byte == b'\n').all(|line| line.len() <= LONGEST_LINE) {
            return Ok(whole);
        }
        let window = self.window();
        let (line, column) = self.line_and_column();
        let before = self.source.inner()[window.start..self.span.start].chars().count().min(column - 1);
        Ok(Box::new(MietteSpanContents::new_named(
            self.source.name().to_owned(),
            &self.source.inner().as_bytes()[window.clone()],
            (window.start, window.len()).into(),
            line - 1,
            column - 1 - before,
            1,
        )))
    }
}

impl Diagnostic for ScenarioError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.fault.advice().map(|advice| Box::new(advice) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.location.as_ref().map(|place| place as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.location.as_ref()?;
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(Some("here".into()), place.shown()))))
    }
}

/// Finds the name in `known` that is most like `name`, if any is similar enough to be meant.
pub fn nearest_name<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let likeness = |other: &str| strsim::jaro_winkler(&name.to_lowercase(), other);
    let scored = known.into_iter().map(|other| (likeness(other), other));
    let best = scored.max_by(|one, other| one.0.total_cmp(&other.0).then(other.1.cmp(one.1)))?;
    (best.0 > 0.75).then(|| best.1.to_owned())
}

fn in_table(table: &str) -> String {
    if table.is_empty() { String::new() } else { format!(" in `{table}`") }
}

fn listed(known: &[String]) -> String {
    known.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}

fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map_or(String::new(), |nearest| format!("did you mean `{nearest}`? "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_location_is_that_in_the_text_and_shows_no_control_characters() {
        let text = "x = 1\n\u{1b}[2J\u{202e}y = \u{7}z\n";
        let place = SourceLocation::new("a\u{1b}b", text, text.find('\u{7}').expect("it is there")..text.len() - 1);
        assert_eq!((place.line_and_column(), place.excerpt()), ((2, 10), "\\u0007z"));
        assert_eq!(place.to_string(), "a\\u001bb:2:10");
        let shown = place.read_span(&place.shown().into(), 1, 0).expect("the span_text is in the text");
        assert_eq!(shown.data(), b"x = 1\n\\u001b[2J\\u202ey = \\u0007z");
    }

    #[test]
    fn what_a_fault_quotes_cannot_act_on_a_terminal() {
        let error = Fault::NotFound { name: "\u{1b}[31m\u{2066}".into(), nearest: None }.nowhere();
        assert_eq!(error.to_string(), "there is no file and no built-in scenario `\\u001b[31m\\u2066`");
    }
}
