#include "manycontact/analysis/place.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "manycontact/algorithm/configuration.hpp"
#include "manycontact/model/expect_state.hpp"
#include "manycontact/model/suggestion.hpp"
#include "place_search.hpp"

namespace manycontact {

Goal pose_goal(const Attachment& frame, const SE3<double>& M, double weight) {
  const Vec3<double> p = M.p;
  return {.name = frame.frame, .weight = weight, .frame = frame, .position = {p[0], p[1], p[2]}, .axes = M.R};
}

Goal pose_goal(const Attachment& frame, const Partial& position, const Partial& rpy, double weight) {
  return {.name = frame.frame, .weight = weight, .frame = frame, .position = position, .rpy = rpy};
}

Goal center_of_mass_goal(const Scene& scene, const Partial& position, const std::string& robot, double weight) {
  return {.target = Goal::Target::kCenterOfMass,
          .name = robot.empty() ? "centre of mass" : "centre of mass of " + robot,
          .weight = weight,
          .position = position,
          .robot = robot.empty() ? -1 : RigidBodies(scene, robot).first()};
}

Goal joint_goal(const Scene& scene, const std::string& joint, double value, double weight) {
  const BodyJoint found = find_joint(scene, joint);
  return {.target = Goal::Target::kJoint,
          .name = joint,
          .weight = weight,
          .robot = found.robot,
          .joint = found.joint,
          .value = value};
}

Goal contact_goal(const Scene& scene, const std::string& contact, double weight) {
  return {
      .target = Goal::Target::kContact, .name = contact, .weight = weight, .contact = contact_called(scene, contact)};
}

bool PlacedScene::met(double error) const {
  for (const GoalLeft& goal : left)
    if (!(goal.position <= error && goal.angle <= error)) return false;
  return true;
}

namespace {

[[noreturn]] void refuse(const Goal& goal, const std::string& what) {
  throw std::invalid_argument("place: goal " + quote(goal.name) + " " + what);
}

void check(const Scene& scene, const Goal& goal) {
  if (!(goal.weight > 0 && std::isfinite(goal.weight)))
    refuse(goal, "has a weight that is not a finite number above 0");
  for (const Partial* numbers : {&goal.position, &goal.rpy})
    for (const auto& x : *numbers)
      if (x && !std::isfinite(*x)) refuse(goal, "has a number that is not finite, finite numbers are expected");
  switch (goal.target) {
    case Goal::Target::kFrame:
      if (goal.frame.robot < 0 || goal.frame.robot >= scene.nrobots() || goal.frame.joint < -1 ||
          goal.frame.joint >= scene.robots[goal.frame.robot].model->njoints())
        refuse(goal, "belongs to no frame on a robot of this scene: make the goal with pose_goal and this scene");
      break;
    case Goal::Target::kCenterOfMass:
      if (goal.robot >= scene.nrobots()) refuse(goal, "belongs to no robot of this scene");
      if (!(total_mass(goal.robot < 0 ? RigidBodies(scene) : RigidBodies(scene, scene.robots[goal.robot].name)) > 0))
        refuse(goal, "belongs to robots without mass, robots with mass are expected");
      break;
    case Goal::Target::kJoint:
      if (goal.robot < 0 || goal.robot >= scene.nrobots() || goal.joint < 0 ||
          goal.joint >= scene.robots[goal.robot].model->njoints())
        refuse(goal, "belongs to no joint of this scene: make the goal with joint_goal and this scene");
      if (scene.robots[goal.robot].model->joints[goal.joint].nq() != 1)
        refuse(
            goal,
            "belongs to a joint with several coordinates: a joint with one coordinate or a frame's pose is expected");
      if (!std::isfinite(goal.value)) refuse(goal, "has a value that is not finite, a finite number is expected");
      break;
    case Goal::Target::kContact:
      if (goal.contact < 0 || goal.contact >= static_cast<int>(scene.contacts.size()))
        refuse(goal, "belongs to no contact of this scene: make the goal with contact_goal and this scene");
      break;
  }
}

// Returns q with random joint positions within limits for the robots that the search moves. Bases remain unchanged.
Eigen::VectorXd elsewhere(const Scene& scene, const internal::PlaceSearch& search, Eigen::VectorXd q,
                          std::mt19937& generator) {
  const Eigen::VectorXd random = random_configuration(scene, generator);
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Robot& robot = scene.robots[r];
    const int base = robot.model->floating_base ? 7 : 0, n = robot.model->nq - base;
    if (search.moves(r)) q.segment(robot.idx_q + base, n) = random.segment(robot.idx_q + base, n);
  }
  return q;
}

}  // namespace

PlacedScene place(const Scene& scene, const ConstVectorRef& q, const std::vector<Goal>& goals,
                  const PlaceOptions& options) {
  expect_configuration("place", "q", q, scene);
  for (const Goal& goal : goals) check(scene, goal);
  if (options.restarts < 0) throw std::invalid_argument("place: restarts is negative, 0 or more searches are expected");
  internal::PlaceSearch search(scene, goals, options);
  std::mt19937 generator(options.seed);
  PlacedScene out;
  double least = std::numeric_limits<double>::infinity();
  for (int start = 0; start <= options.restarts && !search.met(least); ++start) {
    Eigen::VectorXd found = start == 0 ? Eigen::VectorXd(q) : elsewhere(scene, search, q, generator);
    const double left = search.run(found);
    if (start > 0 && !(left < least)) continue;
    least = left;
    out.q = found;
    out.out_of_steps = search.out_of_steps();
  }
  out.iterations = search.tries();
  out.left = search.left(out.q);
  return out;
}

}  // namespace manycontact
