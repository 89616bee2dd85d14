#pragma once
// W robots of one plan (block.hpp), side by side in the lanes of S = Pack<W>: the steps of a solve
// (systems/matrix/evaluate.cpp, kkt/factor/ldl.cpp, kkt/factor/refined.cpp), each for all lanes at once. Derivatives
// are in derivatives.hpp, products with them in products.hpp.

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <optional>

#include "../derivatives/jacobian_rate.hpp"
#include "../robot_quantities.hpp"
#include "../systems/contact_drift.hpp"
#include "arrays.hpp"
#include "checks.hpp"
#include "dependent_rows.hpp"
#include "lanes.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/algorithm/model_numbers.hpp"
#include "manycontact/contact/derivatives.hpp"
#include "manycontact/contact/products.hpp"
#include "manycontact/contact/row_scale.hpp"
#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lanes {

template <class S>
class RobotBlock {
 public:
  static constexpr int W = S::width;
  using Mask = typename S::Mask;
  using Robot = RobotBlocks::Robot;
  using Robots = std::span<Robot>;
  using Memory = RobotBlocks::Memory;

  explicit RobotBlock(std::shared_ptr<const BlockPlan> plan);
  // as RobotBlocks has them
  void solve(const Job& job, Robots robots, std::span<Answer> answers);
  void differentiate(const DerivativeJob& job, Robots robots, double* memory, std::span<const Panel> panels);
  void jvp(const ProductJob& job, Robots robots);
  void vjp(const ProductJob& job, Robots robots);
  void evaluate(const Job& job, Robots robots, Memory memory);
  void factor(Robots robots, Memory memory);
  void load(const Job& job, Robots robots, double* memory);
  void correct(Robots robots, Memory memory);
  void check(Robots robots, Memory memory);
  void finish(Robots robots, Memory memory);
  void store(const Job& job, Robots robots, double* memory);
  void move_ends(const DerivativeJob& job, Robots robots);

 private:
  /// The sparse kernels' value.
  using Number = std::conditional_t<W == 1, double, S>;
  /// In the memory of a batch: K, L, D as KktMatrix, LdlSymbolic have them; w = L^-1 r.
  struct Numbers {
    S *K, *b, *L, *D, *x, *w;
  };
  /// Robots joined to others: a batch meets its numbers again after all others have met theirs.
  using Prefetch = std::conditional_t<W == 1, sparse::kernel::NoPrefetch, sparse::kernel::PrefetchNext>;
  static Prefetch prefetch_of(const Memory& memory) {
    if constexpr (W == 1)
      return {};
    else
      return {(memory.next - memory.at) / W};
  }
  void use(double* memory) {
    Numbers& n = n_;
    n.K = reinterpret_cast<S*>(memory);
    n.b = n.K + pattern_.K.nonzeros();
    n.L = n.b + pattern_.size();
    n.D = n.L + pattern_.ldl.nonzeros();
    n.x = n.D + pattern_.size();
    n.w = n.x + pattern_.size();
    if (dependent_) dependent_->use(memory + plan_->dependence_at() * W);
  }

  /// Of a panel: columns at a time; those of them in registers, four rows of each; and those of a part, which stand
  /// beside each other in the panel.
  struct Columns {
    int at_a_time, in_registers, of_part;
  };
  static constexpr Columns columns_of(int registers) {
    if (W == 1) return registers == 8 ? Columns{32, 32, 8} : registers == 4 ? Columns{12, 12, 4} : Columns{4, 4, 4};
    return registers == 8 ? Columns{8, 4, 1} : registers == 4 ? Columns{12, 3, 1} : Columns{12, 2, 1};
  }
  static constexpr Columns kOfPanel = columns_of(sparse::kernel::kRegister);
  static constexpr int kColumns = kOfPanel.at_a_time, kPart = kOfPanel.of_part, kParts = kColumns / kPart;
  static_assert(8 % kPart == 0 && 8 % W == 0);
  struct Chunk {
    int first[kParts], parts;
    std::size_t at;      // in B_: rows that it reaches, its columns side by side
    std::size_t answer;  // in work_: all rows, likewise
    int columns() const { return W == 1 ? parts * kPart : kColumns; }
  };
  struct Band {  // of parts, and their chunks
    int first, end;
    std::size_t chunk, chunk_end;
  };
  struct Piece {  // a part of columns in work_: that of row k, in the pattern's order, is at + k stride
    std::size_t at;
    int stride;
  };
  struct Contradicted {  // lanes::Contradiction
    S left = S(0), Ja = S(0), a0 = S(0), of_terms = S(0);
    S least_row = S(std::numeric_limits<double>::infinity()), largest_row = S(0);
    Contradiction operator[](int lane) const {
      return {left[lane], Ja[lane], a0[lane], of_terms[lane], least_row[lane], largest_row[lane]};
    }
  };
  struct Slot {
    int i, j;
    bool of_tree;  // what robot_columns writes
  };
  /// Entries of right-hand sides, a block of rows and columns of the panel: where B_ keeps them.
  struct Indexed {
    S* B;
    const int* place;
    int ld;
    S& operator()(int i, int j) const { return B[place[i * ld + j]]; }
    Indexed block(int i, int j) const { return {B, place + i * ld + j, ld}; }
  };

