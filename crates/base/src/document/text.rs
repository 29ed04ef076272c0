//! Documents for a terminal: lines of at most 80 characters, tables in columns.

use std::fmt::Write;

use super::{Block, Document, Table};

/// The width that sentences are broken to, in characters.
pub const WIDTH: usize = 80;

impl Document {
    /// Prints the document for a terminal: a blank line between blocks, no marks.
    ///
    /// Tables are as wide as they are. Control characters are left to whoever writes to the terminal.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        if !self.title.is_empty() {
            push_wrapped(&mut text, &self.title);
        }
        push_blocks(&mut text, &self.blocks);
        text
    }
}

fn push_blocks(text: &mut String, blocks: &[Block]) {
    for block in blocks.iter().filter(|block| !block.is_for_pages()) {
        if !text.is_empty() {
            text.push('\n');
        }
        match block {
            Block::Heading(line) | Block::Text(line) => {
                wrapped(line, WIDTH).iter().for_each(|line| push_line(text, line));
            }
            Block::List(lines) => lines.iter().for_each(|line| push_wrapped(text, line)),
            Block::Links(links) => {
                links.iter().for_each(|(line, file)| push_wrapped(text, &format!("{line}: {file}")));
            }
            Block::Terms(terms) => push_terms(text, terms),
            Block::Table(table) => {
                if let Some(caption) = &table.caption {
                    push_wrapped(text, caption);
                    text.push('\n');
                }
                text.push_str(&table.to_text());
            }
            // Never wrapped: spaces align its columns.
            Block::Verbatim(lines) => push_line(text, lines.trim_end_matches('\n')),
            Block::Figure(figure) => {
                figure.file.iter().for_each(|file| push_line(text, &format!("Figure: {file}.png")));
            }
            // Filtered out above.
            Block::Contents => {}
            // A terminal shows no pictures.
            Block::Image { caption, .. } => push_wrapped(text, caption),
            Block::Folded(title, blocks) => {
                push_wrapped(text, title);
                push_blocks(text, blocks);
            }
        }
    }
}

fn push_line(text: &mut String, line: &str) {
    text.push_str(line);
    text.push('\n');
}

/// Pushes a line, broken between its words; what follows the first break is indented.
fn push_wrapped(text: &mut String, line: &str) {
    hanging(line, WIDTH, "  ").iter().for_each(|line| push_line(text, line));
}

/// Names in a column, and beside it the lines that say what they are.
fn push_terms(text: &mut String, terms: &[(String, String)]) {
    let width = terms.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
    for (name, meaning) in terms {
        let names = std::iter::once(name.as_str()).chain(std::iter::repeat(""));
        for (name, line) in names.zip(wrapped(meaning, WIDTH.saturating_sub(width + 2))) {
            push_line(text, &format!("{name:width$}  {line}"));
        }
    }
}

/// Breaks text into lines of whole words, at most `width` characters each unless a word is longer; at least one line.
pub fn wrapped(text: &str, width: usize) -> Vec<String> {
    hanging(text, width, "")
}

/// Does the same, and begins every line but the first with an indent.
fn hanging(text: &str, width: usize, indent: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    let mut has_text = false;
    for word in text.split([' ', '\n']) {
        let line = lines.last_mut().expect("there is one always");
        if has_text && line.chars().count() + 1 + word.chars().count() > width {
            lines.push(format!("{indent}{word}"));
        } else {
            line.push_str(if has_text { " " } else { "" });
            line.push_str(word);
        }
        has_text = true;
    }
    lines
}

