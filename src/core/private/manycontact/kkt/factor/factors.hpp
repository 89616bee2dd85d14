#pragma once

#include <memory>

#include "manycontact/kkt/factor/factor.hpp"

namespace manycontact {

/// Factorizes K = L D L^T in K's order, by the pattern's schedule (kSparseLdl) or SuiteSparse's LDL (kSuiteSparseLdl,
/// or for lack of memory). Refuses pivots that are zero, of the wrong sign, or lost in cancellation.
std::unique_ptr<Factor> make_ldl_factor(Method method);

/// Does the same by the schedule, damping 0, with rows of J that may be dependent. Rows without a sound pivot wait:
/// they join the others, or are dropped (rank/dependent_rows.hpp). Rows of M after rows of J must have sound pivots.
/// Refuses if rounding hides the rank, or if more than tolerance::kMostWaiting of more than kFewRows rows wait.
std::unique_ptr<Factor> make_waiting_ldl_factor();

/// Does the same, damping 0, with rows that are dependent across many bodies: factorizes K with a small damping, which
/// costs as much as any damped K, and converges to damping 0 by proximal steps. K may be in any order that is sound
/// with damping. Refuses if rounding hides which rows are dependent.
std::unique_ptr<Factor> make_proximal_factor();

/// Factorizes K = L D L^T by CHOLMOD's simplicial part, in K's order.
std::unique_ptr<Factor> make_cholmod_factor(std::shared_ptr<IslandShape> shape);

/// Dense rank-revealing factor (kkt/dense.hpp): the dense reference solver.
std::unique_ptr<Factor> make_dense_factor();

/// Dense LLT of M and of the Schur complement: the baseline, as in Crocoddyl.
std::unique_ptr<Factor> make_dense_schur_factor();

/// Returns the factor of a method other than kAuto.
std::unique_ptr<Factor> make_factor(Method method, std::shared_ptr<IslandShape> shape);

}  // namespace manycontact
