//! The numbers of legs, stored in one stream apart from the facts.
//!
//! Most recur (speeds, curvatures, lattice steps) and become short references; those that occur once, mostly lengths,
//! stand in a list of their own, because mixing incompressible bytes among the others spoils the compression of both.

use std::collections::BTreeMap;

use super::{FileError, append, take};

/// Reference to the next number that occurs once; greater references count from 1 into those that recur.
const SINGLE: u32 = 0;

/// Collects numbers in the order in which they will be read.
#[derive(Debug, Default)]
pub struct NumberWriter(Vec<f64>);

/// Numbers as a file stores them.
#[derive(Debug, Default)]
pub struct CodedNumbers {
    /// Most frequent first.
    pub recurring: Vec<f64>,
    pub single: Vec<f64>,
    /// A reference per number, each a varint.
    pub references: Vec<u8>,
}

impl NumberWriter {
    pub fn push(&mut self, number: f64) {
        self.0.push(number);
    }

    pub fn coded(&self) -> CodedNumbers {
        let references = self.references();
        let recurring = vec![0.0; references.len()];
        let mut coded = CodedNumbers { recurring, ..CodedNumbers::default() };
        for (&bits, &reference) in &references {
            // References count from 1, as 0 marks a number that occurs once.
            coded.recurring[reference as usize - 1] = f64::from_bits(bits);
        }
        for number in &self.0 {
            let reference = references.get(&number.to_bits()).copied().unwrap_or(SINGLE);
            if reference == SINGLE {
                coded.single.push(*number);
            }
            append(&mut coded.references, &reference);
        }
        coded
    }

    /// Bits of the numbers that recur, with their references.
    fn references(&self) -> BTreeMap<u64, u32> {
        // Compared as bits, so that a zero keeps its sign.
        let mut counts = BTreeMap::<u64, u32>::new();
        for number in &self.0 {
            *counts.entry(number.to_bits()).or_default() += 1;
        }
        let mut recurring: Vec<_> = counts.into_iter().filter(|&(_, count)| count > 1).collect();
        // The sort is stable, so equally frequent numbers stay in the order of their bits.
        recurring.sort_by_key(|&(_, count)| std::cmp::Reverse(count));
        recurring.into_iter().map(|(bits, _)| bits).zip(1..).collect()
    }
}

/// Returns numbers in the order in which they were collected.
#[derive(Debug)]
pub struct NumberReader<'a> {
    recurring: &'a [f64],
    single: std::slice::Iter<'a, f64>,
    references: &'a [u8],
}

impl<'a> NumberReader<'a> {
    pub fn new(recurring: &'a [f64], single: &'a [f64], references: &'a [u8]) -> Self {
        Self { recurring, single: single.iter(), references }
    }

    pub fn next(&mut self) -> Result<f64, FileError> {
        let number = match take::<u32>(&mut self.references)? {
            SINGLE => self.single.next(),
            reference => self.recurring.get(reference as usize - 1),
        };
        number.copied().ok_or(FileError::Damaged("it refers to a number that it does not contain"))
    }

    /// Returns true if every number has been read.
    pub fn is_finished(&self) -> bool {
        self.references.is_empty() && self.single.as_slice().is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back_bit_for_bit() {
        let numbers = [0.0, -0.0, 8.0, 1.0 / 13.0, 8.0, 3.7, 8.0, 1.0 / 13.0, f64::MIN_POSITIVE, -0.0];
        let mut writer = NumberWriter::default();
        numbers.iter().for_each(|&number| writer.push(number));
        let coded = writer.coded();
        assert_eq!(coded.recurring[0], 8.0);
        assert_eq!((coded.recurring.len(), coded.single.len()), (3, 3));
        let mut reader = NumberReader::new(&coded.recurring, &coded.single, &coded.references);
        for number in numbers {
            assert_eq!(reader.next().expect("it was written").to_bits(), number.to_bits());
        }
        assert!(reader.is_finished());
        assert!(reader.next().is_err());
    }

    #[test]
    fn references_to_nothing_are_errors() {
        for references in [[0], [2]] {
            assert!(NumberReader::new(&[1.0], &[], &references).next().is_err());
        }
    }
}
