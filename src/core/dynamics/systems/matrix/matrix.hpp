#pragma once
// An island solved by its whole K in joint space: by the factor that was chosen, by one that drops redundant rows, or
// by the dense reference solver, whichever is sound first (fallbacks.cpp).

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

/// Workspace of an island with dependent contact rows, for derivatives and products.
struct DependentDerivatives {
  Eigen::VectorXd y;                     // nv: J y = f
  bool known = false;                    // y is of the current factor
  Eigen::VectorXd dofs, gradient, rows;  // scratch: nv, nv, nc
  // set by take_columns
  std::vector<char> in_null_space;  // nc
  std::vector<int> contacts;        // contacts of the island with rows there
  std::vector<int> columns, place;  // coordinates that their J changes with; nv: where these are among them
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

  /// K, its factor and x of the current solution, where another system solved. False: no factor is sound, or K is too
  /// large for memory.
  bool make_current(const Scene&, const SceneData&, ThreadWork&);
  /// Whether make_joint_space was called since prepare assigned the island.
  bool has_terms() const;
  /// Memory of K and its vectors in that order of elimination.
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
  std::vector<std::span<const double>> M, J;  // views of the robots' M and the contacts' J; by make_joint_space
  std::uint64_t state = 0;                    // the state that all below belongs to
  KktMatrix K;
  KktVectors v;                   // x: the solution
  std::vector<double> row_terms;  // nc, scratch of the factorization
  std::vector<double> unit;       // nc, or empty where all are 1: S of row_units.hpp, of K and v
  // Made when first needed, one per attempt (Attempts below): the chosen method's, LDL whose rows may wait in the
  // chosen order and leaf-to-root, the proximal factor, and the dense one.
  std::unique_ptr<Factor> chosen, waiting_in_order, waiting, proximal, dense;
  Factor* factor = nullptr;    // the one that solved; nullptr: none did
  double first_error = 0;      // backward error before refinement
  bool contradiction = false;  // the contacts are inconsistent: least squares
  WithinTolerance within;
  double tolerated = 0;        // inconsistency that rows made dependent may have, relative to their terms
  std::vector<int> dependent;  // scratch: rows of J
  std::unique_ptr<DependentDerivatives> rows;  // set by differentiate and products, if rows depend
};

inline double unit_of(const MatrixSystem& m, int row) { return m.unit.empty() ? 1 : m.unit[row]; }

