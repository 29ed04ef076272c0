//! The ground and the rules of fire as recordings store them: see [`super::setting`].

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::check::{MAX_WEATHER, limit};
use super::columns::{DifferenceColumns, read_surface, write_surface};
use super::setting::{cells, steps};
use super::{FileError, append, take};
use crate::{Setting, SpreadSetting};
use wildfire_base::geometry::{Cell, DVec2, FieldFrame};
use wildfire_base::time::SimTime;
use wildfire_fire::embers::{EmberSettings, Embers};
use wildfire_fire::fuel::{CustomFuels, FuelModel};
use wildfire_fire::models::{AlexandridisRules, Density, Neighbours, RothermelRules, Vegetation};
use wildfire_fire::surface::crown::{CrownMethod, CrownRules};
use wildfire_fire::surface::{Combine, Curing, FuelMoisture, LengthToWidth, SurfaceOptions, WindLimit};
use wildfire_fire::{CanopyLayers, Landscape, MoistureZones, Relief, Weather, WeatherInterval, WindField};

const NO_LANDSCAPE: FileError = FileError::Damaged("its landscape does not fit its field");
const NO_WORD: FileError = FileError::Damaged("a choice of its fire is unknown");

/// The part of a setting about fire on the ground.
#[derive(Default, Serialize, Deserialize)]
pub struct GroundSetting {
    /// Index of each blocked cell without a bush, less that of the one before it.
    blocked_steps: Vec<u32>,
    spread: Option<SpreadRecord>,
    /// What `spread` stands for where that is [`SpreadRecord::Local`] or [`SpreadRecord::Zoned`]: it follows, so that reading
    /// needs no recursion.
    #[serde(skip)]
    base: Option<SpreadRecord>,
}

#[derive(Serialize, Deserialize)]
enum SpreadRecord {
    Rothermel {
        landscape: LandscapeRecord,
        weather: Vec<IntervalRecord>,
        rules: RothermelRecord,
    },
    Alexandridis {
        landscape: LandscapeRecord,
        weather: Vec<IntervalRecord>,
        rules: AlexandridisRecord,
    },
    RothermelWithTrees(Box<(LandscapeRecord, Vec<IntervalRecord>, RothermelRecord, TreeRecord)>),
    /// What only some landscapes and weathers have; one of the others follows.
    Local(LocalRecord),
    /// The same, with moistures or factors by place.
    Zoned(Box<(LocalRecord, ZoneRecord)>),
}

/// What only some landscapes and weathers have.
#[derive(Serialize, Deserialize)]
struct LocalRecord {
    custom_fuels: Vec<FuelRecord>,
    /// By interval of the weather, east and north in hundredths of m/s; empty where wind is everywhere the same.
    winds: Vec<Option<[SurfaceRecord; 2]>>,
}

/// What differs from cell to cell besides the fuel.
#[derive(Serialize, Deserialize)]
struct ZoneRecord {
    /// By zone, in the order of intervals; none where moisture is that of the intervals.
    moistures: Vec<[f64; 5]>,
    /// The zone of each cell, if there are some.
    zones: Option<SurfaceRecord>,
    /// Thousandths of the factor on the rate of spread, if there is one.
    factors: Option<SurfaceRecord>,
}

#[derive(Serialize, Deserialize)]
struct FuelRecord {
    number: u8,
    code: String,
    name: String,
    /// Five loads and five ratios, the depth, the moisture of extinction, the heat of dead and of live fuel, as the equations
    /// take them.
    numbers: [f64; 14],
    cures: bool,
}

#[derive(Serialize, Deserialize)]
struct TreeRecord {
    /// Place in the list of methods below.
    method: u8,
    foliar_moisture: f64,
    /// Heights of trees and of the beginning of crowns, their density and cover, in LANDFIRE's units.
    layers: [SurfaceRecord; 4],
}

#[derive(Serialize, Deserialize)]
struct LandscapeRecord {
    /// Fuel models and how many cells in turn have them, by cell index.
    fuels: Vec<u8>,
    runs: Vec<u8>,
    relief: ReliefRecord,
}

#[derive(Serialize, Deserialize)]
enum ReliefRecord {
    /// East and north.
    Plane([f64; 2]),
    Elevation(SurfaceRecord),
    Gradient {
        east: SurfaceRecord,
        north: SurfaceRecord,
    },
}

