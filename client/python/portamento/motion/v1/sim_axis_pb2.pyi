import datetime

from google.protobuf import duration_pb2 as _duration_pb2
from portamento.motion.v1 import plan_pb2 as _plan_pb2
from portamento.motion.v1 import setpoint_pb2 as _setpoint_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class AxisModel(_message.Message):
    __slots__ = ("axis", "mechanics", "servo", "encoder", "noise_seed", "pulses_per_unit")
    AXIS_FIELD_NUMBER: _ClassVar[int]
    MECHANICS_FIELD_NUMBER: _ClassVar[int]
    SERVO_FIELD_NUMBER: _ClassVar[int]
    ENCODER_FIELD_NUMBER: _ClassVar[int]
    NOISE_SEED_FIELD_NUMBER: _ClassVar[int]
    PULSES_PER_UNIT_FIELD_NUMBER: _ClassVar[int]
    axis: str
    mechanics: Mechanics
    servo: Servo
    encoder: Encoder
    noise_seed: int
    pulses_per_unit: float
    def __init__(self, axis: _Optional[str] = ..., mechanics: _Optional[_Union[Mechanics, _Mapping]] = ..., servo: _Optional[_Union[Servo, _Mapping]] = ..., encoder: _Optional[_Union[Encoder, _Mapping]] = ..., noise_seed: _Optional[int] = ..., pulses_per_unit: _Optional[float] = ...) -> None: ...

class Mechanics(_message.Message):
    __slots__ = ("ideal", "rigid", "two_mass", "prescribed", "friction", "max_effort")
    class IdealFollower(_message.Message):
        __slots__ = ()
        def __init__(self) -> None: ...
    class PrescribedMotor(_message.Message):
        __slots__ = ("load_inertia", "stiffness", "damping")
        LOAD_INERTIA_FIELD_NUMBER: _ClassVar[int]
        STIFFNESS_FIELD_NUMBER: _ClassVar[int]
        DAMPING_FIELD_NUMBER: _ClassVar[int]
        load_inertia: float
        stiffness: float
        damping: float
        def __init__(self, load_inertia: _Optional[float] = ..., stiffness: _Optional[float] = ..., damping: _Optional[float] = ...) -> None: ...
    class RigidLoad(_message.Message):
        __slots__ = ("inertia",)
        INERTIA_FIELD_NUMBER: _ClassVar[int]
        inertia: float
        def __init__(self, inertia: _Optional[float] = ...) -> None: ...
    class TwoMassLoad(_message.Message):
        __slots__ = ("motor_inertia", "load_inertia", "stiffness", "damping")
        MOTOR_INERTIA_FIELD_NUMBER: _ClassVar[int]
        LOAD_INERTIA_FIELD_NUMBER: _ClassVar[int]
        STIFFNESS_FIELD_NUMBER: _ClassVar[int]
        DAMPING_FIELD_NUMBER: _ClassVar[int]
        motor_inertia: float
        load_inertia: float
        stiffness: float
        damping: float
        def __init__(self, motor_inertia: _Optional[float] = ..., load_inertia: _Optional[float] = ..., stiffness: _Optional[float] = ..., damping: _Optional[float] = ...) -> None: ...
    class Friction(_message.Message):
        __slots__ = ("coulomb", "viscous", "static_friction", "stribeck_velocity")
        COULOMB_FIELD_NUMBER: _ClassVar[int]
        VISCOUS_FIELD_NUMBER: _ClassVar[int]
        STATIC_FRICTION_FIELD_NUMBER: _ClassVar[int]
        STRIBECK_VELOCITY_FIELD_NUMBER: _ClassVar[int]
        coulomb: float
        viscous: float
        static_friction: float
        stribeck_velocity: float
        def __init__(self, coulomb: _Optional[float] = ..., viscous: _Optional[float] = ..., static_friction: _Optional[float] = ..., stribeck_velocity: _Optional[float] = ...) -> None: ...
    IDEAL_FIELD_NUMBER: _ClassVar[int]
    RIGID_FIELD_NUMBER: _ClassVar[int]
    TWO_MASS_FIELD_NUMBER: _ClassVar[int]
    PRESCRIBED_FIELD_NUMBER: _ClassVar[int]
    FRICTION_FIELD_NUMBER: _ClassVar[int]
    MAX_EFFORT_FIELD_NUMBER: _ClassVar[int]
    ideal: Mechanics.IdealFollower
    rigid: Mechanics.RigidLoad
    two_mass: Mechanics.TwoMassLoad
    prescribed: Mechanics.PrescribedMotor
    friction: Mechanics.Friction
    max_effort: float
    def __init__(self, ideal: _Optional[_Union[Mechanics.IdealFollower, _Mapping]] = ..., rigid: _Optional[_Union[Mechanics.RigidLoad, _Mapping]] = ..., two_mass: _Optional[_Union[Mechanics.TwoMassLoad, _Mapping]] = ..., prescribed: _Optional[_Union[Mechanics.PrescribedMotor, _Mapping]] = ..., friction: _Optional[_Union[Mechanics.Friction, _Mapping]] = ..., max_effort: _Optional[float] = ...) -> None: ...

