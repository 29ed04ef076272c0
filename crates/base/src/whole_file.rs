//! Files that appear whole or not at all.

use std::fs::{self, File, FileType};
use std::io::{self, BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;

use crate::input_file::is_standard_stream;

/// A file that is written aside, as `NAME.PROCESS.part`, and takes its name only when it is complete and on disk;
/// the name is on disk then, too.
///
/// What is dropped without [`WholeFile::finish`] leaves nothing behind; a file of that name stays as it was. Where the
/// name is a link, the file that it leads to is replaced. What is no file, such as a device or a pipe, is refused; only
/// `-`, which is stdout, is written to as it comes.
#[derive(Debug)]
pub struct WholeFile {
    writer: Option<BufWriter<WriteTarget>>,
    /// The path that it is written at and the one that it takes; `None` for stdout.
    places: Option<TemporaryPaths>,
}

#[derive(Debug)]
enum WriteTarget {
    File(File),
    Stdout(io::Stdout),
}

#[derive(Debug)]
struct TemporaryPaths {
    aside: PathBuf,
    path: PathBuf,
}

impl WholeFile {
    /// # Errors
    /// Those of the disk, and those of [`refuse_no_file`] if the name is taken by something else than a file.
    pub fn create(path: &Path) -> io::Result<Self> {
        if is_standard_stream(path) {
            return Ok(Self { writer: Some(BufWriter::new(WriteTarget::Stdout(io::stdout()))), places: None });
        }
        let places = TemporaryPaths::of(path)?;
        let file = File::create(&places.aside)?;
        Ok(Self { writer: Some(BufWriter::new(WriteTarget::File(file))), places: Some(places) })
    }

    /// The path that it is written at until it is finished, for another program that fills it; `None` for stdout.
    pub fn place(&self) -> Option<&Path> {
        self.places.as_ref().map(|places| places.aside.as_path())
    }

    /// Writes what is buffered to the disk and gives the file its name, in place of an older one.
    pub fn finish(mut self) -> io::Result<()> {
        let writer = self.writer.take().expect("only finishing takes the writer");
        let file = writer.into_inner().map_err(io::IntoInnerError::into_error);
        let Some(places) = &self.places else { return file.and_then(|mut stdout| stdout.flush()) };
        // Its bytes come first: after a crash the name must not lead to half a file.
        let renamed = file.and_then(|file| file.sync_all()).and_then(|()| fs::rename(&places.aside, &places.path));
        if renamed.is_err() {
            self.discard();
            return renamed;
        }
        sync_folder_of(&places.path)
    }

    fn discard(&self) {
        if let Some(places) = &self.places {
            // Best effort: the reason for discarding is the error that matters.
            let _ = fs::remove_file(&places.aside);
        }
    }

    fn open_writer(&mut self) -> &mut BufWriter<WriteTarget> {
        self.writer.as_mut().expect("only finishing takes the writer, and it takes the file too")
    }
}

impl WriteTarget {
    fn sync_all(&self) -> io::Result<()> {
        match self {
            Self::File(file) => file.sync_all(),
            Self::Stdout(_) => Ok(()),
        }
    }
}

impl Write for WriteTarget {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.write(bytes),
            Self::Stdout(stdout) => unless_closed(stdout.write(bytes), bytes.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::File(file) => file.flush(),
            Self::Stdout(stdout) => unless_closed(stdout.flush(), ()),
        }
    }
}

/// Forgives a reader that has closed its end, such as `head`: it has seen enough.
fn unless_closed<T>(written: io::Result<T>, all: T) -> io::Result<T> {
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => Ok(all),
        written => written,
    }
}

impl TemporaryPaths {
    /// The place aside is in the same folder, so that renaming stays within one file system, and belongs to this
    /// process, so that two programs never write into one file.
    fn of(path: &Path) -> io::Result<Self> {
        refuse_no_file(path)?;
        // A new file has no canonical path so far.
        let path = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let mut name = path.file_name().unwrap_or_default().to_owned();
        name.push(format!(".{}.part", process::id()));
        Ok(Self { aside: path.with_file_name(name), path })
    }
}

/// Refuses a name that is taken by something else than a file, or leads there by links.
///
/// Opening a pipe could wait forever, a device is not ours to write to, and neither can be replaced.
///
/// # Errors
/// [`ErrorKind::IsADirectory`] for a folder, [`ErrorKind::InvalidInput`] for a device, pipe or socket.
pub fn refuse_no_file(path: &Path) -> io::Result<()> {
    match fs::metadata(path).map(|found| found.file_type()) {
        Ok(found) if found.is_dir() => Err(io::Error::new(ErrorKind::IsADirectory, "it is a folder; expected a file")),
        Ok(found) if !found.is_file() => {
            let sentence = format!("it is {}; expected a file, or - for stdout", kind_of_special(found));
            Err(io::Error::new(ErrorKind::InvalidInput, sentence))
        }
        // If something is wrong with a free name, creating the file says it.
        _ => Ok(()),
    }
}

#[cfg(unix)]
fn kind_of_special(found: FileType) -> &'static str {
    use std::os::unix::fs::FileTypeExt;
    match () {
        () if found.is_fifo() => "a pipe",
        () if found.is_socket() => "a socket",
        () => "a device",
    }
}

#[cfg(not(unix))]
fn kind_of_special(_: FileType) -> &'static str {
    "no file"
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

/// Brings the name of a file or folder, new or changed, to the disk: only then does it survive a crash of the machine.
///
/// Where folders cannot be brought to the disk by themselves, because of the system, the file system or the right to
/// read them, this does nothing.
pub fn sync_folder_of(path: &Path) -> io::Result<()> {
    if cfg!(not(unix)) {
        return Ok(());
    }
    let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match File::open(folder).and_then(|folder| folder.sync_all()) {
        Err(error) if is_impossible(error.kind()) => Ok(()),
        synced => synced,
    }
}

fn is_impossible(kind: ErrorKind) -> bool {
    matches!(kind, ErrorKind::PermissionDenied | ErrorKind::InvalidInput | ErrorKind::Unsupported)
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
        let file = folder.path().join("file");
        let link = folder.path().join("link");
        fs::write(&file, "old").expect("writable");
        std::os::unix::fs::symlink("file", &link).expect("links can be made");
        write_whole(&link, b"new").expect("writable");
        assert_eq!(fs::read_to_string(&file).expect("readable"), "new");
        assert!(fs::symlink_metadata(&link).expect("it is there").is_symlink());
    }

    #[test]
    #[cfg(unix)]
    fn device_is_neither_written_to_nor_replaced() {
        use std::os::unix::fs::FileTypeExt;
        // A link to the device in a folder of its own: were it replaced, then this link and not the machine's device.
        let folder = tempfile::tempdir().expect("a scratch folder");
        let link = folder.path().join("full");
        std::os::unix::fs::symlink("/dev/full", &link).expect("links can be made");
        let refusal = write_whole(&link, b"text").expect_err("it is a device");
        assert_eq!(refusal.to_string(), "it is a device; expected a file, or - for stdout");
        assert_eq!(names(folder.path()), ["full"]);
        assert!(fs::metadata(&link).expect("it is there").file_type().is_char_device());
    }

    #[test]
    #[cfg(unix)]
    fn socket_is_refused_and_stays() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("socket");
        let _socket = std::os::unix::net::UnixListener::bind(&path).expect("sockets can be made");
        let refusal = write_whole(&path, b"text").expect_err("it is a socket");
        assert_eq!((refusal.kind(), names(folder.path())), (ErrorKind::InvalidInput, vec!["socket".to_owned()]));
    }
}
