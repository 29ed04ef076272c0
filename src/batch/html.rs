//! Pages that need no other file and no network: their head, their tables, and text as it stands in them.

use crate::batch::text_table::TextTable;
use crate::untrusted::visible_lines;

const HEAD: &str = "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
                         <meta name=\"viewport\" content=\"width=device-width\">\n";

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#111}\
                     table{border-collapse:collapse;margin:1em 0;font-variant-numeric:tabular-nums}\
                     th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #bbb}\
                     th{vertical-align:bottom;border-bottom:2px solid #111}\
                     th:first-child,td:first-child{text-align:left}";

/// The beginning of a page, with its title as a heading.
pub fn head(title: &str) -> String {
    let title = escaped(title);
    format!("{HEAD}<title>{title}</title>\n<style>{STYLE}</style>\n<h1>{title}</h1>\n")
}

/// A table, whose cells are text.
pub fn table(table: &TextTable) -> String {
    let heading = |lines: &Vec<String>| {
        let lines: Vec<_> = lines.iter().map(|line| escaped(line)).collect();
        format!("<th>{}</th>", lines.join("<br>"))
    };
    let cell = |cell: &String| format!("<td>{}</td>", escaped(cell));
    let row = |row: &Vec<String>| format!("<tr>{}</tr>\n", row.iter().map(cell).collect::<String>());
    let headings: String = table.headings.iter().map(heading).collect();
    let rows: String = table.rows.iter().map(row).collect();
    format!("<table>\n<tr>{headings}</tr>\n{rows}</table>\n")
}

/// Escapes text for a page: nothing in it is a tag, acts on what surrounds it, or turns the direction of writing.
pub fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in visible_lines(text).chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            letter => escaped.push(letter),
        }
    }
    escaped
}
