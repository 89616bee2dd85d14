#pragma once
// Whether redundant contacts are inconsistent: the definition (mathematics.md, Redundant contacts) is
// |P (J a + a0)| > 1e-8 (| |J| |a| | + |a0|), maximum norms, with P the projector on the null space of J^T. The rest
// may still be rounding errors of the terms that a0 is computed from, and that is no inconsistency. Templates on the
// scalar: SIMD batches have one value per robot.

#include <cmath>
#include <limits>

#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact::rank {

/// The larger of two numbers that are not negative; NaN where one is.
template <class S>
S larger_or_nan(const S& a, const S& b) {
  return select(b <= a, a, select(a <= b, b, S(a + b)));
}

/// A row of J that depends on others, or that others depend on.
template <class S>
struct RowOfContradiction {
  S size;   // size of the row of J (rank/row_size.hpp)
  S terms;  // the largest that its a0 is computed from
  S left;   // residual J a + a0: its part in the null space of J^T
};

/// Rounding that the projector P on J^T's null space passes on from row to row. Null vectors y balance the rows, sum of
/// y_k J_k = 0, so |P_jk| is at most about s_j / s_k and s_k / s_j, s the sizes of the rows. For all rows j that is no
/// more than min(s_k max(t_j / s_j), max(t_j s_j) / s_k, max t_j), t the terms that a0 is computed from.
template <class S>
class PassedRounding {
 public:
  void add(const S& size, const S& terms) {
    by_lever_ = larger(select(size > S(0), S(terms / size), S(0)), by_lever_);
    by_force_ = larger(S(terms * size), by_force_);
    largest_ = larger(terms, largest_);
  }
  /// The terms that the rest of a row is compared with: its own, and those of others.
  S terms(const S& size, const S& own) const {
    const S passed = select(size > S(0), -larger(larger(S(-size * by_lever_), S(-by_force_ / size)), -largest_), S(0));
    return larger(own, passed);
  }
  /// The largest terms of any row.
  const S& largest() const { return largest_; }

 private:
  S by_lever_ = S(0), by_force_ = S(0), largest_ = S(0);
};

/// The largest entries of the part of J a + a0 that is left, of |J| |a| and of a0; the largest part of a row's terms
/// that is left of it; and the range of the rows' sizes.
template <class S>
struct Contradiction {
  S left = S(0), Ja = S(0), a0 = S(0), of_terms = S(0);
  S least_row = S(std::numeric_limits<double>::infinity()), largest_row = S(0);

  /// |J| |a| and a0 of one row.
  void add_products(const S& its_Ja, const S& its_a0) {
    Ja = larger(its_Ja, Ja);
    a0 = larger(its_a0, a0);
  }
  /// The rows that each_row(use(RowOfContradiction)) names, twice; size 0: no row.
  template <class EachRow>
  void add_rows(EachRow&& each_row) {
    using std::abs;
    PassedRounding<S> passed;
    each_row([&](const RowOfContradiction<S>& row) { passed.add(row.size, row.terms); });
    each_row([&](const RowOfContradiction<S>& row) {
      const S of_row = abs(row.left);
      left = larger_or_nan(of_row, left);
      of_terms =
          larger_or_nan(S(select(of_row > S(0), S(of_row / passed.terms(row.size, row.terms)), of_row)), of_terms);
      least_row = select(row.size > S(0), -larger(-row.size, -least_row), least_row);
      largest_row = larger(row.size, largest_row);
    });
  }
  /// Other rows of the same island.
  void add(const Contradiction& other) {
    left = larger_or_nan(other.left, left);
    of_terms = larger_or_nan(other.of_terms, of_terms);
    add_products(other.Ja, other.a0);
    least_row = -larger(-other.least_row, -least_row);
    largest_row = larger(other.largest_row, largest_row);
  }
  /// Returns the inconsistency of one robot of a SIMD batch.
  Contradiction<double> of_lane(int lane) const {
    return {left[lane], Ja[lane], a0[lane], of_terms[lane], least_row[lane], largest_row[lane]};
  }

  /// Whether derivatives have a term of it.
  bool exceeds_rounding() const { return !(of_terms <= tolerance::kDriftNoise); }
  /// Whether it is more than J a and a0 allow for.
  bool contradicts() const {
    return !(of_terms <= tolerance::kDriftRounding) && !(left <= tolerance::kContradiction * (Ja + a0));
  }
  /// Least squares of rows of very different size, turns and micrometres, are left to the dense reference solver.
  bool needs_dense() const { return least_row < tolerance::kGradedRows * largest_row && contradicts(); }
};

}  // namespace manycontact::rank
