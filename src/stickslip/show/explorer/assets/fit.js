// Friction from one log or several: what their columns are taken for, as fields; their fit, which can be stopped; and what came out.
import { unpacked } from "./link.js";
import { $ } from "./tools.js";

const LARGEST = 20e6;
const made = (tag, text = "", more = {}) => Object.assign(document.createElement(tag), { textContent: text }, more);
const nothing = () => ({ units: {}, roles: {}, numbers: {}, machine: "", law: "", asymmetric: false });
let files = [], choices = nothing(), planning = 0, fitting = null, result = null, offered = () => false;
const rows = new Map(), fields = new Map(); // of columns and of numbers, by name: a field stays while others are read again, with what is being typed in it

// `sliders`, where the page has those of a shaken robot, gives the numbers of the robot there [SI], and whether it has a friction for each
// direction; null where its drive is none that a log is fitted with.
export function listen(sliders = () => null) {
  $("fit-sliders").addEventListener("click", () => take(sliders()));
  offered = (header) => header.machine === "robot" && sliders() !== null;
  $("fit-file").addEventListener("change", (event) => offer([...event.target.files]));
  $("fit-start").addEventListener("click", start);
  $("fit-stop").addEventListener("click", () => fitting?.abort());
  $("fit-machine").addEventListener("change", (event) => { choices.machine = event.target.value; choices.law = ""; choices.numbers = {}; fields.clear(); plan(); });
  $("fit-law").addEventListener("change", (event) => { choices.law = event.target.value; stale(); });
  $("fit-asymmetric").addEventListener("change", (event) => { choices.asymmetric = event.target.checked; stale(); });
  $("fit-report").addEventListener("click", save);
  $("fit-copy").addEventListener("click", copy);
}

// Logs: they are read, and what is proposed becomes fields. Whether they can be fitted (where what is missing may be typed), and whether
// the first has a velocity that belongs beside the curves.
export async function offer(given) {
  if (!given.length) return { fits: false, beside: false };
  fitting?.abort();
  files = given;
  choices = nothing();
  rows.clear();
  fields.clear();
  $("fit-asymmetric").checked = false;
  $("fit-name").textContent = files.map((each) => each.name).join(", ");
  $("fit-offer").hidden = true;
  stale();
  return plan();
}

async function plan() {
  const number = ++planning;
  stale();
  say("reading …", "busy");
  try {
    const header = await asked("log");
    if (number !== planning) return { fits: false, beside: false };
    choices.units = header.units;
    show(header);
    say(header.problem + atOnce(header.numbers), "wait");
    return { fits: header.machines.length > 0, beside: header.beside };
  } catch (error) {
    if (number === planning) say(error.message);
    return { fits: false, beside: true }; // reading it as a velocity says what is wrong
  }
}

// How to type all numbers that are missing in one field, where there are several.
function atOnce(numbers) {
  const missing = numbers.filter((n) => n.needed && n.typed === null);
  return missing.length > 1 ? `. One field takes all of them: ${missing.map((n) => `${n.name}=${n.example}`).join(" ")}` : "";
}

async function asked(where, options = {}) {
  if (files.reduce((sum, each) => sum + each.size, 0) > LARGEST) throw new Error("the files are larger than 20 MB; use stickslip fit in a shell");
  const several = files.length > 1 ? { files: files.map((each) => [each.name, each.size]) } : {};
  const address = `${where}/${encodeURIComponent(files[0].name)}?choices=${encodeURIComponent(JSON.stringify({ ...choices, ...several }))}`;
  const reply = await fetch(address, { method: "POST", body: new Blob(files), ...options });
  if (!reply.ok) throw new Error((await reply.text()).trim());
  const { header } = unpacked(await reply.arrayBuffer());
  if (header.kind === "problems") throw new Error(header.problems.join("; "));
  return header;
}

function say(sentence, kind = "bad") {
  $("fit-said").textContent = sentence;
  $("fit-said").dataset.state = kind;
}

// What was shown is of other choices.
function stale() {
  result = null;
  $("fit-result").hidden = true;
}

// ---- the proposal ----
function show(header) {
  place("fit-columns", header.channels.map((c) => kept(rows, c.name, () => column(c.name), (row) => row.tell(c, header.roles))));
  const words = Object.fromEntries(header.machines), typed = choices.machine === header.machine;
  fill("fit-machine", header.machines.map(([name]) => [name, name]), header.machine);
  $("fit-machine-why").textContent = header.machine ? `${words[header.machine]}${typed ? "" : `; proposed because of ${header.why}`}` : "";
  fill("fit-law", [["", "compare several"], ...header.laws.map((name) => [name, name])], choices.law);
  place("fit-numbers", header.numbers.map((n) => kept(fields, n.name, () => number(n.name), (label) => label.tell(n))));
  $("fit-sliders").hidden = !offered(header);
  $("fit-notes").replaceChildren(...header.notes.slice(0, 8).map((note) => made("li", note)));
  $("fit-start").disabled = !header.machines.length;
  $("fit-offer").hidden = false;
}

