#pragma once
// M, J, tau_b, a0 of a whole scene as dense matrices, to check solutions without any method of the library.

#include <Eigen/Core>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact::test {

struct Terms {
  Eigen::MatrixXd M, J;
  Eigen::VectorXd tau_b, a0;
  double damping;

  /// active: one flag per contact of the scene.
  Terms(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
        const Eigen::VectorXd& u);

  /// Returns max |M a - J^T f - tau_b| / max |tau_b|, which tests forces that are not unique.
  double dynamics_error(const Eigen::VectorXd& a, const Eigen::VectorXd& f) const;
  /// Returns how far a is from minimising |J a + a0|: max |J^T (J a + a0)|, relative.
  double least_squares_error(const Eigen::VectorXd& a) const;
  /// Returns how far f is from the least norm: its relative part in the null space of J^T.
  double least_norm_error(const Eigen::VectorXd& f) const;
  /// Returns [a; -f] from LU of K.
  Eigen::VectorXd solve_by_lu() const;
};

}  // namespace manycontact::test
