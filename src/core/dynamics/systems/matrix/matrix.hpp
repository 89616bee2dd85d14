#pragma once
// Solves an island by its whole K in joint space: by the chosen factor, by one that drops redundant rows, or by the
// dense reference solver, whichever is sound first (fallbacks.cpp).

#include <array>
#include <span>
#include <utility>

#include "../system.hpp"
#include "manycontact/detail/contact/rows.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/kkt/factor/factors.hpp"
#include "manycontact/kkt/factor/refined.hpp"
#include "within_tolerance.hpp"

namespace manycontact {

struct ProductWork;

/// Workspace of derivatives and products of an island with dependent rows.
struct DependentDerivatives {
  Eigen::VectorXd y;                     // nv: solution of J y = f
  bool known = false;                    // whether y belongs to the current factor
  Eigen::VectorXd dofs, gradient, rows;  // scratch: nv, nv, nc
  // set by take_columns
  std::vector<char> in_null_space;  // nc
  std::vector<int> contacts;        // contacts of the island with rows in the null space
  std::vector<int> columns, place;  // coordinates on which their J depends; nv: indices of coordinates in `columns`
  std::vector<double> panel;        // scratch: size x columns, padded
};

class MatrixSystem final : public IslandSystem {
 public:
  explicit MatrixSystem(IslandWork& island) : owner(island) {}

  bool solve(const Scene&, SceneData&, ThreadWork&, IslandReport&) override;
  bool differentiate(const Scene&, SceneData&, ThreadWork&, IslandDerivatives&) override;
  bool jvp(const Scene&, SceneData&, ThreadWork&, const TangentProduct&) override;
  bool vjp(const Scene&, SceneData&, ThreadWork&, const AdjointProduct&) override;
  bool invert(const Scene&, SceneData&, ThreadWork&, ProductWork&) override;
  bool bound_errors(const Scene&, SceneData&, IslandReport&) override;
  bool estimate_condition(const Scene&, SceneData&, IslandReport&) override;

  /// Computes K, its factor and x if another system solved. False: no sound factor, or K is too large for memory.
  bool make_current(const Scene&, const SceneData&, ThreadWork&);
  /// Whether make_joint_space was called since prepare assigned the island.
  bool has_terms() const;
  /// Allocates K and its vectors in this elimination order.
  void make_room(Order order);
  /// Whether the island has redundant contact rows.
  bool deficient() const;

  /// Calls use(row, column, change) for the entries of J in K that were changed within the tolerance, in K's order.
  template <class Use>
  void each_change(Use&& use) const {
    if (tolerated == 0) return;
    const int* iperm = K.pattern->iperm.data();
    for (const RowChange& change : within.changes())
      use(iperm[K.pattern->nv + change.row], iperm[change.column],
          change.value * (unit.empty() ? 1 : unit[change.row]));
  }

