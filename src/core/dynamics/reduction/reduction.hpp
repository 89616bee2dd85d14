#pragma once
// Reduction of redundant contacts: several contacts between the same two bodies are replaced by one, whose rows span
// theirs (contact/pair_rows.hpp). The solution is that of all contacts: accelerations are equal, and f = S Q y.
// The reduced scene has the contacts of the scene, those in pairs inactive, and then the pairs. A pair is one set of
// active contacts between two bodies; sets are kept for later.

#include <map>
#include <memory>
#include <set>

#include "manycontact/contact/pair_rows.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/data.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/dynamics/solve.hpp"

namespace manycontact {

struct Workspace;

struct Reduction {
  /// Parameters on which reducible pairs depend, in addition to SceneIdentity's.
  struct Terms {
    std::vector<char> constant_rows;      // one flag per contact of the scene
    bool damped = false, forces = false;  // forces: whether there are external wrenches or springs
    double moment_length = 1;
  };

  struct Set {        // active contacts between two bodies
    Contact pair;     // the pair as first made; `pair.pair` is null if the rows are independent
    int number = -1;  // number of the pair among the contacts of the reduced scene
  };

  Scene scene;
  Terms terms;
  std::vector<std::vector<int>> groups;  // contacts of the scene between the same two bodies, with constant rows
  std::vector<std::map<std::vector<char>, Set>> sets;    // one map per group, from flags of its active contacts
  std::vector<std::shared_ptr<PairRows>> pairs;          // one per pair contact, appended after the scene's
  std::set<SharedPairNumbers, PairNumbersLess> numbers;  // all that pairs had; SIMD batches compare their addresses
  std::unique_ptr<SceneData> data;
  // data without reduction, for derivatives of damped sliding contacts; current if it has a solution
  std::unique_ptr<SceneData> plain;
  std::vector<Island> islands;   // one per island of `data`, with the contacts of the original scene
  Eigen::VectorXd prescribed;    // rows of `data`
  Eigen::VectorXd df;            // scratch of products: rows of `data`
  std::vector<char> set;         // scratch
  Eigen::VectorXd rows_of_pair;  // scratch, for all rows of any pair

  int first_pair() const { return static_cast<int>(scene.contacts.size() - pairs.size()); }
  /// Returns the rows of a contact of `scene`; nullptr if it is no pair.
  const PairRows* pair_of(int c) const { return c < first_pair() ? nullptr : pairs[c - first_pair()].get(); }
  /// Calls use(contact of `scene`, rows) for the active pairs.
  template <class Use>
  void each_pair(Use&& use) const {
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (const int c = first_pair() + static_cast<int>(k); data->active[c]) use(c, *pairs[k]);
  }
};

namespace internal {

/// Whether the current reduction was made for the data's options, contacts and parameters.
bool reduction_is_current(const Scene& scene, const SceneData& data);
/// Whether contacts of an island are reduced to pairs.
bool has_pairs(const Reduction& reduction, std::size_t island);
/// Creates, changes or drops the reduction for data.active, and prepares its islands.
void prepare_reduction(const Scene& scene, SceneData& data);
/// Solves the reduced scene, after `begin`. prescribed: accelerations of rows of data.f, or empty.
const Report& solve_reduced(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                            SceneData& data, std::span<const double> prescribed);
/// Returns the data that contain the derivatives of the current solution: the reduced scene's, or `plain`.
SceneData& differentiated(const Scene& scene, SceneData& data);

/// Expands forces y of the reduced scene to f of the scene's contacts: S Q y for pairs.
void expand_forces(const SceneData& data, const double* y, double* f);
/// Applies the transpose of expand_forces.
void reduce_forces(const SceneData& data, const double* f, double* y);

const DerivativeData& differentiate_reduced(const Scene& scene, SceneData& data, const DerivativeRequest& request);
std::vector<DerivativeBounds> derivative_errors_reduced(const Scene& scene, SceneData& data);
void bound_errors_reduced(const Scene& scene, SceneData& data);
void estimate_condition_reduced(const Scene& scene, SceneData& data);

}  // namespace internal

}  // namespace manycontact