  // the steps
  template <class Job>
  void load_state(const Job& job, Robots robots);
  void load_model(const Scene& scene, Robots robots);
  void load_ends(const Scene& scene, Robots robots);
  void set_up(const Job& job, Robots robots);
  void evaluate_rows(const Scene& scene, Robots robots);
  void check_rows(const Scene& scene, Robots robots);
  void assemble_rows(double damping);
  void assemble_right_side(const Job& job, Robots robots);
  void factorize(Prefetch prefetch = {});
  Mask sound_pivots();
  void solve_by_factor(S* x) const;
  void apply_inverse(S* x);
  Mask correct(Mask open);
  void residual_and_sizes();
  S residual();
  S backward_error();
  S residual(Mask same_sizes);
  void refine();
  Mask plainly_damped(double damping) const;
  void report(const Job& job, Robots robots, std::span<Answer> answers) const;
  // of rows that depend on each other
  void size_rows(const Scene& scene, Robots robots);
  void restore_contradiction();
  Contradicted contradicted() const;
  void report_dependence(Robots robots, std::span<Answer> answers);
  void scatter(const Scene& scene, const std::vector<int>& f_offset, const Robot& robot, int lane, double* a,
               double* f) const;
  // with a border
  void prefetch_cached(Prefetch prefetch) const;
  void collect_ends(std::initializer_list<const Mat6X<S>*> columns);
  void store_ends(Robots robots);
  void store_schur_complement(Robots robots);
  void begin(Robots robots);
  void forward(Robots robots, Mask open);
  S check_residual(Robots robots, Prefetch prefetch);
  // of derivatives and products
  template <class Job>
  void linearise(const Job& job, Robots robots, double* memory);
  bool keeps(std::uint64_t serial, Robots robots) const;
  void keep(std::uint64_t serial, Robots robots);
  void add_forces(const Scene& scene, Robots robots, std::vector<Vec6<S>>& fext);
  void derivative_terms(const Scene& scene, Robots robots);
  void solve_once_refined();
  // where rows depend
  internal::JacobianRate<S> jacobian_rate(const Scene& scene, Robots robots, std::size_t k) const;
  void motion_of_forces();
  void least_norm_columns(const DerivativeJob& job, Robots robots);
  template <int N>
  void subtract_least_norm_columns(std::size_t chunk, Number* X);
  void add_least_norm_tangent(const Scene& scene, Robots robots, const std::vector<S>& dq);
  void project_forces();
  void add_least_norm_adjoint(const Scene& scene, Robots robots, std::vector<S>& wq);
  BodyVariationOf<S> body(const Attachment& at) const;
  void find_places();
  void find_reach(const DerivativeJob& job);
  std::vector<Chunk> form_chunks(std::span<const std::vector<char>> reach, int ld);
  void right_sides(const DerivativeJob& job, Robots robots);
  int torques(const DerivativeJob& job) const { return job.request.tau ? model_->nv : model_->nu(); }
  int torque(const DerivativeJob& job, int i) const { return job.request.tau ? i : model_->actuated[i]; }  // its row
  const S* inner_L();
  Mask accurate_unrefined(const S* L);
  void solve_panels(const S* L, std::span<const Panel> panels, Mask plain, bool non_temporal);
  template <class Put>
  void write(const Band& band, std::span<const Panel> panels, Mask plain, Put&& put);
  template <int N = kColumns>
  void solve_chunk(const S* L, std::size_t chunk);
  template <int N>
  void solve_columns(const S* L, std::size_t chunk);
  template <int N>
  void load_chunk(std::size_t chunk, Number* x) const;
  template <int N>
  void subtract_product(const Number* X, Number* R) const;
  void solve_refined(const S* L, int lane, const Panel& panel, int ld);

  /// In work_, from a cache line on.
  Number* answer() {
    return reinterpret_cast<Number*>(work_.data() +
                                     (64 - reinterpret_cast<std::uintptr_t>(work_.data()) % 64) % 64 / sizeof(double));
  }
  const Contact& contact(std::size_t k) const { return plan_->scene.contacts[k]; }
  /// Where the rows of a contact stand in K.
  const int* rows_of(std::size_t k) const { return pattern_.iperm.data() + model_->nv + plan_->island.row_offset[k]; }
  auto diagonal() const {
    return [this](std::size_t k) { return n_.K[pattern_.K.p[k + 1] - 1]; };
  }
  static Mask all() { return S(0) <= S(0); }
  /// Lanes without a robot of their own repeat the last one.
  static const Robot& in_lane(Robots robots, int lane) {
    return robots[std::min<std::size_t>(static_cast<std::size_t>(lane), robots.size() - 1)];
  }
  /// at(robot in its scene, robot) of each, an array of `count`, into the lanes of `to`.
  template <class At>
  static void load_each(const Scene& scene, Robots robots, int count, S* to, At&& at) {
    const double* from[8];
    load_arrays(side_by_side(robots, from, [&](const Robot& r) { return at(scene.robots[r.number], r); }), count, to);
  }
  /// from, of the border, into the robots' arrays.
  template <class To>
  static void store_border(const S* from, int count, Robots robots, To&& to) {
    double* memory[8];
    store_arrays(from, count, side_by_side(robots, memory, [&](const Robot& r) { return to(r.border); }));
  }

