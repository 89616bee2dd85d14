#pragma once
// Steps of solve(), one file each.

#include "manycontact/dynamics/solve.hpp"

namespace manycontact::internal {

/// Kinematics, bias, inertia and contact rows of an island's robots; b = [S^T u - h; -a0] in elimination order.
void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& u, SceneData& data,
              IslandData& island);

/// Each tries one factorization of the assembled system and solves it with refinement. kNone: the answer is sound.
Reason solve_ldl(SceneData& data, IslandData& island, IslandReport& report);
Reason solve_cholmod(IslandData& island, IslandReport& report);
Reason solve_supernodal(const Scene& scene, IslandData& island, IslandReport& report);
/// The oracle; sets status, rank and reason by itself.
void solve_dense(const Scene& scene, IslandData& island, IslandReport& report);
/// All islands at once, after evaluate; sets all of the report.
void solve_dense_schur(const Scene& scene, SceneData& data);

/// Solves in place with the factor at hand, in elimination order.
void solve_with_factor(const Scene& scene, IslandData& island, double* x);

/// Throws std::logic_error, in the name of `function`, unless data holds a solve with the contacts now active.
void check_solved(const SceneData& data, const char* function);
/// Terms of an island's derivatives, at the last solve: RNEA's and the contacts'.
void derivative_terms(const Scene& scene, SceneData& data, const IslandData& island);
/// -dr into the panel out.X, which has its size. After derivative_terms.
void derivative_rhs(const Scene& scene, SceneData& data, const IslandData& island, IslandDerivatives& out);
/// data.derivatives, with places for the islands at hand.
DerivativeData& prepare_derivatives(const Scene& scene, SceneData& data);
/// Sizes and places of an island's blocks.
void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out);
/// All of an island's derivatives into `out`, by the factor at hand (dense-schur: the right-hand sides only).
void differentiate_island(const Scene& scene, SceneData& data, std::size_t island, IslandDerivatives& out);
/// Where the contacts contradict each other, a solves J^T (J a + a0) = 0: adds to -dr2 what the turning of J^T does.
void add_contradiction(const Scene& scene, SceneData& data, const IslandData& island, IslandDerivatives& out);
/// Whether the island's contact rows were found dependent and it was answered by the oracle.
inline bool rank_deficient(const IslandData& d) {
  return d.factor == Factor::kDense && d.dense->delta == 0 && d.dense->rank < d.island.nc;
}
/// Overwrites the panel of right-hand sides with [da; -df], by the factor at hand.
void solve_panel(const Scene& scene, SceneData& data, IslandData& island, IslandDerivatives& out);
/// Adds to dforces_dq what keeps the forces of least norm, where rows are dependent (Factor::kDense).
void least_norm_forces(const Scene& scene, SceneData& data, const IslandData& island, IslandDerivatives& out);
/// dense-schur: explicit inverse of the whole scene's K, times all right-hand sides, as Crocoddyl does.
void differentiate_dense_schur(const Scene& scene, SceneData& data);

/// Between an island's vector in elimination order, x = [a; y], and the scene's: a in the order of v, y in that of f.
template <class A, class Y>
void scatter(const Scene& scene, const SceneData& data, const IslandData& d, const double* x, A& a, Y& y) {
  const int* iperm = d.system.pattern->iperm.data();
  for (std::size_t r = 0; r < d.island.robots.size(); ++r) {
    const Robot& robot = scene.robots[d.island.robots[r]];
    for (int i = 0; i < robot.model->nv; ++i) a[robot.idx_v + i] = x[iperm[d.island.dof_offset[r] + i]];
  }
  for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
    const int rows = scene.contacts[d.island.contacts[c]].rows(), to = data.f_offset[d.island.contacts[c]];
    for (int i = 0; i < rows; ++i) y[to + i] = x[iperm[d.island.nv + d.island.row_offset[c] + i]];
  }
}
template <class A, class Y>
void gather(const Scene& scene, const SceneData& data, const IslandData& d, const A& a, const Y& y, double* x) {
  const int* iperm = d.system.pattern->iperm.data();
  for (std::size_t r = 0; r < d.island.robots.size(); ++r) {
    const Robot& robot = scene.robots[d.island.robots[r]];
    for (int i = 0; i < robot.model->nv; ++i) x[iperm[d.island.dof_offset[r] + i]] = a[robot.idx_v + i];
  }
  for (std::size_t c = 0; c < d.island.contacts.size(); ++c) {
    const int rows = scene.contacts[d.island.contacts[c]].rows(), from = data.f_offset[d.island.contacts[c]];
    for (int i = 0; i < rows; ++i) x[iperm[d.island.nv + d.island.row_offset[c] + i]] = y[from + i];
  }
}

/// Whether refinement ended well enough to be believed.
inline bool converged(const Refinement& r) { return r.backward_error <= 1e-12; }

}  // namespace manycontact::internal
