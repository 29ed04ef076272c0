//! Charts for papers: as PDF with letters as outlines, and as PGF, whose text LaTeX sets in the paper's font.

use std::fmt::Write;

use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use tiny_skia::{Path, PathSegment};

use crate::canvas::Point;
use crate::charts::drawing::{CAPITALS, Drawing, DrawingMark};
use crate::charts::sheet::LABEL;
use crate::colours::Rgb;
use crate::text::{Align, text_path};
use wildfire_base::document::escaped_latex;

/// The size of a chart on paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperSize {
    pub width_mm: f32,
    /// The size of the letters of axes.
    pub font_pt: f32,
}

const POINTS_PER_MM: f32 = 72.0 / 25.4;

/// The narrowest sheets, in units: room for two ticks, and for words in lines.
const NARROWEST: f32 = 240.0;

impl PaperSize {
    /// Returns the least width in millimetres of charts with letters of this size.
    pub fn min_width_mm(font_pt: f32) -> f32 {
        NARROWEST * Self { width_mm: 1.0, font_pt }.points_per_unit() / POINTS_PER_MM
    }

    /// Returns the width in units of the drawing that has this size on paper.
    pub fn units(&self) -> f32 {
        self.width_mm * POINTS_PER_MM / self.points_per_unit()
    }

    fn points_per_unit(&self) -> f32 {
        self.font_pt * CAPITALS / LABEL
    }
}

/// Letters are fitted to whole units of this fineness.
const OUTLINE: f32 = 16.0;
/// How hard the compressor works.
const LEVEL: u8 = 9;

impl Drawing {
    /// Returns a PDF file of one page. It has no date, so the same drawing gives the same bytes.
    pub fn to_pdf(&self, size: PaperSize) -> Vec<u8> {
        let scale = size.points_per_unit();
        let [catalog, pages, page, content, info] = [1, 2, 3, 4, 5].map(Ref::new);
        let opacities = self.opacities();
        let mut pdf = Pdf::new();
        // Publishers take no more than 1.5, pdfTeX warns of more than it writes itself; opacity needs 1.4.
        pdf.set_version(1, 5);
        pdf.catalog(catalog).pages(pages);
        pdf.document_info(info).title(TextStr(&self.title)).producer(TextStr("wildfire"));
        pdf.pages(pages).kids([page]).count(1);
        let mut sheet = pdf.page(page);
        sheet.media_box(Rect::new(0.0, 0.0, self.width * scale, self.height * scale)).parent(pages).contents(content);
        let mut resources = sheet.resources();
        let mut states = resources.ext_g_states();
        for index in 0..opacities.len() {
            states.pair(Name(state_name(index).as_bytes()), Ref::new(6 + index as i32));
        }
        states.finish();
        resources.finish();
        sheet.finish();
        // Only fills need a state, as lines are always opaque.
        for (index, &opacity) in opacities.iter().enumerate() {
            pdf.ext_graphics(Ref::new(6 + index as i32)).non_stroking_alpha(opacity);
        }
        let marks = self.pdf_marks(scale, &opacities);
        pdf.stream(content, &compress_to_vec_zlib(&marks, LEVEL)).filter(Filter::FlateDecode);
        pdf.finish()
    }

    /// Lists the opacities of areas, each once.
    fn opacities(&self) -> Vec<f32> {
        let mut found = vec![1.0];
        for mark in &self.marks {
            if let DrawingMark::Area { opacity, .. } = mark
                && !found.contains(opacity)
            {
                found.push(*opacity);
            }
        }
        found
    }

