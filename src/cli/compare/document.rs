//! A page of headings, sentences and tables, in the forms that it is printed in.

use std::fmt::Write;

use crate::batch::{TextTable, html};
use crate::untrusted::visible;

/// What a page says, from top to bottom. Nothing in it is marked up yet.
#[derive(Clone, Debug, Default)]
pub struct Document {
    pub title: String,
    pub blocks: Vec<Block>,
}

#[derive(Clone, Debug)]
pub enum Block {
    Heading(String),
    Text(String),
    List(Vec<String>),
    Table(TextTable),
}

impl Block {
    /// A table with a line of headings.
    pub fn table(headings: &[&str], rows: Vec<Vec<String>>) -> Self {
        let headings = headings.iter().map(|heading| vec![(*heading).to_owned()]).collect();
        Self::Table(TextTable { headings, rows, rules_before: Vec::new() })
    }
}

impl Document {
    /// For a terminal.
    pub fn to_text(&self) -> String {
        let mut text = format!("{}\n", self.title);
        for block in &self.blocks {
            text.push('\n');
            match block {
                Block::Heading(line) | Block::Text(line) => push_wrapped(&mut text, line, ""),
                Block::List(lines) => lines.iter().for_each(|line| push_wrapped(&mut text, line, "  ")),
                Block::Table(table) => text.push_str(&table.to_text()),
            }
        }
        text
    }

    pub fn to_markdown(&self) -> String {
        let mut text = format!("# {}\n", in_markdown(&self.title));
        for block in &self.blocks {
            text.push('\n');
            match block {
                Block::Heading(line) => push_lines(&mut text, &[format!("## {}", in_markdown(line))]),
                Block::Text(line) => push_lines(&mut text, &[in_markdown(line)]),
                Block::List(lines) => {
                    let items: Vec<_> = lines.iter().map(|line| format!("- {}", in_markdown(line))).collect();
                    push_lines(&mut text, &items);
                }
                Block::Table(table) => text.push_str(&escaped(table, in_markdown).to_markdown()),
            }
        }
        text
    }

    /// A page that needs no other file and no network.
    pub fn to_html(&self) -> String {
        let mut text = html::head(&self.title);
        for block in &self.blocks {
            match block {
                Block::Heading(line) => push(&mut text, format_args!("<h2>{}</h2>\n", html::escaped(line))),
                Block::Text(line) => push(&mut text, format_args!("<p>{}</p>\n", html::escaped(line))),
                Block::List(lines) => {
                    text.push_str("<ul>\n");
                    lines.iter().for_each(|line| push(&mut text, format_args!("<li>{}</li>\n", html::escaped(line))));
                    text.push_str("</ul>\n");
                }
                Block::Table(table) => text.push_str(&html::table(table)),
            }
        }
        text.push_str("</html>\n");
        text
    }
}

/// The width that sentences are broken to on a terminal, in characters.
const WIDTH: usize = 80;

fn push(text: &mut String, arguments: std::fmt::Arguments<'_>) {
    text.write_fmt(arguments).expect("a string takes any text");
}

fn push_lines(text: &mut String, lines: &[impl AsRef<str>]) {
    for line in lines {
        text.push_str(line.as_ref());
        text.push('\n');
    }
}

/// Breaks a line between its words; what follows the first break is indented.
fn push_wrapped(text: &mut String, line: &str, indent: &str) {
    let mut width = 0;
    for word in line.split(' ') {
        let length = word.chars().count();
        if width > 0 && width + 1 + length > WIDTH {
            text.push('\n');
            text.push_str(indent);
            width = indent.len();
        } else if width > 0 {
            text.push(' ');
            width += 1;
        }
        text.push_str(word);
        width += length;
    }
    text.push('\n');
}

fn escaped(table: &TextTable, escape: fn(&str) -> String) -> TextTable {
    let all = |cells: &Vec<String>| cells.iter().map(|cell| escape(cell)).collect();
    TextTable {
        headings: table.headings.iter().map(all).collect(),
        rows: table.rows.iter().map(all).collect(),
        rules_before: table.rules_before.clone(),
    }
}

fn in_markdown(text: &str) -> String {
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

    fn hostile() -> Document {
        let bad = "<script>alert('x')</script> | *b* [c](d) & \"e\"".to_owned();
        let blocks = vec![
            Block::Heading(bad.clone()),
            Block::Text(bad.clone()),
            Block::List(vec![bad.clone()]),
            Block::table(&[&bad], vec![vec![bad.clone()]]),
        ];
        Document { title: bad, blocks }
    }

    #[test]
    fn nothing_from_a_file_becomes_a_tag() {
        let html = hostile().to_html();
        assert!(!html.contains("<script") && !html.contains("'x'"), "{html}");
        assert_eq!(html.matches("&lt;script&gt;").count(), 7, "title twice, and once in each other place");
        assert!(!html.contains("http"), "{html}");
    }

    #[test]
    fn nothing_from_a_file_becomes_markdown() {
        let markdown = hostile().to_markdown();
        let unescaped = |mark: &str| markdown.matches(mark).count() - markdown.matches(&format!("\\{mark}")).count();
        assert_eq!([unescaped("<"), unescaped("*"), unescaped("["), unescaped("&")], [0; 4]);
        assert_eq!(unescaped("|"), 6, "the bars of a table of one column: heading, marks, row");
    }

    #[test]
    fn text_is_what_was_said() {
        let document = Document {
            title: "T".into(),
            blocks: vec![Block::Text("One <two>.".into()), Block::List(vec!["A".into(), "B".into()])],
        };
        assert_eq!(document.to_text(), "T\n\nOne <two>.\n\nA\nB\n");
    }

    #[test]
    fn long_lines_are_broken_between_words() {
        let long = ["word"; 40].join(" ");
        let mut text = String::new();
        push_wrapped(&mut text, &long, "  ");
        assert!(text.lines().all(|line| line.len() <= WIDTH));
        assert_eq!(text.split_whitespace().count(), 40);
        assert!(text.lines().skip(1).all(|line| line.starts_with("  word")));
    }
}
