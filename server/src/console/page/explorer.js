// Type limits, see the motion.

import { call } from "./api.js";
import { ink } from "./chart.js";
import { clear, dress, fact, numbers, object, refuse } from "./form.js";
import { curves, phases } from "./motion.js";
import { Chart, downloads, tables, verdict } from "./panel.js";
import { plain, unit, word } from "./units.js";

const FAMILIES = [
  ["S_CURVE", "S-curve"], ["TRAPEZOIDAL", "trapezoid"], ["TRIGONOMETRIC", "trigonometric"],
  ...[2, 3, 4, 5, 6, 7, 8].map((order) => [`POLYNOMIAL:${order}`, `polynomial, order ${order}`]),
];
const NUMBERS = ["distance", "startVelocity", "endVelocity", "startAcceleration", "endAcceleration", "maxVelocity", "maxAcceleration",
  "maxDeceleration", "maxJerk", "maxSnap", "feedRate", "minimumDuration", "cycleTime"];
/** Fields of the schema, and those of the form. */
const FIELDS = { "goal.position": "distance", "start.velocity": "startVelocity", "goal.velocity": "endVelocity", "start.acceleration": "startAcceleration",
  "goal.acceleration": "endAcceleration", "limits.max_velocity": "maxVelocity", "limits.max_acceleration": "maxAcceleration",
  "limits.max_deceleration": "maxDeceleration", "limits.max_jerk": "maxJerk", "limits.max_snap": "maxSnap", "limits.feed_rate": "feedRate",
  minimum_duration: "minimumDuration", cycle_time: "cycleTime" };

export function explorer() {
  const form = document.querySelector("#move"), state = document.querySelector("#move-state");
  const summary = document.querySelector("#move-summary"), details = document.querySelector("#move-details");
  const chart = new Chart(document.querySelector("#move-chart"));
  for (const select of form.querySelectorAll(".families")) {
    for (const [value, name] of FAMILIES) select.append(new Option(name, value));
  }
  remember(form);
  dress(form);
  let asking = new AbortController(), shown = null;

  async function plan() {
    asking.abort();
    asking = new AbortController();
    const { signal } = asking;
    localStorage.setItem("move", new URLSearchParams(new FormData(form)).toString());
    const given = numbers(form, NUMBERS);
    if (!given) return chart.age();
    const beside = form.elements.beside.value;
    try {
      const [answer, other] = await Promise.all([
        call("PlannerService/Plan", request(form, given, form.elements.family.value), signal),
        // One that cannot be met does not take the first away.
        beside && call("PlannerService/Plan", request(form, given, beside), signal).catch((error) => error),
      ]);
      show(answer, other || null);
    } catch (error) {
      if (error.name === "AbortError") return;
      chart.age();
      shown = null;
      summary.replaceChildren();
      details.replaceChildren();
      const elsewhere = (error.fields ?? []).filter(({ field, description }) => {
        const named = form.elements[FIELDS[field.replace(/^axes\[\d+\]\./, "")]];
        if (named) object(named, description.replace("name a short_path_policy", "choose under “Path too short” what gives way"));
        return !named;
      });
      refuse(state, { ...error, message: error.message, fields: elsewhere, marked: elsewhere.length < (error.fields ?? []).length });
      boxes();
    }
  }

  function show(answer, other) {
    const { plan } = answer, [axis] = plan.axes, { kind } = axis;
    const second = other instanceof Error ? null : other?.plan;
    if (other instanceof Error) refuse(state, { ...other, message: `Beside it: ${other.message}`, fields: (other.fields ?? []).map(({ field, description }) => ({ field: `beside it, ${field}`, description })) });
    else clear(state);
    const { classification: named, limits } = axis;
    const names = [named.eightType && `type ${named.eightType} of 8`, named.asymmetricType && `asymmetric ${named.asymmetricType}`, named.sixCase && `case ${named.sixCase}`].filter(Boolean);
    const critical = plan.explanation?.bindings ?? [];
    const binds = [...new Set(critical.map(({ quantity }) => word(quantity)))].join(", ");
    const familyOf = (plan) => FAMILIES.find(([value]) => value === (plan.method.family.endsWith("POLYNOMIAL") ? `POLYNOMIAL:${plan.method.order}` : plan.method.family.replace("PROFILE_FAMILY_", "")))?.[1] ?? "";
    summary.replaceChildren(
      fact(`${plain(plan.duration)} s`, familyOf(plan), "", ink(0)),
      ...(second ? [fact(`${plain(second.duration)} s`, `${familyOf(second)}, ${second.duration < plan.duration ? "" : "+"}${plain((second.duration / plan.duration - 1) * 100, 3)} %`, "", ink(1))] : []),
      fact(plan.cycleCount, "cycles"),
      fact(`${plain(named.feedRate)} ${unit("u/s", kind)}`, "greatest speed"),
      ...(names.length ? [fact(names.join(", "), "classification")] : []),
      ...(binds ? [fact(binds, "limits reached")] : []),
      verdict(plan.certificate),
      ...(axis.adjustments.length ? [fact(axis.adjustments.map(({ quantity, planned }) => `${word(quantity)} ${plain(planned)}`).join(", "), "not as asked", "warn")] : []),
    );
    const all = [plan, ...(second ? [second] : [])];
    const duration = Math.max(...all.map(({ duration }) => duration));
    const lines = all.map((plan) => curves(plan.axes[0], duration));
    const speed = limits.maxDeceleration ?? limits.maxAcceleration;
    const bounds = [[], [limits.maxVelocity, -(limits.maxVelocityReverse ?? limits.maxVelocity)], [limits.maxAcceleration, -speed],
      plan.method.order >= 3 ? [limits.maxJerk, -limits.maxJerk] : []];
    const panels = ["position", "velocity", "acceleration", "jerk"].map((name, index) => ({
      title: name[0].toUpperCase() + name.slice(1), unit: unit(["u", "u/s", "u/s²", "u/s³"][index], kind), zero: index > 0, limits: bounds[index],
      series: lines.map((line, number) => ({ points: line[index], ink: ink(number), width: number ? 1.6 : 2, dash: number ? [5, 3] : [] })).reverse(),
    }));
    chart.show({ from: 0, to: duration || 1, panels, bands: phases(axis).slice(0, 60) });
    details.replaceChildren(...tables(plan));
    shown = { name: "move", answer };
    boxes();
  }

  const boxes = () => (document.querySelector("#move-downloads").hidden = !shown);
  let timer = 0;
  const soon = () => {
    clearTimeout(timer);
    // A key at a time; who types on is not answered in between.
    timer = setTimeout(plan, 60);
  };
  form.addEventListener("input", soon);
  form.addEventListener("submit", (event) => event.preventDefault());
  downloads(document.querySelector("#move-downloads"), chart, () => shown, (error) => refuse(state, error));
  plan();
  return { redraw: () => { plan(); } };
}

