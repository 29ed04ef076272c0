//! A chart as marks on a sheet, and these marks as pixels and as SVG.

use std::fmt::Write;

use crate::canvas::{Canvas, Point};
use crate::colours::{FAINT_INK, INK, NOTE_INK, PAPER, Rgb};
use crate::png::Picture;
use crate::text::{Align, draw_text};
use wildfire_base::untrusted::visible;

/// Marks on a sheet, in the order in which they are drawn; places are in units to the right and down from the upper
/// left corner. A unit is a pixel of a screen.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub width: f32,
    pub height: f32,
    pub(super) title: String,
    pub(super) marks: Vec<DrawingMark>,
}

/// A mark on a sheet.
#[derive(Clone, Debug, PartialEq)]
pub enum DrawingMark {
    /// The inside of a closed line; opacity from 0 to 1.
    Area { corners: Vec<Point>, colour: Rgb, opacity: f32 },
    /// Straight pieces; lengths of dashes and gaps in units, none of a line without gaps.
    Line { points: Vec<Point>, width: f32, colour: Rgb, dashes: Vec<f32> },
    /// A line of text on a base line; capitals are `height` units high.
    Text { text: String, at: Point, align: Align, height: f32, colour: Rgb },
}

impl Drawing {
    pub fn new(width: f32, height: f32, title: &str) -> Self {
        Self { width, height, title: title.into(), marks: Vec::new() }
    }

    /// All lines of text on it.
    pub fn texts(&self) -> impl Iterator<Item = &str> {
        self.marks.iter().filter_map(|mark| match mark {
            DrawingMark::Text { text, .. } => Some(text.as_str()),
            DrawingMark::Area { .. } | DrawingMark::Line { .. } => None,
        })
    }

    /// All places of its marks.
    pub fn points(&self) -> impl Iterator<Item = Point> {
        self.marks.iter().flat_map(|mark| match mark {
            DrawingMark::Area { corners: points, .. } | DrawingMark::Line { points, .. } => points.clone(),
            DrawingMark::Text { at, .. } => vec![*at],
        })
    }

    pub fn area(&mut self, corners: Vec<Point>, colour: Rgb, opacity: f32) {
        self.marks.push(DrawingMark::Area { corners, colour, opacity });
    }

    pub fn rect(&mut self, (left, top): Point, (right, bottom): Point, colour: Rgb) {
        self.area(vec![(left, top), (right, top), (right, bottom), (left, bottom)], colour, 1.0);
    }

    pub fn line(&mut self, points: Vec<Point>, width: f32, colour: Rgb) {
        self.dashed(points, width, colour, &[]);
    }

    pub fn dashed(&mut self, points: Vec<Point>, width: f32, colour: Rgb, dashes: &[f32]) {
        self.marks.push(DrawingMark::Line { points, width, colour, dashes: dashes.to_vec() });
    }

    pub fn text(&mut self, text: &str, at: Point, align: Align, height: f32, colour: Rgb) {
        self.marks.push(DrawingMark::Text { text: text.into(), at, align, height, colour });
    }

    /// The drawing with two pixels for each unit.
    pub fn paint(&self) -> Picture {
        let mut canvas = Canvas::sized(self.width * PIXELS, self.height * PIXELS, PAPER);
        for mark in &self.marks {
            paint_mark(&mut canvas, mark);
        }
        canvas.finish()
    }

    /// A whole SVG file, which names no other file; text in it is text. Marks that are no data have a class besides their
    /// colour, by which a page gives them others on a dark screen.
    pub fn to_svg(&self) -> String {
        let Self { width, height, .. } = self;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" font-family=\"Helvetica, Arial, sans-serif\">\n\
             <title>{}</title>\n<rect width=\"{width}\" height=\"{height}\"{}/>\n",
            escaped(&self.title),
            painted("fill", PAPER)
        );
        for mark in &self.marks {
            push_mark(&mut svg, mark);
        }
        svg.push_str("</svg>\n");
        svg
    }
}

/// Pixels of a unit: enough for print at the width of a column.
const PIXELS: f32 = 2.0;