  std::shared_ptr<const BlockPlan> plan_;
  std::shared_ptr<const Model> model_;
  const KktPattern &pattern_, &inner_;
  const sparse::LdlSchedule &schedule_, &inner_schedule_;
  int rows_;  // that are eliminated

  VecX<S> q_, v_, tau_;
  SE3<S> base_;
  std::vector<std::array<StandingEnd<S>, 2>>
      standing_;                                // per contact on the robots alone: A, B, where they stand still
  std::vector<std::array<SE3<S>, 2>> on_body_;  // and the frames on the bodies where they move
  Mask usable_;                                 // q, v, tau are finite, quaternions of unit length ...
  ModelNumbers<S> own_model_;                   // where the robots are not all of the plan's model
  RobotQuantities<S> robot_;
  std::vector<ContactData<S>> contacts_;
  S smallest_row_, motion_;

  Numbers n_;           // those at work
  std::vector<S> own_;  // of robots alone
  std::vector<S> pivot_terms_, r_, scale_;
  std::optional<DependentRows<S>> dependent_;  // where the plan drops rows
  S steps_, backward_error_, first_error_;
  std::uint64_t serial_ = 0;  // the solution and the robots that kinematics, M, K, L, D are of
  std::array<int, W> kept_;
  std::size_t kept_count_ = 0;

  std::vector<S> joins_, border_;  // with a border
  std::vector<int> triangle_;      // slots in L of the border's columns, below the diagonal; -1: zero

  // of derivatives
  VecX<S> a_;
  std::vector<VecX<S>> contact_f_, contact_scratch_;  // rows of each contact
  std::vector<Vec6<S>> fext_;
  RneaDerivativesOf<S> rnea_;
  std::vector<ContactDerivativesOf<S>> contact_terms_;
  std::vector<std::vector<int>> columns_;  // per contact: its coordinates
  std::vector<Slot> places_;               // of -dr/dq, -dr/dv: where they are not zero
  DerivativeRequest request_;              // that reach_ is of
  int q_first_ = 0;                        // of its columns
  std::vector<Chunk> chunks_;              // of all columns
  std::vector<Band> bands_;
  // Per row of K, in the pattern's order, for each chunk: where right-hand sides, and L^-1 times them, may be other
  // than zero.
  std::vector<char> reach_, reached_;
  std::vector<char> nonzero_;  // per row of K
  std::vector<S> B_;           // right-hand sides, chunk by chunk: the rows that it reaches, in the pattern's order
  std::vector<int> place_;     // of each entry of the panel in B_; -1: that is zero
  std::vector<int> unset_;     // entries of B_ that the terms of contacts are added to before anything is written
  std::vector<S> inner_L_;     // L without the border's rows
  std::vector<S> packed_;      // sparse::ldl_pack
  std::vector<S> inverse_;     // of the pivots
  std::vector<double> Lx_, Dx_, Kx_;      // one lane's
  std::vector<Piece> pieces_;             // of all columns
  std::vector<double> work_;              // a band, chunk after chunk; of solve_refined
  double rounding_;                       // sparse::ldl_rounding
  std::vector<BodyVariationOf<S>> body_;  // products: tangents, or adjoints
  std::vector<Vec6<S>> u_, dfext_, df_;
  std::vector<S> dq_, dv_, torque_;
  // Where rows depend: J y = f; of jvp dq, of vjp what is added to wq; d(J y)/dq, in K's order; a chunk's correction.
  std::vector<S> y_, along_, rate_, correction_;
  std::vector<S> slope_;  // nv, where joints have friction: -d tau_f / dv
};

template <class S>
RobotBlock<S>::RobotBlock(std::shared_ptr<const BlockPlan> plan)
    : plan_(std::move(plan)),
      model_(plan_->model()),
      pattern_(*plan_->pattern),
      inner_(*plan_->inner),
      schedule_(plan_->schedule()),
      inner_schedule_(inner_.schedule()),
      rows_(plan_->rows()),
      q_(model_->nq),
      v_(model_->nv),
      tau_(model_->nv),
      standing_(plan_->alone),
      on_body_(plan_->alone),
      own_model_(*model_),
      robot_(*model_),
      own_(plan_->border > 0 ? 0 : plan_->memory_size()),
      pivot_terms_(pattern_.size()),
      r_(pattern_.size()),
      scale_(pattern_.size()),
      joins_(std::max(plan_->joins_size(), plan_->ends_size())),
      border_(Border::size(plan_->border)),
      a_(model_->nv),
      fext_(model_->njoints()),
      rnea_(*model_),
      nonzero_(rows_),
      inner_L_(plan_->border > 0 ? inner_.ldl.nonzeros() : 0),
      packed_(inner_schedule_.packed.size()),
      inverse_(rows_),
      Lx_(inner_.ldl.nonzeros()),
      Dx_(rows_),
      Kx_(inner_.K.nonzeros()),
      work_(sparse::panel_kernels().work_size(inner_schedule_)),
      rounding_(sparse::ldl_rounding(inner_.ldl)),
      body_(model_->njoints()),
      u_(model_->njoints()),
      dfext_(model_->njoints()),
      df_(model_->njoints()),
      dq_(model_->nv),
      dv_(model_->nv),
      torque_(model_->nv),
      y_(plan_->dropped.empty() ? 0 : model_->nv),
      along_(y_.size()),
      slope_(has_friction(*model_) ? model_->nv : 0) {
  for (std::size_t k = 0; k < standing_.size(); ++k) {
    const ContactSupport& support = plan_->supports[k];
    contacts_.emplace_back(contact(k), support);
    contact_terms_.emplace_back(plan_->scene, contact(k), support);
    contact_f_.emplace_back(contact(k).rows());
    contact_scratch_.emplace_back(contact(k).rows());
    columns_.push_back(support.a);
    columns_.back().insert(columns_.back().end(), support.b.begin(), support.b.end());
  }
  if (!plan_->dropped.empty()) dependent_.emplace(*plan_);
  const sparse::LdlSymbolic& ldl = pattern_.ldl;
  for (int j = rows_; j < ldl.n; ++j)
    for (int i = rows_; i < j; ++i) {
      const auto first = ldl.Li.begin() + ldl.Lp[i], last = ldl.Li.begin() + ldl.Lp[i + 1];
      const auto at = std::lower_bound(first, last, j);
      triangle_.push_back(at != last && *at == j ? static_cast<int>(at - ldl.Li.begin()) : -1);
    }
  find_places();
}

