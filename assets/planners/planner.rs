// A planner for `wildfire`: an RRT of motions that the truck can drive, in Rust without crates.
//
// Build it:    rustc -O --edition 2021 -o planner FILE
// Try it:      wildfire run contest --command mine=./planner --set unimog.planner=mine
// Compare it:  wildfire plan --planner mine,prm-rs --command mine=./planner --goals 20
//
// The simulation writes a question a line to stdin, this program an answer a line to stdout, both JSON. What you print
// for yourself goes to stderr (`eprintln!`). Metres; radians counter-clockwise from east; a pose is that of the middle of
// the rear axle. `wildfire schema planner-protocol` describes every message. A planner in Rust can also be part of the
// program itself, which is faster and has its collision checks: see the guide, "Your own planner".

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io::{self, BufRead, Write};

// ---- JSON, as much as the messages need ----------------------------------------------------------------------------

#[derive(Default)]
struct Json {
    number: f64,
    text: String,
    list: Vec<Json>,
    members: BTreeMap<String, Json>,
}

impl Json {
    /// Returns a member, or one with nothing in it.
    fn get(&self, name: &str) -> &Json {
        static NOTHING: Json =
            Json { number: 0.0, text: String::new(), list: Vec::new(), members: BTreeMap::new() };
        self.members.get(name).unwrap_or(&NOTHING)
    }

    fn numbers(&self) -> Vec<f64> {
        self.list.iter().map(|item| item.number).collect()
    }
}

struct Reader<'a> {
    rest: &'a [u8],
}

impl Reader<'_> {
    fn peek(&mut self) -> u8 {
        self.rest = self.rest.trim_ascii_start();
        self.rest.first().copied().unwrap_or(0)
    }

    fn take(&mut self, wanted: u8) -> bool {
        let is_there = self.peek() == wanted;
        self.rest = &self.rest[usize::from(is_there)..];
        is_there
    }

    /// Takes bytes while they are wanted.
    fn while_in(&mut self, is_wanted: impl Fn(u8) -> bool) -> String {
        let end = self.rest.iter().position(|&byte| !is_wanted(byte)).unwrap_or(self.rest.len());
        let (taken, rest) = self.rest.split_at(end);
        self.rest = rest;
        String::from_utf8_lossy(taken).into_owned()
    }

    /// Reads a text; escapes are rare in what planners are told, and are not resolved.
    fn read_text(&mut self) -> String {
        self.take(b'"');
        let text = self.while_in(|byte| byte != b'"');
        self.take(b'"');
        text
    }

    fn read(&mut self) -> Json {
        let mut value = Json::default();
        match self.peek() {
            b'{' => {
                self.take(b'{');
                while !self.take(b'}') && !self.rest.is_empty() {
                    self.peek();
                    let name = self.read_text();
                    self.take(b':');
                    value.members.insert(name, self.read());
                    self.take(b',');
                }
            }
            b'[' => {
                self.take(b'[');
                while !self.take(b']') && !self.rest.is_empty() {
                    value.list.push(self.read());
                    self.take(b',');
                }
            }
            b'"' => value.text = self.read_text(),
            letter if letter.is_ascii_alphabetic() => value.text = self.while_in(|byte| byte.is_ascii_alphabetic()),
            _ => match self.while_in(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte)) {
                number if number.is_empty() => self.rest = &self.rest[self.rest.len().min(1)..],
                number => value.number = number.parse().unwrap_or(0.0),
            },
        }
        value
    }
}

// ---- The field and the truck ---------------------------------------------------------------------------------------

#[derive(Clone, Copy)]
struct Pose {
    x: f64,
    y: f64,
    heading: f64,
}

#[derive(Clone, Copy)]
struct Motion {
    /// 1/m, positive to the left.
    curvature: f64,
    /// Metres, negative in reverse.
    length: f64,
}

impl Pose {
    fn after(self, Motion { curvature, length }: Motion) -> Self {
        let turned = self.heading + curvature * length;
        let (sin, cos) = self.heading.sin_cos();
        if curvature == 0.0 {
            return Self { x: self.x + length * cos, y: self.y + length * sin, heading: turned };
        }
        let (x, y) = ((turned.sin() - sin) / curvature, (turned.cos() - cos) / curvature);
        Self { x: self.x + x, y: self.y - y, heading: turned }
    }

