// Wrenches on an arm: an arrow along the force, and a ring with an arrow's head around the torque.

class Push {
  constructor(parent, push, color) {
    this.push = push;
    this.root = new THREE.Group();
    const look = { color: new THREE.Color(color).convertSRGBToLinear(), roughness: 0.6 };
    const solid = new THREE.MeshStandardMaterial(look);
    // What the arm hides shines through it.
    const veil = new THREE.MeshBasicMaterial({ color: look.color, toneMapped: false, transparent: true, opacity: 0.3, depthTest: false, depthWrite: false });
    const up = new THREE.Vector3(0, 1, 0);
    this.parts = [["force", arrow], ["torque", ring]].flatMap(([name, shape]) => {
      const vector = new THREE.Vector3().fromArray(push[name]);
      const length = vector.length();
      if (length === 0) return [];
      const part = new THREE.Group().add(shape(length, solid), shape(length, veil));
      part.quaternion.setFromUnitVectors(up, vector.divideScalar(length));
      this.root.add(part);
      return [part];
    });
    parent.add(this.root);
  }

  // How much of it acts, 0 to 1, as `Wrench.share` has it.
  share(time) {
    const { start, end, rise } = this.push;
    const edge = Math.min(time - start, end - time);
    if (edge < 0 || time >= end) return 0;
    return edge >= rise ? 1 : Math.sin((0.5 * Math.PI * edge) / rise) ** 2;
  }

  move(bodies, time) {
    const share = this.share(time);
    this.root.visible = share > 0;
    if (share === 0) return;
    const body = bodies[this.push.joint];
    this.root.position.fromArray(this.push.at).applyQuaternion(body.quaternion).add(body.position);
    if (this.push.turns) this.root.quaternion.copy(body.quaternion);
    this.root.scale.setScalar(Math.max(share, 0.05));
  }
}

// Both stand along y; the arrow's tail is at the origin.
function arrow(length, material) {
  const [head, radius] = [0.2 * length, 0.022 * length];
  const shaft = new THREE.Mesh(new THREE.CylinderGeometry(radius, radius, length - head, 24), material);
  shaft.position.y = 0.5 * (length - head);
  const tip = new THREE.Mesh(new THREE.ConeGeometry(2.6 * radius, head, 24), material);
  tip.position.y = length - 0.5 * head;
  return new THREE.Group().add(shaft, tip);
}

function ring(length, material) {
  const [radius, tube, turn] = [0.28 * length, 0.022 * length, 1.5 * Math.PI];
  const bow = new THREE.Mesh(new THREE.TorusGeometry(radius, tube, 12, 48, turn), material);
  const tip = new THREE.Mesh(new THREE.ConeGeometry(2.6 * tube, 0.16 * length, 24), material);
  tip.position.set(0, -radius, 0);
  tip.rotation.z = -0.5 * Math.PI;
  const flat = new THREE.Group().add(bow, tip);
  flat.rotation.x = -0.5 * Math.PI;
  return new THREE.Group().add(flat);
}
