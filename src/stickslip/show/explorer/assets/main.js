// The page: what is changed is asked for, what is answered is drawn.
import * as controls from "./controls.js";
import * as faster from "./faster.js";
import * as fit from "./fit.js";
import { Link, unpacked } from "./link.js";
import * as map from "./map.js";
import { colour } from "./plane.js";
import * as portraits from "./portraits.js";
import * as record from "./record.js";
import * as robot from "./robot.js";
import { active, defaults, fromHash, parameters, settled, table, takes, toHash, data, withPreset } from "./state.js";
import * as strip from "./strip.js";
import { $, connection, copies, exports, leftOut, say, themed } from "./tools.js";
import * as velocity from "./velocity.js";
import { capital, digits, quantity, scene, spoken, unrepeated, velocity as spelt } from "./words.js";

const RESTS = 140; // [ms] without a change: the slider rests
const APART = 0.02; // relative difference of the frequencies of a record and of the drive from which on it is not laid over the curves
if (location.search) history.replaceState(null, "", location.pathname + location.hash); // the token is a cookie now, and no part of a link
let state = fromHash(location.hash), resting = 0, saving = 0, dropped = null, last = null, keys = {}, heard = "", exponent = null;

const link = new Link(take, connection);

// ---- going back, and two settings side by side ----
const past = [JSON.stringify(state)];
let pinned = null; // what was pinned: its curve and what its tiles said

function remember() {
  const now = JSON.stringify(state);
  if (now !== past.at(-1)) past.push(now);
  past.splice(0, past.length - 100);
  $("undo").disabled = past.length < 2;
}

function undo() {
  if (JSON.stringify(state) === past.at(-1) && past.length > 1) past.pop();
  state = JSON.parse(past.at(-1));
  $("preset").value = "";
  $("undo").disabled = past.length < 2;
  changed();
}
$("undo").addEventListener("click", undo);
addEventListener("keydown", (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key === "z" && !event.shiftKey && event.target.type !== "text" && !$("undo").disabled) { event.preventDefault(); undo(); }
});

const tiles = () => [...document.querySelectorAll("[data-quantity]")];
$("pin").addEventListener("click", () => {
  const curve = last?.curves[0];
  pinned = pinned || !curve ? null : { ...curve, label: `pinned ${curve.label}` };
  for (const out of tiles()) pinned ? out.parentElement.setAttribute("data-pinned", out.value) : out.parentElement.removeAttribute("data-pinned");
  $("pin").textContent = pinned ? "Unpin" : "Pin";
  $("pin").setAttribute("aria-pressed", String(Boolean(pinned)));
  draw();
});

// ---- asking ----
function changed(name = null) {
  heard = "";
  if (name !== null && name !== state.vary && active(state).includes(name)) state.vary = name;
  settled(state);
  link.ask("curves", { state: table(state), fine: false }); // first of all: the rest is done while the answer is computed
  controls.show(state);
  markStory();
  options();
  faster.place(active(state).map((name) => parameters[name]), data.choices.drive[state.drive].parameters);
  faster.changed(state.values);
  frequencies();
  map.place(state);
  strip.place(state);
  clearTimeout(resting);
  resting = setTimeout(rest, RESTS);
  clearTimeout(saving);
  saving = setTimeout(() => history.replaceState(null, "", toHash(state)), 250);
}

// The slider rests: longer runs, and what lies around them.
function rest() {
  remember();
  link.ask("curves", { state: table(state), fine: true });
  around("map", map.axesOf(state));
  around("strip", strip.axesOf(state));
}

// A map or a strip, if it is not the one that is there: it does not depend on the parameters along its axes.
function around(channel, axes) {
  const asked = table({ ...state, also: [] });
  const rest = { ...asked, values: { ...asked.values } };
  axes.forEach((axis) => delete rest.values[axis.name]);
  const key = JSON.stringify([rest, axes]);
  if (keys[channel] === key) return;
  keys[channel] = key;
  link.ask(channel, { state: asked, axes });
}

