//! A fire's extent after some time: an object and a document.

use std::time::Duration;

use serde::Serialize;

use super::ground::GroundOnEarth;
use super::{SpreadArguments, WindStep};
use wildfire_base::document::number::{count, percent, rounded, short};
use wildfire_base::document::{Document, Table};
use wildfire_base::geometry::{Cell, compass};
use wildfire_base::object::Members;
use wildfire_base::time::SimTime;
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_fire::fuel::written_number;
use wildfire_fire::lone::LoneFire;
use wildfire_fire::surface::crown::FireType;
use wildfire_fire::surface::{FuelBed, FuelMoisture, SurfaceOptions};
use wildfire_fire::{Landscape, Weather, WeatherInterval};

/// What is said of a fire.
#[derive(Debug, Serialize)]
pub struct SpreadReport {
    program_version: &'static str,
    rows: u16,
    cols: u16,
    cell_m: f64,
    /// Bands of files with several, and what they were taken for.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    bands: Vec<String>,
    /// What of the rasters may have been misread or was left out.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    doubts: Vec<String>,
    /// Codes of the fuels and the cells that have them, the most frequent first.
    fuels: Vec<FuelRow>,
    /// Codes of fuels that are too wet to burn.
    too_wet: Vec<String>,
    moisture: FuelMoisture,
    /// Moisture by place, in a sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    moisture_by_place: Option<String>,
    winds: Vec<WindRow>,
    #[serde(flatten)]
    options: SurfaceOptions,
    neighbours: u8,
    duration_s: f64,
    ignitions: Vec<IgnitionRow>,
    burned_cells: usize,
    burned_ha: f64,
    /// Cells that can burn by their fuel.
    burnable_cells: usize,
    /// True if nothing is about to catch fire any more.
    has_ended: bool,
    /// When the first cell at the border of the field caught fire.
    reached_edge_s: Option<f64>,
    /// When the last cell did.
    last_arrival_s: Option<f64>,
    /// The cell that is farthest from the nearest ignition.
    farthest: Option<Farthest>,
    /// Burned cells by the kind of fire, where there are trees.
    #[serde(skip_serializing_if = "Option::is_none")]
    fire_types: Option<Members<&'static str, usize>>,
    /// Along the sides of cells, inner borders included.
    perimeter_m: f64,
    cpu_s: f64,
    cpu_us_per_burned_cell: Option<f64>,
}

#[derive(Debug, Serialize)]
struct FuelRow {
    number: u16,
    code: String,
    cells: usize,
}

#[derive(Debug, Serialize)]
struct WindRow {
    from_s: f64,
    speed_mps: f64,
    from_deg: f64,
    /// Of wind by place the least and the greatest speed; the others are of its mean.
    #[serde(skip_serializing_if = "Option::is_none")]
    speeds_mps: Option<[f64; 2]>,
}

#[derive(Debug, Serialize)]
struct IgnitionRow {
    row: u16,
    col: u16,
    at_s: f64,
}

/// How far a fire came.
#[derive(Debug, Serialize)]
struct Farthest {
    row: u16,
    col: u16,
    distance_m: f64,
    toward_deg: f64,
    arrival_s: f64,
    /// The distance by the time since the ignition.
    mean_rate_m_min: f64,
}