// ---- K x = b ------------------------------------------------------------------------------------------------------

template <class S>
template <class Job>
void RobotBlock<S>::load_state(const Job& job, Robots robots) {
  load_each(job.scene, robots, model_->nq, q_.data(), [&](const auto& r, auto&) { return job.q + r.idx_q; });
  load_each(job.scene, robots, model_->nv, v_.data(), [&](const auto& r, auto&) { return job.v + r.idx_v; });
  if (!model_->floating_base)
    load_each(job.scene, robots, 12, base_.R.data(), [](const auto& r, auto&) { return r.base.R.data(); });
  load_model(job.scene, robots);
  load_ends(job.scene, robots);
}

/// The robots' own placements, inertias and armatures, unless they are the model's.
template <class S>
void RobotBlock<S>::load_model(const Scene& scene, Robots robots) {
  static_assert(sizeof(Inertia<double>) == 13 * sizeof(double) && sizeof(Inertia<S>) == 13 * sizeof(S));
  const auto of = [&scene](const Robot& r) -> const std::shared_ptr<const Model>& {
    return scene.robots[r.number].model;
  };
  robot_.kin.own = nullptr;
  if (std::all_of(robots.begin(), robots.end(), [&](const Robot& r) { return of(r) == model_; })) return;
  robot_.kin.own = &own_model_;
  const double* from[8];
  const auto load = [&](int count, S* to, auto&& at) {
    load_arrays(side_by_side(robots, from, [&](const Robot& r) -> const double* { return at(*of(r)); }), count, to);
  };
  for (std::size_t i = 0; i < own_model_.placement.size(); ++i) {
    load(12, own_model_.placement[i].R.data(), [i](const Model& m) { return m.joints[i].placement.R.data(); });
    load(13, &own_model_.inertia[i].m, [i](const Model& m) { return &m.joints[i].inertia.m; });
  }
  load(model_->nv, own_model_.armature.data(), [](const Model& m) { return m.armature.data(); });
}

/// Where the ends of contacts are: on their bodies, or where they stand.
template <class S>
void RobotBlock<S>::load_ends(const Scene& scene, Robots robots) {
  static_assert(sizeof(StandingEnd<double>) == 15 * sizeof(double) && sizeof(StandingEnd<S>) == 15 * sizeof(S));
  StandingEnd<double> ends[W];
  const double* from[8];
  for (std::size_t k = 0; k < standing_.size(); ++k)
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
        from[l] = ends[l].frame.R.data();
      }
      load_arrays(std::span<const double* const>(from, robots.size()), 15, standing_[k][B].frame.R.data());
    }
}

/// The robots' own part of K x = b, and which robots' input can be used.
template <class S>
void RobotBlock<S>::set_up(const Job& job, Robots robots) {
  load_state(job, robots);
  load_each(job.scene, robots, model_->nv, tau_.data(), [&](const auto& r, auto&) { return job.tau + r.idx_v; });
  usable_ = usable_input<S>(*model_, q_, v_, tau_);
  internal::evaluate_bias<S>(*model_, base_, q_, v_, job.scene.gravity, robot_);
  internal::evaluate_inertia<S>(*model_, robot_, pattern_.M_slot.data(), n_.K);
  evaluate_rows(job.scene, robots);
  check_rows(job.scene, robots);
  if (dependent_) size_rows(job.scene, robots);
  assemble_rows(job.scene.damping);
  assemble_right_side(job, robots);
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

/// The smallest row of J, and the largest motion that rows are picked from: rows that are nothing but rounding beside
/// that no pivot shows.
template <class S>
void RobotBlock<S>::check_rows(const Scene& scene, Robots robots) {
  smallest_row_ = S(std::numeric_limits<double>::infinity()), motion_ = S(0);
  if (scene.damping > 0) return;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    motion_ = larger(motion_scale(scene.contacts[robots.front().contacts[k]], contacts_[k]), motion_);
    smallest_row_ = -larger(-smallest_row(contacts_[k]), -smallest_row_);
  }
}

