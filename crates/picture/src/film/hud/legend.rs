//! The legend: what a run is about in one sentence, what lines and colours of the field mean, and how points are counted.

use std::collections::BTreeSet;

use crate::Rgb;
use crate::colours::{BURNED_OUT, INK, UNIMOG, WUMPUS, blend};
use crate::film::RunView;
use crate::film::field::ground::{BURNED_OPACITY, CHAR, FLAMING, LINE, LOST_LINE, WET, WET_OPACITY};
use crate::film::field::{draw_glow, is_summed};
use crate::film::hud::HudView;
use crate::film::hud::panel::{LineMark, PanelBlock, PanelLine};
use crate::film::hud::pen::{TextFace, TextPen};
use crate::ground::GroundCover;
use crate::text::measure_weighted;
use wildfire_timeline::{Role, Rules, Setting};

/// The sign of an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LegendSign {
    /// A line with these dashes and gaps, in heights of text; whole if both are zero.
    Line(f32, f32),
    Cell(Rgb),
    /// What lies or grows on the ground, which a dark page dims.
    Ground(Rgb),
    /// The mark of several agents of a role.
    Cluster(Role),
    /// The glow of a few fires.
    Glow,
}

/// The legend gives way first; of its lines those on paths last.
const RANK: u8 = u8::MAX;
const PATHS: usize = 3;
/// Room for the words of a sentence in a column of the panel, and where a name begins behind its sign; in heights of text.
const ROOM: f32 = 22.8;
const NAME: f32 = 3.2;

/// Tells in one sentence who does what in a run, and where.
pub fn run_sentence(setting: &Setting) -> String {
    let count = |role, one: &str, many: &str| match agents_of(setting, role) {
        0 => None,
        1 => Some((format!("a {one}"), true)),
        count => Some((format!("{count} {many}"), false)),
    };
    let trucks = count(Role::Unimog, "truck", "trucks").map(|(who, is_one)| {
        let verb = if is_one { "extinguishes" } else { "extinguish" };
        format!("{who} {verb}")
    });
    let lights = count(Role::Wumpus, "Wumpus", "Wumpuses").map(|(who, is_one)| {
        let verb = if is_one { "sets" } else { "set" };
        format!("{who} {verb} bushes on fire")
    });
    let them = if lights.is_some() { "them" } else { "it" };
    let fights = trucks.map_or_else(|| format!("no truck fights {them}"), |trucks| format!("{trucks} {them}"));
    let mut lights = lights.unwrap_or_else(|| "fire spreads".to_owned());
    // All of these sentences begin with an ASCII letter.
    lights[..1].make_ascii_uppercase();
    let [width, height] = [setting.frame.width_m(), setting.frame.height_m()].map(length);
    format!("{lights} and {fights}, on a field of {width} by {height}.")
}

fn length(metres: f64) -> String {
    if metres < 1000.0 { format!("{metres:.0} m") } else { format!("{} km", (metres / 10.0).round() / 100.0) }
}

/// Returns the number of agents of a role.
pub fn agents_of(setting: &Setting, role: Role) -> usize {
    setting.agents.iter().filter(|agent| agent.id.role == role).count()
}

/// Explains how the sides of a run score; empty if it has no scoring.
pub fn points_sentence(setting: &Setting) -> String {
    let Rules { score_wumpus_ignited, score_wumpus_burned_out, score_truck_extinguished, .. } = setting.rules;
    let of = |role, name: &str, points: &[(f64, &str)]| {
        let points = points.iter().filter(|(points, _)| *points != 0.0);
        let points: Vec<String> = points.map(|(points, what)| format!("{points} per bush {what}")).collect();
        (agents_of(setting, role) > 0 && !points.is_empty()).then(|| format!("{name} {}", points.join(" and ")))
    };
    let wumpus = [(score_wumpus_ignited, "ignited"), (score_wumpus_burned_out, "burned out")];
    let sides = [
        of(Role::Wumpus, "Wumpus", &wumpus),
        of(Role::Unimog, "Unimog", &[(score_truck_extinguished, "extinguished")]),
    ];
    let sides: Vec<String> = sides.into_iter().flatten().collect();
    if sides.is_empty() { String::new() } else { format!("Points: {}.", sides.join("; ")) }
}

/// A sign and what it means.
#[derive(Debug)]
pub struct LegendEntry {
    pub sign: LegendSign,
    pub text: String,
}