// ---- answers ----
const provisional = (law) => law.waits && !law.solved; // by a slower solver, until its kernel is ready

function take({ header, arrays }) {
  if (header.channel === "map") return map.show({ header, arrays });
  if (header.channel === "strip") return strip.show({ header, arrays });
  if (header.channel === "exponent") { exponent = header; return motionInWords(); }
  if (header.channel === "faster") return faster.show(header);
  if (header.kind === "problems") return say(header.problems.join("; "));
  const waiting = header.laws.find((law) => law.waits), drawn = (law) => `${law.name}.t` in arrays;
  if (waiting) say(`${header.laws.some((law) => provisional(law) && drawn(law)) ? "This first picture is from a slower, less exact solver. " : ""}${capital(waiting.waits)}`, "busy");
  else say(header.fine ? heard : "", "wait");
  last = { header, curves: header.laws.filter(drawn).map((law) => curve(header, law, arrays)), waiting: header.laws.filter((law) => !drawn(law)) };
  draw();
  if (header.figures) figures(header.figures, header.fine && !waiting);
  $("results").toggleAttribute("data-stale", !header.figures || header.laws.some((law) => law.name === state.law && provisional(law)));
  if (header.python) $("python").textContent = header.python;
  document.documentElement.dataset.drawn = `${header.id}${header.fine && !waiting ? " fine" : ""}`;
}

function curve(header, law, arrays) {
  const own = Object.fromEntries(Object.entries(arrays).filter(([name]) => name.startsWith(law.name + ".")).map(([name, column]) => [name.slice(law.name.length + 1), column]));
  return { ...own, ...velocity.look(header.laws.indexOf(law)), name: law.name, label: provisional(law) ? `${law.label} (first picture)` : law.label, mean: law.mean_velocity, shown: header.shown };
}

function draw() {
  if (!last) return;
  const { header, curves } = last, waiting = last.waiting.map((law) => ({ ...velocity.look(header.laws.indexOf(law)), waits: `${law.label}: preparing …` }));
  const extra = dropped?.v && curves.length ? measured(header, curves[0]) : [];
  const beside = pinned && curves.length ? [{ ...pinned, colour: colour("soft"), dash: [9, 2] }] : [];
  velocity.draw([...curves, ...beside, ...extra], waiting, header.shown * header.period);
  if (curves.length) portraits.draw([...curves, ...beside], header.samples, header.once);
  if (curves[0]?.name === state.law) robot.show(curves[0], state.track === "level" ? 0 : state.values.tilt_deg);
}

function measured(header, main) {
  const own = dropped.frequency, apart = own && [1, 2].every((n) => Math.abs(n * own * header.period - 1) > APART); // 2: period two
  if (apart) return []; // the page says so above the chart
  const v = record.fitted(dropped, main, header.period, header.samples);
  if (!v) {
    say(`the record is shorter than one drive period of ${digits(1e3 * header.period)} ms`);
    return [];
  }
  const t = Float32Array.from(v, (_, i) => (i * header.period) / header.samples);
  return [{ t, v, label: dropped.name, mean: dropped.mean, ...velocity.look(0), dash: [1, 2], colour: getComputedStyle(document.documentElement).getPropertyValue("--record").trim() }];
}

// The exponent of this robot, once.
function askExponent() {
  const asked = table({ ...state, also: [] }), key = JSON.stringify(asked);
  if (keys.exponent === key) return;
  keys.exponent = key;
  exponent = null;
  link.ask("exponent", { state: asked });
}

// The motion as a sentence; of one that has not repeated only after a long run.
function motionInWords(fine = true) {
  const f = last?.header.figures;
  if (!f) return;
  const repeats = f.period_number || !fine || f.steadiness === "not settled";
  $("words").textContent = repeats ? spoken(f.pattern, f.period_number, f.mean_velocity, state.track === "level" ? 0 : state.values.tilt_deg) : unrepeated(f.periods, f.mean_velocity, exponent);
}

