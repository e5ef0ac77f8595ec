"""Many moves of one axis: asked and answered in columns."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence

from ._plan import Plan
from ._status import Refused, refused_of
from .motion.v1 import plan_pb2 as pb

#: Moves in a message: as many as a server takes that nobody has told otherwise.
PER_MESSAGE = 4096

#: What may differ from move to move [u, u/s, u/s², u/s³]; the rest is that of the move that all are like.
COLUMNS = ("start_position", "start_velocity", "start_acceleration", "goal_position", "goal_velocity", "goal_acceleration",
           "max_velocity", "max_acceleration", "max_jerk", "max_deceleration", "max_velocity_reverse", "feed_rate")


def messages(like: pb.PlanRequest, columns: Mapping[str, Sequence[float]]) -> Iterator[pb.PlanManyRequest]:
    """In messages, each with as many moves as it may have."""
    if unknown := sorted(set(columns) - set(COLUMNS)):
        raise TypeError(f"no such column: {', '.join(unknown)}; there are {', '.join(COLUMNS)}")
    count = max((len(column) for column in columns.values()), default=0)
    if ragged := {name: len(column) for name, column in columns.items() if len(column) not in (0, count)}:
        raise ValueError(f"columns of {count} moves with other lengths: {ragged}; give one number for each move, or none")
    for first in range(0, count, PER_MESSAGE):
        part = {name: column[first:first + PER_MESSAGE] for name, column in columns.items()}
        yield pb.PlanManyRequest(columns=pb.MoveColumns(like=like, **part))


class Moves:
    """What became of many moves, in their order. Numbers stay in columns; ``plan`` makes a plan of one of them."""

    def __init__(self, like: pb.PlanRequest, columns: Mapping[str, Sequence[float]], parts: Sequence[pb.PlanColumns]):
        self._like, self._columns, self._parts = like, columns, parts
        #: How long each lasts [s]; 0 of one that is refused.
        self.durations: list[float] = [duration for part in parts for duration in part.duration]
        #: The cycle in which each has ended; 0 of one that is refused.
        self.cycle_counts: list[int] = [count for part in parts for count in part.cycle_count]
        #: Those that are refused, by their index.
        self.refused: dict[int, Refused] = {
            number * PER_MESSAGE + refused.index: refused_of(refused.refusal)
            for number, part in enumerate(parts) for refused in part.refusals}
        self._begins = [list(itertools.accumulate(part.segment_count, initial=0)) for part in parts]

    def __len__(self) -> int:
        return len(self.durations)

    def plan(self, index: int) -> Plan:
        """One of them, with the pieces that ``Server.plan`` gives for it, bit by bit; no certificate and no fingerprint, which
        ``Server.verify`` computes. Raises ``Refused`` where it is refused."""
        if not 0 <= index < len(self):
            raise IndexError(f"move {index} of {len(self)}")
        if index in self.refused:
            raise self.refused[index]
        number, place = divmod(index, PER_MESSAGE)
        part, asked = self._parts[number], self._like.axes[0]
        goal = self._state("goal", index, asked.goal)
        axis = pb.AxisPlan(axis=asked.axis, kind=asked.kind, limits=asked.limits, goal=goal, reached=goal)
        for name in COLUMNS[6:]:
            if (column := self._columns.get(name)) is not None and len(column):
                setattr(axis.limits, name, column[index])
        for adjusted in part.adjustments:
            if adjusted.index == place:
                axis.adjustments.append(adjusted.adjustment)
                if adjusted.adjustment.reason != "FEED_RATE_ABOVE_LIMIT":
                    axis.reached.velocity = adjusted.adjustment.planned
        axis.segments.extend(self._segments(part.segments, *self._begins[number][place:place + 2]))
        method = pb.PlanMethod(family=self._like.family or pb.PROFILE_FAMILY_S_CURVE, order=self._order(),
                               short_path_policy=self._like.short_path_policy or pb.SHORT_PATH_POLICY_REJECT,
                               synchronization=self._like.synchronization or pb.SYNCHRONIZATION_TIME,
                               end_on_cycle=self._like.end_on_cycle)
        orders = (pb.QUANTITY_VELOCITY, pb.QUANTITY_ACCELERATION, pb.QUANTITY_JERK, pb.QUANTITY_SNAP, pb.QUANTITY_CRACKLE,
                  pb.QUANTITY_POP, pb.QUANTITY_LOCK, pb.QUANTITY_DROP)
        message = pb.Plan(planner_version=part.planner_version, evaluation_version=part.evaluation_version, method=method,
                          guaranteed=orders[:method.order], cycle_count=part.cycle_count[place],
                          duration=part.duration[place], axes=[axis])
        if self._like.HasField("cycle_time"):
            message.cycle_time.CopyFrom(self._like.cycle_time)
        else:
            message.cycle_time.FromMilliseconds(1)
        limits = message.axes[0].limits
        if not limits.max_jerk:
            # What order 2 may leave out, as the planner takes it then.
            limits.max_jerk = max(limits.max_acceleration, limits.max_deceleration) / (message.cycle_time.ToNanoseconds() / 1e9)
        return Plan(message)

    def _state(self, end: str, index: int, otherwise: pb.AxisState) -> pb.AxisState:
        state = pb.AxisState()
        for part in ("position", "velocity", "acceleration"):
            column = self._columns.get(f"{end}_{part}")
            setattr(state, part, column[index] if column is not None and len(column) else getattr(otherwise, part))
        return state

    def _order(self) -> int:
        if self._like.HasField("order"):
            return self._like.order
        return 2 if self._like.family == pb.PROFILE_FAMILY_TRAPEZOIDAL else 3

    def _segments(self, columns: pb.SegmentColumns, first: int, last: int) -> Iterator[pb.AxisSegment]:
        # Only polynomials tell derivatives.
        at = sum(columns.derivative_count[:first])
        for k in range(first, last):
            start = pb.AxisState(position=columns.position[k], velocity=columns.velocity[k],
                                 acceleration=columns.acceleration[k])
            segment = pb.AxisSegment(duration=columns.duration[k], start=start)
            if columns.derivative_count:
                derivatives = columns.derivatives[at:at + columns.derivative_count[k]]
                at += len(derivatives)
                if len(derivatives) == 1:
                    segment.jerk = derivatives[0]
                else:
                    segment.polynomial.derivatives.extend(derivatives)
            elif self._like.family == pb.PROFILE_FAMILY_TRIGONOMETRIC and columns.jerk[k] != 0:
                segment.cosine_jerk.peak_jerk = columns.jerk[k]
            else:
                segment.jerk = columns.jerk[k]
            yield segment
