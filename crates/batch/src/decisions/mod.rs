//! What decisions were worth: a run is forked where an agent decided, and goes on with every other choice there was.
//!
//! One rerun says little, since a small change early on leads to another run, with luck of its own. So every choice is played
//! over several futures: what is left to chance after the decision is drawn again, alike for all choices. What counts is the
//! difference of losses in the same future.
//!
//! Futures are played in rounds, and a decision whose differences are settled after a round needs no more. Every interval is
//! widened so that all rounds together keep their probability of error (Bonferroni), and the p-values of one run are adjusted
//! by [`holm`](crate::stats::holm).

mod attainable;
mod futures;
mod table;
mod why;

pub use attainable::{Answers, HindsightBound, HindsightBudget, attain, attain_all};
pub use futures::{AlternativeAction, DecisionValue, JudgeProgress, SelectedDecisions};
pub use table::{DECISION_COLUMNS, DecisionTally, JudgeError, judge_batch};
pub use why::WhyReport;