fn paint_mark(canvas: &mut Canvas, mark: &DrawingMark) {
    let place = |&(x, y): &Point| (x * PIXELS, y * PIXELS);
    let places = |points: &[Point]| points.iter().map(place).collect::<Vec<_>>();
    match mark {
        DrawingMark::Area { corners, colour, opacity } => canvas.fill_through(&places(corners), *colour, *opacity),
        DrawingMark::Line { points, width, colour, dashes } if dashes.is_empty() => {
            canvas.polyline(&places(points), width * PIXELS, *colour);
        }
        DrawingMark::Line { points, width, colour, dashes } => {
            let dashes = dashes.iter().map(|length| length * PIXELS).collect();
            canvas.dashed_by(&places(points), width * PIXELS, *colour, dashes);
        }
        DrawingMark::Text { text, at, align, height, colour } => {
            draw_text(canvas, text, place(at), *align, height * PIXELS, *colour);
        }
    }
}

/// Height of capitals of the usual fonts without serifs, in font sizes.
pub const CAPITALS: f32 = 0.72;

fn push_mark(svg: &mut String, mark: &DrawingMark) {
    let written = match mark {
        DrawingMark::Area { corners, colour, opacity } => {
            // SVG is opaque by default, which keeps files of many areas short.
            let opacity = if *opacity < 1.0 { format!(" fill-opacity=\"{opacity}\"") } else { String::new() };
            writeln!(svg, "<polygon points=\"{}\"{}{opacity}/>", places(corners), painted("fill", *colour))
        }
        DrawingMark::Line { points, width, colour, dashes } => {
            let dashes = match dashes.as_slice() {
                [] => String::new(),
                dashes => format!(" stroke-dasharray=\"{}\"", joined(dashes)),
            };
            let places = places(points);
            let stroke = painted("stroke", *colour);
            writeln!(
                svg,
                "<polyline points=\"{places}\" fill=\"none\"{stroke} stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\"{dashes}/>"
            )
        }
        DrawingMark::Text { text, at: (x, y), align, height, colour } => {
            let anchor = match align {
                Align::Left => "start",
                Align::Centre => "middle",
                Align::Right => "end",
            };
            // SVG sizes a font by its em, while heights here are those of capitals.
            let size = rounded(height / CAPITALS);
            let fill = painted("fill", *colour);
            let text = escaped(text);
            let (x, y) = (rounded(*x), rounded(*y));
            writeln!(svg, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{size}\"{fill}>{text}</text>")
        }
    };
    written.expect("a string takes any text");
}

fn places(points: &[Point]) -> String {
    points.iter().map(|&(x, y)| format!("{},{}", rounded(x), rounded(y))).collect::<Vec<_>>().join(" ")
}

fn joined(lengths: &[f32]) -> String {
    lengths.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// Rounds to a hundredth of a unit, so that no zeros stand at the end.
fn rounded(value: f32) -> f32 {
    // Adding 0 makes 0 of -0, which SVG would show with its sign.
    (value * 100.0).round() / 100.0 + 0.0
}

/// The classes of colours that are no data.
pub const CLASSES: [(Rgb, &str); 4] = [(INK, "ink"), (NOTE_INK, "note"), (FAINT_INK, "faint"), (PAPER, "paper")];

/// Writes the colour of an attribute, and its class if it has one.
fn painted(attribute: &str, colour: Rgb) -> String {
    let [red, green, blue] = colour;
    let class = CLASSES.iter().find(|(class_colour, _)| *class_colour == colour);
    let class = class.map_or_else(String::new, |(_, class)| format!(" class=\"{class}\""));
    format!(" {attribute}=\"#{red:02x}{green:02x}{blue:02x}\"{class}")
}

/// Escapes text for XML: what XML does not have becomes a space, what would act on other text an escape.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in visible(text).chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push(' '),
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colours::INK;

    #[test]
    fn no_text_becomes_a_tag() {
        let mut drawing = Drawing::new(10.0, 10.0, "<b>&\"");
        drawing.text("</text><script>\u{0}", (1.0, 2.0), Align::Left, 10.0, INK);
        let svg = drawing.to_svg();
        assert!(svg.contains("<title>&lt;b&gt;&amp;&quot;</title>"), "{svg}");
        assert!(svg.contains(">&lt;/text&gt;&lt;script&gt;\\u0000</text>"), "{svg}");
    }

    #[test]
    fn lengths_are_short_and_never_minus_zero() {
        assert_eq!(rounded(0.123_456).to_string(), "0.12");
        assert_eq!(rounded(-0.000_01).to_string(), "0");
    }
}
