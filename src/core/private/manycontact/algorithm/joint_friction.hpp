#pragma once
// Joint damping d and friction c as torques tau_f = -d v - c tanh(v / v0), with v0 = kFrictionVelocity.

#include <cmath>

#include "manycontact/model/model.hpp"
#include "manycontact/spatial/scalar.hpp"

namespace manycontact {

inline bool has_friction(const Model& model) { return model.damping.size() + model.friction.size() > 0; }

template <class S>
void add_friction(const Model& model, const S* v, S* tau, double scale = 1) {  // tau += scale tau_f
  using std::tanh;
  for (Eigen::Index i = 0; i < model.damping.size(); ++i) tau[i] -= S(scale * model.damping[i]) * v[i];
  for (Eigen::Index i = 0; i < model.friction.size(); ++i)
    if (model.friction[i] != 0) tau[i] -= S(scale * model.friction[i]) * tanh(v[i] / S(kFrictionVelocity));
}

inline double friction_slope(const Model& model, int i, double v) {  // -d tau_f / dv
  double slope = model.damping.size() > 0 ? model.damping[i] : 0;
  if (model.friction.size() == 0 || model.friction[i] == 0) return slope;
  const double c = std::cosh(v / kFrictionVelocity);
  return slope + model.friction[i] / (kFrictionVelocity * c * c);
}

/// Adds the derivative of tau_f at v along dv to `out`, for a robot's nv coordinates.
template <class V, class Dv, class Out>
void add_friction_change(const Model& model, const V& v, const Dv& dv, Out&& out) {
  for (int i = 0; has_friction(model) && i < model.nv; ++i) out[i] -= friction_slope(model, i, v[i]) * dv[i];
}

}  // namespace manycontact
