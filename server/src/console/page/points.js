// Points of position, velocity and time: type or paste them, see what becomes of each.

import { call } from "./api.js";
import { color, ink } from "./chart.js";
import { clear, dress, fact, numbers, object, refuse } from "./form.js";
import { curves } from "./motion.js";
import { Chart, downloads, tables, verdict } from "./panel.js";
import { number, plain, unit, word } from "./units.js";

const EXAMPLE = [["0.2", "0.015", "0.15"], ["0.4", "0.045", "0.15"], ["0.6", "0.09", "0.1"], ["0.8", "0.1", "0"]];

export function points() {
  const form = document.querySelector("#pvt"), body = document.querySelector("#rows"), state = document.querySelector("#pvt-state");
  const summary = document.querySelector("#pvt-summary"), details = document.querySelector("#pvt-details");
  const chart = new Chart(document.querySelector("#pvt-chart"));
  dress(form);
  let asking = new AbortController(), shown = null, timer = 0;

  function row(cells = ["", "", ""], before = null) {
    const line = document.createElement("tr");
    ["time", "position", "velocity"].forEach((name, index) => {
      const cell = document.createElement("td"), field = document.createElement("input");
      Object.assign(field, { value: cells[index] ?? "", inputMode: "decimal", ariaLabel: name });
      cell.append(field);
      line.append(cell);
    });
    const region = document.createElement("td"), last = document.createElement("td"), remove = document.createElement("button");
    region.className = "of";
    Object.assign(remove, { type: "button", textContent: "×", ariaLabel: "Remove this point", title: "Remove this point" });
    remove.addEventListener("click", () => {
      const next = line.nextElementSibling ?? line.previousElementSibling;
      line.remove();
      next?.querySelector("button").focus();
      soon();
    });
    last.append(remove);
    line.append(region, last);
    body.insertBefore(line, before);
    return line;
  }
  function fill(rows) {
    body.replaceChildren();
    rows.forEach((cells) => row(cells));
    soon();
  }

  const read = () => [...body.rows].map((line) => [...line.querySelectorAll("input")]);
  async function plan() {
    asking.abort();
    asking = new AbortController();
    localStorage.setItem("points", JSON.stringify(read().map((fields) => fields.map(({ value }) => value))));
    const limits = numbers(form, ["maxVelocity", "maxAcceleration", "maxJerk"]);
    let good = limits !== null;
    const rows = read().map((fields) => fields.map((field) => {
      const value = number(field.value);
      const bad = !Number.isFinite(value);
      field.toggleAttribute("aria-invalid", bad);
      if (bad) field.setAttribute("aria-invalid", "true");
      good &&= !bad;
      return value;
    }));
    if (!rows.length) return empty();
    if (!good) return chart.age();
    const [times, positions, velocities] = [0, 1, 2].map((column) => rows.map((line) => line[column]));
    const { kind, policy, interpolation, finishUnreached } = form.elements;
    const axis = { axis: "x", kind: kind.value, limits, times, positions, velocities };
    const request = { axes: [axis], policy: policy.value, interpolation: interpolation.value, finishUnreached: finishUnreached.checked };
    try {
      show(await call("PlannerService/PlanPvt", request, asking.signal), axis);
    } catch (error) {
      if (error.name === "AbortError") return;
      chart.age();
      shown = null;
      summary.replaceChildren();
      details.replaceChildren();
      const elsewhere = (error.fields ?? []).filter(({ field, description }) => {
        const limit = { max_velocity: "maxVelocity", max_acceleration: "maxAcceleration", max_jerk: "maxJerk" }[field.split(".limits.")[1]];
        if (limit) object(form.elements[limit], description);
        const [, column, index] = field.match(/\.(times|positions|velocities)\[(\d+)\]/) ?? [];
        if (column) read()[index]?.[["times", "positions", "velocities"].indexOf(column)].setAttribute("aria-invalid", "true");
        return !limit;
      });
      refuse(state, { ...error, message: error.message, fields: elsewhere, marked: elsewhere.length < (error.fields ?? []).length });
      boxes();
    }
  }

  function empty() {
    shown = null;
    boxes();
    chart.age();
    summary.replaceChildren();
    details.replaceChildren();
    state.className = "state";
    const text = document.createElement("p");
    text.textContent = "There is no point yet: add one, paste a table of time, position, velocity, or take the example.";
    state.replaceChildren(text);
  }

  function show(answer, asked) {
    const { plan, points } = answer, [axis] = plan.axes, { kind } = axis;
    clear(state);
    [...body.rows].forEach((line, index) => {
      const report = points[index], place = line.querySelector(".of");
      const badge = document.createElement("span");
      badge.className = `region ${report?.region ?? ""}${report?.adjustments.length ? " adjusted" : ""}`;
      badge.textContent = report?.region || "–";
      badge.title = report?.adjustments.length ? report.adjustments.map(({ quantity, asked, planned }) => `${word(quantity)}: ${plain(planned)} instead of ${plain(asked)}`).join("\n") : "met as asked";
      place.replaceChildren(badge);
    });
    const missed = points.filter(({ adjustments }) => adjustments.length);
    summary.replaceChildren(
      fact(`${plain(plan.duration)} s`, `through ${points.length} points`),
      fact(String(missed.length), "not met as asked", missed.length ? "warn" : "good"),
      verdict(plan.certificate),
      ...(plan.certificate.reversals.length ? [fact(String(plan.certificate.reversals.length), "times turned back", "warn")] : []),
    );
    const lines = curves(axis, plan.duration), { limits } = axis;
    const bounds = [[], [limits.maxVelocity, -limits.maxVelocity], [limits.maxAcceleration, -limits.maxAcceleration], [limits.maxJerk, -limits.maxJerk]];
    const met = (report) => !report.adjustments.length;
    const marks = (column, value) => [
      { points: points.filter(met).map((report) => [report.time, value(report)]), color: color("text") },
      { points: points.map((report, index) => [asked.times[index], asked[column][index], report]).filter(([, , report]) => !met(report)), color: color("warn"), hollow: true },
    ];
    const panels = ["position", "velocity", "acceleration", "jerk"].map((name, index) => ({
      title: name[0].toUpperCase() + name.slice(1), unit: unit(["u", "u/s", "u/s²", "u/s³"][index], kind), zero: index > 0, limits: bounds[index],
      series: [{ points: lines[index], ink: ink(0) }],
      marks: index === 0 ? marks("positions", ({ position }) => position) : index === 1 ? marks("velocities", ({ velocity }) => velocity) : [],
    }));
    let from = 0;
    const spans = points.map(({ time, region }) => {
      const span = { from, to: time, name: region || "–", color: region ? color(region.toLowerCase()) : color("edge") };
      from = time;
      return span;
    });
    chart.show({ from: 0, to: plan.duration || 1, panels, spans });
    details.replaceChildren(...tables(plan));
    shown = { name: "points", answer };
    boxes();
  }

  const boxes = () => (document.querySelector("#pvt-downloads").hidden = !shown);
  const soon = () => {
    clearTimeout(timer);
    timer = setTimeout(plan, 60);
  };
  form.addEventListener("input", soon);
  form.addEventListener("submit", (event) => event.preventDefault());
  body.addEventListener("paste", (event) => {
    const text = event.clipboardData.getData("text");
    const rows = text.split(/\r?\n/).map((line) => line.trim().split(/[\t;]|,\s*|\s+/)).filter((cells) => cells.length >= 3 && Number.isFinite(number(cells[0])));
    if (!rows.length) return;
    event.preventDefault();
    const line = event.target.closest("tr");
    rows.forEach((cells) => row(cells, line));
    if ([...line.querySelectorAll("input")].every(({ value }) => !value.trim())) line.remove();
    soon();
  });
  document.querySelector("#add-row").addEventListener("click", () => {
    const last = number(body.lastElementChild?.querySelector("input").value ?? "") ?? 0;
    row([plain(last + 0.2).replace("−", "-"), "", "0"]).querySelectorAll("input")[1].focus();
    soon();
  });
  document.querySelector("#example-rows").addEventListener("click", () => fill(EXAMPLE));
  downloads(document.querySelector("#pvt-downloads"), chart, () => shown, (error) => refuse(state, error));
  let kept = EXAMPLE;
  try {
    kept = JSON.parse(localStorage.getItem("points")) ?? EXAMPLE;
  } catch { /* what cannot be read is not kept */ }
  fill(kept);
  return { redraw: () => plan() };
}
