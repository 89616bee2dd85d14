#pragma once
// CutRobots in the lanes of S = Pack<W>: the steps of SideBySide, without the rows that join robots.

#include <limits>

#include "cut.hpp"
#include "side_by_side.hpp"
#include "terms.hpp"

namespace manycontact::lanes {

template <class S>
class CutSideBySide {
 public:
  static constexpr int W = S::width;
  using Mask = typename S::Mask;
  using Robot = CutRobots::Robot;
  using Memory = CutRobots::Memory;
  /// In the memory of a batch: K, L, D as KktMatrix, LdlSymbolic have them; w = L^-1 r.
  struct Numbers {
    S *K, *b, *L, *D, *x, *w;
  };

  explicit CutSideBySide(std::shared_ptr<const CutRobot> cut);
  void evaluate(const Job& job, std::span<Robot> robots, Memory memory);
  void factor(std::span<Robot> robots, Memory memory);
  void load(const Job& job, std::span<const Robot> robots, double* memory);
  void correct(std::span<Robot> robots, Memory memory);
  void store(const Job& job, std::span<const Robot> robots, double* memory) const;

 private:
  /// A batch meets its numbers again after all others have met theirs.
  using Ahead = std::conditional_t<W == 1, sparse::kernel::NoNext, sparse::kernel::Next>;
  static Ahead ahead_of(const Memory& memory) {
    if constexpr (W == 1)
      return {};
    else
      return {(memory.next - memory.at) / W};
  }
  Numbers numbers_in(double* memory) const {
    const KktPattern& p = cut_->pattern;
    Numbers n;
    n.K = reinterpret_cast<S*>(memory);
    n.b = n.K + p.K.nonzeros();
    n.L = n.b + p.size();
    n.D = n.L + p.ldl.nonzeros();
    n.x = n.D + p.size();
    n.w = n.x + p.size();
    return n;
  }
  Mask load_state(const Job& job, std::span<const Robot> robots);
  void evaluate_rows(const Job& job, std::span<Robot> robots);
  void assemble(const Job& job, std::span<const Robot> robots, const Numbers& n) const;
  /// Asks for what those whose turn is next will write: K, b and the joins.
  void fetch_kept(const Numbers& n, Ahead ahead) const {
    constexpr std::size_t kLine = 64 / sizeof(S);
    for (std::size_t k = 0; k < cut_->kept_size() + cut_->joins_size(); k += kLine) ahead.fetch_to_write(n.K + k);
  }
  void store_ends(std::span<const Robot> robots);
  void begin(std::span<const Robot> robots, const Numbers& n);
  void forward(std::span<const Robot> robots, const Numbers& n, Mask open);
  S residual(std::span<Robot> robots, const Numbers& n, Ahead ahead);

  const Contact& contact(std::size_t k) const { return cut_->scene.contacts[k]; }
  /// Where the rows of a contact stand in K.
  const int* rows_of(std::size_t k) const {
    return cut_->pattern.iperm.data() + model_.nv + cut_->island.row_offset[k];
  }
  /// from, of the border, into the robots' arrays.
  template <class To>
  static void store_border(const S* from, int count, std::span<const Robot> robots, To&& to) {
    double* memory[8];
    store_arrays(from, count, side_by_side(robots, memory, [&](const Robot& r) { return to(r.border); }));
  }

  std::shared_ptr<const CutRobot> cut_;
  const Model& model_;
  std::vector<int> triangle_;  // slots in L of the border's columns, below the diagonal; -1: zero

