// What the plots and the table show: the joints of one run, or several runs against each other.

// Okabe and Ito's colours, darker or lighter where the background asks for it.
const JOINT_COLORS = {
  light: ["#0072B2", "#D55E00", "#008060", "#B34C86", "#A66F00", "#2F7FB0", "#6B6B00", "#444444"],
  dark: ["#56B4E9", "#E69F00", "#2CC79A", "#E08FBE", "#F0E442", "#7FA8FF", "#FF8A5C", "#DDDDDD"],
};

class Readout {
  constructor(page, runs, onSeek) {
    this.runs = runs;
    this.several = runs.length > 1;
    this.onSeek = onSeek;
    this.joint = -1;
    this.log = false;
    const data = runs[0].run;
    this.names = Object.keys(data.charts.signals);
    this.signal = this.names[0];
    this.charts = Object.fromEntries(
      ["error", "torque", "signal"].map((kind) => [kind, new Chart(page.charts, kind, onSeek)])
    );
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

  // One line per joint of a single run, or one per run.
  lines(quantity) {
    const colors = this.palette();
    const rows = ({ run }) => run.charts.t.length;
    const table = ({ run }) => (quantity === "signal" ? run.charts.signals[this.signal] : run.charts[quantity]);
    if (!this.several) {
      const [only] = this.runs;
      const { names, columns } = this.columnsOf(only, quantity, table(only));
      return names
        .map((label, j) => ({ label, color: colors[j % colors.length], t: only.run.charts.t, j,
          y: column(columns, j, rows(only)) }))
        .filter(({ j }) => this.joint < 0 || names.length <= this.joint || j === this.joint);
    }
    return this.runs
      .filter((run) => run.shown && table(run)?.length > Math.max(this.joint, 0) * rows(run))
      .map((run) => ({
        label: run.run.name, color: run.run.color, t: run.run.charts.t,
        y: this.joint < 0 ? norm(table(run), rows(run)) : column(table(run), this.joint, rows(run)),
      }));
  }

  columnsOf({ run }, quantity, columns) {
    const count = columns.length / run.charts.t.length;
    const names = count === run.joints.length ? run.joints
      : Array.from({ length: count }, (_, i) => `${this.signal}[${i}]`);
    return { names, columns };
  }

  limits() {
    const { effort_limit: limit } = this.runs[0].run;
    const colors = this.palette();
    const muted = getComputedStyle(document.documentElement).getPropertyValue("--muted").trim();
    const signed = (value, color, always) => (value === null ? [] : [1, -1].map((s) => ({ value: s * value, color, always })));
    if (this.joint >= 0) return signed(limit[this.joint], this.several ? muted : colors[this.joint % colors.length], true);
    if (this.several) return [];
    const sharing = (value) => limit.filter((other) => other === value).length;
    return limit.flatMap((value, j) =>
      limit.indexOf(value) < j ? [] : signed(value, sharing(value) > 1 ? muted : colors[j % colors.length], false)
    );
  }

  limitNote() {
    const { effort_limit: limit } = this.runs[0].run;
    const value = this.joint >= 0 ? limit[this.joint] : limit[0];
    const one = this.joint >= 0 || (!this.several && limit.every((other) => other === value));
    return one && value !== null ? `, limit ±${shortNumber(value)}` : "";
  }

  draw(time = this.time) {
    this.time = time;
    const { units } = this.runs[0].run;
    const unit = (list) => (this.joint >= 0 ? list[this.joint] : [...new Set(list)].join(", "));
    const of = this.several && this.joint < 0 ? "Norm of the " : "";
    const named = (text) => (of ? of + text.toLowerCase() : text);
    const content = {
      error: { title: named("Tracking error"), unit: unit(units.position), lines: this.lines("e"), limits: [], log: this.log },
      torque: { title: named("Torque"), unit: unit(units.effort), lines: this.lines("tau"), limits: this.limits(), log: false, note: this.limitNote() },
    };
    if (this.signal) {
      const title = this.signal === "s" ? named("Sliding variable s") : named(`Signal ${this.signal}`);
      content.signal = { title, unit: "–", lines: this.lines("signal"), limits: [], log: false };
    }
    for (const [kind, item] of Object.entries(content)) {
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
      const limit = this.runs[run].run.effort_limit;
      const pick = (list) => {
        const joint = this.several ? this.joint : index;
        return joint < 0 ? Math.hypot(...list) : list[joint];
      };
      const tau = this.values(run, "tau", time);
      const used = tau.map((value, j) => (limit[j] ? Math.abs(value) / limit[j] : NaN));
      const joint = this.several ? this.joint : index;
      const share = joint < 0 ? Math.max(...used.filter(Number.isFinite), 0) : used[joint];
      cells[0].textContent = shortNumber(pick(this.values(run, "e", time)));
      cells[1].textContent = shortNumber(pick(tau));
      cells[2].textContent = Number.isFinite(share) ? `${Math.round(100 * share)} %` : "–";
    });
  }
}

function norm(columns, rows) {
  const result = new Float32Array(rows);
  const count = columns.length / rows;
  for (let i = 0; i < rows; i++) {
    let sum = 0;
    for (let j = 0; j < count; j++) sum += columns[j * rows + i] ** 2;
    result[i] = Math.sqrt(sum);
  }
  return result;
}
