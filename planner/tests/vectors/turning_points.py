"""Writes turning_points.json: pieces of polynomial motion, and every zero of every derivative of theirs, to 32 digits.

    pip install mpmath; python3 planner/tests/vectors/turning_points.py > planner/tests/vectors/turning_points.json

A zero is that of the polynomial whose coefficients are the doubles of the record, exactly: closed in on at 150 digits between the zeros of the
next derivative, 80 halvings and three steps of Newton's method. It is written as the nearest double and what is missing of it. All complex zeros by mpmath's polyroots, at 200 digits and without any
isolation, gave the same zeros.

- `values`: position, velocity ... at the start of the piece, `duration`: its length.
- `zeros`: of the velocity and of all derivatives above it but the last, inside the piece, in order of time: the order of the derivative,
  the nearest double, and what is missing.

Left out are pieces in which two of them, or one and an end, are nearer than 1e-6 of the duration: whether those are two, one or none is a
matter of rounding.
"""

import json
import random
from math import factorial

from mpmath import mp, mpf

mp.dps = 150


def value(coefficients, t):
    total = mpf(0)
    for c in reversed(coefficients):
        total = total * t + c
    return total


def zero_between(coefficients, low, high):
    """Of a function that is monotone there; none where it does not change its sign."""
    slopes = [k * c for k, c in enumerate(coefficients)][1:]
    rises = value(coefficients, low) < 0
    if rises == (value(coefficients, high) < 0):
        return None
    for _ in range(80):
        middle = (low + high) / 2
        if (value(coefficients, middle) < 0) == rises:
            low = middle
        else:
            high = middle
    for _ in range(3):
        low -= value(coefficients, low) / value(slopes, low)
    return low


def zeros(values, duration):
    """Between two zeros of the next derivative a derivative is monotone: at 150 digits no sign is in doubt."""
    found, of_next = [], []
    for order in reversed(range(1, len(values) - 1)):
        # In units of the duration, so that all are of one size.
        coefficients = [mpf(v) / factorial(k) * mpf(duration) ** k for k, v in enumerate(values[order:])]
        ends = [mpf(0)] + of_next + [mpf(1)]
        of_next = [zero_between(coefficients, a, b) for a, b in zip(ends, ends[1:])]
        of_next = [zero for zero in of_next if zero is not None]
        found += [(zero * mpf(duration), order) for zero in of_next]
    return sorted(found)


def piece(random_, order, kind):
    if kind == "sizes":
        # Terms of one size over the length of the piece.
        duration = 10.0 ** random_.uniform(-3.0, 3.0)
        parts = [random_.uniform(-1.0, 1.0) for _ in range(order + 1)]
        return duration, [part * factorial(k) / duration**k for k, part in enumerate(parts)]
    # Zeros of the position that were put where they are, some close together, and of the first one very near to the start.
    places = [random_.uniform(0.0, 1.0) for _ in range(order)]
    if kind == "close":
        places[1] = places[0] + 1e-3 * random_.random()
    if kind == "early":
        places = [place * 10.0 ** random_.uniform(-5.0, 0.0) for place in places]
    coefficients = [mpf(1)]
    for place in places:
        longer = [mpf(0)] + coefficients
        for k, c in enumerate(coefficients):
            longer[k] -= mpf(place) * c
        coefficients = longer
    return 1.0, [float(c * factorial(k)) for k, c in enumerate(coefficients)]


def main():
    random_ = random.Random(15)
    records = []
    for order in (3, 4, 5, 6, 7, 8, 11, 15):
        for kind in ("sizes", "apart", "close", "early"):
            kept = 0
            while kept < 6:
                duration, values = piece(random_, order, kind)
                found = zeros(values, duration)
                ends = [mpf(0)] + [zero for zero, _ in found] + [mpf(duration)]
                if not found or min(b - a for a, b in zip(ends, ends[1:])) < mpf(duration) * mpf("1e-6"):
                    continue
                kept += 1
                told = [[order, float(zero), float(zero - mpf(float(zero)))] for zero, order in found]
                records.append({"kind": kind, "duration": duration, "values": values, "zeros": told})
    print("[")
    print(",\n".join(json.dumps(record, separators=(",", ":")) for record in records))
    print("]")


main()
