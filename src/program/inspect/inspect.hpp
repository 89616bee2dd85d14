#pragma once
// The command `manycontact inspect` prints the structure of a scene, and possible simplifications.

#include "../files/python.hpp"
#include "../text/describe.hpp"
#include "manycontact/analysis/ranks.hpp"
#include "manycontact/kkt/pattern.hpp"

namespace manycontact::cli {

struct Inspection {
  const SceneFile& file;
  SceneData data;  // solved with method `auto` at the scene's state
  std::vector<IslandKind> kinds;
  double bytes = 0;  // heap memory of `data` after the solve; 0 if unknown

  /// Returns the index of the first island of a kind, whose name, shape and ranks represent all islands of the kind.
  std::size_t first(const IslandKind& kind) const { return static_cast<std::size_t>(kind.islands.front()); }
  const Island& island(const IslandKind& kind) const { return solved_island(data, first(kind)); }
  /// Returns the pattern of the island's K, analysed in the elimination order that the solve chose.
  const KktPattern& pattern(std::size_t island) const;
  std::string name(const IslandKind& kind) const;
};

/// Prints limits and efforts of joints as the robots' files contain them, once per model.
void print_joints(std::ostream& out, const SceneFile& file);
/// Prints constraint, gains, mu and errors of each contact at the scene's state. Copies of a contact share a line.
void print_contacts(std::ostream& out, const SceneFile& file);

/// Writes the patterns of K and L as an SVG file. "-" is standard output. Throws as OutputFile and run_python do.
void write_picture(const Inspection& inspection, const Python& python, const std::string& path);

}  // namespace manycontact::cli
