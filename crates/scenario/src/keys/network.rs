//! A network with one hidden layer of rectified units.

use crate::HIDDEN;

/// A function of some inputs: `b + sum v_h max(0, c_h + w_h . x)`. Sums run in a fixed order and nothing but sums and products is
/// used, so its values are the same bits everywhere.
#[derive(Clone, Debug, PartialEq)]
pub struct Network {
    inputs: usize,
    /// For each hidden unit its weights of the inputs and its bias; then the weights of the units, and the last bias.
    weights: Vec<f64>,
}

impl Network {
    /// Returns the number of weights of a network with some inputs.
    pub const fn size(inputs: usize) -> usize {
        HIDDEN * (inputs + 2) + 1
    }

    /// Creates a network from [`Self::size`] weights: for each hidden unit those of the inputs and its bias, then those of
    /// the units, and the last bias.
    ///
    /// # Panics
    /// If there are more or fewer weights.
    pub fn new(inputs: usize, weights: &[f64]) -> Self {
        assert_eq!(weights.len(), Self::size(inputs), "a network with {inputs} inputs");
        Self { inputs, weights: weights.to_vec() }
    }

    /// Returns its value.
    pub fn value(&self, inputs: &[f64]) -> f64 {
        debug_assert_eq!(inputs.len(), self.inputs);
        let (hidden, output) = self.weights.split_at(HIDDEN * (self.inputs + 1));
        let mut value = output[HIDDEN];
        for (unit, weight) in hidden.chunks_exact(self.inputs + 1).zip(output) {
            let mut sum = unit[self.inputs];
            for (weight, input) in unit.iter().zip(inputs) {
                sum += weight * input;
            }
            value += weight * sum.max(0.0);
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_network_is_the_sum_of_its_rectified_units() {
        let mut weights = vec![0.0; Network::size(2)];
        assert_eq!(Network::new(2, &weights).value(&[3.0, -4.0]), 0.0);
        // One unit is max(0, 1 + 2 x - y), with weight 5; the last bias is 7.
        weights[..3].copy_from_slice(&[2.0, -1.0, 1.0]);
        weights[HIDDEN * 3] = 5.0;
        weights[HIDDEN * 4] = 7.0;
        let network = Network::new(2, &weights);
        assert_eq!(network.value(&[3.0, -4.0]), 5.0 * 11.0 + 7.0);
        assert_eq!(network.value(&[-3.0, 4.0]), 7.0);
    }
}