/** What was typed the last time. */
function remember(form) {
  const kept = new URLSearchParams(localStorage.getItem("move") ?? "");
  for (const [name, value] of kept) {
    const field = form.elements[name];
    if (field?.type === "checkbox") field.checked = true;
    else if (field) field.value = value;
  }
}

/** A PlanRequest. Limits that a polynomial needs and that are not given follow the rule of `portamento compare`. */
function request(form, given, law) {
  const [family, order] = law.split(":");
  const limits = { maxVelocity: given.maxVelocity, maxAcceleration: given.maxAcceleration };
  for (const name of ["maxJerk", "maxDeceleration", "feedRate"]) if (given[name] !== undefined) limits[name] = given[name];
  const high = Number(order ?? 0);
  const snap = given.maxSnap ?? (2 * given.maxJerk ** 2) / given.maxAcceleration;
  if (high >= 4) limits.maxSnap = snap;
  if (high >= 5) {
    const all = [given.maxJerk, snap];
    while (all.length < high - 2) all.push((2 * all.at(-1) ** 2) / all.at(-2));
    limits.maxHigherDerivatives = all.slice(2);
  }
  const asked = {
    axes: [{
      axis: "x", kind: form.elements.kind.value, limits,
      start: { velocity: given.startVelocity ?? 0, acceleration: given.startAcceleration ?? 0 },
      goal: { position: given.distance ?? 0, velocity: given.endVelocity ?? 0, acceleration: given.endAcceleration ?? 0 },
    }],
    family: `PROFILE_FAMILY_${family}`, shortPathPolicy: form.elements.shortPathPolicy.value, endOnCycle: form.elements.endOnCycle.checked,
  };
  if (order) asked.order = high;
  if (given.minimumDuration) asked.minimumDuration = seconds(given.minimumDuration);
  if (given.cycleTime !== undefined) asked.cycleTime = seconds(given.cycleTime / 1000);
  return asked;
}

const seconds = (value) => `${value.toFixed(9)}s`;
