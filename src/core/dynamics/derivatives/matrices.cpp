// The islands' derivatives as matrices of the scene, dense and sparse.

#include "../internal.hpp"
#include "manycontact/dynamics/differentiate.hpp"

namespace manycontact {

namespace {

enum Columns { kOfQ, kOfV, kOfU, kOfW };

// use(block, its rows, its columns in the scene, by what, whether it is of forces) for each of an island's blocks.
template <class Use>
void each_block(const Scene& scene, const SceneData& data, const Island& island, const IslandDerivatives& d,
                Use&& use) {
  std::vector<int> v, u, f, w;  // the scene's coordinate of each of the island's
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
  for (int push : d.pushes)
    for (int k = 0; k < 6; ++k) w.push_back(6 * push + k);
  use(d.da_dq(), v, v, kOfQ, false);
  use(d.da_dv(), v, v, kOfV, false);
  use(d.da_du(), v, u, kOfU, false);
  use(d.da_dw(), v, w, kOfW, false);
  if (!d.request.forces) return;
  use(d.dforces_dq(), f, v, kOfQ, true);
  use(d.dforces_dv(), f, v, kOfV, true);
  use(d.dforces_du(), f, u, kOfU, true);
  use(d.dforces_dw(), f, w, kOfW, true);
}

// How many columns there are of each, and rows of forces.
struct Sizes {
  int columns[4], forces;
};
Sizes sizes_of(const Scene& scene, const SceneData& data, const DerivativeData& dd) {
  const DerivativeRequest r = dd.islands.empty() ? DerivativeRequest{} : dd.islands[0].request;
  return {{r.q ? scene.nv : 0, r.v ? scene.nv : 0,
           !r.u    ? 0
           : r.tau ? scene.nv
                   : scene.nu,
           r.pushes ? 6 * static_cast<int>(scene.pushes.size()) : 0},
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
    each_block(scene, data, island_of(data, i), dd.islands[i],
               [&](const auto& block, const std::vector<int>& rows, const std::vector<int>& columns, Columns by,
                   bool of_forces) {
                 Eigen::MatrixXd& to = *(of_forces ? of_f : of_a)[by];
                 for (Eigen::Index k = 0; k < block.rows(); ++k)
                   for (Eigen::Index j = 0; j < block.cols(); ++j) to(rows[k], columns[j]) = block(k, j);
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
    each_block(scene, data, island_of(data, i), dd.islands[i],
               [&](const auto& block, const std::vector<int>& rows, const std::vector<int>& columns, Columns by,
                   bool of_forces) {
                 for (Eigen::Index k = 0; k < block.rows(); ++k)
                   for (Eigen::Index j = 0; j < block.cols(); ++j)
                     entries.emplace_back((of_forces ? scene.nv : 0) + rows[k], first[by] + columns[j], block(k, j));
               });
  Eigen::SparseMatrix<double> out(scene.nv + sizes.forces, first[4]);
  out.setFromTriplets(entries.begin(), entries.end());
  return out;
}

}  // namespace manycontact
