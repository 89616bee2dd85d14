#pragma once
// Changes J so that rows that are dependent up to Scene::tolerance or constraint violation become exactly dependent.

#include <memory>
#include <span>

#include "manycontact/model/scene.hpp"

namespace manycontact {

struct IslandWork;
struct Workspace;

struct RowChange {  // a change of an entry of the island's J
  int row, column;  // contact row and velocity coordinate of the island
  double value;
};

class WithinTolerance {
 public:
  WithinTolerance();
  ~WithinTolerance();
  /// Changes J of the evaluated contacts so that rows become dependent that are so within Scene::tolerance, or were at
  /// the start of a motion. Returns the largest inconsistency of these rows that the change may cause,
  /// relative to the rows' terms; 0 if J is unchanged.
  double make_dependent(const Scene& scene, Workspace& work, const IslandWork& d);
  std::span<const RowChange> changes() const;
  double inaccuracy(int coordinate) const;  // the error assumed for J's entries at this coordinate, in rows in m

  struct Work;

 private:
  std::unique_ptr<Work> work_;
};

/// Whether make_dependent may change rows of this island; only MatrixSystem can then solve it.
bool is_inexact(const Scene& scene, const IslandWork& d);

}  // namespace manycontact
