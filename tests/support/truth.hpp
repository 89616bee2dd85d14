#pragma once
// The dense truth in quadruple precision. It uses no structure but the islands, and stores nothing.

#include "dynamics/truth/truth_terms.hpp"

namespace manycontact {

/// Returns accelerations and forces at q, v, u (sizes of the scene), contacts as flagged in `active`, under these
/// external wrenches, or those of the scene if none are given.
template <class S>
Truth<S> solve_truth(const Scene& scene, const std::vector<char>& active, const VecX<S>& q, const VecX<S>& v,
                     const VecX<S>& u, std::span<const Vec6<S>> wrenches = {}) {
  std::vector<Vec6<S>> w(wrenches.begin(), wrenches.end());
  for (std::size_t k = w.size(); k < scene.wrenches.size(); ++k)
    w.push_back(scene.wrenches[k].wrench.template cast<S>());
  const internal::TruthTerms<S> terms = internal::truth_terms<S>(scene, active, q, v, w);
  std::vector<int> f_offset(scene.contacts.size(), -1);
  int rows = 0;
  for (std::size_t c = 0; c < scene.contacts.size(); ++c)
    if (active[c]) f_offset[c] = rows, rows += scene.contacts[c].rows();
  Truth<S> out;
  out.a.resize(scene.nv);
  out.f.resize(rows);
  out.h.resize(scene.nv);
  for (int r = 0; r < scene.nrobots(); ++r)
    out.h.segment(scene.robots[r].idx_v, scene.robots[r].model->nv) = terms.robots[r].h;
  for (const Island& island : find_islands(scene, active))
    internal::dense_truth<S>(scene, terms, island, f_offset, u, out);
  return out;
}

}  // namespace manycontact
