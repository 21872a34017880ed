// Make it faster: the best places of the sliders that are ticked, what they cost, and the way there and back.
import { $ } from "./tools.js";
import { digits, quantity, shown } from "./words.js";

const MOST = 8; // sliders at once, as the server has it
const ticked = (id) => [...document.querySelectorAll(`#${id} input:checked`)].map((box) => box.value);
let known = {}, offered = null, before = null;

// Tell of what is asked and taken: `ask(body)`, `values()` of now, `take(values)`.
export function listen({ ask, values, take }) {
  $("faster-find").addEventListener("click", () => {
    forget();
    tell("searching …", "busy");
    ask({ sliders: ticked("faster-sliders"), keep: ticked("faster-kept") });
  });
  $("faster-take").addEventListener("click", () => {
    before = Object.fromEntries(Object.keys(offered).map((name) => [name, values()[name]]));
    take(offered);
    $("faster-take").hidden = true;
    $("faster-back").hidden = false;
  });
  $("faster-back").addEventListener("click", () => { take(before); forget(); });
  $("faster-sliders").addEventListener("change", room);
}

// The sliders that there are, and those that are ticked at first.
export function place(given, first) {
  const page = [...document.querySelectorAll("[data-parameter]")].map((row) => row.dataset.parameter);
  const parameters = [...given].sort((a, b) => page.indexOf(a.name) - page.indexOf(b.name));
  const names = parameters.map((p) => p.name).join();
  if ($("faster-sliders").dataset.names === names) return;
  const old = new Set(ticked("faster-sliders")), kept = [...old].filter((name) => parameters.some((p) => p.name === name));
  known = Object.fromEntries(parameters.map((p) => [p.name, p]));
  $("faster-sliders").dataset.names = names;
  $("faster-sliders").replaceChildren($("faster-sliders").firstElementChild, ...parameters.map((p) => box(p, (kept.length ? kept : first).includes(p.name))));
  room();
}

function box(p, checked) {
  const label = document.createElement("label"), input = Object.assign(document.createElement("input"), { type: "checkbox", value: p.name, name: `faster-${p.name}`, checked });
  label.append(input, ` ${p.symbol ? apart(p, "label") : p.name}`);
  return label;
}

// A word of a number; with the part of the machine that it is of, if numbers of several parts share the word.
function apart(p, word) {
  if (Object.values(known).filter((other) => other[word] === p[word]).length === 1) return p[word];
  const part = document.querySelector(`[data-parameter="${CSS.escape(p.name)}"]`).closest("fieldset").querySelector("legend").textContent;
  return `${p[word]}, ${part}`;
}

function room() {
  const full = ticked("faster-sliders").length >= MOST;
  for (const input of document.querySelectorAll("#faster-sliders input")) input.disabled = full && !input.checked;
}

// Numbers were changed by hand: what was found is of others.
export function changed(values) {
  const same = (given) => given && Object.entries(given).every(([name, value]) => values[name] === value);
  if (before && !same(offered)) forget();
  else if (!before && offered && $("faster-take").hidden === false) forget();
}

function forget() {
  offered = before = null;
  $("faster-take").hidden = $("faster-back").hidden = $("faster-found").hidden = true;
  tell("");
}

function tell(sentence, kind = "wait") {
  $("faster-said").textContent = sentence;
  $("faster-said").dataset.state = kind;
}

export function show(header) {
  if (header.kind === "problems") return tell(header.problems.join("; "), "bad");
  if (header.waits) return tell(header.waits, "busy");
  const moved = Object.entries(header.values).map(([name, value]) => `${known[name].symbol ? apart(known[name], "symbol") : name} = ${shown(known[name], value)}${header.ends.includes(name) ? " (the slider's end)" : ""}`);
  tell([`${moved.join(", ")}: the best of ${header.tried} that were tried`, ...header.notes].join("; "));
  $("faster-rows").replaceChildren(...header.rows.map(line));
  offered = header.values;
  $("faster-found").hidden = false;
  $("faster-take").hidden = header.rows.every((row) => row.before === row.after);
}

function line(row) {
  const amount = (x) => (row.unit ? quantity(x, row.unit) : digits(x));
  const cells = [row.name.replaceAll("_", " "), amount(row.before), amount(row.after), change(row)];
  const made = document.createElement("tr");
  made.append(...cells.map((text, i) => Object.assign(document.createElement(i ? "td" : "th"), { textContent: text }, i ? {} : { scope: "row" })));
  return made;
}

function change({ before: a, after: b }) {
  const percent = 100 * (b / a - 1);
  return Number.isFinite(percent) ? `${percent > 0 ? "+" : ""}${digits(Math.abs(percent) < 1e-3 ? 0 : percent, 3)} %` : "–";
}