    fn pdf_marks(&self, scale: f32, opacities: &[f32]) -> Vec<u8> {
        let mut content = Content::new();
        // Units go down from the upper left corner, points up from the lower left one.
        content.transform([scale, 0.0, 0.0, -scale, 0.0, self.height * scale]);
        content.set_line_join(LineJoinStyle::RoundJoin).set_line_cap(LineCapStyle::ButtCap);
        for mark in &self.marks {
            match mark {
                DrawingMark::Area { corners, colour, opacity } => {
                    // Each opacity is one state of the page, as PDF has no opacity of a single mark.
                    let index = opacities.iter().position(|other| other == opacity).unwrap_or(0);
                    content.set_parameters(Name(state_name(index).as_bytes()));
                    fill_colour(&mut content, *colour);
                    push_points(&mut content, corners);
                    content.close_path().fill_nonzero();
                }
                DrawingMark::Line { points, width, colour, dashes } => {
                    let [red, green, blue] = shares(*colour);
                    content.set_stroke_rgb(red, green, blue).set_line_width(*width);
                    content.set_dash_pattern(dashes.iter().copied(), 0.0);
                    push_points(&mut content, points);
                    content.stroke();
                }
                DrawingMark::Text { text, at: (x, y), align, height, colour } => {
                    // Letters are fitted at a finer size, or small ones would be rounded to whole units.
                    let at = (x * OUTLINE, y * OUTLINE);
                    let Some(outlines) = text_path(text, at, *align, height * OUTLINE) else { continue };
                    // The state of an area before would make the letters transparent too.
                    content.set_parameters(Name(state_name(0).as_bytes()));
                    fill_colour(&mut content, *colour);
                    push_outlines(&mut content, &outlines);
                    content.fill_nonzero();
                }
            }
        }
        content.finish().to_vec()
    }

    /// Returns a picture for `\input` in LaTeX, where it needs `\usepackage{pgf}`.
    pub fn to_pgf(&self, size: PaperSize) -> String {
        let scale = size.points_per_unit();
        // PGF counts upwards from the lower left corner, in PostScript's points.
        let point = |(x, y): Point| format!("\\pgfpoint{{{:.2}bp}}{{{:.2}bp}}", x * scale, (self.height - y) * scale);
        // In a group, as every mark defines the colour `wildfire` again, which must not reach the document.
        let mut pgf = format!(
            "% {}\n% \\usepackage{{pgf}}, then \\input this file.\n\\begingroup\n\\begin{{pgfpicture}}\n\
             \\pgfpathrectangle{{\\pgfpointorigin}}{{{}}}\\pgfusepath{{use as bounding box}}\n\
             \\pgfsetroundjoin\n",
            one_line(&self.title),
            point((self.width, 0.0))
        );
        for mark in &self.marks {
            let written = match mark {
                // Letters after it would be as transparent as the area.
                DrawingMark::Area { corners, colour, opacity } => writeln!(
                    pgf,
                    "{}\\pgfsetfillcolor{{wildfire}}\\pgfsetfillopacity{{{opacity}}}{}\\pgfpathclose\\pgfusepath{{fill}}\
                     \\pgfsetfillopacity{{1}}",
                    defined(*colour),
                    path(corners, point)
                ),
                DrawingMark::Line { points, width, colour, dashes } => {
                    let dashes: String = dashes.iter().map(|length| format!("{{{:.2}bp}}", length * scale)).collect();
                    writeln!(
                        pgf,
                        "{}\\pgfsetstrokecolor{{wildfire}}\\pgfsetlinewidth{{{:.2}bp}}\\pgfsetdash{{{dashes}}}{{0pt}}{}\
                         \\pgfusepath{{stroke}}",
                        defined(*colour),
                        width * scale,
                        path(points, point)
                    )
                }
                DrawingMark::Text { text, at, align, height, colour } => {
                    let side = match align {
                        Align::Left => ",left",
                        Align::Centre => "",
                        Align::Right => ",right",
                    };
                    // `\fontsize` wants the distance of lines too, which a single line does not use.
                    let font = height / CAPITALS * scale;
                    writeln!(
                        pgf,
                        "{}\\pgftext[at={},base{side}]{{\\color{{wildfire}}\\fontsize{{{font:.2}bp}}{{{:.2}bp}}\\selectfont{{}}{}}}",
                        defined(*colour),
                        point(*at),
                        1.2 * font,
                        escaped_latex(text)
                    )
                }
            };
            written.expect("a string takes any text");
        }
        pgf.push_str("\\end{pgfpicture}\n\\endgroup\n");
        pgf
    }
}

fn state_name(index: usize) -> String {
    format!("g{index}")
}

fn shares(colour: Rgb) -> [f32; 3] {
    colour.map(|part| f32::from(part) / 255.0)
}

fn fill_colour(content: &mut Content, colour: Rgb) {
    let [red, green, blue] = shares(colour);
    content.set_fill_rgb(red, green, blue);
}

fn push_points(content: &mut Content, points: &[Point]) {
    for (index, &(x, y)) in points.iter().enumerate() {
        if index == 0 {
            content.move_to(x, y);
        } else {
            content.line_to(x, y);
        }
    }
}

