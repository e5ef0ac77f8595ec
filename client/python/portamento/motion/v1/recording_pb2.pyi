import datetime

from google.protobuf import duration_pb2 as _duration_pb2
from portamento.motion.v1 import setpoint_pb2 as _setpoint_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class RecordingHead(_message.Message):
    __slots__ = ("stream", "recorded_by", "cycle_time", "axes")
    STREAM_FIELD_NUMBER: _ClassVar[int]
    RECORDED_BY_FIELD_NUMBER: _ClassVar[int]
    CYCLE_TIME_FIELD_NUMBER: _ClassVar[int]
    AXES_FIELD_NUMBER: _ClassVar[int]
    stream: str
    recorded_by: str
    cycle_time: _duration_pb2.Duration
    axes: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, stream: _Optional[str] = ..., recorded_by: _Optional[str] = ..., cycle_time: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., axes: _Optional[_Iterable[str]] = ...) -> None: ...

class RecordedCycle(_message.Message):
    __slots__ = ("cycle", "position", "velocity", "acceleration", "jerk", "measured_position", "following_error", "load_position", "cycle_jitter_ns")
    CYCLE_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    JERK_FIELD_NUMBER: _ClassVar[int]
    MEASURED_POSITION_FIELD_NUMBER: _ClassVar[int]
    FOLLOWING_ERROR_FIELD_NUMBER: _ClassVar[int]
    LOAD_POSITION_FIELD_NUMBER: _ClassVar[int]
    CYCLE_JITTER_NS_FIELD_NUMBER: _ClassVar[int]
    cycle: int
    position: float
    velocity: float
    acceleration: float
    jerk: float
    measured_position: float
    following_error: float
    load_position: float
    cycle_jitter_ns: int
    def __init__(self, cycle: _Optional[int] = ..., position: _Optional[float] = ..., velocity: _Optional[float] = ..., acceleration: _Optional[float] = ..., jerk: _Optional[float] = ..., measured_position: _Optional[float] = ..., following_error: _Optional[float] = ..., load_position: _Optional[float] = ..., cycle_jitter_ns: _Optional[int] = ...) -> None: ...

class RecordedOperation(_message.Message):
    __slots__ = ("operation", "result", "refused")
    OPERATION_FIELD_NUMBER: _ClassVar[int]
    RESULT_FIELD_NUMBER: _ClassVar[int]
    REFUSED_FIELD_NUMBER: _ClassVar[int]
    operation: _setpoint_pb2.Operation
    result: _setpoint_pb2.OperationResult
    refused: str
    def __init__(self, operation: _Optional[_Union[_setpoint_pb2.Operation, _Mapping]] = ..., result: _Optional[_Union[_setpoint_pb2.OperationResult, _Mapping]] = ..., refused: _Optional[str] = ...) -> None: ...
