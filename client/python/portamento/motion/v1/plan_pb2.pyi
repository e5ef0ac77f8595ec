import datetime

from google.protobuf import duration_pb2 as _duration_pb2
from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from collections.abc import Iterable as _Iterable, Mapping as _Mapping
from typing import ClassVar as _ClassVar, Optional as _Optional, Union as _Union

DESCRIPTOR: _descriptor.FileDescriptor

class AxisKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    AXIS_KIND_UNSPECIFIED: _ClassVar[AxisKind]
    AXIS_KIND_PRISMATIC: _ClassVar[AxisKind]
    AXIS_KIND_REVOLUTE: _ClassVar[AxisKind]
    AXIS_KIND_PULSES: _ClassVar[AxisKind]

class Quantity(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    QUANTITY_UNSPECIFIED: _ClassVar[Quantity]
    QUANTITY_POSITION: _ClassVar[Quantity]
    QUANTITY_VELOCITY: _ClassVar[Quantity]
    QUANTITY_ACCELERATION: _ClassVar[Quantity]
    QUANTITY_JERK: _ClassVar[Quantity]
    QUANTITY_SNAP: _ClassVar[Quantity]
    QUANTITY_TIME: _ClassVar[Quantity]
    QUANTITY_CRACKLE: _ClassVar[Quantity]
    QUANTITY_POP: _ClassVar[Quantity]
    QUANTITY_LOCK: _ClassVar[Quantity]
    QUANTITY_DROP: _ClassVar[Quantity]

class ProfileFamily(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PROFILE_FAMILY_UNSPECIFIED: _ClassVar[ProfileFamily]
    PROFILE_FAMILY_S_CURVE: _ClassVar[ProfileFamily]
    PROFILE_FAMILY_TRAPEZOIDAL: _ClassVar[ProfileFamily]
    PROFILE_FAMILY_POLYNOMIAL: _ClassVar[ProfileFamily]
    PROFILE_FAMILY_TRIGONOMETRIC: _ClassVar[ProfileFamily]

class ShortPathPolicy(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    SHORT_PATH_POLICY_UNSPECIFIED: _ClassVar[ShortPathPolicy]
    SHORT_PATH_POLICY_REVERSE: _ClassVar[ShortPathPolicy]
    SHORT_PATH_POLICY_MATCH_START_VELOCITY: _ClassVar[ShortPathPolicy]
    SHORT_PATH_POLICY_NEAREST_VELOCITY: _ClassVar[ShortPathPolicy]
    SHORT_PATH_POLICY_REJECT: _ClassVar[ShortPathPolicy]

class Synchronization(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    SYNCHRONIZATION_UNSPECIFIED: _ClassVar[Synchronization]
    SYNCHRONIZATION_NONE: _ClassVar[Synchronization]
    SYNCHRONIZATION_TIME: _ClassVar[Synchronization]
    SYNCHRONIZATION_PHASE: _ClassVar[Synchronization]

class PlanDetail(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PLAN_DETAIL_UNSPECIFIED: _ClassVar[PlanDetail]
    PLAN_DETAIL_FULL: _ClassVar[PlanDetail]
    PLAN_DETAIL_MOTION: _ClassVar[PlanDetail]

class PvtInterpolation(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PVT_INTERPOLATION_UNSPECIFIED: _ClassVar[PvtInterpolation]
    PVT_INTERPOLATION_S_SHAPED: _ClassVar[PvtInterpolation]
    PVT_INTERPOLATION_CUBIC: _ClassVar[PvtInterpolation]
    PVT_INTERPOLATION_QUINTIC: _ClassVar[PvtInterpolation]

class PvtPolicy(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
    PVT_POLICY_UNSPECIFIED: _ClassVar[PvtPolicy]
    PVT_POLICY_PREFER_VELOCITY: _ClassVar[PvtPolicy]
    PVT_POLICY_PREFER_POSITION: _ClassVar[PvtPolicy]
    PVT_POLICY_EXTEND_TIME: _ClassVar[PvtPolicy]
    PVT_POLICY_REJECT: _ClassVar[PvtPolicy]
AXIS_KIND_UNSPECIFIED: AxisKind
AXIS_KIND_PRISMATIC: AxisKind
AXIS_KIND_REVOLUTE: AxisKind
AXIS_KIND_PULSES: AxisKind
QUANTITY_UNSPECIFIED: Quantity
QUANTITY_POSITION: Quantity
QUANTITY_VELOCITY: Quantity
QUANTITY_ACCELERATION: Quantity
QUANTITY_JERK: Quantity
QUANTITY_SNAP: Quantity
QUANTITY_TIME: Quantity
QUANTITY_CRACKLE: Quantity
QUANTITY_POP: Quantity
QUANTITY_LOCK: Quantity
QUANTITY_DROP: Quantity
PROFILE_FAMILY_UNSPECIFIED: ProfileFamily
PROFILE_FAMILY_S_CURVE: ProfileFamily
PROFILE_FAMILY_TRAPEZOIDAL: ProfileFamily
PROFILE_FAMILY_POLYNOMIAL: ProfileFamily
PROFILE_FAMILY_TRIGONOMETRIC: ProfileFamily
SHORT_PATH_POLICY_UNSPECIFIED: ShortPathPolicy
SHORT_PATH_POLICY_REVERSE: ShortPathPolicy
SHORT_PATH_POLICY_MATCH_START_VELOCITY: ShortPathPolicy
SHORT_PATH_POLICY_NEAREST_VELOCITY: ShortPathPolicy
SHORT_PATH_POLICY_REJECT: ShortPathPolicy
SYNCHRONIZATION_UNSPECIFIED: Synchronization
SYNCHRONIZATION_NONE: Synchronization
SYNCHRONIZATION_TIME: Synchronization
SYNCHRONIZATION_PHASE: Synchronization
PLAN_DETAIL_UNSPECIFIED: PlanDetail
PLAN_DETAIL_FULL: PlanDetail
PLAN_DETAIL_MOTION: PlanDetail
PVT_INTERPOLATION_UNSPECIFIED: PvtInterpolation
PVT_INTERPOLATION_S_SHAPED: PvtInterpolation
PVT_INTERPOLATION_CUBIC: PvtInterpolation
PVT_INTERPOLATION_QUINTIC: PvtInterpolation
PVT_POLICY_UNSPECIFIED: PvtPolicy
PVT_POLICY_PREFER_VELOCITY: PvtPolicy
PVT_POLICY_PREFER_POSITION: PvtPolicy
PVT_POLICY_EXTEND_TIME: PvtPolicy
PVT_POLICY_REJECT: PvtPolicy

class AxisState(_message.Message):
    __slots__ = ("position", "velocity", "acceleration")
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    position: float
    velocity: float
    acceleration: float
    def __init__(self, position: _Optional[float] = ..., velocity: _Optional[float] = ..., acceleration: _Optional[float] = ...) -> None: ...

class AxisLimits(_message.Message):
    __slots__ = ("max_velocity", "max_acceleration", "max_jerk", "max_deceleration", "max_velocity_reverse", "min_position", "max_position", "max_snap", "max_higher_derivatives", "feed_rate")
    MAX_VELOCITY_FIELD_NUMBER: _ClassVar[int]
    MAX_ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    MAX_JERK_FIELD_NUMBER: _ClassVar[int]
    MAX_DECELERATION_FIELD_NUMBER: _ClassVar[int]
    MAX_VELOCITY_REVERSE_FIELD_NUMBER: _ClassVar[int]
    MIN_POSITION_FIELD_NUMBER: _ClassVar[int]
    MAX_POSITION_FIELD_NUMBER: _ClassVar[int]
    MAX_SNAP_FIELD_NUMBER: _ClassVar[int]
    MAX_HIGHER_DERIVATIVES_FIELD_NUMBER: _ClassVar[int]
    FEED_RATE_FIELD_NUMBER: _ClassVar[int]
    max_velocity: float
    max_acceleration: float
    max_jerk: float
    max_deceleration: float
    max_velocity_reverse: float
    min_position: float
    max_position: float
    max_snap: float
    max_higher_derivatives: _containers.RepeatedScalarFieldContainer[float]
    feed_rate: float
    def __init__(self, max_velocity: _Optional[float] = ..., max_acceleration: _Optional[float] = ..., max_jerk: _Optional[float] = ..., max_deceleration: _Optional[float] = ..., max_velocity_reverse: _Optional[float] = ..., min_position: _Optional[float] = ..., max_position: _Optional[float] = ..., max_snap: _Optional[float] = ..., max_higher_derivatives: _Optional[_Iterable[float]] = ..., feed_rate: _Optional[float] = ...) -> None: ...

class AxisMove(_message.Message):
    __slots__ = ("axis", "kind", "start", "goal", "limits")
    AXIS_FIELD_NUMBER: _ClassVar[int]
    KIND_FIELD_NUMBER: _ClassVar[int]
    START_FIELD_NUMBER: _ClassVar[int]
    GOAL_FIELD_NUMBER: _ClassVar[int]
    LIMITS_FIELD_NUMBER: _ClassVar[int]
    axis: str
    kind: AxisKind
    start: AxisState
    goal: AxisState
    limits: AxisLimits
    def __init__(self, axis: _Optional[str] = ..., kind: _Optional[_Union[AxisKind, str]] = ..., start: _Optional[_Union[AxisState, _Mapping]] = ..., goal: _Optional[_Union[AxisState, _Mapping]] = ..., limits: _Optional[_Union[AxisLimits, _Mapping]] = ...) -> None: ...

class PlanRequest(_message.Message):
    __slots__ = ("axes", "cycle_time", "family", "order", "short_path_policy", "synchronization", "minimum_duration", "end_on_cycle")
    AXES_FIELD_NUMBER: _ClassVar[int]
    CYCLE_TIME_FIELD_NUMBER: _ClassVar[int]
    FAMILY_FIELD_NUMBER: _ClassVar[int]
    ORDER_FIELD_NUMBER: _ClassVar[int]
    SHORT_PATH_POLICY_FIELD_NUMBER: _ClassVar[int]
    SYNCHRONIZATION_FIELD_NUMBER: _ClassVar[int]
    MINIMUM_DURATION_FIELD_NUMBER: _ClassVar[int]
    END_ON_CYCLE_FIELD_NUMBER: _ClassVar[int]
    axes: _containers.RepeatedCompositeFieldContainer[AxisMove]
    cycle_time: _duration_pb2.Duration
    family: ProfileFamily
    order: int
    short_path_policy: ShortPathPolicy
    synchronization: Synchronization
    minimum_duration: _duration_pb2.Duration
    end_on_cycle: bool
    def __init__(self, axes: _Optional[_Iterable[_Union[AxisMove, _Mapping]]] = ..., cycle_time: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., family: _Optional[_Union[ProfileFamily, str]] = ..., order: _Optional[int] = ..., short_path_policy: _Optional[_Union[ShortPathPolicy, str]] = ..., synchronization: _Optional[_Union[Synchronization, str]] = ..., minimum_duration: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., end_on_cycle: _Optional[bool] = ...) -> None: ...

class PlanResponse(_message.Message):
    __slots__ = ("plan",)
    PLAN_FIELD_NUMBER: _ClassVar[int]
    plan: Plan
    def __init__(self, plan: _Optional[_Union[Plan, _Mapping]] = ...) -> None: ...

class PlanManyRequest(_message.Message):
    __slots__ = ("requests", "detail", "columns")
    REQUESTS_FIELD_NUMBER: _ClassVar[int]
    DETAIL_FIELD_NUMBER: _ClassVar[int]
    COLUMNS_FIELD_NUMBER: _ClassVar[int]
    requests: _containers.RepeatedCompositeFieldContainer[PlanRequest]
    detail: PlanDetail
    columns: MoveColumns
    def __init__(self, requests: _Optional[_Iterable[_Union[PlanRequest, _Mapping]]] = ..., detail: _Optional[_Union[PlanDetail, str]] = ..., columns: _Optional[_Union[MoveColumns, _Mapping]] = ...) -> None: ...

class MoveColumns(_message.Message):
    __slots__ = ("like", "start_position", "start_velocity", "start_acceleration", "goal_position", "goal_velocity", "goal_acceleration", "max_velocity", "max_acceleration", "max_jerk", "max_deceleration", "max_velocity_reverse", "feed_rate")
    LIKE_FIELD_NUMBER: _ClassVar[int]
    START_POSITION_FIELD_NUMBER: _ClassVar[int]
    START_VELOCITY_FIELD_NUMBER: _ClassVar[int]
    START_ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    GOAL_POSITION_FIELD_NUMBER: _ClassVar[int]
    GOAL_VELOCITY_FIELD_NUMBER: _ClassVar[int]
    GOAL_ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    MAX_VELOCITY_FIELD_NUMBER: _ClassVar[int]
    MAX_ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    MAX_JERK_FIELD_NUMBER: _ClassVar[int]
    MAX_DECELERATION_FIELD_NUMBER: _ClassVar[int]
    MAX_VELOCITY_REVERSE_FIELD_NUMBER: _ClassVar[int]
    FEED_RATE_FIELD_NUMBER: _ClassVar[int]
    like: PlanRequest
    start_position: _containers.RepeatedScalarFieldContainer[float]
    start_velocity: _containers.RepeatedScalarFieldContainer[float]
    start_acceleration: _containers.RepeatedScalarFieldContainer[float]
    goal_position: _containers.RepeatedScalarFieldContainer[float]
    goal_velocity: _containers.RepeatedScalarFieldContainer[float]
    goal_acceleration: _containers.RepeatedScalarFieldContainer[float]
    max_velocity: _containers.RepeatedScalarFieldContainer[float]
    max_acceleration: _containers.RepeatedScalarFieldContainer[float]
    max_jerk: _containers.RepeatedScalarFieldContainer[float]
    max_deceleration: _containers.RepeatedScalarFieldContainer[float]
    max_velocity_reverse: _containers.RepeatedScalarFieldContainer[float]
    feed_rate: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, like: _Optional[_Union[PlanRequest, _Mapping]] = ..., start_position: _Optional[_Iterable[float]] = ..., start_velocity: _Optional[_Iterable[float]] = ..., start_acceleration: _Optional[_Iterable[float]] = ..., goal_position: _Optional[_Iterable[float]] = ..., goal_velocity: _Optional[_Iterable[float]] = ..., goal_acceleration: _Optional[_Iterable[float]] = ..., max_velocity: _Optional[_Iterable[float]] = ..., max_acceleration: _Optional[_Iterable[float]] = ..., max_jerk: _Optional[_Iterable[float]] = ..., max_deceleration: _Optional[_Iterable[float]] = ..., max_velocity_reverse: _Optional[_Iterable[float]] = ..., feed_rate: _Optional[_Iterable[float]] = ...) -> None: ...

class PlanManyResponse(_message.Message):
    __slots__ = ("outcomes", "columns")
    OUTCOMES_FIELD_NUMBER: _ClassVar[int]
    COLUMNS_FIELD_NUMBER: _ClassVar[int]
    outcomes: _containers.RepeatedCompositeFieldContainer[PlanOutcome]
    columns: PlanColumns
    def __init__(self, outcomes: _Optional[_Iterable[_Union[PlanOutcome, _Mapping]]] = ..., columns: _Optional[_Union[PlanColumns, _Mapping]] = ...) -> None: ...

class PlanColumns(_message.Message):
    __slots__ = ("planner_version", "evaluation_version", "duration", "cycle_count", "segment_count", "segments", "refusals", "adjustments")
    class RefusedMove(_message.Message):
        __slots__ = ("index", "refusal")
        INDEX_FIELD_NUMBER: _ClassVar[int]
        REFUSAL_FIELD_NUMBER: _ClassVar[int]
        index: int
        refusal: bytes
        def __init__(self, index: _Optional[int] = ..., refusal: _Optional[bytes] = ...) -> None: ...
    class AdjustedMove(_message.Message):
        __slots__ = ("index", "adjustment")
        INDEX_FIELD_NUMBER: _ClassVar[int]
        ADJUSTMENT_FIELD_NUMBER: _ClassVar[int]
        index: int
        adjustment: Adjustment
        def __init__(self, index: _Optional[int] = ..., adjustment: _Optional[_Union[Adjustment, _Mapping]] = ...) -> None: ...
    PLANNER_VERSION_FIELD_NUMBER: _ClassVar[int]
    EVALUATION_VERSION_FIELD_NUMBER: _ClassVar[int]
    DURATION_FIELD_NUMBER: _ClassVar[int]
    CYCLE_COUNT_FIELD_NUMBER: _ClassVar[int]
    SEGMENT_COUNT_FIELD_NUMBER: _ClassVar[int]
    SEGMENTS_FIELD_NUMBER: _ClassVar[int]
    REFUSALS_FIELD_NUMBER: _ClassVar[int]
    ADJUSTMENTS_FIELD_NUMBER: _ClassVar[int]
    planner_version: str
    evaluation_version: int
    duration: _containers.RepeatedScalarFieldContainer[float]
    cycle_count: _containers.RepeatedScalarFieldContainer[int]
    segment_count: _containers.RepeatedScalarFieldContainer[int]
    segments: SegmentColumns
    refusals: _containers.RepeatedCompositeFieldContainer[PlanColumns.RefusedMove]
    adjustments: _containers.RepeatedCompositeFieldContainer[PlanColumns.AdjustedMove]
    def __init__(self, planner_version: _Optional[str] = ..., evaluation_version: _Optional[int] = ..., duration: _Optional[_Iterable[float]] = ..., cycle_count: _Optional[_Iterable[int]] = ..., segment_count: _Optional[_Iterable[int]] = ..., segments: _Optional[_Union[SegmentColumns, _Mapping]] = ..., refusals: _Optional[_Iterable[_Union[PlanColumns.RefusedMove, _Mapping]]] = ..., adjustments: _Optional[_Iterable[_Union[PlanColumns.AdjustedMove, _Mapping]]] = ...) -> None: ...

class SegmentColumns(_message.Message):
    __slots__ = ("duration", "position", "velocity", "acceleration", "jerk", "derivative_count", "derivatives")
    DURATION_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    JERK_FIELD_NUMBER: _ClassVar[int]
    DERIVATIVE_COUNT_FIELD_NUMBER: _ClassVar[int]
    DERIVATIVES_FIELD_NUMBER: _ClassVar[int]
    duration: _containers.RepeatedScalarFieldContainer[float]
    position: _containers.RepeatedScalarFieldContainer[float]
    velocity: _containers.RepeatedScalarFieldContainer[float]
    acceleration: _containers.RepeatedScalarFieldContainer[float]
    jerk: _containers.RepeatedScalarFieldContainer[float]
    derivative_count: _containers.RepeatedScalarFieldContainer[int]
    derivatives: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, duration: _Optional[_Iterable[float]] = ..., position: _Optional[_Iterable[float]] = ..., velocity: _Optional[_Iterable[float]] = ..., acceleration: _Optional[_Iterable[float]] = ..., jerk: _Optional[_Iterable[float]] = ..., derivative_count: _Optional[_Iterable[int]] = ..., derivatives: _Optional[_Iterable[float]] = ...) -> None: ...

class PlanOutcome(_message.Message):
    __slots__ = ("plan", "refusal")
    PLAN_FIELD_NUMBER: _ClassVar[int]
    REFUSAL_FIELD_NUMBER: _ClassVar[int]
    plan: Plan
    refusal: bytes
    def __init__(self, plan: _Optional[_Union[Plan, _Mapping]] = ..., refusal: _Optional[bytes] = ...) -> None: ...

class AxisSegment(_message.Message):
    __slots__ = ("duration", "start", "jerk", "polynomial", "cosine_jerk")
    class Polynomial(_message.Message):
        __slots__ = ("derivatives",)
        DERIVATIVES_FIELD_NUMBER: _ClassVar[int]
        derivatives: _containers.RepeatedScalarFieldContainer[float]
        def __init__(self, derivatives: _Optional[_Iterable[float]] = ...) -> None: ...
    class CosineJerk(_message.Message):
        __slots__ = ("peak_jerk",)
        PEAK_JERK_FIELD_NUMBER: _ClassVar[int]
        peak_jerk: float
        def __init__(self, peak_jerk: _Optional[float] = ...) -> None: ...
    DURATION_FIELD_NUMBER: _ClassVar[int]
    START_FIELD_NUMBER: _ClassVar[int]
    JERK_FIELD_NUMBER: _ClassVar[int]
    POLYNOMIAL_FIELD_NUMBER: _ClassVar[int]
    COSINE_JERK_FIELD_NUMBER: _ClassVar[int]
    duration: float
    start: AxisState
    jerk: float
    polynomial: AxisSegment.Polynomial
    cosine_jerk: AxisSegment.CosineJerk
    def __init__(self, duration: _Optional[float] = ..., start: _Optional[_Union[AxisState, _Mapping]] = ..., jerk: _Optional[float] = ..., polynomial: _Optional[_Union[AxisSegment.Polynomial, _Mapping]] = ..., cosine_jerk: _Optional[_Union[AxisSegment.CosineJerk, _Mapping]] = ...) -> None: ...

class AxisPlan(_message.Message):
    __slots__ = ("axis", "kind", "limits", "segments", "goal", "reached", "adjustments", "classification")
    AXIS_FIELD_NUMBER: _ClassVar[int]
    KIND_FIELD_NUMBER: _ClassVar[int]
    LIMITS_FIELD_NUMBER: _ClassVar[int]
    SEGMENTS_FIELD_NUMBER: _ClassVar[int]
    GOAL_FIELD_NUMBER: _ClassVar[int]
    REACHED_FIELD_NUMBER: _ClassVar[int]
    ADJUSTMENTS_FIELD_NUMBER: _ClassVar[int]
    CLASSIFICATION_FIELD_NUMBER: _ClassVar[int]
    axis: str
    kind: AxisKind
    limits: AxisLimits
    segments: _containers.RepeatedCompositeFieldContainer[AxisSegment]
    goal: AxisState
    reached: AxisState
    adjustments: _containers.RepeatedCompositeFieldContainer[Adjustment]
    classification: Classification
    def __init__(self, axis: _Optional[str] = ..., kind: _Optional[_Union[AxisKind, str]] = ..., limits: _Optional[_Union[AxisLimits, _Mapping]] = ..., segments: _Optional[_Iterable[_Union[AxisSegment, _Mapping]]] = ..., goal: _Optional[_Union[AxisState, _Mapping]] = ..., reached: _Optional[_Union[AxisState, _Mapping]] = ..., adjustments: _Optional[_Iterable[_Union[Adjustment, _Mapping]]] = ..., classification: _Optional[_Union[Classification, _Mapping]] = ...) -> None: ...

class Adjustment(_message.Message):
    __slots__ = ("quantity", "asked", "planned", "reason")
    QUANTITY_FIELD_NUMBER: _ClassVar[int]
    ASKED_FIELD_NUMBER: _ClassVar[int]
    PLANNED_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    quantity: Quantity
    asked: float
    planned: float
    reason: str
    def __init__(self, quantity: _Optional[_Union[Quantity, str]] = ..., asked: _Optional[float] = ..., planned: _Optional[float] = ..., reason: _Optional[str] = ...) -> None: ...

class Classification(_message.Message):
    __slots__ = ("eight_type", "asymmetric_type", "six_case", "pvt_regions", "feed_rate")
    EIGHT_TYPE_FIELD_NUMBER: _ClassVar[int]
    ASYMMETRIC_TYPE_FIELD_NUMBER: _ClassVar[int]
    SIX_CASE_FIELD_NUMBER: _ClassVar[int]
    PVT_REGIONS_FIELD_NUMBER: _ClassVar[int]
    FEED_RATE_FIELD_NUMBER: _ClassVar[int]
    eight_type: str
    asymmetric_type: str
    six_case: str
    pvt_regions: _containers.RepeatedScalarFieldContainer[str]
    feed_rate: float
    def __init__(self, eight_type: _Optional[str] = ..., asymmetric_type: _Optional[str] = ..., six_case: _Optional[str] = ..., pvt_regions: _Optional[_Iterable[str]] = ..., feed_rate: _Optional[float] = ...) -> None: ...

class PlanCertificate(_message.Message):
    __slots__ = ("limit_checks", "continuity_checks", "end_checks", "passed", "reversals")
    class LimitCheck(_message.Message):
        __slots__ = ("axis", "quantity", "limit", "extremum", "at_time", "margin", "guaranteed", "led_back_by")
        AXIS_FIELD_NUMBER: _ClassVar[int]
        QUANTITY_FIELD_NUMBER: _ClassVar[int]
        LIMIT_FIELD_NUMBER: _ClassVar[int]
        EXTREMUM_FIELD_NUMBER: _ClassVar[int]
        AT_TIME_FIELD_NUMBER: _ClassVar[int]
        MARGIN_FIELD_NUMBER: _ClassVar[int]
        GUARANTEED_FIELD_NUMBER: _ClassVar[int]
        LED_BACK_BY_FIELD_NUMBER: _ClassVar[int]
        axis: str
        quantity: Quantity
        limit: float
        extremum: float
        at_time: float
        margin: float
        guaranteed: bool
        led_back_by: float
        def __init__(self, axis: _Optional[str] = ..., quantity: _Optional[_Union[Quantity, str]] = ..., limit: _Optional[float] = ..., extremum: _Optional[float] = ..., at_time: _Optional[float] = ..., margin: _Optional[float] = ..., guaranteed: _Optional[bool] = ..., led_back_by: _Optional[float] = ...) -> None: ...
    class ContinuityCheck(_message.Message):
        __slots__ = ("axis", "quantity", "worst_jump", "at_time", "allowed", "guaranteed")
        AXIS_FIELD_NUMBER: _ClassVar[int]
        QUANTITY_FIELD_NUMBER: _ClassVar[int]
        WORST_JUMP_FIELD_NUMBER: _ClassVar[int]
        AT_TIME_FIELD_NUMBER: _ClassVar[int]
        ALLOWED_FIELD_NUMBER: _ClassVar[int]
        GUARANTEED_FIELD_NUMBER: _ClassVar[int]
        axis: str
        quantity: Quantity
        worst_jump: float
        at_time: float
        allowed: float
        guaranteed: bool
        def __init__(self, axis: _Optional[str] = ..., quantity: _Optional[_Union[Quantity, str]] = ..., worst_jump: _Optional[float] = ..., at_time: _Optional[float] = ..., allowed: _Optional[float] = ..., guaranteed: _Optional[bool] = ...) -> None: ...
    class EndCheck(_message.Message):
        __slots__ = ("axis", "quantity", "residual", "allowed")
        AXIS_FIELD_NUMBER: _ClassVar[int]
        QUANTITY_FIELD_NUMBER: _ClassVar[int]
        RESIDUAL_FIELD_NUMBER: _ClassVar[int]
        ALLOWED_FIELD_NUMBER: _ClassVar[int]
        axis: str
        quantity: Quantity
        residual: float
        allowed: float
        def __init__(self, axis: _Optional[str] = ..., quantity: _Optional[_Union[Quantity, str]] = ..., residual: _Optional[float] = ..., allowed: _Optional[float] = ...) -> None: ...
    class Reversal(_message.Message):
        __slots__ = ("axis", "at_time", "position")
        AXIS_FIELD_NUMBER: _ClassVar[int]
        AT_TIME_FIELD_NUMBER: _ClassVar[int]
        POSITION_FIELD_NUMBER: _ClassVar[int]
        axis: str
        at_time: float
        position: float
        def __init__(self, axis: _Optional[str] = ..., at_time: _Optional[float] = ..., position: _Optional[float] = ...) -> None: ...
    LIMIT_CHECKS_FIELD_NUMBER: _ClassVar[int]
    CONTINUITY_CHECKS_FIELD_NUMBER: _ClassVar[int]
    END_CHECKS_FIELD_NUMBER: _ClassVar[int]
    PASSED_FIELD_NUMBER: _ClassVar[int]
    REVERSALS_FIELD_NUMBER: _ClassVar[int]
    limit_checks: _containers.RepeatedCompositeFieldContainer[PlanCertificate.LimitCheck]
    continuity_checks: _containers.RepeatedCompositeFieldContainer[PlanCertificate.ContinuityCheck]
    end_checks: _containers.RepeatedCompositeFieldContainer[PlanCertificate.EndCheck]
    passed: bool
    reversals: _containers.RepeatedCompositeFieldContainer[PlanCertificate.Reversal]
    def __init__(self, limit_checks: _Optional[_Iterable[_Union[PlanCertificate.LimitCheck, _Mapping]]] = ..., continuity_checks: _Optional[_Iterable[_Union[PlanCertificate.ContinuityCheck, _Mapping]]] = ..., end_checks: _Optional[_Iterable[_Union[PlanCertificate.EndCheck, _Mapping]]] = ..., passed: _Optional[bool] = ..., reversals: _Optional[_Iterable[_Union[PlanCertificate.Reversal, _Mapping]]] = ...) -> None: ...

class PlanMethod(_message.Message):
    __slots__ = ("family", "order", "short_path_policy", "synchronization", "end_on_cycle", "interpolation", "policy")
    FAMILY_FIELD_NUMBER: _ClassVar[int]
    ORDER_FIELD_NUMBER: _ClassVar[int]
    SHORT_PATH_POLICY_FIELD_NUMBER: _ClassVar[int]
    SYNCHRONIZATION_FIELD_NUMBER: _ClassVar[int]
    END_ON_CYCLE_FIELD_NUMBER: _ClassVar[int]
    INTERPOLATION_FIELD_NUMBER: _ClassVar[int]
    POLICY_FIELD_NUMBER: _ClassVar[int]
    family: ProfileFamily
    order: int
    short_path_policy: ShortPathPolicy
    synchronization: Synchronization
    end_on_cycle: bool
    interpolation: PvtInterpolation
    policy: PvtPolicy
    def __init__(self, family: _Optional[_Union[ProfileFamily, str]] = ..., order: _Optional[int] = ..., short_path_policy: _Optional[_Union[ShortPathPolicy, str]] = ..., synchronization: _Optional[_Union[Synchronization, str]] = ..., end_on_cycle: _Optional[bool] = ..., interpolation: _Optional[_Union[PvtInterpolation, str]] = ..., policy: _Optional[_Union[PvtPolicy, str]] = ...) -> None: ...

class Plan(_message.Message):
    __slots__ = ("fingerprint", "planner_version", "evaluation_version", "method", "guaranteed", "cycle_time", "cycle_count", "duration", "axes", "certificate", "explanation")
    FINGERPRINT_FIELD_NUMBER: _ClassVar[int]
    PLANNER_VERSION_FIELD_NUMBER: _ClassVar[int]
    EVALUATION_VERSION_FIELD_NUMBER: _ClassVar[int]
    METHOD_FIELD_NUMBER: _ClassVar[int]
    GUARANTEED_FIELD_NUMBER: _ClassVar[int]
    CYCLE_TIME_FIELD_NUMBER: _ClassVar[int]
    CYCLE_COUNT_FIELD_NUMBER: _ClassVar[int]
    DURATION_FIELD_NUMBER: _ClassVar[int]
    AXES_FIELD_NUMBER: _ClassVar[int]
    CERTIFICATE_FIELD_NUMBER: _ClassVar[int]
    EXPLANATION_FIELD_NUMBER: _ClassVar[int]
    fingerprint: bytes
    planner_version: str
    evaluation_version: int
    method: PlanMethod
    guaranteed: _containers.RepeatedScalarFieldContainer[Quantity]
    cycle_time: _duration_pb2.Duration
    cycle_count: int
    duration: float
    axes: _containers.RepeatedCompositeFieldContainer[AxisPlan]
    certificate: PlanCertificate
    explanation: PlanExplanation
    def __init__(self, fingerprint: _Optional[bytes] = ..., planner_version: _Optional[str] = ..., evaluation_version: _Optional[int] = ..., method: _Optional[_Union[PlanMethod, _Mapping]] = ..., guaranteed: _Optional[_Iterable[_Union[Quantity, str]]] = ..., cycle_time: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., cycle_count: _Optional[int] = ..., duration: _Optional[float] = ..., axes: _Optional[_Iterable[_Union[AxisPlan, _Mapping]]] = ..., certificate: _Optional[_Union[PlanCertificate, _Mapping]] = ..., explanation: _Optional[_Union[PlanExplanation, _Mapping]] = ...) -> None: ...

class PlanExplanation(_message.Message):
    __slots__ = ("critical_axis", "bindings")
    class Binding(_message.Message):
        __slots__ = ("axis", "quantity", "from_time", "to_time")
        AXIS_FIELD_NUMBER: _ClassVar[int]
        QUANTITY_FIELD_NUMBER: _ClassVar[int]
        FROM_TIME_FIELD_NUMBER: _ClassVar[int]
        TO_TIME_FIELD_NUMBER: _ClassVar[int]
        axis: str
        quantity: Quantity
        from_time: float
        to_time: float
        def __init__(self, axis: _Optional[str] = ..., quantity: _Optional[_Union[Quantity, str]] = ..., from_time: _Optional[float] = ..., to_time: _Optional[float] = ...) -> None: ...
    CRITICAL_AXIS_FIELD_NUMBER: _ClassVar[int]
    BINDINGS_FIELD_NUMBER: _ClassVar[int]
    critical_axis: str
    bindings: _containers.RepeatedCompositeFieldContainer[PlanExplanation.Binding]
    def __init__(self, critical_axis: _Optional[str] = ..., bindings: _Optional[_Iterable[_Union[PlanExplanation.Binding, _Mapping]]] = ...) -> None: ...

class PvtAxis(_message.Message):
    __slots__ = ("axis", "kind", "limits", "start", "times", "positions", "velocities")
    AXIS_FIELD_NUMBER: _ClassVar[int]
    KIND_FIELD_NUMBER: _ClassVar[int]
    LIMITS_FIELD_NUMBER: _ClassVar[int]
    START_FIELD_NUMBER: _ClassVar[int]
    TIMES_FIELD_NUMBER: _ClassVar[int]
    POSITIONS_FIELD_NUMBER: _ClassVar[int]
    VELOCITIES_FIELD_NUMBER: _ClassVar[int]
    axis: str
    kind: AxisKind
    limits: AxisLimits
    start: AxisState
    times: _containers.RepeatedScalarFieldContainer[float]
    positions: _containers.RepeatedScalarFieldContainer[float]
    velocities: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, axis: _Optional[str] = ..., kind: _Optional[_Union[AxisKind, str]] = ..., limits: _Optional[_Union[AxisLimits, _Mapping]] = ..., start: _Optional[_Union[AxisState, _Mapping]] = ..., times: _Optional[_Iterable[float]] = ..., positions: _Optional[_Iterable[float]] = ..., velocities: _Optional[_Iterable[float]] = ...) -> None: ...

class PlanPvtRequest(_message.Message):
    __slots__ = ("axes", "cycle_time", "interpolation", "policy", "finish_unreached")
    AXES_FIELD_NUMBER: _ClassVar[int]
    CYCLE_TIME_FIELD_NUMBER: _ClassVar[int]
    INTERPOLATION_FIELD_NUMBER: _ClassVar[int]
    POLICY_FIELD_NUMBER: _ClassVar[int]
    FINISH_UNREACHED_FIELD_NUMBER: _ClassVar[int]
    axes: _containers.RepeatedCompositeFieldContainer[PvtAxis]
    cycle_time: _duration_pb2.Duration
    interpolation: PvtInterpolation
    policy: PvtPolicy
    finish_unreached: bool
    def __init__(self, axes: _Optional[_Iterable[_Union[PvtAxis, _Mapping]]] = ..., cycle_time: _Optional[_Union[datetime.timedelta, _duration_pb2.Duration, _Mapping]] = ..., interpolation: _Optional[_Union[PvtInterpolation, str]] = ..., policy: _Optional[_Union[PvtPolicy, str]] = ..., finish_unreached: _Optional[bool] = ...) -> None: ...

class PvtPointReport(_message.Message):
    __slots__ = ("axis", "point", "region", "position", "velocity", "time", "least_displacement", "greatest_displacement", "adjustments")
    AXIS_FIELD_NUMBER: _ClassVar[int]
    POINT_FIELD_NUMBER: _ClassVar[int]
    REGION_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    TIME_FIELD_NUMBER: _ClassVar[int]
    LEAST_DISPLACEMENT_FIELD_NUMBER: _ClassVar[int]
    GREATEST_DISPLACEMENT_FIELD_NUMBER: _ClassVar[int]
    ADJUSTMENTS_FIELD_NUMBER: _ClassVar[int]
    axis: str
    point: int
    region: str
    position: float
    velocity: float
    time: float
    least_displacement: float
    greatest_displacement: float
    adjustments: _containers.RepeatedCompositeFieldContainer[Adjustment]
    def __init__(self, axis: _Optional[str] = ..., point: _Optional[int] = ..., region: _Optional[str] = ..., position: _Optional[float] = ..., velocity: _Optional[float] = ..., time: _Optional[float] = ..., least_displacement: _Optional[float] = ..., greatest_displacement: _Optional[float] = ..., adjustments: _Optional[_Iterable[_Union[Adjustment, _Mapping]]] = ...) -> None: ...

class PlanPvtResponse(_message.Message):
    __slots__ = ("plan", "points")
    PLAN_FIELD_NUMBER: _ClassVar[int]
    POINTS_FIELD_NUMBER: _ClassVar[int]
    plan: Plan
    points: _containers.RepeatedCompositeFieldContainer[PvtPointReport]
    def __init__(self, plan: _Optional[_Union[Plan, _Mapping]] = ..., points: _Optional[_Iterable[_Union[PvtPointReport, _Mapping]]] = ...) -> None: ...

class VerifyPlanRequest(_message.Message):
    __slots__ = ("plan", "against")
    PLAN_FIELD_NUMBER: _ClassVar[int]
    AGAINST_FIELD_NUMBER: _ClassVar[int]
    plan: Plan
    against: _containers.RepeatedCompositeFieldContainer[AxisMove]
    def __init__(self, plan: _Optional[_Union[Plan, _Mapping]] = ..., against: _Optional[_Iterable[_Union[AxisMove, _Mapping]]] = ...) -> None: ...

class VerifyPlanResponse(_message.Message):
    __slots__ = ("certificate",)
    CERTIFICATE_FIELD_NUMBER: _ClassVar[int]
    certificate: PlanCertificate
    def __init__(self, certificate: _Optional[_Union[PlanCertificate, _Mapping]] = ...) -> None: ...

class SamplePlanRequest(_message.Message):
    __slots__ = ("plan", "first_cycle", "cycles")
    PLAN_FIELD_NUMBER: _ClassVar[int]
    FIRST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    CYCLES_FIELD_NUMBER: _ClassVar[int]
    plan: Plan
    first_cycle: int
    cycles: int
    def __init__(self, plan: _Optional[_Union[Plan, _Mapping]] = ..., first_cycle: _Optional[int] = ..., cycles: _Optional[int] = ...) -> None: ...

class SamplePlanResponse(_message.Message):
    __slots__ = ("first_cycle", "columns", "digest")
    FIRST_CYCLE_FIELD_NUMBER: _ClassVar[int]
    COLUMNS_FIELD_NUMBER: _ClassVar[int]
    DIGEST_FIELD_NUMBER: _ClassVar[int]
    first_cycle: int
    columns: SetpointColumns
    digest: int
    def __init__(self, first_cycle: _Optional[int] = ..., columns: _Optional[_Union[SetpointColumns, _Mapping]] = ..., digest: _Optional[int] = ...) -> None: ...

class SetpointColumns(_message.Message):
    __slots__ = ("cycles", "position", "velocity", "acceleration", "jerk")
    CYCLES_FIELD_NUMBER: _ClassVar[int]
    POSITION_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_FIELD_NUMBER: _ClassVar[int]
    JERK_FIELD_NUMBER: _ClassVar[int]
    cycles: int
    position: _containers.RepeatedScalarFieldContainer[float]
    velocity: _containers.RepeatedScalarFieldContainer[float]
    acceleration: _containers.RepeatedScalarFieldContainer[float]
    jerk: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, cycles: _Optional[int] = ..., position: _Optional[_Iterable[float]] = ..., velocity: _Optional[_Iterable[float]] = ..., acceleration: _Optional[_Iterable[float]] = ..., jerk: _Optional[_Iterable[float]] = ...) -> None: ...
