//! Messages by the well-known schemas of Foxglove, and two of this program's own.
//!
//! Source: "Foxglove schemas" (docs.foxglove.dev/docs/sdk/schemas): names and types of members are theirs, as far as they are
//! used here. Viewers know the messages by the names of their schemas; the schemas themselves are made from these types.

use schemars::JsonSchema;
use schemars::generate::SchemaSettings;
use serde::Serialize;

use crate::Rgb;
use wildfire_base::geometry::{DVec2, Pose, ops};
use wildfire_base::time::SimTime;

/// The frame of the field: metres east and north of its south-west corner, z up.
pub const FIELD_FRAME: &str = "field";

const NANOS_PER_SECOND: u64 = 1_000_000_000;

/// A message that viewers know by the name of its schema.
pub trait Message: Serialize + JsonSchema {
    const SCHEMA: &'static str;

    /// Returns its JSON Schema without references, which readers of such files do not follow.
    fn schema_text() -> String {
        let generator = SchemaSettings::draft07().with(|settings| settings.inline_subschemas = true).into_generator();
        let mut schema = generator.into_root_schema_for::<Self>();
        schema.insert("title".to_owned(), Self::SCHEMA.into());
        serde_json::to_string(&schema).expect("a schema is JSON")
    }
}

#[derive(Clone, Copy, Serialize, JsonSchema)]
#[schemars(title = "time")]
pub struct Time {
    sec: u64,
    nsec: u32,
}

impl From<SimTime> for Time {
    fn from(time: SimTime) -> Self {
        let nanos = time.as_nanos();
        Self { sec: nanos / NANOS_PER_SECOND, nsec: (nanos % NANOS_PER_SECOND) as u32 }
    }
}

/// 0 is forever.
#[derive(Clone, Copy, Default, Serialize, JsonSchema)]
#[schemars(title = "duration")]
pub struct Duration {
    sec: i32,
    nsec: u32,
}

#[derive(Clone, Copy, Default, Serialize, JsonSchema)]
pub struct Vector2 {
    pub x: f64,
    pub y: f64,
}

#[derive(Clone, Copy, Default, Serialize, JsonSchema)]
pub struct Vector3 {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

impl Vector3 {
    pub fn on_ground(place: DVec2, z: f64) -> Self {
        Self { x: place.x, y: place.y, z }
    }
}

#[derive(Clone, Copy, Serialize, JsonSchema)]
pub struct Quaternion {
    x: f64,
    y: f64,
    z: f64,
    w: f64,
}

impl Quaternion {
    const NONE: Self = Self { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };

    /// The turn to a heading.
    pub fn from_heading(heading: f64) -> Self {
        let (z, w) = ops::sin_cos(0.5 * heading);
        Self { z, w, ..Self::NONE }
    }
}

#[derive(Clone, Copy, Serialize, JsonSchema)]
pub struct PoseMessage {
    pub position: Vector3,
    pub orientation: Quaternion,
}

impl PoseMessage {
    pub fn at(position: Vector3) -> Self {
        Self { position, orientation: Quaternion::NONE }
    }
}

/// From 0 to 1.
#[derive(Clone, Copy, Serialize, JsonSchema)]
pub struct Color {
    r: f64,
    g: f64,
    b: f64,
    a: f64,
}

impl Color {
    pub fn new([r, g, b]: Rgb, a: f64) -> Self {
        let [r, g, b] = [r, g, b].map(|channel| f64::from(channel) / 255.0);
        Self { r, g, b, a }
    }
}

/// The frame of an agent in that of the field.
#[derive(Serialize, JsonSchema)]
pub struct FrameTransform {
    timestamp: Time,
    parent_frame_id: &'static str,
    child_frame_id: String,
    translation: Vector3,
    rotation: Quaternion,
}

impl Message for FrameTransform {
    const SCHEMA: &'static str = "foxglove.FrameTransform";
}

impl FrameTransform {
    pub fn new(time: SimTime, child_frame_id: String, pose: Pose) -> Self {
        Self {
            timestamp: time.into(),
            parent_frame_id: FIELD_FRAME,
            child_frame_id,
            translation: Vector3::on_ground(pose.position(), 0.0),
            rotation: Quaternion::from_heading(pose.heading),
        }
    }
}

/// Values of the cells of the field, from the south-west corner row by row.
#[derive(Serialize, JsonSchema)]
pub struct Grid {
    pub timestamp: Time,
    pub frame_id: &'static str,
    pub pose: PoseMessage,
    pub column_count: u32,
    pub cell_size: Vector2,
    pub row_stride: u32,
    pub cell_stride: u32,
    pub fields: Vec<PackedElementField>,
    /// The bytes of all cells in base64.
    #[schemars(extend("contentEncoding" = "base64"))]
    pub data: String,
}

impl Message for Grid {
    const SCHEMA: &'static str = "foxglove.Grid";
}

/// A number in the bytes of a cell.
#[derive(Clone, Copy, Serialize, JsonSchema)]
pub struct PackedElementField {
    name: &'static str,
    offset: u32,
    /// 1 is an unsigned number of 8 bits.
    #[serde(rename = "type")]
    kind: u8,
}

impl PackedElementField {
    const UINT8: u8 = 1;

