//! The ground of a run on a page: vegetation, burning and wet cells over time, fires lit by embers, the wind.

use std::collections::BTreeMap;

use serde::Serialize;

use super::data::{differences, hex};
use crate::Rgb;
use crate::colours::{EXTINGUISHED, blend};
use crate::film::RunView;
use crate::film::field::ground::{
    ArrivalLines, BURNED_OPACITY, CHAR, CellShades, EMBER, EMBERS, FLAMING, GLOWS_FOR_S, GroundView, LINE, LOST_LINE,
    OLD, OLD_AFTER_S, WET, WET_OPACITY, YOUNG, YOUNG_FOR_S,
};
use wildfire_base::time::SimTime;

/// A page has a number for each cell of ground, and a browser a pixel: more would be too much for either.
pub const MAX_GROUND_CELLS: usize = 2048 * 2048;

const NANOS_PER_MILLI: u64 = 1_000_000;
/// Parts of a cell in which lines are written.
const PER_CELL: f64 = 100.0;
/// Rows of colours of the bar of a scale.
const SHADES: u32 = 110;

/// The ground. Times are in whole milliseconds, rounded down.
#[derive(Serialize)]
pub struct GroundData {
    covers: CellColours,
    /// Cells of ground that can burn.
    cells: u32,
    burnings: BurningTable,
    wettings: WettingTable,
    spots: SpotTable,
    arrival: Vec<ArrivalData>,
    /// By the layer that shows them.
    shades: BTreeMap<&'static str, ShadesData>,
    wind: WindTable,
    /// When crews set out, in ascending order.
    crews_ms: Vec<u64>,
    line: LineTable,
    colours: FireColours,
}

/// A colour for each cell, by its place in a list of colours, or -1.
#[derive(Serialize)]
struct CellColours {
    colours: Vec<String>,
    cells: Vec<i64>,
}

/// When which cells of ground burn, by cell.
#[derive(Default, Serialize)]
struct BurningTable {
    cell: Vec<i64>,
    ignited_ms: Vec<i64>,
    /// How long it burns, or -1 forever.
    lasts_ms: Vec<i64>,
    is_put_out: Vec<u8>,
}

#[derive(Default, Serialize)]
struct WettingTable {
    cell: Vec<i64>,
    from_ms: Vec<i64>,
    lasts_ms: Vec<i64>,
}

/// Cells of line that crews have cleared, in order of time, and whether they hold.
#[derive(Default, Serialize)]
struct LineTable {
    cell: Vec<i64>,
    from_ms: Vec<i64>,
    holds: Vec<u8>,
}

/// What embers lit, in order of time.
#[derive(Default, Serialize)]
struct SpotTable {
    time_ms: Vec<i64>,
    /// In metres: of the cell, and where the ember came from.
    at_m: Vec<[f64; 2]>,
    from_m: Vec<[f64; 2]>,
}

/// Lines that the front reached at a time.
#[derive(Serialize)]
struct ArrivalData {
    time_s: f64,
    label: String,
    /// Places along each in parts of a cell, x and y in turn, each less that of the place before.
    lines: Vec<Vec<i64>>,
}

#[derive(Serialize)]
struct ShadesData {
    name: String,
    /// Colours of the bar from below.
    shades: Vec<String>,
    /// Labels, and where they are, as shares of the bar from below.
    ticks: Vec<(f64, String)>,
    cells: CellColours,
}

#[derive(Default, Serialize)]
struct WindTable {
    from_ms: Vec<i64>,
    /// In m/s, where the wind blows to.
    east: Vec<f64>,
    north: Vec<f64>,
}

/// The colours of fire on the ground by its age.
#[derive(Serialize)]
struct FireColours {
    young: Rgb,
    flaming: Rgb,
    old: Rgb,
    embers: Rgb,
    char: Rgb,
    put_out: Rgb,
    ember: Rgb,
    wet: Rgb,
    line: Rgb,
    lost_line: Rgb,
    wet_opacity: f32,
    burned_opacity: f64,
    young_for_s: f32,
    old_after_s: f32,
    glows_for_s: f32,
}

