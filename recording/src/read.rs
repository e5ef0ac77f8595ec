use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

use mcap::MessageStream;
use planner::{Plan, Setpoint, State};
use prost::Message;
use proto::stream::{Motion, Operation, OperationResult};
use proto::{Rejected, pb};

/// What a recording holds, as far as it can be played again.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// Name of the stream.
    pub stream: String,
    /// What was asked of the planner, where that was recorded.
    pub request: Option<pb::PlanRequest>,
    /// What the stream begins with here.
    pub beginning: Beginning,
    /// The operations that took effect, in order of their revisions.
    pub operations: Vec<(Operation, OperationResult)>,
    /// The setpoints of each cycle that was recorded, axis by axis in plan order.
    pub cycles: BTreeMap<u64, Vec<Setpoint>>,
    /// How many revisions of the motion were adopted, where that was reported.
    pub revisions: Option<u64>,
}

/// What a recorded stream begins with.
#[derive(Clone, Debug, PartialEq)]
pub enum Beginning {
    /// It was opened with this plan.
    Plan(Plan),
    /// Another server had served it until then, and it went on with this motion.
    Motion(Box<Motion>),
}

impl Beginning {
    /// What is played first.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        match self {
            Self::Plan(plan) => plan,
            Self::Motion(motion) => motion.plan(),
        }
    }
}

/// Why a file is not a recording that can be played again.
#[derive(Debug, thiserror::Error)]
pub enum UnreadableRecording {
    /// It cannot be opened.
    #[error("{path} cannot be read: {cause}: name a file that can be", path = .path.display())]
    Io {
        /// Which.
        path: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// It is not MCAP, or broke off.
    #[error(
        "{path} is not a whole MCAP file: {cause}: name one that --record has written to its end, and nobody has compressed since", path = .path.display()
    )]
    NotMcap {
        /// Which.
        path: PathBuf,
        /// What is wrong.
        cause: mcap::McapError,
    },
    /// A message is not what its topic says.
    #[error("{path} is not a recording of a stream: {cause}", path = .path.display())]
    NotARecording {
        /// Which.
        path: PathBuf,
        /// What is wrong.
        cause: String,
    },
    /// It holds no plan or motion that could be played.
    #[error("what is played in {path} is refused: {cause}", path = .path.display())]
    Plan {
        /// Which.
        path: PathBuf,
        /// Why.
        cause: Box<Rejected>,
    },
}

impl Recording {
    /// Reads the file at `path`.
    ///
    /// # Errors
    /// [`UnreadableRecording`].
    pub fn read(path: &Path) -> Result<Self, UnreadableRecording> {
        let place = || path.to_owned();
        let bytes = std::fs::read(path).map_err(|cause| UnreadableRecording::Io { path: place(), cause })?;
        let not_mcap = |cause| UnreadableRecording::NotMcap { path: place(), cause };
        let mut found = Found::default();
        for message in MessageStream::new(&bytes).map_err(not_mcap)? {
            let message = message.map_err(not_mcap)?;
            let topic = message.channel.topic.as_str();
            found.take(topic, &message.data).map_err(|error| UnreadableRecording::NotARecording {
                path: place(),
                cause: format!("a message on {topic} cannot be read: {error}"),
            })?;
        }
        found.recording().map_err(|cause| match cause {
            Missing::Plan => UnreadableRecording::NotARecording {
                path: place(),
                cause:
                    "it holds no plan and no motion, as --record of this version writes: record the run again"
                        .to_owned(),
            },
            Missing::Good(cause) => UnreadableRecording::Plan { path: place(), cause },
        })
    }
}

/// What has been read so far.
#[derive(Default)]
struct Found {
    head: pb::RecordingHead,
    request: Option<pb::PlanRequest>,
    plan: Option<pb::Plan>,
    motion: Option<pb::Motion>,
    operations: Vec<pb::RecordedOperation>,
    cycles: BTreeMap<u64, Vec<Setpoint>>,
    report: Option<pb::TrackingReport>,
}

enum Missing {
    Plan,
    Good(Box<Rejected>),
}

impl Found {
    fn take(&mut self, topic: &str, data: &[u8]) -> Result<(), prost::DecodeError> {
        match topic {
            "/head" => self.head = Message::decode(data)?,
            "/request" => self.request = Some(Message::decode(data)?),
            "/plan" => self.plan = Some(Message::decode(data)?),
            "/motion" => self.motion = Some(Message::decode(data)?),
            "/operations" => self.operations.push(Message::decode(data)?),
            "/report" => self.report = Some(Message::decode(data)?),
            _ => {
                let axis = topic.strip_prefix("/axes/");
                if let Some(axis) = axis.and_then(|name| self.head.axes.iter().position(|axis| axis == name))
                {
                    self.cycle(axis, Message::decode(data)?);
                }
                // Others may have recorded something beside it.
            }
        }
        Ok(())
    }

    fn cycle(&mut self, axis: usize, recorded: pb::RecordedCycle) {
        let pb::RecordedCycle { cycle, position, velocity, acceleration, jerk, .. } = recorded;
        let axes = self.head.axes.len();
        let row = self.cycles.entry(cycle).or_insert_with(|| vec![Setpoint::default(); axes]);
        row[axis] = Setpoint { state: State { position, velocity, acceleration }, jerk };
    }

    fn recording(self) -> Result<Recording, Missing> {
        let Self { head, request, plan, motion, operations, cycles, report } = self;
        let refused = |rejected| Missing::Good(Box::new(rejected));
        let beginning = match (plan, motion) {
            (Some(plan), _) => {
                Beginning::Plan(proto::plan_from_wire(plan).map_err(|invalid| refused(invalid.into()))?)
            }
            (None, Some(motion)) => {
                Beginning::Motion(Box::new(proto::motion_from_wire(motion).map_err(refused)?))
            }
            (None, None) => return Err(Missing::Plan),
        };
        let done =
            operations.into_iter().filter_map(|pb::RecordedOperation { operation, result, .. }| {
                Some((Operation::from(operation?), OperationResult::from(result?)))
            });
        let mut operations: Vec<_> = done.collect();
        operations.sort_by_key(|(_, result)| result.revision);
        let revisions = report.and_then(|report| report.stream).map(|stream| stream.revisions);
        Ok(Recording { stream: head.stream, request, beginning, operations, cycles, revisions })
    }
}
