#pragma once
#include "manycontact/kkt/pattern.hpp"
#include "manycontact/kkt/schur.hpp"

namespace manycontact {

// Predicted time of one factorization and two solves, in microseconds of a machine of 2020; only ratios count. The
// coefficients were fitted to `./run bench`.
double predicted_cost_ldl(const KktPattern& pattern);
double predicted_cost_cholmod(const KktPattern& pattern);
double predicted_cost_supernodal(const Scene& scene, const Island& island, const SchurPattern& pattern);
double predicted_cost_dense(int nv, int nc);

}  // namespace manycontact
