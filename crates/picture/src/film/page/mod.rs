//! Pages that play runs in a browser: one file each, which needs neither a network nor this program.
//!
//! Numbers, texts, colours and sprites are prepared here and embedded in the page as data; its script (`assets/page/`)
//! draws them as the other modules of [`film`](super) do. Layers of values over the whole field are left out.

mod data;
mod ground;

use std::borrow::Cow;
use std::collections::BTreeMap;

use data_encoding::BASE64;
use miniz_oxide::deflate::compress_to_vec_zlib;
use serde::Serialize;

pub use ground::MAX_GROUND_CELLS;

use data::{RunData, hex};

use crate::colours::{
    BORDER, BURNING, EXTINGUISHED, FAINT_INK, FIELD, INK, OUTSIDE, PAPER, UNIMOG, WATER, WUMPUS, bush_colour,
};
use crate::film::field::searches::STYLES;
use crate::film::field::sprite::{
    BURNED_SPRITE, BUSH_SPRITE, EMBERS_SPRITE, FLAME_SPRITE, Sprite, SvgShape, UNIMOG_SPRITE, WET_SPRITE, WHEEL_SPRITE,
    WUMPUS_SPRITE,
};
use crate::film::hud::chart::CountScale;
use crate::film::hud::legend::{LegendEntry, LegendSign, legend_entries, run_sentence};
use crate::film::{BINDINGS, Camera, CameraTarget, FrameRequest, Layer, RunView, Selected};
use wildfire_base::document::escaped_html;
use wildfire_fire::BushStateKind;
use wildfire_timeline::Setting;

const TEMPLATE: &str = include_str!("../../../assets/page/page.html");
const STYLE: &str = include_str!("../../../assets/page/page.css");
/// The player's scripts; each uses those before it.
const SCRIPTS: [&str; 7] = [
    include_str!("../../../assets/page/run.js"),
    include_str!("../../../assets/page/field.js"),
    include_str!("../../../assets/page/ground.js"),
    include_str!("../../../assets/page/chart.js"),
    include_str!("../../../assets/page/panel.js"),
    include_str!("../../../assets/page/tour.js"),
    include_str!("../../../assets/page/player.js"),
];
/// Start scripts: of a page that carries its runs, and of one that computes them.
const RECORDED: &str = include_str!("../../../assets/page/recorded.js");
const PLAY: &str = include_str!("../../../assets/page/play.js");
const WORKER: &str = include_str!("../../../assets/page/worker.js");
const DESK: &str = include_str!("../../../assets/page/desk.html");
const QUESTION: &str = include_str!("../../../assets/page/question.html");
/// What lies over the field at first: a button that plays, or the choice of a game.
const COVER: &str = include_str!("../../../assets/page/cover.html");
const CHOICE: &str = include_str!("../../../assets/page/choice.html");

/// How hard the data are packed, 0 to 10: more takes longer and gains next to nothing.
const PACKED: u8 = 8;

/// The name of the element that holds a page's module.
const MODULE: &str = "module";

/// Keys of the window that ask for what a page cannot do: other runs, and to quit.
const WINDOW_ONLY: [&str; 3] = ["R", "N P", "Q"];

