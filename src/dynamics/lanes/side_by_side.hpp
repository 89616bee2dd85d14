#pragma once
// W islands of one robot each, side by side in the lanes of S = Pack<W>: the steps of a solve (dynamics/evaluate.cpp,
// kkt/factor/ldl.cpp, kkt/factor/refined.cpp), each for all lanes at once.

#include <algorithm>
#include <limits>

#include "lanes.hpp"
#include "manycontact/algorithm/crba.hpp"
#include "manycontact/algorithm/rnea.hpp"
#include "manycontact/sparse/ldl_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lanes {

template <class S>
class SideBySide {
 public:
  static constexpr int W = S::width;
  using Mask = typename S::Mask;

  SideBySide(const Scene& scene, const Island& island, const IslandSupport& support,
             std::shared_ptr<const KktPattern> pattern);
  void solve(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers);

 private:
  const double* lane_of(const double* all, int first) const { return all + first; }
  void load(const Job& job, std::span<const Island* const> islands);
  void evaluate(const Scene& scene, const Island& island);
  void drop_rounding();
  void assemble(double damping, const Island& island);
  Mask believable_rows(const Scene& scene, const Island& island, double damping) const;
  Mask believable_pivots() const;
  S residual();
  void refine();
  void store(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) const;

  std::shared_ptr<const Model> model_;
  std::shared_ptr<const KktPattern> pattern_;
  std::vector<ContactSupport> supports_;

  VecX<S> q_, v_, tau_, h_;
  SE3<S> base_;
  std::vector<SE3<S>> bMB_;  // per contact, where B is the world: its placement
  Mask usable_;              // q, v, tau are finite, quaternions of unit length

  Kinematics<S> kin_;
  std::vector<Inertia<S>> Yc_;
  std::vector<Vec6<S>> f_;
  std::vector<ContactData<S>> contacts_;

  std::vector<S> M_;          // packed
  std::vector<S> K_, L_, D_;  // as KktMatrix, LdlSymbolic have them
  std::vector<S> pivot_terms_, b_, x_, r_, scale_, correction_;
  S steps_, backward_error_;
};

template <class S>
SideBySide<S>::SideBySide(const Scene& scene, const Island& island, const IslandSupport& support,
                          std::shared_ptr<const KktPattern> pattern)
    : model_(scene.robots[island.robots.front()].model),
      pattern_(std::move(pattern)),
      supports_(support.contacts),
      q_(model_->nq),
      v_(model_->nv),
      tau_(model_->nv),
      h_(model_->nv),
      bMB_(island.contacts.size()),
      kin_(*model_),
      Yc_(model_->njoints()),
      f_(model_->njoints()),
      M_(model_->M_begin[model_->nv]),
      K_(pattern_->K.nonzeros()),
      L_(pattern_->ldl.nonzeros()),
      D_(pattern_->size()),
      pivot_terms_(pattern_->size()),
      b_(pattern_->size()),
      x_(pattern_->size()),
      r_(pattern_->size()),
      scale_(pattern_->size()),
      correction_(pattern_->size()) {
  for (std::size_t k = 0; k < island.contacts.size(); ++k)
    contacts_.emplace_back(scene.contacts[island.contacts[k]], supports_[k]);
}

template <class S>
void SideBySide<S>::solve(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) {
  const Scene& scene = job.scene;
  const Island& first = *islands.front();
  load(job, islands);
  evaluate(scene, first);
  assemble(scene.damping, first);
  sparse::ldl_scheduled_factor(pattern_->schedule(), K_.data(), L_.data(), D_.data(), pivot_terms_.data());
  usable_ = usable_ & believable_rows(scene, first, scene.damping) & believable_pivots();
  refine();
  store(job, islands, answers);
}

