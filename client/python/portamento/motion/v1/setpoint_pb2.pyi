import datetime

from google.protobuf import duration_pb2 as _duration_pb2
from portamento.motion.v1 import plan_pb2 as _plan_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class Phase(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PHASE_UNSPECIFIED: _ClassVar[Phase]
    PHASE_MOVING: _ClassVar[Phase]
    PHASE_HOLDING: _ClassVar[Phase]
    PHASE_STOPPING: _ClassVar[Phase]
    PHASE_STANDSTILL: _ClassVar[Phase]
    PHASE_FINISHED: _ClassVar[Phase]

class StreamEventKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    STREAM_EVENT_KIND_UNSPECIFIED: _ClassVar[StreamEventKind]
    STREAM_EVENT_KIND_DRAINING: _ClassVar[StreamEventKind]
    STREAM_EVENT_KIND_STANDSTILL: _ClassVar[StreamEventKind]
    STREAM_EVENT_KIND_FINISHED: _ClassVar[StreamEventKind]
    STREAM_EVENT_KIND_SUPERSEDED: _ClassVar[StreamEventKind]
    STREAM_EVENT_KIND_TRACKING_WANTED: _ClassVar[StreamEventKind]
    STREAM_EVENT_KIND_TRACKING_UNWANTED: _ClassVar[StreamEventKind]
PHASE_UNSPECIFIED: Phase
PHASE_MOVING: Phase
PHASE_HOLDING: Phase
PHASE_STOPPING: Phase
PHASE_STANDSTILL: Phase
PHASE_FINISHED: Phase
STREAM_EVENT_KIND_UNSPECIFIED: StreamEventKind
STREAM_EVENT_KIND_DRAINING: StreamEventKind
STREAM_EVENT_KIND_STANDSTILL: StreamEventKind
STREAM_EVENT_KIND_FINISHED: StreamEventKind
STREAM_EVENT_KIND_SUPERSEDED: StreamEventKind
STREAM_EVENT_KIND_TRACKING_WANTED: StreamEventKind
STREAM_EVENT_KIND_TRACKING_UNWANTED: StreamEventKind

class StreamSetpointsRequest(_message.Message):
    __slots__ = ("open", "report", "operation")
    OPEN_FIELD_NUMBER: _ClassVar[int]
    REPORT_FIELD_NUMBER: _ClassVar[int]
    OPERATION_FIELD_NUMBER: _ClassVar[int]
    open: Open
    report: AxisReport
    operation: Operation
    def __init__(self, open: _Optional[_Union[Open, _Mapping]] = ..., report: _Optional[_Union[AxisReport, _Mapping]] = ..., operation: _Optional[_Union[Operation, _Mapping]] = ...) -> None: ...

class Open(_message.Message):
    __slots__ = ("stream", "epoch", "lead_cycles", "batch_cycles", "axis_guard", "close_at_rest", "accept_unproved", "executed_cycle", "compact", "plan", "resume")
    STREAM_FIELD_NUMBER: _ClassVar[int]
    EPOCH_FIELD_NUMBER: _ClassVar[int]
    LEAD_CYCLES_FIELD_NUMBER: _ClassVar[int]
    BATCH_CYCLES_FIELD_NUMBER: _ClassVar[int]
    AXIS_GUARD_FIELD_NUMBER: _ClassVar[int]
    CLOSE_AT_REST_FIELD_NUMBER: _ClassVar[int]
    ACCEPT_UNPROVED_FIELD_NUMBER: _ClassVar[int]
    EXECUTED_CYCLE_FIELD_NUMBER: _ClassVar[int]
    COMPACT_FIELD_NUMBER: _ClassVar[int]
    PLAN_FIELD_NUMBER: _ClassVar[int]
    RESUME_FIELD_NUMBER: _ClassVar[int]
    stream: str
    epoch: int
    lead_cycles: int
    batch_cycles: int
    axis_guard: int
    close_at_rest: bool
    accept_unproved: bool
    executed_cycle: int
    compact: bool
    plan: _plan_pb2.Plan
    resume: Resume
    def __init__(self, stream: _Optional[str] = ..., epoch: _Optional[int] = ..., lead_cycles: _Optional[int] = ..., batch_cycles: _Optional[int] = ..., axis_guard: _Optional[int] = ..., close_at_rest: _Optional[bool] = ..., accept_unproved: _Optional[bool] = ..., executed_cycle: _Optional[int] = ..., compact: _Optional[bool] = ..., plan: _Optional[_Union[_plan_pb2.Plan, _Mapping]] = ..., resume: _Optional[_Union[Resume, _Mapping]] = ...) -> None: ...

class Resume(_message.Message):
    __slots__ = ("motion", "next_cycle", "digest", "checkpoint_cycle", "checkpoint_digest")
    MOTION_FIELD_NUMBER: _ClassVar[int]
    NEXT_CYCLE_FIELD_NUMBER: _ClassVar[int]
    DIGEST_FIELD_NUMBER: _ClassVar[int]
    CHECKPOINT_CYCLE_FIELD_NUMBER: _ClassVar[int]
    CHECKPOINT_DIGEST_FIELD_NUMBER: _ClassVar[int]
    motion: Motion
    next_cycle: int
    digest: int
    checkpoint_cycle: int
    checkpoint_digest: int
    def __init__(self, motion: _Optional[_Union[Motion, _Mapping]] = ..., next_cycle: _Optional[int] = ..., digest: _Optional[int] = ..., checkpoint_cycle: _Optional[int] = ..., checkpoint_digest: _Optional[int] = ...) -> None: ...

class Motion(_message.Message):
    __slots__ = ("revision", "from_cycle", "digest_before", "plan", "override_factor", "phase", "base", "base_time", "closing_from_cycle", "recent")
    REVISION_FIELD_NUMBER: _ClassVar[int]
    FROM_CYCLE_FIELD_NUMBER: _ClassVar[int]
    DIGEST_BEFORE_FIELD_NUMBER: _ClassVar[int]
    PLAN_FIELD_NUMBER: _ClassVar[int]
    OVERRIDE_FACTOR_FIELD_NUMBER: _ClassVar[int]
    PHASE_FIELD_NUMBER: _ClassVar[int]
    BASE_FIELD_NUMBER: _ClassVar[int]
    BASE_TIME_FIELD_NUMBER: _ClassVar[int]
    CLOSING_FROM_CYCLE_FIELD_NUMBER: _ClassVar[int]
    RECENT_FIELD_NUMBER: _ClassVar[int]
    revision: int
    from_cycle: int
    digest_before: int
    plan: _plan_pb2.Plan
    override_factor: float
    phase: Phase
    base: _plan_pb2.Plan
    base_time: _containers.RepeatedCompositeFieldContainer[_plan_pb2.AxisSegment]
    closing_from_cycle: int
    recent: _containers.RepeatedCompositeFieldContainer[OperationResult]
    def __init__(self, revision: _Optional[int] = ..., from_cycle: _Optional[int] = ..., digest_before: _Optional[int] = ..., plan: _Optional[_Union[_plan_pb2.Plan, _Mapping]] = ..., override_factor: _Optional[float] = ..., phase: _Optional[_Union[Phase, str]] = ..., base: _Optional[_Union[_plan_pb2.Plan, _Mapping]] = ..., base_time: _Optional[_Iterable[_Union[_plan_pb2.AxisSegment, _Mapping]]] = ..., closing_from_cycle: _Optional[int] = ..., recent: _Optional[_Iterable[_Union[OperationResult, _Mapping]]] = ...) -> None: ...

class Operation(_message.Message):
    __slots__ = ("request_id", "not_before_cycle", "hold", "resume", "set_override", "retarget", "append_pvt", "stop")
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    NOT_BEFORE_CYCLE_FIELD_NUMBER: _ClassVar[int]
    HOLD_FIELD_NUMBER: _ClassVar[int]
    RESUME_FIELD_NUMBER: _ClassVar[int]
    SET_OVERRIDE_FIELD_NUMBER: _ClassVar[int]
    RETARGET_FIELD_NUMBER: _ClassVar[int]
    APPEND_PVT_FIELD_NUMBER: _ClassVar[int]
    STOP_FIELD_NUMBER: _ClassVar[int]
    request_id: str
    not_before_cycle: int
    hold: Hold
    resume: ResumeMotion
    set_override: SetOverride
    retarget: Retarget
    append_pvt: AppendPvt
    stop: Stop
    def __init__(self, request_id: _Optional[str] = ..., not_before_cycle: _Optional[int] = ..., hold: _Optional[_Union[Hold, _Mapping]] = ..., resume: _Optional[_Union[ResumeMotion, _Mapping]] = ..., set_override: _Optional[_Union[SetOverride, _Mapping]] = ..., retarget: _Optional[_Union[Retarget, _Mapping]] = ..., append_pvt: _Optional[_Union[AppendPvt, _Mapping]] = ..., stop: _Optional[_Union[Stop, _Mapping]] = ...) -> None: ...

class Hold(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class ResumeMotion(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class SetOverride(_message.Message):
    __slots__ = ("factor",)
    FACTOR_FIELD_NUMBER: _ClassVar[int]
    factor: float
    def __init__(self, factor: _Optional[float] = ...) -> None: ...

class Retarget(_message.Message):
    __slots__ = ("goals",)
    GOALS_FIELD_NUMBER: _ClassVar[int]
    goals: _containers.RepeatedCompositeFieldContainer[_plan_pb2.AxisMove]
    def __init__(self, goals: _Optional[_Iterable[_Union[_plan_pb2.AxisMove, _Mapping]]] = ...) -> None: ...

class AppendPvt(_message.Message):
    __slots__ = ("axes", "last")
    AXES_FIELD_NUMBER: _ClassVar[int]
    LAST_FIELD_NUMBER: _ClassVar[int]
    axes: _containers.RepeatedCompositeFieldContainer[_plan_pb2.PvtAxis]
    last: bool
    def __init__(self, axes: _Optional[_Iterable[_Union[_plan_pb2.PvtAxis, _Mapping]]] = ..., last: _Optional[bool] = ...) -> None: ...

class Stop(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class AxisReport(_message.Message):
    __slots__ = ("executed_cycle", "accepted_cycle", "grant_cycle", "revision", "digest", "refused", "tail_from_cycle", "tracking", "counters")
    EXECUTED_CYCLE_FIELD_NUMBER: _ClassVar[int]
    ACCEPTED_CYCLE_FIELD_NUMBER: _ClassVar[int]
    GRANT_CYCLE_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    DIGEST_FIELD_NUMBER: _ClassVar[int]
    REFUSED_FIELD_NUMBER: _ClassVar[int]
    TAIL_FROM_CYCLE_FIELD_NUMBER: _ClassVar[int]
    TRACKING_FIELD_NUMBER: _ClassVar[int]
    COUNTERS_FIELD_NUMBER: _ClassVar[int]
    executed_cycle: int
    accepted_cycle: int
    grant_cycle: int
    revision: int
    digest: int
    refused: Refused
    tail_from_cycle: int
    tracking: TrackingColumns
    counters: StreamCounters
    def __init__(self, executed_cycle: _Optional[int] = ..., accepted_cycle: _Optional[int] = ..., grant_cycle: _Optional[int] = ..., revision: _Optional[int] = ..., digest: _Optional[int] = ..., refused: _Optional[_Union[Refused, _Mapping]] = ..., tail_from_cycle: _Optional[int] = ..., tracking: _Optional[_Union[TrackingColumns, _Mapping]] = ..., counters: _Optional[_Union[StreamCounters, _Mapping]] = ...) -> None: ...

class Refused(_message.Message):
    __slots__ = ("revision", "first_cycle", "reason")
    REVISION_FIELD_NUMBER: _ClassVar[int]
    FIRST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    revision: int
    first_cycle: int
    reason: str
    def __init__(self, revision: _Optional[int] = ..., first_cycle: _Optional[int] = ..., reason: _Optional[str] = ...) -> None: ...

class TrackingColumns(_message.Message):
    __slots__ = ("first_cycle", "cycles", "measured_position", "following_error", "cycle_jitter_ns")
    FIRST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    CYCLES_FIELD_NUMBER: _ClassVar[int]
    MEASURED_POSITION_FIELD_NUMBER: _ClassVar[int]
    FOLLOWING_ERROR_FIELD_NUMBER: _ClassVar[int]
    CYCLE_JITTER_NS_FIELD_NUMBER: _ClassVar[int]
    first_cycle: int
    cycles: int
    measured_position: _containers.RepeatedScalarFieldContainer[float]
    following_error: _containers.RepeatedScalarFieldContainer[float]
    cycle_jitter_ns: _containers.RepeatedScalarFieldContainer[int]
    def __init__(self, first_cycle: _Optional[int] = ..., cycles: _Optional[int] = ..., measured_position: _Optional[_Iterable[float]] = ..., following_error: _Optional[_Iterable[float]] = ..., cycle_jitter_ns: _Optional[_Iterable[int]] = ...) -> None: ...

class StreamCounters(_message.Message):
    __slots__ = ("underruns", "duplicate_cycles", "refused_batches", "stale_epochs", "least_lead_cycles", "late_cycles")
    UNDERRUNS_FIELD_NUMBER: _ClassVar[int]
    DUPLICATE_CYCLES_FIELD_NUMBER: _ClassVar[int]
    REFUSED_BATCHES_FIELD_NUMBER: _ClassVar[int]
    STALE_EPOCHS_FIELD_NUMBER: _ClassVar[int]
    LEAST_LEAD_CYCLES_FIELD_NUMBER: _ClassVar[int]
    LATE_CYCLES_FIELD_NUMBER: _ClassVar[int]
    underruns: int
    duplicate_cycles: int
    refused_batches: int
    stale_epochs: int
    least_lead_cycles: int
    late_cycles: int
    def __init__(self, underruns: _Optional[int] = ..., duplicate_cycles: _Optional[int] = ..., refused_batches: _Optional[int] = ..., stale_epochs: _Optional[int] = ..., least_lead_cycles: _Optional[int] = ..., late_cycles: _Optional[int] = ...) -> None: ...

class StreamSetpointsResponse(_message.Message):
    __slots__ = ("epoch", "opened", "revised", "batch", "operation", "event", "refusal")
    EPOCH_FIELD_NUMBER: _ClassVar[int]
    OPENED_FIELD_NUMBER: _ClassVar[int]
    REVISED_FIELD_NUMBER: _ClassVar[int]
    BATCH_FIELD_NUMBER: _ClassVar[int]
    OPERATION_FIELD_NUMBER: _ClassVar[int]
    EVENT_FIELD_NUMBER: _ClassVar[int]
    REFUSAL_FIELD_NUMBER: _ClassVar[int]
    epoch: int
    opened: Opened
    revised: MotionRevised
    batch: SetpointBatch
    operation: OperationResult
    event: StreamEvent
    refusal: OperationRefusal
    def __init__(self, epoch: _Optional[int] = ..., opened: _Optional[_Union[Opened, _Mapping]] = ..., revised: _Optional[_Union[MotionRevised, _Mapping]] = ..., batch: _Optional[_Union[SetpointBatch, _Mapping]] = ..., operation: _Optional[_Union[OperationResult, _Mapping]] = ..., event: _Optional[_Union[StreamEvent, _Mapping]] = ..., refusal: _Optional[_Union[OperationRefusal, _Mapping]] = ...) -> None: ...

class OperationRefusal(_message.Message):
    __slots__ = ("request_id", "status")
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    STATUS_FIELD_NUMBER: _ClassVar[int]
    request_id: str
    status: bytes
    def __init__(self, request_id: _Optional[str] = ..., status: _Optional[bytes] = ...) -> None: ...

class Opened(_message.Message):
    __slots__ = ("motion", "first_cycle", "served_by", "current_epoch")
    MOTION_FIELD_NUMBER: _ClassVar[int]
    FIRST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    SERVED_BY_FIELD_NUMBER: _ClassVar[int]
    CURRENT_EPOCH_FIELD_NUMBER: _ClassVar[int]
    motion: Motion
    first_cycle: int
    served_by: str
    current_epoch: int
    def __init__(self, motion: _Optional[_Union[Motion, _Mapping]] = ..., first_cycle: _Optional[int] = ..., served_by: _Optional[str] = ..., current_epoch: _Optional[int] = ...) -> None: ...

class MotionRevised(_message.Message):
    __slots__ = ("motion", "certificate")
    MOTION_FIELD_NUMBER: _ClassVar[int]
    CERTIFICATE_FIELD_NUMBER: _ClassVar[int]
    motion: Motion
    certificate: _plan_pb2.PlanCertificate
    def __init__(self, motion: _Optional[_Union[Motion, _Mapping]] = ..., certificate: _Optional[_Union[_plan_pb2.PlanCertificate, _Mapping]] = ...) -> None: ...

class SetpointBatch(_message.Message):
    __slots__ = ("first_cycle", "revision", "replaces", "last", "columns", "stop_tails", "digest", "cycles")
    FIRST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    REPLACES_FIELD_NUMBER: _ClassVar[int]
    LAST_FIELD_NUMBER: _ClassVar[int]
    COLUMNS_FIELD_NUMBER: _ClassVar[int]
    STOP_TAILS_FIELD_NUMBER: _ClassVar[int]
    DIGEST_FIELD_NUMBER: _ClassVar[int]
    CYCLES_FIELD_NUMBER: _ClassVar[int]
    first_cycle: int
    revision: int
    replaces: bool
    last: bool
    columns: _plan_pb2.SetpointColumns
    stop_tails: _containers.RepeatedCompositeFieldContainer[StopTail]
    digest: int
    cycles: int
    def __init__(self, first_cycle: _Optional[int] = ..., revision: _Optional[int] = ..., replaces: _Optional[bool] = ..., last: _Optional[bool] = ..., columns: _Optional[_Union[_plan_pb2.SetpointColumns, _Mapping]] = ..., stop_tails: _Optional[_Iterable[_Union[StopTail, _Mapping]]] = ..., digest: _Optional[int] = ..., cycles: _Optional[int] = ...) -> None: ...

class StopTail(_message.Message):
    __slots__ = ("segments", "rest_position")
    SEGMENTS_FIELD_NUMBER: _ClassVar[int]
    REST_POSITION_FIELD_NUMBER: _ClassVar[int]
    segments: _containers.RepeatedCompositeFieldContainer[_plan_pb2.AxisSegment]
    rest_position: float
    def __init__(self, segments: _Optional[_Iterable[_Union[_plan_pb2.AxisSegment, _Mapping]]] = ..., rest_position: _Optional[float] = ...) -> None: ...

class OperationResult(_message.Message):
    __slots__ = ("request_id", "effective_cycle", "rest_cycle", "revision", "on_path", "operation_digest")
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    EFFECTIVE_CYCLE_FIELD_NUMBER: _ClassVar[int]
    REST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    REVISION_FIELD_NUMBER: _ClassVar[int]
    ON_PATH_FIELD_NUMBER: _ClassVar[int]
    OPERATION_DIGEST_FIELD_NUMBER: _ClassVar[int]
    request_id: str
    effective_cycle: int
    rest_cycle: int
    revision: int
    on_path: bool
    operation_digest: int
    def __init__(self, request_id: _Optional[str] = ..., effective_cycle: _Optional[int] = ..., rest_cycle: _Optional[int] = ..., revision: _Optional[int] = ..., on_path: _Optional[bool] = ..., operation_digest: _Optional[int] = ...) -> None: ...

class StreamEvent(_message.Message):
    __slots__ = ("kind", "at_cycle")
    KIND_FIELD_NUMBER: _ClassVar[int]
    AT_CYCLE_FIELD_NUMBER: _ClassVar[int]
    kind: StreamEventKind
    at_cycle: int
    def __init__(self, kind: _Optional[_Union[StreamEventKind, str]] = ..., at_cycle: _Optional[int] = ...) -> None: ...

class ControlStreamRequest(_message.Message):
    __slots__ = ("stream", "operation")
    STREAM_FIELD_NUMBER: _ClassVar[int]
    OPERATION_FIELD_NUMBER: _ClassVar[int]
    stream: str
    operation: Operation
    def __init__(self, stream: _Optional[str] = ..., operation: _Optional[_Union[Operation, _Mapping]] = ...) -> None: ...

class ControlStreamResponse(_message.Message):
    __slots__ = ("result",)
    RESULT_FIELD_NUMBER: _ClassVar[int]
    result: OperationResult
    def __init__(self, result: _Optional[_Union[OperationResult, _Mapping]] = ...) -> None: ...

class WatchStreamRequest(_message.Message):
    __slots__ = ("stream", "period", "max_points")
    STREAM_FIELD_NUMBER: _ClassVar[int]
    PERIOD_FIELD_NUMBER: _ClassVar[int]
    MAX_POINTS_FIELD_NUMBER: _ClassVar[int]
    stream: str
    period: _duration_pb2.Duration
    max_points: int
    def __init__(self, stream: _Optional[str] = ..., period: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., max_points: _Optional[int] = ...) -> None: ...

class WatchStreamResponse(_message.Message):
    __slots__ = ("stream", "executed_cycle", "lead_cycles", "phase", "override_factor", "cycles", "commanded", "tracking", "counters", "messages_dropped", "axes", "events", "cycle_time", "kinds")
    STREAM_FIELD_NUMBER: _ClassVar[int]
    EXECUTED_CYCLE_FIELD_NUMBER: _ClassVar[int]
    LEAD_CYCLES_FIELD_NUMBER: _ClassVar[int]
    PHASE_FIELD_NUMBER: _ClassVar[int]
    OVERRIDE_FACTOR_FIELD_NUMBER: _ClassVar[int]
    CYCLES_FIELD_NUMBER: _ClassVar[int]
    COMMANDED_FIELD_NUMBER: _ClassVar[int]
    TRACKING_FIELD_NUMBER: _ClassVar[int]
    COUNTERS_FIELD_NUMBER: _ClassVar[int]
    MESSAGES_DROPPED_FIELD_NUMBER: _ClassVar[int]
    AXES_FIELD_NUMBER: _ClassVar[int]
    EVENTS_FIELD_NUMBER: _ClassVar[int]
    CYCLE_TIME_FIELD_NUMBER: _ClassVar[int]
    KINDS_FIELD_NUMBER: _ClassVar[int]
    stream: str
    executed_cycle: int
    lead_cycles: int
    phase: Phase
    override_factor: float
    cycles: _containers.RepeatedScalarFieldContainer[int]
    commanded: _plan_pb2.SetpointColumns
    tracking: TrackingColumns
    counters: StreamCounters
    messages_dropped: int
    axes: _containers.RepeatedScalarFieldContainer[str]
    events: _containers.RepeatedCompositeFieldContainer[StreamEvent]
    cycle_time: _duration_pb2.Duration
    kinds: _containers.RepeatedScalarFieldContainer[_plan_pb2.AxisKind]
    def __init__(self, stream: _Optional[str] = ..., executed_cycle: _Optional[int] = ..., lead_cycles: _Optional[int] = ..., phase: _Optional[_Union[Phase, str]] = ..., override_factor: _Optional[float] = ..., cycles: _Optional[_Iterable[int]] = ..., commanded: _Optional[_Union[_plan_pb2.SetpointColumns, _Mapping]] = ..., tracking: _Optional[_Union[TrackingColumns, _Mapping]] = ..., counters: _Optional[_Union[StreamCounters, _Mapping]] = ..., messages_dropped: _Optional[int] = ..., axes: _Optional[_Iterable[str]] = ..., events: _Optional[_Iterable[_Union[StreamEvent, _Mapping]]] = ..., cycle_time: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., kinds: _Optional[_Iterable[_Union[_plan_pb2.AxisKind, str]]] = ...) -> None: ...
