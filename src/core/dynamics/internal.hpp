#pragma once

#include <algorithm>
#include <cmath>
#include <functional>

#include "manycontact/detail/algorithm/crba.hpp"
#include "manycontact/sparse/largest.hpp"
#include "workspace/workspace.hpp"

namespace manycontact::internal {

/// Solves a prepared scene. prescribed: prescribed accelerations of constraint rows, in f's order; all zero if empty.
const Report& solve_prepared(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                             SceneData& data, std::span<const double> prescribed = {});
void prepare_checked(const Scene& scene, SceneData& data);  // prepares a scene that check_scene has accepted
/// Sets up Workspace::islands for all contacts; `prepare` skips this if it uses a Reduction.
void prepare_islands(const Scene& scene, const SceneData& data);
/// Returns why this island's input cannot be used; kNone if it can.
Reason check_input(const Scene& scene, const ConstVector& q, const ConstVector& v, const ConstVector& tau,
                   const Island& island);
void reset(IslandReport& report, const Island& island);  // to an unsolved island; keeps dependent_rows' capacity
/// Sets report.dependent_rows to the sorted indices in data.f of the island's constraint rows `rows`.
void name_dependent_rows(const SceneData& data, const Island& island, std::span<const int> rows, IslandReport& report);
inline double prescribed_in(const SceneData& data, int contact, Eigen::Index i) {  // acceleration of a contact's row i
  const std::vector<double>& prescribed = data.workspace->prescribed;
  return prescribed.empty() ? 0 : prescribed[data.f_offset[contact] + i];
}

/// Returns the stored ContactData::left of a pair: its contacts' inconsistency; nullptr if the contact is no pair.
inline double* left_of(Workspace& w, int contact) {
  const int at = w.left_offset[contact];
  return at < 0 ? nullptr : w.left.data() + at;
}
inline void keep_left(Workspace& w, int contact, const ContactData<double>& rows) {
  if (double* left = left_of(w, contact)) std::copy_n(rows.left.data(), rows.left.size(), left);
}

inline ProductWork& products_of(const Scene& scene, Workspace& w) {  // constructed at the first call
  if (!w.products) w.products = std::make_unique<ProductWork>(scene);
  return *w.products;
}

/// Calls use(system) with the system that solved, then with MatrixSystem, until one succeeds; returns whether it did.
template <class Use>
bool ask(const Scene& scene, const SceneData& data, IslandWork& d, ThreadWork& thread, Use&& use) {
  if (!d.answered) return false;
  if (use(*d.answered)) return true;
  return d.answered != &d.matrix && d.matrix.make_current(scene, data, thread) && use(d.matrix);
}

/// Computes error bounds of a and f with |K^-1| (mathematics.md) and stores them in the islands' reports.
void bound_errors(const Scene& scene, SceneData& data);

/// Whether the inconsistency `of` exceeds the rounding errors of accelerations due to gravity or torques.
bool contradicts(const Scene& scene, const SceneData& data, rank::Contradiction<double> of, IslandWork& island);

/// Larger derivatives [bytes] are written past the caches, as they exceed a core's share of the last-level cache.
inline constexpr std::size_t kCacheBytes = 4 << 20;

bool has_derivatives(const SceneData& data);  // whether those of the current solution have been computed
/// Sets u_offset, nu and cols of an island's derivatives, i.e. the columns with respect to torques, from out.request.
void number_torques(const Scene& scene, const Island& island, IslandDerivatives& out);
/// Sets the sizes and offsets of an island's blocks of derivatives, and allocates the panels with zeros.
void lay_out(const Scene& scene, const Island& island, const DerivativeRequest& request, IslandDerivatives& out);
/// Overwrites out.X, after lay_out, with -dr, the right-hand sides of K [da; -df] = -dr. Requires an AtSolution.
void right_hand_sides(const Scene& scene, SceneData& data, const IslandWork& island, IslandDerivatives& out);

/// Returns |K^-1|_1 of an n x n K; solve(x) overwrites x with K^-1 x. The result is exact for n <= kSmallInverse, from
/// all columns, in at most the time of a factorization; otherwise it is an estimate.
double inverse_norm(int n, const std::function<void(double*)>& solve);

/// Reports the largest residuals r of dynamics rows [0] and contact rows [1], relative to the largest terms (`scale`).
/// For contact rows, the terms count at least as much as gravity, since at rest they are rounding errors themselves.
inline void report_residuals(const Scene& scene, const double (&r)[2], const double (&scale)[2], IslandReport& report) {
  report.residual_dynamics = r[0] == 0 ? 0 : r[0] / scale[0];
  report.residual_contact = r[1] == 0 ? 0 : r[1] / std::max(scale[1], scene.gravity.norm());
  report.contact_terms = scale[1];
}
/// Reports the error bounds of a and f. If a bound exceeds the solution and the loads, the status becomes kRegularised.
inline void report_bounds(const Known& a, const Known& f, IslandReport& report) {
  report.error_acceleration = a.relative();
  report.error_forces = f.relative();
  if ((a.uncertain() || f.uncertain()) && (report.status == Status::kOk || report.status == Status::kRedundant))
    report.status = Status::kRegularised, report.reason = Reason::kUncertain;
}

inline bool is_angular(const Joint& joint, int k) {  // whether the k-th velocity coordinate is an angular velocity
  if (joint.type == JointType::kFloating) return k >= 3;
  return joint.type == JointType::kRevolute || (joint.type == JointType::kPlanar && k == 2);
}

inline double inertia_size(const Inertia<double>& Y) {  // the largest magnitude of mass, first moment and moments
  return std::max({std::abs(Y.m), Y.h.cwiseAbs().maxCoeff(), Y.I.cwiseAbs().maxCoeff()});
}

/// Copy an island's x = [a; y], in elimination order, to (scatter) or from (gather) the scene's a and y.
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

/// Returns the largest absolute entry of an island's forces; NaN if one is NaN.
inline double largest_force(const Scene& scene, const std::vector<int>& f_offset, const Island& island,
                            const Eigen::VectorXd& f) {
  double out = 0;
  each_force_block(scene, f_offset, island, [&](int first, int, int n) {
    for (int i = 0; i < n; ++i) out = sparse::larger_or_nan(out, std::abs(f[first + i]));
  });
  return out;
}

}  // namespace manycontact::internal
