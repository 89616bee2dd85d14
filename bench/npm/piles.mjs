// Piles of boxes in physics engines from npm, and in manycontact.
//
//   node bench/npm/piles.mjs FOLDER_WITH_node_modules [MANYCONTACT, or ""] [SECONDS] > piles.json
//
// Towers, tables and walls rest from the start. Each engine takes steps of 1/240 s for SECONDS (2) with its default solver; only
// sleeping is switched off. Boxes are cubes of 1 m and 9 kg, in contact where they carry each other and 0.1 m apart elsewhere.
//   step_us        median time of a step in the second half; of manycontact, mean of a simulation's steps
//   solve_us       of manycontact: one solve, the median of 50
//   force_error    of the vertical force of the ground on the pile in the last step, relative to the weight; null: not reported
//   penetration_mm the deepest of a body in the one below it, at the end
//   drift_mm       the longest way of a body from its place
//   speed          the greatest of a body at the end [m/s]
//   stands         no body is 0.5 m or more from its place

import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [folder, manycontact, seconds] = process.argv.slice(2);
if (!folder) {
  console.error("usage: node piles.mjs FOLDER_WITH_node_modules [MANYCONTACT, or \"\"] [SECONDS]");
  process.exit(2);
}
const H = 1 / 240, SECONDS = Number(seconds ?? 2), DENSITY = 9, GRAVITY = 9.81;
const LONGEST = 60; // seconds of measurement of one scene
const say = (text) => process.stderr.write(`${text}\n`);
const round = (x, digits = 4) => (x == null ? null : Number(x.toPrecision(digits)));
const median = (x) => [...x].sort((a, b) => a - b)[x.length >> 1];

// ---- scenes: bodies { size, at }, and supports { upper, lower (-1: the ground), rectangle [x0, x1, y0, y1] } --------------

const PITCH = 1.1;
const box = (x, y, z, width = 1) => ({ size: [width, 1, 1], at: [x, y, z + 0.5] });
const tower = (n) => Array.from({ length: n }, (_, k) => box(0, 0, k));

function table(n) {
  const side = Math.sqrt(n), half = (side - 1) / 2;
  const boxes = Array.from({ length: n }, (_, k) => box(PITCH * ((k % side) - half), PITCH * (Math.floor(k / side) - half), 1));
  return [{ size: [PITCH * side, PITCH * side, 1], at: [0, 0, 0.5] }, ...boxes];
}

// Rows in running bond: every second one is shifted by half a brick, and has a short brick at each end.
function wall(rows) {
  const bricks = [];
  for (let z = 0; z < rows; ++z) {
    const shift = z % 2 ? PITCH / 2 : 0;
    for (let k = 0; k < rows - (z % 2); ++k) bricks.push(box(PITCH * k + shift, 0, z));
    if (z % 2) bricks.push(box(-0.275, 0, z, 0.45), box(PITCH * (rows - 1) + 0.275, 0, z, 0.45));
  }
  return bricks;
}

function supportsOf(bodies) {
  const least = (b, k) => b.at[k] - b.size[k] / 2, most = (b, k) => b.at[k] + b.size[k] / 2;
  const ground = { at: [0, 0, -1], size: [1e3, 1e3, 2] };
  return bodies.flatMap((upper, i) => [ground, ...bodies].flatMap((lower, j) => {
    const [x0, x1, y0, y1] = [0, 1].flatMap((k) => [Math.max(least(upper, k), least(lower, k)), Math.min(most(upper, k), most(lower, k))]);
    const touches = Math.abs(most(lower, 2) - least(upper, 2)) < 1e-9 && x1 - x0 > 1e-9 && y1 - y0 > 1e-9;
    return touches ? [{ upper: i, lower: j - 1, rectangle: [x0, x1, y0, y1] }] : [];
  }));
}

const mass = (b) => DENSITY * b.size[0] * b.size[1] * b.size[2];
const KINDS = [[tower, [10, 40, 160]], [table, [16, 64, 256]], [wall, [4, 10, 20]]];
const SCENES = KINDS.flatMap(([make, sizes]) => sizes.map((n) => {
  const bodies = make(n), weight = GRAVITY * bodies.reduce((sum, b) => sum + mass(b), 0);
  return { name: `${make.name} ${make === wall ? bodies.length : n}`, bodies, supports: supportsOf(bodies), weight };
}));

