//! Distributions to draw from: outcomes of contests, and others of known shape.

use rand::Rng;
use rayon::prelude::*;
use wildfire::scenario::Scenario;
use wildfire::timeline::{Outcome, Winner};
use wildfire::{scenario, sim};

/// Runs whose outcomes are drawn from.
const SEEDS: std::ops::RangeInclusive<u64> = 1..=1000;

/// Outcomes of the same seeds.
pub struct Contests {
    pub contest: Vec<Contest>,
    /// The same with other planners of the truck.
    pub hybrid: Vec<Contest>,
    pub prm_rs: Vec<Contest>,
    /// The scenario `original-2024`, whose outcomes are skewed.
    pub original: Vec<Contest>,
}

/// What one run came to.
pub struct Contest {
    pub saved: f64,
    pub expansions: f64,
    /// 0 if nothing was extinguished.
    pub response_s: f64,
    pub won: bool,
}

/// Numbers of which each is as likely to be drawn, or a distribution.
pub enum Population {
    Normal,
    LogNormal,
    Numbers(Vec<f64>),
}

pub fn contests() -> Result<Contests, String> {
    let planner = |name: &str| [format!("unimog.planner={name}")];
    Ok(Contests {
        contest: runs("contest", &planner("prm+primitives"))?,
        hybrid: runs("contest", &planner("hybrid-astar"))?,
        prm_rs: runs("contest", &planner("prm-rs"))?,
        original: runs("original-2024", &[])?,
    })
}

fn runs(scenario: &str, changes: &[String]) -> Result<Vec<Contest>, String> {
    let contest = scenario::load(scenario, changes).map_err(|error| error.to_string())?;
    let run = |seed| {
        let run = sim::run(&contest, seed).map_err(|error| format!("seed {seed}: {error}"))?;
        let outcome = Outcome::new(&run.timeline);
        Ok(Contest {
            saved: f64::from(outcome.intact + outcome.extinguished),
            expansions: outcome.agents.iter().map(|agent| agent.local_expansions as f64).sum(),
            response_s: outcome.mean_response_s.unwrap_or(0.0),
            won: outcome.winner() == Winner::Unimog,
        })
    };
    SEEDS.into_par_iter().map(run).collect()
}

/// The bushes saved in runs of a scenario.
pub fn saved(contest: &Scenario, seeds: std::ops::RangeInclusive<u64>) -> Result<Vec<f64>, String> {
    let run = |seed| {
        let run = sim::run(contest, seed).map_err(|error| format!("seed {seed}: {error}"))?;
        let outcome = Outcome::new(&run.timeline);
        Ok(f64::from(outcome.intact + outcome.extinguished))
    };
    seeds.into_par_iter().map(run).collect()
}

impl Population {
    pub fn mean(&self) -> f64 {
        match self {
            Self::Normal => 0.0,
            Self::LogNormal => libm::exp(0.5),
            Self::Numbers(numbers) => numbers.iter().sum::<f64>() / numbers.len() as f64,
        }
    }

    /// Half of what is drawn is at most this.
    pub fn median(&self) -> f64 {
        match self {
            Self::Normal => 0.0,
            Self::LogNormal => 1.0,
            Self::Numbers(numbers) => {
                let mut sorted = numbers.clone();
                sorted.sort_by(f64::total_cmp);
                sorted[(sorted.len() - 1) / 2]
            }
        }
    }

    pub fn sample(&self, n: usize, random: &mut impl Rng) -> Vec<f64> {
        (0..n).map(|_| self.draw(random)).collect()
    }

    fn draw(&self, random: &mut impl Rng) -> f64 {
        match self {
            Self::Normal => normal(random),
            Self::LogNormal => libm::exp(normal(random)),
            Self::Numbers(numbers) => numbers[below(numbers.len(), random)],
        }
    }
}

/// By Box and Muller's transformation.
fn normal(random: &mut impl Rng) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - uniform(random))).sqrt();
    radius * libm::cos(std::f64::consts::TAU * uniform(random))
}

/// From 0 to less than 1.
pub fn uniform(random: &mut impl Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

pub fn below(n: usize, random: &mut impl Rng) -> usize {
    (uniform(random) * n as f64) as usize
}
