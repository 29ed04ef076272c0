//! The program told to do things from outside, as small stories.

mod commands;
mod contest;
mod errors;
mod story;
