//! The displayed parts of a run: cells, bodies, paths and searches.

use data_encoding::BASE64;

use crate::colours::{FIELD, INK, OBSTACLE, agent_colour, blend, bush_colour};
use crate::mcap::messages::{
    Color, CubePrimitive, FIELD_FRAME, Grid, LinePrimitive, PackedElementField, PoseMessage, SceneEntity,
    SceneEntityDeletion, SceneUpdate, TextPrimitive, Vector2, Vector3,
};
use wildfire_base::geometry::{DVec2, FieldFrame};
use wildfire_base::query::SearchGraph;
use wildfire_base::time::SimTime;
use wildfire_base::trajectory::Trajectory;
use wildfire_fire::BushStateKind;
use wildfire_timeline::{AgentStart, Body, Setting};

/// Bytes of a cell: its state, then red, green, blue and opacity.
const CELL_BYTES: usize = 5;
/// Numbers of cells by what is in them; the first four are states of bushes and ground.
const FREE: u8 = 255;
const BLOCKED: u8 = 254;
/// The share of a state's colour on ground, where bushes have it whole.
const TINT: f64 = 0.45;

/// Lines lie above the ground by this, in metres, so that they are seen.
const LINE_M: f64 = 0.3;
const WAY_PIXELS: f64 = 2.0;
const SEARCH_PIXELS: f64 = 1.0;
/// Of a way, an arc has a point for each turn by this much, in radians, and no more than these.
const TURN_RAD: f64 = 0.05;
const MAX_ON_PIECE: f64 = 128.0;

/// The states of all cells, as a message has them.
pub struct CellGrid {
    frame: FieldFrame,
    bytes: Vec<u8>,
    is_bush: Vec<bool>,
}

impl CellGrid {
    pub fn new(setting: &Setting) -> Self {
        let frame = setting.frame;
        let mut grid = Self { frame, bytes: Vec::new(), is_bush: vec![false; frame.cell_count()] };
        let free = cell_bytes(FREE, FIELD);
        grid.bytes = free.repeat(frame.cell_count());
        setting.bushes.iter().for_each(|&bush| grid.is_bush[frame.index(bush)] = true);
        for index in 0..frame.cell_count() {
            if grid.is_bush[index] || setting.spread.is_some() && setting.is_ground(frame.cell(index)) {
                grid.set(index, BushStateKind::Intact);
            }
        }
        setting.blocked.iter().for_each(|&cell| grid.put(frame.index(cell), cell_bytes(BLOCKED, OBSTACLE)));
        grid
    }

    /// Bytes of one message, nearly.
    pub fn message_bytes(frame: FieldFrame) -> usize {
        frame.cell_count() * CELL_BYTES * 4 / 3
    }

    pub fn set(&mut self, index: usize, state: BushStateKind) {
        let colour = bush_colour(state);
        let colour = if self.is_bush[index] { colour } else { blend(FIELD, colour, TINT) };
        self.put(index, cell_bytes(state as u8, colour));
    }

    fn put(&mut self, index: usize, bytes: [u8; CELL_BYTES]) {
        self.bytes[index * CELL_BYTES..][..CELL_BYTES].copy_from_slice(&bytes);
    }

    pub fn message(&self, time: SimTime) -> Grid {
        let names = ["state", "red", "green", "blue", "alpha"];
        Grid {
            timestamp: time.into(),
            frame_id: FIELD_FRAME,
            pose: PoseMessage::at(Vector3::default()),
            column_count: self.frame.cols.into(),
            cell_size: Vector2 { x: self.frame.cell_m, y: self.frame.cell_m },
            row_stride: u32::from(self.frame.cols) * CELL_BYTES as u32,
            cell_stride: CELL_BYTES as u32,
            fields: names.into_iter().zip(0..).map(|(name, offset)| PackedElementField::byte(name, offset)).collect(),
            data: BASE64.encode(&self.bytes),
        }
    }
}

fn cell_bytes(state: u8, [red, green, blue]: [u8; 3]) -> [u8; CELL_BYTES] {
    [state, red, green, blue, u8::MAX]
}

/// All bodies, each in the frame of its agent, with their names above them.
pub fn bodies<'a>(agents: impl Iterator<Item = &'a AgentStart>) -> SceneUpdate {
    SceneUpdate { entities: agents.map(body).collect(), ..SceneUpdate::default() }
}

fn body(start: &AgentStart) -> SceneEntity {
    let name = start.id.to_string();
    let (ahead_m, length_m, width_m) = match start.body {
        Body::Square { size_m } => (0.0, size_m, size_m),
        Body::Truck(truck) => (truck.centre_offset_m(), truck.length_m, truck.width_m),
    };
    // Heights are not part of a run: bodies are as high as they are wide.
    let centre = Vector3 { x: ahead_m, y: 0.0, z: 0.5 * width_m };
    let color = Color::new(agent_colour(start.id), 1.0);
    let cube =
        CubePrimitive { pose: PoseMessage::at(centre), size: Vector3 { x: length_m, y: width_m, z: width_m }, color };
    let text = TextPrimitive {
        pose: PoseMessage::at(Vector3 { z: 2.0 * width_m, ..centre }),
        billboard: true,
        font_size: 12.0,
        scale_invariant: true,
        color,
        text: name.clone(),
    };
    let mut entity = SceneEntity::new(SimTime::ZERO, name.clone(), name);
    entity.cubes.push(cube);
    entity.texts.push(text);
    entity
}

/// The way that an agent follows from now on; it is taken away where there is none.
pub fn way(time: SimTime, start: &AgentStart, leg: &Trajectory) -> SceneUpdate {
    let points = points(leg);
    let color = Color::new(agent_colour(start.id), 0.9);
    lines(time, format!("{}/way", start.id), LinePrimitive::strip(points, WAY_PIXELS, color))
}

/// What a search looked at.
pub fn search(time: SimTime, id: String, graph: &SearchGraph) -> SceneUpdate {
    let points = graph.lines().flatten().map(|place| Vector3::on_ground(place, LINE_M)).collect();
    lines(time, id, LinePrimitive::list(points, SEARCH_PIXELS, Color::new(INK, 0.5)))
}

fn lines(time: SimTime, id: String, line: LinePrimitive) -> SceneUpdate {
    if line.is_empty() {
        return SceneUpdate { deletions: vec![SceneEntityDeletion::new(time, id)], ..SceneUpdate::default() };
    }
    let mut entity = SceneEntity::new(time, FIELD_FRAME.to_owned(), id);
    entity.lines.push(line);
    SceneUpdate { entities: vec![entity], ..SceneUpdate::default() }
}

/// Points on a leg, from its start to its end; none where it leads nowhere.
fn points(leg: &Trajectory) -> Vec<Vector3> {
    let mut places: Vec<DVec2> = Vec::new();
    for (start, piece) in leg.pieces_with_starts() {
        let Some(segment) = piece.segment() else { continue };
        if places.is_empty() {
            places.push(start.position());
        }
        let steps = ((segment.curvature * segment.length_m).abs() / TURN_RAD).ceil().clamp(1.0, MAX_ON_PIECE);
        let shares = (1..=steps as u32).map(|step| f64::from(step) / steps);
        places.extend(shares.map(|share| segment.pose_at(start, share * segment.length_m).position()));
    }
    places.into_iter().map(|place| Vector3::on_ground(place, LINE_M)).collect()
}
