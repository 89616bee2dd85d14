#include <limits>

#include "internal.hpp"
#include "manycontact/dynamics/differentiate.hpp"
#include "manycontact/sparse/condition.hpp"
#include "manycontact/sparse/tolerances.hpp"

namespace manycontact {

namespace {

// Sets the bounds of derivatives that were not requested to kNotEstimated.
void forget_unrequested(const DerivativeRequest& request, DerivativeBounds& b) {
  if (!request.q) b.da_dq = b.dforces_dq = kNotEstimated;
  if (!request.v) b.da_dv = b.dforces_dv = kNotEstimated;
  if (!request.u) b.da_du = b.dforces_du = kNotEstimated;
  if (!request.wrenches) b.da_dw = b.dforces_dw = kNotEstimated;
  if (!request.forces) b.dforces_dq = b.dforces_dv = b.dforces_du = b.dforces_dw = kNotEstimated;
}

}  // namespace

double internal::inverse_norm(int n, const std::function<void(double*)>& solve) {
  return n <= tolerance::kSmallInverse ? sparse::norm_1_by_columns(n, solve) : sparse::inverse_norm_1(n, solve);
}

void internal::bound_errors(const Scene& scene, SceneData& data) {
  Workspace& w = *data.workspace;
  if (w.reduction) return bound_errors_reduced(scene, data);
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    IslandReport& report = data.report.islands[i];
    if (!ask(scene, data, *w.islands[i], w.threads.front(),
             [&](IslandSystem& system) { return system.bound_errors(scene, data, report); }))
      report.error_acceleration = report.error_forces = std::numeric_limits<double>::infinity();
  }
}

void estimate_errors(const Scene& scene, SceneData& data) {
  internal::check_not_prescribed(scene, data, "estimate_errors");
  internal::refine_for_bounds(scene, data);
  internal::bound_errors(scene, data);
  internal::take_extended_bounds(scene, data);
  summarise(data.report);
}

std::vector<DerivativeBounds> estimate_derivative_errors(const Scene& scene, SceneData& data) {
  internal::check_scene(scene, data, "estimate_derivative_errors");
  const DerivativeData& of = derivatives(data);
  if (data.workspace->reduction) return internal::derivative_errors_reduced(scene, data);
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Workspace& w = *data.workspace;
  std::vector<DerivativeBounds> out(w.islands.size(), {kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone});
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    IslandWork& d = *w.islands[i];
    if (!d.answered || !d.matrix.make_current(scene, data, w.threads.front())) continue;
    w.linearisation->assign(scene, w, d.island);
    DerivativeBounds bounds;
    if (internal::bound_derivatives(scene, data, w.threads.front(), d.matrix, of.islands[i], bounds)) out[i] = bounds;
  }
  for (std::size_t i = 0; i < out.size(); ++i) forget_unrequested(of.islands[i].request, out[i]);
  return out;
}

void estimate_condition(const Scene& scene, SceneData& data) {
  internal::check_solved(scene, data, "estimate_condition");
  Workspace& w = *data.workspace;
  if (w.reduction) return internal::estimate_condition_reduced(scene, data);
  for (std::size_t i = 0; i < w.islands.size(); ++i) {
    IslandReport& report = data.report.islands[i];
    if (!internal::ask(scene, data, *w.islands[i], w.threads.front(),
                       [&](IslandSystem& system) { return system.estimate_condition(scene, data, report); }))
      report.condition = std::numeric_limits<double>::infinity();
  }
  summarise(data.report);
}

}  // namespace manycontact
