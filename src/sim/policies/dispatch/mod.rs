//! Policies for a whole team of trucks: who goes to which fire, and where those wait who go to none.

mod make;
mod nearest;
mod policy;
mod team;

pub use make::make;
pub use team::{Assignment, Fire, Intact, Positioning, Team, TeamRules, TeamTruck, WAY_FACTOR};
