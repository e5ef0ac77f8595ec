"""Why something cannot be."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import grpc
from google.rpc import error_details_pb2, status_pb2

_DETAILS = "grpc-status-details-bin"


class Unreachable(ConnectionError):
    """Nobody answers: try again, or elsewhere."""


class Refused(Exception):
    """The request was understood and refused; nothing has changed."""

    def __init__(self, code: str, reason: str, message: str, fields: list[tuple[str, str]], metadata: dict[str, str]):
        super().__init__(f"{reason}: {message}")
        self.code = code  #: of gRPC, as ``FAILED_PRECONDITION``
        self.reason = reason  #: as ``PATH_TOO_SHORT``; ``portamento explain`` knows them all
        self.message = message  #: what was given, what is allowed, and the way out
        self.fields = fields  #: each field at fault, with what is wrong with it
        self.metadata = metadata  #: figures for programs, as ``nearest``


def error_of(call: grpc.RpcError) -> Exception:
    """What a failed call means."""
    code, text = call.code(), call.details() or ""
    details = [value for key, value in call.trailing_metadata() or () if key == _DETAILS]
    reason, fields, metadata = _read(status_pb2.Status.FromString(details[0])) if details else ("", [], {})
    if not reason and code in (grpc.StatusCode.UNAVAILABLE, grpc.StatusCode.DEADLINE_EXCEEDED):
        return Unreachable(text)
    return Refused(code.name, reason or code.name, text, fields, metadata)


def refused_of(serialised: bytes) -> Refused:
    """What stands in the place of one of many that is refused."""
    status = status_pb2.Status.FromString(serialised)
    code = next((code.name for code in grpc.StatusCode if code.value[0] == status.code), str(status.code))
    reason, fields, metadata = _read(status)
    return Refused(code, reason or code, status.message, fields, metadata)


def _read(status: status_pb2.Status) -> tuple[str, list[tuple[str, str]], dict[str, str]]:
    reason, fields, metadata = "", [], {}
    for detail in status.details:
        info, bad = error_details_pb2.ErrorInfo(), error_details_pb2.BadRequest()
        if detail.Unpack(info):
            reason, metadata = info.reason, dict(info.metadata)
        elif detail.Unpack(bad):
            fields = [(violation.field, violation.description) for violation in bad.field_violations]
    return reason, fields, metadata


@contextlib.contextmanager
def refusals() -> Iterator[None]:
    """Turns errors of gRPC into those of this package."""
    try:
        yield
    except grpc.RpcError as error:
        raise error_of(error) from None
