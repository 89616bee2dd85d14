#pragma once
// Checks, for each robot of a SIMD batch, that its numbers are accurate. Each robot has one element of the packs.

#include <limits>
#include <span>
#include <type_traits>

#include "manycontact/detail/spatial/pack.hpp"
#include "manycontact/model/model.hpp"
#include "manycontact/rank/pivots.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact::lanes {

/// Evaluates f(k, k mod 4) for k < n, so that four independent sums or maxima are computed in parallel.
template <class F>
[[gnu::always_inline]] inline void in_four(std::size_t n, F&& f) {
  std::size_t k = 0;
  for (; k + 4 <= n; k += 4) {
#pragma GCC unroll 4
    for (int c = 0; c < 4; ++c) f(k + c, c);
  }
#pragma GCC unroll 4
  for (int c = 0; c < 4; ++c)
    if (k + c < n) f(k + c, c);
}
template <class S>
struct FourSums {
  S of[4] = {S(0), S(0), S(0), S(0)};
  S total() const { return (of[0] + of[1]) + (of[2] + of[3]); }
};
template <class S>
struct FourLargest {  // maximum of non-negative numbers
  S of[4] = {S(0), S(0), S(0), S(0)};
  void take(int c, S x) { of[c] = larger(x, of[c]); }
  S total() const { return larger(larger(of[0], of[1]), larger(of[2], of[3])); }
};

/// 1 for doubles, more for floats. kLeft multiplies the thresholds of single pivots and rows. kPassedOn divides each of
/// the two pivots whose product must exceed a threshold (rank::PassedOn).
template <class S>
inline constexpr double kLeft = std::is_same_v<typename S::Element, float> ? tolerance::kSingleLeft : 1;
template <class S>
inline constexpr double kPassedOn = std::is_same_v<typename S::Element, float> ? tolerance::kSinglePassedOn : 1;

/// Whether q, v, tau are finite and quaternions have unit length.
template <class S>
typename S::Mask usable_input(const Model& model, const VecX<S>& q, const VecX<S>& v, const VecX<S>& tau) {
  FourSums<S> sum;  // 0 x is NaN if x is not finite
  for (const VecX<S>* x : {&q, &v, &tau})
    in_four(static_cast<std::size_t>(x->size()), [&](std::size_t k, int c) { sum.of[c] += (*x)[k] * S(0); });
  constexpr double k = tolerance::kQuaternion / (kLeft < S >> 1 ? 2 : 1);  // leaves room for errors of 1e-7 in floats
  typename S::Mask usable = sum.total() <= S(0);
  for (const Joint& joint : model.joints) {
    if (joint.type != JointType::kFloating) continue;
    const S norm2 = q.template segment<4>(joint.idx_q + 3).squaredNorm();
    usable = usable & (abs(norm2 - S(1)) <= S(2 * k - k * k));  // then | |q| - 1 | <= k
  }
  return usable;
}

/// Accepts or rejects pivots in elimination order. passed_on_more: divides each pivot in products of two pivots.
template <class S>
class PivotJudge {
 public:
  explicit PivotJudge(double passed_on_more = kPassedOn<S>) : more_(passed_on_more) {}
  /// Whether the next pivot exceeds `margin` times its rounding error; rejected ones have no effect. diagonal: K_kk.
  typename S::Mask accepts(const rank::Pivot<S>& pivot, const S& diagonal, double margin = 1) {
    const S left = select(diagonal < S(0), S(1), abs(pivot.d) / (more_ * pivot.terms));  // 1 for damped rows of J
    rank::PassedOn<S> next = passed_on_;
    const typename S::Mask sound =
        next.accepts(pivot.of_M, left) & rank::is_left(pivot, margin * kLeft<S>) & rank::has_its_sign(pivot);
    passed_on_.least = select(sound, next.least, passed_on_.least);
    passed_on_.least_of_J = select(sound, next.least_of_J, passed_on_.least_of_J);
    return sound;
  }

 private:
  S more_;
  rank::PassedOn<S> passed_on_;
};

/// Returns the componentwise backward error (sparse/refine.hpp) of residuals r, or NaN. scale: |b| + |K| |x| per row.
template <class S>
S componentwise_error(std::span<const S> r, const S* scale) {
  FourLargest<S> largest, error;
  FourSums<S> sum;
  in_four(r.size(), [&](std::size_t k, int c) { largest.take(c, scale[k]); });
  const S floor = largest.total() * S(std::numeric_limits<typename S::Element>::epsilon());
  in_four(r.size(), [&](std::size_t k, int c) {
    const S bound = larger(scale[k], floor), size = abs(r[k]);
    sum.of[c] += size + bound;
    error.take(c, select(size > S(0), size / bound, S(0)));
  });
  return error.total() + sum.total() * S(0);
}

template <class S>
struct Refinement {  // iterative refinement (sparse/refine.hpp) of a batch; each robot takes its own number of steps
  S steps = S(0), error, first;  // number of steps; backward error after the last step, and before the first

  /// correct(open): sets x += A^-1 r for robots flagged in `open`, and returns the backward errors of all robots.
  template <class Correct>
  Refinement(typename S::Mask usable, S error_of_x, Correct&& correct, int most = tolerance::kRefinementSteps)
      : error(error_of_x), first(error_of_x) {
    typename S::Mask open = usable & (error > S(tolerance::kRefined));
    for (int step = 0; step < most && open.any(); ++step) {
      const S before = error;
      error = correct(open);
      steps += select(open, S(1), S(0));
      open = open & (error < S(0.5) * before) & (error > S(tolerance::kRefined));
    }
  }
};

template <class S>
struct Largest {  // largest residual of a set of rows, and largest magnitude of their terms
  S r, scale;

  Largest(S least_scale, std::span<const int> rows, const S* residual, const S* size)
      : Largest(
            least_scale, rows.size(), [&](std::size_t k) { return rows[k]; }, residual, size) {}
  /// Takes the set of the first `count` rows. least_scale: lower limit of `scale`.
  Largest(S least_scale, std::size_t count, const S* residual, const S* size)
      : Largest(
            least_scale, count, [](std::size_t k) { return k; }, residual, size) {}
  template <class Row>
  Largest(S least_scale, std::size_t count, Row&& row, const S* residual, const S* size) {
    FourLargest<S> of_r, of_scale;
    in_four(count, [&](std::size_t k, int c) {
      of_r.take(c, abs(residual[row(k)]));
      of_scale.take(c, size[row(k)]);
    });
    r = of_r.total(), scale = larger(of_scale.total(), least_scale);
  }
  double ratio(int lane) const { return r[lane] == 0 ? 0 : r[lane] / scale[lane]; }
};

template <class S>
struct Growth {  // growth of K's entries (kkt/factor/pivots.hpp): largest terms of pivots, largest diagonal entry
  S terms, diagonal;

  template <class Diagonal>
  Growth(std::size_t n, const S* of_pivots, Diagonal&& entry) {
    FourLargest<S> of_terms, of_diagonal;
    in_four(n, [&](std::size_t k, int c) {
      of_terms.take(c, of_pivots[k]);
      of_diagonal.take(c, abs(entry(k)));
    });
    terms = of_terms.total(), diagonal = of_diagonal.total();
  }
};

}  // namespace manycontact::lanes
