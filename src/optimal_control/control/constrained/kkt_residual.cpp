#include "kkt_residual.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../multi_robot/coordinates.hpp"
#include "constraint_rows.hpp"
#include "manycontact/control/coupled_direction.hpp"
#include "manycontact/detail/control/couplings.hpp"
#include "manycontact/lq/choose.hpp"
#include "quadratic_model.hpp"

namespace manycontact {

namespace {

using Vectors = std::vector<Eigen::VectorXd>;
using internal::ConstraintRows;

struct Largest {  // The largest magnitude of the numbers that were added. It is infinite if a number was not finite.
  double value = 0;
  void add(double number) {
    if (!std::isfinite(number)) value = std::numeric_limits<double>::infinity();
    value = std::max(value, std::abs(number));
  }
  void add(const ConstVectorRef& x) {
    for (const double number : x) add(number);
  }
};

// Returns y^T times column i of the constraints' Jacobian dc/dx or dc/du, whose row k is row(k). Zero if y is null.
template <class Row>
double pull_back(const ConstraintRows& rows, const Eigen::VectorXd* y, Row&& row, Eigen::Index i) {
  double sum = 0;
  for (Eigen::Index k = 0; y && k < rows.size(); ++k)
    if ((*y)[k] != 0) sum += (*y)[k] * row(k)[i];
  return sum;
}

bool is_of_parts(const ShootingProblem& problem) {
  for (std::size_t t = 0; t <= problem.get_T(); ++t) {
    const auto* parts = dynamic_cast<const ActionModelParts*>(problem.model(t).get());
    if (parts && !parts->get_couplings()) return true;
  }
  return false;
}

// Updates the maximum `worst` with the error c - P(c + y / scale) of each constraint row of value c and multiplier y,
// where P projects onto the row's bounds.
void add_constraints(const ConstraintRows& rows, const ActionDataAbstract& d, const Eigen::VectorXd& y, double scale,
                     Largest& worst) {
  check_size("kkt_residual", "multipliers of a node", y.size(), static_cast<std::size_t>(rows.size()));
  for (Eigen::Index k = 0; k < rows.size(); ++k) {
    const double c = rows.value(d, k);
    worst.add(c - std::min(std::max(c + y[k] / scale, rows.lower(k)), rows.upper(k)));
  }
}

// Updates the maximum `worst` with the gradient `slope` with respect to control i, or, with limits, with
// u - P(u - slope), where P projects onto the limits of this control u.
void add_slope(const ActionModelAbstract& model, const Eigen::VectorXd& u, Eigen::Index i, bool limits, double slope,
               Largest& worst) {
  if (limits && model.get_has_control_limits())
    slope = u[i] - std::min(std::max(u[i] - slope, model.get_u_lb()[i]), model.get_u_ub()[i]);
  worst.add(slope);
}

}  // namespace

namespace internal {

namespace {

double kkt_residual_of_part(const ShootingProblem& problem, const Vectors& xs, const Vectors& us, const Vectors& l,
                            bool limits, const Vectors& ys, double scale, Eigen::VectorXd& work) {
  const std::size_t T = problem.get_T();
  const Eigen::Index ndx = static_cast<Eigen::Index>(problem.get_ndx());
  const auto size = static_cast<Eigen::Index>(2 * problem.get_ndx() + problem.get_nu_max());
  if (work.size() < size) work.resize(size);
  const bool coupled = CoupledDirection::applies_to(problem);
  Largest worst;
  const Eigen::VectorXd none;
  Eigen::VectorXd by_x, by_u;
  auto gap = work.head(ndx), gx = work.segment(ndx, ndx);
  problem.get_terminalModel()->get_state()->diff(xs[0], problem.get_x0(), gap);
  worst.add(gap);
  for (std::size_t t = 0; t <= T; ++t) {
    const ActionModelAbstract& model = *problem.model(t);
    ActionDataAbstract& d = *problem.data(t);
    const ConstraintRows rows = rows_at(problem, t);
    const Eigen::VectorXd* y = ys.empty() ? nullptr : &ys[t];
    if (y) add_constraints(rows, d, *y, scale, worst);
    // If coupled, scene_gradient eliminates the wrenches with derivatives of the whole scene's dynamics.
    if (coupled) {
      scene_gradient(static_cast<const ActionModelParts&>(model), static_cast<ActionDataParts&>(d),
                     l[std::min(t + 1, T)], t == T, y ? *y : none, by_x, by_u);
      worst.add((by_x - l[t]) / scale);
      for (Eigen::Index i = 0; t < T && i < by_u.size(); ++i)
        add_slope(model, us[t], i, limits, by_u[i] / scale, worst);
    } else {
      auto gu = work.segment(2 * ndx, t < T ? us[t].size() : 0);
      t < T ? d.pull_back(l[t + 1], gx, gu) : void(gx.setZero());
      for (Eigen::Index i = 0; i < l[t].size(); ++i) {
        const double of_y = pull_back(
            rows, y, [&](Eigen::Index k) { return rows.x_row(d, k); }, i);
        worst.add((d.Lx[i] - l[t][i] + gx[i] + of_y) / scale);
      }
      for (Eigen::Index i = 0; i < gu.size(); ++i) {
        const double of_y = pull_back(
            rows, y, [&](Eigen::Index k) { return rows.u_row(d, k); }, i);
        add_slope(model, us[t], i, limits, (d.Lu[i] + gu[i] + of_y) / scale, worst);
      }
    }
    if (t == T) break;
    model.get_state()->diff(xs[t + 1], d.xnext, gap);
    worst.add(gap);
  }
  return worst.value;
}

}  // namespace

double kkt_residual_of_nodes(const ShootingProblem& problem, const Vectors& xs, const Vectors& us, const Vectors& l,
                             bool limits, const Vectors& ys, double scale, Eigen::VectorXd& work) {
  if (!is_of_parts(problem)) return kkt_residual_of_part(problem, xs, us, l, limits, ys, scale, work);
  const std::vector<ShootingPart> parts = separate(problem);
  std::vector<Vectors> own_ys(parts.size(), Vectors(ys.size()));
  for (std::size_t t = 0; t < ys.size(); ++t) {
    const ConstraintRows all = rows_at(problem, t);
    check_size("kkt_residual", "multipliers of a node", ys[t].size(), static_cast<std::size_t>(all.size()));
    const auto& node = static_cast<const ActionModelParts&>(*problem.model(t));
    const auto rows = constraint_rows(node.get_parts(), problem.by_state_alone(t));
    for (std::size_t i = 0; i < parts.size(); ++i) gather(ys[t], rows[i], own_ys[i][t]);
  }
  double worst = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const ShootingPart& part = parts[i];
    Vectors own_xs(xs.size()), own_us(us.size()), own_l(xs.size());
    for (std::size_t t = 0; t < xs.size(); ++t) {
      gather(xs[t], part.x, own_xs[t]);
      gather(l[t], part.dx, own_l[t]);
      if (t < us.size()) gather(us[t], part.u[t], own_us[t]);
    }
    worst = std::max(worst, kkt_residual_of_part(*part.problem, own_xs, own_us, own_l, limits, own_ys[i], scale, work));
  }
  return worst;
}

namespace {

// Calls use(g_t[i], u_t[i], lower limit, upper limit) for each control i of each node t. The gradient of the total cost
// is g_t = Lu + Fu^T l_(t+1), with the costates l_T = Lx of the terminal node and l_t = Lx + Fx^T l_(t+1).
template <class Use>
void each_slope_of_part(const ShootingProblem& problem, const Vectors& us, bool limits, Use&& use) {
  const std::size_t T = problem.get_T();
  const bool coupled = CoupledDirection::applies_to(problem);
  const Eigen::VectorXd none;
  Eigen::VectorXd l = Eigen::VectorXd::Zero(problem.get_ndx()), gx = l, gu;
  for (std::size_t t = T + 1; t-- > 0;) {
    const ActionModelAbstract& model = *problem.model(t);
    ActionDataAbstract& d = *problem.data(t);
    gu.setZero(t < T ? us[t].size() : 0);
    if (coupled) {
      scene_gradient(static_cast<const ActionModelParts&>(model), static_cast<ActionDataParts&>(d), l, t == T, none, gx,
                     gu);
    } else if (t == T) {
      gx = d.Lx;
    } else {
      d.pull_back(l, gx, gu);
      gx += d.Lx;
      gu += d.Lu;
    }
    const bool limited = limits && model.get_has_control_limits();
    constexpr double kNone = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; t < T && i < gu.size(); ++i)
      use(gu[i], us[t][i], limited ? model.get_u_lb()[i] : -kNone, limited ? model.get_u_ub()[i] : kNone);
    l = gx;
  }
}

template <class Use>
void each_slope(const ShootingProblem& problem, const Vectors& us, bool limits, Use&& use) {
  if (!is_of_parts(problem)) return each_slope_of_part(problem, us, limits, use);
  for (const ShootingPart& part : separate(problem)) {
    Vectors own(us.size());
    for (std::size_t t = 0; t < us.size(); ++t) gather(us[t], part.u[t], own[t]);
    each_slope_of_part(*part.problem, own, limits, use);
  }
}

}  // namespace