/// A number for each cell.
#[derive(Serialize, Deserialize)]
struct SurfaceRecord {
    lengths: Vec<u8>,
    bits: Vec<u8>,
}

#[derive(Serialize, Deserialize)]
struct IntervalRecord {
    from_ns: u64,
    /// East and north.
    wind_mps: [f64; 2],
    /// Of dead fuel of 1, 10 and 100 hours, of herbs, of wood.
    moistures: [f64; 5],
}

#[derive(Serialize, Deserialize)]
struct RothermelRecord {
    /// Places in the lists below: curing, sum of wind and slope, wind limit, length to width.
    choices: [u8; 4],
    neighbours: u8,
    wet_ns: u64,
    burn_out_ns: Option<u64>,
    embers: Option<EmberRecord>,
}

#[derive(Serialize, Deserialize)]
struct EmberRecord {
    seed: u64,
    /// In the order of the settings' table.
    settings: [f64; 9],
}

#[derive(Serialize, Deserialize)]
struct AlexandridisRecord {
    /// p0, c1 and c2 of the wind, a of the slope.
    numbers: [f64; 4],
    /// Places in the lists below: vegetation, density.
    choices: [u8; 2],
    step_ns: u64,
}

// Words are written as their places in these lists, which only grow at the end.
const CURINGS: [Curing; 2] = [Curing::Exact, Curing::Behave];
const COMBINES: [Combine; 2] = [Combine::Plane, Combine::Flat];
const WIND_LIMITS: [WindLimit; 3] = [WindLimit::None, WindLimit::Rothermel1972, WindLimit::Andrews2013];
const LENGTHS_TO_WIDTHS: [LengthToWidth; 2] = [LengthToWidth::Anderson1983, LengthToWidth::Linear];

const CROWN_METHODS: [CrownMethod; 2] = [CrownMethod::ScottReinhardt, CrownMethod::Rothermel];

const VEGETATIONS: [Vegetation; 3] = [Vegetation::Agricultural, Vegetation::Thickets, Vegetation::Pine];
const DENSITIES: [Density; 3] = [Density::Sparse, Density::Normal, Density::Dense];

fn place_of<T: PartialEq>(values: &[T], word: T) -> u8 {
    values.iter().position(|other| *other == word).expect("all words are listed") as u8
}

fn word_at<T: Copy>(values: &[T], place: u8) -> Result<T, FileError> {
    values.get(usize::from(place)).copied().ok_or(NO_WORD)
}

impl From<&Setting> for GroundSetting {
    fn from(setting: &Setting) -> Self {
        let blocked_steps = steps(setting.frame, &setting.blocked);
        let spread = setting.spread.as_ref().map(SpreadRecord::from);
        let local = setting.spread.as_ref().map(LocalRecord::new);
        let record = match local.zip(setting.spread.as_ref().map(ZoneRecord::new)) {
            Some((local, Some(zones))) => SpreadRecord::Zoned(Box::new((local, zones))),
            Some((local, None)) if !local.is_empty() => SpreadRecord::Local(local),
            _ => return Self { blocked_steps, spread, base: None },
        };
        Self { blocked_steps, spread: Some(record), base: spread }
    }
}

impl From<&SpreadSetting> for SpreadRecord {
    fn from(spread: &SpreadSetting) -> Self {
        match spread {
            SpreadSetting::Rothermel { landscape, weather, rules } => {
                let trees = landscape.canopy.as_ref().zip(rules.crowns);
                let trees = trees.map(|(trees, rules)| TreeRecord::new(trees, rules, landscape.frame));
                let landscape = LandscapeRecord::from(&**landscape);
                let rules = RothermelRecord::from(rules);
                let weather = weather.intervals().iter().map(IntervalRecord::from).collect();
                match trees {
                    Some(trees) => Self::RothermelWithTrees(Box::new((landscape, weather, rules, trees))),
                    None => Self::Rothermel { landscape, weather, rules },
                }
            }
            SpreadSetting::Alexandridis { landscape, weather, rules } => Self::Alexandridis {
                landscape: LandscapeRecord::from(&**landscape),
                weather: weather.intervals().iter().map(IntervalRecord::from).collect(),
                rules: AlexandridisRecord::from(rules),
            },
        }
    }
}

