//! The moments of a run that a film shows, and how long each is visible.

use crate::time::SimTime;

/// The most frames of a film: at twenty a second, an hour and a half.
pub const MOST_FRAMES: u64 = 100_000;

/// The moments that a film shows: evenly spaced from a first to a last one, both shown.
#[derive(Clone, Copy, Debug)]
pub struct Moments {
    pub from: SimTime,
    pub to: SimTime,
    /// Simulated seconds for a second of the film.
    pub speed: f64,
    /// Frames for a second of the film.
    pub fps: f64,
}

impl Moments {
    /// The delay of the last frame of a loop, in hundredths of a second.
    const LAST_DELAY: u16 = 100;

    pub fn count(&self) -> u64 {
        let steps = (self.to.since(self.from).as_seconds() / self.step_s()).ceil();
        steps as u64 + 1
    }

    /// The simulated time of a frame, from 0 on.
    pub fn time(&self, frame: u64) -> SimTime {
        (self.from + SimTime::from_seconds(frame as f64 * self.step_s())).min(self.to)
    }

    /// Returns the delay of a frame, in hundredths of a second, so that rounding errors do not add up.
    pub fn hundredths(&self, frame: u64) -> u16 {
        if frame + 1 == self.count() {
            return Self::LAST_DELAY;
        }
        let until = |frame: u64| (100.0 * frame as f64 / self.fps).round();
        (until(frame + 1) - until(frame)) as u16
    }

    /// Some frames from all over the film, at most `most`, the last among them.
    pub fn sample(&self, most: u64) -> impl Iterator<Item = u64> + use<> {
        let last = self.count() - 1;
        let stride = last.div_ceil(most - 1).max(1);
        (0..last).step_by(stride as usize).chain([last])
    }

    fn step_s(&self) -> f64 {
        self.speed / self.fps
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(from: f64, to: f64, speed: f64, fps: f64) -> Moments {
        Moments { from: SimTime::from_seconds(from), to: SimTime::from_seconds(to), speed, fps }
    }

    #[test]
    fn first_and_last_moment_are_shown_and_none_beyond() {
        for (from, to, speed, fps) in
            [(0.0, 3600.0, 60.0, 20.0), (10.0, 10.0, 1.0, 7.0), (0.0, 1.0, 0.1, 30.0), (1.0, 9.3, 0.7, 3.0)]
        {
            let moments = moments(from, to, speed, fps);
            let times: Vec<_> = (0..moments.count()).map(|frame| moments.time(frame)).collect();
            assert_eq!((times[0], times.last()), (moments.from, Some(&moments.to)));
            assert!(times.is_sorted_by(|earlier, later| earlier < later), "{moments:?}");
        }
    }

    #[test]
    fn film_of_ten_seconds_has_two_hundred_steps() {
        let moments = moments(0.0, 600.0, 60.0, 20.0);
        assert_eq!(moments.count(), 201);
        assert_eq!(moments.time(100), SimTime::from_seconds(300.0));
    }

    #[test]
    fn delays_add_up_to_the_time_of_the_film() {
        for fps in [1.0, 7.0, 24.0, 30.0, 50.0] {
            let moments = moments(0.0, 420.0, 10.0, fps);
            let last = moments.count() - 1;
            let sum: u16 = (0..last).map(|frame| moments.hundredths(frame)).sum();
            assert_eq!(sum, 4200, "{fps}");
            assert!((0..last).all(|frame| moments.hundredths(frame) >= 2), "{fps}");
            assert_eq!(moments.hundredths(last), 100);
        }
    }

    #[test]
    fn sample_has_the_ends_and_no_frame_twice() {
        for seconds in [0.0, 0.1, 3.0, 160.0, 161.0, 3600.0] {
            let moments = moments(0.0, seconds, 1.0, 10.0);
            let sample: Vec<_> = moments.sample(32).collect();
            assert!(sample.len() <= 32, "{}", sample.len());
            assert!(sample.is_sorted_by(|earlier, later| earlier < later));
            assert_eq!((sample[0], sample.last()), (0, Some(&(moments.count() - 1))));
        }
    }
}
