#pragma once
// Changes J so that rows become dependent that are nearly so, within Scene::tolerance or constraint violation.

#include <memory>
#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

struct IslandWork;
struct Workspace;

/// A change of an entry of the island's J.
struct RowChange {
  int row, column;  // contact row and velocity coordinate of the island
  double value;
};

class WithinTolerance {
 public:
  WithinTolerance();
  ~WithinTolerance();
  /// Changes J of the evaluated contacts, so that rows become dependent that are so within Scene::tolerance, or were so
  /// at the start of a motion. Returns the rows' largest possible inconsistency relative to their terms; 0: no change.
  double make_dependent(const Scene& scene, Workspace& work, const IslandWork& d);
  std::span<const RowChange> changes() const;
  /// Returns the error, used by make_dependent, of J's entries in rows in m and at this velocity coordinate.
  double inaccuracy(int coordinate) const;

  struct Work;

 private:
  std::unique_ptr<Work> work_;
};

/// Whether make_dependent may change rows of this island; only MatrixSystem can then solve it.
bool is_inexact(const Scene& scene, const IslandWork& d);

}  // namespace manycontact
