//! Loading: from a name or a path to a scenario that is complete and checked.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::change::SettingChanges;
use super::contradictions::{self, GENERATED_ONLY};
use super::copies::AgentExpansion;
use super::fuel_image::FuelImage;
use super::source::{MAX_MAP_BYTES, ScenarioText, first_too_deep, too_deep_message, unreadable};
use super::starts::Starting;
use super::weather_stream::read_stream;
use crate::faults::check::{TablePath, ValidationError};
use crate::faults::error::{Fault, ScenarioError, SourceLocation};
use crate::faults::path::{FieldPath, FoundSpan, PathStep};
use crate::faults::wording::{self, FaultOfField, KeyOrValue, LOADED};
use crate::keys::program::{Unusable, UnusableFile};
use crate::site::fuel_file::read_fuels;
use crate::site::geojson;
use crate::site::imported::json_fault;
use crate::site::layers::{LayerKind, LayerReader, PackedLayer, Weights};
use crate::site::moisture::{ImportedMoisture, MOISTURE_CLASSES, read_rate_factors};
use crate::site::weather_csv::{read_samples, read_wind};
use crate::site::wind_raster::{WindRasterKind, WindRasters, read_wind_list};
use crate::{Field, IgnitionCells, ImportedField, ImportedLayers, Scenario};
use wildfire_base::geometry::{DVec2, FieldFrame};
use wildfire_base::input_file;
use wildfire_fire::surface::FuelMoisture;
use wildfire_grid::map_files;
use wildfire_grid::map_files::raster::MAX_RASTER_CELLS;
use wildfire_planning::PlannerName;

/// A scenario, with what its author wrote, so that defaults can be distinguished.
#[derive(Clone, Debug)]
pub struct LoadedScenario {
    pub scenario: Scenario,
    written: Value,
    pub(crate) copies: AgentExpansion,
}

impl LoadedScenario {
    /// Reads a built-in scenario or a file, makes the changes (`path=value`, in their order), fills in the defaults,
    /// loads the map if there is one, and checks everything.
    ///
    /// A map's path starts from the scenario's folder; one that a change names starts from the current folder. Where
    /// a change contradicts the file (`field.pieces` against its `coverage`), the change holds.
    ///
    /// # Errors
    /// Returns the first fault found, with its location in the file, in the map, or in the change.
    pub fn open(source: &str, changes: &[String]) -> Result<Self, Box<ScenarioError>> {
        Self::from_text(&ScenarioText::open(source)?, changes)
    }

    /// Does the same with a text that has been read before.
    ///
    /// # Errors
    /// Fails as [`Self::open`] does.
    pub fn from_text(source: &ScenarioText, changes: &[String]) -> Result<Self, Box<ScenarioError>> {
        let mut written = Value::Table(parse(source)?);
        // Changes are made to the text's values and not to the scenario, so that both are read and refused alike.
        let changes = SettingChanges::make(changes, &mut written)?;
        drop_sign_of_zero(&mut written);
        contradictions::drop_overruled(&mut written, &changes);
        let mut text = WrittenScenario { source, changes, copies: AgentExpansion::default() };
        let scenario = text.resolve(&written).map_err(|mut error| {
            for list in ["unimog", "wumpus"] {
                if written.get(list).and_then(Value::as_array).is_some_and(|entries| entries.len() == 1) {
                    error.fault = error.fault.without_number_in(list);
                }
            }
            error
        })?;
        Ok(Self { scenario, written, copies: text.copies })
    }

    /// Lists every value of the scenario with its path, defaults included.
    ///
    /// With a map, what only a generated field has is left out.
    pub fn values(&self) -> Vec<(String, String)> {
        let mut root = Value::try_from(&self.scenario).expect("every part of a scenario can be written as TOML");
        let of_map = if self.scenario.field.imported.is_some() { &GENERATED_ONLY[..] } else { &[] };
        let of_file = if self.scenario.wind_file.is_some() { &["wind"][..] } else { &[] };
        for hidden in [&LOADED, of_map, of_file].concat() {
            FieldPath::parse(hidden).all_in(&root).iter().for_each(|path| path.remove_from(&mut root));
        }
        leaves(root, &FieldPath::default())
    }

