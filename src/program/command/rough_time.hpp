#pragma once
// Measured times of calls, and predicted times of dense methods [us], which are right to a factor of about three on
// current machines. They serve only to skip calls that would take too long.

#include <chrono>

#include "manycontact/dynamics/views.hpp"

namespace manycontact::cli {

/// Returns the time of a call [us].
template <class Call>
double time_of(Call&& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}
double median(std::vector<double> times);

/// Predicts the time of a solve of the scene's islands by `dense`, whatever the method of `data`.
double rough_time_of_dense(const Scene& scene, const SceneData& data);

/// Predict the time of a solve by the method of `data`, and of derivatives after it; 0 for sparse methods.
double rough_time_of_solve(const Scene& scene, const SceneData& data);
double rough_time_of_derivatives(const Scene& scene, const SceneData& data);

}  // namespace manycontact::cli
