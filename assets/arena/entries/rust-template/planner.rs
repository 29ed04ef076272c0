// A planner for `wildfire`: the shortest Reeds-Shepp curve where it is free, otherwise an RRT of such curves, in Rust
// without crates.
//
// Build it:    rustc -O --edition 2021 -o planner FILE
// Try it:      wildfire run contest --command mine=./planner --set unimog.planner=mine
// Compare it:  wildfire plan --planner mine,prm-rs --command mine=./planner --goals 20
//
// As a WebAssembly module, with the same answers and the same count of instructions on every computer:
//   rustup target add wasm32-wasip1
//   rustc --edition 2024 -O --target wasm32-wasip1 FILE -o mine.wasm
//   wildfire run contest --module mine=mine.wasm --set unimog.planner=mine
//
// The simulation writes one query per line to stdin, this program writes one answer per line to stdout, both JSON. Print
// your own messages to stderr (`eprintln!`). Metres; radians counter-clockwise from east; a pose is that of the middle of
// the rear axle. `wildfire schema planner-protocol` describes every message. A planner in Rust can also be part of the
// program itself, which is faster and has its collision checks: see the guide, "Your own planner".

use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
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

/// Tried for a query unless the setting `curves` says otherwise: counted effort repeats, time does not.
const CURVES: usize = 1000;
/// Metres, the most that the tree grows by at once.
const STEP: f64 = 15.0;
/// Metres kept from bushes and border; the rules ask for 0.01 m.
const MARGIN: f64 = 0.1;
/// Metres; gaps are measured up to here, so that only a few bushes near the truck are looked at.
const FAR: f64 = 2.0;

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
        if curvature == 0.0 {
            return self.ahead(length);
        }
        let turned = self.heading + curvature * length;
        let (x, y) = (turned.sin() - self.heading.sin(), turned.cos() - self.heading.cos());
        Self { x: self.x + x / curvature, y: self.y - y / curvature, heading: turned }
    }

    fn ahead(self, metres: f64) -> Self {
        Self { x: self.x + metres * self.heading.cos(), y: self.y + metres * self.heading.sin(), ..self }
    }

    fn distance(self, x: f64, y: f64) -> f64 {
        (self.x - x).hypot(self.y - y)
    }
}

fn length_of(segments: &[Motion]) -> f64 {
    segments.iter().map(|motion| motion.length.abs()).sum()
}

struct Goal {
    is_pose: bool,
    x: f64,
    y: f64,
    /// The heading of a pose, the radius of a disc.
    last: f64,
}

struct Field {
    cell: f64,
    cols: usize,
    rows: usize,
    width: f64,
    height: f64,
    bush: Vec<bool>,
    radius: f64,
    half_length: f64,
    half_width: f64,
    /// From the rear axle forward to the body's centre.
    to_centre: f64,
    /// While the rear axle drives 1 m, no point of the body moves by more than the outer corner does in a turn.
    stretch: f64,
    /// Bushes within FAR of the body are at most so many cells from the one in which its centre is.
    ring: usize,
    seed: f64,
}

