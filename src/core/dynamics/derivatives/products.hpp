#pragma once
// Products with derivatives before and after the solve: right-hand sides along a direction, and gradients from the
// adjoint. Vectors are in the scene's coordinates; [a; y] is that of `work`.

#include "../workspace/workspace.hpp"

namespace manycontact::internal {

/// Variation of a fixed body. It is defined here, as kernels include BodyVariation's header without start-up code.
inline const BodyVariation kAtRest{Vec6<double>::Zero(), Vec6<double>::Zero(), Vec6<double>::Zero(),
                                   Vec6<double>::Zero()};

/// Sets [a; y] = -dr along (dq, dv, dtau); take_tangent copies the solution [da; -df] from them.
void tangent_right_side(const Scene& scene, const SceneData& data, const Island& island, const TangentProduct& p,
                        ProductWork& work);
void take_tangent(const Scene& scene, const SceneData& data, const Island& island, const ProductWork& work,
                  const TangentProduct& p);

/// Sets [a; y] = [wa; -wf]; pull_back_island computes the gradients w = -(dr)^T l from l = K^-1 [wa; -wf].
void adjoint_right_side(const Scene& scene, const SceneData& data, const Island& island, const AdjointProduct& p,
                        ProductWork& work);
void pull_back_island(const Scene& scene, const SceneData& data, const Island& island, ProductWork& work,
                      const AdjointProduct& p);

/// Computes the product for an island that was evaluated. solve(work): [a; y] <- K^-1 [a; y].
template <class Solve>
void tangent_product(const Scene& scene, SceneData& data, const Island& island, const TangentProduct& p,
                     Solve&& solve) {
  ProductWork& work = *data.workspace->products;
  const AtSolution at(scene, data, island);
  tangent_right_side(scene, data, island, p, work);
  solve(work);
  take_tangent(scene, data, island, work, p);
}
template <class Solve>
void adjoint_product(const Scene& scene, SceneData& data, const Island& island, const AdjointProduct& p,
                     Solve&& solve) {
  ProductWork& work = *data.workspace->products;
  const AtSolution at(scene, data, island);
  adjoint_right_side(scene, data, island, p, work);
  solve(work);
  pull_back_island(scene, data, island, work, p);
}

}  // namespace manycontact::internal
