// The map over two parameters: click to go there, drag to zoom, or do the same with keys.
import { Plane, colour } from "./plane.js";
import { parameters, span } from "./state.js";
import { axisLabel, shown, TYPES, typeName, velocity } from "./words.js";

const canvas = document.getElementById("map"), said = document.getElementById("map-said"), legend = document.getElementById("map-legend");
const KINDS = ["#8a949e", "#c9d1d8", "#0072b2", "#e69f00", "#009e73", "#cc79a7", "#6b4c9a"];
let state = null, found = null, act = null, drag = null, cursor = null;
const plane = new Plane(canvas, () => draw());

export const CELLS = [48, 40];
export const spansOf = (s) => s.map.spans ?? [span(s.map.x, s), span(s.map.y, s)];
export const axesOf = (s) => [s.map.x, s.map.y].map((name, i) => ({ name, from: spansOf(s)[i][0], to: spansOf(s)[i][1], cells: CELLS[i] }));

export function listen(actions) { act = actions; }
export function place(s) { state = s; draw(); }
export function show(answer) {
  const { header, arrays } = answer;
  if (header.kind === "map") found = { ...header, ...arrays, picture: null };
  said.textContent = header.kind === "map" ? "" : header.waits ?? header.problems.join("; ");
  if (header.kind === "problems") found = null;
  draw();
}
export function forget() { if (found) found.picture = null; draw(); }

// Blue backwards, red forwards, white at zero.
function shade(share) {
  const t = Math.max(-1, Math.min(1, share)), to = t < 0 ? [33, 102, 172] : [178, 24, 43], a = Math.abs(t) ** 0.8;
  return to.map((c) => Math.round(247 + (c - 247) * a));
}
const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16));

// The speed of the full colours: that of nearly all periodic motions. A robot that slides away ever faster would leave them pale.
function fullSpeed() {
  const speeds = (only) => found.mean_velocity.filter((v, k) => Number.isFinite(v) && only(k)).map(Math.abs).sort((a, b) => a - b);
  const all = speeds(() => true), periodic = speeds((k) => found.period[k] > 0), most = all.at(-1) ?? 0;
  const usual = (periodic.length ? periodic : all)[Math.floor(0.98 * (periodic.length || all.length))] ?? 0;
  found.beyond = usual > 0 && most > 1.3 * usual;
  return Math.max(found.beyond ? usual : most, 1e-12);
}

function picture() {
  const [nx, ny] = found.cells, off = new OffscreenCanvas(nx, ny), pen = off.getContext("2d"), image = pen.createImageData(nx, ny);
  const most = (found.most = fullSpeed());
  for (let j = 0; j < ny; j++) for (let i = 0; i < nx; i++) {
    const k = j * nx + i, value = found[state.map.shows][k], at = 4 * ((ny - 1 - j) * nx + i);
    const rgb = state.map.shows === "mean_velocity" ? shade(value / most) : hex(KINDS[value] ?? "#000000");
    image.data.set([...rgb, Number.isNaN(value) ? 0 : 255], at);
  }
  pen.putImageData(image, 0, 0);
  found.picture = off;
  found.drawn = state.map.shows;
}

export function draw() {
  if (!state || !canvas.clientWidth) return;
  const [px, py] = [parameters[state.map.x], parameters[state.map.y]], spans = spansOf(state);
  plane.begin(spans[0].map((v) => v * px.factor), spans[1].map((v) => v * py.factor), axisLabel(px), axisLabel(py));
  if (found && found.names[0] === state.map.x && found.names[1] === state.map.y) {
    if (!found.picture || found.drawn !== state.map.shows) {
      picture();
      key();
      label();
    }
    const [[a, b], [c, d]] = found.spans, { pen } = plane;
    pen.imageSmoothingEnabled = false;
    pen.save();
    pen.beginPath();
    pen.rect(plane.left, plane.top, plane.right - plane.left, plane.bottom - plane.top);
    pen.clip();
    const hx = (b - a) / (found.cells[0] - 1) / 2, hy = (d - c) / (found.cells[1] - 1) / 2;
    const x0 = plane.x((a - hx) * px.factor), y0 = plane.y((d + hy) * py.factor);
    pen.drawImage(found.picture, x0, y0, plane.x((b + hx) * px.factor) - x0, plane.y((c - hy) * py.factor) - y0);
    pen.restore();
  }
  mark(px, py);
}

function mark(px, py) {
  const { pen } = plane, x = plane.x(state.values[px.name] * px.factor), y = plane.y(state.values[py.name] * py.factor);
  for (const [style, width] of [["#ffffff", 4], ["#000000", 1.6]]) {
    plane.stroke([[x - 9, y], [x + 9, y]], style, width);
    plane.stroke([[x, y - 9], [x, y + 9]], style, width);
  }
  if (cursor && document.activeElement === canvas) {
    const at = [plane.x(cursor[0] * px.factor), plane.y(cursor[1] * py.factor)];
    Object.assign(pen, { strokeStyle: colour("accent"), lineWidth: 2.5 });
    pen.strokeRect(at[0] - 6, at[1] - 6, 12, 12);
  }
  if (drag?.moved) {
    pen.setLineDash([4, 3]);
    Object.assign(pen, { strokeStyle: "#000000", lineWidth: 1.5 });
    pen.strokeRect(drag.x, drag.y, drag.to[0] - drag.x, drag.to[1] - drag.y);
    pen.setLineDash([]);
  }
}

