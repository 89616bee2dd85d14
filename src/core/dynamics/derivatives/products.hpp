#pragma once
// Steps of jvp and vjp before and after the solve: right-hand sides along a direction, gradients from the adjoint
// solution. [a; y]: work.a, work.y, in the scene's coordinates; r: residuals of dynamics and contact rows.

#include "../workspace/workspace.hpp"

namespace manycontact::internal {

/// The zero variation of a fixed body. It is not in BodyVariation's header, as SIMD kernels must not run start-up code.
inline const BodyVariation kAtRest{Vec6<double>::Zero(), Vec6<double>::Zero(), Vec6<double>::Zero(),
                                   Vec6<double>::Zero()};

/// tangent_right_side sets [a; y] = -dr along (dq, dv, dtau). take_tangent copies the solution [da; -df] from [a; y].
void tangent_right_side(const Scene& scene, const SceneData& data, const Island& island, const TangentProduct& p,
                        ProductWork& work);
void take_tangent(const Scene& scene, const SceneData& data, const Island& island, const ProductWork& work,
                  const TangentProduct& p);

/// adjoint_right_side sets [a; y] = [wa; -wf]; pull_back_island sets (wq, wv, wtau) = -(dr)^T l, l = K^-1 [wa; -wf].
void adjoint_right_side(const Scene& scene, const SceneData& data, const Island& island, const AdjointProduct& p,
                        ProductWork& work);
void pull_back_island(const Scene& scene, const SceneData& data, const Island& island, ProductWork& work,
                      const AdjointProduct& p);

/// Computes jvp for an island whose terms are evaluated. solve(work): overwrites [a; y] with K^-1 [a; y].
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
