//! Documents as pages that need no other file and no network.

use data_encoding::BASE64;

use super::{Block, Document, Table};
use crate::untrusted::visible_lines;

const STYLE: &str = "body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:#111}\
                     .wide,pre{overflow-x:auto}pre{white-space:pre-wrap}\
                     table{border-collapse:collapse;margin:1em 0;font-variant-numeric:tabular-nums}\
                     caption{text-align:left;padding:.2em 0}\
                     th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid #bbb}\
                     th{vertical-align:bottom;border-bottom:2px solid #111}\
                     .text{text-align:left;vertical-align:top}dt{font-weight:bold}\
                     svg,img{max-width:100%;height:auto}figure{margin:1.5em 0;break-inside:avoid}\
                     figcaption{color:#555;font-size:.85em}summary{cursor:pointer;font-weight:bold}";

impl Document {
    pub fn to_html(&self) -> String {
        let title = escaped(&self.title);
        let heading = if title.is_empty() { String::new() } else { format!("<h1>{title}</h1>\n") };
        let mut text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n\
             <title>{title}</title>\n<style>{STYLE}</style>\n{heading}"
        );
        push_blocks(&mut text, &self.blocks);
        text.push_str("</html>\n");
        text
    }
}

fn push_blocks(text: &mut String, blocks: &[Block]) {
    for block in blocks {
        match block {
            Block::Heading(line) => text.push_str(&format!("<h2>{}</h2>\n", escaped(line))),
            Block::Text(line) => text.push_str(&format!("<p>{}</p>\n", escaped(line))),
            Block::List(lines) => {
                let items: String = lines.iter().map(|line| format!("<li>{}</li>\n", escaped(line))).collect();
                text.push_str(&format!("<ul>\n{items}</ul>\n"));
            }
            Block::Links(links) => {
                let item = |(line, file): &(String, String)| {
                    format!("<li><a href=\"{}\">{}</a></li>\n", escaped(file), escaped(line))
                };
                text.push_str(&format!("<ul>\n{}</ul>\n", links.iter().map(item).collect::<String>()));
            }
            Block::Terms(terms) => {
                let term = |(name, meaning): &(String, String)| {
                    format!("<dt>{}</dt><dd>{}</dd>\n", escaped(name), escaped(meaning))
                };
                text.push_str(&format!("<dl>\n{}</dl>\n", terms.iter().map(term).collect::<String>()));
            }
            Block::Table(table) => push_table(text, table),
            Block::Verbatim(lines) => text.push_str(&format!("<pre>{}</pre>\n", escaped(lines))),
            Block::Figure(figure) => {
                let (svg, file) = (&figure.svg, escaped(&figure.file));
                text.push_str(&format!("<figure>\n{svg}<figcaption>{file}.svg and .png</figcaption>\n</figure>\n"));
            }
            Block::Image { caption, png } => {
                let (caption, data) = (escaped(caption), BASE64.encode(png));
                text.push_str("<figure>\n<img alt=\"\" src=\"data:image/png;base64,");
                text.push_str(&data);
                text.push_str(&format!("\">\n<figcaption>{caption}</figcaption>\n</figure>\n"));
            }
            Block::Folded(title, blocks) => {
                text.push_str(&format!("<details><summary>{}</summary>\n", escaped(title)));
                push_blocks(text, blocks);
                text.push_str("</details>\n");
            }
        }
    }
}

fn push_table(text: &mut String, table: &Table) {
    let class = |column: usize| if table.is_text(column) { " class=\"text\"" } else { "" };
    text.push_str("<div class=\"wide\"><table>\n");
    if let Some(caption) = &table.caption {
        text.push_str(&format!("<caption>{}</caption>\n", escaped(caption)));
    }
    let heading = |(column, heading): (usize, &String)| {
        format!("<th{}>{}</th>", class(column), escaped(heading).replace('\n', "<br>"))
    };
    text.push_str(&format!("<tr>{}</tr>\n", table.headings.iter().enumerate().map(heading).collect::<String>()));
    for row in &table.rows {
        let cell = |(column, cell): (usize, &String)| format!("<td{}>{}</td>", class(column), escaped(cell));
        text.push_str(&format!("<tr>{}</tr>\n", row.iter().enumerate().map(cell).collect::<String>()));
    }
    text.push_str("</table></div>\n");
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

#[cfg(test)]
mod tests {
    use crate::document::tests::filled;

    #[test]
    fn nothing_from_a_file_becomes_a_tag() {
        let html = filled("<script>alert('x')</script> | *b* [c](d) & \"e\"").to_html();
        assert!(!html.contains("<script") && !html.contains("'x'"), "{html}");
        assert_eq!(html.matches("&lt;script&gt;").count(), 17, "title twice, and once in each other place");
        assert!(!html.contains("http"), "{html}");
    }
}
