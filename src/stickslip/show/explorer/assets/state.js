// What is on the page, as one plain object; and the same as the part of the address behind #.
export const data = JSON.parse(document.getElementById("data").textContent);
export const parameters = data.parameters;
const KINDS = ["drive", "track", "contact", "law"];

export const defaults = () => ({
  ...data.first,
  also: [...data.first.also],
  values: Object.fromEntries(Object.values(parameters).map((p) => [p.name, p.default])),
  map: { x: "amplitude", y: "tilt_deg", spans: null, shows: "mean_velocity" },
  vary: "amplitude",
  shape: null, // of a recorded drive: its cosines and sines, in parts of the amplitude
});

// The parameters that matter for these choices, in the order of the page.
export function active(state) {
  const used = new Set(["body_mass", "inner_mass", "gravity"]);
  for (const kind of KINDS) data.choices[kind][state[kind]].parameters.forEach((name) => used.add(name));
  for (const law of state.also) data.choices.law[law].parameters.forEach((name) => used.add(name));
  return Object.keys(parameters).filter((name) => used.has(name));
}

// What the server is told.
export const table = (state) => ({
  drive: state.drive, track: state.track, contact: state.contact, law: state.law,
  also: state.also.filter((law) => law !== state.law),
  values: Object.fromEntries(active(state).map((name) => [name, state.values[name]])),
  ...(state.drive === "recorded" && state.shape ? { shape: state.shape } : {}),
});

// Axes must be parameters that matter; where they are not, the first two that do take their place.
export function settled(state) {
  const names = active(state);
  if (!names.includes(state.map.x)) Object.assign(state.map, { x: names.find((n) => n !== state.map.y), spans: null });
  if (!names.includes(state.map.y) || state.map.y === state.map.x) Object.assign(state.map, { y: names.find((n) => n !== state.map.x), spans: null });
  if (!names.includes(state.vary)) state.vary = names[0];
  return state;
}

export function withPreset(name) {
  const state = defaults(), preset = data.presets[name].state;
  for (const kind of KINDS) if (preset[kind]) state[kind] = preset[kind];
  state.also = [...preset.also];
  Object.assign(state.values, preset.values);
  if (preset.values.mu0) state.vary = "mu0";
  return settled(state);
}

export function span(name, state) {
  const p = parameters[name], value = state.values[name];
  return [Math.min(p.low, value), Math.max(p.high, value)];
}

const short = (x) => String(Number(x.toPrecision(12)));

export function toHash(state) {
  const q = new URLSearchParams();
  for (const kind of KINDS) q.set(kind, state[kind]);
  q.set("also", state.also.join(","));
  for (const name of active(state)) q.set(name, String(state.values[name]));
  const { x, y, spans, shows } = state.map;
  q.set("map", [shows, x, y, ...(spans ? spans.flat().map(short) : [])].join(","));
  q.set("vary", state.vary);
  if (state.drive === "recorded" && state.shape) q.set("shape", state.shape.flat().map((c) => Number(c.toPrecision(7))).join(","));
  return "#" + q;
}

// Whether a name and its text in an address are taken.
export function takes(name, text) {
  if (KINDS.includes(name)) return Object.hasOwn(data.choices[name], text);
  if (!Object.hasOwn(parameters, name)) return ["also", "map", "vary", "shape"].includes(name);
  const value = Number(text || NaN);
  return value >= parameters[name].least && value <= parameters[name].most;
}

// The state of an address; what is missing or makes no sense stays as it is at first.
export function fromHash(hash) {
  const state = defaults(), q = new URLSearchParams(hash.replace(/^#/, ""));
  for (const kind of KINDS) if (takes(kind, q.get(kind) ?? "")) state[kind] = q.get(kind);
  if (q.has("also")) state.also = q.get("also").split(",").filter((law) => Object.hasOwn(data.choices.law, law) && law !== state.law).slice(0, 4);
  for (const name of Object.keys(parameters)) if (takes(name, q.get(name))) state.values[name] = Number(q.get(name));
  const [shows, x, y, ...ends] = (q.get("map") ?? "").split(",");
  if (["mean_velocity", "motion_type"].includes(shows)) state.map.shows = shows;
  if (Object.hasOwn(parameters, x ?? "") && Object.hasOwn(parameters, y ?? "") && x !== y) {
    Object.assign(state.map, { x, y });
    const [a, b, c, d] = ends.map(Number);
    if (ends.length === 4 && a < b && c < d) state.map.spans = [[a, b], [c, d]];
  }
  if (Object.hasOwn(parameters, q.get("vary") ?? "")) state.vary = q.get("vary");
  const shape = (q.get("shape") ?? "").split(",").map((text) => Number(text || NaN)), half = shape.length / 2;
  if (Number.isInteger(half) && half <= data.harmonics && shape.every((c) => Math.abs(c) <= 10)) state.shape = [shape.slice(0, half), shape.slice(half)];
  return settled(state);
}
