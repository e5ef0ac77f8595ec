"""Smooth motion for machine axes, planned and streamed.

- ``Server``: plans, samples, watches and controls streams
- ``SimAxis``: has a simulated axis follow a plan
- ``Move``, ``Limits``, ``Points``: what is asked, in SI units
- ``Moves``: many moves of one axis, asked in columns
- ``Plan``: the answer, as analytic pieces that can be read out at any instant
- ``Refused``: why it cannot be, with the way out

Everything else is the generated messages of ``portamento.motion.v1``.
"""

from ._ask import Kind, Limits, Move, Points, State
from ._axis import Run, Samples, SimAxis
from ._many import Moves
from ._plan import Plan, PointReport
from ._server import Server
from ._status import Refused, Unreachable

__all__ = ["Kind", "Limits", "Move", "Moves", "Plan", "PointReport", "Points", "Refused", "Run", "Samples", "Server", "SimAxis",
           "State", "Unreachable"]
