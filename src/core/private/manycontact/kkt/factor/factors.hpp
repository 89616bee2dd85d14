#pragma once
// The kinds of factor.

#include <memory>
#include <span>

#include "manycontact/kkt/factor/factor.hpp"

namespace manycontact {

/// K = L D L^T in K's order, by the pattern's schedule (kSparseLdl) or by SuiteSparse's LDL (kSuiteSparseLdl, and
/// patterns whose schedule would take too much memory). Refused: pivots that are zero, of the wrong sign, or lost in
/// cancellation.
std::unique_ptr<Factor> make_ldl_factor(Method method);

/// The same by the schedule, damping 0, where rows of J may depend on each other. Those without a plain pivot wait:
/// they join the others, or depend on them and are dropped (rank/dependent_rows.hpp). K may be in any order, as long as
/// rows of M that follow rows of J have sound pivots. Refused where rounding hides which rows depend, and where more
/// than tolerance::kMostWaiting wait of more than kFewRows.
std::unique_ptr<Factor> make_waiting_ldl_factor();

/// The same, damping 0, where rows depend on each other across many bodies: by the factor of K with a small damping,
/// which takes no more than that of any damped K, and steps that converge to what damping 0 gives. K in any order that
/// is sound with damping. Refused where rounding hides which rows depend.
std::unique_ptr<Factor> make_proximal_factor();

/// K = L D L^T by CHOLMOD's simplicial part, in K's order.
std::unique_ptr<Factor> make_cholmod_factor(std::shared_ptr<IslandShape> shape);

/// Dense and rank-revealing (kkt/dense.hpp): the dense reference solver.
std::unique_ptr<Factor> make_dense_factor();

/// Dense LLT of M and of the Schur complement: the baseline, as Crocoddyl does it.
std::unique_ptr<Factor> make_dense_schur_factor();

/// The factor of a method, not kAuto.
std::unique_ptr<Factor> make_factor(Method method, std::shared_ptr<IslandShape> shape);

}  // namespace manycontact