  VecX<S> q_, v_, tau_;
  SE3<S> base_;
  std::vector<SE3<S>> bMB_;  // per contact on the robots alone, where B is the world: its placement
  RobotQuantities<S> robot_;
  std::vector<ContactData<S>> contacts_;
  std::vector<S> joins_, terms_, border_, r_, scale_;
};

template <class S>
CutSideBySide<S>::CutSideBySide(std::shared_ptr<const CutRobot> cut)
    : cut_(std::move(cut)),
      model_(*cut_->scene.robots.front().model),
      q_(model_.nq),
      v_(model_.nv),
      tau_(model_.nv),
      bMB_(cut_->alone),
      robot_(model_),
      joins_(cut_->joins_size()),
      terms_(cut_->pattern.size()),
      border_(Border::size(cut_->border)),
      r_(cut_->pattern.size()),
      scale_(cut_->pattern.size()) {
  for (std::size_t k = 0; k < bMB_.size(); ++k) contacts_.emplace_back(contact(k), cut_->supports[k]);
  const sparse::LdlSymbolic& ldl = cut_->pattern.ldl;
  for (int j = cut_->rows(); j < ldl.n; ++j)
    for (int i = cut_->rows(); i < j; ++i) {
      const auto first = ldl.Li.begin() + ldl.Lp[i], last = ldl.Li.begin() + ldl.Lp[i + 1];
      const auto at = std::lower_bound(first, last, j);
      triangle_.push_back(at != last && *at == j ? static_cast<int>(at - ldl.Li.begin()) : -1);
    }
}

/// Which robots' input can be used: finite numbers, quaternions of unit length.
template <class S>
typename S::Mask CutSideBySide<S>::load_state(const Job& job, std::span<const Robot> robots) {
  const double* from[8];
  const auto of = [&](auto&& at) {
    return side_by_side(robots, from, [&](const Robot& r) { return at(job.scene.robots[r.number]); });
  };
  load_arrays(of([&](const auto& robot) { return job.q + robot.idx_q; }), model_.nq, q_.data());
  load_arrays(of([&](const auto& robot) { return job.v + robot.idx_v; }), model_.nv, v_.data());
  load_arrays(of([&](const auto& robot) { return job.tau + robot.idx_v; }), model_.nv, tau_.data());
  if (!model_.floating_base) load_arrays(of([](const auto& robot) { return robot.base.R.data(); }), 12, base_.R.data());
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    load_arrays(side_by_side(robots, from,
                             [&](const Robot& r) { return job.scene.contacts[r.contacts[k]].B.placement.R.data(); }),
                12, bMB_[k].R.data());
  return usable_input<S>(model_, q_, v_, tau_);
}

template <class S>
void CutSideBySide<S>::evaluate(const Job& job, std::span<Robot> robots, Memory memory) {
  const Numbers n = numbers_in(memory.at);
  fetch_kept(n, ahead_of(memory));
  const Mask usable = load_state(job, robots);
  internal::evaluate_bias<S>(model_, base_, q_, v_, job.scene.gravity, robot_);
  internal::evaluate_inertia<S>(model_, robot_, cut_->pattern.M_slot.data(), n.K);
  store_ends(robots);
  evaluate_rows(job, robots);
  assemble(job, robots, n);
  for (std::size_t l = 0; l < robots.size(); ++l) robots[l].sound = usable[static_cast<int>(l)];
}

/// Rows of the contacts on the robots alone, the smallest of J's and the largest motion they are picked from.
template <class S>
void CutSideBySide<S>::evaluate_rows(const Job& job, std::span<Robot> robots) {
  S smallest(std::numeric_limits<double>::infinity()), motion(0);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& first = job.scene.contacts[robots.front().contacts[k]];
    ContactData<S>& rows = contacts_[k];
    rows_on_one_robot<S>(job.scene.gravity, first, cut_->supports[k], robot_.kin, bMB_[k], rows);
    motion = larger(motion_size(first, rows), motion);
    smallest = -larger(-smallest_row(rows), -smallest);
  }
  for (std::size_t l = 0; l < robots.size(); ++l) {
    robots[l].smallest_row = smallest[static_cast<int>(l)];
    robots[l].motion = motion[static_cast<int>(l)];
  }
}

