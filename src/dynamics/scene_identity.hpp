#pragma once
// By which data know their scene, and notice what was changed under them.

#include "manycontact/model/scene.hpp"

namespace manycontact {

class SceneIdentity {
 public:
  explicit SceneIdentity(const Scene& scene);
  /// What differs, for people; empty where nothing does.
  std::string difference(const Scene& scene) const;

 private:
  std::vector<std::shared_ptr<const Model>> models_;  // kept: another model must not pass for one at its address
  struct OfContact {
    ContactType type;
    int robot_A, joint_A, robot_B, joint_B;
    SE3<double> place;  // on A
    Vec3<double> axis;
  };
  static const char* changed(const OfContact& was, const Contact& is);
  std::vector<OfContact> contacts_;
};

}  // namespace manycontact
