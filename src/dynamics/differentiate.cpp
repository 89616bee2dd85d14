#include "manycontact/dynamics/differentiate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "bodies.hpp"
#include "steps.hpp"
#include "systems/robots/joined_derivatives.hpp"
#include "threads.hpp"

namespace manycontact {

void IslandDerivatives::check() const {
  if (!stamp.current())
    throw std::logic_error("derivatives of an island: the scene was solved again since, call differentiate first");
}

namespace internal {

void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out) {
  out.u_offset.clear();  // so that it is not taken for laid out, should memory run out
  out.request = request;
  out.nv = island.nv;
  out.nc = island.nc;
  out.nu = 0;
  for (int r : island.robots) out.nu += request.tau ? scene.robots[r].model->nv : scene.robots[r].model->nu();
  out.q_first = 0;
  out.v_first = request.q ? out.nv : 0;
  out.u_first = out.v_first + (request.v ? out.nv : 0);
  out.cols = out.u_first + (request.u ? out.nu : 0);
  remake(out.X, island.size(), (out.cols + 7) / 8 * 8);
  out.X.setZero();
  int first = 0;
  for (int r : island.robots) {
    out.u_offset.push_back(first);
    first += request.tau ? scene.robots[r].model->nv : scene.robots[r].model->nu();
  }
  out.u_offset.push_back(first);
}

void differentiate_island(const Scene& scene, SceneData& data, std::size_t i, IslandDerivatives& out,
                          ThreadWork& thread) {
  Workspace& w = *data.workspace;
  IslandWork& d = *w.islands[i];
  const auto none = [&out] { out.X.setConstant(std::numeric_limits<double>::quiet_NaN()); };
  if (differentiate_by_robots(scene, data, d, out)) return;
  if (d.in_lanes) complete_island(scene, data, d, thread);
  if (!d.factor) return none();
  const AtSolution at(scene, data, d.island);
  derivative_terms(scene, data, d.island, data.f);
  out.X.setZero();
  derivative_rhs(scene, *w.linearisation, data.v, d, out);
  const bool deficient = rank_deficient(d) && out.request.q;
  if (deficient && !d.rows) d.rows = std::make_unique<DependentDerivatives>();
  if (deficient && d.contradiction) add_contradiction(scene, data, d, out, thread.panel);
  solve_panel(scene, d, out, thread.panel);
  out.X.bottomRows(out.nc) *= -1;  // [da; -df]
  if (deficient && out.request.forces) least_norm_forces(scene, data, d, out);
}

namespace {

// An island that no lane served.
void differentiate_alone(const Scene& scene, SceneData& data, std::size_t i, ThreadWork& thread) {
  IslandWork& d = *data.workspace->islands[i];
  IslandDerivatives& out = data.workspace->derivatives.islands[i];
  differentiate_island(scene, data, i, out, thread);
  if (!d.factor) return;
  const bool bodies = by_bodies(d), refused = bodies ? out.X.hasNaN() : out.X.size() > 0 && std::isnan(out.X(0, 0));
  if (refused && (bodies ? climb_again(scene, data, d, thread) : climb_to_oracle(scene, data, d, thread)))
    differentiate_island(scene, data, i, out, thread);  // another factor may do better
}

}  // namespace

}  // namespace internal

const DerivativeData& differentiate(const Scene& scene, SceneData& data, const DerivativeRequest& request) {
  internal::check_unasked(scene, data, "differentiate");
  Workspace& w = *data.workspace;
  w.derivatives_serial = 0;
  Linearisation& linearisation = internal::linearisation_of(scene, data);
  w.derivatives.islands.resize(w.islands.size());
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    IslandDerivatives& out = w.derivatives.islands[i];
    const Island& island = w.islands[i]->island;
    out.stamp = {};
    internal::complete_bodies(scene, data, *w.islands[i], w.threads.front());
    internal::joint_space_terms(scene, data, *w.islands[i], "differentiate");
    if (out.request != request || out.X.rows() != island.size() || out.u_offset.size() != island.robots.size() + 1)
      internal::lay_out(scene, island, request, out);
    internal::prepare_by_robots(scene, *w.islands[i], out, w);
    if (!internal::goes_by_robots(data, *w.islands[i])) linearisation.assign(scene, w, *w.islands[i]);
  }
  const internal::OneBlasOfThreads one_blas_thread(w);
  internal::differentiate_in_lanes(scene, data);
  for (std::size_t i = 0; i < w.islands.size(); ++i)  // these have their own use for all threads
    if (internal::goes_by_robots(data, *w.islands[i])) internal::differentiate_alone(scene, data, i, w.threads.front());
  internal::each_item(w, w.islands.size(), [&](std::size_t i, ThreadWork& thread) {
    if (!w.islands[i]->served_in_lanes() && !internal::goes_by_robots(data, *w.islands[i]))
      internal::differentiate_alone(scene, data, i, thread);
  });
  bool all_linearised = true;
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    all_linearised =
        all_linearised && !w.islands[i]->served_in_lanes() && !internal::goes_by_robots(data, *w.islands[i]);
    w.derivatives.islands[i].stamp = {&w.current, data.serial};
  }
  w.kinematics_known = std::all_of(w.islands.begin(), w.islands.end(),
                                   [](const auto& d) { return !d->in_lanes || (d->joined && d->joined->terms_known); });
  w.derivatives_serial = data.serial;
  w.linearised_serial = all_linearised ? data.serial : 0;
  return w.derivatives;
}

