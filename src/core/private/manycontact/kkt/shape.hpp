#pragma once
// Islands with the same trees and contacts share all analyses, which do not depend on the state.

#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <unordered_map>

#include "manycontact/kkt/bodies/subtrees.hpp"
#include "manycontact/kkt/pattern.hpp"
#include "manycontact/model/interned.hpp"
#include "manycontact/sparse/cholmod.hpp"

namespace manycontact {

/// The part of an island on which patterns and orders depend. Analyses are computed at the first call, by any thread.
class IslandShape {
 public:
  IslandShape(const Scene& scene, const Island& island);

  const Scene& scene() const { return scene_; }     // only the island's robots and contacts, numbered as in the island
  const Island& island() const { return island_; }  // the whole of scene()
  /// Returns the joint-space support; like all below but bodies(), it grows with the squared depth of deep trees.
  const IslandSupport& support() const;

  /// Returns a permutation of K's rows. Only that of kContactsEarly depends on contacts' positions on their bodies.
  const std::vector<int>& permutation(Order order);
  /// Returns counts of the factor in that order, without computing its pattern.
  const sparse::LdlCounts& counts(Order order);
  const std::shared_ptr<const KktPattern>& pattern(Order order);
  /// Returns CHOLMOD's analysis of K in that order, without reordering.
  const std::shared_ptr<const sparse::CholmodSymbolic>& cholmod(Order order);
  const std::shared_ptr<const BodyPattern>& bodies();
  /// Returns the subtrees into which constrained bodies cut the trees.
  const BodySubtrees& body_subtrees();

 private:
  Scene scene_;
  Island island_;
  mutable std::recursive_mutex mutex_;  // guards all below; recursive, as analyses use each other
  mutable std::optional<IslandSupport> support_;
  std::array<std::optional<std::vector<int>>, std::size(kOrders)> permutations_;
  std::array<std::optional<sparse::LdlCounts>, std::size(kOrders)> counts_;
  std::shared_ptr<const BodyPattern> bodies_;
  std::unique_ptr<const BodySubtrees> body_parts_;
  std::array<std::shared_ptr<const KktPattern>, std::size(kOrders)> patterns_;
  std::array<std::shared_ptr<const sparse::CholmodSymbolic>, std::size(kOrders)> cholmod_;
};

/// The shapes so far, which are not analysed again. Keys are all inputs of an analysis, compared number by number.
/// Positions of points on bodies affect patterns only through one permutation: islands that differ only in these have
/// one shape if their permutations agree, except in trees too deep for it.
class ShapeCache {
 public:
  /// Returns the island's shape; allocates nothing for trees and contacts that were requested before. by_places:
  /// islands with different positions get separate shapes, which avoids the search for the order contacts-early.
  const std::shared_ptr<IslandShape>& find(const Scene& scene, const Island& island, bool by_places = false);
  std::size_t size() const { return shapes_.size(); }
  /// Deletes all shapes that are not in `used`.
  void keep(const std::set<const IslandShape*>& used);

 private:
  std::unordered_map<SharedWords, std::shared_ptr<IslandShape>, HashOfWords, SameWords> by_places_, shapes_;
  Words key_;
};

}  // namespace manycontact
