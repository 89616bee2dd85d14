#pragma once

#include <memory>

#include "manycontact/kkt/factor/factor.hpp"

namespace manycontact {

/// Makes K = L D L^T in K's order, by the compiled schedule (sparse/ldl_schedule.hpp) or, for kSuiteSparseLdl or if
/// that needs too much memory, SuiteSparse's LDL. Refuses pivots that are zero, of the wrong sign, or lost in
/// cancellation.
std::unique_ptr<Factor> make_ldl_factor(Method method);

/// Makes K = L D L^T for damping 0. Rows of J without a sound pivot wait, and later join or are dropped
/// (rank/dependent_rows.hpp); rows of M must have sound pivots. Refuses K if rounding hides the rank, or if J has more
/// than kFewRows rows and more than kMostWaiting of them wait.
std::unique_ptr<Factor> make_waiting_ldl_factor();

/// Makes the factor for damping 0 and dependences among rows of many bodies. It factorizes K with a damping of
/// kProximal, in any order, and proximal steps converge to the undamped solution. It refuses K if rounding hides which
/// rows are dependent.
std::unique_ptr<Factor> make_proximal_factor();

std::unique_ptr<Factor> make_cholmod_factor(std::shared_ptr<IslandShape> shape);  // CHOLMOD's LDL', in K's order

std::unique_ptr<Factor> make_dense_factor();  // rank-revealing (kkt/dense.hpp)

std::unique_ptr<Factor> make_dense_schur_factor();  // dense LLT of M and Schur complement

std::unique_ptr<Factor> make_factor(Method method, std::shared_ptr<IslandShape> shape);  // not for kAuto

}  // namespace manycontact
