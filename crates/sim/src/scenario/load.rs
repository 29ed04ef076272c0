//! Loading: from a name or a path to a scenario that is complete and checked.

use std::path::{Path, PathBuf};

use toml::{Table, Value};

use super::change::Change;
use super::check::{Refusal, TablePath};
use super::copies::Copies;
use super::error::{Fault, ScenarioError, SourceLocation};
use super::fuel_image::FuelImage;
use super::layers::{LayerKind, LayerReader, Weights};
use super::path::{FieldPath, FoundSpan, PathStep};
use super::program::FILLED_IN;
use super::source::{MAX_MAP_BYTES, ScenarioText, first_too_deep, too_deep_message, unreadable};
use super::starts::Starting;
use super::weather_csv::{read_samples, read_wind};
use super::wording::{self, KeyOrValue};
use super::{Field, GivenField, IgnitionCells, Scenario};
use wildfire_base::geometry::FieldFrame;
use wildfire_base::input_file;
use wildfire_grid::map_files;
use wildfire_planning::PlannerName;

/// Options of `[field]` that say how to generate one, and so contradict a map.
const GENERATED_ONLY: [&str; 6] = ["size_m", "coverage", "pieces", "shapes", "overlaps", "start_clearance_m"];

/// Why the size of a field cannot be given beside rasters.
const RASTER_SIZE: &str = "a raster says itself how large the field and its cells are";

/// Why deviations cannot be given beside rows.
const ONE_CHANCE: &str = "each says how uncertain the weather is";

/// Tables of a truck that say how many samples its roadmap has,
const ROADMAP_TABLES: [&str; 2] = ["prm", "prm_rs"];
/// by a number of them
const SAMPLES: &str = "samples";
/// or by a density.
const DENSITY: &str = "samples_per_hectare";

/// Returns the paths of the number and of the density of samples in a table of a truck.
fn sample_paths(truck: usize, table: &'static str) -> [FieldPath; 2] {
    let steps = [PathStep::key("unimog"), PathStep::Index(truck), PathStep::key(table)];
    [SAMPLES, DENSITY].map(|name| FieldPath(steps.iter().cloned().chain([PathStep::key(name)]).collect()))
}

/// A scenario, with what its author wrote, so that defaults can be told apart.
#[derive(Clone, Debug)]
pub struct LoadedScenario {
    pub scenario: Scenario,
    written: Table,
    pub(super) copies: Copies,
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
        let mut written = parse(source)?;
        let changes = changes.iter().map(|option| Change::make(option, &mut written)).collect::<Result<Vec<_>, _>>()?;
        written.iter_mut().for_each(|(_, value)| drop_sign_of_zero(value));
        let mut text = WrittenScenario { source, changes, copies: Copies::default() };
        text.drop_overruled(&mut written);
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
        let mut table = Table::try_from(&self.scenario).expect("every part of a scenario can be written as TOML");
        if let Some(Value::Table(field)) = table.get_mut("field") {
            let has_map = self.scenario.field.given.is_some();
            field.retain(|name, _| {
                name != "given" && name != "raster_frame" && !(has_map && GENERATED_ONLY.contains(&name))
            });
        }
        for (name, hidden) in [("landscape", "given"), ("weather", "rows")] {
            if let Some(inner) = table.get_mut(name).and_then(Value::as_table_mut) {
                inner.remove(hidden);
            }
        }
        for entry in table.get_mut("ignition").and_then(Value::as_array_mut).into_iter().flatten() {
            entry.as_table_mut().expect("it is a table").remove("weights");
        }
        if self.scenario.wind_file.is_some() {
            table.remove("wind");
        }
        for kind in ["planner", "policy"] {
            let tables = table.get_mut(kind).and_then(Value::as_table_mut).into_iter().flat_map(Table::iter_mut);
            for (_, program) in tables {
                program.as_table_mut().expect("it is a table").retain(|name, _| !FILLED_IN.contains(&name));
            }
        }
        leaves(Value::Table(table), &FieldPath::default())
    }

    /// Says whether the file or a change gives the value at this path, such as `unimog.0.prm.samples`. The starts of agents
    /// that an entry has by their number are given by it.
    pub fn is_given(&self, dotted: &str) -> bool {
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

/// A scenario as it was written: in its file, and in changes of the command line.
struct WrittenScenario<'a> {
    source: &'a ScenarioText,
    changes: Vec<Change>,
    /// The entries that agents are written in, once they are known.
    copies: Copies,
}

