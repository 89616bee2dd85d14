#include <algorithm>
#include <cmath>

#include "manycontact/analysis/findings.hpp"

namespace manycontact {

std::string to_string(Violating kind) {
  switch (kind) {
    case Violating::kPulls:
      return "pulls";
    case Violating::kSlips:
      return "slips";
    case Violating::kTips:
      return "tips";
    case Violating::kTurns:
      break;
  }
  return "turns";
}

std::string unit_of(Violating kind) {
  switch (kind) {
    case Violating::kPulls:
    case Violating::kSlips:
      return "N";
    case Violating::kTips:
      return "m";
    case Violating::kTurns:
      break;
  }
  return "N m";
}

namespace {

constexpr double kRoundingOfForces = 1e-9;  // of the largest force on a contact's robots

// Normal and tangential force of a contact with a mu.
struct Pressure {
  double normal = 0;
  Eigen::Vector2d tangential = Eigen::Vector2d::Zero();
};

Pressure pressure(const Contact& contact, const double* f) {
  if (contact.type == ContactType::k1D) return {f[0]};
  if (contact.type == ContactType::k2D) return {f[1], {f[0], 0}};
  return {f[2], {f[0], f[1]}};
}

// How far m_z is beyond what friction at the corners of a box X, Y (half sides) bears: tau_min <= m_z <= tau_max with
//   tau_min = -mu (X + Y) n + |Y f_x - mu m_x| + |X f_y - mu m_y|
//   tau_max =  mu (X + Y) n - |Y f_x + mu m_x| - |X f_y + mu m_y|
double excess_torque(const double* f, double mu, double X, double Y) {
  const double most = mu * (X + Y) * f[2];
  const double low = -most + std::abs(Y * f[0] - mu * f[3]) + std::abs(X * f[1] - mu * f[4]);
  const double high = most - std::abs(Y * f[0] + mu * f[3]) - std::abs(X * f[1] + mu * f[4]);
  return std::max(low - f[5], f[5] - high);
}

// Per robot, the largest entry of its contacts' forces.
std::vector<double> largest_forces(const Scene& scene, const Eigen::VectorXd& f, const std::vector<int>& f_offset) {
  std::vector<double> largest(scene.robots.size(), 0);
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
  const double beyond = std::max(std::abs(f[4]) - X * n, std::abs(f[3]) - Y * n);  // N m
  const double lever = std::max(X, Y);
  const double noise =
      rounding * lever + kRoundingOfForces * std::max({std::abs(f[3]), std::abs(f[4]), std::abs(f[5])});
  if (beyond > noise) return out.push_back({c, Violating::kTips, n > 0 ? beyond / n : INFINITY});
  const double torque = excess_torque(f, *contact.mu, X, Y);
  if (torque > noise) out.push_back({c, Violating::kTurns, torque});
}

}  // namespace

std::vector<Violation> violations(const Scene& scene, const Eigen::VectorXd& f, const std::vector<int>& f_offset) {
  const std::vector<double> largest = largest_forces(scene, f, f_offset);
  std::vector<Violation> out;
  for (std::size_t i = 0; i < f_offset.size(); ++i) {
    const Contact& contact = scene.contacts[i];
    if (f_offset[i] < 0 || !contact.mu) continue;
    const int c = static_cast<int>(i);
    const double* force = f.data() + f_offset[i];
    const Pressure p = pressure(contact, force);
    const double on_B = contact.B.robot < 0 ? 0 : largest[contact.B.robot];
    const double rounding = kRoundingOfForces * std::max(largest[contact.A.robot], on_B);
    const double tangential = p.tangential.norm();
    if (p.normal < -rounding) {
      out.push_back({c, Violating::kPulls, -p.normal});
      continue;
    }
    if (tangential > *contact.mu * p.normal + rounding)
      out.push_back(
          {c, Violating::kSlips, tangential - *contact.mu * p.normal, p.normal > 0 ? tangential / p.normal : INFINITY});
    if (!contact.box.isZero(0)) judge_box(contact, force, c, rounding, out);
  }
  return out;
}

}  // namespace manycontact
