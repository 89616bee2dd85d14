#include "manycontact/dynamics/keep_dependent.hpp"

#include "internal.hpp"
#include "manycontact/dynamics/shapes.hpp"
#include "workspace/workspace.hpp"

namespace manycontact {

void keep_dependent(SceneData& data) {
  if (data.workspace->reduction) return keep_dependent(*data.workspace->reduction->data);
  for (std::size_t i = 0; i < data.workspace->islands.size(); ++i) {
    IslandWork& d = *data.workspace->islands[i];
    const IslandReport& report = data.report.islands[i];
    d.depended = d.answered && !d.answered_by(d.bodies.get()) ? report.nc - report.rank : 0;
  }
}

void forget_dependent(SceneData& data) {
  Workspace& w = data.workspace->reduction ? *data.workspace->reduction->data->workspace : *data.workspace;
  for (const auto& d : w.islands) d->depended = 0;
}

namespace {

void copy_dependent(const SceneData& of, SceneData& data) {
  const Workspace &from = *of.workspace, &to = *data.workspace;
  if (from.reduction && to.reduction) return copy_dependent(*from.reduction->data, *to.reduction->data);
  if (from.reduction || to.reduction || from.islands.size() != to.islands.size()) return;  // the methods differ
  for (std::size_t i = 0; i < to.islands.size(); ++i) to.islands[i]->depended = from.islands[i]->depended;
}

}  // namespace

void keep_dependent_as(const SceneData& of, const Scene& scene, SceneData& data) {
  data.active = of.active;
  prepare(scene, data);
  copy_dependent(of, data);
}

Eigen::VectorXd inaccuracy_of(const Scene& scene, const SceneData& data) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(scene.nv);
  for (const auto& d : data_solved(data).workspace->islands)
    if (d->answered_by(&d->matrix) && d->matrix.tolerated > 0)
      each_velocity_block(scene, d->island, [&](int first, int row, int n) {
        for (int i = 0; i < n; ++i) out[first + i] = d->matrix.within.inaccuracy(row + i);
      });
  return out;
}

}  // namespace manycontact
