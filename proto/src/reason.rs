//! Why a request is refused.

use std::fmt;
use std::str::FromStr;

use tonic::Code;

/// One row per reason: variant, name on the wire, what it means and the way out.
macro_rules! reasons {
    ($($code:ident { $($variant:ident $name:literal $explanation:literal)+ })+) => {
        /// Why a request is refused: the `reason` of the `google.rpc.ErrorInfo` in every refusal. The only source of
        /// these names and of the status code that goes with each.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Reason {
            $($(#[doc = $explanation] $variant,)+)+
        }

        impl Reason {
            /// Every reason, grouped by status code.
            pub const ALL: &[Self] = &[$($(Self::$variant,)+)+];

            /// The status code that a refusal for this reason has.
            #[must_use]
            pub const fn code(self) -> Code {
                match self {
                    $($(Self::$variant)|+ => Code::$code,)+
                }
            }

            /// The name on the wire, in UPPER_SNAKE.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $($(Self::$variant => $name,)+)+
                }
            }

            /// What it means and what to do about it, in plain sentences.
            #[must_use]
            pub const fn explanation(self) -> &'static str {
                match self {
                    $($(Self::$variant => $explanation,)+)+
                }
            }
        }
    };
}

reasons! {
    InvalidArgument {
        NotFinite "NOT_FINITE"
            "A number is NaN or infinite. Send finite numbers; to ask for no limit, leave the optional field out."
        LimitNotPositive "LIMIT_NOT_POSITIVE"
            "A limit is zero or negative. Limits are magnitudes: send a value above 0, or leave an optional limit out."
        LengthMismatch "LENGTH_MISMATCH"
            "Lists that belong together do not match: in length, or in the times of the points, which all axes share. \
             Send as many times as positions and velocities, the same times for every axis, and one value per axis \
             and cycle in columns."
        TimesNotIncreasing "TIMES_NOT_INCREASING"
            "The times of the points do not grow from one to the next by a cycle at least, or begin before the start. \
             Sort the points, drop repeated times, and begin after 0."
        KindUnspecified "KIND_UNSPECIFIED"
            "An enum that has no default is unset or has a value that this version does not know. Say the kind, \
             for instance whether an axis is prismatic, revolute or counts pulses."
        DuplicateAxis "DUPLICATE_AXIS"
            "Two axes of one request have the same name. Give each axis a name of its own."
        UnknownAxis "UNKNOWN_AXIS"
            "A name matches no axis of the plan or stream. Use a name that the plan lists; names are compared \
             letter by letter."
        NoAxes "NO_AXES"
            "The request names no axis. Send at least one."
        NoPoints "NO_POINTS"
            "The request has no point to go through. Send at least one time, position and velocity per axis."
        OrderUnsupported "ORDER_UNSUPPORTED"
            "The order does not go with the profile family, or is beyond what is supported. Leave it out, or ask \
             for a polynomial of an order within the range that the error names."
        CycleTimeInvalid "CYCLE_TIME_INVALID"
            "The cycle time is zero, negative or out of range. Send a positive duration, or leave it out for 1 ms."
        StateNotAtRest "STATE_NOT_AT_REST"
            "The profile family plans from rest to rest only, and a start or goal has velocity or acceleration. \
             Set both to 0, or use the S-curve family."
        OverrideOutOfRange "OVERRIDE_OUT_OF_RANGE"
            "The override factor is negative, or so large that the velocity limit would be exceeded. Stay between \
             0 and max_velocity / feed_rate."
        FieldMissing "FIELD_MISSING"
            "A part that has no default is not there. Set the field that is named: a plan, the limits of an axis, an \
             endpoint."
        ValueOutOfRange "VALUE_OUT_OF_RANGE"
            "A value is outside the range that has a meaning there. Stay within the least and the greatest value that \
             the error names."
        NameInvalid "NAME_INVALID"
            "A name is empty, longer than 256 bytes, or has control characters. Give a name that can be read and \
             printed, as x or cell-7/x."
        EndpointInvalid "ENDPOINT_INVALID"
            "An endpoint is not an address that can be connected to. Write it as http://host:port, or https:// where \
             the server has a certificate."
        RequestIdReused "REQUEST_ID_REUSED"
            "The request_id names an operation that is something else. A repeat with the same id is harmless since it is not done twice; \
             ask for anything else under an id of its own."
        MessageInvalid "MESSAGE_INVALID"
            "The text or the bytes are not a message of the schema: no JSON, an unknown field, a broken encoding. Compare \
             with the schema at the place that is named, and write numbers that JSON knows."
        ServoUnstable "SERVO_UNSTABLE"
            "The loops of the servo are unstable on this axis: any motion of it would grow without bound. Leave \
             velocity_gain and velocity_integral_time at 0, which tunes them, with a position_gain up to the one named."
        ProtocolOrder "PROTOCOL_ORDER"
            "A message came when it must not, or without a part that it needs. Open a stream with exactly one Open \
             as the first message, and set exactly one member of each choice."
    }
    FailedPrecondition {
        StartOutsideLimits "START_OUTSIDE_LIMITS"
            "The start state breaks a limit in a way that the profile family cannot lead back from. Raise the limit \
             to the value named as needed, or use the S-curve family, which leads a start back inside first."
        GoalOutsideLimits "GOAL_OUTSIDE_LIMITS"
            "The goal state breaks a limit, so no motion may end in it. Raise the limit to the value named as needed, \
             or take the nearest goal that is named."
        PositionLimit "POSITION_LIMIT"
            "The motion would leave the position range of an axis, on its way or at its end. Choose a goal inside, \
             slow the start or the goal down, or widen the range as named."
        PathTooShort "PATH_TOO_SHORT"
            "The path is too short to change from the start to the end velocity within the limits. Lengthen it to the \
             distance named as needed, take the nearest velocity that is named, or choose a short-path policy."
        PvtUnreachable "PVT_UNREACHABLE"
            "A point cannot be met in position, velocity and time at once. Move it as the nearest values say, \
             give it more time, or choose a policy that says which of the three may give way."
        PhaseSynchronizationImpossible "PHASE_SYNCHRONIZATION_IMPOSSIBLE"
            "The start and goal states do not lie on one straight line in axis space, or an axis keeps its limits only off \
             that line. Make velocities and accelerations proportional to the distances, begin gentler, or synchronize in \
             time."
        StreamFinished "STREAM_FINISHED"
            "The stream is over, so nothing can be done to its motion any more. Open a stream with a new plan."
        Stopped "STOPPED"
            "The stream is stopping and has forgotten the rest of its motion, so it can be neither held, resumed nor \
             changed. Wait until it is at rest and open a stream with a new plan; use hold where you mean to go on."
        PlanRejected "PLAN_REJECTED"
            "A plan that was sent in fails the judge: it jumps, breaks a limit that it guarantees, or does not end \
             where it says; or it is not what it says of itself. Plan it again, and verify it to see each check."
        NotProved "NOT_PROVED"
            "The plan does not guarantee velocity and acceleration limits, so it does not open a stream by itself. \
             Use another profile family or interpolation, or set accept_unproved if you know that it is safe."
        JoinMismatch "JOIN_MISMATCH"
            "The motion does not begin in the state in which the axis stands or moves. Plan from the commanded state \
             of the axis and open again."
        NotAPlanner "NOT_A_PLANNER"
            "Somebody answers at the endpoint, and not as a planner of this version does. Name the address of a planner, \
             and compare versions."
        AxisDiverged "AXIS_DIVERGED"
            "The simulated axis has left its setpoints beyond any sense, and the run was ended there. Lower the gains, \
             raise max_effort, or ask for less acceleration."
    }
    OutOfRange {
        AppendTooLate "APPEND_TOO_LATE"
            "The points came after the closing stop had to begin at the cycle that is named. Append earlier, or \
             retarget once the stream stands still."
        ResumePastEnd "RESUME_PAST_END"
            "The cycle to go on from lies past the end of the motion. Nothing is left to send: open a stream with a \
             new plan."
    }
    Aborted {
        EpochSuperseded "EPOCH_SUPERSEDED"
            "The stream was opened again with a newer epoch, and this session is over. Open with an epoch above the \
             current one that is named, unless the newer session is yours."
        NotConfirmed "NOT_CONFIRMED"
            "The axis did not adopt the operation before the session ended, or refused it three times. Send it \
             again with the same request_id: it takes effect at most once."
        Superseded "SUPERSEDED"
            "A later operation took effect before this one was due. Nothing of it was done: send it again if it is \
             still wanted."
    }
    PermissionDenied {
        StreamNotAllowed "STREAM_NOT_ALLOWED"
            "The policy does not let this identity use the stream. Use a stream name that the policy grants, or have \
             the policy extended."
        MethodNotAllowed "METHOD_NOT_ALLOWED"
            "The policy does not let this identity call the method, or the server was started without it. Use an \
             identity that may, or have the policy or the server's settings changed."
    }
    NotFound {
        StreamNotHere "STREAM_NOT_HERE"
            "This replica does not serve the stream. Ask the other replicas in turn, or send the command to the \
             axis, which reaches whichever replica serves it."
    }
    ResourceExhausted {
        TooManyAxes "TOO_MANY_AXES"
            "The request has more axes than the server allows. Split it, or raise the server's limit that is named."
        TooManyPoints "TOO_MANY_POINTS"
            "The request has more points than the server allows. Send them in parts by appending, or raise the \
             server's limit that is named."
        TooManyPlans "TOO_MANY_PLANS"
            "A message asks for more plans than the server allows. Send them in several messages of the same stream, or \
             raise the server's limit that is named."
        TooManySegments "TOO_MANY_SEGMENTS"
            "The plan has more segments than the server allows. Split the motion, or raise the server's limit that \
             is named."
        TooManyCycles "TOO_MANY_CYCLES"
            "The motion has more cycles than the server allows. Ask for fewer at a time, lengthen the cycle, shorten \
             the motion, or raise the server's limit that is named."
        TooManyStreams "TOO_MANY_STREAMS"
            "The server serves as many streams as it may. Open on another replica, close streams that are not \
             needed, or raise the server's limit that is named."
        MessageTooLarge "MESSAGE_TOO_LARGE"
            "A message, asked or answered, is larger than one side takes. Split the request, ask for less at a time, or \
             raise the limit that is named on the side that is named."
        Overloaded "OVERLOADED"
            "The server has more to do than it can finish in time. Try again after a while, on another replica if \
             there is one."
    }
    DeadlineExceeded {
        FirstMessageLate "FIRST_MESSAGE_LATE"
            "A call was begun, and its first message did not come in time. Send the message with the call; where the line is \
             slow, raise the server's first_message_deadline."
        StreamIdle "STREAM_IDLE"
            "Nothing was said on a stream for longer than the server waits. Report at least every batch; where axes are to \
             stand silent for longer, raise the server's idle_deadline. Open again to go on."
    }
    Unavailable {
        Draining "DRAINING"
            "The server is about to stop and takes no new work. Open or call on another replica at once."
        PlannerUnreachable "PLANNER_UNREACHABLE"
            "None of the planners that were named answers the axis; nothing has moved. Start one, or name the address \
             as the axis reaches it, which need not be as you do."
        StreamBroken "STREAM_BROKEN"
            "The stream to the planner broke off before the motion had ended, and the axis holds where its last setpoint \
             was. Plan from where it stands, as the report before says, and run again."
    }
    Unimplemented {
        NotImplemented "NOT_IMPLEMENTED"
            "This server does not offer what was asked. Compare its version with the documentation, and leave the \
             option out or update the server."
    }
    DataLoss {
        DigestMismatch "DIGEST_MISMATCH"
            "The setpoints that the two sides hold differ at the cycle that is named, so going on would be a guess. \
             Let the axis come to rest, check that both sides have the same evaluation version, and open with a new plan."
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Reason {
    type Err = UnknownReason;

    fn from_str(name: &str) -> Result<Self, UnknownReason> {
        Self::ALL
            .iter()
            .copied()
            .find(|reason| reason.name() == name)
            .ok_or_else(|| UnknownReason { name: name.to_owned() })
    }
}

/// A name that is not that of a [`Reason`], perhaps from a newer version.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name:?} is not a reason of this version: reasons are written as in PATH_TOO_SHORT")]
pub struct UnknownReason {
    /// The name that was given.
    pub name: String,
}
