//! A finished picture.

use std::io;
use std::path::Path;

use wildfire_base::whole_file::WholeFile;
use wildfire_grid::Grid;
use wildfire_grid::map_files::carried;

use super::colours::Rgb;

/// Pictures of at most this many bytes are packed small, larger ones fast.
const PACKED_WELL: usize = 8 << 20;

/// A finished picture.
///
/// The same scene gives the same pixels on every machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    width: u32,
    height: u32,
    /// Red, green and blue of every pixel, row by row.
    channels: Vec<u8>,
    /// The chunk of the file that holds the map of the picture.
    map: Option<Vec<u8>>,
}

impl Picture {
    /// Takes opaque pixels of four channels; the fourth goes, in place, since pictures can be large.
    pub fn from_rgba(width: u32, height: u32, mut channels: Vec<u8>) -> Self {
        let pixels = channels.len() / 4;
        for pixel in 0..pixels {
            channels.copy_within(4 * pixel..4 * pixel + 3, 3 * pixel);
        }
        channels.truncate(3 * pixels);
        Self { width, height, channels, map: None }
    }

    pub fn width(&self) -> u32 {
        self.width
    }

    pub fn height(&self) -> u32 {
        self.height
    }

    /// Red, green and blue of a pixel, `x` to the right and `y` down from the upper left corner.
    ///
    /// # Panics
    /// If the pixel lies outside the picture.
    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        assert!(x < self.width && y < self.height, "pixel {x}, {y} of {} x {}", self.width, self.height);
        let at = 3 * (y as usize * self.width as usize + x as usize);
        [self.channels[at], self.channels[at + 1], self.channels[at + 2]]
    }

    /// Returns the same with a map, which its file carries for whoever reads it as a map.
    pub fn with_map(self, occupied: &Grid<bool>) -> Self {
        Self { map: Some(carried::chunk(occupied)), ..self }
    }

    /// Writes the picture as a PNG file, atomically.
    pub fn write_png(&self, path: &Path) -> io::Result<()> {
        let mut file = WholeFile::create(path)?;
        self.encode_png(&mut file)?;
        file.finish()
    }

    /// The bytes of the picture as a PNG file.
    pub fn to_png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        self.encode_png(&mut bytes).expect("memory takes what it is given");
        bytes
    }

    fn encode_png(&self, mut target: impl io::Write) -> io::Result<()> {
        let Some(map) = &self.map else { return self.encode_pixels(target) };
        let mut pixels = Vec::new();
        self.encode_pixels(&mut pixels)?;
        let (header, rest) = pixels.split_at(carried::HEADER_BYTES);
        [header, map, rest].into_iter().try_for_each(|bytes| target.write_all(bytes))
    }

    fn encode_pixels(&self, target: impl io::Write) -> io::Result<()> {
        // The fast way to pack looks only for runs of zeros, which differences from the row above have; the thorough
        // one finds the repetitions of flat colours better in what is left as it is.
        let (compression, filter) = match self.channels.len() {
            0..=PACKED_WELL => (png::Compression::High, png::Filter::NoFilter),
            _ => (png::Compression::Fast, png::Filter::Up),
        };
        let mut encoder = png::Encoder::new(target, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(compression);
        encoder.set_filter(filter);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.channels)?;
        Ok(writer.finish()?)
    }
}
