//! Disk operations of a batch, which tests replace by those of a full disk.

use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use super::BatchError;
use wildfire_base::whole_file::WholeFile;

/// A destination for the files of a batch.
pub trait Disk {
    /// A file that appears when it is finished.
    fn whole_file(&self, path: &Path) -> io::Result<Box<dyn Whole>>;

    /// A journal that is open, to be written at its end.
    fn journal(&self, file: File) -> Box<dyn Append>;
}

/// Writes a file that appears when it is complete.
pub(crate) fn write_whole(disk: &dyn Disk, path: &Path, contents: &[u8]) -> Result<(), BatchError> {
    let written = disk.whole_file(path).and_then(|mut file| {
        file.write_all(contents)?;
        file.finish()
    });
    written.map_err(|source| BatchError::unwritable(path, source))
}

/// A file that appears when it is complete.
pub trait Whole: Write + Send {
    fn finish(self: Box<Self>) -> io::Result<()>;
}

/// A file to which lines are appended.
pub trait Append {
    /// Hands all bytes over to the system: they survive the end of this process.
    fn append(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Brings what was handed over to the disk: it survives the end of the machine.
    fn sync(&mut self) -> io::Result<()>;
}

/// The file system.
#[derive(Clone, Copy, Debug)]
pub struct RealDisk;

impl Disk for RealDisk {
    fn whole_file(&self, path: &Path) -> io::Result<Box<dyn Whole>> {
        Ok(Box::new(WholeFile::create(path)?))
    }

    fn journal(&self, file: File) -> Box<dyn Append> {
        Box::new(file)
    }
}

impl Whole for WholeFile {
    fn finish(self: Box<Self>) -> io::Result<()> {
        Self::finish(*self)
    }
}

impl Append for File {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        // It is not opened to append there, see `journal::lock`.
        #[cfg(windows)]
        io::Seek::seek(self, io::SeekFrom::End(0))?;
        self.write_all(bytes)
    }

    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }
}