/// J and -delta I in K; of the border J comes later, and no damping.
template <class S>
void RobotBlock<S>::assemble_rows(double damping) {
  const int* slot = pattern_.J_slot.data();
  for (const ContactData<S>& rows : contacts_)
    for (Eigen::Index k = 0; k < rows.J.size(); ++k) n_.K[*slot++] = rows.J.data()[k];
  const std::size_t count = pattern_.diagonal_slot.size(), own = count - static_cast<std::size_t>(plan_->border);
  for (std::size_t k = 0; k < count; ++k) n_.K[pattern_.diagonal_slot[k]] = S(k < own ? -damping : 0);
}

/// b = [tau - h; wanted - a0; 0]
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
  std::fill_n(n_.b + rows_, plan_->border, S(0));
}

/// r = b - K x, scale = |b| + |K| |x|.
template <class S>
void RobotBlock<S>::residual_and_sizes() {
  sparse::ldl_scheduled_residual(pattern_.K, as_scalar(n_.K), as_scalar(n_.x), as_scalar(n_.b), as_scalar(r_.data()),
                                 as_scalar(scale_.data()));
}

// ---- robots alone -------------------------------------------------------------------------------------------------

template <class S>
void RobotBlock<S>::solve(const Job& job, Robots robots, std::span<Answer> answers) {
  use(reinterpret_cast<double*>(own_.data()));
  set_up(job, robots);
  keep(job.serial, robots);
  factorize();
  usable_ = usable_ & sound_pivots();
  if (!dependent_) usable_ = usable_ & (smallest_row_ > S(tolerance::kRank) * motion_);
  refine();
  report(job, robots, answers);
  if (dependent_) report_dependence(robots, answers);
}

/// L and D, without the rows that depend on others.
template <class S>
void RobotBlock<S>::factorize(Prefetch prefetch) {
  if (dependent_) dependent_->damp(n_.K);
  sparse::ldl_scheduled_factor(schedule_, as_scalar(n_.K), as_scalar(n_.L), as_scalar(n_.D),
                               as_scalar(pivot_terms_.data()), prefetch);
  if (dependent_) dependent_->undamp(n_.K, n_.D, pivot_terms_.data());
}

/// Whether the pivots can be believed; where rows are dropped, that it is these.
template <class S>
typename S::Mask RobotBlock<S>::sound_pivots() {
  if (dependent_) return dependent_->hold(n_.K, n_.L, n_.D, pivot_terms_.data(), [this](S* x) { solve_by_factor(x); });
  return accept_pivots<S>(model_->nv, {n_.D, static_cast<std::size_t>(rows_)}, pivot_terms_.data(), diagonal());
}

/// x <- K^-1 x by L and D, without the border: what x has there, of all the pattern's rows, is lost.
template <class S>
void RobotBlock<S>::solve_by_factor(S* x) const {
  if (plan_->border == 0) return sparse::ldl_scheduled_solve(schedule_, as_scalar(n_.L), as_scalar(n_.D), as_scalar(x));
  sparse::ldl_scheduled_forward(schedule_, as_scalar(n_.L), as_scalar(x));
  std::fill_n(x + rows_, plan_->border, S(0));
  sparse::ldl_scheduled_backward(schedule_, as_scalar(n_.L), as_scalar(n_.D), as_scalar(x));
}

/// x <- K^-1 x; where rows depend, (I - P) K_kept^-1 x, of an x without part P x (Factor::correct).
template <class S>
void RobotBlock<S>::apply_inverse(S* x) {
  solve_by_factor(x);
  if (dependent_) dependent_->project_out(x);
}

/// x += K^-1 r in the lanes that are open. Where no entry moves by more than kSameSize of itself: there |K| |x| stays
/// what it is, but for as much.
template <class S>
typename S::Mask RobotBlock<S>::correct(Mask open) {
  constexpr double kSameSize = 1e-6;
  std::copy_n(r_.data(), rows_, n_.w);
  apply_inverse(n_.w);
  Mask same_sizes = all();
  for (int k = 0; k < rows_; ++k) {
    const S x = n_.x[k], step = select(open, n_.w[k], S(0));
    same_sizes = same_sizes & (abs(step) <= S(kSameSize) * abs(x));
    n_.x[k] = select(open, x + step, x);
  }
  return same_sizes;
}

/// r, scale, and the backward error.
template <class S>
S RobotBlock<S>::residual() {
  residual_and_sizes();
  return backward_error();
}

/// The componentwise backward error of r, NaN where any is (Factor::backward_error).
template <class S>
S RobotBlock<S>::backward_error() {
  const std::span<const S> r(r_.data(), static_cast<std::size_t>(rows_));
  if (!dependent_) return componentwise_error<S>(r, scale_.data());
  dependent_->scale_of_dependent(scale_.data(), n_.w);
  return componentwise_error<S>(r, n_.w);
}

/// The same after `correct`, which says where scale need not be computed again.
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

/// x = K^-1 b, each lane refined as if it stood alone (sparse/refine.hpp).
template <class S>
void RobotBlock<S>::refine() {
  if (dependent_) dependent_->project_out(n_.b, true);
  std::copy_n(n_.b, rows_, n_.x);
  apply_inverse(n_.x);
  const Refinement<S> refined(usable_, residual(), [&](Mask open) { return residual(correct(open)); });
  steps_ = refined.steps, backward_error_ = refined.error, first_error_ = refined.first;
  usable_ = usable_ & (backward_error_ <= S(tolerance::kConverged));
  if (dependent_) restore_contradiction();
}

