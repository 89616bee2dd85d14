#include "manycontact/dynamics/differentiate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "internal.hpp"
#include "systems/robots/derivatives.hpp"
#include "threads.hpp"

namespace manycontact {

void IslandDerivatives::check() const {
  if (!stamp.current())
    throw std::logic_error("derivatives of an island: the scene was solved again since, call differentiate first");
}

namespace internal {

bool has_derivatives(const SceneData& data) {
  if (!data.workspace || data.serial == 0) return false;
  const std::vector<IslandDerivatives>& islands = data.workspace->derivatives.islands;
  return islands.size() == data.workspace->islands.size() &&
         std::all_of(islands.begin(), islands.end(), [](const auto& of) { return of.stamp.current(); });
}

void number_torques(const Scene& scene, const Island& island, IslandDerivatives& out) {
  out.u_offset.assign(1, 0);
  for (int r : island.robots)
    out.u_offset.push_back(out.u_offset.back() +
                           (out.request.tau ? scene.robots[r].model->nv : scene.robots[r].model->nu()));
  out.nu = out.u_offset.back();
  out.cols = out.u_first + (out.request.u ? out.nu : 0);
}

void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out) {
  const auto pad = [](std::size_t columns) { return static_cast<Eigen::Index>((columns + 7) / 8 * 8); };
  out.u_offset.clear();  // so that it is not taken for laid out, should memory run out
  out.request = request;
  out.nv = island.nv;
  out.nc = island.nc;
  out.q_first = 0;
  out.v_first = request.q ? out.nv : 0;
  out.u_first = out.v_first + (request.v ? out.nv : 0);
  out.pushes.clear();
  for (std::size_t k = 0; request.pushes && k < scene.pushes.size(); ++k)
    if (std::binary_search(island.robots.begin(), island.robots.end(), scene.pushes[k].at.robot))
      out.pushes.push_back(static_cast<int>(k));
  remake(out.W, island.size(), pad(6 * out.pushes.size()));
  out.W.setZero();
  int columns = out.u_first;
  for (int r : island.robots)
    columns += !request.u ? 0 : request.tau ? scene.robots[r].model->nv : scene.robots[r].model->nu();
  remake(out.X, island.size(), pad(columns));
  out.X.setZero();
  number_torques(scene, island, out);
}

void right_hand_sides(const Scene& scene, SceneData& data, const IslandWork& d, IslandDerivatives& out) {
  derivative_terms(scene, data, d.island, data.f);
  out.X.setZero();
  derivative_rhs(scene, *data.workspace->linearisation, data.v, d, out);
}

namespace {

// Memory, by the thread that calls, of an island's derivatives.
void prepare_island(const Scene& scene, SceneData& data, IslandWork& d, const DerivativeRequest& request,
                    IslandDerivatives& out) {
  Workspace& w = *data.workspace;
  if (d.answered_by(d.bodies.get())) check_joint_space(d, "differentiate", ", ask for products (jvp, vjp)");
  // where forces are applied, what was laid out is no longer what was kept, and not zero where it may stand
  if (forces_are_applied(w) || out.request != request || out.X.rows() != d.island.size() ||
      out.u_offset.size() != d.island.robots.size() + 1)
    lay_out(scene, d.island, request, out);
  prepare_robots_derivatives(scene, d, out, w);
  if (!d.answered || d.served_in_lanes() || differentiates_by_robots(d)) return;
  make_joint_space(scene, w, d);
  w.linearisation->assign(scene, w, d.island);
}

// Whether an island that sparse-bodies answered is differentiated by the whole K first: bodies solve for columns one by
// one, which takes 4 to 70 times as long where K's sparse factor is sound, however deep the tree. Where it is not, the
// oracle of a large K would take longer.
bool differentiates_by_matrix(const SceneData& data, const IslandWork& d) {
  constexpr int kLargest = 1500;  // rows of K
  return data.options.method == Method::kAuto && d.answered_by(d.bodies.get()) && d.island.size() <= kLargest;
}

// Of an island that no batch of robots alone serves: robot by robot where that is cheaper, by the system that answered,
// by the whole K.
void differentiate_island(const Scene& scene, SceneData& data, IslandWork& d, ThreadWork& thread,
                          IslandDerivatives& out) {
  if (differentiates_by_robots(d) && d.robots->differentiate(scene, data, thread, out)) return;
  if (differentiates_by_matrix(data, d) && d.matrix.make_current(scene, data, thread) &&
      d.matrix.deficient() == d.bodies->drops &&  // of the answer's rank
      d.matrix.differentiate(scene, data, thread, out))
    return;
  if (!ask(scene, data, d, thread, [&](IslandSystem& system) {  // robots were tried just now, or are not cheaper
        return &system != d.robots.get() && system.differentiate(scene, data, thread, out);
      }))
    out.X.setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

}  // namespace internal

const DerivativeData& differentiate(const Scene& scene, SceneData& data, const DerivativeRequest& wanted) {
  internal::check_not_prescribed(scene, data, "differentiate");
  Workspace& w = *data.workspace;
  const bool applied = internal::forces_are_applied(w);
  const DerivativeRequest request = applied ? internal::by_all_torques(wanted) : wanted;
  (void)internal::linearisation_of(scene, data);
  w.derivatives.islands.resize(w.islands.size());
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    w.derivatives.islands[i].stamp = {};
    internal::prepare_island(scene, data, *w.islands[i], request, w.derivatives.islands[i]);
  }
  const internal::OneBlasOfThreads one_blas_thread(w);
  internal::differentiate_alone(scene, data);
  internal::each_island(
      w, [](const IslandWork& d) { return d.served_in_lanes(); }, internal::differentiates_by_robots,
      [&](IslandWork& d, std::size_t i, ThreadWork& thread) {
        internal::differentiate_island(scene, data, d, thread, w.derivatives.islands[i]);
      });
  if (applied) internal::join_applied_forces(scene, data, wanted);
  for (IslandDerivatives& out : w.derivatives.islands) out.stamp = {&w.current, data.serial};
  return w.derivatives;
}

const DerivativeData& derivatives(const SceneData& data) {
  if (!internal::has_derivatives(data))
    throw std::logic_error("derivatives: of no solution at hand, call differentiate first");
  return data.workspace->derivatives;
}

namespace {

void release(IslandWork& d) {
  d.derivatives = {};
  if (d.robots && !d.robots->solves)
    d.robots.reset();  // made for derivatives
  else if (d.robots)
    d.robots->derivatives.reset();
  d.matrix.rows.reset();
  for (Factor* factor :
       {d.matrix.chosen.get(), d.matrix.safe_in_order.get(), d.matrix.safe.get(), d.matrix.dense.get()})
    if (factor) factor->release_panels();
}

}  // namespace

void release_derivatives(SceneData& data) {
  if (!data.workspace) return;
  Workspace& w = *data.workspace;
  w.derivatives = {};
  for (ThreadWork& thread : w.threads) thread.panel = {};
  for (const auto& island : w.islands) release(*island);
  w.pool.each([](IslandWork& island) { release(island); });
}

namespace {

struct BlockOffsets {
  std::vector<int> v, u, f, w;  // scene's coordinate of each of the island's
};
BlockOffsets block_offsets(const Scene& scene, const SceneData& data, const Island& island,
                           const IslandDerivatives& d) {
  BlockOffsets p;
  for (int push : d.pushes)
    for (int k = 0; k < 6; ++k) p.w.push_back(6 * push + k);
  const auto list = [](std::vector<int>& out) {
    return [&out](int first, int, int n) {
      for (int i = 0; i < n; ++i) out.push_back(first + i);
    };
  };
  each_velocity_block(scene, island, list(p.v));
  each_force_block(scene, data.f_offset, island, list(p.f));
  if (d.request.tau)
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
  const auto nw = static_cast<Eigen::Index>(request.pushes ? 6 * scene.pushes.size() : 0);
  out.da_dq.setZero(scene.nv, request.q ? scene.nv : 0);
  out.da_dv.setZero(scene.nv, request.v ? scene.nv : 0);
  out.da_du.setZero(scene.nv, !request.u ? 0 : request.tau ? scene.nv : scene.nu);
  out.dforces_dq.setZero(nf, out.da_dq.cols());
  out.dforces_dv.setZero(nf, out.da_dv.cols());
  out.dforces_du.setZero(nf, out.da_du.cols());
  out.da_dw.setZero(scene.nv, nw);
  out.dforces_dw.setZero(nf, nw);
  for (std::size_t i = 0; i < dd.islands.size(); ++i) {
    const IslandDerivatives& d = dd.islands[i];
    const BlockOffsets p = block_offsets(scene, data, island_of(data, i), d);
    scatter(d.da_dq(), p.v, p.v, out.da_dq);
    scatter(d.da_dv(), p.v, p.v, out.da_dv);
    scatter(d.da_du(), p.v, p.u, out.da_du);
    scatter(d.da_dw(), p.v, p.w, out.da_dw);
    if (!request.forces) continue;
    scatter(d.dforces_dq(), p.f, p.v, out.dforces_dq);
    scatter(d.dforces_dv(), p.f, p.v, out.dforces_dv);
    scatter(d.dforces_du(), p.f, p.u, out.dforces_du);
    scatter(d.dforces_dw(), p.f, p.w, out.dforces_dw);
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
    const BlockOffsets p = block_offsets(scene, data, island_of(data, i), d);
    nf = d.request.forces ? static_cast<int>(data.f.size()) : 0;
    const int v_first = d.request.q ? scene.nv : 0, u_first = v_first + (d.request.v ? scene.nv : 0);
    const int w_first = u_first + (!d.request.u ? 0 : d.request.tau ? scene.nv : scene.nu);
    cols = w_first + (d.request.pushes ? 6 * static_cast<int>(scene.pushes.size()) : 0);
    const auto add = [&](const auto& block, const std::vector<int>& rows, int row, const std::vector<int>& columns,
                         int column) {
      for (Eigen::Index k = 0; k < block.rows(); ++k)
        for (Eigen::Index j = 0; j < block.cols(); ++j)
          entries.emplace_back(row + rows[k], column + columns[j], block(k, j));
    };
    add(d.da_dq(), p.v, 0, p.v, 0);
    add(d.da_dv(), p.v, 0, p.v, v_first);
    add(d.da_du(), p.v, 0, p.u, u_first);
    add(d.da_dw(), p.v, 0, p.w, w_first);
    if (!d.request.forces) continue;
    add(d.dforces_dq(), p.f, scene.nv, p.v, 0);
    add(d.dforces_dv(), p.f, scene.nv, p.v, v_first);
    add(d.dforces_du(), p.f, scene.nv, p.u, u_first);
    add(d.dforces_dw(), p.f, scene.nv, p.w, w_first);
  }
  Eigen::SparseMatrix<double> out(scene.nv + nf, cols);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace manycontact
