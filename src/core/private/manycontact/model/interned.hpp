#pragma once
// Objects that are shared by all users with equal keys, as long as any user exists.

#include <algorithm>
#include <cstdint>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

namespace manycontact {

/// The key of an object: numbers, bits of doubles, addresses. Several tables may share a key as SharedWords.
using Words = std::vector<std::uint64_t>;
using SharedWords = std::shared_ptr<const Words>;

struct HashOfWords {
  using is_transparent = void;
  std::size_t operator()(const SharedWords& key) const { return (*this)(*key); }
  std::size_t operator()(const Words& key) const {
    std::uint64_t h = key.size();
    for (std::uint64_t x : key) {  // one round of splitmix64 per word
      h += x + 0x9e3779b97f4a7c15;
      h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9;
      h = (h ^ (h >> 27)) * 0x94d049bb133111eb;
      h ^= h >> 31;
    }
    return h;
  }
};

struct SameWords {
  using is_transparent = void;
  static const Words& words(const SharedWords& x) { return *x; }
  static const Words& words(const Words& x) { return x; }
  bool operator()(const auto& x, const auto& y) const { return words(x) == words(y); }
};

template <class T>
class Interned {
 public:
  struct Found {
    std::shared_ptr<T> object;
    SharedWords key;
  };
  template <class Make>
  Found find(const Words& key, Make&& make) {  // thread-safe; calls make() only if no object has the key
    const std::lock_guard lock(mutex_);
    if (known_.size() >= sweep_at_) {
      std::erase_if(known_, [](const auto& item) { return item.second.expired(); });
      sweep_at_ = std::max(kFewest, 2 * known_.size());
    }
    auto known = known_.find(key);
    if (known == known_.end()) known = known_.try_emplace(std::make_shared<const Words>(key)).first;
    std::shared_ptr<T> found = known->second.lock();
    if (!found) known->second = found = make();
    return {std::move(found), known->first};
  }

 private:
  static constexpr std::size_t kFewest = 64;
  std::mutex mutex_;
  std::unordered_map<SharedWords, std::weak_ptr<T>, HashOfWords, SameWords> known_;
  std::size_t sweep_at_ = kFewest;
};

}  // namespace manycontact
