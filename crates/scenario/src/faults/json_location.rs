//! Locations in a JSON text: of values, and of errors of its reader.

use std::fmt;
use std::ops::Range;

use serde::Deserializer;
use serde::de::{DeserializeSeed, Error as _, IgnoredAny, MapAccess, SeqAccess, Visitor};

use super::path::{FieldPath, PathStep};

/// Finds the first character of the value that a path leads to, or of the last value on the way that exists.
pub fn locate(text: &str, path: &FieldPath) -> Range<usize> {
    let mut json = serde_json::Deserializer::from_str(text);
    let Err(halt) = LocationWalk(&path.0).deserialize(&mut json) else { return 0..0 };
    let before = offset(text, halt.line(), halt.column());
    // The parser halts in front of the value, at the latest on the colon or comma before it.
    let gap = text[before..].find(|letter: char| !(letter.is_whitespace() || letter == ':' || letter == ','));
    let at = before + gap.unwrap_or(0);
    character_at(text, at)
}

/// Converts a line and a column to a byte offset; both count from 1, columns in bytes as `serde_json` has them.
pub fn offset(text: &str, line: usize, column: usize) -> usize {
    let line_start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let mut at = (line_start + column.saturating_sub(1)).min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}

/// Returns the span of the character that begins at this byte; it is empty at the end.
pub fn character_at(text: &str, at: usize) -> Range<usize> {
    at..at + text[at..].chars().next().map_or(0, char::len_utf8)
}

/// The steps still to be taken. The walk halts at its end by an error, since only errors carry line and column.
struct LocationWalk<'p>(&'p [PathStep]);

impl<'de> DeserializeSeed<'de> for LocationWalk<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        if self.0.is_empty() { Err(D::Error::custom("arrived")) } else { deserializer.deserialize_any(self) }
    }
}

impl<'de> Visitor<'de> for LocationWalk<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a map or a list")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        while let Some(key) = map.next_key::<String>()? {
            match self.0.split_first() {
                Some((PathStep::Key(name), rest)) if *name == key => return map.next_value_seed(LocationWalk(rest)),
                _ => map.next_value::<IgnoredAny>()?,
            };
        }
        Err(A::Error::custom("no such member"))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        let Some((PathStep::Index(index), rest)) = self.0.split_first() else {
            return Err(A::Error::custom("no list was expected"));
        };
        for _ in 0..*index {
            seq.next_element::<IgnoredAny>()?;
        }
        seq.next_element_seed(LocationWalk(rest))?.ok_or_else(|| A::Error::custom("no such element"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "{\"a\": [1, {\"b\": [7,\n -8]}],\n\n \"c\" : {\"d\" :\n null, \"e\": \"x\"}}";

    fn rest(dotted: &str) -> &str {
        &TEXT[locate(TEXT, &FieldPath::parse(dotted)).start..]
    }

    #[test]
    fn paths_lead_to_the_first_byte_of_a_value() {
        assert!(rest("a.1.b.1").starts_with("-8]}]"), "{}", rest("a.1.b.1"));
        assert!(rest("a.1.b").starts_with("[7"), "{}", rest("a.1.b"));
        assert!(rest("c.d").starts_with("null"), "{}", rest("c.d"));
        assert!(rest("c.e").starts_with("\"x\""), "{}", rest("c.e"));
        assert!(rest("c").starts_with("{\"d\""), "{}", rest("c"));
    }

    #[test]
    fn paths_that_lead_nowhere_give_a_place_on_the_way() {
        for dotted in ["a.9", "a.1.b.5", "c.f", "c.e.3", "z", "a.x", ""] {
            assert!(locate(TEXT, &FieldPath::parse(dotted)).end <= TEXT.len(), "{dotted}");
        }
    }
}
