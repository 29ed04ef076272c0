use crate::geometry::Pose;
use crate::planning::GoalDisc;
use crate::vehicle::{Dimensions, Segment};

use super::turn_straight::{Aim, Aiming};

/// Places on the path from which the goal is aimed at lie so far apart.
const KNOT_M: f64 = 4.0;
/// A new end must be better by this.
const WORTH_M: f64 = 0.05;
/// Exits that are swept before the path is left as it is.
const MAX_TRIES: usize = 6;

/// A place on the path from which the goal can be aimed at.
#[derive(Clone, Copy, Debug)]
struct Exit {
    /// Cost of the whole path when it leaves here.
    cost: f64,
    pose: Pose,
    /// The segment left, and the part of it driven before.
    index: usize,
    travelled_m: f64,
    aim: Aim,
}

/// Replaces the end of a path by an aim into the goal, where that makes it cheaper and is free, cheapest first.
///
/// `is_free` tells whether the truck may drive a segment from a pose.
pub fn shorten(
    body: &Dimensions,
    aiming: &Aiming,
    is_free: impl Fn(Pose, Segment) -> bool,
    start: Pose,
    goal: GoalDisc,
    segments: &mut Vec<Segment>,
) {
    let mut exits = exits(body, aiming, start, goal, segments);
    exits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let free = exits.iter().take(MAX_TRIES).find(|exit| {
        let mut pose = exit.pose;
        exit.aim.pieces().all(|piece| {
            let from = pose;
            pose = piece.end(from);
            is_free(from, piece)
        })
    });
    let Some(exit) = free else { return };
    let (last, aim) = (segments[exit.index], exit.aim);
    segments.truncate(exit.index);
    if exit.travelled_m != 0.0 {
        segments.push(Segment { length_m: exit.travelled_m, ..last });
    }
    segments.extend(aim.pieces());
}

/// All exits that make the path cheaper, in the order of the path.
fn exits(body: &Dimensions, aiming: &Aiming, start: Pose, goal: GoalDisc, segments: &[Segment]) -> Vec<Exit> {
    let limit = aiming.price.of_all(start, segments) - WORTH_M;
    let mut exits = Vec::new();
    let (mut pose, mut cost, mut before) = (start, 0.0, None);
    for (index, &segment) in segments.iter().enumerate() {
        let pieces = (segment.length_m.abs() / KNOT_M).ceil();
        for k in 0..pieces as u32 {
            let travelled_m = segment.length_m * f64::from(k) / pieces;
            let (here, spent, came) = if k == 0 {
                (pose, cost, before)
            } else {
                let driven = Segment { length_m: travelled_m, ..segment };
                let spent = cost + aiming.price.of(driven, before) + aiming.price.of_places(pose, driven);
                (driven.end(pose), spent, Some(segment.is_reverse()))
            };
            let centre = body.body_centre(here);
            let gap = centre.distance(goal.centre) - goal.radius_m;
            if gap <= 0.0 || spent + gap > limit {
                continue;
            }
            let aim = aiming.best_into(here, goal, came);
            let whole = |aim: &Aim| spent + (aim.cost + aiming.price.of_all_places(here, aim.pieces()));
            let exit = aim.map(|aim| Exit { cost: whole(&aim), pose: here, index, travelled_m, aim });
            exits.extend(exit.filter(|exit| exit.cost < limit));
        }
        cost += aiming.price.of(segment, before) + aiming.price.of_places(pose, segment);
        before = Some(segment.is_reverse());
        pose = segment.end(pose);
    }
    exits
}
