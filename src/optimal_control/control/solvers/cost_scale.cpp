#include "cost_scale.hpp"

#include <algorithm>
#include <cmath>

#include "manycontact/control/euler.hpp"
#include "manycontact/detail/control/augmented_action.hpp"
#include "manycontact/detail/control/parts.hpp"

namespace manycontact::internal {

namespace {

constexpr double kSmall = 1e-6, kLarge = 1e7;             // scaled: Hessians of controls below kSmall, any above kLarge
constexpr double kUsualControls = 1e-4, kUsualAll = 1e2;  // Hessian of controls, or largest Hessian, when scaled

struct Sizes {  // the largest absolute values on the diagonals of Lxx (all) and Luu (controls)
  double all = 0, controls = 0;
};

template <class Matrix>
double largest_diagonal(const Matrix& H) {
  double out = 0;
  const Eigen::VectorXd diagonal = H.diagonal();
  for (const double h : diagonal) out = std::max(out, std::abs(h));
  return out;
}

void add_node(const ActionDataAbstract& data, Sizes& out) {
  const auto add = [&](const auto& Lxx, const auto& Luu, double factor) {
    if (Luu.rows() > 0) out.controls = std::max(out.controls, factor * largest_diagonal(Luu));
    if (Lxx.rows() > 0) out.all = std::max(out.all, factor * largest_diagonal(Lxx));
  };
  const auto* euler = dynamic_cast<const IntegratedActionDataEuler*>(&data);
  if (const auto* whole = dynamic_cast<const ActionDataParts*>(&data)) {
    for (const auto& part : whole->parts) add_node(*part, out);
  } else if (const auto* augmented = dynamic_cast<const ActionDataAugmentedLagrangian*>(&data)) {
    add_node(*augmented->inner, out);
  } else if (euler && !euler->has_matrices()) {
    const double factor = euler->step > 0 ? euler->step : 1;  // a terminal node has no step
    add(euler->differential->Lxx_sparse(), euler->differential->Luu_sparse(), factor);
  } else {
    add(data.Lxx, data.Luu, 1);
  }
}

}  // namespace

CostScale cost_scale(const ShootingProblem& problem) {
  double controls = 0, all = 0;  // smallest nonzero Hessian of controls of a node, largest Hessian of all nodes
  for (std::size_t t = 0; t <= problem.get_T(); ++t) {
    Sizes own;
    add_node(*problem.data(t), own);
    all = std::max({all, own.all, own.controls});
    if (own.controls > 0) controls = controls > 0 ? std::min(controls, own.controls) : own.controls;
  }
  CostScale out;
  const double gradient = controls > 0 ? std::sqrt(controls * all) : all;
  if (gradient > 0 && std::isfinite(gradient)) out.gradient = gradient;
  double scale = 1;
  if (controls > 0 && controls < kSmall)
    scale = controls / kUsualControls;
  else if (controls == 0 && all > 0 && all < kSmall)
    scale = all / kUsualAll;
  else if (all > kLarge)
    scale = all / kUsualAll;
  if (scale < 1) scale = std::min(std::max(scale, all / kLarge), 1.0);  // ensures that no scaled Hessian exceeds kLarge
  if (std::isfinite(scale) && scale != 1) out.cost = std::exp2(std::round(std::log2(scale)));
  return out;
}

}  // namespace manycontact::internal
