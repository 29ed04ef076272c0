//! The data of a page's runs, prepared once and written as JSON for its script.
//!
//! A table is a list per column. Column names end in their unit. Columns of times, cells and bushes hold the differences
//! of successive numbers, which compress well. Lengths and angles are integers in small units.

use std::collections::BTreeMap;

use serde::Serialize;

use super::ground::GroundData;
use crate::Rgb;
use crate::film::field::searches::STYLES;
use crate::film::hud::chart::CountScale;
use crate::film::hud::formatting::activity_name;
use crate::film::hud::legend::points_sentence;
use crate::film::hud::stories::{burned_for, cells_word, change_text};
use crate::film::{RunView, Verdict};
use wildfire_base::geometry::Pose;
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Piece;
use wildfire_base::untrusted::visible;
use wildfire_fire::BushStateKind;
use wildfire_timeline::{
    Activity, AgentFact, AgentStart, Body, ChangedBush, Fact, FireFact, Role, Rules, SuppressionSpan,
};

/// Parts of a metre in which places and lengths are written, of a radian, of a curvature of 1/m, and of m/s and m/s2.
const PER_METRE: f64 = 1e4;
const PER_RADIAN: f64 = 1e6;
const PER_CURVATURE: f64 = 1e8;
const PER_MPS: f64 = 1e6;

/// Kinds of [`PieceTable::kind`].
const DRIVE: u8 = 0;
const TURN: u8 = 1;
const WAIT: u8 = 2;

/// A run.
#[derive(Serialize)]
pub struct RunData {
    title: String,
    seed: u64,
    /// What gives points.
    points: String,
    program: String,
    end_ns: u64,
    cols: u16,
    rows: u16,
    cell_m: f64,
    /// Indices of the cells of bushes.
    bush_cells: Vec<i64>,
    dwell_ns: u64,
    reach_m: Option<f64>,
    spread_radius_m: Option<f64>,
    burn_out_ns: Option<u64>,
    /// The height of the curves in bushes, where the intact ones are left out.
    without_intact: Option<f64>,
    agents: Vec<AgentData>,
    changes: ChangeTable,
    counts: CountTable,
    failed_plans_ns: Vec<i64>,
    /// Times of decisions by verdict, with the colours of their marks.
    verdicts: Vec<(String, Vec<i64>)>,
    /// When something happens that one can step to.
    moments_ns: Vec<i64>,
    spreads: Vec<SpreadData>,
    searches: Vec<SearchData>,
    water: Option<WaterData>,
    ground: Option<GroundData>,
    /// Sentences and words that tables name by their place here.
    texts: Vec<String>,
}

