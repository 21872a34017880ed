// The page of a machine: what is dragged is asked for, what is answered is drawn by moving.js, which reports have too.
import * as faster from "./faster.js";
import { Link } from "./link.js";
import { $, connection, copies, exports, leftOut, say, themed } from "./tools.js";
import { capital, digits, shown, typedNumber, velocity } from "./words.js";

const RESTS = 140; // [ms] without a change: the slider rests
const data = JSON.parse($("data").textContent), parameters = data.parameters;
if (location.search) history.replaceState(null, "", location.pathname + location.hash); // the token is a cookie now, and no part of a link
let values = fromHash(), resting = 0, saving = 0, show = null;

const link = new Link(take, connection);

// ---- the numbers in the address ----
function fromHash() {
  const found = {};
  const takes = (name, text) => Object.hasOwn(parameters, name) && text.trim() !== "" && Number.isFinite(Number(text));
  for (const [name, text] of new URLSearchParams(location.hash.slice(1))) if (takes(name, text)) found[name] = Number(text);
  leftOut(takes);
  return found;
}
const toHash = () => (Object.keys(values).length ? `#${new URLSearchParams(Object.entries(values).map(([name, value]) => [name, String(value)]))}` : location.pathname);
const value = (name) => values[name] ?? parameters[name].default;
const now = () => Object.fromEntries(Object.keys(parameters).map((name) => [name, value(name)]));

// ---- asking ----
function changed() {
  link.ask("curves", { machine: values, fine: false });
  controls();
  if ($("faster")) faster.changed(now());
  clearTimeout(resting);
  resting = setTimeout(() => link.ask("curves", { machine: values, fine: true }), RESTS);
  clearTimeout(saving);
  saving = setTimeout(() => history.replaceState(null, "", toHash()), 250);
}

function set(name, to) {
  if (to === parameters[name].default) delete values[name];
  else values[name] = to;
  changed();
}

// ---- answers ----
function take({ header }) {
  if (header.channel === "faster") return faster.show(header);
  if (header.kind === "problems") return say(header.problems.join("; "));
  if (header.waits) say(header.picture ? `This first picture is from a slower, less exact solver. ${capital(header.waits)}` : header.waits, "busy");
  else say(header.status === "finished" ? "" : header.status);
  if (!header.picture) return;
  show ? show(header.picture) : (show = moving($("moving"), header.picture)); // eslint-disable-line no-undef
  means(header.mean_velocity, header.speeds);
  servo(header.picture);
  if (header.fine) numbers(header);
  document.documentElement.dataset.drawn = `${header.id}${header.fine && !header.waits ? " fine" : ""}`;
}

const cell = (kind, text) => Object.assign(document.createElement(kind), { textContent: text });
function line(cells, head = false) {
  const row = document.createElement("tr");
  row.append(...cells.map((text, i) => Object.assign(cell(head || i === 0 ? "th" : "td", text), head ? { scope: "col" } : i === 0 ? { scope: "row" } : {})));
  return row;
}

// The last error and the largest torque of a machine that turns.
function servo(picture) {
  const last = picture.traces.find((trace) => trace.name === "error")?.curves ?? [], torque = picture.traces.find((trace) => trace.name === "torque")?.curves[0];
  const most = torque && Math.max(...torque[1].map(Math.abs));
  const tiles = [...last.map(([name, y]) => [`error at the end${last.length > 1 ? ` of ${name}` : ""}`, `${digits(y.at(-1))} rad`]), ...(torque ? [["largest torque applied", `${digits(most)} N m`]] : [])];
  $("means").prepend(...tiles.map(([name, text]) => tile(name, text)));
}

function tile(name, text) {
  const box = Object.assign(document.createElement("div"), { className: "chief" });
  box.append(cell("dt", name), cell("dd", text));
  return box;
}

// Mean velocities: bodies that stay together have one.
function means(found, units) {
  const texts = Object.entries(found).map(([name, v]) => [name, units[name] === "m/s" ? velocity(v) : `${digits(Math.abs(v) < 1e-12 ? 0 : v)} ${units[name]}`]), one = new Set(texts.map(([, text]) => text)).size === 1;
  $("means").replaceChildren(...(one ? [["mean velocity", texts[0][1]]] : texts.map(([name, text]) => [`mean velocity of ${name}`, text])).map(([name, text]) => tile(name, text)));
}

function numbers({ facts, tables, notes }) {
  $("facts").replaceChildren(...facts.map((fact) => line(fact)));
  $("tables").replaceChildren(...tables.map((t) => {
    const table = document.createElement("table"), scroll = Object.assign(document.createElement("div"), { className: "scroll", tabIndex: 0 });
    scroll.setAttribute("role", "group");
    scroll.setAttribute("aria-label", t.caption);
    table.append(cell("caption", t.caption), line(t.head, true), ...t.rows.map((row) => line(row)));
    scroll.append(table);
    return scroll;
  }));
  $("note-count").textContent = notes.length;
  $("notes").replaceChildren(...notes.map((note) => cell("li", note)));
}

// ---- controls ----
function controls() {
  for (const p of Object.values(parameters)) {
    const slider = $(`p-${p.name}`), typed = $(`n-${p.name}`), now = value(p.name);
    slider.min = Math.min(p.low, now);
    slider.max = Math.max(p.high, now);
    slider.value = now;
    slider.setAttribute("aria-valuetext", shown(p, now));
    if (document.activeElement !== typed) {
      typed.value = String(Number((now * p.factor).toPrecision(6)));
      typed.removeAttribute("aria-invalid");
    }
  }
}
for (const p of Object.values(parameters)) {
  $(`p-${p.name}`).addEventListener("input", (event) => set(p.name, Number(event.target.value)));
  const typed = $(`n-${p.name}`);
  typed.addEventListener("input", () => {
    const number = typedNumber(p, typed.value);
    if (Number.isFinite(number)) {
      typed.removeAttribute("aria-invalid");
      set(p.name, number);
    } else typed.setAttribute("aria-invalid", "true");
  });
  typed.addEventListener("keydown", (event) => { if (event.key === "Enter") typed.blur(); });
  document.querySelector(`[data-reset="${CSS.escape(p.name)}"]`).addEventListener("click", () => set(p.name, p.default));
}
if ($("faster")) {
  const all = Object.values(parameters), drives = all.map((p) => p.name).filter((name) => `.${name}`.includes(".drive."));
  faster.place(all, drives.slice(0, 8));
  faster.listen({
    ask: (wish) => link.ask("faster", { machine: values, ...wish }),
    values: now,
    take(found) { Object.assign(values, found); changed(); },
  });
}
$("reset-all").addEventListener("click", () => { values = {}; changed(); });
addEventListener("hashchange", () => { values = fromHash(); changed(); });

// ---- taking home ----
exports((name) => `machine/${name}?machine=${encodeURIComponent(JSON.stringify(values))}`);
copies($("share"), toHash, () => location.href, "Copy link");

themed(() => {});
changed();
