//! GeoJSON: polygons, whose cells are the bushes of a given field, and lines, whose cells are roads.
//!
//! A cell is a bush where its centre lies in a polygon and in none of its holes, of which the even-odd rule decides. The
//! field is the rectangle about all polygons, from its south-west corner on in whole cells. Feet become metres; metres of the
//! web's Mercator projection become degrees. Degrees are projected about the middle of that rectangle: x = R cos(middle latitude) (longitude - middle longitude), y = R (latitude - middle latitude),
//! which is true to a few decimetres within ten kilometres. A line makes a road of every cell that it crosses; only metres are
//! accepted there, as other files say where the field is.
//!
//! Sources: H. Butler and others, "The GeoJSON Format", RFC 7946, 2016; J. P. Snyder, "Map Projections: A Working Manual",
//! U.S. Geological Survey Professional Paper 1395, 1987, chapter 12, "Equidistant cylindrical projection".

use std::fmt;
use std::ops::Range;

use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::layers::ImportedLayers;
use crate::faults::error::MapFault;
use wildfire_base::geometry::{DVec2, FieldFrame, ops};
use wildfire_base::untrusted::visible_start;
use wildfire_grid::Grid;
use wildfire_grid::map_files::raster::GeoKeys;
use wildfire_grid::map_files::raster::crs::{Coordinates, degrees_of_web_mercator, epsg_of_name, unit_name};

/// The mean radius of the Earth in metres: H. Moritz, "Geodetic Reference System 1980", Journal of Geodesy 74, 2000.
const EARTH_RADIUS_M: f64 = 6_371_008.8;

/// The most places at which edges of polygons cross the middle lines of rows, and the most cells that lines cross.
const MAX_CROSSINGS: usize = 1 << 24;

/// The types of GeoJSON objects that may be at the top.
const TYPES: [&str; 9] = [
    "FeatureCollection",
    "Feature",
    "GeometryCollection",
    "Polygon",
    "MultiPolygon",
    "Point",
    "MultiPoint",
    "LineString",
    "MultiLineString",
];

