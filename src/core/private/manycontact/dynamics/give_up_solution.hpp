#pragma once
#include "manycontact/dynamics/data.hpp"

namespace manycontact {

/// Discards the current solution and its derivatives.
void give_up_solution(SceneData& data);

}  // namespace manycontact
