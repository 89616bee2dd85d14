#pragma once
// Configurations of a whole scene: where to start, and the manifold they live on (algorithm/integrate.hpp per robot).
// Everywhere q: scene.nq, v: scene.nv; std::invalid_argument on another size.

#include <random>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Joints at zero, floating bases where Robot::base has them.
Eigen::VectorXd neutral(const Scene& scene);

/// Uniform within the joints' limits. Where there are none: angles within +-pi, displacements within +-1 m; with one
/// limit alone, within that range from it. Floating bases within +-1 m of Robot::base; any orientation.
Eigen::VectorXd random_configuration(const Scene& scene, std::mt19937& generator);

/// q (+) v: reached from q by the velocity v held for unit time. `out` may be q.
void integrate(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
               const Eigen::Ref<const Eigen::VectorXd>& v, Eigen::Ref<Eigen::VectorXd> out);
Eigen::VectorXd integrate(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                          const Eigen::Ref<const Eigen::VectorXd>& v);

/// q1 (-) q0: the v with integrate(scene, q0, v) = q1.
void difference(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q0,
                const Eigen::Ref<const Eigen::VectorXd>& q1, Eigen::Ref<Eigen::VectorXd> out);
Eigen::VectorXd difference(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q0,
                           const Eigen::Ref<const Eigen::VectorXd>& q1);

}  // namespace manycontact
