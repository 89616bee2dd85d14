#pragma once
// RobotBlock: solves single-robot islands, with refinement and checks.

#include "robot_block.hpp"
#include "single.hpp"

namespace manycontact::lanes {

template <class S>
void RobotBlock<S>::solve(const Job& job, Robots robots, std::span<Answer> answers) {
  if constexpr (kSingle)
    use(own_.data());
  else
    use(reinterpret_cast<double*>(own_.data()));
  set_up(job, robots);
  keep(job.serial, robots);
  usable_ = factorize(usable_);
  if constexpr (kSingle) {
    usable_ = usable_ & (smallest_row_ > S(kLeft<S> * tolerance::kRank) * motion_);
    solve_unrefined(job.scene, robots);
  } else {
    if (rows_wait()) size_drifts(job.scene, robots);
    refine();
  }
  report(job, robots, answers);
  if (job.start) store_contact_velocities(job, robots);
  if constexpr (!kSingle) report_dependence(robots, answers);
}

/// Computes the factors L and D of K. Returns the usable elements (robots) in which each row has a sound pivot, or is a
/// row of J that joins the kept rows (joining_rows.hpp) or depends on them.
template <class S>
typename S::Mask RobotBlock<S>::factorize(Mask usable, Prefetch prefetch) {
  waiting_.clear();
  PivotJudge<S> judge;
  const auto inverse_of = [&](int k, const Number& d, const Number& terms) {
    const S pivot(d), diagonal = n_.K[pattern_.K.p[k + 1] - 1];
    const bool of_M = pattern_.perm[k] < pattern_.nv;
    const S own = of_M ? larger(diagonal, S(0)) : waiting_.largest_entry(k);
    const bool may_wait = may_wait_ && !of_M;
    const Mask sound = judge.accepts({of_M, pivot, S(terms), own, of_M ? S(-1) : waiting_.row_size(k)}, diagonal,
                                     may_wait ? waiting_.margin() : 1);
    S inverse = S(1) / pivot;
    if (!may_wait) {
      usable = usable & sound;
    } else if (!sound.all()) {
      waiting_.add(k, sound);
      inverse = select(sound, inverse, S(0));
    }
    return *as_scalar(&inverse);
  };
  sparse::ldl_scheduled_factor(schedule_, as_scalar(n_.K), as_scalar(n_.L), as_scalar(n_.D),
                               as_scalar(pivot_terms_.data()), prefetch, inverse_of);
  if (!rows_wait()) return usable;
  return waiting_.hold(usable, n_.K, n_.L, n_.D, pivot_terms_.data(), [this](S* x) { solve_by_factor(x); });
}

template <class S>
bool RobotBlock<S>::rows_wait() const {
  return !kSingle && waiting_.any();
}

/// Overwrites x with K^-1 x from L and D, without the border and the waiting rows, whose entries of x are destroyed.
template <class S>
void RobotBlock<S>::solve_by_factor(S* x) const {
  if (plan_->border() == 0)
    return sparse::ldl_scheduled_solve(schedule_, as_scalar(n_.L), as_scalar(n_.D), as_scalar(x));
  sparse::ldl_scheduled_forward(schedule_, as_scalar(n_.L), as_scalar(x));
  std::fill_n(x + rows_, plan_->border(), S(0));
  sparse::ldl_scheduled_backward(schedule_, as_scalar(n_.L), as_scalar(n_.D), as_scalar(x));
}

/// Overwrites x with K^-1 x. If rows are dependent, x must satisfy P x = 0, and becomes (I - P) K_kept^-1 x; P projects
/// on the null space of J^T, K_kept has the kept rows (Factor::correct).
template <class S>
void RobotBlock<S>::apply_inverse(S* x) {
  if (!rows_wait()) return solve_by_factor(x);
  waiting_.template before_solve<1>(as_scalar(x));
  solve_by_factor(x);
  waiting_.template after_solve<1>(as_scalar(x));
  waiting_.project_out(x);
}

/// Sets x += K^-1 r in elements (robots) flagged in `open`. Returns the elements where no
/// entry x_k changes by more than kSameSize |x_k|.
template <class S>
typename S::Mask RobotBlock<S>::correct(Mask open) {
  std::copy_n(r_.data(), rows_, n_.w);
  apply_inverse(n_.w);
  Mask same_sizes = all();
  for (int k = 0; k < rows_; ++k) {
    const S x = n_.x[k], step = select(open, n_.w[k], S(0));
    same_sizes = same_sizes & (abs(step) <= S(tolerance::kSameSize) * abs(x));
    n_.x[k] = select(open, x + step, x);
  }
  return same_sizes;
}

template <class S>
S RobotBlock<S>::residual() {  // r = b - K x, scale = |b| + |K| |x|; returns the backward error
  residual_and_sizes();
  return backward_error();
}

template <class S>
S RobotBlock<S>::backward_error() {  // componentwise backward error of residual r, or NaN
  const std::span<const S> r(r_.data(), static_cast<std::size_t>(rows_));
  if (!rows_wait()) return componentwise_error<S>(r, scale_.data());
  waiting_.scale_of_dependent(scale_.data(), n_.w);
  return componentwise_error<S>(r, n_.w);
}

/// Computes the residual after `correct`. same_sizes: the elements that `correct` returned, whose `scale` is reused.
template <class S>
S RobotBlock<S>::residual(Mask same_sizes) {
  if (same_sizes.all()) {
    sparse::ldl_scheduled_residual(pattern_.K, as_scalar(n_.K), as_scalar(n_.x), as_scalar(n_.b), as_scalar(r_.data()));
  } else {
    std::copy_n(scale_.data(), rows_, n_.w);
    residual_and_sizes();
    for (int k = 0; k < rows_; ++k) scale_[k] = select(same_sizes, n_.w[k], scale_[k]);
  }
  return backward_error();
}

template <class S>
void RobotBlock<S>::refine() {  // solves x = K^-1 b with refinement; each element takes its own number of steps
  if (rows_wait()) waiting_.take_out(n_.b);
  std::copy_n(n_.b, rows_, n_.x);
  apply_inverse(n_.x);
  const Refinement<S> refined(
      usable_, residual(), [&](Mask open) { return residual(correct(open)); }, tolerance::kRefinementSteps);
  steps_ = refined.steps, backward_error_ = refined.error, first_error_ = refined.first;
  usable_ = usable_ & (backward_error_ <= S(tolerance::kConverged));
  if (rows_wait()) restore_contradiction();
}

template <class S>
void RobotBlock<S>::report(const Job& job, Robots robots, std::span<Answer> answers) const {
  // Residuals are relative to the largest terms; for contact rows, relative to gravity if it is larger.
  const std::span<const int> rows(pattern_.iperm);
  const Largest<S> dynamics(0, rows.first(pattern_.nv), r_.data(), scale_.data());
  Largest<S> contact(S(0), rows.subspan(pattern_.nv), r_.data(), scale_.data());
  const S contact_terms = contact.scale;
  contact.scale = larger(contact.scale, S(job.scene.gravity.norm()));
  const Growth<S> growth(static_cast<std::size_t>(rows_), pivot_terms_.data(), diagonal());
  const S terms(growth.terms), entries(growth.diagonal);
  const Mask safe = terms * S(std::numeric_limits<double>::epsilon()) <= S(tolerance::kConverged) * entries;
  const S factor = select(entries > S(0), terms / entries, S(1));
  Mask sound = usable_ & (factor <= S(std::numeric_limits<typename S::Element>::max()));
  if constexpr (!kSingle) sound = sound & plainly_damped(job.scene.damping);  // solve_unrefined judges floats
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    Answer& answer = answers[l];
    answer.dependent = {};
    answer.sound = sound[lane];
    if (!answer.sound) continue;
    answer.panel_is_safe = safe[lane];
    answer.refine_panel = first_error_[lane] > tolerance::kRefinePanel;
    answer.refinement_steps = static_cast<int>(steps_[lane]);
    answer.backward_error = backward_error_[lane];
    answer.residual_dynamics = dynamics.ratio(lane);
    answer.residual_contact = contact.ratio(lane);
    answer.contact_terms = contact_terms[lane];
    scatter(job.scene, job.f_offset, robots[l], lane, job.a, job.f);
  }
}

