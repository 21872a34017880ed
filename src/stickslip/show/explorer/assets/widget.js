// The page part of ss.widget: sliders on the left, curves on the right. Text goes in as text, never as HTML, and nothing is loaded.
const COLOURS = ["#0072b2", "#c04f00", "#00805c", "#a8447f", "#6a51a3", "#56b4e9"];  // Okabe and Ito (2008), darkened
const SVG = "http://www.w3.org/2000/svg";
const WIDTH = 560, HEIGHT = 190, LEFT = 58, RIGHT = 8, TOP = 20, BOTTOM = 34;

function element(name, attributes = {}, text = "", space = null) {
  const made = space ? document.createElementNS(space, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
}

const drawn = (name, attributes, text) => element(name, attributes, text, SVG);
const readable = (value) => String(Number(value.toPrecision(6)));

function ticks(low, high) {
  const rough = (high - low) / 4, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((k) => k * power).find((s) => s >= rough);
  const found = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step; k++) found.push(k * step);
  return found;
}

function chart(title, times, unit, curves) {
  const svg = drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": title });
  const all = curves.flatMap((curve) => curve.values).filter(Number.isFinite);
  let low = Math.min(...all, 0), high = Math.max(...all, 0);
  if (!(high > low)) [low, high] = [-1, 1];
  const room = 0.05 * (high - low);
  const first = times[0], last = times[times.length - 1] || 1;
  const x = (t) => LEFT + ((t - first) / (last - first)) * (WIDTH - LEFT - RIGHT);
  const y = (v) => HEIGHT - BOTTOM - ((v - low + room) / (high - low + 2 * room)) * (HEIGHT - TOP - BOTTOM);
  svg.append(drawn("text", { x: LEFT, y: 12 }, title));
  for (const v of ticks(low, high)) {
    svg.append(drawn("path", { class: "axis", d: `M${LEFT} ${y(v)}H${WIDTH - RIGHT}` }));
    svg.append(drawn("text", { x: LEFT - 6, y: y(v) + 4, "text-anchor": "end" }, readable(v)));
  }
  for (const t of ticks(first, last)) svg.append(drawn("text", { x: x(t), y: HEIGHT - BOTTOM + 14, "text-anchor": "middle" }, readable(t)));
  svg.append(drawn("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 4, "text-anchor": "middle" }, `time (${unit})`));
  for (const { values, colour } of curves) {
    const points = values.map((v, k) => `${x(times[k]).toFixed(1)} ${y(v).toFixed(1)}`);
    svg.append(drawn("path", { class: "curve", d: `M${points.join("L")}`, fill: "none", stroke: colour, "stroke-width": 1.6 }));
  }
  return svg;
}

function curves(answer, column) {
  return answer.picture.bodies
    .map((body, k) => ({ name: body.name, values: body[column], colour: COLOURS[k % COLOURS.length] }))
    .filter((curve) => Array.isArray(curve.values));
}

function show(answer, said, charts) {
  said.toggleAttribute("data-bad", Boolean(answer.error));
  if (answer.error) {
    said.textContent = answer.error;
    return;
  }
  const { t, unit, lengths, speeds } = answer.picture, moving = curves(answer, "x");
  const inUnits = (v, per) => (per === "m/s" ? `${readable(1e3 * v)} mm/s` : `${readable(v)} ${per}`);
  const means = Object.entries(answer.mean_velocity).map(([name, v]) => `${name} ${inUnits(v, answer.speeds[name] ?? "m/s")}`);
  said.textContent = `mean velocity: ${means.join(", ")}; ${answer.status}${answer.fine ? "" : " …"}`;
  const legend = element("div", { class: "legend" }), facts = element("dl");
  for (const [name, value] of answer.facts ?? []) facts.append(element("dt", {}, name), element("dd", {}, value));
  for (const { name, colour } of moving) legend.append(element("span", { style: `--c: ${colour}` }, name));
  charts.replaceChildren(chart(`velocity (${speeds})`, t, unit, curves(answer, "v")), chart(`displacement (${lengths})`, t, unit, moving), legend, facts);
}

function slider(described, moved) {
  const label = element("label"), name = element("span", {}, `${described.label} `);
  name.append(element("i", {}, described.symbol));
  const range = element("input", { type: "range", min: described.low, max: described.high, step: "any", "aria-label": described.label });
  const typed = element("input", { type: "text", inputmode: "decimal", "aria-label": `${described.label}, value` });
  const put = (value) => {
    range.value = value;
    typed.value = readable(value);
    typed.setAttribute("aria-invalid", "false");
  };
  put(described.value);
  range.addEventListener("input", () => { typed.value = readable(Number(range.value)); moved(described, Number(range.value), false); });
  range.addEventListener("change", () => moved(described, Number(range.value), true));
  typed.addEventListener("change", () => {
    const value = Number(typed.value.trim().replace(",", "."));
    const good = typed.value.trim() !== "" && Number.isFinite(value);
    typed.setAttribute("aria-invalid", String(!good));
    if (!good) return;
    range.value = value;
    moved(described, value, true);
  });
  label.append(name, typed, element("span", {}, described.unit), range);
  return { label, put };
}

function render({ model, el }) {
  const root = element("div", { class: "stickslip-widget" }), numbers = element("div", { class: "numbers" });
  const right = element("div"), said = element("p", { class: "said", role: "status" }), charts = element("div");
  const view = Math.random().toString(36).slice(2);
  let wanted = null, waiting = false, asked = 0;

  // One question at a time: while the kernel computes, only the newest is kept.
  const ask = () => {
    if (waiting || wanted === null) return;
    waiting = true;
    model.set("state", { ...wanted, id: `${view} ${++asked}` });
    wanted = null;
    model.save_changes();
  };
  const moved = (described, value, fine) => {
    const values = { ...(wanted ?? model.get("state")).values, [described.name]: value / described.factor };
    wanted = { values, fine };
    ask();
  };
  const sliders = model.get("sliders").map((described) => ({ described, ...slider(described, moved) }));
  const place = () => {
    const { values } = model.get("state");
    for (const { described, put } of sliders) put(described.name in values ? values[described.name] * described.factor : described.value);
  };
  const answered = () => {
    const answer = model.get("answer");
    if (answer.id === `${view} ${asked}`) waiting = false;
    else place();  // moved from Python, or in another view of the same widget
    show(answer, said, charts);
    ask();
  };
  sliders.forEach(({ described, label }, k) => {
    if (described.part && described.part !== sliders[k - 1]?.described.part) numbers.append(element("h5", {}, described.part));
    numbers.append(label);
  });
  right.append(element("h4", {}, model.get("title")), said, charts);
  root.append(numbers, right);
  el.append(root);
  model.on("change:answer", answered);
  place();
  show(model.get("answer"), said, charts);
  return () => model.off("change:answer", answered);
}

export default { render };
