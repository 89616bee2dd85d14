#include <cmath>
#include <limits>
#include <set>

#include "manycontact/algorithm/crba.hpp"
#include "manycontact/analysis/findings.hpp"
#include "manycontact/dynamics/views.hpp"

namespace manycontact {

namespace {

constexpr double kNothing = 64 * std::numeric_limits<double>::epsilon();  // of the entry a pivot was computed from

// Row k of a packed matrix stands at its own entry, its parent's, ... (algorithm/crba.hpp); leaves first: M = L^T D L.
std::vector<int> zero_pivots(const Model& model, std::vector<double> M) {
  std::vector<double> at_first;
  for (int k = 0; k < model.nv; ++k) at_first.push_back(M[model.M_begin[k]]);
  std::vector<int> zero;
  for (int k = model.nv - 1; k >= 0; --k) {
    const double* row = M.data() + model.M_begin[k];
    if (!(row[0] > kNothing * at_first[k])) {
      zero.insert(zero.begin(), k);
      continue;
    }
    for (int i = model.dof_parent[k], a = 1; i >= 0; i = model.dof_parent[i], ++a) {
      double* above = M.data() + model.M_begin[i];
      for (int j = i, b = a; j >= 0; j = model.dof_parent[j], ++b) above[b - a] -= row[a] * row[b] / row[0];
    }
  }
  return zero;
}

}  // namespace

std::vector<int> weightless_coordinates(const Robot& robot, const Eigen::Ref<const Eigen::VectorXd>& q) {
  const Model& model = *robot.model;
  Kinematics<double> kin(model);
  std::vector<Inertia<double>> Yc;
  std::vector<double> M(packed_size(model));
  forward_kinematics<double>(model, robot.base, q, kin);
  crba<double>(model, kin, Yc, M.data());
  return zero_pivots(model, std::move(M));
}

std::vector<std::string> weightless_names(const Scene& scene, const SceneData& data,
                                          const Eigen::Ref<const Eigen::VectorXd>& q) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < data.report.islands.size(); ++i) {
    const IslandReport& report = data.report.islands[i];
    if (report.status != Status::kFailed || report.reason != Reason::kSingularInertia) continue;
    for (int r : island_of(data, i).robots) {
      const Robot& robot = scene.robots[r];
      if (robot.model->nv > 0 && robot.model->M_begin.empty()) continue;
      std::set<int> joints;  // each named once
      for (int k : weightless_coordinates(robot, q.segment(robot.idx_q, robot.model->nq)))
        if (joints.insert(robot.model->dof_joint[k]).second)
          out.push_back(robot.name + "/" + robot.model->joints[robot.model->dof_joint[k]].name);
    }
  }
  return out;
}

}  // namespace manycontact