/// Whether the terms of damped contact rows are at most kInDoubt delta |f|, so that their rounding errors change f by
/// at most 1 %. |f| counts as at least kLeastLoad times the largest term of the equations of motion.
template <class S>
typename S::Mask RobotBlock<S>::plainly_damped(double damping) const {
  if (!(damping > 0)) return all();
  S scale(0), force(0);
  for (int i = 0; i < rows_; ++i) {
    const int k = pattern_.iperm[i];
    if (i >= pattern_.nv) scale = larger(scale_[k], scale);
    force = larger(i < pattern_.nv ? S(tolerance::kLeastLoad) * scale_[k] : abs(n_.x[k]), force);
  }
  return scale <= S(tolerance::kInDoubt * damping) * force;
}

// ---- redundant rows (systems/matrix/fallbacks.cpp) ---------------------------------------------------------------

/// Computes the largest terms of each row's a0, relative to which the row's inconsistency is judged.
template <class S>
void RobotBlock<S>::size_drifts(const Scene& scene, Robots robots) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    const Vec3<S> place = c.B.robot < 0 ? standing_[k][1].origin : Vec3<S>(Vec3<S>::Zero());
    const auto& kin = robot_.kin;
    const auto terms = internal::bias_acceleration_terms<S>(c, contacts_[k], *model_, kin, *model_, kin, place);
    for (int i = 0; i < c.rows(); ++i) waiting_.row_terms(rows_of(k)[i]) = terms.of_row(i);
  }
}

