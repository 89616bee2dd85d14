#pragma once
// The two truths share the terms of a scene in S, and the dense solution of one island.

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
  std::vector<ContactData<S>> contacts;  // one entry per contact of the scene; only those of active contacts are set
};
template <class S>
TruthTerms<S> truth_terms(const Scene& scene, const std::vector<char>& active, const VecX<S>& q, const VecX<S>& v,
                          std::span<const Vec6<S>> w);

/// S^T u - h of one robot.
template <class S>
VecX<S> bias_torques(const Scene& scene, const TruthTerms<S>& t, int robot, const VecX<S>& u);

/// The island's a and f into `out`, its rank and regularity to the end of the lists there.
template <class S>
void dense_truth(const Scene& scene, const TruthTerms<S>& t, const Island& island, const std::vector<int>& f_offset,
                 const VecX<S>& u, Truth<S>& out);

}  // namespace manycontact::internal
