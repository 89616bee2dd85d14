#pragma once
// W islands of one robot each, side by side in the lanes of S = Pack<W>: the steps of a solve (dynamics/evaluate.cpp,
// kkt/factor/ldl.cpp, kkt/factor/refined.cpp), each for all lanes at once.

#include <algorithm>
#include <limits>

#include "judge.hpp"
#include "lanes.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/contact/derivatives.hpp"
#include "manycontact/contact/products.hpp"
#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "terms.hpp"

namespace manycontact::lanes {

/// One robot alone is a double's business to the sparse kernels, which then take several rows of a column at a time.
inline double* numbers(Pack<1>* x) { return x ? &x->v : nullptr; }  // null: of no numbers at all
inline const double* numbers(const Pack<1>* x) { return x ? &x->v : nullptr; }
template <int W>
Pack<W>* numbers(Pack<W>* x) {
  return x;
}
template <int W>
const Pack<W>* numbers(const Pack<W>* x) {
  return x;
}

/// Lanes without an island of their own repeat the last one.
inline const Island& in_lane(std::span<const Island* const> islands, int lane) {
  return *islands[std::min<std::size_t>(lane, islands.size() - 1)];
}
/// at(island) of each, an array of `count`, into the lanes of `to`.
template <class S, class At>
void load_each(std::span<const Island* const> islands, int count, S* to, At&& at) {
  const double* from[8];
  load_arrays(side_by_side(islands, from, [&](const Island* island) { return at(*island); }), count, to);
}

/// Adds the force F on A, in A's axes, and -F on B' to the bodies' forces.
template <class S>
void add_force(const Contact& contact, const ContactData<S>& rows, const Vec6<S>& F, std::vector<Vec6<S>>& fext) {
  fext[contact.A.joint] += rows.aMA.act_force(F);
  if (contact.B.robot >= 0) fext[contact.B.joint] -= rows.bMA.act_force(F);
}

template <class S>
class SideBySide {
 public:
  static constexpr int W = S::width;
  using Mask = typename S::Mask;

  SideBySide(const Scene& scene, const Island& island, const IslandSupport& support,
             std::shared_ptr<const KktPattern> pattern);
  void solve(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers);
  void differentiate(const DerivativeJob& job, std::span<const Island* const> islands, std::span<const Panel> panels);
  void jvp(const ProductJob& job, std::span<const Island* const> islands);
  void vjp(const ProductJob& job, std::span<const Island* const> islands);

 private:
  /// The sparse kernels' value.
  using Number = std::conditional_t<W == 1, double, S>;
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
  struct Place {
    int i, j;
    bool of_tree;  // what robot_columns writes
  };
  /// Entries of right-hand sides, a block of rows and columns of the panel: where B_ keeps them.
  struct Placed {
    S* B;
    const int* place;
    int ld;
    S& operator()(int i, int j) const { return B[place[i * ld + j]]; }
    Placed block(int i, int j) const { return {B, place + i * ld + j, ld}; }
  };

  void find_places();
  template <class Job>
  void load_state(const Job& job, std::span<const Island* const> islands);
  void load(const Job& job, std::span<const Island* const> islands);
  void keep(std::uint64_t serial, std::span<const Island* const> islands);
  template <class Job>
  void linearise(const Job& job, std::span<const Island* const> islands);
  void evaluate(const Scene& scene, const Island& island);
  void evaluate_inertia();
  void evaluate_rows(const Scene& scene, const Island& island);
  void assemble_rows(double damping);
  void assemble_right_side();
  void add_wanted(const Job& job, std::span<const Island* const> islands);
  void factor();
  void apply_inverse(std::vector<S>& x) const;
  Mask correct(Mask open);
  Mask believable_rows(const Scene& scene, const Island& island, double damping) const;
  void residual_and_sizes();
  S residual();
  S residual(Mask same_sizes);
  void refine();
  void store(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) const;
  void scatter(const Scene& scene, const std::vector<int>& f_offset, const Island& island, int lane, double* a,
               double* f) const;
  void derivative_terms(const Scene& scene, const Island& island);
  void solve_once_refined();
  BodyVariationOf<S> body(const Attachment& at) const;
  void find_reach(const DerivativeJob& job, int ld);
  std::vector<Chunk> form_chunks(std::span<const std::vector<char>> reach, int ld);
  void right_sides(const DerivativeJob& job, int ld);
  int torques(const DerivativeJob& job) const { return job.request.tau ? model_->nv : model_->nu(); }
  int torque(const DerivativeJob& job, int i) const { return job.request.tau ? i : model_->actuated[i]; }  // its row
  Mask accurate_unrefined();
  void solve_panels(std::span<const Panel> panels, Mask plain, bool past_caches);
  template <class Put>
  void write(const Band& band, std::span<const Panel> panels, Mask plain, Put&& put);
  template <int N = kColumns>
  void solve_chunk(std::size_t chunk);
  template <int N>
  void solve_columns(std::size_t chunk);
  void solve_refined(int lane, const Panel& panel);

