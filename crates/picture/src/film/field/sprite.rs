//! Small vector drawings, read from text files in `assets/sprites/`.
//!
//! A line of a file is a shape; later ones lie over earlier ones, and `//` begins a comment. x points right (of agents:
//! forward), y up (of agents: to the left), in units that the file names:
//! ```text
//! area COLOUR x,y x,y ...           the inside of a closed line of straight pieces
//! blob COLOUR x,y x,y ...           the inside of a smooth closed line, drawn towards the points in turn
//! disc COLOUR radius x,y ...        discs
//! line COLOUR width x,y x,y ...     a line of straight pieces
//! curve COLOUR width x,y x,y ...    a smooth line, drawn towards the points between its ends
//! ```
//! `both` before a shape draws it a second time, mirrored at the x axis. A colour is `#rrggbb`, or the name of one that
//! has a meaning everywhere; `/0.5` after it makes it half transparent.

use std::sync::LazyLock;

use tiny_skia::{Path, PathBuilder, PathSegment, Transform};

use crate::canvas::{Canvas, Ink, Point, closed, open};
use crate::colours::{BURNED_OUT, BURNING, EXTINGUISHED, INK, INTACT, PAPER, Rgb, UNIMOG, WUMPUS};
use crate::marks::to_f32;
use wildfire_base::geometry::ops;

/// A drawing in its own units.
#[derive(Debug)]
pub struct Sprite {
    shapes: Vec<SpriteShape>,
}

#[derive(Debug)]
struct SpriteShape {
    path: Path,
    ink: Ink,
    /// The width of a line; `None` fills the path.
    width: Option<f32>,
}

/// The same with its path in the notation of SVG.
#[derive(Debug)]
pub struct SvgShape {
    pub path: String,
    pub ink: Ink,
    pub width: Option<f32>,
}

/// The place, size and direction of a sprite on a canvas.
#[derive(Clone, Copy, Debug)]
pub struct Placement(Transform);

impl Placement {
    /// Its origin at a place, its x axis to the right; pixels a unit along x and along y. The y axis leans to the right
    /// by that many units of x for one of y.
    pub fn leaning((x, y): Point, (along, up): (f32, f32), lean: f32) -> Self {
        Self(Transform::from_row(along, 0.0, lean * along, -up, x, y))
    }

    /// Turned to a heading in radians, counter-clockwise from the right; pixels a unit forward and to the side.
    pub fn turned((x, y): Point, heading: f64, (along, across): (f32, f32)) -> Self {
        let (sin, cos) = ops::sin_cos(heading);
        let (sin, cos) = (to_f32(sin), to_f32(cos));
        Self(Transform::from_row(along * cos, -along * sin, -across * sin, -across * cos, x, y))
    }
}

impl Sprite {
    /// `None` if a line is no shape.
    pub fn read(text: &str) -> Option<Self> {
        let lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
        let mut shapes = Vec::new();
        for line in lines {
            match line.strip_prefix("both ") {
                Some(shape) => shapes.extend([read_shape(shape, 1.0)?, read_shape(shape, -1.0)?]),
                None => shapes.push(read_shape(line, 1.0)?),
            }
        }
        Some(Self { shapes })
    }

    pub fn draw(&self, canvas: &mut Canvas, placement: Placement) {
        for shape in &self.shapes {
            match shape.width {
                Some(width) => canvas.stroke_shape(&shape.path, placement.0, width, shape.ink),
                None => canvas.fill_shape(&shape.path, placement.0, shape.ink),
            }
        }
    }

    /// Its shapes, the lowest first.
    pub fn shapes_as_svg(&self) -> impl Iterator<Item = SvgShape> + '_ {
        self.shapes.iter().map(|shape| SvgShape { path: svg_path(&shape.path), ink: shape.ink, width: shape.width })
    }

    /// The largest distance of a point that it is drawn towards from its origin, along each axis, in its units.
    #[cfg(test)]
    pub fn reach(&self) -> (f32, f32) {
        let points = self.shapes.iter().flat_map(|shape| shape.path.points());
        points.fold((0.0, 0.0), |(x, y), point| (x.max(point.x.abs()), y.max(point.y.abs())))
    }
}

