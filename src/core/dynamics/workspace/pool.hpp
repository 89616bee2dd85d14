#pragma once
// Keeps the memory of islands of earlier contact sets, for reuse.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace manycontact {

class IslandShape;
struct IslandWork;

/// Unused islands, found by their shapes. If they exceed `most` bytes, `trim` deletes the least recently used.
class IslandPool {
 public:
  std::size_t most = std::size_t(256) << 20;

  std::unique_ptr<IslandWork> take(const IslandShape& shape);        // removes, returns one of this shape, or nullptr
  void give(std::unique_ptr<IslandWork> island, std::uint64_t now);  // now: Workspace::layout, as time of last use
  void clear();
  /// Above `most` bytes, deletes the least recently used down to half of `most`. Returns whether any were deleted.
  bool trim();

  template <class Use>
  void each(Use&& use) const {  // calls use(island) for all islands
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
