//! `wildfire plan --repeat`: whether planners answer the same when they are asked again.

use serde::Serialize;

use wildfire_base::document::number::count;
use wildfire_batch::drives::Attempt;
use wildfire_planning::{PlanFailure, PlannerName};

/// How the second answers of a planner compare with the first.
#[derive(Clone, Debug, Serialize)]
pub struct Repeat {
    pub planner: PlannerName,
    pub goals: usize,
    pub different: usize,
    /// Field and goal of the first answer that differs.
    first: Option<(String, usize)>,
}

impl Repeat {
    /// Compares the answers of a planner, which are in the same order.
    pub fn new(planner: &PlannerName, answers: &[Attempt<'_>], again: &[Attempt<'_>]) -> Self {
        let pairs = answers.iter().zip(again).filter(|(one, _)| one.planner == *planner);
        let different = pairs.clone().filter(|(one, other)| !is_same(one, other));
        let first = different.clone().next().map(|(one, _)| (one.problem.name.clone(), one.goal));
        Self { planner: planner.clone(), goals: pairs.count(), different: different.count(), first }
    }

    /// Says it in a sentence.
    pub fn sentence(&self) -> String {
        let Self { planner, goals, different, first } = self;
        let goals = count(*goals, "goal");
        match first {
            None => format!("{planner}: queried twice, the answers for {goals} are bit-identical."),
            Some((field, goal)) => format!(
                "{planner}: queried twice, {different} of the answers for {goals} differ, first on field {field}, \
                 goal {goal}: its runs are not reproducible."
            ),
        }
    }
}

/// Says whether two answers are equal, bit for bit, apart from what they cost.
fn is_same(one: &Attempt<'_>, other: &Attempt<'_>) -> bool {
    one.expansions == other.expansions && bits(one) == bits(other)
}

/// Returns the numbers of an answer's path as they are stored, or why there is none.
fn bits<'a>(attempt: &'a Attempt<'_>) -> Result<Vec<u64>, &'a PlanFailure> {
    let segments = attempt.drive.as_ref().map(|drive| drive.path.segments.iter());
    segments.map(|segments| segments.flat_map(|it| [it.curvature.to_bits(), it.length_m.to_bits()]).collect())
}
