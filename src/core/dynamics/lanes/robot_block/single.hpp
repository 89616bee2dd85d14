#pragma once
// RobotBlock of floats: solves single-robot islands without refinement. A second solve estimates the effect of rounding
// errors. Its right-hand side is the residual b - K x plus eps times each row's terms, with pseudo-random signs. Terms
// are magnitudes in the tree frame, as residuals do not reveal digits that were lost for links far from the base.

#include <cstdint>
#include <numbers>

#include "robot_block.hpp"

namespace manycontact::lanes {

/// Removes whole revolutions from q [rad]. per_turn: 1/(2 pi), or 0 for lengths. Source: e_rem_pio2.c (fdlibm).
inline double without_turns(double q, double per_turn) {
  constexpr double shift = 6755399441055744.0;  // 1.5 * 2^52
  const double turns = (q * per_turn + shift) - shift;
  const double rest = (q - turns * 6.28318530693650245668) - turns * 2.430840202602476899728e-10;
  return std::abs(q) <= kLargestAngle ? rest : q;
}

template <class S>
void RobotBlock<S>::make_single() {  // allocates the members used in single precision
  near_q_.resize(static_cast<std::size_t>(W * model_->nq));
  per_turn_.assign(static_cast<std::size_t>(model_->nq), 0.0);
  for (const Joint& joint : model_->joints) {
    if (joint.type == JointType::kRevolute) per_turn_[joint.idx_q] = 0.5 / std::numbers::pi;
    if (joint.type == JointType::kPlanar) per_turn_[joint.idx_q + 2] = 0.5 / std::numbers::pi;
  }
  body_sizes_.resize(model_->joints.size());
  for (std::uint32_t k = 0, x = 1; k < static_cast<std::uint32_t>(rows_); ++k) {
    x ^= x << 13, x ^= x >> 17, x ^= x << 5;  // Marsaglia's xorshift
    signs_.push_back(x & 0x10000 ? 1.0f : -1.0f);
  }
}

/// Loads q such that floats keep most digits: without whole revolutions, and with the robot's base at the origin.
template <class S>
template <class Job>
void RobotBlock<S>::load_near(const Job& job, Robots robots) {
  const double* from[kMostInBatch];
  const std::size_t nq = static_cast<std::size_t>(model_->nq);
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const auto& robot = job.scene.robots[robots[l].number];
    const double* q = job.q + robot.idx_q;
    double* to = near_q_.data() + l * nq;
    for (std::size_t k = 0; k < nq; ++k) to[k] = without_turns(q[k], per_turn_[k]);
    origin_[l] = robot.base.p;
    if (model_->floating_base) origin_[l] = Vec3<double>(q[0], q[1], q[2]), std::fill_n(to, 3, 0.0);
    from[l] = to;
  }
  load_arrays(std::span<const double* const>(from, robots.size()), model_->nq, q_.data());
}

template <class S, class X>
S size_of(const X& x) {
  return larger(larger(S(abs(x[0])), S(abs(x[1]))), S(abs(x[2])));
}

/// Computes magnitudes of the terms of M a + h - J^T f. sizes: one per row of K, set in rows of coordinates.
template <class S>
void RobotBlock<S>::size_torques(const Scene& scene, Robots robots, S* sizes) {
  const Kinematics<S>& kin = robot_.kin;
  const int n = model_->njoints();
  for (int i = 0; i < n; ++i) {
    const Joint& joint = model_->joints[i];
    BodySizes& of = body_sizes_[i];
    of.moved = joint.parent < 0 ? S(0) : body_sizes_[joint.parent].moved;
    of.turned = joint.parent < 0 ? S(0) : body_sizes_[joint.parent].turned;
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k) {
      const S a = abs(n_.x[pattern_.iperm[k]]);
      of.moved += a * size_of<S>(kin.J.col(k).template head<3>());
      of.turned += a * size_of<S>(kin.J.col(k).template tail<3>());
    }
    const Inertia<S>& Y = kin.Y[i];
    const S m = abs(Y.m), H = size_of<S>(Y.h), I = size_of<S>(Y.I.diagonal());
    const S v = size_of<S>(kin.v[i].template head<3>()), w = size_of<S>(kin.v[i].template tail<3>());
    const S a = of.moved + size_of<S>(kin.a[i].template head<3>()),
            t = of.turned + size_of<S>(kin.a[i].template tail<3>());
    const S momentum = m * v + H * w, spin = I * w + H * v;
    of.force = m * a + H * t + w * momentum;
    of.moment = I * t + H * a + w * spin + v * momentum;
  }
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    S f(0);
    for (int i = 0; i < c.rows(); ++i) f = larger(S(abs(n_.x[rows_of(k)[i]])), f);
    const auto add = [&](const Attachment& at, const Vec3<S>& p) {
      if (!moves(at)) return;
      body_sizes_[at.joint].force += f;
      body_sizes_[at.joint].moment += f * (size_of<S>(p) + S(holds_turning(c.type) || c.pair ? 1 : 0));
    };
    add(c.A, contacts_[k].aMA.p), add(c.B, contacts_[k].bMA.p);
  }
  for (int i = n - 1; i >= 0; --i) {
    const Joint& joint = model_->joints[i];
    const BodySizes& of = body_sizes_[i];
    for (int k = joint.idx_v; k < joint.idx_v + joint.nv(); ++k)
      sizes[pattern_.iperm[k]] = abs(tau_[k]) + of.force * size_of<S>(kin.J.col(k).template head<3>()) +
                                 of.moment * size_of<S>(kin.J.col(k).template tail<3>());
    if (joint.parent < 0) continue;
    body_sizes_[joint.parent].force += of.force;
    body_sizes_[joint.parent].moment += of.moment;
  }
}