#[derive(Serialize)]
struct AgentData {
    id: String,
    number: u16,
    is_truck: bool,
    /// What it does with bushes.
    cells_word: &'static str,
    /// The words for its activities.
    activities: [&'static str; 6],
    /// Of a truck: length, width, wheelbase, and from the rear axle to the body's middle; of others the side.
    body_m: Vec<f64>,
    start: [i64; 3],
    steps: StepTable,
    legs: PageLegs,
    stops: StopTable,
}

/// The numbers of an agent from a time on.
#[derive(Default, Serialize)]
struct StepTable {
    time_ns: Vec<i64>,
    activity: Vec<u8>,
    /// Index of the cell that it goes for, or -1.
    goal: Vec<i64>,
    plans: Vec<i64>,
    failures: Vec<i64>,
    expansions: Vec<i64>,
    cells: Vec<i64>,
    /// Place of the last failure among the texts, or -1.
    failure: Vec<i64>,
}

/// The legs of an agent, with their pieces one after the other.
#[derive(Default, Serialize)]
struct PageLegs {
    from_ns: Vec<i64>,
    /// When it sets out at the earliest, after `from_ns`.
    wait_ns: Vec<i64>,
    x: Vec<i64>,
    y: Vec<i64>,
    heading: Vec<i64>,
    /// Driven on legs before.
    driven_m: Vec<i64>,
    pieces: Vec<usize>,
    piece: PieceTable,
}

#[derive(Default, Serialize)]
struct PieceTable {
    kind: Vec<u8>,
    /// Microseconds: how long it takes. It follows from the others, but where a body brakes to a standstill these would have to be
    /// very precise.
    lasts: Vec<i64>,
    /// Metres along the way, negative in reverse; radians of a turn on the spot.
    amount: Vec<i64>,
    curvature: Vec<i64>,
    speed: Vec<i64>,
    acceleration: Vec<i64>,
}

#[derive(Serialize)]
struct StopTable {
    time_ns: Vec<i64>,
    lasts_ns: Vec<u64>,
    cell: Vec<usize>,
}

/// Changes of bushes in order of time.
#[derive(Default, Serialize)]
struct ChangeTable {
    time_ns: Vec<i64>,
    bush: Vec<i64>,
    to: Vec<u8>,
    /// What happened, and for how long it had burned or -1, among the texts.
    words: Vec<usize>,
    burned: Vec<i64>,
}

#[derive(Default, Serialize)]
struct CountTable {
    time_ns: Vec<i64>,
    /// By kind of state.
    bushes: [Vec<i64>; 4],
    wumpus_score: Vec<f64>,
    truck_score: Vec<f64>,
}

#[derive(Serialize)]
struct SpreadData {
    time_ns: u64,
    from: usize,
    caught: Vec<usize>,
}

#[derive(Serialize)]
struct SearchData {
    time_ns: u64,
    agent: usize,
    style: usize,
    /// In centimetres, x and y in turn, each less that of the place before.
    places: Vec<i64>,
    /// Ends of connections by place, in turn, each less the one before.
    edges: Vec<i64>,
}

#[derive(Serialize)]
struct WaterData {
    reach_m: f64,
    places_m: Vec<[f64; 2]>,
}

/// Texts by their place, each once.
#[derive(Default)]
struct Texts {
    places: BTreeMap<String, usize>,
    texts: Vec<String>,
}

impl Texts {
    fn place(&mut self, text: String) -> usize {
        *self.places.entry(text).or_insert_with_key(|text| {
            self.texts.push(text.clone());
            self.texts.len() - 1
        })
    }
}

impl RunData {
    pub fn new(run: &RunView, scale: CountScale) -> Self {
        let (timeline, index) = (run.timeline(), run.index());
        let setting = &timeline.setting;
        let frame = timeline.setting.frame;
        // Many entries have the same text, so that tables hold the numbers of texts.
        let mut texts = Texts::default();
        let agents = setting.agents.iter().enumerate();
        let agents = agents.map(|(agent, start)| agent_data(run, agent, start, &mut texts)).collect();
        let changes = change_table(run, &mut texts);
        let failed = timeline.events.iter().filter(|event| is_failed_plan(&event.fact)).map(|event| event.time);
        let spread = |spread: &wildfire_timeline::SpreadMoment| SpreadData {
            time_ns: spread.time.as_nanos(),
            from: frame.index(spread.from),
            caught: spread.caught.iter().map(|&cell| frame.index(cell)).collect(),
        };
        Self {
            title: visible(run.title()).into_owned(),
            seed: setting.seed,
            points: points_sentence(setting),
            program: setting.program_version.clone(),
            end_ns: run.end_time().as_nanos(),
            cols: frame.cols,
            rows: frame.rows,
            cell_m: frame.cell_m,
            bush_cells: differences(setting.bushes.iter().map(|&bush| frame.index(bush) as i64)),
            dwell_ns: setting.rules.suppression_dwell.as_nanos(),
            reach_m: setting.rules.suppression_reach_m,
            spread_radius_m: setting.rules.fire.map(|fire| fire.spread_radius_m),
            burn_out_ns: setting.rules.fire.and_then(|fire| fire.burn_out).map(SimTime::as_nanos),
            without_intact: scale.max(),
            agents,
            changes,
            counts: count_table(run, &setting.rules),
            failed_plans_ns: time_differences(failed),
            verdicts: verdicts(run),
            moments_ns: time_differences(index.moments().iter().copied()),
            spreads: index.spreads().iter().map(spread).collect(),
            searches: searches(run),
            water: setting.water.as_ref().map(|water| WaterData {
                reach_m: water.reach_m,
                places_m: water.places.iter().map(|place| [place.x, place.y]).collect(),
            }),
            ground: GroundData::new(run),
            texts: texts.texts,
        }
    }
}

fn is_failed_plan(fact: &Fact) -> bool {
    matches!(fact, Fact::Agent(_, AgentFact::PlanFailed { .. }))
}

fn agent_data(run: &RunView, agent: usize, start: &AgentStart, texts: &mut Texts) -> AgentData {
    let is_truck = start.id.role == Role::Unimog;
    let steps = step_table(run, agent, texts);
    AgentData {
        id: start.id.to_string(),
        number: start.id.number,
        is_truck,
        cells_word: cells_word(start.id),
        activities: Activity::ALL.map(|activity| activity_name(start.id, activity)),
        body_m: match start.body {
            Body::Square { size_m } => vec![size_m],
            Body::Truck(body) => vec![body.length_m, body.width_m, body.wheelbase_m, body.centre_offset_m()],
        },
        start: pose(start.pose),
        steps,
        legs: leg_table(run, agent),
        stops: stop_table(run, agent),
    }
}

fn step_table(run: &RunView, agent: usize, texts: &mut Texts) -> StepTable {
    let (index, timeline) = (run.index(), run.timeline());
    let mut table = StepTable::default();
    for time in index.changes_of_agent(agent) {
        let state = run.agent_at(agent, time);
        let stats = run.stats_at(agent, time);
        let failure = stats.last_failure.map(|at| &timeline.events[at].fact);
        table.time_ns.push(nanos(time));
        table.activity.push(stats.activity as u8);
        // None is -1, as a column of numbers packs better than one with gaps.
        table.goal.push(state.goal.map_or(-1, |goal| timeline.setting.frame.index(goal) as i64));
        table.plans.push(stats.plans.into());
        table.failures.push(stats.failures.into());
        table.expansions.push(stats.expansions as i64);
        table.cells.push(stats.cells.into());
        table.failure.push(match failure {
            Some(Fact::Agent(_, AgentFact::PlanFailed { reason, goal, .. })) => {
                texts.place(format!("{reason}, for {goal}")) as i64
            }
            _ => -1,
        });
    }
    // Not of columns whose numbers stand for kinds: their differences are no smaller.
    let StepTable { time_ns, goal, plans, failures, expansions, cells, .. } = &mut table;
    for column in [time_ns, goal, plans, failures, expansions, cells] {
        *column = differences(column.iter().copied());
    }
    table
}

fn leg_table(run: &RunView, agent: usize) -> PageLegs {
    let timeline = run.timeline();
    let mut table = PageLegs::default();
    for leg in run.index().legs_of(agent) {
        let trajectory = leg.trajectory(timeline);
        let [x, y, heading] = pose(trajectory.start());
        // A leg that is cut short begins when the whole one did, which is before it is followed.
        let driven_m = run.stats_at(agent, leg.from).distance_m;
        table.from_ns.push(nanos(leg.from));
        table.wait_ns.push(nanos(trajectory.start_time()).saturating_sub(nanos(leg.from)));
        table.x.push(x);
        table.y.push(y);
        table.heading.push(heading);
        table.driven_m.push(scaled(driven_m, PER_METRE));
        table.pieces.push(trajectory.pieces().len());
        trajectory.pieces().iter().for_each(|piece| push_piece(&mut table.piece, piece));
    }
    let PageLegs { from_ns, x, y, driven_m, .. } = &mut table;
    for column in [from_ns, x, y, driven_m] {
        *column = differences(column.iter().copied());
    }
    table
}

fn push_piece(table: &mut PieceTable, piece: &Piece) {
    let (kind, amount, motion) = match *piece {
        Piece::Drive { segment, speed_mps, acceleration_mps2 } => (
            DRIVE,
            scaled(segment.length_m, PER_METRE),
            [scaled(segment.curvature, PER_CURVATURE), scaled(speed_mps, PER_MPS), scaled(acceleration_mps2, PER_MPS)],
        ),
        Piece::Turn { heading } => (TURN, scaled(heading, PER_RADIAN), [0; 3]),
        Piece::Wait { .. } => (WAIT, 0, [0; 3]),
    };
    table.kind.push(kind);
    table.lasts.push(scaled(piece.duration_s(), 1e6));
    table.amount.push(amount);
    table.curvature.push(motion[0]);
    table.speed.push(motion[1]);
    table.acceleration.push(motion[2]);
}

fn stop_table(run: &RunView, agent: usize) -> StopTable {
    let frame = run.timeline().setting.frame;
    let mut stops: Vec<SuppressionSpan> =
        run.index().changes_of_agent(agent).filter_map(|time| run.index().stop_at(agent, time)).collect();
    // A stop goes on over several changes of its agent, each of which finds it.
    stops.dedup();
    StopTable {
        time_ns: time_differences(stops.iter().map(|stop| stop.since)),
        lasts_ns: stops.iter().map(|stop| stop.lasts.as_nanos()).collect(),
        cell: stops.iter().map(|stop| frame.index(stop.cell)).collect(),
    }
}

fn change_table(run: &RunView, texts: &mut Texts) -> ChangeTable {
    let timeline = run.timeline();
    let setting = &run.timeline().setting;
    let mut since: Vec<Option<SimTime>> = vec![None; setting.bushes.len()];
    let mut table = ChangeTable::default();
    for event in &timeline.events {
        let Some(ChangedBush { cell, state }) = event.bush_change() else { continue };
        let Some(bush) = setting.bush_index(cell) else { continue };
        table.time_ns.push(nanos(event.time));
        table.bush.push(bush as i64);
        table.to.push(state.kind() as u8);
        table.words.push(texts.place(change_text(&event.fact, since[bush].is_some())));
        table.burned.push(burned_for(event, since[bush]).map_or(-1, |text| texts.place(text) as i64));
        // This comes only now, so `change_text` could see whether the bush had burned before this ignition.
        if let Fact::Fire(FireFact::Ignited { .. }) = event.fact {
            since[bush] = Some(event.time);
        }
    }
    table.time_ns = differences(table.time_ns);
    table.bush = differences(table.bush);
    table
}

fn count_table(run: &RunView, rules: &Rules) -> CountTable {
    let mut times: Vec<SimTime> = vec![SimTime::ZERO];
    times.extend(run.timeline().events.iter().filter(|event| event.bush_change().is_some()).map(|event| event.time));
    times.dedup();
    let counts: Vec<_> = times.iter().map(|&time| run.counts_at(time)).collect();
    CountTable {
        time_ns: time_differences(times),
        bushes: BushStateKind::ALL.map(|kind| differences(counts.iter().map(|counts| i64::from(counts.count(kind))))),
        wumpus_score: counts.iter().map(|counts| counts.wumpus_score(rules)).collect(),
        truck_score: counts.iter().map(|counts| counts.truck_score(rules)).collect(),
    }
}

fn searches(run: &RunView) -> Vec<SearchData> {
    let timeline = run.timeline();
    let setting = &run.timeline().setting;
    let searched = timeline.events.iter().filter_map(|event| {
        let Fact::Agent(id, AgentFact::Searched { phase, graph }) = &event.fact else { return None };
        Some(SearchData {
            time_ns: event.time.as_nanos(),
            agent: setting.agent_index(*id)?,
            style: STYLES.iter().position(|style| style.phase == *phase)?,
            places: pair_differences(graph.places.iter().map(|&(x, y)| [i64::from(x), i64::from(y)])),
            edges: differences(graph.edges.iter().flat_map(|&(from, to)| [i64::from(from), i64::from(to)])),
        })
    });
    searched.collect()
}

fn pose(pose: Pose) -> [i64; 3] {
    [scaled(pose.x, PER_METRE), scaled(pose.y, PER_METRE), scaled(pose.heading, PER_RADIAN)]
}

#[expect(clippy::cast_possible_truncation, reason = "fields have some kilometres, runs some hours")]
fn scaled(value: f64, parts: f64) -> i64 {
    (value * parts).round() as i64
}

fn verdicts(run: &RunView) -> Vec<(String, Vec<i64>)> {
    if run.verdicts().is_empty() {
        return Vec::new();
    }
    Verdict::ALL
        .map(|verdict: Verdict| {
            let those = run.verdicts().iter().filter(|(_, other)| *other == verdict);
            (hex(verdict.colour()), time_differences(those.map(|(time, _)| *time)))
        })
        .to_vec()
}

fn time_differences(times: impl IntoIterator<Item = SimTime>) -> Vec<i64> {
    differences(times.into_iter().map(nanos))
}

/// Whole nanoseconds; of a time that no run reaches, but that a damaged recording may hold, the most.
fn nanos(time: SimTime) -> i64 {
    i64::try_from(time.as_nanos()).unwrap_or(i64::MAX)
}

/// Returns each number less the one before it.
pub fn differences(values: impl IntoIterator<Item = i64>) -> Vec<i64> {
    let mut last = 0_i64;
    values.into_iter().map(|value| value.saturating_sub(std::mem::replace(&mut last, value))).collect()
}

fn pair_differences(pairs: impl IntoIterator<Item = [i64; 2]>) -> Vec<i64> {
    let mut last = [0; 2];
    pairs
        .into_iter()
        .flat_map(|pair| {
            let [x, y] = std::mem::replace(&mut last, pair);
            [pair[0] - x, pair[1] - y]
        })
        .collect()
}

/// The colour in the notation of HTML.
pub fn hex([red, green, blue]: Rgb) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use wildfire_base::vehicle::Segment;
    use wildfire_timeline::sample;

