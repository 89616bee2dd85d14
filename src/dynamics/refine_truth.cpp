#include <limits>

#include "internal.hpp"
#include "truth_terms.hpp"

namespace manycontact {

namespace {

using internal::TruthTerms;

// K (upper triangle) and b of an island in S, in the elimination order of its pattern.
template <class S>
struct System {
  const sparse::UpperCsc& A;
  std::vector<S> K, b, x, r;
};

template <class S>
System<S> assemble_system(const Scene& scene, const TruthTerms<S>& t, const IslandData& d, const VecX<S>& u) {
  const KktPattern& p = *d.system.pattern;
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

// r = b - K x; returns max |r| / max (|b| + |K| |x|).
template <class S>
S backward_error(System<S>& s) {
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
    if (!(abs(s.r[k]) <= worst)) worst = abs(s.r[k]);
    if (!(scale[k] <= largest)) largest = scale[k];
  }
  return worst == 0 ? worst : S(worst / largest);
}

// Whether x was found.
template <class S>
bool refine_island(const Scene& scene, IslandData& d, System<S>& s) {
  constexpr int kSteps = 60;
  const S small = 10000 * std::numeric_limits<S>::epsilon();
  std::vector<double> dx(s.b.size());
  S error(1);
  for (int step = 0; step < kSteps; ++step) {
    for (std::size_t k = 0; k < dx.size(); ++k) dx[k] = static_cast<double>(s.r[k]);
    internal::solve_with_factor(scene, d, dx.data());
    for (std::size_t k = 0; k < dx.size(); ++k) s.x[k] += S(dx[k]);  // x += K^-1 r
    const S before = error;
    error = backward_error(s);
    // one step more than the residual needs: x itself still gains by the condition of K
    if (!(error < S(0.5) * before)) break;
  }
  return error < small;
}

}  // namespace

template <class S>
Truth<S> refine_truth(const Scene& scene, SceneData& data, const VecX<S>& q, const VecX<S>& v, const VecX<S>& u,
                      int dense_size) {
  internal::check_solved(data, "refine_truth");
  const TruthTerms<S> terms = internal::truth_terms<S>(scene, data.active, q, v);
  const S nan = std::numeric_limits<S>::quiet_NaN();
  Truth<S> out;
  out.a.setConstant(scene.nv, nan);
  out.f.setConstant(data.f.size(), nan);
  out.h.resize(scene.nv);
  for (int r = 0; r < scene.nrobots(); ++r)
    out.h.segment(scene.robots[r].idx_v, scene.robots[r].model->nv) = terms.h[r];
  for (IslandData& d : data.islands) {
    if (d.factor == Factor::kLdl) {
      System<S> s = assemble_system(scene, terms, d, u);
      if (refine_island(scene, d, s)) {
        for (int k = 0; k < d.island.nc; ++k) s.x[d.system.pattern->iperm[d.island.nv + k]] *= -1;  // x = [a; -f]
        internal::scatter(scene, data, d, s.x.data(), out.a, out.f);
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