/// `side` is -1 for the mirrored shape, else 1.
fn read_shape(line: &str, side: f32) -> Option<SpriteShape> {
    let mut tokens = line.split_whitespace();
    let kind = tokens.next()?;
    let ink = read_ink(tokens.next()?)?;
    let size = match kind {
        "disc" | "line" | "curve" => Some(tokens.next()?.parse().ok()?),
        _ => None,
    };
    let points: Option<Vec<Point>> = tokens.map(|word| read_point(word, side)).collect();
    let points = points.filter(|points| !points.is_empty())?;
    let (path, width) = match (kind, size) {
        ("area", None) => (closed(&points), None),
        ("blob", None) => (smooth_closed(&points).finish(), None),
        ("disc", Some(radius)) => (discs(&points, radius).finish(), None),
        ("line", Some(_)) => (open(&points).finish(), size),
        ("curve", Some(_)) => (smooth_open(&points).finish(), size),
        _ => return None,
    };
    Some(SpriteShape { path: path?, ink, width })
}

fn read_point(word: &str, side: f32) -> Option<Point> {
    let (x, y) = word.split_once(',')?;
    Some((x.parse().ok()?, side * y.parse::<f32>().ok()?))
}

fn read_ink(word: &str) -> Option<Ink> {
    let (name, opacity) = word.split_once('/').unwrap_or((word, "1"));
    Some(Ink { colour: read_colour(name)?, opacity: opacity.parse().ok()? })
}

fn read_colour(name: &str) -> Option<Rgb> {
    if let Some(digits) = name.strip_prefix('#') {
        let number = u32::from_str_radix(digits, 16).ok().filter(|_| digits.len() == 6)?;
        let [_, red, green, blue] = number.to_be_bytes();
        return Some([red, green, blue]);
    }
    Some(match name {
        "paper" => PAPER,
        "ink" => INK,
        "intact" => INTACT,
        "burning" => BURNING,
        "burned-out" => BURNED_OUT,
        "extinguished" => EXTINGUISHED,
        "wumpus" => WUMPUS,
        "unimog" => UNIMOG,
        _ => return None,
    })
}

fn svg_path(path: &Path) -> String {
    let point = |at: tiny_skia::Point| format!("{},{}", short(at.x), short(at.y));
    let segment = |segment: PathSegment| match segment {
        PathSegment::MoveTo(to) => format!("M{}", point(to)),
        PathSegment::LineTo(to) => format!("L{}", point(to)),
        PathSegment::QuadTo(by, to) => format!("Q{} {}", point(by), point(to)),
        PathSegment::CubicTo(first, second, to) => format!("C{} {} {}", point(first), point(second), point(to)),
        PathSegment::Close => "Z".to_owned(),
    };
    path.segments().map(segment).collect()
}

/// The number to a ten-thousandth, without what says nothing.
fn short(number: f32) -> f32 {
    // Adding 0 makes 0 of -0.
    (number * 1e4).round() / 1e4 + 0.0
}

/// Quadratic curves from middle to middle of the sides, the points between being their control points.
fn smooth_closed(points: &[Point]) -> PathBuilder {
    let mut path = PathBuilder::new();
    let start = middle(points[points.len() - 1], points[0]);
    path.move_to(start.0, start.1);
    for (index, &(x, y)) in points.iter().enumerate() {
        let to = middle((x, y), points[(index + 1) % points.len()]);
        path.quad_to(x, y, to.0, to.1);
    }
    path.close();
    path
}

fn smooth_open(points: &[Point]) -> PathBuilder {
    let mut path = PathBuilder::new();
    path.move_to(points[0].0, points[0].1);
    let last = points.len() - 1;
    for (index, &(x, y)) in points.iter().enumerate().take(last).skip(1) {
        let next = points[index + 1];
        let to = if index + 1 == last { next } else { middle((x, y), next) };
        path.quad_to(x, y, to.0, to.1);
    }
    path
}

fn discs(centres: &[Point], radius: f32) -> PathBuilder {
    let mut path = PathBuilder::new();
    centres.iter().for_each(|&(x, y)| path.push_circle(x, y, radius));
    path
}

fn middle(a: Point, b: Point) -> Point {
    (0.5 * (a.0 + b.0), 0.5 * (a.1 + b.1))
}

pub static BUSH_SPRITE: LazyLock<Sprite> =
    LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/bush.txt")));
pub static EMBERS_SPRITE: LazyLock<Sprite> =
    LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/embers.txt")));
pub static BURNED_SPRITE: LazyLock<Sprite> =
    LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/burned.txt")));
