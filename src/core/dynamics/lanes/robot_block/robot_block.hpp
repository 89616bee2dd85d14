#pragma once
// A SIMD batch of W robots of one BlockPlan (block.hpp). Numbers are packs S = Pack<W>: element l belongs to robot l.
// Further headers contain inputs (terms.hpp), solves of single-robot islands (alone.hpp) and of coupled robots
// (joined.hpp), linearisation (linearise.hpp), derivatives and products. The border are rows of coupling contacts.

#include <algorithm>
#include <initializer_list>
#include <type_traits>

#include "../../derivatives/jacobian_rate.hpp"
#include "../../robot_quantities.hpp"
#include "../arrays.hpp"
#include "../checks.hpp"
#include "../lanes.hpp"
#include "manycontact/algorithm/joint_friction.hpp"
#include "manycontact/algorithm/model_numbers.hpp"
#include "manycontact/contact/products.hpp"
#include "manycontact/detail/contact/derivatives.hpp"
#include "manycontact/rank/row_size.hpp"
#include "manycontact/sparse/ldl_panel_kernels.hpp"
#include "manycontact/sparse/panel_kernels.hpp"
#include "manycontact/sparse/tolerances.hpp"
#include "waiting_rows.hpp"

namespace manycontact::lanes {

struct Without {  // an empty type for members that kernels in single precision do not need
  explicit Without(const Model&) {}
};

/// Implements RobotBlocks if S contains doubles, SingleBlocks if floats.
template <class S>
class RobotBlock final
    : public std::conditional_t<std::is_same_v<typename S::Element, float>, SingleBlocks, RobotBlocks> {
 public:
  static constexpr int W = S::width;
  /// Whether elements are floats. Such kernels solve only single-robot islands without redundant rows (single.hpp).
  static constexpr bool kSingle = std::is_same_v<typename S::Element, float>;
  using Mask = typename S::Mask;
  using Robot = RobotBlocks::Robot;
  using Robots = std::span<Robot>;
  using Memory = RobotBlocks::Memory;

  explicit RobotBlock(std::shared_ptr<const BlockPlan> plan);
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
  using Number = std::conditional_t<W == 1, typename S::Element, S>;  // the number type of sparse kernels
  struct Numbers {  // arrays in a batch's memory: K, its factors L, D, right-hand side b, solution x, w = L^-1 r
    S *K, *b, *L, *D, *x, *w;
  };
  /// Prefetches the next batch's memory, which other batches have displaced from the cache.
  using Prefetch = std::conditional_t<W == 1, sparse::kernel::NoPrefetch, sparse::kernel::PrefetchNext>;
  static Prefetch prefetch_of(const Memory& memory) {
    if constexpr (W == 1)
      return {};
    else
      return {(memory.next - memory.at) * static_cast<std::ptrdiff_t>(sizeof(double))};
  }
  void use(double* memory) { use(reinterpret_cast<S*>(memory)); }
  void use(S* numbers) {
    Numbers& n = n_;
    n.K = numbers;
    n.b = n.K + pattern_.K.nonzeros();
    n.L = n.b + pattern_.size();
    n.D = n.L + pattern_.ldl.nonzeros();
    n.x = n.D + pattern_.size();
    n.w = n.x + pattern_.size();
    waiting_.use(numbers + plan_->waiting_at());
  }

  /// Numbers of panel columns: at_a_time are solved together (a chunk), in_registers are kept in registers for four
  /// rows, of_part are adjacent in the panel (a part).
  struct Columns {
    int at_a_time, in_registers, of_part;
  };
  static constexpr Columns columns_of(int registers) {
    if (W == 1) return registers == 8 ? Columns{32, 32, 8} : registers == 4 ? Columns{12, 12, 4} : Columns{4, 4, 4};
    return registers == 8 ? Columns{8, 4, 1} : registers == 4 ? Columns{12, 3, 1} : Columns{12, 2, 1};
  }
  static constexpr Columns kOfPanel = columns_of(sparse::kernel::kRegister);
  static constexpr int kColumns = kOfPanel.at_a_time, kPart = kOfPanel.of_part, kParts = kColumns / kPart;
  static_assert(kSingle || (8 % kPart == 0 && 8 % W == 0));
  struct Chunk {
    int first[kParts], parts;
    std::size_t at;      // offset in B_ of the chunk's right-hand sides: rows that may be nonzero, row-major
    std::size_t answer;  // offset in work_ of the chunk's solutions: all rows, row-major
    int columns() const { return W == 1 ? parts * kPart : kColumns; }
  };
  struct Band {  // columns that are solved, then copied to panels together: ranges of parts and of chunks
    int first, end;
    std::size_t chunk, chunk_end;
  };
  struct Piece {  // the solutions of a part in work_: row k, in the pattern's order, begins at `at` + k stride
    std::size_t at;
    int stride;
  };
  struct Slot {  // an entry of -dr/dq or -dr/dv that may be nonzero
    int i, j;
    bool of_tree;  // whether it has terms of inverse dynamics (robot_columns), not only of contacts
  };
  struct Indexed {  // access to the right-hand sides in B_ by row and column of the panel
    S* B;
    const int* place;
    int ld;
    S& operator()(int i, int j) const { return B[place[i * ld + j]]; }
    Indexed block(int i, int j) const { return {B, place + i * ld + j, ld}; }
  };

  template <class Job>
  void load_state(const Job& job, Robots robots);
  void load_model(const Scene& scene, Robots robots);
  void load_ends(const Scene& scene, Robots robots);
  void set_up(const Job& job, Robots robots);
  void load_start(const Job& job, Robots robots);
  void evaluate_start(const StartOfStep& start);
  void store_contact_velocities(const Job& job, Robots robots);
  void evaluate_rows(const Scene& scene, Robots robots);
  void store_left(const Job& job, Robots robots) const;
  void size_rows(const Scene& scene, Robots robots);
  void assemble_rows(double damping);
  void assemble_right_side(const Job& job, Robots robots);
  Mask factorize(Mask usable, Prefetch prefetch = {});
  void solve_by_factor(S* x) const;
  void apply_inverse(S* x);
  Mask correct(Mask open);
  void residual_and_sizes();
  S residual();
  S backward_error();
  S residual(Mask same_sizes);
  void refine();
  // single precision
  template <class Job>
  void load_near(const Job& job, Robots robots);
  void size_torques(const Scene& scene, Robots robots, S* sizes);
  void size_drifts(const Scene& scene, Robots robots, const S& a, S* sizes) const;
  S largest(const S* x, int first, int end) const;
  Mask knows_turns(const Scene& scene, Robots robots) const;
  void make_single();
  void solve_unrefined(const Scene& scene, Robots robots);
  Mask plainly_damped(double damping) const;
  void report(const Job& job, Robots robots, std::span<Answer> answers) const;
  // redundant rows
  bool rows_wait() const;
  void size_drifts(const Scene& scene, Robots robots);
  void restore_contradiction();
  rank::Contradiction<S> contradicted() const;
  void report_dependence(Robots robots, std::span<Answer> answers);
  void scatter(const Scene& scene, const std::vector<int>& f_offset, const Robot& robot, int lane, double* a,
               double* f) const;
  // coupled robots
  void prefetch_cached(Prefetch prefetch) const;
  void collect_ends(std::initializer_list<const Mat6X<S>*> columns);
  void store_ends(Robots robots);
  void store_schur_complement(Robots robots);
  void begin(Robots robots);
  void forward(Robots robots, Mask open);
  S check_residual(Robots robots, Prefetch prefetch);
  // derivatives and products
  template <class Job>
  void linearise(const Job& job, Robots robots, double* memory);
  bool keeps(std::uint64_t serial, Robots robots) const;
  void keep(std::uint64_t serial, Robots robots);
  void add_forces(const Scene& scene, Robots robots, std::vector<Vec6<S>>& fext);
  void derivative_terms(const Scene& scene, Robots robots);
  void solve_once_refined();
  // derivatives with redundant rows
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
  /// torques: the number of torque columns. torque: the coordinate on which the i-th of these torques acts.
  int torques(const DerivativeJob& job) const { return job.request.tau ? model_->nv : model_->nu(); }
  int torque(const DerivativeJob& job, int i) const { return job.request.tau ? i : model_->actuated[i]; }
  const S* inner_L();
  Mask accurate_unrefined(const S* L);
  void solve_panels(const S* L, std::span<const Panel> panels, Mask of, WaitingRows<S>* waiting,
                    const DerivativeJob& job);
  template <class Put>
  void write(const Band& band, std::span<const Panel> panels, Mask plain, Put&& put);
  template <int N = kColumns>
  void solve_chunk(const S* L, std::size_t chunk, WaitingRows<S>* waiting);
  template <int N>
  void solve_columns(const S* L, std::size_t chunk, WaitingRows<S>* waiting);
  template <int N>
  void load_chunk(std::size_t chunk, Number* x) const;
  template <int N>
  void subtract_product(const Number* X, Number* R) const;
  void solve_refined(const S* L, int lane, const Panel& panel, int ld);

  Number* answer() {  // the first cache-line-aligned address in work_, where solutions begin
    return reinterpret_cast<Number*>(work_.data() +
                                     (64 - reinterpret_cast<std::uintptr_t>(work_.data()) % 64) % 64 / sizeof(double));
  }
  const Contact& contact(std::size_t k) const { return plan_->scene.contacts[k]; }
  /// Returns the rows of a contact in K.
  const int* rows_of(std::size_t k) const { return pattern_.iperm.data() + model_->nv + plan_->island.row_offset[k]; }
  auto diagonal() const {
    return [this](std::size_t k) { return n_.K[pattern_.K.p[k + 1] - 1]; };
  }
  static Mask all() { return S(0) <= S(0); }
  static const Robot& in_lane(Robots robots, int lane) {  // an element's robot; surplus elements repeat the last
    return robots[std::min<std::size_t>(static_cast<std::size_t>(lane), robots.size() - 1)];
  }
  /// Loads `count` numbers of each robot, from the address at(robot of the scene, robot), into the elements of `to`.
  template <class At>
  static void load_each(const Scene& scene, Robots robots, int count, S* to, At&& at) {
    const double* from[kMostInBatch];
    load_arrays(side_by_side(robots, from, [&](const Robot& r) { return at(scene.robots[r.number], r); }), count, to);
  }
  /// Stores each robot's elements of from[0 ... count-1] in the array to(Robot::border).
  template <class To>
  static void store_border(const S* from, int count, Robots robots, To&& to) {
    double* memory[kMostInBatch];
    store_arrays(from, count, side_by_side(robots, memory, [&](const Robot& r) { return to(r.border); }));
  }

  std::shared_ptr<const BlockPlan> plan_;
  std::shared_ptr<const Model> model_;
  const KktPattern &pattern_, &inner_;
  const sparse::LdlSchedule &schedule_, &inner_schedule_;
  int rows_;  // number of eliminated rows, i.e. of K without the border

  VecX<S> q_, v_, tau_;
  SE3<S> base_;
  // single precision (single.hpp)
  struct BodySizes {  // magnitudes of a body's linear and angular acceleration due to qdd, of force and moment
    S moved, turned, force, moment;
  };
  std::vector<double> near_q_, per_turn_;  // each robot's q without whole revolutions; 1/(2 pi) for angles, else 0
  std::array<Vec3<double>, W> origin_;     // each robot's base position, to which world positions are relative
  std::vector<BodySizes> body_sizes_;
  std::vector<float> signs_;                             // one entry per row of K: pseudo-random 1 or -1
  std::vector<std::array<StandingEnd<S>, 2>> standing_;  // one entry per contact on single robots: its fixed ends A, B
  std::vector<std::array<SE3<S>, 2>> on_body_;           // one entry per contact on single robots: ends A, B that move
  Mask usable_;                                          // robots that have passed all checks so far
  ModelNumbers<S> own_model_;                            // used if a robot has another model than the plan's
  RobotQuantities<S> robot_;
  std::vector<ContactData<S>> contacts_;
  std::vector<const PairNumbers<double>*> common_pair_;  // one per contact: numbers that all elements share, or nullptr
  S smallest_row_, motion_;                              // size of J's smallest row; size by which it is judged
  bool may_wait_ = false;  // whether rows of J without a sound pivot may wait; if not, another system must solve

  Numbers n_;
  std::vector<S> own_;  // memory of K, its factors and vectors in single-robot islands
  std::vector<S> pivot_terms_, r_, scale_;
  WaitingRows<S> waiting_;
  S steps_, backward_error_, first_error_;
  std::uint64_t serial_ = 0;  // Solution::serial of the current kinematics, M, K, L, D; 0: none
  std::array<int, W> kept_;   // numbers in the scene of that solution's robots
  std::size_t kept_count_ = 0;

  std::vector<S> joins_, border_;
  std::vector<int> triangle_;  // slots in L of the border's triangle, by columns without diagonal; -1: zero

  // derivatives
  VecX<S> a_;
  std::vector<VecX<S>> contact_f_, contact_scratch_;  // forces of each contact; scratch
  std::vector<Vec6<S>> fext_;
  std::conditional_t<kSingle, Without, RneaDerivativesOf<S>> rnea_;
  std::vector<ContactDerivativesOf<S>> contact_terms_;
  std::vector<std::vector<int>> columns_;  // coordinates of J's columns, one list per contact
  std::vector<Slot> places_;               // entries of -dr/dq, -dr/dv that may be nonzero
  DerivativeRequest request_;              // the request for which reach_ was computed
  std::vector<Chunk> chunks_;
  std::vector<Band> bands_;
  std::vector<char> reach_, reached_;  // flags per chunk and row of K: B, and L^-1 B, may be nonzero
  std::vector<char> nonzero_;  // scratch: whether each row of K may be nonzero
  std::vector<S> B_;           // right-hand sides, chunk by chunk: rows that may be nonzero, in the pattern's order
  std::vector<int> place_;     // place of each entry of the panel in B_; -1: zero
  std::vector<int> unset_;     // entries of B_ to set to zero before contact terms are added
  std::vector<S> inner_L_;     // L without the border's rows
  std::vector<S> packed_;      // L in the order of sparse::ldl_pack
  std::vector<S> inverse_;
  std::vector<double> Lx_, Dx_, Kx_;  // one robot's L, D, K
  std::vector<Piece> pieces_;
  std::vector<double> work_;              // solutions of a band, chunk by chunk; scratch of solve_refined
  double rounding_;                       // result of sparse::ldl_rounding
  std::vector<BodyVariationOf<S>> body_;  // tangents (jvp) or adjoints (vjp) of the bodies' motions
  std::vector<Vec6<S>> u_, dfext_, df_;
  std::vector<S> dq_, dv_, torque_;
  // For redundant rows: y with J y = f; dq of jvp, or a term of wq in vjp; d(J y)/dq; correction of a chunk's solution.
  std::vector<S> y_, along_, rate_, correction_;
  std::vector<S> slope_;  // nv, empty without joint friction: -d(friction torque)/dv
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
      own_(plan_->border() > 0 ? 0 : plan_->memory_size()),
      pivot_terms_(pattern_.size()),
      r_(pattern_.size()),
      scale_(pattern_.size()),
      waiting_(*plan_),
      joins_(std::max(plan_->joins_size(), plan_->ends_size())),
      border_(Border::size(plan_->border())),
      a_(model_->nv),
      fext_(model_->njoints()),
      rnea_(*model_),
      nonzero_(rows_),
      inner_L_(plan_->border() > 0 ? inner_.ldl.nonzeros() : 0),
      packed_(kSingle ? 0 : inner_schedule_.packed.size()),
      inverse_(rows_),
      Lx_(kSingle ? 0 : inner_.ldl.nonzeros()),
      Dx_(rows_),
      Kx_(kSingle ? 0 : inner_.K.nonzeros()),
      work_(kSingle ? 0 : sparse::panel_kernels().work_size(inner_schedule_)),
      rounding_(sparse::ldl_rounding(inner_.ldl)),
      body_(model_->njoints()),
      u_(model_->njoints()),
      dfext_(model_->njoints()),
      df_(model_->njoints()),
      dq_(model_->nv),
      dv_(model_->nv),
      torque_(model_->nv),
      y_(model_->nv),
      along_(y_.size()),
      slope_(has_friction(*model_) ? model_->nv : 0) {
  for (std::size_t k = 0; k < standing_.size(); ++k) {
    const ContactSupport& support = plan_->supports[k];
    contacts_.emplace_back(contact(k), support);
    common_pair_.push_back(nullptr);
    if constexpr (!kSingle) contact_terms_.emplace_back(plan_->scene, contact(k), support);
    contact_f_.emplace_back(contact(k).rows());
    contact_scratch_.emplace_back(contact(k).rows());
    columns_.push_back(support.a);
    columns_.back().insert(columns_.back().end(), support.b.begin(), support.b.end());
  }
  if constexpr (kSingle) make_single();
  const sparse::LdlSymbolic& ldl = pattern_.ldl;
  for (int j = rows_; j < ldl.n; ++j)
    for (int i = rows_; i < j; ++i) {
      const auto first = ldl.Li.begin() + ldl.Lp[i], last = ldl.Li.begin() + ldl.Lp[i + 1];
      const auto at = std::lower_bound(first, last, j);
      triangle_.push_back(at != last && *at == j ? static_cast<int>(at - ldl.Li.begin()) : -1);
    }
  if constexpr (!kSingle) find_places();
}

}  // namespace manycontact::lanes
