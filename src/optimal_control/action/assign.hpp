#pragma once
// Sets, adds or subtracts a value, as an argument of type AssignmentOp requests.

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
