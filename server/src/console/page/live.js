// Streams as they run: commanded against measured, at the display's rate whatever the cycle.

import { watch } from "./api.js";
import { Card } from "./card.js";

/** Between two messages of a stream [ms], and the most points in one. */
const PERIOD = 50, POINTS = 120;
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
  const nothing = () => say("No stream is open here", "Plan a motion and have an axis play it, as <code>portamento plan … --output move.json</code> and <code>portamento track move.json</code>. It appears here by itself.");
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
        const before = cards.get(name), card = new Card(name);
        before?.leave();
        if (before?.large) card.enlarge();
        cards.set(name, card);
        card.join(holder);
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
  function columns(message, refused) {
    if (refused) return;
    // Whoever sends columns is there, however late a summary comes.
    present.set(message.stream, performance.now());
    cards.get(message.stream)?.take(message);
  }
  /** One connection carries all streams: a browser has six for a server. */
  function watchAll(names) {
    const wanted = names.join("\n");
    if (wanted === watched) return;
    watched = wanted;
    ends[1]?.();
    ends.length = 1;
    if (names.length) ends.push(watch(names, { periodMs: PERIOD, maxPoints: POINTS }, { message: columns, lost }));
  }

  function frame(now) {
    if (!running) return;
    for (const card of cards.values()) card.draw(now);
    requestAnimationFrame(frame);
  }
  return { start, stop };
}
