#pragma once
// Memory of earlier contact sets, for reuse.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace manycontact {

class IslandShape;
struct IslandWork;

/// Unused islands by shape: up to `most` bytes, the most recently used.
class IslandPool {
 public:
  std::size_t most = std::size_t(256) << 20;

  /// Returns nullptr if there is none of this shape.
  std::unique_ptr<IslandWork> take(const IslandShape& shape);
  /// now: count of contact switches, as time of last use.
  void give(std::unique_ptr<IslandWork> island, std::uint64_t now);
  void clear();
  /// If there are more than `most` bytes, deletes the least recently used down to half. Returns whether it did.
  bool trim();

  /// Calls use(island) for all.
  template <class Use>
  void each(Use&& use) const {
    for (const auto& [shape, entries] : islands_)
      for (const Entry& entry : entries) use(*entry.island);
  }

 private:
  struct Entry {
    std::unique_ptr<IslandWork> island;
    std::size_t bytes;
    std::uint64_t since;
  };
  std::unordered_map<const IslandShape*, std::vector<Entry>> islands_;
  std::size_t bytes_ = 0;
};

}  // namespace manycontact
