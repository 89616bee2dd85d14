// Draws contacts: a ball at A's origin, a ring if the contact is redundant, the friction cone, and the force on A as an
// arrow (pale if the force is not unique and there is no cone). Lines connect A, its target frame B', and the frame
// that B' is fixed to, if these are apart.
// External wrenches are arrows of another colour. Springs are lines between their ends.

const kActive = 1, kRedundant = 2, kShared = 4;
const kApart = 0.05;  // least length of the lines between A, B' and B, relative to a robot's size; shorter are hidden
const kForceColour = 0xd9480f, kSharedColour = 0xb197fc, kInsideColour = 0x2b8a3e, kOutsideColour = 0xc92a2a, kWrenchColour = 0x1971c2, kSpringColour = 0x0b7285;

class Contacts {
  constructor(data, size, world) {
    this.data = data;
    this.size = size;  // size of a robot, m
    this.shown = {forces: true, cones: true, contacts: true};
    this.newtons = this.forceOfMetre();
    const shaft = new THREE.CylinderBufferGeometry(1, 1, 1, 14).translate(0, 0.5, 0).rotateX(Math.PI / 2);
    const head = new THREE.ConeBufferGeometry(1, 1, 18).translate(0, 0.5, 0).rotateX(Math.PI / 2);
    const ball = new THREE.SphereBufferGeometry(0.016 * size, 16, 12);
    const ring = new THREE.TorusBufferGeometry(0.036 * size, 0.007 * size, 10, 28);
    const cone = new THREE.ConeBufferGeometry(1, 1, 40, 1, true).rotateX(-Math.PI / 2).translate(0, 0, 0.5);
    const flat = (colour, more) => new THREE.MeshBasicMaterial(Object.assign({color: colour}, more));
    this.list = data.contacts.map((contact, c) => {
      const parts = {contact, group: new THREE.Group()};
      parts.ball = new THREE.Mesh(ball, flat(0x1c2733));
      parts.ring = new THREE.Mesh(ring, flat(0xc026d3));
      parts.cone = new THREE.Mesh(cone, flat(0x69db7c, {transparent: true, opacity: 0.3, side: THREE.DoubleSide, depthWrite: false}));
      parts.ball.userData.contact = c;
      parts.arrow = this.arrow(shaft, head);
      parts.lines = [0, 1].map(() => new THREE.Mesh(shaft, flat(0x1c2733, {transparent: true, opacity: 0.6})));
      world.add(...parts.lines);
      parts.group.add(parts.ball, parts.ring, parts.cone, parts.arrow.group);
      world.add(parts.group);
      return parts;
    });
    this.wrenches = Array.from({length: data.wrenches}, () => {
      const arrow = this.arrow(shaft, head);
      world.add(arrow.group);
      return arrow;
    });
    this.springs = Array.from({length: data.springs}, () => {
      const line = new THREE.Mesh(shaft, flat(kSpringColour));
      world.add(line);
      return line;
    });
  }

  // Makes an arrow that is visible through bodies, but paler: drawn once as a solid and once over everything.
  arrow(shaft, head) {
    const group = new THREE.Group();
    const solid = new THREE.MeshPhongMaterial({specular: 0x111111});
    const ghost = new THREE.MeshBasicMaterial({transparent: true, opacity: 0.55, depthTest: false, depthWrite: false});
    const parts = [[shaft, solid], [head, solid], [shaft, ghost], [head, ghost]].map(([geometry, material]) => {
      const mesh = new THREE.Mesh(geometry, material);
      mesh.castShadow = material === solid;
      mesh.renderOrder = material === ghost ? 2 : 0;
      group.add(mesh);
      return mesh;
    });
    return {group, solid, ghost, shafts: [parts[0], parts[2]], heads: [parts[1], parts[3]]};
  }

  // Returns the force [N] for an arrow of one metre, such that arrows of large forces have a third of a robot's size.
  forceOfMetre() {
    const {forces, wrenches} = this.data.frames, sizes = [];
    const add = (list, i) => {
      const f = Math.hypot(list[i], list[i + 1], list[i + 2]);
      if (f > 0) sizes.push(f);
    };
    for (let i = 0; i < forces.length; i += 3) add(forces, i);
    for (let i = 3; i < wrenches.length; i += 6) add(wrenches, i);
    if (sizes.length === 0) return 1000;
    const large = sizes.sort((a, b) => a - b)[Math.floor(0.95 * (sizes.length - 1))];
    return roundUp(large / (0.35 * this.size));
  }

