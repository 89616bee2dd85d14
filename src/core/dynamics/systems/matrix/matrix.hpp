#pragma once
// Solves an island by factors of its whole K = [M J^T; J -delta I]. MatrixSystem tries several factors, the dense
// reference solver last, until one is sound (fallbacks.cpp). Here S is the diagonal scaling of contact rows by their
// weights (rank/row_units.hpp), K^+ the generalised inverse of K, and c eps a relative rounding error (`rounding`).

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
  Eigen::VectorXd y;                     // nv: any solution of J y = f, where f are the contact forces
  bool known = false;                    // whether y was computed for the current solution
  Eigen::VectorXd dofs, gradient, rows;  // scratch: nv, nv, nc
  // set by take_columns (least_norm_forces.cpp)
  std::vector<char> in_null_space;  // nc: whether the row takes part in a linear dependence of rows of J
  std::vector<int> contacts;        // contacts of the island that have rows in linear dependences
  // columns: coordinates on which J of `contacts` depends; place: nv, each coordinate's index in `columns`, or -1
  std::vector<int> columns, place;
  std::vector<double> panel;        // scratch: one row per row of K, one padded column per entry of `columns`
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

  /// Computes K, a factor of K, and x, unless up to date. Returns false if no factor is sound, or if K is too large.
  bool make_current(const Scene&, const SceneData&, ThreadWork&);
  bool has_terms() const;       // whether make_joint_space has allocated M and J of the current island
  void make_room(Order order);  // allocates K and its vectors in this elimination order
  bool deficient() const;       // whether the island has redundant contact rows

  /// Calls use(row, column, change) for each entry of J in K that `within` (WithinTolerance) changed. row and column
  /// are indices in K's elimination order.
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
  std::uint64_t state = 0;                    // Workspace::state at which the members below were computed
  KktMatrix K;
  KktVectors v;                   // x: the solution
  std::vector<double> row_terms;  // nc, scratch: magnitudes of the terms of each row's a0
  std::vector<double> unit;       // nc: diagonal of the scaling S of K and v; empty if S = I
  // Factors by FactorKind, constructed on demand. There are two of kWaiting: waiting_in_order in the chosen elimination
  // order, and `waiting` leaf-to-root.
  std::unique_ptr<Factor> chosen, waiting_in_order, waiting, proximal, dense;
  Factor* factor = nullptr;    // the factor that solved; nullptr: none
  double first_error = 0;      // backward error of x before refinement
  bool contradiction = false;  // whether the contacts are inconsistent, so that x is the least-squares solution
  WithinTolerance within;
  double tolerated = 0;                        // relative inconsistency that changes of J by `within` explain, else 0
  std::vector<int> dependent;                  // scratch: dependent rows of J
  std::unique_ptr<DependentDerivatives> rows;  // set by differentiate and products if rows are dependent
};

inline double unit_of(const MatrixSystem& m, int row) { return m.unit.empty() ? 1 : m.unit[row]; }

namespace internal {

inline void scale_rows(const MatrixSystem& m, IslandDerivatives& out) {  // multiplies contact rows of out.X by S
  for (std::size_t k = 0; k < m.unit.size(); ++k) out.X.row(out.nv + static_cast<Eigen::Index>(k)) *= m.unit[k];
}
/// Computes the right-hand sides of derivatives in out.X, scaled by S, with terms of inconsistent contacts. Returns
/// false if these terms are inaccurate. An AtSolution must exist.
bool weighed_right_hand_sides(const Scene& scene, SceneData& data, MatrixSystem& system, IslandDerivatives& out,
                              PanelWork& work);
std::pair<Known, Known> known_answer(const Scene& scene, SceneData& data, MatrixSystem& system);  // accuracy of a, f
void solve_refined_once(MatrixSystem& system, double* x);  // x = K^-1 x, refined, as tiny masses cause cancellation
double norm_of(const MatrixSystem& system);                // |K|_1
double condition_of(MatrixSystem& system);                 // an estimate of |K|_1 |K^-1|_1
/// Estimates, within a factor of three, the largest entry of |K^-1| w in rows first ... first+count-1 of the island, in
/// units of a and f. w: one size per row of K, in elimination order.
double bound_of_solution(MatrixSystem& system, const std::vector<double>& w, int first, int count);
/// Estimates the largest entry of |K^-1 K^-1| w in rows first ... first+count-1 of the island.
double bound_of_two_solutions(MatrixSystem& system, const std::vector<double>& w, int first, int count);
double rounding(const Scene& scene, const MatrixSystem& system);  // c eps, for sums along the deepest chain of joints
/// Returns the relative error of J: c eps or, if larger, the largest relative residual with which the factor's dropped
/// rows depend on its kept rows.
double rounding_of_J(const Scene& scene, const MatrixSystem& system);
/// Adds |dJ| |a| to the contact rows of w, and |dJ|^T |f| to its joint rows, in elimination order. dJ: bounds of J's
/// errors, divided by `rounding`. `sizes`: the magnitudes |a| and |f|, in elimination order.
void add_terms_of_J(const Scene& scene, const Workspace& work, const MatrixSystem& system,
                    const std::vector<double>& sizes, std::vector<double>& w);
/// Returns |dJ^T r|, in elimination order as r. If r is the contacts' inconsistency, rounding errors dJ change the
/// least-squares solution by K^+ K^+ [dJ^T r; 0] (Golub, Pereyra, SIAM J. Numer. Anal. 10, 1973, eq. 4.12).
std::vector<double> turned_contradiction(const Scene& scene, const Workspace& work, const MatrixSystem& system,
                                         const std::vector<double>& r);
/// Computes error bounds of an island's derivatives. Returns false if no bound is known.
bool bound_derivatives(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& system,
                       const IslandDerivatives& derivatives, DerivativeBounds& out);

void make_robot(const Scene& scene, Workspace& work, int robot);  // allocates RobotData at the first call
bool is_evaluated(const Workspace& work, int robot);  // whether RobotData is of the current state
/// Allocates the joint-space terms of an island at the first call. Throws std::length_error if an M is too large.
void make_joint_space(const Scene& scene, Workspace& work, IslandWork& d);
/// Evaluates kinematics, bias, inertia and contact rows of an island, whose memory is allocated.
void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& work, const Island& island);
/// Allocates an island's joint-space terms and evaluates them at the current q, v, unless this was done already.
void evaluate_at_state(const Scene& scene, const SceneData& data, IslandWork& d);
void place_at_state(const Scene& scene, const SceneData& data, const Island& island);  // places the robots' bodies at q
bool joint_space_fits(const IslandWork& d);  // whether M and J are small enough; if not, only sparse-bodies solves
/// Throws std::length_error, naming `function`, unless joint_space_fits. instead: advice that ends the message.
void check_joint_space(const IslandWork& d, const char* function, const char* instead);

