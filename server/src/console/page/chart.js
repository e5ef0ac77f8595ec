// Panels over one time axis, on a canvas or into an SVG. Own drawing, since what is drawn is little and is drawn at every frame.

const STYLES = getComputedStyle(document.documentElement);
const resolved = new Map();
/** A colour of the style sheet as it is now, light or dark. */
export function color(name) {
  const scheme = dark();
  const key = `${name}${scheme}`;
  if (!resolved.has(key)) {
    const [, light, night] = STYLES.getPropertyValue(`--${name}`).match(/light-dark\((.*?), (.*?)\)/) ?? [];
    resolved.set(key, (scheme ? night : light) ?? STYLES.getPropertyValue(`--${name}`));
  }
  return resolved.get(key);
}
const prefers = matchMedia("(prefers-color-scheme: dark)");
export function dark() {
  const { theme } = document.documentElement.dataset;
  return theme ? theme === "dark" : prefers.matches;
}

// Okabe and Ito (2008): told apart with every kind of colour vision.
const INKS = [["#0072b2", "#56b4e9"], ["#d55e00", "#ff8f3f"], ["#009e73", "#2fc796"], ["#aa4499", "#e39bd0"]];
export const ink = (index) => INKS[index % INKS.length][dark() ? 1 : 0];

/** Steps of 1, 2 or 5 so that there are about `count` of them. */
function ticks(from, to, count) {
  const rough = (to - from) / count;
  if (!(rough > 0) || !Number.isFinite(rough)) return { values: [from], digits: 0 };
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((unit) => unit * power).find((size) => size >= rough);
  const values = [];
  for (let index = Math.ceil(from / step - 1e-9); index * step <= to + step * 1e-9; index++) values.push(index * step);
  return { values, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

const label = (value, digits) => (Math.abs(value) < 1e-12 ? "0" : Math.abs(value) >= 1e6 || digits > 6 ? value.toExponential(2) : value.toFixed(digits)).replace("-", "−");

/**
 * Draws `figure`:
 * { from, to, unit, panels: [{ title, unit, series: [{ points, ink, dash, width }], limits, zero }], bands, spans, marks, cursor }
 * onto `pen`, in a space of `width` × `height`.
 */
export function draw(pen, figure, width, height) {
  const left = width < 420 ? 56 : 62, right = width - 10, top = 6 + (figure.spans ? 20 : 0) + (figure.bands ? 16 : 0);
  const bottom = height - (figure.bare ? 6 : 34), gap = figure.bare ? 14 : 24;
  const count = figure.panels.length;
  const tall = (bottom - top - gap * (count - (figure.bare ? 1 : 0))) / count;
  const { from, to } = figure;
  const x = (time) => left + ((time - from) / (to - from || 1)) * (right - left);
  const text = color("text"), quiet = color("quiet"), edge = color("edge");
  pen.clear(width, height, color("panel"));
  const time = ticks(from, to, Math.max(2, Math.floor((right - left) / 90)));
  (figure.spans ?? []).forEach(({ from, to, name, color: fill }) => {
    pen.fill(x(from), 4, Math.max(1, x(to) - x(from) - 1), 16, fill);
    if (x(to) - x(from) > 18) pen.text(name, (x(from) + x(to)) / 2, 12, text, 10, "center");
  });
  const places = [];
  figure.panels.forEach((panel, index) => {
    const y0 = top + index * (tall + gap) + (figure.bare ? 0 : gap), y1 = y0 + tall;
    let [low, high] = panel.zero ? [0, 0] : [Infinity, -Infinity];
    for (const { points } of [...panel.series, ...(panel.marks ?? [])]) for (const [, value] of points) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    if (!(high >= low)) [low, high] = [0, 0];
    // What stands still is a level line, with a number beside it that can be read.
    const reach = Math.max(high - low, Math.abs(high) * 1e-3, panel.least ?? 0) || 1;
    // A limit that is near is seen whole, one far away does not flatten the curve; a rounding below zero brings none nearer.
    for (const limit of panel.limits ?? []) if (limit > high && limit < high + reach * (1 - 1e-9)) high = limit; else if (limit < low && limit > low - reach * (1 - 1e-9)) low = limit;
    const room = Math.max((high - low) * 0.06, (reach - (high - low)) / 2, reach * 0.03);
    [low, high] = [low - room, high + room];
    const y = (value) => y1 - ((value - low) / (high - low)) * (y1 - y0);
    places.push({ y0, y1, y, panel });
    (figure.bands ?? []).forEach(([start, end], number) => {
      if (number % 2 === 0) pen.fill(x(start), y0, x(end) - x(start), y1 - y0, color("page"));
      if (index === 0 && x(end) - x(start) > 10) pen.text(String(number + 1), (x(start) + x(end)) / 2, y0 - gap - 4, quiet, 10, "center");
    });
    const scale = ticks(low, high, Math.max(2, Math.floor(tall / 26)));
    for (const value of scale.values) {
      pen.line([[left, y(value)], [right, y(value)]], edge, 1);
      pen.text(label(value, scale.digits), left - 6, y(value), quiet, 10.5, "right");
    }
    if (!figure.bare) {
      for (const value of time.values) pen.line([[x(value), y0], [x(value), y1]], edge, 1);
      pen.text(`${panel.title} [${panel.unit}]`, left, y0 - 10, text, 12, "left", true);
    } else pen.text(panel.title, left + 4, y0 + 8, quiet, 10.5, "left");
    pen.clip(left, y0 - 1, right - left, y1 - y0 + 2);
    for (const limit of panel.limits ?? []) pen.line([[left, y(limit)], [right, y(limit)]], quiet, 1.2, [6, 4]);
    for (const { points, ink: color, dash, width } of panel.series) pen.line(points.map(([t, value]) => [x(t), y(value)]), color, width ?? 2, dash);
    for (const { points, color, hollow } of panel.marks ?? []) for (const [t, value] of points) pen.dot(x(t), y(value), hollow ? 5 : 2.5, color, hollow);
    pen.unclip();
  });
  if (!figure.bare) {
    for (const value of time.values) pen.text(label(value, time.digits), x(value), bottom + 12, quiet, 10.5, "center");
    pen.text("Time [s]", (left + right) / 2, bottom + 27, text, 12, "center");
  }
  if (figure.cursor !== undefined) cursor(pen, figure, places, x, left, right);
  return { time: (place) => from + ((place - left) / (right - left)) * (to - from) };
}

/** Values under the cursor, beside it. */
function cursor(pen, figure, places, x, left, right) {
  const at = Math.min(Math.max(figure.cursor, figure.from), figure.to);
  for (const { y0, y1, y, panel } of places) {
    pen.line([[x(at), y0], [x(at), y1]], color("accent"), 1);
    const said = [];
    for (const { points, ink } of panel.series) {
      const value = valueAt(points, at);
      if (value === undefined) continue;
      pen.dot(x(at), y(value), 3, ink);
      said.push(value.toPrecision(5).replace(/\.?0+$/, "").replace("-", "−"));
    }
    const aside = x(at) > (left + right) / 2 ? -8 : 8;
    pen.text(said.join("   "), x(at) + aside, y0 + 9, color("text"), 11, aside < 0 ? "right" : "left", true);
  }
  pen.text(`${at.toFixed(4)} s`, x(at), places.at(-1).y1 + 12, color("accent"), 11, "center", true);
}

function valueAt(points, at) {
  const index = points.findIndex(([time]) => time >= at);
  if (index < 0) return points.at(-1)?.[1];
  if (index === 0) return points[0][1];
  const [[t0, v0], [t1, v1]] = [points[index - 1], points[index]];
  return t1 > t0 ? v0 + ((v1 - v0) * (at - t0)) / (t1 - t0) : v1;
}

const FONT = "system-ui, sans-serif";

/** Draws on a canvas, at the resolution of the screen. */
export class CanvasPen {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
  }
  /** Makes the canvas as large as it is shown; its size. */
  fit() {
    const { clientWidth: width, clientHeight: height } = this.canvas, ratio = devicePixelRatio || 1;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      [this.canvas.width, this.canvas.height] = [Math.round(width * ratio), Math.round(height * ratio)];
    }
    this.context.setTransform(ratio, 0, 0, ratio, 0, 0);
    return [width, height];
  }
  clear(width, height) { this.context.clearRect(0, 0, width, height); }
  fill(x, y, width, height, color) { this.context.fillStyle = color; this.context.fillRect(x, y, width, height); }
  line(points, color, width, dash = []) {
    const { context } = this;
    context.beginPath();
    for (const [x, y] of points) context.lineTo(x, y);
    Object.assign(context, { strokeStyle: color, lineWidth: width, lineJoin: "bevel" });
    context.setLineDash(dash);
    context.stroke();
  }
  dot(x, y, radius, color, hollow) {
    const { context } = this;
    context.beginPath();
    context.arc(x, y, radius, 0, 7);
    context.setLineDash([]);
    if (hollow) { Object.assign(context, { strokeStyle: color, lineWidth: 1.6 }); context.stroke(); }
    else { context.fillStyle = color; context.fill(); }
  }
  text(text, x, y, color, size, align, bold) {
    Object.assign(this.context, { fillStyle: color, font: `${bold ? 600 : 400} ${size}px ${FONT}`, textAlign: align, textBaseline: "middle" });
    this.context.fillText(text, x, y);
  }
  clip(x, y, width, height) {
    this.context.save();
    this.context.beginPath();
    this.context.rect(x, y, width, height);
    this.context.clip();
  }
  unclip() { this.context.restore(); }
}

