//! The container: messages in chunks, and an index of them at the end.
//!
//! Source: "MCAP Format Specification" (mcap.dev/spec), version 0. Chunks are packed as frames of LZ4, which every reader
//! knows. Numbers are little-endian; lists and texts begin with their length in bytes.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::mem;

use crc32fast::Hasher;
use lz4_flex::frame::FrameEncoder;

use wildfire_base::time::SimTime;

/// How chunks are packed.
const PACKING: &str = "lz4";
const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";
/// Bytes of messages after which a chunk ends.
const CHUNK_BYTES: usize = 1 << 20;
/// Bytes before the content of a record: its kind and its length.
const RECORD_HEAD: u64 = 1 + 8;

/// Kinds of records.
mod kind {
    pub const HEADER: u8 = 0x01;
    pub const FOOTER: u8 = 0x02;
    pub const SCHEMA: u8 = 0x03;
    pub const CHANNEL: u8 = 0x04;
    pub const MESSAGE: u8 = 0x05;
    pub const CHUNK: u8 = 0x06;
    pub const MESSAGE_INDEX: u8 = 0x07;
    pub const CHUNK_INDEX: u8 = 0x08;
    pub const STATISTICS: u8 = 0x0b;
    pub const METADATA: u8 = 0x0c;
    pub const METADATA_INDEX: u8 = 0x0d;
    pub const SUMMARY_OFFSET: u8 = 0x0e;
    pub const DATA_END: u8 = 0x0f;
}

/// A channel that messages are written to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ChannelId(u16);

/// The content of a record while it is put together.
#[derive(Debug, Default)]
struct RecordContent(Vec<u8>);

impl RecordContent {
    fn u8(mut self, number: u8) -> Self {
        self.0.push(number);
        self
    }

    fn u16(mut self, number: u16) -> Self {
        self.0.extend_from_slice(&number.to_le_bytes());
        self
    }

    fn u32(mut self, number: u32) -> Self {
        self.0.extend_from_slice(&number.to_le_bytes());
        self
    }

    fn u64(mut self, number: u64) -> Self {
        self.0.extend_from_slice(&number.to_le_bytes());
        self
    }

    fn time(self, time: SimTime) -> Self {
        self.u64(time.as_nanos())
    }

    /// Adds bytes after their length.
    fn bytes(self, bytes: &[u8]) -> Self {
        let mut content = self.u32(u32::try_from(bytes.len()).expect("lists within records are short"));
        content.0.extend_from_slice(bytes);
        content
    }

    fn text(self, text: &str) -> Self {
        self.bytes(text.as_bytes())
    }

    fn texts(self, texts: &[(&str, String)]) -> Self {
        let pairs = texts.iter().fold(Self::default(), |pairs, (key, value)| pairs.text(key).text(value));
        self.bytes(&pairs.0)
    }
}

/// The times of some messages.
#[derive(Clone, Copy, Debug, Default)]
struct Span {
    first: SimTime,
    last: SimTime,
}

/// A chunk that is being filled.
#[derive(Debug, Default)]
struct Chunk {
    records: Vec<u8>,
    span: Option<Span>,
    /// By channel: the time of each message and its place among the records.
    messages: BTreeMap<ChannelId, Vec<(SimTime, u64)>>,
}

/// Writes a file, record by record.
pub struct McapWriter<W> {
    to: W,
    written: u64,
    crc: Hasher,
    /// Schemas and channels, which the summary repeats.
    schemas: Vec<Vec<u8>>,
    channels: Vec<Vec<u8>>,
    chunk: Chunk,
    chunk_indices: Vec<Vec<u8>>,
    metadata_indices: Vec<Vec<u8>>,
    counts: BTreeMap<ChannelId, u64>,
    sequences: BTreeMap<ChannelId, u32>,
    span: Option<Span>,
}

fn widened(span: Option<Span>, time: SimTime) -> Option<Span> {
    let span = span.unwrap_or(Span { first: time, last: time });
    Some(Span { first: span.first.min(time), last: span.last.max(time) })
}

