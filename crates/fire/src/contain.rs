//! Containment of a growing fire by a line that crews build along its edge, or parallel to it.
//!
//! Fried, J.S., Fried, B.D. 1996. Simulating wildfire containment with realistic tactics. Forest Science 42, 267-281.
//!
//! The free fire is an ellipse that grows from its rear focus. Crews begin at the head or at the rear and build line on both
//! flanks, each with half of the production. A builder is at the point of the ellipse with the eccentric angle u, or at the
//! offset from it along its normal: it moves with the front, and along it with what its rate leaves. The fire is contained
//! when u has passed all of the flank. Units: chains (20.1168 m), acres (10 square chains), minutes.
//!
//! Steps of time and the conventions named at [`FireFlank`] were deduced from the answers of BEHAVE to 1,200 cases.

use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use wildfire_base::geometry::{DVec2, ops};

use crate::surface::{LengthToWidth, length_to_width};

// Square chains.
const ACRE: f64 = 10.0;
const MAX_ACRES: f64 = 1000.0;
const MAX_MINUTES: f64 = 1080.0;

/// People or machines that build line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resource {
    /// After the report.
    pub arrival_min: f64,
    pub duration_min: f64,
    /// The sum of both flanks.
    pub production_ch_h: f64,
}

/// Where the line begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Tactic {
    Head,
    Rear,
}

/// A fire and what is sent to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Attack {
    /// The rate of spread of the head, constant from the report on.
    pub rate_ch_h: f64,
    pub size_acre: f64,
    pub length_to_width: f64,
    pub tactic: Tactic,
    /// Between the fire and the line.
    pub offset_ch: f64,
    /// At least one.
    pub resources: Vec<Resource>,
    /// The least number of time steps of a containment: a step takes a minute and is halved until this number is reached.
    /// The run ends at four times this number.
    pub min_steps: u32,
}

/// The end of an attack: the line is closed, the last resource has left, the fire is larger than 1,000 acres, 18 hours have
/// passed since the report, or the steps ran out before that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    Contained,
    Exhausted,
    SizeLimit,
    TimeLimit,
    Attacked,
}

impl Status {
    pub fn name(self) -> &'static str {
        ["contained", "exhausted", "size_limit", "time_limit", "attacked"][self as usize]
    }
}

/// The result of an attack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    pub status: Status,
    /// After the report, at the end of the last step.
    pub time_min: f64,
    /// The length of line on both flanks.
    pub line_ch: f64,
    /// Within the line, and what burns outside it where it is not closed.
    pub area_acre: f64,
}

impl Attack {
    pub fn run(&self) -> Outcome {
        let mut step_min = 1.0;
        loop {
            let (outcome, steps) = self.run_with(step_min);
            if outcome.status != Status::Contained || steps >= self.min_steps {
                return outcome;
            }
            step_min *= 0.5;
        }
    }

    /// Returns perimeter (ch) and size (acres) of the free fire when the first resource arrives, as BEHAVE prints them: by
    /// another ellipse than that of the containment, one whose ratio follows from the wind by Anderson's formula and the wind
    /// from the ratio by a linear one.
    pub fn free_fire(&self) -> [f64; 2] {
        let ratio = length_to_width(4.0 * (self.length_to_width - 1.0), LengthToWidth::Anderson1983);
        let shape = FireShape::new(ratio);
        let head = shape.head(self.size_acre) + self.rate_ch_h * self.start_min() / 60.0;
        let (a, b) = (shape.a * head, shape.b * head);
        let h = (a - b) * (a - b) / ((a + b) * (a + b));
        [PI * (a + b) * (1.0 + h / 4.0 + h * h / 64.0), PI * a * b / ACRE]
    }

    fn start_min(&self) -> f64 {
        self.resources.iter().map(|resource| resource.arrival_min).fold(f64::INFINITY, f64::min)
    }

    /// Production per minute of a flank; resources work to the end of the minute of their departure.
    fn production(&self, time_min: f64) -> f64 {
        self.resources
            .iter()
            .filter(|resource: &&Resource| {
                (resource.arrival_min..=resource.arrival_min + resource.duration_min).contains(&time_min)
            })
            .map(|resource| resource.production_ch_h / 120.0)
            .sum()
    }