  /// In work_, from a cache line on.
  Number* answer() {
    return reinterpret_cast<Number*>(work_.data() +
                                     (64 - reinterpret_cast<std::uintptr_t>(work_.data()) % 64) % 64 / sizeof(double));
  }
  /// Where the rows of a contact stand in K.
  const int* rows_of(std::size_t contact) const { return pattern_->iperm.data() + model_->nv + row_offset_[contact]; }

  std::shared_ptr<const Model> model_;
  std::shared_ptr<const KktPattern> pattern_;
  std::vector<ContactSupport> supports_;
  std::vector<int> row_offset_;  // per contact

  std::uint64_t serial_ = 0;  // the solution and the islands that kinematics, M, K, L, D are of
  std::vector<const Island*> kept_;

  VecX<S> q_, v_, tau_;
  SE3<S> base_;
  std::vector<SE3<S>> bMB_;  // per contact, where B is the world: its placement
  Mask usable_;              // q, v, tau are finite, quaternions of unit length

  RobotQuantities<S> robot_;
  std::vector<ContactData<S>> contacts_;

  std::vector<S> K_, L_, D_;  // as KktMatrix, LdlSymbolic have them
  std::vector<S> pivot_terms_, b_, x_, r_, scale_, correction_;
  S steps_, backward_error_, first_error_;

