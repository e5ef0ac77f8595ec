"""A server: plans, and streams that it serves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import grpc
from google.protobuf import duration_pb2

from ._ask import Move, Points
from ._many import Moves, messages
from ._operate import Operations
from ._plan import Plan
from ._status import refusals
from .motion.v1 import plan_pb2 as pb
from .motion.v1 import plan_pb2_grpc, setpoint_pb2, setpoint_pb2_grpc

#: The largest message, as the server's own default.
MAX_MESSAGE_BYTES = 64 << 20


def channel(endpoint: str, credentials: grpc.ChannelCredentials | None) -> grpc.Channel:
    address = endpoint.removeprefix("http://").removeprefix("https://").rstrip("/")
    options = [("grpc.max_receive_message_length", MAX_MESSAGE_BYTES), ("grpc.max_send_message_length", MAX_MESSAGE_BYTES)]
    if credentials is None:
        return grpc.insecure_channel(address, options)
    return grpc.secure_channel(address, credentials, options)


@dataclass(frozen=True)
class Columns:
    """Setpoints of consecutive cycles: ``position[axis][n]`` is that of cycle ``first_cycle + n`` [u, s]."""

    first_cycle: int
    position: list[list[float]]
    velocity: list[list[float]]
    acceleration: list[list[float]]
    jerk: list[list[float]]
    digest: int


def by_axis(values, cycles: int) -> list[list[float]]:
    return [list(values[start:start + cycles]) for start in range(0, len(values), cycles)] if cycles else []


def _duration(seconds: float | None) -> duration_pb2.Duration | None:
    if seconds is None:
        return None
    duration = duration_pb2.Duration()
    duration.FromNanoseconds(round(seconds * 1e9))
    return duration


def _request(moves: Sequence[Move], family: str, order: int | None, short_path: str, synchronization: str,
             minimum_duration: float | None, cycle_time: float | None, end_on_cycle: bool) -> pb.PlanRequest:
    return pb.PlanRequest(
        axes=[move.to_wire() for move in moves], family=f"PROFILE_FAMILY_{family}", order=order,
        short_path_policy=f"SHORT_PATH_POLICY_{short_path}", synchronization=f"SYNCHRONIZATION_{synchronization}",
        minimum_duration=_duration(minimum_duration), cycle_time=_duration(cycle_time), end_on_cycle=end_on_cycle)


class Server(Operations):
    """A connection to a server, as ``Server("127.0.0.1:50051")``; with ``credentials`` of ``grpc``, encrypted.

    Calls raise ``Refused`` for what cannot be, and ``Unreachable`` where nobody answers.
    """

    def __init__(self, endpoint: str = "127.0.0.1:50051", credentials: grpc.ChannelCredentials | None = None,
                 timeout: float = 10.0):
        self._channel = channel(endpoint, credentials)
        self._planner = plan_pb2_grpc.PlannerServiceStub(self._channel)
        self._setpoints = setpoint_pb2_grpc.SetpointServiceStub(self._channel)
        self._timeout = timeout

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._channel.close()

    def plan(self, *moves: Move, family: str = "S_CURVE", order: int | None = None, short_path: str = "REJECT",
             synchronization: str = "TIME", minimum_duration: float | None = None, cycle_time: float | None = None,
             end_on_cycle: bool = False) -> Plan:
        """Plans a move of one axis or several. Choices are the names of the schema without their prefix."""
        request = _request(moves, family, order, short_path, synchronization, minimum_duration, cycle_time, end_on_cycle)
        with refusals():
            return Plan(self._planner.Plan(request, timeout=self._timeout).plan)

    def plan_many(self, like: Move, *, family: str = "S_CURVE", order: int | None = None, short_path: str = "REJECT",
                  minimum_duration: float | None = None, cycle_time: float | None = None, end_on_cycle: bool = False,
                  timeout: float | None = None, **columns: Sequence[float]) -> Moves:
        """Plans many moves of one axis that are like ``like`` but for the numbers of columns, each with one for every move:
        ``start_position``, ``start_velocity``, ``start_acceleration``, the same of ``goal``, ``max_velocity``,
        ``max_acceleration``, ``max_jerk``, ``max_deceleration``, ``max_velocity_reverse`` and ``feed_rate``. What cannot be is in
        ``Moves.refused``; what is wrong with all raises ``Refused``."""
        request = _request([like], family, order, short_path, "TIME", minimum_duration, cycle_time, end_on_cycle)
        asked = list(messages(request, columns))
        with refusals():
            answers = self._planner.PlanMany(iter(asked), timeout=timeout)
            return Moves(request, columns, [answer.columns for answer in answers])

    def pvt(self, *axes: Points, policy: str = "PREFER_VELOCITY", interpolation: str = "S_SHAPED",
            finish_unreached: bool = False, cycle_time: float | None = None) -> Plan:
        """Plans a motion through points. ``Plan.points`` says what became of each."""
        request = pb.PlanPvtRequest(
            axes=[axis.to_wire() for axis in axes], policy=f"PVT_POLICY_{policy}",
            interpolation=f"PVT_INTERPOLATION_{interpolation}", finish_unreached=finish_unreached,
            cycle_time=_duration(cycle_time))
        with refusals():
            response = self._planner.PlanPvt(request, timeout=self._timeout)
        return Plan(response.plan, list(response.points))

    def verify(self, plan: Plan) -> pb.PlanCertificate:
        """Has the server's judge look at a plan, whoever made it."""
        with refusals():
            return self._planner.VerifyPlan(pb.VerifyPlanRequest(plan=plan.message), timeout=self._timeout).certificate

    def sample(self, plan: Plan, first_cycle: int = 0, cycles: int = 0) -> Iterator[Columns]:
        """The setpoints of a plan, chunk by chunk, to the bit; 0 cycles is to the end."""
        request = pb.SamplePlanRequest(plan=plan.message, first_cycle=first_cycle, cycles=cycles)
        with refusals():
            for chunk in self._planner.SamplePlan(request):
                count, of = chunk.columns.cycles, chunk.columns
                yield Columns(chunk.first_cycle, by_axis(of.position, count), by_axis(of.velocity, count),
                              by_axis(of.acceleration, count), by_axis(of.jerk, count), chunk.digest)

    def watch(self, stream: str = "", period: float = 0.05, max_points: int = 0) -> Iterator[setpoint_pb2.WatchStreamResponse]:
        """Looks on: at one stream with how its axes follow, or at how all streams of this server stand."""
        request = setpoint_pb2.WatchStreamRequest(stream=stream, period=_duration(period), max_points=max_points)
        with refusals():
            yield from self._setpoints.WatchStream(request)

    def _operate(self, stream: str, operation: setpoint_pb2.Operation) -> setpoint_pb2.OperationResult:
        request = setpoint_pb2.ControlStreamRequest(stream=stream, operation=operation)
        with refusals():
            return self._setpoints.ControlStream(request, timeout=self._timeout).result
