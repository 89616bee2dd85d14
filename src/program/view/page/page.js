// The page: creates the scene, plots and controls, then draws whenever the state or the camera changed.

const element = (id) => document.getElementById(id);
const kMostNames = 2000;  // names offered in the field `find`; other names may be typed
const kMostListed = 8;    // most listed contacts whose force is outside of its cone

class Page {
  constructor() {
    this.data = readScene();
    this.times = this.data.frames.t;
    this.now = this.times[0];
    this.playing = false;
    this.changed = true;
    this.setWorld();
    this.setControls();
    this.setPlots();
    this.setText();
    this.setFirstCamera();
    this.followAddress();
    requestAnimationFrame((ms) => this.tick(ms));
  }

  setWorld() {
    this.renderer = new THREE.WebGLRenderer({canvas: element('canvas'), antialias: true});
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFSoftShadowMap;
    this.world = new THREE.Scene();
    this.world.background = new THREE.Color(0xe9eef3);
    this.camera = new OrbitCamera(element('canvas'), () => { this.changed = true; });
    this.robots = new Robots(this.data, this.world);
    this.robots.place(frameAt(this.times, this.now));
    this.world.updateMatrixWorld();

    const first = this.seen(this.robots.boxes());  // in the robots' first configuration
    const sizes = first.map((box) => box.getSize(new THREE.Vector3()).length()).sort((a, b) => a - b);
    this.size = sizes[sizes.length >> 1] || 1;  // median size of a robot, m
    this.lowest = Math.min(...first.map((box) => box.min.z));
    this.boxes = this.seen(this.robots.boxesOfMotion(this.world));
    this.box = this.boxes.reduce((all, box) => all.union(box), new THREE.Box3());
    this.robots.place(frameAt(this.times, this.now));
    this.contacts = new Contacts(this.data, this.size, this.world);
    this.addFloor();
    this.addLight();
  }

  // Returns the bounding boxes that are not empty, or a default box if no robot has a shape.
  seen(boxes) {
    const full = boxes.filter((box) => !box.isEmpty());
    return full.length > 0 ? full : [new THREE.Box3(new THREE.Vector3(-1, -1, 0), new THREE.Vector3(1, 1, 1))];
  }

  // The squares of the floor are a texture, because some browsers do not draw lines that pass the camera.
  addFloor() {
    const radius = Math.max(this.box.getSize(new THREE.Vector3()).length(), 2 * this.size);
    const centre = this.box.getCenter(new THREE.Vector3());
    this.cell = roundUp(Math.max(0.2 * this.size, 0.04 * radius));
    const cells = 2 * Math.ceil(20 * radius / this.cell), middle = (x) => Math.round(x / this.cell) * this.cell;
    const canvas = document.createElement('canvas'), g = canvas.getContext('2d'), n = 256;
    canvas.width = canvas.height = n;
    g.fillStyle = '#e3e8ec';
    g.fillRect(0, 0, n, n);
    g.strokeStyle = '#b3bfc9';
    g.lineWidth = 5;
    g.strokeRect(0, 0, n, n);
    const squares = new THREE.CanvasTexture(canvas);
    squares.wrapS = squares.wrapT = THREE.RepeatWrapping;
    squares.repeat.set(cells, cells);
    squares.anisotropy = this.renderer.capabilities.getMaxAnisotropy();
    const floor = new THREE.Mesh(new THREE.PlaneBufferGeometry(cells * this.cell, cells * this.cell),
                                 new THREE.MeshPhongMaterial({map: squares, specular: 0}));
    floor.receiveShadow = true;
    floor.position.set(middle(centre.x), middle(centre.y), this.lowest < -0.02 * this.size ? this.lowest : 0);
    this.world.add(floor);
    this.world.fog = new THREE.Fog(0xe9eef3, 4 * radius, 11 * radius);
  }

