#include <algorithm>

#include "manycontact/analysis/findings.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

namespace {

constexpr double kMissed = 1e-8;  // contacts with smaller residuals, relative to the largest residual, are not listed

// Returns the residual J a + a0 + delta f of contact c.
Eigen::VectorXd missed_by(const Scene& scene, const SceneData& data, int c) {
  const Contact& contact = scene.contacts[c];
  const ContactData<double>& rows = contact_data(scene, data, c);
  const ContactSupport& support = contact_support(scene, data, c);
  Eigen::VectorXd r = rows.a0 + scene.damping * data.f.segment(data.f_offset[c], contact.rows());
  Eigen::Index k = 0;
  for (int i : support.a) r += rows.J.col(k++) * data.a[scene.robots[contact.A.robot].idx_v + i];
  for (int i : support.b) r += rows.J.col(k++) * data.a[scene.robots[contact.B.robot].idx_v + i];
  return r;
}

}  // namespace

std::vector<Contradiction> contradictions(const Scene& scene, const SceneData& data) {
  std::vector<Contradiction> out;
  if (data.report.status < Status::kInconsistent) return out;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    if (data.report.islands[i].status != Status::kInconsistent) continue;
    for (int c : solved_island(data, i).contacts) {
      const Eigen::VectorXd r = missed_by(scene, data, c);
      const Eigen::Index linear = std::min<Eigen::Index>(3, r.size());
      out.push_back({c, r.head(linear).norm(), r.tail(r.size() - linear).norm()});
    }
  }
  const auto size = [](const Contradiction& c) { return std::max(c.linear, c.angular); };
  std::ranges::stable_sort(out, std::ranges::greater(), size);
  if (!out.empty()) {
    const double least = kMissed * size(out.front());
    std::erase_if(out, [&](const Contradiction& c) { return size(c) <= least; });
  }
  return out;
}

}  // namespace manycontact