/// Assembles K and b = [data.tau - h; prescribed - a0] from the evaluated terms, in the elimination order `order`.
void assemble(const Scene& scene, const SceneData& data, Order order, double damping, MatrixSystem& system);
void weigh_rows(const Scene& scene, MatrixSystem& system);  // multiplies contact rows of K and b by S, unless S = 1
/// Solves by the first sound attempt, or returns false. Sets system.v.x, system.factor, report. Call `evaluate` before.
bool solve_by_fallbacks(const Scene& scene, const SceneData& data, FactorScratch& scratch, MatrixSystem& system,
                        IslandReport& report);
/// Factors of K: by the chosen method; LDL in which rows of J without a sound pivot wait, i.e. are eliminated last or
/// dropped; by proximal steps; by the dense reference solver.
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
/// Returns the attempts to solve an island, in order. LDL without damping: kWaiting in the chosen, then leaf-to-root
/// order; with over kFewRows rows each is followed (or, if too many rows depend, replaced) by kProximal, and kChosen
/// precedes the first kProximal if sound pivots are expected. Other methods, or damping: kChosen, then leaf-to-root
/// kChosen (with damping) or kWaiting (without). For n <= kDenseSize, kDense is last.
Attempts attempts_of(const Scene& scene, const MatrixSystem& system);
/// Solves by the dense reference solver. Returns false if it fails, has solved already, or if K is too large.
bool solve_by_oracle(const Scene& scene, const SceneData& data, ThreadWork& thread, MatrixSystem& system);

/// Overwrites the right-hand sides out.X with [da; -df] by the current factor, or with NaN if the result is inaccurate.
void solve_panel(const Scene& scene, MatrixSystem& system, IslandDerivatives& out, PanelWork& work);
/// Overwrites a panel X with row stride ld by K^+ X. Returns false if the result is inaccurate.
bool solve_columns(MatrixSystem& system, double* X, int ld, PanelWork& work);
bool solve_vector(MatrixSystem& system, KktVectors& v);  // v.x = K^+ v.b, refined; NaN and false if inaccurate

// Terms of dependent rows in derivatives and products (least_norm_forces.cpp). An AtSolution must exist.

/// Add the change of least-norm forces that is due to the change of J's range with q. The first function adds it to
/// dforces_dq in out.X, the second adds its product with dq to df = -work.y. v: scratch.
void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& system, KktVectors& v,
                       IslandDerivatives& out);
void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& system, const ConstVector& dq, KktVectors& v,
                       ProductWork& work);
/// Add to the right-hand sides of contact rows the effect of dJ^T rho on the least-squares acceleration, where rho is
/// the contacts' inconsistency J a + a0 (least_norm_forces.cpp). The first function changes out.X; the second adds the
/// product of the effect with dq to work.y. Both return false if the effect is inaccurate.
bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& system, IslandDerivatives& out,
                       PanelWork& work);
bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& system, const ConstVector& dq, KktVectors& v,
                       ProductWork& work);
/// Adds adjoints of least_norm_forces, add_contradiction to p.wq; false if inaccurate. v.x: K^+ [wa; -wf], scratch.
bool add_dependent_adjoint(const Scene& scene, SceneData& data, MatrixSystem& system, const AdjointProduct& p,
                           KktVectors& v);

}  // namespace internal

}  // namespace manycontact
