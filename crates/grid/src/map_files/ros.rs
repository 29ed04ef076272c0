//! Maps of ROS: a YAML file that names an image and the meaning of its grey values.
//!
//! Source: Brian Gerkey, Tony Pratkanis, "map_server", ROS wiki, sections 1.2 "Map format" and 1.2.2 "Value
//! interpretation". A pixel of value x (0 black to 255 white) is occupied with probability p = (255 - x) / 255, or x / 255
//! where `negate` is set. Cells of transparent pixels are unknown in the modes `trinary` and `scale`, as in Nav2's
//! `map_server` (Steve Macenski and others, package `nav2_map_server`, `loadMapFromFile`); the mode `raw` has no alpha.

use saphyr_parser::{Event, Parser};

use crate::Grid;
use crate::map_files::Fault;
use crate::map_files::decoded::GreyImage;
use crate::map_files::pixel::Transparency;
use wildfire_base::untrusted::visible_start;

/// Most bytes of a YAML file.
pub(super) const MAX_FILE: u64 = 1 << 16;

/// The keys that say that a text is the YAML file of a map.
const KEYS: [&str; 7] = ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"];

/// The pixels of an image that are not free.
pub(super) struct OccupiedPixels {
    pub occupied: Grid<bool>,
    /// The number of those that are not occupied for certain: unknown, or between the two thresholds.
    pub unknown: usize,
}

/// A map as its YAML file describes it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RosMap {
    /// The path of the image, relative to the folder of the YAML file.
    pub image: String,
    pub place: MapPlace,
    negate: bool,
    occupied_thresh: f64,
    free_thresh: f64,
    mode: RosMode,
}

/// The position of a map's cells in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapPlace {
    /// The side of a cell in metres.
    pub cell_m: f64,
    /// The pose of the lower left corner of the map: x and y in metres, the heading in radians counter-clockwise.
    pub origin: [f64; 3],
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RosMode {
    Trinary,
    Scale,
    Raw,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Occupancy {
    Free,
    Occupied,
    Unknown,
}

/// Returns whether a text is the YAML file of a ROS map: one of its lines begins with one of the keys.
pub(super) fn is_start(start: &[u8]) -> bool {
    start.split(|&byte| byte == b'\n').any(|line| key_of(line).is_some()) || is_flow_start(start)
}

/// Returns whether a text is such a file in braces, which JSON has too: it has the keys that no other file has together.
pub(super) fn is_flow_start(start: &[u8]) -> bool {
    let keys: Vec<&str> = start.split(|byte| matches!(byte, b'\n' | b'{' | b',')).filter_map(key_of).collect();
    start.contains(&b'{') && ["image", "resolution", "origin"].iter().all(|key| keys.contains(key))
}

/// Returns the key of a ROS map that a part of a text begins with.
fn key_of(part: &[u8]) -> Option<&'static str> {
    let key = part.split(|&byte| byte == b':').next().filter(|key| key.len() < part.len())?.trim_ascii();
    let key = if key.first() == key.last() && key.first().is_some_and(|byte| matches!(byte, b'"' | b'\'')) {
        key.get(1..key.len() - 1)?
    } else {
        key
    };
    KEYS.into_iter().find(|name| key == name.as_bytes())
}

