// A measured record of velocity: read by the server, which knows the formats, and laid over the curves.
import { unpacked } from "./link.js";

// The velocity in a file: from `start` in steps of `step` [s], and its mean [m/s]; a file with a drive alone has no v.
export async function opened(file) {
  const { header, arrays } = await sent("record", file);
  return { ...header, v: arrays.v, name: file.name, file };
}

// The drive in a file: amplitude [m], omega [rad/s] and shape.
export const drive = async (file) => (await sent("drive", file)).header;

async function sent(where, file) {
  if (file.size > 20e6) throw new Error("the file is larger than 20 MB");
  const reply = await fetch(`${where}/${encodeURIComponent(file.name)}`, { method: "POST", body: file });
  if (!reply.ok) throw new Error((await reply.text()).trim());
  const answer = unpacked(await reply.arrayBuffer());
  if (answer.header.kind === "problems") throw new Error(answer.header.problems.join("; "));
  return answer;
}

function at({ start, step, v }, time) {
  const place = Math.max(0, Math.min(v.length - 1.000001, (time - start) / step)), i = Math.floor(place);
  return v[i] + (place - i) * (v[i + 1] - v[i]);
}

// The last periods of a record on the instants of a curve, moved in time to where it fits the curve best.
export function fitted(record, curve, period, samples) {
  const end = record.start + record.step * (record.v.length - 1), whole = Math.floor((end - record.start) / period + 1e-6);
  if (whole < 1) return null;
  const count = Math.min(whole, Math.round(curve.t.at(-1) / period)), start = end - count * period, n = count * samples;
  const own = Array.from({ length: n }, (_, i) => at(record, start + (i * period) / samples));
  let best = 0, most = -Infinity;
  for (let shift = 0; shift < samples; shift += 2) {
    let sum = 0;
    for (let i = 0; i < n; i += 3) sum += own[(i + shift) % n] * curve.v[i];
    if (sum > most) [most, best] = [sum, shift];
  }
  return Float32Array.from({ length: n + 1 }, (_, i) => own[(i + best) % n]);
}
