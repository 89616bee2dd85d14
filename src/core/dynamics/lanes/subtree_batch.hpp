#pragma once
// Implements SubtreeBatch with packs S = Pack<W>, for W subtrees of one shape at a time.

#include "../robot_quantities.hpp"
#include "arrays.hpp"
#include "checks.hpp"
#include "manycontact/algorithm/body_kinematics.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "subtrees.hpp"

namespace manycontact::lanes {

template <class S>
class SubtreeBatchOf final : public SubtreeBatch {
 public:
  using Mask = typename S::Mask;

  explicit SubtreeBatchOf(std::shared_ptr<const SubtreePlan> plan);
  void solve(std::span<Subtree> subtrees) override;

 private:
  void load(std::span<const Subtree> subtrees);
  void assemble_inertia();
  Mask assemble_rows();
  void act();
  S correct(Mask open);
  void store(const Refinement<S>& refined, std::span<Subtree> subtrees);

  std::shared_ptr<const SubtreePlan> plan_;
  const BodyPattern& p_;
  // terms of the subtrees (BodySystem), and the right-hand side
  std::vector<Vec3<S>> r_;
  Mat6X<S> S_, GA_, GB_;
  std::vector<Inertia<S>> Y_, Yc_;
  std::vector<Vec6<S>> c_, h_;
  std::vector<S> armature_, tau_, g_;
  // K, its factor and pivot terms; the solution x = [qdd; y] in K's order; accelerations and forces of bodies
  std::vector<S> K_, L_, D_, terms_, x_, step_;
  std::vector<Vec6<S>> a_, f_;
  std::vector<S> b_, left_, scale_;  // b, r = b - K x, |b| + |K| |x|, in K's order
  Mask usable_;
};

template <class S>
SubtreeBatchOf<S>::SubtreeBatchOf(std::shared_ptr<const SubtreePlan> plan)
    : plan_(std::move(plan)),
      p_(*plan_->pattern),
      r_(p_.nodes),
      S_(6, p_.nv),
      GA_(6, p_.nc),
      GB_(6, p_.nc),
      Y_(p_.nodes),
      Yc_(p_.nodes),
      c_(p_.nodes),
      h_(p_.nodes),
      armature_(p_.nv),
      tau_(p_.nv),
      g_(p_.nc),
      K_(plan_->K.nonzeros(), S(0)),
      L_(plan_->schedule.nonzeros()),
      D_(plan_->K.n),
      terms_(plan_->K.n),
      x_(plan_->K.n),
      step_(plan_->K.n),
      a_(p_.nodes),
      f_(p_.nodes),
      b_(plan_->K.n),
      left_(plan_->K.n),
      scale_(plan_->K.n) {}

template <class S>
void SubtreeBatchOf<S>::solve(std::span<Subtree> subtrees) {
  load(subtrees);
  assemble_inertia();
  usable_ = assemble_rows();
  sparse::ldl_scheduled_factor(plan_->schedule, K_.data(), L_.data(), D_.data(), terms_.data());
  PivotJudge<S> judge;
  for (int k = 0; k < plan_->K.n; ++k) {
    const S own = K_[plan_->K.p[k + 1] - 1];
    usable_ = usable_ & judge.accepts({k < p_.nv, D_[k], terms_[k], larger(own, S(0))}, own);
  }

  std::fill(x_.begin(), x_.end(), S(0));
  act();
  b_ = left_;
  const Refinement<S> refined(usable_, correct(usable_), [&](Mask open) { return correct(open); });
  usable_ = usable_ & (refined.error <= S(tolerance::kConverged));
  store(refined, subtrees);
}

template <class S>
void SubtreeBatchOf<S>::load(std::span<const Subtree> subtrees) {
  const double* from[8];
  const auto load = [&](int count, S* to, auto&& at) {
    if (count > 0)
      load_arrays(side_by_side(subtrees, from, [&](const Subtree& subtree) { return at(subtree); }), count, to);
  };
  const auto system = [&](int count, S* to, auto&& at) {
    load(count, to, [&](const Subtree& p) { return at(*p.system); });
  };
  const auto given = [&](int count, S* to, auto&& at) {
    load(count, to, [&](const Subtree& p) { return at(p.solution->b); });
  };
  static_assert(sizeof(Inertia<double>) == 13 * sizeof(double) && sizeof(Inertia<S>) == 13 * sizeof(S));
  system(3 * p_.nodes, r_.front().data(), [](const BodySystem& s) { return s.r.front().data(); });
  system(6 * p_.nv, S_.data(), [](const BodySystem& s) { return s.S.data(); });
  system(13 * p_.nodes, &Y_.front().m, [](const BodySystem& s) { return &s.Y.front().m; });
  system(p_.nv, armature_.data(), [](const BodySystem& s) { return s.armature.data(); });
  system(6 * p_.nc, GA_.data(), [](const BodySystem& s) { return s.GA.data(); });
  system(6 * p_.nc, GB_.data(), [](const BodySystem& s) { return s.GB.data(); });
  given(6 * p_.nodes, c_.front().data(), [](const BodyVectors& b) { return b.motion.front().data(); });
  given(6 * p_.nodes, h_.front().data(), [](const BodyVectors& b) { return b.force.front().data(); });
  given(p_.nv, tau_.data(), [](const BodyVectors& b) { return b.joints.data(); });
  given(p_.nc, g_.data(), [](const BodyVectors& b) { return b.rows.data(); });
}

/// Writes M into K: M_kj = S_j^T F_k for coordinates j of ancestors. F_k = Yc S_k, transformed to the ancestor's node.
template <class S>
void SubtreeBatchOf<S>::assemble_inertia() {
  const int* slot = plan_->M_slot.data();
  Yc_ = Y_;
  for (int i = p_.nodes - 1; i >= 0; --i) {
    const int first = p_.first_dof[i];
    for (int k = first; k < first + p_.ndof[i]; ++k) {
      Vec6<S> F = Yc_[i] * S_.col(k);
      for (int j = first; j <= k; ++j) K_[*slot++] = dot(S_.col(j), F);
      S& own = K_[slot[-1]];
      own = internal::without_rounding<S>(own + armature_[k], S_.col(k), Yc_[i]);
      for (int node = i; p_.parent[node] >= 0;) {
        F = force_from(F, r_[node]);
        node = p_.parent[node];
        for (int j = p_.first_dof[node]; j < p_.first_dof[node] + p_.ndof[node]; ++j) K_[*slot++] = dot(S_.col(j), F);
      }
    }
    if (p_.parent[i] >= 0) Yc_[p_.parent[i]] += Yc_[i].seen_at(r_[i]);
  }
}

/// Writes J into K. Returns the elements in which every row has an entry above rounding errors (kPlainlyMoves).
template <class S>
typename S::Mask SubtreeBatchOf<S>::assemble_rows() {
  const int* slot = plan_->J_slot.data();
  Mask all_move = S(0) <= S(0);
  for (int row = 0; row < p_.nc; ++row) {
    Mask moves = S(0) < S(0);
    const auto climb = [&](int node, Vec6<S> G) {
      Vec6<S> sizes = G.cwiseAbs();  // magnitudes of G's terms, computed until J is above rounding in all elements
      for (; node != plan_->meeting[row]; node = p_.parent[node]) {
        for (int j = p_.first_dof[node]; j < p_.first_dof[node] + p_.ndof[node]; ++j) {
          const S J = dot(S_.col(j), G);
          K_[*slot++] = J;
          if (moves.all()) continue;
          const S size = dot(S_.col(j).cwiseAbs(), sizes);
          moves.bits = moves.bits | ((abs(J) > S(tolerance::kPlainlyMoves) * size) & (size > S(0))).bits;
        }
        if (!moves.all()) sizes.template tail<3>() += cross_sizes<S>(r_[node].cwiseAbs(), sizes.template head<3>());
        G = force_from(G, r_[node]);
      }
    };
    climb(p_.A[row], GA_.col(row));
    climb(p_.B[row], GB_.col(row));
    all_move = all_move & moves;
  }
  return all_move;
}

/// Computes from x the bodies' accelerations, the joints' forces, and the residual; for x = 0 the residual is b.
template <class S>
void SubtreeBatchOf<S>::act() {
  for (int i = 0; i < p_.nodes; ++i) {
    a_[i] = c_[i];
    if (const int parent = p_.parent[i]; parent >= 0) a_[i] += motion_at(a_[parent], r_[i]);
    for (int k = p_.first_dof[i]; k < p_.first_dof[i] + p_.ndof[i]; ++k) a_[i] += S_.col(k) * x_[plan_->place(k)];
    f_[i] = h_[i] + Y_[i] * a_[i];
  }
  for (int row = 0; row < p_.nc; ++row) {
    const int at = plan_->place_of_row(row);
    left_[at] = g_[row];
    const auto end = [&](int node, const auto& G) {
      if (node < 0) return;
      left_[at] -= dot(G, a_[node]);
      f_[node] += G * x_[at];
    };
    end(p_.A[row], GA_.col(row));
    end(p_.B[row], GB_.col(row));
  }
  for (int i = p_.nodes - 1; i >= 0; --i) {
    for (int k = p_.first_dof[i]; k < p_.first_dof[i] + p_.ndof[i]; ++k) {
      const int at = plan_->place(k);
      left_[at] = tau_[k] - dot(S_.col(k), f_[i]) - armature_[k] * x_[at];
    }
    if (p_.parent[i] >= 0) f_[p_.parent[i]] += force_from(f_[i], r_[i]);
  }
}

/// Sets x += K^-1 r in subtrees flagged in `open`; then r = b - K x. Returns the error |r| / (|b| + |K| |x|), or NaN.
template <class S>
S SubtreeBatchOf<S>::correct(Mask open) {
  step_ = left_;
  sparse::ldl_scheduled_solve(plan_->schedule, L_.data(), D_.data(), step_.data());
  for (std::size_t k = 0; k < x_.size(); ++k) x_[k] += select(open, step_[k], S(0));
  sparse::ldl_scheduled_residual(plan_->K, K_.data(), x_.data(), b_.data(), left_.data(), scale_.data());
  return componentwise_error<S>(left_, scale_.data());
}

template <class S>
void SubtreeBatchOf<S>::store(const Refinement<S>& refined, std::span<Subtree> subtrees) {
  const std::size_t nv = static_cast<std::size_t>(p_.nv), nc = static_cast<std::size_t>(p_.nc);
  const Largest<S> dynamics(0, nv, left_.data(), scale_.data());
  const Largest<S> contact(0, nc, left_.data() + nv, scale_.data() + nv);
  act();  // computes the forces on the bases
  for (std::size_t l = 0; l < subtrees.size(); ++l) {
    const int lane = static_cast<int>(l);
    Subtree& subtree = subtrees[l];
    subtree.sound = usable_[lane];
    if (!subtree.sound) continue;
    subtree.factor_nonzeros = plan_->schedule.nonzeros() + plan_->K.n;
    subtree.refinement = {static_cast<int>(refined.steps[lane]), refined.error[lane], refined.first[lane]};
    BodySolve& out = *subtree.solution;
    for (int k = 0; k < p_.nv; ++k) out.x.joints[k] = x_[plan_->place(k)][lane];
    for (int k = 0; k < p_.nc; ++k) out.x.rows[k] = x_[plan_->place_of_row(k)][lane];
    for (int i = 0; i < p_.nodes; i = p_.end[i])
      for (int k = 0; k < 6; ++k) out.x.force[i][k] = f_[i][k][lane];
    out.residual.dynamics = dynamics.r[lane], out.residual.dynamics_scale = dynamics.scale[lane];
    out.residual.contact = contact.r[lane], out.residual.contact_scale = contact.scale[lane];
  }
}

}  // namespace manycontact::lanes
