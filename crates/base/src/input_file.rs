//! Files that a user names, read once from front to end: pipes, devices and stdin as well as files.
//!
//! A pipe states no length, a device has no end, and what is parsed takes a multiple of its bytes. So whoever keeps an
//! input in memory says how many bytes it may have, and no more than these are ever read.
//!
//! Text is UTF-8, or UTF-16 that begins with a byte order mark, as PowerShell writes it: [`TextReader`].

use std::fmt;
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::marker::PhantomData;
use std::path::Path;

use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

/// The name that is stdin where a file is read, and stdout where one is written. A file of that name is `./-`.
pub const STANDARD_STREAM: &str = "-";

/// Says whether a name is that of stdin or stdout.
pub fn is_standard_stream(path: &Path) -> bool {
    path.as_os_str() == STANDARD_STREAM
}

/// An input that is open, for readers that limit by themselves how much they keep.
#[derive(Debug)]
pub enum InputFile {
    /// A file on a disk, and its bytes.
    Regular(File, u64),
    /// A pipe or a device: it can be read once and from its front only.
    Stream(File),
    Stdin(io::Stdin),
}

/// Opens what a user named; for a pipe that nobody writes to yet, this waits.
///
/// # Errors
/// [`ErrorKind::IsADirectory`] for a folder.
pub fn open(path: &Path) -> io::Result<InputFile> {
    if is_standard_stream(path) {
        return Ok(InputFile::Stdin(io::stdin()));
    }
    // A folder opens like a file on Unix, where only reading it would fail, and is "Access denied" on Windows.
    if path.is_dir() {
        return Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder; expected a file"));
    }
    let file = File::open(path)?;
    let found = file.metadata()?;
    match () {
        () if found.is_file() => Ok(InputFile::Regular(file, found.len())),
        () => Ok(InputFile::Stream(file)),
    }
}

/// Reads an input of at most `max` bytes.
///
/// # Errors
/// [`ErrorKind::FileTooLarge`] for an input that has more; one byte more than the limit is read of it.
pub fn read(path: &Path, max: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(max.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > max { Err(too_large(max)) } else { Ok(bytes) }
}

/// Returns the error of an input with more than `max` bytes.
pub fn too_large(max: u64) -> io::Error {
    let limit = max as f64 / 1e6;
    io::Error::new(ErrorKind::FileTooLarge, format!("it is too large; expected at most {limit} MB"))
}

/// Reads a text of at most `max` bytes, without its byte order mark.
///
/// # Errors
/// Those of [`read`], and [`ErrorKind::InvalidData`] for what is no text.
pub fn read_text(path: &Path, max: u64) -> io::Result<String> {
    text(read(path, max)?)
}

/// Returns the text of bytes, without a byte order mark.
///
/// # Errors
/// [`ErrorKind::InvalidData`] for what is no text.
pub fn text(bytes: Vec<u8>) -> io::Result<String> {
    const BYTE_ORDER_MARK: char = '\u{FEFF}';
    let mut text = String::from_utf8(utf8(bytes)?)
        .map_err(|error| not_text(&format!("byte {} is not UTF-8", error.utf8_error().valid_up_to())))?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.drain(..BYTE_ORDER_MARK.len_utf8());
    }
    match text.find('\0') {
        Some(byte) => Err(not_text(&format!("byte {byte} is zero"))),
        None => Ok(text),
    }
}

/// Returns bytes as they are, unless they are UTF-16 with a byte order mark, of which the UTF-8 is returned.
///
/// # Errors
/// [`ErrorKind::InvalidData`] for UTF-16 that is damaged.
pub fn utf8(bytes: Vec<u8>) -> io::Result<Vec<u8>> {
    if !is_utf16(&bytes) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    TextReader::new(&bytes[..]).read_to_end(&mut text)?;
    Ok(text)
}

/// Says whether bytes begin with a byte order mark of UTF-16.
pub fn is_utf16(start: &[u8]) -> bool {
    start.starts_with(&LITTLE_ENDIAN) || start.starts_with(&BIG_ENDIAN)
}

fn not_text(reason: &str) -> io::Error {
    let expected = "expected UTF-8, or UTF-16 with a byte order mark";
    io::Error::new(ErrorKind::InvalidData, format!("it is not text: {reason}; {expected}"))
}

