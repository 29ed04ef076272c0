//! Tables of numbers as plain text and as Markdown.

use std::fmt::Write;

/// Cells of text under headings; the first column is aligned left, all others right.
#[derive(Clone, Debug, Default)]
pub struct TextTable {
    /// Per column, lines of its heading from top to bottom.
    pub headings: Vec<Vec<String>>,
    pub rows: Vec<Vec<String>>,
    /// Before which rows a line is drawn in plain text.
    pub rules_before: Vec<usize>,
}

impl TextTable {
    /// Columns one space apart, as wide as their widest cell.
    pub fn to_text(&self) -> String {
        let widths = self.widths();
        let mut text = String::new();
        for line in self.heading_lines() {
            push_line(&mut text, &line, &widths);
        }
        let rule = "-".repeat(widths.iter().sum::<usize>() + widths.len().saturating_sub(1));
        for (index, row) in self.rows.iter().enumerate() {
            if index == 0 || self.rules_before.contains(&index) {
                text.push_str(&rule);
                text.push('\n');
            }
            push_line(&mut text, row, &widths);
        }
        text
    }

    pub fn to_markdown(&self) -> String {
        let mut text = String::new();
        let titles = self.headings.iter().map(|lines| lines.join(" ").replace("- ", ""));
        push_markdown_line(&mut text, titles);
        let marks = (0..self.headings.len()).map(|column| if column == 0 { "---" } else { "---:" }.to_owned());
        push_markdown_line(&mut text, marks);
        for row in &self.rows {
            push_markdown_line(&mut text, row.iter().cloned());
        }
        text
    }

    fn widths(&self) -> Vec<usize> {
        let in_column = |column: usize| {
            let headings = self.headings[column].iter();
            let cells = self.rows.iter().filter_map(move |row| row.get(column));
            headings.chain(cells).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        (0..self.headings.len()).map(in_column).collect()
    }

    /// Headings as lines, their last lines on the bottom.
    fn heading_lines(&self) -> Vec<Vec<String>> {
        let height = self.headings.iter().map(Vec::len).max().unwrap_or(0);
        let line = |line: usize| {
            let cell = |lines: &Vec<String>| {
                let gap = height - lines.len();
                if line < gap { String::new() } else { lines[line - gap].clone() }
            };
            self.headings.iter().map(cell).collect()
        };
        (0..height).map(line).collect()
    }
}

fn push_line(text: &mut String, cells: &[String], widths: &[usize]) {
    let mut line = String::new();
    for (column, (cell, &width)) in cells.iter().zip(widths).enumerate() {
        let written = if column == 0 { write!(line, "{cell:<width$}") } else { write!(line, " {cell:>width$}") };
        written.expect("a string takes any text");
    }
    text.push_str(line.trim_end());
    text.push('\n');
}

fn push_markdown_line(text: &mut String, cells: impl Iterator<Item = String>) {
    for cell in cells {
        text.push_str("| ");
        text.push_str(&cell);
        text.push(' ');
    }
    text.push_str("|\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> TextTable {
        let words = |words: &[&str]| words.iter().map(|&word| word.to_owned()).collect::<Vec<_>>();
        TextTable {
            headings: vec![words(&["Run"]), words(&["Reacha-", "bility"]), words(&["Sum"])],
            rows: vec![words(&["1", "10.5", "3"]), words(&["Mean", "7", "-"])],
            rules_before: vec![1],
        }
    }

    #[test]
    fn plain_text_is_aligned_and_ruled() {
        let expected =
            "     Reacha-\nRun   bility Sum\n----------------\n1       10.5   3\n----------------\nMean       7   -\n";
        assert_eq!(sample().to_text(), expected);
    }

    #[test]
    fn markdown_has_one_heading_line_without_broken_words() {
        let expected = "| Run | Reachability | Sum |\n| --- | ---: | ---: |\n| 1 | 10.5 | 3 |\n| Mean | 7 | - |\n";
        assert_eq!(sample().to_markdown(), expected);
    }
}
