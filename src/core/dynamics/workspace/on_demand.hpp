#pragma once
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace manycontact {

/// Memory of each of a scene's robots or contacts that an island needed; SIMD batches have their own.
template <class T>
class OnDemand {
 public:
  explicit OnDemand(std::size_t count) : made_(count) {}
  T& operator[](std::size_t k) { return *made_[k]; }
  const T& operator[](std::size_t k) const { return *made_[k]; }
  bool has(std::size_t k) const { return made_.at(k) != nullptr; }
  template <class... Args>
  void make(std::size_t k, Args&&... args) {
    made_[k] = std::make_unique<T>(std::forward<Args>(args)...);
  }

 private:
  std::vector<std::unique_ptr<T>> made_;
};

}  // namespace manycontact
