"""Writes cosine_turning_points.json: pulses of cosine jerk that begin anywhere, and when their velocity and acceleration are zero, to 32 digits.

    pip install mpmath; python3 planner/tests/vectors/cosine_turning_points.py > planner/tests/vectors/cosine_turning_points.json

The acceleration of a pulse from a_0 is a_0 + J/2w (wt - sin wt), w = 2 pi/duration: zero where Kepler's equation says. The jerk keeps its sign,
so there is at most one zero, and of the velocity at most one on either side of it; each is bisected at 60 digits.
"""

import json
import random

from mpmath import cos, mp, mpf, pi, sin

mp.dps = 60


def zero_between(function, low, high):
    rises = function(low) < 0
    if rises == (function(high) < 0):
        return None
    for _ in range(180):
        middle = (low + high) / 2
        if (function(middle) < 0) == rises:
            low = middle
        else:
            high = middle
    return low


def main():
    random_ = random.Random(8)
    records = []
    while len(records) < 100:
        duration = 10.0 ** random_.uniform(-3.0, 2.0)
        peak = random_.choice((-1.0, 1.0)) * 10.0 ** random_.uniform(-2.0, 4.0)
        gained = -peak * duration / 2
        acceleration = gained * random_.uniform(0.0, 1.0)
        velocity = random_.uniform(-0.2, 0.2) * gained * duration
        w, half = 2 * pi / mpf(duration), mpf(peak) / 2
        a = lambda t: acceleration + half / w * (w * t - sin(w * t))
        v = lambda t: velocity + acceleration * t + half / w**2 * ((w * t) ** 2 / 2 - (1 - cos(w * t)))
        turn = zero_between(a, mpf(0), mpf(duration))
        if turn is None:
            continue
        found = [(turn, 2)]
        for low, high in ((mpf(0), turn), (turn, mpf(duration))):
            zero = zero_between(v, low, high)
            if zero is not None:
                found.append((zero, 1))
        found.sort()
        # Where the slope is next to nothing a zero is not known from doubles.
        slope = lambda t, order: abs(a(t)) / abs(gained) if order == 1 else (1 - cos(w * t)) / 2
        if any(slope(zero, order) < mpf("0.05") for zero, order in found):
            continue
        told = [[order, float(zero), float(zero - mpf(float(zero)))] for zero, order in found]
        records.append(
            {"duration": duration, "peak": peak, "velocity": velocity, "acceleration": acceleration, "zeros": told}
        )
    print("[")
    print(",\n".join(json.dumps(record, separators=(",", ":")) for record in records))
    print("]")


main()
