#pragma once
// Reduction of redundant contacts to pairs. A pair is one contact that replaces several contacts between the same two
// bodies; its rows are a basis of the span of their rows (contact/pair_rows.hpp). The accelerations do not change. The
// replaced contacts have the forces f = S Q y, with the pair's forces y, row weights S, and a Q with orthonormal
// columns. The reduced scene has the scene's contacts, of which the replaced ones are inactive, followed by the pairs.
// Each set of active contacts between two bodies has its own pair, which is kept for later.

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
  struct Terms {  // parameters of the scene, besides SceneIdentity, on which the reduction depends
    std::vector<char> constant_rows;      // one flag per contact of the scene
    bool damped = false, forces = false;  // forces: whether the scene has external wrenches or springs
    double moment_length = 1;
  };

  struct Set {        // a set of active contacts between two bodies
    Contact pair;     // the pair as first made; pair.pair is nullptr if the rows are independent, i.e. without a pair
    int number = -1;  // number of the pair's contact in the reduced scene
  };

  Scene scene;
  Terms terms;
  std::vector<std::vector<int>> groups;  // contacts of the scene between the same two bodies, with constant rows
  std::vector<std::map<std::vector<char>, Set>> sets;    // one map per group, from flags of its active contacts
  std::vector<std::shared_ptr<PairRows>> pairs;          // rows of each pair, in the order of the pairs' contacts
  std::set<SharedPairNumbers, PairNumbersLess> numbers;  // each distinct PairNumbers once; batches compare addresses
  std::unique_ptr<SceneData> data;                       // data of the reduced scene
  std::unique_ptr<SceneData> plain;  // the scene's own data, for derivatives if damped contacts slide; may be outdated
  std::vector<Island> islands;   // one per island of `data`, with the contacts of the original scene
  Eigen::VectorXd prescribed;    // prescribed accelerations of rows, in data->f's order
  Eigen::VectorXd df;            // scratch of products, in data->f's order
  std::vector<char> set;         // scratch of set_of
  Eigen::VectorXd rows_of_pair;  // scratch: one entry per row of a pair's contacts

  int first_pair() const { return static_cast<int>(scene.contacts.size() - pairs.size()); }
  /// Returns the PairRows of contact c of the reduced scene; nullptr if the contact is no pair.
  const PairRows* pair_of(int c) const { return c < first_pair() ? nullptr : pairs[c - first_pair()].get(); }
  template <class Use>
  void each_pair(Use&& use) const {  // calls use(contact of `scene`, rows) for the active pairs
    for (std::size_t k = 0; k < pairs.size(); ++k)
      if (const int c = first_pair() + static_cast<int>(k); data->active[c]) use(c, *pairs[k]);
  }
};

namespace internal {

/// Whether the reduction is up to date with the data's options and active contacts, and the scene's parameters.
bool reduction_is_current(const Scene& scene, const SceneData& data);
bool has_pairs(const Reduction& reduction, std::size_t island);  // whether an island's contacts are reduced to pairs
void prepare_reduction(const Scene& scene, SceneData& data);  // makes or drops the reduction; prepares its islands
/// Solves a prepared scene by its reduced scene. prescribed: as for solve_prepared (internal.hpp).
const Report& solve_reduced(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                            SceneData& data, std::span<const double> prescribed);
/// Returns the data whose solution is to be differentiated: Reduction::data, or Reduction::plain, solved if necessary.
SceneData& differentiated(const Scene& scene, SceneData& data);

void expand_forces(const SceneData& data, const double* y, double* f);  // f = S Q y for pairs, f = y for others
void reduce_forces(const SceneData& data, const double* f, double* y);  // the transpose: y = Q^T S f for pairs

const DerivativeData& differentiate_reduced(const Scene& scene, SceneData& data, const DerivativeRequest& request);
std::vector<DerivativeBounds> derivative_errors_reduced(const Scene& scene, SceneData& data);
void bound_errors_reduced(const Scene& scene, SceneData& data);
void estimate_condition_reduced(const Scene& scene, SceneData& data);

}  // namespace internal

}  // namespace manycontact
