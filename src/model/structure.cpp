#include "structure.hpp"

#include <algorithm>
#include <mutex>
#include <unordered_map>

namespace manycontact {

namespace {

// All that patterns, and the branches of the algorithms, depend on.
std::vector<double> key_of(const Model& model) {
  std::vector<double> key{double(model.floating_base)};
  key.reserve(key.size() + 9 * model.joints.size());
  for (const Joint& joint : model.joints) {
    key.insert(key.end(), {double(joint.parent), double(joint.type), double(joint.actuated),
                           double(joint.placement_rotates), double(joint.axis_kind)});
    if (joint.axis_kind == 3) key.insert(key.end(), joint.axis.begin(), joint.axis.end());
  }
  return key;
}

std::size_t hash(const std::vector<double>& key) {
  std::size_t h = key.size();
  for (double x : key) h = 31 * h + std::hash<double>()(x);
  return h;
}

}  // namespace

std::shared_ptr<const ModelStructure> find_structure(const Model& model) {
  constexpr std::size_t kFewest = 64;
  static std::mutex mutex;
  static std::unordered_multimap<std::size_t, std::weak_ptr<const ModelStructure>> known;
  static std::size_t sweep_at = kFewest;

  std::vector<double> key = key_of(model);
  const std::size_t h = hash(key);
  const std::lock_guard lock(mutex);
  if (known.size() >= sweep_at) {
    std::erase_if(known, [](const auto& item) { return item.second.expired(); });
    sweep_at = std::max(kFewest, 2 * known.size());
  }
  for (auto [at, end] = known.equal_range(h); at != end; ++at)
    if (auto structure = at->second.lock(); structure && structure->key == key) return structure;
  auto fresh = std::make_shared<const ModelStructure>(ModelStructure{std::move(key)});
  known.emplace(h, fresh);
  return fresh;
}

}  // namespace manycontact
