"""Writes polynomial_high.json: moves of the orders 7 and 8 from rest to rest, at 60 digits, by Python's decimal alone.

    python3 planner/tests/vectors/polynomial_high.py > planner/tests/vectors/polynomial_high.json

Shares nothing with the planner, which solves for the box lengths F by Newton's method and lays mirrored halves:

- The holds T are those of Nguyen, Ng and Chen (2008), section 3, as the paper has them: for p = n down to 1 the longest T_p with
  which no peak is above its limit while all later ones are zero. It is found by bisection.
- A peak is not computed from a formula of its own. The template of 2^n - 1 pieces, + 0 - 0 - 0 + ..., is written out as the paper
  does, L_1 = [T_n], L_{i+1} = L_i, T_{n-i}, -L_i, and integrated piece by piece, exactly but for the 60 digits: the peak of a
  derivative is its value where the block that raises it ends.
- Before a record is written, the whole template is integrated: it must end at the distance, at rest in every derivative, to 1e-40.

The fields are those of polynomial.json; `samples` are [t, x, x', ... up to the derivative n - 1]. Inputs are doubles, taken exactly.
"""

import json
import random
from decimal import Decimal, getcontext

getcontext().prec = 60

EXACT = Decimal(10) ** -40


def advance(state, highest, t):
    """The state (x, x' ... x^(n-1)) after `t` at a constant derivative n."""
    order = len(state)
    full = state + [highest]
    out = []
    for m in range(order):
        term, total = Decimal(1), full[m]
        for i in range(1, order - m + 1):
            term = term * t / i
            total += full[m + i] * term
        out.append(total)
    return out


def block(holds, highest, i):
    """L_i: pairs of a length and a derivative n. `holds[p - 1]` is T_p."""
    n = len(holds)
    if i == 1:
        return [(holds[n - 1], highest)]
    lower = block(holds, highest, i - 1)
    return lower + [(holds[n - i], Decimal(0))] + [(t, -x) for t, x in lower]


def peaks(holds, highest):
    """|x^(n-1)|, |x^(n-2)| ... |x'|, and the distance: each where the block that raises it ends."""
    n = len(holds)
    found = []
    state = [Decimal(0)] * n
    for i in range(1, n + 1):
        # The state is that after L_{i-1}; what L_i adds to it are a hold and L_{i-1} mirrored.
        pieces = block(holds, highest, i)
        rest = pieces if i == 1 else pieces[len(pieces) // 2 :]
        for t, x in rest:
            if t > 0:
                state = advance(state, x, t)
        found.append(abs(state[n - i]))
    return found


def longest(holds, p, limits):
    """Bisects for the longest T_p that keeps every limit, with what comes after it at zero."""
    n = len(holds)

    def fits(t):
        trial = holds[: p - 1] + [t] + holds[p:]
        found = peaks(trial, limits[n])
        # found[i - 1] is the peak of the derivative n - i.
        return all(found[i - 1] <= limits[n - i] for i in range(1, n + 1))

    if not fits(Decimal(0)):
        return Decimal(0)
    high = Decimal(1)
    while fits(high):
        high *= 16
    low = Decimal(0)
    while high - low > high * Decimal(10) ** -52:
        middle = (low + high) / 2
        if fits(middle):
            low = middle
        else:
            high = middle
    return low


def record(number, tag, limits):
    exact = [Decimal(x) for x in limits]
    n = len(limits) - 1
    holds = [Decimal(0)] * n
    for p in range(n, 0, -1):
        found = longest(holds, p, exact)
        # A hold of nothing is told from one that the limits just allow.
        before = sum(holds) if p < n else Decimal(0)
        holds[p - 1] = found if before == 0 or found > before * Decimal(10) ** -38 else Decimal(0)
    pieces = block(holds, exact[n], n)
    state, ends, begin = [Decimal(0)] * n, [], Decimal(0)
    for t, x in pieces:
        if t == 0:
            continue
        ends.append((begin, state, t, x))
        state = advance(state, x, t)
        begin += t
    total = begin
    found = peaks(holds, exact[n])
    reached = [found[n - 1 - k] for k in range(n)] + [exact[n]]
    assert abs(state[0] - exact[0]) <= EXACT * exact[0], (number, state[0], exact[0])
    for k in range(1, n):
        assert abs(state[k]) <= EXACT * reached[k], (number, k, state[k])
    boxes = []
    for p in range(n, 0, -1):
        boxes.append(holds[p - 1] + sum(boxes))
    assert abs(sum(boxes) - total) <= EXACT * total
    samples = []
    for part in ("0.03125", "0.1875", "0.34375", "0.5", "0.6875", "0.96875"):
        # A double, so that whoever reads it evaluates there.
        t = Decimal(float(Decimal(part) * total))
        start, at, _, x = max((piece for piece in ends if piece[0] <= t), key=lambda piece: piece[0])
        samples.append([float(t)] + [float(value) for value in advance(at, x, t - start)])
    return {
        "id": number,
        "tag": tag,
        "n": n,
        "X": limits,
        "T": [float(t) for t in holds],
        "F": [float(f) for f in boxes],
        "total": float(total),
        "peaks": [float(x) for x in reached],
        "samples": samples,
    }


def drawn(random_, n, tag):
    if tag == "reached":
        # Each box twice as long as the sum of all before it, or up to eight times: every limit is reached.
        boxes = [random_.uniform(0.001, 0.01)]
        while len(boxes) < n:
            boxes.append(sum(boxes) * random_.uniform(2.0, 8.0))
        top = 10.0 ** random_.uniform(3.0, 9.0)
        limits = [top]
        for length in boxes:
            limits.insert(0, limits[0] * length)
        return limits
    velocity, acceleration = random_.uniform(1.0, 60.0), random_.uniform(5.0, 400.0)
    limits = [velocity, acceleration]
    while len(limits) < n:
        limits.append(limits[-1] * random_.uniform(0.5, 40.0))
    if tag == "wild":
        limits = [10.0 ** random_.uniform(-3.0, 6.0) for _ in range(n)]
    if tag == "tie":
        # Powers of two: limits that are just reached.
        limits = [2.0 ** random_.randint(-8, 8) for _ in range(n)]
        return [2.0 ** random_.randint(-8, 8)] + limits
    ranges = {"short": (-7.0, -5.0), "mid": (-1.0, 2.0), "long": (3.0, 5.0), "wild": (-3.0, 6.0)}
    return [10.0 ** random_.uniform(*ranges[tag])] + limits


def main():
    random_ = random.Random(2008)
    records = []
    for n in (7, 8):
        for _ in range(4):
            for tag in ("reached", "short", "mid", "long", "wild", "tie"):
                records.append(record(len(records), tag, drawn(random_, n, tag)))
    print("[")
    print(",\n".join(json.dumps(each, separators=(",", ":")) for each in records))
    print("]")


main()
