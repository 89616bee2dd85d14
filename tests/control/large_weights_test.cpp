// The method of multipliers meets the ends of linear motions for any weights of the controls, and proves infeasible
// ones to be so.

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "manycontact/control/augmented_lagrangian.hpp"
#include "manycontact/control/box_solvers.hpp"
#include "manycontact/detail/control/state_vector.hpp"

namespace manycontact::test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A cart of a mass on a rail moves in semi-implicit steps: x = [position, velocity], u its force. `ends`: positions at
// rest, all of which the terminal node requires.
class Cart : public ActionModelAbstract {
 public:
  Cart(double mass, double step, double weight, std::vector<double> ends = {})
      : ActionModelAbstract(std::make_shared<StateVector>(2), 1, 0, 0, 0, 0, 2 * ends.size()),
        weight_(weight),
        ends_(std::move(ends)) {
    A_ << 1, step, 0, 1;
    b_ << step * step / mass, step / mass;
  }
  void calc(const std::shared_ptr<ActionDataAbstract>& d, const ConstVectorRef& x, const ConstVectorRef& u) override {
    d->xnext = A_ * x + b_ * u;
    d->cost = 0.5 * weight_ * u.squaredNorm();
  }
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& d, const ConstVectorRef&, const ConstVectorRef& u) override {
    d->Fx = A_;
    d->Fu = b_;
    d->Lu = weight_ * u;
    d->Luu(0, 0) = weight_;
  }
  void calc(const std::shared_ptr<ActionDataAbstract>& d, const ConstVectorRef& x) override {
    d->cost = 0;
    d->xnext = x;
    d->h.resize(static_cast<Index>(2 * ends_.size()));
    for (std::size_t k = 0; k < ends_.size(); ++k)
      d->h.segment<2>(static_cast<Index>(2 * k)) = x - Eigen::Vector2d(ends_[k], 0);
  }
  void calcDiff(const std::shared_ptr<ActionDataAbstract>& d, const ConstVectorRef&) override {
    d->Hx = MatrixXd::Identity(2, 2).replicate(static_cast<Index>(ends_.size()), 1);
    d->Lx.setZero();
    d->Lxx.setZero();
  }
  void limit(double u) {
    u_lb_ = VectorXd::Constant(1, -u);
    u_ub_ = -u_lb_;
    update_has_control_limits();
  }
  /// Returns the end that T controls lead to from zero, per control.
  MatrixXd reach(int T) const {
    MatrixXd out(2, T);
    VectorXd column = b_;
    for (int t = T - 1; t >= 0; --t, column = A_ * column) out.col(t) = column;
    return out;
  }

 private:
  Eigen::Matrix2d A_;
  Eigen::Vector2d b_;
  double weight_;
  std::vector<double> ends_;
};

struct Ride {
  std::shared_ptr<Cart> running;
  std::shared_ptr<ShootingProblem> problem;
  Ride(int T, double step, double weight, const std::vector<double>& ends, double mass = 1)
      : running(std::make_shared<Cart>(mass, step, weight * step)),
        problem(std::make_shared<ShootingProblem>(Eigen::Vector2d::Zero(),
                                                  ShootingProblem::Models(static_cast<std::size_t>(T), running),
                                                  std::make_shared<Cart>(mass, step, 0, ends))) {}
};

// Sets the solver up as tasks do.
void as_task(SolverAugmentedLagrangian& solver, double step) {
  solver.set_penalty_init(step);
  solver.set_th_constraint(1e-9);
  solver.set_th_kkt(1e-6);
  solver.set_measures_scale(true);
}

// The solution is the controls of least norm.
TEST(LinearEnds, AreMetWhateverControlsWeigh) {
  for (const double step : {0.1, 0.02, 0.005, 0.001})
    for (const double weight : {1e-6, 1e-3, 1., 1e2, 1e4, 1e6})
      for (const int T : {2, 5, 20}) {
        const Ride ride(T, step, weight, {1});
        SolverAugmentedLagrangian solver(ride.problem);
        as_task(solver, step);
        EXPECT_TRUE(solver.solve({}, {}, 300))
            << step << " " << weight << " " << T << ": " << to_string(solver.reason());
        const VectorXd u =
            ride.running->reach(T).completeOrthogonalDecomposition().solve(VectorXd(Eigen::Vector2d(1, 0)));
        const double least = 0.5 * weight * step * u.squaredNorm();
        EXPECT_NEAR(solver.get_cost(), least, 1e-6 * least) << step << " " << weight << " " << T;
        EXPECT_LE(solver.get_violation(), 1e-9) << step << " " << weight << " " << T;
      }
}

TEST(LinearEnds, ThatContradictAreInfeasible) {
  for (const double weight : {1e-4, 1., 1e4, 1e6})
    for (const double step : {0.1, 0.01})
      for (const int T : {3, 10}) {
        const Ride ride(T, step, weight, {1, 1.5});
        SolverAugmentedLagrangian solver(ride.problem);
        as_task(solver, step);
        EXPECT_FALSE(solver.solve({}, {}, 300));
        EXPECT_EQ(solver.reason(), StopReason::kInfeasible)
            << weight << " " << step << " " << T << ": " << to_string(solver.reason());
        EXPECT_NEAR(solver.get_violation(), 0.25, 1e-3) << weight << " " << step << " " << T;
      }
}

TEST(LinearEnds, OutOfReachOfLimitsAreInfeasible) {
  for (const double weight : {1e-4, 1., 1e4}) {
    const Ride ride(10, 0.1, weight, {1});
    ride.running->limit(0.5);
    const auto problem = std::make_shared<ShootingProblem>(Eigen::Vector2d::Zero(), ride.problem->get_runningModels(),
                                                           ride.problem->get_terminalModel());
    SolverAugmentedLagrangian solver(problem);
    as_task(solver, 0.1);
    EXPECT_FALSE(solver.solve({}, {}, 300));
    EXPECT_EQ(solver.reason(), StopReason::kInfeasible) << weight << ": " << to_string(solver.reason());
  }
}

// One node's control costs nothing, as in a phase without costs; steps are 8 ms.
TEST(LinearEnds, AreMetWhereControlsCostNothing) {
  for (const double mass : {0.2, 1.473651548490606, 30.})
    for (const double end : {-2., 3.}) {
      const double step = 0.0082;
      const auto costly = std::make_shared<Cart>(mass, step, 0.05 * step), free = std::make_shared<Cart>(mass, step, 0);
      const auto problem = std::make_shared<ShootingProblem>(
          Eigen::Vector2d::Zero(), ShootingProblem::Models{costly, costly, costly, costly, free},
          std::make_shared<Cart>(mass, step, 0, std::vector<double>{end}));
      SolverAugmentedLagrangian solver(problem);
      as_task(solver, step);
      EXPECT_TRUE(solver.solve({}, {}, 300)) << mass << " " << end << ": " << to_string(solver.reason());
      EXPECT_LE(solver.get_violation(), 1e-9) << mass << " " << end;
    }
}

}  // namespace
}  // namespace manycontact::test
