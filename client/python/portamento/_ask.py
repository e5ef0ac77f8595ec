"""What is asked, in SI units: m and rad, or pulses, and s."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

from .motion.v1 import plan_pb2 as pb


class Kind(Enum):
    """What an axis moves in, and with it the unit u of its numbers."""

    PRISMATIC = pb.AXIS_KIND_PRISMATIC  #: travels, u = m
    REVOLUTE = pb.AXIS_KIND_REVOLUTE  #: turns, u = rad
    PULSES = pb.AXIS_KIND_PULSES  #: counts, u = pulses


@dataclass(frozen=True)
class State:
    """Where an axis is [u], how fast [u/s], and how that changes [u/s²]."""

    position: float = 0.0
    velocity: float = 0.0
    acceleration: float = 0.0

    def to_wire(self) -> pb.AxisState:
        return pb.AxisState(position=self.position, velocity=self.velocity, acceleration=self.acceleration)


@dataclass(frozen=True)
class Limits:
    """What an axis may do: magnitudes above 0."""

    velocity: float  #: [u/s]
    acceleration: float  #: [u/s²], while speed grows
    jerk: float = 0.0  #: [u/s³]; a trapezoid can do without
    deceleration: float | None = None  #: [u/s²], while speed shrinks; as ``acceleration`` if not given
    velocity_reverse: float | None = None  #: [u/s], towards falling positions; as ``velocity`` if not given
    min_position: float | None = None  #: [u]
    max_position: float | None = None  #: [u]
    feed_rate: float | None = None  #: [u/s], speed asked for, which an override scales
    snap: float | None = None  #: [u/s⁴], for polynomials of order 4 and up
    higher_derivatives: Sequence[float] = field(default_factory=tuple)  #: [u/s⁵ …], for order 5 and up

    def to_wire(self) -> pb.AxisLimits:
        return pb.AxisLimits(
            max_velocity=self.velocity, max_acceleration=self.acceleration, max_jerk=self.jerk,
            max_deceleration=self.deceleration, max_velocity_reverse=self.velocity_reverse,
            min_position=self.min_position, max_position=self.max_position, feed_rate=self.feed_rate,
            max_snap=self.snap, max_higher_derivatives=self.higher_derivatives)


@dataclass(frozen=True)
class Move:
    """One axis, from its start to its goal. A number is a state at rest there."""

    axis: str
    goal: State | float
    limits: Limits
    start: State | float = State()
    kind: Kind = Kind.PRISMATIC

    def to_wire(self) -> pb.AxisMove:
        return pb.AxisMove(axis=self.axis, kind=self.kind.value, start=_state(self.start), goal=_state(self.goal),
                           limits=self.limits.to_wire())


@dataclass(frozen=True)
class Points:
    """One axis, through points of time [s], position [u] and velocity [u/s]."""

    axis: str
    points: Sequence[tuple[float, float, float]]
    limits: Limits
    start: State | float = State()
    kind: Kind = Kind.PRISMATIC

    def to_wire(self) -> pb.PvtAxis:
        times, positions, velocities = zip(*self.points) if self.points else ((), (), ())
        return pb.PvtAxis(axis=self.axis, kind=self.kind.value, start=_state(self.start), limits=self.limits.to_wire(),
                          times=times, positions=positions, velocities=velocities)


def _state(of: State | float) -> pb.AxisState:
    return (of if isinstance(of, State) else State(position=of)).to_wire()
