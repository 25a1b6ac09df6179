// SPDX-License-Identifier: MIT
// Plots over time from the columns of steps.csv. What follows the mouse and the animation are elements of their own above
// the canvas, so that nothing is drawn again while the animation plays.

const PHASES = [["stage1_collisions_ms", "1 collisions"], ["stage2_velocity_ms", "2 velocity"],
  ["stage3_static_contact_ms", "3 static contact"], ["stage4_position_ms", "4 position"],
  ["stage5_dynamic_contact_ms", "5 dynamic contact"], ["stage5_failsafe_ms", "5 failsafe"],
  ["stage6_velocity_ms", "6 velocity"], ["stage7_static_contact_ms", "7 static contact"],
  ["certificate_ms", "certificate"]];

/** `nothing`: said where all values are zero or missing. `log`: values that are not positive are left out. */
const CHARTS = [
  { title: "Time per step by phase", unit: "ms", stacked: true, wide: true, series: PHASES },
  { title: "Contacts and collisions", unit: "per step", series: [["contacts", "contacts solved"],
      ["sleeping_contacts", "contacts asleep"], ["collisions", "collision impulses"]] },
  { title: "Energy", unit: "J", series: [["energy", "total"], ["kinetic_energy", "kinetic"]] },
  { title: "Momentum", unit: "kg m/s", series: [["momentum_x", "x"], ["momentum_y", "y"], ["momentum_z", "z"]] },
  { title: "Smallest distance", unit: "m", log: true, series: [["min_distance", "at the end of the step"]],
    nothing: "nothing came within the proximity distance" },
  { title: "Failsafe: clusters", unit: "per step", nothing: "no merge, rung change, cluster or held body in this run",
    series: [["merges", "merges"], ["rung_changes", "rung changes"], ["kinematic_bodies", "bodies in kinematic clusters"],
      ["rigid_bodies", "in rigid clusters"], ["held", "held"]] },
  { title: "Sleeping", unit: "bodies", series: [["sleeping", "asleep"]], nothing: "no body fell asleep in this run" },
  { title: "Residual of the contact solver", unit: "m/s", log: true, series: [["residual", "largest violation left"]],
    nothing: "no contact left a residual" },
  { title: "Candidate pairs", unit: "per step", series: [["pairs", "body pairs examined"]] },
  { title: "Sweeps of the contact solver", unit: "per step", series: [["iterations", "stages 3 and 7 together"]] },
  { title: "Detection and response", unit: "ms, threads together", stacked: true,
    series: [["detection_ms", "collision detection"], ["response_ms", "collision response"],
      ["static_detection_ms", "contact detection"], ["static_response_ms", "contact solves"]] },
];

const COLOURS = ["#3b82c4", "#e08a2e", "#3aa17e", "#c9503f", "#8a63b8", "#d4a72c", "#7d8894", "#3fa9b8", "#b85c8a"];
const MARGIN = { left: 58, right: 12, top: 8, bottom: 22 };

function shortNumber(value) {
  if (Number.isNaN(value)) return "–";
  const size = Math.abs(value);
  if (size === 0 || (size >= 1e-3 && size < 1e6)) return String(Number(value.toPrecision(4)));
  return value.toExponential(2).replace(/\.?0*e\+?/, "e");
}

/** About `count` round numbers that span [low, high]. */
function roundTicks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((m) => m * power >= raw);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9) + 1e-300; ++k) ticks.push(k * step);
  return ticks;
}

/** Round numbers in [low, high] for a logarithmic axis: powers of ten, or some of them, or 2 and 5 times these as well. */
function logTicks(low, high) {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high));
  const every = Math.max(1, Math.ceil((last - first) / 6)), parts = last - first > 3 ? [1] : [1, 2, 5];
  const ticks = [];
  for (let k = first; k <= last; k += every) ticks.push(...parts.map((part) => part * 10 ** k));
  return ticks.filter((value) => value >= low && value <= high);
}

const element = (tag, className = "", text = "") => {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.textContent = text;
  return made;
};