/// Lists the signs that one of the runs has, on panes of that side in pixels: paths first.
pub fn legend_entries(runs: &[&RunView], pane_side: f64) -> Vec<LegendEntry> {
    let mut entries = Vec::new();
    let mut add = |sign, text: &str| entries.push(LegendEntry { sign, text: text.to_owned() });
    add(LegendSign::Line(0.0, 0.0), "driven in the last 2 min");
    add(LegendSign::Line(0.25, 0.3), "driven or planned in reverse");
    add(LegendSign::Line(0.8, 0.5), "planned; brackets: the goal");
    let by_shares = |run: &&&RunView| {
        let frame = run.timeline().setting.frame;
        is_summed(&frame, pane_side / f64::from(frame.cols.max(frame.rows)))
    };
    if runs.iter().filter(by_shares).any(|run| run.index().ground().is_none()) {
        add(LegendSign::Glow, "where fire was (size: bushes)");
    }
    if runs.iter().filter(by_shares).any(|run| run.is_crowded()) {
        add(LegendSign::Cluster(Role::Unimog), "trucks close together");
        add(LegendSign::Cluster(Role::Wumpus), "Wumpuses close together");
    }
    // Of millions of cells in every frame.
    let mut has_fuel = [false; 256];
    for spread in runs.iter().filter_map(|run| run.timeline().setting.spread.as_ref()) {
        spread.landscape().fuel.iter().for_each(|&number| has_fuel[usize::from(number)] = true);
    }
    let numbers = (0..=u8::MAX).filter(|&number| has_fuel[usize::from(number)]);
    let covers: BTreeSet<GroundCover> = numbers.map(GroundCover::from_fuel).collect();
    covers.iter().for_each(|cover| add(LegendSign::Ground(cover.colour()), cover.name()));
    // Colours of fire are laid over those of the ground, so that they are shown on a ground of these runs.
    if let Some(cover) = covers.iter().find(|cover| cover.burns()) {
        add(LegendSign::Cell(FLAMING), "on fire");
        add(LegendSign::Cell(blend(cover.colour(), CHAR, BURNED_OPACITY)), "burned");
        add(LegendSign::Cell(blend(cover.colour(), WET, WET_OPACITY.into())), "wet");
    }
    if runs.iter().any(|run| run.timeline().setting.line.is_some()) {
        add(LegendSign::Cell(LINE), "line that holds");
        add(LegendSign::Cell(LOST_LINE), "lost line");
    }
    entries
}

/// The block of the legend: a line for each path, two entries of other kinds in one, then what gives points.
pub fn legend_block(view: &HudView) -> PanelBlock {
    let entries = legend_entries(view.runs, view.pane_side).into_iter().filter(|entry| is_there(view.runs, entry));
    let entries: Vec<LegendEntry> = entries.collect();
    let is_cell = |entry: &LegendEntry| matches!(entry.sign, LegendSign::Cell(_) | LegendSign::Ground(_));
    let marks = |from: f32, entry: &LegendEntry| {
        let name = from + if is_cell(entry) { 1.9 } else { NAME };
        [
            LineMark::Legend { from, sign: entry.sign },
            LineMark::Left { from: name, text: entry.text.clone(), face: TextFace::faint() },
        ]
    };
    let (cells, lines): (Vec<_>, Vec<_>) = entries.iter().partition(|entry| is_cell(entry));
    let mut all: Vec<PanelLine> = lines.iter().map(|entry| PanelLine::new(marks(0.0, entry).to_vec())).collect();
    let pairs = cells.chunks(2).map(|pair| {
        let each = pair.iter().zip([0.0, 0.5 * ROOM]).flat_map(|(entry, from)| marks(from, entry));
        PanelLine::new(each.collect())
    });
    all.extend(pairs);
    if !view.is_of_ground() {
        all.extend(wrapped_lines(&points_sentence(&view.runs[0].timeline().setting)));
    }
    let min = PATHS.min(all.len());
    PanelBlock::new(RANK, all).with_min(min)
}