impl GroundSetting {
    /// Returns the cells that are blocked without a bush.
    pub fn blocked(&self, frame: FieldFrame) -> Result<Vec<Cell>, FileError> {
        cells(frame, &self.blocked_steps)
    }

    /// Returns the rules of fire on this field's ground; values have not been checked yet.
    pub fn spread(&self, frame: FieldFrame) -> Result<Option<SpreadSetting>, FileError> {
        match (&self.spread, &self.base) {
            (Some(SpreadRecord::Local(local)), Some(base)) => local.onto(base.spread(frame)?).map(Some),
            (Some(SpreadRecord::Zoned(record)), Some(base)) => {
                let (local, zones) = &**record;
                zones.onto(local.onto(base.spread(frame)?)?).map(Some)
            }
            (record, _) => record.as_ref().map(|record| record.spread(frame)).transpose(),
        }
    }

    /// Adds it to the bytes of a payload.
    pub fn append_to(&self, bytes: &mut Vec<u8>) {
        append(bytes, self);
        self.base.iter().for_each(|base| append(bytes, base));
    }

    /// Reads it from the front of some bytes.
    pub fn take_from(bytes: &mut &[u8]) -> Result<Self, FileError> {
        let mut setting: Self = take(bytes)?;
        if matches!(setting.spread, Some(SpreadRecord::Local(_) | SpreadRecord::Zoned(_))) {
            setting.base = Some(take(bytes)?);
        }
        Ok(setting)
    }
}

impl SpreadRecord {
    fn spread(&self, frame: FieldFrame) -> Result<SpreadSetting, FileError> {
        match self {
            Self::Rothermel { landscape, weather, rules } => Ok(SpreadSetting::Rothermel {
                landscape: Arc::new(landscape.landscape(frame)?),
                weather: Arc::new(weather_of(weather)?),
                rules: rules.rules()?,
            }),
            Self::RothermelWithTrees(wood) => {
                let (landscape, weather, rules, trees) = &**wood;
                let canopy = Some(trees.layers(frame)?);
                Ok(SpreadSetting::Rothermel {
                    landscape: Arc::new(Landscape { canopy, ..landscape.landscape(frame)? }),
                    weather: Arc::new(weather_of(weather)?),
                    rules: RothermelRules { crowns: Some(trees.rules()?), ..rules.rules()? },
                })
            }
            Self::Alexandridis { landscape, weather, rules } => Ok(SpreadSetting::Alexandridis {
                landscape: Arc::new(landscape.landscape(frame)?),
                weather: Arc::new(weather_of(weather)?),
                rules: rules.rules()?,
            }),
            Self::Local(_) | Self::Zoned(_) => Err(NO_LANDSCAPE),
        }
    }
}

impl LocalRecord {
    fn new(spread: &SpreadSetting) -> Self {
        let custom_fuels: Vec<_> = spread.landscape().custom_fuels.models().iter().map(FuelRecord::from).collect();
        let cols = usize::from(spread.landscape().frame.cols);
        let fields = spread.weather().wind_fields().iter();
        let winds = fields
            .map(|field| {
                let WindField { east, north } = field.as_deref()?;
                Some([east, north].map(|parts| SurfaceRecord::new(cols, parts.iter().map(|&part| f32::from(part)))))
            })
            .collect();
        Self { custom_fuels, winds }
    }

    /// Says whether a landscape and its weather have nothing of the kind.
    fn is_empty(&self) -> bool {
        self.custom_fuels.is_empty() && self.winds.is_empty()
    }

    /// Adds it to the rest of a setting.
    fn onto(&self, mut spread: SpreadSetting) -> Result<SpreadSetting, FileError> {
        let models = self.custom_fuels.iter().map(FuelModel::from).collect();
        let custom_fuels = CustomFuels::new(models).map_err(FileError::Impossible)?;
        let (SpreadSetting::Rothermel { landscape, weather, .. }
        | SpreadSetting::Alexandridis { landscape, weather, .. }) = &mut spread;
        let frame = landscape.frame;
        *landscape = Arc::new(Landscape { custom_fuels, ..Landscape::clone(landscape) });
        // An empty list stands for wind that is the same everywhere, at all times.
        if !self.winds.is_empty() {
            if self.winds.len() != weather.intervals().len() {
                return Err(FileError::Damaged("its winds by place are not those of its weather"));
            }
            let mut fields = Vec::with_capacity(self.winds.len());
            for wind in &self.winds {
                let field = match wind {
                    Some([east, north]) => {
                        Some(Arc::new(WindField { east: east.integers(frame)?, north: north.integers(frame)? }))
                    }
                    None => None,
                };
                fields.push(field);
            }
            *weather = Arc::new(Weather::clone(weather).with_wind_fields(fields));
        }
        Ok(spread)
    }
}

