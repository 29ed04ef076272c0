//! ZIP archives of uncompressed files, the format of `.npz`.
//!
//! Source: PKWARE, "APPNOTE.TXT - .ZIP File Format Specification", version 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16. All
//! files are of midnight on 1 January 1980, the first time that the format knows, so that equal files give equal archives.

use std::io::{self, Write};

// `PK` and two bytes for the kind of the record, as little-endian numbers.
const LOCAL_HEADER: u32 = 0x0403_4b50;
const CENTRAL_HEADER: u32 = 0x0201_4b50;
const END: u32 = 0x0605_4b50;
/// The version 2.0 of the format has all that is needed.
const VERSION: u16 = 20;
// The month is in bits 5 to 8, the day below them; years count from 1980.
const FIRST_DAY: u16 = (1 << 5) | 1;

/// A writer of an archive, file by file.
pub struct ZipWriter<W> {
    to: W,
    written: u64,
    /// What the archive ends with: a header for each file.
    directory: Vec<u8>,
    files: u16,
}

impl<W: Write> ZipWriter<W> {
    pub fn new(to: W) -> Self {
        Self { to, written: 0, directory: Vec::new(), files: 0 }
    }

    /// Adds a file.
    ///
    /// # Errors
    /// Those of the disk, and a file or an archive of 4 GiB or more, which this form of the format does not have.
    pub fn add(&mut self, name: &str, content: &[u8]) -> io::Result<()> {
        let offset = size(self.written)?;
        let mut entry = Vec::new();
        // Flags and method: neither encrypted nor compressed.
        for number in [VERSION, 0, 0, 0, FIRST_DAY] {
            entry.extend_from_slice(&number.to_le_bytes());
        }
        let length = size(content.len() as u64)?;
        // What is stored as it is has the same length compressed.
        for number in [crc32fast::hash(content), length, length] {
            entry.extend_from_slice(&number.to_le_bytes());
        }
        let name_length = u16::try_from(name.len()).map_err(io::Error::other)?;
        // The zero is the length of an extra field, of which there is none.
        for number in [name_length, 0] {
            entry.extend_from_slice(&number.to_le_bytes());
        }
        self.put(&[&LOCAL_HEADER.to_le_bytes(), entry.as_slice(), name.as_bytes(), content])?;
        self.directory.extend_from_slice(&CENTRAL_HEADER.to_le_bytes());
        self.directory.extend_from_slice(&VERSION.to_le_bytes());
        self.directory.extend_from_slice(&entry);
        // No comment, the first disk, no attributes.
        self.directory.extend_from_slice(&[0; 10]);
        self.directory.extend_from_slice(&offset.to_le_bytes());
        self.directory.extend_from_slice(name.as_bytes());
        self.files += 1;
        Ok(())
    }

    /// Writes the directory.
    pub fn finish(mut self) -> io::Result<()> {
        let offset = size(self.written)?;
        let length = size(self.directory.len() as u64)?;
        let directory = std::mem::take(&mut self.directory);
        // An archive on one disk: the files on this disk are all files.
        let counts = [0, 0, self.files, self.files].map(u16::to_le_bytes).concat();
        let places = [length, offset].map(u32::to_le_bytes).concat();
        self.put(&[&directory, &END.to_le_bytes(), &counts, &places, &[0; 2]])?;
        self.to.flush()
    }

    fn put(&mut self, parts: &[&[u8]]) -> io::Result<()> {
        for part in parts {
            self.to.write_all(part)?;
            self.written += part.len() as u64;
        }
        Ok(())
    }
}

fn size(bytes: u64) -> io::Result<u32> {
    // The greatest number means that the size is elsewhere.
    u32::try_from(bytes)
        .ok()
        .filter(|&bytes| bytes < u32::MAX)
        .ok_or_else(|| io::Error::new(io::ErrorKind::FileTooLarge, "an archive takes less than 4 GiB"))
}