/// J of the rows that do not join robots and -delta I in K, and b = [tau - h; wanted - a0; 0].
template <class S>
void CutSideBySide<S>::assemble(const Job& job, std::span<const Robot> robots, const Numbers& n) const {
  const KktPattern& p = cut_->pattern;
  const int* slot = p.J_slot.data();
  for (const ContactData<S>& rows : contacts_)
    for (Eigen::Index k = 0; k < rows.J.size(); ++k) n.K[*slot++] = rows.J.data()[k];
  const std::size_t own = p.diagonal_slot.size() - static_cast<std::size_t>(cut_->border);
  for (std::size_t k = 0; k < p.diagonal_slot.size(); ++k)
    n.K[p.diagonal_slot[k]] = S(k < own ? -job.scene.damping : 0);
  for (int i = 0; i < model_.nv; ++i) n.b[p.iperm[i]] = tau_[i] - robot_.h[i];
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    for (Eigen::Index i = 0; i < contacts_[k].a0.size(); ++i) {
      S wanted(0);
      for (std::size_t l = 0; job.wanted && l < robots.size(); ++l)
        wanted.set(static_cast<int>(l), job.wanted[job.f_offset[robots[l].contacts[k]] + i]);
      n.b[rows_of(k)[i]] = wanted - contacts_[k].a0[i];
    }
  std::fill_n(n.b + cut_->rows(), cut_->border, S(0));
}

/// ContactTerms::JoinedEnd of each contact that joins the robots.
template <class S>
void CutSideBySide<S>::store_ends(std::span<const Robot> robots) {
  S* to = joins_.data();
  const auto add = [&to](const S* from, std::size_t count) { to = std::copy_n(from, count, to); };
  for (std::size_t k = contacts_.size(); k < cut_->supports.size(); ++k) {
    const int joint = contact(k).A.joint;
    add(origin_numbers(robot_.kin, joint), 6);
    add(robot_.kin.oMi[joint].R.data(), 12);
    add(robot_.kin.v[joint].data(), 6);
    add(robot_.kin.a[joint].data(), 6);
    for (int i : cut_->supports[k].a) add(robot_.kin.J.col(i).data(), 6);
  }
  double* memory[8];
  store_arrays(joins_.data(), static_cast<int>(joins_.size()),
               side_by_side(robots, memory, [](const Robot& r) { return r.joins; }));
}

template <class S>
void CutSideBySide<S>::factor(std::span<Robot> robots, Memory memory) {
  const Numbers n = numbers_in(memory.at);
  const KktPattern& p = cut_->pattern;
  const int* slot = p.J_slot.data();
  for (const ContactData<S>& rows : contacts_) slot += rows.J.size();
  const double* from[8];
  std::size_t next = 0;  // among the joins
  for (std::size_t k = contacts_.size(); k < cut_->supports.size(); ++k) {
    const int cols = cut_->supports[k].cols(), count = contact(k).rows() * cols;
    load_arrays(side_by_side(robots, from, [&](const Robot& r) { return r.joins + next; }), count, joins_.data());
    for (int i = 0; i < count; ++i) n.K[*slot++] = joins_[i];
    next += ContactTerms::JoinedEnd::size(cols);
  }
  sparse::ldl_scheduled_factor(cut_->schedule, numbers(n.K), numbers(n.L), numbers(n.D), numbers(terms_.data()),
                               ahead_of(memory));
  const std::size_t rows = static_cast<std::size_t>(cut_->rows());
  const auto diagonal = [&](std::size_t k) { return n.K[p.K.p[k + 1] - 1]; };
  const Mask good = believable_pivots<S>(model_.nv, {n.D, rows}, terms_.data(), diagonal);
  const Growth<S> growth(rows, terms_.data(), diagonal);
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    robots[l].sound = robots[l].sound && good[lane];
    robots[l].terms = growth.terms[lane];
    robots[l].diagonal = growth.diagonal[lane];
  }
  S* to = border_.data();
  const int* below = triangle_.data();
  for (int j = cut_->rows(); j < p.size(); ++j) {
    for (int i = cut_->rows(); i < j; ++i, ++below) *to++ = *below < 0 ? S(0) : n.L[*below];
    *to++ = n.D[j];
  }
  std::copy(terms_.end() - cut_->border, terms_.end(), to);
  store_border(border_.data(), static_cast<int>(to - border_.data()) + cut_->border, robots,
               [](const Border& b) { return b.S; });
  begin(robots, n);
}

