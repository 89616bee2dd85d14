#include <cmath>

#include "internal.hpp"

namespace manycontact::internal {

namespace {

bool has_inertia(const KktPattern& p, const double* D) {
  int positive = 0;
  for (int k = 0; k < p.size(); ++k) positive += D[k] > 0;
  return positive == p.nv;
}

Reason judge(const KktPattern& p, const double* D, double pivot_ratio) {
  for (int k = 0; k < p.size(); ++k)
    if (!std::isfinite(D[k]) || D[k] == 0) return Reason::kZeroPivot;
  if (!has_inertia(p, D)) return Reason::kWrongInertia;
  return pivot_ratio < kSmallestPivotRatio ? Reason::kSmallPivot : Reason::kNone;
}

template <class Solve>
Reason solve_refined(IslandData& d, IslandReport& report, Solve&& apply) {
  KktSystem& s = d.system;
  s.x = s.b;
  apply(s.x.data());
  const Refinement refinement = refine(s, kRefinementSteps, apply);
  d.first_error = refinement.first;
  report.refinement_steps = refinement.steps;
  return converged(refinement) ? Reason::kNone : Reason::kLargeResidual;
}

}  // namespace

Reason solve_ldl(SceneData& data, IslandData& d, IslandReport& report) {
  KktSystem& s = d.system;
  const KktPattern& p = *s.pattern;
  begin_ldl(d, report);
  if (sparse::ldl_factor(p.K, p.ldl, s.Kx.data(), data.ldl_work, d.Lx.data(), d.D.data()) != p.size())
    return Reason::kZeroPivot;
  const double ratio = sparse::smallest_pivot_ratio(p.K, p.ldl, s.Kx.data(), d.Lx.data(), d.D.data(), s.scale.data());
  if (const Reason reason = judge(p, d.D.data(), ratio); reason != Reason::kNone) return reason;
  d.factor = Factor::kLdl;
  return solve_refined(d, report, [&](double* x) { sparse::ldl_solve(p.ldl, d.Lx.data(), d.D.data(), x); });
}

Reason solve_cholmod(IslandData& d, IslandReport& report) {
  KktSystem& s = d.system;
  const KktPattern& p = *s.pattern;
  if (!d.cholmod || d.cholmod_pattern != &p) {
    d.cholmod.emplace(p.K, sparse::CholmodKind::kSimplicialLdl, false);
    d.cholmod_pattern = &p;
  }
  d.D.resize(p.size());
  report.method = Method::kSparseCholmod;
  report.order = p.order;
  report.factor_nonzeros = d.cholmod->factor_nonzeros();
  if (!d.cholmod->factorize(s.Kx.data())) return Reason::kZeroPivot;
  d.cholmod->pivots(d.D.data());
  const double ratio = d.cholmod->smallest_pivot_ratio(s.Kx.data(), s.scale.data());
  if (const Reason reason = judge(p, d.D.data(), ratio); reason != Reason::kNone) return reason;
  d.factor = Factor::kCholmod;
  return solve_refined(d, report, [&](double* x) { d.cholmod->solve(x, 1); });
}

Reason solve_supernodal(const Scene& scene, IslandData& d, IslandReport& report) {
  KktSystem& s = d.system;
  report.method = Method::kSparseSupernodal;
  report.order = s.pattern->order;
  const SchurPattern& p = *d.schur_pattern;
  if (!form_schur(scene, d.island, d.support, p, d.M, d.J, scene.damping, d.schur)) return Reason::kSingularInertia;
  report.factor_nonzeros = 0;
  for (const auto& L : d.schur.L) report.factor_nonzeros += static_cast<int>(L.size());
  if (d.island.nc > 0) {
    if (!d.cholmod) d.cholmod.emplace(p.S, sparse::CholmodKind::kSupernodalLlt, true);
    if (!d.cholmod->factorize(d.schur.Sx.data())) return Reason::kSmallPivot;
    report.factor_nonzeros += d.cholmod->factor_nonzeros();
    if (d.cholmod->rcond() < kSmallestPivotRatio) return Reason::kSmallPivot;
  }
  d.factor = Factor::kSupernodal;
  return solve_refined(d, report, [&](double* x) { solve_with_factor(scene, d, x); });
}

}  // namespace manycontact::internal
