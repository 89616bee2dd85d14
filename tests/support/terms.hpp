#pragma once
// M, J, tau_b, a0 of a whole scene as dense matrices, to hold answers against without any method of the library.

#include <Eigen/Core>
#include <vector>

#include "manycontact/model/scene.hpp"

namespace manycontact::test {

struct Terms {
  Eigen::MatrixXd M, J;
  Eigen::VectorXd tau_b, a0;
  double damping;

  /// With the active contacts of `active`.
  Terms(const Scene& scene, const std::vector<char>& active, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
        const Eigen::VectorXd& u);

  /// max |M a - J^T f - tau_b| / max |tau_b|: small if forces that are not unique are right.
  double dynamics_error(const Eigen::VectorXd& a, const Eigen::VectorXd& f) const;
  /// How far a is from minimising |J a + a0|: max |J^T (J a + a0)|, relative.
  double least_squares_error(const Eigen::VectorXd& a) const;
  /// How far f is from the least norm: the part of it that J^T does not see, relative.
  double least_norm_error(const Eigen::VectorXd& f) const;
  /// [a; -f] by LU of K.
  Eigen::VectorXd solve_by_lu() const;
};

}  // namespace manycontact::test