    fn run(seed: u64) -> RunView {
        RunView::new(sample::random(seed, SimTime::from_seconds(300.0)), None)
    }

    fn data(run: &RunView) -> RunData {
        RunData::new(run, CountScale::new(&[run]))
    }

    fn sums(differences: &[i64]) -> Vec<i64> {
        let add = |sum: &mut i64, difference: &i64| {
            *sum += difference;
            Some(*sum)
        };
        differences.iter().scan(0, add).collect()
    }

    /// The place of the last time that is not after another.
    fn last_at(times: &[i64], time: SimTime) -> Option<usize> {
        times.partition_point(|&at| at <= nanos(time)).checked_sub(1)
    }

    fn times() -> impl Iterator<Item = SimTime> {
        (0..1000).map(|step| SimTime::from_seconds(0.3 * f64::from(step)))
    }

    #[test]
    fn counts_and_states_are_those_of_the_run() {
        for seed in 0..4 {
            let run = run(seed);
            let RunData { counts, changes, .. } = data(&run);
            let count_times = sums(&counts.time_ns);
            let change_times = sums(&changes.time_ns);
            let bushes = sums(&changes.bush);
            let kinds = counts.bushes.each_ref().map(|kind| sums(kind));
            for time in times() {
                let expected = run.counts_at(time);
                let state = run.state_at(time);
                let step = last_at(&count_times, time).expect("the first is at zero");
                for (kind, counts) in BushStateKind::ALL.into_iter().zip(&kinds) {
                    assert_eq!(counts[step], i64::from(expected.count(kind)), "{kind:?} at {time}");
                }
                let mut states = vec![0; state.bushes.len()];
                for change in 0..last_at(&change_times, time).map_or(0, |last| last + 1) {
                    states[bushes[change] as usize] = changes.to[change];
                }
                let expected: Vec<u8> = state.bushes.iter().map(|bush| bush.kind() as u8).collect();
                assert_eq!(states, expected, "at {time}");
            }
        }
    }

