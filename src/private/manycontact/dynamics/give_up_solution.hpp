#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// No solution is at hand from here on, nor derivatives of one.
void give_up_solution(SceneData& data);

}  // namespace manycontact
