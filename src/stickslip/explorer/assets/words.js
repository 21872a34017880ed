// Numbers and words as a person reads them.
export const digits = (x, n = 4) => (Number.isFinite(x) ? String(Number(x.toPrecision(n))).replace("-", "−") : "–");

const PREFIXES = [[1e-9, "n"], [1e-6, "µ"], [1e-3, "m"], [1, ""], [1e3, "k"]];

// The prefix in which the largest number lies between 1 and 1000.
export function prefix(largest) {
  const found = PREFIXES.findLast(([size]) => Math.abs(largest) >= size * 0.9999) ?? PREFIXES[0];
  return largest ? { factor: 1 / found[0], letter: found[1] } : { factor: 1, letter: "" };
}

export function quantity(x, unit, n = 4) {
  if (!Number.isFinite(x)) return "–";
  const { factor, letter } = prefix(x);
  return `${digits(x * factor, n)} ${letter}${unit}`;
}

export const shown = (p, value, n = 5) => `${digits(value * p.factor, n)}${p.unit ? (p.unit === "°" ? "" : " ") + p.unit : ""}`;

// What stands at an axis.
export const axisLabel = (p) => `${p.label.split(",")[0]} ${p.symbol}${p.unit ? ` [${p.unit}]` : ""}`;

export const velocity = (v, n = 4) => `${digits(1e3 * v, n)} mm/s`;

export const TYPES = ["rest", "presliding", "I", "II", "III", "IV", "other"];

export function typeName(type) {
  return /^I/.test(type) ? `type ${type}` : type;
}
