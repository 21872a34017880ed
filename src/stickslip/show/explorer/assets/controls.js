// Sliders with typed values, choices, the laws to compare with.
import { active, parameters, span } from "./state.js";
import { shown, typedNumber } from "./words.js";

const row = (name) => document.querySelector(`[data-parameter="${name}"]`);
const slider = (name) => document.getElementById(`p-${name}`);
const typed = (name) => document.getElementById(`n-${name}`);
const CHOICES = ["drive", "track", "contact", "law"];
const text = (p, value) => String(Number((value * p.factor).toPrecision(6)));

// Put a state into the controls.
export function show(state) {
  const used = new Set(active(state));
  for (const kind of CHOICES) document.getElementById(kind).value = state[kind];
  for (const p of Object.values(parameters)) {
    row(p.name).hidden = !used.has(p.name);
    if (used.has(p.name)) set(p, state);
  }
  for (const label of document.querySelectorAll("[data-also]")) {
    const law = label.dataset.also, box = label.querySelector("input");
    label.hidden = law === state.law;
    box.checked = state.also.includes(law);
    box.disabled = !box.checked && state.also.length >= 4;
  }
}

function set(p, state) {
  const value = state.values[p.name], range = slider(p.name), [low, high] = span(p.name, state);
  if (Number(range.min) !== low) range.min = low;
  if (Number(range.max) !== high) range.max = high;
  if (Number(range.value) !== value) range.value = value;
  range.setAttribute("aria-valuetext", shown(p, value));
  const field = typed(p.name);
  if (document.activeElement !== field) {
    field.value = text(p, value);
    field.removeAttribute("aria-invalid");
  }
}

// What a person typed, or null.
function read(p, field) {
  const value = typedNumber(p, field.value);
  return value >= p.least * (1 - 1e-12) - 1e-300 && value <= p.most * (1 + 1e-12) ? Math.min(p.most, Math.max(p.least, value)) : null;
}

// Tell of every change: `change(name, value)` of a number, `choose(kind, value)` of a choice, `compare(laws)`.
export function listen({ change, choose, compare, refuse }) {
  for (const p of Object.values(parameters)) {
    slider(p.name).addEventListener("input", (event) => change(p.name, Number(event.target.value)));
    const field = typed(p.name);
    field.addEventListener("input", () => {
      const value = read(p, field);
      field.toggleAttribute("aria-invalid", false);
      if (value === null) field.setAttribute("aria-invalid", "true");
      else change(p.name, value);
    });
    field.addEventListener("change", () => {
      if (read(p, field) !== null) return;
      const given = field.value || "nothing", wider = `the slider reaches from ${shown(p, p.low)} to ${shown(p, p.high)} and grows with what is typed`;
      refuse(Number.isNaN(typedNumber(p, field.value)) ? `${p.label}: ${given} is not a number; type one such as ${shown(p, p.default)}; ${wider}` : `${p.label}: ${given} is not allowed; allowed is ${shown(p, p.least)} to ${shown(p, p.most)}; ${wider}`);
    });
    field.addEventListener("keydown", (event) => { if (event.key === "Enter") field.blur(); });
    document.querySelector(`[data-reset="${p.name}"]`).addEventListener("click", () => change(p.name, p.default));
  }
  for (const kind of CHOICES) document.getElementById(kind).addEventListener("change", (event) => choose(kind, event.target.value));
  for (const box of document.querySelectorAll("[data-also] input")) {
    box.addEventListener("change", () => compare([...document.querySelectorAll("[data-also] input:checked")].map((b) => b.value)));
  }
}
