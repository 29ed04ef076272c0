//! The blocks of the panel.

use crate::Rgb;
use crate::colours::{FAINT_INK, UNIMOG, WUMPUS};
use crate::film::hud::formatting::{format_clock, format_cpu, format_hectares, format_length, format_percent};
use crate::film::hud::legend::{agents_of, legend_block, run_sentence, wrapped_lines};
use crate::film::hud::panel::{LineMark, PanelBlock, PanelLine};
use crate::film::hud::pen::TextFace;
use crate::film::hud::stories::{agent_blocks, story_block};
use crate::film::hud::{HudView, formatting};
use crate::film::{Layer, RunView, ViewOptions};
use wildfire_fire::BushStateKind;
use wildfire_timeline::{Activity, BushCounts, CrewRules, GroundCounts, GroundIndex, Role};

/// All blocks in the order in which they are shown.
pub fn panel_blocks(view: &HudView) -> Vec<PanelBlock> {
    let mut blocks = vec![title_block(view), clock_block(view), counts_block(view)];
    blocks.extend(scores_block(view));
    blocks.extend(story_block(view));
    blocks.extend(agent_blocks(view));
    blocks.extend(switches_block(view));
    blocks.push(legend_block(view));
    blocks
}

/// The distance between the ends of two values of a line, in heights of text.
const FIRST_VALUE: f32 = 7.6;

/// Values at the right of a line: one a run.
pub fn values(texts: impl IntoIterator<Item = String>, face: TextFace) -> Vec<LineMark> {
    let texts: Vec<String> = texts.into_iter().collect();
    let count = texts.len();
    texts
        .into_iter()
        .enumerate()
        .map(|(index, text)| LineMark::Right { to: FIRST_VALUE * (count - 1 - index) as f32, text, face })
        .collect()
}

/// Above the values of the runs of a comparison: what they are of, and the names of the runs.
pub fn heading(view: &HudView, name: LineMark) -> PanelLine {
    let names =
        values((0..view.runs.len()).map(|run_index| formatting::run_name(run_index).to_owned()), TextFace::STRONG);
    PanelLine::new([name].into_iter().chain(names).collect())
}

pub fn title_block(view: &HudView) -> PanelBlock {
    let lines = view.runs.iter().enumerate().flat_map(|(run_index, run)| {
        let (name, changes) = run.title().split_once(", ").unwrap_or((run.title(), ""));
        let (name, face) = if view.is_comparison() {
            (format!("{}  {name}", formatting::run_name(run_index)), TextFace::STRONG)
        } else {
            (name.to_owned(), TextFace::TITLE)
        };
        let seed = format!("seed {}", run.timeline().setting.seed);
        let title = PanelLine::new(vec![LineMark::left(name, face), LineMark::right(seed, TextFace::PLAIN)]);
        let changes = (!changes.is_empty()).then(|| PanelLine::new(vec![LineMark::left(changes, TextFace::faint())]));
        [title].into_iter().chain(changes)
    });
    let mut lines: Vec<PanelLine> = lines.collect();
    let min = lines.len();
    let sentence = run_sentence(&view.runs[0].timeline().setting);
    // Two runs by different rules have no common sentence.
    if view.runs.iter().all(|run| run_sentence(&run.timeline().setting) == sentence) {
        // Beside the names of two runs there is no room for the size of their field.
        let (deeds, _) = sentence.split_once(", on a field").unwrap_or((&sentence, ""));
        lines.extend(wrapped_lines(&if view.runs.len() > 1 { format!("{deeds}.") } else { sentence }));
    }
    PanelBlock::new(3, lines).with_min(min)
}

pub fn clock_block(view: &HudView) -> PanelBlock {
    let time = PanelLine { height: 3.0, marks: vec![LineMark::left(format_clock(view.time), TextFace::CLOCK)] };
    let mut below = vec![LineMark::left(format!("of {}", format_clock(view.end)), TextFace::faint())];
    if let Some(status) = &view.options.status {
        let pace = if status.is_paused { "paused".to_owned() } else { format!("{} x", status.speed) };
        below.push(LineMark::right(pace, TextFace::STRONG));
    }
    let follows = view.options.follows.map(|followed| PanelLine::pair("follows", followed.to_string()));
    PanelBlock::new(0, [time, PanelLine::new(below)].into_iter().chain(follows).collect())
}

/// Distances at which a name begins behind its sign, and a count ends in front of its share.
const STATE_NAME: f32 = 2.3;
const COUNT: f32 = 6.0;

pub fn counts_block(view: &HudView) -> PanelBlock {
    if view.is_of_ground() {
        return PanelBlock::new(1, ground_fire_lines(view));
    }
    let counts = BushStateKind::ALL.map(|kind| {
        let mut marks = vec![
            LineMark::Sign(kind),
            LineMark::Left { from: STATE_NAME, text: kind.name().into(), face: TextFace::PLAIN },
        ];
        match view.counts.as_slice() {
            [counts] => marks.extend(count_and_share(counts, kind)),
            counts => {
                marks.extend(values(counts.iter().map(|counts| counts.count(kind).to_string()), TextFace::STRONG));
            }
        }
        PanelLine::new(marks)
    });
    let names = view.is_comparison().then(|| heading(view, LineMark::left("bushes", TextFace::faint())));
    PanelBlock::new(1, names.into_iter().chain(counts).chain(ground_lines(view)).collect())
}