impl<W: Write> McapWriter<W> {
    /// Begins a file that this program writes.
    pub fn begin(to: W, program: &str) -> io::Result<Self> {
        let mut writer = Self {
            to,
            written: 0,
            crc: Hasher::new(),
            schemas: Vec::new(),
            channels: Vec::new(),
            chunk: Chunk::default(),
            chunk_indices: Vec::new(),
            metadata_indices: Vec::new(),
            counts: BTreeMap::new(),
            sequences: BTreeMap::new(),
            span: None,
        };
        writer.put(MAGIC)?;
        // The profile is empty, as messages follow none.
        writer.record(kind::HEADER, &RecordContent::default().text("").text(program).0)?;
        Ok(writer)
    }

    /// Adds the JSON Schema of messages of this name, and returns its number.
    pub fn schema(&mut self, name: &str, schema: &str) -> io::Result<u16> {
        let id = u16::try_from(self.schemas.len() + 1).map_err(io::Error::other)?;
        let content = RecordContent::default().u16(id).text(name).text("jsonschema").text(schema).0;
        self.record(kind::SCHEMA, &content)?;
        self.schemas.push(content);
        Ok(id)
    }

    /// Adds a channel of JSON messages of a schema.
    pub fn channel(&mut self, schema: u16, topic: &str) -> io::Result<ChannelId> {
        let id = u16::try_from(self.channels.len()).map_err(io::Error::other)?;
        let content = RecordContent::default().u16(id).u16(schema).text(topic).text("json").texts(&[]).0;
        self.record(kind::CHANNEL, &content)?;
        self.channels.push(content);
        Ok(ChannelId(id))
    }

    /// Adds named texts about the file.
    pub fn metadata(&mut self, name: &str, texts: &[(&str, String)]) -> io::Result<()> {
        let content = RecordContent::default().text(name).texts(texts).0;
        let at = self.written;
        let length = RECORD_HEAD + content.len() as u64;
        self.metadata_indices.push(RecordContent::default().u64(at).u64(length).text(name).0);
        self.record(kind::METADATA, &content)
    }

    /// Adds a message, which is not earlier than those before it.
    pub fn message(&mut self, channel: ChannelId, time: SimTime, json: &[u8]) -> io::Result<()> {
        let sequence = self.sequences.entry(channel).or_default();
        let head = RecordContent::default().u16(channel.0).u32(*sequence).time(time).time(time).0;
        *sequence = sequence.wrapping_add(1);
        *self.counts.entry(channel).or_default() += 1;
        self.span = widened(self.span, time);
        let chunk = &mut self.chunk;
        chunk.span = widened(chunk.span, time);
        chunk.messages.entry(channel).or_default().push((time, chunk.records.len() as u64));
        append_record(&mut chunk.records, kind::MESSAGE, &[&head, json]);
        if chunk.records.len() >= CHUNK_BYTES { self.end_chunk() } else { Ok(()) }
    }

    fn end_chunk(&mut self) -> io::Result<()> {
        let Chunk { records, span, messages } = mem::take(&mut self.chunk);
        let Some(span) = span else { return Ok(()) };
        let size = records.len() as u64;
        // The checksum is of the unpacked bytes, as the specification has it.
        let head = RecordContent::default().time(span.first).time(span.last).u64(size).u32(crc32fast::hash(&records));
        let mut encoder = FrameEncoder::new(Vec::new());
        encoder.write_all(&records)?;
        let packed = encoder.finish().map_err(io::Error::from)?;
        let packed_size = packed.len() as u64;
        let head = head.text(PACKING).u64(packed_size).0;
        let at = self.written;
        self.put(&[kind::CHUNK])?;
        self.put(&(head.len() as u64 + packed_size).to_le_bytes())?;
        self.put(&head)?;
        self.put(&packed)?;
        // The index stands behind the chunk and not in it: a reader that looks for one topic skips the chunk by it.
        let indices_at = self.written;
        let mut offsets = RecordContent::default();
        for (channel, messages) in &messages {
            offsets = offsets.u16(channel.0).u64(self.written);
            let index = messages.iter().fold(RecordContent::default(), |index, &(time, at)| index.time(time).u64(at));
            self.record(kind::MESSAGE_INDEX, &RecordContent::default().u16(channel.0).bytes(&index.0).0)?;
        }
        let index =
            RecordContent::default().time(span.first).time(span.last).u64(at).u64(indices_at - at).bytes(&offsets.0);
        let index = index.u64(self.written - indices_at).text(PACKING).u64(packed_size).u64(size);
        self.chunk_indices.push(index.0);
        Ok(())
    }

