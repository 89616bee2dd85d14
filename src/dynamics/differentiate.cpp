#include "manycontact/dynamics/differentiate.hpp"

#include <limits>
#include <map>
#include <stdexcept>

#include "internal.hpp"

namespace manycontact {

DerivativeData::DerivativeData(const Scene& scene, const std::vector<ContactSupport>& supports) {
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    rows.emplace_back(scene.contacts[c], supports[c]);
    contacts.emplace_back(scene, scene.contacts[c], supports[c]);
  }
}

void DerivativeData::assign_slots(const Scene& scene, const std::vector<std::vector<int>>& islands) {
  slot.assign(scene.robots.size(), -1);
  std::map<const Model*, std::vector<int>> places;  // of each model
  for (const std::vector<int>& island : islands) {
    std::map<const Model*, std::size_t> used;
    for (int r : island) {
      const Model* model = scene.robots[r].model.get();
      std::vector<int>& of_model = places[model];
      const std::size_t k = used[model]++;
      if (k == of_model.size()) {
        of_model.push_back(static_cast<int>(pool.size()));
        pool.push_back({RneaDerivatives(*model), std::vector<Vec6<double>>(model->njoints())});
      }
      slot[r] = of_model[k];
    }
  }
}

namespace internal {

void check_solved(const SceneData& data, const char* function) {
  if (!data.solved) throw std::logic_error(std::string(function) + ": solve first");
  if (data.islands_active != data.active)
    throw std::logic_error(std::string(function) + ": the active contacts changed since the last solve, solve first");
}

DerivativeData& prepare_derivatives(const Scene& scene, SceneData& data) {
  if (!data.derivatives) data.derivatives = std::make_unique<DerivativeData>(scene, data.supports);
  DerivativeData& dd = *data.derivatives;
  if (dd.islands.size() == data.islands.size()) return dd;
  std::vector<std::vector<int>> robots;
  for (const IslandData& d : data.islands) robots.push_back(d.island.robots);
  dd.pool.clear();
  dd.assign_slots(scene, robots);
  dd.islands.assign(data.islands.size(), {});
  dd.dependent.clear();
  dd.dependent.resize(data.islands.size());
  return dd;
}

void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out) {
  out.request = request;
  out.nv = island.nv;
  out.nc = island.nc;
  out.nu = 0;
  out.u_offset.clear();
  for (int r : island.robots) {
    out.u_offset.push_back(out.nu);
    out.nu += request.tau ? scene.robots[r].model->nv : scene.robots[r].model->nu();
  }
  out.u_offset.push_back(out.nu);
  out.q_first = 0;
  out.v_first = request.q ? out.nv : 0;
  out.u_first = out.v_first + (request.v ? out.nv : 0);
  out.cols = out.u_first + (request.u ? out.nu : 0);
  out.X.setZero(island.size(), (out.cols + 7) / 8 * 8);
}

void differentiate_island(const Scene& scene, SceneData& data, std::size_t i, IslandDerivatives& out) {
  IslandData& d = data.islands[i];
  if (d.factor == Factor::kNone) {
    out.X.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  derivative_terms(scene, data, d);
  derivative_rhs(scene, data, d, out);
  if (d.factor == Factor::kDenseSchur) return;
  const bool deficient = rank_deficient(d) && out.request.q;
  DependentDerivatives& dependent = data.derivatives->dependent[i];
  if (deficient && data.report.islands[i].status == Status::kInconsistent)
    add_contradiction(scene, data, d, dependent, out);
  solve_panel(scene, data, d, out);
  out.X.bottomRows(out.nc) *= -1;  // [da; -df]
  if (deficient && out.request.forces) least_norm_forces(scene, data, d, dependent, out);
}

}  // namespace internal

const DerivativeData& differentiate(const Scene& scene, SceneData& data, const DerivativeRequest& request) {
  internal::check_solved(data, "differentiate");
  DerivativeData& dd = internal::prepare_derivatives(scene, data);
  bool dense_schur = false;
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    IslandDerivatives& out = dd.islands[i];
    if (out.request != request || out.X.rows() != data.islands[i].island.size() || out.u_offset.empty())
      internal::lay_out(scene, data.islands[i].island, request, out);
    internal::differentiate_island(scene, data, i, out);
    dense_schur |= data.islands[i].factor == Factor::kDenseSchur;
  }
  if (dense_schur) internal::differentiate_dense_schur(scene, data);
  return dd;
}

namespace {

// Calls place(block row, block column, scene row, scene column) ... for each island's rows and columns, as index lists.
struct Places {
  std::vector<int> v, u, f;  // scene's coordinate of each of the island's
};
Places places(const Scene& scene, const SceneData& data, const Island& island, bool tau) {
  Places p;
  for (int r : island.robots) {
    const Robot& robot = scene.robots[r];
    for (int i = 0; i < robot.model->nv; ++i) p.v.push_back(robot.idx_v + i);
    for (int i = 0; i < (tau ? robot.model->nv : robot.model->nu()); ++i)
      p.u.push_back((tau ? robot.idx_v : robot.idx_u) + i);
  }
  for (int c : island.contacts)
    for (int i = 0; i < scene.contacts[c].rows(); ++i) p.f.push_back(data.f_offset[c] + i);
  return p;
}

template <class Block>
void scatter(const Block& block, const std::vector<int>& rows, const std::vector<int>& cols, Eigen::MatrixXd& out) {
  for (Eigen::Index i = 0; i < block.rows(); ++i)
    for (Eigen::Index j = 0; j < block.cols(); ++j) out(rows[i], cols[j]) = block(i, j);
}

const DerivativeData& computed(const SceneData& data) {
  const DerivativeData* dd = data.derivatives.get();
  bool complete = dd && dd->islands.size() == data.islands.size();
  for (std::size_t i = 0; complete && i < data.islands.size(); ++i)  // jvp and vjp leave them without blocks
    complete = dd->islands[i].X.rows() == data.islands[i].island.size();
  if (!complete) throw std::logic_error("derivatives: call differentiate first");
  return *dd;
}

}  // namespace

SceneDerivatives dense_derivatives(const Scene& scene, const SceneData& data) {
  const DerivativeData& dd = computed(data);
  const DerivativeRequest request = dd.islands.empty() ? DerivativeRequest{} : dd.islands[0].request;
  SceneDerivatives out;
  const Eigen::Index nf = request.forces ? data.f.size() : 0;
  out.da_dq.setZero(scene.nv, request.q ? scene.nv : 0);
  out.da_dv.setZero(scene.nv, request.v ? scene.nv : 0);
  out.da_du.setZero(scene.nv, !request.u ? 0 : request.tau ? scene.nv : scene.nu);
  out.dforces_dq.setZero(nf, out.da_dq.cols());
  out.dforces_dv.setZero(nf, out.da_dv.cols());
  out.dforces_du.setZero(nf, out.da_du.cols());
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    const IslandDerivatives& d = dd.islands[i];
    const Places p = places(scene, data, data.islands[i].island, d.request.tau);
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
  const DerivativeData& dd = computed(data);
  std::vector<Eigen::Triplet<double>> entries;
  int cols = 0, nf = 0;
  for (std::size_t i = 0; i < data.islands.size(); ++i) {
    const IslandDerivatives& d = dd.islands[i];
    const Places p = places(scene, data, data.islands[i].island, d.request.tau);
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
