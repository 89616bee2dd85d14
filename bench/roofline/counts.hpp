#pragma once
// Floating-point operations are counted by running the library's own sources in quadruple precision: each operation is
// a call of the compiler's library that the linker redirects to a counter (CMakeLists.txt: --wrap).

#include <Eigen/Core>

#include "manycontact/model/scene.hpp"

namespace manycontact::bench {

/// Operations of all robots and contacts of a scene at a state. Sines, cosines and comparisons are not counted.
struct Operations {
  double motion = 0;       // kinematics, bias torques, joint-space inertia, contact rows
  double derivatives = 0;  // terms of derivatives of inverse dynamics and of contact rows
  double product = 0;      // terms of w^T times these
};

/// Counts the operations with all contacts active. a: accelerations (any numbers suffice).
Operations count_operations(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v,
                            const Eigen::VectorXd& a);

}  // namespace manycontact::bench
