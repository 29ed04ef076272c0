//! A board: a folder with entries, a file of rows for each track, and what follows from them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use serde::{Serialize, Serializer};

use super::card::data_card;
use super::entry::class_of;
use super::row::MAX_BYTES;
use super::{ARENA_VERSION, ArenaEntry, ArenaError, ArenaRow, Class, TRACKS, Track, rows_hash};
use crate::comparison::{RankBasis, RankInput, RankedEntry, Ranking, RunKey, SampleSize, ranked};
use crate::plan::{COMMIT, EntryCard, PROGRAM_VERSION, Seeds};
use crate::stats::{Interval, Series};
use crate::table::Better;
use wildfire_base::document::Document;
use wildfire_base::input_file;
use wildfire_base::object;
use wildfire_base::untrusted::visible;
use wildfire_base::whole_file::write_whole;

/// The folder of a board that holds its entries.
const ENTRIES_FOLDER: &str = "entries";

/// The data card of a board.
const CARD_FILE: &str = "croissant.json";

/// Values of published files that tell who ranked, which nobody can compute again.
const OF_THE_PROGRAM: [&str; 3] = ["\"program_version\": ", "\"commit\": ", "\"citeAs\": "];

/// A folder with entries and their rows.
#[derive(Clone, Debug)]
pub struct Board {
    folder: PathBuf,
}

/// The ranks of a track's entries.
#[derive(Debug)]
pub struct TrackBoard {
    pub track: &'static Track,
    /// The mean score of each entry, its ranks, and its differences from all others.
    pub ranking: Ranking,
    /// In the order of the ranking.
    pub entries: Vec<BoardEntry>,
    /// The difference of two entries at which the interval of their difference just leaves 0, the median over all pairs of
    /// neighbours; `None` of one entry.
    pub noise_floor: Option<f64>,
}

/// An entry of a board.
#[derive(Debug)]
pub struct BoardEntry {
    pub card: EntryCard,
    pub class: Class,
    /// Mean score under each condition, with its interval.
    pub by_condition: Vec<(String, f64, Option<Interval>)>,
    /// The interval of what decides.
    pub interval: Option<Interval>,
    /// The place of the worst condition.
    pub worst: usize,
    /// Mean over all runs.
    pub effort: f64,
    pub entry_hash: String,
    pub rows_hash: String,
}

impl Board {
    pub fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    fn file(&self, track: &Track, ending: &str) -> PathBuf {
        self.folder.join(format!("{}.{ending}", track.name))
    }

    /// Returns the rows of a track; none if nobody has played it.
    ///
    /// # Errors
    /// If the file is no file of rows, with the line.
    pub fn rows(&self, track: &Track) -> Result<Vec<ArenaRow>, ArenaError> {
        let path = self.file(track, "csv");
        match input_file::read(&path, MAX_BYTES).and_then(input_file::utf8) {
            Ok(bytes) => ArenaRow::read(&path, &bytes[..]),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(Vec::new()),
            Err(source) => Err(ArenaError::Unreadable { path, source }),
        }
    }

    /// Returns the rows of a track if each entry has those of all seeds that everybody has, or of all hidden ones. Who may
    /// choose the seeds of a board chooses its order.
    ///
    /// # Errors
    /// As [`Self::rows`], and if an entry has rows of other seeds.
    pub fn whole_rows(&self, track: &Track) -> Result<Vec<ArenaRow>, ArenaError> {
        let rows = self.rows(track)?;
        let mut by_entry: BTreeMap<&str, BTreeSet<(&str, u64)>> = BTreeMap::new();
        rows.iter().for_each(|row| _ = by_entry.entry(&row.entry).or_default().insert((&row.condition, row.seed)));
        let conditions = track.conditions();
        let hidden = Seeds::from_file_text(track.hidden).expect("the seeds of a frozen track are right");
        let lists = [track.public_seeds(), hidden].map(|seeds| {
            let runs = seeds.iter().flat_map(|seed| conditions.iter().map(move |name| (name.as_str(), seed)));
            runs.collect::<BTreeSet<(&str, u64)>>()
        });
        // File systems of macOS and Windows ignore case, so the files of one of the two entries would overwrite the other's.
        if let Some([one, other]) = same_but_for_case(by_entry.keys().copied()) {
            return Err(ArenaError::Wrong { path: self.file(track, "csv"), message: one_folder(one, other) });
        }
        let Some((name, runs)) = by_entry.iter().find(|(_, runs)| !lists.contains(runs)) else { return Ok(rows) };
        // A foreign seed is reported first: a count alone would not show that somebody chose the seeds.
        let strange = runs.iter().find(|run| !lists.iter().any(|list| list.contains(*run)));
        let message = match strange {
            Some((_, seed)) => format!("{name} has a row of seed {seed}, which the track does not have"),
            None => format!(
                "{name} has rows of {} runs; expected the {} of the track's seeds, or the {} of its hidden ones",
                runs.len(),
                lists[0].len(),
                lists[1].len()
            ),
        };
        Err(ArenaError::Wrong { path: self.file(track, "csv"), message })
    }

