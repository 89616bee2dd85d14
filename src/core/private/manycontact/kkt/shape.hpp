#pragma once
// Analyses of islands (patterns, orders), independent of the state; equal trees and contacts share them.

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

/// What determines an island's patterns and orders, and its analyses, computed by each function's first call.
class IslandShape {
 public:
  IslandShape(const Scene& scene, const Island& island);

  const Scene& scene() const { return scene_; }     // a scene of only the island's robots and contacts, in its order
  const Island& island() const { return island_; }  // all of scene() as one island
  /// Returns J's columns. This and all below, except bodies() and body_subtrees(), are quadratic in the trees' depth.
  const IslandSupport& support() const;

  /// Returns the permutation of K's rows. Only that of kContactsEarly depends on the positions of contacts on bodies.
  const std::vector<int>& permutation(Order order);
  const sparse::LdlCounts& counts(Order order);  // sizes of K's factor, without its pattern
  const std::shared_ptr<const KktPattern>& pattern(Order order);
  const std::shared_ptr<const sparse::CholmodSymbolic>& cholmod(Order order);  // analysis of K in this order
  const std::shared_ptr<const BodyPattern>& bodies();
  const BodySubtrees& body_subtrees();  // subtrees of trees cut at constrained bodies

 private:
  Scene scene_;
  Island island_;
  mutable std::recursive_mutex mutex_;  // guards all members below; recursive, as analyses use each other
  mutable std::optional<IslandSupport> support_;
  std::array<std::optional<std::vector<int>>, std::size(kOrders)> permutations_;
  std::array<std::optional<sparse::LdlCounts>, std::size(kOrders)> counts_;
  std::shared_ptr<const BodyPattern> bodies_;
  std::unique_ptr<const BodySubtrees> body_parts_;
  std::array<std::shared_ptr<const KktPattern>, std::size(kOrders)> patterns_;
  std::array<std::shared_ptr<const sparse::CholmodSymbolic>, std::size(kOrders)> cholmod_;
};

/// The shapes requested so far, by all inputs of an analysis. Islands that differ only in the positions of contacts on
/// bodies share a shape if they have the same order kContactsEarly, and trees are not too deep for it.
class ShapeCache {
 public:
  /// Returns the island's shape; allocates nothing for trees and contacts known before. by_places: different positions
  /// get separate shapes, and the order contacts-early is not computed for comparison.
  const std::shared_ptr<IslandShape>& find(const Scene& scene, const Island& island, bool by_places = false);
  std::size_t size() const { return shapes_.size(); }
  void keep(const std::set<const IslandShape*>& used);  // deletes all other shapes

 private:
  std::unordered_map<SharedWords, std::shared_ptr<IslandShape>, HashOfWords, SameWords> by_places_, shapes_;
  Words key_;
};

}  // namespace manycontact
