//! Documents as pages that need no other file and no network, for screens of any width, light or dark, and for paper.

use std::collections::BTreeSet;

use data_encoding::BASE64;

use super::{Block, Document, Figure, Table};
use crate::untrusted::visible_lines;

/// The look of all pages. Colours have names, which a dark screen gives other values; so have those parts of drawings that
/// are no data, by the classes `ink`, `note`, `faint` and `paper` of their marks. Paper is white, whatever the screen is.
const STYLE: &str = "\
:root{color-scheme:light;--paper:#fff;--ink:#111;--soft:#555;--line:#bbb;--link:#0a58a8}\
body{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em;color:var(--ink);background:var(--paper);\
overflow-wrap:break-word}\
a{color:var(--link)}h1{line-height:1.2}h1+p{font-size:1.2em}\
nav ul{list-style:none;padding:.5em 0;display:flex;flex-wrap:wrap;gap:.2em 1.2em;border-block:1px solid var(--line)}\
.wide,pre{overflow-x:auto}pre{white-space:pre-wrap}\
table{border-collapse:collapse;margin:1em 0;font-variant-numeric:tabular-nums}\
caption{text-align:left;padding:.2em 0}\
th,td{padding:.2em .7em;text-align:right;border-bottom:1px solid var(--line);overflow-wrap:normal}\
th{vertical-align:bottom;border-bottom:2px solid var(--ink)}\
td:not(.text){white-space:nowrap}.text{text-align:left;vertical-align:top}dt{font-weight:bold}\
svg,img{max-width:100%;height:auto}img{background:#fff}figure{margin:1.5em 0}\
.phone{display:none}figcaption{color:var(--soft);font-size:.85em}summary{cursor:pointer;font-weight:bold}\
@media(max-width:44em){body{margin:1em auto;padding:0 .8em}h1{font-size:1.5em}h1+p{font-size:1.1em}svg{min-width:600px}\
.desk{display:none}.phone{display:block}.phone svg{min-width:0;width:100%}}\
@media screen and (prefers-color-scheme:dark){\
:root{color-scheme:dark;--paper:#16181c;--ink:#e4e4e8;--soft:#a9a9b2;--line:#4a4c55;--link:#8ab4f8}\
polyline.ink{stroke:#e4e4e8}polyline.faint{stroke:#3c3e46}polyline.paper{stroke:#16181c}\
polygon.ink,text.ink{fill:#e4e4e8}text.note{fill:#a9a9b2}polygon.faint{fill:#3c3e46}polygon.paper,rect.paper{fill:#16181c}}\
@media print{body{max-width:none;margin:0;padding:0;font-size:10pt}nav{display:none}a{color:inherit;text-decoration:none}\
h1,h2,summary,caption{break-after:avoid}figure,tr,li,dt{break-inside:avoid}p{orphans:3;widows:3}.wide{overflow:visible}}\
@media print{details::details-content{content-visibility:visible;display:block}}";

impl Document {
    pub fn to_html(&self) -> String {
        let title = escaped(&self.title);
        let heading = if title.is_empty() { String::new() } else { format!("<h1>{title}</h1>\n") };
        let text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{title}</title>\n<style>{STYLE}</style>\n{heading}"
        );
        let mut page = HtmlPage { text, sections: sections(&self.blocks), started: 0 };
        page.push_blocks(&self.blocks);
        page.text + "</html>\n"
    }
}

/// A heading, and the name by which links find it.
struct HtmlSection<'a> {
    heading: &'a str,
    id: String,
}

/// Lists the sections in the order of the page; each has a name of its own.
fn sections(blocks: &[Block]) -> Vec<HtmlSection<'_>> {
    fn push_headings<'a>(blocks: &'a [Block], headings: &mut Vec<&'a str>) {
        for block in blocks {
            match block {
                Block::Heading(heading) => headings.push(heading),
                Block::Folded(_, blocks) => push_headings(blocks, headings),
                _ => {}
            }
        }
    }
    let mut headings = Vec::new();
    push_headings(blocks, &mut headings);
    let mut taken = BTreeSet::new();
    let section = |heading| {
        let name = id_of(heading);
        let numbered = (2..).map(|number| format!("{name}-{number}"));
        let mut names = std::iter::once(name.clone()).chain(numbered);
        let id = names.find(|id| taken.insert(id.clone())).expect("numbers do not end");
        HtmlSection { heading, id }
    };
    headings.into_iter().map(section).collect()
}

