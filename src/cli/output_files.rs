//! Files that are to be written: what can be checked of them before anything is computed, and writing them.

use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use crate::cli::error::CliError;
use crate::cli::report::FormArguments;
use crate::cli::terminal;
use wildfire_base::input_file::is_standard_stream;
use wildfire_base::whole_file::refuse_no_file;

/// A file that may have been asked for, and how it is written.
pub type Output<'a> = (Option<&'a Path>, &'a dyn Fn(&Path) -> io::Result<()>);

/// The format of a file, which its name must show by its ending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Png,
    /// A drawing of lines and text, in either of two formats.
    Sketch,
    Gif,
    Mp4,
    Html,
    Csv,
    Json,
    GeoJson,
    Npy,
    Npz,
    Mcap,
    Asc,
    Tif,
    OmplLog,
    Recording,
    Toml,
    /// The source text of a program.
    Source,
}

impl Format {
    const fn name(self) -> &'static str {
        match self {
            Self::Png => "a PNG image",
            Self::Sketch => "a drawing",
            Self::Gif => "a GIF",
            Self::Mp4 => "an MP4",
            Self::Html => "a page",
            Self::Csv => "a table",
            Self::Json => "JSON",
            Self::GeoJson => "GeoJSON",
            Self::Npy => "a NumPy array",
            Self::Npz => "NumPy arrays",
            Self::Mcap => "an MCAP",
            Self::Asc => "an ESRI ASCII grid",
            Self::Tif => "a GeoTIFF",
            Self::OmplLog => "a log",
            Self::Recording => "a recording",
            Self::Toml => "TOML",
            Self::Source => "a planner's source text",
        }
    }

    /// Returns the endings that go with the format; tables and logs are plain text too.
    const fn endings(self) -> &'static [&'static str] {
        match self {
            Self::Png => &["png"],
            Self::Sketch => &["svg", "png"],
            Self::Gif => &["gif"],
            Self::Mp4 => &["mp4"],
            Self::Html => &["html", "htm"],
            Self::Csv => &["csv", "txt"],
            Self::Json => &["json"],
            Self::GeoJson => &["geojson", "json"],
            Self::Npy => &["npy"],
            Self::Npz => &["npz"],
            Self::Mcap => &["mcap"],
            Self::Asc => &["asc"],
            Self::Tif => &["tif", "tiff"],
            Self::OmplLog => &["log", "txt"],
            Self::Recording => &["wildfire"],
            Self::Toml => &["toml"],
            Self::Source => &["py", "c", "cpp", "rs"],
        }
    }

    fn check(self, path: &Path) -> Result<(), CliError> {
        let ending = path.extension().unwrap_or_default();
        if self.endings().iter().any(|valid| ending.eq_ignore_ascii_case(valid)) {
            return Ok(());
        }
        let endings = self.endings().iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(" or ");
        let (path, name) = (path.display(), self.name());
        let help = (self == Self::Png).then_some("films are written with `wildfire render --gif` and `--mp4`");
        let help = help.filter(|_| ending.eq_ignore_ascii_case("gif") || ending.eq_ignore_ascii_case("mp4"));
        Err(CliError::bad_input(
            format_args!("{path} would hold {name}; expected a name that ends in {endings}, or -"),
            help,
        ))
    }
}

/// The stream that the words of a command go to: stdout, or stderr if a file goes to stdout.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportStream {
    Stdout,
    Stderr,
}

impl ReportStream {
    /// Prints a result for people.
    pub fn print(self, result: &str) -> Result<(), CliError> {
        match self {
            Self::Stdout => terminal::print(result),
            Self::Stderr => {
                result.lines().for_each(terminal::note);
                Ok(())
            }
        }
    }
}

/// The files that a command was asked to read and to write.
#[derive(Debug, Default)]
pub struct Files<'a> {
    pub inputs: Vec<&'a Path>,
    pub outputs: Vec<(Format, &'a Path)>,
    /// The form of the report: all but text are no words but a result on stdout.
    pub form: FormArguments,
}