/// Lanes without an island of their own repeat the last one.
template <class S>
void SideBySide<S>::load(const Job& job, std::span<const Island* const> islands) {
  for (int l = 0; l < W; ++l) {
    const Island& island = *islands[std::min<std::size_t>(l, islands.size() - 1)];
    const Robot& robot = job.scene.robots[island.robots.front()];
    for (int i = 0; i < model_->nq; ++i) q_[i].set(l, job.q[robot.idx_q + i]);
    for (int i = 0; i < model_->nv; ++i) v_[i].set(l, job.v[robot.idx_v + i]);
    for (int i = 0; i < model_->nv; ++i) tau_[i].set(l, job.tau[robot.idx_v + i]);
    const auto place = [l](const SE3<double>& from, SE3<S>& to) {
      for (int i = 0; i < 9; ++i) to.R.data()[i].set(l, from.R.data()[i]);
      for (int i = 0; i < 3; ++i) to.p[i].set(l, from.p[i]);
    };
    place(robot.base, base_);
    for (std::size_t k = 0; k < bMB_.size(); ++k) place(job.scene.contacts[island.contacts[k]].B.placement, bMB_[k]);
  }
  // finite numbers times zero are zero
  S sum(0);
  for (const VecX<S>* x : {&q_, &v_, &tau_})
    for (Eigen::Index i = 0; i < x->size(); ++i) sum += (*x)[i] * S(0);
  usable_ = sum <= S(0);
  for (const Joint& joint : model_->joints) {
    if (joint.type != JointType::kFloating) continue;
    const S norm2 = q_.template segment<4>(joint.idx_q + 3).squaredNorm();
    usable_ = usable_ & (abs(norm2 - S(1)) <= S(tolerance::kQuaternion));
  }
}

template <class S>
void SideBySide<S>::evaluate(const Scene& scene, const Island& island) {
  forward_kinematics<S>(*model_, base_, q_, kin_);
  forward_accelerations<S>(*model_, v_, nullptr, scene.gravity, kin_);
  inverse_dynamics<S>(*model_, kin_, nullptr, {}, f_, h_);  // h = ID(q, v, 0)
  crba<S>(*model_, kin_, Yc_, M_.data());
  drop_rounding();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    const SE3<S> aMA = kin_.oMi[contact.A.joint] * contact.A.placement.cast<S>();
    if (contact.B.robot < 0)
      contact_rows_between<S>(scene.gravity, contact, supports_[k], kin_, aMA, nullptr, bMB_[k], contacts_[k]);
    else
      contact_rows_between<S>(scene.gravity, contact, supports_[k], kin_, aMA, &kin_,
                              kin_.oMi[contact.B.joint] * contact.B.placement.cast<S>(), contacts_[k]);
  }
}

template <class S>
void SideBySide<S>::drop_rounding() {
  const S rounding(tolerance::kRounding * std::numeric_limits<double>::epsilon());
  for (int i = 0; i < model_->nv; ++i) {
    const Inertia<S>& Y = Yc_[model_->dof_joint[i]];
    const auto J = kin_.J.col(i);
    S& m = M_[model_->M_begin[i]];
    const S terms = J.template head<3>().squaredNorm() * Y.m + J.template tail<3>().squaredNorm() * Y.I.trace();
    m = select(abs(m) <= rounding * terms, S(0), m);
  }
}

template <class S>
void SideBySide<S>::assemble(double damping, const Island& island) {
  const KktPattern& p = *pattern_;
  for (std::size_t k = 0; k < M_.size(); ++k) K_[p.M_slot[k]] = M_[k];
  const int* slot = p.J_slot.data();
  for (const ContactData<S>& rows : contacts_)
    for (Eigen::Index k = 0; k < rows.J.size(); ++k) K_[*slot++] = rows.J.data()[k];
  for (int k : p.diagonal_slot) K_[k] = S(-damping);

  for (int i = 0; i < model_->nv; ++i) b_[p.iperm[i]] = tau_[i] - h_[i];  // b = [tau - h; -a0]
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const int* to = p.iperm.data() + island.nv + island.row_offset[k];
    for (Eigen::Index i = 0; i < contacts_[k].a0.size(); ++i) b_[to[i]] = -contacts_[k].a0[i];
  }
}

/// No row of J is nothing but rounding beside the contacts' motions: pivots do not show that.
template <class S>
typename S::Mask SideBySide<S>::believable_rows(const Scene& scene, const Island& island, double damping) const {
  S smallest(std::numeric_limits<double>::infinity()), motion(0);
  if (damping > 0 || contacts_.empty()) return smallest > motion;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const ContactData<S>& rows = contacts_[k];
    motion = larger(motion_size(scene.contacts[island.contacts[k]], rows), motion);
    for (Eigen::Index i = 0; i < rows.J.rows(); ++i) {
      S size(0);
      for (Eigen::Index j = 0; j < rows.J.cols(); ++j) size = larger(abs(rows.J(i, j)), size);
      smallest = -larger(-size, -smallest);
    }
  }
  return smallest > S(tolerance::kRank) * motion;
}

