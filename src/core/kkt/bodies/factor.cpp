#include "manycontact/kkt/bodies/factor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

void BodySolve::resize(const BodyPattern& p) {
  b.resize(p);
  x.resize(p);
  dx.resize(p);
  residual.resize(p);
}

sparse::Refinement solve_refined(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps) {
  backward_sweep(system, ldl, v.b);
  return solve_lifted(system, ldl, v, max_steps);
}

sparse::Refinement solve_lifted(const BodySystem& system, BodyLdl& ldl, BodySolve& v, int max_steps) {
  double error = forward_sweep(system, ldl, v.b, v.x, v.residual);
  return sparse::refine(
      max_steps, tolerance::kRefined, [&] { return error; },
      [&] {
        backward_sweep(system, ldl, v.residual.r);
        error = correct_bodies(system, ldl, v.b, v.dx, v.x, v.residual);
        // Equations may have terms tiny relative to those of others, which backward_error takes into account.
        if (error > tolerance::kRefined) error = backward_error(system, v.b, v.x, v.residual);
      });
}

namespace {

// A column's normwise backward error. Its componentwise error is too large if entries are rounding errors of others.
double normwise(const BodyResidual& r) {
  const double left = std::max(r.dynamics, r.contact);
  return left == 0 ? 0 : left / std::max(r.dynamics_scale, r.contact_scale);
}

}  // namespace

void BodyFactor::make_room() {
  if (has_room_) return;
  system.reset(system.pattern);
  ldl.resize(*system.pattern);
  work_.resize(*system.pattern);
  work_.b.set_zero();
  has_room_ = true;
}

void BodyFactor::solve(double* x) {
  const BodyPattern& p = *system.pattern;
  work_.b.joints = Eigen::Map<const Eigen::VectorXd>(x, p.nv);
  work_.b.rows = Eigen::Map<const Eigen::VectorXd>(x + p.nv, p.nc);
  solve_bodies(system, ldl, work_.b, work_.x);
  Eigen::Map<Eigen::VectorXd>(x, p.nv) = work_.x.joints;
  Eigen::Map<Eigen::VectorXd>(x + p.nv, p.nc) = work_.x.rows;
}

void BodyFactor::solve_panel(double* X, int cols) {
  const BodyPattern& p = *system.pattern;
  for (int c = 0; c < cols; ++c) {
    const auto at = [&](int k) -> double& { return X[static_cast<std::ptrdiff_t>(k) * cols + c]; };
    for (int k = 0; k < p.nv; ++k) work_.b.joints[k] = at(k);
    for (int k = 0; k < p.nc; ++k) work_.b.rows[k] = at(p.nv + k);
    const sparse::Refinement refinement = solve_refined(system, ldl, work_, 1);
    const bool found = std::isfinite(refinement.backward_error) && normwise(work_.residual) <= tolerance::kConverged;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int k = 0; k < p.nv; ++k) at(k) = found ? work_.x.joints[k] : nan;
    for (int k = 0; k < p.nc; ++k) at(p.nv + k) = found ? work_.x.rows[k] : nan;
  }
}

int nonzeros(const BodyPattern& p, const BodyLdl& ldl) {
  double count = 0;  // numbers in P, U, D of each body; in G, H, W of its rows; in L
  for (int i = 0; i < p.nodes; ++i) {
    const double n = p.ndof[i], m = ldl.count[i];
    count += 21 + 6 * n + n * n + m * (12 + n) + m * (m + 1) / 2;
  }
  const double m = static_cast<double>(ldl.base_row.size());
  count += m * (m + 1) / 2;
  return static_cast<int>(std::min(count, static_cast<double>(std::numeric_limits<int>::max())));
}

}  // namespace manycontact