/// What was driven of some segments, the pose there, and whether the goal or the end of the segments was reached.
struct Drive {
    driven: Vec<Motion>,
    pose: Pose,
    is_done: bool,
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
        let [cell, radius] = [message.get("cell_m").number, vehicle.get("min_turn_radius").number];
        let [half_length, half_width] = ["length", "width"].map(|name| vehicle.get(name).number / 2.0);
        let to_centre = half_length - vehicle.get("rear_overhang").number;
        let (width, height) = (cols as f64 * cell, rows as f64 * cell);
        let stretch = (1.0 + half_width / radius).hypot((to_centre.abs() + half_length) / radius);
        let ring = ((half_length.hypot(half_width) + FAR) / cell).ceil() as usize;
        let seed = message.get("seed").number;
        Self { cell, cols, rows, width, height, bush, radius, half_length, half_width, to_centre, stretch, ring, seed }
    }

    /// A lower bound on the distance from the body to bushes and border, FAR at most; negative if they meet. Two
    /// rectangles are apart if they are so along a side of one of them (the separating axis theorem), and at least as far
    /// as that.
    fn gap(&self, pose: Pose) -> f64 {
        let (Pose { x, y, .. }, half) = (pose.ahead(self.to_centre), self.cell / 2.0);
        let (sin, cos) = pose.heading.sin_cos();
        // Half the body's extent along the axes of the field, and half a bush's along those of the body.
        let east = self.half_length * cos.abs() + self.half_width * sin.abs();
        let north = self.half_length * sin.abs() + self.half_width * cos.abs();
        let turned = half * (cos.abs() + sin.abs());
        let border = [x - east, self.width - x - east, y - north, self.height - y - north];
        let mut gap = border.into_iter().fold(FAR, f64::min);
        if gap < 0.0 {
            return gap; // outside there are no cells
        }
        let around = |middle: f64, most: usize| {
            let cell = (middle / self.cell) as usize;
            cell.saturating_sub(self.ring)..=(cell + self.ring).min(most - 1)
        };
        for row in around(y, self.rows) {
            for col in around(x, self.cols).filter(|col| self.bush[row * self.cols + col]) {
                let (dx, dy) = ((col as f64 + 0.5) * self.cell - x, (row as f64 + 0.5) * self.cell - y);
                let along_field = (dx.abs() - east - half).max(dy.abs() - north - half);
                let along_body = (dx * cos + dy * sin).abs() - self.half_length - turned;
                let across_body = (dy * cos - dx * sin).abs() - self.half_width - turned;
                gap = gap.min(along_field.max(along_body).max(across_body));
            }
        }
        gap
    }

    /// Returns whether the truck's centre is in the goal, if that is a disc; curves to a pose end there anyway.
    fn is_in_disc(&self, pose: Pose, goal: &Goal) -> bool {
        !goal.is_pose && pose.ahead(self.to_centre).distance(goal.x, goal.y) < goal.last - 0.01
    }

    /// Drives along segments until the body is not free, the goal is reached or `most` metres are driven.
    fn drive(&self, mut pose: Pose, segments: &[Motion], goal: &Goal, mut most: f64) -> Drive {
        let (mut driven, mut gap) = (Vec::new(), self.gap(pose));
        for &Motion { curvature, length } in segments {
            let (begin, whole) = (pose, length.abs());
            let (mut done, mut is_there) = (0.0, false);
            while done < whole {
                is_there = self.is_in_disc(pose, goal);
                // Nothing can be hit before the gap is used up, so that there is nothing to check on the way there.
                let to = (done + gap.max(MARGIN) / self.stretch).min(whole);
                let after = begin.after(Motion { curvature, length: to.copysign(length) });
                gap = self.gap(after);
                if is_there || gap < MARGIN || to > most {
                    break;
                }
                (pose, done) = (after, to);
            }
            if done > 0.0 {
                driven.push(Motion { curvature, length: done.copysign(length) });
            }
            if done < whole {
                return Drive { driven, pose, is_done: is_there };
            }
            most -= done;
        }
        Drive { driven, pose, is_done: true }
    }
}

// ---- Reeds-Shepp curves (Reeds and Shepp, 1990) --------------------------------------------------------------------

/// Keeps the shortest of many curves. A part is a side (1 a left arc, -1 a right arc, 0 a straight) and a length, which
/// is negative in reverse.
struct Shortest {
    /// -1 while curves are those to the mirrored end.
    side: f64,
    length: f64,
    parts: Vec<Motion>,
}

impl Shortest {
    fn add<const PARTS: usize>(&mut self, curve: [(f64, f64); PARTS]) {
        let parts = curve.map(|(side, length)| {
            // Either way round a circle ends in the same pose; the shorter is taken.
            let round = if side == 0.0 { 0.0 } else { (length / TAU).round() };
            Motion { curvature: self.side * side, length: length - TAU * round }
        });
        if length_of(&parts) < self.length {
            (self.length, self.parts) = (length_of(&parts), parts.to_vec());
        }
    }

