#include <algorithm>
#include <map>
#include <stdexcept>

#include "manycontact/analysis/ranks.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

namespace {

using Key = std::vector<long>;

// Returns a key of `ranks` that is equal for islands of the same shape that have the same ranks.
Key key_of(const IslandRanks& ranks) {
  Key key{ranks.known, ranks.rank};
  key.insert(key.end(), ranks.redundant.begin(), ranks.redundant.end());
  for (const BodyPair& p : ranks.pairs)
    key.insert(key.end(),
               {p.rank, static_cast<long>(p.holds), std::ranges::find(p.contacts, p.alone) - p.contacts.begin()});
  for (const Lighter& l : ranks.lighter) key.insert(key.end(), {l.rank, l.only_just});
  return key;
}

}  // namespace

std::vector<IslandKind> find_kinds(const Scene& scene, const SceneData& data) {
  if (data.serial == 0) throw std::logic_error("find_kinds: there is no solution, call solve first");
  std::map<Key, std::size_t> seen;
  std::vector<IslandKind> kinds;
  for (std::size_t i = 0; i < island_count(data); ++i) {
    const IslandReport& r = data.report.islands[i];
    IslandRanks ranks = find_ranks(scene, data, i);
    Key key = key_of(ranks);
    key.insert(key.end(), {reinterpret_cast<long>(shape_of(data, i).get()), long(r.status), long(r.method),
                           long(r.order), long(r.reason), long(r.changed_order)});
    const auto [at, fresh] = seen.emplace(std::move(key), kinds.size());
    if (fresh) kinds.push_back({{}, std::move(ranks)});
    kinds[at->second].islands.push_back(static_cast<int>(i));
  }
  return kinds;
}

std::vector<std::vector<std::size_t>> alike_pairs(const Scene& scene, const std::vector<BodyPair>& pairs) {
  const auto model = [&](const Body& b) { return b.robot < 0 ? nullptr : scene.robots[b.robot].model.get(); };
  std::map<Key, std::size_t> seen;
  std::vector<std::vector<std::size_t>> out;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const BodyPair& p = pairs[i];
    Key key{reinterpret_cast<long>(model(p.A)), p.A.joint, reinterpret_cast<long>(model(p.B)), p.B.joint, p.rank,
            static_cast<long>(p.holds)};
    for (int c : p.contacts) key.push_back(static_cast<long>(scene.contacts[c].type));
    const auto [at, fresh] = seen.emplace(std::move(key), out.size());
    if (fresh) out.emplace_back();
    out[at->second].push_back(i);
  }
  return out;
}

}  // namespace manycontact
