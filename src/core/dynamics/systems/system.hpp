#pragma once
// The ways to solve an island, at one state after the other:
//
//     [M  J^T     ] [ a]   [tau - h        ]
//     [J  -delta I] [-f] = [prescribed - a0].
//
//     RobotsSystem   several robots as blocks in SIMD batches, coupled by few rows (systems/robots)
//     BodiesSystem   deep trees: the accelerations of bodies stay unknowns (systems/bodies)
//     MatrixSystem   the whole K by any factor, down to the dense reference solver (systems/matrix)
//
// Before these, robots alone are solved in SIMD batches, many islands by one call (systems/robots/alone.cpp).
// `solve` takes the first system whose solution is sound. That system also gives derivatives, products and bounds of
// its solution, unless another is cheaper (differentiate.cpp). The whole K does the rest, and is made then (`ask` in
// internal.hpp). A system stamps its numbers with the state they belong to (Workspace::state), and computes them again
// at another state.

#include <algorithm>

#include "manycontact/dynamics/derivatives.hpp"
#include "manycontact/dynamics/solve.hpp"
#include "manycontact/rank/row_size.hpp"

namespace manycontact {

struct IslandWork;
struct ProductWork;
struct ThreadWork;

namespace internal {

/// Accuracy of an island's solution: the largest entry, a bound of its error, and the size that it is judged against
/// where it vanishes; all of one unit.
struct Known {
  double size = 0, error = 0, acts = 0;
  double relative() const { return error == 0 ? 0 : error / size; }
  /// The error relative to the larger of the solution and the loads.
  double felt() const { return error == 0 ? 0 : error / std::max(size, acts); }
  bool uncertain() const { return !(error < std::max(size, acts)) && error != 0; }
};

/// Loads on an island, relative to which accelerations and forces that vanish are small: gravity; torques and bias
/// forces relative to the inertia that they move; terms of contacts' rows relative to their moment arms; and the forces
/// of these at the longest moment arm.
struct Acting {
  double gravity = 0, load = 0, moved = 0, answered = 0, inertia = 0, lever = 0;
  void add_coordinate(double torque, double its_inertia) {
    load = std::max(load, torque);
    inertia = std::max(inertia, its_inertia);
    if (its_inertia > 0) moved = std::max(moved, torque / its_inertia);
  }
  void add_contact(const Contact &contact, const ContactData<double> &data, const RowTerms<double> &terms) {
    for (int row = 0; row < contact.rows(); row += contact.pair ? 1 : 3) {  // one of a motion, one of rotation
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

/// Inputs and outputs of jvp and vjp, in the scene's coordinates. dtau, wtau: of torques on all velocity coordinates.
struct TangentProduct {
  const ConstVector &dq, &dv, &dtau;
  Eigen::Ref<Eigen::VectorXd> &da, &df;
};
struct AdjointProduct {
  const ConstVector &wa, &wf;
  Eigen::Ref<Eigen::VectorXd> &wq, &wv, &wtau;
};

/// Every function returns false where the system has no sound result: then its output is undefined.
class IslandSystem {
 public:
  virtual ~IslandSystem() = default;

  /// Factorizes at the current q and v and solves for data.tau, refined and judged: the solution is in data.a and
  /// data.f, and the report is complete. False: report.reason has the reason, where one is known.
  virtual bool solve(const Scene &, SceneData &, ThreadWork &, IslandReport &) { return false; }
  /// All derivatives of the current solution, into what is laid out.
  virtual bool differentiate(const Scene &, SceneData &, ThreadWork &, IslandDerivatives &) { return false; }
  /// Products with them, by a solve that is refined once.
  virtual bool jvp(const Scene &, SceneData &, ThreadWork &, const TangentProduct &) { return false; }
  virtual bool vjp(const Scene &, SceneData &, ThreadWork &, const AdjointProduct &) { return false; }
  /// [a; y] <- K^+ [a; y] of the scratch of products (Workspace::products), refined at least once.
  virtual bool invert(const Scene &, SceneData &, ThreadWork &, ProductWork &) { return false; }
  /// error_acceleration and error_forces of the report, as estimate_errors has them.
  virtual bool bound_errors(const Scene &, SceneData &, IslandReport &) { return false; }
  /// The report's condition.
  virtual bool estimate_condition(const Scene &, SceneData &, IslandReport &) { return false; }
};

}  // namespace manycontact
