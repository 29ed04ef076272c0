//! The runs that are shown, and how others take their place.

use std::sync::Arc;
use std::thread::{self, JoinHandle};

use bevy::prelude::Resource;

use crate::picture::film::Film;
use crate::time::SimTime;

/// Where a window gets further runs from.
pub trait FilmSource: Send + Sync {
    /// The run of a seed, simulated or read; takes as long as that takes.
    ///
    /// # Errors
    /// A sentence for the viewer.
    fn film(&self, seed: u64) -> Result<Film, String>;

    /// The seeds to walk through; `None` where any seed will do.
    fn seeds(&self) -> Option<&[u64]>;
}

/// Which runs to get.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    Next,
    Previous,
    /// The next, to be played from the beginning.
    Rerun,
}

/// The runs that are shown, and those that are on their way.
#[derive(Resource)]
pub struct Reels {
    reels: Vec<Reel>,
    coming: Option<(Step, JoinHandle<Delivery>)>,
}

/// What a thread brings: a film for every run that has a source.
type Delivery = Result<Vec<Option<Film>>, String>;

struct Reel {
    film: Film,
    source: Option<Arc<dyn FilmSource>>,
}

impl Reels {
    pub fn new(films: Vec<(Film, Option<Box<dyn FilmSource>>)>) -> Self {
        let reels = films.into_iter().map(|(film, source)| Reel { film, source: source.map(Arc::from) });
        Self { reels: reels.collect(), coming: None }
    }

    /// One run or two.
    pub fn films(&self) -> Vec<&Film> {
        self.reels.iter().map(|reel| &reel.film).collect()
    }

    /// When the longest run ends.
    pub fn end(&self) -> SimTime {
        Film::last_end(&self.films())
    }

    /// The next time after `time` at which something happens in any run.
    pub fn next_event(&self, time: SimTime) -> Option<SimTime> {
        self.reels.iter().filter_map(|reel| reel.film.next_event(time)).min()
    }

    /// The last time before `time` at which something happened in any run.
    pub fn previous_event(&self, time: SimTime) -> Option<SimTime> {
        self.reels.iter().filter_map(|reel| reel.film.previous_event(time)).max()
    }

    /// Whether other runs are on their way.
    pub fn is_waiting(&self) -> bool {
        self.coming.is_some()
    }

    /// Sends for the next runs of all sources and says what is done; the present ones stay until those are there.
    ///
    /// # Errors
    /// A sentence that says why there are no other runs.
    pub fn send_for(&mut self, step: Step) -> Result<String, String> {
        if self.is_waiting() {
            return Err("one run after the other: the last one that was asked for is not there yet".into());
        }
        let orders = self.reels.iter().map(|reel| reel.order(step)).collect::<Result<Vec<_>, _>>()?;
        let seeds: Vec<u64> = orders.iter().flatten().map(|(_, seed)| *seed).collect();
        let message = match seeds[..] {
            [] => return Err("a recording has no other seeds".into()),
            [seed] => format!("simulating seed {seed} ..."),
            [first, second, ..] if first == second => format!("simulating seed {first} twice ..."),
            [first, second, ..] => format!("simulating seeds {first} and {second} ..."),
        };
        let thread = thread::spawn(move || orders.into_iter().map(fetch).collect());
        self.coming = Some((step, thread));
        Ok(message)
    }

    /// Takes in the runs that were sent for; `None` while they are on their way or none were sent for.
    ///
    /// # Errors
    /// A sentence that says why they do not come; the present runs stay.
    pub fn receive(&mut self) -> Option<Result<Step, String>> {
        let (step, thread) = self.coming.take_if(|(_, thread)| thread.is_finished())?;
        let films = thread.join().unwrap_or_else(|_| Err("the simulation broke off, which is a bug".into()));
        Some(films.map(|films| {
            self.take_in(films);
            step
        }))
    }

    fn take_in(&mut self, films: Vec<Option<Film>>) {
        for (reel, film) in self.reels.iter_mut().zip(films) {
            if let Some(film) = film {
                reel.film = film;
            }
        }
    }
}

type Order = (Arc<dyn FilmSource>, u64);

fn fetch(order: Option<Order>) -> Result<Option<Film>, String> {
    order.map(|(source, seed)| source.film(seed)).transpose()
}

impl Reel {
    /// What to get next; nothing for a recording.
    fn order(&self, step: Step) -> Result<Option<Order>, String> {
        let Some(source) = &self.source else { return Ok(None) };
        let seed = neighbour(self.film.timeline().setting.seed, source.seeds(), step)?;
        Ok(Some((Arc::clone(source), seed)))
    }
}

/// The seed beside `seed`.
fn neighbour(seed: u64, seeds: Option<&[u64]>, step: Step) -> Result<u64, String> {
    let beside = match (seeds, step) {
        (None, Step::Next | Step::Rerun) => seed.checked_add(1),
        (None, Step::Previous) => seed.checked_sub(1),
        (Some(seeds), _) => {
            let at = seeds.iter().position(|&listed| listed == seed);
            let beside = match step {
                Step::Next | Step::Rerun => at.map_or(Some(0), |at| at.checked_add(1)),
                Step::Previous => at.and_then(|at| at.checked_sub(1)),
            };
            beside.and_then(|beside| seeds.get(beside).copied())
        }
    };
    beside.ok_or_else(|| match step {
        Step::Next | Step::Rerun => format!("seed {seed} is the last"),
        Step::Previous => format!("seed {seed} is the first"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_of_a_batch_are_walked_in_its_order_and_end() {
        let seeds = Some([4, 9, 2].as_slice());
        assert_eq!(neighbour(4, seeds, Step::Next), Ok(9));
        assert_eq!(neighbour(9, seeds, Step::Next), Ok(2));
        assert_eq!(neighbour(2, seeds, Step::Previous), Ok(9));
        assert!(neighbour(2, seeds, Step::Next).is_err());
        assert!(neighbour(4, seeds, Step::Previous).is_err());
    }

    #[test]
    fn seeds_of_a_scenario_follow_one_another() {
        assert_eq!(neighbour(7, None, Step::Next), Ok(8));
        assert_eq!(neighbour(7, None, Step::Previous), Ok(6));
        assert!(neighbour(0, None, Step::Previous).is_err());
        assert!(neighbour(u64::MAX, None, Step::Next).is_err());
    }
}
