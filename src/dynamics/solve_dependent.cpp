#include <cmath>
#include <ranges>

#include "internal.hpp"

namespace manycontact::internal {

namespace {

// A row of J with less than kSmallestPivotRatio left of its pivot may depend on the others (below 3e-6 of its length it
// does not point elsewhere). Whether it does in truth, J's rows themselves tell, far more sharply: what is left of them
// must be rounding; in between, the oracle decides.
constexpr double kRowLeft = 1e-13;
// Rows kept that are much smaller than those dropped make the projector lose more digits than the condition explains:
// 30^2 eps is what a value is allowed at the least. Beyond, the oracle answers.
constexpr double kLargestEntry = 30;

// The contacts' rows of the system as it was, and whether they contradict each other; after the solve of the projected
// right-hand side.
bool restore(double drift, KktSystem& s, const std::vector<double>& null_part) {
  const KktPattern& p = *s.pattern;
  double left = 0, Ja = 0, a0 = 0;
  for (int k = p.nv; k < p.size(); ++k) {
    Ja = std::max(Ja, s.scale[k] - std::abs(s.b[k]));
    s.scale[k] -= std::abs(s.b[k]);
    s.b[k] += null_part[k];
    s.r[k] += null_part[k];
    s.scale[k] += std::abs(s.b[k]);
    a0 = std::max(a0, std::abs(s.b[k]));
    left = std::max(left, std::abs(s.r[k]));
  }
  return contradictory(left, Ja, a0, drift);
}

}  // namespace

Reason solve_dependent(const Scene& scene, SceneData& data, IslandData& d, IslandReport& report) {
  KktSystem& s = d.system;
  const KktPattern& p = *s.pattern;
  begin_ldl(d, report);
  const double size = motion_size(scene, data, d.island);
  const int done = sparse::ldl_factor_dependent(p.K, p.ldl, s.Kx.data(), p.nv, kSmallestPivotRatio,
                                                kRankTolerance * size, data.ldl_work, d.Lx.data(), d.D.data(), d.rows);
  if (done != p.size()) return done < p.nv ? Reason::kSingularInertia : Reason::kWrongInertia;
  sparse::find_null_space(p.K, p.ldl, s.Kx.data(), p.nv, size, d.Lx.data(), d.D.data(), d.rows);
  if (!(d.rows.largest_residual <= kRowLeft && d.rows.largest_entry <= kLargestEntry)) return Reason::kSmallPivot;
  d.factor = d.rows.dropped.empty() ? Factor::kLdl : Factor::kDependent;
  const auto apply = [&](double* x) { solve_with_factor(scene, d, x); };
  d.rows.null_part.assign(p.size(), 0.0);
  sparse::project_out(d.rows, s.b.data(), d.rows.null_part.data());  // what the contacts can agree on
  s.x = s.b;
  apply(s.x.data());
  const Refinement refinement = refine(s, kRefinementSteps, apply);
  d.first_error = refinement.first;
  report.refinement_steps = refinement.steps;
  const bool contradiction = restore(drift_size(scene, data, d.island), s, d.rows.null_part);
  if (!converged(refinement)) {
    d.factor = Factor::kNone;
    return Reason::kLargeResidual;
  }
  if (d.rows.dropped.empty()) return Reason::kNone;
  report.status = contradiction ? Status::kInconsistent : Status::kRedundant;
  report.rank = d.island.nc - static_cast<int>(d.rows.dropped.size());
  const auto row_of_J = [&p](int k) { return p.perm[k] - p.nv; };
  name_dependent_rows(data, d.island, d.rows.dropped | std::views::transform(row_of_J), report);
  return Reason::kNone;
}

}  // namespace manycontact::internal
