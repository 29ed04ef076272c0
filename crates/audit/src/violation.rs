//! A violation of a rule: when, who, where, which rule.

use std::fmt;

use super::Contact;
use wildfire_base::geometry::{Cell, DVec2};
use wildfire_base::time::SimTime;
use wildfire_timeline::AgentId;

/// The rule that was broken, and by how much.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ViolationKind {
    Touched(Contact),
    /// Two trucks at one place.
    Overlap {
        other: AgentId,
        depth_m: f64,
    },
    /// A turn of less than the smallest radius; 0 on the spot.
    Curvature {
        radius_m: f64,
        min_m: f64,
    },
    /// The state at a time is not where the pieces of the leg lead.
    Astray {
        metres: f64,
        radians: f64,
    },
    Speed {
        found_mps: f64,
        limit_mps: f64,
    },
    Acceleration {
        found_mps2: f64,
        limit_mps2: f64,
    },
    Braking {
        found_mps2: f64,
        limit_mps2: f64,
    },
    Lateral {
        found_mps2: f64,
        limit_mps2: f64,
    },
    /// Front wheels that have not turned yet for the curvature of the way.
    Steering {
        behind_s: f64,
        max_s: f64,
    },
    /// Speed changes at once where acceleration has a limit; at cusps a truck stands.
    SpeedJump {
        from_mps: f64,
        to_mps: f64,
    },
    /// A piece whose braking would end before it does.
    StopsShort,
    /// A time or a place that is not a number.
    NotANumber,
    /// A leg begins this far from where the last one ended.
    Discontinuous {
        metres: f64,
        radians: f64,
    },
    /// A leg begins before the last one has ended.
    StillUnderWay {
        until: SimTime,
    },
    /// The leg as driven, after its goal was dropped, is another one than planned.
    CutDiffers,
    /// A fire went out while its truck was moving, or had stood for less than the dwell since its last one went out.
    NotStanding {
        cell: Cell,
        since: SimTime,
    },
    /// A fire went out beyond the reach of its truck.
    OutOfReach {
        cell: Cell,
        metres: f64,
        reach_m: f64,
    },
    /// One stop put out a second fire where the rules say one.
    SecondFire {
        cell: Cell,
    },
    /// A Wumpus lit a bush on its way.
    IgnitedInPassing {
        cell: Cell,
    },
    /// A cell that was not burning went out or burned out.
    NotBurning {
        cell: Cell,
    },
    /// A cell that cannot burn caught fire.
    CannotBurn {
        cell: Cell,
    },
    /// A bush caught fire from one that does not burn, spreads none, or not then.
    NoSource {
        cell: Cell,
        from: Cell,
    },
    /// A bush caught fire from one that is too far away.
    TooFarToSpread {
        cell: Cell,
        from: Cell,
        metres: f64,
        radius_m: f64,
    },
    /// A bush stayed as it was while another of its piece caught fire or went out, where pieces do so as a whole.
    TornPiece {
        cell: Cell,
    },
    /// A bush in the radius of one that spreads stayed as it was.
    SparedBySpread {
        cell: Cell,
        from: Cell,
    },
    /// Fire came to a cell at another time than from the cells around it.
    WrongArrival {
        cell: Cell,
        due: Option<SimTime>,
    },
    /// Fire came to a cell much sooner or later than straight over ground that is all alike.
    NotStraight {
        cell: Cell,
        due: SimTime,
    },
    /// A cell did not catch fire when fire came to it from the cells around.
    SparedByFront {
        cell: Cell,
        due: SimTime,
    },
    /// Water on a cell that has nothing left to burn, or for another time than the rules say.
    WrongWater {
        cell: Cell,
    },
    /// Line in a cell that cannot have any, or sooner than crews come there, or more of it than they build.
    WrongLine {
        cell: Cell,
    },
    /// Water came to a cell from a truck that is not there, or not for long enough.
    WaterFromAfar {
        cell: Cell,
        metres: f64,
        reach_m: f64,
    },
    /// A stop at a fire began, or put one out, without water in the tank for it.
    EmptyTank,
    /// A cell went out by less water than its front takes, before it was sprayed, or though it was too hot.
    TooLittleWater {
        cell: Cell,
    },
    /// A truck filled its tank this far from the nearest water, or before it stood there.
    NoWater {
        metres: f64,
        reach_m: f64,
    },
    /// A tank was not filled for as long as that takes.
    WrongRefill {
        due: SimTime,
    },
    /// A fire ended, or went on, against its time of burning out.
    WrongBurnOut {
        cell: Cell,
        due: Option<SimTime>,
    },
    /// An agent did what only the other role does, or it is not in the setting.
    WrongAgent,
    /// More to look at than any run has.
    Endless,
}