    /// Adds the curves from (0, 0, 0) to (x, y, turn) that begin with a left arc, for a turning radius of 1.
    ///
    /// Every formula solves the same equation. The centre of the first circle is (0, 1), that of the last one follows
    /// from the goal, and the parts in between lead from one to the other: a straight adds its length times a unit
    /// vector, two circles that touch add 2. Not every curve here is the shortest of its kind, but each ends in the goal,
    /// and the shortest of all is among them.
    fn add_from_left(&mut self, x: f64, y: f64, turn: f64) {
        const LEFT: f64 = 1.0;
        const RIGHT: f64 = -1.0;
        // The last circle is to the left of the goal, `d` from the first in the direction `angle`.
        let (dx, dy) = (x - turn.sin(), y - 1.0 + turn.cos());
        let (d, angle) = (dx.hypot(dy), dy.atan2(dx));
        // The direction of the straight, and its heading.
        for (sign, along) in [(1.0, angle), (-1.0, angle + PI)] {
            let quarter = sign * FRAC_PI_2;
            self.add([(LEFT, along), (0.0, sign * d), (LEFT, turn - along)]);
            if d >= 2.0 {
                // A quarter circle to the right before or after the straight.
                let straight = sign * (d * d - 4.0).sqrt();
                let offset = 2f64.atan2(straight);
                let (head, rest) = (angle - offset, straight - 2.0 * sign);
                self.add([(LEFT, head + quarter), (RIGHT, quarter), (0.0, rest), (LEFT, turn - head)]);
                let head = angle + offset;
                self.add([(LEFT, head), (0.0, rest), (RIGHT, quarter), (LEFT, turn - head + quarter)]);
            }
            if d <= 4.0 {
                // No straight, but a circle that touches both others.
                let half = sign * (d / 4.0).asin();
                let first = along + half;
                self.add([(LEFT, first), (RIGHT, 2.0 * half), (LEFT, turn - first + 2.0 * half)]);
            }
        }
        // The last circle is to the right of the goal.
        let (dx, dy) = (x + turn.sin(), y - 1.0 - turn.cos());
        let (d, angle) = (dx.hypot(dy), dy.atan2(dx));
        for (sign, along) in [(1.0, angle), (-1.0, angle + PI)] {
            let (quarter, rest) = (sign * FRAC_PI_2, sign * (d - 2.0));
            self.add([(LEFT, along + quarter), (RIGHT, quarter), (0.0, rest), (RIGHT, along - turn)]);
            self.add([(LEFT, along), (0.0, rest), (LEFT, quarter), (RIGHT, along + quarter - turn)]);
            if d >= 2.0 {
                let straight = sign * (d * d - 4.0).sqrt();
                let offset = 2f64.atan2(straight);
                let head = angle + offset;
                self.add([(LEFT, head), (0.0, straight), (RIGHT, head - turn)]);
                // Quarter circles before and after the straight.
                let (head, rest) = (angle - offset + quarter, straight - 4.0 * sign);
                self.add([(LEFT, head), (RIGHT, quarter), (0.0, rest), (LEFT, quarter), (RIGHT, head - turn)]);
            }
            if d <= 2.0 {
                // Two circles in between, driven equally far, one forward and one in reverse.
                let (middle, head) = (sign * ((2.0 + d) / 4.0).acos(), angle + FRAC_PI_2);
                self.add([(LEFT, head + middle), (RIGHT, middle), (LEFT, -middle), (RIGHT, head - middle - turn)]);
            } else if d <= 6.0 {
                // Two circles in between, driven equally far in one direction.
                let middle = sign * ((20.0 - d * d) / 16.0).acos();
                let first = angle + FRAC_PI_2 - (2.0 * middle.sin()).atan2(4.0 - 2.0 * middle.cos());
                self.add([(LEFT, first), (RIGHT, middle), (LEFT, middle), (RIGHT, first - turn)]);
            }
        }
    }
}

fn shortest_curve(start: Pose, end: Pose, radius: f64) -> Vec<Motion> {
    let (dx, dy) = ((end.x - start.x) / radius, (end.y - start.y) / radius);
    let (sin, cos) = start.heading.sin_cos();
    let (x, y, turn) = (dx * cos + dy * sin, dy * cos - dx * sin, end.heading - start.heading);
    let mut shortest = Shortest { side: 1.0, length: f64::INFINITY, parts: Vec::new() };
    shortest.add_from_left(x, y, turn);
    // Curves that begin with a right arc are those to the mirrored end, mirrored.
    shortest.side = -1.0;
    shortest.add_from_left(x, -y, -turn);
    let parts = shortest.parts.iter().filter(|part| part.length.abs() > 1e-9);
    parts.map(|part| Motion { curvature: part.curvature / radius, length: part.length * radius }).collect()
}

// ---- The search ----------------------------------------------------------------------------------------------------