class Chart {
  /** columns: Float32Array by name; `time` and `step` among them. player moves the cursor and is moved by the mouse. */
  constructor(spec, columns, span, player) {
    Object.assign(this, { spec, player, span, times: columns.time ?? new Float32Array(0), steps: columns.step });
    this.series = spec.series.filter(([name]) => columns[name])
      .map(([name, label], i) => ({ label, colour: COLOURS[i], values: columns[name] }));
    this.hover = -1;
    this.build();
    this.range = this.findRange();
    this.nothing.textContent = this.range ? "" : spec.nothing ?? "zero throughout";
  }

  build() {
    this.card = element("div", `card chart${this.spec.wide ? " wide" : ""}`);
    const head = element("div", "head"), title = element("h2", "", this.spec.title + " "), legend = element("div", "legend");
    title.append(element("span", "unit", this.spec.unit));
    for (const { label, colour } of this.series) {
      const entry = element("span"), swatch = element("i");
      swatch.style.background = colour;
      entry.append(swatch, label);
      legend.append(entry);
    }
    head.append(title, legend);
    this.plot = element("div", "plot");
    this.canvas = element("canvas");
    this.cursor = element("div", "cursor");
    this.marker = element("div", "cursor marker"); // under the mouse
    this.nothing = element("p", "nothing");
    this.tip = element("div", "tip");
    this.tip.hidden = true;
    this.plot.append(this.canvas, this.marker, this.cursor, this.nothing, this.tip);
    this.card.append(head, this.plot);
    this.listen();
  }

  listen() {
    const timeAt = (event) => {
      const box = this.plot.getBoundingClientRect();
      return this.timeOf(event.clientX - box.left);
    };
    this.plot.addEventListener("pointermove", (event) => {
      this.hover = this.rowNear(timeAt(event));
      if (event.buttons & 1) this.player.seek(timeAt(event));
      this.showHover();
    });
    this.plot.addEventListener("pointerdown", (event) => {
      this.plot.setPointerCapture(event.pointerId);
      this.player.seek(timeAt(event));
    });
    this.plot.addEventListener("pointerleave", () => { this.hover = -1; this.showHover(); });
  }

  /** The lowest and highest value, or nothing where there is nothing to draw. */
  findRange() {
    const { log, stacked } = this.spec;
    let low = Infinity, high = -Infinity;
    for (let row = 0; row < this.times.length; ++row) {
      let sum = 0;
      for (const { values } of this.series) {
        const value = values[row];
        if (Number.isNaN(value) || (log && value <= 0)) continue;
        sum = stacked ? sum + value : value;
        low = Math.min(low, sum);
        high = Math.max(high, sum);
      }
    }
    if (!(low <= high) || (low === 0 && high === 0)) return null;
    if (log) return [low / 1.5, high * 1.5];
    return [Math.min(low, 0) * 1.04, Math.max(high, 0) * 1.04];
  }

  get width() { return this.plot.clientWidth; }
  get height() { return this.plot.clientHeight; }
  x(time) {
    const part = (time - this.span[0]) / (this.span[1] - this.span[0]);
    return MARGIN.left + part * (this.width - MARGIN.left - MARGIN.right);
  }
  timeOf(x) {
    const part = (x - MARGIN.left) / (this.width - MARGIN.left - MARGIN.right);
    return this.span[0] + Math.min(Math.max(part, 0), 1) * (this.span[1] - this.span[0]);
  }
  y(value) {
    const [low, high] = this.spec.log ? this.range.map(Math.log) : this.range;
    const part = ((this.spec.log ? Math.log(value) : value) - low) / (high - low);
    return this.height - MARGIN.bottom - part * (this.height - MARGIN.top - MARGIN.bottom);
  }