    fn run_with(&self, step_min: f64) -> (Outcome, u32) {
        let shape = FireShape::new(self.length_to_width);
        let rate = self.rate_ch_h / 60.0;
        let flank = FireFlank { shape, rate, offset: self.offset_ch, is_rear: self.tactic == Tactic::Rear };
        let last =
            self.resources.iter().map(|resource| resource.arrival_min + resource.duration_min).fold(0.0, f64::max);
        let mut time = self.start_min();
        let mut head = shape.head(self.size_acre) + rate * time;
        let mut passed = 0.0;
        let mut at = flank.point(passed, head);
        let (mut line, mut swept) = (0.0, 0.0);
        for steps in 1_u32.. {
            // The rate of the first three stages is that at the beginning of the step.
            let [production, then] = [time, time + step_min].map(|time| self.production(time));
            // A step of the classical Runge-Kutta method for the angle that the builder has passed.
            let half = 0.5 * step_min;
            let first = flank.pace(passed, head, production);
            let second = flank.pace(passed + half * first, head + half * rate, production);
            let third = flank.pace(passed + half * second, head + half * rate, production);
            let fourth = flank.pace(passed + step_min * third, head + step_min * rate, then);
            let next = passed + step_min * (first + 2.0 * (second + third) + fourth) / 6.0;
            let is_closed = next >= PI;
            let to = if is_closed {
                flank.end(passed, next, head, step_min)
            } else {
                flank.point(next, head + step_min * rate)
            };
            // Doubled, as the other flank is the mirror image of this one.
            line += 2.0 * (to - at).length();
            // Trapezoids between flank and axis, each doubled for the other flank.
            swept += (at.y + to.y) * (to.x - at.x);
            (passed, head, at, time) = (next, head + step_min * rate, to, time + step_min);
            let area_acre = (swept.abs() + if is_closed { 0.0 } else { flank.outside(at, head) }) / ACRE;
            // In this order: a line that closes counts, even in the step that passes a limit.
            let status = match () {
                () if is_closed => Status::Contained,
                () if area_acre > MAX_ACRES => Status::SizeLimit,
                () if time >= MAX_MINUTES => Status::TimeLimit,
                () if time >= last => Status::Exhausted,
                () if steps >= 4 * self.min_steps => Status::Attacked,
                () => continue,
            };
            return (Outcome { status, time_min: time, line_ch: line, area_acre }, steps);
        }
        unreachable!("the time is limited")
    }
}

/// An ellipse with its head at the distance 1 from the origin of the fire, a focus.
#[derive(Clone, Copy)]
struct FireShape {
    a: f64,
    b: f64,
    center: f64,
}

impl FireShape {
    fn new(length_to_width: f64) -> Self {
        let eccentricity = (1.0 - 1.0 / (length_to_width * length_to_width)).sqrt();
        let a = 1.0 / (1.0 + eccentricity);
        Self { a, b: a / length_to_width, center: eccentricity * a }
    }

    /// Returns how far the head of a fire of this size is from the origin.
    fn head(self, size_acre: f64) -> f64 {
        (size_acre * ACRE / (PI * self.a * self.b)).sqrt()
    }
}

/// One flank of the fire, seen from where the line begins: the angle that the builder has passed goes from 0 to pi. Seen
/// from the rear, x points backwards.
///
/// Conventions of BEHAVE: the part of the curvature that the offset brings in has a factor b^2 too many, so that a parallel
/// line is longer than its builders' rate allows unless the fire is round. The last point of a line from the head lies where
/// the rear was, a share of a step before.
struct FireFlank {
    shape: FireShape,
    rate: f64,
    offset: f64,
    is_rear: bool,
}

impl FireFlank {
    /// Returns the ellipse's point and its outward normal for a head at 1.
    fn edge(&self, passed: f64) -> (DVec2, DVec2, f64) {
        let FireShape { a, b, center } = self.shape;
        let (sin, cos) = ops::sin_cos(passed);
        let center = if self.is_rear { -center } else { center };
        let stretch = (a * a * sin * sin + b * b * cos * cos).sqrt();
        (DVec2::new(center + a * cos, b * sin), DVec2::new(b * cos, a * sin) / stretch, stretch)
    }

    fn point(&self, passed: f64, head: f64) -> DVec2 {
        let (point, normal, _) = self.edge(passed);
        point * head + normal * self.offset
    }

    /// Computes the angle that the builder passes in a minute.
    fn pace(&self, passed: f64, head: f64, production: f64) -> f64 {
        let (point, normal, stretch) = self.edge(passed);
        let FireShape { a, b, .. } = self.shape;
        let outwards = self.rate * point.dot(normal);
        let along = self.rate * point.dot(normal.perp());
        // A builder that is no faster than the front has nothing left to go along it.
        let free = (production * production - outwards * outwards).max(0.0).sqrt();
        (free - along) / (head * stretch + self.offset * b * b * a * b / (stretch * stretch))
    }

