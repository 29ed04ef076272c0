//! A report for people: headings, sentences, lists, tables and figures, printed as text, Markdown, HTML or LaTeX.
//!
//! Reports and answers are [`Document`]s of plain text. The printers escape all of it for their form, so
//! that no name of a file or a scenario becomes a tag, a command or a control character. Numbers become text in
//! [`number`], so that they look the same everywhere.
//!
//! ```
//! use wildfire_base::document::{Block, Document, Table};
//!
//! let table = Table::new(&["Run", "CPU\nms"], vec![vec!["1".into(), "12.5".into()]]);
//! let document = Document::new("Two <runs>").with([Block::Text("One was slow.".into()), table.into()]);
//! assert_eq!(document.to_text(), "Two <runs>\n\nOne was slow.\n\n     CPU\nRun   ms\n--------\n1   12.5\n");
//! assert!(document.to_html().contains("<h1>Two &lt;runs&gt;</h1>"));
//! ```

mod html;
mod latex;
mod markdown;
pub mod number;
mod text;

pub use html::{escaped as escaped_html, wide_and_narrow};
pub use latex::escaped as escaped_latex;
pub use text::{WIDTH, wrapped};

/// A title, and what follows it from top to bottom.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    pub title: String,
    pub blocks: Vec<Block>,
}

/// A part of a document. Nothing in it is marked up yet.
#[derive(Clone, Debug, PartialEq)]
pub enum Block {
    /// The beginning of a section.
    Heading(String),
    /// Links to all sections, which only a page has: other forms are read from top to bottom.
    Contents,
    /// A paragraph.
    Text(String),
    /// Sentences with a line each.
    List(Vec<String>),
    /// Sentences with a line each, and the file that each is about, by its path from the document.
    Links(Vec<(String, String)>),
    /// Names, and what each of them is.
    Terms(Vec<(String, String)>),
    Table(Table),
    /// Lines that are printed as they are, in letters of one width.
    Verbatim(String),
    Figure(Figure),
    /// A picture of pixels, which a page holds itself and of which other forms have the caption only.
    Image {
        caption: String,
        /// The bytes of a PNG file.
        png: Vec<u8>,
    },
    /// A part that a page shows when its title is clicked, and other forms show under it.
    Folded(String, Vec<Block>),
}

/// Cells of text under headings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    pub caption: Option<String>,
    /// A heading for each column. A line end in it is a place to break it; after a hyphen that divides a word.
    pub headings: Vec<String>,
    pub rows: Vec<Vec<String>>,
    /// The rows that have a line above them, besides the first.
    pub rules_before: Vec<usize>,
    /// The number of columns, from the left, that hold words and are aligned left; all others hold numbers, aligned
    /// right.
    pub text_columns: usize,
}

/// A drawing, and the name of its files.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The drawing itself. It goes into pages as it is, so it must be this program's own.
    pub svg: String,
    /// The path of the files that hold it, without the endings `.svg` and `.png`; `None` of a drawing that only the page
    /// has, and other forms leave out.
    pub file: Option<String>,
    /// The paths of further files of it: what it shows as a table, or its forms for paper.
    pub more_files: Vec<String>,
}

impl Block {
    /// Says whether only a page has the block, so that other forms leave it out.
    fn is_for_pages(&self) -> bool {
        matches!(self, Self::Contents | Self::Figure(Figure { file: None, .. }))
    }
}

impl Document {
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), blocks: Vec::new() }
    }

    /// Adds blocks to the end.
    pub fn with<B: Into<Block>>(mut self, blocks: impl IntoIterator<Item = B>) -> Self {
        self.blocks.extend(blocks.into_iter().map(Into::into));
        self
    }

    /// Adds a block to the end.
    pub fn add(&mut self, block: impl Into<Block>) {
        self.blocks.push(block.into());
    }

    /// Adds sentences to the end, if there are any.
    pub fn add_list(&mut self, lines: Vec<String>) {
        if !lines.is_empty() {
            self.blocks.push(Block::List(lines));
        }
    }
}

impl Table {
    /// A table whose first column holds words and all others numbers.
    pub fn new(headings: &[&str], rows: Vec<Vec<String>>) -> Self {
        let headings = headings.iter().map(|&heading| heading.to_owned()).collect();
        Self { headings, rows, text_columns: 1, ..Self::default() }
    }

    pub fn with_caption(self, caption: &str) -> Self {
        Self { caption: Some(caption.to_owned()), ..self }
    }

    /// The headings in one line each.
    fn whole_headings(&self) -> impl Iterator<Item = String> {
        self.headings.iter().map(|heading| heading.replace("-\n", "").replace('\n', " "))
    }

    fn is_text(&self, column: usize) -> bool {
        column < self.text_columns
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A document with the same text in every place that takes any.
    pub fn filled(text: &str) -> Document {
        let copy = || text.to_owned();
        let table = Table { caption: Some(copy()), ..Table::new(&[text], vec![vec![copy()]]) };
        Document::new(text).with([
            Block::Heading(copy()),
            Block::Contents,
            Block::Text(copy()),
            Block::List(vec![copy()]),
            Block::Links(vec![(copy(), copy())]),
            Block::Terms(vec![(copy(), copy())]),
            Block::Table(table),
            Block::Verbatim(copy()),
            Block::Figure(Figure { svg: String::new(), file: Some(copy()), more_files: Vec::new() }),
            Block::Image { caption: copy(), png: Vec::new() },
            Block::Folded(copy(), vec![Block::Text(copy())]),
        ])
    }

    #[test]
    fn no_form_lets_text_act_on_a_terminal_or_turn_its_direction() {
        let document = filled("a\u{1b}[2Jb\u{202e}c");
        // A terminal's text is escaped where it is printed, together with all other text.
        for printed in [document.to_markdown(), document.to_html(), document.to_latex()] {
            assert!(!printed.contains(['\u{1b}', '\u{202e}']), "{printed}");
            assert!(printed.contains("u001b") && printed.contains("u202e"), "{printed}");
        }
    }

    #[test]
    fn drawings_without_files_and_contents_are_for_pages_only() {
        let alone = Figure { svg: "<svg/>".into(), file: None, more_files: Vec::new() };
        let document = || Document::new("title").with([Block::Text("words".into())]);
        let with_figure = document().with([Block::Contents, Block::Figure(alone)]);
        assert!(with_figure.to_html().contains("<svg/>"));
        assert_eq!(with_figure.to_text(), document().to_text());
        assert_eq!(with_figure.to_markdown(), document().to_markdown());
        assert_eq!(with_figure.to_latex(), document().to_latex());
    }

    #[test]
    fn every_form_says_everything() {
        let document = filled("words");
        let places = 17;
        assert_eq!(document.to_text().matches("words").count(), places - 1, "a figure has one name");
        for printed in [document.to_markdown(), document.to_html(), document.to_latex()] {
            assert!(printed.matches("words").count() >= places - 1, "{printed}");
        }
    }
}
