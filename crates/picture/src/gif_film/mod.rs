//! Films as GIF files.
//!
//! All frames share one palette. Only the rectangle that changed is written, and unchanged pixels in it are transparent, so
//! that the previous frame shows through; this compresses well. (GIF89a Specification, CompuServe, 1990; loops as in
//! Netscape's application extension.)

mod palette;

pub use palette::{ColourCounts, Palette};

use std::io;
use std::path::Path;

use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};

use palette::TRANSPARENT;
use wildfire_base::whole_file::WholeFile;

/// A GIF that is being written, frame by frame; it plays without end.
///
/// The file appears when it is finished; what is dropped before leaves nothing.
pub struct GifFilm {
    encoder: Encoder<WholeFile>,
    width: u16,
    palette: Palette,
    /// Palette indices of what is shown so far, row by row.
    shown: Vec<u8>,
    /// The same of the frame that is being added.
    next: Vec<u8>,
}

/// The part of a frame that changed: columns and rows, both without their ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Changed {
    left: usize,
    right: usize,
    top: usize,
    bottom: usize,
}

impl GifFilm {
    /// The shortest time that a frame is shown, in hundredths of a second; viewers give less another meaning.
    pub const MIN_DELAY: u16 = 2;

    /// Begins a file of frames of that width and height in pixels.
    pub fn create(path: &Path, (width, height): (u32, u32), palette: Palette) -> io::Result<Self> {
        let side =
            |pixels| u16::try_from(pixels).map_err(|_| io::Error::other("a GIF has at most 65535 pixels a side"));
        let (width, height) = (side(width)?, side(height)?);
        let file = WholeFile::create(path)?;
        let mut encoder = Encoder::new(file, width, height, &palette.table()).map_err(into_io)?;
        encoder.set_repeat(Repeat::Infinite).map_err(into_io)?;
        let pixels = usize::from(width) * usize::from(height);
        // No colour has the index of transparency, so all of the first frame counts as changed.
        Ok(Self { encoder, width, palette, shown: vec![TRANSPARENT; pixels], next: vec![TRANSPARENT; pixels] })
    }

    /// Adds a frame that is shown for some hundredths of a second. Its pixels are red, green, blue and opacity, row by
    /// row; the fourth is not looked at.
    pub fn add(&mut self, pixels: &[u8], hundredths: u16) -> io::Result<()> {
        let (pixels, _) = pixels.as_chunks::<4>();
        for (index, &[red, green, blue, _]) in self.next.iter_mut().zip(pixels) {
            *index = self.palette.nearest([red, green, blue]);
        }
        let changed = Changed::between(&self.shown, &self.next, usize::from(self.width));
        let frame = self.frame_of(changed, hundredths.max(Self::MIN_DELAY));
        self.encoder.write_frame(&frame).map_err(into_io)?;
        std::mem::swap(&mut self.shown, &mut self.next);
        Ok(())
    }

    pub fn finish(self) -> io::Result<()> {
        self.encoder.into_inner().map_err(into_io)?.finish()
    }

    fn frame_of(&self, Changed { left, right, top, bottom }: Changed, delay: u16) -> Frame<'static> {
        let width = usize::from(self.width);
        let rows = (top..bottom).map(|row| row * width + left..row * width + right);
        // Unchanged pixels are transparent, as long runs of one number pack better.
        let pixels = rows.flatten().map(|at| if self.next[at] == self.shown[at] { TRANSPARENT } else { self.next[at] });
        let short = |pixels: usize| u16::try_from(pixels).expect("the changed part lies within the frame");
        Frame {
            delay,
            dispose: DisposalMethod::Keep,
            transparent: Some(TRANSPARENT),
            left: short(left),
            top: short(top),
            width: short(right - left),
            height: short(bottom - top),
            buffer: pixels.collect::<Vec<_>>().into(),
            ..Frame::default()
        }
    }
}

