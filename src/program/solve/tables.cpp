#include <algorithm>
#include <cmath>

#include "../text/describe.hpp"
#include "../text/lines.hpp"
#include "manycontact/algorithm/rigid_body.hpp"
#include "manycontact/analysis/rounding.hpp"
#include "manycontact/contact/normal.hpp"
#include "solve.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostRobots = 12, kMostContacts = 24, kMostTorques = 8;

// Returns the velocity coordinate with the largest absolute joint acceleration, or -1 if there are no joints.
int fastest_joint(const Model& model, const ConstVectorRef& a) {
  int best = -1;
  for (int i = model.first_actuated(); i < model.nv; ++i)
    if (best < 0 || !(std::abs(a[i]) <= std::abs(a[best]))) best = i;
  return best;
}

// Returns the force and the moment on A in the contact's axes.
Vec6<double> force_in_axes(const Contact& contact, const Eigen::VectorXd& f, int offset) {
  Vec6<double> w = Vec6<double>::Zero();
  w.head<3>() = linear_force(contact, f.data() + offset);
  if (contact.type == ContactType::k5D) w.tail<3>() = across(contact.axis).transpose() * f.segment<2>(offset + 3);
  if (contact.type == ContactType::k6D) w.tail<3>() = f.segment<3>(offset + 3);
  return w;
}

// Returns for each component of a contact's force whether it depends on rows that are not unique.
std::vector<bool> shared_in_axes(const SolvedScene& s, int c) {
  const Contact& contact = s.file.scene.contacts[c];
  const int first = s.data.f_offset[c];
  std::vector<bool> shared(6);
  for (int k = 0; k < contact.rows(); ++k) {
    if (s.unique.empty() || s.unique[first + k]) continue;
    const Vec6<double> w = force_in_axes(contact, Eigen::VectorXd::Unit(contact.rows(), k), 0);
    for (int i = 0; i < 6; ++i) shared[i] = shared[i] || w[i] != 0;
  }
  return shared;
}

std::vector<int> active_contacts(const SolvedScene& s) {
  std::vector<int> active;
  for (std::size_t c = 0; c < s.data.f_offset.size(); ++c)
    if (s.data.f_offset[c] >= 0) active.push_back(static_cast<int>(c));
  return active;
}

// Returns for each robot the sum of the contact forces on it, in world axes. The last entry is the sum of the forces
// that the world exerts on all robots.
std::vector<Vec3<double>> contact_force_on(const SolvedScene& s) {
  const Scene& scene = s.file.scene;
  const RigidBodies bodies(scene);
  RigidBodyData at(bodies);
  forward_kinematics(bodies, s.file.q, at);
  std::vector<Vec3<double>> total(scene.robots.size() + 1, Vec3<double>::Zero());
  for (int c : active_contacts(s)) {
    const Contact& contact = scene.contacts[c];
    Vec3<double> f = force_in_axes(contact, s.data.f, s.data.f_offset[c]).head<3>();
    if (contact.reference_frame == ReferenceFrame::kLocal) f = frame_placement(bodies, at, contact.A).R * f;
    total[contact.A.robot] += f;
    if (contact.B.robot >= 0)
      total[contact.B.robot] -= f;
    else
      total.back() += f;
  }
  return total;
}

// Prints the sum of the forces from the world, and the weight that they support.
void print_total(std::ostream& out, const SolvedScene& s) {
  double mass = 0;
  for (const Robot& robot : s.file.scene.robots) mass += robot.model->floating_base ? robot.model->mass() : 0;
  Table table("<|||");
  const auto row = [&table](const std::string& what, const Vec3<double>& f) {
    table.add({what, decimal(f[0]), decimal(f[1]), decimal(f[2])});
  };
  row("all forces from the world, world axes [N]", contact_force_on(s).back());
  if (mass > 0) row("weight of the floating robots", mass * s.file.scene.gravity);
  table.print(out);
}

