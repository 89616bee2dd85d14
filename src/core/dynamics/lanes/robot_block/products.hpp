#pragma once
// RobotBlock: jvp and vjp of single-robot islands in a SIMD batch, as derivatives/products.cpp for one island.

#include "manycontact/detail/spatial/products.hpp"
#include "robot_block.hpp"

namespace manycontact::lanes {

template <class S>
void RobotBlock<S>::solve_once_refined() {  // x = K^-1 b with up to one step of refinement
  if (rows_wait()) waiting_.project_out(n_.b);
  std::copy_n(n_.b, rows_, n_.x);
  apply_inverse(n_.x);
  const Mask open = residual() > S(tolerance::kRefined);
  if (open.any()) (void)correct(open);
}

template <class S>
BodyVariationOf<S> RobotBlock<S>::body(const Attachment& at) const {
  const Vec6<S> zero = Vec6<S>::Zero();
  return moves(at) ? body_[at.joint] : BodyVariationOf<S>{zero, zero, zero, zero};
}

// ---- least-norm forces f = J y of dependent rows: P df = P D dq, D = d(J y)/dq (systems/matrix/least_norm_forces.cpp)

template <class S>
internal::JacobianRate<S> RobotBlock<S>::jacobian_rate(const Scene& scene, Robots robots, std::size_t k) const {
  const ContactSupport& support = plan_->supports[k];
  const std::vector<int>& joint = model_->dof_joint;
  return {scene.contacts[robots.front().contacts[k]],
          contacts_[k],
          {support.a, joint},
          {support.b, joint},
          columns_[k],
          contact_terms_[k].chain_a,
          0,
          robot_.kin};
}

template <class S>
void RobotBlock<S>::motion_of_forces() {  // computes y_ such that J y_ are the contact forces
  for (int i = 0; i < model_->nv; ++i) n_.b[pattern_.iperm[i]] = S(0);
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    for (Eigen::Index i = 0; i < contact_f_[k].size(); ++i) n_.b[rows_of(k)[i]] = contact_f_[k][i];
  solve_once_refined();
  for (int i = 0; i < model_->nv; ++i) y_[i] = n_.x[pattern_.iperm[i]];
}

/// Sets df += P D dq in x = [da; -df], where D = d(J y)/dq and P projects on the null space of J^T.
template <class S>
void RobotBlock<S>::add_least_norm_tangent(const Scene& scene, Robots robots, const std::vector<S>& dq) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Vec6<S> dnu = Vec6<S>::Zero();
    jacobian_rate(scene, robots, k).of_motion(y_, [&](int i, const Vec6<S>& column) { dnu += column * dq[i]; });
    VecX<S>& rows = contact_scratch_[k];
    rows.noalias() = contacts_[k].W * dnu;
    for (Eigen::Index i = 0; i < rows.size(); ++i) n_.w[rows_of(k)[i]] = rows[i];
  }
  waiting_.take_out(n_.w);
  for (int k = 0; k < rows_; ++k) n_.x[k] -= waiting_.null_component(k);
}

/// Stores P b in waiting_.null_component, for b = [wa; -wf], before the solve. P projects on the null space of J^T.
template <class S>
void RobotBlock<S>::project_forces() {
  std::copy_n(n_.b, rows_, n_.w);
  waiting_.take_out(n_.w);
}

/// Sets wq += D^T P wf after project_forces, where D = d(J y)/dq and P projects on the null space of J^T.
template <class S>
void RobotBlock<S>::add_least_norm_adjoint(const Scene& scene, Robots robots, std::vector<S>& wq) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    VecX<S>& rows = contact_scratch_[k];
    for (Eigen::Index i = 0; i < rows.size(); ++i) rows[i] = -waiting_.null_component(rows_of(k)[i]);
    const Vec6<S> F = contacts_[k].W.transpose() * rows;
    jacobian_rate(scene, robots, k).of_motion(y_, [&](int i, const Vec6<S>& column) { wq[i] += dot(column, F); });
  }
}