  IslandWork& owner;
  std::vector<std::span<const double>> M, J;  // views of the robots' M and the contacts' J; set by make_joint_space
  std::uint64_t state = 0;                    // the state of all members below
  KktMatrix K;
  KktVectors v;                   // x: the solution
  std::vector<double> row_terms;  // nc, scratch of the factorization
  std::vector<double> unit;       // nc, or empty if all are 1: S of row_units.hpp, applied to K and v
  // Factors of the attempts (Attempts below), constructed on demand; LDL with waiting rows: chosen order, leaf-to-root.
  std::unique_ptr<Factor> chosen, waiting_in_order, waiting, proximal, dense;
  Factor* factor = nullptr;    // the factor that solved; nullptr: none
  double first_error = 0;      // backward error before refinement
  bool contradiction = false;  // whether the contacts are inconsistent: least squares
  WithinTolerance within;
  double tolerated = 0;                        // inconsistency allowed in rows made dependent, relative to their terms
  std::vector<int> dependent;                  // scratch: rows of J
  std::unique_ptr<DependentDerivatives> rows;  // set by differentiate and products if rows are dependent
};

inline double unit_of(const MatrixSystem& m, int row) { return m.unit.empty() ? 1 : m.unit[row]; }

namespace internal {

/// Multiplies the contact rows of a panel, in the island's order, by S.
inline void scale_rows(const MatrixSystem& m, IslandDerivatives& out) {
  for (std::size_t k = 0; k < m.unit.size(); ++k) out.X.row(out.nv + static_cast<Eigen::Index>(k)) *= m.unit[k];
}
/// Computes right-hand sides with the terms of inconsistent contacts; AtSolution must be alive. False: inaccurate.
bool weighed_right_hand_sides(const Scene& scene, SceneData& data, MatrixSystem& system, IslandDerivatives& out,
                              PanelWork& work);
/// Returns a's and f's sizes, error bounds and the loads that these are relative to (bounds.cpp).
std::pair<Known, Known> known_answer(const Scene& scene, SceneData& data, MatrixSystem& system);
/// Sets x = K^-1 x, refined once, as nearly massless bodies leave rounding errors of cancelling terms.
void solve_refined_once(MatrixSystem& system, double* x);
/// Returns |K|_1.
double norm_of(const MatrixSystem& system);
/// Returns an estimate of |K|_1 |K^-1|_1.
double condition_of(MatrixSystem& system);
/// Returns the largest entry of |K^-1| w in rows first ... first+count-1 of the island, within a factor of three;
/// forces in N and N m. w: one size per row of K, in elimination order.
double bound_of_solution(MatrixSystem& system, const std::vector<double>& w, int first, int count);
/// Returns the largest entry of |K^-1 K^-1| w in these rows.
double bound_of_two_solutions(MatrixSystem& system, const std::vector<double>& w, int first, int count);
/// Returns c eps, the relative rounding error of sums along the deepest chain of joints.
double rounding(const Scene& scene, const MatrixSystem& system);
/// Returns the relative error c eps of J: at least the residual of dropped rows, as other rows might be dropped.
double rounding_of_J(const Scene& scene, const MatrixSystem& system);
/// Adds |dJ| times `sizes` (of K's unknowns) to w, in elimination order; dJ: rounding errors of J's terms over c eps.
void add_terms_of_J(const Scene& scene, const Workspace& work, const MatrixSystem& system,
                    const std::vector<double>& sizes, std::vector<double>& w);
/// Returns |dJ^T r| in elimination order, as r: with inconsistency r, rounding errors of J change the least-squares
/// solution by K^+ K^+ [dJ^T r; 0] (Golub, Pereyra, SIAM J. Numer. Anal. 10, 1973, eq. 4.12).
std::vector<double> turned_contradiction(const Scene& scene, const Workspace& work, const MatrixSystem& system,
                                         const std::vector<double>& r);
/// Computes error bounds of an island's derivatives (derivative_bounds.cpp). False: there are none.
bool bound_derivatives(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& system,
                       const IslandDerivatives& derivatives, DerivativeBounds& out);

/// Allocates a robot's kinematics and dynamics terms at the first call.
void make_robot(const Scene& scene, Workspace& work, int robot);
/// Whether the robot's terms were evaluated at the current state.
bool is_evaluated(const Workspace& work, int robot);
/// Allocates the joint-space terms of an island at the first call. Throws std::length_error beyond 2^31 entries.
void make_joint_space(const Scene& scene, Workspace& work, IslandWork& d);
/// Evaluates kinematics, bias, inertia and contact rows of an island, whose memory is allocated.
void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& work, const Island& island);
/// Calls `evaluate` at the current state (q, v) unless that was done, and allocates memory, also for sparse-bodies.
void evaluate_at_state(const Scene& scene, const SceneData& data, IslandWork& d);
/// Computes only the bodies' placements, which products with derivatives need besides the rows at the solution.
void place_at_state(const Scene& scene, const SceneData& data, const Island& island);
/// Whether joint-space terms may be allocated: for an island of sparse-bodies only up to kMostJointSpace numbers.
bool joint_space_fits(const IslandWork& d);
/// Throws std::length_error, naming `function`, unless joint_space_fits. instead: advice on what to use.
void check_joint_space(const IslandWork& d, const char* function, const char* instead);

/// Assembles K and b = [data.tau - h; wanted - a0] from the evaluated terms, in the elimination order `order`.
void assemble(const Scene& scene, const SceneData& data, Order order, double damping, MatrixSystem& system);
/// Multiplies the contact rows of K and b by S, unless S = 1.
void weigh_rows(const Scene& scene, MatrixSystem& system);
/// Factorizes and solves by the first sound attempt, after evaluate; sets v.x, factor, report. False: none is sound.
bool solve_by_fallbacks(const Scene& scene, const SceneData& data, FactorScratch& scratch, MatrixSystem& system,
                        IslandReport& report);
/// An attempt to factorize K; attempts_of lists an island's in order. LDL without damping: with waiting rows, in the
/// chosen order and then leaf-to-root. In large islands, where too many rows may wait, each is followed by the proximal
/// factor, and in the chosen order preceded by LDL of all rows, unless another system found no sound pivots or
/// dependent rows at this state. Other methods, or damping: the chosen method and order; with damping then
/// leaf-to-root, without it LDL with waiting rows. The dense reference solver is last.
enum class FactorKind { kChosen, kWaiting, kProximal, kDense };
struct Attempt {
  FactorKind kind;
  Order order;
  double damping;
};
struct Attempts {
  std::array<Attempt, 6> list;
  int count = 0;
  void add(const Attempt& attempt) { list[count++] = attempt; }
};
Attempts attempts_of(const Scene& scene, const MatrixSystem& system);
/// Solves by the dense reference solver if another factor is inaccurate. False: too slow, or tried before.
bool solve_by_oracle(const Scene& scene, const SceneData& data, ThreadWork& thread, MatrixSystem& system);

/// Overwrites the panel of right-hand sides with [da; -df] by the current factor; NaN if that is inaccurate.
void solve_panel(const Scene& scene, MatrixSystem& system, IslandDerivatives& out, PanelWork& work);
/// Overwrites a panel X with row stride ld by K^+ X. False if that is inaccurate.
bool solve_columns(MatrixSystem& system, double* X, int ld, PanelWork& work);
/// Sets v.x = K^+ v.b by the current factor, refined once. False, and v.x NaN, if that is inaccurate.
bool solve_vector(MatrixSystem& system, KktVectors& v);

// Terms of dependent rows in derivatives and products (least_norm_forces.cpp); AtSolution must be alive.

/// Adds the change of least-norm forces to dforces_dq, or along dq to df = -y of `work`. v: scratch.
void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& system, KktVectors& v,
                       IslandDerivatives& out);
void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& system, const ConstVector& dq, KktVectors& v,
                       ProductWork& work);
/// Adds the effect of dJ^T to -dr2 (panel, or `work` along dq) if contacts are inconsistent. False: inaccurate.
bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& system, IslandDerivatives& out,
                       PanelWork& work);
bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& system, const ConstVector& dq, KktVectors& v,
                       ProductWork& work);
/// Adds the transposes of least_norm_forces, add_contradiction to wq. v.x: K^+ [wa; -wf], scratch. False: inaccurate.
bool add_dependent_adjoint(const Scene& scene, SceneData& data, MatrixSystem& system, const AdjointProduct& p,
                           KktVectors& v);

}  // namespace internal

}  // namespace manycontact
