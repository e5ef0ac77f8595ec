"""A simulated axis that follows a plan."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import grpc

from ._operate import Operations
from ._plan import Plan
from ._server import _duration, by_axis, channel
from ._status import Refused, refusals
from .motion.v1 import setpoint_pb2, sim_axis_pb2, sim_axis_pb2_grpc


@dataclass(frozen=True)
class Samples:
    """Consecutive cycles: ``position[axis][n]`` is that of cycle ``first_cycle + n`` [u, s]."""

    first_cycle: int
    position: list[list[float]]
    velocity: list[list[float]]
    measured_position: list[list[float]]
    following_error: list[list[float]]
    load_position: list[list[float]]

    @property
    def cycles(self) -> int:
        return len(self.position[0]) if self.position else 0


class Run:
    """A run that has begun: iterate over its ``Samples``; leaving the ``with`` block ends it. ``events`` and ``report`` fill
    as it goes on."""

    def __init__(self, call) -> None:
        self._call = call
        self.events: list[setpoint_pb2.StreamEvent] = []
        self.report: sim_axis_pb2.TrackingReport | None = None

    def __enter__(self) -> Run:
        return self

    def __exit__(self, *_: object) -> None:
        self._call.cancel()

    def __iter__(self) -> Iterator[Samples]:
        with refusals():
            for message in self._call:
                what = message.WhichOneof("message")
                if what == "samples":
                    of, count = message.samples, message.samples.commanded.cycles
                    yield Samples(of.first_cycle, by_axis(of.commanded.position, count), by_axis(of.commanded.velocity, count),
                                  by_axis(of.tracking.measured_position, count), by_axis(of.tracking.following_error, count),
                                  by_axis(of.load_position, count))
                elif what == "event":
                    self.events.append(message.event)
                else:
                    self.report = message.report

    def finish(self) -> sim_axis_pb2.TrackingReport:
        """Reads to the end; how well the axes followed."""
        for _ in self:
            pass
        if self.report is None:
            raise Refused("UNKNOWN", "UNKNOWN", "the run ended without a report", [], {})
        return self.report


class SimAxis(Operations):
    """A connection to an axis simulator, as ``SimAxis("127.0.0.1:50052")``. Operations go through the axis to whichever server
    serves its stream."""

    def __init__(self, endpoint: str = "127.0.0.1:50052", credentials: grpc.ChannelCredentials | None = None,
                 timeout: float = 10.0):
        self._channel = channel(endpoint, credentials)
        self._axis = sim_axis_pb2_grpc.SimAxisServiceStub(self._channel)
        self._timeout = timeout

    def __enter__(self) -> SimAxis:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._channel.close()

    def track(self, plan: Plan, stream: str = "python", planners: Sequence[str] = ("http://127.0.0.1:50051",), *,
              models: Sequence[sim_axis_pb2.AxisModel] = (), virtual_time: bool = False, stay_open: bool = False,
              settle_window: float | None = None, lead_cycles: int = 0, accept_unproved: bool = False,
              compact: bool = False, spread: bool = False) -> Run:
        """Has the axis open a stream at one of ``planners``, as the axis reaches them, and follow ``plan``. With ``compact`` it
        evaluates the motion itself; with ``spread`` it tries the planners in an order that follows from the name of the stream."""
        request = sim_axis_pb2.RunTrackingRequest(
            stream=stream, endpoints=planners, plan=plan.message, models=models, virtual_time=virtual_time,
            stay_open=stay_open, settle_window=_duration(settle_window), lead_cycles=lead_cycles,
            accept_unproved=accept_unproved, compact=compact, spread=spread)
        call = self._axis.RunTracking(request)
        # Comes once the stream is open, so that operations find it; a refusal is raised where the run is read.
        call.initial_metadata()
        return Run(call)

    def _operate(self, stream: str, operation: setpoint_pb2.Operation) -> setpoint_pb2.OperationResult:
        request = sim_axis_pb2.CommandRequest(stream=stream, operation=operation)
        with refusals():
            return self._axis.Command(request, timeout=self._timeout).result