impl RosMap {
    /// Reads a YAML file, in which all keys but `mode` are required; unknown keys are ignored.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        let entries = YamlMembers::parse(text)?;
        let mode = match entries.find("mode").map(|entry| entry.word(MODES)).transpose()? {
            None | Some("trinary") => RosMode::Trinary,
            Some("scale") => RosMode::Scale,
            Some("raw") => RosMode::Raw,
            Some(_) => return Err(entries.required("mode")?.unlike(MODES)),
        };
        let negate = entries.required("negate")?;
        // Map servers write 0 and 1; the other spellings are those of a truth value in YAML 1.1.
        let negate = match negate.word(SWITCH)?.to_ascii_lowercase().as_str() {
            "0" | "false" | "no" | "off" | "n" => false,
            "1" | "true" | "yes" | "on" | "y" => true,
            _ => return Err(negate.unlike(SWITCH)),
        };
        let occupied_thresh = entries.share("occupied_thresh")?;
        let free_thresh = entries.share("free_thresh")?;
        // Cells between both thresholds are unknown; in the other order a cell could be free and occupied at once.
        if free_thresh > occupied_thresh {
            return Err(entries.required("free_thresh")?.unlike("at most `occupied_thresh`"));
        }
        let resolution = entries.required("resolution")?;
        let cell_m = resolution.number("a side in metres above 0")?;
        if cell_m <= 0.0 {
            return Err(resolution.unlike("a side in metres above 0"));
        }
        let origin = entries.required("origin")?.numbers("a list of three numbers: x, y and heading")?;
        let image = entries.required("image")?.word("the path of an image")?.to_owned();
        Ok(Self { image, place: MapPlace { cell_m, origin }, negate, occupied_thresh, free_thresh, mode })
    }

    /// Returns the meaning of transparent pixels.
    pub fn transparency(&self) -> Transparency {
        if self.mode == RosMode::Raw { Transparency::Ignored } else { Transparency::Unknown }
    }

    /// Finds the occupied pixels: all that are not free. `inverted` swaps light and dark.
    pub fn occupied(&self, image: &GreyImage, inverted: bool) -> OccupiedPixels {
        let GreyImage { grey, is_unknown, .. } = image;
        // There are 256 grey values, and up to millions of pixels that have them.
        let states: Vec<Occupancy> = (0..=u8::MAX).map(|value| self.state(value, inverted)).collect();
        let is_unknown = |cell: usize| is_unknown.as_ref().is_some_and(|pixels| pixels.values()[cell]);
        let cells = grey.values().iter().enumerate();
        let cells =
            cells.map(|(cell, &value)| if is_unknown(cell) { Occupancy::Unknown } else { states[usize::from(value)] });
        let unknown = cells.clone().filter(|&state| state == Occupancy::Unknown).count();
        let occupied = cells.map(|state| state != Occupancy::Free).collect();
        OccupiedPixels { occupied: Grid::from_values(grey.rows(), grey.cols(), occupied), unknown }
    }

    fn state(&self, value: u8, inverted: bool) -> Occupancy {
        let value = if self.negate != inverted { 255 - value } else { value };
        // Light pixels are free unless the file says `negate`.
        let probability = match self.mode {
            RosMode::Trinary | RosMode::Scale => f64::from(255 - value) / 255.0,
            RosMode::Raw if value <= 100 => f64::from(value) / 100.0,
            RosMode::Raw => return Occupancy::Unknown,
        };
        if probability > self.occupied_thresh {
            Occupancy::Occupied
        } else if probability < self.free_thresh {
            Occupancy::Free
        } else {
            Occupancy::Unknown
        }
    }
}

const MODES: &str = "`trinary`, `scale` or `raw`";
const SWITCH: &str = "0 or 1";

/// A value of the YAML file: words of a list, or the one word of a plain value; `None` for what has parts of its own.
struct YamlValue {
    key: String,
    line: usize,
    parts: Option<Vec<String>>,
    is_list: bool,
}

impl YamlValue {
    fn unlike(&self, expected: &str) -> Fault {
        let found = match &self.parts {
            Some(parts) if self.is_list => format!("[{}]", parts.join(", ")),
            Some(parts) if parts.concat().is_empty() => "empty".to_owned(),
            Some(parts) => parts.concat(),
            None => "a value with parts".to_owned(),
        };
        let message = format!("`{}` is {}; expected {expected}", self.key, visible_start(&found));
        Fault::Line { line: self.line, message }
    }

    fn word(&self, expected: &str) -> Result<&str, Fault> {
        match self.parts.as_deref() {
            Some([word]) if !self.is_list && !word.is_empty() => Ok(word),
            _ => Err(self.unlike(expected)),
        }
    }