impl Changed {
    /// The smallest part that holds all that differs between two frames; one pixel where nothing does, since a frame
    /// has pixels.
    fn between(shown: &[u8], next: &[u8], width: usize) -> Self {
        let rows = shown.chunks_exact(width).zip(next.chunks_exact(width)).enumerate();
        let mut changed = None::<Self>;
        for (row, (before, after)) in rows.filter(|(_, (before, after))| before != after) {
            let differs = |col: &usize| before[*col] != after[*col];
            let first = (0..width).find(differs).expect("the rows differ");
            let last = (0..width).rfind(differs).expect("the rows differ");
            let so_far = changed.get_or_insert(Self { left: first, right: last + 1, top: row, bottom: row + 1 });
            so_far.left = so_far.left.min(first);
            so_far.right = so_far.right.max(last + 1);
            so_far.bottom = row + 1;
        }
        changed.unwrap_or(Self { left: 0, right: 1, top: 0, bottom: 1 })
    }
}

fn into_io(error: EncodingError) -> io::Error {
    match error {
        EncodingError::Io(error) => error,
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use gif::{ColorOutput, DecodeOptions};
    use rand::RngExt;

    use super::*;
    use wildfire_base::rng;

    const SIZE: (u32, u32) = (13, 7);

    /// A frame of few colours, of which some change.
    fn scribbled(before: &[u8], rng: &mut impl rand::Rng) -> Vec<u8> {
        let (pixels, _) = before.as_chunks::<4>();
        let changed = rng.random_range(0..4) * 8;
        let pixel = |&pixel: &[u8; 4]| {
            let is_changed = rng.random_range(0..32) < changed;
            if is_changed { [rng.random_range(0..3) * 90, 40, rng.random_range(0..5), 255] } else { pixel }
        };
        pixels.iter().flat_map(pixel).collect()
    }

    /// Delays and pixels of all frames, each drawn over the one before.
    fn decoded(path: &Path) -> Vec<(u16, Vec<u8>)> {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::RGBA);
        let mut decoder = options.read_info(File::open(path).expect("it is there")).expect("a GIF");
        assert_eq!(decoder.repeat(), Repeat::Infinite);
        let width = usize::from(decoder.width());
        let mut sheet = vec![0; 4 * width * usize::from(decoder.height())];
        let mut frames = Vec::new();
        while let Some(frame) = decoder.read_next_frame().expect("a frame") {
            let (pixels, _) = frame.buffer.as_chunks::<4>();
            for (index, pixel) in pixels.iter().enumerate().filter(|(_, pixel)| pixel[3] == 255) {
                let row = index / usize::from(frame.width);
                let col = index % usize::from(frame.width);
                let at = (row + usize::from(frame.top)) * width + col + usize::from(frame.left);
                sheet[4 * at..][..4].copy_from_slice(pixel);
            }
            frames.push((frame.delay, sheet.clone()));
        }
        frames
    }

    #[test]
    fn frames_of_few_colours_come_back_exactly_with_their_delays() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("film.gif");
        let mut rng = rng::stream(1, "gif");
        let mut frames = vec![[7, 40, 0, 255].repeat((SIZE.0 * SIZE.1) as usize)];
        for number in 0..40 {
            frames.push(scribbled(&frames[number], &mut rng));
        }
        let mut counts = ColourCounts::default();
        frames.iter().for_each(|frame| counts.add(frame));
        let mut film = GifFilm::create(&path, SIZE, counts.palette()).expect("writable");
        for (frame, delay) in frames.iter().zip(0..) {
            film.add(frame, delay).expect("writable");
        }
        assert!(!path.exists(), "it appears when it is whole");
        film.finish().expect("writable");
        let expected: Vec<_> = (0..).map(|delay: u16| delay.max(2)).zip(frames).collect();
        assert_eq!(decoded(&path), expected);
    }

    #[test]
    fn film_that_is_dropped_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a scratch folder");
        let path = folder.path().join("film.gif");
        let mut film = GifFilm::create(&path, (1, 1), ColourCounts::default().palette()).expect("writable");
        film.add(&[1, 2, 3, 255], 5).expect("writable");
        drop(film);
        assert_eq!(folder.path().read_dir().expect("readable").count(), 0);
    }

    #[test]
    fn what_changed_is_the_least_rectangle() {
        let shown = [0; 20];
        let mut next = shown;
        next[5 + 3] = 1;
        next[10 + 1] = 1;
        assert_eq!(Changed::between(&shown, &next, 5), Changed { left: 1, right: 4, top: 1, bottom: 3 });
        assert_eq!(Changed::between(&shown, &shown, 5), Changed { left: 0, right: 1, top: 0, bottom: 1 });
    }
}
