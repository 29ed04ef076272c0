//! Documents as Markdown, with the tables of GitHub's dialect.

use super::{Block, Document, Table};
use crate::untrusted::{visible, visible_lines};

impl Document {
    pub fn to_markdown(&self) -> String {
        let mut text = if self.title.is_empty() { String::new() } else { format!("# {}\n", escaped(&self.title)) };
        push_blocks(&mut text, &self.blocks);
        text
    }
}

fn push_blocks(text: &mut String, blocks: &[Block]) {
    for block in blocks.iter().filter(|block| !block.is_for_pages()) {
        text.push('\n');
        match block {
            Block::Heading(line) => text.push_str(&format!("## {}\n", escaped(line))),
            Block::Text(line) => text.push_str(&format!("{}\n", escaped(line))),
            Block::List(lines) => lines.iter().for_each(|line| text.push_str(&format!("- {}\n", escaped(line)))),
            Block::Links(links) => {
                for (line, file) in links {
                    text.push_str(&format!("- {}: {}\n", escaped(line), escaped(file)));
                }
            }
            Block::Terms(terms) => {
                for (name, meaning) in terms {
                    text.push_str(&format!("- **{}**: {}\n", escaped(name), escaped(meaning)));
                }
            }
            Block::Table(table) => text.push_str(&table.to_markdown()),
            // Lines that are indented by four need no mark at their end that something in them could imitate.
            Block::Verbatim(lines) => {
                visible_lines(lines).lines().for_each(|line| text.push_str(&format!("    {line}\n")));
            }
            Block::Figure(figure) => {
                text.extend(figure.file.iter().map(|file| format!("![{0}]({0}.png)\n", escaped(file))));
            }
            // Filtered out above.
            Block::Contents => {}
            // An embedded image would be a `data:` address, which GitHub removes.
            Block::Image { caption, .. } => text.push_str(&format!("{}\n", escaped(caption))),
            Block::Folded(title, blocks) => {
                text.push_str(&format!("## {}\n", escaped(title)));
                push_blocks(text, blocks);
            }
        }
    }
}

impl Table {
    /// Prints the table under its caption.
    pub fn to_markdown(&self) -> String {
        let mut text = self.caption.as_ref().map_or(String::new(), |caption| format!("**{}**\n\n", escaped(caption)));
        push_row(&mut text, self.whole_headings().map(|heading| escaped(&heading)));
        push_row(
            &mut text,
            (0..self.headings.len()).map(|at| if self.is_text(at) { "---" } else { "---:" }.to_owned()),
        );
        for row in &self.rows {
            push_row(&mut text, row.iter().map(|cell| escaped(cell)));
        }
        text
    }
}

fn push_row(text: &mut String, cells: impl Iterator<Item = String>) {
    cells.for_each(|cell| text.push_str(&format!("| {cell} ")));
    text.push_str("|\n");
}

fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in visible(text).chars() {
        if "\\`*[]<>|&".contains(letter) {
            escaped.push('\\');
        }
        escaped.push(letter);
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::tests::filled;

    #[test]
    fn tables_have_one_heading_line_without_broken_words() {
        let rows = vec![vec!["1".into(), "10.5".into()], vec!["Mean".into(), "-".into()]];
        let table = Table::new(&["Run", "Reacha-\nbility\nms"], rows).with_caption("Times");
        let expected = "**Times**\n\n| Run | Reachability ms |\n| --- | ---: |\n| 1 | 10.5 |\n| Mean | - |\n";
        assert_eq!(table.to_markdown(), expected);
    }

    #[test]
    fn nothing_from_a_file_becomes_markdown() {
        let mut document = filled("<script>alert('x')</script> | [c](d) & \"e\"");
        document.blocks.retain(|block| !matches!(block, Block::Verbatim(_)));
        let markdown = document.to_markdown();
        let unescaped = |mark: &str| markdown.matches(mark).count() - markdown.matches(&format!("\\{mark}")).count();
        assert_eq!([unescaped("<"), unescaped("&")], [0; 2]);
        assert_eq!(unescaped("["), 1, "the bracket of the figure");
        assert_eq!(unescaped("|"), 6, "the bars of a table of one column: heading, marks, row");
    }
}
