//! Films as MP4 files, made by the program `ffmpeg`.

use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, ChildStdin, Command, Stdio};
use std::thread::{self, JoinHandle};

use crate::cli::error::CliError;
use wildfire_base::whole_file::WholeFile;

/// Reads frames of four bytes a pixel and writes H.264 as all players take it.
const ENCODING: &str = "-an -c:v libx264 -preset medium -crf 18 -pix_fmt yuv420p \
    -vf scale=out_color_matrix=bt709:out_range=tv -colorspace bt709 -color_primaries bt709 -color_trc bt709 \
    -f mp4";

/// The most bytes of messages of `ffmpeg` that are kept, the last ones.
const KEPT_BYTES: usize = 4096;

/// An MP4 that is being written, frame by frame.
///
/// The file appears when it is finished; what is dropped before leaves nothing, and no program running.
pub struct Mp4File {
    path: PathBuf,
    file: WholeFile,
    encoder: Encoder,
}

impl Mp4File {
    /// For frames of that width and height in pixels, both even.
    pub fn create(path: &Path, (width, height): (u32, u32), fps: f64) -> Result<Self, CliError> {
        let file = WholeFile::create(path).map_err(|error| CliError::unwritable(path, &error))?;
        let mut command = Command::new("ffmpeg");
        command.args(["-hide_banner", "-nostdin", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgba"]);
        command.args(["-s", &format!("{width}x{height}"), "-r", &fps.to_string(), "-i", "pipe:0"]);
        command.args(ENCODING.split_whitespace());
        match file.place() {
            Some(place) => {
                // The index moves to the front when the file is complete, so players need not read it to its end.
                command.args(["-movflags", "+faststart"]).arg("--").arg(absolute(place)).stdout(Stdio::null())
            }
            // A pipe cannot be gone back in: the index comes in parts, with the frames.
            None => command.args(["-movflags", "+frag_keyframe+empty_moov", "pipe:1"]),
        };
        let encoder = Encoder::start(command)?;
        Ok(Self { path: path.to_owned(), file, encoder })
    }

    /// Adds a frame: red, green, blue and opacity of every pixel, row by row.
    pub fn add(&mut self, pixels: &[u8]) -> Result<(), CliError> {
        self.encoder.write(pixels).map_err(|reason| self.failure(&reason))
    }

    pub fn finish(mut self) -> Result<(), CliError> {
        self.encoder.end().map_err(|reason| self.failure(&reason))?;
        self.file.finish().map_err(|error| CliError::unwritable(&self.path, &error))
    }

    fn failure(&self, reason: &str) -> CliError {
        CliError::environment(format_args!("cannot write {}: ffmpeg failed: {reason}", self.path.display()))
    }
}

/// A name that cannot be taken for an option or a protocol.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

/// The running program.
struct Encoder {
    child: Child,
    /// `None` once all frames are written.
    frames: Option<ChildStdin>,
    message: Option<JoinHandle<String>>,
}

impl Encoder {
    fn start(mut command: Command) -> Result<Self, CliError> {
        let started = command.stdin(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = started.map_err(|error| match error.kind() {
            ErrorKind::NotFound => CliError::environment(
                "ffmpeg is needed for --mp4 and was not found: install it (Debian: apt-get install ffmpeg) or use --gif",
            ),
            _ => CliError::environment(format_args!("cannot start ffmpeg: {error}")),
        })?;
        let frames = child.stdin.take();
        let stderr = child.stderr.take();
        // What it says is read all the time, or it would wait for a reader while we wait for it.
        let message = stderr.map(|stderr| thread::spawn(move || last_line(stderr)));
        Ok(Self { child, frames, message })
    }

    /// # Errors
    /// The program's last words, if it is gone.
    fn write(&mut self, pixels: &[u8]) -> Result<(), String> {
        let written = self.frames.as_mut().map_or(Ok(()), |frames| frames.write_all(pixels));
        match written {
            Err(error) if error.kind() == ErrorKind::BrokenPipe => {
                Err(self.end().err().unwrap_or_else(|| error.to_string()))
            }
            written => written.map_err(|error| error.to_string()),
        }
    }

    /// Lets the program finish.
    fn end(&mut self) -> Result<(), String> {
        drop(self.frames.take());
        let status = self.child.wait().map_err(|error| error.to_string())?;
        let message = self.message.take().and_then(|message| message.join().ok()).unwrap_or_default();
        match status.success() {
            true => Ok(()),
            false if message.is_empty() => Err(status.to_string()),
            false => Err(message),
        }
    }
}

impl Drop for Encoder {
    fn drop(&mut self) {
        // One that has ended is left alone; for one that has not, no frames will come.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// The last line that is not empty.
fn last_line(mut stderr: ChildStderr) -> String {
    let mut kept = Vec::new();
    let mut bytes = [0; KEPT_BYTES];
    while let Some(count) = read_some(&mut stderr, &mut bytes) {
        kept.extend_from_slice(&bytes[..count]);
        kept.drain(..kept.len().saturating_sub(KEPT_BYTES));
    }
    let text = String::from_utf8_lossy(&kept);
    text.lines().rev().map(str::trim).find(|line| !line.is_empty()).unwrap_or_default().to_owned()
}

/// Returns how many bytes were read; `None` at the end.
fn read_some(from: &mut impl Read, bytes: &mut [u8]) -> Option<usize> {
    loop {
        match from.read(bytes) {
            Ok(0) => return None,
            Ok(count) => return Some(count),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(_) => return None,
        }
    }
}
