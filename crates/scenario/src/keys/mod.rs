//! Tables and keys of a scenario: what they are by default, their ranges, and what they mean.

pub mod agents;
pub mod alexandridis;
pub mod custom_fuel;
pub mod dispatch;
mod erased;
pub mod field;
pub mod fire;
pub mod goal;
pub mod ground_speed;
pub mod learned;
pub mod line;
pub mod network;
pub mod program;
pub mod rothermel;
pub mod rules;
pub mod traffic;
pub mod unimog;
pub mod water;
pub mod wumpus;
