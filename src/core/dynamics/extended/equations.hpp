#pragma once
// The equations of a scene in double-double, for the precision `extended`:
//
//     [M  J^T     ] [ a]   [tau - h        ]
//     [J  -delta I] [-f] = [prescribed - a0].
//
// a0 are the constraint rows' accelerations for a = 0, and delta is the damping. K is never formed. K x is computed by
// inverse dynamics of a with forces f, and by relative accelerations of contact frames, at a cost linear in the number
// of bodies. Corrections of x use a factor of K in double (extended.cpp). The class is compiled once per instruction
// level (src/core/simd/levels.cmake), but does not use SIMD batches.

#include <memory>
#include <span>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact::extended {

struct Job {  // a state in the scene's coordinates; pointers must remain valid for all calls at this state
  const Scene& scene;
  const double *q, *v, *tau;         // tau (nv): without friction, springs and external wrenches
  std::span<const Vec6<double>> w;   // external wrenches of the scene
  bool applied;                      // whether any wrench or spring acts
  const double* prescribed;          // prescribed accelerations of the constraint rows, as f; nullptr: zero
  const double* damping;             // delta, one entry per contact of the scene
  const std::vector<int>& f_offset;  // first row of each contact in f; negative: not active
};

/// The islands that a call processes: all their robots and contacts.
struct Part {
  std::span<const int> robots, contacts;  // numbers in the scene
};

class Equations {
 public:
  virtual ~Equations() = default;

  /// Sets x = [a; f], and evaluates the terms of K and b at a state, and r = b - K x.
  virtual void begin(const Job& job, const Part& part, const double* a, const double* f) = 0;
  /// Sets x += [da; df] and, if `residual`, r = b - K x.
  virtual void add(const Part& part, const double* da, const double* df, bool residual) = 0;
  virtual void residual(const Part& part, double* of_dynamics, double* of_contacts) const = 0;  // r, rounded to double
  virtual void round(const Part& part, double* a, double* f) const = 0;                         // x, rounded to double
  /// Returns x - [a; f], rounded to double.
  virtual void difference(const Part& part, const double* a, const double* f, double* da, double* df) const = 0;

  // Projections on the null space of J^T, with row weights S. Forces are split as f = n + S^2 J y with J^T n = 0; the
  // residual of contact rows as r = n + J y with J^T S^2 n = 0. The vector `rest` starts as f or r, and becomes n.
  enum class Projected { kForces, kResidual };
  /// Starts a projection with rest = f of x, or rest = r. weights: S, one entry per row of f.
  virtual void begin_projection(const Part& part, Projected what, const double* weights) = 0;
  /// Subtracts S^2 J dy (forces) or J dy (residual) from rest. change: the term subtracted.
  virtual void project(const Part& part, const double* dy, double* change) = 0;
  /// Sets torque = J^T rest (forces) or J^T S^2 rest (residual), rounded; J^T S^2 J dy = torque gives the step dy.
  virtual void gradient_of_rest(const Part& part, double* torque) = 0;
  virtual void take_rest(const Part& part) = 0;  // ends a projection: subtracts rest from f (forces) or b (residual)

  virtual void set_rest(const Part& part, const double* f) = 0;  // rest = f
  /// Sets torque = J^T rest, rounded. Returns its largest entry, relative to the largest sum of the terms' magnitudes.
  virtual double torque_of_rest(const Part& part, double* torque) = 0;
  virtual void add_to_rest(const Part& part, const double* df) = 0;  // rest += df
};

struct Level {
  std::unique_ptr<Equations> (*make)(const Scene& scene);
};

}  // namespace manycontact::extended