    /// A leg as the script of a page reads it.
    struct ReadLeg {
        start_s: f64,
        start: Pose,
        /// Pieces, and the seconds that each lasts.
        pieces: Vec<(f64, Piece)>,
    }

    impl ReadLeg {
        fn new(table: &PageLegs, index: usize) -> Self {
            let x = sums(&table.x)[index] as f64 / PER_METRE;
            let y = sums(&table.y)[index] as f64 / PER_METRE;
            let first: usize = table.pieces[..index].iter().sum();
            let PieceTable { kind, lasts, amount, curvature, speed, acceleration } = &table.piece;
            let piece = |at: usize| match kind[at] {
                DRIVE => Piece::Drive {
                    segment: Segment {
                        curvature: curvature[at] as f64 / PER_CURVATURE,
                        length_m: amount[at] as f64 / PER_METRE,
                    },
                    speed_mps: speed[at] as f64 / PER_MPS,
                    acceleration_mps2: acceleration[at] as f64 / PER_MPS,
                },
                TURN => Piece::Turn { heading: amount[at] as f64 / PER_RADIAN },
                _ => Piece::Wait { seconds: lasts[at] as f64 / 1e6 },
            };
            Self {
                start_s: (sums(&table.from_ns)[index] + table.wait_ns[index]) as f64 / 1e9,
                start: Pose { x, y, heading: table.heading[index] as f64 / PER_RADIAN },
                pieces: (first..first + table.pieces[index]).map(|at| (lasts[at] as f64 / 1e6, piece(at))).collect(),
            }
        }

