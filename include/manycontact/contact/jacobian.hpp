#pragma once
// The contacts of a scene as one matrix and one vector, and their forces on the bodies, for code that has equations of
// its own (a whole-body controller):
//
//     J a + a0 = 0        M a + h = S^T u + J^T f

#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

/// J of the contacts flagged `active` (empty: as the scene has them), dense: their rows in the scene's order, nv
/// columns. At q (nq). Rows are in each contact's reference frame (contact/rows.hpp). Throws std::invalid_argument
/// unless sizes fit, as all here.
Eigen::MatrixXd contact_jacobian(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                 const std::vector<char>& active = {});

/// a0 at q, v, by row [m/s^2, rad/s^2]: dJ/dt v, and what gains ask for: alpha times the error and beta J v.
Eigen::VectorXd contact_drift(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                              const Eigen::Ref<const Eigen::VectorXd>& v, const std::vector<char>& active = {});

/// Everything that acts on bodies from outside their joints, at q (nq) and v (nv): the forces f of contacts (rows as
/// Solution::f, with its f_offset: -1 where a contact is not active), the wrenches of the scene's pushes (empty: as the
/// scene has them; else one per push, as SceneData::pushes), and its springs and dampers between points. A wrench per
/// body, robot by robot, in the child frames: rnea's fext (algorithm/rigid_body.hpp). With them rnea(q, v, a) gives the
/// motors' torques alone, and joint_wrench what joints carry. NaN where the ends of a spring coincide.
std::vector<Vec6<double>> forces_on_bodies(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                           const Eigen::Ref<const Eigen::VectorXd>& v,
                                           const Eigen::Ref<const Eigen::VectorXd>& f, const std::vector<int>& f_offset,
                                           std::span<const Vec6<double>> pushes = {});
/// The same of contacts alone.
std::vector<Vec6<double>> contact_forces_on_bodies(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q,
                                                   const Eigen::Ref<const Eigen::VectorXd>& f,
                                                   const std::vector<int>& f_offset);

}  // namespace manycontact
