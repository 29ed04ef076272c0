//! The formulas: how long the inner letters of a word have to be.
//!
//! [`crate::vehicle::curve::circles`] tells how the vector D between the centres of the first and the last turning
//! circle decides a word. To write D down, follow the centre of the circle on which the vehicle turns. During an arc it
//! stays. A straight of length s at the heading q moves it by s e(q), where e(q) is the unit vector of the heading;
//! passing from the left-hand circle to the right-hand one at the heading q adds 2 e(q - pi/2), and passing back takes
//! that away. Summed over a word, D is one vector of known angle against the heading at which the first arc ends:
//!
//! | formula | word | middle | it turns by | lean, as a complex number |
//! |---|---|---|---|---|
//! | 8.1 | L+ S+ L+ | S = d | 0 | 1 |
//! | 8.2 | L+ S+ R+ | S = w | 0 | w + 2i |
//! | 8.3, 8.4 | L+ R- L+, L+ R- L- | R = u, sin(u/2) = d/4 | u | -q + di |
//! | 8.4 backwards | L+ R+ L- | R = u, sin(u/2) = d/4 | -u | q + di |
//! | 8.7 | L+ R+ L- R- | R = L = u, cos u = (2 + d)/4 | -2u | -sin u + i cos u |
//! | 8.8 | L+ R- L- R+ | R = L = u, cos u = (20 - d^2)/16 | 0 | -2 sin u + i (4 - 2 cos u) |
//! | 8.9 | L+ R- S- L- | R = pi/2, S = w - 2 | pi/2 | -2 + wi |
//! | 8.9 backwards | L+ S+ R+ L- | S = w - 2, R = pi/2 | -pi/2 | w + 2i |
//! | 8.10 | L+ R- S- R- | R = pi/2, S = d - 2 | pi/2 | i |
//! | 8.10 backwards | L+ S+ L+ R- | S = d - 2, L = pi/2 | pi/2 | 1 |
//! | 8.11 | L+ R- S- L- R+ | R = L = pi/2, S = w - 4 | 0 | -2 + wi |
//! | Dubins | L+ R+ L+ | R = 2 pi - u, sin(u/2) = d/4 | u | -q + di |
//!
//! with d the length of D, w = sqrt(d^2 - 4) that of the inner tangent, and q = sqrt(16 - d^2). A word exists when its
//! middle does.
//!
//! Source of the words and of the numbers: J. A. Reeds, L. A. Shepp, "Optimal paths for a car that goes both forwards and
//! backwards", Pacific Journal of Mathematics 145 (2), 1990, section 8. The paper writes D in the frame of the start.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::word::WordForm;
use crate::geometry::ops;
use crate::vehicle::curve::MAX_LETTERS;
use crate::vehicle::curve::circles::{Ends, Middle, OuterArcs, View, at_least, at_most};

impl WordForm {
    /// Returns on which side the last arc lies.
    #[inline(always)]
    pub fn ends(self) -> Ends {
        match self {
            Self::LpSpLp
            | Self::LpRmLp
            | Self::LpRmLm
            | Self::LpRpLm
            | Self::LpRmSmLm
            | Self::LpSpRpLm
            | Self::LpRpLp => Ends::SameSide,
            Self::LpSpRp | Self::LpRpLmRm | Self::LpRmLmRp | Self::LpRmSmRm | Self::LpSpLpRm | Self::LpRmSmLmRp => {
                Ends::OtherSide
            }
        }
    }

