#pragma once
// spatial/explog.hpp for SIMD batches, robot by robot, since branches of logarithms differ between robots.

#include "manycontact/spatial/explog.hpp"

#ifdef MANYCONTACT_LANES

namespace manycontact {

template <int W, class E, class Function>
auto lane_by_lane(const SE3<Pack<W, E>>& M, Function&& function) {
  SE3<double> of_lane;
  using Result = decltype(function(of_lane));
  Eigen::Matrix<Pack<W, E>, Result::RowsAtCompileTime, Result::ColsAtCompileTime> out;
  for (int l = 0; l < W; ++l) {
    for (int i = 0; i < 9; ++i) of_lane.R.data()[i] = M.R.data()[i][l];
    for (int i = 0; i < 3; ++i) of_lane.p[i] = M.p[i][l];
    const Result x = function(of_lane);
    for (Eigen::Index i = 0; i < x.size(); ++i) out.data()[i].set(l, x.data()[i]);
  }
  return out;
}
template <int W, class E>
Vec6<Pack<W, E>> log6(const SE3<Pack<W, E>>& M) {
  return lane_by_lane(M, [](const SE3<double>& m) { return log6<double>(m); });
}
template <int W, class E>
Mat6<Pack<W, E>> log6_derivative(const SE3<Pack<W, E>>& M) {
  return lane_by_lane(M, [](const SE3<double>& m) { return log6_derivative<double>(m); });
}

}  // namespace manycontact

#endif