  // of derivatives
  VecX<S> a_;
  std::vector<VecX<S>> contact_f_, contact_scratch_;  // rows of each contact
  std::vector<Vec6<S>> fext_;
  RneaDerivativesOf<S> rnea_;
  std::vector<ContactDerivativesOf<S>> contact_terms_;
  std::vector<std::vector<int>> columns_;  // per contact: its coordinates
  std::vector<Place> places_;              // of -dr/dq, -dr/dv: where they are not zero
  DerivativeRequest request_;              // that reach_ is of
  std::vector<Chunk> chunks_;              // of all columns
  std::vector<Band> bands_;
  // Per row of K, in the pattern's order, for each chunk: where right-hand sides, and L^-1 times them, may be other
  // than zero.
  std::vector<char> reach_, reached_;
  std::vector<char> nonzero_;  // per row of K
  std::vector<S> B_;           // right-hand sides, chunk by chunk: the rows that it reaches, in the pattern's order
  std::vector<int> place_;     // of each entry of the panel in B_; -1: that is zero
  std::vector<int> unset_;     // entries of B_ that the terms of contacts are added to before anything is written
  std::vector<S> packed_;      // sparse::ldl_pack
  std::vector<double> Lx_, Dx_, Kx_;      // one lane's
  std::vector<Piece> pieces_;             // of all columns
  std::vector<double> work_;              // a band, chunk after chunk; of solve_refined
  double rounding_;                       // sparse::ldl_rounding
  std::vector<BodyVariationOf<S>> body_;  // products: tangents, or adjoints
  std::vector<Vec6<S>> u_, dfext_, df_;
  std::vector<S> dq_, dv_, w_;
  std::vector<S> slope_;  // nv, where joints have friction: -d tau_f / dv
};

template <class S>
SideBySide<S>::SideBySide(const Scene& scene, const Island& island, const IslandSupport& support,
                          std::shared_ptr<const KktPattern> pattern)
    : model_(scene.robots[island.robots.front()].model),
      pattern_(std::move(pattern)),
      supports_(support.contacts),
      row_offset_(island.row_offset),
      kept_(W),
      q_(model_->nq),
      v_(model_->nv),
      tau_(model_->nv),
      bMB_(island.contacts.size()),
      robot_(*model_),
      K_(pattern_->K.nonzeros()),
      L_(pattern_->ldl.nonzeros()),
      D_(pattern_->size()),
      pivot_terms_(pattern_->size()),
      b_(pattern_->size()),
      x_(pattern_->size()),
      r_(pattern_->size()),
      scale_(pattern_->size()),
      correction_(pattern_->size()),
      a_(model_->nv),
      fext_(model_->njoints()),
      rnea_(*model_),
      columns_(support.columns),
      nonzero_(pattern_->size()),
      packed_(pattern_->schedule().packed.size()),
      Lx_(L_.size()),
      Dx_(D_.size()),
      Kx_(K_.size()),
      work_(sparse::panel_kernels().work_size(pattern_->schedule())),
      rounding_(sparse::ldl_rounding(pattern_->ldl)),
      body_(model_->njoints()),
      u_(model_->njoints()),
      dfext_(model_->njoints()),
      df_(model_->njoints()),
      dq_(model_->nv),
      dv_(model_->nv),
      w_(model_->nv),
      slope_(has_friction(*model_) ? model_->nv : 0) {
  for (std::size_t k = 0; k < island.contacts.size(); ++k) {
    const Contact& contact = scene.contacts[island.contacts[k]];
    contacts_.emplace_back(contact, supports_[k]);
    contact_terms_.emplace_back(scene, contact, supports_[k]);
    contact_f_.emplace_back(contact.rows());
    contact_scratch_.emplace_back(contact.rows());
  }
  find_places();
}

/// Rows of a coordinate's columns of -dr: its ancestors and descendants, and the rows of contacts on any of these.
template <class S>
void SideBySide<S>::find_places() {
  const int nv = model_->nv;
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> places;
  places.setZero(pattern_->size(), nv);
  for (int i = 0; i < nv; ++i)
    for (int j = i; j >= 0; j = model_->dof_parent[j]) places(i, j) = places(j, i) = true;
  const auto of_tree = places;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const ContactDerivativesOf<S>& terms = contact_terms_[k];
    for (const std::vector<int>* chain : {&terms.chain_a, &terms.chain_b})
      for (int i : *chain) {
        places.col(i).segment(nv + row_offset_[k], contacts_[k].a0.size()).setOnes();
        // a force on one of two bodies moves with the other
        for (const std::vector<int>* other : {&terms.chain_a, &terms.chain_b})
          for (int j : *other) places(j, i) = true;
      }
  }
  for (int i = 0; i < places.rows(); ++i)
    for (int j = 0; j < nv; ++j)
      if (places(i, j)) places_.push_back({i, j, of_tree(i, j)});
}

template <class S>
void SideBySide<S>::solve(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) {
  const Scene& scene = job.scene;
  const Island& first = *islands.front();
  load(job, islands);
  keep(job.serial, islands);
  evaluate(scene, first);
  assemble_rows(scene.damping);
  assemble_right_side();
  if (job.wanted) add_wanted(job, islands);
  factor();
  usable_ = usable_ & believable_rows(scene, first, scene.damping) &
            believable_pivots<S>(model_->nv, D_, pivot_terms_.data(),
                                 [&](std::size_t k) { return K_[pattern_->K.p[k + 1] - 1]; });
  refine();
  store(job, islands, answers);
}