    /// Checks that entries, and those that the board has, have names that differ in more than upper and lower case: some
    /// file systems have one folder for both.
    ///
    /// # Errors
    /// With two names that do not.
    pub fn expect_distinct(&self, entries: &[ArenaEntry]) -> Result<(), ArenaError> {
        let path = self.folder.join(ENTRIES_FOLDER);
        let folders = fs::read_dir(&path).into_iter().flatten().flatten();
        let there: Vec<String> = folders.map(|found| found.file_name().to_string_lossy().into_owned()).collect();
        let names = there.iter().map(String::as_str).chain(entries.iter().map(|entry| &entry.card.name[..]));
        match same_but_for_case(names) {
            Some([one, other]) => Err(ArenaError::Wrong { path, message: one_folder(one, other) }),
            None => Ok(()),
        }
    }

    /// Takes an entry's rows on a track in the place of those that it had, and a copy of its files.
    ///
    /// # Errors
    /// If the folder cannot be written, or another entry has this name.
    pub fn add(&self, entry: &ArenaEntry, track: &Track, rows: Vec<ArenaRow>) -> Result<(), ArenaError> {
        let name = &entry.card.name;
        let mut all = self.rows(track)?;
        all.retain(|row| row.entry != *name);
        all.extend(rows);
        all.sort_by(ArenaRow::cmp_run);
        let copy = self.folder.join(ENTRIES_FOLDER).join(name);
        let files = [(self.file(track, "csv"), ArenaRow::write(&all))];
        self.copy(entry, &copy).map_err(|source| ArenaError::Unreadable { path: copy.clone(), source })?;
        write(&files)
    }

    fn copy(&self, entry: &ArenaEntry, copy: &Path) -> io::Result<()> {
        if copy.is_dir() && fs::canonicalize(copy)? == fs::canonicalize(entry.folder())? {
            return Ok(());
        }
        for file in &entry.files {
            let to = copy.join(file);
            fs::create_dir_all(to.parent().expect("it is below the copy"))?;
            fs::copy(entry.folder().join(file), to)?;
        }
        Ok(())
    }

    /// Reads the entry of this name.
    ///
    /// # Errors
    /// If the board has rows of it and no files.
    pub fn entry(&self, name: &str) -> Result<ArenaEntry, ArenaError> {
        ArenaEntry::read(&self.folder.join(ENTRIES_FOLDER).join(name).join(crate::plan::ENTRY_FILE))
    }

    /// Ranks the entries of a track; `None` if it has none.
    ///
    /// # Errors
    /// If rows are missing, twice there, or of an entry whose files are not there.
    pub fn ranked(&self, track: &'static Track) -> Result<Option<TrackBoard>, ArenaError> {
        let rows = self.whole_rows(track)?;
        let mut by_entry: BTreeMap<&str, Vec<&ArenaRow>> = BTreeMap::new();
        rows.iter().for_each(|row| by_entry.entry(&row.entry).or_default().push(row));
        if by_entry.is_empty() {
            return Ok(None);
        }
        self.expect_same_runs(track, &by_entry)?;
        let worst_score = worst_score(track, by_entry.values().flatten().copied());
        let mut found = Vec::new();
        for (name, rows) in &mut by_entry {
            // `chunk_by` in `BoardEntry::new` joins neighbours only, and two entries are paired row by row.
            rows.sort_by(|one, other| (one.seed, &one.condition).cmp(&(other.seed, &other.condition)));
            let entry = self.entry(name)?;
            // A class depends on the programs that an entry names, not on seeds.
            let plan = ArenaEntry::plan(std::slice::from_ref(&entry), track, Seeds::default())?;
            found.push((BoardEntry::new(track, &entry, class_of(&plan, name), rows, worst_score), &*rows));
        }
        Ok(Some(TrackBoard::new(track, found, worst_score)))
    }

