#pragma once
// The operations of Crocoddyl's AssignmentOp on a value.

#include "manycontact/action/state.hpp"

namespace manycontact::internal {

template <class Out, class Value>
void assign(Out&& out, const Value& value, AssignmentOp op) {
  if (op == setto)
    out = value;
  else if (op == addto)
    out += value;
  else
    out -= value;
}

}  // namespace manycontact::internal
