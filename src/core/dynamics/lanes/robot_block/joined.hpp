#pragma once
// RobotBlock: steps of a solve of coupled robots. systems/robots solves the border, the rows of coupling contacts.

#include "robot_block.hpp"

namespace manycontact::lanes {

template <class S>
void RobotBlock<S>::prefetch_cached(Prefetch prefetch) const {  // prefetches K, b, JoinedEnds of the next batch
  constexpr std::size_t kLine = 64 / sizeof(S);
  for (std::size_t k = 0; k < plan_->kept_size() + plan_->joins_size(); k += kLine) prefetch.fetch_to_write(n_.K + k);
}

template <class S>
void RobotBlock<S>::evaluate(const Job& job, Robots robots, Memory memory) {
  use(memory.at);
  prefetch_cached(prefetch_of(memory));
  set_up(job, robots);
  store_ends(robots);
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    robots[l].sound = usable_[lane];
    robots[l].motion = motion_[lane];
  }
}

/// Fills joins_ for each coupling contact: the motion of the contact's body, and the columns that move this body.
template <class S>
void RobotBlock<S>::collect_ends(std::initializer_list<const Mat6X<S>*> columns) {
  S* to = joins_.data();
  const auto add = [&to](const S* from, std::size_t count) { to = std::copy_n(from, count, to); };
  for (std::size_t k = contacts_.size(); k < plan_->supports.size(); ++k) {
    const int joint = contact(k).A.joint;
    add(origin_numbers(robot_.kin, joint), 6);
    add(robot_.kin.oMi[joint].R.data(), 12);
    add(robot_.kin.v[joint].data(), 6);
    add(robot_.kin.a[joint].data(), 6);
    for (const Mat6X<S>* of : columns)
      for (int i : plan_->supports[k].a) add(of->col(i).data(), 6);
  }
}

template <class S>
void RobotBlock<S>::store_ends(Robots robots) {
  collect_ends({&robot_.kin.J});
  double* memory[kMostInBatch];
  store_arrays(joins_.data(), static_cast<int>(plan_->joins_size()),
               side_by_side(robots, memory, [](const Robot& r) { return r.joins; }));
}

template <class S>
void RobotBlock<S>::factor(Robots robots, Memory memory) {
  use(memory.at);
  const int* slot = pattern_.J_slot.data();
  for (const ContactData<S>& rows : contacts_) slot += rows.J.size();
  const double* from[kMostInBatch];
  std::size_t next = 0;  // offset in Robot::joins
  for (std::size_t k = contacts_.size(); k < plan_->supports.size(); ++k) {
    const int cols = plan_->supports[k].cols(), count = contact(k).rows() * cols;
    load_arrays(side_by_side(robots, from, [&](const Robot& r) { return r.joins + next; }), count, joins_.data());
    for (int i = 0; i < count; ++i) n_.K[*slot++] = joins_[i];
    next += JoinedEnd::size(cols);
  }
  Mask good = factorize(all(), prefetch_of(memory));
  const Growth<S> growth(static_cast<std::size_t>(rows_), pivot_terms_.data(), diagonal());
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    robots[l].sound = robots[l].sound && good[lane];
    robots[l].terms = growth.terms[lane];
    robots[l].diagonal = growth.diagonal[lane];
    robots[l].dependent = waiting_.of(lane);
  }
  store_schur_complement(robots);
  begin(robots);
}

template <class S>
void RobotBlock<S>::store_schur_complement(Robots robots) {
  S* to = border_.data();
  const int* below = triangle_.data();
  for (int j = rows_; j < pattern_.size(); ++j) {
    for (int i = rows_; i < j; ++i, ++below) *to++ = *below < 0 ? S(0) : n_.L[*below];
    *to++ = n_.D[j];
  }
  std::copy_n(pivot_terms_.data() + rows_, plan_->border(), to);
  store_border(border_.data(), static_cast<int>(to - border_.data()) + plan_->border(), robots,
               [](const Border& b) { return b.S; });
}

template <class S>
void RobotBlock<S>::load(const Job& job, Robots robots, double* memory) {
  use(memory);
  load_each(job.scene, robots, model_->nv, a_.data(), [&](const auto& r, auto&) { return job.a + r.idx_v; });
  for (int i = 0; i < model_->nv; ++i) n_.b[pattern_.iperm[i]] = a_[i];
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    VecX<S>& f = contact_f_[k];
    load_each(job.scene, robots, contact(k).rows(), f.data(),
              [&](auto&, const Robot& r) { return job.f + job.f_offset[r.contacts[k]]; });
    for (Eigen::Index i = 0; i < f.size(); ++i) n_.b[rows_of(k)[i]] = -f[i];
  }
  std::fill_n(n_.b + rows_, plan_->border(), S(0));
  begin(robots);
}