/// All that the script of a page is given.
#[derive(Serialize)]
struct PageData {
    time_ns: u64,
    /// The point in the middle as shares of the field, and the zoom.
    camera: [f64; 3],
    /// `fleet` or an agent.
    follows: Option<String>,
    selected: Option<SelectedData>,
    layers: Vec<LayerData>,
    /// Signs of the legend, as a kind and a colour or nothing, and what they mean.
    legend: Vec<(&'static str, String, String)>,
    search_styles: Vec<SearchStyleData>,
    /// Keys and what they do.
    keys: Vec<[&'static str; 2]>,
    zooms: [f64; 2],
    colours: BTreeMap<&'static str, String>,
    state_names: [&'static str; 4],
    state_colours: [String; 4],
    /// Shapes, the lowest first: colour, opacity, width of a line or 0, path.
    sprites: BTreeMap<&'static str, Vec<(String, f32, f32, String)>>,
    runs: Vec<RunData>,
}

#[derive(Serialize)]
struct SelectedData {
    run: usize,
    /// Place of a bush, or of an agent, in the run.
    bush: Option<usize>,
    agent: Option<usize>,
}

#[derive(Serialize)]
struct LayerData {
    name: &'static str,
    key: String,
    is_on: bool,
}

#[derive(Serialize)]
struct SearchStyleData {
    layer: &'static str,
    colours: [[u8; 3]; 2],
    width: f32,
    opacity: f32,
    disc: f32,
}

/// Returns a page that plays the runs of a request, one or two; it begins at the request's time, seen as its options say.
pub fn page(request: &FrameRequest) -> String {
    let title = request.runs.iter().map(|run| format!("{}, seed {}", run.title(), run.timeline().setting.seed));
    let title = title.collect::<Vec<_>>().join(" and ");
    let mut sentences: Vec<String> = request.runs.iter().map(|run| run_sentence(&run.timeline().setting)).collect();
    sentences.dedup();
    let sentence = sentences.join(" ");
    filled_in(&Filling {
        title: &title,
        sentence: &sentence,
        cover: COVER,
        script: RECORDED,
        data: &packed_runs(request),
        ..Filling::default()
    })
}

/// A WebAssembly module as a page carries it: compressed, in base 64.
#[derive(Clone, Debug)]
pub struct PackedModule<'a>(Cow<'a, str>);

impl<'a> PackedModule<'a> {
    /// Compresses the bytes of a module.
    pub fn new(module: &[u8]) -> Self {
        Self(BASE64.encode(&compress_to_vec_zlib(module, PACKED)).into())
    }

    /// Returns the module of a page that `play_page` made; `None` if there is none.
    pub fn from_page(page: &'a str) -> Option<Self> {
        let (_, rest) = page.split_once(&element_start(MODULE))?;
        // Base 64 has no `<`, so the first one is that of the element's end.
        let (module, _) = rest.split_once('<')?;
        Some(Self(module.into()))
    }
}

/// Returns a page that computes runs by a WebAssembly module and lets its reader play. It opens with a recorded run behind the
/// choice of a game, or with a game, in JSON, if that is played.
pub fn play_page(module: &PackedModule<'_>, opening: &FrameRequest, game: &str) -> String {
    // No text of a game ends the element that it stands in.
    let game = game.replace('<', "\\u003c");
    let data = [packed_runs(opening), element("worker", WORKER), element("setup-data", &game)];
    filled_in(&Filling {
        title: "wildfire",
        sentence: "An arsonist lights bushes, fire trucks put them out: the side with more points at the end wins.",
        // `wasm-unsafe-eval` lets the page compile its module, and evaluate no text as a script.
        policy: "script-src 'unsafe-inline' 'wasm-unsafe-eval'; worker-src blob:",
        desk: DESK,
        question: QUESTION,
        cover: CHOICE,
        script: PLAY,
        data: &data.concat(),
        // The last in the page: what comes before is shown while this is still read.
        module: &element(MODULE, &module.0),
    })
}

fn packed_runs(request: &FrameRequest) -> String {
    element("run-data", &BASE64.encode(&compress_to_vec_zlib(page_data(request).as_bytes(), PACKED)))
}

/// The parts in which pages differ.
struct Filling<'a> {
    title: &'a str,
    sentence: &'a str,
    /// The content security policy, without what all pages have.
    policy: &'a str,
    desk: &'a str,
    question: &'a str,
    cover: &'a str,
    script: &'a str,
    /// Elements that carry data.
    data: &'a str,
    module: &'a str,
}

impl Default for Filling<'_> {
    fn default() -> Self {
        let policy = "script-src 'unsafe-inline'";
        Self { title: "", sentence: "", policy, desk: "", question: "", cover: "", script: "", data: "", module: "" }
    }
}

