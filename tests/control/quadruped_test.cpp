// In a program for Crocoddyl, after a change of namespace and of the state's construction, a quadruped walks and trots.
// Stance feet are contacts of type 3D. A swing foot follows a tent x = L s, z = H min(2 s, 2 - 2 s), s in (0, 1], and
// lands by an impulse, or by a step with a cost on its velocity.

#include <gtest/gtest.h>

#include "manycontact/crocoddyl.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/io/urdf.hpp"

namespace {

using crocoddyl::FrameIndex;
using ActionPtr = std::shared_ptr<crocoddyl::ActionModelAbstract>;
using Eigen::Vector3d;
using Eigen::VectorXd;

VectorXd squares(std::initializer_list<std::pair<int, double>> parts) {
  VectorXd out(0);
  for (const auto& [n, weight] : parts) {
    out.conservativeResize(out.size() + n);
    out.tail(n).setConstant(weight * weight);
  }
  return out;
}

struct Gait {
  double length = 0.2, height = 0.1, step = 1e-2;
  std::size_t swing_knots = 20, stance_knots = 2;
  bool impulses = true;
};

class Quadruped {
 public:
  explicit Quadruped(const Gait& gait) : gait_(gait) {
    state_ = std::make_shared<crocoddyl::StateMultibody>(std::make_shared<crocoddyl::Model>(
        crocoddyl::load_urdf(MANYCONTACT_SOURCE_DIR "/models/quadruped.urdf", {.floating_base = true})));
    actuation_ = std::make_shared<crocoddyl::ActuationModelFloatingBase>(state_);
    nu_ = actuation_->get_nu();
    for (const char* name : {"LF_foot", "RF_foot", "LH_foot", "RH_foot"})
      feet_.push_back(state_->get_pinocchio()->getFrameId(name));
    x0_ = state_->zero();
    for (std::size_t leg = 0; leg < 4; ++leg) x0_.segment<3>(7 + 3 * leg) << 0, 0.7, -1.4;
    x0_[2] -= foot(feet_[0], x0_)[2];  // on the ground
  }

  const VectorXd& x0() const { return x0_; }
  const std::vector<FrameIndex>& feet() const { return feet_; }
  const std::shared_ptr<crocoddyl::StateMultibody>& state() const { return state_; }

  Vector3d foot(FrameIndex id, const VectorXd& x) const {
    const auto& frame = state_->get_pinocchio()->frames[id];
    return frame_placement<double>(kinematics(x), {}, frame.joint, frame.placement).translation();
  }
  Vector3d center_of_mass(const VectorXd& x) const {
    const crocoddyl::Kinematics<double> kin = kinematics(x);
    Vector3d c = Vector3d::Zero();
    double mass = 0;
    for (const auto& body : kin.Y) c += body.m * kin.origin(0) + body.h, mass += body.m;
    return c / mass;
  }

  // Groups of feet (numbers in feet()) swing in turn, the first of each cycle by half the length.
  std::shared_ptr<crocoddyl::ShootingProblem> walk(const std::vector<std::vector<int>>& groups) {
    Vector3d com = center_of_mass(x0_);
    std::vector<Vector3d> at;
    for (FrameIndex id : feet_) at.push_back(foot(id, x0_));
    std::vector<ActionPtr> nodes;
    for (std::size_t k = 0; k < groups.size(); ++k) {
      const double length = 2 * k < groups.size() ? gait_.length / 2 : gait_.length;
      nodes.insert(nodes.end(), gait_.stance_knots, swing({0, 1, 2, 3}, nullptr, {}, {}));
      std::vector<int> stance;
      for (int i = 0; i < 4; ++i)
        if (std::find(groups[k].begin(), groups[k].end(), i) == groups[k].end()) stance.push_back(i);
      const double share = groups[k].size() / 4.0;
      std::vector<Vector3d> goals(groups[k].size());
      for (std::size_t n = 1; n <= gait_.swing_knots; ++n) {
        const double s = static_cast<double>(n) / gait_.swing_knots;
        for (std::size_t i = 0; i < goals.size(); ++i)
          goals[i] = at[groups[k][i]] + Vector3d(length * s, 0, gait_.height * std::min(2 * s, 2 - 2 * s));
        const Vector3d c = com + Vector3d(length * s * share, 0, 0);
        nodes.push_back(swing(stance, &c, groups[k], goals));
      }
      nodes.push_back(gait_.impulses ? impulse({0, 1, 2, 3}, groups[k], goals)
                                     : touch_down({0, 1, 2, 3}, groups[k], goals));
      com[0] += length * share;
      for (std::size_t i = 0; i < goals.size(); ++i) at[groups[k][i]] = goals[i];
    }
    goals_ = at;
    com_goal_ = com;
    return std::make_shared<crocoddyl::ShootingProblem>(x0_, nodes, nodes.back());
  }
  // Goals of the feet and of the centre of mass, at the end.
  const std::vector<Vector3d>& goals() const { return goals_; }
  const Vector3d& com_goal() const { return com_goal_; }