/// Says whether a JSON text is GeoJSON: its `type` is one of the format's.
pub(crate) fn is_geojson(text: &str) -> bool {
    #[derive(Deserialize)]
    struct GeometryKind {
        r#type: String,
    }
    serde_json::from_str(text).is_ok_and(|kind: GeometryKind| TYPES.contains(&kind.r#type.as_str()))
}

/// A field with its bushes, and the number of objects that were passed over.
type ReadField = (FieldFrame, Grid<bool>, usize);

/// Reads the polygons of a GeoJSON text on cells of this side, at most `max` of them a side of the field; objects of other
/// types are passed over, and counted.
///
/// # Errors
/// Fails if the text is not GeoJSON, as the JSON reader says, or as [`Shapes::field`] does.
pub(crate) fn parse(text: &str, cell_m: f64, max: u16) -> Result<Result<ReadField, MapFault>, serde_json::Error> {
    let shapes = Shapes::read(text, false)?;
    let left_out = shapes.left_out;
    Ok(shapes.field(cell_m, max).map(|(frame, occupied)| (frame, occupied, left_out)))
}

/// Reads the lines of a GeoJSON text, in metres of the landscape's files or, without any, of the field, and marks by 1 the
/// cells that they cross. Objects of other types are passed over.
///
/// # Errors
/// Fails if the text is not GeoJSON, as the JSON reader says; or returns a sentence if no line crosses the field, if
/// coordinates are in another system, or if the lines are too long.
pub(crate) fn road_cells(
    text: &str,
    frame: &FieldFrame,
    layers: Option<&ImportedLayers>,
) -> Result<Result<Vec<u8>, String>, serde_json::Error> {
    Ok(Shapes::read(text, true)?.crossed(frame, layers))
}

/// Reads the polygons of a GeoJSON text, in the same coordinates, and marks by 1 the cells whose middles are inside.
///
/// # Errors
/// Fails if the text is not GeoJSON; or returns a sentence if no polygon has a cell of the field in it, if coordinates are in
/// another system, or if a ring crosses itself.
pub(crate) fn area_cells(
    text: &str,
    frame: &FieldFrame,
    layers: Option<&ImportedLayers>,
) -> Result<Result<Vec<u8>, String>, serde_json::Error> {
    Ok(Shapes::read(text, false)?.inside(frame, layers))
}

/// Marks by 1 the cells that polygons of a GeoJSON text cover and those that its lines cross.
///
/// # Errors
/// Fails as [`area_cells`] and [`road_cells`] do, with a sentence if the text has neither polygons nor lines.
pub(crate) fn covered_cells(
    text: &str,
    frame: &FieldFrame,
    layers: Option<&ImportedLayers>,
) -> Result<Result<Vec<u8>, String>, serde_json::Error> {
    let area = area_cells(text, frame, layers)?;
    let lines = road_cells(text, frame, layers)?;
    Ok(match (area, lines) {
        (Ok(area), Ok(lines)) => Ok(area.iter().zip(&lines).map(|(one, other)| one | other).collect()),
        // A file need not have both, but what is wrong with either is said.
        (Ok(cells), Err(fault)) | (Err(fault), Ok(cells)) => {
            if fault.starts_with(NO_POLYGON) || fault.starts_with(NO_LINE) { Ok(cells) } else { Err(fault) }
        }
        // What is wrong with polygons is said if there are any, as a file without lines has none that could be wrong.
        (Err(area), Err(lines)) => Err(if area.starts_with(NO_POLYGON) { lines } else { area }),
    })
}

/// The beginnings of the sentences on a text without polygons and on one without lines.
const NO_POLYGON: &str = "it has no polygon";
const NO_LINE: &str = "it has no line";

/// Points of a ring up to which it is looked at for crossings: every pair of its edges is compared.
const MAX_RING: usize = 5000;

/// Polygons as lists of rings, rings as lists of points; or lines, which are lists of points like rings.
#[derive(Default)]
struct Shapes {
    /// Lines are read, not polygons.
    are_lines: bool,
    points: Vec<DVec2>,
    ring_ends: Vec<usize>,
    polygon_ends: Vec<usize>,
    /// The number of objects of other types.
    left_out: usize,
    /// The name of the coordinate system, if the file gives one.
    crs: Option<String>,
}

impl Shapes {
    /// Reads the lines of a GeoJSON text, or its polygons.
    fn read(text: &str, are_lines: bool) -> Result<Self, serde_json::Error> {
        let mut shapes = Self { are_lines, ..Self::default() };
        let mut json = serde_json::Deserializer::from_str(text);
        Member(&mut shapes).deserialize(&mut json)?;
        json.end()?;
        Ok(shapes)
    }

    /// Draws the polygons on cells.
    ///
    /// # Errors
    /// Fails if there is no polygon, if the field would have too many cells, or if the outlines are too fine for them.
    fn field(mut self, cell_m: f64, max: u16) -> Result<(FieldFrame, Grid<bool>), MapFault> {
        if self.points.is_empty() {
            return Err(MapFault::NoPolygon);
        }
        if self.points.iter().any(|point| !point.is_finite()) {
            return Err(MapFault::Coordinate);
        }
        self.project()?;
        let (low, high) = self.bounds();
        // It is at least one cell, as polygons without an extent have a size of 0.
        let size = ((high - low) / cell_m).ceil().max(DVec2::ONE);
        if size.max_element() > f64::from(max) {
            return Err(MapFault::TooWide { size: [high.x - low.x, high.y - low.y], cell_m, max });
        }
        let frame = FieldFrame { cols: size.x as u16, rows: size.y as u16, cell_m };
        let mut occupied = Grid::filled(frame.rows.into(), frame.cols.into(), false);
        // In cells from the south-west corner.
        self.points.iter_mut().for_each(|point| *point = (*point - low) / cell_m);
        self.fill(&mut occupied)?;
        Ok((frame, occupied))
    }

    fn bounds(&self) -> (DVec2, DVec2) {
        let all = |join: fn(DVec2, DVec2) -> DVec2| self.points.iter().copied().reduce(join).expect("there is a point");
        (all(DVec2::min), all(DVec2::max))
    }

    /// Returns what the coordinates measure, `None` if the file does not say.
    fn coordinates(&self) -> Result<Option<Coordinates>, String> {
        let Some(name) = &self.crs else { return Ok(None) };
        let supported = Coordinates::of_name(name).filter(|supported| *supported != Coordinates::Unusable);
        supported.map(Some).ok_or_else(|| {
            let name = visible_start(name);
            format!(
                "the coordinate system `{name}` is not known, or not one in degrees, metres or feet on the ground; ogr2ogr \
                 -t_srs EPSG:4326 out.geojson in.geojson converts it"
            )
        })
    }

    /// Turns coordinates into metres. They are degrees if the file names such a system, or none and they could be.
    fn project(&mut self) -> Result<(), MapFault> {
        let mut coordinates = self.coordinates().map_err(|message| MapFault::Json { message })?;
        if coordinates == Some(Coordinates::WebMercator) {
            self.points.iter_mut().for_each(|point| *point = degrees_of_web_mercator(point.to_array()).into());
            coordinates = Some(Coordinates::Degrees);
        }
        let (low, high) = self.bounds();
        let could_be = low.x >= -180.0 && high.x <= 180.0 && low.y >= -90.0 && high.y <= 90.0;
        match coordinates {
            Some(Coordinates::Lengths { unit_m }) => {
                self.points.iter_mut().for_each(|point| *point *= unit_m);
                return Ok(());
            }
            // Numbers that cannot be degrees are metres where the file does not say what they are.
            None if !could_be => return Ok(()),
            _ if !could_be => return Err(MapFault::Coordinate),
            _ => {}
        }
        // An equirectangular projection about the middle: true there, and good enough on fields of a few kilometres.
        let middle = 0.5 * (low + high);
        let scale = EARTH_RADIUS_M * DVec2::new(ops::cos(middle.y.to_radians()), 1.0);
        self.points.iter_mut().for_each(|point| {
            let apart = *point - middle;
            *point = scale * DVec2::new(apart.x.to_radians(), apart.y.to_radians());
        });
        Ok(())
    }

    fn fill(&self, occupied: &mut Grid<bool>) -> Result<(), MapFault> {
        let rows = occupied.rows();
        // Rows whose middle line an edge crosses, the lower end included and the upper one not.
        let crossed = |a: DVec2, b: DVec2| {
            let row = |y: f64| (y - 0.5).ceil().clamp(0.0, rows as f64) as usize;
            row(a.y.min(b.y))..row(a.y.max(b.y))
        };
        // Crossings are counted first, so outlines finer than any field are refused before memory is taken for them.
        let all: usize = self.edges(0..self.ring_ends.len()).map(|(a, b)| crossed(a, b).len()).sum();
        if all > MAX_CROSSINGS {
            return Err(MapFault::TooFine { found: all, max: MAX_CROSSINGS });
        }
        let mut first_ring = 0;
        for &end_ring in &self.polygon_ends {
            let mut crossings: Vec<(usize, f64)> = Vec::new();
            for (a, b) in self.edges(first_ring..end_ring) {
                // Level edges divide by zero here, and cross no middle line that would use it.
                let slope = (b.x - a.x) / (b.y - a.y);
                crossings.extend(crossed(a, b).map(|row| (row, a.x + slope * (row as f64 + 0.5 - a.y))));
            }
            crossings.sort_unstable_by(|one, other| one.0.cmp(&other.0).then(one.1.total_cmp(&other.1)));
            // Rings are closed, so that an even number of edges crosses each row and no pair spans two of them.
            for pair in crossings.chunks_exact(2) {
                let [(row, from), (_, to)] = [pair[0], pair[1]];
                let col = |x: f64| (x - 0.5).ceil().clamp(0.0, occupied.cols() as f64) as usize;
                let (from, to) = (col(from), col(to));
                occupied.row_mut(row)[from..to.max(from)].fill(true);
            }
            first_ring = end_ring;
        }
        Ok(())
    }

    /// Marks the cells whose middles are inside polygons.
    fn inside(mut self, frame: &FieldFrame, layers: Option<&ImportedLayers>) -> Result<Vec<u8>, String> {
        if self.points.is_empty() {
            return Err(format!("{NO_POLYGON}; expected a Polygon or a MultiPolygon"));
        }
        let system = self.check_system(layers)?;
        // The inside of a ring that crosses itself is a matter of convention.
        if let Some(at) = self.first_crossing() {
            return Err(format!("a ring crosses itself at ({}, {}); expected rings that do not", at.x, at.y));
        }
        let (low, high) = self.bounds();
        let corner = layers.map_or(DVec2::ZERO, |layers| DVec2::new(layers.west_m, layers.south_m));
        // `fill` counts in cells from the south-west corner of the field.
        self.points.iter_mut().for_each(|point| *point = (*point - corner) / frame.cell_m);
        let mut inside = Grid::filled(frame.rows.into(), frame.cols.into(), false);
        self.fill(&mut inside).map_err(|fault| fault.to_string())?;
        if inside.values().contains(&true) {
            return Ok(inside.values().iter().map(|&is_inside| u8::from(is_inside)).collect());
        }
        // The usual cause is another coordinate system, which the two rectangles show.
        Err(format!(
            "its polygons reach from ({}, {}) to ({}, {}), expected the middle of a cell inside, in the field of {} x {} m from \
             ({}, {}) on, in {system}",
            low.x,
            low.y,
            high.x,
            high.y,
            frame.width_m(),
            frame.height_m(),
            corner.x,
            corner.y
        ))
    }

    /// Returns where two edges of a ring cross that are not neighbours.
    fn first_crossing(&self) -> Option<DVec2> {
        (0..self.ring_ends.len()).find_map(|ring| {
            let edges: Vec<(DVec2, DVec2)> = self.edges(ring..ring + 1).filter(|(a, b)| a != b).collect();
            if edges.len() > MAX_RING {
                return None;
            }
            edges.iter().enumerate().find_map(|(number, &(a, b))| {
                edges[number + 1..].iter().find_map(|&(c, d)| {
                    let [of_c, of_d] = [side(a, b, c), side(a, b, d)];
                    // Strictly on both sides of each other, so that edges that only touch do not count.
                    (of_c * of_d < 0.0 && side(c, d, a) * side(c, d, b) < 0.0)
                        .then(|| c + (d - c) * (of_c / (of_c - of_d)))
                })
            })
        })
    }

    /// Refuses coordinates that are not those of the field, and returns the name of these.
    fn check_system(&self, layers: Option<&ImportedLayers>) -> Result<String, String> {
        if let Some(point) = self.points.iter().find(|point| !point.is_finite() || point.abs().max_element() > 1e12) {
            return Err(format!("it has the point ({}, {}); expected metres up to 1e12", point.x, point.y));
        }
        let epsg = layers.and_then(|layers| layers.crs.as_ref()).and_then(GeoKeys::epsg);
        let system = epsg.map_or_else(|| "metres".to_owned(), |epsg| format!("metres of EPSG:{epsg}"));
        let found = match self.coordinates()? {
            Some(Coordinates::Degrees) => Some("longitude and latitude".to_owned()),
            Some(Coordinates::Lengths { unit_m }) if unit_m != 1.0 => Some(unit_name(unit_m)),
            Some(Coordinates::WebMercator) => Some("metres of a Mercator projection of the whole Earth".to_owned()),
            _ => None,
        };
        let of_field = epsg.map_or_else(|| "NUMBER".to_owned(), |epsg| epsg.to_string());
        if let Some(found) = found {
            return Err(format!("its coordinates are {found}; expected {system} (ogr2ogr -t_srs EPSG:{of_field})"));
        }
        if let (Some(found), Some(expected)) = (self.crs.as_deref().and_then(epsg_of_name), epsg)
            && found != u32::from(expected)
        {
            return Err(format!("it is in the coordinate system EPSG:{found}, expected EPSG:{expected}"));
        }
        Ok(system)
    }

    /// Marks the cells that lines cross.
    fn crossed(&self, frame: &FieldFrame, layers: Option<&ImportedLayers>) -> Result<Vec<u8>, String> {
        if self.points.is_empty() {
            return Err(format!("{NO_LINE}; expected a LineString or a MultiLineString"));
        }
        let system = self.check_system(layers)?;
        let (low, high) = self.bounds();
        let corner = layers.map_or(DVec2::ZERO, |layers| DVec2::new(layers.west_m, layers.south_m));
        let mut cells = vec![0; frame.cell_count()];
        let mut left = MAX_CROSSINGS;
        let starts = std::iter::once(&0).chain(&self.ring_ends);
        for piece in starts.zip(&self.ring_ends).flat_map(|(&start, &end)| self.points[start..end].windows(2)) {
            for (row, cols) in crossed_by(frame, [piece[0], piece[1]].map(|point| (point - corner) / frame.cell_m)) {
                // Each piece counts at least one, so millions of tiny pieces end too.
                left = left
                    .checked_sub(1 + cols.len())
                    .ok_or_else(|| format!("its lines cross more than {MAX_CROSSINGS} cells"))?;
                cells[row * usize::from(frame.cols)..][cols].fill(1);
            }
        }
        // Degrees that are read as metres give lines shorter than a cell, which is the usual slip.
        let size = high - low;
        if !cells.contains(&1) || size.max_element() < frame.cell_m {
            return Err(format!(
                "its lines go from ({}, {}) to ({}, {}), expected lines longer than a cell that cross the field of \
                 {} x {} m from ({}, {}) on, in {system} (longitude and latitude are not converted)",
                low.x,
                low.y,
                high.x,
                high.y,
                frame.width_m(),
                frame.height_m(),
                corner.x,
                corner.y
            ));
        }
        Ok(cells)
    }

    /// The edges of rings, each of which its last point joins to its first.
    fn edges(&self, rings: Range<usize>) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
        rings.flat_map(|ring| {
            let start = ring.checked_sub(1).map_or(0, |before| self.ring_ends[before]);
            let points = &self.points[start..self.ring_ends[ring]];
            points.iter().zip(points.iter().cycle().skip(1)).map(|(&a, &b)| (a, b))
        })
    }
}

/// Positive if a point lies to the left of the line from one to another.
fn side(a: DVec2, b: DVec2, point: DVec2) -> f64 {
    (b - a).perp_dot(point - a)
}

/// Lists the rows that a straight piece crosses, and the columns in each; its ends are in cells from the south-west corner.
/// Columns of neighbouring rows overlap, so that cells of a line meet at their sides.
fn crossed_by(frame: &FieldFrame, [a, b]: [DVec2; 2]) -> impl Iterator<Item = (usize, Range<usize>)> + use<> {
    let [cols, rows] = [frame.cols, frame.rows].map(f64::from);
    let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
    // The ends exactly, without rounding, and without dividing by zero on level pieces.
    let x_at = move |y: f64| match y {
        y if y <= a.y => a.x,
        y if y >= b.y => b.x,
        y => a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y)),
    };
    let [first, end] = [a.y.floor(), b.y.floor() + 1.0].map(|row| row.clamp(0.0, rows) as usize);
    (first..end).map(move |row| {
        let one = x_at(row as f64);
        let other = x_at(row as f64 + 1.0);
        let [west, end] =
            [one.min(other).floor(), one.max(other).floor() + 1.0].map(|col| col.clamp(0.0, cols) as usize);
        (row, west..end.max(west))
    })
}

