// Puts the page together, and gives programs a handle on it: `window.fotsmc`.

const THREE = MeshCat.THREE;

async function start() {
  const data = await readDocument();
  const page = Object.fromEntries(
    [...document.querySelectorAll("[data-part]")].map((element) => [toCamel(element.dataset.part), element])
  );
  page.scene.setAttribute("aria-label", `3D view of ${data.runs.map(({ name }) => name).join(", ")}`);
  const theme = new Theme(page.themeButton, data.options.theme);
  const stage = new Stage(page.scene, data.view);
  await loadImages(data.meshes);
  data.meshes.forEach((mesh) => (mesh.geometry = meshGeometry(mesh)));
  const runs = data.runs.map((run, index) => {
    run.visuals.forEach((visual) => Object.assign(visual, { mesh: data.meshes[visual.mesh], geometry: data.meshes[visual.mesh].geometry }));
    return new Run(stage.root, run, { index, count: data.runs.length }, stage);
  });
  const look = { time: 0, ghost: data.options.ghost, paths: data.options.paths };
  const readout = new Readout(page, runs, data.view, (time) => player.seek(time));
  const show = (time = look.time) => {
    look.time = time;
    runs.forEach((run, index) => run.show(look, runs.filter(({ run }, k) => (run.ghost_of ?? k) === index)));
    readout.seek(time);
    stage.viewer.set_dirty();
  };
  const times = data.runs.map(({ frames }) => frames.t);
  const range = {
    start: Math.min(...times.map((t) => t[0])),
    end: Math.max(...times.map((t) => t[t.length - 1])),
    step: times[0].length > 1 ? times[0][1] - times[0][0] : 0.01,
  };
  const player = new Player(page, { ...range, ...data.options }, show);

  const setGhost = (on) => {
    look.ghost = on;
    page.ghostButton.setAttribute("aria-pressed", on);
    show();
  };
  const setPaths = (mode) => {
    look.paths = page.pathSelect.value = mode;
    show();
  };
  page.ghostButton.hidden = !data.runs.some(({ frames }) => frames.ghost);
  page.ghostButton.addEventListener("click", () => setGhost(!look.ghost));
  page.pathSelect.addEventListener("change", () => setPaths(page.pathSelect.value));
  const views = { three: data.view.direction, front: [1, 0, 0.0001], side: [0, -1, 0.0001], top: [0.0001, 0, 1] };
  page.viewSelect.addEventListener("change", () => {
    stage.look(views[page.viewSelect.value]);
  });
  stage.viewer.controls.addEventListener("start", () => (page.viewSelect.value = ""));
  const reset = () => {
    page.viewSelect.value = "three";
    stage.look(views.three);
  };
  listenToKeys(player, {
    g: () => setGhost(!look.ghost),
    p: () => setPaths({ growing: "whole", whole: "off", off: "growing" }[look.paths]),
    r: reset,
    s: () => stage.setShadows(!stage.shadows),
    t: () => theme.flip(),
  });
  theme.onChange = () => {
    stage.recolor();
    readout.table();
    readout.draw(look.time);
  };
  setPaths(look.paths);
  setGhost(look.ghost);
  theme.onChange();

  const frame = (now) => {
    requestAnimationFrame(frame);
    player.tick(now);
    stage.render();
  };
  stage.render();
  requestAnimationFrame(frame);
  window.fotsmc = handle({ data, runs, stage, player, readout });
  if (data.options.play && !matchMedia("(prefers-reduced-motion: reduce)").matches) player.toggle(true);
  document.documentElement.dataset.ready = "true";
}

// What programs may call. Times in seconds, places in metres, angles in radians.
function handle({ data, runs, stage, player, readout }) {
  const runOf = (name) => {
    const index = name === undefined ? 0 : data.runs.findIndex((run) => run.name === name);
    if (index < 0) throw new Error(`no run called ${name}`);
    return index;
  };
  return {
    get time() { return player.time; },
    get playing() { return player.playing; },
    get duration() { return player.end - player.start; },
    // Seconds from opening the page to its first picture.
    readyAfter: performance.now() / 1000,
    runs: data.runs.map(({ name }) => name),
    play: () => player.toggle(true),
    pause: () => player.toggle(false),
    seek: (time) => player.seek(time),
    times: (name) => Array.from(data.runs[runOf(name)].frames.t),
    error: (time, name) => readout.values(runOf(name), "e", time),
    torque: (time, name) => readout.values(runOf(name), "tau", time),
    // Placement of a joint's body as it is drawn now: { position, quaternion (x, y, z, w) }.
    pose(joint, name, which = "arm") {
      const run = runs[runOf(name)];
      const figure = which === "ghost" ? run.ghost : run.figure;
      const body = figure.bodies[run.run.bodies.indexOf(joint)];
      return { position: body.position.toArray(), quaternion: body.quaternion.toArray() };
    },
    // What is to be seen of the middle of a run now: payloads that hang, wrenches that act.
    payloads: (name) => runs[runOf(name)].figure.passing.filter(({ holder }) => holder.visible).map(({ holder }) => holder.children[0].name),
    pushes: (name) => runs[runOf(name)].pushes.map((push) => ({ share: push.share(player.time), position: push.root.position.toArray() })),
    tool: (name) => runs[runOf(name)].path.head.position.toArray(),
    links: (name) => data.runs[runOf(name)].visuals.map((visual) => visual.name),
    showLink(link, visible, name) {
      runs[runOf(name)].figure.root.traverse((object) => {
        if (object.isMesh && object.name === link) object.visible = visible;
      });
      stage.viewer.set_dirty();
    },
    // Slow machines draw about twice as fast without.
    setShadows: (on) => stage.setShadows(on),
    capture: () => stage.viewer.capture_image(),
  };
}

class Theme {
  constructor(button, wanted) {
    this.system = matchMedia("(prefers-color-scheme: dark)");
    this.system.addEventListener("change", () => this.chosen || this.set(this.system.matches));
    button.addEventListener("click", () => this.flip());
    this.button = button;
    this.chosen = wanted !== "auto";
    this.set(this.chosen ? wanted === "dark" : this.system.matches);
  }

  flip() {
    this.chosen = true;
    this.set(!this.dark);
  }

  set(dark) {
    this.dark = dark;
    document.documentElement.dataset.shade = dark ? "dark" : "light";
    this.button.setAttribute("aria-pressed", dark);
    this.onChange?.();
  }
}

function toCamel(name) {
  return name.replace(/-(.)/g, (_, letter) => letter.toUpperCase());
}

start().catch((error) => {
  console.error(error);
  const note = document.getElementById("fotsmc-failure");
  note.hidden = false;
  note.textContent = `This page could not be shown: ${error.message}. It needs WebGL and a browser of 2023 or later.`;
});
