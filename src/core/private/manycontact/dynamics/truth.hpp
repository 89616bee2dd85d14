#pragma once
// Forward dynamics in any scalar S. In quadruple precision (library manycontact_quad) it is the reference for solutions
// in double. Its cost is linear in the scene: K x = b is refined with residuals in S and a factor in double.

#include "manycontact/dynamics/data.hpp"
#include "manycontact/kkt/dense.hpp"

namespace manycontact {

template <class S>
struct Truth {
  VecX<S> a;              // scene.nv
  VecX<S> f;              // one entry per row of the active contacts
  VecX<S> h;              // scene.nv: bias minus torques of joint friction, external wrenches and springs
  std::vector<int> rank;  // one entry per island: rank of J
  std::vector<bool> regular;
};

/// Computes accelerations and forces at q, v, u, for the contacts and wrenches of `data`. `data` must contain a
/// solution by sparse-ldl at a state within 1e-8 of (q, v, u). Each island is refined by
///
///     x <- x + L^-T D^-1 L^-1 (b - K x),   K, b at q, v, u in S, L D L^T in double,
///
/// until the backward error stops decreasing. Islands that sparse-ldl did not solve, or whose error stays above 1e4 eps
/// of S, are solved densely up to `dense_size` unknowns. Larger islands get NaN and count as not regular. For refined
/// islands the member rank is nc.
template <class S>
Truth<S> refine_truth(const Scene& scene, SceneData& data, const VecX<S>& q, const VecX<S>& v, const VecX<S>& u,
                      int dense_size);

}  // namespace manycontact