/// Reads an object of GeoJSON, or null, and adds its polygons or its lines.
struct Member<'a>(&'a mut Shapes);

impl<'de> DeserializeSeed<'de> for Member<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Member<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an object of GeoJSON")
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let shapes = self.0;
        let before = (shapes.points.len(), shapes.ring_ends.len(), shapes.polygon_ends.len());
        let (mut kind, mut level) = (String::new(), None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                "type" => kind = map.next_value()?,
                "coordinates" => level = map.next_value_seed(Nest { shapes, depth: 0 })?.level(),
                "geometry" => map.next_value_seed(Member(shapes))?,
                "features" | "geometries" => map.next_value_seed(GeometryMembers(shapes))?,
                "crs" => shapes.crs = map.next_value::<Option<Crs>>()?.map(Crs::into_name),
                _ => {
                    map.next_value::<IgnoredAny>()?;
                }
            }
        }
        // The kind is decided at the end, since `type` may stand behind the coordinates.
        let (expected, lists) = match (kind.as_str(), shapes.are_lines) {
            ("Polygon", false) => (POLYGON, "a list of rings, each a list of points"),
            ("MultiPolygon", false) => (POLYGON + 1, "a list of polygons, each a list of points"),
            ("LineString", true) => (RING, "a list of points"),
            ("MultiLineString", true) => (POLYGON, "a list of lines, each a list of points"),
            ("FeatureCollection" | "Feature" | "GeometryCollection", _) => return Ok(()),
            _ => {
                shapes.left_out += usize::from(TYPES.contains(&kind.as_str()));
                // What a geometry of another kind added is taken back, as its coordinates were read before its type was known.
                shapes.points.truncate(before.0);
                shapes.ring_ends.truncate(before.1);
                shapes.polygon_ends.truncate(before.2);
                return Ok(());
            }
        };
        if level.is_some_and(|level| level != expected) {
            return Err(A::Error::custom(format!("the coordinates of a {kind} are {lists}")));
        }
        Ok(())
    }
}

