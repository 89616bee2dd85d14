#pragma once
// Calls calc or calcDiff of a running node (with u), or of a terminal node (u is null).

#include "manycontact/detail/action/fwd.hpp"

namespace manycontact::internal {

template <class Model, class Data>
void calc(Model& model, const Data& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  u ? model.calc(data, x, *u) : model.calc(data, x);
}

template <class Model, class Data>
void calc_diff(Model& model, const Data& data, const ConstVectorRef& x, const ConstVectorRef* u) {
  u ? model.calcDiff(data, x, *u) : model.calcDiff(data, x);
}

}  // namespace manycontact::internal
