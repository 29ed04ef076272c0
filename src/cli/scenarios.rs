//! Files that people write, and what may stand in them: `wildfire scenarios`, `check`, `new` and `schema`.

use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};
use std::process::ExitCode;

use clap::{Args, ValueEnum};
use schemars::{JsonSchema, schema_for};
use serde::Serialize;

use crate::cli::args::ScenarioArguments;
use crate::cli::assignment;
use crate::cli::batch::{BatchObject, PlanAnswer, ReportAnswer, SliceAnswer};
use crate::cli::context::CommandContext;
use crate::cli::error::CliError;
use crate::cli::grade::Platform;
use crate::cli::map::{NO_IMAGE, parse_tolerance};
use crate::cli::numbers;
use crate::cli::output_files::{Files, Format, note_written};
use crate::cli::report::FormArguments;
use crate::cli::terminal;
use wildfire_base::document::number::percent;
use wildfire_base::document::{Block, Document};
use wildfire_base::input_file::{self, is_standard_stream};
use wildfire_base::ranges::number_text;
use wildfire_base::untrusted::visible;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::execute::Machines;
use wildfire_batch::plan::{PLAN_TEMPLATE, PROGRAM_VERSION, plan_schema, rules_schema};
use wildfire_batch::table::{TableOfRows, row_schema};
use wildfire_grid::map_files::{self, MAX_BYTES, Reading, Tolerance};
use wildfire_picture::draw_vehicle;
use wildfire_scenario::{
    self as scenario, BUILT_IN, LoadedScenario, MemoryEstimate, MemoryLimit, Scenario, ScenarioText,
};
use wildfire_sim::programs::protocol;
use wildfire_timeline::export;

const SCENARIO_TEMPLATE: &str = include_str!("../../assets/scenario.toml");

/// Planners to begin with, by the ending of their file.
const PLANNER_TEMPLATES: [(&str, &str); 4] = [
    ("py", include_str!("../../assets/planners/planner.py")),
    ("c", include_str!("../../assets/planners/planner.c")),
    ("cpp", include_str!("../../assets/planners/planner.cpp")),
    ("rs", include_str!("../../assets/planners/planner.rs")),
];

#[derive(Debug, Args)]
pub struct NewArguments {
    /// The kind of file.
    pub what: NewFile,
    /// Output file; must not exist [default: print it]. The ending of a planner's file selects its language: `.py`,
    /// `.c`, `.cpp` or `.rs`. An assignment takes a folder, which must not exist or must be empty.
    pub file: Option<PathBuf>,
    /// The same, named as in other commands.
    #[arg(short, long, value_name = "FILE", conflicts_with = "file")]
    pub out: Option<PathBuf>,
    /// Platform of an assignment: its files are added [default: plain].
    #[arg(long = "for", value_name = "PLATFORM")]
    pub platform: Option<Platform>,
    #[command(flatten)]
    pub map: MapArguments,
}

