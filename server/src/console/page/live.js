// Streams as they run: commanded against measured, at the display's rate whatever the cycle.

import { call, watch } from "./api.js";
import { CanvasPen, draw, ink } from "./chart.js";
import { plain, unit, word } from "./units.js";

/** How much of the past is seen [s]. */
const WINDOW = 4;
/** How far behind the newest the picture goes [s], so that it moves evenly between two messages. */
const BEHIND = 0.15;
/** Between two messages of a stream [ms], and the most points in one. */
const PERIOD = 50, POINTS = 120;
/** Points kept of each curve. */
const KEPT = 6000;

export function live() {
  const holder = document.querySelector("#streams"), state = document.querySelector("#live-state"), count = document.querySelector("#live-count");
  const cards = new Map();
  let ends = [], running = false, watched = "", silent = 0;

  function start() {
    if (running) return;
    running = true;
    ends = [watch([], { periodMs: 500 }, { message: summaries, lost })];
    say("Looking for streams …");
    clearInterval(silent);
    silent = setInterval(() => (present.size ? take() : state.textContent.startsWith("Looking") ? nothing() : take()), 1200);
    requestAnimationFrame(frame);
  }
  function stop() {
    running = false;
    watched = "";
    clearInterval(silent);
    ends.forEach((end) => end());
  }

  function say(title, text = "", how = "") {
    state.className = `state ${how}`;
    state.replaceChildren();
    if (!title) return;
    const head = document.createElement("h2"), body = document.createElement("p");
    head.textContent = title;
    body.innerHTML = text;
    state.append(head, body);
  }
  const nothing = () => say("No stream is open here", "Plan a motion and have an axis play it, as <code>portamento plan … --output move.json</code> and <code>portamento track --plan move.json</code>. It appears here by itself.");
  const lost = () => running && say("The server does not answer", "What is shown stands still. It goes on by itself when the server is back; axes go on with another replica, or come to rest.", "refused");

  const present = new Map();
  function summaries(message, refused) {
    if (refused) return say("The server is leaving", refused.message, "refused");
    const now = performance.now();
    present.set(message.stream, now);
    if (state.textContent) say("");
    take();
  }
  /** Brings the cards in line with the streams that there are. */
  function take() {
    const now = performance.now();
    for (const [name, seen] of present) if (now - seen > 1800) present.delete(name);
    count.hidden = present.size === 0;
    count.textContent = present.size;
    if (!present.size && !state.textContent) nothing();
    for (const name of present.keys()) {
      if (!cards.has(name) || cards.get(name).over) {
        cards.get(name)?.element.remove();
        const card = new Card(name);
        cards.set(name, card);
        holder.append(card.element);
      }
    }
    for (const [name, card] of cards) if (!present.has(name)) card.end();
    // One that came again before it was missed: what was shown of it has ended.
    if ([...cards.values()].some((card) => !card.over && now - card.heard > 2500)) {
      watched = "";
      for (const card of cards.values()) card.heard = now;
    }
    watchAll([...present.keys()].sort());
  }
  /** One connection carries all streams: a browser has six for a server. */
  function watchAll(names) {
    const wanted = names.join("\n");
    if (wanted === watched) return;
    watched = wanted;
    ends[1]?.();
    ends.length = 1;
    if (names.length) ends.push(watch(names, { periodMs: PERIOD, maxPoints: POINTS }, { message: (message, refused) => refused || cards.get(message.stream)?.take(message), lost }));
  }

  function frame(now) {
    if (!running) return;
    for (const card of cards.values()) card.draw(now);
    requestAnimationFrame(frame);
  }
  return { start, stop };
}