template <class S>
void RobotBlock<S>::restore_contradiction() {  // adds to b and r the inconsistency that refine() subtracted
  const Mask of = waiting_.elements();
  for (int i = pattern_.nv; i < rows_; ++i) {
    const int k = pattern_.iperm[i];
    const S of_null = waiting_.null_component(k), b = n_.b[k] + of_null;
    scale_[k] = select(of, scale_[k] - abs(n_.b[k]) + abs(b), scale_[k]);
    r_[k] = select(of, r_[k] + of_null, r_[k]);
    n_.b[k] = select(of, b, n_.b[k]);
  }
  backward_error_ = select(of, componentwise_error<S>(r_, scale_.data()), backward_error_);
}

template <class S>
rank::Contradiction<S> RobotBlock<S>::contradicted() const {
  rank::Contradiction<S> out;
  const auto each_row = [this](auto&& use) {
    for (int i = pattern_.nv; i < rows_; ++i) use(pattern_.iperm[i]);
  };
  each_row([&](int k) { out.add_products(scale_[k] - abs(n_.b[k]), abs(n_.b[k])); });
  if (!rows_wait()) return out;
  const Mask of = waiting_.elements();
  out.add_rows([&](auto&& use) {
    each_row([&](int k) {
      use({select(of, waiting_.row_size(k), S(0)), waiting_.row_terms(k), waiting_.null_component(k)});
    });
  });
  return out;
}

template <class S>
void RobotBlock<S>::report_dependence(Robots robots, std::span<Answer> answers) {
  if (!rows_wait()) return;
  const rank::Contradiction<S> of = contradicted();
  for (std::size_t l = 0; l < robots.size(); ++l) {
    answers[l].dependent = waiting_.of(static_cast<int>(l));
    if (answers[l].dependent.empty()) continue;
    answers[l].contradiction = of.of_lane(static_cast<int>(l));
    if (answers[l].contradiction.needs_dense()) answers[l].sound = false;
    if (answers[l].contradiction.exceeds_rounding())  // only MatrixSystem has derivatives with inconsistency
      answers[l].panel_is_safe = false;
  }
}

/// Copies one robot's x = [a; -f] to the scene's a and f.
template <class S>
void RobotBlock<S>::scatter(const Scene& scene, const std::vector<int>& f_offset, const Robot& robot, int lane,
                            double* a, double* f) const {
  const int* iperm = pattern_.iperm.data();
  a += scene.robots[robot.number].idx_v;
  for (int i = 0; i < model_->nv; ++i) a[i] = n_.x[iperm[i]][lane];
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    double* to = f + f_offset[robot.contacts[k]];
    for (int i = 0; i < contact(k).rows(); ++i) to[i] = -n_.x[rows_of(k)[i]][lane];
  }
}

}  // namespace manycontact::lanes
