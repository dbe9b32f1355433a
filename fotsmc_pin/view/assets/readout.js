// What the plots and the table show: the joints of one run, or several runs against each other.

// Okabe and Ito's colours, darker or lighter where the background asks for it.
const JOINT_COLORS = {
  light: ["#0072B2", "#D55E00", "#008060", "#B34C86", "#A66F00", "#2F7FB0", "#6B6B00", "#444444"],
  dark: ["#56B4E9", "#E69F00", "#2CC79A", "#E08FBE", "#F0E442", "#7FA8FF", "#FF8A5C", "#DDDDDD"],
};

class Readout {
  constructor(page, runs, { push_color: pushColor }, onSeek) {
    this.pushColor = pushColor;
    this.runs = runs;
    this.several = runs.length > 1;
    this.onSeek = onSeek;
    this.joint = -1;
    this.log = false;
    const data = runs[0].run;
    this.names = Object.keys(data.charts.signals);
    this.signal = this.names[0];
    // Radians and metres, newton-metres and newtons have no axis in common: a chart for each unit.
    this.units = [...new Set(runs.flatMap(({ run }) => run.units.position))];
    const kinds = [...["error", "torque"].flatMap((kind) => this.units.map((unit) => `${kind} ${unit}`)), "signal"];
    this.charts = Object.fromEntries(kinds.map((kind) => [kind, new Chart(page.charts, kind, onSeek)]));
    this.charts.signal.host.hidden = this.names.length === 0;
    this.page = page;
    this.controls();
    this.table();
  }

  controls() {
    const { jointSelect, signalSelect, logButton } = this.page;
    const all = this.several ? "All joints (norm)" : "All joints";
    const joints = this.sharedJoints();
    const option = (value, text) => Object.assign(document.createElement("option"), { value, textContent: text });
    jointSelect.append(option(-1, all), ...joints.map((name, j) => option(j, name)));
    jointSelect.addEventListener("change", () => this.choose(Number(jointSelect.value)));
    signalSelect.append(...this.names.map((name) => option(name, name)));
    signalSelect.closest("label").hidden = this.names.length < 2;
    signalSelect.addEventListener("change", () => {
      this.signal = signalSelect.value;
      this.draw();
    });
    logButton.addEventListener("click", () => {
      this.log = !this.log;
      logButton.setAttribute("aria-pressed", this.log);
      this.draw();
    });
  }

  // Names of the joints that can be chosen; different arms share no more than numbers.
  sharedJoints() {
    const [first, ...others] = this.runs.map(({ run }) => run.joints);
    if (others.every((names) => names.join() === first.join())) return first;
    const count = Math.min(first.length, ...others.map((names) => names.length));
    return Array.from({ length: count }, (_, j) => `Joint ${j + 1}`);
  }

  choose(joint) {
    this.joint = joint;
    this.page.jointSelect.value = joint;
    this.table();
    this.draw();
  }

  palette() {
    return JOINT_COLORS[document.documentElement.dataset.shade];
  }

  // Numbers of a run's joints whose position is in `unit`; of all joints without one.
  jointsOf({ run }, unit) {
    const all = run.joints.map((_, j) => j);
    return unit ? all.filter((j) => run.units.position[j] === unit) : all;
  }

  effortUnit(unit) {
    const { run } = this.runs.find(({ run }) => run.units.position.includes(unit));
    return run.units.effort[run.units.position.indexOf(unit)];
  }