double control_gradient_of_nodes(const ShootingProblem& problem, const Vectors& us, bool limits) {
  double sum = 0;
  each_slope(problem, us, limits, [&](double g, double u, double lower, double upper) {
    const bool outwards = g > 0 ? u <= lower : u >= upper;
    if (!outwards) sum += g * g;
  });
  return std::sqrt(sum);
}

double largest_fall_within_limits(const ShootingProblem& problem, const Vectors& us) {
  double sum = 0;
  each_slope(problem, us, true, [&](double g, double u, double lower, double upper) {
    if (g != 0) sum += g * (u - (g > 0 ? lower : upper));
  });
  return sum;
}

}  // namespace internal

double kkt_residual(ShootingProblem& problem, const Vectors& xs, const Vectors& us, const Vectors& l, bool limits,
                    const Vectors& ys, double scale) {
  const std::size_t nodes = problem.get_T() + 1;
  require(l.size() == nodes && (ys.empty() || ys.size() == nodes), "kkt_residual",
          "the number of multipliers is not T + 1");
  require(scale > 0, "kkt_residual", "a positive scale is expected");
  for (const Eigen::VectorXd& l_t : l)
    check_size("kkt_residual", "multipliers of a node", l_t.size(), problem.get_ndx());
  problem.calc(xs, us);
  problem.calcDiff(xs, us);
  Eigen::VectorXd work;
  return internal::kkt_residual_of_nodes(problem, xs, us, l, limits, ys, scale, work);
}

