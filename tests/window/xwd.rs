//! Screenshots as `xwd` writes them.
//!
//! Format: X.Org, XWDFile.h, version 7: a header of 25 numbers, most significant byte first, and the window's name; the
//! colour map, 12 bytes an entry; rows of pixels.

use wildfire::picture::Picture;

type Rgb = [u8; 3];

/// What a window shows.
#[derive(Clone, PartialEq, Eq)]
pub struct Screenshot {
    pub width: u32,
    pub height: u32,
    pixels: Vec<Rgb>,
}

impl Screenshot {
    /// `None` where the bytes are no picture of 32 bits a pixel.
    pub fn parse(bytes: &[u8]) -> Option<Self> {
        let (chunks, _) = bytes.as_chunks::<4>();
        let number = |at: usize| chunks.get(at).copied().map(u32::from_be_bytes);
        let (header_size, width, height) = (number(0)?, number(4)?, number(5)?);
        let (is_big_endian, bits, row_bytes, colours) = (number(7)? == 1, number(11)?, number(12)?, number(19)?);
        let masks = [number(14)?, number(15)?, number(16)?];
        if bits != 32 || masks.contains(&0) {
            return None;
        }
        let rows = bytes.get((header_size + 12 * colours) as usize..)?.chunks_exact(row_bytes as usize);
        let pixel = |bytes: &[u8; 4]| {
            let value = if is_big_endian { u32::from_be_bytes(*bytes) } else { u32::from_le_bytes(*bytes) };
            masks.map(|mask| ((value & mask) >> mask.trailing_zeros()) as u8)
        };
        let pixels: Vec<Rgb> = rows
            .take(height as usize)
            .flat_map(|row| row.as_chunks::<4>().0[..width as usize].iter().map(pixel).collect::<Vec<_>>())
            .collect();
        (pixels.len() == (width * height) as usize).then_some(Self { width, height, pixels })
    }

    pub fn pixel(&self, x: u32, y: u32) -> Rgb {
        self.pixels[(y * self.width + x) as usize]
    }

    /// How many pixels differ from a picture's by more than the rounding between two ways to write colours.
    pub fn differences(&self, picture: &Picture) -> usize {
        if (self.width, self.height) != (picture.width(), picture.height()) {
            return self.pixels.len();
        }
        let differs = |&(x, y): &(u32, u32)| {
            let (seen, drawn) = (self.pixel(x, y), picture.pixel(x, y));
            seen.iter().zip(drawn).any(|(&seen, drawn)| seen.abs_diff(drawn) > 2)
        };
        (0..self.height).flat_map(|y| (0..self.width).map(move |x| (x, y))).filter(differs).count()
    }
}
