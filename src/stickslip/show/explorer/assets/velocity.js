// Velocity over time, of all laws and of a record.
import { colour, DASHES, extent, steady } from "./plane.js";
import { digits, prefix, velocity as words } from "./words.js";

const box = document.getElementById("velocity"), legend = document.getElementById("legend");
let chart = null, kinds = "", zoomed = null, range = null, last = null, unit = prefix(1e-3);

function series(curves) {
  return curves.map((c) => ({ label: c.label, stroke: c.colour, width: 1.8, dash: c.dash, pxAlign: 0, points: { show: false }, spanGaps: false }));
}

function made(curves) {
  chart?.destroy();
  const size = parseFloat(getComputedStyle(document.documentElement).fontSize), font = `${Math.round(size * 0.76)}px system-ui, sans-serif`; // uPlot scales whole numbers of px alone
  const axis = (label, n) => ({
    label, font, labelFont: font, stroke: () => colour("soft"), grid: { stroke: () => colour("grid"), width: 1 }, ticks: { show: false },
    labelSize: size * 1.2, size: size * n, gap: 3, labelGap: 0, values: (u, found) => found.map((x) => digits(x, 6)),
  });
  chart = new window.uPlot({
    width: box.clientWidth, height: box.clientHeight, legend: { show: false }, padding: [6, 10, 0, 0],
    cursor: { drag: { x: true, y: false, setScale: true }, points: { size: 6 } },
    scales: { x: { time: false, range: () => zoomed ?? [0, last.end] }, y: { range: () => range } },
    axes: [axis("time [ms]", 1.6), axis(`velocity v [${unit.letter}m/s]`, 3.4)],
    series: [{}, ...series(curves)],
    hooks: { setSelect: [(u) => { if (u.select.width > 4) zoomed = [u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")]; tell(); }] },
  }, data(curves), box);
  chart.over.addEventListener("dblclick", () => zoom(0));
}

// Columns of one length: a law with fewer periods ends earlier.
function data(curves) {
  const longest = curves.reduce((a, b) => (b.t.length > a.t.length ? b : a));
  const step = longest.t[1] - longest.t[0];
  const column = (c) => { // what was pinned may have another drive period, so another step
    const found = new Array(longest.t.length).fill(null), ratio = step / (c.t[1] - c.t[0]);
    for (let i = 0; i < found.length; i++) {
      const at = i * ratio, k = Math.round(at);
      if (at > c.v.length - 1 + 1e-6) break;
      const value = Math.abs(at - k) < 1e-3 ? c.v[k] : c.v[Math.floor(at)] + (at - Math.floor(at)) * (c.v[Math.floor(at) + 1] - c.v[Math.floor(at)]);
      found[i] = Number.isNaN(value) ? null : unit.factor * value;
    }
    return found;
  };
  return [Array.from(longest.t, (t) => 1e3 * t), ...curves.map(column)];
}

function key(curves) {
  legend.replaceChildren(...curves.map((c) => {
    const item = document.createElement("li");
    item.innerHTML = '<svg viewBox="0 0 28 8" aria-hidden="true"><line x1="0" y1="4" x2="28" y2="4" stroke-width="2.4"/></svg>';
    const line = item.querySelector("line");
    line.style.stroke = c.colour;
    line.style.strokeDasharray = c.dash.join(" ");
    item.append(c.waits ?? `${c.label}: mean ${words(c.mean)}`);
    return item;
  }));
}

// Draw; `waiting` are laws that have no curve yet.
export function draw(curves, waiting, end) {
  if (!curves.length) return key(waiting);
  last = { curves, waiting, end: 1e3 * end };
  if (zoomed && zoomed[0] >= last.end) zoomed = null;
  const [low, high] = extent(...curves.map((c) => c.v));
  const wanted = prefix(Math.max(Math.abs(low), Math.abs(high)) || 1e-3);
  if (wanted.letter !== unit.letter) [unit, range] = [wanted, null];
  range = steady(range, unit.factor * Math.min(low, 0), unit.factor * Math.max(high, 0));
  const now = JSON.stringify([unit.letter, curves.map((c) => [c.label, c.colour, c.dash])]);
  if (now !== kinds || !chart) made(curves);
  else chart.setData(data(curves));
  kinds = now;
  tell();
  key([...curves, ...waiting]);
  box.setAttribute("aria-label", `velocity over time: ${curves.map((c) => `${c.label}, ${words(extent(c.v)[0], 3)} to ${words(extent(c.v)[1], 3)}, mean ${words(c.mean, 3)}`).join("; ")}`);
}

export function zoom(factor) {
  if (!chart || !last) return;
  const [a, b] = zoomed ?? [0, last.end], middle = (a + b) / 2, half = ((b - a) / 2) * factor;
  zoomed = factor === 0 || 2 * half >= last.end ? null : [Math.max(middle - half, 0), Math.min(middle + half, last.end)];
  chart.setData(chart.data);
  tell();
}

// From where to where [ms] the chart reaches, for whoever looks at the page without eyes.
function tell() {
  const [a, b] = zoomed ?? [0, last.end];
  box.dataset.shows = `${a} ${b}`;
}

export function restyle() {
  kinds = "";
}

new ResizeObserver(() => chart?.setSize({ width: box.clientWidth, height: box.clientHeight })).observe(box);

export const look = (i) => ({ colour: colour(`c${i % 5}`), dash: DASHES[i % 5] });