/// The byte order marks of UTF-16 and UTF-8: the character U+FEFF.
const LITTLE_ENDIAN: [u8; 2] = [0xFF, 0xFE];
const BIG_ENDIAN: [u8; 2] = [0xFE, 0xFF];
const UTF8_MARK: [u8; 3] = [0xEF, 0xBB, 0xBF];

/// The bytes of a text without its byte order mark, UTF-16 as UTF-8, read from front to end; without a mark the bytes of
/// any file as they are.
///
/// Source: The Unicode Consortium, "The Unicode Standard", version 15.0, sections 3.9 and 23.8.
#[derive(Debug)]
pub struct TextReader<R> {
    source: R,
    order: Option<ByteOrder>,
    /// Bytes to return before others are read.
    kept: Vec<u8>,
    returned: usize,
    /// The first half of a character beyond U+FFFF.
    surrogate: Option<u16>,
    bytes_read: u64,
}

#[derive(Clone, Copy, Debug)]
enum ByteOrder {
    None,
    Little,
    Big,
}

impl<R: Read> TextReader<R> {
    pub fn new(source: R) -> Self {
        Self { source, order: None, kept: Vec::new(), returned: 0, surrogate: None, bytes_read: 0 }
    }

    /// Reads the mark, and keeps the bytes that are none.
    fn begin(&mut self) -> io::Result<ByteOrder> {
        self.source.by_ref().take(2).read_to_end(&mut self.kept)?;
        if !is_utf16(&self.kept) {
            self.source.by_ref().take(1).read_to_end(&mut self.kept)?;
            if self.kept == UTF8_MARK {
                self.kept.clear();
            }
            return Ok(ByteOrder::None);
        }
        let order = if self.kept == LITTLE_ENDIAN { ByteOrder::Little } else { ByteOrder::Big };
        self.bytes_read = self.kept.len() as u64;
        self.kept.clear();
        Ok(order)
    }

    /// Keeps the next characters of UTF-16; none at its end.
    fn decode(&mut self, unit: fn([u8; 2]) -> u16) -> io::Result<()> {
        const BLOCK: u64 = 1 << 13;
        let mut block = Vec::new();
        self.source.by_ref().take(BLOCK).read_to_end(&mut block)?;
        let (pairs, rest) = block.as_chunks::<2>();
        let damaged = |byte: u64| not_text(&format!("byte {byte} is not UTF-16"));
        let units = self.surrogate.take().into_iter().chain(pairs.iter().map(|&pair| unit(pair)));
        let mut units: Vec<u16> = units.collect();
        let is_end = (block.len() as u64) < BLOCK;
        if !is_end {
            // The second half of that character is in the next block.
            self.surrogate = units.pop_if(|unit| matches!(unit, 0xD800..0xDC00));
        }
        // A first half that waits for the next block is not decoded yet.
        let end = self.bytes_read + 2 * (pairs.len() - usize::from(self.surrogate.is_some())) as u64;
        let mut place = end - 2 * units.len() as u64;
        self.bytes_read += block.len() as u64;
        self.kept.clear();
        self.returned = 0;
        for letter in char::decode_utf16(units) {
            let letter = letter.map_err(|_| damaged(place))?;
            place += 2 * letter.len_utf16() as u64;
            self.kept.extend_from_slice(letter.encode_utf8(&mut [0; 4]).as_bytes());
        }
        // Blocks have an even number of bytes, so an odd one is the last of the input.
        if rest.is_empty() { Ok(()) } else { Err(damaged(self.bytes_read - 1)) }
    }
}

impl<R: Read> Read for TextReader<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let order = self.order.map_or_else(|| self.begin(), Ok)?;
        self.order = Some(order);
        if self.returned == self.kept.len() {
            match order {
                ByteOrder::None => return self.source.read(bytes),
                ByteOrder::Little => self.decode(u16::from_le_bytes)?,
                ByteOrder::Big => self.decode(u16::from_be_bytes)?,
            }
        }
        let count = (&self.kept[self.returned..]).read(bytes)?;
        self.returned += count;
        Ok(count)
    }
}