impl SpreadReport {
    pub fn new(
        arguments: &SpreadArguments,
        ground: &GroundOnEarth,
        fire: &mut LoneFire,
        ignitions: &[(SimTime, Cell)],
        cpu: Duration,
        fire_types: &[f64],
        perimeter_m: f64,
    ) -> Self {
        // This is asked before the fire is borrowed for reading, as looking for the next arrival changes its queue.
        let has_ended = fire.next_arrival().is_none();
        let fire = &*fire;
        let landscape = &*ground.landscape;
        let frame = landscape.frame;
        let cells = (0..frame.cell_count()).map(|index| frame.cell(index));
        let burned = || cells.clone().filter_map(|cell| Some((cell, fire.arrival(cell)?)));
        let burned_cells = burned().count();
        let is_border =
            |cell: Cell| cell.col == 0 || cell.row == 0 || cell.col + 1 == frame.cols || cell.row + 1 == frame.rows;
        let reached_edge = burned().filter(|&(cell, _)| is_border(cell)).map(|(_, time)| time).min();
        let options = arguments.choices.options();
        let fuels = shares(landscape);
        let models = landscape.burning_models();
        let too_wet = models.iter().filter(|model| {
            let of_fuel = (0..landscape.fuel.len()).filter(|&index| landscape.fuel[index] == model.number);
            let mut moistures = ground.weather.moistures_of(of_fuel);
            // Without zones all cells have the moisture of the weather.
            if moistures.is_empty() {
                moistures.push(ground.weather.intervals()[0].moisture);
            }
            moistures.iter().all(|moisture| !FuelBed::new(model, moisture, options.curing).burns())
        });
        Self {
            program_version: PROGRAM_VERSION,
            rows: frame.rows,
            cols: frame.cols,
            cell_m: frame.cell_m,
            bands: ground.bands.clone(),
            doubts: ground.doubts.clone(),
            too_wet: too_wet.map(|model| model.code.to_string()).collect(),
            fuels,
            moisture: arguments.moisture,
            moisture_by_place: ground.moisture.clone(),
            winds: winds(arguments, &ground.weather),
            options,
            neighbours: arguments.neighbours.into(),
            duration_s: arguments.duration,
            ignitions: (ignitions.iter())
                .map(|&(time, cell)| IgnitionRow { row: cell.row, col: cell.col, at_s: time.as_seconds() })
                .collect(),
            burned_cells,
            // A cell that has burned is no longer among those that can burn.
            burnable_cells: fire.fires().flammable().len() + burned_cells,
            has_ended,
            burned_ha: burned_cells as f64 * frame.cell_m * frame.cell_m / 10_000.0,
            reached_edge_s: reached_edge.map(SimTime::as_seconds),
            last_arrival_s: burned().map(|(_, time)| time).max().map(SimTime::as_seconds),
            farthest: farthest(fire, burned(), ignitions),
            fire_types: (!fire_types.is_empty()).then(|| FireType::tally(fire_types)),
            perimeter_m,
            cpu_s: cpu.as_secs_f64(),
            cpu_us_per_burned_cell: (burned_cells > 0).then(|| cpu.as_secs_f64() * 1e6 / burned_cells as f64),
        }
    }

    /// The title of the report and of the picture.
    pub fn title(&self) -> String {
        let fuel = match &self.fuels[..] {
            [only] => only.code.clone(),
            fuels => count(fuels.len(), "fuel"),
        };
        format!("Fire in {fuel}, {}", minutes(self.duration_s))
    }

    /// Says whether the fire has ended in a small part of what could burn.
    fn is_enclosed(&self) -> bool {
        const SMALL: f64 = 0.01;
        self.has_ended && self.burned_cells > 0 && (self.burned_cells as f64) < SMALL * self.burnable_cells as f64
    }

    fn conditions(&self) -> Vec<String> {
        let FuelMoisture { d1, d10, d100, herb, woody } = self.moisture;
        let [d1, d10, d100, herb, woody] = [d1, d10, d100, herb, woody].map(percent);
        let field = format!("{} rows and {} columns of {} m", self.rows, self.cols, short(self.cell_m));
        let fuels = self.fuels.iter().take(6).map(|share| format!("{} {}", share.code, share.cells));
        let fuels = fuels.collect::<Vec<_>>().join(", ");
        let more = if self.fuels.len() > 6 { format!(" and {} more", self.fuels.len() - 6) } else { String::new() };
        let mut lines = vec![
            field,
            format!("Cells by fuel: {fuels}{more}"),
            format!("Moisture of dead fuel {d1}, {d10} and {d100} %, of live grass {herb} %, of live wood {woody} %"),
        ];
        lines.extend(self.moisture_by_place.iter().map(|moisture| moisture.trim_end_matches('.').to_owned()));
        if !self.bands.is_empty() {
            lines.insert(1, format!("Layers: {}", self.bands.join("; ")));
        }
        if !self.too_wet.is_empty() {
            lines.push(format!("Fuel too wet to burn: {}", self.too_wet.join(", ")));
        }
        let winds = self.winds.iter().take(5).map(|wind| {
            let blows = match wind.speed_mps {
                0.0 => "none".to_owned(),
                speed => format!("{} m/s from {}", short(speed), short(wind.from_deg)),
            };
            let blows = match wind.speeds_mps {
                Some([min, max]) => {
                    format!("by place {} to {} m/s, on average {blows}", rounded(min, 1), rounded(max, 1))
                }
                None => blows,
            };
            if wind.from_s > 0.0 { format!("{blows} after {}", minutes(wind.from_s)) } else { blows }
        });
        let winds = winds.collect::<Vec<_>>().join(", ");
        let more =
            if self.winds.len() > 5 { format!(" and {} more changes", self.winds.len() - 5) } else { String::new() };
        lines.push(format!("Wind at 10 m: {winds}{more}"));
        lines
    }
}

/// Lists the winds that were given, or those of rasters.
fn winds(arguments: &SpreadArguments, weather: &Weather) -> Vec<WindRow> {
    if weather.wind_fields().is_empty() {
        let winds = arguments.winds().into_iter().map(|WindStep { from, speed_mps, from_deg }| WindRow {
            from_s: from.as_seconds(),
            speed_mps,
            from_deg,
            speeds_mps: None,
        });
        return winds.collect();
    }
    let winds = weather.intervals().iter().enumerate().map(|(number, interval): (usize, &WeatherInterval)| WindRow {
        from_s: interval.from.as_seconds(),
        speed_mps: (100.0 * interval.wind_mps.length()).round() / 100.0,
        from_deg: compass::azimuth_deg(-interval.wind_mps).round(),
        speeds_mps: weather.wind_field(number).map(|field| field.speeds().map(|mps| (100.0 * mps).round() / 100.0)),
    });
    winds.collect()
}

