#include "pool.hpp"

#include <algorithm>

#include "workspace.hpp"

namespace manycontact {

namespace {

// Estimates the bytes of an island, its shape and its kernels from the entries of K, its factors and its derivatives.
std::size_t bytes_of(const IslandWork& d) {
  std::size_t entries = 0;
  if (const auto& p = d.matrix.K.pattern) entries += p->K.nonzeros() + p->ldl.nonzeros();
  if (d.robots) entries += d.robots->interface->S.nonzeros() + d.robots->interface->schedule.nonzeros();
  return costs::kBytesOfEntry * entries + costs::kBytesOfRow * d.island.size() +
         sizeof(double) * d.derivatives.X.size();
}

}  // namespace

std::unique_ptr<IslandWork> IslandPool::take(const IslandShape& shape) {
  const auto known = islands_.find(&shape);
  if (known == islands_.end() || known->second.empty()) return nullptr;
  Entry entry = std::move(known->second.back());
  known->second.pop_back();
  bytes_ -= entry.bytes;
  return std::move(entry.island);
}

void IslandPool::give(std::unique_ptr<IslandWork> island, std::uint64_t now) {
  std::vector<Entry>& entries = islands_[island->shape.get()];
  const std::size_t bytes = bytes_of(*island);
  entries.push_back({std::move(island), bytes, now});
  bytes_ += bytes;
}

void IslandPool::clear() {
  islands_.clear();
  bytes_ = 0;
}

bool IslandPool::trim() {
  if (bytes_ <= most) return false;
  std::vector<std::pair<std::uint64_t, std::size_t>> ages;
  for (const auto& [shape, entries] : islands_)
    for (const Entry& entry : entries) ages.emplace_back(entry.since, entry.bytes);
  std::sort(ages.begin(), ages.end());
  std::uint64_t last = 0;  // time of last use of the newest island to delete
  for (std::size_t k = 0, left = bytes_; left > most / 2; ++k) left -= ages[k].second, last = ages[k].first;
  for (auto& [shape, entries] : islands_)
    std::erase_if(entries, [&, last](const Entry& entry) {
      if (entry.since > last) return false;
      bytes_ -= entry.bytes;
      return true;
    });
  std::erase_if(islands_, [](const auto& item) { return item.second.empty(); });
  return true;
}

}  // namespace manycontact
