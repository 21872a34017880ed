// A measured record of velocity, read here in the browser: it does not leave the machine.
const MOST = 2e7;
const TIMES = { s: 1, ms: 1e-3, µs: 1e-6, us: 1e-6 }, SPEEDS = { "m/s": 1, "mm/s": 1e-3, "cm/s": 1e-2, "µm/s": 1e-6, "um/s": 1e-6 };

const unit = (name, units) => Object.entries(units).find(([u]) => new RegExp(`(^|[^a-zµ/])${u}($|[^a-z/])`, "i").test(name))?.[1] ?? 1;

// Columns t [s] and v [m/s] of a text with a time in the first column, and a velocity in the one named so, else in the second.
export function parsed(text) {
  if (text.length > MOST) throw new Error("the file is larger than 20 MB");
  const lines = text.split(/\r?\n/).map((line) => line.trim()).filter((line) => line && !/^[#%]/.test(line));
  const split = (line) => line.split(line.includes(";") ? ";" : line.includes("\t") ? "\t" : line.includes(",") ? "," : /\s+/).map((cell) => cell.trim());
  const numbers = (line) => split(line).map((cell) => (cell === "" ? NaN : Number(cell.replace(/^"|"$/g, ""))));
  const first = lines.findIndex((line) => numbers(line).filter(Number.isFinite).length >= 2);
  if (first < 0) throw new Error("there are no two columns of numbers in it");
  const head = first > 0 ? split(lines[first - 1]) : [], named = head.findIndex((name) => /^"?(v\b|velocity|speed)/i.test(name));
  const column = named > 0 ? named : 1, time = unit(head[0] ?? "", TIMES), speed = unit(head[column] ?? "", SPEEDS);
  const t = [], v = [];
  for (const line of lines.slice(first)) {
    const row = numbers(line);
    if (Number.isFinite(row[0]) && Number.isFinite(row[column]) && (!t.length || row[0] * time > t.at(-1))) { t.push(row[0] * time); v.push(row[column] * speed); }
  }
  if (t.length < 16) throw new Error(`it has ${t.length} rows with rising times; 16 are needed`);
  return { t, v, mean: mean(t, v) };
}

function mean(t, v) {
  let area = 0;
  for (let i = 1; i < t.length; i++) area += 0.5 * (v[i] + v[i - 1]) * (t[i] - t[i - 1]);
  return area / (t.at(-1) - t[0]);
}

function at(record, time) {
  const { t, v } = record;
  let low = 0, high = t.length - 1;
  while (high - low > 1) { const middle = (low + high) >> 1; if (t[middle] <= time) low = middle; else high = middle; }
  return v[low] + ((time - t[low]) / (t[high] - t[low])) * (v[high] - v[low]);
}

// The last periods of a record on the instants of a curve, moved in time to where it fits the curve best.
export function fitted(record, curve, period, samples) {
  const whole = Math.floor((record.t.at(-1) - record.t[0]) / period - 1e-9);
  if (whole < 1) return null;
  const count = Math.min(whole, Math.round(curve.t.at(-1) / period)), start = record.t.at(-1) - count * period, n = count * samples;
  const own = Array.from({ length: n }, (_, i) => at(record, start + (i * period) / samples));
  let best = 0, most = -Infinity;
  for (let shift = 0; shift < samples; shift += 2) {
    let sum = 0;
    for (let i = 0; i < n; i += 3) sum += own[(i + shift) % n] * curve.v[i];
    if (sum > most) [most, best] = [sum, shift];
  }
  return Float32Array.from({ length: n + 1 }, (_, i) => own[(i + best) % n]);
}
