// The bifurcation strip: strobed velocities along one parameter.
import { Plane, colour, extent } from "./plane.js";
import { parameters, span } from "./state.js";
import { axisLabel, digits, prefix, shown } from "./words.js";

const canvas = document.getElementById("strip");
let state = null, found = null, go = null;
const plane = new Plane(canvas, () => draw());

export const axesOf = (s) => { const [from, to] = span(s.vary, s); return [{ name: s.vary, from, to, cells: 120 }]; };
export function listen(action) { go = action; }
export function place(s) { state = s; draw(); }
export function show({ header, arrays }) {
  document.getElementById("strip-said").textContent = header.kind === "strip" ? header.said : header.waits ?? header.problems.join("; ");
  if (header.kind === "strip") found = { ...header, ...arrays };
  draw();
}
export const restyle = () => draw();

function draw() {
  if (!state || !canvas.clientWidth) return;
  const p = parameters[state.vary], mine = found && found.names[0] === state.vary ? found : null, [a, b] = mine ? mine.spans[0] : span(state.vary, state);
  const [low, high] = mine ? extent(mine.strobes, mine.means) : [-1e-3, 1e-3], room = 0.05 * (high - low || 1e-3);
  const speed = prefix(Math.max(Math.abs(low), Math.abs(high)));
  plane.begin([a * p.factor, b * p.factor], [speed.factor * (low - room), speed.factor * (high + room)], axisLabel(p), `velocity at t = kT [${speed.letter}m/s]`);
  const { pen } = plane;
  if (mine) {
    plane.curve(mine.values, mine.means, p.factor, speed.factor, colour("c1"), [5, 3], 1.4);
    pen.fillStyle = colour("c0");
    const size = Math.max(1.6, plane.size / 6);
    mine.strobes.forEach((v, k) => {
      const x = plane.x(mine.values[Math.floor(k / mine.kept)] * p.factor), y = plane.y(speed.factor * v);
      pen.globalAlpha = mine.settled[Math.floor(k / mine.kept)] === 0 ? 0.25 : 1;
      if (y === y) pen.fillRect(x - size / 2, y - size / 2, size, size);
    });
    pen.globalAlpha = 1;
    const most = Math.max(...mine.values.map((_, i) => new Set(Array.from(mine.strobes.slice(i * mine.kept, (i + 1) * mine.kept), (v) => digits(v, 3))).size));
    canvas.setAttribute("aria-label", `velocities at the start of drive periods along ${p.label}, from ${shown(p, a)} to ${shown(p, b)}: between ${digits(1e3 * low, 3)} and ${digits(1e3 * high, 3)} mm/s, at most ${most} different ones at one value; dashed: mean velocity${mine.said && ". " + mine.said}`);
  }
  const x = plane.x(state.values[state.vary] * p.factor);
  plane.stroke([[x, plane.top], [x, plane.bottom]], colour("ink"), 1.5);
}

canvas.addEventListener("click", (event) => {
  const p = parameters[state.vary], value = plane.atX(Math.max(plane.left, Math.min(plane.right, event.offsetX))) / p.factor;
  go(state.vary, Math.max(p.least, Math.min(p.most, value)));
});
