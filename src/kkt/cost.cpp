#include "manycontact/kkt/cost.hpp"

namespace manycontact {

double predicted_cost_ldl(const KktPattern& p) {
  return 1e-3 * (10.0 * p.size() + 4.0 * p.ldl.nonzeros() + 0.6 * p.ldl.flops);
}

double predicted_cost_cholmod(const KktPattern& p) {
  return 5 + 1e-3 * (30.0 * p.size() + 8.0 * p.ldl.nonzeros() + 1.0 * p.ldl.flops);
}

double predicted_cost_supernodal(const Scene& scene, const Island& island, const SchurPattern& p) {
  double flops = 0;
  for (std::size_t r = 0; r < p.robots.size(); ++r) {
    const Model& model = *scene.robots[island.robots[r]].model;
    const double rows = p.robots[r].rows;
    for (int i = 0; i < model.nv; ++i) flops += (model.dof_depth[i] + 1.0) * (model.dof_depth[i] + rows);
    flops += 0.5 * rows * rows * model.nv;
  }
  const double nc = island.nc;  // S is nearly dense in its supernodes
  return 20 + 1e-3 * (1.3 * flops + 0.25 * nc * nc + 25 * p.S.nonzeros());
}

double predicted_cost_dense(int nv, int nc) {
  const double n = nv, m = nc;
  return 5 + 1e-3 * 0.5 * (4 * n * n * m + 2 * n * n * n);
}

}  // namespace manycontact