/** One stream. */
class Card {
  constructor(name) {
    Object.assign(this, { name, over: false, axes: [], kinds: [], times: [], rows: [], phase: "", cycle: 0.001, asked: 0, heard: performance.now() });
    const element = (this.element = document.createElement("article"));
    element.className = "stream";
    element.tabIndex = 0;
    element.innerHTML = `<h2><span class="name"></span><span class="phase"></span><button type="button" class="enlarge" title="Enlarge (Enter)" aria-label="Enlarge">⤢</button></h2>
      <canvas role="img"></canvas>
      <div class="numbers"></div>
      <div class="controls"><button type="button" data-do="hold">Hold</button><button type="button" data-do="resume">Resume</button>
      <label>Override <input type="range" min="0" max="100" value="100" step="1"><output>100 %</output></label><button type="button" class="stop" data-do="stop">Stop</button></div>
      <p class="said" role="status" aria-live="polite"></p>`;
    element.setAttribute("aria-label", `Stream ${name}`);
    element.querySelector(".name").textContent = name;
    element.querySelector(".name").title = name;
    this.canvas = element.querySelector("canvas");
    this.canvas.setAttribute("aria-label", `${name}: position commanded and measured, and following error`);
    this.pen = new CanvasPen(this.canvas);
    this.slider = element.querySelector("input");
    this.said = element.querySelector(".said");
    element.querySelector(".enlarge").addEventListener("click", () => this.enlarge());
    element.querySelector(".controls").addEventListener("click", ({ target }) => target.dataset.do && this.ask(target.dataset.do));
    this.slider.addEventListener("input", () => {
      this.touched = performance.now();
      this.element.querySelector("output").textContent = `${this.slider.value} %`;
    });
    this.slider.addEventListener("change", () => this.ask("override"));
    element.addEventListener("keydown", (event) => {
      if (event.target !== element || event.ctrlKey || event.metaKey || event.altKey) return;
      const by = { ArrowLeft: -5, ArrowRight: 5 }[event.key];
      if (by) {
        this.slider.value = Number(this.slider.value) + by;
        this.slider.dispatchEvent(new Event("input"));
        clearTimeout(this.settling);
        this.settling = setTimeout(() => this.ask("override"), 250);
      } else if (event.key === "Enter") this.enlarge();
      else if (event.key.toLowerCase() === "h") this.ask("hold");
      else if (event.key.toLowerCase() === "r") this.ask("resume");
      else return;
      event.preventDefault();
    });
  }

  enlarge() { this.element.classList.toggle("large"); }

  /** Asks for an operation, and says what became of it. */
  async ask(what) {
    const factor = Number(this.slider.value) / 100;
    const operation = { requestId: crypto.randomUUID?.() ?? `console-${Date.now()}-${Math.random()}`,
      ...{ hold: { hold: {} }, resume: { resume: {} }, stop: { stop: {} }, override: { setOverride: { factor } } }[what] };
    this.tell(`${what} …`);
    const asked = ++this.asked;
    this.waiting = true;
    try {
      const { result } = await this.insist({ stream: this.name, operation });
      if (asked !== this.asked) return;
      const does = { hold: "Holds", resume: "Goes on", stop: "Stops", override: `Goes at ${Math.round(factor * 100)} %` }[what];
      this.tell(`${does} from cycle ${result.effectiveCycle}, at rest at cycle ${result.restCycle}.`);
    } catch (error) {
      if (asked === this.asked) this.tell(`${error.reason ? `${error.reason}: ` : ""}${error.message}`, true);
    } finally {
      if (asked === this.asked) this.waiting = false;
    }
  }
  /** An operation that got lost in a change of sessions is sent again: with the same id it is not done twice. */
  async insist(request, times = 3) {
    try {
      return await call("SetpointService/ControlStream", request);
    } catch (error) {
      if (error.reason !== "NOT_CONFIRMED" || times <= 1) throw error;
      return this.insist(request, times - 1);
    }
  }
  tell(text, refused = false) {
    this.said.className = `said${refused ? " refused" : ""}`;
    this.said.textContent = text;
  }

  end() {
    if (this.over) return;
    this.over = true;
    this.element.classList.add("over");
    for (const control of this.element.querySelectorAll(".controls button, .controls input")) control.disabled = true;
    this.tell("The stream has ended.");
  }