template <class S>
void CutSideBySide<S>::load(const Job& job, std::span<const Robot> robots, double* memory) {
  const Numbers n = numbers_in(memory);
  const double* from[8];
  load_arrays(side_by_side(robots, from, [&](const Robot& r) { return job.a + job.scene.robots[r.number].idx_v; }),
              model_.nv, robot_.h.data());
  for (int i = 0; i < model_.nv; ++i) n.b[cut_->pattern.iperm[i]] = robot_.h[i];
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    auto& f = contacts_[k].a0;
    load_arrays(side_by_side(robots, from, [&](const Robot& r) { return job.f + job.f_offset[r.contacts[k]]; }),
                contact(k).rows(), f.data());
    for (Eigen::Index i = 0; i < f.size(); ++i) n.b[rows_of(k)[i]] = -f[i];
  }
  begin(robots, n);
}

/// x = 0, r = b.
template <class S>
void CutSideBySide<S>::begin(std::span<const Robot> robots, const Numbers& n) {
  std::fill_n(n.x, cut_->pattern.size(), S(0));
  std::copy_n(n.b, cut_->pattern.size(), r_.data());
  forward(robots, n, S(0) <= S(0));
}

/// w = L^-1 r, and what that leaves to the border; zero for robots that are not open: they have nothing to gain.
template <class S>
void CutSideBySide<S>::forward(std::span<const Robot> robots, const Numbers& n, Mask open) {
  const int m = cut_->border;
  for (int k = 0; k < cut_->rows(); ++k) n.w[k] = select(open, r_[k], S(0));
  std::fill_n(n.w + cut_->rows(), m, S(0));
  if (open.any()) sparse::ldl_scheduled_forward(cut_->schedule, numbers(n.L), numbers(n.w));
  store_border(n.w + cut_->rows(), m, robots, [](const Border& b) { return b.b(); });
}

template <class S>
void CutSideBySide<S>::correct(std::span<Robot> robots, Memory memory) {
  const Numbers n = numbers_in(memory.at);
  const Ahead ahead = ahead_of(memory);
  const double* from[8];
  load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.border.y(); }), cut_->border,
              n.w + cut_->rows());
  sparse::ldl_scheduled_backward(cut_->schedule, numbers(n.L), numbers(n.D), numbers(n.w), ahead);
  for (int k = 0; k < cut_->pattern.size(); ++k) {
    for (const S* x : {n.x, n.w, n.b, n.D}) ahead.fetch(x + k);
    n.x[k] += n.w[k];
  }
  forward(robots, n, residual(robots, n, ahead) > S(tolerance::kRefined));
}

/// r = b - K x, scale = |b| + |K| |x|; returns the robots' componentwise backward error (sparse/refine.hpp).
template <class S>
S CutSideBySide<S>::residual(std::span<Robot> robots, const Numbers& n, Ahead ahead) {
  const KktPattern& p = cut_->pattern;
  sparse::ldl_scheduled_residual(p.K, numbers(n.K), numbers(n.x), numbers(n.b), numbers(r_.data()),
                                 numbers(scale_.data()), ahead);
  const int m = cut_->border, rows = cut_->rows();
  store_border(r_.data() + rows, m, robots, [](const Border& b) { return b.r(); });
  store_border(scale_.data() + rows, m, robots, [](const Border& b) { return b.scale(); });
  const std::span<const int> eliminated(p.iperm.data(), rows);
  const Largest<S> largest[] = {{0, eliminated.first(p.nv), r_.data(), scale_.data()},
                                {0, eliminated.subspan(p.nv), r_.data(), scale_.data()}};
  const S error = componentwise_error<S>({r_.data(), static_cast<std::size_t>(rows)}, scale_.data());
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
void CutSideBySide<S>::store(const Job& job, std::span<const Robot> robots, double* memory) const {
  const S* x = numbers_in(memory).x;
  const int* iperm = cut_->pattern.iperm.data();
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    double* a = job.a + job.scene.robots[robots[l].number].idx_v;
    for (int i = 0; i < model_.nv; ++i) a[i] = x[iperm[i]][lane];
    for (std::size_t k = 0; k < contacts_.size(); ++k) {
      double* f = job.f + job.f_offset[robots[l].contacts[k]];
      for (int i = 0; i < contact(k).rows(); ++i) f[i] = -x[rows_of(k)[i]][lane];
    }
  }
}

}  // namespace manycontact::lanes