 private:
  crocoddyl::Kinematics<double> kinematics(const VectorXd& x) const {
    const crocoddyl::Model& model = *state_->get_pinocchio()->scene().robots[0].model;
    crocoddyl::Kinematics<double> kin(model);
    crocoddyl::forward_kinematics<double>(model, crocoddyl::SE3<double>{}, x.head(model.nq), kin);
    return kin;
  }
  const std::string& name(int i) const { return state_->get_pinocchio()->frames[feet_[i]].name; }

  std::shared_ptr<crocoddyl::ContactModelMultiple> stance(const std::vector<int>& feet) const {
    auto contacts = std::make_shared<crocoddyl::ContactModelMultiple>(state_, nu_);
    for (int i : feet) {
      std::shared_ptr<crocoddyl::ContactModelAbstract> contact = std::make_shared<crocoddyl::ContactModel3D>(
          state_, feet_[i], Vector3d::Zero(), crocoddyl::LOCAL_WORLD_ALIGNED, nu_, Eigen::Vector2d(0, 50));
      contacts->addContact(name(i) + "_contact", contact);
    }
    return contacts;
  }

  void track(crocoddyl::CostModelSum& costs, const std::vector<int>& feet, const std::vector<Vector3d>& goals,
             double weight) const {
    for (std::size_t i = 0; i < feet.size(); ++i) {
      std::shared_ptr<crocoddyl::CostModelAbstract> cost = std::make_shared<crocoddyl::CostModelResidual>(
          state_,
          std::make_shared<crocoddyl::ResidualModelFrameTranslation>(state_, feet_[feet[i]], goals[i], costs.get_nu()));
      costs.addCost(name(feet[i]) + "_track", cost, weight);
    }
  }

  void regularise(crocoddyl::CostModelSum& costs, const VectorXd& weights, double control) const {
    std::shared_ptr<crocoddyl::ActivationModelAbstract> activation =
        std::make_shared<crocoddyl::ActivationModelWeightedQuad>(weights);
    costs.addCost("state",
                  std::make_shared<crocoddyl::CostModelResidual>(
                      state_, activation, std::make_shared<crocoddyl::ResidualModelState>(state_, x0_, costs.get_nu())),
                  10);
    if (control > 0)
      costs.addCost("control",
                    std::make_shared<crocoddyl::CostModelResidual>(
                        state_, std::make_shared<crocoddyl::ResidualModelControl>(state_, costs.get_nu())),
                    control);
  }

  ActionPtr swing(const std::vector<int>& feet, const Vector3d* com, const std::vector<int>& moving,
                  const std::vector<Vector3d>& goals) const {
    auto costs = std::make_shared<crocoddyl::CostModelSum>(state_, nu_);
    if (com)
      costs->addCost("com",
                     std::make_shared<crocoddyl::CostModelResidual>(
                         state_, std::make_shared<crocoddyl::ResidualModelCoMPosition>(state_, *com, nu_)),
                     1e6);
    track(*costs, moving, goals, 1e6);
    regularise(*costs, squares({{3, 0}, {3, 500}, {12, 0.01}, {6, 10}, {12, 1}}), 1e-1);
    std::shared_ptr<crocoddyl::DifferentialActionModelAbstract> model =
        std::make_shared<crocoddyl::DifferentialActionModelContactFwdDynamics>(state_, actuation_, stance(feet), costs);
    return std::make_shared<crocoddyl::IntegratedActionModelEuler>(model, gait_.step);
  }

  ActionPtr touch_down(const std::vector<int>& feet, const std::vector<int>& landing,
                       const std::vector<Vector3d>& goals) const {
    auto costs = std::make_shared<crocoddyl::CostModelSum>(state_, nu_);
    track(*costs, landing, goals, 1e7);
    for (int i : landing)
      costs->addCost(name(i) + "_rest",
                     std::make_shared<crocoddyl::CostModelResidual>(
                         state_, std::make_shared<crocoddyl::ResidualModelFrameVelocity>(
                                     state_, feet_[i], crocoddyl::Motion::Zero(), crocoddyl::LOCAL, nu_)),
                     1e6);
    regularise(*costs, squares({{3, 0}, {3, 500}, {12, 0.01}, {18, 10}}), 1e-3);
    return std::make_shared<crocoddyl::IntegratedActionModelEuler>(
        std::make_shared<crocoddyl::DifferentialActionModelContactFwdDynamics>(state_, actuation_, stance(feet), costs),
        gait_.step);
  }

