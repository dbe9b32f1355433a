// The arms of the runs: links, ghosts of the reference, and the paths of the tools.

// One rigid body per joint, moved together along packed placements.
class Figure {
  constructor(parent, run, placements, dress) {
    this.root = new THREE.Group();
    this.placements = placements;
    this.frames = run.frames.t.length;
    this.bodies = run.bodies.map((name) => {
      const body = new THREE.Group();
      body.name = name;
      this.root.add(body);
      return body;
    });
    this.passing = [];
    run.visuals.forEach((visual) => {
      const body = this.bodies[visual.joint];
      if (!visual.spans) return dress(visual, body);
      const holder = new THREE.Group();
      body.add(holder);
      this.passing.push({ holder, spans: visual.spans });
      dress(visual, holder);
    });
    parent.add(this.root);
  }

  // `place` is the interval of frames that holds `time`, as `locate` gives it.
  move(place, time) {
    for (const { holder, spans } of this.passing)
      holder.visible = spans.some(([from, until]) => time >= from && (until === null || time < until));
    const { position, orientation } = this.placements;
    const turned = new THREE.Quaternion();
    const read = (array, joint, width, k, row) => array[(joint * width + k) * this.frames + row];
    this.bodies.forEach((body, joint) => {
      const at = (k) => {
        const a = read(position, joint, 3, k, place.row);
        return a + place.part * (read(position, joint, 3, k, place.next) - a);
      };
      body.position.set(at(0), at(1), at(2));
      const q = (row) => [0, 1, 2, 3].map((k) => read(orientation, joint, 4, k, row));
      body.quaternion.fromArray(q(place.row));
      if (place.part > 0) body.quaternion.slerp(turned.fromArray(q(place.next)), place.part);
    });
  }
}

class Path {
  constructor(parent, columns, rows, radius, material) {
    const points = Array.from(
      { length: rows },
      (_, i) => new THREE.Vector3(columns[i], columns[rows + i], columns[2 * rows + i])
    );
    this.mesh = new THREE.Mesh(tubeGeometry(points, radius), material);
    this.mesh.frustumCulled = false;
    this.head = new THREE.Mesh(new THREE.SphereGeometry(2.4 * radius, 20, 14), material);
    this.points = points;
    this.root = new THREE.Group();
    this.root.add(this.mesh, this.head);
    parent.add(this.root);
  }

  // mode: "growing" up to now, "whole", or "off".
  grow(place, mode) {
    this.root.visible = mode !== "off";
    this.head.position.lerpVectors(this.points[place.row], this.points[place.next], place.part);
    const stretches = mode === "whole" ? Infinity : place.row;
    this.mesh.geometry.setDrawRange(0, stretches * TUBE_SIDES * 6);
  }
}

class Run {
  constructor(scene, run, { index, count }, { size, view }) {
    const several = count > 1;
    this.run = run;
    this.root = new THREE.Group();
    this.root.position.fromArray(run.offset);
    scene.add(this.root);
    this.color = new THREE.Color(run.color).convertSRGBToLinear();
    const ghostColor = new THREE.Color(view.ghost_color).convertSRGBToLinear();
    this.shown = true;
    const paints = new Map();
    const paint = (rgba, image) => {
      const key = `${rgba.join()} ${image?.uuid}`;
      if (!paints.has(key)) paints.set(key, linkMaterial(rgba, several ? this.color : null, image, behind(index)));
      return paints.get(key);
    };
    const dressed = ({ paint: runs, skin }) => runs.map(({ rgba }, k) => paint(rgba, skin?.images[k] ?? null));
    this.figure = new Figure(this.root, run, run.frames.arm, (visual, body) => {
      const mesh = new THREE.Mesh(visual.geometry, dressed(visual.mesh));
      mesh.name = visual.name;
      mesh.castShadow = mesh.receiveShadow = true;
      body.add(mesh);
    });
    if (run.frames.ghost) {
      const layers = ghostMaterials(ghostColor, count);
      this.ghost = new Figure(this.root, run, run.frames.ghost, (visual, body) => {
        layers.forEach((material, layer) => {
          const mesh = new THREE.Mesh(visual.geometry, material);
          mesh.renderOrder = 1 + layer;
          body.add(mesh);
        });
      });
    }
    if (run.frames.axes) {
      const frames = { frames: run.frames, bodies: ["tool axes", "reference axes"], visuals: [] };
      this.axes = new Figure(this.root, frames, run.frames.axes, () => {});
      this.axes.bodies.forEach((body, k) => body.add(triad((k ? 0.13 : 0.09) * size, k ? 0.0011 * size : 0.0024 * size)));
    }
    this.pushes = run.pushes.map((push) => new Push(this.figure.root, push, view.push_color));
    const rows = run.frames.t.length;
    const line = (color, place) => new THREE.MeshBasicMaterial({ color, toneMapped: false, ...behind(place) });
    this.path = new Path(this.root, run.frames.tool, rows, 0.0032 * size, line(this.color, index));
    if (run.frames.tool_d) {
      const thin = 0.0022 * size;
      this.reference = new Path(this.root, run.frames.tool_d, rows, thin, line(ghostColor, count));
    }
  }