namespace {

// Returns whether control i of u is at a limit. Without `limits`, returns false.
bool stands_at_limit(const ActionModelAbstract& model, const Eigen::VectorXd& u, Eigen::Index i, bool limits) {
  return limits && model.get_has_control_limits() && (u[i] <= model.get_u_lb()[i] || u[i] >= model.get_u_ub()[i]);
}

// Makes the linear-quadratic problem of least_squares_multipliers. Wrenches of couplings are variables with the cost
// Lw^T dw. Controls at a limit are left out, because the limit's multiplier balances their gradient.
lq::Problem problem_of(const ShootingProblem& problem, const Vectors& us, bool limits,
                       const std::vector<ActionPart>& blocks) {
  lq::Problem out = internal::structure_of(problem, blocks);
  internal::fill_nodes(problem, internal::Terms::kWithoutHessians, out);
  for (std::size_t t = 0; t <= us.size(); ++t)
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      lq::Group& group = out.knots[t].groups[i];
      group.Q.setIdentity();
      if (t == us.size()) continue;
      for (std::size_t j = 0; j < blocks[i].u.size(); ++j) {
        const Eigen::Index at = static_cast<Eigen::Index>(j);
        group.R(at, at) = 1;
        if (blocks[i].u[j] >= us[t].size() || !stands_at_limit(*problem.model(t), us[t], blocks[i].u[j], limits))
          continue;
        group.B.col(at).setZero();
        group.D.col(at).setZero();
        group.r[at] = 0;
      }
    }
  return out;
}

// Returns the least-squares multipliers of a subproblem, or NaN if there are none, as for contradictory couplings.
Vectors of_part(const ShootingProblem& problem, const Vectors& us, bool limits) {
  const std::vector<ActionPart> blocks = internal::blocks_of(problem);
  const lq::Problem lq = problem_of(problem, us, limits, blocks);
  const std::unique_ptr<lq::DirectionSolver> solver = lq::choose(lq);
  lq::Point z;
  const bool answered = solver->factorize(lq).status == lq::Status::kOk;
  const lq::Status status = answered ? solver->solve(lq, z).status : lq::Status::kSingular;
  const lq::Layout layout(lq);
  Vectors out(problem.get_T() + 1,
              Eigen::VectorXd::Constant(problem.get_ndx(), std::numeric_limits<double>::quiet_NaN()));
  if (status != lq::Status::kOk && status != lq::Status::kInaccurate) return out;
  for (std::size_t t = 0; t < out.size(); ++t)
    for (std::size_t i = 0; i < blocks.size(); ++i)
      scatter(z.lambda[t].segment(layout.x[i], lq.nx[i]), blocks[i].dx, out[t]);
  return out;
}

}  // namespace

namespace internal {

Vectors least_squares_multipliers_of_nodes(const ShootingProblem& problem, const Vectors& us, bool limits) {
  Vectors out(problem.get_T() + 1, Eigen::VectorXd::Zero(problem.get_ndx()));
  for (const ShootingPart& part : separate(problem)) {
    Vectors own_us(us.size());
    for (std::size_t t = 0; t < us.size(); ++t) gather(us[t], part.u[t], own_us[t]);
    const Vectors own = of_part(*part.problem, own_us, limits);
    for (std::size_t t = 0; t < out.size(); ++t) scatter(own[t], part.dx, out[t]);
  }
  return out;
}

}  // namespace internal

Vectors least_squares_multipliers(ShootingProblem& problem, const Vectors& xs, const Vectors& us, bool limits) {
  problem.calc(xs, us);
  problem.calcDiff(xs, us);
  return internal::least_squares_multipliers_of_nodes(problem, us, limits);
}

}  // namespace manycontact