    /// Every entry has each seed under each condition once.
    fn expect_same_runs(&self, track: &Track, rows: &BTreeMap<&str, Vec<&ArenaRow>>) -> Result<(), ArenaError> {
        let keys =
            |rows: &[&ArenaRow]| rows.iter().map(|row| (row.seed, row.condition.clone())).collect::<BTreeSet<_>>();
        let mut first: Option<(&str, BTreeSet<(u64, String)>)> = None;
        for (name, rows) in rows {
            let found = keys(rows);
            let wrong = |message: String| ArenaError::Wrong { path: self.file(track, "csv"), message };
            if found.len() != rows.len() {
                return Err(wrong(format!("{name} has two rows of one run; expected one")));
            }
            // Equality is transitive, so comparing all entries with the first one is enough.
            let (before, expected) = first.get_or_insert_with(|| (name, found.clone()));
            if found != *expected {
                return Err(wrong(format!(
                    "{before} and {name} did not play the same seeds: {} and {} runs; `wildfire arena run` plays those \
                     of an entry again",
                    expected.len(),
                    found.len()
                )));
            }
        }
        Ok(())
    }

    /// Writes what follows from the rows: `TRACK.json`, `TRACK.md` and `TRACK.html`.
    ///
    /// # Errors
    /// If they cannot be written.
    pub fn publish(&self, board: &TrackBoard) -> Result<(), ArenaError> {
        write(&self.published(board))
    }

    fn published(&self, board: &TrackBoard) -> [(PathBuf, String); 3] {
        let document = Document::from(board);
        let json = serde_json::to_string_pretty(board).expect("names, numbers and words are JSON") + "\n";
        let file = |ending| self.file(board.track, ending);
        [(file("json"), json), (file("md"), document.to_markdown()), (file("html"), document.to_html())]
    }

    /// Ranks tracks again, and says where published files differ from what follows from the rows: a sentence for each file.
    ///
    /// # Errors
    /// As [`Self::ranked`].
    pub fn ranking_differences(&self, tracks: &[&'static Track]) -> Result<Vec<String>, ArenaError> {
        let mut differences = Vec::new();
        for track in tracks {
            let expected = match self.ranked(track)? {
                Some(board) => self.published(&board),
                None => ["json", "md", "html"].map(|ending| (self.file(track, ending), String::new())),
            };
            differences.extend(expected.iter().filter_map(difference_of_file));
        }
        differences.extend(difference_of_file(&self.card()?));
        Ok(differences)
    }

    /// Writes `croissant.json`, the data card of all its files of rows.
    ///
    /// # Errors
    /// If it cannot be written, or rows cannot be read.
    pub fn publish_card(&self) -> Result<(), ArenaError> {
        write(&[self.card()?])
    }

    fn card(&self) -> Result<(PathBuf, String), ArenaError> {
        let mut files = Vec::new();
        for track in &TRACKS {
            let rows = self.rows(track)?;
            files.extend((!rows.is_empty()).then(|| (track, ArenaRow::write(&rows))));
        }
        let card = serde_json::to_string_pretty(&data_card(&files)).expect("texts are JSON") + "\n";
        Ok((self.folder.join(CARD_FILE), card))
    }
}

/// Returns two names that are the same apart from upper and lower case.
fn same_but_for_case<'a>(names: impl Iterator<Item = &'a str>) -> Option<[&'a str; 2]> {
    let mut seen = BTreeMap::new();
    names.into_iter().find_map(|name| {
        let other = seen.insert(name.to_lowercase(), name)?;
        (other != name).then_some([other, name])
    })
}

fn one_folder(one: &str, other: &str) -> String {
    format!("the entries {one} and {other} have one folder on macOS and Windows; expected names that differ in letters")
}

