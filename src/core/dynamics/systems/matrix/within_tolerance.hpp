#pragma once
// Scenes that are not exact (Scene::tolerance), and rows that depended on each other at the start of a motion.

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
  /// Changes J so that rows of the island's J depend on each other, where they do within the tolerance, or did at the
  /// start and now differ by the contacts' misplacements (within_tolerance.cpp). Call it after evaluate. Returns the
  /// largest inconsistency that such rows may have, relative to the terms that they are computed from.
  double make_dependent(const Scene& scene, Workspace& work, const IslandWork& d);
  /// The changes of J; empty if there are none.
  std::span<const RowChange> changes() const;
  /// After that: the error of entries of J in rows of lengths, at a coordinate of the island.
  double inaccuracy(int coordinate) const;

  struct Work;

 private:
  std::unique_ptr<Work> work_;
};

/// Whether that may be: then the whole K solves, no other system. Rows that depended at the start are considered only
/// where fewer are found to depend.
bool is_inexact(const Scene& scene, const IslandWork& d);

}  // namespace manycontact
