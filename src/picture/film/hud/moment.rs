//! What the words about a shot are taken from.

use super::super::{Film, Look, Shot, Tally};
use crate::time::SimTime;
use crate::timeline::State;

/// The runs of a shot at its time.
pub struct Moment<'a> {
    pub films: &'a [&'a Film],
    pub look: &'a Look,
    pub time: SimTime,
    /// When the last run ends.
    pub end: SimTime,
    pub states: &'a [State],
    pub tallies: Vec<Tally>,
}

impl<'a> Moment<'a> {
    pub fn new(shot: &Shot<'a>, states: &'a [State]) -> Self {
        let end = Film::last_end(shot.films);
        let time = shot.time.min(end);
        let tallies = shot.films.iter().map(|film| film.tally_at(time)).collect();
        Self { films: shot.films, look: shot.look, time, end, states, tallies }
    }

    pub fn is_comparison(&self) -> bool {
        self.films.len() > 1
    }
}
