#include "matrix.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../../derivatives/products.hpp"
#include "../../internal.hpp"
#include "manycontact/sparse/largest.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

bool MatrixSystem::has_terms() const {
  return M.size() == owner.island.robots.size() && J.size() == owner.island.contacts.size();
}

void MatrixSystem::make_room(Order order) {
  const std::shared_ptr<const KktPattern>& pattern = owner.shape->pattern(order);
  if (K.pattern != pattern) K.reset(pattern);
  v.resize(K.size());
}

bool MatrixSystem::deficient() const { return factor && factor->rank() < owner.island.nc; }

namespace {

// Returns dK x in K's order, where dK is the change of J in K by WithinTolerance; empty if J is unchanged.
std::vector<double> change_of(const MatrixSystem& m) {
  std::vector<double> out;
  m.each_change([&](int row, int column, double value) {
    if (out.empty()) out.assign(m.v.x.size(), 0.0);
    out[row] += value * m.v.x[column];
    out[column] += value * m.v.x[row];
  });
  return out;
}

// Reports the residuals of the solution with the scene's J, i.e. without the change of J by WithinTolerance.
void report_residuals(const Scene& scene, const MatrixSystem& m, IslandReport& report) {
  const KktPattern& p = *m.K.pattern;
  const KktVectors& s = m.v;
  double r[2] = {0, 0}, scale[2] = {0, 0};  // largest: [0] dynamics rows, [1] contact rows
  const std::vector<double> changed = change_of(m);
  for (int k = 0; k < p.size(); ++k) {
    const int row = p.perm[k] >= p.nv;
    r[row] = sparse::larger_or_nan(r[row], std::abs(s.r[k] + (changed.empty() ? 0 : changed[k])));
    scale[row] = std::max(scale[row], s.scale[k]);
  }
  internal::report_residuals(scene, r, scale, report);
}

// Stores x = [a; -f] in the scene's coordinates, and the residual of K x = b.
void take_answer(const Scene& scene, SceneData& data, const MatrixSystem& m, IslandReport& report) {
  const KktPattern& p = *m.K.pattern;
  internal::scatter(scene, data.f_offset, p, m.owner.island, m.v.x.data(), data.a, data.f);
  each_force_block(scene, data.f_offset, m.owner.island, [&](int first, int row, int n) {
    for (int i = 0; i < n; ++i) data.f[first + i] *= -unit_of(m, row + i);
  });
  report_residuals(scene, m, report);
  if (m.deficient() && (m.contradiction || m.factor != m.proximal.get()))
    report.backward_error = sparse::componentwise_backward_error(m.v.r, m.v.scale);
}

// Calls solve(), and returns its result, i.e. whether there is a solution. If fewer rows are redundant than at the
// start of the motion, makes rows dependent within the constraint violation and calls solve() again.
template <class Solve>
bool solve_with_kept_rows(const Scene& scene, const SceneData& data, MatrixSystem& m, IslandReport& report,
                          Solve&& solve) {
  const bool answered = solve();
  const int depend = m.factor ? m.owner.island.nc - m.factor->rank() : 0;
  if (depend >= m.owner.depended || m.tolerated > 0) return answered;
  m.tolerated = m.within.make_dependent(scene, *data.workspace, m.owner);
  if (m.tolerated == 0) return answered;
  internal::reset(report, m.owner.island);
  return solve();
}

// Solves K x = b at the current state with the first sound factor.
bool solve_at_state(const Scene& scene, const SceneData& data, ThreadWork& thread, MatrixSystem& m,
                    IslandReport& report) {
  m.factor = nullptr;
  if (!internal::joint_space_fits(m.owner)) return false;
  internal::evaluate_at_state(scene, data, m.owner);
  return solve_with_kept_rows(scene, data, m, report,
                              [&] { return internal::solve_by_fallbacks(scene, data, thread.scratch, m, report); });
}

// Whether a diagonal entry of K (inertia or damping) is tiny relative to the cancelling terms of its row, so that
// rounding errors, or the change of J, may spoil the row's unknown. In this rare case error bounds decide the status.
bool in_doubt(const Scene& scene, const MatrixSystem& m) {
  const KktPattern& p = *m.K.pattern;
  double size[2] = {scene.gravity.cwiseAbs().maxCoeff(), 0}, change[2] = {0, 0};  // largest a, f and change of a, f
  const std::vector<double> changed = change_of(m);
  constexpr double kRounding = tolerance::kBoundRounding * std::numeric_limits<double>::epsilon();
  for (int k = 0; k < p.size(); ++k) {
    const int row = p.perm[k] >= p.nv;
    const double own = row ? scene.damping : std::abs(m.K.values[p.K.p[k + 1] - 1]);
    size[row] = std::max(size[row], std::abs(m.v.x[k]));
    if (!(own > 0)) continue;
    if (!row) size[row] = std::max(size[row], std::abs(m.v.b[k]) / own);
    const double more = changed.empty() ? 0 : std::abs(changed[k]) / kRounding;
    change[row] = std::max(change[row], (m.v.scale[k] + more) / own);
  }
  const auto doubtful = [&](int row) {  // also doubtful: infinity relative to infinity
    return !(change[row] <= tolerance::kInDoubt * size[row]) || std::isinf(change[row]);
  };
  return doubtful(0) || doubtful(1);
}

void take_judged_answer(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& m,
                        IslandReport& report) {
  take_answer(scene, data, m, report);
  if (!in_doubt(scene, m)) return;
  thread.spare_report = report;
  m.bound_errors(scene, data, thread.spare_report);
  if (thread.spare_report.status != report.status) std::swap(report, thread.spare_report);
}

}  // namespace