template <class S>
template <class Job>
void SideBySide<S>::load_state(const Job& job, std::span<const Island* const> islands) {
  const auto robot = [&](const Island& i) -> const Robot& { return job.scene.robots[i.robots.front()]; };
  load_each(islands, model_->nq, q_.data(), [&](const Island& i) { return job.q + robot(i).idx_q; });
  load_each(islands, model_->nv, v_.data(), [&](const Island& i) { return job.v + robot(i).idx_v; });
  if (!model_->floating_base)
    load_each(islands, 12, base_.R.data(), [&](const Island& i) { return robot(i).base.R.data(); });
  for (std::size_t k = 0; k < bMB_.size(); ++k)
    load_each(islands, 12, bMB_[k].R.data(),
              [&](const Island& i) { return job.scene.contacts[i.contacts[k]].B.placement.R.data(); });
}

template <class S>
void SideBySide<S>::load(const Job& job, std::span<const Island* const> islands) {
  load_state(job, islands);
  load_each(islands, model_->nv, tau_.data(),
            [&](const Island& i) { return job.tau + job.scene.robots[i.robots.front()].idx_v; });
  usable_ = usable_input<S>(*model_, q_, v_, tau_);
}

template <class S>
void SideBySide<S>::evaluate(const Scene& scene, const Island& island) {
  internal::evaluate_bias<S>(*model_, base_, q_, v_, scene.gravity, robot_);
  evaluate_inertia();
  evaluate_rows(scene, island);
}

/// M in K.
template <class S>
void SideBySide<S>::evaluate_inertia() {
  internal::evaluate_inertia<S>(*model_, robot_, pattern_->M_slot.data(), K_.data());
}

template <class S>
void SideBySide<S>::evaluate_rows(const Scene& scene, const Island& island) {
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    rows_on_one_robot<S>(scene.gravity, scene.contacts[island.contacts[k]], supports_[k], robot_.kin, bMB_[k],
                         contacts_[k]);
}

/// J and -delta I in K.
template <class S>
void SideBySide<S>::assemble_rows(double damping) {
  const KktPattern& p = *pattern_;
  const int* slot = p.J_slot.data();
  for (const ContactData<S>& rows : contacts_)
    for (Eigen::Index k = 0; k < rows.J.size(); ++k) K_[*slot++] = rows.J.data()[k];
  for (int k : p.diagonal_slot) K_[k] = S(-damping);
}

/// b = [tau - h; -a0]
template <class S>
void SideBySide<S>::assemble_right_side() {
  const KktPattern& p = *pattern_;
  for (int i = 0; i < model_->nv; ++i) b_[p.iperm[i]] = tau_[i] - robot_.h[i];
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    for (Eigen::Index i = 0; i < contacts_[k].a0.size(); ++i) b_[rows_of(k)[i]] = -contacts_[k].a0[i];
}

/// The contact rows of b, per lane.
template <class S>
void SideBySide<S>::add_wanted(const Job& job, std::span<const Island* const> islands) {
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    for (Eigen::Index i = 0; i < contacts_[k].a0.size(); ++i) {
      S wanted(0);
      for (int l = 0; l < W; ++l) wanted.set(l, job.wanted[job.f_offset[in_lane(islands, l).contacts[k]] + i]);
      b_[rows_of(k)[i]] += wanted;
    }
}

template <class S>
void SideBySide<S>::factor() {
  sparse::ldl_scheduled_factor(pattern_->schedule(), numbers(K_.data()), numbers(L_.data()), numbers(D_.data()),
                               numbers(pivot_terms_.data()));
}

/// x <- K^-1 x
template <class S>
void SideBySide<S>::apply_inverse(std::vector<S>& x) const {
  sparse::ldl_scheduled_solve(pattern_->schedule(), numbers(L_.data()), numbers(D_.data()), numbers(x.data()));
}

/// x += K^-1 r in the lanes that are open. Where no entry moves by more than kSameSize of itself: there |K| |x| stays
/// what it is, but for as much.
template <class S>
typename S::Mask SideBySide<S>::correct(Mask open) {
  constexpr double kSameSize = 1e-6;
  correction_ = r_;
  apply_inverse(correction_);
  Mask same_sizes = S(0) <= S(0);
  for (std::size_t k = 0; k < x_.size(); ++k) {
    const S x = x_[k], step = select(open, correction_[k], S(0));
    same_sizes = same_sizes & (abs(step) <= S(kSameSize) * abs(x));
    x_[k] = select(open, x + step, x);
  }
  return same_sizes;
}

