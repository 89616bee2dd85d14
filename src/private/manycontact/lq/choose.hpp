#pragma once
// The direction solver that costs least by predicted operations.

#include <memory>

#include "manycontact/lq/direction_solver.hpp"

namespace manycontact::lq {

struct Prediction {
  double dense, islands, coupling_schur;  // operations of factorize
};
/// From the structure alone.
Prediction predict(const Problem& problem);

/// Riccati by islands, which is the dense one where all is joined, unless the Schur complement of couplings is
/// predicted to cost less, or a terminal knot has more equations than w, which Riccati cannot meet. Analysed.
std::unique_ptr<DirectionSolver> choose(const Problem& problem);

}  // namespace manycontact::lq
