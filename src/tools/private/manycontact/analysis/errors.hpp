#pragma once
// Differences of a solution from another solution or a reference, per robot and in the maximum norm. S is the scalar of
// the reference: differences from a reference in quadruple precision are computed in quadruple precision.

#include <cmath>
#include <vector>

#include "manycontact/model/scene.hpp"
#include "manycontact/sparse/largest.hpp"

namespace manycontact {

/// The differences |x - truth|, in the units of x, and |x - truth| / |truth|. NaN if x or truth contains NaN.
struct Deviation {
  double absolute = 0, relative = 0;
};

/// Returns max |x_ij|; NaN if x contains NaN.
template <class X>
double largest_entry(const X& x) {
  using std::abs;
  double out = 0;
  for (Eigen::Index j = 0; j < x.cols(); ++j)
    for (Eigen::Index i = 0; i < x.rows(); ++i) out = sparse::larger_or_nan(out, static_cast<double>(abs(x(i, j))));
  return out;
}

/// Returns the deviations of accelerations per robot (a, truth: nv, [m/s^2, rad/s^2]), relative to the larger of
/// |truth| and |at_least|. at_least (nv, or empty) is for robots at rest, whose accelerations are rounding errors.
template <class S>
std::vector<Deviation> acceleration_deviations(const Scene& scene, const Eigen::VectorXd& a, const VecX<S>& truth,
                                               const Eigen::VectorXd& at_least = {}) {
  std::vector<Deviation> out;
  for (const Robot& robot : scene.robots) {
    const int first = robot.idx_v, nv = robot.model->nv;
    const double absolute = largest_entry(a.segment(first, nv).template cast<S>() - truth.segment(first, nv));
    double size = largest_entry(truth.segment(first, nv));
    if (at_least.size() > 0) size = sparse::larger_or_nan(size, largest_entry(at_least.segment(first, nv)));
    out.push_back({absolute, absolute == 0 ? 0 : absolute / size});
  }
  return out;
}

/// Returns per robot the largest entry of the forces of all contacts on it [N, N m]. f, f_offset: as in Solution.
template <class S>
std::vector<double> largest_forces(const Scene& scene, const std::vector<int>& f_offset, const VecX<S>& f) {
  std::vector<double> out(scene.robots.size(), 0.0);
  for (std::size_t c = 0; c < scene.contacts.size(); ++c) {
    if (f_offset[c] < 0) continue;
    const Contact& contact = scene.contacts[c];
    const double size = largest_entry(f.segment(f_offset[c], contact.rows()));
    for (int robot : {contact.A.robot, contact.B.robot})
      if (robot >= 0) out.begin()[robot] = sparse::larger_or_nan(out.begin()[robot], size);
  }
  return out;
}

/// Returns per robot the deviations of the forces of all contacts on it.
template <class S>
std::vector<Deviation> force_deviations(const Scene& scene, const std::vector<int>& f_offset, const Eigen::VectorXd& f,
                                        const VecX<S>& truth) {
  const std::vector<double> absolute = largest_forces<S>(scene, f_offset, f.cast<S>() - truth);
  const std::vector<double> size = largest_forces<S>(scene, f_offset, truth);
  std::vector<Deviation> out;
  for (std::size_t r = 0; r < size.size(); ++r)
    out.push_back({absolute[r], absolute[r] == 0 ? 0 : absolute[r] / size[r]});
  return out;
}

/// Returns the largest absolute and the largest relative deviation; NaN if a deviation is NaN.
inline Deviation worst(const std::vector<Deviation>& deviations) {
  Deviation out;
  for (const Deviation& d : deviations) {
    out.absolute = sparse::larger_or_nan(out.absolute, d.absolute);
    out.relative = sparse::larger_or_nan(out.relative, d.relative);
  }
  return out;
}

}  // namespace manycontact