/// A fire on the ground: what burns, and who works against it.
fn ground_fire_lines(view: &HudView) -> Vec<PanelLine> {
    let line = |name: &str, tell: &dyn Fn(usize, &RunView, &GroundIndex) -> String| {
        let texts = view.runs.iter().enumerate().map(|(index, run)| {
            // Only called if `is_of_ground` holds, which is about all runs.
            let ground = run.index().ground().expect("all runs have ground");
            tell(index, run, ground)
        });
        PanelLine::new(
            [LineMark::left(name, TextFace::PLAIN)].into_iter().chain(values(texts, TextFace::STRONG)).collect(),
        )
    };
    let mut lines: Vec<PanelLine> =
        view.is_comparison().then(|| heading(view, LineMark::left("fire", TextFace::faint()))).into_iter().collect();
    lines.push(line("on fire", &|_, run, ground| format_hectares(run.hectares(ground.counts_at(view.time).burning))));
    lines.push(line("burned", &|_, run, ground| {
        let counts = ground.counts_at(view.time);
        format_hectares(run.hectares(counts.cells - counts.intact()))
    }));
    lines.push(line("perimeter", &|_, _, ground| format_length(ground.perimeter_m_at(view.time))));
    if view.states.iter().any(|state| !state.agents.is_empty()) {
        lines.push(line("trucks at work", &|index, _, _| {
            let agents = &view.states[index].agents;
            let activities = agents.iter().map(|agent| agent.activity);
            let at_work = activities.filter(|activity| !matches!(activity, Activity::Standing | Activity::Waiting));
            format!("{} of {}", at_work.count(), agents.len())
        }));
    }
    if view.runs.iter().any(|run| !crews_of(run).is_empty()) {
        lines.push(line("crews at work", &|_, run, _| {
            let set_out = crews_of(run).iter().filter(|crew| crew.at_ns <= view.time.as_nanos()).count();
            format!("{set_out} of {}", crews_of(run).len())
        }));
    }
    if view.counts.iter().any(|counts| counts.bushes() > 0) {
        lines.push(line("bushes burned", &|index, _, _| {
            let counts = &view.counts[index];
            format!(
                "{} of {}",
                counts.count(BushStateKind::Burning) + counts.count(BushStateKind::BurnedOut),
                counts.bushes()
            )
        }));
    }
    lines
}

fn crews_of(run: &RunView) -> &[CrewRules] {
    run.timeline().setting.line.as_ref().map_or(&[], |line| &line.crews)
}

/// How much ground burns and has burned, in hectares, where some can.
fn ground_lines(view: &HudView) -> Vec<PanelLine> {
    if !view.has_ground() {
        return Vec::new();
    }
    let hectares = |cells: fn(&GroundCounts) -> u32| {
        view.runs.iter().map(move |run| {
            let ground = run.index().ground();
            ground.map_or("-".to_owned(), |ground| format!("{:.2}", run.hectares(cells(&ground.counts_at(view.time)))))
        })
    };
    let line = |name: &str, texts: Vec<String>| {
        let name = LineMark::Left { from: STATE_NAME, text: name.into(), face: TextFace::PLAIN };
        PanelLine::new([name].into_iter().chain(values(texts, TextFace::STRONG)).collect())
    };
    vec![
        line("ground on fire, ha", hectares(|counts| counts.burning).collect()),
        line("ground burned, ha", hectares(|counts| counts.cells - counts.intact()).collect()),
    ]
}

fn count_and_share(counts: &BushCounts, kind: BushStateKind) -> [LineMark; 2] {
    let count = counts.count(kind);
    let share = format_percent(counts.count(kind), counts.bushes());
    [
        LineMark::Right { to: COUNT, text: count.to_string(), face: TextFace::STRONG },
        LineMark::Right { to: 0.0, text: share, face: TextFace::faint() },
    ]
}

