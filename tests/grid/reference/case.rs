//! A case: a map, a start, a goal, and a folder of answers.

use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};

use flate2::read::GzDecoder;
use serde_json::Value;
use tempfile::TempDir;
use wildfire::grid::{BadPlace, Grid, Place, occupancy};
use wildfire::map_files;

use super::answers::{self, Answer};
use super::compare::{self, Tally};

pub struct Case {
    folder: PathBuf,
    /// Where compressed files are unpacked to.
    scratch: TempDir,
    pub facts: Value,
    pub occupied: Grid<bool>,
    /// What the cost maps are of: the picture where there is one, read with the tolerance of 50.
    pub occupied_for_cost: Grid<bool>,
    pub start: Place,
    pub goal: Place,
}

impl Case {
    pub fn read(folder: &Path) -> Self {
        let facts = fs::read_to_string(folder.join("case.json")).expect("every case has facts");
        let facts: Value = serde_json::from_str(&facts).expect("the facts are JSON");
        let place = |name: &str| {
            let number = |index: usize| facts[name][index].as_u64().expect("places are two numbers") as usize;
            (number(0), number(1))
        };
        let mut case = Self {
            folder: folder.to_owned(),
            scratch: tempfile::tempdir().expect("there is room for temporary files"),
            start: place("start"),
            goal: place("goal"),
            occupied: Grid::filled(0, 0, false),
            occupied_for_cost: Grid::filled(0, 0, false),
            facts,
        };
        case.occupied = case.read_map("map.txt").expect("every case has a map").occupied;
        let picture = ["grey.png", "grey.pgm"].into_iter().find_map(|name| case.read_map(name));
        case.occupied_for_cost = picture.map_or_else(|| case.occupied.clone(), |picture| picture.occupied);
        case
    }

    pub fn name(&self) -> String {
        self.folder.file_name().expect("cases have names").to_string_lossy().into_owned()
    }

    /// Why the goal is refused, if it is.
    pub fn refusal(&self) -> Option<BadPlace> {
        self.occupied[self.goal].then_some(BadPlace::Occupied { place: self.goal })
    }

    /// Names of the files without the suffix of compression.
    fn file_names(&self) -> BTreeSet<String> {
        let paths = super::entries(&self.folder);
        let name = |path: &PathBuf| path.file_name().expect("files have names").to_string_lossy().into_owned();
        paths.iter().map(|path| name(path).trim_end_matches(".gz").to_owned()).collect()
    }

    /// A file's path, unpacked if need be.
    fn unpacked(&self, name: &str) -> Option<PathBuf> {
        let plain = self.folder.join(name);
        if plain.exists() {
            return Some(plain);
        }
        let mut packed = GzDecoder::new(fs::File::open(self.folder.join(format!("{name}.gz"))).ok()?);
        let mut content = Vec::new();
        packed.read_to_end(&mut content).expect("the file is whole");
        let path = self.scratch.path().join(name);
        fs::write(&path, content).expect("there is room for temporary files");
        Some(path)
    }

    fn read_map(&self, name: &str) -> Option<map_files::MapFile> {
        let path = self.unpacked(name)?;
        Some(map_files::read(&path, 50).expect("the map is readable"))
    }

    pub fn text(&self, name: &str) -> String {
        let path = self.unpacked(name).expect("the file was listed");
        fs::read_to_string(path).expect("answers are text")
    }

    /// Compares every file of the folder.
    ///
    /// The one exception is the output of the cost map report's own program, whose bugs are not for reproduction.
    pub fn compare(&self, tally: &mut Tally) {
        for name in self.file_names() {
            let place = format!("{}/{name}", self.name());
            match name.as_str() {
                "cost_jenkins_raw.csv" => tally.excepted += 1,
                "case.json" => {
                    answers::compare_facts(self);
                    tally.compared += 1;
                }
                "map.txt" => {
                    let occupied = self.occupied.values().iter().filter(|&&is_occupied| is_occupied).count();
                    assert_eq!(self.facts["occupied"], occupied, "{place}");
                    tally.compared += 1;
                }
                "grey.pgm" | "grey.png" => {
                    self.compare_picture(&name);
                    tally.compared += 1;
                }
                _ => match answers::answer(self, &name).unwrap_or_else(|| panic!("{place}: an unknown file")) {
                    Answer::Refused => tally.refused += 1,
                    answer => {
                        compare::with_file(&place, &answer, &self.text(&name), &self.facts["files"][&name]);
                        tally.compared += 1;
                    }
                },
            }
        }
    }

    /// The cases' maps count a grey of exactly 50 as free, which is our tolerance of 49.
    fn compare_picture(&self, name: &str) {
        let grey = self.read_map(name).and_then(|picture| picture.grey).expect("pictures are grey");
        assert_eq!(occupancy::from_grey(&grey, 49), self.occupied, "{}/{name}", self.name());
        assert_eq!(occupancy::from_grey(&grey, 50), self.occupied_for_cost, "{}/{name}", self.name());
    }
}