  addLight() {
    const radius = this.box.getSize(new THREE.Vector3()).length() / 2 + 0.4 * this.size;
    const centre = this.box.getCenter(new THREE.Vector3());
    this.world.add(new THREE.HemisphereLight(0xffffff, 0xb9b2a6, 0.7));
    this.lamp = new THREE.DirectionalLight(0xffffff, 0.22);  // moves with the camera
    this.world.add(this.lamp, this.lamp.target);
    const sun = new THREE.DirectionalLight(0xfff6e8, 0.4);
    sun.position.set(0.9, -0.6, 1.9).normalize().multiplyScalar(4 * radius).add(centre);
    sun.target.position.copy(centre);
    sun.castShadow = true;
    sun.shadow.mapSize.set(2048, 2048);
    Object.assign(sun.shadow.camera, {left: -radius, right: radius, top: radius, bottom: -radius, near: radius, far: 8 * radius});
    sun.shadow.bias = -0.0006;
    sun.shadow.radius = 3;
    this.world.add(sun, sun.target);
  }

  setFirstCamera() {
    const size = this.box.getSize(new THREE.Vector3());
    const wide = Math.hypot(size.x, size.y);
    this.camera.elevation = wide > 2.5 * size.z ? 0.5 : 0.2;
    this.camera.azimuth = size.x > 1.5 * size.y ? -1.2 : size.y > 1.5 * size.x ? -0.38 : -0.75;
    this.startTarget = this.box.getCenter(new THREE.Vector3());
    this.startCentre = this.robots.centre();
    this.camera.target.copy(this.startTarget);
  }

  // Returns the width of the picture that the panel covers [pixels].
  covered() { return Math.min(element('panel').offsetWidth + 12, element('canvas').clientWidth / 2); }

  setControls() {
    const update = () => { this.changed = true; };
    for (const id of ['colours', 'follow', 'scale', 'see_through', 'show_forces', 'show_cones', 'show_contacts'])
      element(id).addEventListener('input', update);
    window.addEventListener('resize', update);
    element('play').addEventListener('click', () => this.play(!this.playing));
    element('slider').addEventListener('input', (e) => this.seek(this.times[0] + e.target.value * this.duration));
    window.addEventListener('keydown', (e) => {
      if (e.target.tagName === 'SELECT' || e.target.type === 'search') return;
      const step = {ArrowRight: 1, ArrowLeft: -1}[e.key];
      if (e.key === ' ') this.play(!this.playing);
      else if (step && e.target.tagName !== 'INPUT') this.seek(this.times[this.neighbour(step)]);
      else return;
      e.preventDefault();
    });
    element('canvas').addEventListener('pointermove', (e) => this.point(e));
    element('names').append(...this.data.robots.concat(this.data.contacts).slice(0, kMostNames).map(({name}) => new Option(name)));
    element('find').addEventListener('change', (e) => this.find(e.target.value.trim()));
  }

  // Moves the camera to a robot or a contact, and describes the contact.
  find(name) {
    if (!name) return;
    this.draw();  // moves all robots and contacts to the current time
    const robot = this.data.robots.findIndex((r) => r.name === name), contact = this.contacts.list.find((c) => c.contact.name === name);
    const box = robot < 0 ? new THREE.Box3() : this.robots.boxes()[robot];
    if (!contact && box.isEmpty()) {
      element('pointed').textContent = robot < 0 ? 'there is no robot or contact ' + name : name + ' has no shape';
      return;
    }
    element('follow').checked = false;
    const at = contact && box.isEmpty() ? contact.group.position : box.getCenter(new THREE.Vector3());
    this.camera.target.copy(at);
    this.camera.distance = contact && box.isEmpty() ? this.size : Math.max(2 * box.getSize(new THREE.Vector3()).length(), this.size);
    this.camera.moved = true;
    element('pointed').textContent = contact && box.isEmpty() ? this.describe(contact) : name;
    document.body.dataset.found = name;
    this.changed = true;
  }

  get duration() { return this.times[this.times.length - 1] - this.times[0]; }

