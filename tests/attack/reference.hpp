#pragma once
// The right answers of a case in quadruple precision, by Newton and Euler and a decomposition of J^T. J's rows and
// columns come from velocities, M's from forces, derivatives from dual numbers: another way at every step than the
// library's, and no code of it.

#include <algorithm>
#include <memory>
#include <optional>

#include "case.hpp"
#include "linear.hpp"

namespace manycontact::attack {

struct Balance {                // of the rows of one island
  double left = 0;              // largest entry of J a + a0 + delta f
  double moved = 0, drift = 0;  // largest entries of |J| |a| and of a0
  double terms = 0;             // the same, and of all that a0 is made of
};

struct Answer {  // at one rank
  int rank = 0;
  bool regular = false;
  Column a, f;
  double condition = 0;          // of K, 1-norm
  std::vector<Balance> balance;  // per island
  double terms = 0;              // the largest of theirs
};

struct Slopes {  // of a and f along one direction
  Column a, f;
};

/// A tangent of q, v, the torques of all coordinates and the pushes' wrenches, force before torque.
struct Direction {
  std::vector<double> q, v, tau, w;
};

class Reference {
 public:
  explicit Reference(const Case& c);
  ~Reference();

  int nv() const { return nv_; }
  int rows() const { return rows_; }
  /// The ranks J may be said to have: several where what is left of a row is neither rounding of double precision nor
  /// plainly more. The highest first.
  const std::vector<int>& ranks() const { return ranks_; }
  const Matrix& M() const { return M_; }
  const Matrix& J() const { return J_; }
  double free_size() const;                     // of M^-1 b1, the accelerations without contacts; 0 where M is singular
  double load() const { return largest(b1_); }  // entries of the forces without contacts
  double largest_J() const { return std::max(largest(J_.x), 1e-300); }

  const Answer& at(int rank);
  /// Of the answer at that rank, kept constant.
  Slopes along(int rank, const Direction& direction);

  /// The u part of the least-norm least-squares solution of [S^T J^T] [u; f] = h(q, 0), S the torques of all joints but
  /// bases; none where its rank is in doubt. spread: of what was left of the rows, largest over smallest.
  std::optional<std::vector<double>> quasi_static(double& spread) const;
  /// v+ and impulses at that rank; false where there are none.
  bool impact(int rank, Column& v, Column& impulse) const;

 private:
  struct Solved;
  Solved& solved(int rank);
  Case case_;
  int nv_ = 0, rows_ = 0;
  Matrix M_, J_;
  Column b1_, b2_;
  std::vector<int> island_of_row_;
  std::vector<double> terms_;  // per island, of what its a0 are made of
  std::vector<int> ranks_;
  std::vector<std::unique_ptr<Solved>> solved_;
};

/// The same case with every number off by an eps or so.
Case blurred(const Case& c, std::uint64_t seed);
/// Where frame A of every hold stands becomes where B' is, in double precision: nothing is left to be corrected.
void place_where_they_are(Case& c);

}  // namespace manycontact::attack
