#pragma once
// Terms of a scene in scalars S, and the dense solution of one island, for reference solutions (dynamics/truth.hpp).

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

/// Returns B u - h of one robot, where B selects the actuated coordinates.
template <class S>
VecX<S> bias_torques(const Scene& scene, const TruthTerms<S>& t, int robot, const VecX<S>& u);

/// Solves one island: writes its a and f into `out`, and appends its rank and `regular` (kkt/dense.hpp).
template <class S>
void dense_truth(const Scene& scene, const TruthTerms<S>& t, const Island& island, const std::vector<int>& f_offset,
                 const VecX<S>& u, Truth<S>& out);

}  // namespace manycontact::internal
