//! Columns of numbers near a prediction, as recordings store them.
//!
//! A number of the ground, a time at which a cell caught fire or a height, is told by its difference from a prediction out
//! of the cells to the west and to the south, which are told before it. Of a difference, its length in bits and the bits
//! themselves are columns of their own: lengths deflate well, the bits not at all.

use super::FileError;

const TOO_FEW: FileError = FileError::Damaged("a column in it is too short");
const NO_NUMBER: FileError = FileError::Damaged("a column in it contains an invalid number");

/// Folds a difference so that small ones of either sign are small numbers.
fn fold(difference: u64) -> u64 {
    let signed = difference.cast_signed();
    ((signed << 1) ^ (signed >> 63)).cast_unsigned()
}

fn unfold(folded: u64) -> u64 {
    (folded >> 1) ^ (folded & 1).wrapping_neg()
}

/// Writes differences.
#[derive(Debug, Default)]
pub struct DifferenceWriter {
    /// The bit length of each number.
    pub lengths: Vec<u8>,
    /// The bits below the highest one of each number, the lowest first.
    pub bits: Vec<u8>,
    // Up to 7 bits wait while up to 63 are added, which 64 do not hold.
    pending: u128,
    pending_bits: u32,
}

impl DifferenceWriter {
    pub fn push(&mut self, number: u64, predicted: u64) {
        let folded = fold(number.wrapping_sub(predicted));
        let length = u64::BITS - folded.leading_zeros();
        self.lengths.push(length as u8);
        let below = length.saturating_sub(1);
        self.pending |= u128::from(folded & !(u64::MAX << below)) << self.pending_bits;
        self.pending_bits += below;
        while self.pending_bits >= 8 {
            self.bits.push(self.pending as u8);
            self.pending >>= 8;
            self.pending_bits -= 8;
        }
    }

    pub fn finish(mut self) -> DifferenceColumns {
        if self.pending_bits > 0 {
            self.bits.push(self.pending as u8);
        }
        DifferenceColumns { lengths: self.lengths, bits: self.bits }
    }
}

/// Differences as they were written, see [`DifferenceWriter`].
#[derive(Debug)]
pub struct DifferenceColumns {
    pub lengths: Vec<u8>,
    pub bits: Vec<u8>,
}

/// Reads differences from any bytes.
#[derive(Debug)]
pub struct DifferenceReader<'a> {
    lengths: &'a [u8],
    bits: &'a [u8],
    pending: u128,
    pending_bits: u32,
}

impl<'a> DifferenceReader<'a> {
    pub fn new(lengths: &'a [u8], bits: &'a [u8]) -> Self {
        Self { lengths, bits, pending: 0, pending_bits: 0 }
    }

    /// Returns the next number from its difference to this prediction.
    pub fn next(&mut self, predicted: u64) -> Result<u64, FileError> {
        let (&length, lengths) = self.lengths.split_first().ok_or(TOO_FEW)?;
        self.lengths = lengths;
        if u32::from(length) > u64::BITS {
            return Err(NO_NUMBER);
        }
        let below = u32::from(length).saturating_sub(1);
        while self.pending_bits < below {
            let (&byte, bits) = self.bits.split_first().ok_or(TOO_FEW)?;
            self.bits = bits;
            self.pending |= u128::from(byte) << self.pending_bits;
            self.pending_bits += 8;
        }
        let low = self.pending as u64 & !u64::MAX.checked_shl(below).unwrap_or(0);
        self.pending >>= below;
        self.pending_bits -= below;
        // Zero alone has no highest bit.
        let folded = if length == 0 { 0 } else { low | 1 << below };
        Ok(predicted.wrapping_add(unfold(folded)))
    }

    pub fn is_finished(&self) -> bool {
        self.lengths.is_empty() && self.bits.is_empty() && self.pending == 0
    }
}

/// Numbers by cell index, as far as they are known, and the prediction of the next one.
///
/// A smooth surface is locally a plane: a cell is expected where the plane through its neighbours to the west, to the
/// south and to the south-west has it.
#[derive(Debug)]
pub struct PlanePredictor {
    cols: usize,
    numbers: Vec<Option<u64>>,
    last: u64,
}

impl PlanePredictor {
    pub fn new(cols: usize, cells: usize) -> Self {
        Self { cols, numbers: vec![None; cells], last: 0 }
    }

