#include "stability/problem.hpp"

#include <numbers>

#include "manycontact/detail/contact/reference.hpp"
#include "support/dense.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"
#include "support/truth.hpp"

namespace manycontact::test {

namespace {

std::string robot_xml(const std::string& name, const std::string& urdf, bool floating, const std::string& more = "") {
  return "<robot name=\"" + name + "\" urdf=\"" + urdf + ".urdf\" base=\"" + (floating ? "floating" : "fixed") + "\"" +
         more + "/>";
}

Problem from_xml(const std::string& robots) {
  SceneFile file = load_text("<scene>" + robots + "</scene>");
  std::mt19937 rng(5);
  disturb(file, rng, 0.3);
  file.v.setZero();
  Problem p;
  p.scene = file.scene, p.q = file.q, p.v = file.v, p.u = file.u;
  return p;
}

Inertia<double> rod(double length) {
  const Vec3<double> c(0, 0, -length / 2);
  const double Ic = length * length / 12;
  return Inertia<double>::from_com(1, c, Vec3<double>(Ic + 1e-3, Ic + 1e-3, 1e-3).asDiagonal());
}

Problem one_model(Model model) {
  finalize(model);
  Problem p;
  auto shared = std::make_shared<Model>(std::move(model));
  add_robot(p.scene, "r", shared);
  p.q = neutral(*shared);
  p.v.setZero(p.scene.nv);
  p.u.setZero(p.scene.nu);
  return p;
}

}  // namespace

Problem robot(const std::string& urdf, bool floating) { return from_xml(robot_xml("r", urdf, floating)); }

Problem two_robots(const std::string& urdf_a, bool floating_a, const std::string& urdf_b) {
  return from_xml(robot_xml("a", urdf_a, floating_a) + robot_xml("b", urdf_b, true, " xyz=\"1 0 0.2\""));
}

Problem chain(int n, bool floating) {
  constexpr double kLength = 0.3;
  Model model;
  model.name = "chain";
  model.floating_base = floating;
  for (int i = 0; i < n; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = i - 1;
    joint.inertia = rod(kLength);
    if (i == 0 && floating) {
      joint.type = JointType::kFloating;
    } else {
      joint.axis = Vec3<double>::Unit(i % 2 ? 0 : 1);
      if (i > 0) joint.placement.p = Vec3<double>(0, 0, -kLength);
    }
    Frame& frame = model.frames.emplace_back();
    frame.name = "link" + std::to_string(i);
    frame.joint = i;
    model.joints.push_back(std::move(joint));
  }
  Frame& tip = model.frames.emplace_back();
  tip.name = "tip";
  tip.joint = n - 1;
  tip.placement.p = Vec3<double>(0, 0, -kLength);
  Problem p = one_model(std::move(model));
  for (int k = 0; k < p.scene.nu; ++k) p.q[p.scene.nq - p.scene.nu + k] = 0.2 + 0.1 * std::sin(3.0 * k);
  return p;
}

Problem planar_chain(int n) {
  Model model;
  for (int i = 0; i < n; ++i) {
    Joint joint;
    joint.name = "joint" + std::to_string(i);
    joint.parent = i - 1;
    joint.inertia = rod(1);
    if (i > 0) joint.placement.p = Vec3<double>(1, 0, 0);
    model.joints.push_back(std::move(joint));
    Frame& frame = model.frames.emplace_back();
    frame.name = "link" + std::to_string(i);
    frame.joint = i;
  }
  Frame& tip = model.frames.emplace_back();
  tip.name = "tip";
  tip.joint = n - 1;
  tip.placement.p = Vec3<double>(1, 0, 0);
  Problem p = one_model(std::move(model));
  for (int i = 0; i < n; ++i) p.q[i] = 2 * std::numbers::pi / (n + 1) * (i > 0) + 0.1;
  for (int i = 0; i < n; ++i) p.u[i] = 1 + i;
  return p;
}

namespace {

Contact& add(Problem& p, Contact c) {
  c.name = "contact" + std::to_string(p.scene.contacts.size());
  c.axis = Vec3<double>(0.1, -0.2, 1);
  resolve_reference(p.scene, p.q, true, true, c);
  add_contact(p.scene, std::move(c));
  return p.scene.contacts.back();
}

}  // namespace

Contact& hold(Problem& p, ContactType type, const std::string& frame, const Vec3<double>& offset, ReferenceFrame axes,
              const std::string& robot) {
  Contact c;
  c.type = type;
  c.reference_frame = axes;
  c.A = attach(p.scene, robot, frame, {Mat3<double>::Identity(), offset});
  return add(p, std::move(c));
}

Contact& tie(Problem& p, ContactType type, const std::string& robot_a, const std::string& frame_a,
             const std::string& robot_b, const std::string& frame_b, const Vec3<double>& offset, ReferenceFrame axes) {
  Contact c;
  c.type = type;
  c.reference_frame = axes;
  c.A = attach(p.scene, robot_a, frame_a, {Mat3<double>::Identity(), offset});
  c.B = attach(p.scene, robot_b, frame_b);
  return add(p, std::move(c));
}

void move(Problem& p, double size) {
  std::mt19937 rng(9);
  p.v = random_vector(p.scene.nv, rng, size);
}

Problem turned(Problem p) {
  const std::vector<char> all(p.scene.contacts.size(), 1);
  const Truth<Quad> truth = solve_truth<Quad>(p.scene, all, p.q.cast<Quad>(), p.v.cast<Quad>(), p.u.cast<Quad>());
  p.known = {truth.a, truth.f, Eigen::VectorXd::Ones(truth.a.size()), Eigen::VectorXd::Ones(truth.f.size())};
  p.only_known = true;
  std::mt19937 rng(15);
  const SE3<double> turn{random_rotation(rng), Vec3<double>(0.3, -0.2, 0.5)};
  p.scene.gravity = turn.R * p.scene.gravity;
  for (Robot& r : p.scene.robots) r.base = turn * r.base;
  for (Contact& c : p.scene.contacts) c.B.placement = turn * c.B.placement;
  return p;
}

void move_within_contacts(Problem& p, double size) {
  move(p, size);
  const Eigen::MatrixXd J = contact_jacobian(p.scene, p.q);
  p.v -= least_norm(J, J * p.v, 1e-9);
}

void bend(Problem& p, const std::string& joint, double angle) {
  const Robot& robot = p.scene.robots[0];
  const int j = robot.model->find_joint(joint);
  if (j < 0) throw std::logic_error("no joint " + joint);
  p.q[robot.idx_q + robot.model->joints[j].idx_q] = angle;
}

void edit(Problem& p, const std::function<void(Model&)>& change, int robot) {
  auto model = std::make_shared<Model>(*p.scene.robots[robot].model);
  change(*model);
  p.scene.robots[robot].model = std::move(model);
}

void scale(Inertia<double>& Y, double factor) { Y.m *= factor, Y.h *= factor, Y.I *= factor; }

}  // namespace manycontact::test
