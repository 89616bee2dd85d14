#include "structure.hpp"

#include <bit>

#include "manycontact/model/interned.hpp"

namespace manycontact {

namespace {

// All that patterns, and the branches of the algorithms, depend on.
std::vector<std::uint64_t> key_of(const Model& model) {
  std::vector<std::uint64_t> key{model.floating_base};
  key.reserve(1 + 8 * model.joints.size());
  for (const Joint& joint : model.joints) {
    key.insert(key.end(), {static_cast<std::uint64_t>(joint.parent), static_cast<std::uint64_t>(joint.type),
                           joint.actuated, joint.placement_rotates, static_cast<std::uint64_t>(joint.axis_kind)});
    for (int k = 0; k < 3 && joint.axis_kind == 3; ++k)
      key.push_back(std::bit_cast<std::uint64_t>(joint.axis[k] + 0.0));  // -0 is 0
  }
  return key;
}

}  // namespace

std::shared_ptr<const ModelStructure> find_structure(const Model& model) {
  static Interned<const ModelStructure> structures;
  return structures.find(key_of(model), [] { return std::make_shared<const ModelStructure>(); }).object;
}

}  // namespace manycontact
