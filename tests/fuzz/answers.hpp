#pragma once
// Every method is compared with the dense reference solver, for any scene.

#include <string>

#include "manycontact/model/scene.hpp"

namespace manycontact::fuzz {

/// Solves the scene by every method and order, and judges islands by the dense reference solver:
///
///   * failed: NaN and nothing else; otherwise finite numbers;
///   * ok, redundant, inconsistent, of the rank that the reference finds: accelerations and forces within three times
///     both solutions' error bounds (estimate_errors, whose |K^-1| is an estimate), and together within twice
///     max(1e-12, 100 eps cond);
///   * of another rank: only where one of both conditions is above 1e8;
///   * products with derivatives along one direction: within ten times that; jvp and vjp are products with
///     differentiate's matrices;
/// * a contact switched off and on again leaves every bit as it was.
///
/// Throws Finding.
void check_answers(const Scene& scene, const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& u);

}  // namespace manycontact::fuzz