/// A coordinate system: by its name, by a link to its description, or by its number, as writers of several ages have it (H.
/// Butler and others, "The GeoJSON Format Specification", 2008, section 3).
#[derive(Deserialize)]
struct Crs {
    #[serde(default)]
    properties: CrsProperties,
}

#[derive(Default, Deserialize)]
struct CrsProperties {
    name: Option<String>,
    href: Option<String>,
    code: Option<u32>,
}

impl Crs {
    fn into_name(self) -> String {
        let CrsProperties { name, href, code } = self.properties;
        name.or(href).or_else(|| code.map(|code| format!("EPSG:{code}"))).unwrap_or_default()
    }
}

/// Reads a list of objects.
struct GeometryMembers<'a>(&'a mut Shapes);

impl<'de> DeserializeSeed<'de> for GeometryMembers<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_seq(self)
    }
}

impl<'de> Visitor<'de> for GeometryMembers<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of objects of GeoJSON")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        while seq.next_element_seed(Member(self.0))?.is_some() {}
        Ok(())
    }
}

/// How deep lists are nested: a point is a list of numbers, a ring one of points, a polygon one of rings.
const POINT: usize = 1;
const RING: usize = 2;
const POLYGON: usize = 3;

/// Reads coordinates, whose lists may be nested to any depth of these.
struct Nest<'a> {
    shapes: &'a mut Shapes,
    depth: usize,
}

