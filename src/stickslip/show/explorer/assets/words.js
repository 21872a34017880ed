// Numbers and words as a person reads them.
export const digits = (x, n = 4) => (Number.isFinite(x) ? String(Number(x.toPrecision(n))).replace("-", "−") : "–");

export const capital = (sentence) => sentence.charAt(0).toUpperCase() + sentence.slice(1);

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

// What is rounding beside any motion, a billionth of a mm/s, is none.
export const velocity = (v, n = 4) => (Math.abs(v) > 1e-12 && Number.isFinite(v) ? quantity(v, "m/s", n) : `${digits(Number.isFinite(v) ? 0 : v, n)} mm/s`);

// What a person typed for a parameter, in SI units; NaN where it is none. A comma may be the decimal point, and a unit may stand behind.
export function typedNumber(p, text) {
  const found = /^([-+]?[\d.]+(?:e[-+]?\d+)?)\s*(.*)$/i.exec(text.trim().replace(",", ".").replace("−", "-"));
  if (!found) return NaN;
  const unit = found[2].trim().replace("μ", "µ");
  return Number(found[1]) * (unit === "" || unit === p.unit ? 1 / p.factor : (p.units?.[unit] ?? NaN));
}

// A motion as a sentence: what the body does, from its pattern of + (forwards), 0 (rest) and −.
export function spoken(pattern, periods, mean, tilt) {
  const one = pattern.slice(0, pattern.length / (periods || 1)), regular = one.repeat(periods || 1) === pattern;
  const does = { "+": "slides forwards", 0: "rests", "-": "slides backwards" }, steps = [...(regular ? one : pattern)].map((sign) => does[sign]);
  if (!steps.length || steps.some((step) => !step)) return "";
  if (pattern === "0") return "The drive is too weak: friction holds the body all the time.";
  const way = Math.abs(mean) < 1e-9 ? "It returns to its starting position." : tilt ? `Overall it moves ${mean * tilt > 0 ? "downhill" : "uphill"}.` : `Overall it moves ${mean > 0 ? "forwards" : "backwards"}.`;
  if (steps.length > 5) return `It slides and rests ${steps.length} times${periods ? ` before it repeats, after ${periods} drive period${periods > 1 ? "s" : ""}` : ""}. ${way}`;
  const again = periods > 1 ? ` It repeats after ${periods} of them.` : "";
  return `In ${regular ? "each drive period" : periods + " drive periods"} the body ${steps.join(", ")}.${regular ? again : ""} ${way}`;
}

// A motion that has not repeated, with its largest Lyapunov exponent once that is known.
export function unrepeated(periods, mean, found) {
  const travels = Math.abs(mean) > 1e-9 ? ` On average it moves ${mean > 0 ? "forwards" : "backwards"}.` : "";
  const no = `The motion does not repeat within ${periods} drive periods.`;
  if (!found || found.waits) return `${no} Whether it is chaotic is being computed.`;
  if (found.kind === "problems") return no;
  const exponent = `${digits(found.exponent, 3)} ± ${digits(found.error, 2)} per drive period`;
  if (!found.chaotic) return `${no} It is not shown to be chaotic: the largest Lyapunov exponent is ${exponent}.${travels}`;
  return `${no} It is chaotic: two motions that begin close together part by a factor of ${digits(Math.exp(found.exponent), 2)} in each drive period (largest Lyapunov exponent ${exponent}).${travels}`;
}

// What is on the page: the robot, its drive, what friction does, and the curves. All of it comes from the numbers that are shown.
export function scene(state, header, laws) {
  const tilt = state.track === "level" ? 0 : state.values.tilt_deg, f = header.figures, often = digits(1 / header.period, 3);
  const track = tilt ? `on a track that ${tilt > 0 ? "falls" : "rises"} by ${digits(Math.abs(tilt), 3)}°` : "on a level track";
  const rests = !f ? "" : f.stick_fraction > 0.995 ? "Friction holds the body all the time." : f.stick_fraction > 0 ? "Friction holds the body, lets it slide and holds it again." : "Friction slows the body but never holds it.";
  const eased = state.track === "folded" && tilt && f && f.mean_velocity * tilt > 0 ? ` It resists less downhill than uphill, so the body travels downhill.` : "";
  const number = ["", "one friction law", "two friction laws", "three friction laws", "four friction laws", "five friction laws"][laws.length];
  const curves = laws.length > 1 ? `its velocity under ${number}, ${laws.slice(0, -1).join(", ")} and ${laws.at(-1)}` : `its velocity under ${laws[0]} friction`;
  return `A robot ${track}. A drive moves a mass inside it to and fro, ${often} times a second. ${rests}${eased} The chart shows ${curves}.`;
}

export const TYPES = ["rest", "presliding", "I", "II", "III", "IV", "other"];

export function typeName(type) {
  return /^I/.test(type) ? `type ${type}` : type;
}