/// Says where a published file differs from the text that follows from the rows; `None` if nowhere, or if there is no file.
fn difference_of_file((path, expected): &(PathBuf, String)) -> Option<String> {
    /// Characters of both that are shown, and those of them before the first that differs.
    const SHOWN: usize = 50;
    const BEFORE: usize = 20;
    let name = path.file_name().unwrap_or_default().display();
    let found = match input_file::read_text(path, MAX_BYTES) {
        Ok(found) => found,
        Err(error) if error.kind() == ErrorKind::NotFound => return None,
        Err(error) => return Some(format!("{name}: {error}")),
    };
    let found = lines_of(&found);
    let expected = lines_of(expected);
    let place = (0..found.len().max(expected.len())).find(|&place| match (found.get(place), expected.get(place)) {
        (Some(found), Some(expected)) => {
            // Git may check files out with CRLF, and a later version of the program publishes its own name and commit.
            found.trim_end_matches('\r') != expected && !(is_of_program(found) && is_of_program(expected))
        }
        // One of the two ends before the other.
        _ => true,
    })?;
    let line = |lines: &[String]| lines.get(place).cloned().unwrap_or_default();
    let found = line(&found);
    let expected = line(&expected);
    let same = found.chars().zip(expected.chars()).take_while(|(one, other)| one == other).count();
    let shown = |line: &str| {
        // Text before the difference shows where in a long line of JSON it is.
        visible(&line.chars().skip(same.saturating_sub(BEFORE)).take(SHOWN).collect::<String>()).into_owned()
    };
    Some(format!("{name}, line {}: `{}`; the rows give `{}`", place + 1, shown(&found), shown(&expected)))
}

fn lines_of(text: &str) -> Vec<String> {
    text.split('\n').map(str::to_owned).collect::<Vec<_>>()
}

fn is_of_program(line: &str) -> bool {
    OF_THE_PROGRAM.iter().any(|start| line.trim_start().starts_with(start))
}

fn write(files: &[(PathBuf, String)]) -> Result<(), ArenaError> {
    for (path, text) in files {
        write_whole(path, text.as_bytes()).map_err(|source| ArenaError::Unreadable { path: path.clone(), source })?;
    }
    Ok(())
}

/// The worst score of all entries of a track, which is that of a run without one: where lower is better, 0 would win.
fn worst_score<'a>(track: &Track, rows: impl Iterator<Item = &'a ArenaRow>) -> f64 {
    let scores = rows.filter_map(|row| row.score);
    match track.better {
        Better::Higher => scores.fold(0.0, f64::min),
        Better::Lower => scores.fold(0.0, f64::max),
    }
}

impl BoardEntry {
    /// `rows` are in the order of their seeds and conditions; those without a score count as the worst one.
    fn new(track: &Track, entry: &ArenaEntry, class: Class, rows: &[&ArenaRow], worst_score: f64) -> Self {
        let mut by_condition: BTreeMap<&str, Series> = BTreeMap::new();
        let mut effort = Series::default();
        for row in rows {
            by_condition.entry(&row.condition).or_default().add(row.score.unwrap_or(worst_score));
            effort.add(row.effort as f64);
        }
        let by_condition: Vec<_> = by_condition
            .into_iter()
            .map(|(name, scores)| (name.to_owned(), scores.mean().unwrap_or(f64::NAN), scores.mean_interval()))
            .collect();
        // The arguments are exchanged: the worst condition is the last one by goodness.
        let worst = (0..by_condition.len())
            .min_by(|one, other| {
                // Of conditions with equal means the first by name is the worst, whatever the order of the rows.
                track.better.best_first(by_condition[*other].1, by_condition[*one].1).then(one.cmp(other))
            })
            .unwrap_or(0);
        // The interval follows below, as the runs that decide depend on the worst condition.
        let mut found = Self {
            card: entry.card.clone(),
            class,
            worst,
            interval: None,
            effort: effort.mean().unwrap_or(0.0),
            entry_hash: entry.hash.clone(),
            rows_hash: rows_hash(rows.iter().copied()),
            by_condition,
        };
        let decisive = found.decisive(track, rows, worst_score);
        // Rows of one seed share its field and are not independent, so the interval is one of means by seed.
        let of_seeds = decisive.chunk_by(|one, next| one.0 == next.0);
        let means = of_seeds.map(|of_seed| of_seed.iter().map(|it| it.2).sum::<f64>() / of_seed.len() as f64);
        found.interval = Series::from_values(&means.collect::<Vec<f64>>()).mean_interval();
        found
    }

    /// The seed, the stratum and the score of each row that decides.
    fn decisive(&self, track: &Track, rows: &[&ArenaRow], worst_score: f64) -> Vec<(u64, usize, f64)> {
        let place =
            |row: &ArenaRow| self.by_condition.iter().position(|(name, ..)| *name == row.condition).unwrap_or(0);
        rows.iter()
            .filter(|row| !track.worst_decides || place(row) == self.worst)
            .map(|row| (row.seed, if track.worst_decides { 0 } else { place(row) }, row.score.unwrap_or(worst_score)))
            .collect()
    }
}