    /// Writes the summary.
    pub fn finish(mut self) -> io::Result<()> {
        self.end_chunk()?;
        // The file has two checksums: one of all records up to here, one of the summary.
        let crc_of_data = mem::take(&mut self.crc).finalize();
        self.record(kind::DATA_END, &RecordContent::default().u32(crc_of_data).0)?;
        self.crc = Hasher::new();
        // A reader opens the file at its end, and finds the records of the summary by these offsets.
        let summary_at = self.written;
        let statistics = self.statistics();
        let groups = [
            (kind::SCHEMA, mem::take(&mut self.schemas)),
            (kind::CHANNEL, mem::take(&mut self.channels)),
            (kind::STATISTICS, vec![statistics]),
            (kind::METADATA_INDEX, mem::take(&mut self.metadata_indices)),
            (kind::CHUNK_INDEX, mem::take(&mut self.chunk_indices)),
        ];
        let mut offsets = Vec::new();
        for (kind, records) in groups.iter().filter(|(_, records)| !records.is_empty()) {
            let at = self.written;
            records.iter().try_for_each(|content| self.record(*kind, content))?;
            offsets.push(RecordContent::default().u8(*kind).u64(at).u64(self.written - at).0);
        }
        let offsets_at = self.written;
        offsets.iter().try_for_each(|content| self.record(kind::SUMMARY_OFFSET, content))?;
        // The checksum is of all from the summary on to the checksum itself.
        // Its length counts two offsets and that checksum.
        let footer = RecordContent::default().u8(kind::FOOTER).u64(8 + 8 + 4).u64(summary_at).u64(offsets_at).0;
        self.put(&footer)?;
        let crc = mem::take(&mut self.crc).finalize();
        self.put(&crc.to_le_bytes())?;
        self.put(MAGIC)?;
        self.to.flush()
    }

    fn statistics(&self) -> Vec<u8> {
        let span = self.span.unwrap_or_default();
        let counts =
            self.counts.iter().fold(RecordContent::default(), |all, (channel, &count)| all.u16(channel.0).u64(count));
        RecordContent::default()
            .u64(self.counts.values().sum())
            .u16(self.schemas.len() as u16)
            .u32(self.channels.len() as u32)
            // There are no attachments.
            .u32(0)
            .u32(self.metadata_indices.len() as u32)
            .u32(self.chunk_indices.len() as u32)
            .time(span.first)
            .time(span.last)
            .bytes(&counts.0)
            .0
    }

    fn record(&mut self, kind: u8, content: &[u8]) -> io::Result<()> {
        self.put(&[kind])?;
        self.put(&(content.len() as u64).to_le_bytes())?;
        self.put(content)
    }

    fn put(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.to.write_all(bytes)?;
        self.crc.update(bytes);
        self.written += bytes.len() as u64;
        Ok(())
    }
}

fn append_record(records: &mut Vec<u8>, kind: u8, content: &[&[u8]]) {
    let length: usize = content.iter().map(|part| part.len()).sum();
    records.push(kind);
    records.extend_from_slice(&(length as u64).to_le_bytes());
    content.iter().for_each(|part| records.extend_from_slice(part));
}