fn push_outlines(content: &mut Content, outlines: &Path) {
    let mut pen = (0.0, 0.0);
    let place = |point: tiny_skia::Point| (point.x / OUTLINE, point.y / OUTLINE);
    for segment in outlines.segments() {
        match segment {
            PathSegment::MoveTo(to) => {
                pen = place(to);
                content.move_to(pen.0, pen.1);
            }
            PathSegment::LineTo(to) => {
                pen = place(to);
                content.line_to(pen.0, pen.1);
            }
            PathSegment::QuadTo(by, to) => {
                // PDF knows curves of the third degree alone: the same curve has its handles two thirds of the way.
                let (by, to) = (place(by), place(to));
                let handle = |end: Point| (end.0 + (by.0 - end.0) * 2.0 / 3.0, end.1 + (by.1 - end.1) * 2.0 / 3.0);
                let (one, other) = (handle(pen), handle(to));
                content.cubic_to(one.0, one.1, other.0, other.1, to.0, to.1);
                pen = to;
            }
            PathSegment::CubicTo(one, other, to) => {
                let (one, other) = (place(one), place(other));
                pen = place(to);
                content.cubic_to(one.0, one.1, other.0, other.1, pen.0, pen.1);
            }
            PathSegment::Close => {
                content.close_path();
            }
        }
    }
}

fn path(points: &[Point], point: impl Fn(Point) -> String) -> String {
    points
        .iter()
        .enumerate()
        .map(|(index, &at)| {
            let command = if index == 0 { "\\pgfpathmoveto" } else { "\\pgfpathlineto" };
            format!("{command}{{{}}}", point(at))
        })
        .collect()
}

fn defined([red, green, blue]: Rgb) -> String {
    format!("\\definecolor{{wildfire}}{{RGB}}{{{red},{green},{blue}}}")
}

/// Returns text for a comment, which no letter of it ends.
fn one_line(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::INK;

    const COLUMN: PaperSize = PaperSize { width_mm: 88.0, font_pt: 8.0 };

    fn drawing() -> Drawing {
        let mut drawing = Drawing::new(COLUMN.units(), 200.0, "A chart\n\\input{x}");
        drawing.rect((10.0, 10.0), (50.0, 60.0), INK);
        drawing.area(vec![(1.0, 1.0), (9.0, 1.0), (5.0, 9.0)], [213, 94, 0], 0.2);
        drawing.dashed(vec![(0.0, 100.0), (90.0, 120.0)], 2.0, INK, &[8.0, 4.0]);
        drawing.text("50 % of \\cell_m & Größe", (30.0, 150.0), Align::Centre, LABEL, INK);
        drawing
    }

    #[test]
    fn a_page_has_the_requested_width_and_the_same_bytes_each_time() {
        let pdf = drawing().to_pdf(COLUMN);
        assert!(pdf.starts_with(b"%PDF-1.5\n") && pdf.ends_with(b"%%EOF"));
        assert_eq!(pdf, drawing().to_pdf(COLUMN));
        let text = String::from_utf8_lossy(&pdf);
        let at = text.find("/MediaBox [").expect("a page has a size") + "/MediaBox [".len();
        let numbers: Vec<f32> =
            text[at..].split([' ', ']']).take(4).map(|number| number.parse().expect("a number")).collect();
        assert!((numbers[2] - 88.0 * POINTS_PER_MM).abs() < 0.01, "{numbers:?}");
        assert!((numbers[3] - 200.0 * 8.0 * CAPITALS / LABEL).abs() < 0.01, "{numbers:?}");
    }

    #[test]
    fn no_text_is_a_command_of_latex() {
        let pgf = drawing().to_pgf(COLUMN);
        assert!(pgf.starts_with("% A chart \\input{x}\n"), "{pgf}");
        assert!(pgf.contains("50 \\% of \\textbackslash{}cell\\_m \\& Größe"), "{pgf}");
        let count = |brace: char, escaped: &str| pgf.matches(brace).count() - pgf.matches(escaped).count();
        assert_eq!(count('{', "\\{"), count('}', "\\}"));
    }

    #[test]
    fn smaller_paper_has_fewer_units_and_larger_letters_too() {
        let wide = PaperSize { width_mm: 180.0, ..COLUMN };
        assert!((wide.units() / COLUMN.units() - 180.0 / 88.0).abs() < 1e-4);
        let large = PaperSize { font_pt: 16.0, ..COLUMN };
        assert!((COLUMN.units() / large.units() - 2.0).abs() < 1e-4);
    }
}
