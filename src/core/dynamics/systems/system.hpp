#pragma once
// The systems that solve an island, i.e. coupled robots and their contacts, at successive states:
//
//     [M  J^T     ] [ a]   [tau - h        ]
//     [J  -delta I] [-f] = [prescribed - a0],
//
// where `prescribed` is zero unless accelerations are prescribed (dynamics/solve_prescribed.hpp). The systems are:
//
//     RobotsSystem   several robots as blocks in SIMD batches, coupled by few rows (systems/robots)
//     BodiesSystem   deep trees, with the accelerations of all bodies as unknowns (systems/bodies)
//     MatrixSystem   the whole matrix K above by any factor, e.g. the dense reference solver (systems/matrix)
//
// SIMD batches first solve single-robot islands (systems/robots/alone.cpp). The first system with a sound solution also
// computes derivatives, products and bounds, unless another is cheaper (differentiate.cpp). If this system fails,
// MatrixSystem computes them (`ask` in internal.hpp). Results are stamped with their state (Workspace::state).

#include <algorithm>

#include "manycontact/dynamics/derivatives.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/rank/row_size.hpp"

namespace manycontact {

struct IslandWork;
struct ProductWork;
struct ThreadWork;

namespace internal {

/// The accuracy of an island's accelerations a or forces f. size: largest |entry|; error: bound of every entry's error;
/// acts: largest acceleration or force that a single load causes (Acting).
struct Known {
  double size = 0, error = 0, acts = 0;
  double relative() const { return error == 0 ? 0 : error / size; }
  /// Returns the error relative to the larger of the solution and the loads.
  double felt() const { return error == 0 ? 0 : error / std::max(size, acts); }
  bool uncertain() const { return !(error < std::max(size, acts)) && error != 0; }
};

/// The largest loads on an island: gravity; torques and bias forces (load), and these divided by inertia (moved); terms
/// of contact rows divided by moment arms (answered). Errors of a and f are judged relative to acceleration() and
/// force() if these exceed the largest entries of a and f.
struct Acting {
  double gravity = 0, load = 0, moved = 0, answered = 0, inertia = 0, lever = 0;
  void add_coordinate(double torque, double its_inertia) {
    load = std::max(load, torque);
    inertia = std::max(inertia, its_inertia);
    if (its_inertia > 0) moved = std::max(moved, torque / its_inertia);
  }
  void add_contact(const Contact &contact, const ContactData<double> &data, const RowTerms<double> &terms) {
    for (int row = 0; row < contact.rows(); row += contact.pair ? 1 : 3) {  // one row of translation, one of rotation
      const double its_lever = row_size(contact, data, row);
      if (!(its_lever > 0)) continue;
      lever = std::max(lever, its_lever);
      answered = std::max(answered, terms.of_row(row) / its_lever);
    }
  }
  double acceleration() const { return std::max({gravity, moved, answered}); }
  double force() const { return lever > 0 ? std::max(load, inertia * answered) / lever : 0; }
};

}  // namespace internal

/// Inputs and outputs of jvp and vjp in the scene's coordinates. dtau, wtau: nv, torques on all velocity coordinates.
struct TangentProduct {
  const ConstVector &dq, &dv, &dtau;
  Eigen::Ref<Eigen::VectorXd> &da, &df;
};
struct AdjointProduct {
  const ConstVector &wa, &wf;
  Eigen::Ref<Eigen::VectorXd> &wq, &wv, &wtau;
};

/// An algorithm that solves an island. Functions without a sound result return false, with undefined outputs.
class IslandSystem {
 public:
  virtual ~IslandSystem() = default;

  /// Solves for data.tau at the current state. Sets data.a, data.f, report; on failure only report.reason, if known.
  virtual bool solve(const Scene &, SceneData &, ThreadWork &, IslandReport &) { return false; }
  /// Computes the requested derivatives of the current solution in IslandDerivatives::X, which lay_out has allocated.
  virtual bool differentiate(const Scene &, SceneData &, ThreadWork &, IslandDerivatives &) { return false; }
  /// Compute products with the derivatives (jvp) or their transposes (vjp) by a solve that is refined once.
  virtual bool jvp(const Scene &, SceneData &, ThreadWork &, const TangentProduct &) { return false; }
  virtual bool vjp(const Scene &, SceneData &, ThreadWork &, const AdjointProduct &) { return false; }
  /// Overwrites [a; y] of Workspace::products with K^+ [a; y], refined at least once. K^+: generalised inverse of K.
  virtual bool invert(const Scene &, SceneData &, ThreadWork &, ProductWork &) { return false; }
  /// Sets error_acceleration and error_forces of the report (estimate_errors).
  virtual bool bound_errors(const Scene &, SceneData &, IslandReport &) { return false; }
  virtual bool estimate_condition(const Scene &, SceneData &, IslandReport &) { return false; }  // report.condition
};

}  // namespace manycontact
