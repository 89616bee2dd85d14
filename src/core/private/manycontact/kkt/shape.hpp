#pragma once
// Analyses of islands (patterns, orders). They do not depend on the state, and islands with equal trees and contacts
// share them.

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

/// The properties of an island that determine patterns and orders, and its analyses. The first call of each function
/// computes an analysis.
class IslandShape {
 public:
  IslandShape(const Scene& scene, const Island& island);

  const Scene& scene() const { return scene_; }     // a scene of only the island's robots and contacts, in its order
  const Island& island() const { return island_; }  // all of scene() as one island
  /// Returns the columns of J. The size of this analysis is quadratic in the depth of trees, as are those of all
  /// members below except bodies() and body_subtrees().
  const IslandSupport& support() const;

  /// Returns the permutation of K's rows. Only that of kContactsEarly depends on the positions of contacts on bodies.
  const std::vector<int>& permutation(Order order);
  /// Returns counts of K's factor in that order, without computing the factor's pattern.
  const sparse::LdlCounts& counts(Order order);
  const std::shared_ptr<const KktPattern>& pattern(Order order);
  /// Returns CHOLMOD's analysis of K in that order; CHOLMOD does not reorder.
  const std::shared_ptr<const sparse::CholmodSymbolic>& cholmod(Order order);
  const std::shared_ptr<const BodyPattern>& bodies();
  /// Returns the subtrees that remain if trees are cut at constrained bodies.
  const BodySubtrees& body_subtrees();

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

/// The shapes that were requested so far. The key of a shape has all inputs of an analysis, compared number by number.
/// Positions of contacts on bodies affect only the order kContactsEarly. Islands that differ only in these positions
/// share a shape if they have the same order kContactsEarly. Trees that are too deep for that order do not.
class ShapeCache {
 public:
  /// Returns the island's shape; allocates nothing for trees and contacts that were requested before. by_places:
  /// whether islands with different positions get separate shapes. The order contacts-early is then not computed for
  /// comparison.
  const std::shared_ptr<IslandShape>& find(const Scene& scene, const Island& island, bool by_places = false);
  std::size_t size() const { return shapes_.size(); }
  /// Deletes all shapes that are not in `used`.
  void keep(const std::set<const IslandShape*>& used);

 private:
  std::unordered_map<SharedWords, std::shared_ptr<IslandShape>, HashOfWords, SameWords> by_places_, shapes_;
  Words key_;
};

}  // namespace manycontact
