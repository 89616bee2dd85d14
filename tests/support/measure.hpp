#pragma once
// Errors of a solution: relative, in the maximum norm, per quantity and robot. The allowed error is max(1e-12, 100 eps
// cond) with cond the 1-norm condition of the island's K.

#include <algorithm>
#include <iosfwd>
#include <vector>

#include "manycontact/dynamics/solve.hpp"
#include "spatial/compare.hpp"

namespace manycontact::test {

inline double allowed(double condition) { return std::max(1e-12, 100 * kEps * condition); }

/// Relative errors of a robot's accelerations and of the contact forces on a robot, the largest over the robots, and
/// the largest relative to the allowed error. They are NaN if a solution contains NaN.
struct Errors {
  double acceleration = 0, forces = 0;
  double excess = 0;
};
std::ostream& operator<<(std::ostream& out, const Errors& e);

/// Returns errors of data.a, data.f relative to a (scene.nv) and f (as data.f), in double or quadruple precision.
/// `condition`: per island. With `a_free` a robot's errors are relative to the larger of its accelerations and a_free,
/// for balanced forces, where accelerations are rounding errors of the input.
template <class S>
Errors errors(const Scene& scene, const SceneData& data, const VecX<S>& a, const VecX<S>& f,
              const std::vector<double>& condition, const Eigen::VectorXd& a_free = {});

/// Returns conditions of the islands from estimate_condition, after a solve.
std::vector<double> conditions(const Scene& scene, SceneData& data);

/// Returns accelerations without any contact, from the dense reference solver.
Eigen::VectorXd free_accelerations(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                                   const Eigen::VectorXd& u);

}  // namespace manycontact::test