// What the map shows, in words.
function label() {
  const axes = found.names.map((name, i) => `${parameters[name].label} from ${shown(parameters[name], found.spans[i][0], 3)} to ${shown(parameters[name], found.spans[i][1], 3)}`).join(" and ");
  const values = state.map.shows === "mean_velocity"
    ? `between ${velocity(found.mean_velocity.reduce((a, b) => (b < a ? b : a), Infinity), 3)} and ${velocity(found.mean_velocity.reduce((a, b) => (b > a ? b : a), -Infinity), 3)}`
    : TYPES.map(typeName).filter((_, i) => found.motion_type.includes(i)).join(", ");
  canvas.setAttribute("aria-label", `map of the ${state.map.shows === "mean_velocity" ? "mean velocity" : "motion type"} over ${axes}: ${values}`);
}

function key() {
  const more = found.beyond ? " and beyond" : "";
  if (state.map.shows === "mean_velocity") return legend.replaceChildren(scale(more));
  const entries = TYPES.map((name, i) => [hex(KINDS[i]), typeName(name)]).filter((_, i) => found.motion_type.includes(i));
  legend.replaceChildren(...entries.map(([rgb, text]) => {
    const item = document.createElement("li");
    item.innerHTML = '<svg viewBox="0 0 28 10" aria-hidden="true"><rect width="28" height="10" rx="2"/></svg>';
    item.querySelector("rect").style.fill = `rgb(${rgb})`;
    item.append(text);
    return item;
  }));
}

// The colour scale: a strip of all shades, with its ends and its middle.
function scale(more) {
  const item = Object.assign(document.createElement("li"), { className: "scale" }), strip = document.createElement("span");
  const shades = Array.from({ length: 17 }, (_, i) => `rgb(${shade(i / 8 - 1)})`);
  strip.className = "shades";
  strip.style.background = `linear-gradient(90deg, ${shades})`;
  const words = [`−${velocity(found.most, 3)}${more}`, "0", `${velocity(found.most, 3)}${more}`].map((textContent) => Object.assign(document.createElement("span"), { textContent }));
  item.append(strip, ...words);
  return item;
}

// What the map says at a place.
function tell(at) {
  const names = [state.map.x, state.map.y], where = names.map((n, i) => `${parameters[n].symbol} = ${shown(parameters[n], at[i], 4)}`).join(", ");
  let what = "";
  if (found && found.names[0] === names[0] && found.names[1] === names[1]) {
    const [i, j] = [0, 1].map((k) => Math.round(((at[k] - found.spans[k][0]) / (found.spans[k][1] - found.spans[k][0])) * (found.cells[k] - 1)));
    if (i >= 0 && j >= 0 && i < found.cells[0] && j < found.cells[1]) {
      const k = j * found.cells[0] + i, v = found.mean_velocity[k];
      what = Number.isNaN(v) ? ": no such robot" : `: ${velocity(v, 3)}, ${typeName(TYPES[found.motion_type[k]])}${found.period[k] ? `, period ${found.period[k]}` : ", no period found"}`;
    }
  }
  said.textContent = where + what;
}

// ---- by pointer ----
const local = (event) => [event.offsetX, event.offsetY];
const inside = ([x, y]) => [Math.max(plane.left, Math.min(plane.right, x)), Math.max(plane.top, Math.min(plane.bottom, y))];
const values = ([x, y]) => [plane.atX(x) / parameters[state.map.x].factor, plane.atY(y) / parameters[state.map.y].factor];

canvas.addEventListener("pointerdown", (event) => {
  if (event.button) return;
  const [x, y] = inside(local(event));
  drag = { x, y, to: [x, y], moved: false };
  canvas.setPointerCapture(event.pointerId);
});
canvas.addEventListener("pointermove", (event) => {
  const at = inside(local(event));
  tell(values(at));
  if (!drag) return;
  drag.to = at;
  drag.moved ||= Math.hypot(at[0] - drag.x, at[1] - drag.y) > 6;
  draw();
});
canvas.addEventListener("pointerup", () => {
  if (!drag) return;
  const from = values([drag.x, drag.y]), to = values(drag.to), zoomed = drag.moved;
  drag = null;
  if (zoomed) zoomTo([0, 1].map((i) => [from[i], to[i]].sort((a, b) => a - b)));
  else act.go(from);
});
canvas.addEventListener("pointercancel", () => { drag = null; draw(); });

// Window within what is allowed, and never without size.
function zoomTo(spans) {
  const names = [state.map.x, state.map.y];
  const kept = spans.map(([a, b], i) => [Math.max(a, parameters[names[i]].least), Math.min(b, parameters[names[i]].most)]);
  if (kept.every(([a, b], i) => b - a > 1e-6 * (parameters[names[i]].high - parameters[names[i]].low))) act.zoom(kept);
  else draw();
}

// ---- by keys ----
canvas.addEventListener("focus", () => { cursor = [state.values[state.map.x], state.values[state.map.y]]; draw(); });
canvas.addEventListener("blur", () => { cursor = null; draw(); });
canvas.addEventListener("keydown", (event) => {
  const spans = spansOf(state), step = spans.map(([a, b], i) => (b - a) / (CELLS[i] - 1));
  const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (way) cursor = cursor.map((c, i) => Math.max(spans[i][0], Math.min(spans[i][1], c + way[i] * step[i] * (event.shiftKey ? 5 : 1))));
  else if (event.key === "Enter") act.go(cursor);
  else if (event.key === "+" || event.key === "=") zoomTo(spans.map(([a, b], i) => [cursor[i] - (b - a) / 4, cursor[i] + (b - a) / 4]));
  else if (event.key === "-") zoomTo(spans.map(([a, b], i) => [cursor[i] - (b - a), cursor[i] + (b - a)]));
  else if (event.key === "0") act.zoom(null);
  else return;
  event.preventDefault();
  tell(cursor);
  draw();
});