function figures(f, fine) {
  const put = (name, text) => { const out = document.querySelector(`[data-quantity="${name}"]`); if (out.value !== text) out.value = text; };
  put("mean_velocity", spelt(f.mean_velocity));
  put("motion_type", f.motion_type);
  $("pattern").textContent = $("pattern").title = f.pattern.replaceAll("-", "−");
  $("intro").textContent = scene(state, last.header, last.header.laws.map((law) => law.label));
  if (fine && !f.period_number) askExponent();
  motionInWords(fine);
  put("margin", Number.isFinite(f.margin) ? digits(f.margin, 3) : "none");
  put("stick_fraction", `${digits(100 * f.stick_fraction, 3)} %`);
  put("period", f.period_number ? String(f.period_number) : fine ? `none in ${f.periods}` : "not yet");
  put("power", quantity(f.power, "W"));
  if (!fine) return;
  $("note-count").textContent = f.notes.length;
  $("notes").replaceChildren(...f.notes.map((note) => Object.assign(document.createElement("li"), { textContent: note })));
  if (f.status !== "finished") say(f.status);
  else if (f.steadiness === "not settled") say("the motion has not settled: the mean velocity is not the steady one yet, see the notes", "wait");
}

// ---- changing ----
controls.listen({
  change(name, value) { state.values[name] = value; $("preset").value = ""; changed(name); },
  choose(kind, value) { state[kind] = value; state.also = state.also.filter((law) => law !== state.law); $("preset").value = ""; changed(); },
  compare(laws) { state.also = laws.filter((law) => law !== state.law).slice(0, 4); changed(); },
  refuse: say,
});
function choosePreset(name) {
  state = { ...withPreset(name), map: { ...state.map, spans: null } };
  forgetRecord(); // it was measured on another robot
  changed();
}
$("preset").addEventListener("change", (event) => { if (event.target.value) choosePreset(event.target.value); });
for (const story of document.querySelectorAll("[data-story]")) story.addEventListener("click", () => { $("preset").value = ""; choosePreset(story.dataset.story); });

// The story whose numbers are on the page.
function markStory() {
  const now = JSON.stringify(table(state));
  for (const story of document.querySelectorAll("[data-story]")) story.setAttribute("aria-pressed", String(JSON.stringify(table(withPreset(story.dataset.story))) === now));
}
$("reset-all").addEventListener("click", () => { state = defaults(); $("preset").value = ""; changed(); });
addEventListener("hashchange", () => { state = fromHash(location.hash); leftOut(takes); changed(); });

map.listen({
  go(at) { [state.map.x, state.map.y].forEach((name, i) => { state.values[name] = Math.max(parameters[name].least, Math.min(parameters[name].most, at[i])); }); $("preset").value = ""; changed(); },
  zoom(spans) { state.map.spans = spans; changed(); },
});
faster.listen({
  ask: (wish) => link.ask("faster", { state: table({ ...state, also: [] }), ...wish }),
  values: () => state.values,
  take(values) { Object.assign(state.values, values); $("preset").value = ""; changed(); },
});
strip.listen((name, value) => { state.values[name] = value; $("preset").value = ""; changed(); });
$("map-shows").addEventListener("change", (event) => { state.map.shows = event.target.value; changed(); });
for (const axis of ["x", "y"]) $(`map-${axis}`).addEventListener("change", (event) => {
  const other = axis === "x" ? "y" : "x";
  if (event.target.value === state.map[other]) state.map[other] = state.map[axis];
  state.map[axis] = event.target.value;
  state.map.spans = null;
  changed();
});
$("map-whole").addEventListener("click", () => { state.map.spans = null; changed(); });
$("vary").addEventListener("change", (event) => { state.vary = event.target.value; changed(); });

