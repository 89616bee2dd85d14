// Integrators are tested for derivatives (numerical differentiation, quadruple precision), order and Hessians.

#include "control/nodes.hpp"
#include "derivatives/differences.hpp"
#include "support/truth.hpp"

namespace manycontact::test {
namespace {

constexpr double kTolerance = 1e-6;  // of central differences

enum class Scheme { kEuler, kTwo, kThree, kFour, kSymplectic };

NodePtr integrated(Scheme scheme, const std::shared_ptr<DifferentialActionModelAbstract>& model, double h,
                   std::shared_ptr<ControlParametrizationModelAbstract> control = nullptr) {
  if (!control) control = std::make_shared<ControlParametrizationModelPolyZero>(model->get_nu());
  if (scheme == Scheme::kEuler) return std::make_shared<IntegratedActionModelEuler>(model, control, h);
  if (scheme == Scheme::kSymplectic) return std::make_shared<IntegratedActionModelSymplectic>(model, control, h);
  const RKType types[] = {two, two, three, four};
  return std::make_shared<IntegratedActionModelRK>(model, control, types[static_cast<int>(scheme)], h);
}

void expect_like_its_twin(const NodePtr& model, const Eigen::VectorXd& x, const Eigen::VectorXd& u) {
  ActionModelNumDiff twin(model, true);
  for (const bool terminal : {false, true}) {
    SCOPED_TRACE(terminal ? "terminal" : "running");
    const NodeDataPtr data = model->createData(), numbers = twin.createData();
    EXPECT_TRUE(model->checkData(data));
    if (terminal) {
      model->calc(data, x), model->calcDiff(data, x);
      twin.calc(numbers, x), twin.calcDiff(numbers, x);
      EXPECT_TRUE(data->xnext == x);
    } else {
      model->calc(data, x, u), model->calcDiff(data, x, u);
      twin.calc(numbers, x, u), twin.calcDiff(numbers, x, u);
      EXPECT_LT(twin_error(data->Fu, numbers->Fu, size_of(data->xnext)), kTolerance);
      EXPECT_LT(twin_error(data->Lu, numbers->Lu, std::abs(data->cost)), kTolerance);
      EXPECT_LT(twin_error(data->Gu, numbers->Gu, size_of(data->g)), kTolerance);
      EXPECT_LT(twin_error(data->Hu, numbers->Hu, size_of(data->h)), kTolerance);
      EXPECT_GT(size_of(data->Fu), 0);
    }
    EXPECT_EQ(data->cost, numbers->cost);
    EXPECT_LT(twin_error(data->Fx, numbers->Fx, size_of(data->xnext)), kTolerance);
    EXPECT_LT(twin_error(data->Lx, numbers->Lx, std::abs(data->cost)), kTolerance);
    EXPECT_LT(twin_error(data->Gx, numbers->Gx, size_of(data->g)), kTolerance);
    EXPECT_LT(twin_error(data->Hx, numbers->Hx, size_of(data->h)), kTolerance);
    EXPECT_EQ(data->g.size(), static_cast<Eigen::Index>(terminal ? model->get_ng_T() : model->get_ng()));
    EXPECT_EQ(data->h.size(), static_cast<Eigen::Index>(terminal ? model->get_nh_T() : model->get_nh()));
    EXPECT_FALSE(data->Fx == numbers->Fx && !terminal);
  }
}

class Integrators : public testing::TestWithParam<std::tuple<int, Scheme>> {
 protected:
  Problem p = problem_with_costs(std::get<0>(GetParam()));
  Scheme scheme = std::get<1>(GetParam());
};

TEST_P(Integrators, AreLikeTheirTwins) { expect_like_its_twin(integrated(scheme, p.model(), 0.02), p.x, p.u); }

TEST_P(Integrators, WithPolynomialControls) {
  if (scheme == Scheme::kEuler || scheme == Scheme::kSymplectic) GTEST_SKIP() << "it looks at one control";
  std::mt19937 rng(5);
  const std::size_t nw = p.actuation->get_nu();
  std::vector<std::shared_ptr<ControlParametrizationModelAbstract>> controls = {
      std::make_shared<ControlParametrizationModelPolyOne>(nw)};
  if (scheme != Scheme::kTwo)
    controls.push_back(
        std::make_shared<ControlParametrizationModelPolyTwoRK>(nw, scheme == Scheme::kThree ? three : four));
  for (const auto& control : controls) {
    const NodePtr model = integrated(scheme, p.model(), 0.02, control);
    EXPECT_EQ(model->get_nu(), control->get_nu());
    expect_like_its_twin(model, p.x, random_vector(static_cast<int>(control->get_nu()), rng));
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Integrators,
                         testing::Combine(testing::Values(40, 41, 42, 43),
                                          testing::Values(Scheme::kEuler, Scheme::kTwo, Scheme::kThree, Scheme::kFour,
                                                          Scheme::kSymplectic)));

// ---- quadruple precision ------------------------------------------------------------------------------------------

VecX<Quad> integrate_scene(const Scene& scene, const VecX<Quad>& q, const VecX<Quad>& dq) {
  VecX<Quad> out(scene.nq);
  for (const Robot& robot : scene.robots) {
    const Model& m = *robot.model;
    VecX<Quad> moved(m.nq);
    integrate<Quad>(m, q.segment(robot.idx_q, m.nq), dq.segment(robot.idx_v, m.nv), moved);
    out.segment(robot.idx_q, m.nq) = moved;
  }
  return out;
}

VecX<Quad> subtract_scene(const Scene& scene, const VecX<Quad>& q0, const VecX<Quad>& q1) {
  VecX<Quad> out(scene.nv);
  for (const Robot& robot : scene.robots) {
    const Model& m = *robot.model;
    VecX<Quad> dq(m.nv);
    difference<Quad>(m, q0.segment(robot.idx_q, m.nq), q1.segment(robot.idx_q, m.nq), dq);
    out.segment(robot.idx_v, m.nv) = dq;
  }
  return out;
}

// One step uses the formulas of euler.hpp and rk.hpp.
QuadState step(const Scene& scene, const std::vector<char>& active, Scheme scheme, double step, const QuadState& x,
               const VecX<Quad>& u) {
  const Quad h = step;
  const auto a = [&](const QuadState& y) { return solve_truth<Quad>(scene, active, y.q, y.v, u).a; };
  if (scheme == Scheme::kEuler) {
    const VecX<Quad> acceleration = a(x);
    return {integrate_scene(scene, x.q, h * x.v + h * h * acceleration), x.v + h * acceleration};
  }
  const Quad third = Quad(1) / 3, half = Quad(1) / 2;
  std::vector<Quad> c, b;
  if (scheme == Scheme::kTwo) c = {0, half}, b = {0, 1};
  if (scheme == Scheme::kThree) c = {0, third, 2 * third}, b = {half / 2, 0, 3 * half / 2};
  if (scheme == Scheme::kFour) c = {0, half, half, 1}, b = {third / 2, third, third, third / 2};
  VecX<Quad> dq = VecX<Quad>::Zero(scene.nv), dv = dq, kq = dq, kv = dq;
  for (std::size_t i = 0; i < c.size(); ++i) {
    const QuadState y = {integrate_scene(scene, x.q, c[i] * h * kq), x.v + c[i] * h * kv};
    kq = y.v;
    kv = a(y);
    dq += b[i] * h * kq;
    dv += b[i] * h * kv;
  }
  return {integrate_scene(scene, x.q, dq), x.v + dv};
}

class InQuadruplePrecision : public testing::TestWithParam<Scheme> {};

// Tests four directions of x, and four of u.
TEST_P(InQuadruplePrecision, DerivativesAreTrue) {
  for (const int seed : {40, 42}) {
    const Problem p = problem_with_costs(seed);
    const double h = 0.01;
    const NodePtr model = integrated(GetParam(), p.model(), h);
    const NodeDataPtr data = model->createData();
    model->calc(data, p.x, p.u);
    model->calcDiff(data, p.x, p.u);
    const auto first = p.model()->createData();  // for its scene
    const Scene& scene = as_fwddyn(first).multibody->scene;
    const std::vector<char> active(scene.contacts.size(), 1);
    const QuadState x = {p.x.head(scene.nq).cast<Quad>(), p.x.tail(scene.nv).cast<Quad>()};
    const QuadState next = step(scene, active, GetParam(), h, x, p.u.cast<Quad>());
    EXPECT_LT(difference_of(data->xnext.head(scene.nq).eval(), next.q), 1e-10);
    EXPECT_LT(difference_of(data->xnext.tail(scene.nv).eval(), next.v), 1e-10 * (1 + size_of(data->xnext)));
    std::mt19937 rng(seed);
    const Quad e = Quad(1) / Quad(10000000000LL);
    for (int k = 0; k < 8; ++k) {
      Eigen::VectorXd dx = random_vector(2 * scene.nv, rng), du = random_vector(scene.nu, rng);
      (k < 4 ? du : dx).setZero();
      const auto moved = [&](const Quad& s) {
        const QuadState from = {integrate_scene(scene, x.q, s * dx.head(scene.nv).cast<Quad>()),
                                x.v + s * dx.tail(scene.nv).cast<Quad>()};
        return step(scene, active, GetParam(), h, from, p.u.cast<Quad>() + s * du.cast<Quad>());
      };
      const QuadState plus = moved(e), minus = moved(-e);
      VecX<Quad> truth(2 * scene.nv);
      truth << (subtract_scene(scene, next.q, plus.q) - subtract_scene(scene, next.q, minus.q)) / (2 * e),
          (plus.v - minus.v) / (2 * e);
      const Eigen::VectorXd mine = data->Fx * dx + data->Fu * du;
      EXPECT_LT(difference_of(mine, truth), 1e-10 * size_of(truth));
      EXPECT_GT(size_of(truth), 0);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Schemes, InQuadruplePrecision,
                         testing::Values(Scheme::kEuler, Scheme::kTwo, Scheme::kThree, Scheme::kFour));

// ---- order and Hessians -------------------------------------------------------------------------------------------

TEST(Integrators, HaveTheirOrder) {
  const Problem p = problem_with_costs(40);
  const auto end = [&](Scheme scheme, int steps) {
    const NodePtr model = integrated(scheme, p.model(), 0.02 / steps);
    const NodeDataPtr data = model->createData();
    Eigen::VectorXd x = p.x;
    for (int k = 0; k < steps; ++k) {
      model->calc(data, x, p.u);
      x = data->xnext;
    }
    return x;
  };
  const Eigen::VectorXd truth = end(Scheme::kFour, 64);
  const std::pair<Scheme, double> orders[] = {{Scheme::kEuler, 1}, {Scheme::kTwo, 2}};
  for (const auto& [scheme, order] : orders) {
    const double coarse = size_of(p.state->diff_dx(truth, end(scheme, 4)));
    const double fine = size_of(p.state->diff_dx(truth, end(scheme, 8)));
    EXPECT_NEAR(std::log2(coarse / fine), order, 0.35);
  }
}

// The dynamics is linear and costs are quadratic, so Gauss-Newton Hessians are exact.
TEST(Integrators, HessiansAreThoseOfQuadraticCosts) {
  const auto lqr = std::make_shared<DifferentialActionModelLQR>(DifferentialActionModelLQR::Random(3, 2));
  std::mt19937 rng(3);
  for (const Scheme scheme : {Scheme::kEuler, Scheme::kTwo, Scheme::kThree, Scheme::kFour})
    for (const bool linear : {false, true}) {
      if (linear && scheme == Scheme::kEuler) continue;
      std::shared_ptr<ControlParametrizationModelAbstract> control;
      if (linear) control = std::make_shared<ControlParametrizationModelPolyOne>(2);
      const NodePtr model = integrated(scheme, lqr, 0.3, control);
      ActionModelNumDiff twin(model);
      const NodeDataPtr data = model->createData(), numbers = twin.createData();
      const Eigen::VectorXd x = random_vector(6, rng), u = random_vector(static_cast<int>(model->get_nu()), rng);
      model->calc(data, x, u), model->calcDiff(data, x, u);
      twin.calc(numbers, x, u), twin.calcDiff(numbers, x, u);
      const double size = size_of(data->Lxx);
      EXPECT_LT(difference_of(data->Lxx, numbers->Lxx), 1e-5 * size);
      EXPECT_LT(difference_of(data->Lxu, numbers->Lxu), 1e-5 * size);
      EXPECT_LT(difference_of(data->Luu, numbers->Luu), 1e-5 * size);
      EXPECT_GT(size_of(data->Lxu), 0);
    }
}

TEST(Integrators, QuasiStaticHoldsTheState) {
  Walker w;
  for (const Scheme scheme : {Scheme::kEuler, Scheme::kFour}) {
    const NodePtr model = integrated(scheme, w.model(), 1e-2);
    const NodeDataPtr data = model->createData();
    const Eigen::VectorXd u = model->quasiStatic_x(data, w.x_rest);
    model->calc(data, w.x_rest, u);
    EXPECT_LT(size_of(w.state->diff_dx(w.x_rest, data->xnext)), 1e-10);
  }
}

TEST(Integrators, RefuseMisuse) {
  Walker w;
  const auto model = w.model();
  EXPECT_THROW(IntegratedActionModelEuler(nullptr, 0.1), std::invalid_argument);
  EXPECT_THROW(IntegratedActionModelEuler(model, -0.1), std::invalid_argument);
  EXPECT_THROW(IntegratedActionModelEuler(model, NAN), std::invalid_argument);
  EXPECT_THROW(IntegratedActionModelEuler(model, std::make_shared<ControlParametrizationModelPolyZero>(w.nu + 1), 0.1),
               std::invalid_argument);
  EXPECT_THROW(ControlParametrizationModelPolyTwoRK(3, two), std::invalid_argument);
  IntegratedActionModelEuler euler(model);
  EXPECT_EQ(euler.get_dt(), 1e-3);
  IntegratedActionModelRK rk(model, four);
  const auto data = euler.createData(), other = rk.createData();
  EXPECT_THROW(euler.calc(other, w.x, w.u), std::invalid_argument);
  EXPECT_THROW(euler.calc(nullptr, w.x, w.u), std::invalid_argument);
  EXPECT_THROW(euler.calc(data, w.x.head(3), w.u), std::invalid_argument);
  EXPECT_THROW(euler.calc(data, w.x, w.u.head(3)), std::invalid_argument);
  EXPECT_FALSE(rk.checkData(data));
  model->set_storage(MatrixStorage::kSparse);
  const auto sparse = euler.createData();
  euler.calc(sparse, w.x, w.u);
  EXPECT_THROW(euler.calcDiff(sparse, w.x, w.u), std::invalid_argument);
}

}  // namespace
}  // namespace manycontact::test
