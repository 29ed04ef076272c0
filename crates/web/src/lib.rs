#![doc = include_str!("../README.md")]

mod exports;
mod session;

pub use session::Session;
