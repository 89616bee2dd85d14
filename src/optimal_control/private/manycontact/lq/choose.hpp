#pragma once

#include <memory>

#include "manycontact/lq/direction_solver.hpp"

namespace manycontact::lq {

struct Prediction {
  double dense, islands, coupling_schur;  // operations of factorize
};
/// Predicts the operations from the structure alone.
Prediction predict(const Problem& problem);

/// Chooses Riccati by islands (dense if all blocks are coupled), or the Schur complement of couplings if predicted to
/// cost less, or if a terminal knot has more equations than w, which Riccati cannot solve. The result is analysed.
std::unique_ptr<DirectionSolver> choose(const Problem& problem);

}  // namespace manycontact::lq