/// No row of J is nothing but rounding beside the contacts' motions: pivots do not show that.
template <class S>
typename S::Mask SideBySide<S>::believable_rows(const Scene& scene, const Island& island, double damping) const {
  S smallest(std::numeric_limits<double>::infinity()), motion(0);
  if (damping > 0 || contacts_.empty()) return smallest > motion;
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const ContactData<S>& rows = contacts_[k];
    motion = larger(motion_size(scene.contacts[island.contacts[k]], rows), motion);
    smallest = -larger(-smallest_row(rows), -smallest);
  }
  return smallest > S(tolerance::kRank) * motion;
}

/// r = b - K x, scale = |b| + |K| |x|.
template <class S>
void SideBySide<S>::residual_and_sizes() {
  sparse::ldl_scheduled_residual(pattern_->K, numbers(K_.data()), numbers(x_.data()), numbers(b_.data()),
                                 numbers(r_.data()), numbers(scale_.data()));
}

/// r, scale, and the componentwise backward error (sparse/refine.hpp); NaN where any is.
template <class S>
S SideBySide<S>::residual() {
  residual_and_sizes();
  return componentwise_error<S>(r_, scale_.data());
}

/// The same after `correct`, which says where scale need not be computed again.
template <class S>
S SideBySide<S>::residual(Mask same_sizes) {
  if (same_sizes.all()) {
    sparse::ldl_scheduled_residual(pattern_->K, numbers(K_.data()), numbers(x_.data()), numbers(b_.data()),
                                   numbers(r_.data()));
  } else {
    correction_ = scale_;
    residual_and_sizes();
    for (std::size_t k = 0; k < scale_.size(); ++k) scale_[k] = select(same_sizes, correction_[k], scale_[k]);
  }
  return componentwise_error<S>(r_, scale_.data());
}

/// x = K^-1 b, each lane refined as if it stood alone (sparse/refine.hpp).
template <class S>
void SideBySide<S>::refine() {
  x_ = b_;
  apply_inverse(x_);
  const Refinement<S> refined(usable_, residual(), [&](Mask open) { return residual(correct(open)); });
  steps_ = refined.steps, backward_error_ = refined.error, first_error_ = refined.first;
  usable_ = usable_ & (backward_error_ <= S(tolerance::kConverged));
}

template <class S>
void SideBySide<S>::store(const Job& job, std::span<const Island* const> islands, std::span<Answer> answers) const {
  const KktPattern& p = *pattern_;
  // Residuals relative to the terms they are left of; those of the contacts at least to gravity.
  const std::span<const int> rows(p.iperm);
  const Largest<S> dynamics(0, rows.first(p.nv), r_.data(), scale_.data());
  const Largest<S> contact(job.scene.gravity.norm(), rows.subspan(p.nv), r_.data(), scale_.data());
  const Growth<S> growth(D_.size(), pivot_terms_.data(), [&](std::size_t k) { return K_[p.K.p[k + 1] - 1]; });
  const Mask safe =
      growth.terms * S(std::numeric_limits<double>::epsilon()) <= S(tolerance::kConverged) * growth.diagonal;
  const S factor = select(growth.diagonal > S(0), growth.terms / growth.diagonal, S(1));
  const Mask sound = usable_ & (factor <= S(std::numeric_limits<double>::max()));
  for (std::size_t l = 0; l < islands.size(); ++l) {
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
    scatter(job.scene, job.f_offset, *islands[l], lane, job.a, job.f);
  }
}

