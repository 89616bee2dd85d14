#include <limits>

#include "../internal.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "truth_terms.hpp"

namespace manycontact {

namespace {

using internal::TruthTerms;

template <class S>
struct System {  // K (upper triangle) and b of an island in scalars S, in the pattern's elimination order
  const sparse::UpperCsc& A;
  std::vector<S> K, b, x, r;
};

template <class S>
System<S> assemble_system(const Scene& scene, const TruthTerms<S>& t, const IslandWork& d, const VecX<S>& u) {
  const KktPattern& p = *d.matrix.K.pattern;
  System<S> s{p.K, std::vector<S>(p.K.nonzeros(), S(0)), std::vector<S>(p.size(), S(0)), {}, {}};
  const int* slot = p.M_slot.data();
  for (std::size_t k = 0; k < d.island.robots.size(); ++k) {
    const int r = d.island.robots[k], o = d.island.dof_offset[k];
    for (const S& value : t.M[r]) s.K[*slot++] = value;
    const VecX<S> tau = internal::bias_torques(scene, t, r, u);
    for (int i = 0; i < tau.size(); ++i) s.b[p.iperm[o + i]] = tau[i];
  }
  slot = p.J_slot.data();
  for (std::size_t k = 0; k < d.island.contacts.size(); ++k) {
    const ContactData<S>& rows = t.contacts[d.island.contacts[k]];
    for (const S& value : rows.J.reshaped()) s.K[*slot++] = value;
    for (int i = 0; i < rows.a0.size(); ++i) s.b[p.iperm[d.island.nv + d.island.row_offset[k] + i]] = -rows.a0[i];
  }
  for (int k : p.diagonal_slot) s.K[k] = S(-scene.damping);
  s.x.assign(p.size(), S(0));
  s.r = s.b;
  return s;
}

template <class S>
S backward_error(System<S>& s) {  // sets r = b - K x; returns max |r| / max (|b| + |K| |x|)
  using std::abs;
  s.r = s.b;
  std::vector<S> scale(s.b.size());
  for (std::size_t k = 0; k < s.b.size(); ++k) scale[k] = abs(s.b[k]);
  for (int j = 0; j < s.A.n; ++j)
    for (int k = s.A.p[j]; k < s.A.p[j + 1]; ++k) {
      const int i = s.A.i[k];
      const S ij = s.K[k] * s.x[j];
      s.r[i] -= ij, scale[i] += abs(ij);
      if (i == j) continue;
      const S ji = s.K[k] * s.x[i];
      s.r[j] -= ji, scale[j] += abs(ji);
    }
  S worst(0), largest(0);
  for (std::size_t k = 0; k < s.b.size(); ++k) {
    worst = sparse::larger_or_nan(worst, S(abs(s.r[k])));
    largest = sparse::larger_or_nan(largest, scale[k]);
  }
  return worst == 0 ? worst : S(worst / largest);
}

// Refines x until the residual no longer decreases (K may be ill-conditioned). Returns whether x converged.
template <class S>
bool refine_island(Factor& factor, System<S>& s) {
  std::vector<double> dx(s.b.size());
  const double small = tolerance::kTruthRounding * static_cast<double>(std::numeric_limits<S>::epsilon());
  const sparse::Refinement refinement = sparse::refine(
      tolerance::kTruthSteps, 0, [&] { return static_cast<double>(backward_error(s)); },
      [&] {
        for (std::size_t k = 0; k < dx.size(); ++k) dx[k] = static_cast<double>(s.r[k]);
        factor.solve(dx.data());
        for (std::size_t k = 0; k < dx.size(); ++k) s.x[k] += S(dx[k]);
      });
  return refinement.backward_error < small;
}

}  // namespace

template <class S>
Truth<S> refine_truth(const Scene& scene, SceneData& data, const VecX<S>& q, const VecX<S>& v, const VecX<S>& u,
                      int dense_size) {
  internal::check_not_prescribed(scene, data, "refine_truth");
  std::vector<Vec6<S>> w;
  if (internal::forces_are_applied(*data.workspace))
    for (const Vec6<double>& wrench : data.workspace->applied->w) w.push_back(wrench.template cast<S>());
  const TruthTerms<S> terms = internal::truth_terms<S>(scene, data.active, q, v, w);
  const S nan = std::numeric_limits<S>::quiet_NaN();
  Truth<S> out;
  out.a.setConstant(scene.nv, nan);
  out.f.setConstant(data.f.size(), nan);
  out.h.resize(scene.nv);
  for (int r = 0; r < scene.nrobots(); ++r)
    out.h.segment(scene.robots[r].idx_v, scene.robots[r].model->nv) = terms.robots[r].h;
  internal::prepare_islands(scene, data);
  for (const auto& island : data.workspace->islands) {
    IslandWork& d = *island;
    const bool by_matrix = d.answered && !d.answered_by(d.bodies.get()) &&
                           d.matrix.make_current(scene, data, data.workspace->threads.front());
    if (by_matrix && d.matrix.factor->method() == Method::kSparseLdl && !d.matrix.deficient() &&
        d.matrix.unit.empty()) {
      System<S> s = assemble_system(scene, terms, d, u);
      if (refine_island(*d.matrix.factor, s)) {
        const KktPattern& p = *d.matrix.K.pattern;
        for (int k = 0; k < d.island.nc; ++k) s.x[p.iperm[d.island.nv + k]] *= -1;  // x = [a; -f]
        internal::scatter(scene, data.f_offset, p, d.island, s.x.data(), out.a, out.f);
        out.rank.push_back(d.island.nc);
        out.regular.push_back(true);
        continue;
      }
    }
    if (d.island.size() <= dense_size) {
      internal::dense_truth<S>(scene, terms, d.island, data.f_offset, u, out);
    } else {
      out.rank.push_back(0);
      out.regular.push_back(false);
    }
  }
  return out;
}

template Truth<InstantiatedScalar> refine_truth<InstantiatedScalar>(const Scene&, SceneData&,
                                                                    const VecX<InstantiatedScalar>&,
                                                                    const VecX<InstantiatedScalar>&,
                                                                    const VecX<InstantiatedScalar>&, int);

}  // namespace manycontact
