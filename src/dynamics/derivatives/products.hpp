#pragma once
// What products with derivatives have before and after the solve: right-hand sides along a direction, and gradients
// from the adjoint. In the scene's coordinates, [a; y] of the scratch. While AtSolution lives.

#include "../workspace.hpp"

namespace manycontact::internal {

/// [a; y] = -dr along (dq, dv, du); after the solve x = [da; -df].
void tangent_right_side(const Scene& scene, const SceneData& data, const Island& island, const TangentProduct& p,
                        ProductWork& work);
void take_tangent(const Scene& scene, const SceneData& data, const Island& island, const ProductWork& work,
                  const TangentProduct& p);

/// [a; y] = [wa; -wf]; after the solve, l = K^-1 [wa; -wf], the gradients w = -(dr)^T l.
void adjoint_right_side(const Scene& scene, const SceneData& data, const Island& island, const AdjointProduct& p,
                        ProductWork& work);
void pull_back_island(const Scene& scene, const SceneData& data, const Island& island, ProductWork& work,
                      const AdjointProduct& p);

}  // namespace manycontact::internal