  // One line per joint of a single run, or one per run; of the joints in `unit`.
  lines(quantity, unit) {
    const colors = this.palette();
    const rows = ({ run }) => run.charts.t.length;
    const table = ({ run }) => (quantity === "signal" ? run.charts.signals[this.signal] : run.charts[quantity]);
    if (!this.several) {
      const [only] = this.runs;
      const { names, columns } = this.columnsOf(only, quantity, table(only));
      return names
        .map((label, j) => ({ label, color: colors[j % colors.length], t: only.run.charts.t, j,
          y: column(columns, j, rows(only)) }))
        .filter(({ j }) => this.joint < 0 || names.length <= this.joint || j === this.joint)
        .filter(({ j }) => !unit || this.jointsOf(only, unit).includes(j));
    }
    const joints = (run) => (unit ? this.jointsOf(run, unit) : null);
    const has = (run) => !unit || (this.joint < 0 ? joints(run).length > 0 : joints(run).includes(this.joint));
    return this.runs
      .filter((run) => run.shown && has(run) && table(run)?.length > Math.max(this.joint, 0) * rows(run))
      .map((run) => ({
        label: run.run.name, color: run.run.color, t: run.run.charts.t,
        y: this.joint < 0 ? norm(table(run), rows(run), joints(run)) : column(table(run), this.joint, rows(run)),
      }));
  }

  columnsOf({ run }, quantity, columns) {
    const count = columns.length / run.charts.t.length;
    const names = count === run.joints.length ? run.joints
      : Array.from({ length: count }, (_, i) => `${this.signal}[${i}]`);
    return { names, columns };
  }

  limits(unit) {
    const { effort_limit: limit } = this.runs[0].run;
    const colors = this.palette();
    const muted = getComputedStyle(document.documentElement).getPropertyValue("--muted").trim();
    const signed = (value, color, always) => (value === null ? [] : [1, -1].map((s) => ({ value: s * value, color, always })));
    if (this.joint >= 0) return signed(limit[this.joint], this.several ? muted : colors[this.joint % colors.length], true);
    if (this.several) return [];
    const joints = this.jointsOf(this.runs[0], unit);
    const sharing = (value) => joints.filter((j) => limit[j] === value);
    return joints.flatMap((j) =>
      sharing(limit[j])[0] < j ? [] : signed(limit[j], sharing(limit[j]).length > 1 ? muted : colors[j % colors.length], false)
    );
  }

  // What happens in the runs that are shown, as the plots mark it.
  marks() {
    const muted = getComputedStyle(document.documentElement).getPropertyValue("--muted").trim();
    const shown = this.runs.filter((run) => !this.several || run.shown);
    return shown.flatMap(({ run }) => run.marks)
      .map(({ time, end }) => ({ time, end, color: end === null ? muted : this.pushColor }));
  }

  limitNote(unit) {
    const { effort_limit: limit } = this.runs[0].run;
    const joints = this.jointsOf(this.runs[0], unit);
    const value = limit[this.joint >= 0 ? this.joint : joints[0]];
    const one = this.joint >= 0 || (!this.several && joints.every((j) => limit[j] === value));
    return one && value !== null ? `, limit ±${shortNumber(value)}` : "";
  }

  draw(time = this.time) {
    this.time = time;
    const of = this.several && this.joint < 0 ? "Norm of the " : "";
    const named = (text) => (of ? of + text.toLowerCase() : text);
    const content = {};
    for (const unit of this.units) {
      const effort = unit === "m" ? "Force" : "Torque";
      content[`error ${unit}`] = { title: named("Tracking error"), unit, lines: this.lines("e", unit), limits: [], log: this.log };
      content[`torque ${unit}`] = {
        title: named(effort), unit: this.effortUnit(unit), lines: this.lines("tau", unit),
        limits: this.limits(unit), log: false, note: this.limitNote(unit),
      };
    }
    if (this.signal) {
      const title = this.signal === "s" ? named("Sliding variable s") : named(`Signal ${this.signal}`);
      content.signal = { title, unit: "–", lines: this.lines("signal"), limits: [], log: false };
    }
    for (const [kind, item] of Object.entries(content)) {
      item.marks = this.marks();
      if (item.lines.length) this.charts[kind].draw(item, time);
      this.charts[kind].host.hidden = item.lines.length === 0;
    }
    this.seek(time);
  }

