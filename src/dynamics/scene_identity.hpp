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
  std::vector<Contact> contacts_;                     // type, bodies, A's placement and axis count
};

}  // namespace manycontact
