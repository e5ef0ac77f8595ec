// Fields with units, and what is said of them.

import { number, tidy, unit } from "./units.js";

/** Puts its unit beside each field, in that of the kind chosen. */
export function dress(form) {
  for (const input of form.querySelectorAll("label > [data-unit]")) {
    const box = document.createElement("span");
    box.className = "with-unit";
    input.replaceWith(box);
    const of = document.createElement("span");
    of.className = "unit";
    box.append(input, of);
  }
  const name = () => {
    const kind = form.elements.kind.value;
    for (const of of form.querySelectorAll(".unit")) of.textContent = unit(of.previousElementSibling.dataset.unit, kind, true);
    for (const head of form.querySelectorAll("[data-unit-head]")) head.textContent = `${head.dataset.unitHead} [${unit(head.dataset.unit, kind, true)}]`;
  };
  form.elements.kind.addEventListener("change", name);
  name();
}

/** The numbers of the named fields; one that is none is marked, and `null` comes back. */
export function numbers(form, names) {
  const read = {};
  let good = true;
  for (const name of names) {
    const field = form.elements[name], value = number(field.value);
    const bad = value !== undefined && !Number.isFinite(value);
    object(field, bad ? `${field.value.trim()} is not a number` : "");
    good &&= !bad;
    if (value !== undefined) read[name] = value;
  }
  return good ? read : null;
}

/** Says beside a field what is wrong with it; nothing where nothing is. */
export function object(field, why) {
  const holder = field.closest("label") ?? field.parentElement;
  let said = holder.querySelector(".why");
  if (!why) {
    field.removeAttribute("aria-invalid");
    said?.remove();
    return;
  }
  field.setAttribute("aria-invalid", "true");
  if (!said) {
    said = document.createElement("span");
    said.className = "why";
    holder.append(said);
  }
  said.textContent = tidy(why);
}

/** Says what the server refuses, and what to do. */
export function refuse(state, error) {
  const title = document.createElement("h2"), text = document.createElement("p");
  state.className = "state refused";
  title.textContent = error.reason ? error.reason : "No answer";
  const fields = (error.fields ?? []).map(({ field, description }) => `${field}: ${description}`);
  const words = error.marked ? "What is wrong, and what would do, stands beside the field." : error.reason ? error.message : `${error.message}. Is the server still running? What is typed stays here.`;
  text.textContent = tidy(fields.length ? fields.join("; ") : words);
  state.replaceChildren(title, text);
}

export function clear(state) {
  state.className = "state";
  state.replaceChildren();
}

/** A fact in a box: its value, large, and what it is. */
export function fact(value, name, how = "", key = "") {
  const box = document.createElement("div"), big = document.createElement("b"), small = document.createElement("span");
  box.className = `fact ${how}`;
  big.textContent = value;
  small.textContent = name;
  if (key) {
    const line = document.createElement("i");
    line.className = "key";
    line.style.borderColor = key;
    small.prepend(line);
  }
  box.append(big, small);
  return box;
}

/** A table under a heading that folds. */
export function table(title, head, rows, open = false) {
  const details = document.createElement("details"), summary = document.createElement("summary");
  const scroll = document.createElement("div"), table = document.createElement("table");
  details.open = open;
  summary.textContent = title;
  scroll.className = "scroll";
  table.className = "figures";
  const line = (cells, kind) => {
    const row = document.createElement("tr");
    for (const cell of cells) {
      const place = document.createElement(kind);
      place.textContent = cell;
      row.append(place);
    }
    return row;
  };
  const top = document.createElement("thead"), body = document.createElement("tbody");
  top.append(line(head, "th"));
  body.append(...rows.map((row) => line(row, "td")));
  table.append(top, body);
  scroll.append(table);
  details.append(summary, scroll);
  return details;
}

/** Hands a text over as a file. */
export function save(name, type, text) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
