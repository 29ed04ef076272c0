//! From a file to a checked scenario: TOML, changes of the command line, what other files give, contradictions.

pub mod built_in;
pub mod change;
pub mod contradictions;
pub mod copies;
pub mod difference;
pub mod fuel_image;
pub mod load;
pub mod problem;
pub mod source;
pub mod starts;
pub mod weather_stream;
