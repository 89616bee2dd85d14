#pragma once
// Steps of solve(), one file each.

#include <algorithm>
#include <cmath>

#include "manycontact/dynamics/solve.hpp"

namespace manycontact::internal {

/// Why this island's input cannot be used, kNone if it can.
Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                   const Island& island);
/// Kinematics, bias, inertia and contact rows of an island's robots.
void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, SceneData& data, const Island& island);
/// K and b = [data.tau - h; -a0] of what was evaluated, in the elimination order of `pattern`.
void assemble_island(const Scene& scene, const SceneData& data, const std::shared_ptr<const KktPattern>& pattern,
                     IslandData& island);

/// Below this, what is left of a pivot after cancellation no longer tells a small number from none.
inline constexpr double kSmallestPivotRatio = 1e-11;
inline constexpr int kRefinementSteps = 5;

/// Room for the island's LDL, and what the report says of it.
inline void begin_ldl(IslandData& d, IslandReport& report) {
  const KktPattern& p = *d.system.pattern;
  d.Lx.resize(p.ldl.nonzeros());
  d.D.resize(p.size());
  report.method = Method::kSparseLdl;
  report.order = p.order;
  report.factor_nonzeros = p.ldl.nonzeros() + p.size();
}

/// Each tries one factorization of the assembled system and solves it with refinement. kNone: the answer is sound.
Reason solve_ldl(SceneData& data, IslandData& island, IslandReport& report);
Reason solve_cholmod(IslandData& island, IslandReport& report);
Reason solve_supernodal(const Scene& scene, IslandData& island, IslandReport& report);
/// Drops rows of J that depend on others (damping 0), in leaf-to-root order; sets status and rank. kNone also when none
/// does.
Reason solve_dependent(const Scene& scene, SceneData& data, IslandData& island, IslandReport& report);
/// The oracle; sets status, rank and reason by itself.
void solve_dense(const Scene& scene, const SceneData& data, IslandData& island, IslandReport& report);
/// All islands at once, after evaluate; sets all of the report.
void solve_dense_schur(const Scene& scene, SceneData& data);

/// Solves in place with the factor at hand, in elimination order.
void solve_with_factor(const Scene& scene, IslandData& island, double* x);

/// Throws std::logic_error, in the name of `function`, unless data holds a solve with the contacts now active.
void check_solved(const SceneData& data, const char* function);
/// Terms of an island's derivatives, at the last solve: RNEA's and the contacts'.
void derivative_terms(const Scene& scene, SceneData& data, const IslandData& island);
/// Adds to -dr1/dq of an island (nv x nv) what a contact's force does beyond a force fixed to its bodies: B's half
/// moves with A, and a world-aligned frame does not turn. columns: of the contact; oA, oB: first coordinates of its
/// robots.
void force_columns(const ContactData<double>& rows, const ContactDerivatives& d, const std::vector<int>& columns,
                   int oA, int oB, Eigen::Ref<IslandDerivatives::Panel, 0, Eigen::OuterStride<>> X);
/// -dr into the panel out.X, which has its size. After derivative_terms.
void derivative_rhs(const Scene& scene, SceneData& data, const IslandData& island, IslandDerivatives& out);
/// data.derivatives, with places for the islands at hand.
DerivativeData& prepare_derivatives(const Scene& scene, SceneData& data);
/// Sizes and places of an island's blocks.
void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out);
/// All of an island's derivatives into `out`, by the factor at hand (dense-schur: the right-hand sides only).
void differentiate_island(const Scene& scene, SceneData& data, std::size_t island, IslandDerivatives& out);
/// Where the contacts contradict each other, a solves J^T (J a + a0) = 0: adds to -dr2 what the turning of J^T does.
void add_contradiction(const Scene& scene, SceneData& data, IslandData& island, DependentDerivatives& work,
                       IslandDerivatives& out);
