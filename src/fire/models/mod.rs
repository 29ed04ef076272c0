//! The fire models, each with its own parameters and the memory that it takes.

mod radius;

pub use radius::Radius;