impl ZoneRecord {
    /// `None` if a landscape and its weather have nothing of the kind.
    fn new(spread: &SpreadSetting) -> Option<Self> {
        let landscape = spread.landscape();
        let moisture = spread.weather().moisture_zones();
        let factors = (!landscape.rate_factors.is_empty())
            .then(|| SurfaceRecord::of_whole(landscape.frame, &landscape.rate_factors));
        let zones = moisture.map(|moisture| SurfaceRecord::of_whole(landscape.frame, &moisture.of_cell));
        let moistures = moisture.iter().flat_map(|moisture| &moisture.moistures);
        let moistures = moistures.map(|&FuelMoisture { d1, d10, d100, herb, woody }| [d1, d10, d100, herb, woody]);
        (factors.is_some() || zones.is_some()).then(|| Self { moistures: moistures.collect(), zones, factors })
    }

    /// Adds it to the rest of a setting; values have not been checked yet.
    fn onto(&self, mut spread: SpreadSetting) -> Result<SpreadSetting, FileError> {
        let (SpreadSetting::Rothermel { landscape, weather, .. }
        | SpreadSetting::Alexandridis { landscape, weather, .. }) = &mut spread;
        let frame = landscape.frame;
        if let Some(factors) = &self.factors {
            let rate_factors = factors.whole(frame)?;
            *landscape = Arc::new(Landscape { rate_factors, ..Landscape::clone(landscape) });
        }
        if let Some(zones) = &self.zones {
            let of_cell = zones.whole(frame)?;
            let moistures = self.moistures.iter();
            let moistures =
                moistures.map(|&[d1, d10, d100, herb, woody]| FuelMoisture { d1, d10, d100, herb, woody }).collect();
            let zones = MoistureZones { of_cell, moistures };
            *weather = Arc::new(Weather::clone(weather).with_moisture_zones(zones));
        }
        Ok(spread)
    }
}

impl From<&FuelModel> for FuelRecord {
    fn from(model: &FuelModel) -> Self {
        let [a, b, c, d, e] = model.loads;
        let [f, g, h, i, j] = model.savs;
        let FuelModel { number, depth_ft, dead_extinction, heat_btu_lb, live_heat_btu_lb, cures, .. } = *model;
        let numbers = [a, b, c, d, e, f, g, h, i, j, depth_ft, dead_extinction, heat_btu_lb, live_heat_btu_lb];
        Self { number, code: model.code.to_string(), name: model.name.to_string(), numbers, cures }
    }
}

impl From<&FuelRecord> for FuelModel {
    fn from(record: &FuelRecord) -> Self {
        let [a, b, c, d, e, f, g, h, i, j, depth_ft, dead_extinction, heat_btu_lb, live_heat_btu_lb] = record.numbers;
        Self {
            number: record.number,
            code: record.code.clone().into(),
            name: record.name.clone().into(),
            loads: [a, b, c, d, e],
            savs: [f, g, h, i, j],
            depth_ft,
            dead_extinction,
            heat_btu_lb,
            live_heat_btu_lb,
            cures: record.cures,
        }
    }
}

impl From<&Landscape> for LandscapeRecord {
    fn from(landscape: &Landscape) -> Self {
        let (mut fuels, mut runs) = (Vec::new(), Vec::new());
        for run in landscape.fuel.chunk_by(|one, other| one == other) {
            fuels.push(run[0]);
            append(&mut runs, &(run.len() as u32));
        }
        let cols = usize::from(landscape.frame.cols);
        let relief = match &landscape.relief {
            Relief::Plane(gradient) => ReliefRecord::Plane(gradient.to_array()),
            Relief::Elevation(heights) => ReliefRecord::Elevation(SurfaceRecord::new(cols, heights.iter().copied())),
            Relief::Gradient(gradients) => {
                let [east, north] = [0, 1].map(|axis| gradients.iter().map(move |gradient| gradient[axis]));
                ReliefRecord::Gradient { east: SurfaceRecord::new(cols, east), north: SurfaceRecord::new(cols, north) }
            }
        };
        Self { fuels, runs, relief }
    }
}

