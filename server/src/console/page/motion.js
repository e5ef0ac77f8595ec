// Reads out a plan: the same laws as the planner's, for drawing. Setpoints that are kept come from the server.

/** Position, velocity, acceleration and jerk of a segment, so long after its start. */
export function after(segment, t) {
  const { position: s, velocity: v, acceleration: a } = segment.start;
  if (segment.cosineJerk) {
    const [w, h] = [(2 * Math.PI) / segment.duration, segment.cosineJerk.peakJerk / 2];
    const x = w * t;
    // j = h (1 − cos wt), integrated from the start.
    return [
      s + v * t + (a * t * t) / 2 + h * ((t * t * t) / 6 - (x - Math.sin(x)) / w ** 3),
      v + a * t + h * ((t * t) / 2 - (1 - Math.cos(x)) / w ** 2),
      a + h * (t - Math.sin(x) / w),
      h * (1 - Math.cos(x)),
    ];
  }
  const higher = segment.polynomial ? segment.polynomial.derivatives : [segment.jerk ?? 0];
  const all = [s, v, a, ...higher];
  // Horner over the factorials, from each order on.
  const from = (order) => {
    let sum = 0;
    for (let k = all.length - 1; k >= order; k--) sum = all[k] + (sum * t) / (k - order + 1);
    return sum;
  };
  return [from(0), from(1), from(2), from(3)];
}

const PIECES = { jerk: 24, other: 48 };

/** Four curves of an axis, as [time, value] pairs; a jump is two pairs at one time. */
export function curves(axis, duration) {
  const curves = [[], [], [], []];
  let begin = 0;
  const put = (time, words) => words.forEach((value, word) => curves[word].push([time, value]));
  for (const segment of axis.segments) {
    const steps = axis.segments.length > 200 ? 4 : segment.jerk !== undefined ? PIECES.jerk : PIECES.other;
    for (let step = 0; step <= steps; step++) {
      const t = (segment.duration * step) / steps;
      put(begin + t, after(segment, t));
    }
    begin += segment.duration;
  }
  const { position, velocity, acceleration } = axis.reached ?? {};
  put(begin, [position ?? 0, velocity ?? 0, acceleration ?? 0, 0]);
  if (begin < duration && velocity === 0) put(duration, [position, 0, 0, 0]);
  return curves;
}

/** The phases of an axis, as [from, to]. */
export function phases(axis) {
  let begin = 0;
  return axis.segments.map(({ duration }) => [begin, (begin += duration)]);
}