pub static WET_SPRITE: LazyLock<Sprite> = LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/wet.txt")));
pub static FLAME_SPRITE: LazyLock<Sprite> =
    LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/flame.txt")));
pub static WUMPUS_SPRITE: LazyLock<Sprite> =
    LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/wumpus.txt")));
pub static UNIMOG_SPRITE: LazyLock<Sprite> =
    LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/unimog.txt")));
pub static WHEEL_SPRITE: LazyLock<Sprite> =
    LazyLock::new(|| read_asset(include_str!("../../../assets/sprites/wheel.txt")));

fn read_asset(text: &str) -> Sprite {
    Sprite::read(text).expect("sprites are part of the program, and a test reads all of them")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns how many pixels of a sheet of 40 x 40 a sprite leaves its first colour on, 10 pixels a unit about the
    /// middle.
    fn covered(text: &str) -> usize {
        let mut canvas = Canvas::new(40, 40, PAPER);
        Sprite::read(text).expect("a sprite").draw(&mut canvas, Placement::leaning((20.0, 20.0), (10.0, 10.0), 0.0));
        let picture = canvas.finish();
        (0..1600).filter(|index| picture.pixel(index % 40, index / 40) == INK).count()
    }

    #[test]
    fn shapes_cover_what_they_say() {
        assert_eq!(covered("// a square\narea ink -1,-1 1,-1 1,1 -1,1"), 400);
        assert_eq!(covered("both area ink -1,0 1,0 1,1 -1,1"), 400);
        assert!((250..=314).contains(&covered("disc ink 1 0,0")));
        // A quarter of the square's corners is cut off by quadratic curves: a sixth of its area.
        assert!((290..=334).contains(&covered("blob ink -1,-1 1,-1 1,1 -1,1")));
        assert_eq!(covered("line ink 1 -1,0 1,0"), covered("curve ink 1 -1,0 0,0 1,0"));
    }

    #[test]
    fn x_is_turned_to_the_heading_and_y_to_its_left() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for (text, heading, (x, y)) in [
            ("area ink 0.5,-0.5 1.5,-0.5 1.5,0.5 0.5,0.5", 0.0, (30, 20)),
            ("area ink 0.5,-0.5 1.5,-0.5 1.5,0.5 0.5,0.5", quarter, (20, 10)),
            ("area ink -0.5,0.5 0.5,0.5 0.5,1.5 -0.5,1.5", 0.0, (20, 10)),
            ("area ink -0.5,0.5 0.5,0.5 0.5,1.5 -0.5,1.5", quarter, (10, 20)),
        ] {
            let mut canvas = Canvas::new(40, 40, PAPER);
            let placement = Placement::turned((20.0, 20.0), heading, (10.0, 10.0));
            Sprite::read(text).expect("a sprite").draw(&mut canvas, placement);
            assert_eq!(canvas.finish().pixel(x, y), INK, "{text} at {heading}");
        }
    }

    #[test]
    fn what_is_no_shape_is_refused() {
        for line in [
            "area",
            "area ink",
            "area ink 1",
            "area puce 0,0 1,0 1,1",
            "area #12 0,0 1,0 1,1",
            "area ink/half 0,0 1,0 1,1",
            "disc ink 0,0",
            "line ink 1 0,0",
            "curve ink 1 0,0 1,1",
            "star ink 0,0 1,0 1,1",
        ] {
            assert!(Sprite::read(line).is_none(), "{line}");
        }
    }

    #[test]
    fn sprites_stay_near_what_they_stand_for() {
        // Points pull smooth lines, which stay inside them; a torch and its flame stick out of the square body.
        for (name, sprite, (along, across)) in [
            ("bush", &BUSH_SPRITE, (0.65, 0.65)),
            ("embers", &EMBERS_SPRITE, (0.65, 0.65)),
            ("burned", &BURNED_SPRITE, (0.65, 0.65)),
            ("wet", &WET_SPRITE, (0.65, 0.65)),
            ("flame", &FLAME_SPRITE, (0.5, 1.15)),
            ("wumpus", &WUMPUS_SPRITE, (0.95, 0.6)),
            ("unimog", &UNIMOG_SPRITE, (2.45, 1.1)),
            ("wheel", &WHEEL_SPRITE, (0.5, 0.2)),
        ] {
            let reach = sprite.reach();
            assert!(reach.0 <= along && reach.1 <= across, "{name} reaches {reach:?}");
        }
    }
}