template <class S>
void RobotBlock<S>::report(const Job& job, Robots robots, std::span<Answer> answers) const {
  // Residuals relative to the terms they are left of; those of the contacts at least to gravity.
  const std::span<const int> rows(pattern_.iperm);
  const Largest<S> dynamics(0, rows.first(pattern_.nv), r_.data(), scale_.data());
  const Largest<S> contact(job.scene.gravity.norm(), rows.subspan(pattern_.nv), r_.data(), scale_.data());
  const Growth<S> growth(static_cast<std::size_t>(rows_), pivot_terms_.data(), diagonal());
  const Mask safe =
      growth.terms * S(std::numeric_limits<double>::epsilon()) <= S(tolerance::kConverged) * growth.diagonal;
  const S factor = select(growth.diagonal > S(0), growth.terms / growth.diagonal, S(1));
  const Mask sound = usable_ & (factor <= S(std::numeric_limits<double>::max())) & plainly_damped(job.scene.damping);
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    Answer& answer = answers[l];
    answer.sound = sound[lane];
    if (!answer.sound) continue;
    answer.panel_is_safe = safe[lane];
    answer.refine_panel = first_error_[lane] > tolerance::kRefinePanel;
    answer.refinement_steps = static_cast<int>(steps_[lane]);
    answer.backward_error = backward_error_[lane];
    answer.residual_dynamics = dynamics.ratio(lane);
    answer.residual_contact = contact.ratio(lane);
    scatter(job.scene, job.f_offset, robots[l], lane, job.a, job.f);
  }
}

/// Whether rounding of a damped row's terms is little beside the forces (kInDoubt), or a thousandth of the loads'
/// terms.
template <class S>
typename S::Mask RobotBlock<S>::plainly_damped(double damping) const {
  if (!(damping > 0)) return all();
  S scale(0), force(0);
  for (int i = 0; i < pattern_.size() - plan_->border; ++i) {
    const int k = pattern_.iperm[i];
    if (i >= pattern_.nv) scale = larger(scale_[k], scale);
    force = larger(i < pattern_.nv ? S(1e-3) * scale_[k] : abs(n_.x[k]), force);
  }
  return scale <= S(tolerance::kInDoubt * damping) * force;
}

// ---- rows that depend on each other (systems/matrix/fallbacks.cpp) ------------------------------------------------

/// What rows of J are judged beside, and what their contradictions are.
template <class S>
void RobotBlock<S>::size_rows(const Scene& scene, Robots robots) {
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = scene.contacts[robots.front().contacts[k]];
    const S moved = row_scale<S>(c, contacts_[k], 0), turned = c.rows() > 3 ? row_scale<S>(c, contacts_[k], 3) : moved;
    const Vec3<S> place = c.B.robot < 0 ? standing_[k][1].origin : Vec3<S>(Vec3<S>::Zero());
    const auto& kin = robot_.kin;
    const auto terms = internal::contact_drift<S>(c, contacts_[k], *model_, kin, *model_, kin, place);
    for (int i = 0; i < c.rows(); ++i) {
      const int row = rows_of(k)[i];
      dependent_->row_size(row) = i < 3 ? moved : turned;
      dependent_->row_terms(row) = terms.of_row(i);
    }
  }
}

/// Rows of b and r with what was taken out of them: what dependent rows contradict each other by.
template <class S>
void RobotBlock<S>::restore_contradiction() {
  for (int i = pattern_.nv; i < pattern_.size() - plan_->border; ++i) {
    const int k = pattern_.iperm[i];
    const S of_null = dependent_->null_component(k);
    scale_[k] -= abs(n_.b[k]);
    n_.b[k] += of_null;
    r_[k] += of_null;
    scale_[k] += abs(n_.b[k]);
  }
  backward_error_ = componentwise_error<S>(r_, scale_.data());
}

template <class S>
typename RobotBlock<S>::Contradicted RobotBlock<S>::contradicted() const {
  Contradicted out;
  internal::PassedRounding<S> passed;
  for (int i = pattern_.nv; dependent_ && i < pattern_.size() - plan_->border; ++i) {
    const int k = pattern_.iperm[i];
    passed.add(dependent_->row_size(k), dependent_->row_terms(k));
  }
  for (int i = pattern_.nv; i < pattern_.size() - plan_->border; ++i) {
    const int k = pattern_.iperm[i];
    out.Ja = larger(scale_[k] - abs(n_.b[k]), out.Ja);
    out.a0 = larger(abs(n_.b[k]), out.a0);
    if (!dependent_) continue;
    const S size = dependent_->row_size(k), left = abs(dependent_->null_component(k));
    out.left = larger(left, out.left);
    out.of_terms =
        larger(select(left > S(0), S(left / passed.terms(size, dependent_->row_terms(k))), S(0)), out.of_terms);
    out.least_row = select(size > S(0), -larger(-size, -out.least_row), out.least_row);  // of rows at all
    out.largest_row = larger(size, out.largest_row);
  }
  return out;
}

