//! Drawings as SVG.

use std::fmt::Write;

use super::drawing::{Drawing, Mark};
use crate::picture::canvas::Point;
use crate::picture::colours::Rgb;
use crate::picture::text::Align;
use crate::untrusted::visible;

/// Height of capitals of the usual fonts without serifs, in font sizes.
const CAPITALS: f32 = 0.72;

impl Drawing {
    /// A whole SVG file, which names no other file; text in it is text.
    pub fn to_svg(&self) -> String {
        let Self { width, height, .. } = self;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" role=\"img\" font-family=\"Helvetica, Arial, sans-serif\">\n\
             <title>{}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n",
            escaped(&self.title)
        );
        for mark in &self.marks {
            push(&mut svg, mark);
        }
        svg.push_str("</svg>\n");
        svg
    }
}

fn push(svg: &mut String, mark: &Mark) {
    let written = match mark {
        Mark::Area { corners, colour, opacity } => {
            let opacity = if *opacity < 1.0 { format!(" fill-opacity=\"{opacity}\"") } else { String::new() };
            writeln!(svg, "<polygon points=\"{}\" fill=\"{}\"{opacity}/>", places(corners), hex(*colour))
        }
        Mark::Line { points, width, colour, dashes } => {
            let dashes = match dashes.as_slice() {
                [] => String::new(),
                dashes => format!(" stroke-dasharray=\"{}\"", joined(dashes)),
            };
            let (places, colour) = (places(points), hex(*colour));
            writeln!(
                svg,
                "<polyline points=\"{places}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" \
                 stroke-linejoin=\"round\"{dashes}/>"
            )
        }
        Mark::Text { text, at: (x, y), align, height, colour } => {
            let anchor = match align {
                Align::Left => "start",
                Align::Centre => "middle",
                Align::Right => "end",
            };
            let (size, colour, text) = (rounded(height / CAPITALS), hex(*colour), escaped(text));
            let (x, y) = (rounded(*x), rounded(*y));
            writeln!(
                svg,
                "<text x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" font-size=\"{size}\" fill=\"{colour}\">{text}</text>"
            )
        }
    };
    written.expect("a string takes any text");
}

fn places(points: &[Point]) -> String {
    let place = |&(x, y): &Point| format!("{},{}", rounded(x), rounded(y));
    points.iter().map(place).collect::<Vec<_>>().join(" ")
}

fn joined(lengths: &[f32]) -> String {
    lengths.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ")
}

/// To a hundredth of a unit, without zeros at the end.
fn rounded(value: f32) -> f32 {
    (value * 100.0).round() / 100.0 + 0.0
}

fn hex([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
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
    use crate::picture::colours::INK;

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
