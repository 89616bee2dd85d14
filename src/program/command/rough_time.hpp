#pragma once
// Times of calls; and how long the dense methods take, to a factor of about three on machines of today: to leave out
// what would take too long, and for nothing else. The sparse methods never do. Predicted costs (kkt/choose.hpp) are
// relative; these are us.

#include <chrono>

#include "manycontact/dynamics/views.hpp"

namespace manycontact::cli {

/// The time of a call, us.
template <class Call>
double time_of(Call&& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}
double median(std::vector<double> times);

/// One solve of the scene's islands by `dense`, whatever the method of `data`.
double rough_time_of_dense(const Scene& scene, const SceneData& data);

/// One solve by the method of `data`, and its derivatives after it; 0 for the sparse ones.
double rough_time_of_solve(const Scene& scene, const SceneData& data);
double rough_time_of_derivatives(const Scene& scene, const SceneData& data);

}  // namespace manycontact::cli