impl GroundData {
    /// `None` of a run in which only bushes burn.
    pub fn new(run: &RunView) -> Option<Self> {
        let view = GroundView::new(run)?;
        let index = run.index().ground()?;
        let setting = &run.timeline().setting;
        let frame = setting.frame;
        let mut burnings = BurningTable::default();
        for cell in 0..frame.cell_count() {
            for burning in index.burnings_of(frame.cell(cell)) {
                burnings.cell.push(cell as i64);
                burnings.ignited_ms.push(millis(burning.ignited));
                // Fires that nothing ends have no length, for which -1 stands.
                let is_endless = burning.ends == SimTime::MAX;
                burnings.lasts_ms.push(if is_endless { -1 } else { millis(burning.ends) - millis(burning.ignited) });
                burnings.is_put_out.push(burning.is_extinguished.into());
            }
        }
        burnings.cell = differences(burnings.cell);
        burnings.ignited_ms = differences(burnings.ignited_ms);
        let mut wettings = WettingTable::default();
        // Line is wet for good, and is in a table of its own.
        for wetting in index.wettings().iter().filter(|wetting| wetting.until < SimTime::MAX) {
            wettings.cell.push(frame.index(wetting.cell) as i64);
            wettings.from_ms.push(millis(wetting.from));
            wettings.lasts_ms.push(millis(wetting.until) - millis(wetting.from));
        }
        wettings.cell = differences(wettings.cell);
        wettings.from_ms = differences(wettings.from_ms);
        let mut line = LineTable::default();
        for built in index.line_cells() {
            line.cell.push(frame.index(built.cell) as i64);
            line.from_ms.push(millis(built.from));
            line.holds.push(built.holds.into());
        }
        line.from_ms = differences(line.from_ms);
        let mut spots = SpotTable::default();
        for &(time, at, from) in view.spotted() {
            spots.time_ms.push(millis(time));
            spots.at_m.push([at.x, at.y]);
            spots.from_m.push([from.x, from.y]);
        }
        spots.time_ms = differences(spots.time_ms);
        let mut wind = WindTable::default();
        for interval in setting.spread.as_ref()?.weather().intervals() {
            wind.from_ms.push(millis(interval.from));
            wind.east.push(interval.wind_mps.x);
            wind.north.push(interval.wind_mps.y);
        }
        let crews = setting.line.iter().flat_map(|line| &line.crews);
        let mut crews_ms: Vec<u64> = crews.map(|crew| crew.at_ns / NANOS_PER_MILLI).collect();
        crews_ms.sort_unstable();
        Some(Self {
            covers: CellColours::new(view.covers().iter().copied().map(Some)),
            cells: index.counts_at(SimTime::ZERO).cells,
            burnings,
            wettings,
            spots,
            arrival: arrival_lines(run),
            shades: shades_data(run),
            wind,
            crews_ms,
            line,
            colours: FireColours {
                young: YOUNG,
                flaming: FLAMING,
                old: OLD,
                embers: EMBERS,
                char: CHAR,
                put_out: blend(CHAR, EXTINGUISHED, 0.6),
                ember: EMBER,
                wet: WET,
                line: LINE,
                lost_line: LOST_LINE,
                wet_opacity: WET_OPACITY,
                burned_opacity: BURNED_OPACITY,
                young_for_s: YOUNG_FOR_S,
                old_after_s: OLD_AFTER_S,
                glows_for_s: GLOWS_FOR_S,
            },
        })
    }
}

impl CellColours {
    fn new(colours: impl Iterator<Item = Option<Rgb>>) -> Self {
        let mut places: BTreeMap<Rgb, i64> = BTreeMap::new();
        let mut palette = Vec::new();
        let mut place = |colour: Rgb| {
            *places.entry(colour).or_insert_with(|| {
                palette.push(hex(colour));
                palette.len() as i64 - 1
            })
        };
        let cells = colours.map(|colour| colour.map_or(-1, &mut place)).collect();
        Self { colours: palette, cells }
    }
}

fn arrival_lines(run: &RunView) -> Vec<ArrivalData> {
    let levels = ArrivalLines::new(run).levels;
    levels
        .into_iter()
        .map(|(time_s, label, lines)| {
            let lines: Vec<crate::contours::ContourLine> = lines;
            ArrivalData { time_s, label, lines: lines.iter().map(|contour| line_steps(&contour.points)).collect() }
        })
        .collect()
}

/// Returns a line as steps from point to point in parts of a cell, columns and rows in turn.
fn line_steps(points: &[(f64, f64)]) -> Vec<i64> {
    let columns = differences(points.iter().map(|point| (point.0 * PER_CELL).round() as i64));
    let rows = differences(points.iter().map(|point| (point.1 * PER_CELL).round() as i64));
    columns.into_iter().zip(rows).flat_map(|(col, row)| [col, row]).collect()
}

fn shades_data(run: &RunView) -> BTreeMap<&'static str, ShadesData> {
    CellShades::LAYERS
        .into_iter()
        .filter_map(|(layer, quantity)| Some((layer.name(), shades_of_quantity(CellShades::new(run, quantity)?))))
        .collect()
}

fn shades_of_quantity(CellShades { scale, by_cell }: CellShades) -> ShadesData {
    ShadesData {
        name: scale.name.clone(),
        shades: (0..SHADES).map(|row| hex(scale.shade((f64::from(row) + 0.5) / f64::from(SHADES)))).collect(),
        ticks: scale.ticks.iter().map(|tick| (scale.fraction(tick.value), tick.label.clone())).collect(),
        cells: CellColours::new(by_cell.iter().copied()),
    }
}

fn millis(time: SimTime) -> i64 {
    (time.as_nanos() / NANOS_PER_MILLI) as i64
}
