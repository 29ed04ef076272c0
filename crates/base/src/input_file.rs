//! Files that a user names, read once from front to end: pipes, devices and stdin as well as files.
//!
//! A pipe states no length, a device has no end, and what is parsed takes a multiple of its bytes. So whoever keeps an
//! input in memory says how many bytes it may have, and no more than these are ever read.

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
    let file = File::open(path)?;
    let found = file.metadata()?;
    match () {
        () if found.is_dir() => Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder; expected a file")),
        () if found.is_file() => Ok(InputFile::Regular(file, found.len())),
        () => Ok(InputFile::Stream(file)),
    }
}

/// Reads an input of at most `most` bytes.
///
/// # Errors
/// [`ErrorKind::FileTooLarge`] for an input that has more; one byte more than the limit is read of it.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.take(most.saturating_add(1)).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most { Err(too_large(most)) } else { Ok(bytes) }
}

/// Returns the error of an input with more than `most` bytes.
pub fn too_large(most: u64) -> io::Error {
    let limit = most as f64 / 1e6;
    io::Error::new(ErrorKind::FileTooLarge, format!("it is too large; expected at most {limit} MB"))
}

/// Reads an input of at most `most` bytes of UTF-8, without the byte order mark that some editors write.
///
/// # Errors
/// Those of [`read`], and [`ErrorKind::InvalidData`] for what is no text.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    text(read(path, most)?)
}

/// Returns the text of bytes, without a byte order mark.
///
/// # Errors
/// [`ErrorKind::InvalidData`] for what is no text.
pub fn text(bytes: Vec<u8>) -> io::Result<String> {
    const BYTE_ORDER_MARK: char = '\u{FEFF}';
    let mut text = String::from_utf8(bytes).map_err(|error| {
        let byte = error.utf8_error().valid_up_to();
        io::Error::new(ErrorKind::InvalidData, format!("it is not text: byte {byte} is not UTF-8"))
    })?;
    if text.starts_with(BYTE_ORDER_MARK) {
        text.drain(..BYTE_ORDER_MARK.len_utf8());
    }
    Ok(text)
}

/// Reads a list of at most `MOST` items: an item of two bytes, such as `{}` with defaults, may take a thousand in
/// memory.
///
/// # Errors
/// A longer one, as soon as it is longer.
pub fn list_of_at_most<'de, const MOST: usize, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Vec<T>, D::Error> {
    struct List<const MOST: usize, T>(PhantomData<T>);

    impl<'de, const MOST: usize, T: Deserialize<'de>> Visitor<'de> for List<MOST, T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("a sequence")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<T>, A::Error> {
            let mut items = Vec::new();
            while let Some(item) = seq.next_element()? {
                if items.len() == MOST {
                    return Err(A::Error::custom(format_args!("more than {MOST} entries; expected fewer")));
                }
                items.push(item);
            }
            Ok(items)
        }
    }
    deserializer.deserialize_seq(List::<MOST, T>(PhantomData))
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
    fn what_is_no_file_of_text_is_said_to_be_so() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("input");
        assert_eq!(read(&path, 9).expect_err("it is not there").kind(), ErrorKind::NotFound);
        assert_eq!(read(folder.path(), 9).expect_err("it is a folder").kind(), ErrorKind::IsADirectory);
        fs::write(&path, b"ab\xFFc").expect("writable");
        let refusal = read_text(&path, 9).expect_err("it is no text");
        assert_eq!(
            (refusal.kind(), refusal.to_string().as_str()),
            (ErrorKind::InvalidData, "it is not text: byte 2 is not UTF-8")
        );
    }

    #[test]
    #[cfg(unix)]
    fn device_without_an_end_is_read_up_to_the_limit() {
        let refusal = read(Path::new("/dev/zero"), 1000).expect_err("it never ends");
        assert_eq!(refusal.kind(), ErrorKind::FileTooLarge);
    }
}