    /// Returns what lies between the outer arcs, if their centres are neither too close nor too far apart.
    #[inline(always)]
    pub fn middle(self, view: &View) -> Option<Middle> {
        let &View { squared, distance: d, tangent: w, .. } = view;
        // Those that end in L+ or R-, which turn counter-clockwise as L+ does.
        let turns_on = matches!(
            self,
            Self::LpSpLp | Self::LpRmLp | Self::LpRpLmRm | Self::LpRmSmRm | Self::LpSpLpRm | Self::LpRpLp
        );
        let middle = |length, turn, x, y| Some(Middle { length, turn, lean: DVec2::new(x, y), turns_on });
        match self {
            Self::LpSpLp => middle(d, 0.0, 1.0, 0.0),
            Self::LpSpRp => {
                // Circles that overlap have no inner tangent.
                at_least(4.0, squared)?;
                middle(w, 0.0, w, 2.0)
            }
            Self::LpRmLp | Self::LpRmLm => {
                let (u, q) = inner_arc(view)?;
                middle(u, u, -q, d)
            }
            Self::LpRpLm => {
                let (u, q) = inner_arc(view)?;
                middle(u, -u, q, d)
            }
            Self::LpRpLp => {
                // Dubins' word takes the longer of the two arcs between the touching circles.
                let (u, q) = inner_arc(view)?;
                middle(TAU - u, u, -q, d)
            }
            Self::LpRpLmRm => {
                // The inner arcs are equal (8.7), so one length stands for both.
                let cos = at_most(1.0, 0.25 * (2.0 + d))?;
                let u = ops::acos(cos);
                middle(2.0 * u, -2.0 * u, -sine(cos), cos)
            }
            Self::LpRmLmRp => {
                // Reeds and Shepp bound these arcs by a quarter circle, up to where the cosine is not negative.
                let cos = at_least(0.0, at_most(1.0, (20.0 - squared) / 16.0)?)?;
                middle(2.0 * ops::acos(cos), 0.0, -2.0 * sine(cos), 4.0 - 2.0 * cos)
            }
            // From here on an inner arc beside a straight is a quarter circle, which the middle includes.
            Self::LpRmSmLm => middle(FRAC_PI_2 + at_least(0.0, w - 2.0)?, FRAC_PI_2, -2.0, w),
            Self::LpSpRpLm => middle(FRAC_PI_2 + at_least(0.0, w - 2.0)?, -FRAC_PI_2, w, 2.0),
            Self::LpRmSmRm => middle(FRAC_PI_2 + at_least(0.0, d - 2.0)?, FRAC_PI_2, 0.0, 1.0),
            Self::LpSpLpRm => middle(FRAC_PI_2 + at_least(0.0, d - 2.0)?, FRAC_PI_2, 1.0, 0.0),
            Self::LpRmSmLmRp => middle(PI + at_least(0.0, w - 4.0)?, 0.0, -2.0, w),
        }
    }

    /// One length per letter, in the word's order.
    pub fn lengths(self, middle: f64, outer: &OuterArcs) -> [f64; MAX_LETTERS] {
        let &OuterArcs { first, last, .. } = outer;
        match self {
            Self::LpSpLp | Self::LpSpRp | Self::LpRmLp | Self::LpRmLm | Self::LpRpLm | Self::LpRpLp => {
                [first, middle, last, 0.0, 0.0]
            }
            Self::LpRpLmRm | Self::LpRmLmRp => [first, 0.5 * middle, 0.5 * middle, last, 0.0],
            Self::LpRmSmLm | Self::LpRmSmRm => [first, FRAC_PI_2, middle - FRAC_PI_2, last, 0.0],
            Self::LpSpRpLm | Self::LpSpLpRm => [first, middle - FRAC_PI_2, FRAC_PI_2, last, 0.0],
            Self::LpRmSmLmRp => [first, FRAC_PI_2, middle - PI, FRAC_PI_2, last],
        }
    }
}

/// The arc between two circles that touch both outer ones, and q of the table.
#[inline(always)]
fn inner_arc(view: &View) -> Option<(f64, f64)> {
    let sine_of_half = at_most(1.0, 0.25 * view.distance)?;
    Some((PI - 2.0 * ops::acos(sine_of_half), 4.0 * sine(sine_of_half)))
}

/// The sine of an angle in [0, pi/2] from its cosine, or the reverse.
fn sine(cosine: f64) -> f64 {
    (1.0 - cosine * cosine).max(0.0).sqrt()
}