/// Random numbers by SplitMix64.
struct Random(u64);

impl Random {
    fn between(&mut self, from: f64, to: f64) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        from + (to - from) * ((bits ^ (bits >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A pose of the tree, the index of the one before, and the way from there.
struct Node {
    pose: Pose,
    before: usize,
    driven: Vec<Motion>,
}

struct Search<'a> {
    field: &'a Field,
    start: Pose,
    goal: Goal,
    random: Random,
    /// Tried so far.
    curves: usize,
}

impl Search<'_> {
    /// Finds the shortest free curve from a pose into the goal: to a disc at eight headings, since any will do there.
    fn drive_to_goal(&mut self, pose: Pose) -> Option<Vec<Motion>> {
        let Goal { is_pose, x, y, last } = self.goal;
        let aims: Vec<Pose> = match is_pose {
            true => vec![Pose { x, y, heading: last }],
            false => (0..8)
                .map(|eighth| Pose { x, y, heading: pose.heading + f64::from(eighth) * PI / 4.0 })
                .map(|centre| centre.ahead(-self.field.to_centre))
                .collect(),
        };
        self.curves += aims.len();
        let curves = aims.iter().map(|&aim| shortest_curve(pose, aim, self.field.radius));
        let drives = curves.map(|curve| self.field.drive(pose, &curve, &self.goal, f64::INFINITY));
        let free = drives.filter(|drive| drive.is_done).map(|drive| drive.driven);
        free.min_by(|a, b| length_of(a).total_cmp(&length_of(b)))
    }

    /// Finds a path from the start into the goal, or gives up after `budget` curves. Also returns how many it tried.
    fn plan(&mut self, budget: usize) -> (Option<Vec<Motion>>, usize) {
        if let Some(path) = self.drive_to_goal(self.start) {
            return (Some(path), self.curves);
        }
        let (field, start, x, y) = (self.field, self.start, self.goal.x, self.goal.y);
        let spread = 20.0 + start.distance(x, y) / 2.0;
        let mut tree = vec![Node { pose: start, before: 0, driven: Vec::new() }];
        while self.curves < budget {
            // Around start and goal, where the path probably is.
            let random = &mut self.random;
            let x = random.between(start.x.min(x) - spread, start.x.max(x) + spread);
            let y = random.between(start.y.min(y) - spread, start.y.max(y) + spread);
            let heading = random.between(0.0, TAU);
            let distance = |index: &usize| tree[*index].pose.distance(x, y);
            let nearest = (0..tree.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let before = nearest.expect("the start is in the tree");
            let from = tree[before].pose;
            let towards = shortest_curve(from, Pose { x, y, heading }, field.radius);
            let Drive { driven, pose, .. } = field.drive(from, &towards, &self.goal, STEP);
            self.curves += 1;
            if length_of(&driven) < 1.0 {
                continue;
            }
            tree.push(Node { pose, before, driven });
            let Some(mut path) = self.drive_to_goal(pose) else { continue };
            let mut index = tree.len() - 1;
            while index > 0 {
                path.splice(0..0, tree[index].driven.iter().copied());
                index = tree[index].before;
            }
            return (Some(path), self.curves);
        }
        (None, self.curves)
    }
}

fn answer(field: &Field, message: &Json, line: &str, budget: usize) -> String {
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
    let (path, expansions) = Search { field, start, goal, random: Random(seed), curves: 0 }.plan(budget);
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
    let (mut field, mut budget) = (None, CURVES);
    for line in io::stdin().lock().lines() {
        let line = line?;
        let message = Reader { rest: line.as_bytes() }.read();
        let said = match (message.get("type").text.as_str(), &field) {
            ("hello", _) => "{\"type\":\"hello\",\"protocol\":1,\"name\":\"rs-rrt\",\"version\":\"1\"}".to_owned(),
            ("field", _) => {
                field = Some(Field::new(&message));
                let asked = message.get("settings").get("curves").number;
                budget = if asked > 0.0 { asked as usize } else { budget };
                "{\"type\":\"ready\"}".to_owned()
            }
            ("plan", Some(field)) => answer(field, &message, &line, budget),
            ("end", _) => break,
            _ => continue,
        };
        // Without the flush the simulation would wait forever.
        println!("{said}");
        io::stdout().flush()?;
    }
    Ok(())
}
