"use strict";
// Charts that can be asked: point or press arrow keys for values, drag to zoom, double-click for all, a button for each curve.
// Where this does not run, and in print, the picture of the same curves stands in the chart's place.
(() => {
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const minus = (text) => text.replace("-", "\u2212");
  const told = (value, unit) => (value == null ? "\u2013" : minus(String(Number(value.toPrecision(5)))) + (unit && " " + unit));

  function chart(figure, spec) {
    const box = figure.querySelector(".chart"), plot = box.querySelector(".plot"), keys = box.querySelector(".keys"), where = box.querySelector("output");
    const hint = where.textContent, visible = spec.curves.map(() => true), colour = (c) => ink(c.plain ? "--ink" : "--c" + c.colour);
    const buttons = spec.curves.map((c, i) => key(c, i)), values = buttons.map((b) => b.querySelector("b"));
    const whole = document.createElement("button");
    let u = null, typed = null; // the place that keys went to: at a jump two points have one x
    const place = () => typed ?? u?.cursor.idx ?? null;

    function key(c, i) {
      const button = document.createElement("button");
      button.type = "button";
      button.setAttribute("aria-pressed", "true");
      button.innerHTML = '<svg viewBox="0 0 26 8" aria-hidden="true"><line x1="1" x2="25" y1="4" y2="4"/></svg> <span></span> <b></b>';
      const line = button.querySelector("line");
      line.style.stroke = "var(" + (c.plain ? "--ink" : "--c" + c.colour) + ")";
      line.style.strokeDasharray = c.points ? "0 8" : c.dash.join(" ");
      if (c.points) line.style.strokeLinecap = "round", (line.style.strokeWidth = 6);
      button.querySelector("span").textContent = c.label;
      button.addEventListener("click", () => {
        visible[i] = !visible[i];
        button.setAttribute("aria-pressed", String(visible[i]));
        u.setSeries(i + 1, { show: visible[i] });
      });
      return button;
    }

    function axis([label, unit], side) {
      const size = parseFloat(getComputedStyle(plot).fontSize), font = 0.8 * size + "px system-ui, sans-serif";
      return {
        label: unit ? `${label} [${unit}]` : label, font, labelFont: font, labelSize: 1.35 * size, size: side * size, gap: 4, labelGap: 0,
        space: side < 2 ? 5 * size : 2 * size, stroke: ink("--soft"), grid: { stroke: ink("--line"), width: 1 }, ticks: { show: false },
        values: (_, found) => found.map((v) => (v == null ? "" : minus(String(Number(v.toPrecision(6)))))),
      };
    }

    function shade(self) {
      self.ctx.save();
      self.ctx.fillStyle = ink("--shade");
      for (const [a, b] of spec.shade) {
        const from = Math.max(self.valToPos(a, "x", true), self.bbox.left), to = Math.min(self.valToPos(b, "x", true), self.bbox.left + self.bbox.width);
        if (to > from) self.ctx.fillRect(from, self.bbox.top, to - from, self.bbox.height);
      }
      self.ctx.restore();
    }

    function tell() {
      const i = place(), [name, unit] = spec.across;
      where.textContent = i === null ? hint : `${name} ${told(spec.x[i], unit)}`;
      values.forEach((b, k) => (b.textContent = i === null ? "" : told(spec.curves[k].y[i], spec.up[1])));
    }

    function size() {
      const width = Math.floor(plot.clientWidth);
      return { width, height: Math.round(Math.min(Math.max(0.55 * width, 190), 300)) };
    }

    function make() {
      const before = u && [u.scales.x.min, u.scales.x.max];
      u?.destroy();
      const series = spec.curves.map((c, i) => ({
        label: c.label, stroke: colour(c), width: c.plain ? 1 : 1.8, dash: c.dash, show: visible[i], spanGaps: false,
        paths: c.points ? () => null : undefined, points: { show: c.points, size: 6, fill: colour(c) },
      }));
      u = new uPlot({
        ...size(), legend: { show: false }, padding: [8, 18, 0, 0], scales: { x: { time: false } },
        cursor: { drag: { x: true, y: false }, points: { size: 7 } },
        axes: [axis(spec.across, 1.7), axis(spec.up, 3.6)], series: [{}, ...series], hooks: { drawClear: [shade], setCursor: [tell] },
      }, [spec.x, ...spec.curves.map((c) => c.y)], plot);
      if (before) u.setScale("x", { min: before[0], max: before[1] });
    }

    function zoom(factor) {
      const first = spec.x[0], last = spec.x.at(-1), { min, max } = u.scales.x, at = place() === null ? (min + max) / 2 : spec.x[place()];
      const low = Math.max(first, at - factor * (at - min)), high = Math.min(last, at + factor * (max - at));
      u.setScale("x", factor ? { min: low, max: high } : { min: first, max: last });
    }

    function pressed(event) {
      const by = { ArrowLeft: -1, ArrowRight: 1 }[event.key], factor = { "+": 0.5, "=": 0.5, "-": 2, 0: 0 }[event.key];
      if (by === undefined && factor === undefined) return;
      event.preventDefault();
      if (by === undefined) return zoom(factor);
      const seen = spec.x.map((x, i) => i).filter((i) => spec.x[i] >= u.scales.x.min && spec.x[i] <= u.scales.x.max);
      const now = seen.indexOf(place());
      typed = seen[now < 0 ? 0 : Math.min(Math.max(now + by * (event.shiftKey ? 20 : 1), 0), seen.length - 1)];
      u.setCursor({ left: u.valToPos(spec.x[typed], "x"), top: u.over.clientHeight / 2 });
    }

    box.hidden = false;
    figure.classList.add("asked");
    whole.type = "button";
    whole.textContent = "Show all";
    whole.addEventListener("click", () => zoom(0));
    keys.append(...buttons, whole);
    plot.addEventListener("keydown", pressed);
    plot.addEventListener("mousemove", () => (typed = null), true);
    make();
    new ResizeObserver(() => u.width !== size().width && u.setSize(size())).observe(plot);
    dark.addEventListener("change", make);
  }

  const specs = JSON.parse(document.getElementById("charts").textContent);
  for (const figure of document.querySelectorAll("figure[data-chart]")) {
    try {
      chart(figure, specs[Number(figure.dataset.chart)]);
    } catch (error) {
      figure.classList.remove("asked");
      figure.querySelector(".chart").hidden = true;
      console.error(error);
    }
  }
})();