  /** Takes a WatchStreamResponse. */
  take(message) {
    const { cycles = [], commanded, tracking, events = [] } = message;
    this.axes = message.axes;
    this.kinds = message.kinds;
    if (message.cycleTime) this.cycle = parseFloat(message.cycleTime);
    const now = (this.heard = performance.now());
    const name = word(message.phase);
    if (name !== this.phase) {
      const badge = this.element.querySelector(".phase");
      badge.className = `phase ${message.phase.replace("PHASE_", "")}`;
      badge.textContent = this.phase = name;
    }
    const count = cycles.length, tracked = tracking && tracking.cycles === count;
    for (let index = 0; index < count; index++) {
      const at = (column) => this.axes.map((_, axis) => column[axis * count + index]);
      this.rows.push({ time: Number(cycles[index]) * this.cycle, commanded: at(commanded.position), velocity: at(commanded.velocity),
        measured: tracked ? at(tracking.measuredPosition) : null, error: tracked ? at(tracking.followingError) : null,
        jitter: tracked ? (tracking.cycleJitterNs?.[index] ?? 0) : null });
    }
    if (this.rows.length > KEPT) this.rows.splice(0, this.rows.length - KEPT);
    const last = this.rows.at(-1);
    if (last && count) {
      // The stream's clock against the display's, steady within a message or two.
      const offset = last.time * 1000 - now;
      this.offset = this.offset === undefined || Math.abs(offset - this.offset) > 400 ? offset : this.offset + 0.05 * (offset - this.offset);
    }
    this.latest = { message, last };
    if (!(performance.now() - (this.touched ?? -1e9) < 1500)) {
      this.slider.value = Math.round(message.overrideFactor * 100);
      this.element.querySelector("output").textContent = `${this.slider.value} %`;
    }
    for (const { kind, atCycle } of events) {
      // What was asked for is answered first.
      if (!this.waiting) this.tell(`${word(kind)} at cycle ${atCycle}`);
      if (kind.endsWith("FINISHED")) this.end();
    }
    this.numbers();
  }

  numbers() {
    const { message, last } = this.latest, { counters } = message, kind = this.kinds?.[0];
    const error = last?.error ? Math.max(...last.error.map(Math.abs)) : null;
    const small = kind === "AXIS_KIND_PULSES" ? [1, "p"] : kind === "AXIS_KIND_REVOLUTE" ? [1e6, "µrad"] : [1e6, "µm"];
    const facts = [
      ["cycle", message.executedCycle], ["lead", `${message.leadCycles} cycles`],
      ["position", last ? `${plain(last.commanded[0], 5)} ${unit("u", kind, true)}` : "–"],
      ["error", error === null ? "–" : `${plain(error * small[0], 3)} ${small[1]}`],
      ["late by", last?.jitter === null || !last ? "–" : `${plain(last.jitter / 1000, 3)} µs`],
      ["missed", counters?.underruns ?? "0"],
      ...(Number(message.messagesDropped) ? [["messages lost", message.messagesDropped]] : []),
    ];
    const box = this.element.querySelector(".numbers");
    while (box.children.length < facts.length) box.append(Object.assign(document.createElement("span"), { innerHTML: `<i></i> <b></b>` }));
    facts.forEach(([name, value], index) => {
      box.children[index].firstChild.textContent = name;
      box.children[index].lastChild.textContent = value;
    });
  }

  draw(now) {
    if (!this.rows.length || !this.canvas.clientWidth) return;
    const large = this.element.classList.contains("large");
    const last = this.rows.at(-1).time;
    const to = this.over ? last : Math.min(last, (now + this.offset) / 1000 - BEHIND), from = Math.max(this.rows[0].time, to - WINDOW);
    if (to === this.drawn && !large) return;
    this.drawn = to;
    const seen = this.rows.filter(({ time }) => time >= from - 0.1 && time <= to);
    if (!seen.length) return;
    const kind = this.kinds?.[0], micro = kind === "AXIS_KIND_PULSES" ? [1, "pulses"] : kind === "AXIS_KIND_REVOLUTE" ? [1e6, "µrad"] : [1e6, "µm"];
    const series = (of, axis) => {
      const points = [];
      for (const row of seen) if (of(row)) points.push([row.time, of(row)[axis]]);
      return points;
    };
    const axes = this.axes.slice(0, 4).map((_, axis) => axis);
    const panels = [
      { title: "position", unit: unit("u", kind), series: axes.flatMap((axis) => [
        { points: series((row) => row.commanded, axis), ink: ink(axis), width: 3.5 },
        { points: series((row) => row.measured, axis), ink: ink(axis + 1), width: 1.3 }]) },
      ...(large ? [{ title: "velocity", unit: unit("u/s", kind), zero: true, series: axes.map((axis) => ({ points: series((row) => row.velocity, axis), ink: ink(axis), width: 2 })) }] : []),
      { title: large ? "following error" : `error [${micro[1]}]`, unit: micro[1], zero: true, least: kind === "AXIS_KIND_PULSES" ? 0.1 : 0.01, series: axes.map((axis) => ({
        points: series((row) => row.error, axis).map(([time, value]) => [time, value * micro[0]]), ink: ink(axis + 1), width: 1.5 })) },
    ];
    if (!large) panels[0].title = `position [${panels[0].unit}]`;
    const [width, height] = this.pen.fit();
    draw(this.pen, { from, to: Math.max(to, from + 0.05), panels, bare: !large }, width, height);
  }
}