  neighbour(step) {
    const frame = frameAt(this.times, this.now).frame + step;
    return Math.min(Math.max(frame, 0), this.times.length - 1);
  }

  setPlots() {
    const {frames} = this.data;
    this.plots = [];
    element('timeline').hidden = this.times.length < 2;
    if (this.times.length < 2) return;
    // The potential energy is plotted relative to its first value: its zero is arbitrary, and an offset hides changes.
    const start = frames.potential.find((x) => isFinite(x)) || 0, potential = frames.potential.map((x) => x - start);
    const total = frames.kinetic.map((k, i) => k + potential[i]), seek = (t) => this.seek(t);
    this.plots.push(new Plot(element('energy'), 'energy [J], potential from its start', this.times, [
      {name: 'total', colour: '#22303c', values: total},
      {name: 'kinetic', colour: '#d9480f', values: frames.kinetic},
      {name: 'potential', colour: '#1c7ed6', values: potential},
    ], false, seek));
    this.plots.push(new Plot(element('drift'), 'constraint violation', this.times, [
      {name: 'position [m, rad]', colour: '#7048e8', values: frames.violation_position},
      {name: 'velocity [per s]', colour: '#2b8a3e', values: frames.violation_velocity},
    ], true, seek));
  }

  setText() {
    const {data} = this, bodies = this.robots.bodies.length;
    const count = (n, what) => n + ' ' + what + (n === 1 ? '' : /y$/.test(what) ? '' : 's');
    const islands = new Set(data.frames.islands.slice(0, data.robots.length)).size;
    document.title = data.name + ' - manycontact';
    element('title').textContent = data.name.replace(/_/g, '_\u200b');  // allows line breaks after underscores
    element('summary').textContent = count(data.robots.length, 'robot') + ', ' + (bodies === 1 ? '1 body' : bodies + ' bodies') +
        ', ' + count(islands, 'island') + ', ' + count(data.contacts.length, 'contact') + '; grid ' + show(this.cell) + ' m';
    const known = Array.from(data.frames.forces).some((x) => x === x);
    const notes = data.notes.slice();
    if (data.contacts.length > 0 && !known) notes.push('the forces are not known: the trajectory has none');
    element('notes').textContent = notes.join('\n');
    const cones = data.contacts.some((contact) => contact.friction > 0);
    element('show_cones').parentElement.hidden = !cones;
    if (!cones) element('show_cones').parentElement.style.display = 'none';
    Object.assign(document.body.dataset, {robots: data.robots.length, bodies, islands, contacts: data.contacts.length,
                                          shapes: this.robots.shapes.length, frames: this.times.length});
  }

  // "#t=0.3" starts at this time, "#play" plays, "#azimuth=..&elevation=..&distance=.." set the camera [rad, m], and
  // "#find=left" moves the camera to the robot or contact of this name.
  followAddress() {
    const words = new URLSearchParams(location.hash.slice(1));
    for (const name of ['azimuth', 'elevation', 'distance'])
      if (words.has(name) && isFinite(Number(words.get(name)))) this.camera[name] = Number(words.get(name));
    this.camera.moved = words.has('distance');
    if (words.has('t') && isFinite(Number(words.get('t')))) this.seek(Number(words.get('t')));
    if (words.has('play')) this.play(true);
    if (words.has('find')) this.find(words.get('find'));
  }

  play(on) {
    this.playing = on && this.times.length > 1;
    if (this.playing && this.now >= this.times[this.times.length - 1]) this.seek(this.times[0]);
    element('play').textContent = this.playing ? '\u275a\u275a' : '\u25b6';
  }

  seek(t) {
    this.now = Math.min(Math.max(t, this.times[0]), this.times[this.times.length - 1]);
    this.changed = true;
  }

  tick(ms) {
    requestAnimationFrame((next) => this.tick(next));
    const passed = this.before === undefined ? 0 : Math.min((ms - this.before) / 1000, 0.1);
    this.before = ms;
    if (this.playing) {
      const t = this.now + passed * Number(element('speed').value), end = this.times[this.times.length - 1];
      this.seek(t > end + 0.4 * Number(element('speed').value) ? this.times[0] : t);
      if (t > end) this.now = t;  // at the end, the motion pauses for a moment before it repeats
    }
    if (!this.changed) return;
    this.changed = false;
    this.draw();
  }

