// Triangles for three.js: meshes with smooth faces and sharp edges, and tubes along paths.

const CREASE = Math.cos((32 * Math.PI) / 180);

function meshGeometry(mesh) {
  const { vertices, faces, low, step } = mesh;
  const points = new Float32Array(vertices.length);
  for (let i = 0; i < points.length; i++) points[i] = low[i % 3] + vertices[i] * step;
  const geometry = creased(points, faces, mesh.skin?.uv);
  let start = 0;
  mesh.paint.forEach(({ count }, index) => {
    geometry.addGroup(3 * start, 3 * count, index);
    start += count;
  });
  return geometry;
}

// A corner's normal is the mean of those faces around its vertex that meet its own face at less than
// the crease angle.
function creased(points, faces, uv) {
  const count = faces.length / 3;
  const normals = new Float32Array(3 * count);
  const lengths = new Float32Array(count);
  const around = new Uint32Array(points.length / 3 + 1);
  for (let f = 0; f < count; f++) {
    const [a, b, c] = [3 * faces[3 * f], 3 * faces[3 * f + 1], 3 * faces[3 * f + 2]];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    normals[3 * f] = nx;
    normals[3 * f + 1] = ny;
    normals[3 * f + 2] = nz;
    lengths[f] = Math.hypot(nx, ny, nz) || 1e-30;
    for (let k = 0; k < 3; k++) around[faces[3 * f + k] + 1]++;
  }
  for (let v = 1; v < around.length; v++) around[v] += around[v - 1];
  const next = around.slice();
  const members = new Uint32Array(faces.length);
  for (let i = 0; i < faces.length; i++) members[next[faces[i]]++] = Math.floor(i / 3);

  // Corners of one vertex with one normal and one place in the picture become one vertex again: a chain per vertex finds them.
  const [corners, smooth, chain, places] = [[], [], [], []];
  const elsewhere = (k, i) => uv && (places[2 * k] !== uv[2 * i] || places[2 * k + 1] !== uv[2 * i + 1]);
  const bent = (k, x, y, z) => x * smooth[3 * k] + y * smooth[3 * k + 1] + z * smooth[3 * k + 2] < 0.9999;
  const first = new Int32Array(points.length / 3).fill(-1);
  const indices = new Uint32Array(faces.length);
  for (let i = 0; i < faces.length; i++) {
    const f = Math.floor(i / 3);
    const vertex = faces[i];
    const [fx, fy, fz] = [normals[3 * f], normals[3 * f + 1], normals[3 * f + 2]];
    let x = 0, y = 0, z = 0;
    for (let m = around[vertex]; m < around[vertex + 1]; m++) {
      const g = members[m];
      const [gx, gy, gz] = [normals[3 * g], normals[3 * g + 1], normals[3 * g + 2]];
      if (fx * gx + fy * gy + fz * gz >= CREASE * lengths[f] * lengths[g]) {
        x += gx;
        y += gy;
        z += gz;
      }
    }
    const length = Math.hypot(x, y, z) || 1;
    x /= length;
    y /= length;
    z /= length;
    let k = first[vertex];
    while (k >= 0 && (bent(k, x, y, z) || elsewhere(k, i))) k = chain[k];
    if (k < 0) {
      k = chain.length;
      chain.push(first[vertex]);
      first[vertex] = k;
      corners.push(points[3 * vertex], points[3 * vertex + 1], points[3 * vertex + 2]);
      smooth.push(x, y, z);
      if (uv) places.push(uv[2 * i], uv[2 * i + 1]);
    }
    indices[i] = k;
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
  geometry.setAttribute("normal", new THREE.Float32BufferAttribute(smooth, 3));
  if (uv) geometry.setAttribute("uv", new THREE.Float32BufferAttribute(places, 2));
  geometry.setIndex(new THREE.BufferAttribute(indices, 1));
  return geometry;
}

const TUBE_SIDES = 8;

// A tube through the points whose first `n` stretches are its first `n * TUBE_SIDES * 6` indices.
function tubeGeometry(points, radius) {
  const rings = points.length;
  const positions = new Float32Array(3 * rings * TUBE_SIDES);
  const normals = new Float32Array(3 * rings * TUBE_SIDES);
  const indices = new Uint32Array(6 * (rings - 1) * TUBE_SIDES);
  const tangent = new THREE.Vector3(0, 0, 1);
  const side = new THREE.Vector3(1, 0, 0);
  const [other, step] = [new THREE.Vector3(), new THREE.Vector3()];
  for (let i = 0; i < rings; i++) {
    step.subVectors(points[Math.min(i + 1, rings - 1)], points[Math.max(i - 1, 0)]);
    if (step.lengthSq() > 0) tangent.copy(step).normalize();
    side.addScaledVector(tangent, -side.dot(tangent));
    if (side.lengthSq() < 1e-6) side.set(tangent.y, tangent.z, tangent.x).cross(tangent);
    side.normalize();
    other.crossVectors(tangent, side);
    for (let k = 0; k < TUBE_SIDES; k++) {
      const angle = (2 * Math.PI * k) / TUBE_SIDES;
      step.copy(side).multiplyScalar(Math.cos(angle)).addScaledVector(other, Math.sin(angle));
      const at = 3 * (i * TUBE_SIDES + k);
      step.toArray(normals, at);
      step.multiplyScalar(radius).add(points[i]).toArray(positions, at);
      if (i === rings - 1) continue;
      const [a, b] = [i * TUBE_SIDES + k, i * TUBE_SIDES + ((k + 1) % TUBE_SIDES)];
      indices.set([a, b, b + TUBE_SIDES, a, b + TUBE_SIDES, a + TUBE_SIDES], 6 * a);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
  geometry.setIndex(new THREE.BufferAttribute(indices, 1));
  return geometry;
}