/// Counts the cells of each fuel.
fn shares(landscape: &Landscape) -> Vec<FuelRow> {
    let mut cells = [0; 256];
    for &number in &landscape.fuel {
        cells[usize::from(number)] += 1;
    }
    let there = (0..=u8::MAX).filter(|&number| cells[usize::from(number)] > 0);
    let mut shares: Vec<FuelRow> = there
        .map(|number| {
            let code = landscape.fuel_model(number).map_or("none".to_owned(), |model| model.code.to_string());
            FuelRow { number: written_number(number), code, cells: cells[usize::from(number)] }
        })
        .collect();
    shares.sort_by_key(|share| (std::cmp::Reverse(share.cells), share.number));
    shares
}

fn farthest(
    fire: &LoneFire,
    burned: impl Iterator<Item = (Cell, SimTime)>,
    ignitions: &[(SimTime, Cell)],
) -> Option<Farthest> {
    let frame = fire.fires().frame();
    let reached = burned.filter_map(|(cell, time)| {
        let ignited = ignitions
            // An ignition that came after the fire cannot have brought it there.
            .iter()
            .filter(|&&(ignited_at, _)| ignited_at <= time)
            .map(|&(ignited_at, start)| (frame.centre(cell) - frame.centre(start), ignited_at));
        let (way, ignited_at) = ignited.min_by(|(a, _), (b, _)| a.length_squared().total_cmp(&b.length_squared()))?;
        Some((cell, time, way, ignited_at))
    });
    let (cell, time, way, ignited_at) =
        reached.max_by(|(_, _, a, _), (_, _, b, _)| a.length_squared().total_cmp(&b.length_squared()))?;
    // A fire that never left its ignition has no direction.
    (way.length_squared() > 0.0).then(|| Farthest {
        row: cell.row,
        col: cell.col,
        distance_m: way.length(),
        toward_deg: compass::azimuth_deg(way),
        arrival_s: time.as_seconds(),
        mean_rate_m_min: 60.0 * way.length() / time.since(ignited_at).as_seconds(),
    })
}

/// Seconds as people say them.
fn minutes(seconds: f64) -> String {
    if seconds < 120.0 { format!("{} s", short(seconds)) } else { format!("{} min", rounded(seconds / 60.0, 1)) }
}

impl From<&SpreadReport> for Document {
    fn from(report: &SpreadReport) -> Self {
        let mut document = Self::new(report.title());
        document.add_list(report.conditions());
        let mut rows = vec![fire_row("Burned cells", report.burned_cells.to_string())];
        let fire_types = report.fire_types.iter().flat_map(|fire_types| &fire_types.0);
        rows.extend(fire_types.map(|(name, cells)| fire_row(&format!("  by {name} fire"), cells.to_string())));
        rows.push(fire_row("Burned ha", rounded(report.burned_ha, 2)));
        rows.push(fire_row("Perimeter m", rounded(report.perimeter_m, 0)));
        if let Some(farthest) = &report.farthest {
            rows.push(fire_row("Farthest from an ignition m", rounded(farthest.distance_m, 0)));
            rows.push(fire_row("  to azimuth", rounded(farthest.toward_deg, 0)));
            rows.push(fire_row("  after", minutes(farthest.arrival_s)));
            rows.push(fire_row("  on average m/min", rounded(farthest.mean_rate_m_min, 2)));
        }
        let edge = report.reached_edge_s.map_or_else(|| "no".to_owned(), |time| format!("after {}", minutes(time)));
        rows.push(fire_row("Reached the edge", edge));
        document.add(Table::new(&["Fire", "Value"], rows));
        let mut remarks = Vec::new();
        if report.is_enclosed() {
            let burned = count(report.burned_cells, "cell");
            let could = report.burnable_cells;
            remarks.push(format!(
                "The fire ended after {burned} of {could} that can burn, enclosed by bare ground, roads, water or \
                 moist fuel"
            ));
        }
        if report.reached_edge_s.is_some() {
            remarks.push("Fire beyond the edge, and fire that would return from there, is not simulated".to_owned());
        }
        if let Some(cost) = report.cpu_us_per_burned_cell {
            remarks.push(format!("CPU time {} s, {} us per burned cell", rounded(report.cpu_s, 3), rounded(cost, 2)));
        }
        document.add_list(remarks);
        document
    }
}

fn fire_row(name: &str, value: String) -> Vec<String> {
    vec![name.to_owned(), value]
}
