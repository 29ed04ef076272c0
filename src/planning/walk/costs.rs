use crate::grid::step_costs::StepCosts;

/// What steps of a walk cost.
#[derive(Clone, Debug)]
pub struct WalkCosts {
    /// Of an orthogonal step and of a diagonal one.
    pub steps: (f64, f64),
    /// By point: the factor of its half of a step, at least 1; none where all places cost the same.
    pub factors: Option<Vec<f64>>,
}

/// A step costs the mean of the factors at its two ends times its own cost, so it costs the same both ways.
impl StepCosts for &WalkCosts {
    fn of(&self, k: usize, from: usize, to: usize) -> f64 {
        let cost = self.steps.of(k, from, to);
        match &self.factors {
            None => cost,
            Some(factors) => cost * (0.5 * (factors[from] + factors[to])),
        }
    }
}