impl<'a> Files<'a> {
    /// Adds outputs, any of which may not have been asked for.
    pub fn writing(mut self, outputs: impl IntoIterator<Item = (Format, &'a Option<PathBuf>)>) -> Self {
        self.outputs.extend(outputs.into_iter().filter_map(|(format, path)| Some((format, path.as_deref()?))));
        self
    }

    /// Refuses two inputs on stdin, two results on stdout, and outputs that are one and the same file, an input, no
    /// file, in no folder, or named as if they held something else than they will.
    ///
    /// # Errors
    /// Bad input; a fault of the environment where the system does not let the folder be looked at.
    pub fn check(&self) -> Result<ReportStream, CliError> {
        // Stdin can be read once, so the second of two inputs would be empty.
        if self.inputs.iter().filter(|path| is_standard_stream(path)).count() > 1 {
            return Err(CliError::bad_input(
                "- is stdin, which can be read only once; expected it as a single input",
                None,
            ));
        }
        let on_stdout = self.outputs.iter().filter(|(_, path)| is_standard_stream(path)).count();
        let is_result = !self.form.is_text();
        // The report in another form than text is itself a result on stdout.
        if on_stdout + usize::from(is_result && on_stdout > 0) > 1 {
            let help = if is_result { "the report goes to stdout too" } else { "give the other outputs names" };
            return Err(CliError::bad_input("- is stdout, which takes a single output; expected it once", Some(help)));
        }
        let mut seen: Vec<PathBuf> =
            self.inputs.iter().filter(|path| !is_standard_stream(path)).map(|path| resolved(path)).collect();
        let files = self.outputs.iter().filter(|(_, path)| !is_standard_stream(path));
        // The file that a name leads to counts: a link and its target are one file.
        for &(_, path) in files.clone() {
            if seen.contains(&resolved(path)) {
                let sentence = format_args!("{} is named for two files", path.display()).to_string();
                return Err(CliError::bad_input(sentence, Some("the input and every output need different names")));
            }
            seen.push(resolved(path));
        }
        for &(format, path) in files {
            check_place(path)?;
            format.check(path)?;
        }
        Ok(if on_stdout > 0 { ReportStream::Stderr } else { ReportStream::Stdout })
    }
}

/// The path without links and detours, as far as it exists: one name for one file.
fn resolved(path: &Path) -> PathBuf {
    fs::canonicalize(path)
        .ok()
        .or_else(|| Some(fs::canonicalize(parent_of(path)).ok()?.join(path.file_name()?)))
        .unwrap_or_else(|| path.to_owned())
}

fn parent_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Refuses a file in no folder, and a name that is taken by something else.
fn check_place(path: &Path) -> Result<(), CliError> {
    match fs::metadata(parent_of(path)).map(|found| found.is_dir()) {
        Ok(true) => {}
        Err(error) if !matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            return Err(CliError::unwritable(path, &error));
        }
        _ => {
            let sentence = format!("cannot write {}: the folder does not exist", path.display());
            return Err(CliError::bad_input(sentence, None));
        }
    }
    refuse_no_file(path)
        .map_err(|reason| CliError::bad_input(format_args!("cannot write {}: {reason}", path.display()), None))
}

/// Tries to write all files that were asked for; the error is the first.
pub fn write_all(outputs: &[Output], quiet: bool) -> Result<(), CliError> {
    let mut all = Ok(());
    for (path, write) in outputs {
        let Some(path) = path else { continue };
        let written = write(path).map_err(|error| CliError::unwritable(path, &error));
        if written.is_ok() {
            note_written(path, quiet);
        }
        all = all.and(written);
    }
    all
}

/// Says that a file was written; for stdout there is no need to.
pub fn note_written(path: &Path, quiet: bool) {
    if !quiet && !is_standard_stream(path) {
        terminal::note(&format!("wrote {}", path.display()));
    }
}