  ActionPtr impulse(const std::vector<int>& feet, const std::vector<int>& landing,
                    const std::vector<Vector3d>& goals) const {
    auto impulses = std::make_shared<crocoddyl::ImpulseModelMultiple>(state_);
    for (int i : feet) {
      std::shared_ptr<crocoddyl::ImpulseModelAbstract> one =
          std::make_shared<crocoddyl::ImpulseModel3D>(state_, feet_[i], crocoddyl::LOCAL_WORLD_ALIGNED);
      impulses->addImpulse(name(i) + "_impulse", one);
    }
    auto costs = std::make_shared<crocoddyl::CostModelSum>(state_, 0);
    track(*costs, landing, goals, 1e7);
    regularise(*costs, squares({{6, 1}, {12, 10}, {18, 10}}), 0);
    return std::make_shared<crocoddyl::ActionModelImpulseFwdDynamics>(state_, impulses, costs);
  }

  Gait gait_;
  std::shared_ptr<crocoddyl::StateMultibody> state_;
  std::shared_ptr<crocoddyl::ActuationModelFloatingBase> actuation_;
  std::size_t nu_;
  std::vector<FrameIndex> feet_;
  VectorXd x0_;
  std::vector<Vector3d> goals_;
  Vector3d com_goal_;
};

const std::vector<std::vector<int>> kWalk = {{3}, {1}, {2}, {0}}, kTrot = {{0, 3}, {1, 2}};

template <class Solver>
void expect_converges(Quadruped& robot, const std::vector<std::vector<int>>& groups, std::size_t maxiter,
                      bool bounded = false) {
  const std::shared_ptr<crocoddyl::ShootingProblem> problem = robot.walk(groups);
  if (!bounded)
    for (const ActionPtr& model : problem->get_runningModels()) {
      const double inf = std::numeric_limits<double>::infinity();
      model->set_u_lb(VectorXd::Constant(model->get_nu(), -inf));
      model->set_u_ub(VectorXd::Constant(model->get_nu(), inf));
    }
  Solver solver(problem);
  const auto log = std::make_shared<crocoddyl::CallbackLogger>();
  std::vector<std::shared_ptr<crocoddyl::CallbackAbstract>> callbacks;
  callbacks.push_back(log);
  solver.setCallbacks(callbacks);
  const std::size_t T = solver.get_problem()->get_T();
  std::vector<VectorXd> xs(T, robot.x0());
  std::vector<VectorXd> us = problem->quasiStatic_xs(xs);
  xs.push_back(robot.x0());
  EXPECT_TRUE(solver.solve(xs, us, maxiter, false, 0.1)) << to_string(solver.reason());
  EXPECT_LE(solver.get_iter(), 20u);
  EXPECT_TRUE(solver.get_is_feasible());
  EXPECT_LT(solver.get_cost(), 0.2 * log->costs.front());
  // Feet land at their goals, and the motion is that of its controls.
  const VectorXd& end = solver.get_xs().back();
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_LT((robot.foot(robot.feet()[i], end) - robot.goals()[i]).norm(), 0.01) << i;
  const double asked = robot.com_goal()[0] - robot.center_of_mass(robot.x0())[0];
  EXPECT_GT(asked, 0.1);
  EXPECT_GT(robot.center_of_mass(end)[0] - robot.center_of_mass(robot.x0())[0], 0.8 * asked);
  const std::vector<VectorXd> rolled = problem->rollout_us(solver.get_us());
  EXPECT_LT((rolled[T / 2] - solver.get_xs()[T / 2]).norm(), 1e-6);
  for (std::size_t t = 0; t < T; ++t) {
    const ActionPtr& model = problem->get_runningModels()[t];
    ASSERT_EQ(solver.get_us()[t].size(), static_cast<Eigen::Index>(model->get_nu()));
    if (bounded && model->get_nu() > 0) {
      EXPECT_TRUE((solver.get_us()[t].array() <= model->get_u_ub().array()).all());
      EXPECT_TRUE((solver.get_us()[t].array() >= model->get_u_lb().array()).all());
    }
  }
}

TEST(QuadrupedProgram, Walks) {
  Quadruped robot({});
  expect_converges<crocoddyl::SolverFDDP>(robot, kWalk, 100);
}

TEST(QuadrupedProgram, Trots) {
  Quadruped robot({.length = 0.15, .height = 0.08});
  expect_converges<crocoddyl::SolverFDDP>(robot, kTrot, 100);
}

TEST(QuadrupedProgram, WalksWithoutImpulses) {
  Quadruped robot({.impulses = false});
  expect_converges<crocoddyl::SolverFDDP>(robot, kWalk, 100);
}

TEST(QuadrupedProgram, WalksWithinItsTorques) {
  Quadruped robot({});
  expect_converges<crocoddyl::SolverBoxFDDP>(robot, kWalk, 100, true);
}

}  // namespace
