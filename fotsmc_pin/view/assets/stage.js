// The place where the arms stand: Meshcat's viewer with our floor, light and camera.

class Stage {
  constructor(pane, view) {
    this.pane = pane;
    this.view = view;
    this.viewer = new MeshCat.Viewer(pane, false);
    const resize = this.viewer.set_3d_pane_size.bind(this.viewer);
    this.viewer.set_3d_pane_size = () => resize(pane.clientWidth, pane.clientHeight);
    this.viewer.gui.domElement.remove();
    const { renderer, scene } = this.viewer;
    scene.children.filter((child) => child.name !== "Cameras").forEach((child) => (child.visible = false));
    scene.background = null;
    renderer.outputEncoding = THREE.sRGBEncoding;
    renderer.toneMapping = THREE.ACESFilmicToneMapping;
    renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.root = new THREE.Group();
    scene.add(this.root);
    this.low = new THREE.Vector3().fromArray(view.low);
    this.high = new THREE.Vector3().fromArray(view.high);
    this.size = this.low.distanceTo(this.high);
    this.center = this.low.clone().add(this.high).multiplyScalar(0.5);
    this.lights();
    this.floor();
    this.camera();
    new ResizeObserver(() => this.resize()).observe(pane);
  }

  lights() {
    const sky = new THREE.HemisphereLight(0xffffff, 0x8c93a0, 0.75);
    sky.position.set(0, 0, 1);
    const key = new THREE.DirectionalLight(0xffffff, 1.65);
    const half = 0.75 * this.size;
    const facing = new THREE.Vector3().fromArray(this.view.direction);
    const aside = new THREE.Vector3(0, 0, 1).cross(facing).normalize();
    key.position.copy(this.center).addScaledVector(facing, 1.2 * this.size);
    key.position.addScaledVector(aside, 1.0 * this.size).add(new THREE.Vector3(0, 0, 2.2 * this.size));
    key.target.position.copy(this.center);
    key.castShadow = true;
    key.shadow.mapSize.set(2048, 2048);
    key.shadow.normalBias = 0.004 * this.size;
    key.shadow.radius = 4;
    Object.assign(key.shadow.camera, {
      left: -half, right: half, top: half, bottom: -half, near: 0.1 * this.size, far: 6 * this.size,
    });
    const fill = new THREE.DirectionalLight(0xdfe9ff, 0.45);
    fill.position.copy(this.center).addScaledVector(aside, -2 * this.size);
    fill.position.add(new THREE.Vector3(0, 0, 0.6 * this.size));
    fill.target.position.copy(this.center);
    this.key = key;
    this.shadows = true;
    this.root.add(sky, key, key.target, fill, fill.target);
  }

  floor() {
    const { floor, reach } = this.view;
    const radius = 1.1 * this.size + reach;
    const step = 10 ** Math.floor(Math.log10(reach / 2));
    const spacing = [step, 2 * step, 5 * step].findLast((s) => s <= reach / 3) ?? step;
    const grid = new THREE.LineSegments(gridGeometry(radius, spacing), gridMaterial());
    const shadow = new THREE.Mesh(
      new THREE.CircleGeometry(radius, 64),
      new THREE.ShadowMaterial({ opacity: 0.22, depthWrite: false })
    );
    shadow.receiveShadow = true;
    const base = new THREE.Group();
    base.position.set(this.center.x, this.center.y, floor - 0.001 * this.size);
    const snap = (x) => Math.round(x / spacing) * spacing;
    grid.position.set(snap(this.center.x) - this.center.x, snap(this.center.y) - this.center.y, 0);
    base.add(shadow, grid);
    this.grid = grid;
    this.root.add(base);
  }

  camera() {
    const { controls, camera } = this.viewer;
    camera.fov = 32;
    camera.near = 0.01 * this.size;
    camera.far = 30 * this.size;
    controls.minDistance = 0.15 * this.size;
    controls.maxDistance = 12 * this.size;
    controls.addEventListener("start", () => (this.moved = true));
    this.resize();
  }

  // Robots have z up, three.js y; the viewer turns the scene but not the camera.
  look(direction) {
    const { controls, camera } = this.viewer;
    const turned = ({ x, y, z }) => new THREE.Vector3(x, z, -y);
    const away = turned(new THREE.Vector3().fromArray(direction)).normalize();
    const aim = turned(this.center);
    const right = new THREE.Vector3(0, 1, 0).cross(away);
    if (right.lengthSq() < 1e-6) right.set(1, 0, 0);
    right.normalize();
    const up = new THREE.Vector3().crossVectors(away, right);
    const tall = Math.tan((camera.fov * Math.PI) / 360);
    const wide = tall * camera.aspect;
    const points = this.view.outline.map(([x, y, z]) => turned({ x, y, z }));
    // Centre the picture of the outline, then step back until it fits; twice, as both depend.
    let distance = 0;
    for (let pass = 0; pass < 3; pass++) {
      const seen = points.map((point) => {
        const relative = point.clone().sub(aim);
        const depth = Math.max(distance - relative.dot(away), 0.1 * this.size);
        return [relative.dot(right), relative.dot(up), relative.dot(away), depth];
      });
      if (distance > 0) {
        const middle = (k) => {
          const slopes = seen.map((s) => s[k] / s[3]);
          return (distance * (Math.min(...slopes) + Math.max(...slopes))) / 2;
        };
        aim.addScaledVector(right, middle(0)).addScaledVector(up, middle(1));
      }
      distance = Math.max(...points.map((point) => {
        const relative = point.clone().sub(aim);
        const aside = Math.abs(relative.dot(right)) / wide;
        return relative.dot(away) + Math.max(aside, Math.abs(relative.dot(up)) / tall);
      }));
    }
    controls.target.copy(aim);
    camera.position.copy(aim).addScaledVector(away, 1.1 * distance);
    this.direction = direction;
    this.moved = false;
    controls.update();
    this.viewer.set_dirty();
  }

  resize() {
    if (!this.pane.clientWidth || !this.pane.clientHeight) return;
    this.viewer.set_3d_pane_size();
    if (!this.moved) this.look(this.direction ?? this.view.direction);
    this.viewer.set_dirty();
  }

  setShadows(on) {
    this.shadows = this.key.castShadow = on;
    this.viewer.set_dirty();
  }

  recolor() {
    const style = getComputedStyle(document.documentElement);
    this.grid.material.color.set(style.getPropertyValue("--grid").trim());
    this.viewer.set_dirty();
  }

  render() {
    if (this.viewer.needs_render) this.viewer.render();
  }
}

function gridMaterial() {
  return new THREE.LineBasicMaterial({
    vertexColors: true, transparent: true, depthWrite: false, toneMapped: false,
  });
}

// A square grid that fades out towards its rim.
function gridGeometry(radius, spacing) {
  const [points, colors] = [[], []];
  const count = Math.floor(radius / spacing);
  const fade = (x, y) => Math.max(0, 1 - Math.hypot(x, y) / radius) ** 1.5;
  for (let i = -count; i <= count; i++)
    for (let j = -count; j < count; j++) {
      const [a, b, c] = [i * spacing, j * spacing, (j + 1) * spacing];
      points.push(a, b, 0, a, c, 0, b, a, 0, c, a, 0);
      for (const [x, y] of [[a, b], [a, c], [b, a], [c, a]]) colors.push(1, 1, 1, fade(x, y));
    }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(colors, 4));
  return geometry;
}