/// Computes magnitudes of the terms of J a + a0. sizes: one per row of K, set in rows of J. a: largest acceleration.
template <class S>
void RobotBlock<S>::size_drifts(const Scene& scene, Robots robots, const S& a, S* sizes) const {
  const Kinematics<S>& kin = robot_.kin;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    const Vec3<S> place = c.B.robot < 0 ? standing_[k][1].origin : Vec3<S>(Vec3<S>::Zero());
    const auto terms = internal::bias_acceleration_terms<S>(c, contacts_[k], *model_, kin, *model_, kin, place);
    double gain = std::abs(c.alpha);
    for (std::size_t m = 0; c.pair && m < c.pair->members.size(); ++m)
      gain = std::max(gain, std::abs(c.pair->members[m].alpha));
    S far = size_of<S>(place);  // distance from the base; its rounding error is eps far
    for (const Attachment* at : {&c.A, &c.B})
      if (moves(*at)) far += size_of<S>(kin.origin(at->joint));
    const S lever = contacts_[k].joint_lever + size_of<S>(contacts_[k].aMA.p);
    for (int i = 0; i < c.rows(); ++i) sizes[rows_of(k)[i]] = terms.of_row(i) + (S(1) + lever) * a + S(gain) * far;
  }
}

template <class S>
S RobotBlock<S>::largest(const S* x, int first, int end) const {  // |x| of island rows [first, end); x: in K's order
  FourLargest<S> of;
  for (int i = first; i < end; ++i) of.take(i % 4, abs(x[pattern_.iperm[i]]));
  return of.total();
}

/// Whether all contacts' orientation errors are below half a revolution, where the direction of the error is undefined.
template <class S>
typename S::Mask RobotBlock<S>::knows_turns(const Scene& scene, Robots robots) const {
  Mask out = all();
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    const Mat3<S>& R = contacts_[k].G.R;
    if (c.type == ContactType::k6D && c.alpha != 0)
      out = out & (R(0, 0) + R(1, 1) + R(2, 2) > S(tolerance::kHalfTurn - 1));
  }
  return out;
}

/// Solves x = K^-1 b. A robot remains usable if rounding errors change accelerations by at most tolerance::kWorthless
/// times the largest acceleration or gravity, and forces by at most tolerance::kWorthless times the largest force.
template <class S>
void RobotBlock<S>::solve_unrefined(const Scene& scene, Robots robots) {
  std::copy_n(n_.b, rows_, n_.x);
  solve_by_factor(n_.x);
  steps_ = S(0);
  first_error_ = backward_error_ = residual();
  const auto largest_a = [this](const S* x) { return largest(x, 0, pattern_.nv); };
  const auto largest_f = [this](const S* x) { return largest(x, pattern_.nv, rows_); };
  const S a = larger(largest_a(n_.x), S(scene.gravity.norm()));
  S* const w = n_.w;
  size_torques(scene, robots, w);
  size_drifts(scene, robots, a, w);
  const S eps(std::numeric_limits<typename S::Element>::epsilon());
  for (int k = 0; k < rows_; ++k) w[k] = multiply_add(S(signs_[k]) * eps, w[k], r_[k]);
  solve_by_factor(w);
  const S terms = larger(largest_a(scale_.data()), largest_f(scale_.data()));
  usable_ = usable_ & knows_turns(scene, robots) & (terms > S(tolerance::kSmallestTerm)) &
            (largest_a(w) <= S(tolerance::kWorthless) * a) &
            (largest_f(w) <= S(tolerance::kWorthless) * largest_f(n_.x));
}

}  // namespace manycontact::lanes
