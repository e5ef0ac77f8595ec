use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};

use mcap::records::MessageHeader;
use mcap::{McapError, WriteOptions, Writer};
use planner::CycleTime;
use prost::{Message, Name};
use proto::pb;

use crate::record::{Head, Moment};

/// An MCAP file under way. Not compressed: compression would need a C compiler, and files of a run are small.
pub(crate) struct McapFile {
    writer: Writer<BufWriter<File>>,
    cycle_time: CycleTime,
    /// By topic.
    channels: BTreeMap<String, Channel>,
    /// The topic of each axis.
    axes: Vec<String>,
}

#[derive(Clone, Copy, Debug)]
struct Channel {
    id: u16,
    /// Messages so far.
    sequence: u32,
}

impl McapFile {
    pub(crate) fn begin(file: BufWriter<File>, head: &Head) -> io::Result<Self> {
        let Head { stream, recorded_by, cycle_time, axes } = head;
        let options = WriteOptions::new().compression(None).library(recorded_by.as_str());
        let writer = options.create(file).map_err(io_error)?;
        let topics = axes.iter().map(|axis| format!("/axes/{axis}")).collect();
        let mut begun = Self { writer, cycle_time: *cycle_time, channels: BTreeMap::new(), axes: topics };
        let ns = cycle_time.as_ns();
        let cycle_time =
            proto::Duration { seconds: (ns / 1_000_000_000) as i64, nanos: (ns % 1_000_000_000) as i32 };
        let head = pb::RecordingHead {
            stream: stream.clone(),
            recorded_by: recorded_by.clone(),
            cycle_time: Some(cycle_time),
            axes: axes.clone(),
        };
        begun.write("/head", 0, &head)?;
        Ok(begun)
    }

    pub(crate) fn write<M: Message + Name>(
        &mut self,
        topic: &str,
        cycle: u64,
        message: &M,
    ) -> io::Result<()> {
        let channel = match self.channels.get(topic) {
            Some(channel) => *channel,
            None => self.open::<M>(topic)?,
        };
        let log_time = cycle.saturating_mul(self.cycle_time.as_ns());
        let header = MessageHeader {
            channel_id: channel.id,
            sequence: channel.sequence,
            log_time,
            publish_time: log_time,
        };
        self.writer.write_to_known_channel(&header, &message.encode_to_vec()).map_err(io_error)?;
        let next = Channel { sequence: channel.sequence.wrapping_add(1), ..channel };
        if let Some(known) = self.channels.get_mut(topic) {
            *known = next;
        }
        Ok(())
    }

    fn open<M: Name>(&mut self, topic: &str) -> io::Result<Channel> {
        let schema = self.writer.add_schema(&M::full_name(), "protobuf", proto::FILE_DESCRIPTOR_SET);
        let schema = schema.map_err(io_error)?;
        let id = self.writer.add_channel(schema, topic, "protobuf", &BTreeMap::new()).map_err(io_error)?;
        let channel = Channel { id, sequence: 0 };
        self.channels.insert(topic.to_owned(), channel);
        Ok(channel)
    }

    pub(crate) fn cycle(&mut self, cycle: u64, moments: impl Iterator<Item = Moment>) -> io::Result<()> {
        let topics = std::mem::take(&mut self.axes);
        let written = topics.iter().zip(moments).try_for_each(|(topic, moment)| {
            let Moment { setpoint, measured_position, following_error, load_position, cycle_jitter_ns } =
                moment;
            let [position, velocity, acceleration, jerk] = setpoint.words();
            let recorded = pb::RecordedCycle {
                cycle,
                position,
                velocity,
                acceleration,
                jerk,
                measured_position,
                following_error,
                load_position,
                cycle_jitter_ns,
            };
            self.write(topic, cycle, &recorded)
        });
        self.axes = topics;
        written
    }

    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.writer.finish().map_err(io_error)?;
        io::Write::flush(&mut self.writer.into_inner())
    }
}

impl std::fmt::Debug for McapFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("McapFile").field("channels", &self.channels).finish_non_exhaustive()
    }
}

fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
