//! The clock of a window, shared by all its runs.

use std::time::Duration;

use bevy::prelude::Resource;

use wildfire_base::time::SimTime;

/// The speeds that one goes through, in simulated seconds for a second.
const SPEEDS: [f64; 13] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];

/// A clock between 0 and the end of the longest run. It stops there, paused.
#[derive(Clone, Copy, Debug, PartialEq, Resource)]
pub struct Player {
    clock: SimTime,
    end: SimTime,
    speed: f64,
    is_paused: bool,
}

impl Player {
    pub const SLOWEST: f64 = SPEEDS[0];
    pub const FASTEST: f64 = SPEEDS[SPEEDS.len() - 1];

    /// Playing from `start`; a speed out of range becomes the slowest or the fastest.
    pub fn new(start: SimTime, end: SimTime, speed: f64) -> Self {
        Self { clock: start.min(end), end, speed: speed.clamp(Self::SLOWEST, Self::FASTEST), is_paused: false }
    }

    pub fn clock(&self) -> SimTime {
        self.clock
    }

    pub fn end(&self) -> SimTime {
        self.end
    }

    /// Simulated seconds for a second.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    pub fn is_paused(&self) -> bool {
        self.is_paused
    }

    /// Advances the clock by real time.
    pub fn advance(&mut self, real: Duration) {
        if self.is_paused {
            return;
        }
        self.seek(self.clock + SimTime::from_seconds(real.as_secs_f64() * self.speed));
        self.is_paused = self.clock == self.end;
    }

    pub fn pause(&mut self) {
        self.is_paused = true;
    }

    pub fn play(&mut self) {
        self.is_paused = false;
    }

    /// Pauses or plays; at the end, plays from the start.
    pub fn toggle_pause(&mut self) {
        if self.is_paused && self.clock == self.end {
            self.clock = SimTime::ZERO;
        }
        self.is_paused = !self.is_paused;
    }

    /// Sets the clock, at most to the end.
    pub fn seek(&mut self, time: SimTime) {
        self.clock = time.min(self.end);
    }

    /// Sets the clock that many seconds forward, or back where they are negative.
    pub fn seek_by(&mut self, seconds: f64) {
        let span = SimTime::from_seconds(seconds.abs());
        self.seek(if seconds < 0.0 { self.clock.since(span) } else { self.clock + span });
    }

    /// Sets the clock to a share of the whole time, 0 to 1.
    pub fn seek_share(&mut self, share: f64) {
        self.seek(SimTime::from_seconds(share * self.end.as_seconds()));
    }

    /// Switches to the next higher of the usual speeds.
    pub fn faster(&mut self) {
        self.speed = SPEEDS.into_iter().find(|&speed| speed > self.speed).unwrap_or(Self::FASTEST);
    }

    /// Switches to the next lower of the usual speeds.
    pub fn slower(&mut self) {
        self.speed = SPEEDS.into_iter().rev().find(|&speed| speed < self.speed).unwrap_or(Self::SLOWEST);
    }

    /// Continues with other runs at the same time, at most at their end.
    pub fn change_end(&mut self, end: SimTime) {
        self.end = end;
        self.seek(self.clock);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds)
    }

    fn player() -> Player {
        Player::new(SimTime::ZERO, seconds(100.0), 10.0)
    }

    #[test]
    fn clock_goes_speed_times_as_fast_and_stands_while_paused() {
        let mut player = player();
        player.advance(Duration::from_millis(300));
        assert_eq!(player.clock(), seconds(3.0));
        player.toggle_pause();
        player.advance(Duration::from_secs(7));
        assert_eq!(player.clock(), seconds(3.0));
        player.toggle_pause();
        player.advance(Duration::from_millis(100));
        assert_eq!(player.clock(), seconds(4.0));
    }

    #[test]
    fn other_slices_of_the_same_time_lead_to_the_same_clock() {
        for speed in [1.0, 50.0, 1000.0] {
            let mut once = Player::new(SimTime::ZERO, SimTime::MAX, speed);
            let mut often = once;
            once.advance(Duration::from_millis(1600));
            (0..100).for_each(|_| often.advance(Duration::from_millis(16)));
            assert_eq!(once, often);
        }
    }

    #[test]
    fn clock_stops_at_the_end_and_starts_again_from_the_beginning() {
        let mut player = player();
        player.advance(Duration::from_secs(11));
        assert_eq!((player.clock(), player.is_paused()), (seconds(100.0), true));
        player.toggle_pause();
        assert_eq!((player.clock(), player.is_paused()), (SimTime::ZERO, false));
    }

    #[test]
    fn seeking_stays_between_the_ends() {
        let mut player = player();
        player.seek_by(-10.0);
        assert_eq!(player.clock(), SimTime::ZERO);
        player.seek_by(60.0);
        assert_eq!(player.clock(), seconds(60.0));
        player.seek_by(60.0);
        assert_eq!(player.clock(), seconds(100.0));
        player.seek_share(0.25);
        assert_eq!(player.clock(), seconds(25.0));
        player.change_end(seconds(20.0));
        assert_eq!(player.clock(), seconds(20.0));
    }

    #[test]
    fn speeds_go_in_steps_between_the_slowest_and_the_fastest() {
        let mut player = Player::new(SimTime::ZERO, seconds(1.0), 3.0);
        player.faster();
        assert_eq!(player.speed(), 5.0);
        player.slower();
        assert_eq!(player.speed(), 2.0);
        (0..20).for_each(|_| player.faster());
        assert_eq!(player.speed(), 1000.0);
        (0..20).for_each(|_| player.slower());
        assert_eq!(player.speed(), 0.1);
    }
}
