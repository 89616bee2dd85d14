#pragma once
// The constraints of a node as rows c = [g; h] with bounds lo <= c <= hi. P is the projection onto [lo, hi].

#include <algorithm>

#include "manycontact/control/solver.hpp"

namespace manycontact::internal {

/// The constraint rows of a terminal node, evaluated by calc(data, x), or of a running node, by calc(data, x, u).
class ConstraintRows {
 public:
  ConstraintRows(const ActionModelAbstract& model, bool terminal)
      : ng_(terminal ? model.get_ng_T() : model.get_ng()),
        nh_(terminal ? model.get_nh_T() : model.get_nh()),
        lo_(terminal ? model.get_g_lb_T() : model.get_g_lb()),
        hi_(terminal ? model.get_g_ub_T() : model.get_g_ub()) {}

  Eigen::Index size() const { return ng_ + nh_; }
  Eigen::Index inequalities() const { return ng_; }
  double value(const ActionDataAbstract& d, Eigen::Index i) const { return i < ng_ ? d.g[i] : d.h[i - ng_]; }
  double lower(Eigen::Index i) const { return i < ng_ ? lo_[i] : 0; }
  double upper(Eigen::Index i) const { return i < ng_ ? hi_[i] : 0; }
  auto x_row(const ActionDataAbstract& d, Eigen::Index i) const { return i < ng_ ? d.Gx.row(i) : d.Hx.row(i - ng_); }
  auto u_row(const ActionDataAbstract& d, Eigen::Index i) const { return i < ng_ ? d.Gu.row(i) : d.Hu.row(i - ng_); }

  /// Returns the next multiplier y+ = rho (z - P(z)) of row i with value c, where z = c + y / rho, and P clamps z to
  /// the row's bounds. Returns NaN if c is NaN.
  double next_multiplier(const ActionDataAbstract& d, Eigen::Index i, double y, double rho) const {
    const double c = value(d, i);
    return std::max(y + rho * (c - upper(i)), 0.0) + std::min(y + rho * (c - lower(i)), 0.0);
  }
  /// Returns the signed violation c - P(c) of row i with value c, where P clamps c to the row's bounds.
  double violation(const ActionDataAbstract& d, Eigen::Index i) const { return next_multiplier(d, i, 0, 1); }

 private:
  Eigen::Index ng_, nh_;
  const Eigen::VectorXd &lo_, &hi_;
};

inline ConstraintRows rows_at(const ShootingProblem& problem, std::size_t t) {
  return {*problem.model(t), problem.by_state_alone(t)};
}

enum class Rows { kInequalities, kEqualities, kAll };
/// Returns the largest violation (LInf) or the sum of violations (L1) of all evaluated nodes, or NaN if any is NaN.
double infeasibility(const ShootingProblem& problem, Rows which, FeasibilityNorm norm);

}  // namespace manycontact::internal
