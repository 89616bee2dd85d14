#pragma once
// Steps of solve and differentiate, one file each.

#include <algorithm>
#include <cmath>

#include "manycontact/algorithm/crba.hpp"
#include "workspace.hpp"

namespace manycontact::internal {

/// prepare, of a scene already checked.
void prepare_checked(const Scene& scene, SceneData& data);
/// Why this island's input cannot be used, kNone if it can.
Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                   const Island& island);
/// An island's report as it is before it is solved; keeps the memory of its list.
void reset(IslandReport& report, const Island& island);
/// Kinematics, K and factor of the islands that were solved in lanes, as if they had been solved alone.
void complete(const Scene& scene, const SceneData& data);
void complete_island(const Scene& scene, const SceneData& data, IslandWork& island, ThreadWork& thread);
/// Kinematics, bias, inertia and contact rows of an island's robots.
void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& work, const Island& island);
void evaluate_robot(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& work, int robot);
void evaluate_contact(const Scene& scene, Workspace& work, int contact);
/// What row i of a contact is asked for, as accelerations.
inline double wanted_in(const SceneData& data, int contact, Eigen::Index i) {
  const double* wanted = data.workspace->wanted;
  return wanted ? wanted[data.f_offset[static_cast<std::size_t>(contact)] + i] : 0;
}
/// K and b = [data.tau - h; wanted - a0] of what was evaluated, in that order of elimination.
void assemble_island(const Scene& scene, const SceneData& data, Order order, double damping, IslandWork& island);
/// After evaluate, of an island that is not known to be dependent (still_dependent): factorizes and solves by the first
/// way that gives a sound answer. island.v.x, island.factor and the report are that answer's; false where there is none.
bool climb_ladder(const Scene& scene, const SceneData& data, FactorScratch& scratch, IslandWork& island,
                  IslandReport& report);

/// Rows that depended on each other in the solve before mostly still do, where the first rungs would fail: whether they
/// do, and the answer then. If not, was_dependent is false, and another way has to answer as if they never had.
[[nodiscard]] bool still_dependent(const Scene& scene, const SceneData& data, FactorScratch& scratch,
                                   IslandWork& island, IslandReport& report);

/// climb_ladder once more for an island that was answered: what the next solve tries first, and the report, stay.
bool climb_again(const Scene& scene, const SceneData& data, IslandWork& island, ThreadWork& thread);
/// The oracle alone, where the factor at hand does not serve for derivatives; false, and that factor again, where the
/// oracle has no answer either or would take too long.
bool climb_to_oracle(const Scene& scene, const SceneData& data, IslandWork& island, ThreadWork& thread);
/// The same for an answer that lanes or parts gave. island.factor is null where there is none.
void factorize_again(const Scene& scene, const SceneData& data, IslandWork& island, ThreadWork& thread);

/// Forgets what a solve leaves to the next one for speed alone: the next answer depends on its state alone, as that of
/// new data does.
void forget_states(SceneData& data);

/// Bytes of derivatives: more than a core can count on in a cache it shares, and need not be written through it.
inline constexpr std::size_t kCached = 4 << 20;

/// Sizes and places of an island's blocks.
void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out);
/// All of an island's derivatives into `out`, which is laid out, by the factor at hand.
void differentiate_island(const Scene& scene, SceneData& data, std::size_t island, IslandDerivatives& out,
                          ThreadWork& thread);
/// -dr into the panel out.X, which is laid out and zero where it may stand. After derivative_terms.
void derivative_rhs(const Scene& scene, const Linearisation& terms, const Eigen::VectorXd& v, const IslandWork& island,
                    IslandDerivatives& out);
/// Overwrites the panel of right-hand sides with [da; -df], by the factor at hand. NaN where that cannot be believed.
void solve_panel(const Scene& scene, IslandWork& island, IslandDerivatives& out, PanelWork& work);
/// Where the contacts contradict each other, a solves J^T (J a + a0) = 0: adds to -dr2 what the turning of J^T does.
void add_contradiction(const Scene& scene, SceneData& data, IslandWork& island, IslandDerivatives& out,
                       PanelWork& work);
/// Adds to dforces_dq what keeps the forces of least norm, where rows are dependent.
void least_norm_forces(const Scene& scene, SceneData& data, IslandWork& island, IslandDerivatives& out);

/// The largest of an inertia's mass, first moment and moments.
inline double inertia_size(const Inertia<double>& Y) {
  return std::max({std::abs(Y.m), Y.h.cwiseAbs().maxCoeff(), Y.I.cwiseAbs().maxCoeff()});
}

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