    fn ahead(self, metres: f64) -> (f64, f64) {
        (self.x + metres * self.heading.cos(), self.y + metres * self.heading.sin())
    }
}

struct Field {
    cell: f64,
    cols: usize,
    rows: usize,
    bush: Vec<bool>,
    radius: f64,
    length: f64,
    /// From the rear axle forward to the body's centre.
    to_centre: f64,
    /// The radius of the three discs that cover the body, with a margin for what lies between poses that are checked.
    disc: f64,
    seed: f64,
}

impl Field {
    fn new(message: &Json) -> Self {
        let (cols, rows) = (message.get("cols").number as usize, message.get("rows").number as usize);
        let mut bush = vec![false; cols * rows];
        for cell in &message.get("cells_cr").list {
            let at = cell.numbers();
            bush[at[1] as usize * cols + at[0] as usize] = true;
        }
        let vehicle = message.get("vehicle");
        let length = vehicle.get("length").number;
        Self {
            cell: message.get("cell_m").number,
            cols,
            rows,
            bush,
            radius: vehicle.get("min_turn_radius").number,
            length,
            to_centre: length / 2.0 - vehicle.get("rear_overhang").number,
            disc: (length / 6.0).hypot(vehicle.get("width").number / 2.0) + 0.3,
            seed: message.get("seed").number,
        }
    }

    fn disc_is_free(&self, (x, y): (f64, f64)) -> bool {
        let (width, height) = (self.cols as f64 * self.cell, self.rows as f64 * self.cell);
        if x <= self.disc || x >= width - self.disc || y <= self.disc || y >= height - self.disc {
            return false;
        }
        let cells = |middle: f64, most: usize| {
            let (from, to) = ((middle - self.disc) / self.cell, (middle + self.disc) / self.cell);
            from as usize..=(to as usize).min(most - 1)
        };
        cells(x, self.cols).all(|col| {
            cells(y, self.rows).all(|row| {
                // The point of the bush's cell that is nearest to the disc's centre.
                let near = |at: f64, cell: usize| at.clamp(cell as f64 * self.cell, (cell + 1) as f64 * self.cell);
                !self.bush[row * self.cols + col] || (x - near(x, col)).hypot(y - near(y, row)) >= self.disc
            })
        })
    }

    /// Says whether the body keeps clear of bushes and border. It is stricter than it must be, never less strict.
    fn is_free(&self, pose: Pose) -> bool {
        let thirds = [-1.0, 0.0, 1.0].map(|third| self.to_centre + third * self.length / 3.0);
        thirds.iter().all(|&along| self.disc_is_free(pose.ahead(along)))
    }

    fn motion_is_free(&self, pose: Pose, motion: Motion) -> bool {
        let steps = (motion.length.abs() / 0.4).ceil().max(1.0) as usize;
        (1..=steps).all(|step| {
            let length = motion.length * step as f64 / steps as f64;
            self.is_free(pose.after(Motion { length, ..motion }))
        })
    }
}

struct Goal {
    is_pose: bool,
    x: f64,
    y: f64,
    /// The heading of a pose, the radius of a disc.
    last: f64,
}

impl Goal {
    /// Distance from the point of the truck that counts: its centre for a disc, its rear axle for a pose.
    fn distance(&self, field: &Field, pose: Pose, (x, y): (f64, f64)) -> f64 {
        let place = pose.ahead(if self.is_pose { 0.0 } else { field.to_centre });
        (place.0 - x).hypot(place.1 - y)
    }

    fn is_met(&self, field: &Field, pose: Pose) -> bool {
        let distance = self.distance(field, pose, (self.x, self.y));
        if !self.is_pose {
            return distance < self.last - 0.01;
        }
        // This planner ends in poses only by luck; the rules allow 1 mm and 0.001 rad.
        let turned = (pose.heading - self.last).rem_euclid(TAU);
        distance < 0.001 && turned.min(TAU - turned) < 0.001
    }
}

// ---- The search ----------------------------------------------------------------------------------------------------

