"""Writes digest.json: test vectors of the setpoint digest for implementations in any language.

Shares no code with the Rust implementation: PyPI's `xxhash` binds the reference library.

    pip install xxhash && python3 digest.py > digest.json
"""

import json
import math
import struct

import xxhash


def then(before, cycle, axes):
    words = struct.pack("<QQ", before, cycle)
    for axis in axes:
        words += struct.pack("<4d", *axis)
    return xxhash.xxh3_64_intdigest(words, seed=0)


def bits(value):
    return f"{struct.unpack('<Q', struct.pack('<d', value))[0]:016x}"


def vector(name, before, first_cycle, setpoints):
    digest, cycles = before, []
    for cycle, axes in enumerate(setpoints, first_cycle):
        digest = then(digest, cycle, axes)
        cycles.append({
            "cycle": cycle,
            "axes": axes,
            "bits": [[bits(value) for value in axis] for axis in axes],
            "digest": f"{digest:016x}",
        })
    return {"name": name, "before": f"{before:016x}", "cycles": cycles}


def ramp(axis, cycle):
    t = cycle * 1e-3
    j = 10.0 + axis
    return [axis / 3 + j * t**3 / 6, j * t**2 / 2, j * t, j]


vectors = [
    vector("one axis from rest", 0, 1, [[ramp(0, c)] for c in range(1, 6)]),
    vector("two axes", 0, 1, [[ramp(0, c), ramp(1, c)] for c in range(1, 5)]),
    vector("seven axes", 0, 1, [[ramp(a, c) for a in range(7)] for c in range(1, 4)]),
    vector("nine axes", 0, 1, [[ramp(a, c) for a in range(9)] for c in range(1, 3)]),
    vector("zero and negative zero differ", 0, 1, [[[0.0, 0.0, 0.0, 0.0]], [[-0.0, 0.0, -0.0, 0.0]]]),
    vector("negative zero alone", 0, 1, [[[-0.0, 0.0, 0.0, 0.0]]]),
    vector("subnormal", 0, 1, [
        [[5e-324, -5e-324, math.ulp(0.0) * 3, 2.2250738585072009e-308]],
        [[2.2250738585072014e-308, -1e-310, 1e-320, -0.0]],
    ]),
    vector("extremes", 0, 1, [[[1.7976931348623157e308, -1.7976931348623157e308, 0.1, 1 / 3]]]),
    vector("from the middle of a stream", 0xFEDCBA9876543210, 2**40, [[ramp(0, c), ramp(1, c)] for c in (7, 8)]),
]

about = (
    "d(0) = 0; d(n) = XXH3-64 (seed 0) of d(n-1), n, and position, velocity, acceleration and jerk of each axis in "
    "plan order, all as little-endian 64-bit words. `bits` are the doubles of `axes` and decide where a reader of "
    "decimal numbers is in doubt; `digest` is d(cycle), and `before` is d of the cycle before the first. All "
    "hexadecimal numbers are written with the highest digit first. Made by digest.py."
)

# One line per cycle.
print('{"about": ' + json.dumps(about) + ',\n"vectors": [')
print(",\n".join(
    '{"name": ' + json.dumps(v["name"]) + f', "before": "{v["before"]}", "cycles": [\n  '
    + ",\n  ".join(json.dumps(cycle) for cycle in v["cycles"]) + "\n]}"
    for v in vectors
))
print("]}")
