//! Documents as LaTeX, to be read into a paper with `\input`. The first lines say which packages it needs.

use super::{Block, Document, Table};
use crate::untrusted::{visible, visible_lines};

impl Document {
    pub fn to_latex(&self) -> String {
        // The quotation marks of text are letters of T1.
        let mut text = "% \\usepackage[T1]{fontenc}\n% \\usepackage{booktabs,caption,graphicx}\n".to_owned();
        if !self.title.is_empty() {
            text.push_str(&format!("\\section*{{{}}}\n", escaped(&self.title)));
        }
        push_blocks(&mut text, &self.blocks);
        text
    }
}

fn push_blocks(text: &mut String, blocks: &[Block]) {
    for block in blocks.iter().filter(|block| !block.is_for_pages()) {
        text.push('\n');
        match block {
            Block::Heading(line) => text.push_str(&format!("\\subsection*{{{}}}\n", escaped(line))),
            Block::Text(line) => text.push_str(&format!("{}\n", escaped(line))),
            Block::List(lines) => {
                let items: String = lines.iter().map(|line| format!("  \\item {}\n", escaped(line))).collect();
                text.push_str(&format!("\\begin{{itemize}}\n{items}\\end{{itemize}}\n"));
            }
            Block::Links(links) => {
                let item = |(line, file): &(String, String)| {
                    format!("  \\item {}: \\texttt{{{}}}\n", escaped(line), escaped(file))
                };
                let items: String = links.iter().map(item).collect();
                text.push_str(&format!("\\begin{{itemize}}\n{items}\\end{{itemize}}\n"));
            }
            Block::Terms(terms) => {
                let item = |(name, meaning): &(String, String)| {
                    format!("  \\item[{{{}}}] {}\n", escaped(name), escaped(meaning))
                };
                let items: String = terms.iter().map(item).collect();
                text.push_str(&format!("\\begin{{description}}\n{items}\\end{{description}}\n"));
            }
            Block::Table(table) => push_table(text, table),
            // Not the environment of this name, which text in it could end.
            Block::Verbatim(lines) => {
                let lines = visible_lines(lines);
                let lines: Vec<_> = lines.lines().map(|line| escaped(line).replace(' ', "~")).collect();
                text.push_str(&format!("{{\\ttfamily\\noindent\n{}\\par}}\n", lines.join("\\\\\n")));
            }
            Block::Figure(figure) => {
                // The name of a file is no text: an escape in it would be part of the name.
                let is_plain = |letter: &char| letter.is_alphanumeric() || "-_./ ".contains(*letter);
                let file: String = figure.file.iter().flat_map(|file| file.chars()).filter(is_plain).collect();
                text.push_str(&format!("\\includegraphics[width=\\linewidth]{{\\detokenize{{{file}}}.png}}\n"));
            }
            Block::Contents => {}
            Block::Image { caption, .. } => text.push_str(&format!("{}\n\n", escaped(caption))),
            Block::Folded(title, blocks) => {
                text.push_str(&format!("\\subsection*{{{}}}\n", escaped(title)));
                push_blocks(text, blocks);
            }
        }
    }
}

fn push_table(text: &mut String, table: &Table) {
    let columns: String =
        (0..table.headings.len()).map(|column| if table.is_text(column) { 'l' } else { 'r' }).collect();
    let row = |cells: Vec<String>| cells.join(" & ") + " \\\\\n";
    text.push_str("\\begin{table}[htbp]\n\\centering\n");
    if let Some(caption) = &table.caption {
        text.push_str(&format!("\\caption*{{{}}}\n", escaped(caption)));
    }
    text.push_str(&format!("\\begin{{tabular}}{{{columns}}}\n\\toprule\n"));
    text.push_str(&row(table.whole_headings().map(|heading| escaped(&heading)).collect()));
    for (index, cells) in table.rows.iter().enumerate() {
        if index == 0 || table.rules_before.contains(&index) {
            text.push_str("\\midrule\n");
        }
        let cells = cells.iter().enumerate();
        text.push_str(&row(cells.map(|(column, cell)| cell_text(cell, table.is_text(column))).collect()));
    }
    text.push_str("\\bottomrule\n\\end{tabular}\n\\end{table}\n");
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
    fn tables_have_the_rules_of_booktabs() {
        let rows = vec![vec!["-1".into(), "-10.5".into()], vec!["Mean".into(), "50 %".into()]];
        let table = Table { rules_before: vec![1], ..Table::new(&["Run", "Reacha-\nbility"], rows) };
        let mut text = String::new();
        push_table(&mut text, &table.with_caption("Times"));
        let expected = "\\begin{table}[htbp]\n\\centering\n\\caption*{Times}\n\\begin{tabular}{lr}\n\\toprule\n\
                        Run & Reachability \\\\\n\\midrule\n-1 & $-$10.5 \\\\\n\\midrule\nMean & 50 \\% \\\\\n\
                        \\bottomrule\n\\end{tabular}\n\\end{table}\n";
        assert_eq!(text, expected);
    }

    #[test]
    fn nothing_from_a_file_becomes_a_command() {
        let latex = filled("\\input{x} $y_1^2$ 5% & #a ~b [c]").to_latex();
        assert!(!latex.contains("\\input"), "{latex}");
        let own =
            "\\textbackslash{}input\\{x\\} \\$y\\_1\\textasciicircum{}2\\$ 5\\% \\& \\#a \\textasciitilde{}b {[}c{]}";
        assert_eq!(latex.matches(own).count(), 14, "everywhere but between ties: {latex}");
    }
}