class Servo(_message.Message):
    __slots__ = ("position_gain", "velocity_gain", "velocity_integral_time", "current_loop_bandwidth", "velocity_feedforward", "acceleration_feedforward", "substep", "command_delay")
    POSITION_GAIN_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_GAIN_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_INTEGRAL_TIME_FIELD_NUMBER: _ClassVar[int]
    CURRENT_LOOP_BANDWIDTH_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FEEDFORWARD_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FEEDFORWARD_FIELD_NUMBER: _ClassVar[int]
    SUBSTEP_FIELD_NUMBER: _ClassVar[int]
    COMMAND_DELAY_FIELD_NUMBER: _ClassVar[int]
    position_gain: float
    velocity_gain: float
    velocity_integral_time: float
    current_loop_bandwidth: float
    velocity_feedforward: float
    acceleration_feedforward: float
    substep: float
    command_delay: float
    def __init__(self, position_gain: _Optional[float] = ..., velocity_gain: _Optional[float] = ..., velocity_integral_time: _Optional[float] = ..., current_loop_bandwidth: _Optional[float] = ..., velocity_feedforward: _Optional[float] = ..., acceleration_feedforward: _Optional[float] = ..., substep: _Optional[float] = ..., command_delay: _Optional[float] = ...) -> None: ...

class Encoder(_message.Message):
    __slots__ = ("resolution",)
    RESOLUTION_FIELD_NUMBER: _ClassVar[int]
    resolution: float
    def __init__(self, resolution: _Optional[float] = ...) -> None: ...

class RunTrackingRequest(_message.Message):
    __slots__ = ("stream", "endpoints", "plan", "models", "lead_cycles", "virtual_time", "settle_window", "settle_tolerance", "stay_open", "accept_unproved", "patience", "compact", "spread")
    STREAM_FIELD_NUMBER: _ClassVar[int]
    ENDPOINTS_FIELD_NUMBER: _ClassVar[int]
    PLAN_FIELD_NUMBER: _ClassVar[int]
    MODELS_FIELD_NUMBER: _ClassVar[int]
    LEAD_CYCLES_FIELD_NUMBER: _ClassVar[int]
    VIRTUAL_TIME_FIELD_NUMBER: _ClassVar[int]
    SETTLE_WINDOW_FIELD_NUMBER: _ClassVar[int]
    SETTLE_TOLERANCE_FIELD_NUMBER: _ClassVar[int]
    STAY_OPEN_FIELD_NUMBER: _ClassVar[int]
    ACCEPT_UNPROVED_FIELD_NUMBER: _ClassVar[int]
    PATIENCE_FIELD_NUMBER: _ClassVar[int]
    COMPACT_FIELD_NUMBER: _ClassVar[int]
    SPREAD_FIELD_NUMBER: _ClassVar[int]
    stream: str
    endpoints: _containers.RepeatedScalarFieldContainer[str]
    plan: _plan_pb2.Plan
    models: _containers.RepeatedCompositeFieldContainer[AxisModel]
    lead_cycles: int
    virtual_time: bool
    settle_window: _duration_pb2.Duration
    settle_tolerance: float
    stay_open: bool
    accept_unproved: bool
    patience: _duration_pb2.Duration
    compact: bool
    spread: bool
    def __init__(self, stream: _Optional[str] = ..., endpoints: _Optional[_Iterable[str]] = ..., plan: _Optional[_Union[_plan_pb2.Plan, _Mapping]] = ..., models: _Optional[_Iterable[_Union[AxisModel, _Mapping]]] = ..., lead_cycles: _Optional[int] = ..., virtual_time: _Optional[bool] = ..., settle_window: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., settle_tolerance: _Optional[float] = ..., stay_open: _Optional[bool] = ..., accept_unproved: _Optional[bool] = ..., patience: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., compact: _Optional[bool] = ..., spread: _Optional[bool] = ...) -> None: ...

