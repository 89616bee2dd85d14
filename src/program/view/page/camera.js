// A camera on a sphere about a target, z up. Dragging rotates it, the right button or shift moves the target, and the
// wheel or two fingers change the distance.

class OrbitCamera {
  constructor(canvas, changed) {
    this.camera = new THREE.PerspectiveCamera(35, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    this.target = new THREE.Vector3();
    this.azimuth = -0.9;   // rad, from x towards y
    this.elevation = 0.28; // rad
    this.distance = 5;     // m
    this.moved = false;    // whether the user moved the camera
    this.changed = changed;
    this.pointers = new Map();
    canvas.addEventListener('pointerdown', (e) => this.down(canvas, e));
    canvas.addEventListener('pointermove', (e) => this.move(canvas, e));
    for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, (e) => this.pointers.delete(e.pointerId));
    canvas.addEventListener('wheel', (e) => { e.preventDefault(); this.zoom(Math.exp(0.001 * e.deltaY)); }, {passive: false});
    canvas.addEventListener('contextmenu', (e) => e.preventDefault());
  }

  // Returns the unit vector from the target to the camera.
  direction() {
    const c = Math.cos(this.elevation);
    return new THREE.Vector3(c * Math.cos(this.azimuth), c * Math.sin(this.azimuth), Math.sin(this.elevation));
  }

  // Sets the distance to `middle` so that the boxes fill a picture of the ratio `aspect` of width to height. A corner
  // that is x beside `middle`, and z nearer to the camera, requires a distance of x / tan(half the view angle) + z.
  fit(boxes, middle, aspect) {
    this.target.copy(middle);
    const back = this.direction(), right = new THREE.Vector3(-Math.sin(this.azimuth), Math.cos(this.azimuth), 0);
    const above = back.clone().cross(right), slope = 0.97 * Math.tan(THREE.Math.degToRad(this.camera.fov) / 2);
    this.distance = 0;
    for (const {min, max} of boxes)
      for (let k = 0; k < 8; ++k) {
        const corner = new THREE.Vector3(k & 1 ? min.x : max.x, k & 2 ? min.y : max.y, k & 4 ? min.z : max.z);
        corner.sub(this.target);
        const side = Math.max(Math.abs(corner.dot(right)) / aspect, Math.abs(corner.dot(above)));
        this.distance = Math.max(this.distance, side / slope + corner.dot(back));
      }
  }

  // Updates the camera for a picture of this size [pixels], of which the leftmost `covered` pixels are hidden.
  update(width, height, covered) {
    this.camera.position.copy(this.direction()).multiplyScalar(this.distance).add(this.target);
    this.camera.lookAt(this.target);
    this.camera.aspect = width / height;
    this.camera.near = this.distance / 50;
    this.camera.far = this.distance * 100;
    this.camera.setViewOffset(width, height, -covered / 2, 0, width, height);
    this.camera.updateMatrixWorld();
  }

  get dragging() { return this.pointers.size > 0; }

  down(canvas, e) {
    canvas.setPointerCapture(e.pointerId);
    this.pointers.set(e.pointerId, {x: e.clientX, y: e.clientY});
    this.moved = true;
  }

  move(canvas, e) {
    const before = this.pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before.x, dy = e.clientY - before.y;
    const other = [...this.pointers].filter(([id]) => id !== e.pointerId).map(([, p]) => p)[0];
    if (other) {
      const reach = (p) => Math.hypot(p.x - other.x, p.y - other.y);
      this.zoom(reach(before) / Math.max(reach({x: e.clientX, y: e.clientY}), 1));
      this.pan(dx / 2, dy / 2, canvas.clientHeight);
    } else if (e.shiftKey || e.buttons & 6) {
      this.pan(dx, dy, canvas.clientHeight);
    } else {
      this.azimuth -= 0.006 * dx;
      this.elevation = Math.min(Math.max(this.elevation + 0.006 * dy, -1.5), 1.5);
      this.changed();
    }
    this.pointers.set(e.pointerId, {x: e.clientX, y: e.clientY});
  }

  pan(dx, dy, height) {
    const metres = 2 * this.distance * Math.tan(THREE.Math.degToRad(this.camera.fov) / 2) / height;
    const axis = new THREE.Vector3();
    this.target.addScaledVector(axis.setFromMatrixColumn(this.camera.matrixWorld, 0), -dx * metres);
    this.target.addScaledVector(axis.setFromMatrixColumn(this.camera.matrixWorld, 1), dy * metres);
    this.changed();
  }

  zoom(factor) {
    this.distance = Math.min(Math.max(this.distance * factor, 1e-3), 1e5);
    this.moved = true;
    this.changed();
  }
}