    /// Says whether the file or a change gives the value at this path, such as `unimog.0.prm.samples`. The starts of agents
    /// that an entry has by their number are given by it.
    pub fn is_set(&self, dotted: &str) -> bool {
        let path = FieldPath::parse(dotted);
        self.copies.is_drawn(&path) || self.copies.written(&path).leads_to(&self.written)
    }
}

/// Lists the values of a table with their paths, in the order of the paths; a list is one value unless it holds tables.
fn leaves(value: Value, path: &FieldPath) -> Vec<(String, String)> {
    match value {
        Value::Table(table) => {
            table.into_iter().flat_map(|(key, inner)| leaves(inner, &path.join(PathStep::Key(key)))).collect()
        }
        Value::Array(list) if list.iter().any(Value::is_table) => list
            .into_iter()
            .enumerate()
            .flat_map(|(index, inner)| leaves(inner, &path.join(PathStep::Index(index))))
            .collect(),
        plain => vec![(path.to_string(), plain.to_string())],
    }
}

/// Loads the scenario of this name or path, with changes made to it; see [`LoadedScenario::open`].
///
/// # Errors
/// Fails as [`LoadedScenario::open`] does.
pub fn load(source: &str, changes: &[String]) -> Result<Scenario, Box<ScenarioError>> {
    LoadedScenario::open(source, changes).map(|loaded| loaded.scenario)
}

fn parse(source: &ScenarioText) -> Result<Table, Box<ScenarioError>> {
    if let Some(at) = first_too_deep(&source.text) {
        let place = SourceLocation::new(&source.name, &source.text, at..at + 1);
        return Err(Fault::Syntax { message: too_deep_message() }.at(place));
    }
    toml::from_str(&source.text).map_err(|error| {
        let place = SourceLocation::new(&source.name, &source.text, error.span().unwrap_or(0..0));
        Fault::Syntax { message: error.message().to_owned() }.at(place)
    })
}

/// Marks cells of a field by the shapes of a GeoJSON text.
type ShapeReader = fn(&str, &FieldFrame, Option<&ImportedLayers>) -> Result<Result<Vec<u8>, String>, serde_json::Error>;

/// A scenario as it was written: in its file, and in changes of the command line.
struct WrittenScenario<'a> {
    source: &'a ScenarioText,
    changes: SettingChanges,
    /// The entries that agents are written in, once they are known.
    copies: AgentExpansion,
}