namespace internal {

/// Rows of contacts times S, of a panel in the island's order.
inline void scale_rows(const MatrixSystem& m, IslandDerivatives& out) {
  for (std::size_t k = 0; k < m.unit.size(); ++k) out.X.row(out.nv + static_cast<Eigen::Index>(k)) *= m.unit[k];
}
/// Right-hand sides of K's derivatives, with the terms of inconsistent contacts. While AtSolution lives. False: they
/// are inaccurate.
bool weighed_right_hand_sides(const Scene& scene, SceneData& data, MatrixSystem& system, IslandDerivatives& out,
                              PanelWork& work);
/// Bounds of the errors of a and f, and the sizes that they are relative to (bounds.cpp).
std::pair<Known, Known> known_answer(const Scene& scene, SceneData& data, MatrixSystem& system);
/// x <- K^-1 x, refined once: with nearly massless bodies a single solve leaves rounding errors of terms that cancel.
void solve_refined_once(MatrixSystem& system, double* x);
/// |K|_1.
double norm_of(const MatrixSystem& system);
/// |K|_1 |K^-1|_1, estimated.
double condition_of(MatrixSystem& system);
/// The largest entry of |K^-1| w among rows first ... first+count-1 of the island's, those of f in newtons and newton
/// metres, within a factor of three. w: a size per row of K, in order of elimination.
double bound_of_solution(MatrixSystem& system, const std::vector<double>& w, int first, int count);
/// The same of |K^-1 K^-1| w.
double bound_of_two_solutions(MatrixSystem& system, const std::vector<double>& w, int first, int count);
/// c eps: of a sum down the deepest tree.
double rounding(const Scene& scene, const MatrixSystem& system);
/// c eps of J: no less than what is left of rows that were dropped, which other ways to drop as many leave elsewhere.
double rounding_of_J(const Scene& scene, const MatrixSystem& system);
/// w += |dJ| times the sizes of K's unknowns, in units of c eps, all in order of elimination: J's entries may be no
/// more than what is left of what they are computed from.
void add_terms_of_J(const Scene& scene, const Workspace& work, const MatrixSystem& system,
                    const std::vector<double>& sizes, std::vector<double>& w);
/// If contacts are inconsistent by r, rounding errors of J change the least squares by K^+ K^+ [dJ^T r; 0] (Golub,
/// Pereyra, SIAM J. Numer. Anal. 10, 1973, eq. 4.12). Returns |dJ^T r| in elimination order; r is in this order, too.
std::vector<double> turned_contradiction(const Scene& scene, const Workspace& work, const MatrixSystem& system,
                                         const std::vector<double>& r);
/// Bounds of the errors of an island's derivatives (derivative_bounds.cpp). False: there is none.
bool bound_derivatives(const Scene& scene, SceneData& data, ThreadWork& thread, MatrixSystem& system,
                       const IslandDerivatives& derivatives, DerivativeBounds& out);

/// Memory for a robot's kinematics and dynamics terms, the first time.
void make_robot(const Scene& scene, Workspace& work, int robot);
/// Whether the robot's terms were evaluated at the current state.
bool is_evaluated(const Workspace& work, int robot);
/// Memory for the joint-space terms of an island, the first time. Throws std::length_error beyond 2^31 entries.
void make_joint_space(const Scene& scene, Workspace& work, IslandWork& d);
/// Kinematics, bias, inertia and contact rows of an island's robots, which have memory for that.
void evaluate(const Scene& scene, const ConstVector& q, const ConstVector& v, Workspace& work, const Island& island);
/// Evaluates the same terms at the current state (q, v) unless they are known already. Allocates their memory, so that
/// the island may be one of sparse-bodies.
void evaluate_at_state(const Scene& scene, const SceneData& data, IslandWork& d);
/// The bodies' placements alone, which products with derivatives need in addition to the rows at the solution.
void place_at_state(const Scene& scene, const SceneData& data, const Island& island);
/// Whether joint-space terms may be allocated: for an island of sparse-bodies only up to kMostJointSpace numbers.
bool joint_space_fits(const IslandWork& d);
/// Throws std::length_error, in the name of `function`, where they may not. instead: the method to use.
void check_joint_space(const IslandWork& d, const char* function, const char* instead);

/// Assembles K and b = [data.tau - h; wanted - a0] from the evaluated terms, in the elimination order `order`.
void assemble(const Scene& scene, const SceneData& data, Order order, double damping, MatrixSystem& system);
/// Multiplies the contacts' rows of both by S, where that is not 1.
void weigh_rows(const Scene& scene, MatrixSystem& system);
/// Factorizes and solves by the first way that gives a sound solution: v.x, factor and the report are that solution's.
/// False where there is none. After evaluate.
bool solve_by_fallbacks(const Scene& scene, const SceneData& data, FactorScratch& scratch, MatrixSystem& system,
                        IslandReport& report);
/// A way to factorize K. The attempts of an island, in order. Of LDL without damping: that whose rows may wait, in the
/// chosen order and then leaf-to-root. In large islands, where more may wait than serve, each is followed by the
/// proximal factor, and in the chosen order by LDL of all rows first: pivots may be small and sound. This is left out
/// where another system had no sound pivots, or found rows dependent, at this state. Of other methods and with damping:
/// the chosen method and order, with damping leaf-to-root too; without, LDL whose rows may wait. The last: the dense
/// reference solver.
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
/// Solves by the dense reference solver alone, where another factor does not serve for derivatives. False where it
/// would take too long or was tried already.
bool solve_by_oracle(const Scene& scene, const SceneData& data, ThreadWork& thread, MatrixSystem& system);

/// Overwrites the panel of right-hand sides with [da; -df], by the current factor. NaN where that is inaccurate.
void solve_panel(const Scene& scene, MatrixSystem& system, IslandDerivatives& out, PanelWork& work);
/// X <- K^+ X of a panel with row stride ld in the same way. False where that is inaccurate.
bool solve_columns(MatrixSystem& system, double* X, int ld, PanelWork& work);
/// v.x <- K^+ v.b by the current factor, refined once. False, and NaN, where that is inaccurate.
bool solve_vector(MatrixSystem& system, KktVectors& v);

// Dependent rows' terms (least_norm_forces.cpp) of derivatives and of products with them. While AtSolution lives.

/// Adds to dforces_dq, or to df = -y of the scratch along dq, what keeps the forces of least norm. v: scratch.
void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& system, KktVectors& v,
                       IslandDerivatives& out);
void least_norm_forces(const Scene& scene, SceneData& data, MatrixSystem& system, const ConstVector& dq, KktVectors& v,
                       ProductWork& work);
/// If the contacts are inconsistent, a solves J^T (J a + a0) = 0: adds the effect of J^T's rotation to -dr2, of the
/// panel or of the scratch along dq. False where that is inaccurate.
bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& system, IslandDerivatives& out,
                       PanelWork& work);
bool add_contradiction(const Scene& scene, SceneData& data, MatrixSystem& system, const ConstVector& dq, KktVectors& v,
                       ProductWork& work);
/// Adds to wq what the transposes of both do. v: l = K^+ [wa; -wf] in v.x; used up. False where it is inaccurate.
bool add_dependent_adjoint(const Scene& scene, SceneData& data, MatrixSystem& system, const AdjointProduct& p,
                           KktVectors& v);

}  // namespace internal

}  // namespace manycontact