/// Whether the island's contact rows were found dependent.
inline bool rank_deficient(const IslandData& d) {
  if (d.factor == Factor::kDependent) return !d.rows.dropped.empty();
  return d.factor == Factor::kDense && d.dense->delta == 0 && d.dense->rank < d.island.nc;
}
/// report.dependent_rows from rows of the island's J.
template <class Rows>
void name_dependent_rows(const SceneData& data, const Island& island, const Rows& rows, IslandReport& report) {
  report.dependent_rows.clear();
  for (int row : rows) {
    std::size_t c = island.contacts.size() - 1;
    while (island.row_offset[c] > row) --c;
    report.dependent_rows.push_back(data.f_offset[island.contacts[c]] + row - island.row_offset[c]);
  }
  std::sort(report.dependent_rows.begin(), report.dependent_rows.end());
}
/// Whether a row of the island's J is nothing but rounding beside the contacts' motions: no pivot shows that.
bool has_vanishing_row(const Scene& scene, const SceneData& data, const IslandData& island);
/// residual_dynamics and residual_contact from a system's r and scale.
void report_residuals(const Scene& scene, const KktSystem& system, IslandReport& report);
/// Contradiction, by the definition of design: |J a + a0| > 1e-8 (| |J| |a| | + |a0|), maximum norms. Where contacts
/// hold everything all of these are rounding of the terms of `size` (drift_size): that is no contradiction.
inline bool contradictory(double left, double Ja, double a0, double size) {
  return left > 1e-8 * (Ja + a0) && left > 1e-13 * size;
}
/// The largest term that the contacts' a0 are computed from, and gravity.
inline double drift_size(const Scene& scene, const SceneData& data, const Island& island) {
  double largest = scene.gravity.norm();
  for (int c : island.contacts) {
    const ContactData<double>& rows = data.contacts[c];
    const double v = std::max(rows.vA.cwiseAbs().maxCoeff(), rows.vB.cwiseAbs().maxCoeff());
    largest = std::max({largest, rows.aA.cwiseAbs().maxCoeff(), rows.aB.cwiseAbs().maxCoeff(), v * v,
                        std::abs(scene.contacts[c].beta) * v});
  }
  return largest;
}
/// The largest of the contacts' motion_size (contact/rows.hpp).
inline double motion_size(const Scene& scene, const SceneData& data, const Island& island) {
  double largest = 0;
  for (int c : island.contacts)
    largest = std::max(largest, manycontact::motion_size(scene.contacts[c], data.contacts[c]));
  return largest;
}
/// Overwrites the panel of right-hand sides with [da; -df], by the factor at hand.
void solve_panel(const Scene& scene, SceneData& data, IslandData& island, IslandDerivatives& out);
/// Adds to dforces_dq what keeps the forces of least norm, where rows are dependent.
void least_norm_forces(const Scene& scene, SceneData& data, IslandData& island, DependentDerivatives& work,
                       IslandDerivatives& out);
/// dense-schur: explicit inverse of the whole scene's K, times all right-hand sides, as Crocoddyl does.
void differentiate_dense_schur(const Scene& scene, SceneData& data);

/// Between an island's vector in elimination order, x = [a; y], and the scene's: a in the order of v, y in that of f.
template <class X, class A, class Y>
void scatter(const Scene& scene, const SceneData& data, const IslandData& d, const X* x, A& a, Y& y) {
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

/// Forces of an island's contacts on its robots' bodies, in their tree frames, into fext(robot)[joint].
template <class Fext>
void contact_forces(const Scene& scene, const SceneData& data, const Island& island, Fext&& fext) {
  for (int r : island.robots) std::fill(fext(r).begin(), fext(r).end(), Vec6<double>(Vec6<double>::Zero()));
  for (int c : island.contacts) {
    const Contact& contact = scene.contacts[c];
    const ContactData<double>& rows = data.contacts[c];
    Vec6<double> F;
    F.noalias() = rows.W.transpose() * data.f.segment(data.f_offset[c], contact.rows());
    if (contact.A.joint >= 0) fext(contact.A.robot)[contact.A.joint] += rows.aMA.act_force(F);
    if (contact.B.robot >= 0 && contact.B.joint >= 0) fext(contact.B.robot)[contact.B.joint] -= rows.bMA.act_force(F);
  }
}

/// Whether refinement ended well enough to be believed.
inline bool converged(const Refinement& r) { return r.backward_error <= 1e-12; }

}  // namespace manycontact::internal
