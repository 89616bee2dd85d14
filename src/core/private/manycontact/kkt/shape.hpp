#pragma once
// Islands of the same trees and contacts share everything that is analysed, and nothing that is measured.

#include <array>
#include <cstdint>
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

/// The part of an island on which patterns and orders depend. Analyses are computed on first request, by any thread,
/// and kept.
class IslandShape {
 public:
  IslandShape(const Scene& scene, const Island& island);

  const Scene& scene() const { return scene_; }     // the island's robots and contacts alone, numbered as in the island
  const Island& island() const { return island_; }  // the whole of scene()
  /// Support of the joint-space K, like all below but bodies(). In deep trees these grow with the square of the depth.
  const IslandSupport& support() const;

  /// A permutation of K's rows. That of kContactsEarly alone depends on where contacts are on their bodies.
  const std::vector<int>& permutation(Order order);
  /// Counts of the factor in that order, whose pattern need not be made for them.
  const sparse::LdlCounts& counts(Order order);
  const std::shared_ptr<const KktPattern>& pattern(Order order);
  /// CHOLMOD's analysis of K in that order, rows left as they are.
  const std::shared_ptr<const sparse::CholmodSymbolic>& cholmod(Order order);
  /// The bodies and rows of the body-space system.
  const std::shared_ptr<const BodyPattern>& bodies();
  /// And where these fall apart.
  const BodySubtrees& body_subtrees();

 private:
  Scene scene_;
  Island island_;
  mutable std::recursive_mutex mutex_;  // guards all below: one analysis asks for another
  mutable std::optional<IslandSupport> support_;
  std::array<std::optional<std::vector<int>>, std::size(kOrders)> permutations_;
  std::array<std::optional<sparse::LdlCounts>, std::size(kOrders)> counts_;
  std::shared_ptr<const BodyPattern> bodies_;
  std::unique_ptr<const BodySubtrees> body_parts_;
  std::array<std::shared_ptr<const KktPattern>, std::size(kOrders)> patterns_;
  std::array<std::shared_ptr<const sparse::CholmodSymbolic>, std::size(kOrders)> cholmod_;
};

/// The shapes met so far. A shape that was met is not analysed again: keys are all that an analysis reads, compared
/// number by number. Two levels, since places of points on bodies reach the patterns through one permutation only:
/// islands that differ in such places alone have one shape if their permutations agree. (Of trees so deep that the
/// permutation is not made, these have shapes of their own.)
class ShapeCache {
 public:
  /// Allocates nothing when an island with the same trees and contacts was asked for before. by_places: islands that
  /// differ in places have shapes of their own, which spares the search for the order contacts-early.
  const std::shared_ptr<IslandShape>& find(const Scene& scene, const Island& island, bool by_places = false);
  std::size_t size() const { return shapes_.size(); }
  /// Forgets all others.
  void keep(const std::set<const IslandShape*>& used);

 private:
  std::unordered_map<SharedWords, std::shared_ptr<IslandShape>, HashOfWords, SameWords> by_places_, shapes_;
  Words key_;
};

}  // namespace manycontact
