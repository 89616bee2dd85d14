#pragma once
// Objects that are the same for all who ask by equal keys, as long as any of them is alive.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace manycontact {

/// Of words: numbers, bits of doubles, addresses.
struct HashOfWords {
  std::size_t operator()(const std::vector<std::uint64_t>& key) const {
    std::uint64_t h = key.size();
    for (std::uint64_t x : key) {  // a round of splitmix64 for each word
      h += x + 0x9e3779b97f4a7c15;
      h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9;
      h = (h ^ (h >> 27)) * 0x94d049bb133111eb;
      h ^= h >> 31;
    }
    return h;
  }
};

template <class T>
class Interned {
 public:
  /// The one of that key; make() where none is alive.
  template <class Make>
  std::shared_ptr<T> find(const std::vector<std::uint64_t>& key, Make&& make) {
    const std::lock_guard lock(mutex_);
    if (known_.size() >= sweep_at_) {
      std::erase_if(known_, [](const auto& item) { return item.second.expired(); });
      sweep_at_ = std::max(kFewest, 2 * known_.size());
    }
    std::weak_ptr<T>& known = known_[key];
    std::shared_ptr<T> found = known.lock();
    if (!found) known = found = make();
    return found;
  }

 private:
  static constexpr std::size_t kFewest = 64;
  std::mutex mutex_;
  std::unordered_map<std::vector<std::uint64_t>, std::weak_ptr<T>, HashOfWords> known_;
  std::size_t sweep_at_ = kFewest;
};

}  // namespace manycontact
