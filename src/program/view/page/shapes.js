// Draws robots: each body is a group that the recorded frames move; its shapes are in the body's axes.

// Makes the geometry of a shape, with its axis along z. All copies of a robot share it.
function makeGeometry(shape, meshes) {
  const [a, b, c] = shape.size;
  if (shape.shape === 'box') return new THREE.BoxBufferGeometry(a, b, c);
  if (shape.shape === 'sphere') return new THREE.SphereBufferGeometry(a, 24, 16);
  if (shape.shape === 'cylinder') return new THREE.CylinderBufferGeometry(a, a, b, 28).rotateX(Math.PI / 2);
  if (shape.shape === 'capsule') {  // its outline: a half ball, the mantle, a half ball
    const half = [...Array(9)].map((_, k) => k * Math.PI / 16);
    const below = half.map((x) => new THREE.Vector2(a * Math.sin(x), -b / 2 - a * Math.cos(x)));
    const above = half.reverse().map((x) => new THREE.Vector2(a * Math.sin(x), b / 2 + a * Math.cos(x)));
    return new THREE.LatheBufferGeometry([...below, ...above], 20).rotateX(Math.PI / 2);
  }
  const indexed = new THREE.BufferGeometry();
  indexed.setAttribute('position', new THREE.BufferAttribute(meshes[shape.mesh].vertices.slice(), 3));
  indexed.setIndex(new THREE.BufferAttribute(meshes[shape.mesh].triangles, 1));
  const flat = indexed.toNonIndexed().scale(a, b, c);  // each triangle has its own normal
  flat.computeVertexNormals();
  return flat;
}

class Robots {
  constructor(data, world) {
    this.data = data;
    this.bodies = [];  // three.js groups of the bodies of all robots, which the frames move
    this.robotOf = [];  // index of each body's robot
    this.shapes = [];  // one three.js mesh per shape; its userData contains its robot
    this.materials = new Map();
    this.opacity = 1;
    const geometries = data.models.map((model) => model.shapes.map((shape) => makeGeometry(shape, data.meshes)));
    data.robots.forEach((robot, r) => this.addRobot(robot, r, geometries[robot.model], world));
    this.nameIslands();
  }

  addRobot(robot, r, geometries, world) {
    const model = this.data.models[robot.model];
    const place = (object, at) => {
      object.position.fromArray(at, 0);
      object.quaternion.fromArray(at, 3);
    };
    const base = new THREE.Group(), first = this.bodies.length;
    place(base, robot.base);
    world.add(base);
    for (let i = 0; i < model.bodies.length; ++i) {
      const body = new THREE.Group();
      world.add(body);
      this.bodies.push(body);
      this.robotOf.push(r);
    }
    model.shapes.forEach((shape, k) => {
      const mesh = new THREE.Mesh(geometries[k]);
      place(mesh, shape.at);
      mesh.castShadow = mesh.receiveShadow = true;
      mesh.userData = {robot: r, colour: shape.colour,
                       name: robot.name + (shape.body < 0 ? '' : '/' + model.bodies[shape.body])};
      (shape.body < 0 ? base : this.bodies[first + shape.body]).add(mesh);
      this.shapes.push(mesh);
    });
  }

  // Numbers islands in the order of their first frames, so that an island keeps its colour through the motion.
  nameIslands() {
    this.islands = new Map();
    for (const island of this.data.frames.islands)
      if (!this.islands.has(island)) this.islands.set(island, this.islands.size);
  }

  // Returns a mesh's colour. Hues of islands or robots differ by the golden angle; robots of an island, in lightness.
  colourOf(mesh, frame, by) {
    const robot = mesh.userData.robot, urdf = mesh.userData.colour;
    if (by === 'urdf') return urdf ? new THREE.Color(urdf[0], urdf[1], urdf[2]) : new THREE.Color(0x9aa7b3);
    const first = this.data.frames.islands[frame * this.data.robots.length + robot];
    const group = by === 'robots' ? robot : this.islands.get(first);
    const shade = by === 'robots' ? 0 : [0, 0.12, -0.14, 0.06, -0.07][(robot - first) % 5];
    return new THREE.Color().setHSL(((208 + 137.508 * group) % 360) / 360, 0.5, 0.6 + shade);
  }

  paint(frame, by) {
    const n = this.data.robots.length;
    const key = by + this.opacity + this.data.frames.islands.slice(frame * n, (frame + 1) * n).join();
    if (key === this.painted) return;
    this.painted = key;
    for (const mesh of this.shapes) {
      const colour = this.colourOf(mesh, frame, by), name = colour.getHex() + ' ' + this.opacity;
      if (!this.materials.has(name))
        this.materials.set(name, new THREE.MeshPhongMaterial({
          color: colour, specular: 0x222222, shininess: 25, side: THREE.DoubleSide,
          transparent: this.opacity < 1, opacity: this.opacity, depthWrite: this.opacity === 1,
        }));
      mesh.material = this.materials.get(name);
    }
  }

  place(at) {
    const {positions, quaternions} = this.data.frames, n = this.bodies.length, next = new THREE.Quaternion();
    this.bodies.forEach((body, i) => {
      vectorAt(positions, i, n, at, body.position);
      body.quaternion.fromArray(quaternions, 4 * (at.frame * n + i)).normalize();
      if (at.part > 0)
        body.quaternion.slerp(next.fromArray(quaternions, 4 * (at.next * n + i)).normalize(), at.part);
    });
  }

  // Returns bounding boxes of the robots' shapes at the current time.
  boxes() {
    const boxes = this.data.robots.map(() => new THREE.Box3());
    for (const mesh of this.shapes) boxes[mesh.userData.robot].expandByObject(mesh);
    return boxes;
  }

  // Returns bounding boxes over the whole motion: of shapes at some frames, of bodies' origins at all frames.
  boxesOfMotion(world) {
    const boxes = this.boxes(), {positions} = this.data.frames, frames = this.data.frames.t.length;
    const samples = Math.min(frames, Math.max(2, Math.min(24, Math.floor(20000 / this.shapes.length))));
    for (let k = 1; k < samples; ++k) {
      const frame = Math.round(k * (frames - 1) / (samples - 1));
      this.place({frame, next: frame, part: 0});
      world.updateMatrixWorld();
      this.boxes().forEach((box, r) => boxes[r].union(box));
    }
    const n = this.bodies.length, point = new THREE.Vector3();
    for (let i = 0; i < frames * n; ++i) {
      const box = boxes[this.robotOf[i % n]];
      if (!box.isEmpty()) box.expandByPoint(point.fromArray(positions, 3 * i));
    }
    return boxes;
  }

  centre() {
    const sum = new THREE.Vector3();
    for (const body of this.bodies) sum.add(body.position);
    return sum.divideScalar(Math.max(this.bodies.length, 1));
  }
}
