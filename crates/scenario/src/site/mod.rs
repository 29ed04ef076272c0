//! The field of a run: its map, terrain, ground and weather, and where trucks stand.

pub mod features;
pub mod fuel_file;
pub mod fuel_name;
pub mod geojson;
pub mod imported;
pub mod landscape;
pub mod layers;
pub mod moisture;
pub mod terrain;
pub mod tetromino;
pub mod truck_starts;
pub mod weather;
pub mod weather_csv;
pub mod wind;
pub mod wind_raster;