    pub fn byte(name: &'static str, offset: u32) -> Self {
        Self { name, offset, kind: Self::UINT8 }
    }
}

/// Things that are to be shown from now on, or no more.
#[derive(Default, Serialize, JsonSchema)]
pub struct SceneUpdate {
    pub deletions: Vec<SceneEntityDeletion>,
    pub entities: Vec<SceneEntity>,
}

impl Message for SceneUpdate {
    const SCHEMA: &'static str = "foxglove.SceneUpdate";
}

#[derive(Serialize, JsonSchema)]
pub struct SceneEntityDeletion {
    timestamp: Time,
    /// 0: that of this name.
    #[serde(rename = "type")]
    kind: u8,
    id: String,
}

impl SceneEntityDeletion {
    pub fn new(time: SimTime, id: String) -> Self {
        Self { timestamp: time.into(), kind: 0, id }
    }
}

/// A thing in the scene; it takes the place of an older one of its name.
#[derive(Serialize, JsonSchema)]
pub struct SceneEntity {
    timestamp: Time,
    frame_id: String,
    id: String,
    lifetime: Duration,
    /// Whether it goes where its frame goes.
    frame_locked: bool,
    metadata: Vec<KeyValuePair>,
    arrows: Vec<OtherPrimitive>,
    pub cubes: Vec<CubePrimitive>,
    spheres: Vec<OtherPrimitive>,
    cylinders: Vec<OtherPrimitive>,
    pub lines: Vec<LinePrimitive>,
    triangles: Vec<OtherPrimitive>,
    pub texts: Vec<TextPrimitive>,
    models: Vec<OtherPrimitive>,
}

impl SceneEntity {
    /// Makes a thing in a frame, with nothing to show yet.
    pub fn new(time: SimTime, frame_id: String, id: String) -> Self {
        Self {
            timestamp: time.into(),
            frame_id,
            id,
            // A lifetime of zero has no end.
            lifetime: Duration::default(),
            frame_locked: true,
            metadata: Vec::new(),
            arrows: Vec::new(),
            cubes: Vec::new(),
            spheres: Vec::new(),
            cylinders: Vec::new(),
            lines: Vec::new(),
            triangles: Vec::new(),
            texts: Vec::new(),
            models: Vec::new(),
        }
    }
}

#[derive(Serialize, JsonSchema)]
struct KeyValuePair {
    key: String,
    value: String,
}

/// A kind of thing that these scenes do without.
#[derive(Serialize, JsonSchema)]
struct OtherPrimitive {}

#[derive(Serialize, JsonSchema)]
pub struct CubePrimitive {
    pub pose: PoseMessage,
    pub size: Vector3,
    pub color: Color,
}

#[derive(Serialize, JsonSchema)]
pub struct LinePrimitive {
    /// 0: from point to point; 2: each two points are a line.
    #[serde(rename = "type")]
    kind: u8,
    pose: PoseMessage,
    thickness: f64,
    /// Whether the thickness is in pixels.
    scale_invariant: bool,
    points: Vec<Vector3>,
    color: Color,
    colors: Vec<Color>,
    indices: Vec<u32>,
}

impl LinePrimitive {
    const LINE_STRIP: u8 = 0;
    const LINE_LIST: u8 = 2;