/// Points of the sides that a run has, and who leads or won where both are there; `None` without agents and CPU times. A fire
/// on the ground has no points.
pub fn scores_block(view: &HudView) -> Option<PanelBlock> {
    if view.is_of_ground() {
        return cpu_line(view).map(|line| PanelBlock::new(2, vec![line]));
    }
    let is_over = view.time >= view.end;
    let settings = || view.runs.iter().map(|run| &run.timeline().setting);
    let scores: Vec<[f64; 2]> = settings()
        .zip(&view.counts)
        .map(|(setting, counts)| [counts.wumpus_score(&setting.rules), counts.truck_score(&setting.rules)])
        .collect();
    let sides = [(0, "Wumpus", WUMPUS, Role::Wumpus), (1, "Unimog", UNIMOG, Role::Unimog)];
    let present = sides.into_iter().filter(|(.., role)| settings().any(|setting| agents_of(setting, *role) > 0));
    let sides = present.map(|(side, name, colour, _)| {
        let mut marks = vec![LineMark::left(name, TextFace { colour, ..TextFace::STRONG })];
        marks.extend(values(scores.iter().map(|score| points_text(score[side])), TextFace::STRONG));
        PanelLine::new(marks)
    });
    let mut lines: Vec<PanelLine> = sides.collect();
    let is_contest = lines.len() == 2;
    // Of two runs points stand in columns; a bar and a sentence are for one.
    if let (&[score], true) = (scores.as_slice(), is_contest) {
        lines.push(PanelLine { height: 1.2, marks: vec![LineMark::Bar(shares(score))] });
        lines.push(PanelLine::new(vec![LineMark::left(lead_text(score, is_over), TextFace::PLAIN)]));
    } else if view.is_comparison() && !lines.is_empty() {
        lines.insert(0, heading(view, LineMark::left("points", TextFace::faint())));
        let mut marks = vec![LineMark::left(if is_over { "won" } else { "leads" }, TextFace::faint())];
        marks.extend(values(scores.iter().map(|&score| leader(score).unwrap_or("-").to_owned()), TextFace::PLAIN));
        lines.extend(is_contest.then(|| PanelLine::new(marks)));
    }
    lines.extend(cpu_line(view));
    (!lines.is_empty()).then(|| PanelBlock::new(2, lines))
}

/// CPU time of all decisions so far, where it is known of a run.
fn cpu_line(view: &HudView) -> Option<PanelLine> {
    let times: Vec<_> = view.runs.iter().map(|run| run.cpu_until(view.time)).collect();
    times.iter().any(Option::is_some).then(|| {
        let mut marks = vec![LineMark::left("CPU for plans", TextFace::faint())];
        marks.extend(values(times.iter().map(|cpu| cpu.map_or("-".to_owned(), format_cpu)), TextFace::PLAIN));
        PanelLine::new(marks)
    })
}

/// Returns the name of the side that has more points.
fn leader([wumpus, unimog]: [f64; 2]) -> Option<&'static str> {
    if wumpus > unimog { Some("Wumpus") } else { (unimog > wumpus).then_some("Unimog") }
}

fn lead_text(score: [f64; 2], is_over: bool) -> String {
    let verb = if is_over { "won" } else { "leads" };
    leader(score)
        .map_or("tied".to_owned(), |name| format!("{name} {verb} by {}", points_text((score[0] - score[1]).abs())))
}

/// Points are whole numbers with ordinary rules.
fn points_text(score: f64) -> String {
    if score.fract() == 0.0 { format!("{score:.0}") } else { format!("{score:.1}") }
}

/// The part of each side in all points.
fn shares([wumpus, unimog]: [f64; 2]) -> Vec<(f64, Rgb)> {
    let wumpus = wumpus.max(0.0);
    let unimog = unimog.max(0.0);
    let all = wumpus + unimog;
    if all > 0.0 { vec![(wumpus / all, WUMPUS), (unimog / all, UNIMOG)] } else { vec![(1.0, FAINT_INK)] }
}

/// Distances at which the second layer of a line begins, and a name behind its key.
const SECOND: f32 = 11.8;
const LAYER_NAME: f32 = 1.9;

pub fn switches_block(view: &HudView) -> Option<PanelBlock> {
    view.options.status.as_ref()?;
    let layers: Vec<Layer> = Layer::all_of(view.has_ground()).collect();
    let (first, second) = layers.split_at(layers.len().div_ceil(2));
    let lines = (0..first.len()).map(|row| {
        let mut marks = switch(view.options, first[row], 0.0).to_vec();
        marks.extend(second.get(row).into_iter().flat_map(|&layer| switch(view.options, layer, SECOND)));
        PanelLine::new(marks)
    });
    let note = lacks_searches(view)
        .then(|| PanelLine::new(vec![LineMark::left("no searches in the recording", TextFace::PLAIN)]));
    let help = PanelLine::new(vec![LineMark::left("?  all keys", TextFace::PLAIN)]);
    Some(PanelBlock::new(13, lines.chain(note).chain([help]).collect()))
}

/// Returns whether a layer of searches is switched on although no run has any.
fn lacks_searches(view: &HudView) -> bool {
    let shown = Layer::ALL.into_iter().filter(|&layer| view.options.layers.contains(layer));
    shown.into_iter().any(Layer::needs_searches) && !view.runs.iter().any(|run| run.index().has_searches())
}

fn switch(options: &ViewOptions, layer: Layer, from: f32) -> [LineMark; 2] {
    let is_on = options.layers.contains(layer);
    let (key, name) = if is_on { (TextFace::STRONG, TextFace::STRONG) } else { (TextFace::PLAIN, TextFace::faint()) };
    [
        LineMark::Left { from, text: layer.key().to_string(), face: key },
        LineMark::Left { from: from + LAYER_NAME, text: layer.name().into(), face: name },
    ]
}
