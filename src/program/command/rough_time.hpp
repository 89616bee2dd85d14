#pragma once
// Measures times of calls and predicts times of dense methods [us], to a factor of about three on current machines. The
// predictions serve only to skip calls that would take too long.

#include <chrono>

#include "manycontact/dynamics/views.hpp"

namespace manycontact::cli {

template <class Call>
double time_of(Call&& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}
double median(std::vector<double> times);

/// Returns the predicted time [us] of a solve of the scene's islands by the method `dense`, whatever data's method is.
double rough_time_of_dense(const Scene& scene, const SceneData& data);

/// Return the predicted times [us] of a solve with the method of `data`, and of its derivatives. 0 for sparse methods.
double rough_time_of_solve(const Scene& scene, const SceneData& data);
double rough_time_of_derivatives(const Scene& scene, const SceneData& data);

}  // namespace manycontact::cli
