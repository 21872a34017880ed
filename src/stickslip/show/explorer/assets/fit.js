// Friction from one log or several: what their columns are taken for, as fields; their fit, which can be stopped; and what came out.
import { unpacked } from "./link.js";
import { $ } from "./tools.js";

const LARGEST = 20e6;
const made = (tag, text = "", more = {}) => Object.assign(document.createElement(tag), { textContent: text }, more);
const nothing = () => ({ units: {}, roles: {}, numbers: {}, machine: "", law: "", asymmetric: false });
let files = [], choices = nothing(), planning = 0, fitting = null, result = null;

export function listen() {
  $("fit-file").addEventListener("change", (event) => offer([...event.target.files]));
  $("fit-start").addEventListener("click", start);
  $("fit-stop").addEventListener("click", () => fitting?.abort());
  $("fit-machine").addEventListener("change", (event) => { choices.machine = event.target.value; choices.law = ""; choices.numbers = {}; plan(); });
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
    say(header.problem, "wait");
    return { fits: header.machines.length > 0, beside: header.beside };
  } catch (error) {
    if (number === planning) say(error.message);
    return { fits: false, beside: true }; // reading it as a velocity says what is wrong
  }
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
  $("fit-columns").replaceChildren(...header.channels.map((c) => column(c, header.roles)));
  const words = Object.fromEntries(header.machines), typed = choices.machine === header.machine;
  fill("fit-machine", header.machines.map(([name]) => [name, name]), header.machine);
  $("fit-machine-why").textContent = header.machine ? `${words[header.machine]}${typed ? "" : `; proposed because of ${header.why}`}` : "";
  fill("fit-law", [["", "compare several"], ...header.laws.map((name) => [name, name])], choices.law);
  $("fit-numbers").replaceChildren(...header.numbers.map(number));
  $("fit-notes").replaceChildren(...header.notes.slice(0, 8).map((note) => made("li", note)));
  $("fit-start").disabled = !header.machines.length;
  $("fit-offer").hidden = false;
}

function fill(id, options, chosen) {
  $(id).replaceChildren(...options.map(([value, text]) => new Option(text, value, false, value === chosen)));
  $(id).disabled = !options.length;
}

function column(c, roles) {
  const row = document.createElement("div");
  if (c.suggested) row.dataset.state = "check";
  const unit = made("input", "", { type: "text", value: c.unit, autocomplete: "off", placeholder: "unit" });
  unit.setAttribute("aria-label", `unit of ${c.name}`);
  unit.addEventListener("change", () => { choices.units = { ...choices.units, [c.name]: unit.value.trim() }; if (!unit.value.trim()) delete choices.units[c.name]; plan(); });
  const span = c.range ? `${short(c.range[0])} to ${short(c.range[1])}; ` : "";
  if (c.role === "time") return row.append(made("b", c.name), made("span", "time"), unit, made("small", c.why)), row;
  const role = document.createElement("select");
  role.setAttribute("aria-label", `role of ${c.name}`);
  role.append(...roles.map((name) => new Option(name === "unused" ? "left out" : name, name, false, name === c.role)));
  role.addEventListener("change", () => { choices.roles = { ...choices.roles, [c.name]: role.value }; plan(); });
  row.append(made("b", c.name), role, unit, made("small", `${span}${c.role === "unused" ? "not used" : c.why}`));
  return row;
}

const short = (x) => Number(x.toPrecision(3)).toString();

function number(n) {
  const label = made("label", `${n.name.replaceAll("_", " ")}${n.needed ? " (needed)" : ""}`), input = made("input", "", { type: "text", inputMode: "decimal", autocomplete: "off" });
  input.value = [n.typed ?? ""].flat().join("; ");
  input.placeholder = n.needed ? `such as ${n.example}` : n.assumed;
  if (n.needed && n.typed === null) input.setAttribute("aria-invalid", "true");
  input.addEventListener("change", () => {
    const text = input.value.trim().replaceAll(",", "."), values = text.split(";").map((part) => (part.trim() ? Number(part) : NaN));
    if (text && !values.every(Number.isFinite)) { input.setAttribute("aria-invalid", "true"); return say(`${n.name}: ${input.value} is not a number`); }
    if (text) choices.numbers = { ...choices.numbers, [n.name]: values.length > 1 ? values : values[0] };
    else delete choices.numbers[n.name];
    plan();
  });
  label.append(input, made("small", `${n.typed === null && n.why ? `${n.words}: ${n.why}` : n.words}${n.each ? "; one for all files, or one for each, such as 1; 2" : ""}`));
  return label;
}

// ---- the fit ----
async function start() {
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
  const ranking = header.ranking.map((r) => `${r.law}: ΔAICc ${r.aicc}${r.faults ? ", its fit has a fault" : ""}`);
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