fn filled_in(filling: &Filling<'_>) -> String {
    TEMPLATE
        .replace("@POLICY@", filling.policy)
        .replace("@STYLE@", STYLE)
        .replace("@DESK@\n", filling.desk)
        .replace("@QUESTION@\n", filling.question)
        .replace("@COVER@\n", filling.cover)
        .replace("@SCRIPT@", &without_comments(&(SCRIPTS.concat() + filling.script)))
        .replace("@TITLE@", &escaped_html(filling.title))
        .replace("@SENTENCE@", &escaped_html(filling.sentence))
        // The last, so that nothing in it is replaced.
        .replace("@DATA@\n", filling.data)
        .replace("@MODULE@\n", filling.module)
}

/// Returns a script without indentation and lines of comments, a quarter of it. No string of these scripts has several lines.
fn without_comments(script: &str) -> String {
    let lines = script.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
    lines.flat_map(|line| [line, "\n"]).collect()
}

fn element(id: &str, data: &str) -> String {
    format!("{}{data}</script>\n", element_start(id))
}

fn element_start(id: &str) -> String {
    format!("<script type=\"application/octet-stream\" id=\"{id}\">")
}

/// Returns the data of such a page alone, as JSON.
pub fn page_data(request: &FrameRequest) -> String {
    serde_json::to_string(&PageData::new(request)).expect("numbers and words are JSON")
}

impl PageData {
    fn new(request: &FrameRequest) -> Self {
        let options = request.options;
        let Camera { centre, zoom } = options.camera;
        let scale = CountScale::new(request.runs);
        Self {
            time_ns: request.time.as_nanos(),
            camera: [centre.x, centre.y, zoom],
            follows: options.follows.map(|followed: CameraTarget| followed.to_string()),
            selected: options.selected.and_then(|(run, selected)| {
                SelectedData::new(run, selected, &request.runs.get(run)?.timeline().setting)
            }),
            layers: shown_layers(request.runs)
                .map(|layer| LayerData {
                    name: layer.name(),
                    key: layer.key().to_string(),
                    is_on: options.layers.contains(layer),
                })
                .collect(),
            legend: legend_entries(request.runs, USUAL_SIDE).into_iter().map(legend_data).collect(),
            search_styles: STYLES
                .iter()
                .map(|style| SearchStyleData {
                    layer: style.layer.name(),
                    colours: style.colours,
                    width: style.width,
                    opacity: style.opacity,
                    disc: style.disc,
                })
                .collect(),
            keys: BINDINGS
                .iter()
                .filter(|binding| !WINDOW_ONLY.contains(&binding.keys))
                .map(|binding| [binding.keys, binding.does])
                .collect(),
            zooms: [Camera::MIN_ZOOM, Camera::MAX_ZOOM],
            colours: colours(),
            state_names: BushStateKind::ALL.map(BushStateKind::name),
            state_colours: BushStateKind::ALL.map(|kind| hex(bush_colour(kind))),
            sprites: sprites(),
            runs: request.runs.iter().map(|run| RunData::new(run, scale)).collect(),
        }
    }
}

impl SelectedData {
    fn new(run: usize, selected: Selected, setting: &Setting) -> Option<Self> {
        let (bush, agent) = match selected {
            Selected::Bush(cell) => (Some(setting.bush_index(cell)?), None),
            Selected::Agent(id) => (None, Some(setting.agent_index(id)?)),
        };
        Some(Self { run, bush, agent })
    }
}

/// The layers that a page has of these runs: none of values, and of searches only where there are some.
fn shown_layers(runs: &[&RunView]) -> impl Iterator<Item = Layer> {
    let has_searches = runs.iter().any(|run| run.index().has_searches());
    let is_of_values = |layer: Layer| matches!(layer, Layer::Clearance | Layer::CostMap | Layer::Wavefront);
    let has_ground = runs.iter().any(|run| run.index().ground().is_some());
    Layer::all_of(has_ground).filter(move |&layer| !is_of_values(layer) && (has_searches || !layer.needs_searches()))
}