/// A map to begin a scenario with.
#[derive(Debug, Args)]
pub struct MapArguments {
    /// Start the scenario from this map: any format that `wildfire map` reads, text of `.` and `#`, or GeoJSON.
    #[arg(long, value_name = "FILE")]
    pub from_map: Option<PathBuf>,
    /// Side of a cell in metres [default: 5, or the map's value].
    #[arg(long = "cell", alias = "cell-m", value_name = "METRES", allow_hyphen_values = true, value_parser = parse_cell, requires = "from_map")]
    pub cell_m: Option<f64>,
    /// Largest grey value of an image's pixels that become bushes; `auto` picks it with Otsu's method [default: 50].
    #[arg(long, value_name = "GREY|auto", allow_hyphen_values = true, value_parser = parse_tolerance, requires = "from_map")]
    pub tolerance: Option<Tolerance>,
    /// Invert the map: use an image's negative, or swap free cells and bushes.
    #[arg(long, requires = "from_map")]
    pub invert: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NewFile {
    Scenario,
    Plan,
    Planner,
    /// 20 random seeds of 64 bits, for a course.
    Seeds,
    /// A folder for a course: rules, secret seeds, sample entries, a handout, a page for the instructor.
    Assignment,
}

#[derive(Debug, Args)]
pub struct SchemaArguments {
    /// Files, or tables that a batch writes.
    pub of: SchemaOf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum SchemaOf {
    Scenario,
    Plan,
    Rules,
    Runs,
    PlannerCalls,
    States,
    Decisions,
    PlannerProtocol,
    /// The object that `wildfire export` writes as JSON.
    Export,
    /// The file machines.json of a batch.
    Machines,
    /// The output of `wildfire batch --format json` and `wildfire merge --format json`.
    BatchAnswer,
    /// The output of `wildfire batch --dry-run --format json`.
    DryRunAnswer,
    /// The output of `wildfire batch --shard --format json`.
    SliceAnswer,
    /// The output of `wildfire report --format json`.
    ReportAnswer,
    /// The output of `wildfire check --format json`.
    CheckAnswer,
    /// The output of `wildfire scenarios --format json`.
    ScenariosAnswer,
}

#[derive(Debug, Args)]
pub struct CheckArguments {
    #[command(flatten)]
    pub scenario: ScenarioArguments,
    /// Memory limit to compare the estimate with [default: 2GB].
    #[arg(long, value_name = "SIZE", default_value_t, hide_default_value = true)]
    pub memory: MemoryLimit,
    /// Draw the kinematic model of the first truck with its dimensions.
    #[arg(long, value_name = "FILE.svg|FILE.png")]
    pub sketch: Option<PathBuf>,
    /// Print all values, what they mean, the field of seed 1 and the memory; --format json always has them.
    #[arg(long)]
    pub all: bool,
    #[command(flatten)]
    pub form: FormArguments,
}

#[derive(Debug, Args)]
pub struct ScenariosArguments {
    /// Print the main values of this built-in scenario.
    #[arg(long, value_name = "NAME", conflicts_with = "report_form")]
    pub show: Option<String>,
    /// Print the whole file, as a beginning for your own: `> my.toml`.
    #[arg(long, requires = "show")]
    pub all: bool,
    #[command(flatten)]
    pub form: FormArguments,
}

/// What a scenario means.
#[derive(Serialize, JsonSchema)]
pub struct CheckAnswer {
    program_version: &'static str,
    name: String,
    /// The sections in order, as text.
    sections: Vec<CheckSection>,
    /// The scenario with all values filled in, as `wildfire schema scenario` describes it.
    scenario: serde_json::Value,
}

/// A section of what is said of a scenario.
#[derive(Serialize, JsonSchema)]
struct CheckSection {
    title: String,
    lines: Vec<String>,
}

impl CheckAnswer {
    fn new(loaded: &LoadedScenario, document: &Document) -> Self {
        let mut sections: Vec<CheckSection> = vec![CheckSection { title: document.title.clone(), lines: Vec::new() }];
        for block in &document.blocks {
            let lines = match block {
                Block::Heading(title) => {
                    sections.push(CheckSection { title: title.clone(), lines: Vec::new() });
                    continue;
                }
                Block::Text(line) => vec![line.clone()],
                Block::List(lines) => lines.clone(),
                Block::Verbatim(lines) => lines.lines().map(str::to_owned).collect(),
                Block::Terms(terms) => terms.iter().map(|(name, meaning)| format!("{name}: {meaning}")).collect(),
                Block::Table(table) => table.rows.iter().map(|cells| cells.join(" ")).collect(),
                Block::Contents | Block::Links(_) | Block::Figure(_) | Block::Image { .. } | Block::Folded(..) => {
                    Vec::new()
                }
            };
            sections.last_mut().expect("the title is one").lines.extend(lines);
        }
        Self {
            program_version: PROGRAM_VERSION,
            name: loaded.scenario.name.clone(),
            sections,
            scenario: serde_json::to_value(&loaded.scenario).expect("scenarios hold names, numbers and lists only"),
        }
    }
}

/// The built-in scenarios.
#[derive(Serialize, JsonSchema)]
pub struct ScenariosAnswer {
    program_version: &'static str,
    scenarios: Vec<ListedScenario>,
}

#[derive(Serialize, JsonSchema)]
struct ListedScenario {
    name: &'static str,
    /// A sentence about its purpose.
    purpose: String,
}

impl From<&ScenariosAnswer> for Document {
    fn from(answer: &ScenariosAnswer) -> Self {
        let terms = answer.scenarios.iter().map(|listed| (listed.name.to_owned(), listed.purpose.clone()));
        // A list without a title needs no page.
        Self::default().with([Block::Terms(terms.collect())])
    }
}

/// Explains a scenario.
///
/// # Errors
/// Bad input if the scenario is wrong, or if a run would be refused since it needs more memory than the limit.
pub fn check(arguments: &CheckArguments, context: &CommandContext) -> Result<ExitCode, CliError> {
    let loaded =
        LoadedScenario::open(&arguments.scenario.source, &context.with_custom_names(&arguments.scenario.overrides))?;
    let document = scenario::explain(&loaded, arguments.memory);
    let answer = CheckAnswer::new(&loaded, &document);
    let files = Files { form: arguments.form, ..Files::default() }.writing([(Format::Sketch, &arguments.sketch)]);
    let stream = files.check()?;
    let fits = MemoryEstimate::new(&loaded.scenario).meter(arguments.memory);
    let printed = arguments.form.render_either(&answer, || match arguments.all {
        true => document,
        false => brief(document, &loaded, fits.is_ok(), &format!("wildfire check {} --all", arguments.scenario.source)),
    });
    stream.print(&printed)?;
    if let Some(path) = &arguments.sketch {
        write_sketch(&loaded.scenario, path)?;
        note_written(path, context.quiet);
    }
    // The explanation is printed nevertheless, since its list of memory shows what to change.
    match fits {
        Ok(_) => Ok(ExitCode::SUCCESS),
        Err(exceeded) => Err(CliError::bad_input(format_args!("a run would be refused: {exceeded}"), None)),
    }
}

/// The number of agents of a scenario, and its main values.
fn outline(loaded: &LoadedScenario) -> [Block; 2] {
    let Scenario { unimog, wumpus, .. } = &loaded.scenario;
    let agents = format!("Trucks: {}. Wumpuses: {}. The values of the first of each:", unimog.len(), wumpus.len());
    [Block::Text(agents), Block::Verbatim(scenario::outline(loaded).join("\n"))]
}

/// A screen of a scenario's explanation: its main values, the size of its field, and warnings; the memory too if it is
/// more than the limit. It ends with the command that prints all.
fn brief(all: Document, loaded: &LoadedScenario, fits: bool, command: &str) -> Document {
    let mut heading = String::new();
    let mut kept = outline(loaded).to_vec();
    for block in all.blocks {
        if let Block::Heading(title) = &block {
            heading.clone_from(title);
        }
        let is_kept = match &heading[..] {
            "Warnings" | "Programs" => true,
            "Maximum memory of a run" => !fits,
            title => title.starts_with("Field of seed") && !matches!(block, Block::Verbatim(_)),
        };
        kept.extend(is_kept.then_some(block));
    }
    let sentence = format!("{} values in all; `{command}` prints them.", loaded.values().len());
    Document::new(all.title).with(kept).with([Block::Text(sentence)])
}

/// Draws the first truck of a scenario.
fn write_sketch(scenario: &Scenario, path: &Path) -> Result<(), CliError> {
    let Some(truck) = scenario.unimog.first() else {
        return Err(CliError::bad_input("--sketch: expected a scenario with a truck, and this one has none", None));
    };
    let title = format!("Kinematic model of unimog/0, {}", scenario.name);
    let drawing = draw_vehicle(&title, &truck.vehicle);
    let is_png = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    let bytes = if is_png { drawing.paint().to_png() } else { drawing.to_svg().into_bytes() };
    write_whole(path, &bytes).map_err(|error| CliError::unwritable(path, &error))
}

/// Lists the built-in scenarios, or prints the file of one.
pub fn list_or_show(arguments: &ScenariosArguments) -> Result<ExitCode, CliError> {
    match &arguments.show {
        Some(name) if arguments.all => terminal::print(built_in(name)?)?,
        Some(name) => {
            let text = built_in(name)?;
            let loaded = LoadedScenario::open(name, &[])?;
            let document = Document::new(format!("{name}: {}", first_sentence(text))).with(outline(&loaded)).with([
                Block::Text(format!("Change a value: `wildfire run {name} --set KEY=VALUE`.")),
                Block::Text(format!("The whole file: `wildfire scenarios --show {name} --all > my.toml`.")),
            ]);
            terminal::print(&document.to_text())?;
        }
        None => {
            let scenarios =
                BUILT_IN.iter().map(|&(name, text)| ListedScenario { name, purpose: first_sentence(text) }).collect();
            let answer = ScenariosAnswer { program_version: PROGRAM_VERSION, scenarios };
            terminal::print(&arguments.form.render(&answer))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn built_in(name: &str) -> Result<&'static str, CliError> {
    let found = BUILT_IN.iter().find(|(existing, _)| *existing == name);
    found.map(|(_, text)| *text).ok_or_else(|| {
        let names: Vec<_> = BUILT_IN.iter().map(|(existing, _)| *existing).collect();
        let help = format!("the built-in scenarios are {}", names.join(", "));
        CliError::bad_input(format_args!("there is no built-in scenario `{name}`"), Some(&help))
    })
}

/// Returns the purpose of a scenario: the first sentence of the comment that opens its file.
fn first_sentence(text: &str) -> String {
    let comment = text.lines().map_while(|line| line.strip_prefix('#')).map(str::trim);
    let paragraph = comment.take_while(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
    match paragraph.find(". ") {
        Some(end) => paragraph[..=end].to_owned(),
        None => paragraph,
    }
}

/// Writes a template with comments, to begin with.
pub fn new(arguments: &NewArguments, quiet: bool) -> Result<ExitCode, CliError> {
    let file = arguments.file.as_deref().or(arguments.out.as_deref()).filter(|path| !is_standard_stream(path));
    if arguments.map.from_map.is_some() && arguments.what != NewFile::Scenario {
        let help = "`wildfire new scenario --from-map FILE` creates a scenario from a map";
        return Err(CliError::bad_input("--from-map applies only to a scenario", Some(help)));
    }
    if arguments.platform.is_some() && arguments.what != NewFile::Assignment {
        let help = "`wildfire new assignment course --for gradescope` writes a course for Gradescope";
        return Err(CliError::bad_input("--for applies only to an assignment", Some(help)));
    }
    let (format, text) = match arguments.what {
        NewFile::Scenario => match &arguments.map.from_map {
            Some(map) => (Format::Toml, scenario_from_map(map, &arguments.map, file, quiet)?),
            None => (Format::Toml, SCENARIO_TEMPLATE.to_owned()),
        },
        NewFile::Plan => (Format::Toml, PLAN_TEMPLATE.to_owned()),
        NewFile::Planner => (Format::Source, planner_template(file)?),
        NewFile::Seeds => (Format::Csv, assignment::random_seeds()),
        NewFile::Assignment => {
            let help = "`wildfire new assignment course` writes it into the folder `course`";
            let folder = file.ok_or_else(|| CliError::bad_input("an assignment needs a folder", Some(help)))?;
            assignment::write(folder, arguments.platform.unwrap_or(Platform::Plain))?;
            return Ok(ExitCode::SUCCESS);
        }
    };
    match file {
        Some(path) => write_new(path, format, &text)?,
        None => terminal::print(&text)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// The planner in the language of the file's ending, with the file's name in its opening comment.
fn planner_template(file: Option<&Path>) -> Result<String, CliError> {
    let file = file.unwrap_or(Path::new("planner.py"));
    let ending = file.extension().unwrap_or_default();
    let Some((_, text)) = PLANNER_TEMPLATES.iter().find(|(existing, _)| ending == *existing) else {
        let sentence = format!("{}: expected a name that ends in .py, .c, .cpp or .rs", file.display());
        return Err(CliError::bad_input(sentence, Some("the ending selects the planner's language")));
    };
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    Ok(text.replace("FILE", &name))
}

/// A scenario whose field is a map, with the agents of the contest. It is loaded once, so that what is written runs, and so
/// that its comments say what the map is.
fn scenario_from_map(map: &Path, options: &MapArguments, file: Option<&Path>, quiet: bool) -> Result<String, CliError> {
    let folder = file.and_then(Path::parent).unwrap_or(Path::new(""));
    // The map's path is written as seen from the file, so both can be moved together.
    let from_folder = relative_path(map, folder)?;
    let field = field_table(&from_folder.to_string_lossy(), options);
    let source = file.unwrap_or(Path::new("scenario.toml"));
    let stem = map.file_stem().unwrap_or_default().to_string_lossy();
    let name: String = visible(&stem).chars().take(100).collect();
    let head = format!("name = {}\n\n{field}", toml::Value::from(name));
    // Agents without a start get the usual places on this field, and the file spells them out below.
    let draft = format!("{head}\n[[wumpus]]\n\n[[unimog]]\n");
    let draft = ScenarioText::from_bytes(&source.to_string_lossy(), Ok(draft.into_bytes()))?;
    // The draft is loaded once, so that what is written is known to run.
    let scenario = LoadedScenario::from_text(&draft, &[])?.scenario;
    if !quiet {
        let of_map =
            notes_on_map(map, options, &scenario)?.into_iter().map(|note| format!("{}: {note}", map.display()));
        of_map.chain(scenario::warnings_of_map(&scenario)).for_each(|note| terminal::note(&note));
    }
    let frame = scenario.field.frame();
    let imported = scenario.field.imported.as_ref().expect("it has a map");
    let bushes = imported.occupied.values().iter().filter(|&&occupied| occupied).count();
    let [wumpus, truck] = [scenario.wumpus[0].start_m, [scenario.unimog[0].start.x_m, scenario.unimog[0].start.y_m]];
    Ok(format!(
        "# A contest on the map {}. Omitted values have their defaults; `wildfire check FILE` lists all values,\n# \
         scenarios/README.md explains them.\n\
         #\n\
         # The map: {} x {} cells of {} m, {} x {} m, {bushes} bushes ({} % of the cells).\n\
         # A start that a bush blocks is moved to the nearest free place when a run begins.\n\n\
         {head}\n\
         [[wumpus]]\n\
         start_m = [{}, {}]\n\n\
         [[unimog]]\n\
         start = {{ x_m = {}, y_m = {}, heading_deg = 0.0 }}\n",
        visible(&map.to_string_lossy()),
        frame.cols,
        frame.rows,
        frame.cell_m,
        metres_text(frame.width_m()),
        metres_text(frame.height_m()),
        percent(imported.coverage()),
        toml::Value::from(wumpus[0]),
        toml::Value::from(wumpus[1]),
        toml::Value::from(truck[0]),
        toml::Value::from(truck[1]),
    ))
}

fn metres_text(side_m: f64) -> String {
    number_text((1e3 * side_m).round() / 1e3)
}

/// Lists notes on a map, as `wildfire map` does.
fn notes_on_map(map: &Path, options: &MapArguments, scenario: &Scenario) -> Result<Vec<String>, CliError> {
    let bytes = input_file::read(map, MAX_BYTES).map_err(|error| CliError::unreadable(map, &error))?;
    let reading = Reading { tolerance: options.tolerance.unwrap_or_default(), inverted: options.invert };
    let read = if map_files::is_plain_text(&bytes) { None } else { Some(map_files::read_bytes(map, bytes, reading)?) };
    let mut notes = read.as_ref().map_or(Vec::new(), |read| [read.notes.clone(), read.doubts()].concat());
    if read.is_none() {
        notes.extend(scenario::doubts_of_files(scenario));
    }
    if options.tolerance.is_some() && read.is_none_or(|read| read.grey.is_none()) {
        notes.push(NO_IMAGE.to_owned());
    }
    Ok(notes)
}

/// The table of the field, with what was asked for and no more.
fn field_table(map: &str, options: &MapArguments) -> String {
    let mut table = format!("[field]\nmap = {}\n", toml::Value::from(map));
    if let Some(cell_m) = options.cell_m {
        table += &format!("cell_m = {}\n", toml::Value::from(cell_m));
    }
    match options.tolerance {
        Some(Tolerance::Grey(grey)) => table += &format!("map_tolerance = {grey}\n"),
        Some(Tolerance::Auto) => table += "map_tolerance = \"auto\"\n",
        None => {}
    }
    if options.invert {
        table += "map_invert = true\n";
    }
    table
}

/// The path of a file from a folder: up to where both lie and down again.
fn relative_path(file: &Path, folder: &Path) -> Result<PathBuf, CliError> {
    let folder = canonical(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
    let file = canonical(file)?;
    let shared = file.components().zip(folder.components()).take_while(|(one, other)| one == other).count();
    // On Windows, paths on two drives share nothing, and no relative path leads from one to the other.
    if shared == 0 {
        return Ok(file);
    }
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    Ok(up.chain(file.components().skip(shared)).collect())
}

fn canonical(path: &Path) -> Result<PathBuf, CliError> {
    path.canonicalize().map_err(|error| CliError::unreadable(path, &error))
}

fn parse_cell(text: &str) -> Result<f64, String> {
    numbers::parse(text).ok_or_else(|| "expected the side of a cell in metres".to_owned())
}

/// Writes a new file.
fn write_new(path: &Path, format: Format, text: &str) -> Result<(), CliError> {
    Files { outputs: vec![(format, path)], ..Files::default() }.check()?;
    // `create_new` also refuses a file that appears after the check.
    let written = File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => {
            let sentence = format!("{} already exists; expected a new name", path.display());
            CliError::bad_input(sentence, None)
        }
        _ => CliError::unwritable(path, &error),
    })
}

/// Prints what a file may say, or what columns mean, as JSON Schema.
pub fn schema(arguments: &SchemaArguments) -> Result<ExitCode, CliError> {
    let schema = match arguments.of {
        SchemaOf::Scenario => schema_text(scenario::schema()),
        SchemaOf::Plan => schema_text(plan_schema()),
        SchemaOf::Rules => schema_text(rules_schema()),
        SchemaOf::Runs => row_schema(TableOfRows::Runs),
        SchemaOf::PlannerCalls => row_schema(TableOfRows::PlannerCalls),
        SchemaOf::States => row_schema(TableOfRows::States),
        SchemaOf::Decisions => row_schema(TableOfRows::Decisions),
        SchemaOf::PlannerProtocol => schema_text(protocol::schema()),
        SchemaOf::Export => schema_text(export::schema()),
        SchemaOf::Machines => schema_text(schema_for!(Machines)),
        SchemaOf::BatchAnswer => schema_text(schema_for!(BatchObject)),
        SchemaOf::DryRunAnswer => schema_text(schema_for!(PlanAnswer)),
        SchemaOf::SliceAnswer => schema_text(schema_for!(SliceAnswer)),
        SchemaOf::ReportAnswer => schema_text(schema_for!(ReportAnswer)),
        SchemaOf::CheckAnswer => schema_text(schema_for!(CheckAnswer)),
        SchemaOf::ScenariosAnswer => schema_text(schema_for!(ScenariosAnswer)),
    };
    terminal::print(&format!("{schema}\n"))?;
    Ok(ExitCode::SUCCESS)
}

fn schema_text(schema: impl Serialize) -> String {
    serde_json::to_string_pretty(&schema).expect("a schema is JSON")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn purpose_is_the_first_sentence_of_the_first_paragraph() {
        assert_eq!(first_sentence("# One two\n# three. Four.\n\nname = 1\n"), "One two three.");
        assert_eq!(first_sentence("# One\n#\n# two\n"), "One");
        assert_eq!(first_sentence("name = 1\n"), "");
    }

    #[test]
    fn scenario_template_is_the_contest_under_another_name() {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let path = scratch.path().join("mine.toml");
        write_new(&path, Format::Toml, SCENARIO_TEMPLATE).expect("writable");
        let mine = scenario::load(&path.display().to_string(), &[]).expect("it is a scenario");
        let contest = scenario::load("contest", &[]).expect("it is built in");
        assert_eq!(mine, Scenario { name: "mine".into(), ..contest });
    }
}
