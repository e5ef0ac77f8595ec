"""Operations on a motion under way. Each returns once the axis plays by it."""

from __future__ import annotations

import uuid

from .motion.v1 import plan_pb2, setpoint_pb2


class Operations:
    """Hold, resume, override, retarget and stop, by the name of the stream.

    ``not_before``: take effect no earlier than this cycle of the stream. ``request_id``: sent again with the same one, an
    operation has the same answer and is not done twice.
    """

    def hold(self, stream: str = "", **when) -> setpoint_pb2.OperationResult:
        """Comes to rest on the path, ready to resume."""
        return self._ask(stream, when, hold=setpoint_pb2.Hold())

    def resume(self, stream: str = "", **when) -> setpoint_pb2.OperationResult:
        """Goes on after a hold."""
        return self._ask(stream, when, resume=setpoint_pb2.ResumeMotion())

    def override(self, factor: float, stream: str = "", **when) -> setpoint_pb2.OperationResult:
        """Scales the feed rate: 0 rests, 1 is as planned."""
        return self._ask(stream, when, set_override=setpoint_pb2.SetOverride(factor=factor))

    def retarget(self, goals: dict[str, float], stream: str = "", **when) -> setpoint_pb2.OperationResult:
        """Goes elsewhere [u]; axes that are not named keep their goals."""
        moves = [plan_pb2.AxisMove(axis=axis, goal=plan_pb2.AxisState(position=at)) for axis, at in goals.items()]
        return self._ask(stream, when, retarget=setpoint_pb2.Retarget(goals=moves))

    def stop(self, stream: str = "", **when) -> setpoint_pb2.OperationResult:
        """Comes to rest and forgets the rest of the motion. Not an emergency stop: that stays in hardware."""
        return self._ask(stream, when, stop=setpoint_pb2.Stop())

    def _ask(self, stream: str, when: dict, **what) -> setpoint_pb2.OperationResult:
        request_id, not_before = when.pop("request_id", None), when.pop("not_before", None)
        if when:
            raise TypeError(f"unknown: {', '.join(when)}; there are not_before and request_id")
        operation = setpoint_pb2.Operation(request_id=request_id or str(uuid.uuid4()), not_before_cycle=not_before, **what)
        return self._operate(stream, operation)

    def _operate(self, stream: str, operation: setpoint_pb2.Operation) -> setpoint_pb2.OperationResult:
        raise NotImplementedError
