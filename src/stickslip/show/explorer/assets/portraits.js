// Phase portrait with strobe points, and friction against velocity.
import { Plane, extent, steady } from "./plane.js";
import { digits, prefix } from "./words.js";

let last = null, across = null, up = null, sides = null, forces = null, letters = "", units = "";
const phase = new Plane(document.getElementById("phase"), () => drawPhase());
const friction = new Plane(document.getElementById("friction"), () => drawFriction());

// Draw one motion period of each, of at most `periods` drive periods of so many samples: more would only fill the gaps of the dashes.
export function draw(curves, samples, periods) {
  last = curves.map((c) => {
    const count = repeats(c.v, samples, periods) * samples + 1;
    return { ...c, s: withoutDrift(c).slice(-count), v: c.v.slice(-count), R: c.R.slice(-count) };
  });
  drawPhase();
  drawFriction();
}

// After how many drive periods a curve is back where it was, to a hundredth of its size.
function repeats(v, samples, most) {
  const [low, high] = extent(v), n = v.length - 1;
  for (let k = 1; k < most; k++) {
    if (n < (k + 1) * samples) break;
    let worst = 0;
    for (let i = 0; i <= samples; i += 4) worst = Math.max(worst, Math.abs(v[n - i] - v[n - i - k * samples]));
    if (worst <= 0.01 * (high - low)) return k;
  }
  return most;
}

// Displacement less the mean motion; the strobe points of the server begin at the same place.
function withoutDrift({ x, t }) {
  const n = x.length - 1, slope = (x[n] - x[0]) / (t[n] - t[0]);
  return x.map((value, i) => value - x[0] - slope * (t[i] - t[0]));
}

// Where the force jumps while the velocity passes zero, or comes to it, or leaves it, the jump is at zero.
function stepped(v, R, whole) {
  const speeds = [], forces = [], put = (x, y) => { speeds.push(x); forces.push(y); };
  for (let i = 0; i < v.length; i++) {
    if (i && Math.abs(R[i] - R[i - 1]) > 0.05 * whole && v[i] * v[i - 1] <= 0 && v[i] !== v[i - 1]) {
      put(0, R[i - 1]);
      put(0, R[i]);
    }
    put(v[i], R[i]);
  }
  return [speeds, forces];
}

function drawPhase() {
  if (!last?.length) return;
  const [a, b] = extent(...last.map((c) => c.s), ...last.map((c) => c.strobe_s)), [low, high] = extent(...last.map((c) => c.v), ...last.map((c) => c.strobe_v));
  const { factor, letter } = prefix(Math.max(Math.abs(a), Math.abs(b)));
  const speed = prefix(Math.max(Math.abs(low), Math.abs(high)) || 1e-3);
  if (letter + speed.letter !== letters) across = up = null;
  letters = letter + speed.letter;
  across = steady(across, a * factor, b * factor);
  up = steady(up, speed.factor * low, speed.factor * high);
  phase.begin(across, up, `displacement without drift x − Vt [${letter}m]`, `velocity v [${speed.letter}m/s]`);
  for (const c of last) phase.curve(c.s, c.v, factor, speed.factor, c.colour, c.dash);
  for (const c of last) c.strobe_s.forEach((s, i) => phase.ring(s * factor, speed.factor * c.strobe_v[i], c.colour));
  const main = last[0];
  phase.canvas.setAttribute("aria-label", `phase portrait: ${main.label}, displacement without drift from ${digits(a * factor, 3)} to ${digits(b * factor, 3)} ${letter}m, velocity from ${digits(1e3 * low, 3)} to ${digits(1e3 * high, 3)} mm/s`);
}

function drawFriction() {
  if (!last?.length) return;
  const [a, b] = extent(...last.map((c) => c.v)), [low, high] = extent(...last.map((c) => c.R));
  const speed = prefix(Math.max(Math.abs(a), Math.abs(b)) || 1e-3), force = prefix(Math.max(Math.abs(low), Math.abs(high)) || 1e-3);
  if (speed.letter + force.letter !== units) sides = forces = null;
  units = speed.letter + force.letter;
  sides = steady(sides, speed.factor * a, speed.factor * b);
  forces = steady(forces, force.factor * low, force.factor * high);
  friction.begin(sides, forces, `velocity v [${speed.letter}m/s]`, `friction force R [${force.letter}N]`);
  for (const c of last) friction.curve(...stepped(c.v, c.R, high - low), speed.factor, force.factor, c.colour, c.dash);
  friction.canvas.setAttribute("aria-label", `friction force against velocity: ${last.map((c) => `${c.label} from ${digits(1e3 * extent(c.R)[0], 3)} to ${digits(1e3 * extent(c.R)[1], 3)} mN`).join("; ")}`);
}
