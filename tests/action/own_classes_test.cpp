// Classes that a user derives from the library's: their overrides are called, and overrides that would not be called do
// not compile.

#include <gtest/gtest.h>

#include "manycontact/control.hpp"
#include "problem.hpp"

namespace manycontact::test {
namespace {

using Eigen::VectorXd;

std::shared_ptr<StateMultibody> state_of(int seed) {
  std::mt19937 rng(static_cast<unsigned>(seed));
  SceneOptions options;
  options.nrobots = 1 + seed % 2;
  return std::make_shared<StateMultibody>(random_scene(rng, options).scene);
}

/// 2 u'u + x(-)0 . x(-)0, with Base's constructors.
template <class Base>
struct OwnCost : Base {
  using Base::Base;
  void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x, const ConstVectorRef& u) override {
    const VectorXd dx = this->state_->diff_dx(this->state_->zero(), x);
    data->cost = 2 * u.squaredNorm() + dx.squaredNorm();
  }
  using Base::calc;
  void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef& x,
                const ConstVectorRef& u) override {
    const VectorXd zero = this->state_->zero();
    const Eigen::MatrixXd J = this->state_->Jdiff_Js(zero, x, second)[0];
    data->Lx = 2 * J.transpose() * this->state_->diff_dx(zero, x);
    data->Lxx = 2 * J.transpose() * J;
    data->Lu = 4 * u;
    data->Luu.diagonal().setConstant(4);
  }
  using Base::calcDiff;
};

struct Derivatives {
  double cost;
  VectorXd Lx, Lu;
  Eigen::MatrixXd Lxx, Lxu, Luu;
};

Derivatives evaluate(const std::shared_ptr<CostModelSum>& costs, MatrixStorage storage, const VectorXd& x,
                     const VectorXd& u) {
  const auto state = std::dynamic_pointer_cast<StateMultibody>(costs->get_state());
  DifferentialActionModelFreeFwdDynamics model(state, std::make_shared<ActuationModelFull>(state), costs);
  model.set_storage(storage);
  const auto data = model.createData();
  model.calc(data, x, u);
  model.calcDiff(data, x, u);
  if (has_dense(storage)) return {data->cost, data->Lx, data->Lu, data->Lxx, data->Lxu, data->Luu};
  return {data->cost, data->Lx, data->Lu, data->Lxx_sparse(), data->Lxu_sparse(), data->Luu_sparse()};
}

class OwnCosts : public testing::TestWithParam<int> {};

TEST_P(OwnCosts, AreCalledInEveryStorage) {
  const auto state = state_of(GetParam());
  const std::size_t nu = state->get_nv();
  std::mt19937 rng(7);
  const VectorXd x = state->rand(), u = VectorXd::Random(static_cast<Eigen::Index>(nu));
  const auto residual = std::make_shared<ResidualModelState>(state, nu);
  const std::vector<std::shared_ptr<CostModelAbstract>> costs = {
      std::make_shared<OwnCost<CostModelAbstract>>(state), std::make_shared<OwnCost<CostModelAbstract>>(state, nu),
      std::make_shared<OwnCost<CostModelAbstract>>(state, std::make_shared<ActivationModelQuad>(3), nu),
      std::make_shared<OwnCost<CostModelAbstract>>(state, std::make_shared<ActivationModelQuad>(3)),
      std::make_shared<OwnCost<CostModelAbstract>>(state, residual),
      std::make_shared<OwnCost<CostModelResidual>>(state, residual)};
  const auto reference = std::make_shared<CostModelSum>(state, nu);
  reference->addCost("x", std::make_shared<CostModelResidual>(state, residual), 2 * 0.5);
  reference->addCost("u", std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelControl>(state, nu)),
                     4 * 0.5 + 3);
  for (const auto& own : costs)
    for (const MatrixStorage storage : {MatrixStorage::kBoth, MatrixStorage::kDense, MatrixStorage::kSparse}) {
      const auto sum = std::make_shared<CostModelSum>(state, nu);
      sum->addCost("own", own, 0.5);
      sum->addCost("u", std::make_shared<CostModelResidual>(state, std::make_shared<ResidualModelControl>(state, nu)),
                   3);
      const Derivatives a = evaluate(sum, storage, x, u), b = evaluate(reference, storage, x, u);
      EXPECT_NEAR(a.cost, b.cost, 1e-12 * std::abs(b.cost));
      EXPECT_TRUE(a.Lx.isApprox(b.Lx, 1e-12));
      EXPECT_TRUE(a.Lu.isApprox(b.Lu, 1e-12));
      EXPECT_TRUE(a.Lxx.isApprox(b.Lxx, 1e-12));
      EXPECT_TRUE(a.Lxu.isZero(0));
      EXPECT_TRUE(a.Luu.isApprox(b.Luu, 1e-12));
    }
}
INSTANTIATE_TEST_SUITE_P(Robots, OwnCosts, testing::Range(0, 4));

