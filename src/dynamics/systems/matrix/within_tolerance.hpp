#pragma once
// Scenes that are not exact (Scene::tolerance), and rows that depended on each other at the start of a motion.

#include <memory>

#include "manycontact/model/scene.hpp"

namespace manycontact {

struct IslandWork;
struct Workspace;

class WithinTolerance {
 public:
  WithinTolerance();
  ~WithinTolerance();
  /// Where rows of the island's J depend on each other but for the tolerance, or rows that depended at the start but
  /// for the contacts' misplacements, changes J so that they do (within_tolerance.cpp). After evaluate. Returns what
  /// such rows may contradict each other by, beside the terms that they are computed from.
  double make_dependent(const Scene& scene, Workspace& work, const IslandWork& d);
  /// After that: what entries of J in rows of lengths may be off by, at a coordinate of the island.
  double inaccuracy(int coordinate) const;

  struct Work;

 private:
  std::unique_ptr<Work> work_;
};

/// Whether that may be: then the whole K answers, no other system. Rows that depended at the start are looked at only
/// where fewer are found to depend.
bool is_inexact(const Scene& scene, const IslandWork& d);

}  // namespace manycontact