impl TrackBoard {
    fn new(track: &'static Track, found: Vec<(BoardEntry, &Vec<&ArenaRow>)>, worst_score: f64) -> Self {
        let metric = track.metric();
        let decisive: Vec<Vec<(u64, usize, f64)>> =
            found.iter().map(|(entry, rows)| entry.decisive(track, rows, worst_score)).collect();
        // All entries have the same runs in the same order, see `expect_same_runs`; the keys of the first are those of all.
        let runs: Vec<RunKey> = decisive[0].iter().map(|&(seed, stratum, _)| RunKey { seed, stratum }).collect();
        let strata = runs.iter().map(|run| run.stratum + 1).max().unwrap_or(1);
        let contenders = found.iter().zip(&decisive).map(|((entry, rows), decisive)| RankInput {
            entry: RankedEntry {
                name: entry.card.name.clone(),
                runs: rows.len(),
                failed: rows.iter().filter(|row| row.score.is_none()).count(),
                ..RankedEntry::default()
            },
            numbers: decisive.iter().map(|it| it.2).collect(),
        });
        // With one stratum there is nothing to average over, and the ranking needs no analysis by strata.
        let by = (strata > 1).then(|| crate::plan::CONDITION_COLUMN.to_owned());
        let basis = RankBasis { metric: &metric, better: track.better, counts: SampleSize::Fixed };
        let (entries, pairs) = ranked(contenders.collect(), &runs, by.clone(), basis);
        let seeds: BTreeSet<u64> = runs.iter().map(|run| run.seed).collect();
        let ranking = Ranking {
            better: track.better,
            runs: runs.len(),
            seeds: format!("{} of the track", seeds.len()),
            columns: by.into_iter().collect(),
            strata,
            worst: None,
            stop: None,
            entries,
            pairs,
            metric,
        };
        // What neighbours on the board can differ by without meaning: half the width of their interval.
        let mut widths: Vec<f64> = ranking
            .pairs
            .iter()
            .filter(|pair| pair.places[0] + 1 == pair.places[1])
            .filter_map(|pair| pair.contrast.interval)
            .map(|interval| 0.5 * (interval.high - interval.low))
            .collect();
        widths.sort_by(f64::total_cmp);
        // The median, as one pair with few runs must not decide.
        let noise_floor = widths.get(widths.len() / 2).copied();
        let mut entries: Vec<BoardEntry> = found.into_iter().map(|(entry, _)| entry).collect();
        // The ranking orders by what decides; the published table must list the entries in that order.
        entries.sort_by_key(|entry| ranking.entries.iter().position(|ranked| ranked.name == entry.card.name));
        Self { track, ranking, entries, noise_floor }
    }
}

impl Serialize for TrackBoard {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        object!(Board {
            arena: ARENA_VERSION,
            track: self.track.name,
            program_version: PROGRAM_VERSION,
            commit: COMMIT,
            metric: &self.ranking.metric.name,
            better: self.track.better.name(),
            decides: if self.track.worst_decides { "worst condition" } else { "mean" },
            runs: self.ranking.runs,
            noise_floor: self.noise_floor,
            entries: (0..self.entries.len()).map(|place| entry(self, place)).collect::<Vec<_>>(),
        })
        .serialize(serializer)
    }
}

fn entry(board: &TrackBoard, place: usize) -> impl Serialize {
    let entry = &board.entries[place];
    let ranked = &board.ranking.entries[place];
    let next = board.ranking.pair(place, place + 1).map(|pair| {
        object!(Next {
            difference: pair.contrast.difference,
            interval: pair.contrast.interval,
            p_adjusted: pair.p_adjusted,
            #[serde(rename = "told_apart")]
            significant: pair.is_significant,
        })
    });
    let conditions = entry.by_condition.iter();
    let by_condition = conditions
        .map(|(name, mean, interval)| object!(OfCondition { condition: name, mean: *mean, interval: *interval }));
    object!(Entry {
        entry: &entry.card.name,
        authors: &entry.card.authors,
        licence: &entry.card.licence,
        about: &entry.card.about,
        class: entry.class.name(),
        rank_from: ranked.ranks[0],
        rank_to: ranked.ranks[1],
        score: ranked.mean,
        interval: entry.interval,
        next_less_this: next,
        worst_condition: &entry.by_condition[entry.worst].0,
        by_condition: by_condition.collect::<Vec<_>>(),
        failed: ranked.failed,
        effort: entry.effort,
        rows_sha256: &entry.rows_hash,
        entry_sha256: &entry.entry_hash,
    })
}
