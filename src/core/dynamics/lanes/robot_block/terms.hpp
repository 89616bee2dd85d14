#pragma once
// RobotBlock: loads the robots' inputs, evaluates their terms, and assembles K x = b.

#include "manycontact/rank/row_units.hpp"
#include "robot_block.hpp"
#include "single.hpp"

namespace manycontact::lanes {

template <class S>
template <class Job>
void RobotBlock<S>::load_state(const Job& job, Robots robots) {
  serial_ = 0;  // the terms of the last solution are overwritten below
  if constexpr (kSingle)
    load_near(job, robots);
  else
    load_each(job.scene, robots, model_->nq, q_.data(), [&](const auto& r, auto&) { return job.q + r.idx_q; });
  load_each(job.scene, robots, model_->nv, v_.data(), [&](const auto& r, auto&) { return job.v + r.idx_v; });
  if (!model_->floating_base)
    load_each(job.scene, robots, 12, base_.R.data(), [](const auto& r, auto&) { return r.base.R.data(); });
  if constexpr (kSingle) base_.p.setZero();
  load_model(job.scene, robots);
  load_ends(job.scene, robots);
}

template <class S>
void RobotBlock<S>::load_model(const Scene& scene, Robots robots) {  // skipped if all robots have the plan's model
  static_assert(sizeof(Inertia<double>) == 13 * sizeof(double) && sizeof(Inertia<S>) == 13 * sizeof(S));
  const auto of = [&scene](const Robot& r) -> const std::shared_ptr<const Model>& {
    return scene.robots[r.number].model;
  };
  robot_.kin.own = nullptr;
  if (std::all_of(robots.begin(), robots.end(), [&](const Robot& r) { return of(r) == model_; })) return;
  robot_.kin.own = &own_model_;
  const double* from[kMostInBatch];
  const auto load = [&](int count, S* to, auto&& at) {
    load_arrays(side_by_side(robots, from, [&](const Robot& r) -> const double* { return at(*of(r)); }), count, to);
  };
  for (std::size_t i = 0; i < own_model_.placement.size(); ++i) {
    load(12, own_model_.placement[i].R.data(), [i](const Model& m) { return m.joints[i].placement.R.data(); });
    load(13, &own_model_.inertia[i].m, [i](const Model& m) { return &m.joints[i].inertia.m; });
  }
  load(model_->nv, own_model_.armature.data(), [](const Model& m) { return m.armature.data(); });
}

template <class S>
void RobotBlock<S>::load_ends(const Scene& scene, Robots robots) {  // placements of contact frames, moving or fixed
  static_assert(sizeof(StandingEnd<double>) == 15 * sizeof(double) && sizeof(StandingEnd<S>) == 15 * sizeof(S));
  StandingEnd<double> ends[W];
  const double* from[kMostInBatch];
  for (std::size_t k = 0; k < standing_.size(); ++k) {
    if (contacts_[k].pair)
      load_pair<S>(
          robots, [&](const Robot& r) -> const Contact& { return scene.contacts[r.contacts[k]]; }, contacts_[k],
          common_pair_[k]);
    for (const bool B : {false, true}) {
      const auto end = [&](const Robot& r) -> const Attachment& {
        const Contact& c = scene.contacts[r.contacts[k]];
        return B ? c.B : c.A;
      };
      if (moves(B ? contact(k).B : contact(k).A)) {
        load_arrays(side_by_side(robots, from, [&](const Robot& r) { return end(r).placement.R.data(); }), 12,
                    on_body_[k][B].R.data());
        continue;
      }
      for (std::size_t l = 0; l < robots.size(); ++l) {
        ends[l] = standing_end(scene, end(robots[l]));
        if constexpr (kSingle) ends[l].origin -= origin_[l];
        from[l] = ends[l].frame.R.data();
      }
      load_arrays(std::span<const double* const>(from, robots.size()), 15, standing_[k][B].frame.R.data());
    }
  }
}

/// Assembles K x = b of the robots and the contacts on single robots, and sets usable_ to robots with valid input.
template <class S>
void RobotBlock<S>::set_up(const Job& job, Robots robots) {
  load_state(job, robots);
  load_each(job.scene, robots, model_->nv, tau_.data(), [&](const auto& r, auto&) { return job.tau + r.idx_v; });
  if (job.start) load_start(job, robots);
  usable_ = usable_input<S>(*model_, q_, v_, tau_);
  if (job.start)
    evaluate_start(*job.start);
  else
    internal::evaluate_bias<S>(*model_, base_, q_, v_, job.scene.gravity, robot_);
  internal::evaluate_inertia<S>(*model_, robot_, pattern_.M_slot.data(), n_.K);
  evaluate_rows(job.scene, robots);
  store_left(job, robots);
  size_rows(job.scene, robots);
  if (plan_->border() > 0 && may_wait_) size_drifts(job.scene, robots);
  assemble_rows(job.scene.damping);
  assemble_right_side(job, robots);
}

template <class S>
void RobotBlock<S>::load_start(const Job& job, Robots robots) {
  load_each(job.scene, robots, model_->nv, v_.data(), [&](const auto& r, auto&) { return job.start->v + r.idx_v; });
  load_each(job.scene, robots, model_->nv, a_.data(), [&](const auto& r, auto&) { return job.start->stop + r.idx_v; });
}

/// Sets robot_.h to start.h (the time step) times the inverse dynamics at (q, v, a_), then velocities to zero.
template <class S>
void RobotBlock<S>::evaluate_start(const StartOfStep& start) {
  Kinematics<S>& kin = robot_.kin;
  forward_kinematics<S>(*model_, base_, q_, kin);
  forward_accelerations<S>(*model_, v_, a_.data(), start.gravity, kin);
  inverse_dynamics<S>(*model_, kin, nullptr, {}, robot_.f, robot_.h);
  robot_.h *= S(start.h);
  v_.setZero();
  for (std::vector<Vec6<S>>* motion : {&kin.v, &kin.a}) std::fill(motion->begin(), motion->end(), Vec6<S>::Zero());
}

/// Stores J x, the velocities of contact rows after a simulation step; x are the velocities that were solved for.
template <class S>
void RobotBlock<S>::store_contact_velocities(const Job& job, Robots robots) {
  double* to[kMostInBatch];
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const MatX<S>& J = contacts_[k].J;
    VecX<S>& velocity = contact_scratch_[k];
    velocity.setZero();
    for (Eigen::Index j = 0; j < J.cols(); ++j) {
      const S x = n_.x[pattern_.iperm[columns_[k][j]]];
      for (Eigen::Index i = 0; i < J.rows(); ++i) velocity[i] = multiply_add(J(i, j), x, velocity[i]);
    }
    store_arrays(velocity.data(), static_cast<int>(velocity.size()), side_by_side(robots, to, [&](const Robot& r) {
                   return job.start->contact_v + job.f_offset[static_cast<std::size_t>(r.contacts[k])];
                 }));
  }
}

