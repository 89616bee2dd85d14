#pragma once
// Steps of solve and differentiate, one file each.

#include "manycontact/algorithm/crba.hpp"
#include "workspace.hpp"

namespace manycontact::internal {

/// solve_tau and prepare, of a scene and sizes already checked.
const Report& solve_checked(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                            SceneData& data);
void prepare_checked(const Scene& scene, SceneData& data);
/// Why this island's input cannot be used, kNone if it can.
Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                   const Island& island);
/// Kinematics, bias, inertia and contact rows of an island's robots.
void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& work, const Island& island);
/// K and b = [data.tau - h; -a0] of what was evaluated, in that order of elimination.
void assemble_island(const Scene& scene, const SceneData& data, Order order, double damping, IslandWork& island);
/// After evaluate: factorizes and solves by the first way that gives a sound answer. island.v.x, island.factor and the
/// report are that answer's; false where there is none.
bool climb_ladder(const Scene& scene, const SceneData& data, FactorScratch& scratch, IslandWork& island,
                  IslandReport& report);

/// Sizes and places of an island's blocks.
void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out);
/// All of an island's derivatives into `out`, which is laid out, by the factor at hand.
void differentiate_island(const Scene& scene, SceneData& data, std::size_t island, IslandDerivatives& out);
/// Adds to -dr1/dq of an island (nv x nv) what a contact's force does beyond a force fixed to its bodies: B's half
/// moves with A, and a world-aligned frame does not turn. columns: of the contact; oA, oB: first coordinates of its
/// robots.
void force_columns(const ContactData<double>& rows, const ContactDerivatives& d, const std::vector<int>& columns,
                   int oA, int oB, Eigen::Ref<IslandDerivatives::Panel, 0, Eigen::OuterStride<>> X);
/// -dr into the panel out.X, which has its size. After derivative_terms.
void derivative_rhs(const Scene& scene, const Linearisation& terms, const IslandWork& island, IslandDerivatives& out);
/// Overwrites the panel of right-hand sides with [da; -df], by the factor at hand. NaN where that cannot be believed.
void solve_panel(const Scene& scene, IslandWork& island, IslandDerivatives& out, PanelWork& work);
/// Where the contacts contradict each other, a solves J^T (J a + a0) = 0: adds to -dr2 what the turning of J^T does.
void add_contradiction(const Scene& scene, SceneData& data, IslandWork& island, IslandDerivatives& out);
/// Adds to dforces_dq what keeps the forces of least norm, where rows are dependent.
void least_norm_forces(const Scene& scene, SceneData& data, IslandWork& island, IslandDerivatives& out);

/// Whether the island's contact rows were found dependent.
inline bool rank_deficient(const IslandWork& d) { return d.factor && d.factor->rank() < d.island.nc; }

/// Between an island's vector in elimination order, x = [a; y], and the scene's: a in the order of v, y in that of f.
template <class X, class A, class Y>
void scatter(const Scene& scene, const std::vector<int>& f_offset, const KktPattern& p, const Island& island,
             const X* x, A& a, Y& y) {
  const int* iperm = p.iperm.data();
  each_velocity_block(scene, island, [&](int to, int from, int n) {
    for (int i = 0; i < n; ++i) a[to + i] = x[iperm[from + i]];
  });
  each_force_block(scene, f_offset, island, [&](int to, int from, int n) {
    for (int i = 0; i < n; ++i) y[to + i] = x[iperm[island.nv + from + i]];
  });
}
template <class X, class A, class Y>
void gather(const Scene& scene, const std::vector<int>& f_offset, const KktPattern& p, const Island& island, const A& a,
            const Y& y, X* x) {
  const int* iperm = p.iperm.data();
  each_velocity_block(scene, island, [&](int from, int to, int n) {
    for (int i = 0; i < n; ++i) x[iperm[to + i]] = a[from + i];
  });
  each_force_block(scene, f_offset, island, [&](int from, int to, int n) {
    for (int i = 0; i < n; ++i) x[iperm[island.nv + to + i]] = y[from + i];
  });
}

}  // namespace manycontact::internal