/// Random numbers by SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, most: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        most * ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Grows a tree of poses from the start, by motions towards random points, until one is in the goal. Returns the path if
/// there is one, and how often the tree was to grow.
fn plan(field: &Field, start: Pose, goal: &Goal, budget: u32, mut random: Random) -> (Option<Vec<Motion>>, u32) {
    if goal.is_met(field, start) {
        return (Some(Vec::new()), 0);
    }
    // Poses, each with the index of the one before and the motion from there.
    let mut tree = vec![(start, 0, Motion { curvature: 0.0, length: 0.0 })];
    let turns = [0.0, 1.0 / field.radius, -1.0 / field.radius];
    let motions: Vec<Motion> =
        turns.iter().flat_map(|&curvature| [4.0, -4.0].map(|length| Motion { curvature, length })).collect();
    for expansion in 1..=budget {
        let point = match random.below(1.0) < 0.2 {
            true => (goal.x, goal.y),
            false => (random.below(field.cols as f64 * field.cell), random.below(field.rows as f64 * field.cell)),
        };
        let distance = |pose: Pose| goal.distance(field, pose, point);
        // From the pose of the tree that is nearest to the point, the motion that brings it nearest.
        let nearest = (0..tree.len()).min_by(|&a, &b| distance(tree[a].0).total_cmp(&distance(tree[b].0)));
        let nearest = nearest.expect("the start is in the tree");
        let from = tree[nearest].0;
        let free = motions.iter().filter(|&&motion| field.motion_is_free(from, motion));
        let best = free.min_by(|a, b| distance(from.after(**a)).total_cmp(&distance(from.after(**b))));
        let Some(&motion) = best else { continue };
        tree.push((from.after(motion), nearest, motion));
        if goal.is_met(field, from.after(motion)) {
            let (mut path, mut index) = (Vec::new(), tree.len() - 1);
            while index > 0 {
                path.push(tree[index].2);
                index = tree[index].1;
            }
            path.reverse();
            return (Some(path), expansion);
        }
    }
    (None, budget)
}

fn answer(field: &Field, message: &Json, line: &str, budget: u32) -> String {
    let start = message.get("start").numbers();
    let start = Pose { x: start[0], y: start[1], heading: start[2] };
    let is_pose = message.get("goal").members.contains_key("pose");
    let to = message.get("goal").get(if is_pose { "pose" } else { "disc" }).numbers();
    let goal = Goal { is_pose, x: to[0], y: to[1], last: to[2] };
    // A seed for each query, and a budget that is counted: the same question gets the same answer.
    let question = &line[line.find("\"start\"").unwrap_or(0)..];
    let seed = question.bytes().fold(field.seed as u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3)
    });
    let (path, expansions) = plan(field, start, &goal, budget, Random(seed));
    let id = message.get("id").number;
    match path {
        Some(path) => {
            let segments: Vec<String> =
                path.iter().map(|motion| format!("[{},{}]", motion.curvature, motion.length)).collect();
            let segments = segments.join(",");
            format!("{{\"type\":\"path\",\"id\":{id},\"expansions\":{expansions},\"segments\":[{segments}]}}")
        }
        None => format!("{{\"type\":\"none\",\"id\":{id},\"expansions\":{expansions},\"reason\":\"budget-spent\"}}"),
    }
}

fn main() -> io::Result<()> {
    let (mut field, mut budget) = (None, 5000);
    for line in io::stdin().lock().lines() {
        let line = line?;
        let message = Reader { rest: line.as_bytes() }.read();
        let said = match (message.get("type").text.as_str(), &field) {
            ("hello", _) => "{\"type\":\"hello\",\"protocol\":1,\"name\":\"rrt\",\"version\":\"1\"}".to_owned(),
            ("field", _) => {
                field = Some(Field::new(&message));
                let asked = message.get("settings").get("iterations").number;
                budget = if asked > 0.0 { asked as u32 } else { budget };
                "{\"type\":\"ready\"}".to_owned()
            }
            ("plan", Some(field)) => answer(field, &message, &line, budget),
            ("end", _) => break,
            _ => continue,
        };
        // Without the flush the simulation would wait for ever.
        println!("{said}");
        io::stdout().flush()?;
    }
    Ok(())
}