TEST(OwnCosts, OfWrongSizesAreRefused) {
  struct Wide : OwnCost<CostModelAbstract> {
    using OwnCost::OwnCost;
    void calcDiff(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef&, const ConstVectorRef&) override {
      data->Lu = VectorXd::Zero(99);
    }
  };
  const auto state = state_of(0);
  const auto sum = std::make_shared<CostModelSum>(state);
  sum->addCost("own", std::make_shared<Wide>(state), 1);
  EXPECT_THROW((void)evaluate(sum, MatrixStorage::kBoth, state->zero(), VectorXd::Zero(state->get_nv())),
               std::invalid_argument);
}

TEST(OwnCosts, WithoutCalcDiffSaySo) {
  struct Half : CostModelAbstract {
    using CostModelAbstract::CostModelAbstract;
    void calc(const std::shared_ptr<CostDataAbstract>& data, const ConstVectorRef&, const ConstVectorRef&) override {
      data->cost = 1e6;
    }
  };
  const auto state = state_of(0);
  const auto sum = std::make_shared<CostModelSum>(state);
  sum->addCost("own", std::make_shared<Half>(state), 1);
  EXPECT_THROW((void)evaluate(sum, MatrixStorage::kBoth, state->zero(), VectorXd::Zero(state->get_nv())),
               std::logic_error);
}

TEST(OwnActuations, DerivedFromTheLibrarysAreCalled) {
  struct Half : ActuationModelFull {
    using ActuationModelFull::ActuationModelFull;
    void calc(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef&,
              const ConstVectorRef& u) override {
      data->tau = 0.5 * u;
    }
    void calcDiff(const std::shared_ptr<ActuationDataAbstract>& data, const ConstVectorRef&,
                  const ConstVectorRef&) override {
      data->dtau_du = 0.5 * Eigen::MatrixXd::Identity(data->tau.size(), data->tau.size());
    }
  };
  const auto state = state_of(1);
  const auto costs = std::make_shared<CostModelSum>(state);
  DifferentialActionModelFreeFwdDynamics own(state, std::make_shared<Half>(state), costs),
      full(state, std::make_shared<ActuationModelFull>(state), costs);
  const VectorXd x = state->rand(), u = VectorXd::Random(static_cast<Eigen::Index>(state->get_nv()));
  const auto data = own.createData(), reference = full.createData();
  own.calc(data, x, u);
  own.calcDiff(data, x, u);
  full.calc(reference, x, 0.5 * u);
  full.calcDiff(reference, x, 0.5 * u);
  EXPECT_TRUE(data->xout.isApprox(reference->xout, 1e-12));
  EXPECT_TRUE(data->Fu.isApprox(0.5 * reference->Fu, 1e-12));
  EXPECT_TRUE(data->Fx.isApprox(reference->Fx, 1e-12));
}

