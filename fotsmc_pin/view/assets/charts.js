// The plots under the arm: uPlot charts with one playhead, which can be dragged.

const CHART_HEIGHT = 164;

class Chart {
  constructor(parent, kind, onSeek) {
    this.kind = kind;
    this.onSeek = onSeek;
    this.host = document.createElement("figure");
    this.host.className = "chart";
    this.caption = document.createElement("figcaption");
    this.plotArea = document.createElement("div");
    this.host.append(this.caption, this.plotArea);
    parent.append(this.host);
    new ResizeObserver(() => this.resize()).observe(this.host);
  }

  // content: { title, unit, lines: [{ label, color, t, y }], limits: [{ value, color }], log,
  // marks: [{ time, end, color }] }
  draw(content, time) {
    this.content = content;
    this.caption.textContent = `${content.title} [${content.unit}]${content.note ?? ""}`;
    this.plotArea.setAttribute("role", "img");
    this.plotArea.setAttribute(
      "aria-label",
      `${content.title} over time, in ${content.unit}: ${content.lines.map((l) => l.label).join(", ")}`
    );
    this.plot?.destroy();
    this.playhead = null;
    this.time = time;
    const limits = content.log ? [] : content.limits;
    const tables = content.lines.map(({ t, y }) => [t, content.log ? y.map(Math.abs) : y]);
    const shared = tables.every(([t]) => t === tables[0][0]);
    const data = shared ? [tables[0][0], ...tables.map(([, y]) => y)] : uPlot.join(tables);
    const span = [data[0][0], data[0][data[0].length - 1]];
    this.plot = new uPlot(this.options(content, limits, span), data, this.plotArea);
    this.playhead = document.createElement("div");
    this.playhead.className = "playhead";
    this.plot.over.append(this.playhead);
    this.listen(this.plot.over);
    this.seek(time);
  }

  options(content, limits, span) {
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue("--muted").trim();
    const rule = style.getPropertyValue("--rule").trim();
    const axis = {
      stroke: ink,
      font: "11px system-ui, sans-serif",
      grid: { stroke: rule, width: 1 },
      ticks: { stroke: rule, width: 1, size: 4 },
    };
    return {
      width: this.width(),
      height: CHART_HEIGHT,
      legend: { show: false },
      padding: [6, 10, 0, 0],
      cursor: { drag: { x: false, y: false }, points: { show: false }, y: false, x: true },
      scales: {
        x: { time: false, range: () => span },
        y: content.log
          ? { distr: 3, range: (_, low, high) => logRange(low, high) }
          : { range: (_, low, high) => linearRange(low, high, limits) },
      },
      axes: [
        { ...axis, size: 24, gap: 3, label: "time [s]", labelSize: 15, labelGap: 0, labelFont: axis.font, values: (_, ticks) => ticks.map((v) => `${+v.toFixed(6)}`) },
        {
          ...axis,
          size: 58,
          gap: 4,
          space: 26,
          ...(content.log ? { filter: decades, grid: { ...axis.grid, filter: decades }, ticks: { ...axis.ticks, filter: decades } } : {}),
          values: (_, ticks) => ticks.map((v) => (v === null ? "" : shortNumber(v))),
        },
      ],
      pxAlign: 0,
      series: [
        {},
        ...content.lines.map(({ label, color }) => ({
          label, stroke: color, width: 1.4, pxAlign: 0, points: { show: false }, spanGaps: true,
        })),
      ],
      hooks: { drawClear: [(plot) => content.marks.forEach((mark) => drawMark(plot, mark))], draw: [(plot) => limits.forEach((limit) => drawLimit(plot, limit)), () => this.place()] },
    };
  }

  listen(over) {
    const seek = (event) => {
      const x = event.clientX - over.getBoundingClientRect().left;
      this.onSeek(this.plot.posToVal(x, "x"));
    };
    over.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      over.setPointerCapture(event.pointerId);
      seek(event);
    });
    over.addEventListener("pointermove", (event) => {
      if (over.hasPointerCapture(event.pointerId)) seek(event);
    });
  }

  seek(time) {
    if (!this.plot) return;
    this.time = time;
    this.place();
  }

  // Also after each drawing: only then has the plot its scales.
  place() {
    if (!this.playhead) return;
    this.playhead.style.transform = `translateX(${this.plot.valToPos(this.time, "x")}px)`;
  }

  width() {
    return Math.max(this.host.clientWidth, 160);
  }

  resize() {
    if (!this.plot || this.plot.width === this.width()) return;
    this.plot.setSize({ width: this.width(), height: CHART_HEIGHT });
    this.seek(this.time);
  }
}

// The range of the curves with some air; limits that are not far off belong to it.
function linearRange(low, high, limits) {
  if (low === null || high === null || !Number.isFinite(low + high)) return [-1, 1];
  const peak = Math.max(Math.abs(low), Math.abs(high));
  for (const { value, always } of limits)
    if (always || Math.abs(value) <= 2.5 * peak) [low, high] = [Math.min(low, value), Math.max(high, value)];
  const air = 0.06 * (high - low) || 0.1 * peak || 1;
  return [low - air, high + air];
}

function logRange(low, high) {
  if (!(high > 0)) return [1e-6, 1];
  const bottom = Math.max(low > 0 ? low : high * 1e-8, high * 1e-8);
  return [10 ** Math.floor(Math.log10(bottom)), 10 ** Math.ceil(Math.log10(high * 1.0001))];
}

function decades(_, splits) {
  return splits.map((v) => (Math.abs(Math.log10(v) - Math.round(Math.log10(v))) < 1e-9 ? v : null));
}

function drawLimit(plot, { value, color }) {
  const y = plot.valToPos(value, "y", true);
  const { left, top, width, height } = plot.bbox;
  if (!(y >= top - 1 && y <= top + height + 1)) return;
  plot.ctx.save();
  plot.ctx.strokeStyle = color;
  plot.ctx.lineWidth = 1.2 * devicePixelRatio;
  plot.ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
  plot.ctx.beginPath();
  plot.ctx.moveTo(left, y);
  plot.ctx.lineTo(left + width, y);
  plot.ctx.stroke();
  plot.ctx.restore();
}

// A line where something happens, a shade while it lasts.
function drawMark(plot, { time, end, color }) {
  const { left, top, width, height } = plot.bbox;
  const inside = (t) => Math.min(Math.max(plot.valToPos(t, "x", true), left), left + width);
  const begin = inside(time);
  plot.ctx.save();
  plot.ctx.fillStyle = color;
  if (end !== null) plot.ctx.globalAlpha = 0.22;
  plot.ctx.fillRect(begin, top, end === null ? 1.4 * devicePixelRatio : inside(end) - begin, height);
  plot.ctx.restore();
}

function shortNumber(value, digits = 3) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (!Number.isFinite(value)) return "–";
  if (size < 1e-3 || size >= 1e5) return value.toExponential(Math.max(digits - 2, 0)).replace(".0e", "e").replace("e+", "e");
  return `${+value.toPrecision(digits)}`;
}
