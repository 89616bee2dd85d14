#pragma once
// Solves a case in quadruple precision with Newton and Euler's equations and a decomposition of J^T. J comes from
// velocities, M from forces, derivatives from dual numbers: every step and its code differ from the library's.

#include <algorithm>
#include <memory>
#include <optional>

#include "case.hpp"
#include "linear.hpp"

namespace manycontact::attack {

struct Balance {                // residual of one island's rows
  double left = 0;              // largest entry of J a + a0 + delta f
  double moved = 0, drift = 0;  // largest entries of |J| |a| and of a0
  double terms = 0;             // the same sum of sizes, with all terms of a0
};

struct Answer {  // the solution for one rank of J
  int rank = 0;
  bool regular = false;
  Column a, f;
  double condition = 0;          // 1-norm condition of K
  std::vector<Balance> balance;  // one entry per island
  double terms = 0;              // largest over islands
};

struct Slopes {  // derivatives of a and f along one direction
  Column a, f;
};

/// Tangent of q, v, the torques of all coordinates and the external wrenches, force before torque.
struct Direction {
  std::vector<double> q, v, tau, w;
};

class Reference {
 public:
  explicit Reference(const Case& c);
  ~Reference();

  int nv() const { return nv_; }
  int rows() const { return rows_; }
  /// Possible ranks of J, descending: several if a row's residual is neither a rounding error nor clearly more.
  const std::vector<int>& ranks() const { return ranks_; }
  const Matrix& M() const { return M_; }
  const Matrix& J() const { return J_; }
  double free_size() const;                     // size of M^-1 b1, without contacts; 0 where M is singular
  double load() const { return largest(b1_); }  // largest generalised force without contacts
  double largest_J() const { return std::max(largest(J_.x), 1e-300); }

  const Answer& at(int rank);
  /// Returns derivatives of the solution at that rank, which is taken as constant.
  Slopes along(int rank, const Direction& direction);

  /// Returns the u part of the least-norm least-squares solution of [S^T J^T] [u; f] = h(q, 0), S the torques of all
  /// joints but bases; none if its rank is in doubt. `spread` is the largest over the smallest residual of the rows.
  std::optional<std::vector<double>> quasi_static(double& spread) const;
  /// Computes v+ and impulses at that rank; returns false if there are none.
  bool impact(int rank, Column& v, Column& impulse) const;

 private:
  struct Solved;
  Solved& solved(int rank);
  Case case_;
  int nv_ = 0, rows_ = 0;
  Matrix M_, J_;
  Column b1_, b2_;
  std::vector<int> island_of_row_;
  std::vector<double> terms_;  // per island, the terms of its a0
  std::vector<int> ranks_;
  std::vector<std::unique_ptr<Solved>> solved_;
};

/// Returns the same case with every number changed by about an eps.
Case blurred(const Case& c, std::uint64_t seed);
/// Places B' of every hold where frame A is, in double precision, so that placement errors vanish.
void place_where_they_are(Case& c);

}  // namespace manycontact::attack