TEST(OwnStates, DerivedFromTheLibrarysAreCalled) {
  struct Twice : StateMultibody {
    using StateMultibody::StateMultibody;
    void diff(const ConstVectorRef& x0, const ConstVectorRef& x1, VectorRef dxout) const override {
      StateMultibody::diff(x0, x1, dxout);
      dxout *= 2;
    }
    void Jdiff(const ConstVectorRef& x0, const ConstVectorRef& x1, MatrixRef Jfirst, MatrixRef Jsecond,
               Jcomponent which) const override {
      StateMultibody::Jdiff(x0, x1, Jfirst, Jsecond, which);
      if (which != second) Jfirst *= 2;
      if (which != first) Jsecond *= 2;
    }
  };
  const auto library = state_of(0);
  const auto own = std::make_shared<Twice>(library->get_model());
  const VectorXd x = own->rand();
  const auto jacobian = [&](const std::shared_ptr<StateMultibody>& state) {
    ResidualModelState residual(state);
    DataCollector shared;
    const auto data = residual.createData(&shared);
    residual.calc(data, x, VectorXd::Zero(state->get_nv()));
    residual.calcDiff(data, x, VectorXd::Zero(state->get_nv()));
    return data->whole_Rx();
  };
  EXPECT_TRUE(jacobian(own).isApprox(2 * jacobian(library), 1e-12));
}

TEST(OwnDynamics, AreNoneThatTheSymplecticStepKnows) {
  struct Mine : DifferentialActionModelFreeFwdDynamics {
    using DifferentialActionModelFreeFwdDynamics::DifferentialActionModelFreeFwdDynamics;
  };
  const auto state = state_of(0);
  const auto actuation = std::make_shared<ActuationModelFull>(state);
  const auto costs = std::make_shared<CostModelSum>(state);
  EXPECT_THROW(IntegratedActionModelSymplectic(std::make_shared<Mine>(state, actuation, costs), 1e-3),
               std::invalid_argument);
  EXPECT_NO_THROW(IntegratedActionModelSymplectic(
      std::make_shared<DifferentialActionModelFreeFwdDynamics>(state, actuation, costs), 1e-3));
}

TEST(OwnSolvers, AreCalled) {
  struct Mine : SolverFDDP {
    using SolverFDDP::SolverFDDP;
    double stoppingCriteria() override { return 0; }
    void increaseRegularization() override { ++increased; }
    void decreaseRegularization() override { ++decreased; }
    int increased = 0, decreased = 0;
  };
  const auto wheel = std::make_shared<ActionModelUnicycle>();
  const auto problem = std::make_shared<ShootingProblem>(
      Eigen::Vector3d(-1, -1, 1), std::vector<std::shared_ptr<ActionModelAbstract>>(10, wheel), wheel);
  Mine solver(problem);
  EXPECT_TRUE(solver.solve());
  EXPECT_EQ(solver.get_stop(), 0);
  EXPECT_GT(solver.increased + solver.decreased, 0);
}

// The engine evaluates contacts, impulses and constraints together: a class with its own calc would not be called.
static_assert(std::is_final_v<ContactModel1D> && std::is_final_v<ContactModel2D> && std::is_final_v<ContactModel3D> &&
              std::is_final_v<ContactModel5D> && std::is_final_v<ContactModel6D> &&
              std::is_final_v<ContactModelBetweenBodies> && std::is_final_v<ContactModelOfScene>);
static_assert(std::is_final_v<ImpulseModel3D> && std::is_final_v<ImpulseModel6D> &&
              std::is_final_v<ImpulseModelBetweenBodies> && std::is_final_v<ImpulseModelOfScene>);
static_assert(std::is_final_v<ConstraintModelResidual>);
static_assert(!std::is_constructible_v<ContactModelAbstract, std::shared_ptr<StateMultibody>, Contact, std::size_t>);

}  // namespace
}  // namespace manycontact::test