const DerivativeData& derivatives(const SceneData& data) {
  if (!data.workspace || data.workspace->derivatives_serial == 0 || data.workspace->derivatives_serial != data.serial)
    throw std::logic_error("derivatives: of no solution at hand, call differentiate first");
  return data.workspace->derivatives;
}

namespace {

void release(IslandWork& d) {
  d.derivatives = {};
  d.by_robots.reset();
  if (d.joined && !d.joined->solves) d.joined.reset();  // made for derivatives
  d.rows.reset();
  d.all.reset();
  for (Factor* factor : {d.chosen.get(), d.safe.get(), d.dense.get()})
    if (factor) factor->release_panels();
}

}  // namespace

void release_derivatives(SceneData& data) {
  if (!data.workspace) return;
  Workspace& w = *data.workspace;
  w.derivatives_serial = 0;
  w.derivatives = {};
  for (ThreadWork& thread : w.threads) thread.panel = {};
  for (const auto& island : w.islands) release(*island);
  for (const auto& [shape, shelf] : w.shelves)
    for (const auto& island : shelf) release(*island);
}

namespace {

struct Places {
  std::vector<int> v, u, f;  // scene's coordinate of each of the island's
};
Places places(const Scene& scene, const SceneData& data, const Island& island, bool tau) {
  Places p;
  const auto list = [](std::vector<int>& out) {
    return [&out](int first, int, int n) {
      for (int i = 0; i < n; ++i) out.push_back(first + i);
    };
  };
  each_velocity_block(scene, island, list(p.v));
  each_force_block(scene, data.f_offset, island, list(p.f));
  if (tau)
    p.u = p.v;
  else
    each_torque_block(scene, island, list(p.u));
  return p;
}

template <class Block>
void scatter(const Block& block, const std::vector<int>& rows, const std::vector<int>& cols, Eigen::MatrixXd& out) {
  for (Eigen::Index i = 0; i < block.rows(); ++i)
    for (Eigen::Index j = 0; j < block.cols(); ++j) out(rows[i], cols[j]) = block(i, j);
}

}  // namespace

SceneDerivatives dense_derivatives(const Scene& scene, const SceneData& data) {
  internal::check_scene(scene, data, "derivatives");
  const DerivativeData& dd = derivatives(data);
  const DerivativeRequest request = dd.islands.empty() ? DerivativeRequest{} : dd.islands[0].request;
  SceneDerivatives out;
  const Eigen::Index nf = request.forces ? data.f.size() : 0;
  out.da_dq.setZero(scene.nv, request.q ? scene.nv : 0);
  out.da_dv.setZero(scene.nv, request.v ? scene.nv : 0);
  out.da_du.setZero(scene.nv, !request.u ? 0 : request.tau ? scene.nv : scene.nu);
  out.dforces_dq.setZero(nf, out.da_dq.cols());
  out.dforces_dv.setZero(nf, out.da_dv.cols());
  out.dforces_du.setZero(nf, out.da_du.cols());
  for (std::size_t i = 0; i < dd.islands.size(); ++i) {
    const IslandDerivatives& d = dd.islands[i];
    const Places p = places(scene, data, island_of(data, i), d.request.tau);
    scatter(d.da_dq(), p.v, p.v, out.da_dq);
    scatter(d.da_dv(), p.v, p.v, out.da_dv);
    scatter(d.da_du(), p.v, p.u, out.da_du);
    if (!request.forces) continue;
    scatter(d.dforces_dq(), p.f, p.v, out.dforces_dq);
    scatter(d.dforces_dv(), p.f, p.v, out.dforces_dv);
    scatter(d.dforces_du(), p.f, p.u, out.dforces_du);
  }
  return out;
}

Eigen::SparseMatrix<double> sparse_derivatives(const Scene& scene, const SceneData& data) {
  internal::check_scene(scene, data, "derivatives");
  const DerivativeData& dd = derivatives(data);
  std::vector<Eigen::Triplet<double>> entries;
  int cols = 0, nf = 0;
  for (std::size_t i = 0; i < dd.islands.size(); ++i) {
    const IslandDerivatives& d = dd.islands[i];
    const Places p = places(scene, data, island_of(data, i), d.request.tau);
    nf = d.request.forces ? static_cast<int>(data.f.size()) : 0;
    const int v_first = d.request.q ? scene.nv : 0, u_first = v_first + (d.request.v ? scene.nv : 0);
    cols = u_first + (!d.request.u ? 0 : d.request.tau ? scene.nv : scene.nu);
    const auto add = [&](const auto& block, const std::vector<int>& rows, int row, const std::vector<int>& columns,
                         int column) {
      for (Eigen::Index k = 0; k < block.rows(); ++k)
        for (Eigen::Index j = 0; j < block.cols(); ++j)
          entries.emplace_back(row + rows[k], column + columns[j], block(k, j));
    };
    add(d.da_dq(), p.v, 0, p.v, 0);
    add(d.da_dv(), p.v, 0, p.v, v_first);
    add(d.da_du(), p.v, 0, p.u, u_first);
    if (!d.request.forces) continue;
    add(d.dforces_dq(), p.f, scene.nv, p.v, 0);
    add(d.dforces_dv(), p.f, scene.nv, p.v, v_first);
    add(d.dforces_du(), p.f, scene.nv, p.u, u_first);
  }
  Eigen::SparseMatrix<double> out(scene.nv + nf, cols);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace manycontact