/// Returns whether a run has, or will have, what an entry explains.
fn is_there(runs: &[&RunView], entry: &LegendEntry) -> bool {
    let roles: Vec<Role> =
        runs.iter().flat_map(|run| &run.timeline().setting.agents).map(|agent| agent.id.role).collect();
    match entry.sign {
        // Only the sign of reverse has gaps that are longer than its dashes, and Wumpuses never reverse.
        LegendSign::Line(dash, gap) if dash > 0.0 && dash < gap => roles.iter().any(|role| role.drives()),
        LegendSign::Line(..) => !roles.is_empty(),
        LegendSign::Cell(colour) if colour == LOST_LINE => {
            let mut grounds = runs.iter().filter_map(|run| run.index().ground());
            grounds.any(|ground| ground.line_cells().iter().any(|cell| !cell.holds))
        }
        LegendSign::Cell(_) if entry.text == "wet" => roles.iter().any(|role| role.suppresses()),
        _ => true,
    }
}

/// Breaks a sentence into faint lines that fit into a column of the panel.
pub fn wrapped_lines(sentence: &str) -> Vec<PanelLine> {
    let face = TextFace::faint();
    let mut lines: Vec<String> = Vec::new();
    for word in sentence.split_whitespace() {
        let longer = lines.last().map(|line| format!("{line} {word}"));
        match longer.filter(|longer| measure_weighted(longer, face.size, face.weight) <= ROOM) {
            Some(longer) => *lines.last_mut().expect("it was made longer") = longer,
            None => lines.push(word.to_owned()),
        }
    }
    lines.into_iter().map(|line| PanelLine::new(vec![LineMark::left(line, face)])).collect()
}

