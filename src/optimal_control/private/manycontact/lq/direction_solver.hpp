#pragma once
// The interface of the solvers of a linear-quadratic problem:
//
//   solver.analyse(problem);                      reads the structure (sizes, groups, couplings); allocates
//   Outcome o = solver.factorize(problem, reg);   reads Q S R A B C D
//   if (o.status == Status::kOk) o = solver.solve(problem, z);   reads q r f d x0; refines z, computes its KKT error
//
// factorize and solve allocate nothing (except temporaries of Eigen, for products of blocks beyond 128 KB). They throw
// std::invalid_argument if the structure differs from that of the analysed problem.

#include <vector>

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

enum class Status {
  kOk,
  kNotConvex,   // the Hessian with respect to a knot's controls is not positive definite (larger reg.u may help)
  kSingular,    // the equations of couplings are dependent, or do not determine w (reg.rows may help)
  kNotFinite,   // numbers overflowed, or the problem contains NaN
  kInaccurate,  // solved, but the KKT error remains above kAccurate after refinement
};

struct Outcome {  // The result of a factorization or of a solve.
  Status status = Status::kOk;
  int knot = -1;         // number of the knot that failed, or -1
  double kkt_error = 0;  // KKT error of the returned z, the largest relative error of an equation (kkt.hpp)
  int refinements = 0;
};

/// The largest KKT error of an accepted solution. It is 1000 times the rounding error of a sum over T = 1000 knots, and
/// 1e-4 times the accuracy that a Newton step needs.
inline constexpr double kAccurate = 1e-10;

/// The KKT error above which a solution is refined. A smaller error does not affect the convergence of Newton's method.
inline constexpr double kRefineAbove = 1e-13;

class DirectionSolver {
 public:
  virtual ~DirectionSolver() = default;

  void analyse(const Problem& problem);
  [[nodiscard]] Outcome factorize(const Problem& problem, const Regularisation& reg = {});
  [[nodiscard]] Outcome solve(const Problem& problem, Point& z);

  virtual const char* name() const = 0;
  virtual double flops() const = 0;  // predicted operations of factorize, without Group::steps

  int max_refinements = 3;  // largest number of corrections by iterative refinement

 protected:
  virtual void do_analyse(const Problem& problem) = 0;
  virtual Outcome do_factorize(const Problem& problem, const Regularisation& reg) = 0;
  /// Solves H z + h = 0 (kkt.hpp) for z. first: whether this is the solve itself, and not a correction of refinement.
  virtual void do_solve(const Problem& problem, const Point& h, Point& z, bool first) = 0;

  Layout layout_;
  int extra_refinements_ = 0;  // further refinements, if the factor includes a proximal term that H does not have

 private:
  void expect_same_structure(const Problem& problem) const;

  struct GroupShape {
    std::vector<int> blocks, couplings;
  };
  std::vector<int> nx_, nu_;
  std::vector<std::vector<GroupShape>> groups_;
  std::vector<std::vector<Coupling>> couplings_;
  Regularisation reg_;
  bool factorized_ = false;
  Point residual_, scale_, correction_;
};

}  // namespace manycontact::lq