template <class S>
void RobotBlock<S>::jvp(const ProductJob& job, Robots robots) {
  const Scene& scene = job.scene;
  const int nv = model_->nv;
  linearise(job, robots, nullptr);
  load_each(scene, robots, nv, dq_.data(), [&](const auto& r, auto&) { return job.in[0] + r.idx_v; });
  load_each(scene, robots, nv, dv_.data(), [&](const auto& r, auto&) { return job.in[1] + r.idx_v; });
  load_each(scene, robots, nv, torque_.data(), [&](const auto& r, auto&) { return job.in[2] + r.idx_v; });
  if (rows_wait()) motion_of_forces(), along_ = dq_;
  tangent_motions<S>(*model_, robot_.kin, a_.data(), dq_.data(), dv_.data(), body_);
  add_forces(scene, robots, fext_);
  std::fill(dfext_.begin(), dfext_.end(), Vec6<S>(Vec6<S>::Zero()));
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    VecX<S>& dr2 = contact_scratch_[k];
    Vec6<S> dF;
    contact_tangent<S>(c, contacts_[k], body(c.A), body(c.B), contact_f_[k], dr2, dF);
    add_force<S>(c, contacts_[k], dF, dfext_);
    for (Eigen::Index i = 0; i < dr2.size(); ++i) n_.b[rows_of(k)[i]] = -dr2[i];
  }
  tangent_torques<S>(*model_, robot_.kin, body_, fext_, dfext_, robot_.f, df_, dq_.data());
  for (int i = 0; i < nv; ++i) n_.b[pattern_.iperm[i]] = torque_[i] - dq_[i];
  for (std::size_t i = 0; i < slope_.size(); ++i) n_.b[pattern_.iperm[i]] -= slope_[i] * dv_[i];
  solve_once_refined();
  if (rows_wait()) add_least_norm_tangent(scene, robots, along_);
  for (std::size_t l = 0; l < robots.size(); ++l)  // x = [da; -df]
    scatter(scene, job.f_offset, robots[l], static_cast<int>(l), job.out[0], job.out[1]);
}

template <class S>
void RobotBlock<S>::vjp(const ProductJob& job, Robots robots) {
  const Scene& scene = job.scene;
  const int nv = model_->nv;
  linearise(job, robots, nullptr);
  if (rows_wait()) motion_of_forces();
  for (int l = 0; l < W; ++l) {
    const Robot& robot = in_lane(robots, l);
    const double* wa = job.in[0] + scene.robots[robot.number].idx_v;
    for (int i = 0; i < nv; ++i) n_.b[pattern_.iperm[i]].set(l, wa[i]);
    for (std::size_t k = 0; k < contacts_.size(); ++k)
      for (Eigen::Index i = 0; i < contact_f_[k].size(); ++i)
        n_.b[rows_of(k)[i]].set(l, -job.in[1][job.f_offset[robot.contacts[k]] + i]);
  }
  std::fill(along_.begin(), along_.end(), S(0));
  if (rows_wait()) {
    project_forces();
    add_least_norm_adjoint(scene, robots, along_);
  }
  solve_once_refined();  // l = K^-1 [wa; -wf]
  for (int i = 0; i < nv; ++i) torque_[i] = n_.x[pattern_.iperm[i]];
  virtual_velocities<S>(*model_, robot_.kin, torque_.data(), u_);
  const Vec6<S> zero = Vec6<S>::Zero();
  std::fill(body_.begin(), body_.end(), BodyVariationOf<S>{zero, zero, zero, zero});
  add_body_adjoints<S>(*model_, robot_.kin, u_, body_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    VecX<S>& l = contact_scratch_[k];
    for (Eigen::Index i = 0; i < l.size(); ++i) l[i] = n_.x[rows_of(k)[i]];
    BodyVariationOf<S> nobody{zero, zero, zero, zero};
    const auto u = [&](const Attachment& at) { return moves(at) ? u_[at.joint] : zero; };
    const auto adjoint = [&](const Attachment& at) -> BodyVariationOf<S>& {
      return moves(at) ? body_[at.joint] : nobody;
    };
    contact_adjoint<S>(c, contacts_[k], u(c.A), u(c.B), contact_f_[k], l, adjoint(c.A), adjoint(c.B));
  }
  pull_back<S>(*model_, robot_.kin, a_.data(), u_, body_, dq_.data(), dv_.data());
  for (std::size_t i = 0; i < slope_.size(); ++i) dv_[i] += slope_[i] * torque_[i];
  for (std::size_t i = 0; i < along_.size(); ++i) dq_[i] -= along_[i];
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const auto& robot = scene.robots[robots[l].number];
    const int lane = static_cast<int>(l);
    for (int i = 0; i < nv; ++i) job.out[0][robot.idx_v + i] = -dq_[i][lane];  // wq = -(dr/dq)^T l
    for (int i = 0; i < nv; ++i) job.out[1][robot.idx_v + i] = -dv_[i][lane];
    for (int i = 0; i < nv; ++i) job.out[2][robot.idx_v + i] = torque_[i][lane];
  }
}

}  // namespace manycontact::lanes
