// What both planning views show: a chart with a cursor, downloads, and tables of a plan.

import { callAll } from "./api.js";
import { CanvasPen, SvgPen, draw } from "./chart.js";
import { fact, save, table } from "./form.js";
import { PATTERNS, plain, unit, word } from "./units.js";

/** A chart that can be read out with pointer and arrow keys. */
export class Chart {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = new CanvasPen(canvas);
    this.figure = null;
    const point = (event) => {
      if (!this.figure) return;
      this.figure.cursor = this.scale.time(event.offsetX);
      this.redraw();
    };
    canvas.addEventListener("pointermove", point);
    canvas.addEventListener("pointerdown", point);
    canvas.addEventListener("pointerleave", () => this.leave());
    canvas.addEventListener("blur", () => this.leave());
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.005, ArrowRight: 0.005, PageUp: -0.05, PageDown: 0.05, Home: -1, End: 1 }[event.key];
      if (!step || !this.figure) return;
      event.preventDefault();
      const { from, to } = this.figure, now = this.figure.cursor ?? from;
      this.figure.cursor = Math.min(to, Math.max(from, now + step * (to - from)));
      this.redraw();
    });
    new ResizeObserver(() => this.redraw()).observe(canvas);
  }
  leave() {
    if (!this.figure) return;
    delete this.figure.cursor;
    this.redraw();
  }
  show(figure) {
    if (this.figure?.cursor !== undefined) figure.cursor = this.figure.cursor;
    this.figure = figure;
    this.canvas.classList.remove("stale");
    this.redraw();
  }
  /** What is drawn is of another question. */
  age() { this.canvas.classList.add("stale"); }
  redraw() {
    if (!this.figure || !this.canvas.clientWidth) return;
    const [width, height] = this.pen.fit();
    this.scale = draw(this.pen, this.figure, width, height);
  }
  svg() {
    const pen = new SvgPen();
    const { cursor: _, ...figure } = this.figure;
    draw(pen, figure, 900, 760);
    return pen.toString();
  }
}

/** Buttons that save what is shown: `shown()` gives { name, answer }, or nothing. */
export function downloads(box, chart, shown, trouble) {
  box.addEventListener("click", async ({ target }) => {
    const as = target.dataset.as, now = shown();
    if (!as || !now) return;
    if (as === "json") save(`${now.name}.json`, "application/json", JSON.stringify(now.answer, null, 2));
    if (as === "svg") save(`${now.name}.svg`, "image/svg+xml", chart.svg());
    if (as !== "csv") return;
    target.disabled = true;
    try {
      save(`${now.name}.csv`, "text/csv", csv(now.answer.plan, await callAll("PlannerService/SamplePlan", { plan: now.answer.plan })));
    } catch (error) {
      trouble(error);
    } finally {
      target.disabled = false;
    }
  });
}

/** The setpoints as the server samples them, with every digit. */
function csv(plan, chunks) {
  const words = ["position", "velocity", "acceleration", "jerk"];
  const quoted = (name) => (/[",\n]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);
  const head = plan.axes.flatMap(({ axis }) => words.map((word) => quoted(`${axis}.${word}`)));
  const lines = [["cycle", ...head].join(",")];
  for (const { firstCycle, columns } of chunks) {
    for (let index = 0; index < columns.cycles; index++) {
      const cells = plan.axes.flatMap((_, axis) => words.map((word) => columns[word][axis * columns.cycles + index]));
      lines.push([Number(firstCycle) + index, ...cells].join(","));
    }
  }
  return lines.join("\n") + "\n";
}

const title = (quantity) => word(quantity);
const of = (quantity, kind) => unit(PATTERNS[word(quantity)] ?? "", kind);

const exceeded = ({ margin }) => !(margin >= -1e-9);

/** What the judge says, in a box. Passed is what a plan promises: one that promises little may exceed a limit all the same. */
export function verdict({ passed, limitChecks }) {
  if (!passed) return fact("failed", "certificate", "bad");
  const beyond = limitChecks.filter((check) => !check.guaranteed && exceeded(check)).map(({ quantity }) => title(quantity));
  return beyond.length ? fact("passed", `certificate; ${beyond.join(", ")} not promised, and exceeded`, "warn") : fact("passed", "certificate", "good");
}

/** Adjustments, phases, binding limits and the certificate of a plan of one axis. */
export function tables(plan) {
  const [axis] = plan.axes, { kind } = axis, { certificate, explanation } = plan;
  const parts = [];
  if (axis.adjustments.length) {
    parts.push(table("Not as asked", ["what", "asked", "planned", "why"], axis.adjustments.map(({ quantity, asked, planned, reason }) =>
      [`${title(quantity)} [${of(quantity, kind)}]`, plain(asked, 6), plain(planned, 6), reason.toLowerCase().replaceAll("_", " ")]), true));
  }
  if (explanation?.bindings?.length) {
    parts.push(table("Limits that hold it back", ["limit", "from [s]", "to [s]"], explanation.bindings.map(({ quantity, fromTime, toTime }) =>
      [title(quantity), plain(fromTime), plain(toTime)])));
  }
  const checks = certificate.limitChecks.map((check) => [`${title(check.quantity)} [${of(check.quantity, kind)}]`, plain(check.limit), plain(check.extremum),
    plain(check.atTime), `${plain(check.margin * 100, 3)} %`, `${exceeded(check) ? "exceeded" : "kept"}${check.guaranteed ? "" : ", not promised"}`]);
  parts.push(table(`Certificate: ${certificate.passed ? "passed" : "failed"}`, ["limit on", "limit", "extreme", "at [s]", "margin", ""], checks, true));
  parts.push(table("Joins and end", ["what", "worst jump", "allowed", "off the end"], certificate.continuityChecks.map(({ quantity, worstJump, allowed }) =>
    [`${title(quantity)} [${of(quantity, kind)}]`, plain(worstJump, 2), plain(allowed, 2),
      plain(certificate.endChecks.find((check) => check.quantity === quantity)?.residual ?? 0, 2)])));
  if (axis.segments.length && axis.segments.length <= 60) {
    let begin = 0;
    parts.push(table("Phases", ["#", "from [s]", "lasts [s]", `jerk [${unit("u/s³", kind)}]`], axis.segments.map((segment, index) => {
      const row = [index + 1, plain(begin), plain(segment.duration), segment.jerk !== undefined ? plain(segment.jerk) : segment.cosineJerk ? `cosine, peak ${plain(segment.cosineJerk.peakJerk)}` : "polynomial"];
      begin += segment.duration;
      return row;
    })));
  }
  return parts;
}
