#pragma once

#include <memory>

#include "manycontact/kkt/factor/factor.hpp"

namespace manycontact {

/// Makes a factor K = L D L^T in the elimination order of K. kSparseLdl uses the pattern's compiled schedule
/// (sparse/ldl_schedule.hpp), or SuiteSparse's LDL if the schedule needs too much memory. kSuiteSparseLdl always uses
/// SuiteSparse's LDL. The factor refuses pivots that are zero, of the wrong sign, or lost in cancellation.
std::unique_ptr<Factor> make_ldl_factor(Method method);

/// Makes a factor K = L D L^T for damping 0, where rows of J may be dependent. Rows without a sound pivot wait: they
/// later join the other rows, or are dropped (rank/dependent_rows.hpp). Rows of M after rows of J must have sound
/// pivots. The factor refuses K if rounding hides the rank, or if J has more than kFewRows rows, and more than
/// kMostWaiting of them wait.
std::unique_ptr<Factor> make_waiting_ldl_factor();

/// Makes a factor for damping 0 and for dependences that involve rows of many bodies. It factorizes K with a small
/// damping, at the cost of any damped K, and proximal steps converge to the solution without damping. The order of K
/// may be any that is sound with damping. The factor refuses K if rounding hides which rows are dependent.
std::unique_ptr<Factor> make_proximal_factor();

/// Makes a factor K = L D L^T by CHOLMOD's simplicial part, in K's order.
std::unique_ptr<Factor> make_cholmod_factor(std::shared_ptr<IslandShape> shape);

/// Makes the dense rank-revealing factor (kkt/dense.hpp), the dense reference solver.
std::unique_ptr<Factor> make_dense_factor();

/// Makes the factor of the method dense-schur: dense LLT of M and of the Schur complement, as in Crocoddyl.
std::unique_ptr<Factor> make_dense_schur_factor();

/// Makes the factor of a method other than kAuto.
std::unique_ptr<Factor> make_factor(Method method, std::shared_ptr<IslandShape> shape);

}  // namespace manycontact
