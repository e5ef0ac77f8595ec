"""A plan: the motion as analytic pieces."""

from __future__ import annotations

import bisect
import itertools
import math
from dataclasses import dataclass, field

from .motion.v1 import plan_pb2 as pb

PointReport = pb.PvtPointReport


@dataclass(frozen=True)
class Plan:
    """What was planned. ``message`` is all of it; for a plan through points, ``points`` says what became of each."""

    message: pb.Plan
    points: list[PointReport] = field(default_factory=list)

    @property
    def duration(self) -> float:
        """How long it takes [s]."""
        return self.message.duration

    @property
    def cycle_time(self) -> float:
        """Time between two setpoints [s]."""
        return self.message.cycle_time.ToNanoseconds() / 1e9

    @property
    def cycle_count(self) -> int:
        """The last cycle, in which the motion has ended."""
        return self.message.cycle_count

    @property
    def axes(self) -> list[str]:
        """Names, in plan order."""
        return [axis.axis for axis in self.message.axes]

    @property
    def certificate(self) -> pb.PlanCertificate:
        """What a judge found who shares no code with the planner."""
        return self.message.certificate

    def at(self, time: float, axis: int = 0) -> tuple[float, float, float, float]:
        """Position, velocity, acceleration and jerk of an axis after ``time`` [s], for drawing: to rounding, what
        ``Server.sample`` gives to the bit."""
        of = self.message.axes[axis]
        begins = [0.0, *itertools.accumulate(segment.duration for segment in of.segments)]
        index = bisect.bisect_right(begins, time) - 1
        if index < 0 or index >= len(of.segments):
            state = of.reached if index >= 0 or not of.segments else of.segments[0].start
            return state.position + state.velocity * max(0.0, time - begins[-1]), state.velocity, state.acceleration, 0.0
        return _after(of.segments[index], time - begins[index])


def _after(segment: pb.AxisSegment, t: float) -> tuple[float, float, float, float]:
    s, v, a = segment.start.position, segment.start.velocity, segment.start.acceleration
    law = segment.WhichOneof("law")
    if law == "cosine_jerk":
        w, h = 2 * math.pi / segment.duration, segment.cosine_jerk.peak_jerk / 2
        x = w * t
        return (s + v * t + a * t**2 / 2 + h * (t**3 / 6 - (x - math.sin(x)) / w**3),
                v + a * t + h * (t**2 / 2 - (1 - math.cos(x)) / w**2),
                a + h * (t - math.sin(x) / w), h * (1 - math.cos(x)))
    higher = list(segment.polynomial.derivatives) if law == "polynomial" else [segment.jerk]
    derivatives = [s, v, a, *higher]

    def value(order: int) -> float:
        total = 0.0
        for k in range(len(derivatives) - 1, order - 1, -1):
            total = derivatives[k] + total * t / (k - order + 1)
        return total

    return value(0), value(1), value(2), value(3)
