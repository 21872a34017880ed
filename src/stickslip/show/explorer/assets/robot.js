// The robot on its track, in slow motion. Its size is not to scale; what it does is: body and inner mass move by the same measure.
import { colour } from "./plane.js";
import { digits, quantity } from "./words.js";

const canvas = document.getElementById("robot"), pen = canvas.getContext("2d");
const play = document.getElementById("play"), speed = document.getElementById("speed");
let run = null, clock = 0, laps = 0, playing = !matchMedia("(prefers-reduced-motion: reduce)").matches, before = 0, announced = 0;

// What moves: the last motion periods of the chosen law, and the tilt in degrees.
export function show(curve, tilt) {
  const n = curve.t.length - 1, end = curve.t[n];
  if (run) clock = ((clock / run.end) % 1) * end;
  const size = Math.max(...curve.xi) - Math.min(...curve.xi), reach = Math.max(...curve.x) - Math.min(...curve.x);
  run = { ...curve, end, tilt, advance: curve.x[n] - curve.x[0], size: Math.max(size, 1e-12), reach };
  if (!playing || !inView()) frame();
}

function at(column) {
  const place = (clock / run.end) * (column.length - 1), i = Math.min(Math.floor(place), column.length - 2);
  return column[i] + (place - i) * (column[i + 1] - column[i]);
}

function box(x, y, w, h, radius, fill, edge) {
  pen.beginPath();
  pen.roundRect(x, y, w, h, radius);
  Object.assign(pen, { fillStyle: fill, strokeStyle: edge, lineWidth: 1.5 });
  pen.fill();
  pen.stroke();
}

export function frame() {
  if (!run) return;
  const ratio = devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight, unit = h / 8;
  if (canvas.width !== Math.round(w * ratio)) canvas.width = Math.round(w * ratio);
  if (canvas.height !== Math.round(h * ratio)) canvas.height = Math.round(h * ratio);
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, w, h);
  const v = at(run.v), xi = at(run.xi), x = at(run.x) + laps * run.advance;
  const scale = (unit * 3.2) / run.size, moved = x * scale, length = unit * 7;
  pen.save();
  pen.translate(w / 2, h * 0.8);
  pen.rotate((Math.max(-12, Math.min(12, run.tilt)) * Math.PI) / 180);
  track(moved, w, unit);
  box(-length / 2, -unit * 3.6, length, unit * 3.4, unit * 0.5, colour("grid"), colour("ink"));
  box(-unit * 2.8, -unit * 3.3, unit * 5.6, unit * 2, unit * 0.3, colour("card"), colour("line"));
  const middle = (Math.max(...run.xi) + Math.min(...run.xi)) / 2;
  box((xi - middle) * scale - unit * 0.75, -unit * 3.1, unit * 1.5, unit * 1.6, unit * 0.25, colour("c0"), colour("ink"));
  letter("m", (xi - middle) * scale, -unit * 2, unit * 0.95, colour("card"));
  letter("M", 0, -unit * 0.42, unit * 0.95, colour("ink"));
  arrow(v, unit, length);
  pen.restore();
  words(v, x);
}

function letter(text, x, y, size, style) {
  pen.fillStyle = style;
  pen.font = `italic ${size}px Georgia, serif`;
  pen.textAlign = "center";
  pen.fillText(text, x, y);
}

function track(moved, w, unit) {
  const gap = unit * 2, shift = -(moved % gap);
  pen.strokeStyle = colour("soft");
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(-w, 0);
  pen.lineTo(w, 0);
  pen.stroke();
  pen.lineWidth = 1;
  pen.beginPath();
  for (let x = -w - (w % gap); x < w + gap; x += gap) {
    pen.moveTo(x + shift, 0);
    pen.lineTo(x + shift - unit * 0.5, unit * 0.55);
  }
  pen.stroke();
}

function arrow(v, unit, length) {
  const most = Math.max(...run.v.map(Math.abs)) || 1, size = (v / most) * unit * 4;
  if (Math.abs(size) < 2) return;
  const from = Math.sign(v) * (length / 2 + unit * 0.3), y = -unit * 1.8;
  pen.strokeStyle = pen.fillStyle = colour("c1");
  pen.lineWidth = 2.5;
  pen.beginPath();
  pen.moveTo(from, y);
  pen.lineTo(from + size, y);
  pen.stroke();
  pen.beginPath();
  pen.moveTo(from + size + Math.sign(v) * unit * 0.5, y);
  pen.lineTo(from + size, y - unit * 0.4);
  pen.lineTo(from + size, y + unit * 0.4);
  pen.fill();
}

function words(v, x) {
  const doing = run.mode[Math.round((clock / run.end) * (run.mode.length - 1))], text = ["slides backwards", "sticks", "slides forwards"][Math.sign(doing) + 1];
  const still = Math.abs(v) < 0.01 * Math.max(...run.v.map(Math.abs)) ? "at rest, or nearly" : text;
  const line = `${digits(1e3 * clock, 3)} ms · v = ${digits(1e3 * v, 3)} mm/s · ${still}`;
  pen.fillStyle = colour("ink");
  pen.font = `${parseFloat(getComputedStyle(document.documentElement).fontSize) * 0.8}px system-ui, sans-serif`;
  pen.textAlign = "left";
  pen.fillText(line, 8, 16);
  const narrow = canvas.clientWidth < pen.measureText(line).width + 140;
  pen.textAlign = narrow ? "left" : "right";
  pen.fillText(`moved ${quantity(x, "m", 3)}`, narrow ? 8 : canvas.clientWidth - 8, narrow ? 34 : 16);
  if (performance.now() - announced > 1000 && !playing) canvas.setAttribute("aria-label", `the robot on its track: ${line}`);
}

function advance(seconds) {
  clock += seconds;
  while (clock >= run.end) { clock -= run.end; laps += 1; }
  if (laps * Math.abs(run.advance) > 1e3 * run.size) laps = 0;
}

function inView() {
  const { top, bottom } = canvas.getBoundingClientRect();
  return bottom > 0 && top < innerHeight;
}

function tick(now) {
  if (playing && run && inView()) {
    advance(Math.min((now - before) / 1e3, 0.1) * Number(speed.value));
    frame();
  }
  before = now;
  if (playing) requestAnimationFrame(tick);
}

function set(value) {
  playing = value;
  play.textContent = playing ? "pause" : "play";
  play.setAttribute("aria-pressed", String(playing));
  if (playing) requestAnimationFrame((now) => { before = now; tick(now); });
}

play.addEventListener("click", () => set(!playing));
document.getElementById("step").addEventListener("click", () => {
  set(false);
  if (run) advance(run.end / (run.shown * 24));
  frame();
});
new ResizeObserver(() => frame()).observe(canvas);
set(playing);