impl LandscapeRecord {
    fn landscape(&self, frame: FieldFrame) -> Result<Landscape, FileError> {
        let mut runs = &self.runs[..];
        let mut fuel = Vec::with_capacity(frame.cell_count());
        for &number in &self.fuels {
            let length = take::<u32>(&mut runs)? as usize;
            // A length beyond the field is refused before there is memory for it.
            if length > frame.cell_count() - fuel.len() {
                return Err(NO_LANDSCAPE);
            }
            fuel.resize(fuel.len() + length, number);
        }
        if fuel.len() != frame.cell_count() || !runs.is_empty() {
            return Err(NO_LANDSCAPE);
        }
        let relief = match &self.relief {
            &ReliefRecord::Plane([east, north]) => Relief::Plane(DVec2::new(east, north)),
            ReliefRecord::Elevation(heights) => Relief::Elevation(heights.numbers(frame)?),
            ReliefRecord::Gradient { east, north } => {
                let east = east.numbers(frame)?;
                let north = north.numbers(frame)?;
                Relief::Gradient(east.into_iter().zip(north).map(|(east, north)| [east, north]).collect())
            }
        };
        Ok(Landscape { fuel, relief, ..Landscape::uniform(frame, 0) })
    }
}

impl TreeRecord {
    fn new(trees: &CanopyLayers, rules: CrownRules, frame: FieldFrame) -> Self {
        let cols = usize::from(frame.cols);
        let CrownRules { method, foliar_moisture } = rules;
        Self {
            method: place_of(&CROWN_METHODS, method),
            foliar_moisture,
            layers: trees
                .0
                .each_ref()
                .map(|layer| SurfaceRecord::new(cols, layer.iter().map(|&number| f32::from(number)))),
        }
    }

    fn layers(&self, frame: FieldFrame) -> Result<CanopyLayers, FileError> {
        let mut layers = [const { Vec::new() }; 4];
        for (layer, record) in layers.iter_mut().zip(&self.layers) {
            *layer = record.numbers(frame)?.into_iter().map(|number| number as u16).collect();
        }
        Ok(CanopyLayers(layers))
    }

    fn rules(&self) -> Result<CrownRules, FileError> {
        Ok(CrownRules { method: word_at(&CROWN_METHODS, self.method)?, foliar_moisture: self.foliar_moisture })
    }
}

impl SurfaceRecord {
    fn new(cols: usize, numbers: impl ExactSizeIterator<Item = f32>) -> Self {
        let DifferenceColumns { lengths, bits } = write_surface(cols, numbers);
        Self { lengths, bits }
    }

    fn numbers(&self, frame: FieldFrame) -> Result<Vec<f32>, FileError> {
        read_surface(frame.cols.into(), frame.cell_count(), &self.lengths, &self.bits)
    }
}

impl SurfaceRecord {
    fn of_whole(frame: FieldFrame, numbers: &[u16]) -> Self {
        Self::new(frame.cols.into(), numbers.iter().map(|&number| f32::from(number)))
    }

    fn whole(&self, frame: FieldFrame) -> Result<Vec<u16>, FileError> {
        Ok(self.numbers(frame)?.into_iter().map(|number| number as u16).collect())
    }

    fn integers(&self, frame: FieldFrame) -> Result<Vec<i16>, FileError> {
        Ok(self.numbers(frame)?.into_iter().map(|number| number as i16).collect())
    }
}

impl From<&WeatherInterval> for IntervalRecord {
    fn from(&WeatherInterval { from, wind_mps, moisture }: &WeatherInterval) -> Self {
        let FuelMoisture { d1, d10, d100, herb, woody } = moisture;
        Self { from_ns: from.as_nanos(), wind_mps: wind_mps.to_array(), moistures: [d1, d10, d100, herb, woody] }
    }
}