/// K's inertia is (nv, nc, 0), and no pivot was lost in cancellation.
template <class S>
typename S::Mask SideBySide<S>::believable_pivots() const {
  const S largest(std::numeric_limits<double>::max());
  S positive(0);
  Mask good = abs(D_[0]) <= largest;
  for (std::size_t k = 0; k < D_.size(); ++k) {
    positive += select(D_[k] > S(0), S(1), S(0));
    const S size = abs(D_[k]);
    good = good & (size > S(0)) & (size <= largest) & (size >= S(tolerance::kPivotLeft) * pivot_terms_[k]);
  }
  const S nv(pattern_->nv);
  return good & (positive >= nv) & (positive <= nv);
}

/// r = b - K x, scale = |b| + |K| |x|, and the componentwise backward error (sparse/refine.hpp); NaN where any is.
template <class S>
S SideBySide<S>::residual() {
  sparse::ldl_scheduled_residual(pattern_->K, K_.data(), x_.data(), b_.data(), r_.data(), scale_.data());
  S largest(0), sum(0);
  for (const S& s : scale_) largest = larger(s, largest);
  const S floor = largest * S(std::numeric_limits<double>::epsilon());
  S error(0);
  for (std::size_t k = 0; k < r_.size(); ++k) {
    const S bound = larger(scale_[k], floor), size = abs(r_[k]);
    sum += size + bound;
    error = larger(select(size > S(0), size / bound, S(0)), error);
  }
  return error + sum * S(0);
}

/// x = K^-1 b, each lane refined as if it stood alone (sparse/refine.hpp).
template <class S>
void SideBySide<S>::refine() {
  const sparse::LdlSchedule& schedule = pattern_->schedule();
  x_ = b_;
  sparse::ldl_scheduled_solve(schedule, L_.data(), D_.data(), x_.data());
  steps_ = S(0);
  backward_error_ = residual();
  Mask open = usable_ & (backward_error_ > S(tolerance::kRefined));
  for (int step = 0; step < tolerance::kRefinementSteps && open.any(); ++step) {
    correction_ = r_;
    sparse::ldl_scheduled_solve(schedule, L_.data(), D_.data(), correction_.data());
    for (std::size_t k = 0; k < x_.size(); ++k) x_[k] = select(open, x_[k] + correction_[k], x_[k]);
    steps_ += select(open, S(1), S(0));
    const S before = backward_error_;
    backward_error_ = residual();
    open = open & (backward_error_ < S(0.5) * before) & (backward_error_ > S(tolerance::kRefined));
  }
  usable_ = usable_ & (backward_error_ <= S(tolerance::kConverged));
}

template <class S>
void SideBySide<S>::store(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) const {
  const KktPattern& p = *pattern_;
  // Residuals relative to the terms they are left of; those of the contacts at least to gravity.
  S r[2] = {0, 0}, scale[2] = {0, job.scene.gravity.norm()};
  for (int k = 0; k < p.size(); ++k) {
    const int row = p.perm[k] >= p.nv;
    r[row] = larger(abs(r_[k]), r[row]);
    scale[row] = larger(scale_[k], scale[row]);
  }
  for (std::size_t l = 0; l < islands.size(); ++l) {
    const int lane = static_cast<int>(l);
    Answer& answer = answers[l];
    answer.sound = usable_[lane];
    if (!answer.sound) continue;
    answer.refinement_steps = static_cast<int>(steps_[lane]);
    answer.backward_error = backward_error_[lane];
    answer.residual_dynamics = r[0][lane] == 0 ? 0 : r[0][lane] / scale[0][lane];
    answer.residual_contact = r[1][lane] == 0 ? 0 : r[1][lane] / scale[1][lane];
    const Island& island = *islands[l];
    double* a = job.a + job.scene.robots[island.robots.front()].idx_v;
    for (int i = 0; i < island.nv; ++i) a[i] = x_[p.iperm[i]][lane];
    for (std::size_t k = 0; k < island.contacts.size(); ++k) {
      double* f = job.f + job.f_offset[island.contacts[k]];
      const int* from = p.iperm.data() + island.nv + island.row_offset[k];
      for (Eigen::Index i = 0; i < contacts_[k].a0.size(); ++i) f[i] = -x_[from[i]][lane];  // x = [a; -f]
    }
  }
}

}  // namespace manycontact::lanes