function fill(id, options, chosen) {
  $(id).replaceChildren(...options.map(([value, text]) => new Option(text, value, false, value === chosen)));
  $(id).disabled = !options.length;
}

// An element that stays, of that name, made where there is none, and told what is known of it now.
function kept(those, name, make, tell) {
  if (!those.has(name)) those.set(name, make());
  tell(those.get(name));
  return those.get(name);
}

// Elements in their place; those that are there already are not moved, which would take the focus from them.
function place(id, elements) {
  const there = [...$(id).children];
  if (there.length !== elements.length || there.some((each, k) => each !== elements[k])) $(id).replaceChildren(...elements);
}

function take(given) {
  if (!given) return say("the drive of the sliders is none that a log is fitted with; type the numbers", "wait");
  $("fit-asymmetric").checked = choices.asymmetric = given.asymmetric;
  fillIn(Object.entries(given.numbers).filter(([name]) => fields.has(name)));
}

// Numbers for fields, each by the name of its own; they are read again.
function fillIn(numbers) {
  for (const [name, value] of numbers) {
    const input = fields.get(name).querySelector("input");
    delete input.dataset.wrong;
    input.value = [value].flat().join("; ");
    choices.numbers = { ...choices.numbers, [name]: value };
  }
  plan();
}

// What is typed into a field: a number, one with its unit, or several, one for each file; undefined if it is none of these.
function numberIn(typed) {
  const text = typed.trim().replaceAll(",", "."), values = text.split(";").map((part) => part.trim()).map((part) => (Number.isFinite(Number(part || NaN)) ? Number(part) : part));
  const sound = values.every((each) => typeof each === "number" || /^[+-]?[\d.]+(e[+-]?\d+)?\s*\S+/i.test(each));
  return sound ? (values.length > 1 ? values : values[0]) : undefined;
}

// Several numbers by their names in one field, as in a shell: "kp=38 resistance=3", "--set kp=38 --set resistance=3".
function namedIn(text) {
  const pairs = [...text.matchAll(/([A-Za-z_]\w*)\s*=\s*(.*?)(?=[\s,;]*(?:--set\s+)?[A-Za-z_]\w*\s*=|[\s,;]*$)/g)];
  return pairs.map(([, name, value]) => [name, fields.has(name) ? numberIn(value) : undefined]);
}

const busy = (input) => input === document.activeElement || input.dataset.wrong !== undefined; // what was typed and cannot be read stays

function column(name) {
  const row = document.createElement("div"), why = made("small"), time = made("span", "time"), role = document.createElement("select");
  const unit = made("input", "", { type: "text", autocomplete: "off", placeholder: "unit" });
  unit.setAttribute("aria-label", `unit of ${name}`);
  unit.addEventListener("change", () => { choices.units = { ...choices.units, [name]: unit.value.trim() }; if (!unit.value.trim()) delete choices.units[name]; plan(); });
  role.setAttribute("aria-label", `role of ${name}`);
  role.addEventListener("change", () => { choices.roles = { ...choices.roles, [name]: role.value }; plan(); });
  row.append(made("b", name), role, unit, why);
  row.tell = (c, roles) => {
    const span = c.range ? `${short(c.range[0])} to ${short(c.range[1])}; ` : "", isTime = c.role === "time";
    if (c.suggested) row.dataset.state = "check"; else delete row.dataset.state;
    if (!busy(unit)) unit.value = c.unit;
    if (row.children[1] !== (isTime ? time : role)) row.children[1].replaceWith(isTime ? time : role);
    if (!isTime) role.replaceChildren(...roles.map((each) => new Option(each === "unused" ? "left out" : each, each, false, each === c.role)));
    why.textContent = isTime ? c.why : `${span}${c.why}`;
  };
  return row;
}

const short = (x) => Number(x.toPrecision(3)).toString();

function number(name) {
  const label = made("label"), title = made("span"), words = made("small"), input = made("input", "", { type: "text", autocomplete: "off" });
  input.addEventListener("change", () => {
    const text = input.value.trim(), many = text.includes("="), numbers = many ? namedIn(text) : [[name, numberIn(text)]], wrong = numbers.find(([, value]) => value === undefined);
    delete input.dataset.wrong;
    if (text && (wrong || !numbers.length)) {
      input.dataset.wrong = "";
      input.setAttribute("aria-invalid", "true");
      return say(!many ? `${name}: ${text} is not a number` : `${wrong && fields.has(wrong[0]) ? `${wrong[0]} is not a number` : `${wrong?.[0] ?? text} is not known`} in ${text}; type for example ${name}=1`);
    }
    if (many) { input.value = ""; return fillIn(numbers); }
    if (text) choices.numbers = { ...choices.numbers, [name]: numbers[0][1] };
    else delete choices.numbers[name];
    plan();
  });
  label.append(title, input, words);
  label.tell = (n) => {
    title.textContent = `${n.name.replaceAll("_", " ")}${n.needed ? " (needed)" : ""}`;
    input.placeholder = n.needed ? `such as ${n.example}` : n.assumed;
    if (!busy(input) && choices.numbers[name] === undefined) input.value = "";
    if (busy(input) ? input.dataset.wrong !== undefined : n.needed && n.typed === null) input.setAttribute("aria-invalid", "true");
    else input.removeAttribute("aria-invalid");
    words.textContent = `${n.typed === null && n.why ? `${n.words}: ${n.why}` : n.words}${n.each ? "; one for all files, or one for each, such as 1; 2" : ""}`;
  };
  return label;
}

