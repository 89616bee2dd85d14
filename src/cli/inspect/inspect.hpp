#pragma once
// `manycontact inspect`: what the scene holds, seen from its structure, and what could be simpler.

#include "../common/choice.hpp"
#include "manycontact/analysis/ranks.hpp"

namespace manycontact::cli {

/// Islands of one pattern, of which the same is to be said.
struct IslandKind {
  std::vector<int> islands;  // numbers in data.islands; names and ranks are those of the first
  IslandRanks ranks;
  IslandCosts costs;
};

struct Inspection {
  const SceneFile& file;
  SceneData data;  // solved by `auto` at the scene's state
  std::vector<IslandKind> kinds;

  const IslandData& island(const IslandKind& kind) const { return data.islands[kind.islands.front()]; }
  std::string name(const IslandKind& kind) const;
};

Inspection inspect_scene(const SceneFile& file);

void print_islands(std::ostream& out, const Inspection& inspection);
void print_contact_groups(std::ostream& out, const Inspection& inspection);
void print_costs(std::ostream& out, const Inspection& inspection);
void print_advice(std::ostream& out, const Inspection& inspection);

/// Pairs of bodies that are alike in their robots' models, contacts and ranks: positions in `pairs`.
std::vector<std::vector<std::size_t>> alike_pairs(const Scene& scene, const std::vector<BodyPair>& pairs);

/// What the scene models more than it needs, one item each: contacts, and bodies that nothing moves.
std::vector<std::string> contact_advice(const Inspection& inspection);
std::vector<std::string> body_advice(const Inspection& inspection);

/// The patterns of K and L as an SVG file. Throws InputError when it cannot be written.
void write_picture(const Inspection& inspection, const std::string& path);

}  // namespace manycontact::cli
