#pragma once
// Bitwise equal versions of motion_at, force_from (algorithm/body_kinematics.hpp) and inertia times motion, for
// doubles. They write entries in pairs, as Eigen reads them: reading a pair after separate writes stalls.

#include <cstring>

#include "manycontact/spatial/inertia.hpp"

namespace manycontact::pairs {

typedef double Two __attribute__((vector_size(16)));

inline Two load(const double* x) {
  Two t;
  std::memcpy(&t, x, sizeof(t));
  return t;
}

[[gnu::always_inline]] inline Vec6<double> joined(Two a, Two b, Two c) {
  Vec6<double> out;
  std::memcpy(out.data(), &a, sizeof(a));
  std::memcpy(out.data() + 2, &b, sizeof(b));
  std::memcpy(out.data() + 4, &c, sizeof(c));
  return out;
}

inline void store(Two t, double* x) { std::memcpy(x, &t, sizeof(t)); }

[[gnu::always_inline]] inline void add(const Vec6<double>& x, Vec6<double>& y) {
  for (int k = 0; k < 6; k += 2) store(load(y.data() + k) + load(x.data() + k), y.data() + k);
}

inline Two max(Two x, Two y) { return x < y ? y : x; }

/// Returns the largest magnitude of the linear entries, and that of the angular entries.
[[gnu::always_inline]] inline Two sizes(const Vec6<double>& x) {
  const Two a = load(x.data()), b = load(x.data() + 2), c = load(x.data() + 4);
  const Two first{a[0], b[1]}, second{a[1], c[0]}, third{b[0], c[1]};
  const auto absolute = [](Two t) { return max(t, -t); };
  return max(absolute(first), max(absolute(second), absolute(third)));
}

/// Returns the motion m = [v; w] of a body at a point displaced by r: [v + w x r; w].
[[gnu::always_inline]] inline Vec6<double> motion_at(const Vec6<double>& m, const Vec3<double>& r) {
  const double x = r[0], y = r[1], z = r[2], w0 = m[3], w1 = m[4], w2 = m[5];
  return joined(load(m.data()) + (Two{w1, w2} * Two{z, x} - Two{w2, w0} * Two{y, z}), Two{m[2] + (w0 * y - w1 * x), w0},
                Two{w1, w2});
}

/// Returns the force [f; n] that acts at the point r, as a force at the origin: [f; n + r x f]. f: all six numbers.
[[gnu::always_inline]] inline Vec6<double> force_from(const double* f, const Vec3<double>& r) {
  const double x = r[0], y = r[1], z = r[2], f0 = f[0], f1 = f[1], f2 = f[2];
  return joined(load(f), Two{f2, f[3] + (y * f2 - z * f1)},
                load(f + 4) + (Two{z, x} * Two{f0, f1} - Two{x, y} * Two{f2, f0}));
}
[[gnu::always_inline]] inline Vec6<double> force_from(const Vec6<double>& f, const Vec3<double>& r) {
  return force_from(f.data(), r);
}

[[gnu::always_inline]] inline Vec6<double> times(const Inertia<double>& Y, const Vec6<double>& a) {
  const double v0 = a[0], v1 = a[1], v2 = a[2], w0 = a[3], w1 = a[4], w2 = a[5];
  const double h0 = Y.h[0], h1 = Y.h[1], h2 = Y.h[2], *I = Y.I.data();
  const Two f = Y.m * load(a.data()) - (Two{h1, h2} * Two{w2, w0} - Two{h2, h0} * Two{w1, w2});
  const Two n = load(I + 1) * w0 + load(I + 4) * w1 + load(I + 7) * w2;
  return joined(f, Two{Y.m * v2 - (h0 * w1 - h1 * w0), I[0] * w0 + I[3] * w1 + I[6] * w2 + (h1 * v2 - h2 * v1)},
                n + (Two{h2, h0} * Two{v0, v1} - Two{h0, h1} * Two{v2, v0}));
}

}  // namespace manycontact::pairs
