#pragma once

#include <memory>

#include "manycontact/lq/direction_solver.hpp"

namespace manycontact::lq {

struct Prediction {
  double dense, islands, coupling_schur;  // operations of factorize by each method
};
Prediction predict(const Problem& problem);  // operations predicted from sizes, groups and couplings

/// Returns a solver on which analyse(problem) was called. It is Riccati by islands, which is dense if all blocks are
/// coupled, or CouplingSchur if this costs less, or if the terminal knot has more equations than variables w.
std::unique_ptr<DirectionSolver> choose(const Problem& problem);

}  // namespace manycontact::lq
