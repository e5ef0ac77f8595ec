// Which view is shown, and in which colours.

import { explorer } from "./explorer.js";
import { live } from "./live.js";
import { points } from "./points.js";

const root = document.documentElement;
root.dataset.theme = localStorage.getItem("theme") ?? "";
const views = { explorer: explorer(), points: points(), live: live() };

const THEMES = ["", "light", "dark"];
const theme = document.querySelector("#theme");
const name = () => (theme.textContent = { "": "Theme: system", light: "Theme: light", dark: "Theme: dark" }[root.dataset.theme]);
theme.addEventListener("click", () => {
  const next = THEMES[(THEMES.indexOf(root.dataset.theme) + 1) % THEMES.length];
  root.dataset.theme = next;
  localStorage.setItem("theme", next);
  repaint();
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", repaint);
function repaint() {
  name();
  for (const view of Object.values(views)) view.redraw?.();
}
name();

function show() {
  const wanted = location.hash.slice(1) in views ? location.hash.slice(1) : "explorer";
  for (const view of Object.keys(views)) {
    document.querySelector(`#${view}`).hidden = view !== wanted;
    const link = document.querySelector(`#to-${view}`);
    if (view === wanted) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  if (wanted === "live") views.live.start();
  else views.live.stop();
}
addEventListener("hashchange", show);
show();