/// Letters and digits of a heading, with hyphens for what is between them.
fn id_of(heading: &str) -> String {
    let parts = heading.split(|letter: char| !letter.is_alphanumeric()).filter(|word| !word.is_empty());
    let id = parts.collect::<Vec<_>>().join("-").to_lowercase();
    if id.is_empty() { "section".into() } else { id }
}

/// A page that is being written.
struct HtmlPage<'a> {
    text: String,
    sections: Vec<HtmlSection<'a>>,
    /// The number of sections that have begun.
    started: usize,
}

impl HtmlPage<'_> {
    fn push_blocks(&mut self, blocks: &[Block]) {
        for block in blocks {
            match block {
                Block::Heading(line) => {
                    // `sections` walked the same blocks in the same order, so this heading is that of the next section.
                    let id = &self.sections[self.started].id;
                    self.text.push_str(&format!("<h2 id=\"{id}\">{}</h2>\n", escaped(line)));
                    self.started += 1;
                }
                // Links lead to later sections too, which is why all were listed before the first was written.
                Block::Contents => {
                    let links: String = self
                        .sections
                        .iter()
                        .map(|section| {
                            format!("<li><a href=\"#{}\">{}</a></li>\n", address(&section.id), escaped(section.heading))
                        })
                        .collect();
                    self.text.push_str(&format!("<nav aria-label=\"Contents\">\n<ul>\n{links}</ul>\n</nav>\n"));
                }
                Block::Folded(title, blocks) => {
                    // Not `push_block`, as headings of the contents may be inside.
                    self.text.push_str(&format!("<details><summary>{}</summary>\n", escaped(title)));
                    self.push_blocks(blocks);
                    self.text.push_str("</details>\n");
                }
                other => push_block(&mut self.text, other),
            }
        }
    }
}

