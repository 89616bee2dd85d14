#pragma once
// The interface of the compared solvers of K x = b, K symmetric and indefinite.

#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

namespace manycontact::collection {

/// K x = b as read: the lower triangle of K, column by column. K = [M J^T; J -delta I].
struct System {
  Eigen::SparseMatrix<double> lower;
  Eigen::VectorXd b;
  int nv = 0;          // rows of M, which come first
  double damping = 0;  // damping and steps are parameters of sparse-ldl
  int steps = 0;
  int size() const { return static_cast<int>(lower.rows()); }
};

/// A solver of one system. Work that depends on the pattern of K alone is done at creation, and not timed.
struct Solver {
  virtual ~Solver() = default;
  /// Factorizes K and solves for b, each time again. Throws std::runtime_error if K cannot be factorized.
  virtual Eigen::VectorXd solve() = 0;
};

struct Kind {
  std::string name, version;
  int largest;  // largest number of unknowns for which it is run; 0: no limit
  std::unique_ptr<Solver> (*make)(const System& system);
};

/// One entry per library found when this program was built.
const std::vector<Kind>& kinds();

std::vector<Kind> lapack_kinds();
std::vector<Kind> mumps_kinds();  // empty without MUMPS
std::vector<Kind> suitesparse_kinds();
std::vector<Kind> sparse_ldl_kinds();

}  // namespace manycontact::collection
