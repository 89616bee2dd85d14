#pragma once
// Memory of contact sets that were met, for when they come back.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

namespace manycontact {

class IslandShape;
struct IslandWork;

/// Islands that are not in use, by their shapes: up to `most` bytes of them, those met last.
class IslandPool {
 public:
  std::size_t most = std::size_t(256) << 20;

  /// nullptr: there is none of this shape.
  std::unique_ptr<IslandWork> take(const IslandShape& shape);
  /// now: a count of switches, by which the pool knows what was met last.
  void give(std::unique_ptr<IslandWork> island, std::uint64_t now);
  void clear();
  /// If there are more than `most`, deletes those unused for longest until half of it is left. Returns whether it did.
  bool trim();

  /// use(island) of all.
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