bool MatrixSystem::solve(const Scene& scene, SceneData& data, ThreadWork& thread, IslandReport& report) {
  if (!solve_at_state(scene, data, thread, *this, report)) return false;
  take_judged_answer(scene, data, thread, *this, report);
  return true;
}

bool MatrixSystem::make_current(const Scene& scene, const SceneData& data, ThreadWork& thread) {
  if (state != data.workspace->state) return solve_at_state(scene, data, thread, *this, thread.spare_report);
  if (factor) internal::evaluate_at_state(scene, data, owner);  // restores J, which sparse-bodies may have overwritten
  return factor;
}

namespace {

// Computes the panel of derivatives by the current factor. Returns whether the panel is accurate.
bool differentiate_once(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& m,
                        IslandDerivatives& out) {
  const AtSolution at(scene, data, m.owner.island);
  if (!internal::weighed_right_hand_sides(scene, data, m, out, thread.panel)) return false;
  internal::solve_panel(scene, m, out, thread.panel);
  out.X.bottomRows(out.nc) *= -1;
  if (m.deficient() && out.request.q && out.request.forces) internal::least_norm_forces(scene, data, m, thread.v, out);
  internal::scale_rows(m, out);
  return out.X.size() == 0 || !std::isnan(out.X(0, 0));
}

// Overwrites [a; y] of `work` with K^+ [a; y]. Returns whether the result is accurate.
bool solve_product(const Scene& scene, const SceneData& data, MatrixSystem& m, KktVectors& v, ProductWork& work) {
  const KktPattern& p = *m.K.pattern;
  v.resize(m.K.size());
  internal::gather(scene, data.f_offset, p, m.owner.island, work.a, work.y, v.b.data());
  const auto scale = [&](std::vector<double>& x) {
    for (std::size_t k = 0; k < m.unit.size(); ++k) x[p.iperm[p.nv + static_cast<int>(k)]] *= m.unit[k];
  };
  scale(v.b);
  const bool believed = internal::solve_vector(m, v);
  scale(v.x);
  internal::scatter(scene, data.f_offset, p, m.owner.island, v.x.data(), work.a, work.y);
  return believed;
}

bool jvp_once(const Scene& scene, SceneData& data, KktVectors& v, MatrixSystem& m, const TangentProduct& p) {
  bool believed = true;
  internal::tangent_product(scene, data, m.owner.island, p, [&](ProductWork& work) {
    if (m.deficient() && m.contradiction) believed = internal::add_contradiction(scene, data, m, p.dq, v, work);
    believed = solve_product(scene, data, m, v, work) && believed;
    if (m.deficient()) internal::least_norm_forces(scene, data, m, p.dq, v, work);
  });
  return believed;
}

bool vjp_once(const Scene& scene, SceneData& data, KktVectors& v, MatrixSystem& m, const AdjointProduct& p) {
  bool believed = true;
  internal::adjoint_product(scene, data, m.owner.island, p,
                            [&](ProductWork& work) { believed = solve_product(scene, data, m, v, work); });
  return (!m.deficient() || internal::add_dependent_adjoint(scene, data, m, p, v)) && believed;
}

}  // namespace

bool internal::weighed_right_hand_sides(const Scene& scene, SceneData& data, MatrixSystem& m, IslandDerivatives& out,
                                        PanelWork& work) {
  right_hand_sides(scene, data, m.owner, out);
  scale_rows(m, out);
  return !(m.deficient() && m.contradiction && out.request.q) || add_contradiction(scene, data, m, out, work);
}

namespace {

// Calls answer() and returns its result. If that is false, factorizes by the dense reference solver and tries again.
template <class Answer>
bool else_by_oracle(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& m, Answer&& answer) {
  return answer() || (internal::solve_by_oracle(scene, data, thread, m) && answer());
}

}  // namespace

bool MatrixSystem::differentiate(const Scene& scene, SceneData& data, ThreadWork& thread, IslandDerivatives& out) {
  return else_by_oracle(scene, data, thread, *this,
                        [&] { return differentiate_once(scene, data, thread, *this, out); });
}

bool MatrixSystem::jvp(const Scene& scene, SceneData& data, ThreadWork& thread, const TangentProduct& p) {
  return else_by_oracle(scene, data, thread, *this, [&] { return jvp_once(scene, data, thread.v, *this, p); });
}

bool MatrixSystem::vjp(const Scene& scene, SceneData& data, ThreadWork& thread, const AdjointProduct& p) {
  return else_by_oracle(scene, data, thread, *this, [&] { return vjp_once(scene, data, thread.v, *this, p); });
}

bool MatrixSystem::invert(const Scene& scene, SceneData& data, ThreadWork& thread, ProductWork& work) {
  return factor && solve_product(scene, data, *this, thread.v, work);
}

}  // namespace manycontact