class RunTrackingResponse(_message.Message):
    __slots__ = ("samples", "event", "report", "fail_over", "operated")
    SAMPLES_FIELD_NUMBER: _ClassVar[int]
    EVENT_FIELD_NUMBER: _ClassVar[int]
    REPORT_FIELD_NUMBER: _ClassVar[int]
    FAIL_OVER_FIELD_NUMBER: _ClassVar[int]
    OPERATED_FIELD_NUMBER: _ClassVar[int]
    samples: TrackingSamples
    event: _setpoint_pb2.StreamEvent
    report: TrackingReport
    fail_over: FailOver
    operated: Operated
    def __init__(self, samples: _Optional[_Union[TrackingSamples, _Mapping]] = ..., event: _Optional[_Union[_setpoint_pb2.StreamEvent, _Mapping]] = ..., report: _Optional[_Union[TrackingReport, _Mapping]] = ..., fail_over: _Optional[_Union[FailOver, _Mapping]] = ..., operated: _Optional[_Union[Operated, _Mapping]] = ...) -> None: ...

class Operated(_message.Message):
    __slots__ = ("operation", "result")
    OPERATION_FIELD_NUMBER: _ClassVar[int]
    RESULT_FIELD_NUMBER: _ClassVar[int]
    operation: _setpoint_pb2.Operation
    result: _setpoint_pb2.OperationResult
    def __init__(self, operation: _Optional[_Union[_setpoint_pb2.Operation, _Mapping]] = ..., result: _Optional[_Union[_setpoint_pb2.OperationResult, _Mapping]] = ...) -> None: ...

class FailOver(_message.Message):
    __slots__ = ("cause", "to", "executed_cycle", "took")
    CAUSE_FIELD_NUMBER: _ClassVar[int]
    FROM_FIELD_NUMBER: _ClassVar[int]
    TO_FIELD_NUMBER: _ClassVar[int]
    EXECUTED_CYCLE_FIELD_NUMBER: _ClassVar[int]
    TOOK_FIELD_NUMBER: _ClassVar[int]
    cause: str
    to: str
    executed_cycle: int
    took: float
    def __init__(self, cause: _Optional[str] = ..., to: _Optional[str] = ..., executed_cycle: _Optional[int] = ..., took: _Optional[float] = ..., **kwargs) -> None: ...

class TrackingSamples(_message.Message):
    __slots__ = ("first_cycle", "commanded", "tracking", "load_position")
    FIRST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    COMMANDED_FIELD_NUMBER: _ClassVar[int]
    TRACKING_FIELD_NUMBER: _ClassVar[int]
    LOAD_POSITION_FIELD_NUMBER: _ClassVar[int]
    first_cycle: int
    commanded: _plan_pb2.SetpointColumns
    tracking: _setpoint_pb2.TrackingColumns
    load_position: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, first_cycle: _Optional[int] = ..., commanded: _Optional[_Union[_plan_pb2.SetpointColumns, _Mapping]] = ..., tracking: _Optional[_Union[_setpoint_pb2.TrackingColumns, _Mapping]] = ..., load_position: _Optional[_Iterable[float]] = ...) -> None: ...

class TrackingReport(_message.Message):
    __slots__ = ("axes", "stream")
    AXES_FIELD_NUMBER: _ClassVar[int]
    STREAM_FIELD_NUMBER: _ClassVar[int]
    axes: _containers.RepeatedCompositeFieldContainer[AxisReportCard]
    stream: StreamReportCard
    def __init__(self, axes: _Optional[_Iterable[_Union[AxisReportCard, _Mapping]]] = ..., stream: _Optional[_Union[StreamReportCard, _Mapping]] = ...) -> None: ...

class AxisReportCard(_message.Message):
    __slots__ = ("axis", "max_following_error", "max_following_error_time", "rms_following_error", "overshoot", "settling_time", "residual_vibration_amplitude", "residual_vibration_frequency", "max_effort", "effort_saturated_time")
    AXIS_FIELD_NUMBER: _ClassVar[int]
    MAX_FOLLOWING_ERROR_FIELD_NUMBER: _ClassVar[int]
    MAX_FOLLOWING_ERROR_TIME_FIELD_NUMBER: _ClassVar[int]
    RMS_FOLLOWING_ERROR_FIELD_NUMBER: _ClassVar[int]
    OVERSHOOT_FIELD_NUMBER: _ClassVar[int]
    SETTLING_TIME_FIELD_NUMBER: _ClassVar[int]
    RESIDUAL_VIBRATION_AMPLITUDE_FIELD_NUMBER: _ClassVar[int]
    RESIDUAL_VIBRATION_FREQUENCY_FIELD_NUMBER: _ClassVar[int]
    MAX_EFFORT_FIELD_NUMBER: _ClassVar[int]
    EFFORT_SATURATED_TIME_FIELD_NUMBER: _ClassVar[int]
    axis: str
    max_following_error: float
    max_following_error_time: float
    rms_following_error: float
    overshoot: float
    settling_time: float
    residual_vibration_amplitude: float
    residual_vibration_frequency: float
    max_effort: float
    effort_saturated_time: float
    def __init__(self, axis: _Optional[str] = ..., max_following_error: _Optional[float] = ..., max_following_error_time: _Optional[float] = ..., rms_following_error: _Optional[float] = ..., overshoot: _Optional[float] = ..., settling_time: _Optional[float] = ..., residual_vibration_amplitude: _Optional[float] = ..., residual_vibration_frequency: _Optional[float] = ..., max_effort: _Optional[float] = ..., effort_saturated_time: _Optional[float] = ...) -> None: ...

