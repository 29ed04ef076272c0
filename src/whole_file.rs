//! Files that appear whole or not at all.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;

/// A file that is written aside, as `NAME.PROCESS.part`, and takes its name only when it is complete and on disk.
///
/// What is dropped without [`WholeFile::finish`] leaves nothing behind; a file of that name stays as it was. Where the
/// name is a link, the file that it leads to is replaced. A device or a pipe cannot be replaced and is written to
/// directly.
#[derive(Debug)]
pub struct WholeFile {
    writer: Option<BufWriter<File>>,
    /// Where it is written and the name that it takes; `None` of a device or a pipe.
    places: Option<Places>,
}

#[derive(Debug)]
struct Places {
    aside: PathBuf,
    path: PathBuf,
}

impl WholeFile {
    pub fn create(path: &Path) -> io::Result<Self> {
        let places = Places::of(path)?;
        let file = match &places {
            Some(places) => File::create(&places.aside)?,
            None => OpenOptions::new().write(true).open(path)?,
        };
        Ok(Self { writer: Some(BufWriter::new(file)), places })
    }

    /// Where it is written until it is finished, for another program that fills it.
    pub fn place(&self, name: &Path) -> PathBuf {
        self.places.as_ref().map_or_else(|| name.to_owned(), |places| places.aside.clone())
    }

    /// Writes what is buffered to the disk and gives the file its name, in place of an older one.
    pub fn finish(mut self) -> io::Result<()> {
        let writer = self.writer.take().expect("only finishing takes the writer");
        let file = writer.into_inner().map_err(io::IntoInnerError::into_error);
        let Some(places) = &self.places else { return file.map(drop) };
        let renamed = file.and_then(|file| file.sync_all()).and_then(|()| fs::rename(&places.aside, &places.path));
        if renamed.is_err() {
            self.discard();
        }
        renamed
    }

    fn discard(&self) {
        if let Some(places) = &self.places {
            // Best effort: the reason for discarding is the error that matters.
            let _ = fs::remove_file(&places.aside);
        }
    }

    fn open_writer(&mut self) -> &mut BufWriter<File> {
        self.writer.as_mut().expect("only finishing takes the writer, and it takes the file too")
    }
}

impl Places {
    /// The place aside is in the same folder, so that renaming stays within one file system, and belongs to this
    /// process, so that two programs never write into one file.
    fn of(path: &Path) -> io::Result<Option<Self>> {
        let path = match fs::metadata(path) {
            Ok(found) if found.is_file() => fs::canonicalize(path)?,
            Ok(found) if found.is_dir() => return Err(ErrorKind::IsADirectory.into()),
            Ok(_) => return Ok(None),
            Err(_) => path.to_owned(),
        };
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.part", process::id()));
        Ok(Some(Self { aside: path.with_file_name(name), path }))
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.open_writer().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.open_writer().flush()
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if self.writer.take().is_some() {
            self.discard();
        }
    }
}

/// Writes a file in one go, whole or not at all.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = WholeFile::create(path)?;
    file.write_all(bytes)?;
    file.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("the test's own folder");
        entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned()).collect()
    }

    #[test]
    fn finished_file_replaces_the_old_one_and_leaves_nothing_else() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("runs.csv");
        fs::write(&path, "old").expect("writable");
        let mut file = WholeFile::create(&path).expect("writable");
        file.write_all(b"new").expect("writable");
        assert_eq!(fs::read_to_string(&path).expect("readable"), "old");
        file.finish().expect("writable");
        assert_eq!(fs::read_to_string(&path).expect("readable"), "new");
        assert_eq!(names(folder.path()), ["runs.csv"]);
    }

    #[test]
    fn dropped_file_leaves_no_trace() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let mut file = WholeFile::create(&folder.path().join("runs.csv")).expect("writable");
        file.write_all(b"half a row").expect("writable");
        drop(file);
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn name_of_a_folder_is_an_error_that_leaves_no_trace() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("taken");
        fs::create_dir_all(path.join("inside")).expect("writable");
        assert!(write_whole(&path, b"text").is_err());
        assert_eq!(names(folder.path()), ["taken"]);
    }

    #[test]
    #[cfg(unix)]
    fn link_is_followed_and_stays() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "old").expect("writable");
        std::os::unix::fs::symlink("file", &link).expect("links can be made");
        write_whole(&link, b"new").expect("writable");
        assert_eq!(fs::read_to_string(&file).expect("readable"), "new");
        assert!(fs::symlink_metadata(&link).expect("it is there").is_symlink());
    }

    #[test]
    #[cfg(unix)]
    fn device_is_written_to_and_not_replaced() {
        use std::os::unix::fs::FileTypeExt;
        // A link to the device in a folder of its own: were it replaced, then this link and not the machine's device.
        let folder = tempfile::tempdir().expect("a scratch folder");
        let link = folder.path().join("null");
        std::os::unix::fs::symlink("/dev/null", &link).expect("links can be made");
        write_whole(&link, b"into nothing").expect("it takes everything");
        assert_eq!(names(folder.path()), ["null"]);
        assert!(fs::metadata(&link).expect("it is there").file_type().is_char_device());
        assert!(fs::symlink_metadata(&link).expect("it is there").is_symlink());
    }
}
