#pragma once
#include <array>
#include <memory>

#include "manycontact/detail/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Sets the reference placement of a contact: moves B' to A's placement at q (scene.nq), so that the error is zero. The
/// origin of B' moves if `position`, its axes rotate if `orientation`. The contact need not be part of the scene yet.
/// Throws std::invalid_argument unless q has scene.nq finite numbers, and quaternions of unit length within 1e-6.
void resolve_reference(const Scene& scene, const ConstVectorRef& q, bool position, bool orientation, Contact& contact);

/// Sets the reference placement of every contact of the scene, origin and axes, so that all errors are zero at q
/// (scene.nq). Existing SceneData use the new placements. Throws as resolve_reference does.
void resolve_references(Scene& scene, const ConstVectorRef& q);

/// Sets the reference placements of many contacts of one scene at one q. The object refers to the scene and q, which
/// must outlive it. The kinematics of the last two robots are cached.
class ReferenceResolver {
 public:
  ReferenceResolver(const Scene& scene, const Eigen::VectorXd& q);  // q: scene.nq entries
  void resolve(bool position, bool orientation, Contact& contact);  // does what the function resolve_reference does

 private:
  SE3<double> placement(const Attachment& at, const SE3<double>& offset);

  const Scene& scene_;
  const Eigen::VectorXd& q_;
  struct Places {
    int robot = -1;
    std::unique_ptr<Kinematics<double>> kin;
  };
  std::array<Places, 2> known_;  // kinematics of two robots, the most recent one first
};

}  // namespace manycontact