class StreamReportCard(_message.Message):
    __slots__ = ("cycles_executed", "counters", "failovers", "p50_cycle_jitter", "p99_cycle_jitter", "max_cycle_jitter", "digest", "stop_tail_used", "revisions")
    CYCLES_EXECUTED_FIELD_NUMBER: _ClassVar[int]
    COUNTERS_FIELD_NUMBER: _ClassVar[int]
    FAILOVERS_FIELD_NUMBER: _ClassVar[int]
    P50_CYCLE_JITTER_FIELD_NUMBER: _ClassVar[int]
    P99_CYCLE_JITTER_FIELD_NUMBER: _ClassVar[int]
    MAX_CYCLE_JITTER_FIELD_NUMBER: _ClassVar[int]
    DIGEST_FIELD_NUMBER: _ClassVar[int]
    STOP_TAIL_USED_FIELD_NUMBER: _ClassVar[int]
    REVISIONS_FIELD_NUMBER: _ClassVar[int]
    cycles_executed: int
    counters: _setpoint_pb2.StreamCounters
    failovers: int
    p50_cycle_jitter: float
    p99_cycle_jitter: float
    max_cycle_jitter: float
    digest: int
    stop_tail_used: bool
    revisions: int
    def __init__(self, cycles_executed: _Optional[int] = ..., counters: _Optional[_Union[_setpoint_pb2.StreamCounters, _Mapping]] = ..., failovers: _Optional[int] = ..., p50_cycle_jitter: _Optional[float] = ..., p99_cycle_jitter: _Optional[float] = ..., max_cycle_jitter: _Optional[float] = ..., digest: _Optional[int] = ..., stop_tail_used: _Optional[bool] = ..., revisions: _Optional[int] = ...) -> None: ...

class CommandRequest(_message.Message):
    __slots__ = ("stream", "operation")
    STREAM_FIELD_NUMBER: _ClassVar[int]
    OPERATION_FIELD_NUMBER: _ClassVar[int]
    stream: str
    operation: _setpoint_pb2.Operation
    def __init__(self, stream: _Optional[str] = ..., operation: _Optional[_Union[_setpoint_pb2.Operation, _Mapping]] = ...) -> None: ...

class CommandResponse(_message.Message):
    __slots__ = ("result",)
    RESULT_FIELD_NUMBER: _ClassVar[int]
    result: _setpoint_pb2.OperationResult
    def __init__(self, result: _Optional[_Union[_setpoint_pb2.OperationResult, _Mapping]] = ...) -> None: ...

class GetAxisModelRequest(_message.Message):
    __slots__ = ()
    def __init__(self) -> None: ...

class GetAxisModelResponse(_message.Message):
    __slots__ = ("models",)
    MODELS_FIELD_NUMBER: _ClassVar[int]
    models: _containers.RepeatedCompositeFieldContainer[AxisModel]
    def __init__(self, models: _Optional[_Iterable[_Union[AxisModel, _Mapping]]] = ...) -> None: ...

class InjectFaultRequest(_message.Message):
    __slots__ = ("stall_reads", "drop_batches", "pause_reports", "effort_limit_scale")
    STALL_READS_FIELD_NUMBER: _ClassVar[int]
    DROP_BATCHES_FIELD_NUMBER: _ClassVar[int]
    PAUSE_REPORTS_FIELD_NUMBER: _ClassVar[int]
    EFFORT_LIMIT_SCALE_FIELD_NUMBER: _ClassVar[int]
    stall_reads: _duration_pb2.Duration
    drop_batches: int
    pause_reports: _duration_pb2.Duration
    effort_limit_scale: float
    def __init__(self, stall_reads: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., drop_batches: _Optional[int] = ..., pause_reports: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., effort_limit_scale: _Optional[float] = ...) -> None: ...

class InjectFaultResponse(_message.Message):
    __slots__ = ("runs",)
    RUNS_FIELD_NUMBER: _ClassVar[int]
    runs: int
    def __init__(self, runs: _Optional[int] = ...) -> None: ...
