'use strict';
// Decodes the page's numbers from base64 to typed arrays, and interpolates between frames.

function decode(text, Type) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Type(bytes.buffer);
}

// Returns the page's scene, with its frames as typed arrays.
function readScene() {
  const scene = JSON.parse(document.getElementById('scene').textContent);
  const types = {t: Float64Array, quaternions: Int16Array, islands: Int32Array, flags: Uint8Array};
  for (const name of Object.keys(scene.frames))
    if (name !== 'count') scene.frames[name] = decode(scene.frames[name], types[name] || Float32Array);
  for (const mesh of scene.meshes) {
    mesh.vertices = decode(mesh.vertices, Float32Array);
    mesh.triangles = decode(mesh.triangles, Uint32Array);
  }
  return scene;
}

// Returns the last frame at or before time t, the next frame, and t's position between them from 0 to 1.
function frameAt(times, t) {
  let low = 0, high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  if (low >= times.length - 1) return {frame: times.length - 1, next: times.length - 1, part: 0};
  const part = Math.min(Math.max((t - times[low]) / (times[high] - times[low]), 0), 1);
  return part === 1 ? {frame: high, next: high, part: 0} : {frame: low, next: high, part};
}

// Sets `out` to vector i of n per frame, interpolated between two frames; if the second frame has NaN, to the first's.
function vectorAt(array, i, n, at, out) {
  const a = 3 * (at.frame * n + i), b = 3 * (at.next * n + i);
  const s = isNaN(array[b]) ? 0 : at.part;
  const between = (k) => s === 0 ? array[a + k] : (1 - s) * array[a + k] + s * array[b + k];
  return out.set(between(0), between(1), between(2));
}

// Returns the least number that is at least x and is 1, 2 or 5 times a power of ten.
function roundUp(x) {
  const power = Math.pow(10, Math.floor(Math.log10(x)));
  return [1, 2, 5, 10].map((k) => k * power).find((y) => y >= x * 0.999);
}

// Formats x with three significant digits.
function show(x) {
  if (x === 0 || !isFinite(x)) return String(x);
  return Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(1) : String(Number(x.toPrecision(3)));
}