        fn pose_at(&self, time: SimTime) -> Pose {
            let mut left_s = time.as_seconds() - self.start_s;
            let mut pose = self.start;
            for &(lasts_s, piece) in &self.pieces {
                if left_s < 0.0 {
                    break;
                }
                match piece {
                    Piece::Drive { segment, speed_mps, acceleration_mps2 } => {
                        let driven_s = left_s.min(lasts_s);
                        let driven_m = driven_s * (speed_mps + 0.5 * acceleration_mps2 * driven_s);
                        let driven_m = if left_s < lasts_s { driven_m } else { segment.length_m.abs() };
                        pose = segment.pose_at(pose, driven_m.copysign(segment.length_m));
                    }
                    Piece::Turn { heading } => pose.heading = heading,
                    Piece::Wait { .. } => {}
                }
                left_s -= lasts_s;
            }
            pose
        }
    }

    #[test]
    fn agents_are_where_their_legs_lead_and_do_what_their_steps_say() {
        let mut moved = 0;
        for seed in 0..4 {
            let run = run(seed);
            for (index, agent) in data(&run).agents.iter().enumerate() {
                let leg_times = sums(&agent.legs.from_ns);
                let step_times = sums(&agent.steps.time_ns);
                let goals = sums(&agent.steps.goal);
                let cells = sums(&agent.steps.cells);
                let legs: Vec<ReadLeg> = (0..leg_times.len()).map(|at| ReadLeg::new(&agent.legs, at)).collect();
                for time in times() {
                    let state = run.agent_at(index, time);
                    let stats = run.stats_at(index, time);
                    if let Some(leg) = last_at(&leg_times, time) {
                        let apart_m = (legs[leg].pose_at(time).position() - state.pose.position()).length();
                        assert!(apart_m < 0.01, "{} at {time}: {apart_m} m", agent.id);
                        moved += 1;
                    }
                    let step = last_at(&step_times, time).expect("the first is at zero");
                    assert_eq!(agent.steps.activity[step], state.activity as u8, "{} at {time}", agent.id);
                    let goal = state.goal.map_or(-1, |goal| run.timeline().setting.frame.index(goal) as i64);
                    assert_eq!((goals[step], cells[step]), (goal, i64::from(stats.cells)), "{} at {time}", agent.id);
                }
            }
        }
        assert!(moved > 1000, "these runs cannot tell");
    }
}