    fn number(&self, expected: &str) -> Result<f64, Fault> {
        finite(self.word(expected)?).ok_or_else(|| self.unlike(expected))
    }

    fn numbers(&self, expected: &str) -> Result<[f64; 3], Fault> {
        let parts = self.parts.as_deref().filter(|_| self.is_list).unwrap_or_default();
        let numbers: Option<Vec<f64>> = parts.iter().map(|word| finite(word)).collect();
        numbers.and_then(|numbers| numbers.try_into().ok()).ok_or_else(|| self.unlike(expected))
    }
}

fn finite(word: &str) -> Option<f64> {
    word.parse().ok().filter(|number: &f64| number.is_finite())
}

/// The members of the mapping that a YAML file consists of, in their order.
struct YamlMembers(Vec<YamlValue>);

impl YamlMembers {
    fn parse(text: &str) -> Result<Self, Fault> {
        let mut entries: Vec<YamlValue> = Vec::new();
        // Members are at depth 1, where keys and values alternate.
        let (mut depth, mut is_key) = (0, true);
        for event in Parser::new_from_str(text) {
            let (event, span) =
                event.map_err(|error| Fault::Line { line: error.marker().line(), message: error.info().to_owned() })?;
            let opens = matches!(event, Event::MappingStart(..) | Event::SequenceStart(..));
            match event {
                Event::MappingEnd | Event::SequenceEnd => {
                    depth -= 1;
                    is_key = depth == 1;
                    // A second document of the file is not part of the map.
                    if depth == 0 {
                        break;
                    }
                }
                Event::MappingStart(..) if depth == 0 => depth = 1,
                Event::Scalar(word, ..) if depth == 1 && is_key => {
                    let line = span.start.line();
                    // YAML forbids it, and readers differ in which of both they take.
                    if entries.iter().any(|entry| entry.key == word) {
                        let message = format!("`{}` stands twice; expected it once", visible_start(&word));
                        return Err(Fault::Line { line, message });
                    }
                    entries.push(YamlValue { key: word.into_owned(), line, parts: Some(Vec::new()), is_list: false });
                    is_key = false;
                }
                Event::MappingStart(..) | Event::SequenceStart(..) | Event::Scalar(..) | Event::Alias(_) => {
                    // A list or a mapping in the place of a key, or a file that does not begin with a mapping.
                    let Some(entry) = entries.last_mut().filter(|_| depth > 1 || !is_key) else {
                        let message = "expected lines of `key: value`, as in the YAML file of a ROS map".to_owned();
                        return Err(Fault::Line { line: span.start.line(), message });
                    };
                    match event {
                        Event::Scalar(word, ..) => {
                            entry.parts.iter_mut().for_each(|parts| parts.push(word.to_string()));
                        }
                        Event::SequenceStart(..) if depth == 1 => entry.is_list = true,
                        // What has parts of its own is no word; whether it matters is seen when the key is looked up.
                        _ => entry.parts = None,
                    }
                    depth += usize::from(opens);
                    is_key = depth == 1;
                }
                _ => {}
            }
        }
        Ok(Self(entries))
    }

    fn find(&self, key: &str) -> Option<&YamlValue> {
        self.0.iter().find(|entry| entry.key == key)
    }

    fn required(&self, key: &str) -> Result<&YamlValue, Fault> {
        self.find(key).ok_or_else(|| {
            let line = self.0.last().map_or(1, |entry| entry.line);
            Fault::Line { line, message: format!("the file has no `{key}`; the YAML file of a ROS map has one") }
        })
    }

