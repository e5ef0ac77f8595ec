// One stream: its curves, its numbers, and what may be done to it.

import { call } from "./api.js";
import { CanvasPen, draw, ink } from "./chart.js";
import { History } from "./history.js";
import { plain, unit, word } from "./units.js";

/** How much of the past is seen [s]. */
const WINDOW = 4;
/** How far behind the newest the picture goes [s], so that it moves evenly between two messages. */
const BEHIND = 0.15;
/** Axes whose curves are drawn. */
const DRAWN = 4;
/** Between two changes of the numbers [ms], of a card in view and of one that is not: faster cannot be read. */
const READ = 100, UNSEEN = 500;

/** What an event is to whoever looks on. */
const SAYS = {
  draining: (cycle) => `This server leaves, at cycle ${cycle}; the axis goes on with another, or comes to rest.`,
  standstill: (cycle) => `At its goal from cycle ${cycle} on.`,
  finished: (cycle) => `Finished at cycle ${cycle}.`,
  superseded: (cycle) => `The axis has opened this stream anew, at cycle ${cycle}.`,
};

/** Only what is in view is drawn. */
const inView = new WeakMap();
const sight = new IntersectionObserver((entries) => entries.forEach(({ target, isIntersecting }) => inView.set(target, isIntersecting)), { rootMargin: "100px" });

/** What a following error is read in. */
const fine = (kind) => (kind === "AXIS_KIND_PULSES" ? [1, "pulses", "p"] : kind === "AXIS_KIND_REVOLUTE" ? [1e6, "µrad", "µrad"] : [1e6, "µm", "µm"]);