fn weather_of(records: &[IntervalRecord]) -> Result<Weather, FileError> {
    limit("intervals of weather", records.len(), MAX_WEATHER)?;
    let intervals = records
        .iter()
        .map(|record: &IntervalRecord| {
            let [d1, d10, d100, herb, woody] = record.moistures;
            WeatherInterval {
                from: SimTime::from_nanos(record.from_ns),
                wind_mps: DVec2::from_array(record.wind_mps),
                moisture: FuelMoisture { d1, d10, d100, herb, woody },
            }
        })
        .collect();
    Weather::new(intervals).map_err(|error| FileError::Impossible(error.to_string()))
}

impl From<&RothermelRules> for RothermelRecord {
    fn from(&RothermelRules { options, neighbours, refined, wet, burn_out, embers, .. }: &RothermelRules) -> Self {
        let SurfaceOptions { curing, combine, wind_limit, length_to_width } = options;
        Self {
            choices: [
                place_of(&CURINGS, curing),
                place_of(&COMBINES, combine),
                place_of(&WIND_LIMITS, wind_limit),
                place_of(&LENGTHS_TO_WIDTHS, length_to_width),
            ],
            // Odd where directions are refined, which no file of before has.
            neighbours: u8::from(neighbours) + u8::from(refined),
            wet_ns: wet.as_nanos(),
            burn_out_ns: burn_out.map(SimTime::as_nanos),
            embers: embers.map(EmberRecord::from),
        }
    }
}

impl From<&AlexandridisRules> for AlexandridisRecord {
    fn from(rules: &AlexandridisRules) -> Self {
        let AlexandridisRules { p0, wind_c1, wind_c2, slope_a, vegetation, density, step } = *rules;
        Self {
            numbers: [p0, wind_c1, wind_c2, slope_a],
            choices: [place_of(&VEGETATIONS, vegetation), place_of(&DENSITIES, density)],
            step_ns: step.as_nanos(),
        }
    }
}

impl AlexandridisRecord {
    fn rules(&self) -> Result<AlexandridisRules, FileError> {
        let [p0, wind_c1, wind_c2, slope_a] = self.numbers;
        let [vegetation, density] = self.choices;
        let vegetation = word_at(&VEGETATIONS, vegetation)?;
        let density = word_at(&DENSITIES, density)?;
        let step = SimTime::from_nanos(self.step_ns);
        Ok(AlexandridisRules { p0, wind_c1, wind_c2, slope_a, vegetation, density, step })
    }
}

impl From<Embers> for EmberRecord {
    fn from(Embers { settings, seed }: Embers) -> Self {
        let EmberSettings { per_mj, i_min_kw_m, d0, a, b, k, cross_sd_m, p_ign, delay_s } = settings;
        Self { seed, settings: [per_mj, i_min_kw_m, d0, a, b, k, cross_sd_m, p_ign, delay_s] }
    }
}

impl EmberRecord {
    fn embers(&self) -> Embers {
        let [per_mj, i_min_kw_m, d0, a, b, k, cross_sd_m, p_ign, delay_s] = self.settings;
        let settings = EmberSettings { per_mj, i_min_kw_m, d0, a, b, k, cross_sd_m, p_ign, delay_s };
        Embers { settings, seed: self.seed }
    }
}

impl RothermelRecord {
    fn rules(&self) -> Result<RothermelRules, FileError> {
        let [curing, combine, wind_limit, length_to_width] = self.choices;
        let options = SurfaceOptions {
            curing: word_at(&CURINGS, curing)?,
            combine: word_at(&COMBINES, combine)?,
            wind_limit: word_at(&WIND_LIMITS, wind_limit)?,
            length_to_width: word_at(&LENGTHS_TO_WIDTHS, length_to_width)?,
        };
        // Numbers of neighbours are even, so that the lowest bit is free for the refinement.
        let refined = self.neighbours % 2 == 1;
        let neighbours = Neighbours::try_from(self.neighbours & !1).map_err(|_| NO_WORD)?;
        let wet = SimTime::from_nanos(self.wet_ns);
        let burn_out = self.burn_out_ns.map(SimTime::from_nanos);
        let embers = self.embers.as_ref().map(EmberRecord::embers);
        Ok(RothermelRules { options, neighbours, refined, wet, burn_out, embers, crowns: None })
    }
}