impl WrittenScenario<'_> {
    fn resolve(&mut self, written: &Value) -> Result<Scenario, Box<ScenarioError>> {
        self.refuse_loaded_and_infinite(written)?;
        // Counts are expanded before reading, so serde sees as many agents as the run has.
        let mut expanded = written.clone();
        self.copies = AgentExpansion::expand(&mut expanded).map_err(|refusal| self.refuse_entry(&refusal))?;
        let mut scenario: Scenario = serde_path_to_error::deserialize(expanded).map_err(|error| {
            let path = FieldPath::from_serde(error.path());
            // Behind an empty line are the keys on the way, which the path has too.
            let message = error.inner().message().split("\n\n").next().unwrap_or_default().trim_end();
            let FaultOfField { fault, path, side } = wording::fault_from_message(message, path);
            fault.at(self.location(&path, side))
        })?;
        if scenario.name.is_empty() {
            scenario.name.clone_from(&self.source.stem);
        }
        scenario.fire.fill_in_model();
        // Contradictions come after types: of a value with the wrong type, the type is the more basic fault.
        if let Some((path, fault)) = contradictions::first(written) {
            let side = if matches!(fault, Fault::Conflict { .. }) { KeyOrValue::Key } else { KeyOrValue::Value };
            return Err(fault.at(self.location_as_written(&path, side)));
        }
        if let Some(file) = &scenario.fuel_file {
            let path = FieldPath::parse("fuel_file");
            scenario.imported_fuel =
                read_fuels(&self.file(&path, file)).map_err(|message| self.rule(&path, message))?;
        }
        self.load_landscape(&mut scenario)?;
        self.load_map(&mut scenario)?;
        self.load_roads(&mut scenario)?;
        self.load_barriers(&mut scenario)?;
        self.place_starts(written, &mut scenario);
        self.load_weather(&mut scenario)?;
        self.load_zones(&mut scenario)?;
        self.load_densities(&mut scenario)?;
        self.find_files(&mut scenario)?;
        // Values are checked only now, as files give some that have ranges too.
        scenario
            .check_values()
            .map_err(|refusal| refusal.fault().at(self.location(&refusal.path, KeyOrValue::Value)))?;
        // Copies are placed last: places are looked for on the field, whose size and coverage have been checked by now.
        self.copies.place(&mut scenario).map_err(|refusal| self.refuse_entry(&refusal))?;
        Ok(scenario)
    }

    /// Words the refusal of a value of an entry, whose path has the entry's number in it and no agent's.
    fn refuse_entry(&self, refusal: &ValidationError) -> Box<ScenarioError> {
        refusal.fault().at(self.location_as_written(&refusal.path, KeyOrValue::Value))
    }

    /// Refuses values that only loading may fill in, and numbers that are infinite or NaN.
    fn refuse_loaded_and_infinite(&self, written: &Value) -> Result<(), Box<ScenarioError>> {
        if let Some((path, found)) = first_infinite(written, FieldPath::default()) {
            let field = path.to_string();
            let expected = "a finite number".to_owned();
            return Err(Fault::Value { field, found, expected }.at(self.location(&path, KeyOrValue::Value)));
        }
        let Some(path) = LOADED.iter().flat_map(|path| FieldPath::parse(path).all_in(written)).next() else {
            return Ok(());
        };
        let (name, table) = path.0.split_last().expect("it is a field of a table");
        let fault =
            wording::unknown_field(&FieldPath(vec![name.clone()]).to_string(), &FieldPath(table.to_vec()), Vec::new());
        Err(fault.at(self.location(&path, KeyOrValue::Key)))
    }

    /// Looks for the files of programs, from the scenario's folder, or from the current one where a change of the
    /// command line names the program.
    fn find_files(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        // The command line cannot know whether a program of it plans or decides, and gives a table of each kind.
        let unused =
            scenario.policy.keys().filter(|name| !scenario.has_follower(name) && scenario.planner.contains_key(name));
        for name in unused.cloned().collect::<Vec<PlannerName>>() {
            let is_changed = ["command", "module"]
                .map(|key| self.changes.set(&FieldPath(["policy", name.name(), key].map(PathStep::key).to_vec())));
            if is_changed.contains(&true) {
                scenario.policy.remove(&name);
            }
        }
        for (kind, programs) in [("planner", &mut scenario.planner), ("policy", &mut scenario.policy)] {
            for (name, program) in programs.iter_mut().filter(|(_, program)| program.is_external()) {
                let table = FieldPath(vec![PathStep::key(kind), PathStep::key(name.name())]);
                let is_changed = ["command", "module"].map(|key| self.changes.set(&table.join(PathStep::key(key))));
                let folder = if is_changed.contains(&true) { Path::new("") } else { &self.source.folder };
                program.fill_in(folder).map_err(|UnusableFile { place, file, reason }| {
                    let path = FieldPath([table.0.clone(), place].concat());
                    let file = program.works_in.join(file);
                    match reason {
                        Unusable::Unreadable(error) => {
                            unreadable(&file, &error).at(self.location(&path, KeyOrValue::Value))
                        }
                        #[cfg(feature = "modules")]
                        Unusable::Module(message) => self.rule(&path, format!("`{}` {message}", file.display())),
                    }
                })?;
            }
        }
        Ok(())
    }

    /// Reads the files of a landscape, and gives the field their frame.
    fn load_landscape(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        // All layers share one reader, as several may be bands of one file and all must lie on one frame.
        let mut reader = LayerReader::new(scenario.custom_fuels());
        let mut files = Vec::new();
        if let Some(settings) = &scenario.fire.rothermel {
            files.extend([
                (LayerKind::Fuel, "fire.rothermel.fuel_map", &settings.fuel_map),
                (LayerKind::Elevation, "fire.rothermel.elevation", &settings.elevation),
                (LayerKind::Slope, "fire.rothermel.slope", &settings.slope),
                (LayerKind::Aspect, "fire.rothermel.aspect", &settings.aspect),
            ]);
        }
        if let Some(settings) = scenario.fire.crowns() {
            files.extend([
                (LayerKind::Canopy(0), "fire.crowns.height_map", &settings.height_map),
                (LayerKind::Canopy(1), "fire.crowns.base_map", &settings.base_map),
                (LayerKind::Canopy(2), "fire.crowns.density_map", &settings.density_map),
                (LayerKind::Canopy(3), "fire.crowns.cover_map", &settings.cover_map),
            ]);
        }
        for (kind, path, file) in files {
            if let Some(file) = file {
                let path = FieldPath::parse(path);
                let read = reader.read(kind, &self.file(&path, file));
                read.map_err(|message| self.rule(&path, message))?;
            }
        }
        let mut layers = reader.finish();
        if let Some((image, legend)) = scenario.landscape.as_ref().and_then(|it| Some((it.image.as_ref()?, &it.legend)))
        {
            let path = FieldPath::parse("landscape.image");
            let fuel =
                FuelImage::read(&self.file(&path, image), legend).map_err(|message| self.rule(&path, message))?;
            let with_image = fuel.onto(layers, scenario.field.cell_m).map_err(|message| self.rule(&path, message))?;
            layers = Some(with_image);
        }
        let Some(layers) = layers else { return Ok(()) };
        // The files decide on cells and sides, whatever the scenario says.
        let field = &mut scenario.field;
        field.cell_m = layers.frame.cell_m;
        // One number cannot say both sides; `raster_frame` has them.
        field.size_m = layers.frame.width_m().max(layers.frame.height_m());
        field.raster_frame = Some(layers.frame);
        scenario.landscape.get_or_insert_default().imported = Some(layers);
        Ok(())
    }

    /// Reads the lines of roads.
    fn load_roads(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let frame = scenario.field.frame();
        let Some(settings) = &mut scenario.landscape else { return Ok(()) };
        // A field of an impossible size is refused later.
        let has_size = (1..=MAX_RASTER_CELLS).contains(&frame.cell_count());
        let Some(file) = settings.roads_file.as_ref().filter(|_| has_size) else { return Ok(()) };
        let path = FieldPath::parse("landscape.roads_file");
        let layers = settings.imported.as_ref();
        settings.imported_roads = Some(self.read_shapes(&path, file, geojson::road_cells, &frame, layers)?);
        Ok(())
    }

    fn load_densities(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let frame = scenario.field.frame();
        let layers = scenario.landscape.as_ref().and_then(|landscape| landscape.imported.as_ref());
        for (number, ignition) in scenario.ignition.iter_mut().enumerate() {
            let list = FieldPath(vec![PathStep::key("ignition"), PathStep::Index(number)]);
            match &mut ignition.cells {
                IgnitionCells::Density(density) => {
                    let path = list.join(PathStep::key("density"));
                    let weights = Weights::read(&self.file(&path, &density.file), &frame, layers);
                    density.weights = Some(weights.map_err(|message| self.rule(&path, message))?);
                }
                IgnitionCells::Area(area) => {
                    let path = list.join(PathStep::key("perimeter"));
                    area.inside = Some(self.read_shapes(&path, &area.file, geojson::area_cells, &frame, layers)?);
                }
                IgnitionCells::Points(points) => {
                    let path = list.join(PathStep::key("points_m"));
                    // Points have the coordinates of the landscape's files, if it has any.
                    let corner = layers.map_or([0.0; 2], |layers| [layers.west_m, layers.south_m]);
                    let mut cells = Vec::with_capacity(points.len());
                    for &[x, y] in points.iter() {
                        let Some(cell) = frame.cell_at(DVec2::new(x - corner[0], y - corner[1])) else {
                            let [west, south] = corner;
                            let [width, height] = [frame.width_m(), frame.height_m()];
                            let message = format!(
                                "`{path}`: there is no cell at ({x}, {y}); expected a place in the field of {width} x \
                                 {height} m from ({west}, {south}) on"
                            );
                            return Err(self.rule(&path, message));
                        };
                        cells.push(cell);
                    }
                    // From here on they are cells like those that a scenario names.
                    ignition.cells = IgnitionCells::Cells(cells);
                }
                IgnitionCells::Cells(_) | IgnitionCells::Random(_) => {}
            }
        }
        Ok(())
    }

    /// Reads the files of barriers.
    fn load_barriers(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let frame = scenario.field.frame();
        let layers = scenario.landscape.as_ref().and_then(|landscape| landscape.imported.as_ref());
        for (number, barrier) in scenario.barrier.iter_mut().enumerate() {
            let entry = FieldPath(vec![PathStep::key("barrier"), PathStep::Index(number)]);
            let path = entry.join(PathStep::key("file"));
            barrier.fill_in_fuel();
            barrier.covered = Some(self.read_shapes(&path, &barrier.file, geojson::covered_cells, &frame, layers)?);
        }
        Ok(())
    }

    /// Reads a GeoJSON file that a value names, and packs the cells of the field that its shapes mark.
    fn read_shapes(
        &self,
        path: &FieldPath,
        file: &Path,
        mark: ShapeReader,
        frame: &FieldFrame,
        layers: Option<&ImportedLayers>,
    ) -> Result<PackedLayer, Box<ScenarioError>> {
        let file = self.file(path, file);
        let text = input_file::read_text(&file, MAX_MAP_BYTES)
            .map_err(|error| unreadable(&file, &error).at(self.location(path, KeyOrValue::Value)))?;
        // A field of an impossible size is refused later.
        if !(1..=MAX_RASTER_CELLS).contains(&frame.cell_count()) {
            return Ok(PackedLayer::from_bytes(&[]));
        }
        let cells = mark(&text, frame, layers).map_err(|error| {
            let error = json_fault(&text, &error, FieldPath::default());
            Fault::from(error.fault).at(SourceLocation::new(&file.display().to_string(), &text, error.span))
        })?;
        let cells = cells.map_err(|message| self.rule(path, format!("{}: {message}", file.display())))?;
        Ok(PackedLayer::from_bytes(&cells))
    }

    /// Reads moistures by place and factors on the rate of spread.
    fn load_zones(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let frame = scenario.field.frame();
        let fuels = scenario.custom_fuels();
        let layers = scenario.landscape.as_ref().and_then(|landscape| landscape.imported.as_ref());
        // A field of an impossible size is refused later.
        let has_size = (1..=MAX_RASTER_CELLS).contains(&frame.cell_count());
        let Some(settings) = scenario.fire.rothermel.as_mut().filter(|_| has_size) else { return Ok(()) };
        if let Some(file) = &settings.adjustment_file {
            let path = FieldPath::parse("fire.rothermel.adjustment_file");
            let factors = read_rate_factors(&self.file(&path, file));
            settings.imported_factors = factors.map_err(|message| self.rule(&path, message))?;
        }
        if let Some(file) = &settings.moisture_file {
            let path = FieldPath::parse("fire.rothermel.moisture_file");
            let moisture = ImportedMoisture::read_models(&self.file(&path, file));
            settings.imported_moisture = Some(moisture.map_err(|message| self.rule(&path, message))?);
        }
        if let Some(rasters) = &settings.moisture_rasters {
            let path = FieldPath::parse("fire.rothermel.moisture_rasters");
            let classes = (0_u8..).zip(MOISTURE_CLASSES).zip(rasters.files());
            let files: Vec<_> = classes
                .filter_map(|((class, (name, _)), file)| {
                    Some((class, self.file(&path.join(PathStep::key(name)), file?)))
                })
                .collect();
            let moisture = ImportedMoisture::read_rasters(&files, &frame, layers, &fuels);
            settings.imported_moisture = Some(moisture.map_err(|message| self.rule(&path, message))?);
        }
        let has_samples = scenario.weather.iter().flat_map(|weather| &weather.rows).any(|row| row.moisture.is_some());
        match settings.local_moisture_key() {
            Some(key) if has_samples => {
                let path = FieldPath::parse("weather.samples");
                let message = format!("`weather.samples` has columns of moisture; expected none beside `{key}`");
                Err(self.rule(&path, message))
            }
            _ => Ok(()),
        }
    }

    fn load_weather(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        if let Some(file) = &scenario.wind_file {
            let path = FieldPath::parse("wind_file");
            let file = self.file(&path, file);
            let list = read_wind_list(&file, scenario.duration_s).map_err(|message| self.rule(&path, message))?;
            let winds = list.map_or_else(|| read_wind(&file, scenario.duration_s), Ok);
            scenario.wind = winds.map_err(|message| self.rule(&path, message))?;
        }
        self.load_wind_fields(scenario)?;
        if let Some(settings) = &mut scenario.weather
            && let Some(file) = &settings.samples
        {
            let path = FieldPath::parse("weather.samples");
            settings.rows = read_samples(&self.file(&path, file)).map_err(|message| self.rule(&path, message))?;
        }
        // A stream gives dead moisture only, so live fuel keeps the moisture of the scenario.
        let usual = scenario.fire.rothermel.as_ref().map_or_else(FuelMoisture::default, |settings| settings.moisture);
        if let Some(settings) = &mut scenario.weather
            && let Some(file) = &settings.file
        {
            let path = FieldPath::parse("weather.file");
            let stream = read_stream(&self.file(&path, file), settings, &usual, scenario.duration_s);
            let stream = stream.map_err(|message| self.rule(&path, message))?;
            scenario.wind = stream.winds;
            settings.notes = stream.notes;
            // The other changes of the moisture exclude it.
            settings.moisture.extend(stream.moistures);
        }
        Ok(())
    }

    /// Reads the rasters of winds by place.
    fn load_wind_fields(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let frame = scenario.field.frame();
        // A field of an impossible size is refused later.
        let has_size = (1..=MAX_RASTER_CELLS).contains(&frame.cell_count());
        let of_list = scenario.wind_file.as_ref().map(|_| FieldPath::parse("wind_file"));
        let layers = scenario.landscape.as_ref().and_then(|landscape| landscape.imported.as_ref());
        for (number, wind) in scenario.wind.iter_mut().enumerate().filter(|_| has_size) {
            let entry = FieldPath(vec![PathStep::key("wind"), PathStep::Index(number)]);
            let path = of_list.clone().unwrap_or_else(|| entry.clone());
            let rasters = wind.rasters().map_err(|message| self.rule(&path, format!("`{entry}`: {message}")))?;
            let Some(rasters) = rasters else {
                // NaN stands for a number that the entry does not give, and without rasters both are needed.
                let absent = [("speed_mps", wind.speed_mps), ("toward_deg", wind.toward_deg)];
                if let Some((name, _)) = absent.into_iter().find(|(_, number)| number.is_nan()) {
                    let fault = Fault::MissingField { name: name.into(), table: entry.to_string() };
                    return Err(fault.at(self.location(&entry, KeyOrValue::Value)));
                }
                continue;
            };
            // Winds of a list are exempt: they have zeros until their rasters are read.
            if !(wind.speed_mps.is_nan() && wind.toward_deg.is_nan()) && of_list.is_none() {
                let message = format!("`{entry}` has rasters; expected no `speed_mps` and no `toward_deg` beside them");
                return Err(self.rule(&path, message));
            }
            let keys = match rasters.kind {
                WindRasterKind::SpeedFrom => ["speed", "from"],
                WindRasterKind::SpeedToward => ["speed", "toward"],
                WindRasterKind::EastNorth => ["east", "north"],
            };
            // Files of a list lie beside it.
            let [first, second] = match of_list {
                Some(_) => [rasters.first.to_owned(), rasters.second.to_owned()],
                None => [(keys[0], rasters.first), (keys[1], rasters.second)]
                    .map(|(key, file)| self.file(&entry.join(PathStep::key(key)), file)),
            };
            let rasters = WindRasters { first: &first, second: &second, ..rasters };
            let field = rasters.read(&frame, layers).map_err(|message| self.rule(&path, message))?;
            wind.set_field(&field);
        }
        Ok(())
    }

    /// Returns the path of a file that a value names: from the scenario's folder, or from the current one where a change of
    /// the command line names it.
    fn file(&self, path: &FieldPath, file: &Path) -> PathBuf {
        if self.changes.set(path) { file.to_owned() } else { self.source.folder.join(file) }
    }

    /// Words a fault of a value.
    fn rule(&self, path: &FieldPath, message: String) -> Box<ScenarioError> {
        Fault::Rule { message }.at(self.location(path, KeyOrValue::Value))
    }

    fn load_map(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let Some(map) = &scenario.field.map else { return Ok(()) };
        let path = FieldPath::parse("field.map");
        let file = self.file(&path, map);
        let imported = self.read_map(&path, &file, &scenario.field)?;
        let field = &mut scenario.field;
        if let Some(frame) = field.raster_frame.filter(|&frame| frame != imported.frame) {
            let FieldFrame { cols, rows, .. } = imported.frame;
            let message = format!(
                "`field.map` has {cols} x {rows} cells of {} m; expected {} x {} of {} m, as the landscape has",
                imported.frame.cell_m, frame.cols, frame.rows, frame.cell_m
            );
            return Err(self.rule(&path, message));
        }
        // What the map says replaces what the file says, so that a resolved scenario states the field that is run.
        field.cell_m = imported.frame.cell_m;
        field.size_m = imported.frame.width_m().max(imported.frame.height_m());
        field.coverage = imported.coverage();
        field.imported = Some(imported);
        Ok(())
    }

    /// Reads the map at a path, whatever its format.
    fn read_map(&self, path: &FieldPath, file: &Path, field: &Field) -> Result<ImportedField, Box<ScenarioError>> {
        let cannot_be_read = |error| unreadable(file, &error).at(self.location(path, KeyOrValue::Value));
        let bytes = input_file::read(file, MAX_MAP_BYTES).map_err(cannot_be_read)?;
        if !map_files::is_plain_text(&bytes) {
            let map = map_files::read_bytes(file, bytes, field.reading());
            let map = map.map_err(|error| self.rule(path, error.to_string()))?;
            return ImportedField::from_map_file(&map, field.cell_m)
                .map_err(|fault| self.rule(path, format!("{}: {fault}", file.display())));
        }
        let text = input_file::text(bytes).map_err(cannot_be_read)?;
        let mut imported = ImportedField::parse(&text, field.cell_m).map_err(|error| {
            let place = SourceLocation::new(&file.display().to_string(), &text, error.span.clone());
            Fault::from(error.fault).at(place)
        })?;
        // Only text comes here; images are inverted while they are read, with their threshold.
        if field.map_invert {
            imported.occupied.values_mut().iter_mut().for_each(|cell| *cell = !*cell);
        }
        Ok(imported)
    }

    /// Places the agents without a start of their own on a map. Where the map is a change, that is also those whose start
    /// in the file lies outside it.
    fn place_starts(&self, written: &Value, scenario: &mut Scenario) {
        if scenario.field.imported.is_none() {
            return;
        }
        let frame = scenario.field.frame();
        let has_other_map = self.changes.touch(&FieldPath::parse("field.map"));
        let has_start = |kind: &'static str, agent: usize, name: &str, fits: bool| {
            let start = TablePath::entry(kind, self.copies.entry(kind, agent).unwrap_or(agent)).key(name);
            // Starts of the file were written for its own map: one that does not fit another map is moved and not refused.
            start.leads_to(written) && (fits || !has_other_map || self.changes.touch(&start))
        };
        for (number, wumpus) in scenario.wumpus.iter_mut().enumerate() {
            if !has_start("wumpus", number, "start_m", wumpus.start_fits(&frame)) {
                wumpus.start_within(&frame);
            }
        }
        for (number, truck) in scenario.unimog.iter_mut().enumerate() {
            if !has_start("unimog", number, "start", truck.start_fits(&frame)) {
                truck.start_within(&frame);
            }
        }
    }

    /// Returns the location where a value was written last: in a change of it or of a part of it, or in the file.
    fn location(&self, path: &FieldPath, side: KeyOrValue) -> SourceLocation {
        self.location_as_written(&self.copies.written(path), side)
    }

    fn location_as_written(&self, path: &FieldPath, side: KeyOrValue) -> SourceLocation {
        if let Some(location) = self.changes.location(path, side) {
            return location;
        }
        let span = match path.locate(&self.source.text) {
            FoundSpan::Whole { key, .. } if side == KeyOrValue::Key => key,
            FoundSpan::Whole { value, .. } => value,
            FoundSpan::Part(span) => span,
        };
        SourceLocation::new(&self.source.name, &self.source.text, span)
    }
}

/// Makes every -0.0 within a value 0.0: ranges that begin at 0 hold it, and what is computed from it differs.
fn drop_sign_of_zero(value: &mut Value) {
    match value {
        Value::Float(number) => *number += 0.0,
        Value::Array(list) => list.iter_mut().for_each(drop_sign_of_zero),
        Value::Table(table) => table.iter_mut().for_each(|(_, inner)| drop_sign_of_zero(inner)),
        _ => {}
    }
}

/// Finds a number that is infinite or NaN, which TOML can write and no field can mean.
fn first_infinite(value: &Value, path: FieldPath) -> Option<(FieldPath, String)> {
    match value {
        Value::Float(number) if !number.is_finite() => Some((path, number.to_string())),
        Value::Array(list) => {
            list.iter().enumerate().find_map(|(index, inner)| first_infinite(inner, path.join(PathStep::Index(index))))
        }
        Value::Table(table) => {
            table.iter().find_map(|(key, inner)| first_infinite(inner, path.join(PathStep::Key(key.clone()))))
        }
        _ => None,
    }
}
