#pragma once
// The equations of a scene in double-double, for the precision `extended`:
//
//     [M  J^T     ] [ a]   [tau - h        ]
//     [J  -delta I] [-f] = [prescribed - a0].
//
// K is never formed: K x is inverse dynamics of the accelerations a with the contacts' forces f on the bodies, and the
// relative accelerations of the contacts' frames, at a cost linear in the bodies. A double factor of K corrects x
// (extended.cpp). Compiled once per level of instructions (src/core/simd/levels.cmake), where the scalar stays.

#include <memory>
#include <span>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact::extended {

/// A state in the scene's coordinates. Everything is read during the calls alone.
struct Job {
  const Scene& scene;
  const double *q, *v, *tau;         // tau (nv): without friction, springs and external wrenches
  std::span<const Vec6<double>> w;   // external wrenches, one per push of the scene
  bool applied;                      // whether any wrench or spring acts
  const double* prescribed;          // prescribed accelerations of the rows, as f; nullptr: zero
  const double* damping;             // delta, per contact of the scene
  const std::vector<int>& f_offset;  // one entry per contact; negative: not active
};

/// The whole islands that a call is about.
struct Part {
  std::span<const int> robots, contacts;  // numbers in the scene
};

class Equations {
 public:
  virtual ~Equations() = default;

  /// The terms at a state. x = [a; f], of nv and of f's rows; r = b - K x.
  virtual void begin(const Job& job, const Part& part, const double* a, const double* f) = 0;
  /// x += [da; df], and with `residual` r = b - K x.
  virtual void add(const Part& part, const double* da, const double* df, bool residual) = 0;
  /// r, rounded.
  virtual void residual(const Part& part, double* of_dynamics, double* of_contacts) const = 0;
  /// x, rounded.
  virtual void round(const Part& part, double* a, double* f) const = 0;
  /// x - [a; f], rounded.
  virtual void difference(const Part& part, const double* a, const double* f, double* da, double* df) const = 0;

  // The part of forces that moves nothing, n of f = n + S^2 J y, J^T n = 0; or the part of the contacts' residual
  // r = n + J y that no accelerations satisfy, J^T S^2 n = 0.
  enum class Projected { kForces, kResidual };
  /// rest = f of x, or r. weights: S, per row of f.
  virtual void begin_projection(const Part& part, Projected what, const double* weights) = 0;
  /// rest -= S^2 J dy, of forces, or J dy. change: the term subtracted.
  virtual void project(const Part& part, const double* dy, double* change) = 0;
  /// torque = J^T S^2 J dy of the step dy that is left, rounded: J^T rest of forces, J^T S^2 rest of residuals. The
  /// rest itself is far larger than the part that a step is to take from it.
  virtual void gradient_of_rest(const Part& part, double* torque) = 0;
  /// Takes the rest from x's f, or from b.
  virtual void take_rest(const Part& part) = 0;

  // Forces of J^T's null space.
  /// rest = f
  virtual void set_rest(const Part& part, const double* f) = 0;
  /// torque = J^T rest, rounded. Returns its largest entry relative to the largest sum of the terms of one.
  virtual double torque_of_rest(const Part& part, double* torque) = 0;
  /// rest += df
  virtual void add_to_rest(const Part& part, const double* df) = 0;
};

struct Level {
  std::unique_ptr<Equations> (*make)(const Scene& scene);
};

}  // namespace manycontact::extended
