#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// From here on there is no current solution, nor derivatives of one.
void give_up_solution(SceneData& data);

}  // namespace manycontact