  rowNear(time) {
    let low = 0, high = this.times.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.times[middle] < time) low = middle + 1; else high = middle;
    }
    return low > 0 && time - this.times[low - 1] < this.times[low] - time ? low - 1 : low;
  }

  /** The canvas at the plot's size, cleared, in CSS pixels. */
  context() {
    const ratio = devicePixelRatio || 1;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    const context = this.canvas.getContext("2d");
    context.scale(ratio, ratio);
    context.font = "12px system-ui, sans-serif";
    return context;
  }

  draw() {
    const context = this.context();
    if (this.range) {
      this.drawAxes(context);
      if (this.spec.stacked) this.drawStack(context); else this.drawLines(context);
    }
    this.showTime();
    this.showHover();
  }

  drawAxes(context) {
    const style = getComputedStyle(document.documentElement);
    context.fillStyle = style.getPropertyValue("--soft");
    context.strokeStyle = style.getPropertyValue("--grid");
    context.lineWidth = 1;
    const line = (x0, y0, x1, y1) => {
      context.beginPath();
      context.moveTo(Math.round(x0) + 0.5, Math.round(y0) + 0.5);
      context.lineTo(Math.round(x1) + 0.5, Math.round(y1) + 0.5);
      context.stroke();
    };
    const [low, high] = this.range, bottom = this.height - MARGIN.bottom;
    context.textAlign = "right";
    context.textBaseline = "middle";
    const ticks = this.spec.log ? logTicks(low, high) : roundTicks(low, high, Math.max(2, this.height / 45));
    for (const value of ticks) {
      line(MARGIN.left, this.y(value), this.width - MARGIN.right, this.y(value));
      context.fillText(shortNumber(Number(value.toPrecision(12))), MARGIN.left - 7, this.y(value));
    }
    context.textAlign = "center";
    context.textBaseline = "alphabetic";
    for (const time of roundTicks(this.span[0], this.span[1], Math.max(2, this.width / 90))) {
      line(this.x(time), MARGIN.top, this.x(time), bottom);
      context.fillText(`${Number(time.toPrecision(12))} s`, Math.min(this.x(time), this.width - 16), this.height - 6);
    }
  }

  drawStack(context) {
    const below = new Float64Array(this.times.length);
    for (const { values, colour } of this.series) {
      context.beginPath();
      for (let row = 0; row < below.length; ++row) context.lineTo(this.x(this.times[row]), this.y(below[row]));
      for (let row = below.length - 1; row >= 0; --row) {
        below[row] += values[row] || 0;
        context.lineTo(this.x(this.times[row]), this.y(below[row]));
      }
      context.fillStyle = colour;
      context.fill();
    }
  }

  drawLines(context) {
    for (const { values, colour } of this.series) {
      context.beginPath();
      let broken = true; // a missing value interrupts the line
      for (let row = 0; row < this.times.length; ++row) {
        const value = values[row];
        if (Number.isNaN(value) || (this.spec.log && value <= 0)) { broken = true; continue; }
        const x = this.x(this.times[row]), y = this.y(value);
        if (broken) { context.moveTo(x - 0.5, y); broken = false; }
        context.lineTo(x, y);
      }
      context.strokeStyle = colour;
      context.lineWidth = 1.6;
      context.lineJoin = "round";
      context.stroke();
    }
  }

  /** Moves the cursor to the time of the animation. */
  showTime() {
    this.cursor.hidden = this.range === null;
    this.cursor.style.transform = `translateX(${this.x(this.player.time).toFixed(1)}px)`;
  }

  /** The values under the mouse. */
  showHover() {
    const shown = this.range !== null && this.hover >= 0 && this.hover < this.times.length;
    this.tip.hidden = this.marker.hidden = !shown;
    if (!shown) return;
    const x = this.x(this.times[this.hover]);
    this.marker.style.transform = `translateX(${x.toFixed(1)}px)`;
    this.fillTip();
    const left = x + 12 + this.tip.offsetWidth < this.width ? x + 12 : x - 12 - this.tip.offsetWidth;
    this.tip.style.left = `${Math.max(left, 0)}px`;
  }

  fillTip() {
    const row = this.hover, time = Number(this.times[row].toPrecision(6));
    const head = element("div", "", `step ${this.steps?.[row] ?? "?"}, t = ${time} s`);
    const lines = this.series.map(({ label, colour, values }) => {
      const line = element("div"), name = element("span"), swatch = element("i");
      swatch.style.background = colour;
      name.append(swatch, label);
      line.append(name, element("span", "", shortNumber(values[row])));
      return line;
    });
    if (this.spec.stacked) {
      const line = element("div"), sum = this.series.reduce((total, { values }) => total + (values[row] || 0), 0);
      line.append(element("b", "", "together"), element("b", "", shortNumber(sum)));
      lines.reverse().unshift(line); // in the order of the stack, from the top
    }
    this.tip.replaceChildren(head, ...lines);
  }
}