/// Reads a list of at most `MAX` items: an item of two bytes, such as `{}` with defaults, may take a thousand in
/// memory.
///
/// # Errors
/// A longer one, as soon as it is longer.
pub fn list_of_at_most<'de, const MAX: usize, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    struct List<const MAX: usize, T>(PhantomData<T>);

    impl<'de, const MAX: usize, T: Deserialize<'de>> Visitor<'de> for List<MAX, T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a sequence")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<T>, A::Error> {
            let mut items = Vec::new();
            while let Some(item) = seq.next_element()? {
                // An item beyond the last has been read: a list of exactly `MAX` is fine.
                if items.len() == MAX {
                    return Err(A::Error::custom(format_args!("more than {MAX} entries; expected fewer")));
                }
                items.push(item);
            }
            Ok(items)
        }
    }
    deserializer.deserialize_seq(List::<MAX, T>(PhantomData))
}

impl Read for InputFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Regular(file, _) | Self::Stream(file) => file.read(bytes),
            Self::Stdin(stdin) => stdin.read(bytes),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn input_is_read_up_to_the_limit_and_refused_beyond() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("input");
        fs::write(&path, "\u{FEFF}text").expect("writable");
        assert_eq!(read_text(&path, 7).expect("it has seven bytes"), "text");
        let refusal = read_text(&path, 6).expect_err("it has seven bytes");
        assert_eq!(refusal.kind(), ErrorKind::FileTooLarge);
        assert_eq!(refusal.to_string(), "it is too large; expected at most 0.000006 MB");
    }

    #[test]
    fn what_is_no_file_of_text_is_reported() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("input");
        assert_eq!(read(&path, 9).expect_err("it is not there").kind(), ErrorKind::NotFound);
        assert_eq!(read(folder.path(), 9).expect_err("it is a folder").kind(), ErrorKind::IsADirectory);
        fs::write(&path, b"ab\xFFc").expect("writable");
        let refusal = read_text(&path, 9).expect_err("it is no text");
        assert_eq!(
            (refusal.kind(), refusal.to_string().as_str()),
            (
                ErrorKind::InvalidData,
                "it is not text: byte 2 is not UTF-8; expected UTF-8, or UTF-16 with a byte order mark"
            )
        );
    }

    /// Returns the units of a text as bytes, behind a mark.
    fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        std::iter::once(0xFEFF).chain(text.encode_utf16()).flat_map(bytes).collect()
    }

    #[test]
    fn text_is_the_same_in_every_encoding() {
        // Characters of two units lie across the ends of blocks, whose bytes are even in number.
        for text in ["", "a", "Größe\r\n", &"🔥".repeat(9000), &format!("x{}", "🔥".repeat(9000))] {
            let encoded = [
                text.as_bytes().to_vec(),
                [&UTF8_MARK, text.as_bytes()].concat(),
                utf16(text, u16::to_le_bytes),
                utf16(text, u16::to_be_bytes),
            ];
            for bytes in encoded {
                let mut read = String::new();
                TextReader::new(&bytes[..]).read_to_string(&mut read).expect("text");
                assert!(read == text && super::text(bytes).expect("text") == text, "{:?}", text.get(..9));
            }
        }
    }

    #[test]
    fn what_is_no_utf16_is_refused_with_its_place() {
        let refusal = |bytes: &[u8]| text(bytes.to_vec()).expect_err("no text").to_string();
        let whole = utf16(&format!("x{}", "🔥".repeat(9000)), u16::to_le_bytes);
        let mut lone = whole.clone();
        lone[20_001] = b'x';
        assert!(refusal(&lone).starts_with("it is not text: byte 20002 is not UTF-16; "), "{}", refusal(&lone));
        assert!(refusal(&whole[..whole.len() - 1]).starts_with("it is not text: byte "));
        assert!(refusal(&whole[..whole.len() - 2]).starts_with("it is not text: byte "));
        assert!(refusal(&whole[2..]).contains("it is not text: "), "without a mark");
        assert!(refusal(b"a\0b\0").starts_with("it is not text: byte 1 is zero; expected UTF-8, or UTF-16"));
    }

    #[test]
    #[cfg(unix)]
    fn device_without_an_end_is_read_up_to_the_limit() {
        let refusal = read(Path::new("/dev/zero"), 1000).expect_err("it never ends");
        assert_eq!(refusal.kind(), ErrorKind::FileTooLarge);
    }
}
