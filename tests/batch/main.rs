//! Batches over runs that are made up: what is written, and what is left when something goes wrong.

#[cfg(unix)]
mod changed;
mod disk;
mod made_up;
mod parquet;
mod recordings;
mod resume;
mod rows;
mod shared;
mod slices;