template <class S>
void RobotBlock<S>::report_dependence(Robots robots, std::span<Answer> answers) {
  const Contradicted of = contradicted();
  for (std::size_t l = 0; l < robots.size(); ++l) {
    answers[l].contradiction = of[static_cast<int>(l)];
    if (answers[l].contradiction.needs_oracle()) answers[l].sound = false;
    if (answers[l].contradiction.exceeds_rounding())  // the whole K has the term of what is left
      answers[l].panel_is_safe = false;
  }
}

/// A lane's x = [a; -f] into the scene's a and f.
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

// ---- robots joined to others --------------------------------------------------------------------------------------

/// Asks for what those whose turn is next will write: K, b and the joins.
template <class S>
void RobotBlock<S>::prefetch_cached(Prefetch prefetch) const {
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
    robots[l].smallest_row = dependent_ ? std::numeric_limits<double>::infinity() : smallest_row_[lane];
    robots[l].motion = motion_[lane];
  }
}

/// Into joins_, of each contact that joins the robots: how its end's body moves, and its coordinates' columns of these.
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

/// JoinedEnd of each contact that joins the robots.
template <class S>
void RobotBlock<S>::store_ends(Robots robots) {
  collect_ends({&robot_.kin.J});
  double* memory[8];
  store_arrays(joins_.data(), static_cast<int>(plan_->joins_size()),
               side_by_side(robots, memory, [](const Robot& r) { return r.joins; }));
}

template <class S>
void RobotBlock<S>::factor(Robots robots, Memory memory) {
  use(memory.at);
  const int* slot = pattern_.J_slot.data();
  for (const ContactData<S>& rows : contacts_) slot += rows.J.size();
  const double* from[8];
  std::size_t next = 0;  // among the joins
  for (std::size_t k = contacts_.size(); k < plan_->supports.size(); ++k) {
    const int cols = plan_->supports[k].cols(), count = contact(k).rows() * cols;
    load_arrays(side_by_side(robots, from, [&](const Robot& r) { return r.joins + next; }), count, joins_.data());
    for (int i = 0; i < count; ++i) n_.K[*slot++] = joins_[i];
    next += JoinedEnd::size(cols);
  }
  factorize(prefetch_of(memory));
  const Mask good = sound_pivots();
  const Growth<S> growth(static_cast<std::size_t>(rows_), pivot_terms_.data(), diagonal());
  for (std::size_t l = 0; l < robots.size(); ++l) {
    const int lane = static_cast<int>(l);
    robots[l].sound = robots[l].sound && good[lane];
    robots[l].terms = growth.terms[lane];
    robots[l].diagonal = growth.diagonal[lane];
  }
  store_schur_complement(robots);
  begin(robots);
}

/// What the elimination leaves of K in the border, and the terms of that.
template <class S>
void RobotBlock<S>::store_schur_complement(Robots robots) {
  S* to = border_.data();
  const int* below = triangle_.data();
  for (int j = rows_; j < pattern_.size(); ++j) {
    for (int i = rows_; i < j; ++i, ++below) *to++ = *below < 0 ? S(0) : n_.L[*below];
    *to++ = n_.D[j];
  }
  std::copy(pivot_terms_.end() - plan_->border, pivot_terms_.end(), to);
  store_border(border_.data(), static_cast<int>(to - border_.data()) + plan_->border, robots,
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
  std::fill_n(n_.b + rows_, plan_->border, S(0));
  begin(robots);
}

/// x = 0, r = b.
template <class S>
void RobotBlock<S>::begin(Robots robots) {
  std::fill_n(n_.x, pattern_.size(), S(0));
  if (dependent_) dependent_->project_out(n_.b, true);
  std::copy_n(n_.b, pattern_.size(), r_.data());
  forward(robots, all());
}

/// w = L^-1 r, and what that leaves to the border; zero for robots that are not open: they have nothing to gain.
template <class S>
void RobotBlock<S>::forward(Robots robots, Mask open) {
  for (int k = 0; k < rows_; ++k) n_.w[k] = select(open, r_[k], S(0));
  std::fill_n(n_.w + rows_, plan_->border, S(0));
  if (open.any()) sparse::ldl_scheduled_forward(schedule_, as_scalar(n_.L), as_scalar(n_.w));
  store_border(n_.w + rows_, plan_->border, robots, [](const Border& b) { return b.b(); });
}

template <class S>
void RobotBlock<S>::correct(Robots robots, Memory memory) {
  use(memory.at);
  const Prefetch prefetch = prefetch_of(memory);
  const double* from[8];
  load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.border.y(); }), plan_->border, n_.w + rows_);
  sparse::ldl_scheduled_backward(schedule_, as_scalar(n_.L), as_scalar(n_.D), as_scalar(n_.w), prefetch);
  if (dependent_) dependent_->project_out(n_.w);
  for (int k = 0; k < pattern_.size(); ++k) {
    for (const S* x : {n_.x, n_.w, n_.b, n_.D}) prefetch.fetch(x + k);
    n_.x[k] += n_.w[k];
  }
  forward(robots, check_residual(robots, prefetch) > S(tolerance::kRefined));
}

