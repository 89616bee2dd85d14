#include "manycontact/analysis/place.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "bounded_step.hpp"
#include "goal_rows.hpp"
#include "levenberg_marquardt.hpp"
#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/model/suggestion.hpp"

namespace manycontact {

Goal pose_goal(const Attachment& frame, const SE3<double>& M, double weight) {
  const Vec3<double> p = M.p;
  Goal goal = pose_goal(frame, Partial{p[0], p[1], p[2]}, {}, weight);
  goal.axes = M.R;
  return goal;
}

Goal pose_goal(const Attachment& frame, const Partial& position, const Partial& rpy, double weight) {
  Goal goal;
  goal.name = frame.frame;
  goal.weight = weight;
  goal.frame = frame;
  goal.position = position;
  goal.rpy = rpy;
  return goal;
}

Goal center_of_mass_goal(const Scene& scene, const Partial& position, const std::string& robot, double weight) {
  Goal goal;
  goal.of = Goal::Of::kCenterOfMass;
  goal.name = robot.empty() ? "centre of mass" : "centre of mass of " + robot;
  goal.weight = weight;
  goal.position = position;
  if (!robot.empty()) goal.robot = RigidBodies(scene, robot).first();
  return goal;
}

Goal joint_goal(const Scene& scene, const std::string& joint, double value, double weight) {
  const BodyJoint found = joint_called(scene, joint);
  Goal goal;
  goal.of = Goal::Of::kJoint;
  goal.name = joint;
  goal.weight = weight;
  goal.robot = found.robot;
  goal.joint = found.joint;
  goal.value = value;
  return goal;
}

Goal contact_goal(const Scene& scene, const std::string& contact, double weight) {
  Goal goal;
  goal.of = Goal::Of::kContact;
  goal.name = contact;
  goal.weight = weight;
  goal.contact = contact_called(scene, contact);
  return goal;
}

bool PlacedScene::met(double error) const {
  for (const GoalLeft& goal : left)
    if (!(goal.position <= error && goal.angle <= error)) return false;
  return true;
}

namespace {

constexpr internal::Damping kGoalDamping = {1e-9, 1e-9, 1e4};
constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[noreturn]] void refuse(const Goal& goal, const std::string& what) {
  throw std::invalid_argument("place: goal " + quote(goal.name) + " " + what);
}

void check(const Scene& scene, const Goal& goal) {
  if (!(goal.weight > 0 && std::isfinite(goal.weight))) refuse(goal, "has no finite weight above 0");
  for (const Partial* numbers : {&goal.position, &goal.rpy})
    for (const auto& x : *numbers)
      if (x && !std::isfinite(*x)) refuse(goal, "has a number that is not finite");
  switch (goal.of) {
    case Goal::Of::kFrame:
      if (goal.frame.robot < 0 || goal.frame.robot >= scene.nrobots() || goal.frame.joint < -1 ||
          goal.frame.joint >= scene.robots[goal.frame.robot].model->njoints())
        refuse(goal, "is not of a frame on a robot of this scene");
      break;
    case Goal::Of::kCenterOfMass:
      if (goal.robot >= scene.nrobots()) refuse(goal, "is not of a robot of this scene");
      if (!(total_mass(goal.robot < 0 ? RigidBodies(scene) : RigidBodies(scene, scene.robots[goal.robot].name)) > 0))
        refuse(goal, "is of robots without mass");
      break;
    case Goal::Of::kJoint:
      if (goal.robot < 0 || goal.robot >= scene.nrobots() || goal.joint < 0 ||
          goal.joint >= scene.robots[goal.robot].model->njoints())
        refuse(goal, "is not of a joint of this scene");
      if (scene.robots[goal.robot].model->joints[goal.joint].nq() != 1)
        refuse(goal, "is of a joint with several coordinates, expected one with one, or a frame's pose");
      if (!std::isfinite(goal.value)) refuse(goal, "has a number that is not finite");
      break;
    case Goal::Of::kContact:
      if (goal.contact < 0 || goal.contact >= static_cast<int>(scene.contacts.size()))
        refuse(goal, "is not of a contact of this scene");
      break;
  }
}

// Limits of the coordinates: of q, infinite where there are none; and for steps the coordinate of v that moves it
// alone.
struct Limits {
  explicit Limits(const Scene& scene)
      : lower(Eigen::VectorXd::Constant(scene.nq, -kInfinity)), upper(-lower), moved_by(scene.nq, -1), nv(scene.nv) {
    for (const Robot& robot : scene.robots)
      for (const Joint& joint : robot.model->joints) {
        const int n = joint.nv();
        if (joint.type == JointType::kFloating || joint.lower.size() != n || joint.upper.size() != n) continue;
        for (int k = 0; k < n; ++k) {
          if (!(joint.lower[k] < joint.upper[k])) continue;
          const int at = robot.idx_q + joint.idx_q + k;
          lower[at] = joint.lower[k];
          upper[at] = joint.upper[k];
          if (joint.type != JointType::kPlanar || k == 2) moved_by[at] = robot.idx_v + joint.idx_v + k;
        }
      }
  }
  Eigen::VectorXd within(const Eigen::VectorXd& q) const { return q.cwiseMax(lower).cwiseMin(upper); }
  // Of a step from q.
  void of_step(const Eigen::VectorXd& q, Eigen::VectorXd& low, Eigen::VectorXd& high) const {
    low.setConstant(nv, -kInfinity);
    high.setConstant(nv, kInfinity);
    for (Eigen::Index i = 0; i < q.size(); ++i)
      if (moved_by[i] >= 0) low[moved_by[i]] = lower[i] - q[i], high[moved_by[i]] = upper[i] - q[i];
  }

  Eigen::VectorXd lower, upper;
  std::vector<int> moved_by;
  int nv;
};

}  // namespace

PlacedScene place(const Scene& scene, const Eigen::Ref<const Eigen::VectorXd>& q, const std::vector<Goal>& goals,
                  const PlaceOptions& options) {
  expect_configuration("place", "q", q, scene);
  for (const Goal& goal : goals) check(scene, goal);
  const Limits limits(scene);
  PlacedScene out;
  out.q = limits.within(q);
  internal::GoalRows rows(scene, goals);
  std::optional<internal::BoundedStep> bounded;
  Eigen::SparseMatrix<double> J;
  Eigen::VectorXd of, low, high;  // the q that J and the bounds of a step are of
  out.iterations =
      internal::levenberg_marquardt(
          kGoalDamping, options.iterations, out.q, [&](const Eigen::VectorXd& x) { return rows.errors(x); },
          [&](const Eigen::VectorXd& x, const Eigen::VectorXd& e, double mu, Eigen::VectorXd& dq) {
            if (of.size() != x.size() || of != x) {
              (void)rows.errors(x);
              J = rows.jacobian();
              if (!bounded) bounded.emplace(J);
              limits.of_step(x, low, high);
              of = x;
            }
            bounded->solve(J, e, mu, low, high, dq);
            return dq.allFinite();
          },
          [&](const Eigen::VectorXd& x, const Eigen::VectorXd& dq) { return limits.within(integrate(scene, x, dq)); },
          [&](const Eigen::VectorXd& x, const Eigen::VectorXd& e) {
            return e.size() == 0 || e.cwiseAbs().maxCoeff() <= options.tolerance * (1 + x.cwiseAbs().maxCoeff());
          })
          .tries;
  (void)rows.errors(out.q);
  out.left = rows.left();
  return out;
}

}  // namespace manycontact