export class Card {
  constructor(name) {
    Object.assign(this, { name, over: false, axes: [], kinds: [], history: null, phase: "", cycle: 0.001, read: 0, asked: 0, heard: performance.now() });
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
    element.dataset.stream = name;
    this.canvas = element.querySelector("canvas");
    this.canvas.setAttribute("aria-label", `${name}: position commanded and measured, and following error`);
    this.pen = new CanvasPen(this.canvas);
    this.box = element.querySelector(".numbers");
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

  /** Into the page, where its name belongs, and out of it. */
  join(holder) {
    const after = [...holder.children].find(({ dataset }) => dataset.stream.localeCompare(this.name, undefined, { numeric: true }) > 0);
    holder.insertBefore(this.element, after ?? null);
    sight.observe(this.element);
  }
  leave() {
    sight.unobserve(this.element);
    this.element.remove();
  }

  get large() { return this.element.classList.contains("large"); }
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
      // Nobody may have asked for this hold.
      const missed = Number(message.counters?.underruns ?? 0);
      if (name === "holding" && missed && !this.waiting) this.tell(`Holds. It ran out of setpoints ${missed === 1 ? "once" : `${missed} times`}, and then rests by itself: Resume goes on.`);
    }
    const count = cycles.length, tracked = tracking && tracking.cycles === count;
    if (count) this.remember(cycles, commanded, tracked ? tracking : null, now);
    this.latest = message;
    if (!(performance.now() - (this.touched ?? -1e9) < 1500)) {
      this.slider.value = Math.round(message.overrideFactor * 100);
      this.element.querySelector("output").textContent = `${this.slider.value} %`;
    }
    for (const { kind, atCycle } of events) {
      // What was asked for is answered first.
      if (!this.waiting) this.tell((SAYS[word(kind)] ?? ((cycle) => `${word(kind)} at cycle ${cycle}.`))(atCycle));
      if (kind.endsWith("FINISHED")) this.end();
    }
  }

  /** Takes the columns of a message. */
  remember(cycles, commanded, tracking, now) {
    const count = cycles.length, axes = Math.min(this.axes.length, DRAWN), row = {};
    this.history ??= new History(["jitter", ...Array.from({ length: axes }, (_, axis) => [`commanded${axis}`, `velocity${axis}`, `measured${axis}`, `error${axis}`]).flat()]);
    for (let index = 0; index < count; index++) {
      for (let axis = 0; axis < axes; axis++) {
        const place = axis * count + index;
        row[`commanded${axis}`] = commanded.position[place];
        row[`velocity${axis}`] = commanded.velocity[place];
        row[`measured${axis}`] = tracking ? tracking.measuredPosition[place] : NaN;
        row[`error${axis}`] = tracking ? tracking.followingError[place] : NaN;
      }
      row.jitter = tracking ? (tracking.cycleJitterNs?.[index] ?? 0) : NaN;
      this.history.push(Number(cycles[index]) * this.cycle, row);
    }
    // The stream's clock against the display's, steady within a message or two.
    const offset = this.history.last("time") * 1000 - now;
    this.offset = this.offset === undefined || Math.abs(offset - this.offset) > 400 ? offset : this.offset + 0.05 * (offset - this.offset);
  }

  numbers() {
    const { latest: message, history } = this, { counters } = message, kind = this.kinds?.[0], [scale, , short] = fine(kind);
    const axes = Math.min(this.axes.length, DRAWN), jitter = history ? history.last("jitter") : NaN;
    let error = history ? 0 : NaN;
    for (let axis = 0; axis < axes && history; axis++) error = Math.max(error, Math.abs(history.last(`error${axis}`)));
    // Less than a millionth of what it is read in is a rounding.
    const read = (value) => (Math.abs(value) < 1e-6 ? 0 : value);
    const facts = [
      ["cycle", message.executedCycle], ["lead", `${message.leadCycles} cycles`],
      ["position", history ? `${plain(history.last("commanded0"), 5)} ${unit("u", kind, true)}` : "–"],
      ["error", Number.isNaN(error) ? "–" : `${plain(read(error * scale), 3)} ${short}`],
      ["late by", Number.isNaN(jitter) ? "–" : `${plain(jitter / 1000, 3)} µs`],
      ["missed", counters?.underruns ?? "0"],
      ...(Number(message.messagesDropped) ? [["messages lost", message.messagesDropped]] : []),
    ];
    const { box } = this;
    while (box.children.length < facts.length) box.append(Object.assign(document.createElement("span"), { innerHTML: "<i></i> <b></b>" }));
    while (box.children.length > facts.length) box.lastChild.remove();
    facts.forEach((fact, index) => {
      const { firstChild, lastChild } = box.children[index];
      [firstChild, lastChild].forEach((place, part) => { if (place.textContent !== String(fact[part])) place.textContent = fact[part]; });
    });
  }

  /** At every frame: the curves as far as they have got, and now and then the numbers. */
  draw(now) {
    const seen = inView.get(this.element) ?? true;
    if (this.latest && now - this.read > (seen ? READ : UNSEEN)) {
      this.read = now;
      this.numbers();
    }
    if (!seen || !this.history?.length || !this.canvas.clientWidth) return;
    const { history } = this, { large } = this, last = history.last("time");
    const to = this.over ? last : Math.min(last, (now + this.offset) / 1000 - BEHIND), from = Math.max(history.at("time", history.oldest), to - WINDOW);
    if (to === this.drawn && !large) return;
    this.drawn = to;
    const [width, height] = this.pen.fit(), kind = this.kinds?.[0], [scale, long] = fine(kind);
    const curve = (name, by) => history.curve(name, from, to, width / 2, by);
    const axes = this.axes.slice(0, DRAWN).map((_, axis) => axis);
    const panels = [
      { title: "position", unit: unit("u", kind), series: axes.flatMap((axis) => [
        { points: curve(`commanded${axis}`), ink: ink(axis), width: 3.5 },
        { points: curve(`measured${axis}`), ink: ink(axis + 1), width: 1.3 }]) },
      ...(large ? [{ title: "velocity", unit: unit("u/s", kind), zero: true, series: axes.map((axis) => ({ points: curve(`velocity${axis}`), ink: ink(axis), width: 2 })) }] : []),
      { title: large ? "following error" : `error [${long}]`, unit: long, zero: true, least: kind === "AXIS_KIND_PULSES" ? 0.1 : 0.01,
        series: axes.map((axis) => ({ points: curve(`error${axis}`, scale), ink: ink(axis + 1), width: 1.5 })) },
    ];
    if (!large) panels[0].title = `position [${panels[0].unit}]`;
    draw(this.pen, { from, to: Math.max(to, from + 0.05), panels, bare: !large }, width, height);
  }
}
