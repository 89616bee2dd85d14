#include "../internal.hpp"
#include "manycontact/dynamics/differentiate.hpp"

namespace manycontact {

namespace {

enum Columns { kOfQ, kOfV, kOfU, kOfW };

// Calls use(value, row, column, variable, whether the row is a force) for each derivative. Numbers are the scene's.
template <class Use>
void each_entry(const Scene& scene, const SceneData& data, const Island& island, const IslandDerivatives& d,
                Use&& use) {
  std::vector<int> v, u, f, w;  // the scene's number of each of the island's coordinates
  const auto list = [](std::vector<int>& out) {
    return [&out](int first, int, int n) {
      for (int i = 0; i < n; ++i) out.push_back(first + i);
    };
  };
  each_velocity_block(scene, island, list(v));
  each_force_block(scene, data.f_offset, island, list(f));
  if (d.request.tau)
    u = v;
  else
    each_torque_block(scene, island, list(u));
  for (int push : d.wrenches)
    for (int k = 0; k < 6; ++k) w.push_back(6 * push + k);
  const auto each = [&](const auto& block, const std::vector<int>& rows, const std::vector<int>& columns, Columns by) {
    for (Eigen::Index k = 0; k < block.rows(); ++k)
      for (Eigen::Index j = 0; j < block.cols(); ++j) use(block(k, j), rows[k], columns[j], by, &rows == &f);
  };
  each(d.da_dq(), v, v, kOfQ);
  each(d.da_dv(), v, v, kOfV);
  each(d.da_du(), v, u, kOfU);
  each(d.da_dw(), v, w, kOfW);
  if (!d.request.forces) return;
  each(d.dforces_dq(), f, v, kOfQ);
  each(d.dforces_dv(), f, v, kOfV);
  each(d.dforces_du(), f, u, kOfU);
  each(d.dforces_dw(), f, w, kOfW);
}

struct Sizes {  // numbers of columns with respect to q, v, u, w, and of force rows
  int columns[4], forces;
};
Sizes sizes_of(const Scene& scene, const SceneData& data, const DerivativeData& dd) {
  const DerivativeRequest r = dd.islands.empty() ? DerivativeRequest{} : dd.islands[0].request;
  return {{r.q ? scene.nv : 0, r.v ? scene.nv : 0,
           !r.u    ? 0
           : r.tau ? scene.nv
                   : scene.nu,
           r.wrenches ? 6 * static_cast<int>(scene.wrenches.size()) : 0},
          r.forces ? static_cast<int>(data.f.size()) : 0};
}

}  // namespace

SceneDerivatives dense_derivatives(const Scene& scene, const SceneData& data) {
  internal::check_scene(scene, data, "derivatives");
  const DerivativeData& dd = derivatives(data);
  const Sizes sizes = sizes_of(scene, data, dd);
  SceneDerivatives out;
  Eigen::MatrixXd* const of_a[] = {&out.da_dq, &out.da_dv, &out.da_du, &out.da_dw};
  Eigen::MatrixXd* const of_f[] = {&out.dforces_dq, &out.dforces_dv, &out.dforces_du, &out.dforces_dw};
  for (const Columns by : {kOfQ, kOfV, kOfU, kOfW}) {
    of_a[by]->setZero(scene.nv, sizes.columns[by]);
    of_f[by]->setZero(sizes.forces, sizes.columns[by]);
  }
  for (std::size_t i = 0; i < dd.islands.size(); ++i)
    each_entry(scene, data, solved_island(data, i), dd.islands[i],
               [&](double value, int row, int column, Columns by, bool of_forces) {
                 (*(of_forces ? of_f : of_a)[by])(row, column) = value;
               });
  return out;
}

Eigen::SparseMatrix<double> sparse_derivatives(const Scene& scene, const SceneData& data) {
  internal::check_scene(scene, data, "derivatives");
  const DerivativeData& dd = derivatives(data);
  const Sizes sizes = sizes_of(scene, data, dd);
  int first[5] = {0};
  for (const Columns by : {kOfQ, kOfV, kOfU, kOfW}) first[by + 1] = first[by] + sizes.columns[by];
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < dd.islands.size(); ++i)
    each_entry(scene, data, solved_island(data, i), dd.islands[i],
               [&](double value, int row, int column, Columns by, bool of_forces) {
                 entries.emplace_back((of_forces ? scene.nv : 0) + row, first[by] + column, value);
               });
  Eigen::SparseMatrix<double> out(scene.nv + sizes.forces, first[4]);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace manycontact
