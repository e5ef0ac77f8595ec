// Units and numbers as people read them.

const BASE = { AXIS_KIND_PRISMATIC: "m", AXIS_KIND_REVOLUTE: "rad", AXIS_KIND_PULSES: "pulses" };
const SHORT = { AXIS_KIND_PULSES: "p" };

/** "u/s²" in the unit of an axis of this kind. */
export function unit(pattern, kind, narrow = false) {
  const base = (narrow && SHORT[kind]) || BASE[kind] || "u";
  return pattern.replace("u", base);
}

/** A number with so many significant digits, without zeros at its end. */
export function plain(value, digits = 5) {
  if (!Number.isFinite(value)) return String(value);
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size < 1e-4 || size >= 1e7 ? value.toExponential(Math.min(digits, 4) - 1) : value.toPrecision(digits);
  const [digitsPart, exponent] = text.split("e");
  const short = digitsPart.includes(".") ? digitsPart.replace(/\.?0+$/, "") : digitsPart;
  return (exponent ? `${short}e${Number(exponent)}` : short).replace("-", "−");
}

/** A text of the server with numbers as people read them: it writes every digit. */
export function tidy(text) {
  return text.replace(/-?\d+\.\d{7,}(e-?\d+)?/g, (digits) => plain(Number(digits), 6));
}

/** The number in a field: undefined where it is empty, NaN where it is none. A comma is a decimal point. */
export function number(text) {
  const cleaned = text.trim().replace("−", "-").replace(",", ".");
  return cleaned === "" ? undefined : Number(cleaned);
}

/** "QUANTITY_JERK" → "jerk". */
export function word(name) {
  return name.replace(/^(QUANTITY|PHASE|STREAM_EVENT_KIND|PROFILE_FAMILY)_/, "").toLowerCase().replaceAll("_", " ");
}

export const PATTERNS = { position: "u", velocity: "u/s", acceleration: "u/s²", jerk: "u/s³", snap: "u/s⁴",
  crackle: "u/s⁵", pop: "u/s⁶", lock: "u/s⁷", drop: "u/s⁸", time: "s" };
