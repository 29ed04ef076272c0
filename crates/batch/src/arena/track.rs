//! The frozen tracks.

use std::path::{Path, PathBuf};

use super::row::whole_hash;
use super::{ArenaError, ArenaRow};
use crate::comparison::{Metric, MetricKind};
use crate::plan::{BatchPlan, Course, CourseRequest, EntryFile, Seeds};
use crate::table::Better;
use wildfire_scenario::ScenarioText;

/// The version of the tracks; tracks of another version are others, whatever their names.
pub const ARENA_VERSION: &str = "1.0";

/// What a run of a track is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackKind {
    /// A query: the field of a seed, and a drive to one random pose.
    Drive,
    /// A run of the scenario.
    Run,
}

/// A track: a course that never changes.
#[derive(Debug)]
pub struct Track {
    pub name: &'static str,
    pub kind: TrackKind,
    /// The name of the metric of a row's score.
    metric: &'static str,
    /// The side of the better scores from where the entry stands.
    pub better: Better,
    /// Whether the worst condition decides, rather than the mean over all.
    pub worst_decides: bool,
    /// Columns whose sum is the effort of a run.
    pub(super) effort: &'static [&'static str],
    /// One page in Markdown: what it measures, what decides, what it does not measure.
    pub readme: &'static str,
    pub rules: &'static str,
    pub scenario: &'static str,
    /// The public seeds.
    pub seeds: &'static str,
    /// The seeds that were hidden while the season ran, and the hash of that file, which was published before it began.
    pub hidden: &'static str,
    pub hidden_sha256: &'static str,
    golden: &'static str,
    /// The reference entries: the name of a file, and its text.
    references: [(&'static str, &'static str); 2],
}

const BY_TRUCKS: &[&str] = &["truck_roadmap_expansions", "truck_local_expansions"];
const BY_WUMPUSES: &[&str] = &["wumpus_expansions"];

macro_rules! track {
    ($name:literal, $kind:ident, $metric:literal, $better:ident, $worst_decides:literal, $effort:expr,
     [$first:literal, $second:literal]) => {
        Track {
            name: $name,
            kind: TrackKind::$kind,
            metric: $metric,
            better: Better::$better,
            worst_decides: $worst_decides,
            effort: $effort,
            readme: include_str!(concat!("../../arena/1.0/", $name, "/README.md")),
            rules: include_str!(concat!("../../arena/1.0/", $name, "/rules.toml")),
            scenario: include_str!(concat!("../../arena/1.0/", $name, "/scenario.toml")),
            seeds: include_str!(concat!("../../arena/1.0/", $name, "/seeds.txt")),
            hidden: include_str!(concat!("../../arena/1.0/", $name, "/hidden.txt")),
            hidden_sha256: include_str!(concat!("../../arena/1.0/", $name, "/hidden.sha256")),
            golden: include_str!(concat!("../../arena/1.0/", $name, "/golden.csv")),
            references: [
                ($first, include_str!(concat!("../../arena/1.0/", $name, "/", $first))),
                ($second, include_str!(concat!("../../arena/1.0/", $name, "/", $second))),
            ],
        }
    };
}

pub static TRACKS: [Track; 6] = [
    track!("drive", Drive, "path_efficiency", Higher, false, &[], ["hybrid-astar.toml", "prm-rs.toml"]),
    track!("contest", Run, "saved", Higher, false, BY_TRUCKS, ["hybrid-astar.toml", "prm-rs.toml"]),
    track!("arsonist", Run, "burned", Higher, true, BY_WUMPUSES, ["densest.toml", "random.toml"]),
    track!("dispatch", Run, "burned", Lower, false, BY_TRUCKS, ["auction.toml", "nearest.toml"]),
    track!("landscape", Run, "burned_ha", Lower, false, BY_TRUCKS, ["threat-first.toml", "nearest.toml"]),
    track!("fleet", Run, "burned", Lower, false, BY_TRUCKS, ["auction.toml", "nearest.toml"]),
];

impl Track {
    /// Finds a track by its name.
    ///
    /// # Errors
    /// If there is none.
    pub fn named(name: &str) -> Result<&'static Self, ArenaError> {
        let found = TRACKS.iter().find(|track| track.name == name);
        found.ok_or_else(|| ArenaError::NoTrack { name: wildfire_base::untrusted::visible_start(name) })
    }

    /// Returns the name of a folder or file of it, as messages show it.
    pub fn path(&self, file: &str) -> String {
        format!("arena/{ARENA_VERSION}/{}/{file}", self.name)
    }

    /// The files of its folder, by name.
    pub fn files(&self) -> [(&'static str, &'static str); 9] {
        let [first, second] = self.references;
        [
            first,
            second,
            ("README.md", self.readme),
            ("rules.toml", self.rules),
            ("scenario.toml", self.scenario),
            ("seeds.txt", self.seeds),
            ("hidden.txt", self.hidden),
            ("hidden.sha256", self.hidden_sha256),
            ("golden.csv", self.golden),
        ]
    }

    /// The metric of a row's score.
    pub fn metric(&self) -> Metric {
        match self.kind {
            TrackKind::Run => Metric::from_name(self.metric),
            TrackKind::Drive => Metric::unknown(self.metric.to_owned(), MetricKind::Unknown),
        }
    }

    /// The rules, read as those of a course.
    pub(crate) fn course(&self) -> Course {
        let path = self.path("rules.toml");
        let base = ScenarioText::from_bytes(&self.path("scenario.toml"), Ok(self.scenario.as_bytes().to_vec()));
        let course = Course::from_text(Path::new(&path), self.rules, Some(base.expect("it is text")));
        course.unwrap_or_else(|error| panic!("the rules of a frozen track are right: {error}"))
    }

    /// The names of the conditions under which each entry plays each seed; one empty name if there is only one.
    pub fn conditions(&self) -> Vec<String> {
        self.course().conditions.into_iter().map(|condition| condition.name).collect()
    }

    pub fn public_seeds(&self) -> Seeds {
        Seeds::from_file_text(self.seeds).expect("the seeds of a frozen track are right")
    }

    /// SHA-256 of the list of hidden seeds.
    pub fn hidden_hash(&self) -> &str {
        self.hidden_sha256.split_whitespace().next().unwrap_or_default()
    }

    /// Says whether a text of seeds is it is that to which the track committed itself.
    pub fn is_hidden_list(&self, text: &str) -> bool {
        self.hidden_hash() == whole_hash(text)
    }

    /// The runs of the reference entries.
    ///
    /// # Errors
    /// If this program refuses them, which it must not.
    pub fn golden_plan(&self, seeds: Seeds) -> Result<BatchPlan, ArenaError> {
        let entries = self.references.iter().map(|(file, _)| PathBuf::from(self.path(file))).collect();
        let request = CourseRequest { entries, seeds: Some(seeds), ..CourseRequest::default() };
        let read = |path: &Path| {
            let found = self.references.iter().find(|(file, _)| path.ends_with(file));
            EntryFile::from_text(path, found.expect("it is one of them").1)
        };
        Ok(request.resolve_by(&self.course(), &read, true)?.plan)
    }

    /// What the reference entries did when the track was frozen.
    pub fn golden(&self) -> Vec<ArenaRow> {
        let path = self.path("golden.csv");
        ArenaRow::read(Path::new(&path), self.golden.as_bytes()).expect("the golden rows of a frozen track are right")
    }
}