/// Writes a block that neither is nor holds a section.
fn push_block(text: &mut String, block: &Block) {
    match block {
        Block::Text(line) => text.push_str(&format!("<p>{}</p>\n", escaped(line))),
        Block::List(lines) => {
            let items: String = lines.iter().map(|line| format!("<li>{}</li>\n", escaped(line))).collect();
            text.push_str(&format!("<ul>\n{items}</ul>\n"));
        }
        Block::Links(links) => {
            let item = |(line, file): &(String, String)| {
                format!("<li><a href=\"{}\">{}</a></li>\n", address(file), escaped(line))
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
        Block::Figure(figure) => push_figure(text, figure),
        // In the page itself, which must need no other file.
        Block::Image { caption, png } => {
            let caption = escaped(caption);
            let data = BASE64.encode(png);
            // The caption says what the image shows; as an `alt` text a screen reader would read it twice.
            text.push_str("<figure>\n<img alt=\"\" src=\"data:image/png;base64,");
            text.push_str(&data);
            text.push_str(&format!("\">\n<figcaption>{caption}</figcaption>\n</figure>\n"));
        }
        Block::Heading(_) | Block::Contents | Block::Folded(..) => unreachable!("these are written by the page"),
    }
}

/// Returns a drawing that has another form where the window is as narrow as a phone's. Both are in the page itself and not in a
/// `<picture>`, whose images would not follow the colours of the screen.
pub fn wide_and_narrow(wide: &str, narrow: &str) -> String {
    format!("<div class=\"desk\">\n{wide}</div>\n<div class=\"phone\">\n{narrow}</div>\n")
}

/// Writes a drawing, with links to its files by their endings.
fn push_figure(text: &mut String, Figure { svg, file, more_files }: &Figure) {
    text.push_str(&format!("<figure>\n<div class=\"wide\">\n{svg}</div>\n"));
    if let Some(file) = file {
        let forms = ["svg", "png"].map(|ending| format!("{file}.{ending}"));
        let links: String = forms
            .iter()
            .chain(more_files)
            .map(|path| {
                let ending = path.rsplit_once('.').map_or(path.as_str(), |(_, ending)| ending);
                format!(" <a href=\"{}\">{}</a>", address(path), escaped(ending))
            })
            .collect();
        text.push_str(&format!("<figcaption>{}:{links}</figcaption>\n", escaped(file)));
    }
    text.push_str("</figure>\n");
}

fn push_table(text: &mut String, table: &Table) {
    let class = |column: usize| if table.is_text(column) { " class=\"text\"" } else { "" };
    text.push_str("<div class=\"wide\"><table>\n");
    if let Some(caption) = &table.caption {
        text.push_str(&format!("<caption>{}</caption>\n", escaped(caption)));
    }
    let headings: String = table
        .headings
        .iter()
        .enumerate()
        .map(|(column, heading)| format!("<th{}>{}</th>", class(column), escaped(heading).replace('\n', "<br>")))
        .collect();
    text.push_str(&format!("<thead><tr>{headings}</tr></thead>\n"));
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

/// Writes a path, or the name of a section, as it is in a link: of other letters than plain ones their bytes.
fn address(path: &str) -> String {
    let mut address = String::with_capacity(path.len());
    for byte in path.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' => address.push(byte.into()),
            other => address.push_str(&format!("%{other:02X}")),
        }
    }
    address
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::tests::filled;

    #[test]
    fn every_link_of_the_contents_has_its_target() {
        let headings = ["Means", "Über <b>", "Means", "means 2", "?!", "Means-2"];
        let document =
            Document::new("title").with([Block::Contents]).with(headings.map(|it| Block::Heading(it.into())));
        let html = document.to_html();
        for (heading, id, link) in [
            ("Means", "means", "means"),
            ("Über &lt;b&gt;", "über-b", "%C3%BCber-b"),
            ("Means", "means-2", "means-2"),
            ("means 2", "means-2-2", "means-2-2"),
            ("?!", "section", "section"),
            ("Means-2", "means-2-3", "means-2-3"),
        ] {
            assert!(html.contains(&format!("<h2 id=\"{id}\">{heading}</h2>")), "{id}: {html}");
            assert!(html.contains(&format!("<a href=\"#{link}\">{heading}</a>")), "{link}: {html}");
        }
        assert_eq!(html.matches(" id=\"").count(), headings.len());
    }

    #[test]
    fn figure_links_its_files() {
        let more_files = vec!["charts/a b.csv".into()];
        let figure = Figure { svg: "<svg></svg>\n".into(), file: Some("charts/a b-2".into()), more_files };
        let html = Document::new("title").with([Block::Figure(figure)]).to_html();
        for link in ["charts/a%20b-2.svg\">svg<", "charts/a%20b-2.png\">png<", "charts/a%20b.csv\">csv<"] {
            assert!(html.contains(&format!("<a href=\"{link}")), "{link}: {html}");
        }
    }

    #[test]
    fn no_link_leaves_the_folder_of_the_page_for_another_scheme() {
        let links = vec![("words".to_owned(), "javascript:alert(1)".to_owned())];
        let html = Document::new("title").with([Block::Links(links)]).to_html();
        assert!(html.contains("href=\"javascript%3Aalert%281%29\""), "{html}");
    }

    #[test]
    fn nothing_from_a_file_becomes_a_tag() {
        let html = filled("<script>alert('x')</script> | *b* [c](d) & \"e\"").to_html();
        assert!(!html.contains("<script") && !html.contains("'x'"), "{html}");
        assert_eq!(html.matches("&lt;script&gt;").count(), 17, "title twice, and once in each other place");
        assert!(!html.contains("http"), "{html}");
    }
}