template <class S>
void RobotBlock<S>::check(Robots robots, Memory memory) {
  use(memory.at);
  const double* from[8];
  const auto spread = [&](auto&& at, S* to) {  // rows as the island has them, in K's order
    load_arrays(side_by_side(robots, from, at), rows_, pivot_terms_.data());
    for (int i = 0; i < rows_; ++i) to[pattern_.iperm[i]] = pivot_terms_[i];
  };
  spread([](const Robot& r) { return r.x; }, n_.x);
  spread([](const Robot& r) { return r.b; }, n_.b);
  load_arrays(side_by_side(robots, from, [](const Robot& r) { return r.border.y(); }), plan_->border, n_.x + rows_);
  std::fill_n(n_.b + rows_, plan_->border, S(0));
  if (dependent_) dependent_->project_out(n_.b);
  (void)check_residual(robots, prefetch_of(memory));
}

/// r = b - K x, scale = |b| + |K| |x|, and what is reported of them; returns the robots' backward error.
template <class S>
S RobotBlock<S>::check_residual(Robots robots, Prefetch prefetch) {
  sparse::ldl_scheduled_residual(pattern_.K, as_scalar(n_.K), as_scalar(n_.x), as_scalar(n_.b), as_scalar(r_.data()),
                                 as_scalar(scale_.data()), prefetch);
  store_border(r_.data() + rows_, plan_->border, robots, [](const Border& b) { return b.r(); });
  store_border(scale_.data() + rows_, plan_->border, robots, [](const Border& b) { return b.scale(); });
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
  for (int k = pattern_.nv; dependent_ && k < rows_; ++k) n_.b[k] += dependent_->null_component(k);
  (void)check_residual(robots, prefetch_of(memory));
  const S error = componentwise_error<S>({r_.data(), static_cast<std::size_t>(rows_)}, scale_.data());
  const Contradicted of = contradicted();
  for (std::size_t l = 0; l < robots.size(); ++l) {
    robots[l].contradiction = of[static_cast<int>(l)];
    robots[l].error = error[static_cast<int>(l)];
  }
}

template <class S>
void RobotBlock<S>::store(const Job& job, Robots robots, double* memory) {
  use(memory);
  for (std::size_t l = 0; l < robots.size(); ++l)
    scatter(job.scene, job.f_offset, robots[l], static_cast<int>(l), job.a, job.f);
}

// ---- the solution once more, for derivatives and products ---------------------------------------------------------

template <class S>
bool RobotBlock<S>::keeps(std::uint64_t serial, Robots robots) const {
  return serial_ == serial && kept_count_ == robots.size() &&
         std::equal(robots.begin(), robots.end(), kept_.begin(),
                    [](const Robot& r, int number) { return r.number == number; });
}
template <class S>
void RobotBlock<S>::keep(std::uint64_t serial, Robots robots) {
  serial_ = serial;
  kept_count_ = robots.size();
  std::transform(robots.begin(), robots.end(), kept_.begin(), [](const Robot& r) { return r.number; });
}

/// Motions and contact rows at the solution, K and its factor. memory: of robots joined to others, which has the
/// latter; nullptr where only motions are wanted of them.
template <class S>
template <class Job>
void RobotBlock<S>::linearise(const Job& job, Robots robots, double* memory) {
  const bool alone = plan_->border == 0, kept = alone && keeps(job.serial, robots);
  if (alone) memory = reinterpret_cast<double*>(own_.data());
  if (memory) use(memory);
  if (!kept) {
    load_state(job, robots);
    if (alone) keep(job.serial, robots);
    forward_kinematics<S>(*model_, base_, q_, robot_.kin);
    if (memory) internal::evaluate_inertia<S>(*model_, robot_, pattern_.M_slot.data(), n_.K);
  }
  load_each(job.scene, robots, model_->nv, a_.data(), [&](const auto& r, auto&) { return job.a + r.idx_v; });
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    load_each(job.scene, robots, static_cast<int>(contact_f_[k].size()), contact_f_[k].data(),
              [&](auto&, const Robot& r) { return job.f + job.f_offset[r.contacts[k]]; });
  forward_accelerations<S>(*model_, v_, a_.data(), job.scene.gravity, robot_.kin);
  if (!memory) return;
  evaluate_rows(job.scene, robots);
  for (int l = 0; l < W && !slope_.empty(); ++l) {
    const Model& model = *job.scene.robots[in_lane(robots, l).number].model;
    for (std::size_t i = 0; i < slope_.size(); ++i)
      slope_[i].set(l, friction_slope(model, static_cast<int>(i), v_[i][l]));
  }
  if (kept || !alone) return;
  if (dependent_) size_rows(job.scene, robots);
  assemble_rows(job.scene.damping);
  factorize();
  if (dependent_) (void)sound_pivots();  // it is known: for the null space
}

/// Adds the force F on A, in A's axes, and -F on B' to the bodies' forces.
template <class S>
void add_force(const Contact& contact, const ContactData<S>& rows, const Vec6<S>& F, std::vector<Vec6<S>>& fext) {
  each_body_force(contact, rows, F, [&](const Attachment& at, const Vec6<S>& force) { fext[at.joint] += force; });
}

/// fext = those of the contacts at the solution.
template <class S>
void RobotBlock<S>::add_forces(const Scene& scene, Robots robots, std::vector<Vec6<S>>& fext) {
  std::fill(fext.begin(), fext.end(), Vec6<S>(Vec6<S>::Zero()));
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    add_force<S>(scene.contacts[robots.front().contacts[k]], contacts_[k], contacts_[k].W.transpose() * contact_f_[k],
                 fext);
}

}  // namespace manycontact::lanes