    fn share(&self, key: &str) -> Result<f64, Fault> {
        let entry = self.required(key)?;
        let expected = "a probability from 0 to 1";
        let share = entry.number(expected)?;
        if (0.0..=1.0).contains(&share) { Ok(share) } else { Err(entry.unlike(expected)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MAP: &str = "image: hall.pgm\nresolution: 0.05\norigin: [-1.5, 2, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n\
                       free_thresh: 0.196\n";

    fn states(text: &str, values: [u8; 4]) -> ([bool; 4], usize) {
        let map = RosMap::parse(text).expect("a map");
        let image = GreyImage { grey: Grid::from_values(1, 4, values.to_vec()), is_unknown: None, notes: Vec::new() };
        let OccupiedPixels { occupied, unknown } = map.occupied(&image, false);
        (occupied.values().try_into().expect("four"), unknown)
    }

    #[test]
    fn grey_values_mean_what_map_server_takes_them_for() {
        // 205 is the grey of unknown ground: p = 50 / 255 = 0.19608, just above the usual threshold.
        assert_eq!(states(MAP, [0, 254, 205, 100]), ([true, false, true, true], 2));
        let negated = MAP.replace("negate: 0", "negate: 1");
        assert_eq!(states(&negated, [0, 254, 50, 100]), ([false, true, true, true], 2));
        assert_eq!(states(&format!("{MAP}mode: scale\n"), [0, 254, 206, 128]), ([true, false, false, true], 1));
        assert_eq!(states(&format!("{MAP}mode: raw\n"), [0, 100, 19, 255]), ([false, true, false, true], 1));
    }

    #[test]
    fn lists_may_be_written_line_by_line_and_other_keys_are_passed_over() {
        let text = MAP.replace("[-1.5, 2, 0.0]", "\n- -1.5\n- 2\n- 0.0").replace("hall.pgm", "\"hall.pgm\" # plan");
        let odd = format!("---\nauthor: {{name: [me, {{too: 1}}]}}\n{text}tags:\n  - a\n  - [b]\n");
        assert_eq!(RosMap::parse(&odd).expect("a map"), RosMap::parse(MAP).expect("a map"));
        let map = RosMap::parse(MAP).expect("a map");
        assert_eq!(map.place, MapPlace { cell_m: 0.05, origin: [-1.5, 2.0, 0.0] });
        assert!(is_start(odd.as_bytes()) && is_start(b"# map\nimage : x\n") && !is_start(b"0101\n1,0\nimages: 1\n"));
    }

    #[test]
    fn faults_are_named_with_their_line() {
        let cases = [
            ("0.05", "-1", "line 2: `resolution` is -1; expected a side in metres above 0"),
            ("0.05", "wide", "line 2: `resolution` is wide; expected a side in metres above 0"),
            (
                "[-1.5, 2, 0.0]",
                "[1, 2]",
                "line 3: `origin` is [1, 2]; expected a list of three numbers: x, y and heading",
            ),
            ("negate: 0", "negate: 2", "line 4: `negate` is 2; expected 0 or 1"),
            ("negate: 0", "negate: {a: 1}", "line 4: `negate` is a value with parts; expected 0 or 1"),
            ("0.65", "65", "line 5: `occupied_thresh` is 65; expected a probability from 0 to 1"),
            ("0.196", "0.9", "line 6: `free_thresh` is 0.9; expected at most `occupied_thresh`"),
            ("0.196\n", "0.1\nmode: 3d\n", "line 7: `mode` is 3d; expected `trinary`, `scale` or `raw`"),
            ("hall.pgm", "", "line 1: `image` is empty; expected the path of an image"),
            ("image:", "picture:", "line 6: the file has no `image`; the YAML file of a ROS map has one"),
        ];
        for (old, new, expected) in cases {
            let fault = RosMap::parse(&MAP.replacen(old, new, 1)).expect_err(new);
            assert_eq!(fault.to_string(), expected);
        }
        for text in
            ["- image: x\n", "image: [a\n", "{{image: a}: b}", "image: &a [*a]\nnegate: *a\n", "", "? - a\n: b\n"]
        {
            assert!(RosMap::parse(text).is_err(), "{text}");
        }
    }
}