  place(at, scale) {
    const {points, held, normals, forces, flags} = this.data.frames, n = this.list.length;
    const normal = new THREE.Vector3(), force = new THREE.Vector3(), at_B = new THREE.Vector3(), of_B = new THREE.Vector3();
    this.list.forEach((parts, c) => {
      const flag = flags[at.frame * n + c];
      parts.group.visible = parts.lines[0].visible = parts.lines[1].visible = (flag & kActive) !== 0;
      parts.outside = false;
      if (!parts.group.visible) return;
      vectorAt(points, c, n, at, parts.group.position);
      vectorAt(held, 2 * c, 2 * n, at, at_B);
      vectorAt(held, 2 * c + 1, 2 * n, at, of_B);
      this.placeLine(parts.lines[0], parts.group.position, at_B);
      this.placeLine(parts.lines[1], at_B, of_B);
      vectorAt(normals, c, n, at, normal).normalize();
      vectorAt(forces, c, n, at, force);
      parts.ball.visible = this.shown.contacts;
      parts.ring.visible = this.shown.contacts && (flag & kRedundant) !== 0;
      this.turn(parts.ring, normal);
      const inside = this.placeCone(parts, normal, force);
      parts.outside = inside === false;
      parts.shared = (flag & kShared) !== 0;
      const colour = inside === undefined ? (parts.shared ? kSharedColour : kForceColour) : inside ? kInsideColour : kOutsideColour;
      this.placeArrow(parts.arrow, force, scale, colour);
      parts.force = force.clone();
    });
    this.placeForces(at, scale);
  }

  // Returns the names of the active contacts whose force is outside of the friction cone.
  outside() { return this.list.filter((parts) => parts.outside).map((parts) => parts.contact.name); }

  placeForces(at, scale) {
    const {wrenches, springs} = this.data.frames, force = new THREE.Vector3(), end = new THREE.Vector3();
    this.wrenches.forEach((arrow, k) => {
      vectorAt(wrenches, 2 * k, 2 * this.wrenches.length, at, arrow.group.position);
      this.placeArrow(arrow, vectorAt(wrenches, 2 * k + 1, 2 * this.wrenches.length, at, force), scale, kWrenchColour);
    });
    this.springs.forEach((line, k) => {
      const from = vectorAt(springs, 2 * k, 2 * this.springs.length, at, force);
      this.placeLine(line, from, vectorAt(springs, 2 * k + 1, 2 * this.springs.length, at, end), 0);
    });
  }

  turn(object, z) { object.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), z); }

  placeLine(line, from, to, least = kApart * this.size) {
    const along = to.clone().sub(from), length = along.length();
    line.visible = this.shown.contacts && length > least;
    if (!line.visible) return;
    line.position.copy(from);
    line.scale.set(0.004 * this.size, 0.004 * this.size, length);
    this.turn(line, along.divideScalar(length));
  }

  // Places the friction cone of a contact. Returns whether the force is inside; undefined without a cone or a force.
  placeCone(parts, normal, force) {
    const mu = parts.contact.friction, known = mu > 0 && !isNaN(force.x);
    parts.cone.visible = this.shown.cones && mu > 0;
    if (parts.cone.visible) {
      const height = 0.13 * this.size / Math.max(1, mu);
      parts.cone.scale.set(mu * height, mu * height, height);
      this.turn(parts.cone, normal);
    }
    if (!known) return undefined;
    const along = force.dot(normal), across = Math.sqrt(Math.max(force.lengthSq() - along * along, 0));
    return across <= mu * along;
  }

  placeArrow(arrow, force, scale, colour) {
    const length = scale * force.length() / this.newtons;
    arrow.group.visible = this.shown.forces && length > 1e-3 * this.size;  // also hides the arrow of a NaN force
    if (!arrow.group.visible) return;
    const radius = 0.009 * this.size * Math.min(1, length / (0.1 * this.size)), head = Math.min(6 * radius, 0.5 * length);
    for (const shaft of arrow.shafts) shaft.scale.set(radius, radius, length - head);
    for (const cone of arrow.heads) {
      cone.scale.set(2.6 * radius, 2.6 * radius, head);
      cone.position.set(0, 0, length - head);
    }
    this.turn(arrow.group, force.clone().divideScalar(force.length()));
    arrow.solid.color.setHex(colour);
    arrow.ghost.color.setHex(colour);
  }
}
