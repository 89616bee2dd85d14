#pragma once
// Decides whether redundant contacts are inconsistent. They are (mathematics.md, Redundant contacts) if |P (J a + a0)|
// > 1e-8 (| |J| |a| | + |a0|) in maximum norms, unless P (J a + a0) is within the rounding errors of a0's terms. P is
// the projector on the null space of J^T. In SIMD batches the scalar S has one value per robot.

#include <cmath>
#include <limits>

#include "manycontact/sparse/tolerances.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact::rank {

/// Returns the larger of two non-negative numbers, or NaN if one is NaN.
template <class S>
S larger_or_nan(const S& a, const S& b) {
  return select(b <= a, a, select(a <= b, b, S(a + b)));
}

/// The numbers of a row of J from which Contradiction decides whether the contacts are inconsistent.
template <class S>
struct RowOfContradiction {
  S size;   // size of the row of J (rank/row_size.hpp)
  S terms;  // the largest term of the row's a0
  S left;   // the row's entry of P (J a + a0), P the projector on the null space of J^T
};

/// Bounds the rounding errors that the projector P transfers between rows. A null vector y has sum y_k J_k = 0, so that
/// |P_jk| is at most about s_j / s_k and s_k / s_j, with the rows' sizes s. From all rows j, row k receives at most
/// min(s_k max(t_j / s_j), max(t_j s_j) / s_k, max t_j), with the terms t of a0.
template <class S>
class PassedRounding {
 public:
  void add(const S& size, const S& terms) {
    by_lever_ = larger(select(size > S(0), S(terms / size), S(0)), by_lever_);
    by_force_ = larger(S(terms * size), by_force_);
    largest_ = larger(terms, largest_);
  }
  /// Returns the terms with which a row's residual is compared: the row's own, or larger terms of other rows.
  S terms(const S& size, const S& own) const {
    const S passed = select(size > S(0), -larger(larger(S(-size * by_lever_), S(-by_force_ / size)), -largest_), S(0));
    return larger(own, passed);
  }
  const S& largest() const { return largest_; }

 private:
  S by_lever_ = S(0), by_force_ = S(0), largest_ = S(0);
};

/// The numbers that decide whether contacts are inconsistent: the largest entries of P (J a + a0), |J| |a| and a0, the
/// largest entry of P (J a + a0) relative to its row's terms, and the range of row sizes.
template <class S>
struct Contradiction {
  S left = S(0), Ja = S(0), a0 = S(0), of_terms = S(0);
  S least_row = S(std::numeric_limits<double>::infinity()), largest_row = S(0);

  void add_products(const S& its_Ja, const S& its_a0) {
    Ja = larger(its_Ja, Ja);
    a0 = larger(its_a0, a0);
  }
  /// Takes rows into account. each_row(use) must call use(RowOfContradiction) for each row; it is called twice.
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
  void add(const Contradiction& other) {  // rows of the same island
    left = larger_or_nan(other.left, left);
    of_terms = larger_or_nan(other.of_terms, of_terms);
    add_products(other.Ja, other.a0);
    least_row = -larger(-other.least_row, -least_row);
    largest_row = larger(other.largest_row, largest_row);
  }
  Contradiction<double> of_lane(int lane) const {  // one robot's numbers
    return {left[lane], Ja[lane], a0[lane], of_terms[lane], least_row[lane], largest_row[lane]};
  }

  /// Whether derivatives must include a term for the inconsistency.
  bool exceeds_rounding() const { return !(of_terms <= tolerance::kDriftNoise); }
  bool contradicts() const {  // the definition in the file header
    return !(of_terms <= tolerance::kDriftRounding) && !(left <= tolerance::kContradiction * (Ja + a0));
  }
  /// Whether row sizes differ so much (radians, micrometres) that least squares need the dense reference solver.
  bool needs_dense() const { return least_row < tolerance::kGradedRows * largest_row && contradicts(); }
};

}  // namespace manycontact::rank