  // The table is the legend too: a row for each line, with the numbers of now.
  table() {
    const { tableBody, tableHead } = this.page;
    const first = this.runs[0].run;
    tableHead.textContent = this.several ? "Run" : "Joint";
    const colors = this.palette();
    const labels = this.several
      ? this.runs.map((run) => ({ text: run.run.name, color: run.run.color, pressed: run.shown }))
      : first.joints.map((text, j) => ({ text, color: colors[j % colors.length], pressed: this.joint < 0 || this.joint === j }));
    const focused = [...tableBody.querySelectorAll("button")].indexOf(document.activeElement);
    this.cells = labels.map(({ text, color, pressed }, index) => {
      const row = document.createElement("tr");
      const head = document.createElement("th");
      head.scope = "row";
      const button = document.createElement("button");
      button.type = "button";
      button.setAttribute("aria-pressed", pressed);
      const dot = document.createElement("span");
      dot.className = "dot";
      dot.style.background = color;
      button.append(dot, text);
      button.addEventListener("click", () => this.press(index));
      head.append(button);
      const cells = [0, 1, 2].map(() => document.createElement("td"));
      row.append(head, ...cells);
      row.classList.toggle("off", !pressed);
      return { row, cells };
    });
    tableBody.replaceChildren(...this.cells.map(({ row }) => row));
    if (focused >= 0) tableBody.querySelectorAll("button")[focused]?.focus();
    if (this.time !== undefined) this.seek(this.time);
  }

  press(index) {
    if (!this.several) return this.choose(this.joint === index ? -1 : index);
    const run = this.runs[index];
    run.shown = !run.shown;
    this.table();
    this.draw();
    this.onSeek(this.time);
  }

  // Numbers of run `index` at a time: from its curves, or from its frames where those are thinned.
  values(index, quantity, time) {
    const { frames, charts } = this.runs[index].run;
    const { t, [quantity]: table } = frames[quantity] ? frames : charts;
    const rows = t.length;
    const place = locate(t, time);
    return Array.from({ length: table.length / rows }, (_, j) => interpolate(column(table, j, rows), place));
  }

  seek(time) {
    this.time = time;
    Object.values(this.charts).forEach((chart) => chart.seek(time));
    this.cells.forEach(({ cells }, index) => {
      const run = this.several ? index : 0;
      const { effort_limit: limit, units } = this.runs[run].run;
      // With one unit the column's heading tells it; with two, each value does.
      const mixed = this.units.length > 1;
      const pick = (list, unitOf) => {
        const joint = this.several ? this.joint : index;
        const told = (value, j) => shortNumber(value) + (mixed ? ` ${unitOf[j]}` : "");
        if (joint >= 0) return told(list[joint], joint);
        return this.units
          .map((unit) => this.jointsOf(this.runs[run], unit))
          .filter((joints) => joints.length)
          .map((joints) => told(Math.hypot(...joints.map((j) => list[j])), joints[0]))
          .join(", ");
      };
      const tau = this.values(run, "tau", time);
      const used = tau.map((value, j) => (limit[j] ? Math.abs(value) / limit[j] : NaN));
      const joint = this.several ? this.joint : index;
      const share = joint < 0 ? Math.max(...used.filter(Number.isFinite), 0) : used[joint];
      cells[0].textContent = pick(this.values(run, "e", time), units.position);
      cells[1].textContent = pick(tau, units.effort);
      cells[2].textContent = Number.isFinite(share) ? `${Math.round(100 * share)} %` : "–";
    });
  }
}

// Euclidean norm of some columns, all without `joints`, row by row.
function norm(columns, rows, joints) {
  const result = new Float32Array(rows);
  const chosen = joints ?? Array.from({ length: columns.length / rows }, (_, j) => j);
  for (let i = 0; i < rows; i++) {
    let sum = 0;
    for (const j of chosen) sum += columns[j * rows + i] ** 2;
    result[i] = Math.sqrt(sum);
  }
  return result;
}
