//! Documents as LaTeX, to be read into a paper with `\input`. The first lines say which packages it needs.

use super::{Block, Document, Table};
use crate::untrusted::{visible, visible_lines};

/// What surrounds the contents of a box that is made smaller where it is wider than a column.
const NARROWED: [&str; 2] = ["\\resizebox{\\ifdim\\width>\\columnwidth\\columnwidth\\else\\width\\fi}{!}{%\n", "}\n"];

/// Words that are longer than this, in letters, may be broken at signs.
const LONGEST_WHOLE: usize = 16;

impl Document {
    /// Prints the document for a paper: every table with a caption and a label, and nothing wider than a column.
    pub fn to_latex(&self) -> String {
        // The quotation marks of text are letters of T1.
        let mut text =
            "% \\usepackage[T1]{fontenc}\n% \\usepackage{booktabs,graphicx}\n\\begingroup\\sloppy\n".to_owned();
        if !self.title.is_empty() {
            text.push_str(&format!("\\section*{{{}}}\n", breakable(&self.title)));
        }
        LatexBlocks { section: self.title.clone(), labels: Vec::new() }.push(&mut text, &self.blocks);
        text.push_str("\\endgroup\n");
        text
    }
}

/// Blocks that are being printed.
struct LatexBlocks {
    /// The heading above, which is the caption of tables without one.
    section: String,
    /// The labels of the tables before.
    labels: Vec<String>,
}

impl LatexBlocks {
    fn push(&mut self, text: &mut String, blocks: &[Block]) {
        for block in blocks.iter().filter(|block| !block.is_for_pages()) {
            text.push('\n');
            match block {
                Block::Heading(line) => self.begin_section(text, line),
                Block::Text(line) => text.push_str(&format!("{}\n", breakable(line))),
                Block::List(lines) => {
                    push_items(text, "itemize", lines.iter().map(|line| format!("\\item {}", breakable(line))));
                }
                Block::Links(links) => push_items(
                    text,
                    "itemize",
                    links
                        .iter()
                        .map(|(line, file)| format!("\\item {}: \\texttt{{{}}}", breakable(line), breakable(file))),
                ),
                Block::Terms(terms) => push_items(
                    text,
                    "description",
                    terms.iter().map(|(name, meaning)| format!("\\item[{{{}}}] {}", escaped(name), breakable(meaning))),
                ),
                Block::Table(table) => self.push_table(text, table),
                // Not the environment of this name, which text in it could end.
                Block::Verbatim(lines) => {
                    // Only a box can be made smaller, so the lines are rows of a table with one column.
                    let lines = visible_lines(lines);
                    // TeX would merge spaces.
                    let lines: Vec<_> = lines.lines().map(|line| escaped(line).replace(' ', "~")).collect();
                    let [begin, end] = NARROWED;
                    text.push_str(&format!(
                        "{{\\ttfamily\\noindent\n{begin}\\begin{{tabular}}{{@{{}}l@{{}}}}\n{}\n\\end{{tabular}}{end}\\par}}\n",
                        lines.join("\\\\\n")
                    ));
                }
                Block::Figure(figure) => {
                    // The name of a file is no text: an escape in it would be part of the name.
                    let is_plain = |letter: &char| letter.is_alphanumeric() || "-_./ ".contains(*letter);
                    let file: String = figure.file.iter().flat_map(|file| file.chars()).filter(is_plain).collect();
                    text.push_str(&format!("\\includegraphics[width=\\columnwidth]{{\\detokenize{{{file}}}.png}}\n"));
                }
                // Filtered out above.
                Block::Contents => {}
                // LaTeX cannot hold the bytes of an image.
                Block::Image { caption, .. } => text.push_str(&format!("{}\n\n", breakable(caption))),
                // Paper does not fold; as a section the title is the caption of the tables below it.
                Block::Folded(title, blocks) => {
                    self.begin_section(text, title);
                    self.push(text, blocks);
                }
            }
        }
    }