    pub fn strip(points: Vec<Vector3>, pixels: f64, color: Color) -> Self {
        Self::new(Self::LINE_STRIP, points, pixels, color)
    }

    pub fn list(points: Vec<Vector3>, pixels: f64, color: Color) -> Self {
        Self::new(Self::LINE_LIST, points, pixels, color)
    }

    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    fn new(kind: u8, points: Vec<Vector3>, thickness: f64, color: Color) -> Self {
        let pose = PoseMessage::at(Vector3::default());
        Self { kind, pose, thickness, scale_invariant: true, points, color, colors: Vec::new(), indices: Vec::new() }
    }
}

#[derive(Serialize, JsonSchema)]
pub struct TextPrimitive {
    pub pose: PoseMessage,
    /// Whether it faces whoever looks at it.
    pub billboard: bool,
    pub font_size: f64,
    /// Whether this size is in pixels.
    pub scale_invariant: bool,
    pub color: Color,
    pub text: String,
}

/// A line of a log.
#[derive(Serialize, JsonSchema)]
pub struct Log {
    timestamp: Time,
    /// 2 is information.
    level: u8,
    message: String,
    /// Who it is about, or nobody.
    name: String,
    file: String,
    line: u32,
}

impl Message for Log {
    const SCHEMA: &'static str = "foxglove.Log";
}

impl Log {
    const INFO: u8 = 2;

    pub fn new(time: SimTime, name: String, message: String) -> Self {
        Self { timestamp: time.into(), level: Self::INFO, message, name, file: String::new(), line: 0 }
    }
}

/// An agent, for plots and tables.
#[derive(Serialize, JsonSchema)]
pub struct AgentMessage {
    pub x_m: f64,
    pub y_m: f64,
    pub heading_rad: f64,
    pub speed_mps: f64,
    pub activity: &'static str,
    /// Column and row of the cell that it goes for, or -1.
    pub goal_col: i32,
    pub goal_row: i32,
}

impl Message for AgentMessage {
    const SCHEMA: &'static str = "wildfire.Agent";
}

/// How many bushes are in each state, how much ground burns, and the points, for plots.
#[derive(Serialize, JsonSchema)]
pub struct CountsMessage {
    pub intact: u32,
    pub burning: u32,
    pub burned_out: u32,
    pub extinguished: u32,
    pub ground_burning: u32,
    pub wumpus_score: f64,
    pub truck_score: f64,
}

impl Message for CountsMessage {
    const SCHEMA: &'static str = "wildfire.Counts";
}

#[cfg(test)]
mod tests {
    use serde_json::Value as Json;

    use super::*;

    /// Checks that a schema is written as readers of such files understand it.
    fn assert_plain(schema: &Json) {
        if let Some(object) = schema.as_object() {
            assert!(!object.contains_key("$ref") && !object.contains_key("anyOf"), "{schema}");
            if let Some(kind) = object.get("type") {
                assert!(kind.is_string() || kind.is_object(), "{schema}");
            }
            object.values().for_each(assert_plain);
        }
    }

    #[test]
    fn schemas_need_no_references_and_have_their_names() {
        let schemas = [
            (FrameTransform::SCHEMA, FrameTransform::schema_text()),
            (Grid::SCHEMA, Grid::schema_text()),
            (SceneUpdate::SCHEMA, SceneUpdate::schema_text()),
            (Log::SCHEMA, Log::schema_text()),
            (AgentMessage::SCHEMA, AgentMessage::schema_text()),
            (CountsMessage::SCHEMA, CountsMessage::schema_text()),
        ];
        for (name, text) in schemas {
            let schema: Json = serde_json::from_str(&text).expect("it is JSON");
            assert_eq!(schema["title"], name);
            assert_eq!(schema["type"], "object");
            assert_plain(&schema);
        }
        let grid: Json = serde_json::from_str(&Grid::schema_text()).expect("it is JSON");
        assert_eq!(grid["properties"]["data"]["contentEncoding"], "base64");
        assert_eq!(grid["properties"]["timestamp"]["properties"]["nsec"]["type"], "integer");
    }

    #[test]
    fn times_are_seconds_and_the_nanoseconds_beyond() {
        let Time { sec, nsec } = Time::from(SimTime::from_nanos(61_000_000_007));
        assert_eq!((sec, nsec), (61, 7));
    }
}