// ---- the fit ----
async function start() {
  const wrong = [...fields.values()].map((label) => label.querySelector("[data-wrong]")).find(Boolean);
  if (wrong) return wrong.focus();
  fitting?.abort();
  const own = (fitting = new AbortController()), since = performance.now();
  stale();
  const tick = () => say(`fitting … ${Math.round((performance.now() - since) / 1000)} s; the page stays usable meanwhile`, "busy");
  tick();
  const clock = setInterval(tick, 1000);
  $("fit-stop").hidden = false;
  $("fit-start").disabled = true;
  try {
    const header = await asked("fit", { signal: own.signal });
    if (fitting === own) tell(header);
  } catch (error) {
    if (fitting === own) say(error.name === "AbortError" ? "stopped" : error.message, error.name === "AbortError" ? "wait" : "bad");
  } finally {
    clearInterval(clock);
    if (fitting === own) { fitting = null; $("fit-stop").hidden = true; $("fit-start").disabled = false; }
  }
}

function tell(header) {
  result = header;
  say("");
  $("fit-verdict").textContent = header.verdict;
  $("fit-verdict").dataset.supported = header.supported;
  $("fit-rows").tBodies[0].replaceChildren(...header.rows.map(line));
  $("fit-pictures").replaceChildren(...header.pictures.map(picture));
  $("fit-lists").replaceChildren(...lists(header));
  $("fit-python").textContent = header.python;
  $("fit-result").hidden = false;
  $("fit-result").focus({ preventScroll: true });
  $("fit-verdict").scrollIntoView({ block: "nearest" });
}

function line(row) {
  const tr = document.createElement("tr"), name = made("th", row.name, { scope: "row" });
  if (row.label) name.append(made("small", row.label));
  tr.append(name, made("td", row.lost ? "not determined" : row.stated), made("td", row.lost ? "–" : `${row.low} to ${row.high} ${row.unit}`));
  if (row.lost) tr.children[1].dataset.lost = "";
  return tr;
}

function picture({ heading, svg }) {
  const figure = document.createElement("figure"), image = document.createElement("img");
  image.src = `data:image/svg+xml,${encodeURIComponent(svg)}`;
  image.alt = heading;
  figure.append(made("figcaption", heading), image);
  return figure;
}

function lists(header) {
  const ranking = header.ranking.map((r) => [`${r.law}: ΔAICc ${r.aicc}`, ...r.faults].join("; "));
  const groups = [
    ["Not determined by this record", header.undetermined],
    ["Measure next", header.next],
    ["Both directions", header.symmetry],
    ["Laws that were compared", ranking],
    ["Left open", header.questions.map((text) => text.replace(/^machine="(\w+)"/, "as a $1"))],
    ["What to know about these numbers", header.warnings],
    ["Sensor, and what it costs", header.effects],
    ["Residuals", header.quality],
    ["As given", header.given ? [header.given.replace(/^as given: /, "")] : []],
  ];
  return groups.filter(([, items]) => items.length).flatMap(([title, items]) => {
    const list = document.createElement("ul");
    list.append(...items.map((text) => made("li", text)));
    return [made("h4", title), list];
  });
}

// ---- taking home ----
function save() {
  const address = URL.createObjectURL(new Blob([result.report], { type: "text/html" }));
  Object.assign(document.createElement("a"), { href: address, download: `${files[0].name.replace(/\.[^.]*$/, "")}-friction.html` }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

async function copy() {
  try {
    await navigator.clipboard.writeText(result.python);
    $("fit-copy").textContent = "Copied";
  } catch {
    $("fit-copy").textContent = "Copy it from below";
  }
  setTimeout(() => { $("fit-copy").textContent = "Copy the Python"; }, 1800);
}

// ---- the frequency of a record ----
// Says where a record and the model have different frequencies; `take(omega)` sets that of the model, `limits` are those of its slider.
export function frequencies(record, omega, limits, take) {
  const hertz = record?.frequency, model = omega / (2 * Math.PI), differ = hertz && Math.abs(hertz / model - 1) > 1e-3;
  $("record-frequency").hidden = !differ;
  if (!differ) return;
  const able = 2 * Math.PI * hertz >= limits.least && 2 * Math.PI * hertz <= limits.most;
  $("record-frequency-said").textContent = `${record.name} has ${Number(hertz.toPrecision(5))} Hz, the model ${Number(model.toPrecision(5))} Hz: the record is not of this drive.`;
  $("record-frequency-take").hidden = !able;
  $("record-frequency-take").textContent = `Use ${Number(hertz.toPrecision(5))} Hz for the model`;
  $("record-frequency-take").onclick = () => take(2 * Math.PI * hertz);
}