/// A lane's x = [a; -f] into the scene's a and f.
template <class S>
void SideBySide<S>::scatter(const Scene& scene, const std::vector<int>& f_offset, const Island& island, int lane,
                            double* a, double* f) const {
  const int* iperm = pattern_->iperm.data();
  each_velocity_block(scene, island, [&](int to, int from, int n) {
    for (int i = 0; i < n; ++i) a[to + i] = x_[iperm[from + i]][lane];
  });
  each_force_block(scene, f_offset, island, [&](int to, int from, int n) {
    for (int i = 0; i < n; ++i) f[to + i] = -x_[iperm[island.nv + from + i]][lane];
  });
}

// ---- the solution once more, for derivatives (derivatives.hpp) and products -------------------------------------

template <class S>
void SideBySide<S>::keep(std::uint64_t serial, std::span<const Island* const> islands) {
  serial_ = serial;
  kept_.assign(islands.begin(), islands.end());
}

/// Motions and contact rows at the solution, K and its factor.
template <class S>
template <class Job>
void SideBySide<S>::linearise(const Job& job, std::span<const Island* const> islands) {
  const Island& first = *islands.front();
  const bool kept = serial_ == job.serial && std::equal(kept_.begin(), kept_.end(), islands.begin(), islands.end());
  if (!kept) {
    load_state(job, islands);
    keep(job.serial, islands);
    forward_kinematics<S>(*model_, base_, q_, robot_.kin);
    evaluate_inertia();
  }
  load_each(islands, model_->nv, a_.data(),
            [&](const Island& i) { return job.a + job.scene.robots[i.robots.front()].idx_v; });
  for (std::size_t k = 0; k < contacts_.size(); ++k)
    load_each(islands, static_cast<int>(contact_f_[k].size()), contact_f_[k].data(),
              [&](const Island& i) { return job.f + job.f_offset[i.contacts[k]]; });
  forward_accelerations<S>(*model_, v_, a_.data(), job.scene.gravity, robot_.kin);
  evaluate_rows(job.scene, first);
  for (std::size_t i = 0; i < slope_.size(); ++i)
    for (int l = 0; l < W; ++l) slope_[i].set(l, friction_slope(*model_, static_cast<int>(i), v_[i][l]));
  if (kept) return;
  assemble_rows(job.scene.damping);
  factor();
}

// ---- products: dynamics/jvp.cpp for all lanes at once -------------------------------------------------------------

/// x = K^-1 b, refined once as solve_refined with one step does.
template <class S>
void SideBySide<S>::solve_once_refined() {
  x_ = b_;
  apply_inverse(x_);
  const Mask open = residual() > S(tolerance::kRefined);
  if (open.any()) (void)correct(open);
}

template <class S>
BodyVariationOf<S> SideBySide<S>::body(const Attachment& at) const {
  const Vec6<S> zero = Vec6<S>::Zero();
  return at.robot < 0 ? BodyVariationOf<S>{zero, zero, zero, zero} : body_[at.joint];
}

template <class S>
void SideBySide<S>::jvp(const ProductJob& job, std::span<const Island* const> islands) {
  const Scene& scene = job.scene;
  const Island& first = *islands.front();
  const KktPattern& p = *pattern_;
  const int nv = model_->nv;
  linearise(job, islands);
  const auto velocities = [&](const Island& i) { return scene.robots[i.robots.front()].idx_v; };
  load_each(islands, nv, dq_.data(), [&](const Island& i) { return job.in[0] + velocities(i); });
  load_each(islands, nv, dv_.data(), [&](const Island& i) { return job.in[1] + velocities(i); });
  std::fill(w_.begin(), w_.end(), S(0));
  for (int l = 0; l < W; ++l) {
    const Robot& robot = scene.robots[in_lane(islands, l).robots.front()];
    for (int i = 0; i < model_->nu(); ++i) w_[model_->actuated[i]].set(l, job.in[2][robot.idx_u + i]);
  }
  tangent_motions<S>(*model_, robot_.kin, a_.data(), dq_.data(), dv_.data(), body_);
  std::fill(fext_.begin(), fext_.end(), Vec6<S>(Vec6<S>::Zero()));
  std::fill(dfext_.begin(), dfext_.end(), Vec6<S>(Vec6<S>::Zero()));
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = scene.contacts[first.contacts[k]];
    const ContactData<S>& rows = contacts_[k];
    VecX<S>& dr2 = contact_scratch_[k];
    Vec6<S> dF;
    contact_tangent<S>(contact, rows, body(contact.A), body(contact.B), contact_f_[k], dr2, dF);
    add_force<S>(contact, rows, rows.W.transpose() * contact_f_[k], fext_);
    add_force<S>(contact, rows, dF, dfext_);
    for (Eigen::Index i = 0; i < dr2.size(); ++i) b_[rows_of(k)[i]] = -dr2[i];
  }
  tangent_torques<S>(*model_, robot_.kin, body_, fext_, dfext_, robot_.f, df_, dq_.data());
  for (int i = 0; i < nv; ++i) b_[p.iperm[i]] = w_[i] - dq_[i];
  for (std::size_t i = 0; i < slope_.size(); ++i) b_[p.iperm[i]] -= slope_[i] * dv_[i];
  solve_once_refined();
  for (std::size_t l = 0; l < islands.size(); ++l)  // x = [da; -df]
    scatter(scene, job.f_offset, *islands[l], static_cast<int>(l), job.out[0], job.out[1]);
}

