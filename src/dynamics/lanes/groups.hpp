#pragma once
// The islands of a scene that stand in lanes, private to floor dynamics.

#include <map>

#include "lanes.hpp"

namespace manycontact {

struct Workspace;

namespace lanes {

/// Islands of one shape and model. A group stays when its islands are gone, for contact sets to come.
struct Group {
  std::shared_ptr<const Model> model;            // kept: another must not pass for one at its address
  std::vector<std::unique_ptr<Kernel>> kernels;  // one per thread
  std::vector<int> islands;                      // their numbers, ascending
};

struct Groups {
  const Level* level = nullptr;
  std::map<std::pair<const IslandShape*, const Model*>, Group> groups;
  // scratch of a call: the islands it is about, those that stand side by side one after the other
  struct SideBySide {
    const Group* group;
    int first, count;  // of islands and numbers
  };
  std::vector<int> numbers;
  std::vector<const Island*> islands;
  std::vector<SideBySide> batches;
};

/// Sorts the islands at hand into groups. Allocates nothing for a contact set met before.
void regroup(const Scene& scene, Workspace& work);

}  // namespace lanes
}  // namespace manycontact