    fn begin_section(&mut self, text: &mut String, title: &str) {
        text.push_str(&format!("\\subsection*{{{}}}\n", breakable(title)));
        title.clone_into(&mut self.section);
    }

    fn push_table(&mut self, text: &mut String, table: &Table) {
        let columns: String =
            (0..table.headings.len()).map(|column| if table.is_text(column) { 'l' } else { 'r' }).collect();
        let row = |cells: Vec<String>| cells.join(" & ") + " \\\\\n";
        let caption = self.caption(table);
        let label = self.label(&caption);
        let [begin, end] = NARROWED;
        text.push_str(&format!(
            "\\begin{{table}}[htbp]\n\\centering\n\\caption{{{}}}\\label{{{label}}}\n{begin}",
            breakable(&caption)
        ));
        text.push_str(&format!("\\begin{{tabular}}{{{columns}}}\n\\toprule\n"));
        text.push_str(&row(table.whole_headings().map(|heading| escaped(&heading)).collect()));
        for (index, cells) in table.rows.iter().enumerate() {
            if index == 0 || table.rules_before.contains(&index) {
                text.push_str("\\midrule\n");
            }
            let cells = cells.iter().enumerate();
            text.push_str(&row(cells.map(|(column, cell)| cell_text(cell, table.is_text(column))).collect()));
        }
        text.push_str(&format!("\\bottomrule\n\\end{{tabular}}{end}\\end{{table}}\n"));
    }

    /// The table's own caption, without the number that LaTeX gives it, or else the heading above and its first column.
    fn caption(&self, table: &Table) -> String {
        let captioned = table.caption.as_deref().map(|caption| {
            let numbered = caption.strip_prefix("TABLE ").and_then(|rest| rest.split_once(". "));
            numbered.map_or(caption, |(_, text)| text).to_owned()
        });
        captioned.unwrap_or_else(|| {
            let first = table.whole_headings().next().unwrap_or_default();
            [self.section.as_str(), &first].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(": ")
        })
    }

    /// A label of plain letters from a caption, with a number if another table has it.
    fn label(&mut self, caption: &str) -> String {
        const MAX_LETTERS: usize = 40;
        let plain = caption.to_lowercase().replace(|letter: char| !letter.is_ascii_alphanumeric(), "-");
        let parts: Vec<&str> = plain.split('-').filter(|word| !word.is_empty()).collect();
        let joined: String = parts.join("-").chars().take(MAX_LETTERS).collect();
        let label = format!("tab:{}", joined.trim_end_matches('-'));
        let numbered = (2..).map(|number| format!("{label}-{number}"));
        let mut labels = [label.clone()].into_iter().chain(numbered);
        let label = labels.find(|label| !self.labels.contains(label)).expect("there is a number for each label");
        self.labels.push(label.clone());
        label
    }
}

fn push_items(text: &mut String, environment: &str, items: impl Iterator<Item = String>) {
    let items: String = items.map(|item| format!("  {item}\n")).collect();
    text.push_str(&format!("\\begin{{{environment}}}\n{items}\\end{{{environment}}}\n"));
}

/// Escapes text in which long words, such as paths and keys, may be broken after their signs.
fn breakable(text: &str) -> String {
    let word = |word: &str| {
        let text = escaped(word);
        if word.chars().count() <= LONGEST_WHOLE {
            return text;
        }
        ["/", "\\_", "=", ".", ",", ":"]
            .iter()
            .fold(text, |text, sign| text.replace(sign, &format!("{sign}\\allowbreak{{}}")))
    };
    text.split(' ').map(word).collect::<Vec<_>>().join(" ")
}

/// Writes a cell; before a number the hyphen of text becomes a minus sign.
fn cell_text(cell: &str, is_text: bool) -> String {
    match cell.strip_prefix('-').filter(|rest| !is_text && rest.starts_with(|first: char| first.is_ascii_digit())) {
        Some(number) => format!("$-${}", escaped(number)),
        None => escaped(cell),
    }
}

