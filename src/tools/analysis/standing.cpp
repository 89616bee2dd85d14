#include "standing.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/contact/motion_of.hpp"
#include "manycontact/contact/normal.hpp"
#include "manycontact/detail/algorithm/frames.hpp"

namespace manycontact::internal {

namespace {

using Point = Eigen::Vector2d;

double cross(const Point& a, const Point& b) { return a[0] * b[1] - a[1] * b[0]; }

// Returns the convex hull of the points, counterclockwise (Andrew's monotone chain).
std::vector<Point> hull(std::vector<Point> points) {
  const auto before = [](const Point& a, const Point& b) { return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1]; };
  std::vector<Point> out;
  for (int side = 0; side < 2; ++side) {
    const std::size_t first = out.size();
    std::ranges::sort(points, before);
    if (side == 1) std::ranges::reverse(points);
    for (const Point& p : points) {
      while (out.size() > first + 1 && cross(out.back() - out[out.size() - 2], p - out.back()) <= 0) out.pop_back();
      out.push_back(p);
    }
    out.pop_back();  // the last point of this half is the first point of the other half
  }
  if (out.empty()) out.push_back(points.front());
  return out;
}

// Returns the distance of the point c from the convex polygon; 0 if c is inside.
double outside(const Point& c, const std::vector<Point>& polygon) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = polygon.size() > 2;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& a = polygon[i];
    const Point along = polygon[(i + 1) % polygon.size()] - a;
    const double length = along.squaredNorm();
    const double t = length > 0 ? std::clamp((c - a).dot(along) / length, 0.0, 1.0) : 0;
    nearest = std::min(nearest, (a + t * along - c).norm());
    inside = inside && cross(along, c - a) >= 0;
  }
  return inside ? 0 : nearest;
}

struct Ground {        // a robot's contacts with the world, which are the ground unless `told` is false
  bool told = true;    // whether the robot is supported only by contacts with the ground
  bool soles = false;  // whether there is a 6D contact without a box, whose area is unknown
  std::vector<Attachment> feet;
  std::vector<Point> corners;
  double height = 0;  // mean height of the feet
};

void stand_on(const Contact& contact, const SE3<double>& A, Ground& ground) {
  constexpr double kUpright = 0.7;  // least z of a ground contact's normal; contacts with a smaller z are with walls
  const Mat3<double> B = contact.B.placement.R;
  if (contact_normal(contact, A.R, B)[2] < kUpright) ground.told = false;
  ground.feet.push_back(contact.A);
  ground.height += A.p[2];
  const bool has_box = contact.type == ContactType::k6D && !contact.box.isZero(0);
  ground.soles = ground.soles || (contact.type == ContactType::k6D && !has_box);
  const Eigen::Vector2d half = has_box ? Eigen::Vector2d(0.5 * contact.box) : Eigen::Vector2d(Eigen::Vector2d::Zero());
  for (const double x : {-half[0], half[0]})
    for (const double y : {-half[1], half[1]}) ground.corners.push_back((A.p + A.R * Vec3<double>(x, y, 0)).head<2>());
}

std::vector<Ground> grounds(const Scene& scene, const std::vector<bool>& active, const ConstVectorRef& q) {
  std::vector<Ground> out(scene.robots.size());
  MotionOf kin(scene, q);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    const Contact& contact = scene.contacts[c];
    if (!active[c]) continue;
    const int robot = contact.A.robot;
    if (contact.B.robot >= 0) {
      out[robot].told = out[contact.B.robot].told = false;
      continue;
    }
    stand_on(contact,
             frame_placement<double>(kin.of(robot), scene.robots[robot].base, contact.A.joint, contact.A.placement),
             out[robot]);
  }
  for (const Spring& spring : scene.springs)
    for (const int robot : {spring.A.robot, spring.B.robot})
      if (robot >= 0) out[robot].told = false;
  return out;
}

}  // namespace

std::vector<Leaning> leaning(const Scene& scene, const std::vector<bool>& active, const ConstVectorRef& q) {
  constexpr double kSole = 0.13;  // half the length of a human foot, relative to the height of the centre of mass
  std::vector<Leaning> out;
  if (!(scene.gravity[2] < 0 && scene.gravity.head<2>().isZero(0))) return out;
  const std::vector<Ground> on = grounds(scene, active, q);
  for (int r = 0; r < scene.nrobots(); ++r) {
    const Ground& ground = on[r];
    const Robot& robot = scene.robots[r];
    const RigidBodies bodies(scene, robot.name);
    if (!ground.told || ground.feet.empty() || !robot.model->floating_base || !(total_mass(bodies) > 0)) continue;
    RigidBodyData data(bodies);
    forward_kinematics(bodies, q.segment(robot.idx_q, bodies.nq()), data);
    const Vec3<double> c = center_of_mass(bodies, data);
    const double height = c[2] - ground.height / static_cast<double>(ground.feet.size());
    const double by = outside(c.head<2>(), hull(ground.corners));
    if (by > (ground.soles ? kSole * std::abs(height) : 1e-9)) out.push_back({r, by, ground.feet});
  }
  return out;
}

Goal standing_goal(const Scene& scene, const Leaning& robot) {
  Goal goal = center_of_mass_goal(scene, {0.0, 0.0, std::nullopt}, scene.robots[robot.robot].name);
  goal.from = robot.feet;
  return goal;
}

std::vector<Goal> stance_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q) {
  RigidBodyData data(scene);
  forward_kinematics(scene, q, data);
  Vec3<double> middle = Vec3<double>::Zero();
  for (const Attachment& foot : robot.feet)
    middle += frame_placement(scene, data, foot).p / static_cast<double>(robot.feet.size());
  std::vector<Goal> out;
  for (const Attachment& foot : robot.feet) {
    const Vec3<double> p = frame_placement(scene, data, foot).p - middle;
    out.push_back(pose_goal(foot, {p[0], p[1], std::nullopt}));
    out.back().from = robot.feet;
  }
  return out;
}

std::vector<Goal> posture_goals(const Scene& scene, const Leaning& robot, const ConstVectorRef& q, double weight) {
  const Robot& own = scene.robots[robot.robot];
  std::vector<Goal> out;
  for (const Joint& joint : own.model->joints) {
    const int at = own.idx_q + joint.idx_q;
    if (joint.nq() == 1) out.push_back(joint_goal(scene, own.name + "/" + joint.name, q[at], weight));
  }
  RigidBodyData data(scene);
  forward_kinematics(scene, q, data);
  const Attachment base{robot.robot, 0, {}, "base"};
  out.push_back(pose_goal(base, Partial{}, {}, weight));
  out.back().axes = frame_placement(scene, data, base).R;
  return out;
}

}  // namespace manycontact::internal