/// The first violation of a run or a leg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    pub time: SimTime,
    /// The agent that broke the rule, if one did.
    pub agent: Option<AgentId>,
    /// The agent's place, or the centre of the cell, in metres.
    pub place: DVec2,
    pub kind: ViolationKind,
}

/// Returns the first of these in time; of those at one time, the one that was found first.
pub fn first_violation(found: impl Iterator<Item = Result<(), Violation>>) -> Result<(), Violation> {
    found.filter_map(Result::err).min_by_key(|violation| violation.time).map_or(Ok(()), Err)
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let DVec2 { x, y } = self.place;
        write!(f, "at {}, ({x:.3}, {y:.3}) m: ", self.time)?;
        if let Some(agent) = self.agent {
            write!(f, "{agent}: ")?;
        }
        write!(f, "{}", self.kind)
    }
}

impl fmt::Display for ViolationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            // Overlaps are a small part of a metre, so millimetres are easier to read.
            Self::Touched(Contact::Bush { cell, depth_m }) => {
                write!(f, "the body is {:.1} mm deep in the bush at cell {cell}", 1e3 * depth_m)
            }
            Self::Touched(Contact::Border { depth_m }) => {
                write!(f, "the body is {:.1} mm outside of the field", 1e3 * depth_m)
            }
            Self::Overlap { other, depth_m } => {
                write!(f, "its body overlaps that of {other} by {:.1} mm", 1e3 * depth_m)
            }
            Self::Curvature { radius_m, min_m } => {
                write!(f, "it turns with a radius of {radius_m:.4} m, below its turning radius of {min_m} m")
            }
            Self::Astray { metres, radians } => {
                write!(f, "it is {metres:.6} m and {radians:.6} rad from where the pieces of its leg lead")
            }
            Self::Speed { found_mps, limit_mps } => {
                write!(f, "it moves at {found_mps:.4} m/s where {limit_mps} m/s is the limit")
            }
            Self::Acceleration { found_mps2, limit_mps2 } => {
                write!(f, "it speeds up by {found_mps2:.4} m/s2 where {limit_mps2} m/s2 is the limit")
            }
            Self::Braking { found_mps2, limit_mps2 } => {
                write!(f, "it brakes by {found_mps2:.4} m/s2 where {limit_mps2} m/s2 is the limit")
            }
            Self::Lateral { found_mps2, limit_mps2 } => {
                write!(f, "it turns at {found_mps2:.4} m/s2 to the side where {limit_mps2} m/s2 is the limit")
            }
            Self::Steering { behind_s, max_s } => {
                write!(f, "its front wheels need {behind_s:.4} s more to turn where {max_s} s is the limit")
            }
            Self::SpeedJump { from_mps, to_mps } => {
                write!(f, "its speed jumps from {from_mps:.4} m/s to {to_mps:.4} m/s")
            }
            Self::StopsShort => write!(f, "its brakes would stop it before the end of the way"),
            Self::NotANumber => write!(f, "its time or place is not a number"),
            Self::Discontinuous { metres, radians } => {
                write!(f, "a leg begins {metres:.6} m and {radians:.6} rad from where the last one ended")
            }
            Self::StillUnderWay { until } => write!(f, "a leg begins while the last one lasts until {until}"),
            Self::CutDiffers => write!(f, "the leg as driven is not the one that was planned"),
            Self::WrongAgent => write!(f, "this is not for this agent to do"),
            Self::Endless => write!(f, "its way is longer than can be looked at"),
            Self::NotStanding { cell, since } => {
                write!(f, "the fire at cell {cell} goes out, but its truck stands for it only since {since}")
            }
            Self::OutOfReach { cell, metres, reach_m } => {
                write!(f, "the fire at cell {cell} goes out {metres:.3} m away, beyond the reach of {reach_m} m")
            }
            Self::SecondFire { cell } => {
                write!(f, "the fire at cell {cell} goes out at a stop that has put out another one already")
            }
            Self::IgnitedInPassing { cell } => {
                write!(f, "the bush at cell {cell} is lit before the walk there is over")
            }
            Self::NotBurning { cell } => write!(f, "a fire ends at cell {cell}, where nothing burns"),
            Self::CannotBurn { cell } => write!(f, "fire catches at cell {cell}, where nothing is left that may burn"),
            Self::NoSource { cell, from } => {
                write!(f, "cell {cell} catches fire from cell {from}, which does not spread it then")
            }
            Self::TooFarToSpread { cell, from, metres, radius_m } => {
                write!(
                    f,
                    "cell {cell} catches fire from cell {from}, {metres:.3} m away where {radius_m} m is the limit"
                )
            }
            Self::TornPiece { cell } => {
                write!(f, "cell {cell} stays as it was while others of its piece change, which they do together")
            }
            Self::SparedBySpread { cell, from } => {
                write!(f, "cell {cell} does not catch fire from cell {from}, which spreads it there")
            }
            // In nanoseconds: arrivals are compared to 20 ns, and a time prints milliseconds.
            Self::WrongArrival { cell, due: Some(due) } => {
                write!(f, "cell {cell} catches fire at another time than fire comes there, at {} ns", due.as_nanos())
            }
            Self::WrongArrival { cell, due: None } => {
                write!(f, "cell {cell} catches fire where none comes from the cells around it")
            }
            Self::NotStraight { cell, due } => {
                write!(f, "cell {cell} catches fire far from {due}, when fire comes straight over one fuel")
            }
            Self::SparedByFront { cell, due } => {
                write!(f, "cell {cell} does not catch fire at {} ns, when fire comes there", due.as_nanos())
            }
            Self::WrongWater { cell } => {
                write!(f, "water comes to cell {cell}, which has nothing left to burn or is wet for another time")
            }
            Self::WrongLine { cell } => {
                write!(f, "line in cell {cell} that has nothing left to burn, or that crews cannot have built by then")
            }
            Self::WaterFromAfar { cell, metres, reach_m } => {
                write!(f, "water comes to cell {cell}, {metres:.3} m away, beyond the reach of {reach_m} m")
            }
            Self::EmptyTank => write!(f, "it stops at a fire without water for it"),
            Self::TooLittleWater { cell } => {
                write!(
                    f,
                    "cell {cell} goes out with less water or sooner than its heat requires, or is too hot for the pump"
                )
            }
            Self::NoWater { metres, reach_m } => {
                write!(
                    f,
                    "it fills its tank {metres:.3} m from the nearest water, which reaches {reach_m} m, or under way"
                )
            }
            Self::WrongRefill { due } => write!(f, "it fills its tank, which takes until {due}, for another time"),
            Self::WrongBurnOut { cell, due: Some(due) } => {
                write!(f, "the fire at cell {cell} does not burn out when it should, at {due}")
            }
            Self::WrongBurnOut { cell, due: None } => {
                write!(f, "the fire at cell {cell} burns out, which the rules do not let it")
            }
        }
    }
}