template <class S>
void RobotBlock<S>::evaluate_rows(const Scene& scene, Robots robots) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    const auto& [on_A, on_B] = on_body_[k];
    rows_between<S>(scene.gravity, c, plan_->supports[k], robot_.kin,
                    placed_end<S>(c.A, robot_.kin, on_A, standing_[k][0]), on_A.p, robot_.kin,
                    placed_end<S>(c.B, robot_.kin, on_B, standing_[k][1]), on_B.p, contacts_[k]);
    contacts_[k].joint_lever = larger(joint_lever<S>(*model_, robot_.kin, plan_->supports[k].a),
                                      joint_lever<S>(*model_, robot_.kin, plan_->supports[k].b));
  }
}

/// Stores ContactData::left of pairs: the inconsistency among the contacts that a pair replaces.
template <class S>
void RobotBlock<S>::store_left(const Job& job, Robots robots) const {
  double* to[kMostInBatch];
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    if (contacts_[k].pair)
      store_arrays(contacts_[k].left.data(), static_cast<int>(contacts_[k].left.size()),
                   side_by_side(robots, to, [&](const Robot& r) {
                     return job.left + (*job.left_offset)[static_cast<std::size_t>(r.contacts[k])];
                   }));
}

/// Computes row sizes of J and the size by which they are judged (motion_scale), to find rows of mere rounding errors.
/// With damping every row is sound.
template <class S>
void RobotBlock<S>::size_rows(const Scene& scene, Robots robots) {
  smallest_row_ = S(std::numeric_limits<double>::infinity()), motion_ = S(0);
  may_wait_ = !kSingle && internal::may_drop_rows(scene, {robots.front().contacts, contacts_.size()});
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    const ContactData<S>& rows = contacts_[k];
    if (scene.damping > 0) {
      for (int i = 0; i < c.rows(); ++i)
        waiting_.largest_entry(rows_of(k)[i]) = S(0), waiting_.row_size(rows_of(k)[i]) = S(-1);
      continue;
    }
    const MotionSizes<S> sizes = motion_sizes<S>(c, rows);
    if (kSingle || plan_->border() > 0) motion_ = larger(motion_scale(c, rows), motion_);
    for (int i = 0; i < c.rows(); ++i) {
      S largest(0);
      for (Eigen::Index j = 0; j < rows.J.cols(); ++j) largest = larger(abs(rows.J(i, j)), largest);
      smallest_row_ = -larger(-largest, -smallest_row_);
      const int row = rows_of(k)[i];
      waiting_.largest_entry(row) = largest;
      waiting_.row_size(row) = row_size<S>(sizes, c, rows, i);
    }
  }
}

template <class S>
void RobotBlock<S>::assemble_rows(double damping) {  // J and -delta I into K; `factor` writes the border
  const int* slot = pattern_.J_slot.data();
  for (const ContactData<S>& rows : contacts_)
    for (Eigen::Index k = 0; k < rows.J.size(); ++k) n_.K[*slot++] = rows.J.data()[k];
  const std::size_t count = pattern_.diagonal_slot.size(), own = count - static_cast<std::size_t>(plan_->border());
  for (std::size_t k = 0; k < count; ++k) n_.K[pattern_.diagonal_slot[k]] = S(k < own ? -damping : 0);
}

/// Sets b = [tau - h; prescribed accelerations - a0; 0], with zeros in the border.
template <class S>
void RobotBlock<S>::assemble_right_side(const Job& job, Robots robots) {
  for (int i = 0; i < model_->nv; ++i) n_.b[pattern_.iperm[i]] = tau_[i] - robot_.h[i];
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    for (Eigen::Index i = 0; i < contacts_[k].a0.size(); ++i) {
      S wanted(0);
      for (int l = 0; job.prescribed && l < W; ++l)
        wanted.set(l, job.prescribed[job.f_offset[in_lane(robots, l).contacts[k]] + i]);
      n_.b[rows_of(k)[i]] = wanted - contacts_[k].a0[i];
    }
  std::fill_n(n_.b + rows_, plan_->border(), S(0));
}

template <class S>
void RobotBlock<S>::residual_and_sizes() {  // r = b - K x, scale = |b| + |K| |x|
  sparse::ldl_scheduled_residual(pattern_.K, as_scalar(n_.K), as_scalar(n_.x), as_scalar(n_.b), as_scalar(r_.data()),
                                 as_scalar(scale_.data()));
}

}  // namespace manycontact::lanes
