#pragma once
// The contact rows of an island that constrain a motion that other rows do not, at the configuration solved last. Their
// number is that of the solve. Without damping it is the rank of J, to about tolerance::kRank of the scale of each row
// (row_scale, rank/row_size.hpp), which is at least the norm of the row.

#include "manycontact/analysis/names.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

/// A set of rows that imposes the same constraint as all contacts between two bodies.
enum class Holds {
  kEach,        // every row counts
  kOneContact,  // one of them alone
  kSixD,        // one 6D contact anywhere on the body
  kThreeD,      // one 3D contact at their common point
  kLine,        // points on a line: five motions, which no single type constrains
  kFewerRows,   // some of the rows; see IslandRanks::redundant
};

/// All active contacts between the same two bodies.
struct BodyPair {
  Body A, B;                     // A can move
  std::string place_A, place_B;  // place_name of the contacts' ends
  std::vector<int> contacts;     // scene numbers, ascending
  int rows = 0, rank = 0;
  Holds holds = Holds::kEach;
  int alone = -1;  // kOneContact: which, by scene number
};

/// A contact whose own rows depend on each other, since its robots cannot move in all its directions.
struct Lighter {
  int contact = -1, rank = 0;
  std::string type;   // the lightest type of the same rank at the same frame, empty if there is none
  int only_just = 0;  // rows beyond that rank of which only just something is left (analysis/near_dependent.hpp)
};

struct IslandRanks {            // Result of find_ranks for one island.
  bool known = false;           // whether rank and redundant are computed; false: the island is too large
  int rank = 0;                 // rank of the island's J
  std::vector<char> redundant;  // one entry per row of the island: it depends on the rows before it
  std::vector<BodyPair> pairs;  // sorted by their first contacts
  std::vector<Lighter> lighter;
};

/// Call it after a solve, whatever its status. The rank of islands with nv nc^2 above 2e10 is left out (`known`), since
/// it takes dense matrices. Ranks of body pairs are always found. Throws std::logic_error before a solve.
IslandRanks find_ranks(const Scene& scene, const SceneData& data, std::size_t island);

/// An island's rows by name, and its contacts once the redundant rows are taken out, as words.
struct RowSelection {
  std::vector<std::string> redundant;  // "left_2[1]"
  std::vector<std::string> kept;       // "left_1", "left_2 as 2d (x and z)", "left_3[0]": these impose the same
  std::vector<std::string> dropped;    // contacts of which no row is left
};
/// ranks: of that island, known. Takes rows out from the last on, so that the first contacts stay whole.
RowSelection select_rows(const Scene& scene, const Island& island, const IslandRanks& ranks);

// Islands with the same findings, so that a herd of a thousand takes one line.

/// Islands of one shape with the same ranks, and with the same status, method, order and reason in the last solve.
struct IslandKind {
  std::vector<int> islands;  // numbers of the islands, ascending
  IslandRanks ranks;         // ranks of the first island
};

/// The islands' kinds, in the order of their first islands. After a solve; throws std::logic_error before.
std::vector<IslandKind> find_kinds(const Scene& scene, const SceneData& data);

/// Body pairs with the same models, joints, contact types and ranks: positions in `pairs`.
std::vector<std::vector<std::size_t>> alike_pairs(const Scene& scene, const std::vector<BodyPair>& pairs);

namespace internal {

/// The norm of each row of an island's J after projection on the complement of the independent rows before it, relative
/// to its size (rank/row_size.hpp).
struct RowRemainders {
  std::vector<double> left;             // empty where J is not in joint space
  double dependent = tolerance::kRank;  // rows with remainders up to this one depend on the rows before them;
                                        // it is chosen so that their number is what the solver has found
};
/// Uses dense Gram-Schmidt, twice. Call it after a solve.
RowRemainders row_remainders(const Scene& scene, const SceneData& data, std::size_t island);

}  // namespace internal

}  // namespace manycontact
