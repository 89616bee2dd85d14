// Who is accelerated how much, and by which contact forces.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "describe.hpp"
#include "solve.hpp"
#include "table.hpp"

namespace manycontact::cli {

namespace {

constexpr std::size_t kMostRobots = 12, kMostContacts = 24, kMostTorques = 8;

// Positions of the `most` largest values in their old order, all when there are not more; NaN counts as largest.
std::vector<std::size_t> largest_of(const std::vector<double>& values, std::size_t most) {
  std::vector<std::size_t> at(values.size());
  std::iota(at.begin(), at.end(), 0);
  const auto size = [&](std::size_t i) { return std::isnan(values[i]) ? INFINITY : values[i]; };
  if (at.size() > most) {
    std::stable_sort(at.begin(), at.end(), [&](std::size_t i, std::size_t j) { return size(i) > size(j); });
    at.resize(most);
    std::sort(at.begin(), at.end());
  }
  return at;
}

void print_rest(std::ostream& out, std::size_t all, std::size_t shown) {
  if (shown < all) out << "  ... and " << all - shown << " more, none larger\n";
}

// The velocity coordinate of the largest joint acceleration (absolute value), -1 when there is none.
int fastest_joint(const Model& model, const Eigen::Ref<const Eigen::VectorXd>& a) {
  int best = -1;
  for (int i = model.first_actuated(); i < model.nv; ++i)
    if (best < 0 || !(std::abs(a[i]) <= std::abs(a[best]))) best = i;
  return best;
}

// Force and moment on A in the contact's axes.
Vec6<double> force_in_axes(const Contact& contact, const Eigen::VectorXd& f, int offset) {
  Vec6<double> w = Vec6<double>::Zero();
  switch (contact.type) {
    case ContactType::k1D: w.head<3>() = f[offset] * contact.axis; break;
    case ContactType::k2D: w[0] = f[offset], w[2] = f[offset + 1]; break;
    case ContactType::k3D: w.head<3>() = f.segment<3>(offset); break;
    case ContactType::k6D: w = f.segment<6>(offset); break;
  }
  return w;
}

// Force on A in the world's axes.
Vec3<double> force_in_world(const Solution& s, int c) {
  const Contact& contact = s.file.scene.contacts[c];
  const Vec3<double> f = force_in_axes(contact, s.data.f, s.data.f_offset[c]).head<3>();
  return contact.reference_frame == ReferenceFrame::kLocal ? Vec3<double>(s.data.contacts[c].aMA.R * f) : f;
}

std::vector<int> active_contacts(const Solution& s) {
  std::vector<int> active;
  for (std::size_t c = 0; c < s.data.f_offset.size(); ++c)
    if (s.data.f_offset[c] >= 0) active.push_back(static_cast<int>(c));
  return active;
}

// Per robot the force of all its contacts, in the world's axes; the last one is what the world gives.
std::vector<Vec3<double>> contact_force_on(const Solution& s) {
  const Scene& scene = s.file.scene;
  std::vector<Vec3<double>> total(scene.robots.size() + 1, Vec3<double>::Zero());
  for (int c : active_contacts(s)) {
    const Vec3<double> f = force_in_world(s, c);
    const Contact& contact = scene.contacts[c];
    total[contact.A.robot] += f;
    if (contact.B.robot >= 0)
      total[contact.B.robot] -= f;
    else
      total.back() += f;
  }
  return total;
}

std::string triple(const Vec3<double>& x) { return decimal(x[0]) + "  " + decimal(x[1]) + "  " + decimal(x[2]); }

}  // namespace

void print_accelerations(std::ostream& out, const Solution& s) {
  const Scene& scene = s.file.scene;
  std::vector<double> size;
  for (const Robot& r : scene.robots) {
    const auto a = s.data.a.segment(r.idx_v, r.model->nv);
    size.push_back(a.hasNaN() ? NAN : r.model->nv == 0 ? 0 : a.cwiseAbs().maxCoeff());
  }
  const std::vector<Vec3<double>> force = contact_force_on(s);
  Table table({{"robot", Table::kLeft, 24}, {"base linear"}, {"base angular"}, {"joints, largest"},
               {"at", Table::kLeft, 24}, {"contact force"}});
  const std::vector<std::size_t> shown = largest_of(size, kMostRobots);
  for (std::size_t i : shown) {
    const Robot& robot = scene.robots[i];
    const Model& model = *robot.model;
    const auto a = s.data.a.segment(robot.idx_v, model.nv);
    const int k = fastest_joint(model, a);
    const bool floats = model.floating_base;
    table.add({robot.name, floats ? number(a.head<3>().norm(), 4) : "", floats ? number(a.segment<3>(3).norm(), 4) : "",
               k < 0 ? "" : number(a[k], 4), k < 0 ? "" : dof_name(model, k), decimal(force[i].norm())});
  }
  out << "\nAccelerations [m/s^2, rad/s^2] and all contact forces on each robot [N]\n";
  table.print(out);
  print_rest(out, size.size(), shown.size());
}

void print_forces(std::ostream& out, const Solution& s) {
  const Scene& scene = s.file.scene;
  const std::vector<int> active = active_contacts(s);
  if (active.empty()) return;
  std::vector<double> size;
  for (int c : active) size.push_back(s.data.f.segment(s.data.f_offset[c], scene.contacts[c].rows()).norm());
  Table table({{"contact", Table::kLeft, 24}, {"type", Table::kLeft}, {"axes", Table::kLeft}, {"fx"}, {"fy"}, {"fz"},
               {"mx"}, {"my"}, {"mz"}});
  const std::vector<std::size_t> shown = largest_of(size, kMostContacts);
  for (std::size_t i : shown) {
    const Contact& contact = scene.contacts[active[i]];
    const Vec6<double> w = force_in_axes(contact, s.data.f, s.data.f_offset[active[i]]);
    std::vector<std::string> cells{contact.name, to_string(contact.type),
                                   contact.reference_frame == ReferenceFrame::kLocal ? "local" : "world"};
    for (int k = 0; k < (contact.type == ContactType::k6D ? 6 : 3); ++k) cells.push_back(decimal(w[k]));
    table.add(cells);
  }
  out << "\nContact forces on frame A [N, N m], in its own axes (local) or the world's\n";
  table.print(out);
  print_rest(out, active.size(), shown.size());
  double mass = 0;
  for (const Robot& robot : scene.robots) mass += robot.model->floating_base ? robot.model->mass() : 0;
  wrap(out, triple(contact_force_on(s).back()) + " N from the world", 2, "total: ");
  if (mass > 0) wrap(out, triple(mass * scene.gravity) + " N is the weight of all floating robots", 2, "       ");
}

void print_quasi_static(std::ostream& out, const Solution& s) {
  const Scene& scene = s.file.scene;
  std::vector<double> size;
  std::vector<std::string> names;
  for (const Robot& robot : scene.robots)
    for (int k = 0; k < robot.model->nu(); ++k) {
      names.push_back(robot.name + "/" + dof_name(*robot.model, robot.model->first_actuated() + k));
      size.push_back(std::abs((*s.quasi_static_u)[robot.idx_u + k]));
    }
  out << "\nQuasi-static torques, which hold the scene still [N m, N]\n";
  Table table({{"joint", Table::kLeft, 48}, {"torque"}});
  const std::vector<std::size_t> shown = largest_of(size, kMostTorques);
  for (std::size_t i : shown) table.add({names[i], decimal((*s.quasi_static_u)[static_cast<Eigen::Index>(i)], 3)});
  if (table.empty()) out << "  no joint is actuated\n";
  table.print(out);
  print_rest(out, size.size(), shown.size());
}

}  // namespace manycontact::cli