  // `sharers` are the runs whose reference this run's ghost shows.
  show({ time, ghost, paths }, sharers) {
    const place = locate(this.run.frames.t, time);
    const asked = ghost && sharers.some((run) => run.shown);
    this.figure.root.visible = this.shown;
    this.figure.move(place, time);
    if (this.axes) {
      this.axes.root.visible = this.shown;
      this.axes.move(place, time);
      this.axes.bodies[1].visible = asked;
    }
    this.pushes.forEach((push) => push.move(this.figure.bodies, time));
    this.path.grow(place, this.shown ? paths : "off");
    if (this.ghost) {
      this.ghost.root.visible = asked;
      this.ghost.move(place, time);
    }
    if (this.reference) this.reference.grow(place, asked ? paths : "off");
  }
}

// Three bars along the axes of a frame, red, green and blue.
function triad(length, radius) {
  const axes = new THREE.Group();
  [0xd03030, 0x2f9e44, 0x2f6fd0].forEach((color, k) => {
    const sides = [0, 1, 2].map((axis) => (axis === k ? length : 2 * radius));
    const bar = new THREE.Mesh(new THREE.BoxGeometry(...sides), new THREE.MeshBasicMaterial({ color, toneMapped: false }));
    bar.position.setComponent(k, 0.5 * length);
    axes.add(bar);
  });
  return axes;
}

// Shifts a surface a little away from the eye, by its place in a row: where arms of several runs
// coincide, the first of them is what is seen, and not a mixture of speckles.
function behind(place) {
  return { polygonOffset: place > 0, polygonOffsetFactor: 1.5 * place, polygonOffsetUnits: 6 * place };
}

// `image` is what `loadImages` made of a picture, or null.
function linkMaterial([red, green, blue, alpha], tint, image, shift) {
  const color = new THREE.Color(red, green, blue).convertSRGBToLinear();
  if (tint) color.lerp(tint, 0.72);
  return new THREE.MeshStandardMaterial({
    color,
    map: image,
    ...shift,
    roughness: 0.52,
    metalness: 0.08,
    side: THREE.DoubleSide,
    transparent: alpha < 1,
    opacity: Math.max(alpha, 0.15),
    depthWrite: alpha >= 1,
  });
}

// Turns the pictures of all meshes from addresses into textures, each once.
async function loadImages(meshes) {
  const known = new Map();
  const load = async (address) => {
    const texture = new THREE.Texture(Object.assign(new Image(), { src: address }));
    await texture.image.decode();
    Object.assign(texture, { encoding: THREE.sRGBEncoding, wrapS: THREE.RepeatWrapping, wrapT: THREE.RepeatWrapping });
    texture.needsUpdate = true;
    return texture;
  };
  for (const { skin } of meshes)
    for (const [k, address] of (skin?.images ?? []).entries()) {
      if (!address) continue;
      if (!known.has(address)) known.set(address, await load(address));
      skin.images[k] = known.get(address);
    }
}

// The first layer fills only the depth, so that of the second just the nearest surface shows. Both
// lie a little behind their true place, and behind those of all `count` arms: where arm and ghost
// agree, the arm is what is seen.
function ghostMaterials(ghostColor, count) {
  const shift = behind(count + 1);
  const depth = new THREE.MeshBasicMaterial({ colorWrite: false, transparent: true, ...shift });
  const color = new THREE.MeshStandardMaterial({
    color: ghostColor,
    transparent: true,
    opacity: 0.4,
    depthWrite: false,
    roughness: 0.9,
    ...shift,
  });
  return [depth, color];
}