// ---- engines: each makes a pile { settings, step(), places(), speeds(), groundForce?(), free() } -------------------------

const GROUND = [100, 100, 1]; // half of its sizes
const load = (name, entry) => import(pathToFileURL(path.resolve(folder, "node_modules", name, entry)));
const norm = (v) => Math.hypot(...v);
const xyz = (v) => [v.x, v.y, v.z];

async function rapier() {
  const { default: R } = await load("@dimforge/rapier3d-compat", "dist/rapier.mjs");
  await R.init();
  return ({ bodies, supports }) => {
    const world = new R.World({ x: 0, y: 0, z: -GRAVITY });
    world.timestep = H;
    const ground = world.createCollider(R.ColliderDesc.cuboid(...GROUND).setTranslation(0, 0, -GROUND[2]));
    const made = bodies.map(({ size, at }) => {
      const body = world.createRigidBody(R.RigidBodyDesc.dynamic().setTranslation(...at).setCanSleep(false));
      const shape = R.ColliderDesc.cuboid(...size.map((s) => s / 2)).setDensity(DENSITY);
      return { body, collider: world.createCollider(shape, body) };
    });
    return {
      settings: `${world.numSolverIterations} iterations, ${world.numInternalPgsIterations} internal, friction 0.5; float`,
      step: () => world.step(),
      places: () => made.map(({ body }) => xyz(body.translation())),
      speeds: () => made.map(({ body }) => norm(xyz(body.linvel()))),
      groundForce() {
        let impulse = 0;
        for (const { upper } of supports.filter((s) => s.lower < 0))
          world.contactPair(ground, made[upper].collider, (m) => {
            for (let k = 0; k < m.numContacts(); ++k) impulse += m.contactImpulse(k);
          });
        return impulse / H;
      },
      free: () => world.free(),
    };
  };
}

async function jolt() {
  const { default: init } = await load("jolt-physics", "dist/jolt-physics.wasm-compat.js");
  const J = await init();
  return ({ bodies }) => {
    const settings = new J.JoltSettings();
    const layers = new J.BroadPhaseLayerInterfaceTable(2, 2), pairs = new J.ObjectLayerPairFilterTable(2);
    for (const k of [0, 1]) layers.MapObjectToBroadPhaseLayer(k, new J.BroadPhaseLayer(k));
    pairs.EnableCollision(0, 1);
    pairs.EnableCollision(1, 1);
    settings.mBroadPhaseLayerInterface = layers;
    settings.mObjectLayerPairFilter = pairs;
    settings.mObjectVsBroadPhaseLayerFilter = new J.ObjectVsBroadPhaseLayerFilterTable(layers, 2, pairs, 2);
    const physics = new J.JoltInterface(settings);
    const system = physics.GetPhysicsSystem(), used = system.GetPhysicsSettings();
    system.SetGravity(new J.Vec3(0, 0, -GRAVITY));
    const make = (half, at, moving) => {
      const shape = new J.BoxShape(new J.Vec3(...half));
      shape.SetDensity(DENSITY);
      const kind = moving ? J.EMotionType_Dynamic : J.EMotionType_Static;
      const creation = new J.BodyCreationSettings(shape, new J.RVec3(...at), new J.Quat(0, 0, 0, 1), kind, moving ? 1 : 0);
      creation.mAllowSleeping = false;
      const body = system.GetBodyInterface().CreateBody(creation);
      system.GetBodyInterface().AddBody(body.GetID(), J.EActivation_Activate);
      return body;
    };
    make(GROUND, [0, 0, -GROUND[2]], false);
    const made = bodies.map(({ size, at }) => make(size.map((s) => s / 2), at, true));
    system.OptimizeBroadPhase();
    const read = (v) => [v.GetX(), v.GetY(), v.GetZ()];
    return {
      settings: `${used.mNumVelocitySteps} velocity steps, ${used.mNumPositionSteps} position steps, friction 0.2; float`,
      step: () => physics.Step(H, 1),
      places: () => made.map((body) => read(body.GetPosition())),
      speeds: () => made.map((body) => norm(read(body.GetLinearVelocity()))),
      free: () => J.destroy(physics),
    };
  };
}

