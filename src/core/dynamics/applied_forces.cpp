#include "applied_forces.hpp"

#include <algorithm>
#include <cmath>

#include "internal.hpp"
#include "workspace/threads.hpp"

namespace manycontact {

AppliedWork::AppliedWork(const Scene& scene) : w(scene.wrenches.size()), forces(scene) {}

namespace internal {

bool forces_are_applied(const Workspace& w) { return w.applied && w.applied->act; }

void check_pushes(const Scene& scene, const SceneData& data, const char* function) {
  if (data.wrenches.size() != scene.wrenches.size() && has_applied_forces(scene))
    throw std::invalid_argument(std::string(function) + ": data.wrenches has " + std::to_string(data.wrenches.size()) +
                                " wrenches, the scene has " + std::to_string(scene.wrenches.size()));
}

void add_applied_forces(const Scene& scene, SceneData& data, const double* q, const double* v, double* tau) {
  Workspace& work = *data.workspace;
  if (!work.applied) return;
  AppliedWork& applied = *work.applied;
  applied.act = has_applied_forces(scene);
  if (!applied.act) return;
  while (applied.threads.size() < work.threads.size())
    applied.threads.push_back({AppliedScratch(applied.forces), Eigen::VectorXd::Zero(scene.nv),
                               Eigen::VectorXd::Zero(scene.nv), Eigen::VectorXd::Zero(scene.nv),
                               Eigen::VectorXd::Zero(static_cast<Eigen::Index>(6 * scene.wrenches.size()))});
  applied.w = data.wrenches;
  manycontact::add_applied_forces<double>(scene, q, v, applied.w, applied.forces, tau);
}

bool lacks_direction(const Scene& scene, const Workspace& w, const Island& island) {
  if (!forces_are_applied(w)) return false;
  const auto has = [&](int robot) { return std::binary_search(island.robots.begin(), island.robots.end(), robot); };
  for (std::size_t k = 0; k < scene.springs.size(); ++k)
    if (has(scene.springs[k].A.robot) && !w.applied->forces.springs[k].directed) return true;
  return false;
}

DerivativeRequest by_all_torques(DerivativeRequest request) {
  request.u = request.tau = true;
  return request;
}

namespace {

// Calls use(first coordinate in the scene, first coordinate in the island, count) for each robot with applied forces.
template <class Use>
void each_block(const Scene& scene, const Island& island, const AppliedForces<double>& forces, Use&& use) {
  for (std::size_t k = 0; k < island.robots.size(); ++k)
    if (forces.number[island.robots[k]] >= 0)
      use(scene.robots[island.robots[k]].idx_v, island.dof_offset[k], scene.robots[island.robots[k]].model->nv);
}

// Adds l^T dtau/d(q, v) to out.X's row, and sets out.W's row to l^T dtau/dw. l: s.l; tau: wrench and spring torques.
void add_row(const Scene& scene, const SceneData& data, const Island& island, const AppliedForces<double>& forces,
             AppliedWork::OfThread& s, int row, IslandDerivatives& out) {
  each_block(scene, island, forces, [&](int at, int, int n) {
    s.wq.segment(at, n).setZero();
    s.wv.segment(at, n).setZero();
  });
  add_applied_adjoint(scene, data.v.data(), forces, island.robots, s.l.data(), s.scratch, s.wq.data(), s.wv.data(),
                      s.ww.data());
  each_block(scene, island, forces, [&](int at, int first, int n) {
    double* X = out.X.data() + row * out.X.cols() + first;
    if (out.request.q) Eigen::Map<Eigen::VectorXd>(X + out.q_first, n) += s.wq.segment(at, n);
    if (out.request.v) Eigen::Map<Eigen::VectorXd>(X + out.v_first, n) += s.wv.segment(at, n);
  });
  for (std::size_t k = 0; out.request.wrenches && k < out.wrenches.size(); ++k)
    std::copy_n(s.ww.data() + 6 * out.wrenches[k], 6, &out.W(row, 0) + 6 * k);
}

// Calls add_row for each row of out.X, with s.l set to the row's derivatives by the torques on all coordinates.
void join_rows(const Scene& scene, const SceneData& data, const Island& island, const AppliedForces<double>& forces,
               AppliedWork::OfThread& s, IslandDerivatives& out) {
  const int rows = out.request.forces ? island.size() : island.nv;
  for (int row = 0; row < rows; ++row) {
    const double* by_tau = &out.X(row, 0) + out.u_first;
    bool any = false;
    each_block(scene, island, forces, [&](int at, int first, int n) {
      s.l.segment(at, n) = Eigen::Map<const Eigen::VectorXd>(by_tau + first, n);
      any = any || !s.l.segment(at, n).isZero(0);
    });
    if (any) add_row(scene, data, island, forces, s, row, out);  // if s.l is zero, the row of W stays zero
  }
}

// Moves requested torque columns to the left. Columns after them become zero, or NaN if the derivatives failed.
void keep_columns(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out) {
  out.request = request;
  if (request.u && request.tau) return;
  const int before = out.u_first;
  for (Eigen::Index row = 0; row < out.X.rows(); ++row) {
    double* X = &out.X(row, 0);
    double* to = X + before;
    for (std::size_t k = 0; request.u && k < island.robots.size(); ++k)
      for (int i : scene.robots[island.robots[k]].model->actuated) *to++ = X[before + island.dof_offset[k] + i];
    std::fill(to, X + out.X.cols(), std::isnan(X[0]) ? X[0] : 0.0);
  }
  number_torques(scene, island, out);
}

}  // namespace

void join_applied_forces(const Scene& scene, SceneData& data, const DerivativeRequest& request) {
  Workspace& w = *data.workspace;
  AppliedWork& applied = *w.applied;
  each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    const Island& island = w.islands[i]->island;
    IslandDerivatives& out = w.derivatives.islands[i];
    join_rows(scene, data, island, applied.forces, applied.threads[thread.number], out);
    keep_columns(scene, island, request, out);
  });
}

void add_applied_right_hand_sides(const Scene& scene, SceneData& data, const Island& island, IslandDerivatives& R) {
  if (!forces_are_applied(*data.workspace)) return;
  AppliedWork& applied = *data.workspace->applied;
  AppliedWork::OfThread& s = applied.threads.front();
  each_block(scene, island, applied.forces, [&](int at, int, int n) { s.l.segment(at, n).setZero(); });
  each_block(scene, island, applied.forces, [&](int at, int first, int n) {
    for (int i = 0; i < n; ++i) {
      s.l[at + i] = 1;
      add_row(scene, data, island, applied.forces, s, first + i, R);
      s.l[at + i] = 0;
    }
  });
}

AppliedSizes applied_sizes(const Scene& scene, const SceneData& data, const Island& island) {
  const Workspace& w = *data.workspace;
  const std::vector<double> none(scene.nv, 0.0);
  if (!forces_are_applied(w)) return {none, none, none, none};
  return manycontact::applied_sizes(scene, w.q.data(), data.v.data(), w.applied->forces, island.robots);
}

}  // namespace internal
}  // namespace manycontact
