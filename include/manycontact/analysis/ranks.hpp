#pragma once
// Which contact rows of an island hold something the others do not, at the configuration solved last.

#include "describe.hpp"

namespace manycontact::cli {

/// What would hold the same as all contacts between two bodies.
enum class Holds {
  kEach,        // every row counts
  kOneContact,  // one of them alone
  kSixD,        // one 6D contact anywhere on the body
  kThreeD,      // one 3D contact at their common point
  kLine,        // points on a line: five motions, which no single type holds
  kFewerRows,   // some of the rows; see IslandRanks::redundant
};

/// All active contacts between the same two bodies.
struct BodyPair {
  Body A, B;                      // A can move
  Vec3<double> point_A, point_B;  // means of the contacts' origins, on the bodies' joints
  std::vector<int> contacts;      // scene numbers
  int rows = 0, rank = 0;
  Holds holds = Holds::kEach;
  int alone = -1;  // kOneContact: which
};

/// A contact whose own rows depend on each other, since its robots cannot move in all its directions.
struct Lighter {
  int contact = -1, rank = 0;
  std::string type;  // the lightest type of the same rank at the same frame, empty if there is none
};

struct IslandRanks {
  bool known = false;           // false: left out, the island is too large
  int rank = 0;                 // of the island's J
  std::vector<char> redundant;  // per row of the island: it depends on the rows before it
  std::vector<BodyPair> pairs;
  std::vector<Lighter> lighter;

  /// Equal for islands that have the same to say.
  std::vector<long> key() const;
};

/// After a solve or evaluation of the island.
IslandRanks find_ranks(const Scene& scene, const SceneData& data, const IslandData& island);

}  // namespace manycontact::cli