bool nothing_accelerates(const Report& report) {
  if (report.status == Status::kInconsistent)
    return false;  // accelerations of inconsistent islands are never rounding errors
  return std::ranges::all_of(report.islands,
                             [](const IslandReport& r) { return r.nv == 0 || find_rounding(r).acceleration; });
}

}  // namespace

void print_accelerations(std::ostream& out, const SolvedScene& s) {
  const Scene& scene = s.file.scene;
  const std::vector<Vec3<double>> force = contact_force_on(s);
  Lines lines;
  for (std::size_t i = 0; i < scene.robots.size(); ++i) {
    const Robot& robot = scene.robots[i];
    const Model& model = *robot.model;
    const auto a = s.data.a.segment(robot.idx_v, model.nv);
    const double size = a.hasNaN() ? NAN : model.nv == 0 ? 0 : a.cwiseAbs().maxCoeff();
    const int k = fastest_joint(model, a);
    const bool floats = model.floating_base;
    add_line(lines, s.file.robot_group[i], robot.name,
             {floats ? number(a.head<3>().norm()) : "", floats ? number(a.segment<3>(3).norm()) : "",
              k < 0 ? "" : number(a[k]), k < 0 ? "" : dof_name(model, k), decimal(force[i].norm())},
             size);
  }
  out << "\nAccelerations [m/s^2, rad/s^2] and the sum of the contact forces on each robot [N]\n";
  print_lines(out, Table("robot<24|base linear|base angular|joints, largest|at<22|force"), lines, kMostRobots);
  if (nothing_accelerates(s.data.report)) out << "  all accelerations are rounding errors\n";
}

void print_forces(std::ostream& out, const SolvedScene& s) {
  const Scene& scene = s.file.scene;
  const std::vector<int> group = group_of_contacts(s.file);
  const bool any_shared = std::ranges::find(s.unique, 0) != s.unique.end();
  Lines lines;
  for (int c : active_contacts(s)) {
    const Contact& contact = scene.contacts[c];
    const Vec6<double> w = force_in_axes(contact, s.data.f, s.data.f_offset[c]);
    std::vector<std::string> cells{to_string(contact.type),
                                   contact.reference_frame == ReferenceFrame::kLocal ? "local" : "world"};
    const std::vector<bool> shared = shared_in_axes(s, c);
    for (int i = 0; i < (holds_turning(contact.type) ? 6 : 3); ++i)
      cells.push_back(decimal(w[i]) + (!any_shared ? "" : shared[i] ? "*" : " "));
    add_line(lines, group[c], contact.name, cells, s.data.f.segment(s.data.f_offset[c], contact.rows()).norm());
  }
  if (lines.empty()) return;
  for (Line& line : lines) line.cells.resize(8);
  out << "\nContact forces on frame A [N, N m], in the axes of A (local) or of the world (world)\n";
  print_lines(out, Table("contact<24|type<|axes<|fx|fy|fz|mx|my|mz"), lines, kMostContacts);
  if (any_shared)
    wrap(
        out,
        "these forces are not unique: other forces cause the same accelerations. The forces shown have the least norm, "
        "with a newton metre weighted as " +
            (s.file.scene.moment_length == 1 ? "a newton" : number(1 / s.file.scene.moment_length) + " newtons") +
            "; forces without a mark are unique",
        2, "* ");
  print_total(out, s);
}

void print_quasi_static(std::ostream& out, const SolvedScene& s) {
  const Scene& scene = s.file.scene;
  Lines lines;
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) {
      const double torque = (*s.quasi_static_u)[robot.idx_u + k];
      add_line(lines, 0, robot.name + "/" + dof_name(*robot.model, robot.model->actuated[k]), {decimal(torque, 3)},
               std::abs(torque));
    }
  out << "\nQuasi-static torques, which " << (s.unbalanced.empty() ? "keep" : "do not keep")
      << " the scene at rest [N m, N]\n";
  if (lines.empty()) out << "  no joint is actuated\n";
  print_lines(out, Table("joint<60|torque"), lines, kMostTorques);
}

}  // namespace manycontact::cli