/// A number, or a list of lists so deep; `None` for an empty one, which is a list of anything.
enum Nested {
    Number(f64),
    List(Option<usize>),
}

impl Nested {
    fn level(self) -> Option<usize> {
        match self {
            Self::Number(_) => Some(0),
            Self::List(level) => level,
        }
    }
}

impl<'de> DeserializeSeed<'de> for Nest<'_> {
    type Value = Nested;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Nested, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Nest<'_> {
    type Value = Nested;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("coordinates: numbers in lists")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Nested, E> {
        Ok(Nested::Number(number))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Nested, E> {
        Ok(Nested::Number(number as f64))
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Nested, E> {
        Ok(Nested::Number(number as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Nested, A::Error> {
        let Self { shapes, depth } = self;
        // The depth of nesting is that of the recursion, and a file may be one bracket after the other.
        if depth > POLYGON {
            return Err(A::Error::custom("coordinates are lists in lists, at most four deep"));
        }
        let mut inner = None;
        let mut numbers = DVec2::ZERO;
        let mut count = 0;
        while let Some(item) = seq.next_element_seed(Nest { shapes, depth: depth + 1 })? {
            // A third coordinate is a height.
            if let Nested::Number(number) = item
                && count < 2
            {
                numbers[count] = number;
            }
            count += 1;
            let level = item.level();
            if level.is_some() && inner.is_some() && level != inner {
                return Err(A::Error::custom("coordinates are lists in lists, all equally deep"));
            }
            inner = inner.or(level);
        }
        // An empty list fits any depth.
        let Some(inner) = inner else { return Ok(Nested::List(None)) };
        match inner + 1 {
            POINT if count < 2 => return Err(A::Error::custom("a point has two coordinates, or three")),
            POINT => shapes.points.push(numbers),
            RING => shapes.ring_ends.push(shapes.points.len()),
            POLYGON => shapes.polygon_ends.push(shapes.ring_ends.len()),
            _ => {}
        }
        Ok(Nested::List(Some(inner + 1)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAX: u16 = 4096;

    fn rows(text: &str, cell_m: f64) -> Vec<String> {
        let (_, occupied, _) = parse(text, cell_m, MAX).expect("GeoJSON").expect("a field");
        let row = |row: usize| occupied.row(row).iter().map(|&cell| if cell { '#' } else { '.' }).collect();
        (0..occupied.rows()).rev().map(row).collect()
    }

    fn metres(geometry: &str) -> String {
        format!(
            r#"{{"type": "Feature", "crs": {{"type": "name", "properties": {{"name": "urn:ogc:def:crs:EPSG::32632"}}}},
            "properties": {{"type": "Polygon", "coordinates": [1]}}, "geometry": {geometry}}}"#
        )
    }

    #[test]
    fn cells_whose_centres_are_inside_are_bushes_and_holes_are_not() {
        let ring = r#"{"coordinates": [[[0,0],[25,0],[25,25],[0,25],[0,0]], [[10,10],[15,10],[15,15],[10,15]]], "type": "Polygon"}"#;
        assert_eq!(rows(&metres(ring), 5.0), ["#####", "#####", "##.##", "#####", "#####"]);
        let triangle = r#"{"type": "Polygon", "coordinates": [[[100,0,7],[120,0,7],[100,20,7]]]}"#;
        assert_eq!(rows(&metres(triangle), 5.0), ["....", "#...", "##..", "###."]);
    }

    #[test]
    fn polygons_that_overlap_are_both_bushes_and_points_are_passed_over() {
        let several = r#"{"type": "GeometryCollection", "geometries": [
            {"type": "Point", "coordinates": [-900, 4]},
            {"type": "LineString", "coordinates": [[-900, 4], [5, 6]]},
            {"type": "MultiPolygon", "coordinates": [[[[0,0],[20,0],[20,10],[0,10]]], [[[10,0],[30,0],[30,10],[10,10]]]]},
            {"type": "MultiPolygon", "coordinates": []}]}"#;
        assert_eq!(rows(&metres(several), 10.0), ["###"]);
        let (_, _, left_out) = parse(&metres(several), 10.0, MAX).expect("GeoJSON").expect("a field");
        assert_eq!(left_out, 2);
    }

    #[test]
    fn degrees_are_projected_about_their_middle() {
        // 0.001 degrees of latitude are 111.195 m, of longitude at 60 degrees half as much.
        let text = r#"{"type": "FeatureCollection", "features": [{"type": "Feature", "geometry": null}, {"type": "Feature",
            "geometry": {"type": "Polygon", "coordinates": [[[10,59.9995],[10.001,59.9995],[10.001,60.0005],[10,60.0005]]]}}]}"#;
        let (frame, occupied, left_out) = parse(text, 10.0, MAX).expect("GeoJSON").expect("a field");
        assert_eq!(left_out, 0, "a feature without geometry is nothing");
        assert_eq!((frame.cols, frame.rows), (6, 12));
        assert_eq!(occupied.values().iter().filter(|&&cell| cell).count(), 6 * 11);
    }

    /// The rows of a field of 5 x 4 cells of 10 m that lines cross, the north row first.
    fn road_rows(geometries: &str) -> Result<Vec<String>, String> {
        let text = format!(r#"{{"type": "GeometryCollection", "geometries": [{geometries}]}}"#);
        let frame = FieldFrame { cols: 5, rows: 4, cell_m: 10.0 };
        let cells = road_cells(&text, &frame, None).map_err(|error| error.to_string())??;
        Ok(cells
            .chunks(5)
            .rev()
            .map(|row| row.iter().map(|&road| if road == 1 { '#' } else { '.' }).collect())
            .collect())
    }

    #[test]
    fn a_fault_of_polygons_is_reported_beside_right_lines() {
        let line = r#"{"type": "LineString", "coordinates": [[0,5],[50,5]]}"#;
        let polygon = |points: &str| format!(r#"{{"type": "Polygon", "coordinates": [{points}]}}"#);
        let frame = FieldFrame { cols: 5, rows: 4, cell_m: 10.0 };
        let covered = |geometries: &str| {
            let text = format!(r#"{{"type": "GeometryCollection", "geometries": [{geometries}]}}"#);
            covered_cells(&text, &frame, None)
                .expect("GeoJSON")
                .map(|cells| cells.iter().filter(|&&cell| cell == 1).count())
        };
        assert_eq!(covered(line), Ok(5));
        assert_eq!(covered(&format!("{line}, {}", polygon("[[0,10],[20,10],[20,30],[0,30],[0,10]]"))), Ok(9));
        let crossed = format!("{line}, {}", polygon("[[0,0],[40,40],[40,0],[0,40],[0,0]]"));
        let outside = format!("{line}, {}", polygon("[[900,0],[940,0],[940,40],[900,0]]"));
        assert!(covered(&crossed).is_err() && covered(&outside).is_err());
    }

    #[test]
    fn cells_that_lines_cross_are_roads_which_meet_at_sides() {
        let line = |points: &str| road_rows(&format!(r#"{{"type": "LineString", "coordinates": {points}}}"#));
        assert_eq!(line("[[-9,5],[99,5,3]]").expect("a road"), [".....", ".....", ".....", "#####"]);
        assert_eq!(line("[[35,35],[5,5]]").expect("a road"), ["...#.", "..##.", ".##..", "##..."]);
        assert_eq!(line("[[2,38],[12,38],[12,-1e12]]").expect("a road"), ["##...", ".#...", ".#...", ".#..."]);
        let both = r#"{"type": "MultiLineString", "coordinates": [[[0,5],[12,5]], [[45,0],[45,15]], []]},
            {"type": "Polygon", "coordinates": [[[0,0],[50,0],[50,50]]]}, {"type": "Point", "coordinates": [25, 25]}"#;
        assert_eq!(road_rows(both).expect("roads"), [".....", ".....", "....#", "##..#"]);
        for (points, expected) in [
            ("[[60,5],[90,5]]", "its lines go from (60, 5) to (90, 5), expected lines longer than a cell that cross"),
            ("[[7.1,45.9],[7.3,46.1]]", "longitude and latitude are not converted"),
            ("[[0,0],[1e13,0]]", "expected metres up to 1e12"),
            ("[]", "it has no line"),
            ("[[[1,2],[3,4]]]", "the coordinates of a LineString are a list of points"),
            ("[[1],[3,4]]", "a point has two coordinates"),
        ] {
            let refused = line(points).expect_err(points);
            assert!(refused.contains(expected), "{points}: {refused}");
        }
        let frame = FieldFrame { cols: 5, rows: 4, cell_m: 10.0 };
        let mut layers = ImportedLayers::from_fuel(frame, &[99; 20]);
        let directory = vec![1, 1, 0, 1, 3072, 0, 1, 32_611];
        layers.crs = Some(GeoKeys { directory, ..GeoKeys::default() });
        for (name, expected) in [
            ("urn:ogc:def:crs:EPSG::32611", None),
            ("EPSG:32612", Some("it is in the coordinate system EPSG:32612, expected EPSG:32611")),
            ("urn:ogc:def:crs:OGC:1.3:CRS84", Some("longitude and latitude; expected metres of EPSG:32611")),
        ] {
            let crs = format!(r#""crs": {{"properties": {{"name": "{name}"}}}}"#);
            let text = format!(r#"{{"type": "LineString", {crs}, "coordinates": [[0,5],[50,5]]}}"#);
            let found = road_cells(&text, &frame, Some(&layers)).expect("GeoJSON");
            assert_eq!(found.is_ok(), expected.is_none(), "{name}");
            assert!(found.err().unwrap_or_default().contains(expected.unwrap_or_default()), "{name}");
        }
    }

    #[test]
    fn lines_cost_at_most_a_bounded_number_of_cells() {
        let there_and_back = "[5,-1e9],[5,1e9],".repeat(1_100);
        let text = format!(r#"{{"type": "LineString", "coordinates": [{there_and_back}[0,0]]}}"#);
        let frame = FieldFrame { cols: 1, rows: MAX, cell_m: 10.0 };
        let refused = road_cells(&text, &frame, None).expect("GeoJSON");
        assert!(refused.expect_err("it is too long").contains("cross more than 16777216 cells"));
    }

    #[test]
    fn what_is_no_field_is_refused() {
        let fault = |text: &str| parse(text, 1.0, MAX).expect("GeoJSON").expect_err("no field");
        assert_eq!(fault(r#"{"type": "Point", "coordinates": [1, 2]}"#), MapFault::NoPolygon);
        assert_eq!(fault(r#"{"type": "FeatureCollection", "features": []}"#), MapFault::NoPolygon);
        let wide = r#"{"type": "Polygon", "coordinates": [[[0,0],[9000,0],[0,10]]]}"#;
        assert!(matches!(fault(wide), MapFault::TooWide { max: 4096, .. }));
        for wrong in [
            r#"{"type": "Polygon", "coordinates": [[1, 2], [3, 4]]}"#,
            r#"{"type": "Polygon", "coordinates": [[[1], [3, 4]]]}"#,
            r#"{"type": "Polygon", "coordinates": [[[1, 2], 3]]}"#,
            r#"{"type": "Polygon", "coordinates": [[[[[1, 2]]]]]}"#,
            r#"{"type": "Polygon", "coordinates": "here"}"#,
            r#"{"type": "Polygon", "coordinates": []} 1"#,
        ] {
            assert!(parse(wrong, 1.0, MAX).is_err(), "{wrong}");
        }
        assert!(!is_geojson(r#"{"n": 3, "cells_cr": []}"#) && !is_geojson(r#"{"type": "map"}"#));
    }

    #[test]
    fn coordinates_are_metres_on_the_ground_in_whatever_system_the_file_names() {
        let size = |crs: &str, points: &str| {
            let text = format!(r#"{{"type": "Polygon", "crs": {crs}, "coordinates": [{points}]}}"#);
            let field = parse(&text, 1.0, MAX).expect("GeoJSON")?;
            Ok::<_, MapFault>((field.0.cols, field.0.rows))
        };
        let named = |name: &str| format!(r#"{{"type": "name", "properties": {{"name": "{name}"}}}}"#);
        let square = "[[6000000,2000000],[6000656,2000000],[6000656,2000656],[6000000,2000656]]";
        assert_eq!(
            size(&named("urn:ogc:def:crs:EPSG::2227"), square),
            Ok((200, 200)),
            "656 US survey feet are 199.95 m"
        );
        assert_eq!(size(&named("http://www.opengis.net/def/crs/EPSG/0/2222"), square), Ok((200, 200)));
        assert_eq!(size(&named("EPSG:32611"), square), Ok((656, 656)));
        // At 60 degrees north a metre of the map is half a metre long.
        let mercator = "[[1000000,8399737],[1000400,8399737],[1000400,8400137],[1000000,8400137]]";
        for crs in [named("EPSG:3857"), r#"{"type": "EPSG", "properties": {"code": 3857}}"#.to_owned()] {
            let (cols, rows) = size(&crs, mercator).expect("its system is known");
            assert!((199..=201).contains(&cols) && (199..=201).contains(&rows), "{cols} x {rows}");
        }
        let degrees = "[[10,59.9995],[10.001,59.9995],[10.001,60.0005],[10,60.0005]]";
        let link = r#"{"type": "link", "properties": {"href": "http://spatialreference.org/ref/epsg/4326/proj4/", "type": "proj4"}}"#;
        assert_eq!(size(link, degrees), size("null", degrees));
        for unknown in
            [named("my farm"), named("EPSG:3395"), r#"{"type": "link", "properties": {"href": "a.prj"}}"#.into()]
        {
            let refused = size(&unknown, square).expect_err("its system is not known").to_string();
            assert!(refused.contains("ogr2ogr -t_srs EPSG:4326"), "{refused}");
        }
        let frame = FieldFrame { cols: 5, rows: 4, cell_m: 10.0 };
        let road = format!(r#"{{"type": "LineString", "crs": {}, "coordinates": [[0,5],[50,5]]}}"#, named("EPSG:2227"));
        let refused = road_cells(&road, &frame, None).expect("GeoJSON").expect_err("it is in feet");
        assert!(refused.contains("its coordinates are US survey feet; expected metres"), "{refused}");
    }
}