template <class S>
void RobotBlock<S>::begin(Robots robots) {  // sets x = 0 and r = b, without the inconsistency of redundant rows
  std::fill_n(n_.x, pattern_.size(), S(0));
  if (rows_wait()) waiting_.take_out(n_.b);
  std::copy_n(n_.b, pattern_.size(), r_.data());
  forward(robots, all());
}

template <class S>
void RobotBlock<S>::forward(Robots robots, Mask open) {  // w = L^-1 r, and the border's b; zero unless `open`
  for (int k = 0; k < rows_; ++k) n_.w[k] = select(open, r_[k], S(0));
  std::fill_n(n_.w + rows_, plan_->border(), S(0));
  if (open.any()) sparse::ldl_scheduled_forward(schedule_, as_scalar(n_.L), as_scalar(n_.w));
  store_border(n_.w + rows_, plan_->border(), robots, [](const Border& b) { return b.b(); });
}

template <class S>
void RobotBlock<S>::correct(Robots robots, Memory memory) {
  use(memory.at);
  const Prefetch prefetch = prefetch_of(memory);
  const double* from[kMostInBatch];
  load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.border.y(); }), plan_->border(), n_.w + rows_);
  sparse::ldl_scheduled_backward(schedule_, as_scalar(n_.L), as_scalar(n_.D), as_scalar(n_.w), prefetch);
  if (rows_wait()) waiting_.project_out(n_.w);
  for (int k = 0; k < pattern_.size(); ++k) {
    for (const S* x : {n_.x, n_.b, n_.w, n_.D}) prefetch.fetch(x + k);
    n_.x[k] += n_.w[k];
  }
  forward(robots, check_residual(robots, prefetch) > S(tolerance::kRefined));
}

template <class S>
void RobotBlock<S>::check(Robots robots, Memory memory) {
  use(memory.at);
  const double* from[kMostInBatch];
  const auto spread = [&](auto&& at, S* to) {  // reorders from the island's row order to K's
    load_arrays(side_by_side(robots, from, at), rows_, pivot_terms_.data());
    for (int i = 0; i < rows_; ++i) to[pattern_.iperm[i]] = pivot_terms_[i];
  };
  spread([](const Robot& r) { return r.x; }, n_.x);
  spread([](const Robot& r) { return r.b; }, n_.b);
  load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.border.y(); }), plan_->border(), n_.x + rows_);
  std::fill_n(n_.b + rows_, plan_->border(), S(0));
  if (rows_wait()) waiting_.project_out(n_.b);
  (void)check_residual(robots, prefetch_of(memory));
}

/// Computes r = b - K x, scale = |b| + |K| |x|, and the largest entries of r and scale. Returns the backward errors.
template <class S>
S RobotBlock<S>::check_residual(Robots robots, Prefetch prefetch) {
  sparse::ldl_scheduled_residual(pattern_.K, as_scalar(n_.K), as_scalar(n_.x), as_scalar(n_.b), as_scalar(r_.data()),
                                 as_scalar(scale_.data()), prefetch);
  store_border(r_.data() + rows_, plan_->border(), robots, [](const Border& b) { return b.r(); });
  store_border(scale_.data() + rows_, plan_->border(), robots, [](const Border& b) { return b.scale(); });
  const std::span<const int> eliminated(pattern_.iperm.data(), rows_);
  const Largest<S> largest[] = {{0, eliminated.first(pattern_.nv), r_.data(), scale_.data()},
                                {0, eliminated.subspan(pattern_.nv), r_.data(), scale_.data()}};
  const S error = backward_error();
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    for (int row : {0, 1}) {
      robots[l].r[row] = largest[row].r[lane];
      robots[l].scale[row] = largest[row].scale[lane];
    }
    robots[l].error = error[lane];
  }
  return error;
}

template <class S>
void RobotBlock<S>::finish(Robots robots, Memory memory) {
  use(memory.at);
  for (int i = pattern_.nv; rows_wait() && i < rows_; ++i)
    n_.b[pattern_.iperm[i]] += waiting_.null_component(pattern_.iperm[i]);
  (void)check_residual(robots, prefetch_of(memory));
  const S error = componentwise_error<S>({r_.data(), static_cast<std::size_t>(rows_)}, scale_.data());
  const rank::Contradiction<S> of = contradicted();
  for (std::size_t l = 0; l < robots.size(); ++l) {
    robots[l].contradiction = of.of_lane(static_cast<int>(l));
    robots[l].error = error[static_cast<int>(l)];
  }
}

template <class S>
void RobotBlock<S>::store(const Job& job, Robots robots, double* memory) {
  use(memory);
  for (std::size_t l = 0; l < robots.size(); ++l)
    scatter(job.scene, job.f_offset, robots[l], static_cast<int>(l), job.a, job.f);
}

}  // namespace manycontact::lanes