async function mujoco() {
  const { default: init } = await load("@mujoco/mujoco", "mujoco.js");
  const M = await init();
  return ({ bodies }) => {
    const geom = (half, at = [0, 0, 0]) => `<geom type="box" size="${half.join(" ")}" pos="${at.join(" ")}" density="${DENSITY}"/>`;
    const moving = bodies.map(({ size, at }) => `<body pos="${at.join(" ")}"><freejoint/>${geom(size.map((s) => s / 2))}</body>`);
    const model = M.MjModel.from_xml_string(`<mujoco><size memory="512M"/><option timestep="${H}" gravity="0 0 ${-GRAVITY}"/>
      <worldbody>${geom(GROUND, [0, 0, -GROUND[2]])}${moving.join("")}</worldbody></mujoco>`);
    const data = new M.MjData(model);
    const each = (read) => bodies.map((_, k) => read(k));
    return {
      settings: `Newton, ${model.opt.iterations} iterations, tolerance ${model.opt.tolerance}, pyramids, friction 1; double`,
      step: () => M.mj_step(model, data),
      places: () => each((k) => [...data.qpos.slice(7 * k, 7 * k + 3)]),
      speeds: () => each((k) => norm(data.qvel.slice(6 * k, 6 * k + 3))),
      // forces between bodies cancel in this sum
      groundForce: () => each((k) => data.qfrc_constraint[6 * k + 2]).reduce((a, b) => a + b),
      free: () => (data.delete(), model.delete()),
    };
  };
}

// ---- measurements ---------------------------------------------------------------------------------------------------------

function displacements({ bodies, supports }, places) {
  const sunk = (k) => (k < 0 ? 0 : bodies[k].at[2] - places[k][2]);
  return {
    penetration_mm: round(1000 * Math.max(0, ...supports.map((s) => sunk(s.upper) - sunk(s.lower)))),
    drift_mm: round(1000 * Math.max(...places.map((p, k) => norm(p.map((x, i) => x - bodies[k].at[i]))))),
  };
}

function measure(scene, pile) {
  const times = [], steps = Math.round(SECONDS / H), begin = performance.now();
  while (times.length < steps && performance.now() - begin < 1000 * LONGEST) {
    const t = performance.now();
    pile.step();
    times.push(1000 * (performance.now() - t));
  }
  const moved = displacements(scene, pile.places());
  const force = pile.groundForce?.();
  return {
    step_us: round(median(times.slice(times.length >> 1))), simulated_s: round(times.length * H),
    force_error: force == null ? null : round(Math.abs(force / scene.weight - 1), 2),
    ...moved, speed: round(Math.max(...pile.speeds()), 2), stands: moved.drift_mm < 500,
  };
}