// The lists of parameters for the axes.
function options() {
  const names = active(state);
  for (const [id, chosen] of [["map-x", state.map.x], ["map-y", state.map.y], ["vary", state.vary]]) {
    const list = $(id), wanted = names.join();
    if (list.dataset.names !== wanted) {
      list.replaceChildren(...names.map((name) => new Option(`${parameters[name].symbol} · ${parameters[name].label}`, name)));
      list.dataset.names = wanted;
    }
    list.value = chosen;
  }
  $("map-shows").value = state.map.shows;
}

$("zoom-in").addEventListener("click", () => velocity.zoom(0.5));
$("zoom-out").addEventListener("click", () => velocity.zoom(2));
$("zoom-all").addEventListener("click", () => velocity.zoom(0));

// ---- a record ----
async function load(files) {
  if (!files.length) return;
  const { fits, beside } = await fit.offer(files), file = files[0];
  if (!beside) { // a log of another machine: only its friction is of interest
    forgetRecord();
    say("");
    return $("fit").scrollIntoView({ block: "start" });
  }
  try {
    dropped = await record.opened(file);
    $("record-off").hidden = $("record-drive").hidden = false;
    $("record-fit").hidden = !fits;
    heard = dropped.notes.join("; ");
    say(heard, "wait");
    frequencies();
    draw();
  } catch (error) {
    if (fits) $("fit").scrollIntoView({ block: "start" });
    else say(`${file.name}: ${error.message}`);
  }
}
function forgetRecord() {
  dropped = null;
  $("record").value = "";
  $("record-off").hidden = $("record-drive").hidden = $("record-fit").hidden = true;
  frequencies();
  draw();
}
function frequencies() {
  fit.frequencies(dropped, state.values.omega, parameters.omega, (omega) => { state.values.omega = omega; $("preset").value = ""; changed(); });
}
$("record-fit").addEventListener("click", () => $("fit").scrollIntoView({ block: "start" }));
fit.listen(() => {
  if (state.drive !== "harmonic") return null;
  const { amplitude, tilt_deg, body_mass, inner_mass } = state.values;
  const numbers = { amplitude, tilt_deg: state.track === "level" ? 0 : tilt_deg, body_mass, inner_mass };
  return { numbers, asymmetric: state.contact === "anisotropic" };
});
$("record").addEventListener("change", (event) => load([...event.target.files]));
$("record-off").addEventListener("click", forgetRecord);
$("record-drive").addEventListener("click", async () => {
  try {
    const { amplitude, omega, shape, notes } = await record.drive(dropped.file);
    Object.assign(state, { drive: "recorded", shape });
    Object.assign(state.values, { amplitude, omega });
    $("preset").value = "";
    changed();
    heard = notes.join("; ");
  } catch (error) {
    say(`${dropped?.name ?? "record"}: ${error.message}`);
  }
});
addEventListener("dragover", (event) => { event.preventDefault(); $("velocity-panel").classList.add("dropping"); });
addEventListener("dragleave", (event) => { if (!event.relatedTarget) $("velocity-panel").classList.remove("dropping"); });
addEventListener("drop", (event) => {
  event.preventDefault();
  $("velocity-panel").classList.remove("dropping");
  load([...event.dataTransfer.files]);
});

// ---- taking home ----
exports((name) => `export/${name}?state=${encodeURIComponent(JSON.stringify(table(state)))}`);
const hash = () => toHash(state);
copies($("share"), hash, () => location.href, "Copy link");
copies($("copy-code"), hash, () => $("python").textContent, "Copy");

// ---- light and dark ----
themed(() => {
  velocity.restyle();
  if (last) last.curves.forEach((c, i) => Object.assign(c, velocity.look(last.header.laws.findIndex((law) => law.name === c.name) ?? i)));
  draw();
  map.forget();
  strip.restyle();
  robot.frame();
});
leftOut(takes);
const picture = atob($("picture").textContent); // of the numbers that the page has at first
if (picture && JSON.stringify(table(state)) === JSON.stringify(table(defaults()))) take(unpacked(Uint8Array.from(picture, (c) => c.charCodeAt(0)).buffer));
changed();
