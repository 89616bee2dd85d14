#pragma once
// The equations of a scene in double-double, for the precision `extended`:
//
//     [M  J^T     ] [ a]   [tau - h        ]
//     [J  -delta I] [-f] = [prescribed - a0].
//
// K is never formed: K x is inverse dynamics of a with the forces f, and the relative accelerations of the contacts'
// frames, linear in the bodies. A double factor of K corrects x (extended.cpp). It is compiled once per level of
// instructions (src/core/simd/levels.cmake), but always with scalars.

#include <memory>
#include <span>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact::extended {

/// A state in the scene's coordinates. Referenced data must remain valid for all calls at this state.
struct Job {
  const Scene& scene;
  const double *q, *v, *tau;         // tau (nv): without friction, springs and external wrenches
  std::span<const Vec6<double>> w;   // external wrenches, one per wrench of the scene
  bool applied;                      // whether any wrench or spring acts
  const double* prescribed;          // prescribed accelerations of the constraint rows, as f; nullptr: zero
  const double* damping;             // delta, per contact of the scene
  const std::vector<int>& f_offset;  // one entry per contact; negative: not active
};

/// The islands that a call processes, each as a whole.
struct Part {
  std::span<const int> robots, contacts;  // numbers in the scene
};

class Equations {
 public:
  virtual ~Equations() = default;

  /// Evaluates the terms, and r = b - K x, at a state. x = [a; f] has nv + (rows of f) entries.
  virtual void begin(const Job& job, const Part& part, const double* a, const double* f) = 0;
  /// Sets x += [da; df] and, if `residual`, r = b - K x.
  virtual void add(const Part& part, const double* da, const double* df, bool residual) = 0;
  /// Returns r, rounded to double.
  virtual void residual(const Part& part, double* of_dynamics, double* of_contacts) const = 0;
  /// Returns x, rounded to double.
  virtual void round(const Part& part, double* a, double* f) const = 0;
  /// Returns x - [a; f], rounded to double.
  virtual void difference(const Part& part, const double* a, const double* f, double* da, double* df) const = 0;

  // Null-space part n of forces, f = n + S^2 J y with J^T n = 0, or of the residual, r = n + J y with J^T S^2 n = 0.
  enum class Projected { kForces, kResidual };
  /// Starts a projection with rest = f of x, or rest = r. weights: S, one per row of f.
  virtual void begin_projection(const Part& part, Projected what, const double* weights) = 0;
  /// Subtracts S^2 J dy (forces) or J dy (residual) from rest. change: the term subtracted.
  virtual void project(const Part& part, const double* dy, double* change) = 0;
  /// Sets torque = J^T rest (forces) or J^T S^2 rest (residual), rounded: J^T S^2 J dy of the remaining step dy.
  virtual void gradient_of_rest(const Part& part, double* torque) = 0;
  /// Subtracts the rest from x's f, or from b.
  virtual void take_rest(const Part& part) = 0;

  /// Sets rest = f.
  virtual void set_rest(const Part& part, const double* f) = 0;
  /// Sets torque = J^T rest, rounded. Returns its largest entry relative to the largest sum of an entry's terms.
  virtual double torque_of_rest(const Part& part, double* torque) = 0;
  /// Sets rest += df.
  virtual void add_to_rest(const Part& part, const double* df) = 0;
};

struct Level {
  std::unique_ptr<Equations> (*make)(const Scene& scene);
};

}  // namespace manycontact::extended