    /// Returns where the two flanks meet, within a step that passes the end.
    fn end(&self, passed: f64, next: f64, head: f64, step_min: f64) -> DVec2 {
        let (from, to) = if self.is_rear { (PI - passed, next - PI) } else { (passed, next) };
        let share = from / (from + to) * self.rate * step_min;
        self.point(PI, if self.is_rear { head + share } else { head - share })
    }

    /// Returns the area of the free fire beyond the builder, on both flanks; of the part beyond an offset line an
    /// approximation.
    fn outside(&self, at: DVec2, head: f64) -> f64 {
        let FireShape { a, b, center } = self.shape;
        let (a, b) = (a * head, b * head);
        let x = (if self.is_rear { -center } else { center }) * head - at.x;
        match x / a {
            before if before <= -1.0 => PI * a * b,
            behind if behind >= 1.0 => 0.0,
            ratio => (a * b * ops::atan2(at.y / b, ratio) - x * at.y).max(0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A round fire of one acre that grows by 5 ch/h, and a crew that arrives with the report.
    fn attack(production_ch_h: f64) -> Attack {
        Attack {
            rate_ch_h: 5.0,
            size_acre: 1.0,
            length_to_width: 1.0,
            tactic: Tactic::Head,
            offset_ch: 0.0,
            resources: vec![Resource { arrival_min: 0.0, duration_min: 900.0, production_ch_h }],
            min_steps: 2500,
        }
    }

    fn is_near(found: f64, expected: f64) -> bool {
        (found - expected).abs() <= 1e-3 * expected
    }

    #[test]
    fn the_line_around_a_round_fire_is_a_logarithmic_spiral() {
        // r du = k dr with k^2 = (p / rate)^2 - 1, so that r grows by exp(pi / k) over half a turn.
        for (tactic, offset_ch) in [(Tactic::Head, 0.0), (Tactic::Rear, 0.0), (Tactic::Head, 2.0), (Tactic::Rear, 2.0)]
        {
            let k = 3.0_f64.sqrt();
            let radius = (ACRE / PI).sqrt() + offset_ch;
            let growth = ops::exp(PI / k);
            let minutes = radius * (growth - 1.0) * 60.0 / 5.0;
            let outcome = Attack { tactic, offset_ch, ..attack(20.0) }.run();
            assert_eq!(outcome.status, Status::Contained);
            assert!(is_near(outcome.time_min, minutes), "{tactic:?}: {outcome:?}, {minutes} min");
            assert!(is_near(outcome.line_ch, 20.0 * minutes / 60.0), "{tactic:?}: {outcome:?}");
            let area = radius * radius * k / 2.0 * (growth * growth - 1.0) / ACRE;
            assert!(is_near(outcome.area_acre, area), "{tactic:?}: {outcome:?}, {area} acres");
        }
    }

    #[test]
    fn an_attack_that_is_too_slow_ends_when_the_crew_leaves_or_the_fire_is_too_large() {
        // With 9 ch/h on two flanks the crew is slower than the head, and only follows it.
        let slow = attack(9.0);
        let follows =
            Attack { resources: vec![Resource { duration_min: 60.0, ..slow.resources[0] }], ..slow.clone() }.run();
        let radius = (ACRE / PI).sqrt() + 5.0;
        assert_eq!((follows.status, follows.time_min), (Status::Exhausted, 60.0));
        assert!(
            is_near(follows.area_acre, PI * radius * radius / ACRE) && is_near(follows.line_ch, 10.0),
            "{follows:?}"
        );
        assert_eq!(slow.run().status, Status::SizeLimit);
        assert_eq!(Attack { rate_ch_h: 0.5, ..attack(0.9) }.run().status, Status::Exhausted);
        assert_eq!(Attack { min_steps: 10, ..attack(9.0) }.run().status.name(), "attacked");
        let late = Resource { arrival_min: 300.0, duration_min: 900.0, production_ch_h: 0.9 };
        assert_eq!(Attack { rate_ch_h: 0.5, resources: vec![late], ..attack(0.9) }.run().status, Status::TimeLimit);
    }

    #[test]
    fn production_adds_up_while_resources_are_there() {
        let mut two = attack(20.0);
        two.resources.push(Resource { arrival_min: 30.0, duration_min: 60.0, production_ch_h: 10.0 });
        let at = [29.0, 30.0, 90.0, 91.0, 901.0].map(|time| (120.0 * two.production(time)).round());
        assert_eq!(at, [20.0, 30.0, 30.0, 20.0, 0.0]);
        // One acre at the report, and a round fire stays round.
        let [perimeter, size] = two.free_fire();
        assert!(is_near(size, 1.0) && is_near(perimeter, 2.0 * (PI * ACRE).sqrt()));
    }
}