impl LegendSign {
    /// Draws it from `left` on, about half the height of capitals above a base line.
    pub fn draw(self, pen: &mut TextPen, left: f32, base: f32) {
        let middle = base - 0.45 * pen.text;
        let wide = pen.length(2.6);
        let disc = (left + 0.5 * wide, middle);
        match self {
            Self::Line(dash, gap) => {
                let step = pen.text * (dash + gap);
                // Without a gap, one dash takes the whole width.
                let (dash, step) = if step > 0.0 { (pen.text * dash, step) } else { (wide, wide) };
                let mut from = 0.0;
                while from < wide {
                    pen.fill((left + from, middle), (dash.min(wide - from).max(1.0), pen.length(0.2)), INK);
                    from += step;
                }
            }
            Self::Cell(colour) | Self::Ground(colour) => {
                let side = pen.length(1.1);
                pen.fill((left, base - side), (side, side), colour);
            }
            Self::Cluster(Role::Wumpus) => pen.sheet.fill_disc(disc, 0.7 * pen.text, WUMPUS),
            Self::Cluster(Role::Unimog) => {
                let side = pen.length(1.2);
                pen.fill((disc.0 - 0.5 * side, disc.1 - 0.5 * side), (side, side), UNIMOG);
            }
            Self::Glow => draw_glow(pen.sheet, disc, 0.9 * pen.text, BURNED_OUT),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::hud::blocks::{panel_blocks, scores_block};
    use crate::film::{FrameRequest, ViewOptions};
    use wildfire_base::time::SimTime;
    use wildfire_timeline::{AgentId, Timeline, sample};

    fn run(agents: &[AgentId]) -> RunView {
        let setting = sample::small_setting(agents);
        RunView::new(Timeline { setting, events: Vec::new(), ground: Vec::new() }, None)
    }

    /// All texts of some blocks of the panel at the start.
    fn texts(run: &RunView, blocks: impl Fn(&HudView) -> Vec<PanelBlock>) -> String {
        texts_at(run, SimTime::ZERO, blocks)
    }

    fn texts_at(run: &RunView, time: SimTime, blocks: impl Fn(&HudView) -> Vec<PanelBlock>) -> String {
        let options = ViewOptions::default();
        let states = [run.state_at(time)];
        let request = FrameRequest { runs: &[run], time, options: &options };
        let blocks = blocks(&HudView::new(&request, &states));
        let marks = blocks.iter().flat_map(|block| &block.lines).flat_map(|line| &line.marks);
        let text = |mark: &LineMark| match mark {
            LineMark::Left { text, .. } | LineMark::Right { text, .. } => format!("{text} "),
            _ => String::new(),
        };
        marks.map(text).collect()
    }

    #[test]
    fn a_sentence_tells_who_does_what() {
        let sentence = |wumpuses: u16, trucks: u16| {
            let agents = (0..wumpuses).map(AgentId::wumpus).chain((0..trucks).map(AgentId::unimog));
            let sentence = run_sentence(&run(&agents.collect::<Vec<_>>()).timeline().setting);
            sentence.split_once(", on a field of ").expect("the field has a size").0.to_owned()
        };
        assert_eq!(sentence(1, 1), "A Wumpus sets bushes on fire and a truck extinguishes them");
        assert_eq!(sentence(2, 8), "2 Wumpuses set bushes on fire and 8 trucks extinguish them");
        assert_eq!(sentence(1, 0), "A Wumpus sets bushes on fire and no truck fights them");
        assert_eq!(sentence(0, 3), "Fire spreads and 3 trucks extinguish it");
        assert_eq!(sentence(0, 0), "Fire spreads and no truck fights it");
        assert_eq!([999.6, 250.0, 2000.0, 12345.0].map(length), ["1000 m", "250 m", "2 km", "12.35 km"]);
    }

    #[test]
    fn only_sides_that_are_there_have_points_and_lead() {
        let scores = |agents: &[AgentId]| texts(&run(agents), |view| scores_block(view).into_iter().collect());
        let wumpus = AgentId::wumpus(0);
        let truck = AgentId::unimog(0);
        assert_eq!(scores(&[wumpus, truck]), "Wumpus 0 Unimog 0 tied ");
        assert_eq!(scores(&[truck]), "Unimog 0 ");
        assert_eq!(scores(&[wumpus]), "Wumpus 0 ");
        assert_eq!(scores(&[]), "");
        let points = |agents: &[AgentId]| points_sentence(&run(agents).timeline().setting);
        let of_truck = "Unimog 2 per bush extinguished.";
        assert_eq!(points(&[truck]), format!("Points: {of_truck}"));
        let of_wumpus = "Wumpus 1 per bush ignited and 1 per bush burned out";
        assert_eq!(points(&[wumpus, truck]), format!("Points: {of_wumpus}; {of_truck}"));
        assert_eq!(points(&[]), "");
    }

    #[test]
    fn the_panel_explains_lines_and_the_ground_that_there_is() {
        let text = texts(&run(&[AgentId::unimog(0)]), panel_blocks);
        for word in ["driven in the last 2 min", "in reverse", "planned", "Fire spreads and a truck", "Points:"] {
            assert!(text.contains(word), "{word}: {text}");
        }
        assert!(!text.contains("grass"), "{text}");
        let text = texts(&RunView::new(sample::on_ground(), None), panel_blocks);
        for word in ["grass", "on fire", "burned", "wet"] {
            assert!(text.contains(word), "{word}: {text}");
        }
    }

    #[test]
    fn fires_on_the_ground_are_measured_in_hectares() {
        let run = RunView::new(sample::ground_alone(&[sample::TRUCK]), None);
        let text = texts_at(&run, run.end_time(), panel_blocks);
        let counts = run.index().ground().expect("it has ground").counts_at(run.end_time());
        let burned = run.hectares(counts.cells - counts.intact());
        assert!(burned > 0.0);
        for word in [format!("burned {burned:.2} ha"), "perimeter".into(), "trucks at work".into()] {
            assert!(text.contains(&word), "{word}: {text}");
        }
        for word in ["intact", "Points", "lost line", "goal ("] {
            assert!(!text.contains(word), "{word}: {text}");
        }
        let text = texts(&RunView::new(sample::ground_alone(&[]), None), panel_blocks);
        for word in ["driven", "planned", "wet", "at work"] {
            assert!(!text.contains(word), "{word}: {text}");
        }
    }

    #[test]
    fn a_side_leads_until_the_end_and_has_won_then() {
        let run = RunView::new(sample::random(2, SimTime::from_seconds(300.0)), None);
        let before = SimTime::from_nanos(run.end_time().as_nanos() - 1);
        let scores = |time| texts_at(&run, time, |view| scores_block(view).into_iter().collect());
        assert!(scores(before).contains(" leads by "), "{}", scores(before));
        assert!(scores(run.end_time()).contains(" won by "), "{}", scores(run.end_time()));
    }

    #[test]
    fn a_sentence_is_broken_where_a_column_ends() {
        let sentence = run_sentence(&sample::small_setting(&[]));
        let lines = wrapped_lines(&sentence);
        let texts = lines.iter().flat_map(|line| &line.marks).map(|mark| match mark {
            LineMark::Left { text, face, .. } => {
                assert!(measure_weighted(text, face.size, face.weight) <= ROOM, "{text}");
                text.as_str()
            }
            other => panic!("{other:?}"),
        });
        assert_eq!(texts.collect::<Vec<_>>().join(" "), sentence);
        assert!(lines.len() > 1);
    }
}