    pub fn predict(&self, index: usize) -> u64 {
        let neighbour = |rows: usize, cols: usize| {
            let is_inside = index % self.cols >= cols && index >= rows * self.cols;
            is_inside.then(|| self.numbers[index - rows * self.cols - cols]).flatten()
        };
        match (neighbour(0, 1), neighbour(1, 0), neighbour(1, 1)) {
            // Forged numbers may overflow here, and wrapping cannot panic.
            (Some(west), Some(south), Some(between)) => west.wrapping_add(south).wrapping_sub(between),
            (Some(near), ..) | (None, Some(near), _) => near,
            (None, None, Some(near)) => near,
            (None, None, None) => self.last,
        }
    }

    pub fn learn(&mut self, index: usize, number: u64) {
        self.numbers[index] = Some(number);
        self.last = number;
    }
}

/// Single-precision numbers as integers in the same order, so that near numbers are near integers.
fn ordered(number: f32) -> u64 {
    let bits = number.to_bits();
    // As bits alone, negative numbers ascend with their size.
    u64::from(if bits >> 31 == 1 { !bits } else { bits | 1 << 31 })
}

fn from_ordered(ordered: u64) -> Result<f32, FileError> {
    let ordered = u32::try_from(ordered).map_err(|_| NO_NUMBER)?;
    Ok(f32::from_bits(if ordered >> 31 == 1 { ordered & !(1 << 31) } else { !ordered }))
}

/// Writes a number for every cell.
pub fn write_surface(cols: usize, numbers: impl ExactSizeIterator<Item = f32>) -> DifferenceColumns {
    let mut plane = PlanePredictor::new(cols, numbers.len());
    let mut writer = DifferenceWriter::default();
    for (index, number) in numbers.map(ordered).enumerate() {
        writer.push(number, plane.predict(index));
        plane.learn(index, number);
    }
    writer.finish()
}

/// Reads a number for each of `cells` cells.
pub fn read_surface(cols: usize, cells: usize, lengths: &[u8], bits: &[u8]) -> Result<Vec<f32>, FileError> {
    // Compared before there is memory for as many cells.
    if lengths.len() != cells {
        return Err(TOO_FEW);
    }
    let mut plane = PlanePredictor::new(cols, cells);
    let mut reader = DifferenceReader::new(lengths, bits);
    let numbers = (0..cells).map(|index| {
        let number = reader.next(plane.predict(index))?;
        plane.learn(index, number);
        from_ordered(number)
    });
    let numbers = numbers.collect::<Result<Vec<_>, _>>()?;
    if reader.is_finished() { Ok(numbers) } else { Err(NO_NUMBER) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_any_size_come_back() {
        let numbers = [0, 1, u64::MAX, 7, 1 << 63, (1 << 63) - 1, 12, 12, u64::MAX - 1];
        let mut writer = DifferenceWriter::default();
        let mut predicted = 5;
        for number in numbers {
            writer.push(number, predicted);
            predicted = number;
        }
        let DifferenceColumns { lengths, bits } = writer.finish();
        let mut reader = DifferenceReader::new(&lengths, &bits);
        let mut predicted = 5;
        for number in numbers {
            predicted = reader.next(predicted).expect("it was written");
            assert_eq!(predicted, number);
        }
        assert!(reader.is_finished());
        assert!(reader.next(0).is_err());
        assert!(DifferenceReader::new(&[65], &[0; 16]).next(0).is_err());
        assert!(DifferenceReader::new(&[64], &[0; 7]).next(0).is_err());
    }

    #[test]
    fn a_surface_comes_back_bit_for_bit_and_a_plane_takes_next_to_nothing() {
        let odd = [0.0, -0.0, f32::MIN_POSITIVE, -1e30, 1e-30, 3.5, f32::MAX, f32::MIN, 1.0, 1.0, 1.0, 2.0];
        let DifferenceColumns { lengths, bits } = write_surface(4, odd.into_iter());
        let back = read_surface(4, 12, &lengths, &bits).expect("it was written");
        assert!(back.iter().zip(odd).all(|(back, number)| back.to_bits() == number.to_bits()));
        assert!(read_surface(4, 11, &lengths, &bits).is_err());
        let plane = (0..10_000).map(|index| 64.0 + (index % 100) as f32 * 0.25 + (index / 100) as f32 * 0.125);
        let bits = write_surface(100, plane).bits;
        assert!(bits.len() < 1000, "{} bytes", bits.len());
    }
}
