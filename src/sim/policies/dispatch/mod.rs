//! Policies for a whole team of trucks: who goes to which fire, and where those wait who go to none.

mod team;

pub use team::{Assignment, Fire, Intact, Positioning, Team, TeamRules, TeamTruck, WAY_FACTOR};