// manycontact's contacts are given: the corners of each rectangle, as points that neither open nor slide. A solve computes exact
// accelerations and forces; it is not a step of a simulation, which has an integration and checks in addition.
function measureManycontact(scene, work) {
  const { bodies, supports, weight } = scene;
  const robots = bodies.map((b, k) => {
    const [x, y, z] = b.size, m = mass(b), urdf = `box_${x}_${y}.urdf`;
    const inertia = `ixx="${m * (y * y + z * z) / 12}" iyy="${m * (x * x + z * z) / 12}" izz="${m * (x * x + y * y) / 12}"`;
    fs.writeFileSync(path.join(work, urdf), `<robot name="b"><link name="b"><inertial><mass value="${m}"/>` +
      `<inertia ${inertia} ixy="0" ixz="0" iyz="0"/></inertial></link></robot>`);
    return `<robot name="b${k}" urdf="${urdf}" base="floating" xyz="${b.at.join(" ")}"/>`;
  });
  const contacts = supports.flatMap(({ upper, lower, rectangle: [x0, x1, y0, y1] }, s) =>
    [[x0, y0], [x0, y1], [x1, y0], [x1, y1]].map(([x, y], k) => {
      const offset = [x - bodies[upper].at[0], y - bodies[upper].at[1], -bodies[upper].size[2] / 2].join(" ");
      return `<contact name="c${s}_${k}" type="3d" frame="b${upper}/b" offset="${offset}"${lower < 0 ? "" : ` to="b${lower}/b"`}/>`;
    }));
  const file = path.join(work, "pile.xml");
  fs.writeFileSync(file, `<scene>${robots.join("")}${contacts.join("")}</scene>`);
  const options = { maxBuffer: 1 << 30, stdio: ["ignore", "pipe", "ignore"] };
  const run = (...words) => JSON.parse(execFileSync(manycontact, [...words, "--json", "-"], options));
  const solved = run("solve", file, "--repeat", "50");
  let ground = 0; // each support has 12 forces: those of its four points
  solved.forces.forEach((f, k) => (ground += k % 3 === 2 && supports[Math.floor(k / 12)].lower < 0 ? f : 0));

  const out = path.join(work, "pile.csv");
  const simulate = (steps) => {
    const t = performance.now();
    run("simulate", file, "--time", String(steps * H), "--step", String(H), "--out", out, "--every", String(steps));
    return performance.now() - t;
  };
  const steps = Math.round(SECONDS / H), durations = []; // differences leave loading out
  while (durations.length < 5 && !(durations[0] > 2000)) durations.push(-simulate(24) + simulate(steps));
  const [head, ...rows] = fs.readFileSync(out, "utf8").trim().split("\n").map((line) => line.split(","));
  const last = rows.at(-1).map(Number), [q, v] = ["q:", "v:"].map((kind) => head.findIndex((name) => name.startsWith(kind)));
  const moved = displacements(scene, bodies.map((_, k) => last.slice(q + 7 * k, q + 7 * k + 3)));
  return {
    solve_us: round(solved.report.time_us.solve), step_us: round((1000 * median(durations)) / (steps - 24)), simulated_s: SECONDS,
    force_error: round(Math.abs(ground / weight - 1), 2), ...moved,
    speed: round(Math.max(...bodies.map((_, k) => norm(last.slice(v + 6 * k, v + 6 * k + 3)))), 2), stands: moved.drift_mm < 500,
    status: solved.report.status,
  };
}

const results = [];
const note = (program, version, settings, scene, result) => {
  results.push({ program, version, scene: scene.name, bodies: scene.bodies.length, ...result, settings });
  say(`${program} ${version}, ${scene.name}: a step takes ${result.step_us} us${result.stands ? "" : ", it collapses"}`);
};
for (const [name, open] of [["@dimforge/rapier3d-compat", rapier], ["jolt-physics", jolt], ["@mujoco/mujoco", mujoco]]) {
  try {
    const { version } = JSON.parse(fs.readFileSync(path.join(folder, "node_modules", name, "package.json"), "utf8"));
    const create = await open();
    const warm = create(SCENES[0]); // until the engine's code is compiled with all optimisations
    for (let k = 0; k < 3000; ++k) warm.step();
    warm.free();
    for (const scene of SCENES) {
      const pile = create(scene);
      note(name, version, pile.settings, scene, measure(scene, pile));
      pile.free();
    }
  } catch (error) {
    say(`skipped: ${name}: ${String(error.message ?? error).split("\n")[0]}`);
  }
}
if (manycontact) {
  const work = fs.mkdtempSync(path.join(os.tmpdir(), "piles-"));
  try {
    const version = execFileSync(manycontact, ["--version"], { encoding: "utf8" }).trim().split(" ").pop();
    for (const scene of SCENES) note("manycontact", version, "defaults: exact, no damping", scene, measureManycontact(scene, work));
  } catch (error) {
    say(`skipped: manycontact: ${String(error.message ?? error).split("\n")[0]}`);
  }
  fs.rmSync(work, { recursive: true });
}
const machine = `${os.cpus()[0].model}, one core, another process may have used the second`;
const head = { date: new Date().toISOString().slice(0, 10), machine, node: process.version, step: H };
const lines = results.map((result) => JSON.stringify(result)).join(",\n");
console.log(`${JSON.stringify(head).slice(0, -1)},"results":[\n${lines}\n]}`);
