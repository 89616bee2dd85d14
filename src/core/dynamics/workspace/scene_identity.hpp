#pragma once
// A SceneIdentity stores the properties of a scene that must not change while data are in use (data.hpp).

#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/model/scene.hpp"

namespace manycontact {

class SceneIdentity {
 public:
  explicit SceneIdentity(const Scene& scene);
  std::string difference(const Scene& scene) const;  // how the scenes differ; empty if they do not
  /// Compares only the numbers of robots and contacts, and those in `island`. The time depends on its size only.
  std::string difference(const Scene& scene, const Island& island) const;

 private:
  std::string difference_of_counts(const Scene& scene) const;
  std::string difference_of_robot(const Scene& scene, std::size_t r) const;
  std::string difference_of_contact(const Scene& scene, std::size_t c) const;
  std::string difference_of_forces(const Scene& scene) const;
  std::vector<std::shared_ptr<const Model>> models_;  // owned, so that no other model gets the same address
  struct OfContact {
    ContactType type;
    int robot_A, joint_A, robot_B, joint_B;
    SE3<double> place;  // the contact frame's placement on body A
    Vec3<double> axis;
  };
  static const char* changed(const OfContact& was, const Contact& is);
  std::vector<OfContact> contacts_;
  struct Body {
    int robot, joint;
    bool is(const Attachment& at) const { return at.robot == robot && at.joint == joint; }
  };
  std::vector<Body> wrenches_, springs_, joint_springs_;  // springs_: bodies A and B of each spring
};

}  // namespace manycontact
