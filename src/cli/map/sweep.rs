//! Descents of several potential fields on one map: a table of how each ended, and a sheet of small maps.

use std::io;
use std::path::Path;
use std::time::Duration;

use serde::{Serialize, Serializer};

use crate::cli::error::CliError;
use crate::cli::map::commands::{Computation, MapQuery};
use crate::cli::map::computed::{Computed, MapInputError, MapWalk, WalkResult};
use crate::cli::map::fields::{DescendArguments, descent_with};
use crate::cli::map::report::{MapReport, size};
use wildfire_base::document::number::{count, rounded, short};
use wildfire_base::document::{Block, Document, Table};
use wildfire_base::object;
use wildfire_base::whole_file::write_whole;
use wildfire_batch::plan::PROGRAM_VERSION;
use wildfire_grid::Place;
use wildfire_grid::map_files::MapFile;
use wildfire_picture::{MapScene, MapSheet, Picture, SheetPanel, draw_map_sheet};

/// The descent of one field.
struct SweptDescent {
    q: f64,
    eta: f64,
    computed: Computed,
}

/// The descents of all fields of a command.
pub struct DescentSweep<'a> {
    computation: &'a Computation,
    query: &'a MapQuery<DescendArguments>,
    map: &'a MapFile,
    descents: Vec<SweptDescent>,
    cpu_read: Duration,
}

/// Returns the query of a command that asks for several fields.
pub fn swept_query(computation: &Computation) -> Option<&MapQuery<DescendArguments>> {
    let Computation::Descend(query) = computation else { return None };
    (query.parameters.laws().len() > 1).then_some(query)
}

/// Refuses files that only a single descent has.
pub fn check_outputs(query: &MapQuery<DescendArguments>) -> Result<(), CliError> {
    let output = &query.files.output;
    let unfit = [
        (output.npy.is_some(), "--npy"),
        (output.overlay.is_some(), "--overlay"),
        (output.surface.is_some(), "--surface"),
        (output.path.is_some(), "--path"),
        (output.values, "--values"),
    ];
    let unfit = unfit.into_iter().find(|(is_requested, _)| *is_requested);
    unfit.map_or(Ok(()), |(_, option)| {
        let sentence = format!("{option} is for a single descent; expected one value of --q and one of --eta with it");
        Err(CliError::bad_input(sentence, Some("several values give a table (--csv) and a sheet of maps (--png)")))
    })
}

impl<'a> DescentSweep<'a> {
    /// Descends every field.
    pub fn new(
        computation: &'a Computation,
        query: &'a MapQuery<DescendArguments>,
        map: &'a MapFile,
        cpu_read: Duration,
    ) -> Result<Self, MapInputError> {
        let mut descents = Vec::new();
        for law in query.parameters.laws() {
            let computed = descent_with(&map.occupied, &query.parameters, &law)?;
            descents.push(SweptDescent { q: law.q, eta: law.eta, computed });
        }
        Ok(Self { computation, query, map, descents, cpu_read })
    }

    /// Reports the first descent, whose map and options are those of all.
    fn first(&self) -> MapReport<'_> {
        MapReport::new(self.computation, self.map, &self.descents[0].computed, self.cpu_read)
    }

    /// Lists notes on the map and the question.
    pub fn sentences(&self) -> Vec<String> {
        self.first().map_sentences()
    }

    fn table(&self) -> Table {
        let rows = self.descents.iter().map(SweptDescent::cells).collect();
        Table { text_columns: 3, ..Table::new(&["Q", "eta", "Answer", "Steps", "Length", "Local minimum"], rows) }
    }

    /// Writes the table as CSV.
    pub fn write_csv(&self, path: &Path) -> io::Result<()> {
        let mut text = "q,eta,answer,steps,length,minimum_row,minimum_col\n".to_owned();
        for descent in &self.descents {
            let minimum = descent.walk().path.minimum.map(|(row, col)| format!("{row},{col}"));
            let minimum = minimum.unwrap_or_else(|| ",".to_owned());
            let [q, eta, answer, steps, length, _] = descent.cells().try_into().expect("six cells");
            text += &format!("{q},{eta},{answer},{steps},{length},{minimum}\n");
        }
        write_whole(path, text.as_bytes())
    }

    /// Draws a small map of each descent, a row for each Q.
    pub fn draw(&self) -> Picture {
        let report = self.first();
        let values: Vec<_> = self
            .descents
            .iter()
            .map(|descent| |place: Place| Some(descent.computed.values.at(place).as_f64()))
            .collect();
        let captions: Vec<String> = self.descents.iter().map(SweptDescent::caption).collect();
        let panels = self.descents.iter().zip(&values).zip(&captions).map(|((descent, value), caption)| {
            let walk = descent.walk();
            let scene = MapScene {
                path: &walk.path.cells,
                start: Some(walk.start),
                goal: Some(walk.goal),
                stuck: walk.path.minimum,
                colours: self.query.files.output.colormap.into(),
                ..MapScene::new("", descent.computed.value_name, &self.map.occupied, value)
            };
            SheetPanel { caption, scene }
        });
        let panels: Vec<SheetPanel> = panels.collect();
        // Each Q has a row: its panels differ in eta only, and are compared from left to right.
        let columns = self.query.parameters.field.repulsion.repulsion.eta.0.len();
        let title = report.title();
        let subtitle = report.parameters();
        draw_map_sheet(&MapSheet { title: &title, subtitle: &subtitle, columns, panels: &panels })
    }
}

impl SweptDescent {
    fn walk(&self) -> &MapWalk {
        self.computed.walk.as_ref().expect("a descent has a walk")
    }

    /// The cells of its row.
    fn cells(&self) -> Vec<String> {
        let path = &self.walk().path;
        let minimum = path.minimum.map_or_else(|| "-".to_owned(), |(row, col)| format!("row {row}, column {col}"));
        let steps = path.cells.len().saturating_sub(1).to_string();
        let answer = path.answer.name().to_owned();
        vec![short(self.q), short(self.eta), answer, steps, rounded(path.length, 3), minimum]
    }

    fn caption(&self) -> String {
        format!("Q {}, eta {}: {}", short(self.q), short(self.eta), self.walk().path.answer.name())
    }
}

impl Serialize for DescentSweep<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let report = self.first();
        let descents = self.descents.iter().map(|descent| {
            let path = &descent.walk().path;
            object!(Descent {
                q: descent.q,
                eta: descent.eta,
                maximum: descent.computed.values.max(),
                answer: path.answer,
                minimum: path.minimum,
                steps: path.cells.len().saturating_sub(1),
                length: path.length,
            })
        });
        let sweep = object!(Sweep {
            program_version: PROGRAM_VERSION,
            map: report.path.display().to_string(),
            rows: self.map.occupied.rows(),
            cols: self.map.occupied.cols(),
            occupied: report.occupied_cells,
            // `command` and `parameters`.
            #[serde(flatten)]
            computation: self.computation,
            descents: descents.collect::<Vec<_>>(),
            notes: report.map_sentences(),
        });
        sweep.serialize(serializer)
    }
}

impl From<&DescentSweep<'_>> for Document {
    fn from(sweep: &DescentSweep) -> Self {
        let report = sweep.first();
        let reached = sweep.descents.iter().filter(|descent| descent.walk().path.answer == WalkResult::Reached).count();
        let mut lines = report.map_sentences();
        lines.push(format!("{reached} of {} reached the goal.", count(sweep.descents.len(), "descent")));
        Self::new(size(&report)).with([Block::Table(sweep.table()), Block::List(lines)])
    }
}