impl WrittenScenario<'_> {
    fn resolve(&mut self, written: &Table) -> Result<Scenario, Box<ScenarioError>> {
        self.refuse_hidden_and_infinite(written)?;
        let mut expanded = written.clone();
        self.copies = Copies::expand(&mut expanded).map_err(|refusal| self.refuse_entry(&refusal))?;
        let mut scenario: Scenario = serde_path_to_error::deserialize(Value::Table(expanded)).map_err(|error| {
            let path = FieldPath::from_serde(error.path());
            let (fault, path, side) = wording::fault_from_message(error.inner().message(), path);
            fault.at(self.location(&path, side))
        })?;
        if scenario.name.is_empty() {
            scenario.name.clone_from(&self.source.stem);
        }
        scenario.fire.fill_in_model();
        self.refuse_conflicts(written)?;
        self.load_landscape(&mut scenario)?;
        self.load_map(&mut scenario)?;
        self.place_starts(written, &mut scenario);
        self.load_weather(&mut scenario)?;
        self.load_densities(&mut scenario)?;
        self.find_files(&mut scenario)?;
        scenario
            .check_values()
            .map_err(|refusal| refusal.fault().at(self.location(&refusal.path, KeyOrValue::Value)))?;
        self.copies.place(&mut scenario).map_err(|refusal| self.refuse_entry(&refusal))?;
        Ok(scenario)
    }

    /// Words the refusal of a value of an entry, whose path has the entry's number in it and no agent's.
    fn refuse_entry(&self, refusal: &Refusal) -> Box<ScenarioError> {
        refusal.fault().at(self.location_as_written(&refusal.path, KeyOrValue::Value))
    }

    /// Removes from the table the values of the file that a change of another value replaces.
    fn drop_overruled(&self, written: &mut Table) {
        self.drop_overruled_goals(written);
        self.drop_overruled_samples(written);
        let Some(field) = written.get_mut("field").and_then(Value::as_table_mut) else { return };
        let changed = |name: &str| {
            let path = FieldPath::parse("field").join(PathStep::key(name));
            self.changes.iter().any(|change| change.set.iter().any(|set| path.starts_with(set)))
        };
        let overruled = |name: &str| match name {
            "coverage" => changed("pieces") || changed("map"),
            "pieces" => changed("coverage") || changed("map"),
            _ => changed("map") && GENERATED_ONLY.contains(&name),
        };
        field.retain(|name, _| changed(name) || !overruled(name));
    }

    /// Removes the goals of trucks where a change dispatches them, or the table `dispatch` where one gives a truck a goal.
    fn drop_overruled_goals(&self, written: &mut Table) {
        let dispatch = FieldPath::parse("dispatch");
        let changed = |path: &FieldPath| {
            self.changes
                .iter()
                .any(|change| change.set.iter().any(|set| set.starts_with(path) || path.starts_with(set)))
        };
        let goal_of = |number| TablePath::entry("unimog", number).key("goal");
        let count = written.get("unimog").and_then(Value::as_array).map_or(0, Vec::len);
        let (is_dispatched, has_goal) = (changed(&dispatch), (0..count).any(|number| changed(&goal_of(number))));
        if has_goal && !is_dispatched {
            written.remove("dispatch");
        }
        if is_dispatched && let Some(trucks) = written.get_mut("unimog").and_then(Value::as_array_mut) {
            let overruled = trucks.iter_mut().enumerate().filter(|(number, _)| !changed(&goal_of(*number)));
            for truck in overruled.filter_map(|(_, truck)| truck.as_table_mut()) {
                truck.remove("goal");
            }
        }
    }

    /// Does so with the samples of roadmaps: of a number and a density the changed one stays.
    fn drop_overruled_samples(&self, written: &mut Table) {
        let trucks = written.get_mut("unimog").and_then(Value::as_array_mut).into_iter().flatten();
        for (truck, settings) in trucks.enumerate() {
            for table in ROADMAP_TABLES {
                let Some(settings) = settings.get_mut(table).and_then(Value::as_table_mut) else { continue };
                let is_changed = |path: FieldPath| {
                    self.changes.iter().any(|change| change.set.iter().any(|set| path.starts_with(set)))
                };
                match sample_paths(truck, table).map(is_changed) {
                    [true, false] => settings.remove(DENSITY),
                    [false, true] => settings.remove(SAMPLES),
                    _ => None,
                };
            }
        }
    }

    /// Refuses a number of samples beside a density of them.
    fn refuse_two_numbers_of_samples(&self, written: &Table) -> Result<(), Box<ScenarioError>> {
        let trucks = written.get("unimog").and_then(Value::as_array).map_or(0, Vec::len);
        let tables = (0..trucks).flat_map(|truck| ROADMAP_TABLES.map(|table| sample_paths(truck, table)));
        for [number, density] in tables {
            if number.leads_to(written) && density.leads_to(written) {
                let (one, other) = (density.to_string(), number.to_string());
                let fault = Fault::Conflict { one, other, reason: "each says how many samples there are" };
                return Err(fault.at(self.location_as_written(&density, KeyOrValue::Key)));
            }
        }
        Ok(())
    }

    /// Refuses fields that only loading may fill in, and numbers that are infinite or NaN.
    fn refuse_hidden_and_infinite(&self, written: &Table) -> Result<(), Box<ScenarioError>> {
        if let Some((path, found)) = first_infinite(written) {
            let (field, expected) = (path.to_string(), "a finite number".to_owned());
            return Err(Fault::Value { field, found, expected }.at(self.location(&path, KeyOrValue::Value)));
        }
        let hidden = [("field", "given"), ("field", "raster_frame"), ("landscape", "given"), ("weather", "rows")];
        let hidden = hidden.map(|(table, name)| (FieldPath::parse(table), name));
        let tables = ["planner", "policy"].into_iter().filter_map(|kind| Some((kind, written.get(kind)?.as_table()?)));
        let tables = tables.flat_map(|(kind, tables)| tables.keys().map(move |name| (kind, name.clone())));
        let of_programs = tables.flat_map(|(kind, name)| {
            let table = FieldPath(vec![PathStep::key(kind), PathStep::Key(name)]);
            FILLED_IN.map(|field| (table.clone(), field))
        });
        for (table, name) in hidden.into_iter().chain(of_programs) {
            let path = table.join(PathStep::key(name));
            if path.leads_to(written) {
                let fault = wording::unknown_field(name, &table, Vec::new());
                return Err(fault.at(self.location(&path, KeyOrValue::Key)));
            }
        }
        Ok(())
    }

    /// Looks for the files of programs, from the scenario's folder, or from the current one where a change of the
    /// command line names the program.
    fn find_files(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        // The command line cannot know whether a program of it plans or decides, and gives a table of each kind.
        let unused =
            scenario.policy.keys().filter(|name| !scenario.has_follower(name) && scenario.planner.contains_key(name));
        for name in unused.cloned().collect::<Vec<PlannerName>>() {
            let command = FieldPath(["policy", name.name(), "command"].map(PathStep::key).to_vec());
            if self.changes.iter().any(|change| change.set.contains(&command)) {
                scenario.policy.remove(&name);
            }
        }
        for (kind, programs) in [("planner", &mut scenario.planner), ("policy", &mut scenario.policy)] {
            for (name, program) in programs.iter_mut().filter(|(_, program)| !program.command.is_empty()) {
                let table = FieldPath(vec![PathStep::key(kind), PathStep::key(name.name())]);
                let command = table.join(PathStep::key("command"));
                let changed = self.changes.iter().any(|change| change.set.contains(&command));
                let folder = if changed { Path::new("") } else { &self.source.folder };
                program.fill_in(folder).map_err(|(index, error)| {
                    let path = table.join(PathStep::key("files")).join(PathStep::Index(index));
                    unreadable(&program.works_in.join(&program.files[index]), &error)
                        .at(self.location(&path, KeyOrValue::Value))
                })?;
            }
        }
        Ok(())
    }

    /// Reads the files of a landscape, and gives the field their frame.
    fn load_landscape(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let mut reader = LayerReader::default();
        if let Some(settings) = &scenario.fire.rothermel {
            for (kind, key, file) in [
                (LayerKind::Fuel, "fuel_map", &settings.fuel_map),
                (LayerKind::Elevation, "elevation", &settings.elevation),
                (LayerKind::Slope, "slope", &settings.slope),
                (LayerKind::Aspect, "aspect", &settings.aspect),
            ] {
                let path = FieldPath::parse("fire.rothermel").join(PathStep::key(key));
                if let Some(file) = file {
                    let read = reader.read(kind, &self.file(&path, file));
                    read.map_err(|message| self.rule(&path, message))?;
                }
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
        let field = &mut scenario.field;
        field.cell_m = layers.frame.cell_m;
        field.size_m = layers.frame.width_m().max(layers.frame.height_m());
        field.raster_frame = Some(layers.frame);
        scenario.landscape.get_or_insert_default().given = Some(layers);
        Ok(())
    }

    fn load_densities(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let frame = scenario.field.frame();
        let layers = scenario.landscape.as_ref().and_then(|landscape| landscape.given.as_ref());
        for (number, ignition) in scenario.ignition.iter_mut().enumerate() {
            let list = FieldPath(vec![PathStep::key("ignition"), PathStep::Index(number)]);
            let IgnitionCells::Density(density) = &mut ignition.cells else { continue };
            if density.weights.is_some() {
                let path = list.join(PathStep::key("weights"));
                return Err(
                    wording::unknown_field("weights", &list, Vec::new()).at(self.location(&path, KeyOrValue::Key))
                );
            }
            let path = list.join(PathStep::key("density"));
            let weights = Weights::read(&self.file(&path, &density.file), &frame, layers);
            density.weights = Some(weights.map_err(|message| self.rule(&path, message))?);
        }
        Ok(())
    }

    fn load_weather(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        if let Some(file) = &scenario.wind_file {
            let path = FieldPath::parse("wind_file");
            scenario.wind = read_wind(&self.file(&path, file)).map_err(|message| self.rule(&path, message))?;
        }
        if let Some(settings) = &mut scenario.weather
            && let Some(file) = &settings.samples
        {
            let path = FieldPath::parse("weather.samples");
            settings.rows = read_samples(&self.file(&path, file)).map_err(|message| self.rule(&path, message))?;
        }
        Ok(())
    }

    /// Returns the path of a file that a value names: from the scenario's folder, or from the current one where a change of
    /// the command line names it.
    fn file(&self, path: &FieldPath, file: &Path) -> PathBuf {
        let changed = self.changes.iter().any(|change| change.set.contains(path));
        if changed { file.to_owned() } else { self.source.folder.join(file) }
    }

    /// Words a fault of a value.
    fn rule(&self, path: &FieldPath, message: String) -> Box<ScenarioError> {
        Fault::Rule { message }.at(self.location(path, KeyOrValue::Value))
    }

    fn refuse_conflicts(&self, written: &Table) -> Result<(), Box<ScenarioError>> {
        let field = FieldPath::parse("field");
        let given = |name: &str| field.join(PathStep::key(name)).leads_to(written);
        let conflict = |one: &str, other: &str, reason| {
            let fault = Fault::Conflict { one: format!("field.{one}"), other: format!("field.{other}"), reason };
            Err(fault.at(self.location(&field.join(PathStep::key(one)), KeyOrValue::Key)))
        };
        if given("pieces") && given("coverage") {
            return conflict("pieces", "coverage", "each says how many bushes there are");
        }
        if let Some(name) = GENERATED_ONLY.iter().find(|name| given("map") && given(name)) {
            return conflict(name, "map", "a map says itself where the bushes are");
        }
        for name in ["map_tolerance", "map_invert"] {
            if given(name) && !given("map") {
                return Err(
                    self.rule(&field.join(PathStep::key(name)), format!("`field.{name}` needs `field.map` beside it"))
                );
            }
        }
        self.refuse_goals_of_dispatched(written)?;
        self.refuse_two_numbers_of_samples(written)?;
        self.refuse_conflicts_of_landscape(written)
    }

    /// Refuses a goal of a truck beside the table `dispatch`.
    fn refuse_goals_of_dispatched(&self, written: &Table) -> Result<(), Box<ScenarioError>> {
        let trucks = written.get("unimog").and_then(Value::as_array).map_or(0, Vec::len);
        let mut goals = (0..trucks).map(|number| TablePath::entry("unimog", number).key("goal"));
        let Some(goal) = goals.find(|goal| written.contains_key("dispatch") && goal.leads_to(written)) else {
            return Ok(());
        };
        let reason = "each says where trucks go";
        let fault = Fault::Conflict { one: goal.to_string(), other: "dispatch".into(), reason };
        Err(fault.at(self.location_as_written(&goal, KeyOrValue::Key)))
    }

    fn refuse_conflicts_of_landscape(&self, written: &Table) -> Result<(), Box<ScenarioError>> {
        let given = |dotted: &str| FieldPath::parse(dotted).leads_to(written);
        let conflicts = [
            ("fire.rothermel.fuel_map", "landscape.image", "each says what grows where"),
            ("fire.rothermel.ground", "fire.rothermel.fuel_map", "a map of fuels says itself what grows"),
            ("fire.rothermel.ground", "landscape.image", "an image says itself what grows"),
            ("fire.rothermel.elevation", "fire.rothermel.slope", "each says how steep the ground is"),
            ("fire.rothermel.elevation", "fire.rothermel.aspect", "each says how steep the ground is"),
            ("fire.rothermel.slope_deg", "fire.rothermel.elevation", "each says how steep the ground is"),
            ("fire.rothermel.slope_deg", "fire.rothermel.slope", "each says how steep the ground is"),
            ("landscape.hills", "fire.rothermel.elevation", "each says how steep the ground is"),
            ("landscape.hills", "fire.rothermel.slope", "each says how steep the ground is"),
            ("landscape.hills", "fire.rothermel.slope_deg", "each says how steep the ground is"),
            ("wind", "wind_file", "each says how the wind changes"),
            ("weather.samples", "weather.speed_sd_mps", ONE_CHANCE),
            ("weather.samples", "weather.toward_sd_deg", ONE_CHANCE),
            ("weather.samples", "weather.moisture_sd", ONE_CHANCE),
            ("weather.samples", "weather.moisture", "a row of it holds for the whole run"),
            ("field.size_m", "fire.rothermel.fuel_map", RASTER_SIZE),
            ("field.size_m", "fire.rothermel.elevation", RASTER_SIZE),
            ("field.size_m", "fire.rothermel.slope", RASTER_SIZE),
            ("field.size_m", "landscape.image", "an image has a pixel for each cell"),
            ("field.cell_m", "fire.rothermel.fuel_map", RASTER_SIZE),
            ("field.cell_m", "fire.rothermel.elevation", RASTER_SIZE),
            ("field.cell_m", "fire.rothermel.slope", RASTER_SIZE),
        ];
        if let Some(&(one, other, reason)) = conflicts.iter().find(|(one, other, _)| given(one) && given(other)) {
            let fault = Fault::Conflict { one: one.to_owned(), other: other.to_owned(), reason };
            return Err(fault.at(self.location(&FieldPath::parse(one), KeyOrValue::Key)));
        }
        for (one, other) in [
            ("fire.rothermel.slope", "fire.rothermel.aspect"),
            ("fire.rothermel.aspect", "fire.rothermel.slope"),
            ("landscape.image", "landscape.legend"),
        ] {
            if given(one) && !given(other) {
                let message = format!("`{one}` needs `{other}` beside it");
                return Err(self.rule(&FieldPath::parse(one), message));
            }
        }
        Ok(())
    }

    fn load_map(&self, scenario: &mut Scenario) -> Result<(), Box<ScenarioError>> {
        let Some(map) = &scenario.field.map else { return Ok(()) };
        let path = FieldPath::parse("field.map");
        let file = self.file(&path, map);
        let given = self.read_map(&path, &file, &scenario.field)?;
        let field = &mut scenario.field;
        if let Some(frame) = field.raster_frame.filter(|&frame| frame != given.frame) {
            let FieldFrame { cols, rows, .. } = given.frame;
            let message = format!(
                "`field.map` has {cols} x {rows} cells of {} m; expected {} x {} of {} m, as the landscape has",
                given.frame.cell_m, frame.cols, frame.rows, frame.cell_m
            );
            return Err(self.rule(&path, message));
        }
        field.cell_m = given.frame.cell_m;
        field.size_m = given.frame.width_m().max(given.frame.height_m());
        field.coverage = given.coverage();
        field.given = Some(given);
        Ok(())
    }

    /// Reads the map at a path, whatever its format.
    fn read_map(&self, path: &FieldPath, file: &Path, field: &Field) -> Result<GivenField, Box<ScenarioError>> {
        let bytes = input_file::read(file, MAX_MAP_BYTES)
            .map_err(|error| unreadable(file, &error).at(self.location(path, KeyOrValue::Value)))?;
        if !map_files::is_plain_text(&bytes) {
            let map = map_files::read_bytes(file, bytes, field.reading());
            let map = map.map_err(|error| self.rule(path, error.to_string()))?;
            return GivenField::from_map_file(&map, field.cell_m)
                .map_err(|fault| self.rule(path, format!("{}: {fault}", file.display())));
        }
        let text = input_file::text(bytes)
            .map_err(|error| unreadable(file, &error).at(self.location(path, KeyOrValue::Value)))?;
        let mut given = GivenField::parse(&text, field.cell_m).map_err(|error| {
            let place = SourceLocation::new(&file.display().to_string(), &text, error.span.clone());
            Fault::from(error.fault).at(place)
        })?;
        if field.map_invert {
            given.occupied.values_mut().iter_mut().for_each(|cell| *cell = !*cell);
        }
        Ok(given)
    }

    /// Places the agents without a start of their own on a map. Where the map is a change, that is also those whose start
    /// in the file lies outside it.
    fn place_starts(&self, written: &Table, scenario: &mut Scenario) {
        if scenario.field.given.is_none() {
            return;
        }
        let frame = scenario.field.frame();
        let changed = |path: &FieldPath| {
            self.changes
                .iter()
                .any(|change| change.set.iter().any(|set| set.starts_with(path) || path.starts_with(set)))
        };
        let has_other_map = changed(&FieldPath::parse("field").join(PathStep::key("map")));
        let has_start = |kind: &'static str, agent: usize, name: &str, fits: bool| {
            let start = TablePath::entry(kind, self.copies.entry(kind, agent).unwrap_or(agent)).key(name);
            start.leads_to(written) && (fits || !has_other_map || changed(&start))
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
        let related = |set: &&FieldPath| path.starts_with(set) || set.starts_with(path);
        for change in self.changes.iter().rev() {
            if let Some(set) = change.set.iter().find(related) {
                // A fault in a key, or in what the change only adds to, is a fault of its path.
                let in_value = side == KeyOrValue::Value && path.starts_with(set) || path.0.len() > set.0.len();
                return if in_value { change.value_location() } else { change.path_location() };
            }
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
fn first_infinite(table: &Table) -> Option<(FieldPath, String)> {
    fn within(value: &Value, path: FieldPath) -> Option<(FieldPath, String)> {
        match value {
            Value::Float(number) if !number.is_finite() => Some((path, number.to_string())),
            Value::Array(list) => {
                list.iter().enumerate().find_map(|(index, inner)| within(inner, path.join(PathStep::Index(index))))
            }
            Value::Table(table) => {
                table.iter().find_map(|(key, inner)| within(inner, path.join(PathStep::Key(key.clone()))))
            }
            _ => None,
        }
    }
    table.iter().find_map(|(key, value)| within(value, FieldPath(vec![PathStep::Key(key.clone())])))
}
