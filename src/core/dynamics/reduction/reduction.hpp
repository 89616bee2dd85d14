#pragma once
// Decorator of all that is done with a scene's data: where several contacts join the same two bodies, the scene that is
// solved has one contact in their place, whose rows span theirs (contact/pair_rows.hpp). Its solutions are then those
// of all contacts: accelerations are the same, forces f = S Q y.
//
// The scene solved has the contacts of the scene, of which those in pairs are not active, and behind them the pairs. A
// pair is one set of active contacts between two bodies; sets met before are kept.

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
  /// Terms that the pairs that may be reduced depend on, in addition to those of SceneIdentity.
  struct Terms {
    std::vector<char> constant_rows;      // one flag per contact of the scene
    bool damped = false, forces = false;  // forces: there are external wrenches or springs
    double moment_length = 1;
  };

  struct Set {        // active contacts between two bodies, once met
    Contact pair;     // the pair, as first made; `pair.pair` is empty where their rows are independent
    int number = -1;  // number of the pair among the contacts of the scene solved
  };

  Scene scene;  // the scene that is solved
  Terms terms;
  std::vector<std::vector<int>> groups;  // contacts of the scene between the same two bodies, with constant rows
  std::vector<std::map<std::vector<char>, Set>> sets;    // one map per group, from flags of its active contacts
  std::vector<std::shared_ptr<PairRows>> pairs;          // one per pair contact, appended after the scene's
  std::set<SharedPairNumbers, PairNumbersLess> numbers;  // all that pairs had; SIMD batches compare their addresses
  std::unique_ptr<SceneData> data;                       // data of `scene`
  // data of the scene without pairs, for derivatives of damped contacts that slide; a solution there is the current one
  std::unique_ptr<SceneData> plain;
  std::vector<Island> islands;   // islands with the contacts of the original scene, one per island of `data`
  Eigen::VectorXd prescribed;    // rows of `data`
  Eigen::VectorXd df;            // scratch of products: rows of `data`
  std::vector<char> set;         // scratch
  Eigen::VectorXd rows_of_pair;  // scratch, for all rows of any pair

  int first_pair() const { return static_cast<int>(scene.contacts.size() - pairs.size()); }
  /// The rows of a contact of `scene`; nullptr where it is no pair.
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
/// Makes, changes or drops the reduction for data.active; its islands are prepared.
void prepare_reduction(const Scene& scene, SceneData& data);
/// After `begin` of solve, where there is a reduction. prescribed: of rows of data.f, or none.
const Report& solve_reduced(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                            SceneData& data, std::span<const double> prescribed);
/// Returns the data that contain the derivatives of the current solution: those of the reduced scene, or of the scene
/// itself.
SceneData& differentiated(const Scene& scene, SceneData& data);

/// f of the scene's contacts, of that of the scene solved; S Q y of pairs.
void expand_forces(const SceneData& data, const double* y, double* f);
/// The transpose of that.
void reduce_forces(const SceneData& data, const double* f, double* y);

const DerivativeData& differentiate_reduced(const Scene& scene, SceneData& data, const DerivativeRequest& request);
std::vector<DerivativeBounds> derivative_errors_reduced(const Scene& scene, SceneData& data);
void bound_errors_reduced(const Scene& scene, SceneData& data);
void estimate_condition_reduced(const Scene& scene, SceneData& data);

}  // namespace internal

}  // namespace manycontact
