#pragma once
// One interface for every way to solve a linear-quadratic problem:
//
//   solver.analyse(problem);                          structure: sizes, groups, couplings; takes the memory
//   Outcome o = solver.factorize(problem, reg);       Q S R A B C D
//   if (o.status == Status::kOk) o = solver.solve(problem, z);   q r f d x0: the optimum z, refined and judged
//
// factorize and solve allocate nothing (except temporaries of Eigen, for products of blocks beyond 128 KB). They throw
// std::invalid_argument for a structure other than the analysed one.

#include <vector>

#include "manycontact/lq/problem.hpp"

namespace manycontact::lq {

enum class Status {
  kOk,
  kNotConvex,   // the Hessian with respect to a knot's controls is not positive definite (larger reg.u may help)
  kSingular,    // the equations of couplings depend on each other, or do not determine w (reg.rows may help)
  kNotFinite,   // overflow, or NaN in the problem
  kInaccurate,  // solved, but the KKT error stays above kAccurate: z is to be judged by kkt_error
};

struct Outcome {  // result of one solve
  Status status = Status::kOk;
  int knot = -1;         // number of the knot that failed, or -1
  double kkt_error = 0;  // KKT error of the returned z: largest relative error over the equations (kkt.hpp)
  int refinements = 0;
};

/// KKT error up to which a solution is accepted: three orders above the rounding errors of a sum over T = 1000 knots,
/// and four below the accuracy that a Newton step needs.
inline constexpr double kAccurate = 1e-10;

/// KKT error above which a solution is refined: its effect on a step is far below the accuracy of Newton's method.
inline constexpr double kRefineAbove = 1e-13;

class DirectionSolver {
 public:
  virtual ~DirectionSolver() = default;

  void analyse(const Problem& problem);
  [[nodiscard]] Outcome factorize(const Problem& problem, const Regularisation& reg = {});
  [[nodiscard]] Outcome solve(const Problem& problem, Point& z);

  virtual const char* name() const = 0;
  /// Operations (additions and multiplications) of factorize, predicted from the structure as if no group had steps.
  virtual double flops() const = 0;

  int max_refinements = 3;  // corrections of iterative refinement, at most

 protected:
  virtual void do_analyse(const Problem& problem) = 0;
  virtual Outcome do_factorize(const Problem& problem, const Regularisation& reg) = 0;
  /// Computes the z with H z + h = 0. first: the solve itself, not a correction.
  virtual void do_solve(const Problem& problem, const Point& h, Point& z, bool first) = 0;

  Layout layout_;
  int extra_refinements_ = 0;  // further refinements, for a factor that differs from H on purpose

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