/// Escapes text, of which no letter is a command then.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in visible(text).chars() {
        match letter {
            '\\' => escaped.push_str("\\textbackslash{}"),
            '~' => escaped.push_str("\\textasciitilde{}"),
            '^' => escaped.push_str("\\textasciicircum{}"),
            '<' => escaped.push_str("\\textless{}"),
            '>' => escaped.push_str("\\textgreater{}"),
            '|' => escaped.push_str("\\textbar{}"),
            '"' => escaped.push_str("\\textquotedbl{}"),
            // Before a row of a table a bracket would be an option of the line above.
            '[' => escaped.push_str("{[}"),
            ']' => escaped.push_str("{]}"),
            '{' | '}' | '$' | '&' | '#' | '%' | '_' => {
                escaped.push('\\');
                escaped.push(letter);
            }
            // A minus sign is no letter of T1.
            '−' => escaped.push_str("$-$"),
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::tests::filled;

    #[test]
    fn tables_have_the_rules_of_booktabs_captions_and_labels() {
        let rows = vec![vec!["-1".into(), "-10.5".into()], vec!["Mean".into(), "50 %".into()]];
        let table = Table { rules_before: vec![1], ..Table::new(&["Run", "Reacha-\nbility"], rows) };
        let mut text = String::new();
        let mut blocks = LatexBlocks { section: "Runs".into(), labels: Vec::new() };
        blocks.push_table(&mut text, &table.clone().with_caption("TABLE I. Times"));
        let expected = "\\begin{table}[htbp]\n\\centering\n\\caption{Times}\\label{tab:times}\n\
                        \\resizebox{\\ifdim\\width>\\columnwidth\\columnwidth\\else\\width\\fi}{!}{%\n\
                        \\begin{tabular}{lr}\n\\toprule\n\
                        Run & Reachability \\\\\n\\midrule\n-1 & $-$10.5 \\\\\n\\midrule\nMean & 50 \\% \\\\\n\
                        \\bottomrule\n\\end{tabular}}\n\\end{table}\n";
        assert_eq!(text, expected);
        text.clear();
        (0..2).for_each(|_| blocks.push_table(&mut text, &table));
        for expected_part in ["\\caption{Runs: Run}\\label{tab:runs-run}", "\\label{tab:runs-run-2}"] {
            assert!(text.contains(expected_part), "{expected_part}: {text}");
        }
        let labels = ["Runs", "Runs", "Runs 2", "Runs"].map(|caption| blocks.label(caption));
        assert_eq!(labels, ["tab:runs", "tab:runs-2", "tab:runs-2-2", "tab:runs-3"]);
    }

    #[test]
    fn long_words_can_be_broken_and_stay_the_same_letters() {
        assert_eq!(breakable("a_b runs/first"), "a\\_b runs/first");
        let broken = breakable("see unimog.prm_rs.samples=1000");
        assert_eq!(broken, "see unimog.\\allowbreak{}prm\\_\\allowbreak{}rs.\\allowbreak{}samples=\\allowbreak{}1000");
        assert_eq!(broken.replace("\\allowbreak{}", ""), escaped("see unimog.prm_rs.samples=1000"));
    }

    #[test]
    fn nothing_from_a_file_becomes_a_command() {
        let latex = filled("\\input{x} $y_1^2$ 5% & #a ~b [c]").to_latex();
        assert!(!latex.contains("\\input"), "{latex}");
        let escaped =
            "\\textbackslash{}input\\{x\\} \\$y\\_1\\textasciicircum{}2\\$ 5\\% \\& \\#a \\textasciitilde{}b {[}c{]}";
        assert_eq!(latex.matches(escaped).count(), 14, "everywhere but between ties: {latex}");
    }
}
