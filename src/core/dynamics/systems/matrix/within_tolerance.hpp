#pragma once
// Makes rows of J dependent within Scene::tolerance, or that were dependent at the start of a motion.

#include <memory>
#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

struct IslandWork;
struct Workspace;

/// A change of an entry of the island's J.
struct RowChange {
  int row, column;  // numbers in the island
  double value;
};

class WithinTolerance {
 public:
  WithinTolerance();
  ~WithinTolerance();
  /// Makes rows dependent that are so within the tolerance, or were so at the start but for constraint violation. Call
  /// it after evaluate. Returns the rows' largest possible inconsistency relative to their terms.
  double make_dependent(const Scene& scene, Workspace& work, const IslandWork& d);
  std::span<const RowChange> changes() const;
  /// Returns the error of J's entries in rows of lengths at a coordinate of the island, after make_dependent.
  double inaccuracy(int coordinate) const;

  struct Work;

 private:
  std::unique_ptr<Work> work_;
};

/// Whether rows may be made dependent, so that only the whole K solves. Earlier dependence counts if more rows had it.
bool is_inexact(const Scene& scene, const IslandWork& d);

}  // namespace manycontact
