"use strict";
// A machine in motion: bodies to scale on their track, a velocity trace for each, and what every contact does, with one cursor.
// Data: see moments() in show/reports/moving.py. Returns show(data), which draws other numbers at the same instant.
function moving(box, first) { // eslint-disable-line no-unused-vars
  const NS = "http://www.w3.org/2000/svg", W = 640, TALL = 190, STOREY = 62;
  const minus = (text) => text.replace("-", "\u2212"), number = (value, n = 4) => minus(String(Number(value.toPrecision(n))));
  const zeroed = (v, size) => (Math.abs(v) < 1e-9 * size ? 0 : v); // rounding is 0
  const make = (name, attributes = {}, parent = null) => {
    const node = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    parent?.append(node);
    return node;
  };
  const el = (name, kind = "", text = "") => Object.assign(document.createElement(name), { className: kind, textContent: text });
  let m = first, cursors = [], shapes = [], dots = [], timer = null, n = m.t.length, up = null, zoom = 1;

  const stage = make("svg", { class: "stage", role: "img" }), names = el("ul", "names"), lines = el("div", "lines"), line = el("p", "play");
  const play = Object.assign(el("button", "", "Play"), { type: "button" }), when = Object.assign(el("input"), { type: "range", min: 0, step: 1, value: 0 });
  const label = el("label", "", "instant "), out = el("output");
  label.append(when);
  line.append(play, " ", label, " ", out);
  box.replaceChildren(stage, names, lines, line);

  function across(t) { return (W * t) / m.t[n - 1]; }
  const colour = (i) => `var(--c${i % 5})`;
  const dash = (i) => ["", "7 3", "2 3", "8 3 2 3", "4 4"][i % 5];

  // ---- a dial for each body that turns: its hand hangs down at the angle 0, and the dashed hand is where it is wanted ----
  function dials() {
    const slot = W / m.bodies.length, r = 58, y = 72;
    stage.setAttribute("viewBox", `0 0 ${W} ${2 * y}`);
    stage.setAttribute("aria-label", `angle of ${m.bodies.map((b) => b.name).join(", ")}`);
    stage.replaceChildren();
    const hand = (x, kind) => make("line", { x1: x, x2: x, y1: y, y2: y + r - 6, class: kind }, stage);
    shapes = m.bodies.flatMap((b, i) => {
      const x = slot * (i + 0.5), turned = (angle) => `rotate(${(-angle * 180) / Math.PI} ${x} ${y})`;
      make("circle", { cx: x, cy: y, r, class: "dial" }, stage);
      for (let k = 0; k < 12; k++) make("line", { x1: x, x2: x, y1: y + r - 4, y2: y + r, class: "ink", transform: `rotate(${30 * k} ${x} ${y})` }, stage);
      const shape = hand(x, "hand"), wanted = m.targets[b.name] && hand(x, "wanted");
      shape.style.stroke = colour(i);
      make("circle", { cx: x, cy: y, r: 4, class: "hub" }, stage);
      return [{ nodes: [shape], move: (k) => turned(b.x[k]) }, ...(wanted ? [{ nodes: [wanted], move: (k) => turned(m.targets[b.name][k]) }] : [])];
    });
    shapes.springs = [];
    const wanted = Object.keys(m.targets).length ? "; dashed: the target" : "";
    names.replaceChildren(...m.bodies.map((b, i) => keyed(b.name, colour(i), dash(i))), el("li", "soft", `hands: angles, 0 is down${wanted}`));
  }

  function keyed(text, stroke, dashes) {
    const item = el("li"), swatch = make("svg", { viewBox: "0 0 26 10", "aria-hidden": "true" });
    make("line", { x1: 0, x2: 26, y1: 5, y2: 5, "stroke-width": 3, "stroke-dasharray": dashes }, swatch).style.stroke = stroke;
    item.append(swatch, text);
    return item;
  }

  // ---- bodies in the plane, to scale; a body of one point is a disc, and one that turns is as large as its points are apart ----
  function plane() {
    const { bodies, ground, links, outlines } = m.plane, far = (b) => Math.max(0, ...b.points.map(([x, z]) => Math.hypot(x, z)));
    const across = (part) => [...bodies.flatMap((b) => b[part].flatMap((at) => [at - far(b), at + far(b)])), ...outlines.flat().flatMap((point) => point[part === "x" ? 0 : 1])];
    const xs = across("x"), zs = across("z").concat(ground.map(([, z]) => z));
    const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...zs), Math.max(...zs)], edge = 34;
    zoom = Math.min((W - 2 * edge) / (right - left || 1), 260 / (high - low || 1));
    const X = (x) => W / 2 + zoom * (x - 0.5 * (left + right)), base = edge + zoom * (high - low), Z = (z) => base - zoom * (z - low);
    stage.setAttribute("viewBox", `0 0 ${W} ${base + edge}`);
    stage.setAttribute("aria-label", `${bodies.map((b) => b.name).join(", ")} in the plane`);
    stage.replaceChildren();
    if (ground.length) {
      const line = [[0, ground[0][1]], ...ground.map(([x, z]) => [X(x), z]), [W, ground.at(-1)[1]]];
      make("polyline", { points: line.map(([x, z]) => `${x.toFixed(1)},${Z(z).toFixed(1)}`).join(" "), class: "ink", fill: "none" }, stage);
    }
    const rods = outlines.map(() => make("polyline", { class: "rod", fill: "none" }, stage));
    const ties = links.map(() => make("line", { class: "spring" }, stage)), heaviest = Math.max(...bodies.map((b) => b.mass));
    shapes = bodies.map((b, i) => {
      const w = Math.max(0, ...b.points.map(([x]) => Math.abs(x))) * zoom, h = Math.max(0, ...b.points.map(([, z]) => Math.abs(z))) * zoom, r = Math.max(13 * Math.sqrt(b.mass / heaviest), 4), group = make("g", {}, stage);
      const shape = b.angle && b.points.length ? make("rect", { x: -Math.max(w, 3), y: -Math.max(h, 3), width: 2 * Math.max(w, 3), height: 2 * Math.max(h, 3), rx: 2, class: "bodybox" }, group) : make("circle", { r, cy: ground.length ? -r : 0, class: "bodybox" }, group);
      shape.style.fill = colour(i);
      for (const [x, z] of b.points) make("circle", { cx: x * zoom, cy: -z * zoom, r: 3, class: "hub" }, group);
      return { nodes: [group], move: (k) => `translate(${X(b.x[k]).toFixed(2)} ${Z(b.z[k]).toFixed(2)})${b.angle ? ` rotate(${((-180 * b.angle[k]) / Math.PI).toFixed(3)})` : ""}` };
    });
    shapes.springs = [];
    shapes.ties = (k) => (rods.forEach((rod, j) => rod.setAttribute("points", outlines[j].map(([x, z]) => `${X(x[k]).toFixed(1)},${Z(z[k]).toFixed(1)}`).join(" "))), ties.forEach((tie, j) => links[j].forEach(([x, z], end) => {
      tie.setAttribute(`x${end + 1}`, X(x[k]));
      tie.setAttribute(`y${end + 1}`, Z(z[k]));
    })));
    const one = 10 ** Math.floor(Math.log10(120 / zoom));
    make("line", { x1: W - 10 - one * zoom, x2: W - 10, y1: 12, y2: 12, class: "scale" }, stage);
    const drawn = bodies.map((b, i) => {
      const item = el("li"), swatch = make("svg", { viewBox: "0 0 26 10", "aria-hidden": "true" });
      make("rect", { x: 6, y: 0, width: 14, height: 10 }, swatch).style.fill = colour(i);
      item.append(swatch, b.name);
      return item;
    });
    names.replaceChildren(...drawn, ...m.bodies.map((b, i) => keyed(`rate of ${b.name}`, colour(i), dash(i))), el("li", "", `bar: ${number(one)} mm`), el("li", "soft", "heights and ways are to scale"));
  }

  // ---- the bodies on their track ----
  function draw() {
    if (m.turns) return dials();
    if (m.plane) return plane();
    const slots = Math.max(...m.bodies.map((b) => b.place[0])) + 1, storeys = Math.max(...m.bodies.map((b) => b.place[1]));
    const slot = W / slots, most = Math.min(180, 0.6 * slot), heaviest = Math.max(...m.bodies.map((b) => b.mass));
    const wide = (b) => Math.max(most * Math.sqrt(b.mass / heaviest), 22), high = (b) => (wide(b) * 46) / most;
    const reach = Math.max(...m.bodies.flatMap((b) => b.x.map(Math.abs))) || 1, highest = Math.max(0, ...m.bodies.flatMap((b) => b.lift ?? []));
    zoom = Math.min(Math.min(0.5 * (slot - most) * (slots > 1 ? 0.85 : 0.5), 110) / reach, highest > 0 ? TALL / highest : Infinity);
    const ground = 76 + STOREY * storeys + zoom * highest;
    stage.setAttribute("viewBox", `0 0 ${W} ${ground + 16}`);
    stage.setAttribute("aria-label", `${m.bodies.map((b) => b.name).join(", ")} on the track`);
    stage.replaceChildren();
    make("line", { x1: 0, x2: W, y1: ground, y2: ground, class: "ink" }, stage);
    const home = (b) => slot * (b.place[0] + 0.5), mid = (b) => ground - STOREY * b.place[1] - 0.5 * high(b);
    shapes = m.bodies.map((b, i) => {
      make("line", { x1: home(b), x2: home(b), y1: b.place[1] ? mid(b) - 0.5 * high(b) - 10 : ground, y2: b.place[1] ? mid(b) - 0.5 * high(b) - 2 : ground + 9, class: "ink" }, stage);
      const shape = make("rect", { x: -0.5 * wide(b), width: wide(b), y: mid(b) - 0.5 * high(b), height: high(b), rx: 5, class: "bodybox" }, stage);
      shape.style.fill = colour(i);
      const name = make("text", { y: mid(b) }, stage);
      name.textContent = b.name;
      if (name.getComputedTextLength() > wide(b) - 6 || name.getBBox().height > high(b)) name.remove(); // the list below has every name
      return { nodes: [shape, name], move: (k) => `translate(${home(b) + zoom * b.x[k]} ${b.lift ? -zoom * b.lift[k] : 0})`, at: (k) => home(b) + zoom * b.x[k], lift: (k) => (b.lift ? zoom * b.lift[k] : 0), half: 0.5 * wide(b), up: 0.5 * high(b), y: mid(b), storey: b.place[1] };
    });
    shapes.springs = m.links.map(([a, b, gives]) => [a, b, gives, make("polyline", { class: "spring" }, stage)]);
    const one = zoom > 0 ? 10 ** Math.floor(Math.log10(120 / zoom)) : 1;
    make("line", { x1: W - 10 - one * zoom, x2: W - 10, y1: 12, y2: 12, class: "scale" }, stage);
    names.replaceChildren(...m.bodies.map((b, i) => {
      const item = el("li"), swatch = make("svg", { viewBox: "0 0 26 10", "aria-hidden": "true" });
      const mark = b.v ? make("line", { x1: 0, x2: 26, y1: 5, y2: 5, "stroke-width": 3, "stroke-dasharray": dash(i) }, swatch) : make("rect", { x: 6, y: 0, width: 14, height: 10 }, swatch);
      mark.style[b.v ? "stroke" : "fill"] = colour(i);
      item.append(swatch, b.name);
      return item;
    }), el("li", "", `bar: ${number(one)} ${m.lengths} of motion`), el("li", "soft", "areas are proportional to masses; distances between bodies are not to scale"));
  }

  // ---- velocities and contacts over time ----
  function row(name, height, kind) {
    const part = el("div", `row ${kind}`), svg = make("svg", { viewBox: `0 0 ${W} ${height}`, preserveAspectRatio: "none", role: "img" });
    part.append(el("span", "", name), svg);
    lines.append(part);
    return svg;
  }

  // A trace of its own: angle, error, torque.
  function trace({ name, unit, curves }) {
    const tall = 110, all = curves.flatMap(([, y]) => y), low = Math.min(0, ...all), high = Math.max(0, ...all), level = (y) => 6 + ((tall - 12) * (high - y)) / (high - low || 1);
    const svg = row(name, tall, "velocity trace-of-own"), list = el("ul", "names");
    svg.setAttribute("aria-label", `${name}: ${curves.map(([which, y]) => `${which}, ${number(Math.min(...y), 3)} to ${number(Math.max(...y), 3)} ${unit}`).join("; ")}`);
    svg.previousSibling.append(el("small", "", `${number(high, 3)} ${unit}`), el("small", "", number(low, 3)));
    make("line", { x1: 0, x2: W, y1: level(0), y2: level(0), class: "faint" }, svg);
    curves.forEach(([which, y], i) => {
      const curve = make("polyline", { points: y.map((value, k) => `${across(m.t[k]).toFixed(1)},${level(value).toFixed(1)}`).join(" "), class: "trace", "stroke-dasharray": dash(i) }, svg);
      curve.style.stroke = colour(i);
      if (curves.length > 1) list.append(keyed(which, colour(i), dash(i)));
    });
    if (curves.length > 1) lines.append(list);
    cursors.push(make("line", { y1: 0, y2: tall, class: "cursor" }, svg));
  }

  function graphs() {
    lines.replaceChildren();
    cursors = [];
    (m.traces ?? []).forEach(trace);
    const moved = m.bodies.filter((b) => b.v), all = moved.flatMap((b) => b.v), size = TALL - 16;
    const [low, high] = [Math.min(0, ...all), Math.max(0, ...all)].map((v, _, ends) => zeroed(v, ends[1] - ends[0]));
    up = (v) => 8 + (size * (high - v)) / (high - low || 1);
    const svg = row("velocity", TALL, "velocity"), top = el("small", "", `${number(high, 3)} ${m.speeds}`), bottom = el("small", "", number(low, 3));
    svg.setAttribute("aria-label", `velocity of ${moved.map((b) => b.name).join(", ")}: ${number(low, 3)} to ${number(high, 3)} ${m.speeds}`);
    svg.previousSibling.append(top, bottom);
    make("line", { x1: 0, x2: W, y1: up(0), y2: up(0), class: "faint" }, svg);
    for (const [i, b] of m.bodies.entries()) {
      if (!b.v) continue;
      const curve = make("polyline", { points: b.v.map((v, k) => `${across(m.t[k]).toFixed(1)},${up(v).toFixed(1)}`).join(" "), class: "trace", "stroke-dasharray": dash(i) }, svg);
      curve.style.stroke = colour(i);
    }
    cursors.push(make("line", { y1: 0, y2: TALL, class: "cursor" }, svg));
    for (const r of m.rows) {
      const bars = row(r.name, 20, "bars"), share = (sign) => r.stretches.filter((s) => s[2] === sign).reduce((sum, [a, b]) => sum + b - a, 0) / m.t[n - 1];
      const words = [[1, "forwards"], [-1, "backwards"], [0, "sticks"], [2, "pressed"], [3, "in flight"]].filter(([sign]) => share(sign) > 0).map(([sign, word]) => `${word} ${(100 * share(sign)).toFixed(0)} %`);
      bars.setAttribute("aria-label", `${r.name}: ${[...words, ...(r.hits.length ? [`${r.hits.length} hits`] : [])].join(", ") || "never touched"}`);
      for (const [a, b, sign] of r.stretches) {
        const [y, height] = { 1: [1, 9], "-1": [10, 9], 0: [8, 4], 2: [1, 18], 3: [9, 2] }[sign];
        make("rect", { x: across(a), width: Math.max(across(b) - across(a), 1), y, height, class: ["back", "stick", "fore", "press", "flight"][sign + 1] }, bars);
      }
      for (const t of r.hits) make("polygon", { points: `${across(t) - 6},2 ${across(t) + 6},2 ${across(t)},18`, class: "hit" }, bars);
      cursors.push(make("line", { y1: 0, y2: 20, class: "cursor" }, bars));
    }
    const scale = el("div", "row ticks"), ticks = el("div");
    const end = m.t[n - 1], power = 10 ** Math.floor(Math.log10(end / 3)), step = power * [5, 2, 1].find((k) => k * power <= end / 3);
    for (let k = 0; k * step <= end * (1 + 1e-9); k++) {
      const last = (k + 1) * step > end * (1 + 1e-9), tick = el("small", "", number(k * step, 3) + (last ? ` ${m.unit}` : ""));
      tick.style.left = `${(100 * k * step) / end}%`;
      if (k * step > 0.9 * end) tick.className = "last"; // its text ends there, so that nothing sticks out
      ticks.append(tick);
    }
    scale.append(el("span"), ticks);
    lines.append(scale);
    const key = el("ul", "names key"), seen = new Set(m.rows.flatMap((r) => r.stretches.map((s) => s[2])));
    if (m.rows.some((r) => r.hits.length)) seen.add(4);
    for (const [sign, kind, word, y, height] of [[1, "fore", "forwards", 0, 5], [-1, "back", "backwards", 5, 5], [0, "stick", "sticks", 4, 2], [2, "press", "stop pressed", 0, 10], [3, "flight", "in flight", 4, 2], [4, "hit", "hit", 0, 10]]) {
      if (!seen.has(sign)) continue;
      const item = el("li"), swatch = make("svg", { viewBox: "0 0 26 10", "aria-hidden": "true" });
      if (sign === 4) make("polygon", { points: "8,0 18,0 13,10", class: kind }, swatch);
      else make("rect", { x: 0, width: 26, y, height, class: kind }, swatch);
      item.append(swatch, word);
      key.append(item);
    }
    lines.append(key);
  }

  // ---- one instant ----
  function spring([a, b, gives, path]) {
    const k = Number(when.value), ends = [a, b].filter((i) => i >= 0).map((i) => shapes[i]).sort((p, q) => p.at(k) - q.at(k)), [p, q] = ends, y = (s) => s.y - s.lift(k);
    let x0 = 0, y0 = y(p), x1 = p.at(k) - p.half, y1 = y(p); // from the wall at the left
    if (q && p.storey === q.storey) [x0, y0, x1, y1] = [p.at(k) + p.half, y(p), q.at(k) - q.half, y(q)];
    else if (q) {
      const [low, high] = p.storey < q.storey ? [p, q] : [q, p];
      [x0, y0, x1, y1] = [low.at(k), y(low) - low.up, high.at(k), y(high) + high.up];
    }
    const way = Math.hypot(x1 - x0, y1 - y0) || 1, [nx, ny] = [(y0 - y1) / way, (x1 - x0) / way];
    path.setAttribute("points", Array.from({ length: 13 }, (_, i) => {
      const s = i / 12, off = gives && i > 1 && i < 11 ? (i % 2 ? 5 : -5) : 0;
      return `${(x0 + s * (x1 - x0) + off * nx).toFixed(1)},${(y0 + s * (y1 - y0) + off * ny).toFixed(1)}`;
    }).join(" "));
  }

  function at(k) {
    for (const s of shapes) for (const node of s.nodes) node.setAttribute("transform", s.move(k));
    shapes.springs.forEach(spring);
    shapes.ties?.(k);
    for (const c of cursors) for (const end of ["x1", "x2"]) c.setAttribute(end, across(m.t[k]));
    const angles = m.turns ? ` ${m.bodies.map((b) => `${b.name} ${number(b.x[k])}`).join(", ")} ${m.lengths};` : "";
    out.textContent = `t = ${number(m.t[k])} ${m.unit};${angles} v = ${m.bodies.filter((b) => b.v).map((b) => number(zeroed(b.v[k], Math.max(...b.v.map(Math.abs))))).join(", ")} ${m.speeds}`;
    when.setAttribute("aria-valuetext", out.textContent);
  }

  function step() {
    when.value = (Number(when.value) + 2) % n;
    at(Number(when.value));
    timer = requestAnimationFrame(step);
  }

  play.addEventListener("click", () => {
    play.textContent = timer === null ? "Pause" : "Play";
    if (timer === null) return step();
    cancelAnimationFrame(timer);
    timer = null;
  });
  when.addEventListener("input", () => at(Number(when.value)));

  function show(data) {
    m = data;
    n = m.t.length;
    when.max = n - 1;
    draw();
    graphs();
    at(Math.min(Number(when.value), n - 1));
    box.dataset.drawn = String(Number(box.dataset.drawn ?? 0) + 1);
  }
  show(first);
  return show;
}
