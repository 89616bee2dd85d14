#include <algorithm>
#include <cmath>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/contact/motion_of.hpp"
#include "manycontact/contact/normal.hpp"
#include "manycontact/detail/algorithm/frames.hpp"
#include "manycontact/model/expect_state.hpp"

namespace manycontact {

std::string to_string(ViolationKind kind) {
  constexpr const char* kNames[] = {"pulls", "slips", "tips", "turns"};
  return kNames[static_cast<int>(kind)];
}

std::string unit_of(ViolationKind kind) {
  constexpr const char* kUnits[] = {"N", "N", "m", "N m"};
  return kUnits[static_cast<int>(kind)];
}

namespace {

constexpr double kRoundingOfForces = 1e-9;  // rounding error, relative to the largest force and load of the robots

class AxesOf {
 public:
  AxesOf(const Scene& scene, const ConstVectorRef& q) : scene_(scene), kin_(scene, q) {}
  Mat3<double> operator()(const Attachment& at) {
    if (at.robot < 0) return at.placement.R;
    return frame_placement<double>(kin_.of(at.robot), scene_.robots[at.robot].base, at.joint, at.placement).R;
  }

 private:
  const Scene& scene_;
  internal::MotionOf kin_;
};

struct Pressure {  // the normal and tangential force of a contact
  double normal = 0, tangential = 0;
  Vec6<double> in_foot = Vec6<double>::Zero();  // 6D contacts: force and moment in A's axes
};

Pressure pressure(const Contact& contact, const double* f, AxesOf& axes_of) {
  const Mat3<double> oRA = axes_of(contact.A);
  const Mat3<double> axes =
      contact.reference_frame == ReferenceFrame::kLocal ? oRA : Mat3<double>(Mat3<double>::Identity());
  const Vec3<double> n = contact_normal(contact, oRA, contact.normal ? axes_of(contact.B) : Mat3<double>());
  const Vec3<double> force = axes * linear_force(contact, f);
  Pressure out;
  out.normal = n.dot(force);
  out.tangential = (force - out.normal * n).norm();
  if (contact.type == ContactType::k6D)
    out.in_foot << oRA.transpose() * force, oRA.transpose() * (axes * Vec3<double>(f[3], f[4], f[5]));
  return out;
}

// Returns by how much the moment m_z exceeds the friction at the corners of a box with edges 2 X and 2 Y, friction mu
// and normal force n. f is the force, and tau_min <= m_z <= tau_max must hold with
//   tau_min = -mu (X + Y) n + |Y f_x - mu m_x| + |X f_y - mu m_y|
//   tau_max =  mu (X + Y) n - |Y f_x + mu m_x| - |X f_y + mu m_y|
double excess_torque(const double* f, double mu, double X, double Y) {
  const double most = mu * (X + Y) * f[2];
  const double low = -most + std::abs(Y * f[0] - mu * f[3]) + std::abs(X * f[1] - mu * f[4]);
  const double high = most - std::abs(Y * f[0] + mu * f[3]) - std::abs(X * f[1] + mu * f[4]);
  return std::max(low - f[5], f[5] - high);
}

// Returns for each robot the larger of its load and its largest linear contact force, the scale of rounding errors.
std::vector<double> largest_forces(const Scene& scene, const Eigen::VectorXd& f, const std::vector<int>& f_offset,
                                   const Eigen::VectorXd& loads) {
  std::vector<double> largest(loads.begin(), loads.end());
  for (std::size_t c = 0; c < f_offset.size(); ++c) {
    if (f_offset[c] < 0) continue;
    const Contact& contact = scene.contacts[c];
    const double size = f.segment(f_offset[c], std::min(3, contact.rows())).cwiseAbs().maxCoeff();
    for (int r : {contact.A.robot, contact.B.robot})
      if (r >= 0) largest[r] = std::max(largest[r], size);
  }
  return largest;
}

void judge_box(const Contact& contact, const double* f, int c, double rounding, std::vector<Violation>& out) {
  const double X = contact.box[0] / 2, Y = contact.box[1] / 2, n = f[2];
  const double beyond = std::max(std::abs(f[4]) - X * n, std::abs(f[3]) - Y * n);  // moment that tips the box [N m]
  const double lever = std::max(X, Y);
  const double noise =
      rounding * lever + kRoundingOfForces * std::max({std::abs(f[3]), std::abs(f[4]), std::abs(f[5])});
  if (beyond > noise) return out.push_back({c, ViolationKind::kTips, n > 0 ? beyond / n : INFINITY});
  const double torque = excess_torque(f, *contact.mu, X, Y);
  if (torque > noise) out.push_back({c, ViolationKind::kTurns, torque});
}

}  // namespace

Eigen::Vector2d contact_pressure(const Scene& scene, int contact, const ConstVectorRef& q, const Eigen::VectorXd& f) {
  AxesOf axes_of(scene, q);
  const Pressure p = pressure(scene.contacts[contact], f.data(), axes_of);
  return {p.normal, p.tangential};
}

Eigen::VectorXd robot_weights(const Scene& scene) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(scene.robots.size()));
  for (Eigen::Index r = 0; r < out.size(); ++r) out[r] = scene.robots[r].model->mass() * scene.gravity.norm();
  return out;
}

std::vector<Violation> violations(const Scene& scene, const ConstVectorRef& q, const Eigen::VectorXd& f,
                                  const std::vector<int>& f_offset) {
  return violations(scene, q, f, f_offset, robot_weights(scene));
}

std::vector<Violation> violations(const Scene& scene, const ConstVectorRef& q, const Eigen::VectorXd& f,
                                  const std::vector<int>& f_offset, const Eigen::VectorXd& loads) {
  expect_configuration("violations", "q", q, scene);
  expect_numbers("violations", "loads", loads, static_cast<int>(scene.robots.size()));
  AxesOf axes_of(scene, q);
  const std::vector<double> largest = largest_forces(scene, f, f_offset, loads);
  std::vector<Violation> out;
  for (std::size_t i = 0; i < f_offset.size(); ++i) {
    const Contact& contact = scene.contacts[i];
    if (f_offset[i] < 0 || !contact.mu) continue;
    const int c = static_cast<int>(i);
    const Pressure p = pressure(contact, f.data() + f_offset[i], axes_of);
    const double on_B = contact.B.robot < 0 ? 0 : largest[contact.B.robot];
    const double rounding = kRoundingOfForces * std::max(largest[contact.A.robot], on_B);
    const double tangential = p.tangential;
    if (p.normal < -rounding) {
      out.push_back({c, ViolationKind::kPulls, -p.normal});
      continue;
    }
    if (tangential > *contact.mu * p.normal + rounding)
      out.push_back({c, ViolationKind::kSlips, tangential - *contact.mu * p.normal,
                     p.normal > 0 ? tangential / p.normal : INFINITY});
    if (!contact.box.isZero(0)) judge_box(contact, p.in_foot.data(), c, rounding, out);
  }
  return out;
}

}  // namespace manycontact
