#pragma once
#include <array>
#include <memory>

#include "manycontact/algorithm/kinematics.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

/// Moves B' of `contact` onto A at configuration q (the scene's nq), so that the placement error is zero: its origin
/// when `position`, its axes when `orientation`. contact: as for add_contact, before or after it. Throws
/// std::invalid_argument unless q is a configuration: scene.nq finite numbers, quaternions of unit length within 1e-6.
void resolve_reference(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, bool position, bool orientation,
                       Contact& contact);

/// The same for every contact of the scene, origin and axes: at q they all hold. What files leave out is resolved so.
/// SceneData in use see the new places.
void resolve_references(Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q);

/// The same for many contacts of one scene at one q, both of which must outlive it: the places of the two robots met
/// last are kept.
class ReferenceResolver {
 public:
  ReferenceResolver(const Scene& scene, const Eigen::VectorXd& q);  // q: as resolve_reference
  void resolve(bool position, bool orientation, Contact& contact);  // as resolve_reference

 private:
  SE3<double> placement(const Attachment& at, const SE3<double>& offset);

  const Scene& scene_;
  const Eigen::VectorXd& q_;
  struct Places {
    int robot = -1;
    std::unique_ptr<Kinematics<double>> kin;
  };
  std::array<Places, 2> known_;  // the one met last first
};

}  // namespace manycontact
