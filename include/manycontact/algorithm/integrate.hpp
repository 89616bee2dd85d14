#pragma once
// The configuration manifold of one robot. Tangent vectors live in each joint's own child frame.

#include "manycontact/model/model.hpp"

namespace manycontact {

/// out = q (+) v: the configuration reached from q by the velocity v held for unit time. q, out: nq; v: nv.
template <class S>
void integrate(const Model& model, const ConstVecRef<S>& q, const ConstVecRef<S>& v, VecRef<S> out);

/// out = q1 (-) q0: the v with integrate(q0, v) = q1. q0, q1: nq; out: nv.
template <class S>
void difference(const Model& model, const ConstVecRef<S>& q0, const ConstVecRef<S>& q1, VecRef<S> out);

}  // namespace manycontact
