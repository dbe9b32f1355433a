// Time: playing, scrubbing, speed and looping, by button and by key.

class Player {
  constructor(page, { start, end, speed, loop, step }, onTime) {
    Object.assign(this, { page, start, end, step, onTime });
    this.time = start;
    this.playing = false;
    this.speed = speed;
    this.loop = loop;
    Object.assign(page.scrubber, { min: start, max: end, step: "any" });
    page.scrubber.addEventListener("input", () => this.seek(Number(page.scrubber.value)));
    page.playButton.addEventListener("click", () => this.toggle());
    page.speedSelect.addEventListener("change", () => (this.speed = Number(page.speedSelect.value)));
    page.loopButton.addEventListener("click", () => this.setLoop(!this.loop));
    if (![...page.speedSelect.options].some(({ value }) => Number(value) === speed))
      page.speedSelect.append(Object.assign(document.createElement("option"), { value: speed, textContent: `${speed}×` }));
    page.speedSelect.value = [...page.speedSelect.options].find(({ value }) => Number(value) === speed).value;
    this.setLoop(loop);
    this.seek(start);
  }

  setLoop(loop) {
    this.loop = loop;
    this.page.loopButton.setAttribute("aria-pressed", loop);
  }

  toggle(playing = !this.playing) {
    this.playing = playing;
    this.last = undefined;
    if (playing && this.time >= this.end) this.seek(this.start);
    this.page.playButton.setAttribute("aria-label", playing ? "Pause" : "Play");
    this.page.playButton.dataset.playing = playing;
  }

  seek(time) {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.page.scrubber.value = this.time;
    this.page.scrubber.setAttribute("aria-valuetext", `${this.time.toFixed(2)} seconds`);
    const done = (this.time - this.start) / (this.end - this.start || 1);
    this.page.scrubber.style.setProperty("--done", `${100 * done}%`);
    this.page.clock.textContent = `${this.time.toFixed(2)} s`;
    this.onTime(this.time);
  }

  // `now` in milliseconds, from the browser's animation clock.
  tick(now) {
    if (!this.playing) return;
    const passed = this.last === undefined ? 0 : Math.min((now - this.last) / 1000, 0.25);
    this.last = now;
    let time = this.time + passed * this.speed;
    if (time > this.end && this.loop) time = this.start + ((time - this.end) % (this.end - this.start || 1));
    this.seek(time);
    if (time >= this.end && !this.loop) this.toggle(false);
  }

  faster(direction) {
    const { speedSelect } = this.page;
    const values = [...speedSelect.options].map(({ value }) => Number(value)).sort((a, b) => a - b);
    const next = values[values.indexOf(this.speed) + direction];
    if (next !== undefined) speedSelect.value = this.speed = next;
  }
}

// Keys act unless the focus is where the key has a meaning of its own.
function listenToKeys(player, actions) {
  const keys = {
    " ": () => player.toggle(),
    k: () => player.toggle(),
    ArrowLeft: (event) => player.seek(player.time - (event.shiftKey ? 1 : player.step)),
    ArrowRight: (event) => player.seek(player.time + (event.shiftKey ? 1 : player.step)),
    Home: () => player.seek(player.start),
    End: () => player.seek(player.end),
    "+": () => player.faster(1),
    "-": () => player.faster(-1),
    l: () => player.setLoop(!player.loop),
    ...actions,
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target;
    if (target.matches("select, input:not([type=range]), summary")) return;
    if (event.key === " " && target.matches("button")) return;
    const action = keys[event.key] ?? keys[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action(event);
  });
}
