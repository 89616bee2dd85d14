#pragma once
// Terms of a scene in scalars S, and the dense solution of one island, for both reference solutions.

#include "../robot_quantities.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "manycontact/detail/kkt/island.hpp"
#include "manycontact/dynamics/truth.hpp"

namespace manycontact::internal {

template <class S>
struct TruthTerms {
  std::vector<RobotQuantities<S>> robots;
  std::vector<VecX<S>> M;                // one entry per robot, packed
  std::vector<ContactSupport> supports;  // one entry per contact of the scene
  std::vector<ContactData<S>> contacts;  // one entry per contact of the scene; set if active
};
template <class S>
TruthTerms<S> truth_terms(const Scene& scene, const std::vector<char>& active, const VecX<S>& q, const VecX<S>& v,
                          std::span<const Vec6<S>> w);

/// Returns S^T u - h of one robot, S the selection of actuated coordinates.
template <class S>
VecX<S> bias_torques(const Scene& scene, const TruthTerms<S>& t, int robot, const VecX<S>& u);

/// Writes the island's a and f into `out`, and appends its rank and regularity.
template <class S>
void dense_truth(const Scene& scene, const TruthTerms<S>& t, const Island& island, const std::vector<int>& f_offset,
                 const VecX<S>& u, Truth<S>& out);

}  // namespace manycontact::internal