const escape = (text) => text.replace(/[<>&"]/g, (c) => `&#${c.charCodeAt(0)};`);
const short = (value) => Math.round(value * 100) / 100;

/** Draws into an SVG document. */
export class SvgPen {
  constructor() { this.parts = []; this.clips = 0; }
  clear(width, height, color) { this.size = [width, height]; this.fill(0, 0, width, height, color); }
  fill(x, y, width, height, color) { this.parts.push(`<rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}" fill="${color}"/>`); }
  line(points, color, width, dash = []) {
    const path = points.map(([x, y]) => `${short(x)},${short(y)}`).join(" ");
    this.parts.push(`<polyline points="${path}" fill="none" stroke="${color}" stroke-width="${width}" stroke-linejoin="round"${dash.length ? ` stroke-dasharray="${dash}"` : ""}/>`);
  }
  dot(x, y, radius, color, hollow) { this.parts.push(`<circle cx="${short(x)}" cy="${short(y)}" r="${radius}" ${hollow ? `fill="none" stroke="${color}" stroke-width="1.6"` : `fill="${color}"`}/>`); }
  text(text, x, y, color, size, align, bold) {
    const anchor = { left: "start", center: "middle", right: "end" }[align];
    this.parts.push(`<text x="${short(x)}" y="${short(y)}" fill="${color}" font-size="${size}" text-anchor="${anchor}" dominant-baseline="central"${bold ? ' font-weight="600"' : ""}>${escape(text)}</text>`);
  }
  clip(x, y, width, height) {
    const id = `c${this.clips++}`;
    this.parts.push(`<clipPath id="${id}"><rect x="${short(x)}" y="${short(y)}" width="${short(width)}" height="${short(height)}"/></clipPath><g clip-path="url(#${id})">`);
  }
  unclip() { this.parts.push("</g>"); }
  toString() {
    const [width, height] = this.size;
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-family="${FONT}">\n${this.parts.join("\n")}\n</svg>\n`;
  }
}
