//! Batches over runs that are made up: what is written, what is left when something goes wrong, and comparisons of them.

#[cfg(unix)]
mod changed;
mod compare;
mod disk;
mod made_up;
mod parquet;
mod rank;
mod recordings;
mod resume;
mod rows;
mod shared;
mod slices;
mod stopping;
