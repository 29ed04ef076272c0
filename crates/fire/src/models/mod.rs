//! The fire models, each with its own parameters and the memory that it takes.

mod alexandridis;
mod radius;
mod rothermel;

pub use alexandridis::{Alexandridis, AlexandridisRules, Density, Vegetation};
pub use radius::Radius;
pub use rothermel::{DirectionSet, Neighbours, Rothermel, RothermelRules, sampled_cells};