template <class S>
void SideBySide<S>::vjp(const ProductJob& job, std::span<const Island* const> islands) {
  const Scene& scene = job.scene;
  const Island& first = *islands.front();
  const KktPattern& p = *pattern_;
  const int nv = model_->nv;
  linearise(job, islands);
  for (int l = 0; l < W; ++l) {
    const Island& island = in_lane(islands, l);
    const double* wa = job.in[0] + scene.robots[island.robots.front()].idx_v;
    for (int i = 0; i < nv; ++i) b_[p.iperm[i]].set(l, wa[i]);
    for (std::size_t k = 0; k < contacts_.size(); ++k)
      for (Eigen::Index i = 0; i < contact_f_[k].size(); ++i)
        b_[rows_of(k)[i]].set(l, -job.in[1][job.f_offset[island.contacts[k]] + i]);
  }
  solve_once_refined();  // l = K^-1 [wa; -wf]
  for (int i = 0; i < nv; ++i) w_[i] = x_[p.iperm[i]];
  virtual_velocities<S>(*model_, robot_.kin, w_.data(), u_);
  const Vec6<S> zero = Vec6<S>::Zero();
  std::fill(body_.begin(), body_.end(), BodyVariationOf<S>{zero, zero, zero, zero});
  add_body_adjoints<S>(*model_, robot_.kin, u_, body_);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    const Contact& contact = scene.contacts[first.contacts[k]];
    VecX<S>& l = contact_scratch_[k];
    for (Eigen::Index i = 0; i < l.size(); ++i) l[i] = x_[rows_of(k)[i]];
    BodyVariationOf<S> nobody{zero, zero, zero, zero};
    const bool between = contact.B.robot >= 0;
    contact_adjoint<S>(contact, contacts_[k], u_[contact.A.joint], between ? u_[contact.B.joint] : zero, contact_f_[k],
                       l, body_[contact.A.joint], between ? body_[contact.B.joint] : nobody);
  }
  pull_back<S>(*model_, robot_.kin, a_.data(), u_, body_, dq_.data(), dv_.data());
  for (std::size_t i = 0; i < slope_.size(); ++i) dv_[i] += slope_[i] * w_[i];
  for (std::size_t l = 0; l < islands.size(); ++l) {
    const Robot& robot = scene.robots[islands[l]->robots.front()];
    const int lane = static_cast<int>(l);
    for (int i = 0; i < nv; ++i) job.out[0][robot.idx_v + i] = -dq_[i][lane];  // w = -(dr)^T l
    for (int i = 0; i < nv; ++i) job.out[1][robot.idx_v + i] = -dv_[i][lane];
    for (int i = 0; i < model_->nu(); ++i) job.out[2][robot.idx_u + i] = w_[model_->actuated[i]][lane];
  }
}

}  // namespace manycontact::lanes
