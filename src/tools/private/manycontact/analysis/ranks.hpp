#pragma once
// Finds the contact rows of an island that are independent of the rows before them, at the q of the last solve. There
// are as many as the rank that the solve found. Without damping this is the rank of J to about tolerance::kRank times
// the scale of each row (row_scale, rank/row_size.hpp), which is at least the norm of the row.

#include "manycontact/analysis/names.hpp"
#include "manycontact/dynamics/views.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

enum class Holds {  // a set of rows that imposes the same constraint as all contacts between two bodies
  kEach,            // every row is independent
  kOneContact,      // one of the contacts alone imposes it
  kSixD,            // one 6D contact anywhere on the body imposes it
  kThreeD,          // one 3D contact at the contacts' common point imposes it
  kLine,            // points on a line constrain five motions, as no single contact type does
  kFewerRows,       // some of the rows impose it; see IslandRanks::redundant
};

struct BodyPair {                // all active contacts between the same two bodies
  Body A, B;                     // A is a body that can move
  std::string place_A, place_B;  // place_name of the contacts' ends
  std::vector<int> contacts;     // scene numbers of the contacts, ascending
  int rows = 0, rank = 0;
  Holds holds = Holds::kEach;
  int alone = -1;  // kOneContact: scene number of the contact
};

/// A contact with redundant rows, because its robots cannot move in all directions that the contact constrains.
struct Lighter {
  int contact = -1, rank = 0;
  std::string type;   // contact type with fewest rows of equal rank at the same frame; empty if there is none
  int only_just = 0;  // number of rows beyond `rank` that are nearly dependent (analysis/near_dependent.hpp)
};

struct IslandRanks {            // Result of find_ranks for one island.
  bool known = false;           // whether rank and redundant are computed; they are not if the island is too large
  int rank = 0;                 // rank of the island's J
  std::vector<char> redundant;  // one entry per row of the island: whether it depends on the rows before it
  std::vector<BodyPair> pairs;  // sorted by the number of their first contact
  std::vector<Lighter> lighter;
};

/// Finds an island's ranks after a solve of any status; throws std::logic_error before a solve. Computes only the ranks
/// of body pairs if nv nc^2 exceeds 3e9 (`known` is then false), and none if the island is too deep to store J.
IslandRanks find_ranks(const Scene& scene, const SceneData& data, std::size_t island);

struct RowSelection {                  // names of an island's redundant rows, and of its contacts without these rows
  std::vector<std::string> redundant;  // "left_2[1]"
  std::vector<std::string> kept;       // "left_1", "left_2 as 2d (x and z)", "left_3[0]"
  std::vector<std::string> dropped;    // contacts of which no row is left
};
/// Selects rows if the ranks are known. A row is dropped if it depends on earlier rows; first contacts stay complete.
RowSelection select_rows(const Scene& scene, const Island& island, const IslandRanks& ranks);

/// Islands that have the same shape and ranks, and had the same status, method, order and reason in the last solve.
struct IslandKind {
  std::vector<int> islands;  // numbers of the islands, ascending
  IslandRanks ranks;         // ranks of the first of these islands
};

/// Finds the kinds of islands, in the order of their first islands. Throws std::logic_error before a solve.
std::vector<IslandKind> find_kinds(const Scene& scene, const SceneData& data);

/// Groups body pairs that have the same models, joints, contact types and ranks. Returns per group indices in `pairs`.
std::vector<std::vector<std::size_t>> alike_pairs(const Scene& scene, const std::vector<BodyPair>& pairs);

namespace internal {

/// The norm of each row's part orthogonal to preceding independent rows, divided by its scale (rank/row_size.hpp).
struct RowRemainders {
  std::vector<double> left;             // empty if J is not stored in joint space
  double dependent = tolerance::kRank;  // rows with remainders up to this threshold are dependent; it is chosen
                                        // such that the solve dropped equally many rows
};
/// Computes the remainders of an island's rows after a solve, by two passes of dense Gram-Schmidt.
RowRemainders row_remainders(const Scene& scene, const SceneData& data, std::size_t island);

}  // namespace internal

}  // namespace manycontact