impl Table {
    /// Prints the table without its caption: columns one space apart, as wide as their widest cell.
    pub fn to_text(&self) -> String {
        let headings: Vec<Vec<&str>> = self.headings.iter().map(|heading| heading.split('\n').collect()).collect();
        let widths: Vec<usize> = headings
            .iter()
            .enumerate()
            .map(|(column, lines)| {
                let cells = self.rows.iter().filter_map(|row| row.get(column)).map(String::as_str);
                lines.iter().copied().chain(cells).map(|cell| cell.chars().count()).max().unwrap_or(0)
            })
            .collect();
        let mut text = String::new();
        // The last lines of all headings are side by side, above the rule.
        let height = headings.iter().map(Vec::len).max().unwrap_or(0);
        for line in 0..height {
            let cell =
                |lines: &Vec<&str>| (line + lines.len()).checked_sub(height).map_or("", |line| lines[line]).to_owned();
            self.push_row(&mut text, &headings.iter().map(cell).collect::<Vec<_>>(), &widths);
        }
        let rule = "-".repeat(widths.iter().sum::<usize>() + widths.len().saturating_sub(1));
        for (index, row) in self.rows.iter().enumerate() {
            if index == 0 || self.rules_before.contains(&index) {
                push_line(&mut text, &rule);
            }
            self.push_row(&mut text, row, &widths);
        }
        text
    }

    /// Says whether the table fits a terminal.
    pub fn fits_a_terminal(&self) -> bool {
        self.to_text().lines().all(|line| line.chars().count() <= WIDTH)
    }

    fn push_row(&self, text: &mut String, cells: &[String], widths: &[usize]) {
        let mut line = String::new();
        for (column, (cell, &width)) in cells.iter().zip(widths).enumerate() {
            let gap = if column == 0 { "" } else { " " };
            let written = if self.is_text(column) {
                write!(line, "{gap}{cell:<width$}")
            } else {
                write!(line, "{gap}{cell:>width$}")
            };
            written.expect("a string takes any text");
        }
        push_line(text, line.trim_end());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(cells: &[&str]) -> Vec<String> {
        cells.iter().map(|&word| word.to_owned()).collect()
    }

    #[test]
    fn tables_are_aligned_and_ruled() {
        let rows = vec![cells(&["1", "10.5", "3"]), cells(&["Mean", "7", "-"])];
        let table = Table { rules_before: vec![1], ..Table::new(&["Run", "Reacha-\nbility", "Sum"], rows) };
        let expected =
            "     Reacha-\nRun   bility Sum\n----------------\n1       10.5   3\n----------------\nMean       7   -\n";
        assert_eq!(table.to_text(), expected);
        let two_of_text = Table { text_columns: 2, ..table };
        assert!(two_of_text.to_text().contains("\n1    10.5      3\n"), "{}", two_of_text.to_text());
    }

    #[test]
    fn blocks_stand_apart_and_lists_do_not() {
        let terms = Block::Terms(vec![("a".into(), "one".into()), ("long".into(), "two".into())]);
        let table = Table::new(&["N"], vec![vec!["1".into()]]).with_caption("TABLE I.");
        let document = Document::new("T").with([
            Block::Text("One <two>.".into()),
            Block::List(cells(&["A", "B"])),
            terms,
            table.into(),
        ]);
        let expected = "T\n\nOne <two>.\n\nA\nB\n\na     one\nlong  two\n\nTABLE I.\n\nN\n-\n1\n";
        assert_eq!(document.to_text(), expected);
    }

    #[test]
    fn long_lines_are_broken_between_words() {
        let long = ["word"; 40].join(" ");
        let mut text = String::new();
        push_wrapped(&mut text, &long);
        assert!(text.lines().all(|line| line.len() <= WIDTH));
        assert_eq!(text.split_whitespace().count(), 40);
        assert!(text.lines().skip(1).all(|line| line.starts_with("  word")));
        assert_eq!(text.lines().next().map(str::len), Some(79), "the first line is full");
    }

    #[test]
    fn wrapping_keeps_words_and_width() {
        assert_eq!(wrapped("a bb ccc dddd", 4), ["a bb", "ccc", "dddd"]);
        assert_eq!(wrapped("", 4), [""]);
        assert_eq!(wrapped("unbreakable x", 4), ["unbreakable", "x"]);
    }
}
