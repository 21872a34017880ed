// A canvas with axes: sharp on any screen, in the colours of the page.
import { digits } from "./words.js";

export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
export const DASHES = [[], [7, 3], [2, 2.5], [8, 3, 2, 3], [12, 3]];

// Round steps between two numbers, about so many.
export function ticks(low, high, count) {
  const raw = (high - low) / count, size = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * size).find((s) => s >= raw * 0.999);
  const found = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; i++) found.push(i * step);
  return found;
}

// A range that follows its data without trembling: it grows at once, and shrinks when there is much room.
export function steady(old, low, high, room = 0.06) {
  const size = high - low || Math.abs(high) || 1;
  const wanted = [low - room * size, high + room * size];
  if (!old || low < old[0] || high > old[1] || high - low < 0.6 * (old[1] - old[0])) return wanted;
  return old;
}

export function extent(...columns) {
  let low = Infinity, high = -Infinity;
  for (const column of columns) for (const x of column) if (x < low || x > high) { if (x < low) low = x; if (x > high) high = x; }
  return low <= high ? [low, high] : [0, 1];
}

export class Plane {
  constructor(canvas, redraw) {
    Object.assign(this, { canvas, pen: canvas.getContext("2d") });
    new ResizeObserver(() => redraw()).observe(canvas);
  }

  // Clear, and draw axes for these spans [in shown units].
  begin(xs, ys, xlabel, ylabel) {
    const { canvas, pen } = this, ratio = devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
    }
    const size = (this.size = parseFloat(getComputedStyle(document.documentElement).fontSize) * 0.76);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, w, h);
    pen.font = `${size}px system-ui, sans-serif`;
    const widest = (found) => Math.max(...found.map((value) => pen.measureText(digits(value, 6)).width), 0);
    const top = size * 0.6, bottom = h - size * 3.1, rows = ticks(...ys, Math.max((bottom - top) / (size * 3), 2));
    const left = size * Math.ceil(widest(rows) / size + 2.1); // whole sizes, so that the frame does not tremble
    const columns = ticks(...xs, Math.max((w - left - size) / (size * 6), 2)), right = w - Math.max(size, 0.5 * widest(columns.slice(-1)) + 2);
    Object.assign(this, { xs, ys, left, right, top, bottom, rows, columns, w, h });
    this.axes(xlabel, ylabel);
    return this;
  }

  x(value) { return this.left + ((value - this.xs[0]) / (this.xs[1] - this.xs[0])) * (this.right - this.left); }
  y(value) { return this.bottom - ((value - this.ys[0]) / (this.ys[1] - this.ys[0])) * (this.bottom - this.top); }
  atX(px) { return this.xs[0] + ((px - this.left) / (this.right - this.left)) * (this.xs[1] - this.xs[0]); }
  atY(py) { return this.ys[0] + ((this.bottom - py) / (this.bottom - this.top)) * (this.ys[1] - this.ys[0]); }

  axes(xlabel, ylabel) {
    const { pen, left, right, top, bottom, size } = this, grid = colour("grid"), soft = colour("soft");
    pen.lineWidth = 1;
    pen.fillStyle = soft;
    pen.textAlign = "center";
    for (const value of this.columns) {
      this.stroke([[this.x(value), top], [this.x(value), bottom]], grid);
      pen.fillText(digits(value, 6), this.x(value), bottom + size * 1.25);
    }
    pen.textAlign = "right";
    for (const value of this.rows) {
      this.stroke([[left, this.y(value)], [right, this.y(value)]], grid);
      pen.fillText(digits(value, 6), left - size * 0.4, this.y(value) + size * 0.35);
    }
    pen.textAlign = "center";
    const half = 0.5 * Math.min(pen.measureText(xlabel).width, this.w); // a long title goes over the sides of the frame, and is squeezed at last
    pen.fillText(xlabel, Math.min(Math.max((left + right) / 2, half), this.w - half), bottom + size * 2.65, this.w);
    pen.save();
    pen.translate(size * 0.9, (top + bottom) / 2);
    pen.rotate(-Math.PI / 2);
    pen.fillText(ylabel, 0, 0, bottom - top + size * 3);
    pen.restore();
    this.stroke([[left, top], [left, bottom], [right, bottom]], soft);
  }

  stroke(points, style, width = 1, dash = []) {
    const { pen } = this;
    pen.beginPath();
    points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
    Object.assign(pen, { strokeStyle: style, lineWidth: width });
    pen.setLineDash(dash);
    pen.stroke();
    pen.setLineDash([]);
  }

  // A curve through data, kept within the axes.
  curve(xs, ys, xfactor, yfactor, style, dash = [], width = 1.6) {
    const { pen } = this;
    pen.save();
    pen.beginPath();
    pen.rect(this.left, this.top, this.right - this.left, this.bottom - this.top);
    pen.clip();
    const points = new Array(xs.length);
    for (let i = 0; i < xs.length; i++) points[i] = [this.x(xs[i] * xfactor), this.y(ys[i] * yfactor)];
    this.stroke(points, style, width, dash);
    pen.restore();
  }

  ring(x, y, style, radius = 3.2) {
    const { pen } = this;
    pen.beginPath();
    pen.arc(this.x(x), this.y(y), radius, 0, 7);
    Object.assign(pen, { fillStyle: colour("card"), strokeStyle: style, lineWidth: 1.4 });
    pen.fill();
    pen.stroke();
  }
}