  draw() {
    const at = frameAt(this.times, this.now), scale = Math.pow(10, Number(element('scale').value));
    this.robots.opacity = element('see_through').checked ? 0.35 : 1;
    this.robots.paint(at.frame, element('colours').value);
    this.robots.place(at);
    this.contacts.shown = {forces: element('show_forces').checked, cones: element('show_cones').checked,
                           contacts: element('show_contacts').checked};
    this.contacts.place(at, scale);
    this.listOutside();
    element('scale_text').textContent = 'an arrow of 1 m: ' + show(this.contacts.newtons / scale) + ' N';
    const canvas = element('canvas'), width = canvas.clientWidth, height = canvas.clientHeight;
    if (!this.camera.moved)
      this.camera.fit(this.boxes, this.startTarget, (width - this.covered()) / height);
    if (element('follow').checked)
      this.camera.target.copy(this.robots.centre()).sub(this.startCentre).add(this.startTarget);

    this.renderer.setPixelRatio(window.devicePixelRatio || 1);
    this.renderer.setSize(width, height, false);
    this.camera.update(width, height, this.covered());
    this.lamp.position.copy(this.camera.camera.position);
    this.lamp.target.position.copy(this.camera.target);
    this.renderer.render(this.world, this.camera.camera);

    const now = Math.min(this.now, this.times[this.times.length - 1]);
    element('slider').value = this.duration > 0 ? (now - this.times[0]) / this.duration : 0;
    element('clock').textContent = now.toFixed(3) + ' / ' + this.times[this.times.length - 1].toFixed(3) + ' s';
    for (const plot of this.plots) plot.draw(now);
    document.body.dataset.frame = at.frame;
    document.body.dataset.distance = show(this.camera.distance);
    document.body.dataset.triangles = this.renderer.info.render.triangles;
  }

  // Lists the contacts whose force is outside of its friction cone.
  listOutside() {
    const outside = this.contacts.outside(), more = outside.length - kMostListed;
    element('outside').textContent = outside.length === 0 ? '' : 'outside of the friction cone: ' +
        outside.slice(0, kMostListed).join(', ') + (more > 0 ? ' and ' + more + ' more' : '');
    document.body.dataset.outside = outside.length;
  }

  // Finds the contact or the body under the mouse pointer, and describes it.
  point(e) {
    if (this.camera.dragging) return;
    const canvas = element('canvas'), ray = new THREE.Raycaster();
    ray.setFromCamera({x: 2 * e.offsetX / canvas.clientWidth - 1, y: 1 - 2 * e.offsetY / canvas.clientHeight}, this.camera.camera);
    const balls = this.contacts.list.filter((parts) => parts.group.visible).map((parts) => parts.ball);
    const ball = ray.intersectObjects(balls)[0], shape = ball ? undefined : ray.intersectObjects(this.robots.shapes)[0];
    element('pointed').textContent = ball ? this.describe(this.contacts.list[ball.object.userData.contact])
                                          : shape ? shape.object.userData.name : '';
  }

  describe({contact, force, shared}) {
    const text = contact.name + ', ' + contact.type + '\n' + contact.a + ' to ' + contact.b;
    if (isNaN(force.x)) return text;
    const numbers = text + '\n' + show(force.length()) + ' N: ' + force.toArray().map(show).join(', ');
    return shared ? numbers + '\nof least norm: contacts could share it otherwise' : numbers;
  }
}

window.addEventListener('error', (e) => {
  document.body.dataset.error = e.message;
  element('message').textContent = e.message;
});
if (document.createElement('canvas').getContext('webgl')) new Page();
else element('message').textContent = document.body.dataset.error = 'this browser shows no WebGL, which the view needs';
