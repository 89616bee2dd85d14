#pragma once
// The dense forward path in any scalar: in quadruple precision (library manycontact_quad) the truth that the answers in
// double are measured against. No structure is used but the islands; nothing is kept.

#include "manycontact/dynamics/data.hpp"

namespace manycontact {

template <class S>
struct Truth {
  VecX<S> a;               // scene.nv
  VecX<S> f;               // rows of the active contacts
  VecX<S> h;               // scene.nv
  std::vector<int> rank;   // per island
  std::vector<bool> regular;
};

/// Accelerations and forces at q, v, u (sizes of the scene), contacts as flagged in `active`.
template <class S>
Truth<S> solve_truth(const Scene& scene, const std::vector<char>& active, const VecX<S>& q, const VecX<S>& v,
                     const VecX<S>& u);

}  // namespace manycontact
