//! Batches over runs that are made up: what is written, and what is left when something goes wrong.

mod disk;
mod made_up;
mod parquet;
mod resume;
mod rows;
mod slices;