/// The pane of a page in an ordinary window, in pixels.
const USUAL_SIDE: f64 = 700.0;

fn legend_data(LegendEntry { sign, text }: LegendEntry) -> (&'static str, String, String) {
    let (kind, colour) = match sign {
        LegendSign::Line(0.0, _) => ("driven", String::new()),
        LegendSign::Line(dash, gap) => (if dash < gap { "reverse" } else { "planned" }, String::new()),
        LegendSign::Cell(colour) => ("cell", hex(colour)),
        LegendSign::Cluster(role) => (role.name(), String::new()),
        LegendSign::Ground(colour) => ("cell cover", hex(colour)),
        LegendSign::Glow => ("glow", String::new()),
    };
    (kind, colour, text)
}

fn colours() -> BTreeMap<&'static str, String> {
    let colours = [
        ("border", BORDER),
        ("burning", BURNING),
        ("extinguished", EXTINGUISHED),
        ("faint", FAINT_INK),
        ("field", FIELD),
        ("ink", INK),
        ("outside", OUTSIDE),
        ("paper", PAPER),
        ("unimog", UNIMOG),
        ("water", WATER),
        ("wumpus", WUMPUS),
    ];
    colours.into_iter().map(|(name, colour)| (name, hex(colour))).collect()
}

fn sprites() -> BTreeMap<&'static str, Vec<(String, f32, f32, String)>> {
    let sprites: [(&str, &Sprite); 8] = [
        ("burned", &BURNED_SPRITE),
        ("bush", &BUSH_SPRITE),
        ("embers", &EMBERS_SPRITE),
        ("flame", &FLAME_SPRITE),
        ("unimog", &UNIMOG_SPRITE),
        ("wet", &WET_SPRITE),
        ("wheel", &WHEEL_SPRITE),
        ("wumpus", &WUMPUS_SPRITE),
    ];
    sprites.into_iter().map(|(name, sprite)| (name, shapes(sprite))).collect()
}

fn shapes(sprite: &Sprite) -> Vec<(String, f32, f32, String)> {
    let shapes = sprite.shapes_as_svg();
    shapes.map(|SvgShape { path, ink, width }| (hex(ink.colour), ink.opacity, width.unwrap_or(0.0), path)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::ViewOptions;
    use wildfire_base::time::SimTime;
    use wildfire_timeline::sample;

    fn page_of(title: &str) -> String {
        let run = RunView::new(sample::random(3, SimTime::from_seconds(300.0)), None).with_title(title.into());
        page(&FrameRequest { runs: &[&run], time: SimTime::ZERO, options: &ViewOptions::default() })
    }

    #[test]
    fn a_name_is_text_and_nothing_else() {
        let tags = |page: &str| page.matches('<').count();
        let page = page_of("</script><b>\"'@DATA@ &amp;");
        assert_eq!(tags(&page), tags(&page_of("plain")));
        assert!(page.contains("&lt;/script&gt;&lt;b&gt;"), "the title shows the name");
    }

    #[test]
    fn a_page_names_no_other_file_and_no_network() {
        let page = page_of("plain");
        for word in [
            "http:",
            "https:",
            "src=",
            "@import",
            "url(",
            "fetch(",
            "XMLHttpRequest",
            "@TITLE@",
            "@STYLE@",
            "@SCRIPT@",
            "@DATA@",
            "@COVER@",
            "@MODULE@",
        ] {
            assert!(!page.contains(word), "{word}");
        }
        assert!(page.contains("default-src 'none'"));
    }

    #[test]
    fn the_same_run_gives_the_same_page() {
        assert_eq!(page_of("a"), page_of("a"));
    }
}
